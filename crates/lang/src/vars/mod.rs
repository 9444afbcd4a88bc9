//! The variable table: what there is, what has changed, and `next`.

mod bonds;
mod define;
mod files;
mod hash;
mod moving;
mod partition;
pub mod python;
mod text;

use super::expr::Expr;
use files::{AtomFile, Lines};
use perigrain_base::diag::{Code, Diagnostic, FileId, Result, Span, fail, nearest};
use perigrain_base::math::rng::Marsaglia;
use perigrain_base::math::scatter::mixed;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

pub use bonds::{BOND_WORDS, Bonds};
pub(super) use moving::Next;
pub use partition::{Partition, Turn};
pub(super) use text::Text;

/// The style of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// `index`: a list of texts.
    Index,
    /// `loop`: a run of whole numbers.
    Loop,
    /// `world`: one text per partition.
    World,
    /// `universe`: a list of texts that partitions share.
    Universe,
    /// `uloop`: a run of whole numbers that partitions share.
    Uloop,
    /// `string`: one text.
    Text,
    /// `getenv`: an environment variable.
    Getenv,
    /// `file`: the lines of a file, one after the other.
    File,
    /// `atomfile`: sets of values per particle from a file.
    Atomfile,
    /// `format`: a number of another variable in a C format.
    Format,
    /// `equal`: a formula that yields a number.
    Equal,
    /// `atom`: a formula that yields one number per particle.
    Atom,
    /// `vector`: a formula that yields a global vector.
    Vector,
    /// `bond`: a formula that yields one number per peridynamic bond.
    Bond,
    /// `timer`: the moment of its definition.
    Timer,
    /// `internal`: a number that commands set.
    Internal,
    /// `python`: what a function of the program that hosts the session gives.
    Python,
}

impl Kind {
    /// The style as written in a deck.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Index => "index",
            Kind::Loop => "loop",
            Kind::World => "world",
            Kind::Universe => "universe",
            Kind::Uloop => "uloop",
            Kind::Text => "string",
            Kind::Getenv => "getenv",
            Kind::File => "file",
            Kind::Atomfile => "atomfile",
            Kind::Format => "format",
            Kind::Equal => "equal",
            Kind::Atom => "atom",
            Kind::Vector => "vector",
            Kind::Bond => "bond",
            Kind::Timer => "timer",
            Kind::Internal => "internal",
            Kind::Python => "python",
        }
    }

    /// Whether it holds one value per particle.
    pub fn per_particle(self) -> bool {
        matches!(self, Kind::Atom | Kind::Atomfile)
    }

    /// Whether a line that defines it again is passed over, as LAMMPS does.
    fn stays(self) -> bool {
        matches!(
            self,
            Kind::Index
                | Kind::Loop
                | Kind::World
                | Kind::Universe
                | Kind::Uloop
                | Kind::File
                | Kind::Atomfile
        )
    }

    /// Whether partitions take its values in turn.
    fn is_shared(self) -> bool {
        matches!(self, Kind::Universe | Kind::Uloop)
    }

    /// Whether `next` can move it.
    fn moves(self) -> bool {
        self.stays() && self != Kind::World
    }
}

/// What a variable holds.
#[derive(Clone, Debug)]
enum Data {
    List { values: Arc<[String]>, at: usize },
    Range { now: i64, last: i64, width: usize },
    Text(String),
    Getenv(String),
    Lines(Lines),
    Atoms(AtomFile),
    Format { name: String, format: String },
    Formula(Arc<Expr>),
    Number(f64),
    Python(String),
}

#[derive(Clone, Debug)]
struct Variable {
    kind: Kind,
    data: Data,
    /// Where it was defined; nowhere if on the command line.
    span: Option<Span>,
    /// Only a run determines its value (`check` and `plan`).
    unknown: bool,
    /// Only a run determines which line has set or moved it last, or whether one has deleted it.
    adrift: bool,
    /// When it was defined, in lines that set variables.
    born: u64,
    /// When it was set or moved last.
    set: u64,
    /// A hash of its name and definition, the position in a list left out.
    print: u64,
}

impl Variable {
    fn new(kind: Kind, data: Data) -> Self {
        Self { kind, data, span: None, unknown: false, adrift: false, born: 0, set: 0, print: 0 }
    }
}

/// All variables of a session. A copy is cheap and shares its random streams and open files with the original.
#[derive(Clone, Debug, Default)]
pub struct Vars {
    table: Arc<BTreeMap<String, Variable>>,
    /// What `random` and `normal` draw from: one stream for numbers, one for values per particle.
    streams: Arc<Mutex<Streams>>,
    /// Formulas by place, so that a loop parses each of them once.
    formulas: Arc<Mutex<Parsed>>,
    /// Counts what formulas change by being evaluated: random numbers drawn, files read on.
    events: Arc<AtomicU64>,
    /// Environment variables set by `shell putenv`.
    environment: Arc<BTreeMap<String, String>>,
    /// Which of several partitions runs the deck, if there are several.
    partition: Option<Partition>,
    /// The program that has functions in Python, if one hosts the session.
    program: Option<Arc<dyn python::Functions>>,
    /// Which of its functions are known, and what they are given.
    known: Arc<BTreeMap<String, python::Function>>,
    /// The sum of all variables' hashes.
    state: u64,
    /// Counts changes of names and styles.
    names: u64,
    /// Counts lines that set or move variables.
    sets: u64,
}

/// Formulas by file, first and last byte.
type Parsed = BTreeMap<(FileId, u32, u32), Arc<Expr>>;

/// The streams of `random` and `normal`, once their first use has seeded them.
pub(super) type Streams = [Option<Marsaglia>; 2];

impl Vars {
    /// No variables.
    pub fn new() -> Self {
        Self::default()
    }

    /// From now on this is one of several partitions.
    pub fn set_partition(&mut self, partition: Option<Partition>) {
        self.partition = partition;
    }

    /// The number of this partition, from 0, and how many there are.
    pub fn partition(&self) -> (usize, usize) {
        self.partition.as_ref().map_or((0, 1), |p| (p.number, p.of))
    }

    /// A copy that shares nothing with this table: its random streams and files stand where these stand now.
    pub fn detached(&self) -> Self {
        let streams = Arc::new(Mutex::new(self.streams().clone()));
        let mut copy = Self { streams, ..self.clone() };
        Arc::make_mut(&mut copy.table).values_mut().for_each(Variable::detach);
        copy
    }

    /// The random streams, about to be drawn from.
    pub(super) fn streams(&self) -> MutexGuard<'_, Streams> {
        self.event();
        self.streams.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes that evaluating a formula has changed something, or depends on the moment.
    pub(super) fn event(&self) {
        self.events.fetch_add(1, Ordering::Relaxed);
    }

    /// A number that stays the same as long as no variable, stream or file has changed.
    pub(super) fn fingerprint(&self) -> u64 {
        let events = self.events.load(Ordering::Relaxed);
        self.state ^ mixed(events)
    }

    /// A number that stays the same as long as the same variables of the same styles exist.
    pub fn names_version(&self) -> u64 {
        self.names
    }

    /// The formula `text` at `at`, parsed at its first use.
    pub(super) fn formula(&self, text: &str, at: Span) -> Result<Arc<Expr>> {
        let mut known = self.formulas.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (at.file, at.start, at.end);
        if let Some(e) = known.get(&key).filter(|e| e.text() == text) {
            return Ok(e.clone());
        }
        let e = Arc::new(Expr::parse(text, at)?);
        known.insert(key, e.clone());
        Ok(e)
    }

    fn find(&self, name: &str) -> Option<&Variable> {
        self.table.get(name).filter(|v| !v.exhausted())
    }

    /// The style of a variable.
    pub fn kind(&self, name: &str) -> Option<Kind> {
        self.find(name).map(|v| v.kind)
    }

    /// The formula of an equal-, vector- or atom-style variable.
    pub fn expr(&self, name: &str) -> Option<&Expr> {
        match &self.find(name)?.data {
            Data::Formula(e) => Some(e),
            _ => None,
        }
    }

    /// The variable that a format-style variable shows.
    pub fn formatted(&self, name: &str) -> Option<&str> {
        match &self.table.get(name)?.data {
            Data::Format { name, .. } => Some(name),
            _ => None,
        }
    }

    /// Where a variable was defined; `None` also if on the command line.
    pub fn span(&self, name: &str) -> Option<Span> {
        self.find(name)?.span
    }

    /// All names, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.table.iter().filter(|(_, v)| !v.exhausted()).map(|(n, _)| n.as_str())
    }

    /// `-var name value …`: an index variable that wins over the deck's own.
    pub fn set_index(&mut self, name: &str, values: &[String]) -> Result<()> {
        if !is_name(name) {
            return Err(bad_name(name).into());
        }
        if values.is_empty() {
            return fail(Code::MISSING_ARGUMENT, None, format!("variable `{name}` needs at least one value"));
        }
        if self.find(name).is_none() {
            self.put(name, Variable::new(Kind::Index, Data::List { values: values.into(), at: 0 }));
        }
        Ok(())
    }

    /// `shell putenv`: what `getenv` sees from now on.
    pub fn set_environment(&mut self, key: &str, value: &str) {
        Arc::make_mut(&mut self.environment).insert(key.to_owned(), value.to_owned());
        self.event();
    }

    /// The environment variables set by the deck.
    pub fn environment(&self) -> &BTreeMap<String, String> {
        &self.environment
    }

    /// `clear` removes values per particle read from files.
    pub fn clear_atomfiles(&mut self) {
        let gone: Vec<String> =
            self.table.iter().filter(|(_, v)| v.kind == Kind::Atomfile).map(|(n, _)| n.clone()).collect();
        gone.iter().for_each(|n| self.remove(n));
    }

    /// How many lines have set or moved variables so far.
    pub(super) fn sets(&self) -> u64 {
        self.sets
    }

    /// Whether only a run determines if there is such a variable, or which line has set it.
    pub(super) fn is_adrift(&self, name: &str) -> bool {
        self.table.get(name).is_some_and(|v| v.adrift)
    }

    /// Whether `next` has brought a variable to a further value behind the moment `since` that was defined before it.
    pub(super) fn moved_since(&self, since: u64) -> bool {
        self.table.values().any(|v| v.turns_known() && v.set > since && v.born <= since)
    }

    /// Marks a variable's value as unknown: only a run determines whether a line that sets it is reached.
    pub(super) fn set_adrift(&mut self, name: &str) {
        let Some(old) = self.table.get(name) else { return };
        let new = Variable { unknown: true, adrift: true, ..old.clone() };
        self.put(name, new);
    }

    /// Marks the values of all variables as unknown that lines after the moment `since` have set or moved.
    pub(super) fn set_adrift_since(&mut self, since: u64) {
        let names: Vec<String> =
            self.table.iter().filter(|(_, v)| v.set > since).map(|(n, _)| n.clone()).collect();
        names.iter().for_each(|n| self.set_adrift(n));
    }

    /// Marks the numbers of all internal-style variables as unknown: a run that is only checked may have set them.
    pub fn forget_internal(&mut self) {
        let names: Vec<String> =
            self.table.iter().filter(|(_, v)| v.kind == Kind::Internal).map(|(n, _)| n.clone()).collect();
        names.iter().for_each(|n| self.set_adrift(n));
    }

    /// Sets the number of an internal-style variable.
    pub fn set_internal(&mut self, name: &str, value: f64) -> bool {
        let Some(old) = self.find(name).filter(|v| v.kind == Kind::Internal) else { return false };
        let new = Variable { data: Data::Number(value), unknown: false, adrift: false, ..old.clone() };
        self.put(name, new);
        true
    }

    /// Sets the text of a string-style variable.
    pub fn set_text(&mut self, name: &str, text: &str) -> bool {
        let Some(old) = self.find(name).filter(|v| v.kind == Kind::Text) else { return false };
        let new =
            Variable { data: Data::Text(text.to_string()), unknown: false, adrift: false, ..old.clone() };
        self.put(name, new);
        true
    }

    /// As [`Vars::put`], for a line of the deck.
    fn put_line(&mut self, name: &str, variable: Variable) {
        self.sets += 1;
        self.put(name, Variable { born: self.sets, set: self.sets, ..variable });
    }

    fn put(&mut self, name: &str, variable: Variable) {
        let variable = variable.named(name);
        let kind = variable.kind;
        self.state = self.state.wrapping_add(variable.state());
        let old = match Arc::make_mut(&mut self.table).get_mut(name) {
            Some(place) => Some(std::mem::replace(place, variable)),
            None => Arc::make_mut(&mut self.table).insert(name.to_owned(), variable),
        };
        match old {
            Some(old) => {
                self.state = self.state.wrapping_sub(old.state());
                self.names += u64::from(old.kind != kind);
            }
            None => self.names += 1,
        }
    }

    fn remove(&mut self, name: &str) {
        if let Some(old) = Arc::make_mut(&mut self.table).remove(name) {
            self.state = self.state.wrapping_sub(old.state());
            self.names += 1;
        }
    }

    fn unknown(&self, name: &str, span: Span) -> Diagnostic {
        let d = Diagnostic::error(Code::UNKNOWN_VARIABLE, span, format!("variable `{name}` is not defined"));
        match nearest(name, self.names()) {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None => d,
        }
    }
}

fn is_name(name: &str) -> bool {
    !name.is_empty() && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

fn bad_name(name: &str) -> Diagnostic {
    Diagnostic::error(Code::BAD_VALUE, None, format!("`{name}` cannot name a variable"))
        .help("letters, digits and underscores only")
}
