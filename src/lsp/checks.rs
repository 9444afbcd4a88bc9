//! Checks beside the requests: one thread makes them, of the newest text of each deck alone.

use super::places::{Text, path_of, uri_of};
use crate::session::whole::{Checked, check};
use crate::session::{Options, Overlay, absolute, folder_of};
use perigrain_base::diag::{CODES, Diagnostic, FileId, Severity, Sources, Span};
use perigrain_base::par::STACK;
use perigrain_world::reading::place;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// A text is checked when nothing has been typed for so long.
const PAUSE: Duration = Duration::from_millis(80);

/// A deck to be checked.
#[derive(Clone, Debug)]
pub struct Job {
    /// The deck.
    pub uri: String,
    /// Its text.
    pub text: String,
    /// The number of this job: later ones are newer.
    pub number: u64,
    /// Texts of open files, which count in place of those on the disk.
    pub overlay: Overlay,
}

/// What a check has found.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// The deck.
    pub uri: String,
    /// The job's.
    pub number: u64,
    /// The problems as the protocol has them, by the URIs of the files they stand in; the deck is always among them.
    pub problems: BTreeMap<String, Vec<Value>>,
    /// The other files that were read as lines of the deck.
    pub included: Vec<PathBuf>,
}

type Running = Arc<Mutex<Option<(String, Arc<AtomicBool>)>>>;

/// The thread's other end.
pub struct Checker {
    jobs: Sender<Job>,
    running: Running,
}

impl Checker {
    /// Starts the thread; `publish` receives the reports.
    pub fn new(publish: impl Fn(Report) + Send + 'static) -> Self {
        let (jobs, queue) = channel();
        let running = Running::default();
        let own = running.clone();
        let thread = std::thread::Builder::new().stack_size(STACK);
        // Without a thread more there are no messages; all else is answered.
        let _ = thread.spawn(move || work(&queue, &own, &publish));
        Self { jobs, running }
    }

    /// Queues a check; one of an older text of the same deck is given up.
    pub fn queue(&self, job: Job) {
        let running = self.running.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, stop)) = running.as_ref().filter(|(uri, _)| *uri == job.uri) {
            stop.store(true, Ordering::Relaxed);
        }
        drop(running);
        // The thread ends with the program only.
        let _ = self.jobs.send(job);
    }
}

fn work(queue: &Receiver<Job>, running: &Running, publish: &dyn Fn(Report)) {
    let mut waiting: Vec<Job> = vec![];
    loop {
        if waiting.is_empty() {
            let Ok(job) = queue.recv() else { return };
            waiting.push(job);
        }
        while let Ok(job) = queue.recv_timeout(PAUSE) {
            waiting.retain(|other| other.uri != job.uri);
            waiting.push(job);
        }
        let job = waiting.remove(0);
        let stale = Arc::new(AtomicBool::new(false));
        let set = |now| *running.lock().unwrap_or_else(PoisonError::into_inner) = now;
        set(Some((job.uri.clone(), stale.clone())));
        let found = catch_unwind(AssertUnwindSafe(|| report(&job, &stale)));
        set(None);
        if !stale.load(Ordering::Relaxed) {
            publish(found.unwrap_or_else(|_| broken(&job)));
        }
    }
}

/// The report where the check itself has failed.
fn broken(job: &Job) -> Report {
    let text = "perigrain failed at this text, which it should not, whatever the text: please report it";
    let start = json!({"line": 0, "character": 0});
    let problem = json!({"range": {"start": start, "end": start}, "severity": 1, "source": "perigrain", "message": text});
    Report {
        uri: job.uri.clone(),
        number: job.number,
        problems: [(job.uri.clone(), vec![problem])].into(),
        included: vec![],
    }
}

/// Checks a deck as `perigrain check` does.
pub fn report(job: &Job, stale: &Arc<AtomicBool>) -> Report {
    let path = path_of(&job.uri);
    let folder = path.as_deref().map(folder_of).unwrap_or_default();
    let name = path.as_deref().map_or_else(|| job.uri.clone(), |path| path.display().to_string());
    let options = Options { folder: folder.clone(), overlay: job.overlay.clone(), ..Options::default() };
    let Checked { sources, problems } = check(&options, &name, &job.text, stale);
    let uri = |source: &str| match source == name {
        true => job.uri.clone(),
        false => uri_of(&absolute(&found_at(source, &folder, &job.overlay))),
    };
    let mut report = Report { uri: job.uri.clone(), number: job.number, ..Report::default() };
    report.problems.insert(job.uri.clone(), vec![]);
    let all = (0..).map_while(|k| sources.get(FileId(k)));
    for source in all.filter(|source| source.name != name) {
        let path = absolute(&found_at(&source.name, &folder, &job.overlay));
        report.problems.insert(uri_of(&path), vec![]);
        report.included.push(path);
    }
    let mut texts = Texts { sources: &sources, texts: BTreeMap::new() };
    for problem in &problems.0 {
        let at =
            problem.span.and_then(|span| sources.get(span.file)).map_or(job.uri.clone(), |s| uri(&s.name));
        let shown = shown(problem, &mut texts, &uri);
        report.problems.entry(at).or_default().push(shown);
    }
    report
}

/// Where a file is that a deck names, on the disk or in an editor.
fn found_at(name: &str, folder: &Path, overlay: &Overlay) -> PathBuf {
    let beside = absolute(&folder.join(name));
    if overlay.get(&beside).is_some() { beside } else { place(name, folder) }
}

/// Texts of sources with their lines, each made once.
struct Texts<'a> {
    sources: &'a Sources,
    texts: BTreeMap<u32, Text>,
}

impl Texts<'_> {
    fn range(&mut self, span: Option<Span>) -> Value {
        let Some(source) = span.and_then(|span| self.sources.get(span.file)) else {
            return json!({"start": {"line": 0, "character": 0}, "end": {"line": 0, "character": 0}});
        };
        let span = span.unwrap_or_default();
        let text = self.texts.entry(span.file.0).or_insert_with(|| Text::new(source.text.clone()));
        text.range(span.start as usize..span.end as usize)
    }
}

/// A problem as the protocol has it. Help stands in the message, and in `data` for quick fixes.
fn shown(d: &Diagnostic, texts: &mut Texts<'_>, uri: &dyn Fn(&str) -> String) -> Value {
    let severity = match d.severity {
        Severity::Error => 1,
        Severity::Warning => 2,
        Severity::Note => 3,
    };
    let message = d.help.iter().fold(d.message.clone(), |text, help| format!("{text}\nhelp: {help}"));
    let related: Vec<Value> = d
        .labels
        .iter()
        .filter_map(|label| {
            let name = texts.sources.get(label.span.file)?.name.clone();
            let location = json!({"uri": uri(&name), "range": texts.range(Some(label.span))});
            Some(json!({"location": location, "message": label.text}))
        })
        .collect();
    // Editors draw what can be left out in grey.
    let unnecessary = ["PG0119", "PG0120"].contains(&d.code.to_string().as_str());
    json!({
        "range": texts.range(d.span),
        "severity": severity,
        "code": d.code.to_string(),
        "source": "perigrain",
        "message": message,
        "relatedInformation": related,
        "tags": if unnecessary { json!([1]) } else { json!([]) },
        "data": {"help": d.help},
    })
}

/// The story behind a code, as Markdown.
pub fn explained(code: &str) -> Option<String> {
    let kind = CODES.iter().find(|kind| kind.code.to_string() == code)?;
    let mut text = format!("**{code}: {}**\n\n{}\n", kind.title, kind.text);
    for (what, lines) in [("Wrong", kind.wrong), ("Right", kind.right)] {
        if !lines.is_empty() {
            text += &format!("\n{what}:\n\n```perigrain\n{lines}\n```\n");
        }
    }
    Some(text)
}
