//! What all dumps share: which particles, in which order, when, and into which file.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::attribute::{Attribute, Bound, attribute};
use crate::diag::{Code, Diagnostic, Result, fail};
use crate::lang::args::{blame, parse_number};
use crate::lang::{Args, Word};
use crate::out::dump::{Data, Target, sort_rows};
use crate::out::file::Pattern;
use crate::out::image::View;
use crate::out::vtu::Series;
use crate::plan::{Access, Op, Stage, Tick, When};
use crate::styles::step_op::StepOp;
use crate::styles::{BuildCx, SealCx, UseKind};
use crate::world::{GroupId, World};

/// Keywords of `dump_modify` that every style understands.
pub const KEYWORDS: &[&str] =
    &["append", "buffer", "every", "first", "flush", "pad", "pbc", "region", "sort", "thresh"];

/// Keywords of LAMMPS that no style here understands.
const ELSEWHERE: &[&str] = &[
    "at",
    "balance",
    "delay",
    "element",
    "every/time",
    "fileper",
    "header",
    "label",
    "maxfiles",
    "nfile",
    "refresh",
    "sfactor",
    "tfactor",
    "thermo",
    "unwrap",
];

/// What outlives a run: open files and what belongs to them.
#[derive(Debug)]
pub struct State {
    /// The file or files.
    pub target: Target,
    /// The latest step written.
    pub last: Option<i64>,
    /// The list of snapshots of a `vtk` dump.
    pub series: Option<Series>,
    /// The view that an `image` dump keeps.
    pub view: Option<View>,
}

/// The order of rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sort {
    /// As stored.
    Off,
    /// By id.
    Id,
    /// By a column, counted from 0.
    Column(usize, bool),
}

/// `thresh attribute operator value`.
#[derive(Clone, Debug)]
pub struct Threshold {
    attribute: Attribute,
    compare: fn(f64, f64) -> bool,
    value: f64,
}

/// A threshold whose attribute has been found: left side, comparison, right side.
type Test<T> = (T, fn(f64, f64) -> bool, f64);

/// What all dumps share.
#[derive(Clone, Debug)]
pub struct Base {
    /// The dump's ID.
    pub id: String,
    /// Its style.
    pub style: &'static str,
    group: GroupId,
    append: bool,
    pad: usize,
    every: Option<i64>,
    first: bool,
    region: Option<String>,
    thresholds: Vec<Threshold>,
    /// Order of rows.
    pub sort: Sort,
    state: Arc<Mutex<State>>,
}

/// What a style gets to write: a world at rest.
pub struct Shot<'a> {
    /// The world.
    pub world: &'a World,
    /// The present step.
    pub step: i64,
    /// Particle indices in order.
    pub rows: Vec<u32>,
    /// The style's attributes.
    pub data: Vec<Data<'a>>,
    /// What outlives the run.
    pub state: &'a mut State,
}

impl Base {
    /// Reads the file name; `endings` are those the style can write (none: any).
    pub fn new(style: &'static str, args: &mut Args, cx: &BuildCx, endings: &[&str]) -> Result<Self> {
        let word = args.expect("the file name")?;
        let pattern = Pattern::new(&word.text).map_err(|e| e.at(word.span))?;
        if !endings.is_empty() && !endings.iter().any(|e| word.text.ends_with(e)) {
            let message = format!("dump {style} writes {} files, not `{}`", endings.join(" or "), word.text);
            let d = blame(word, Code::NOT_SUPPORTED, message);
            return Err(d.help(format!("let the name end in {}", endings[0])).into());
        }
        let state = State { target: Target::new(pattern), last: None, series: None, view: None };
        Ok(Self {
            id: cx.id.to_string(),
            style,
            group: cx.group,
            append: false,
            pad: 0,
            every: None,
            first: false,
            region: None,
            thresholds: vec![],
            sort: Sort::Id,
            state: Arc::new(Mutex::new(state)),
        })
    }

    /// Refuses a name without `*` where every snapshot is a file of its own; `write_dump` needs none.
    pub fn needs_star(&self, args: &Args, cx: &BuildCx) -> Result<()> {
        if self.state().target.pattern.many() || cx.id == "WRITE_DUMP" {
            return Ok(());
        }
        let message = format!("dump {} writes one file per snapshot", self.style);
        let d = Diagnostic::error(Code::BAD_VALUE, args.here(), message);
        Err(d.help("put a `*` into the file name: it becomes the step").into())
    }

    /// What outlives a run.
    pub fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The interval that `dump_modify … every N` asked for.
    pub fn every(&self) -> Option<i64> {
        self.every
    }

    /// Reads one keyword of `dump_modify` if all dumps share it.
    pub fn modify(&mut self, word: &Word, args: &mut Args, cx: &BuildCx) -> Result<bool> {
        match word.text.as_str() {
            "append" => self.append = args.flag("append")?,
            "every" => self.every = Some(every(args)?),
            "first" => self.first = args.flag("first")?,
            "pad" => self.pad = args.integer_from(0, "the number of digits")?.min(40) as usize,
            "region" => self.region = region(args, cx)?,
            "sort" => self.sort = sort(args)?,
            "thresh" => self.thresh(args, cx)?,
            // Snapshots are always handed over whole, which is what these ask for.
            "flush" | "buffer" => {
                args.flag(&word.text)?;
            }
            "pbc" => {
                if args.flag("pbc")? {
                    let d = blame(word, Code::NOT_SUPPORTED, "dump_modify pbc yes");
                    return Err(d.help("dump xu yu zu, or wrap when reading").into());
                }
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn thresh(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        if args.eat("none") {
            self.thresholds.clear();
            return Ok(());
        }
        let attribute = attribute(args.expect("a particle attribute or `none`")?, cx)?;
        let word = args.expect("an operator: < <= > >= == !=")?;
        let compare: fn(f64, f64) -> bool = match word.text.as_str() {
            "<" => |a, b| a < b,
            "<=" => |a, b| a <= b,
            ">" => |a, b| a > b,
            ">=" => |a, b| a >= b,
            "==" => |a, b| a == b,
            "!=" => |a, b| a != b,
            "|^" => |a, b| (a != 0.0) != (b != 0.0),
            _ => {
                let d = blame(word, Code::BAD_VALUE, format!("`{}` compares nothing", word.text));
                return Err(d.help("use one of < <= > >= == !=").into());
            }
        };
        let word = args.expect("a number to compare with")?;
        if word.text == "LAST" {
            return fail(Code::NOT_SUPPORTED, word.span, "thresh against LAST");
        }
        let value = parse_number(word, "the threshold")?;
        self.thresholds.push(Threshold { attribute, compare, value });
        Ok(())
    }

    /// The op: at its times it selects and sorts particles and lets the style write them.
    pub fn seal(
        &self,
        cx: &mut dyn SealCx,
        every: i64,
        attributes: &[Attribute],
        mut write: impl FnMut(Shot<'_>) -> Result<()> + Send + 'static,
    ) -> Result<Box<dyn Op>> {
        let when = match every {
            0 => When::Always,
            n if self.first => When::Every(n).or(When::First),
            n => When::Every(n),
        };
        let bind = |a: &Attribute, cx: &mut dyn SealCx| a.bind(cx, &when);
        let shown = attributes.iter().map(|a| bind(a, cx)).collect::<Result<Vec<_>>>()?;
        let tested = self
            .thresholds
            .iter()
            .map(|t| Ok((bind(&t.attribute, cx)?, t.compare, t.value)))
            .collect::<Result<Vec<_>>>()?;
        let span = cx.span();
        let base = self.clone();
        let act = move |w: &mut World, t: &Tick| {
            if !base.due(t, every) {
                return Ok(());
            }
            let world = &*w;
            let domain = world.domain().map_err(|e| e.at(span))?;
            let data: Vec<Data<'_>> = shown.iter().map(|b| b.data(world, domain)).collect();
            let rows = base.rows(world, &tested, &data).map_err(|e| e.at(span))?;
            let mut state = base.state();
            (state.target.append, state.target.pattern.pad) = (base.append, base.pad);
            let shot = Shot { world, step: t.step, rows, data, state: &mut state };
            write(shot).map_err(|e| e.at(span))?;
            state.last = Some(t.step);
            Ok(())
        };
        let name = format!("dump {} {}", self.id, self.style);
        let reads = "x v f image mask tag kind mass radius omega torque volume";
        Ok(StepOp::new(name, Stage::Output, Access::new(reads, ""), act).when(when).in_setup(true).boxed())
    }

    /// Whether this step is to be written: not twice, and the first step only if asked or a multiple.
    fn due(&self, t: &Tick, every: i64) -> bool {
        if every == 0 {
            return true;
        }
        let last = self.state().last;
        if t.setup && t.step % every != 0 {
            return self.first && last.is_none();
        }
        t.step % every == 0 && last != Some(t.step)
    }

    /// Particles that pass, in order.
    fn rows(&self, w: &World, tested: &[Test<Bound>], data: &[Data<'_>]) -> Result<Vec<u32>> {
        let region = match &self.region {
            None => None,
            Some(name) => match w.regions.get(name) {
                Some(region) => Some(region),
                None => return fail(Code::UNKNOWN_REGION, None, format!("region `{name}` is gone")),
            },
        };
        let (bit, p) = (self.group.bit(), &w.particles);
        let domain = w.domain()?;
        let tests: Vec<Test<Data<'_>>> =
            tested.iter().map(|(b, compare, value)| (b.data(w, domain), *compare, *value)).collect();
        let passes = |i: usize| {
            p.mask[i] & bit != 0
                && region.is_none_or(|r| r.contains(p.x[i]))
                && tests.iter().all(|(data, compare, value)| compare(data.number(i), *value))
        };
        let mut rows: Vec<u32> = (0..w.n()).filter(|&i| passes(i)).map(|i| i as u32).collect();
        match self.sort {
            Sort::Off => {}
            Sort::Column(k, descending) if k < data.len() => sort_rows(&mut rows, &data[k], descending),
            _ => sort_rows(&mut rows, &Data::int(|i| i64::from(p.tag[i])), false),
        }
        Ok(rows)
    }
}

/// Refuses a keyword that neither the style nor all dumps know.
pub fn unknown(word: &Word, args: &Args, own: &[&'static str]) -> crate::diag::Diagnostics {
    if ELSEWHERE.contains(&word.text.as_str()) {
        return blame(word, Code::NOT_SUPPORTED, format!("dump_modify {}", word.text)).into();
    }
    let known: Vec<&'static str> = KEYWORDS.iter().chain(own).copied().collect();
    args.unknown(word, &known)
}

fn every(args: &mut Args) -> Result<i64> {
    if let Some(word) = args.peek().filter(|w| w.text.starts_with("v_")) {
        let d = blame(word, Code::NOT_SUPPORTED, "dump_modify every with a variable");
        return Err(d
            .help("give a fixed number of steps, or several `run` commands with `first yes`")
            .into());
    }
    args.integer_from(1, "the dump's interval")
}

fn region(args: &mut Args, cx: &BuildCx) -> Result<Option<String>> {
    if args.eat("none") {
        return Ok(None);
    }
    let word = args.expect("a region or `none`")?;
    cx.region(word)?;
    cx.uses(UseKind::Region, &word.text);
    Ok(Some(word.text.clone()))
}

fn sort(args: &mut Args) -> Result<Sort> {
    if args.eat("off") {
        return Ok(Sort::Off);
    }
    if args.eat("id") {
        return Ok(Sort::Id);
    }
    let span = args.here();
    match args.integer("`off`, `id` or a column")? {
        0 => fail(Code::BAD_VALUE, span, "columns are counted from 1"),
        n => Ok(Sort::Column(n.unsigned_abs() as usize - 1, n < 0)),
    }
}
