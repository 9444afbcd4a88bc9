//! `read_dump`: positions, velocities, image flags and forces from a snapshot of a text dump.

use super::common::{bad_keyword, domain, on_particles, settle};
use super::data::body::Index;
use super::data::dump::{self, Snapshot};
use super::data::text::{Lines, load, number, whole};
use super::{Act, CommandStyle};
use crate::diag::{Code, Diagnostic, Result, Source, Span, fail};
use crate::lang::{Args, Word};
use crate::math::cformat::general;
use crate::styles::{ActCx, BuildCx, Doc, Style};
use crate::world::{Domain, World};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// The command.
pub struct ReadDump;

/// What can be read, in LAMMPS' words.
const FIELDS: [&str; 12] = ["x", "y", "z", "vx", "vy", "vz", "ix", "iy", "iz", "fx", "fy", "fz"];
const KEYWORDS: [&str; 9] =
    ["box", "timestep", "replace", "purge", "trim", "add", "label", "scaled", "wrapped"];

impl Style for ReadDump {
    fn name(&self) -> &'static str {
        "read_dump"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "read_dump FILE STEP FIELD … [box yes|no] [timestep yes|no] [replace yes|no] [purge yes|no] \
                     [trim yes|no] [add yes|keep|no] [label FIELD COLUMN] [scaled yes|no] [wrapped yes|no] [format native]",
            summary: "Takes positions, velocities, image flags or forces from a snapshot of a text dump.",
            text: "The file is one of `dump atom` or `dump custom`, packed with gzip if its name ends in `.gz`; it needs a \
                   column `id`. FIELDs are `x y z vx vy vz ix iy iz fx fy fz`; for `x` the first of the columns `x xs xu xsu` \
                   is taken (scaled, unwrapped, both), likewise for `y` and `z`; `label` names another column, and then \
                   `scaled` and `wrapped` say what is in it. Defaults: the snapshot's box takes the place of the box and \
                   its step that of the clock; particles with the same id are overwritten (`replace`); others stay unless \
                   `trim yes`; particles that are only in the snapshot are left out unless `add keep` (with their ids) or \
                   `add yes` (with new ids behind the largest), which needs a column `type`. `purge yes` deletes all \
                   particles first and goes with `replace no`. Particles are wrapped and shrink-wrapped faces follow \
                   afterwards. Positions at creation and peridynamic bonds stay as they are. The formats xyz, molfile and \
                   adios and files per processor are refused.",
            example: "write_dump all custom now.dump id type x y z vx vy vz\nread_dump now.dump 1 x y z vx vy vz",
        }
    }
}

/// What happens to particles that only the snapshot has.
#[derive(Clone, Copy, PartialEq)]
enum Add {
    No,
    /// With new ids.
    Yes,
    /// With their ids.
    Keep,
}

/// What a line asks for.
struct Wish {
    fields: Vec<usize>,
    labels: BTreeMap<String, String>,
    scaled: bool,
    wrapped: bool,
    domain: bool,
    timestep: bool,
    replace: bool,
    purge: bool,
    trim: bool,
    add: Add,
    span: Span,
}

impl CommandStyle for ReadDump {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        domain(cx)?;
        let file = a.expect("a file name")?.clone();
        let at = a.here();
        let step = a.integer("the snapshot's step")?;
        let wish = Wish::read(a, cx)?;
        Ok(on_particles(vec![], move |cx| read(cx, &file, step, at, &wish)))
    }
}

impl Wish {
    fn read(a: &mut Args, cx: &BuildCx) -> Result<Self> {
        let mut w = Self {
            fields: vec![],
            labels: BTreeMap::new(),
            scaled: false,
            wrapped: true,
            domain: true,
            timestep: true,
            replace: true,
            purge: false,
            trim: false,
            add: Add::No,
            span: a.span(),
        };
        while let Some(k) = FIELDS.iter().position(|f| *f == a.peek_text()) {
            let word = a.expect("a field")?;
            if cx.world.settings.two_dimensional && k % 3 == 2 {
                let text = format!("a flat scene has no `{}` to read", word.text);
                return fail(Code::CONFLICT, word.span, text);
            }
            if w.fields.contains(&k) {
                return fail(Code::CONFLICT, word.span, format!("`{}` is named twice", word.text));
            }
            w.fields.push(k);
        }
        if w.fields.is_empty() {
            let text = format!("read_dump needs a field to read: {}", FIELDS.join(" "));
            return fail(Code::MISSING_ARGUMENT, a.here(), text);
        }
        while let Some(word) = a.next() {
            match word.text.as_str() {
                "box" => w.domain = a.flag("box")?,
                "timestep" => w.timestep = a.flag("timestep")?,
                "replace" => w.replace = a.flag("replace")?,
                "purge" => w.purge = a.flag("purge")?,
                "trim" => w.trim = a.flag("trim")?,
                "scaled" => w.scaled = a.flag("scaled")?,
                "wrapped" => w.wrapped = a.flag("wrapped")?,
                "add" => {
                    w.add = match a.choice("value of add", &["yes", "keep", "no"])? {
                        "yes" => Add::Yes,
                        "keep" => Add::Keep,
                        _ => Add::No,
                    }
                }
                "label" => {
                    let known: Vec<&str> = FIELDS.iter().copied().chain(["id", "type"]).collect();
                    let field = a.expect("a field")?;
                    if !known.contains(&field.text.as_str()) {
                        return Err(a.unknown(field, &FIELDS));
                    }
                    let column = a.expect("the label of a column")?;
                    w.labels.insert(field.text.clone(), column.text.clone());
                }
                "format" => drop(super::common::choice_or_refuse(
                    a,
                    "format of read_dump",
                    &["native"],
                    &["xyz", "adios", "molfile"],
                )?),
                _ => return Err(bad_keyword(a, word, &KEYWORDS, &["nfile", "q"])),
            }
        }
        if w.purge && (w.replace || w.trim) {
            let text = "where all particles are purged, none can be replaced or trimmed";
            let d = Diagnostic::error(Code::CONFLICT, w.span, text);
            return Err(d.help("write `purge yes replace no`").into());
        }
        Ok(w)
    }

    /// The column of a field, and whether it is scaled and wrapped.
    fn column(&self, s: &Snapshot, field: usize) -> Result<(usize, bool, bool)> {
        let name = FIELDS[field];
        if let Some(label) = self.labels.get(name) {
            return match s.column(&[label]) {
                Some((k, _)) => Ok((k, self.scaled, self.wrapped)),
                None => self.missing(s, label),
            };
        }
        if field >= 3 {
            return s.column(&[name]).map_or_else(|| self.missing(s, name), |(k, _)| Ok((k, false, true)));
        }
        let [scaled, unwrapped, both] = ["s", "u", "su"].map(|end| format!("{name}{end}"));
        match s.column(&[name, &scaled, &unwrapped, &both]) {
            Some((k, label)) => Ok((k, label == scaled || label == both, label == name || label == scaled)),
            None => self.missing(s, name),
        }
    }

    /// The column `id` or `type`.
    fn named(&self, s: &Snapshot, name: &str) -> Result<usize> {
        let label = self.labels.get(name).map_or(name, String::as_str);
        s.column(&[label]).map_or_else(|| self.missing(s, label), |(k, _)| Ok(k))
    }

    fn missing<T>(&self, s: &Snapshot, label: &str) -> Result<T> {
        let d = Diagnostic::error(Code::UNKNOWN_NAME, s.title, format!("the dump has no column `{label}`"));
        Err(d.label(self.span, "asked for here").into())
    }
}

/// What a snapshot says about one particle.
struct Particle {
    tag: u32,
    kind: u16,
    values: [f64; 12],
}

/// The dump that a word names.
fn open(file: &Word, w: &World) -> Result<Arc<Source>> {
    let paths = [PathBuf::from(&file.text), w.folder.join(&file.text)];
    let Some(text) = paths.iter().find_map(|p| load(p).ok()) else {
        let why = load(&paths[0]).err().map_or(String::new(), |e| format!(": {e}"));
        let d = Diagnostic::error(
            Code::NO_FILE,
            file.span,
            format!("the dump `{}` cannot be read{why}", file.text),
        );
        return Err(d.help("it is looked for in the working folder and beside the deck").into());
    };
    Ok(text)
}

fn read(cx: &mut ActCx, file: &Word, step: i64, at: Span, wish: &Wish) -> Result<()> {
    let text = open(file, cx.world)?;
    let mut lines = Lines::new(&text.text);
    let outcome = (|| {
        let mut last = None;
        while let Some(s) = dump::next(&mut lines)? {
            if s.step == step {
                return Ok(Some((particles(&s, wish, cx.world)?, s)));
            }
            last = Some(s.step);
        }
        let text = match last {
            Some(last) => format!("the dump has no snapshot of step {step}; its last one is of step {last}"),
            None => "the dump has no snapshots".to_string(),
        };
        fail(Code::BAD_VALUE, at, text)
    })();
    let found = outcome.map_err(|e| e.within(&text))?;
    let Some((list, s)) = found else { return Ok(()) };
    let before = cx.world.n();
    let counts = enter(cx.world, &s, &list, wish);
    tell(cx, &s, before, counts);
    Ok(())
}

/// The rows of a snapshot, checked.
fn particles(s: &Snapshot, wish: &Wish, w: &World) -> Result<Vec<Particle>> {
    let id = wish.named(s, "id")?;
    let kind = if wish.add == Add::No { None } else { Some(wish.named(s, "type")?) };
    let mut columns = vec![];
    for &f in &wish.fields {
        columns.push((f, wish.column(s, f)?));
    }
    let mut list = Vec::with_capacity(s.len());
    s.rows(|line, words| {
        let tag = whole(line, words[id], "the id")?;
        let Some(tag) = u32::try_from(tag).ok().filter(|t| *t >= 1) else {
            return fail(Code::BAD_VALUE, line.span_of(words[id]), format!("`{tag}` is no id"));
        };
        let mut p = Particle { tag, kind: 1, values: [0.0; 12] };
        if let Some(k) = kind {
            let t = whole(line, words[k], "the type")?;
            p.kind = match u16::try_from(t) {
                Ok(t) if t >= 1 && usize::from(t) <= w.types => t,
                _ => {
                    let text = format!("there are types 1 to {}, not {t}", w.types);
                    return fail(Code::BAD_VALUE, line.span_of(words[k]), text);
                }
            };
        }
        for &(f, (k, scaled, _)) in &columns {
            let a = number(line, words[k], FIELDS[f])?;
            p.values[f] = if scaled { s.lo[f] + a * (s.hi[f] - s.lo[f]) } else { a };
        }
        list.push(p);
        Ok(())
    })?;
    let tags: Vec<u32> = list.iter().map(|p| p.tag).collect();
    if let Some((a, _)) = Index::new(&tags).twice(&tags) {
        return fail(Code::DUPLICATE_NAME, s.title, format!("the snapshot has two particles {}", tags[a]));
    }
    Ok(list)
}

/// Puts a snapshot into the world; how many particles were purged, replaced, trimmed and added.
fn enter(w: &mut World, s: &Snapshot, list: &[Particle], wish: &Wish) -> [usize; 4] {
    if wish.timestep {
        w.clock.reset(s.step);
    }
    if wish.domain {
        let mut domain = Domain::new(s.lo, s.hi, w.settings.boundary);
        domain.open_shrinking_faces();
        w.domain = Some(domain);
    }
    let tags: Vec<u32> = list.iter().map(|p| p.tag).collect();
    let index = Index::new(&tags);
    let gone: Vec<bool> = w
        .particles
        .tag
        .iter()
        .map(|t| wish.purge || (wish.trim && index.find(*t, &tags).is_none()))
        .collect();
    let left = gone.iter().filter(|g| **g).count();
    if left > 0 {
        w.delete(&gone, false);
    }
    let here = Index::new(&w.particles.tag);
    let known: Vec<Option<usize>> = list.iter().map(|p| here.find(p.tag, &w.particles.tag)).collect();
    let unwrapped = unwraps(s, wish);
    let (mut replaced, mut added) = (0, 0);
    let mut next = w.particles.last_tag();
    for (p, place) in list.iter().zip(known) {
        match place {
            Some(i) if wish.replace => {
                set(w, i, p, wish, unwrapped);
                replaced += 1;
            }
            None if wish.add != Add::No => {
                next += u32::from(wish.add == Add::Yes);
                let tag = if wish.add == Add::Yes { next } else { p.tag };
                w.particles.push(tag, p.kind, [0.0; 3]);
                let i = w.n() - 1;
                set(w, i, p, wish, false);
                if let Some(x0) = w.particles.x0.get_mut(i) {
                    *x0 = w.particles.x[i];
                }
                added += 1;
            }
            _ => {}
        }
    }
    let n = w.n();
    w.columns.resize(n);
    w.spread_type_masses();
    settle(w);
    w.slots.invalidate();
    w.touch();
    let (purged, trimmed) = if wish.purge { (left, 0) } else { (0, left) };
    [purged, replaced, trimmed, added]
}

/// Whether positions of the snapshot have never been wrapped, so that image flags begin anew.
fn unwraps(s: &Snapshot, wish: &Wish) -> bool {
    let places = wish.fields.iter().filter(|f| **f < 3);
    places.filter_map(|f| wish.column(s, *f).ok()).any(|(_, _, wrapped)| !wrapped)
}

fn set(w: &mut World, i: usize, p: &Particle, wish: &Wish, unwrapped: bool) {
    let mut image = if unwrapped { [0; 3] } else { w.particles.image[i] };
    for &f in &wish.fields {
        let (value, d) = (p.values[f], f % 3);
        match f / 3 {
            0 => w.particles.x[i][d] = value,
            1 => w.particles.v[i][d] = value,
            2 => image[d] = value as i32,
            _ => w.particles.f[i][d] = value,
        }
    }
    w.particles.image.set(i, image);
}

fn tell(cx: &mut ActCx, s: &Snapshot, before: usize, [purged, replaced, trimmed, added]: [usize; 4]) {
    cx.say("Scanning dump file ...");
    cx.say("Reading snapshot from dump file ...");
    if let Some(d) = &cx.world.domain {
        let text = |x: [f64; 3]| x.map(|x| general(x, 8)).join(" ");
        let line = format!("  orthogonal box = ({}) to ({})", text(d.lo), text(d.hi));
        cx.say(line);
    }
    let after = cx.world.n();
    for (count, what) in [
        (before, "before read"),
        (s.len(), "in snapshot"),
        (purged, "purged"),
        (replaced, "replaced"),
        (trimmed, "trimmed"),
        (added, "added"),
        (after, "after read"),
    ] {
        cx.say(format!("  {count} atoms {what}"));
    }
}

/// Snapshots of several dumps one after the other, as `rerun` takes them.
pub struct Reel {
    files: std::vec::IntoIter<Word>,
    now: Option<(Arc<Source>, usize)>,
    /// No snapshot before this step.
    pub first: i64,
    /// None after this one.
    pub last: i64,
    every: i64,
    skip: i64,
    wish: Wish,
    /// Step of the last snapshot taken.
    step: Option<i64>,
    /// Snapshots that could have been taken since then.
    passed: i64,
}

/// A `rerun` line.
pub struct Rerun {
    /// The snapshots.
    pub reel: Reel,
    /// Where ramps begin.
    pub start: Option<i64>,
    /// Where ramps end.
    pub stop: Option<i64>,
    /// Whether tables of time follow.
    pub post: bool,
}

impl Rerun {
    /// Reads the words of `rerun`.
    ///
    /// # Errors
    /// Every mistake in the line.
    pub fn read(a: &mut Args, cx: &BuildCx) -> Result<Self> {
        const KEYS: [&str; 8] = ["first", "last", "every", "skip", "start", "stop", "post", "dump"];
        let mut files = vec![a.expect("a dump to read")?.clone()];
        while let Some(word) = a.peek().filter(|w| !KEYS.contains(&w.text.as_str())) {
            files.push(word.clone());
            a.next();
        }
        let (mut first, mut last, mut every, mut skip) = (0, i64::MAX, 0, 1);
        let (mut start, mut stop, mut post) = (None, None, false);
        let wish = loop {
            match a.expect("the keyword `dump` with the fields to read")?.text.as_str() {
                "first" => first = a.integer_from(0, "the first step")?,
                "last" => last = a.integer_from(0, "the last step")?,
                "every" => every = a.integer_from(0, "the interval of snapshots")?,
                "skip" => skip = a.integer_from(1, "the number of snapshots for one that is read")?,
                "start" => start = Some(a.integer_from(0, "the first step of ramps")?),
                "stop" => stop = Some(a.integer_from(0, "the last step of ramps")?),
                "post" => post = a.flag("post")?,
                _ => break Wish::read(a, cx)?,
            }
        };
        if last < first {
            return fail(
                Code::BAD_VALUE,
                a.span(),
                format!("`last` must not be before `first`: {last} is before {first}"),
            );
        }
        let files = files.into_iter();
        let reel = Reel { files, now: None, first, last, every, skip, wish, step: None, passed: 0 };
        Ok(Self { reel, start, stop, post })
    }
}

impl Reel {
    /// Puts the next snapshot into the world; `false` when there is none.
    ///
    /// # Errors
    /// Dumps that cannot be read.
    pub fn next(&mut self, w: &mut World) -> Result<bool> {
        loop {
            let (text, at) = match self.now.take() {
                Some(now) => now,
                None => match self.files.next() {
                    Some(file) => (open(&file, w)?, 0),
                    None => return Ok(false),
                },
            };
            let mut lines = Lines::at(&text.text, at);
            let taken = self.advance(&mut lines, w).map_err(|e| e.within(&text))?;
            let at = lines.position();
            if let Some(step) = taken {
                // The clock belongs to the snapshot whatever `timestep` says.
                w.clock.reset(step);
                self.now = Some((text, at));
                return Ok(true);
            }
        }
    }

    /// The next wanted snapshot of one file; its step.
    fn advance(&mut self, lines: &mut Lines, w: &mut World) -> Result<Option<i64>> {
        while let Some(s) = dump::next(lines)? {
            if s.step > self.last {
                self.files = vec![].into_iter();
                return Ok(None);
            }
            if s.step < self.first || self.step.is_some_and(|last| s.step <= last) {
                continue;
            }
            if self.step.is_some() {
                if self.every > 0 && s.step % self.every != 0 {
                    continue;
                }
                self.passed += 1;
                if self.passed < self.skip {
                    continue;
                }
            }
            (self.step, self.passed) = (Some(s.step), 0);
            let list = particles(&s, &self.wish, w)?;
            enter(w, &s, &list, &self.wish);
            return Ok(Some(s.step));
        }
        Ok(None)
    }
}
