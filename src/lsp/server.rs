//! The state of the server: open texts, files on the disk, the files of each deck; and the checks it has requested.

use super::checks::{Checker, Job, Report};
use super::names::{Index, Kind, Mention, Role};
use super::places::{Text, path_of, uri_of};
use crate::session::{Known, Overlay, absolute, folder_of};
use perigrain_base::gate;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::time::SystemTime;

/// Files within files are followed so far.
const DEEPEST: usize = 20;

/// So many files of a folder are looked into for the deck that includes a file.
const MOST_NEIGHBOURS: usize = 200;

/// A neighbour of more bytes is no deck.
const LARGEST_DECK: u64 = 1 << 20;

/// A text with what is found in it.
#[derive(Debug)]
pub struct File {
    /// Its name, as the client writes it.
    pub uri: String,
    /// Where it lies, if it does.
    pub path: Option<PathBuf>,
    /// The text.
    pub text: Text,
    /// Its lines and names.
    pub index: Index,
}

impl File {
    fn new(uri: String, text: Text) -> Arc<Self> {
        let index = Index::of(text.as_str());
        Arc::new(Self { path: path_of(&uri).map(|path| absolute(&path)), uri, text, index })
    }

    /// The folder for files that it names.
    pub fn folder(&self) -> PathBuf {
        self.path.as_deref().map(folder_of).unwrap_or_default()
    }
}

/// A file that is open in the editor.
struct Open {
    version: Value,
    file: Arc<File>,
}

/// Everything.
pub struct Server {
    open: BTreeMap<String, Open>,
    disk: BTreeMap<PathBuf, (Option<SystemTime>, Arc<File>)>,
    /// By deck.
    reports: BTreeMap<String, Report>,
    /// Files that some other deck was found to include, and that deck.
    parents: BTreeMap<String, String>,
    shown: BTreeSet<String>,
    /// The newest job of each deck.
    numbers: BTreeMap<String, u64>,
    checker: Checker,
    out: Sender<Value>,
}

impl Server {
    /// With nothing open; messages go `out`.
    pub fn new(checker: Checker, out: Sender<Value>) -> Self {
        Self {
            open: BTreeMap::new(),
            disk: BTreeMap::new(),
            reports: BTreeMap::new(),
            parents: BTreeMap::new(),
            shown: BTreeSet::new(),
            numbers: BTreeMap::new(),
            checker,
            out,
        }
    }

    /// Sends a message.
    pub fn send(&self, message: Value) {
        // A client that is gone hears nothing.
        let _ = self.out.send(message);
    }

    /// An open file.
    pub fn opened(&self, uri: &str) -> Option<Arc<File>> {
        self.open.get(uri).map(|open| open.file.clone())
    }

    /// Takes in a file that was opened.
    pub fn open(&mut self, uri: &str, version: Value, text: String) {
        self.put(uri, version, Text::new(text));
        if let Some(parent) = self.includer_of(uri) {
            self.parents.insert(uri.to_string(), parent);
        }
        self.check(uri);
    }

    fn put(&mut self, uri: &str, version: Value, text: Text) {
        self.open.insert(uri.to_string(), Open { version, file: File::new(uri.to_string(), text) });
    }

    /// Makes changes to an open file; one that was never opened is opened by a change of all of it.
    pub fn change(&mut self, uri: &str, version: Value, changes: &[Value]) {
        let old = self.open.remove(uri).map(|open| open.file);
        let text = old.map_or_else(Text::default, |file| file.text.clone());
        self.put(uri, version, text.changed(changes));
        self.check(uri);
    }

    /// Closes a file: the content on the disk counts again.
    pub fn close(&mut self, uri: &str) {
        self.open.remove(uri);
        self.parents.remove(uri);
        if let Some(report) = self.reports.remove(uri) {
            self.show(report.problems.keys().cloned().collect());
        }
        self.numbers.remove(uri);
        if self.decks_of(uri).iter().any(|deck| deck != uri) {
            self.check(uri);
        }
    }

    /// Requests checks of the decks that an open file is part of.
    pub fn check(&mut self, uri: &str) {
        for deck in self.decks_of(uri) {
            let Some(file) = self.file_of(&deck) else { continue };
            let texts = self.open.values().filter_map(|open| {
                let path = open.file.path.clone()?;
                Some((path, Arc::from(open.file.text.as_str())))
            });
            let overlay = Overlay::new(texts.collect());
            let number = self.numbers.entry(deck.clone()).or_default();
            *number += 1;
            self.checker.queue(Job {
                uri: deck,
                number: *number,
                text: file.text.as_str().to_string(),
                overlay,
            });
        }
    }

    /// The decks that read a file as lines of theirs; itself if there is none.
    fn decks_of(&self, uri: &str) -> Vec<String> {
        let path = path_of(uri).map(|path| absolute(&path));
        let reads = |report: &&Report| path.as_ref().is_some_and(|path| report.included.contains(path));
        let mut decks: Vec<String> = self.reports.values().filter(reads).map(|r| r.uri.clone()).collect();
        decks.extend(self.parents.get(uri).filter(|parent| !decks.contains(parent)).cloned());
        decks.retain(|deck| deck != uri);
        if decks.is_empty() { vec![uri.to_string()] } else { decks }
    }

    /// A file, open or not.
    fn file_of(&self, uri: &str) -> Option<Arc<File>> {
        self.opened(uri).or_else(|| read(&path_of(uri)?))
    }

    /// A deck in the same folder that includes a file.
    fn includer_of(&self, uri: &str) -> Option<String> {
        let path = path_of(uri)?;
        let name = path.file_name()?.to_string_lossy().into_owned();
        let mut neighbours: Vec<PathBuf> =
            gate::list(path.parent()?).ok()?.flatten().map(|e| e.path()).collect();
        neighbours.sort();
        let is_deck = |path: &&PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with("in.")
                || [".in", ".lmp", ".lammps", ".perigrain"].iter().any(|end| name.ends_with(end))
        };
        let small = |path: &&PathBuf| path.metadata().is_ok_and(|m| m.is_file() && m.len() < LARGEST_DECK);
        let decks = neighbours.iter().filter(|other| **other != path).filter(is_deck).filter(small);
        let found = decks.take(MOST_NEIGHBOURS).find(|other| {
            let text = gate::read(other)
                .map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
                .unwrap_or_default();
            let names = |line: &str| {
                let mut words = line.split_whitespace();
                words.next() == Some("include")
                    && words.next().is_some_and(|w| w.trim_matches(['"', '\'']) == name)
            };
            text.lines().any(names)
        })?;
        // An open deck keeps the name that the client has given it.
        let found = absolute(found);
        let known = self.open.values().find(|open| open.file.path.as_ref() == Some(&found));
        Some(known.map_or_else(|| uri_of(&found), |open| open.file.uri.clone()))
    }

    /// Takes the results of a check, and sends them to the client.
    pub fn take(&mut self, report: Report) {
        if self.numbers.get(&report.uri) != Some(&report.number) {
            // The text is another one by now.
            return;
        }
        let uri_of_open: BTreeMap<&PathBuf, &String> =
            self.open.iter().filter_map(|(uri, open)| Some((open.file.path.as_ref()?, uri))).collect();
        let mut report = report;
        // Names of files become those of the client.
        let named = std::mem::take(&mut report.problems).into_iter().map(|(uri, problems)| {
            let path = path_of(&uri).map(|path| absolute(&path));
            let uri = path.and_then(|path| uri_of_open.get(&path).map(|uri| (*uri).clone())).unwrap_or(uri);
            (uri, problems)
        });
        report.problems = named.collect();
        let mut concerned: BTreeSet<String> = report.problems.keys().cloned().collect();
        if let Some(old) = self.reports.remove(&report.uri) {
            concerned.extend(old.problems.into_keys());
        }
        for uri in report.problems.keys().filter(|uri| **uri != report.uri) {
            // A file that belongs to a deck is no deck of its own.
            if let Some(own) = self.reports.remove(uri) {
                concerned.extend(own.problems.into_keys());
            }
        }
        self.reports.insert(report.uri.clone(), report);
        self.show(concerned);
    }

    fn show(&mut self, files: BTreeSet<String>) {
        for uri in files {
            let mut all: Vec<Value> = vec![];
            for problem in self.problems(&uri) {
                if !all.contains(problem) {
                    all.push(problem.clone());
                }
            }
            let known = self.open.get(&uri);
            if all.is_empty() && known.is_none() && !self.shown.remove(&uri) {
                continue;
            }
            if !all.is_empty() {
                self.shown.insert(uri.clone());
            }
            let version = known.map_or(Value::Null, |open| open.version.clone());
            let mut params = json!({"uri": uri, "diagnostics": all});
            if version.is_i64() {
                params["version"] = version;
            }
            self.send(
                json!({"jsonrpc": "2.0", "method": "textDocument/publishDiagnostics", "params": params}),
            );
        }
    }

    /// What is known to be wrong with a file.
    pub fn problems<'a>(&'a self, uri: &'a str) -> impl Iterator<Item = &'a Value> {
        self.reports.values().filter_map(move |report| report.problems.get(uri)).flatten()
    }

    /// A file that another one names, open or on the disk.
    pub fn named(&mut self, name: &str, from: &File) -> Option<Arc<File>> {
        let beside = absolute(&from.folder().join(name));
        let plain = absolute(Path::new(name));
        for path in [&beside, &plain] {
            if let Some(open) = self.open.values().find(|open| open.file.path.as_ref() == Some(path)) {
                return Some(open.file.clone());
            }
        }
        [beside, plain].into_iter().find_map(|path| self.on_disk(&path))
    }

    /// A file on the disk; it is read anew when it has changed.
    fn on_disk(&mut self, path: &Path) -> Option<Arc<File>> {
        let meta = path.metadata().ok().filter(|m| m.is_file() && m.len() < LARGEST_DECK)?;
        let time = meta.modified().ok();
        if let Some((_, file)) = self.disk.get(path).filter(|(known, _)| time.is_some() && *known == time) {
            return Some(file.clone());
        }
        let file = read(path)?;
        self.disk.insert(path.to_path_buf(), (time, file.clone()));
        Some(file)
    }

    /// The files of the deck that a file belongs to, each once, in the order in which they are read.
    pub fn family(&mut self, file: &Arc<File>) -> Vec<Arc<File>> {
        let mut all = vec![];
        for uri in self.decks_of(&file.uri) {
            if let Some(deck) = self.file_of(&uri) {
                self.gather(&deck, 0, &mut all);
            }
        }
        if !all.iter().any(|other| other.uri == file.uri) {
            all.push(file.clone());
        }
        all
    }

    fn gather(&mut self, file: &Arc<File>, depth: usize, all: &mut Vec<Arc<File>>) {
        if depth > DEEPEST || all.iter().any(|other| other.uri == file.uri) {
            return;
        }
        all.push(file.clone());
        for mention in file.index.mentions.iter().filter(|m| m.kind == Kind::File) {
            if let Some(next) = self.named(&mention.name, file) {
                self.gather(&next, depth + 1, all);
            }
        }
    }

    /// The names that exist above a byte of a file, through all that its deck includes before.
    pub fn known(&mut self, file: &Arc<File>, byte: usize) -> Known {
        let mut above = Above { known: Known::default(), until: (file.uri.clone(), byte), done: false };
        above.known.groups.push("all".into());
        for uri in self.decks_of(&file.uri) {
            if let Some(deck) = self.file_of(&uri).filter(|_| !above.done) {
                self.walk(&deck, &mut vec![], &mut above);
            }
        }
        if !above.done {
            self.walk(file, &mut vec![], &mut above);
        }
        // A label may stand below.
        above.known.labels = file
            .index
            .mentions
            .iter()
            .filter(|m| m.kind == Kind::Label && m.role == Role::Defines)
            .map(|m| m.name.clone())
            .collect();
        above.known
    }

    fn walk(&mut self, file: &Arc<File>, path: &mut Vec<String>, above: &mut Above) {
        if path.len() > DEEPEST || path.contains(&file.uri) {
            return;
        }
        path.push(file.uri.clone());
        let here = file.uri == above.until.0;
        for mention in &file.index.mentions {
            if above.done || (here && mention.bytes.end >= above.until.1) {
                break;
            }
            match mention.kind {
                Kind::File => {
                    let includes = file
                        .index
                        .word_at(mention.bytes.start)
                        .is_some_and(|(words, _)| words[0].text == "include");
                    if let Some(next) = self.named(&mention.name, file).filter(|_| includes) {
                        self.walk(&next, path, above);
                    }
                }
                _ => above.take(mention),
            }
        }
        above.done |= here;
        if !above.done || here {
            let end = if here { above.until.1 } else { usize::MAX };
            above.pair(file, end);
        }
        path.pop();
    }
}

/// Names gathered on the way down to a place.
struct Above {
    known: Known,
    until: (String, usize),
    done: bool,
}

impl Above {
    fn take(&mut self, mention: &Mention) {
        let Some(list) = mention.kind.list(&mut self.known) else { return };
        match mention.role {
            Role::Defines if !list.contains(&mention.name) => list.push(mention.name.clone()),
            Role::Deletes => list.retain(|name| *name != mention.name),
            _ => {}
        }
    }

    /// The pair style above a byte.
    fn pair(&mut self, file: &File, end: usize) {
        let lines = file.index.lines.iter().take_while(|line| (line.span.start as usize) < end);
        let styles = lines.filter(|line| line.words.first().is_some_and(|w| w.text == "pair_style"));
        if let Some(style) = styles.filter_map(|line| line.words.get(1)).last() {
            self.known.pair = Some(style.text.clone());
        }
    }
}

/// A file from the disk; bytes that are no text become the replacement character.
fn read(path: &Path) -> Option<Arc<File>> {
    let bytes = gate::read(path).ok()?;
    Some(File::new(uri_of(path), Text::new(String::from_utf8_lossy(&bytes).into_owned())))
}
