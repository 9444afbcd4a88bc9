//! The journal: one line per event, on the disk before the event counts.

use super::folder::{self, Folder};
use super::record::{digest, join, open, pairs, seal, split, unpaired};
use super::{Job, Outcome, Settings, Sweep, other};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result};
use perigrain_output::file::trouble;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The file's name.
const NAME: &str = "journal";
/// The first word of its first line, with the number of its form.
const FORM: &str = "sweep 1";

/// The content of the first line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Head {
    pub version: String,
    pub deck: String,
    pub digest: String,
    pub settings: String,
    pub report: Vec<String>,
    pub jobs: Vec<Job>,
}

impl Head {
    fn of(sweep: &Sweep) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            deck: sweep.deck.name.clone(),
            digest: digest(sweep.deck.text.as_bytes()),
            settings: words(&sweep.settings),
            report: sweep.report.clone(),
            jobs: sweep.jobs.clone(),
        }
    }

    fn fields(&self) -> Vec<String> {
        let jobs: Vec<String> = self.jobs.iter().map(|job| pairs(&job.vars)).collect();
        let head = [FORM, &self.version, &self.deck, &self.digest, &self.settings].map(String::from);
        head.into_iter().chain([join(&self.report), join(&jobs)]).collect()
    }

    fn read(fields: &[String]) -> Option<Self> {
        let [form, version, deck, digest, settings, report, jobs] = fields else { return None };
        // One job without variables is an empty text.
        let jobs = if jobs.is_empty() { vec![String::new()] } else { split(jobs) };
        (form == FORM).then(|| Self {
            version: version.clone(),
            deck: deck.clone(),
            digest: digest.clone(),
            settings: settings.clone(),
            report: split(report),
            jobs: jobs.iter().map(|job| Job { vars: unpaired(job) }).collect(),
        })
    }

    /// What is other in `new`, in a sentence without its end.
    fn difference(&self, new: &Self, deck: (Option<&str>, &str)) -> Option<String> {
        if self.version != new.version {
            return Some(format!("perigrain {} began it, this is {}", self.version, new.version));
        }
        if self.digest != new.digest {
            return Some(format!("the deck has changed{}", first_change(deck.0, deck.1)));
        }
        if self.settings != new.settings {
            let say = |words: &str| if words.is_empty() { "none".to_owned() } else { format!("`{words}`") };
            return Some(format!(
                "its switches were {}, they are {}",
                say(&self.settings),
                say(&new.settings)
            ));
        }
        if self.report != new.report {
            let say = |words: &[String]| if words.is_empty() { "nothing".into() } else { words.join(" ") };
            return Some(format!("it reports {}, not {}", say(&self.report), say(&new.report)));
        }
        if self.jobs.len() != new.jobs.len() {
            return Some(format!("it has {} runs, not {}", self.jobs.len(), new.jobs.len()));
        }
        let k = self.jobs.iter().zip(&new.jobs).position(|(a, b)| a != b)?;
        Some(format!("run {} is {}, not {}", k + 1, self.jobs[k].title(), new.jobs[k].title()))
    }
}

/// Settings as the switches that make them.
fn words(settings: &Settings) -> String {
    let switches = [
        (settings.force_list, "-layout list"),
        (settings.no_skipping, "-rest full"),
        (settings.portable, "-portable"),
        (settings.series, "series"),
    ];
    let vars = settings.vars.iter().map(|(name, values)| format!("-var {name} {}", values.join(" ")));
    let compat = settings.compat.is_chosen().then(|| format!("-compat {}", settings.compat.name()));
    let on = switches.into_iter().filter(|(on, _)| *on).map(|(_, word)| word.to_owned());
    let lammps = settings.lammps.iter().map(|path| format!("-lammps {}", path.display()));
    vars.chain(compat).chain(on).chain(lammps).collect::<Vec<_>>().join(" ")
}

/// The first line in which two decks differ, as `: line 3 was …, is …`.
fn first_change(old: Option<&str>, new: &str) -> String {
    let Some(old) = old else { return String::new() };
    let (mut a, mut b) = (old.lines(), new.lines());
    for line in 1.. {
        match (a.next(), b.next()) {
            (Some(was), Some(is)) if was == is => {}
            (Some(was), Some(is)) => {
                return format!(": line {line} was `{}`, is `{}`", was.trim(), is.trim());
            }
            (Some(was), None) => return format!(": line {line}, `{}`, is gone", was.trim()),
            (None, Some(is)) => return format!(": line {line}, `{}`, is new", is.trim()),
            (None, None) => break,
        }
    }
    String::new()
}

/// The journal of a sweep at work.
pub(super) struct Journal {
    path: PathBuf,
    file: File,
    /// The first line's digest.
    print: String,
    /// Whether it has just been begun.
    pub is_new: bool,
    /// Runs that were begun, now or earlier.
    pub begun: Vec<bool>,
    /// What became of runs in the end.
    pub outcomes: Vec<Option<Outcome>>,
    /// The rank at which each run was begun earlier, where there were several.
    pub at: Vec<Option<String>>,
    /// Lines that could not be read.
    pub notes: Diagnostics,
}

impl Journal {
    /// Continues the journal in the folder, or begins one.
    ///
    /// # Errors
    /// A journal of another sweep, a damaged one, files that cannot be written.
    pub fn open(sweep: &Sweep, home: &Folder, anew: bool) -> Result<Self> {
        let path = sweep.folder.join(NAME);
        let head = Head::of(sweep);
        let before = match std::fs::read(&path) {
            Ok(bytes) => Some(read(&path, &bytes)),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => None,
            Err(e) => return Err(trouble("read", &path, &e).into()),
        };
        let Some(before) = before.filter(|b| !anew && !b.as_ref().is_ok_and(|b| b.is_empty())) else {
            forget_runs(sweep, &path);
            return Self::begin_with(sweep, home, path, &head);
        };
        let before = before?;
        let kept = home.kept();
        if let Some(what) =
            before.head.as_ref().and_then(|h| h.difference(&head, (kept.as_deref(), &sweep.deck.text)))
        {
            return Err(other(sweep, what));
        }
        let failed = |e: std::io::Error| Diagnostics::from(trouble("write", &path, &e));
        let mut file = File::options().read(true).write(true).open(&path).map_err(failed)?;
        file.set_len(before.whole).map_err(failed)?;
        std::io::Seek::seek(&mut file, std::io::SeekFrom::End(0)).map_err(failed)?;
        if kept.as_deref() != Some(&sweep.deck.text) {
            home.keep(&sweep.deck)?;
        }
        let print = digest(seal(&head.fields()).as_bytes());
        let Read { begun, outcomes, notes, at, .. } = before;
        Ok(Self { path, file, print, is_new: false, begun, outcomes, at, notes })
    }

    fn begin_with(sweep: &Sweep, home: &Folder, path: PathBuf, head: &Head) -> Result<Self> {
        home.keep(&sweep.deck)?;
        let file = File::create(&path).map_err(|e| trouble("write", &path, &e))?;
        let line = seal(&head.fields());
        let n = sweep.jobs.len();
        let (begun, outcomes) = (vec![false; n], vec![None; n]);
        let print = digest(line.as_bytes());
        let notes = Diagnostics::default();
        let at = vec![None; n];
        let mut journal = Self { path, file, print, is_new: true, begun, outcomes, at, notes };
        journal.write(&head.fields())?;
        Ok(journal)
    }

    /// The fingerprint that distinguishes a run of this sweep from all others.
    pub fn print(&self, job: usize) -> String {
        format!("{}-{job}", self.print)
    }

    /// A run begins; on one of several ranks the line has the rank's name.
    ///
    /// # Errors
    /// The line cannot be written.
    pub fn begin(&mut self, job: usize, at: Option<String>) -> Result<()> {
        self.begun[job] = true;
        let line = ["begin".into(), job.to_string()];
        self.write(&line.into_iter().chain(at).collect::<Vec<_>>())
    }

    /// A run has ended.
    ///
    /// # Errors
    /// The line cannot be written.
    pub fn end(&mut self, job: usize, outcome: &Outcome) -> Result<()> {
        self.write(&["end".into(), job.to_string(), join(&outcome.fields())])
    }

    fn write(&mut self, fields: &[String]) -> Result<()> {
        let written = self.file.write_all(seal(fields).as_bytes()).and_then(|()| self.file.sync_data());
        written.map_err(|e| {
            let d = trouble("write", &self.path, &e);
            d.help("runs that are done are kept: the same command continues when the journal can be written")
                .into()
        })
    }
}

/// Removes the folders of the runs of a sweep that is begun anew, as far as its journal lists them.
fn forget_runs(sweep: &Sweep, path: &Path) {
    let Ok(Ok(before)) = std::fs::read(path).map(|bytes| read(path, &bytes)) else { return };
    let Some(head) = before.head else { return };
    for (job, vars) in head.jobs.iter().enumerate().filter(|(job, _)| before.begun[*job]) {
        // A folder that cannot be removed does no harm: a run that needs its place reports it.
        let _ = folder::forget(&sweep.folder.join(folder::name(head.jobs.len(), job, &vars.title())));
    }
}

/// A journal that was read.
struct Read {
    head: Option<Head>,
    begun: Vec<bool>,
    outcomes: Vec<Option<Outcome>>,
    /// The rank at which each run was begun last, where there were several.
    at: Vec<Option<String>>,
    /// Bytes up to the end of the last whole line.
    whole: u64,
    notes: Diagnostics,
}

impl Read {
    /// Whether not even its first line was written.
    fn is_empty(&self) -> bool {
        self.head.is_none()
    }
}

/// Reads a journal. A truncated last line is left out, for it never counted; damage before it is an error.
fn read(path: &Path, bytes: &[u8]) -> Result<Read> {
    let mut out = Read {
        head: None,
        begun: vec![],
        outcomes: vec![],
        at: vec![],
        whole: 0,
        notes: Diagnostics::default(),
    };
    let (mut at, mut damaged) = (0, vec![]);
    for (k, line) in bytes.split_inclusive(|b| *b == b'\n').enumerate() {
        at += line.len() as u64;
        let fields = std::str::from_utf8(line).ok().filter(|l| l.ends_with('\n')).and_then(open);
        let Some(fields) = fields else {
            damaged.push(k + 1);
            continue;
        };
        if out.take(&fields) { out.whole = at } else { damaged.push(k + 1) }
    }
    let lines = bytes.split_inclusive(|b| *b == b'\n').count();
    if out.whole < bytes.len() as u64 && damaged.last() == Some(&lines) {
        damaged.pop();
    }
    for line in damaged {
        let text =
            format!("`{}`, line {line}, is damaged: a run that it recorded is made anew", path.display());
        out.notes.push(Diagnostic::warning(Code::BAD_FILE, None, text));
    }
    if out.head.is_none() && bytes.contains(&b'\n') {
        let text = format!("`{}`, line 1: this is no journal of a sweep, or a damaged one", path.display());
        let d = Diagnostic::error(Code::BAD_FILE, None, text);
        return Err(d.help("`-anew` begins a new sweep there; `-out DIR` puts it elsewhere").into());
    }
    Ok(out)
}

impl Read {
    /// Takes an event in; false if it is none.
    fn take(&mut self, fields: &[String]) -> bool {
        if self.head.is_none() {
            let Some(head) = Head::read(fields) else { return false };
            let n = head.jobs.len();
            (self.begun, self.outcomes, self.at) = (vec![false; n], vec![None; n], vec![None; n]);
            self.head = Some(head);
            return true;
        }
        let job = fields.get(1).and_then(|w| w.parse::<usize>().ok()).filter(|k| *k < self.begun.len());
        match (fields, job) {
            ([what, _, at @ ..], Some(job)) if what == "begin" && at.len() < 2 => {
                (self.begun[job], self.outcomes[job]) = (true, None);
                self.at[job] = at.first().cloned();
            }
            ([what, _, outcome], Some(job)) if what == "end" => {
                let Some(outcome) = Outcome::read(&split(outcome)) else { return false };
                self.outcomes[job] = Some(outcome);
            }
            _ => return false,
        }
        true
    }
}

/// The content of the journal in a folder.
///
/// # Errors
/// A folder without one, and a damaged one.
pub(super) fn look(folder: &Path) -> Result<(Head, Vec<bool>, Vec<Option<Outcome>>)> {
    let path = folder.join(NAME);
    let bytes = std::fs::read(&path).map_err(|e| {
        let d = trouble("read", &path, &e);
        d.help("name the folder of a sweep, as `perigrain sweep in.deck.sweep -status`")
    })?;
    let Read { head, begun, outcomes, .. } = read(&path, &bytes)?;
    let nothing = || {
        let text = format!("`{}` is empty: no run has begun", path.display());
        Diagnostics::from(Diagnostic::error(Code::BAD_FILE, None, text))
    };
    Ok((head.ok_or_else(nothing)?, begun, outcomes))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head() -> Head {
        let job = |v: &str| Job { vars: vec![("v".into(), v.into())] };
        Head {
            version: "1".into(),
            deck: "in.x".into(),
            digest: "a".into(),
            settings: String::new(),
            report: vec!["c_k".into()],
            jobs: vec![job("1"), job("2")],
        }
    }

    fn text() -> String {
        let end = |k: &str, o: &Outcome| seal(&["end".into(), k.into(), join(&o.fields())]);
        seal(&head().fields())
            + &seal(&["begin".into(), "0".into()])
            + &end("0", &Outcome { steps: 7, ..Outcome::default() })
            + &seal(&["begin".into(), "1".into()])
            + &end("1", &Outcome::failed("why", 1.0))
    }

    fn parse(text: &[u8]) -> Result<Read> {
        read(Path::new("j"), text)
    }

    #[test]
    fn a_journal_cut_anywhere_is_read_up_to_its_last_whole_line() {
        let text = text();
        let ends: Vec<usize> = text.match_indices('\n').map(|(k, _)| k + 1).collect();
        for cut in 0..=text.len() {
            let read = parse(&text.as_bytes()[..cut]).unwrap();
            let lines = ends.iter().filter(|e| **e <= cut).count();
            assert_eq!(read.whole as usize, if lines == 0 { 0 } else { ends[lines - 1] }, "{cut}");
            assert_eq!(read.head.is_some(), lines > 0);
            assert_eq!(read.outcomes.iter().flatten().count(), lines.saturating_sub(1) / 2, "{cut}");
            assert!(read.notes.is_empty(), "{cut}");
        }
    }

    #[test]
    fn damage_is_named_with_its_line_and_the_rest_counts() {
        let damaged = text().replacen("end", "eNd", 1);
        let read = parse(damaged.as_bytes()).unwrap();
        assert!(read.notes.0[0].message.contains("line 3"), "{:?}", read.notes);
        assert_eq!(read.notes.0.len(), 1);
        assert!(read.outcomes[0].is_none() && read.outcomes[1].is_some());
        assert_eq!(read.whole as usize, damaged.len());
        assert!(parse(damaged.replacen("sweep", "swEEp", 1).as_bytes()).is_err());
        assert!(parse(b"# my own journal\nsome text\n").is_err());
        let bytes = [text().as_bytes(), b"\xff\xfe"].concat();
        assert!(parse(&bytes).unwrap().notes.is_empty(), "a torn line may hold anything");
    }

    #[test]
    fn differences_are_reported_with_their_place() {
        let old = head();
        let say =
            |new: Head, deck: (&str, &str)| old.difference(&new, (Some(deck.0), deck.1)).unwrap_or_default();
        assert_eq!(say(old.clone(), ("a", "a")), "");
        let changed = Head { digest: "b".into(), ..old.clone() };
        assert_eq!(
            say(changed.clone(), ("a\nb\n", "a\nc\n")),
            "the deck has changed: line 2 was `b`, is `c`"
        );
        assert_eq!(say(changed, ("a\n", "a\nc\n")), "the deck has changed: line 2, `c`, is new");
        let mut jobs = old.jobs.clone();
        jobs[1].vars[0].1 = "3".into();
        assert_eq!(say(Head { jobs, ..old.clone() }, ("", "")), "run 2 is v=2, not v=3");
        assert!(say(Head { report: vec![], ..old.clone() }, ("", "")).contains("reports c_k, not nothing"));
    }
}
