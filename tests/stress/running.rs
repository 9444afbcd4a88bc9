//! Runs cases and compares what comes out with their bounds.

use super::table::{Case, Figure, How, Section, Vars};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How long runs are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Form {
    Short,
    Long,
}

/// What has come of one figure of a case, or of its refusal.
#[derive(Clone)]
pub struct Row {
    pub case: String,
    /// Nothing where a case is to be refused.
    pub figure: Option<Figure>,
    pub value: Option<f64>,
    /// The output, where it matters.
    pub printed: String,
    pub met: bool,
}

impl Row {
    /// What is wrong with it.
    pub fn problem(&self) -> String {
        match (&self.figure, self.value) {
            (Some(f), Some(v)) => {
                format!("{} is {v:.3e}, not between {:?} and {:?} ({})", f.name, f.least, f.most, f.why)
            }
            (Some(f), None) => format!("no figure {}:\n{}", f.name, self.printed),
            (None, _) => format!("not as stated:\n{}", self.printed),
        }
    }
}

/// What one run has given.
struct Outcome {
    code: Option<i32>,
    printed: String,
    /// The written state, if there is one.
    state: String,
}

/// A program, a section and a case of it.
struct Task<'a> {
    program: &'a Path,
    section: &'a Section,
    case: &'a Case,
    form: Form,
}

impl Task<'_> {
    /// Runs the deck with more variables and a number of threads in a folder.
    fn deck(&self, folder: &Path, more: &[(&str, &str)], threads: usize) -> Outcome {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/stress/scenes");
        let scene = self.case.scene.as_ref().unwrap_or(&self.section.scene);
        let length = if self.form == Form::Long { &self.section.long } else { &self.section.short };
        let mut vars: Vars = self.section.set.clone();
        vars.extend(length.clone());
        vars.extend(self.case.set.clone());
        vars.extend(more.iter().map(|(k, v)| (k.to_string(), v.to_string())));
        let mut command = Command::new(self.program);
        command.arg("-in").arg(scenes.join(format!("{scene}.in"))).args(["-log", "none", "-threads"]);
        command.arg(threads.to_string()).current_dir(folder);
        for (name, value) in &vars {
            command.args(["-var", name, value]);
        }
        let output = command.output().unwrap();
        let printed = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
        let state = std::fs::read_to_string(folder.join("state.dump")).unwrap_or_default();
        Outcome { code: output.status.code(), printed, state }
    }

    /// The state that a run has written, and all output.
    fn state(&self, more: &[(&str, &str)], threads: usize) -> (String, String) {
        let folder = tempfile::tempdir().unwrap();
        let more = [&[("tail", "state")], more].concat();
        let o = self.deck(folder.path(), &more, threads);
        (o.state, o.printed)
    }

    /// The figures of a case, by name, and the last output.
    fn measure(&self) -> (BTreeMap<String, f64>, Option<i32>, String) {
        let one = |name: &str, value: f64| BTreeMap::from([(name.to_string(), value)]);
        match self.case.how {
            How::Run | How::Refused => {
                let folder = tempfile::tempdir().unwrap();
                let o = self.deck(folder.path(), &[], 1);
                (measures(&o.printed), o.code, o.printed)
            }
            How::Order => {
                let [a, b, c, d] = ["1", "2", "4", "8"].map(|n| self.state(&[("halve", n)], 1));
                let (coarse, fine) = (apart(&a.0, &b.0, [1.0; 9]), apart(&c.0, &d.0, [1.0; 9]));
                // Over two halvings: where friction begins or ends within a step, the coefficient of one swings.
                (one("order", 0.5 * (coarse / fine).log2()), Some(0), a.1)
            }
            How::Mirror => {
                let [a, b] = ["1", "-1"].map(|m| self.state(&[("mirror", m)], 1));
                let signs = [-1.0, 1.0, 1.0, -1.0, 1.0, 1.0, 1.0, -1.0, -1.0];
                (one("mirror", apart(&a.0, &b.0, signs)), Some(0), a.1)
            }
            How::Threads => {
                let all = [1, 2, 7, 16].map(|n| self.state(&[], n));
                let other = all.iter().filter(|s| s.0.is_empty() || s.0 != all[0].0).count();
                (one("threads", other as f64), Some(0), all[1].1.clone())
            }
            How::Restart => {
                let whole = self.state(&[], 1);
                let folder = tempfile::tempdir().unwrap();
                let part = |stage| self.deck(folder.path(), &[("tail", "state"), ("stage", stage)], 1);
                let cut = ["first", "second"].map(part);
                let same = !whole.0.is_empty() && whole.0 == cut[1].state;
                (one("restart", f64::from(u8::from(!same))), Some(0), cut[1].printed.clone())
            }
        }
    }

    fn rows(&self) -> Vec<Row> {
        let (found, code, printed) = self.measure();
        let refused = self.case.how == How::Refused;
        let silent = self.case.prints.iter().find(|w| !printed.contains(*w));
        let ends = code == Some(i32::from(refused));
        let row = |figure: Option<Figure>, value, met| Row {
            case: self.case.name.clone(),
            figure,
            value,
            printed: printed.clone(),
            met,
        };
        let mut rows: Vec<Row> = vec![];
        for f in self.section.figures(self.case) {
            let value = found.get(&f.name).copied();
            let within =
                value.is_some_and(|v| f.least.is_none_or(|l| v >= l) && f.most.is_none_or(|m| v <= m));
            rows.push(row(Some(f), value, within && ends && silent.is_none()));
        }
        if refused {
            rows.push(Row { printed: message(&printed), ..row(None, None, ends && silent.is_none()) });
        }
        rows
    }
}

/// The first error of a log without its numbers in brackets, or all output.
fn message(printed: &str) -> String {
    let first = printed.lines().find_map(|l| Some(&l[l.find("error[")?..]));
    first.map_or(printed, |l| l.split(" (the first").next().unwrap_or(l)).to_string()
}

/// The numbers of the lines `measure NAME VALUE`.
fn measures(printed: &str) -> BTreeMap<String, f64> {
    let words = printed.lines().filter_map(|l| l.strip_prefix("measure ")?.split_once(' '));
    words.filter_map(|(name, value)| Some((name.to_string(), value.trim().parse().ok()?))).collect()
}

/// The largest difference of two states, columns of the second multiplied by signs; not a number where there is nothing to compare.
fn apart(a: &str, b: &str, signs: [f64; 9]) -> f64 {
    let rows = |text: &str| -> Vec<Vec<f64>> {
        let body = text.split("ITEM: ATOMS").nth(1).unwrap_or_default().lines().skip(1);
        body.map(|l| l.split_whitespace().skip(1).map(|w| w.parse().unwrap()).collect()).collect()
    };
    let (a, b) = (rows(a), rows(b));
    if a.is_empty() || a.len() != b.len() {
        return f64::NAN;
    }
    let numbers = a.iter().flatten().zip(b.iter().flatten()).zip(signs.iter().cycle());
    let differences = numbers.map(|((a, b), sign)| (a - sign * b).abs());
    // What is no number is no small difference.
    differences.fold(0.0, |most, d| if d.is_nan() || d > most { d } else { most })
}

/// Runs all cases, as many at a time as there are cores; the rows by section.
pub fn run_all(sections: &[Section], form: Form, program: &Path) -> Vec<Vec<Row>> {
    let tasks: Vec<(usize, Task)> = sections
        .iter()
        .enumerate()
        .flat_map(|(k, section)| {
            section.case.iter().map(move |case| (k, Task { program, section, case, form }))
        })
        .collect();
    let (next, done) = (AtomicUsize::new(0), Mutex::new(BTreeMap::new()));
    let work = || {
        loop {
            let k = next.fetch_add(1, Ordering::Relaxed);
            let Some((_, task)) = tasks.get(k) else { return };
            let began = std::time::Instant::now();
            let rows = task.rows();
            if form == Form::Long {
                let met = if rows.iter().all(|r| r.met) { "" } else { "  NOT MET" };
                let (name, seconds) = (&task.case.name, began.elapsed().as_secs_f64());
                println!("{:4} of {}  {seconds:6.1} s  {name}{met}", k + 1, tasks.len());
            }
            done.lock().unwrap().insert(k, rows);
        }
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|s| (0..cores).for_each(|_| drop(s.spawn(work))));
    let mut all = vec![vec![]; sections.len()];
    for (k, rows) in done.into_inner().unwrap() {
        all[tasks[k].0].extend(rows);
    }
    all
}
