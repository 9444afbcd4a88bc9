//! Shared by all dumps: selection and order of particles, times and files.

mod clock;
mod keywords;

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::attribute::{Attribute, Bound, Frame};
use clock::Clock;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::args::blame;
use perigrain_lang::{ValueRef, Word};
use perigrain_output::dump::{Data, Target, sort_rows};
use perigrain_output::file::{Pattern, trouble};
use perigrain_output::image::View;
use perigrain_output::movie::Movie;
use perigrain_output::vtu::{self, Series};
use perigrain_plan::{Needs, Op, Stage, Tick, When};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::Words;
use perigrain_styles::{BuildCx, SealCx, Wants};

pub use keywords::{Common, OfParticles, column, foreign};
use perigrain_world::field::{
    BOX, CHARGE, COLUMNS, F, FACTS, Fields, IMAGE, KIND, MASK, MASS, MOLECULE, MU, OMEGA, RADIUS, REGIONS,
    SLOTS, TAG, TORQUE, V, VOLUME, X,
};
use perigrain_world::{Domain, GroupId, Key, Numbers, Region, World};

/// State that persists between runs: open files and their data.
#[derive(Debug)]
pub struct State {
    /// The output file or files.
    pub target: Target,
    /// The last step written.
    pub last: Option<i64>,
    /// The list of snapshots of a `vtk` dump.
    pub series: Option<Series>,
    /// The view that an `image` dump keeps.
    pub view: Option<View>,
    /// State of a `movie` dump.
    pub movie: Option<Movie>,
    /// The next output time, for `every/time`.
    next_time: Option<f64>,
    /// Files of single snapshots that exist, for `maxfiles`.
    kept: VecDeque<PathBuf>,
}

/// Order of rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sort {
    /// Storage order.
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
    /// `None`: the particle's value at the last snapshot (`LAST`).
    value: Option<f64>,
}

/// A threshold with its attribute bound: left side, comparison, right side.
type Test<T> = (T, fn(f64, f64) -> bool, Option<f64>);

/// Snapshot times, if they are not at multiples of the dump's interval.
#[derive(Clone, Debug)]
enum Rhythm {
    /// At multiples of the dump's interval.
    Steps,
    /// At steps given by a variable.
    Named(ValueRef),
    /// At multiples of a time.
    Time(f64),
    /// At times given by a variable.
    NamedTime(ValueRef),
}

/// Data of all dumps.
#[derive(Clone, Debug)]
pub struct Base {
    /// The dump's ID.
    pub id: String,
    /// Its style.
    pub style: &'static str,
    group: GroupId,
    /// Whether the file name contains `%`, by which processes could share the output.
    shared: bool,
    append: bool,
    /// Compression level (`compression_level`), for styles that always compress.
    pub level: Option<i64>,
    pad: usize,
    every: Option<i64>,
    rhythm: Rhythm,
    delay: i64,
    first: bool,
    pbc: bool,
    maxfiles: Option<usize>,
    skip: Option<ValueRef>,
    refresh: Option<String>,
    /// Names of types.
    pub elements: Vec<String>,
    region: Option<Key<Region>>,
    thresholds: Vec<Threshold>,
    /// Order of rows.
    pub sort: Sort,
    state: Arc<Mutex<State>>,
}

/// Input of a style's writer: the world between steps.
pub struct Shot<'a> {
    /// The world.
    pub world: &'a World,
    /// The current step.
    pub step: i64,
    /// Particle indices in output order.
    pub rows: Vec<u32>,
    /// The style's attributes.
    pub data: Vec<Data<'a>>,
    /// The persistent state.
    pub state: &'a mut State,
}

/// Styles that can write LAMMPS' binary files.
const BINARY: [&str; 2] = ["atom", "custom"];

/// Further styles that allow `%` in file names, as in LAMMPS.
const SHARED: [&str; 2] = ["cfg", "local"];

/// The files of a style.
#[derive(Clone, Copy)]
pub struct Files {
    /// The style.
    pub style: &'static str,
    /// The extensions that it can write (empty: any).
    pub endings: &'static [&'static str],
    /// Its compression level, if it always compresses.
    pub level: Option<i64>,
}

impl Files {
    /// Files of any name.
    pub const fn any(style: &'static str) -> Self {
        Self { style, endings: &[], level: None }
    }
}

/// The line of a dump that needs no other words than its file.
#[derive(Words)]
pub struct OfFile {
    /// The file's name; a `*` in it becomes the step, and each snapshot has a file of its own.
    #[word(name = "FILE", what = "the file name", kind = Kind::File)]
    pub file: Word,
}

impl Base {
    /// A dump into the file of this name.
    ///
    /// # Errors
    /// Names that the style cannot write.
    pub fn new(Files { style, endings, level }: Files, word: &Word, cx: &BuildCx) -> Result<Self> {
        let binary = BINARY.contains(&style);
        let pattern = match binary || SHARED.contains(&style) {
            true => Pattern::shared(&word.text, binary),
            false => Pattern::new(&word.text),
        }
        .map_err(|e| e.at(word.span))?;
        if !endings.is_empty() && !endings.iter().any(|e| word.text.ends_with(e)) {
            let message = format!("dump {style} writes {} files, not `{}`", endings.join(" or "), word.text);
            let d = blame(word, Code::NOT_SUPPORTED, message);
            return Err(d.help(format!("let the name end in {}", endings[0])).into());
        }
        let state = State {
            target: Target::new(pattern),
            last: None,
            series: None,
            view: None,
            movie: None,
            next_time: None,
            kept: VecDeque::new(),
        };
        Ok(Self {
            id: cx.id.to_string(),
            style,
            group: cx.group,
            shared: word.text.contains('%'),
            append: false,
            level,
            pad: 0,
            every: None,
            rhythm: Rhythm::Steps,
            delay: i64::MIN,
            first: false,
            pbc: false,
            maxfiles: None,
            skip: None,
            refresh: None,
            elements: vec!["C".to_string(); cx.world.types],
            region: None,
            thresholds: vec![],
            sort: Sort::Id,
            state: Arc::new(Mutex::new(state)),
        })
    }

    /// Refuses a name without `*` if every snapshot is a separate file; `write_dump` needs no `*`.
    pub fn needs_star(&self, at: Span, cx: &BuildCx) -> Result<()> {
        if self.state().target.pattern.many() || cx.id == "WRITE_DUMP" {
            return Ok(());
        }
        let message = format!("dump {} writes one file per snapshot", self.style);
        let d = Diagnostic::error(Code::BAD_VALUE, at, message);
        Err(d.help("put a `*` into the file name: it becomes the step").into())
    }

    /// The persistent state.
    pub fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether it has written snapshots into a common file.
    pub fn growing(&self) -> bool {
        let state = self.state();
        state.last.is_some() && !state.target.pattern.many()
    }

    /// The interval set by `dump_modify … every N`.
    pub fn every(&self) -> Option<i64> {
        self.every
    }

    /// The op: at output times it selects and sorts particles and calls the style's writer.
    pub fn seal(
        &self,
        cx: &mut dyn SealCx,
        every: i64,
        attributes: &[Attribute],
        write: impl FnMut(Shot<'_>) -> Result<()> + Send + 'static,
    ) -> Result<Box<dyn Op>> {
        self.seal_reading(cx, every, attributes, Fields::NONE, write)
    }

    /// The same for a writer that reads more fields.
    pub fn seal_reading(
        &self,
        cx: &mut dyn SealCx,
        every: i64,
        attributes: &[Attribute],
        more: Fields,
        mut write: impl FnMut(Shot<'_>) -> Result<()> + Send + 'static,
    ) -> Result<Box<dyn Op>> {
        let when = self.when(cx, every)?;
        let mut clock = self.clock(cx)?;
        let bind = |a: &Attribute, cx: &mut dyn SealCx| a.bind(cx, &when);
        let shown = attributes.iter().map(|a| bind(a, cx)).collect::<Result<Vec<_>>>()?;
        let tested = self
            .thresholds
            .iter()
            .map(|t| Ok((bind(&t.attribute, cx)?, t.compare, t.value)))
            .collect::<Result<Vec<_>>>()?;
        let skip = match &self.skip {
            Some(r) => Some(cx.reading(r, Wants::Number, Stage::Output, &when)?),
            None => None,
        };
        let span = cx.span();
        let mut refresh = match &self.refresh {
            Some(id) => cx.refresh(id, Stage::Output, &when)?,
            None => None,
        };
        let base = self.clone();
        let key = |k: usize| Key::new(&format!("dump {} last {k}", self.id));
        let kept: Vec<Numbers> = (0..tested.len()).map(key).collect();
        let act = move |w: &mut World, t: &Tick| {
            let due = base.due(w, t, every, &mut clock)?;
            base.aim();
            if !due || skip.is_some_and(|s| s.get(w) != 0.0) {
                return if t.setup { base.state().target.begin().map_err(|e| e.at(span)) } else { Ok(()) };
            }
            let world = &*w;
            let domain = world.domain().map_err(|e| e.at(span))?;
            let wrapped = base.pbc.then(|| wrapped(world, domain));
            let frame = Frame { world, domain, wrapped: wrapped.as_deref(), elements: &base.elements };
            let data: Vec<Data<'_>> = shown.iter().map(|b| b.data(&frame)).collect();
            let (rows, last) = base.rows(&frame, (&tested, &kept), &data).map_err(|e| e.at(span))?;
            let mut state = base.state();
            let shot = Shot { world, step: t.step, rows, data, state: &mut state };
            write(shot).map_err(|e| e.at(span))?;
            state.last = Some(t.step);
            base.keep_few(&mut state, t.step)?;
            drop(state);
            let n = w.n();
            last.into_iter().for_each(|(key, values)| *w.columns.scalar(key, n) = values);
            refresh.as_mut().map_or(Ok(()), |op| op.run(w, t))
        };
        let name = format!("dump {} {}", self.id, self.style);
        let style = cx.world().particles.style;
        let of = |there: bool, field: Fields| if there { field } else { Fields::NONE };
        let electric = of(style.charged, CHARGE) | of(style.dipole, MU) | of(style.molecules, MOLECULE);
        let reads =
            X | V | F | IMAGE | MASK | TAG | KIND | MASS | RADIUS | OMEGA | TORQUE | VOLUME | electric;
        // The file exists from the first step on, as in LAMMPS.
        let when = if self.state().target.pattern.many() { when } else { when.or(When::First) };
        Ok(StepOp::new(
            name,
            Stage::Output,
            Needs::new().read(reads | BOX | FACTS | REGIONS | SLOTS | more).keep(COLUMNS),
            act,
        )
        .when(when)
        .in_setup(true)
        .boxed())
    }

    /// Passes the options of `dump_modify` to the file.
    fn aim(&self) {
        let target = &mut self.state().target;
        (target.append, target.pattern.pad) = (self.append, self.pad);
        target.level = self.level.and_then(|level| u32::try_from(level).ok());
    }

    /// Steps at which snapshots may be due; `due` decides.
    pub fn when(&self, cx: &mut dyn SealCx, every: i64) -> Result<When> {
        let when = match (&self.rhythm, every) {
            (_, 0) | (Rhythm::Time(_) | Rhythm::NamedTime(_), _) => return Ok(When::Always),
            (Rhythm::Named(r), _) => cx.steps(r)?,
            (Rhythm::Steps, n) => When::Every(n),
        };
        Ok(if self.first { when.or(When::First) } else { when })
    }

    /// The source of the next output time, for `every/time`.
    fn clock(&self, cx: &mut dyn SealCx) -> Result<Option<Clock>> {
        Ok(match &self.rhythm {
            Rhythm::Steps | Rhythm::Named(_) => None,
            Rhythm::Time(every) => Some(Clock::Multiples(*every)),
            Rhythm::NamedTime(r) => {
                let text = format!("$({r}:%.17g)");
                Some(Clock::Named(cx.text(&text, r.span, Stage::Output, &When::Always)?, r.clone()))
            }
        })
    }

    /// Whether this step is to be written: not twice, and the first step only if requested or a multiple.
    fn due(&self, w: &mut World, t: &Tick, every: i64, clock: &mut Option<Clock>) -> Result<bool> {
        if every == 0 {
            return Ok(true);
        }
        let mut state = self.state();
        if t.ending {
            return Ok(t.step >= self.delay && state.last != Some(t.step));
        }
        if let Some(clock) = clock {
            return Ok(clock.strikes(&mut state, w, t, self.first)? && t.step >= self.delay);
        }
        let regular = match self.rhythm {
            Rhythm::Steps => t.step % every == 0,
            _ => !t.setup,
        };
        if t.step < self.delay {
            return Ok(false);
        }
        if t.setup && !regular {
            return Ok(self.first && state.last.is_none());
        }
        Ok(regular && state.last != Some(t.step))
    }

    /// Deletes the oldest files beyond `maxfiles`.
    fn keep_few(&self, state: &mut State, step: i64) -> Result<()> {
        let Some(most) = self.maxfiles.filter(|_| state.target.pattern.many()) else { return Ok(()) };
        let path = state.target.pattern.at(step);
        state.kept.push_back(path);
        while state.kept.len() > most {
            let old = state.kept.pop_front();
            let piece = old.as_deref().and_then(vtu::piece);
            for old in [old, piece].into_iter().flatten() {
                perigrain_base::gate::remove(&old).map_err(|e| trouble("delete", &old, &e))?;
            }
        }
        Ok(())
    }

    /// Selected particles in order, and the values for the next comparison with `LAST`.
    fn rows(
        &self,
        frame: &Frame<'_>,
        (tested, kept): (&[Test<Bound>], &[Numbers]),
        data: &[Data<'_>],
    ) -> Result<(Vec<u32>, Last)> {
        let w = frame.world;
        let region = match self.region {
            None => None,
            Some(key) => match w.regions.get(key) {
                Some(region) => Some(region),
                None => return fail(Code::UNKNOWN_REGION, None, format!("region `{key}` is gone")),
            },
        };
        let (bit, p) = (self.group.bit(), &w.particles);
        let tests: Vec<Test<Data<'_>>> =
            tested.iter().map(|(b, compare, value)| (b.data(frame), *compare, *value)).collect();
        let before: Vec<Option<&[f64]>> = kept.iter().map(|key| w.columns.get_scalar(*key)).collect();
        let passes = |i: usize| {
            let holds = |(k, (data, compare, value)): (usize, &Test<Data<'_>>)| {
                let value = value.or_else(|| before[k].and_then(|b| b.get(i).copied()));
                value.is_some_and(|v| compare(data.number(i), v))
            };
            p.mask[i] & bit != 0
                && region.is_none_or(|r| r.contains(p.x[i]))
                && tests.iter().enumerate().all(holds)
        };
        let mut rows: Vec<u32> = (0..w.n()).filter(|&i| passes(i)).map(|i| i as u32).collect();
        match self.sort {
            Sort::Off => {}
            Sort::Column(k, descending) if k < data.len() => sort_rows(&mut rows, &data[k], descending),
            _ => sort_rows(&mut rows, &Data::int(|i| i64::from(p.tag[i])), false),
        }
        let against_last = tests.iter().enumerate().filter(|(_, t)| t.2.is_none());
        let last =
            against_last.map(|(k, t)| (kept[k], (0..w.n()).map(|i| t.0.number(i)).collect())).collect();
        Ok((rows, last))
    }
}

/// Values of this snapshot for the next one, and their columns.
type Last = Vec<(Numbers, Vec<f64>)>;

/// Positions and image counts wrapped into the box.
fn wrapped(w: &World, domain: &Domain) -> Vec<([f64; 3], [i32; 3])> {
    let p = &w.particles;
    (0..w.n())
        .map(|i| {
            let (mut x, mut image) = (p.x[i], p.image[i]);
            domain.wrap(&mut x, &mut image);
            (x, image)
        })
        .collect()
}
