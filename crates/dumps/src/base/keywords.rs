//! The keywords of `dump_modify` shared by all dumps.

use super::{Base, Rhythm, Sort, Threshold};
use crate::attribute::attribute;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail};
use perigrain_lang::args::blame;
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_styles::words::{
    Alternative, At, Grammar, Kind, Or, Part, Reference, Value, Words, alternatives,
};
use perigrain_styles::{BuildCx, UseKind};
use perigrain_world::{Key, Region};

/// LAMMPS' keywords that no style here accepts, with the reason.
const ELSEWHERE: &[(&str, &str)] = &[
    ("at", "is for dump styles that perigrain does not have"),
    ("compression_level", "is for the styles atom/gz, custom/gz, cfg/gz, xyz/gz and local/gz"),
    ("sfactor", "is for dump xtc, which perigrain does not have"),
    ("tfactor", "is for dump xtc, which perigrain does not have"),
    ("precision", "is for dump xtc, which perigrain does not have"),
    ("unwrap", "is for dumps dcd and xtc, which perigrain does not have: dump xu yu zu"),
    ("thermo", "is for dump yaml"),
    ("triclinic/general", "is for general triclinic boxes, which perigrain does not have"),
    ("header", "is for text dumps"),
    ("label", "is for dump local"),
];

/// The keywords of `dump_modify` that every dump has: files and times.
#[derive(Words)]
pub struct Common {
    /// Snapshots stand behind what an existing file holds.
    #[word(keyword)]
    append: Option<bool>,
    /// Read and without effect: one process writes the file.
    #[word(keyword, what = "balance", placed)]
    balance: Option<At<bool>>,
    /// Read and without effect: snapshots are handed over whole.
    #[word(keyword, what = "buffer")]
    buffer: Option<bool>,
    /// How tightly a style `…/gz` packs: from 0 (not at all) and 1 (fast) to 9, or −1 for the usual one, 6.
    #[word(keyword, name = "N", placed)]
    compression_level: Option<At<Level>>,
    /// Nothing is written before this step.
    #[word(keyword, name = "N", what = "the first step to write")]
    delay: Option<i64>,
    /// The interval in steps, or a variable that names the next step.
    #[word(keyword, name = "N", what = "the dump's interval", placed)]
    every: Option<At<Or<Reference, Interval>>>,
    /// Snapshots at multiples of a time, or a variable that names the next time when a run begins and after each snapshot.
    #[word(keyword = "every/time", name = "T", what = "the time between snapshots", placed)]
    every_time: Option<At<Or<Reference, Period>>>,
    /// Without effect: one process writes one file; needs a `%` in the file name.
    #[word(keyword, name = "N", what = "the number of files or processes", from = 1, placed)]
    fileper: Option<At<i64>>,
    /// Also the first step of the first run is written.
    #[word(keyword, what = "first")]
    first: Option<bool>,
    /// Read and without effect: snapshots are handed over whole.
    #[word(keyword, what = "flush")]
    flush: Option<bool>,
    /// The last N of the files of single snapshots are kept; −1 keeps all.
    #[word(keyword, name = "N", placed)]
    maxfiles: Option<At<MaxFiles>>,
    /// Without effect: one process writes one file; needs a `%` in the file name.
    #[word(keyword, name = "N", what = "the number of files or processes", from = 1, placed)]
    nfile: Option<At<i64>>,
    /// Digits of the step in file names.
    #[word(keyword, name = "N", what = "the number of digits", from = 0)]
    pad: Option<usize>,
    /// No snapshot while this variable is not zero.
    #[word(keyword, name = "v_name")]
    skip: Option<Reference>,
    /// Rows by id, in the order of storage, or by a column, with −N in descending order.
    #[word(keyword, name = "N", what = "`off`, `id` or a column")]
    sort: Option<At<Or<Order, Column>>>,
    /// `no` alone: boxes are never general triclinic ones.
    #[word(keyword = "triclinic/general")]
    general: Option<Upright>,
    /// `numeric` alone: types have no labels.
    #[word(keyword, name = "numeric")]
    types: Option<Numeric>,
}

/// A name for each type.
const NAMES: Kind = Kind::Words(&Grammar {
    parts: &[Part::Many(&[Part::bare("NAME", Kind::Text)], 1)],
    keywords: &[],
    refused: &[],
});

/// The keywords of `dump_modify` that dumps of particles have.
#[derive(Words)]
pub struct OfParticles {
    /// One name for each type, for the attribute `element`.
    #[word(keyword, name = "names", with = names, kind = NAMES)]
    element: Option<Vec<String>>,
    /// Positions are wrapped into the box first.
    #[word(keyword, what = "pbc")]
    pbc: Option<bool>,
    /// See compute displace/atom.
    #[word(keyword, name = "c_ID", with = refresh, kind = Kind::Value)]
    refresh: Option<String>,
    /// Only particles in this region are written.
    #[word(keyword, name = "ID")]
    pub region: Option<Or<Nothing, Key<Region>>>,
    /// Only particles whose attribute passes are written; several must all hold. LAST is the particle's value at the last snapshot.
    #[word(keyword, name = "test")]
    pub thresh: Vec<Or<Nothing, Test>>,
}

/// What is taken back.
#[derive(Words)]
pub enum Nothing {
    None,
}

/// A condition on particles.
#[derive(Words)]
pub struct Test {
    #[word(name = "attribute", what = "a particle attribute or `none`", kind = Kind::Attribute)]
    attribute: Word,
    operator: Operator,
    #[word(name = "value", what = "the threshold")]
    value: Or<Last, f64>,
}

/// The value at the last snapshot.
#[derive(Words)]
enum Last {
    #[word("LAST")]
    Last,
}

/// A comparison.
struct Operator(Comparison);

/// Whether a value compares so with a threshold.
type Comparison = fn(f64, f64) -> bool;

const OPERATORS: [(&str, Comparison); 7] = [
    ("<", |a, b| a < b),
    ("<=", |a, b| a <= b),
    (">", |a, b| a > b),
    (">=", |a, b| a >= b),
    ("==", |a, b| a == b),
    ("!=", |a, b| a != b),
    ("|^", |a, b| (a != 0.0) != (b != 0.0)),
];

const SIGNS: &[Alternative] = &alternatives(&OPERATORS);

impl Value for Operator {
    const KIND: Kind = Kind::Choice(SIGNS);
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let word = args.expect("an operator: < <= > >= == !=")?;
        match OPERATORS.iter().find(|o| o.0 == word.text) {
            Some((_, compare)) => Ok(Self(*compare)),
            None => {
                let d = blame(word, Code::BAD_VALUE, format!("`{}` compares nothing", word.text));
                Err(d.help("use one of < <= > >= == !=").into())
            }
        }
    }
}

/// A number of steps.
struct Interval(i64);

impl Value for Interval {
    const KIND: Kind = Kind::Whole;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.integer_from(1, what).map(Self)
    }
}

/// A time.
struct Period(f64);

impl Value for Period {
    const KIND: Kind = Kind::Number;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.positive(what).map(Self)
    }
}

/// How tightly files are packed.
struct Level(i64);

impl Value for Level {
    const KIND: Kind = Kind::Whole;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let (span, level) = (args.here(), args.integer("how tightly to pack")?);
        match (-1..=9).contains(&level) {
            true => Ok(Self(level)),
            false => fail(Code::BAD_VALUE, span, format!("the level goes from -1 to 9, not {level}")),
        }
    }
}

/// How many files are kept.
struct MaxFiles(Option<usize>);

impl Value for MaxFiles {
    const KIND: Kind = Kind::Whole;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let span = args.here();
        match args.integer("the number of files")? {
            -1 => Ok(Self(None)),
            n if n >= 1 => Ok(Self(Some(n as usize))),
            n => fail(Code::BAD_VALUE, span, format!("maxfiles must be at least 1, or -1 for all, not {n}")),
        }
    }
}

/// The order of rows.
#[derive(Words)]
enum Order {
    Off,
    Id,
}

/// A column, counted from 0, and whether values descend.
struct Column(usize, bool);

impl Value for Column {
    const KIND: Kind = Kind::Whole;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let span = args.here();
        match args.integer(what)? {
            0 => fail(Code::BAD_VALUE, span, "columns are counted from 1"),
            n => Ok(Self(n.unsigned_abs() as usize - 1, n < 0)),
        }
    }
}

/// Boxes are no general triclinic ones.
#[derive(Words)]
#[word(refused = "yes on true")]
enum Upright {
    No,
}

/// Types are shown by their numbers.
struct Numeric;

impl Value for Numeric {
    const KIND: Kind = Kind::Text;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let word = args.expect("`numeric`")?;
        if word.text == "numeric" {
            return Ok(Self);
        }
        let d = blame(word, Code::NOT_SUPPORTED, "types have no labels in perigrain");
        Err(d.help("write `types numeric`, or name types with `element`").into())
    }
}

impl Common {
    /// The place of `sort id`.
    pub fn by_id(&self) -> Option<Span> {
        let by_id = |s: &&At<Or<Order, Column>>| matches!(s.value, Or::Word(Order::Id));
        self.sort.as_ref().filter(by_id).map(|s| s.span)
    }

    /// The rhythm, of which the later of `every` and `every/time` decides.
    fn rhythm(&self) -> Option<Rhythm> {
        let later =
            |t: &&At<Or<Reference, Period>>| self.every.as_ref().is_none_or(|e| t.span.start > e.span.start);
        if let Some(time) = self.every_time.as_ref().filter(later) {
            return Some(match &time.value {
                Or::Word(Reference(r)) => Rhythm::NamedTime(r.clone()),
                Or::Else(Period(every)) => Rhythm::Time(*every),
            });
        }
        self.every.as_ref().map(|every| match &every.value {
            Or::Word(Reference(r)) => Rhythm::Named(r.clone()),
            Or::Else(_) => Rhythm::Steps,
        })
    }

    /// Refuses what a dump cannot do, and notes what has no effect.
    fn check(&self, base: &Base, cx: &BuildCx) -> Result<()> {
        if let (Some(At { span, .. }), None) = (&self.compression_level, base.level) {
            return Err(elsewhere("compression_level", *span));
        }
        if let Some(At { value: MaxFiles(Some(_)), span, .. }) = &self.maxfiles
            && !base.state().target.pattern.many()
        {
            let text = "maxfiles counts files of single snapshots, and this dump writes all into one";
            let d = Diagnostic::error(Code::CONFLICT, *span, text);
            return Err(d.help("put a `*` into the dump's file name: it becomes the step").into());
        }
        let without = |span: Span, text: &str| cx.note(Diagnostic::note(Code::NO_EFFECT, span, text));
        if let Some(At { span, .. }) = self.balance {
            without(span, "without effect: one process writes the file");
        }
        for (word, shared) in [("fileper", &self.fileper), ("nfile", &self.nfile)] {
            let Some(At { span, .. }) = shared else { continue };
            if !base.shared {
                let text = format!("dump_modify {word} needs a `%` in the dump's file name");
                return fail(Code::CONFLICT, *span, text);
            }
            without(*span, "without effect: one process writes one file");
        }
        Ok(())
    }
}

impl Base {
    /// Takes what `dump_modify` says of files and times.
    ///
    /// # Errors
    /// What this dump cannot do.
    pub fn modify(&mut self, given: Common, cx: &BuildCx) -> Result<()> {
        given.check(self, cx)?;
        self.rhythm = given.rhythm().unwrap_or_else(|| self.rhythm.clone());
        if let Some(Or::Else(Interval(every))) = given.every.map(|e| e.value) {
            self.every = Some(every);
        }
        self.append = given.append.unwrap_or(self.append);
        self.level = given.compression_level.map(|l| l.value.0).or(self.level);
        self.delay = given.delay.unwrap_or(self.delay);
        self.first = given.first.unwrap_or(self.first);
        self.maxfiles = given.maxfiles.map_or(self.maxfiles, |m| m.value.0);
        self.pad = given.pad.map_or(self.pad, |digits| digits.min(40));
        self.skip = given.skip.map(|v| v.0).or(self.skip.take());
        self.sort = given.sort.map_or(self.sort, |s| match s.value {
            Or::Word(Order::Off) => Sort::Off,
            Or::Word(Order::Id) => Sort::Id,
            Or::Else(Column(column, descending)) => Sort::Column(column, descending),
        });
        Ok(())
    }

    /// Takes what `dump_modify` says of particles.
    ///
    /// # Errors
    /// Unknown attributes.
    pub fn select(&mut self, given: OfParticles, cx: &BuildCx) -> Result<()> {
        self.elements = given.element.unwrap_or_else(|| std::mem::take(&mut self.elements));
        self.pbc = given.pbc.unwrap_or(self.pbc);
        self.refresh = given.refresh.or(self.refresh.take());
        match given.region {
            Some(Or::Word(Nothing::None)) => self.region = None,
            Some(Or::Else(region)) => self.region = Some(region),
            None => {}
        }
        for test in given.thresh {
            match test {
                Or::Word(Nothing::None) => self.thresholds.clear(),
                Or::Else(Test { attribute: word, operator: Operator(compare), value }) => {
                    let value = if let Or::Else(number) = value { Some(number) } else { None };
                    self.thresholds.push(Threshold { attribute: attribute(&word, cx)?, compare, value });
                }
            }
        }
        Ok(())
    }
}

/// A column by number from 1, by number from -1 backwards, or by name; returned as an index from 0.
///
/// # Errors
/// Unknown names and numbers.
pub fn column<'a>(word: &Word, mut names: impl ExactSizeIterator<Item = &'a str>) -> Result<usize> {
    let n = names.len();
    if let Some(k) = names.position(|name| name == word.text) {
        return Ok(k);
    }
    let Ok(k) = word.text.parse::<i64>() else {
        return fail(Code::UNKNOWN_NAME, word.span, format!("this dump has no column `{}`", word.text));
    };
    match usize::try_from(if k < 0 { n as i64 + k } else { k - 1 }) {
        Ok(index) if index < n => Ok(index),
        _ => fail(Code::BAD_VALUE, word.span, format!("this dump has columns 1 to {n}")),
    }
}

/// The refusal of a keyword that other dumps have.
fn elsewhere(name: &str, span: Span) -> Diagnostics {
    let why = ELSEWHERE.iter().find(|(n, _)| *n == name).map_or("", |(_, why)| why);
    Diagnostic::error(Code::NOT_SUPPORTED, span, format!("dump_modify {name} {why}")).into()
}

/// Refuses keywords that other dumps have.
pub fn foreign(word: &Word) -> Option<Diagnostics> {
    let known = ELSEWHERE.iter().any(|(name, _)| *name == word.text);
    known.then(|| elsewhere(&word.text, word.span))
}

/// One name for each type.
fn names(args: &mut Args, cx: &BuildCx) -> Result<Vec<String>> {
    (0..cx.world.types)
        .map(|k| Ok(args.expect(&format!("the name of type {}", k + 1))?.text.clone()))
        .collect()
}

/// `refresh c_ID`.
fn refresh(args: &mut Args, cx: &BuildCx) -> Result<String> {
    let word = args.expect("a compute, as `c_ID`")?;
    match ValueRef::parse(&word.text, word.span)? {
        Some(r) if r.kind == RefKind::Compute && r.index.is_empty() => {
            if cx.shape(&r).is_none() {
                cx.value(&r, true)?;
            }
            cx.uses(UseKind::Compute, &r.name);
            Ok(r.name)
        }
        _ => Err(blame(word, Code::BAD_VALUE, "refresh takes a compute, as `c_ID`").into()),
    }
}
