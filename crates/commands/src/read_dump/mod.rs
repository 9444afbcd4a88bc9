//! `read_dump`: positions, velocities, image flags and forces from a snapshot of a text dump.

mod reel;
mod snapshot;

use super::data::dump::{self, Snapshot};
use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_geometry::text::{Lines, comes, find};
use perigrain_lang::{Args, Word};
use perigrain_styles::common::{domain, on_particles};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
pub use reel::{RERUN, Reel, Rerun};
use snapshot::{enter, particles};
use std::collections::BTreeMap;

/// The command.
pub struct ReadDump;

/// What can be read, in LAMMPS' words.
const FIELDS: [&str; 12] = ["x", "y", "z", "vx", "vy", "vz", "ix", "iy", "iz", "fx", "fy", "fz"];
impl Style for ReadDump {
    fn name(&self) -> &'static str {
        "read_dump"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Takes positions, velocities, image flags or forces from a snapshot of a text dump.",
            text: "The file is one of `dump atom` or `dump custom`, packed with gzip if its name ends in `.gz`; it needs a column \
                   `id`. For `x` the first of the columns `x xs xu xsu` is taken (scaled, unwrapped, both), likewise for `y` and \
                   `z`.\n\n\
                   Particles are wrapped and shrink-wrapped faces follow afterwards. Positions at creation and peridynamic bonds \
                   stay as they are. The formats xyz, molfile and adios and files per processor are refused.",
            example: "write_dump all custom now.dump id type x y z vx vy vz\nread_dump now.dump 0 x y z vx vy vz",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The file.
    #[word(name = "FILE", what = "a file name", kind = Kind::File)]
    file: Word,
    /// The snapshot's step.
    #[word(name = "STEP")]
    step: At<i64>,
    #[word(flatten)]
    wanted: Wanted,
}

/// What is read of a snapshot.
#[derive(Words)]
#[word(refused = "nfile q")]
struct Wanted {
    /// What is read: places, velocities, image counts, forces.
    #[word(name = "FIELD", what = "field", least = 1)]
    fields: Vec<At<Field>>,
    /// Whether the snapshot's box takes the place of the box.
    #[word(keyword = "box", default = true)]
    domain: bool,
    /// Whether the snapshot's step becomes that of the clock.
    #[word(keyword, default = true)]
    timestep: bool,
    /// Whether particles with the same id are overwritten.
    #[word(keyword, default = true)]
    replace: bool,
    /// Whether all particles are deleted first; goes with `replace no`.
    #[word(keyword, default = false)]
    purge: bool,
    /// Whether particles that are not in the snapshot are deleted.
    #[word(keyword, default = false)]
    trim: bool,
    #[word(keyword, default = Add::No)]
    add: Add,
    /// The column of a field, of `id` or of `type`.
    #[word(keyword, name = "FIELD COLUMN", what = "the label of a column")]
    label: Vec<(Word, String)>,
    /// Whether places in labelled columns are parts of the box.
    #[word(keyword, default = false)]
    scaled: bool,
    /// Whether places in labelled columns are wrapped into the box.
    #[word(keyword, default = true)]
    wrapped: bool,
    #[word(keyword)]
    format: Option<Format>,
}

/// What can be read, in LAMMPS' words.
#[derive(Clone, Copy, Words)]
#[word(what = "field")]
enum Field {
    X,
    Y,
    Z,
    Vx,
    Vy,
    Vz,
    Ix,
    Iy,
    Iz,
    Fx,
    Fy,
    Fz,
}

/// How dumps are written.
#[derive(Words)]
#[word(what = "format of read_dump", refused = "xyz adios molfile")]
enum Format {
    Native,
}

/// What happens to particles that only the snapshot has.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "value of add")]
enum Add {
    /// Particles that are only in the snapshot are left out.
    No,
    /// They get new ids behind the largest; needs a column `type`.
    Yes,
    /// They keep their ids; needs a column `type`.
    Keep,
}

/// A parsed line.
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
        let Line { file, step: At { value: step, span: at, .. }, wanted } = read(a, cx)?;
        let wish = Wish::new(wanted, a, cx)?;
        if cx.checking {
            comes(cx.world, &file, "dump")?;
        }
        Ok(on_particles(vec![], move |cx| enter_snapshot(cx, &file, step, at, &wish)))
    }
}

impl Wish {
    /// Takes the fields and keywords of a line.
    fn read(a: &mut Args, cx: &BuildCx) -> Result<Self> {
        let wanted = read(a, cx)?;
        Self::new(wanted, a, cx)
    }

    fn new(wanted: Wanted, a: &Args, cx: &BuildCx) -> Result<Self> {
        let mut w = Self {
            fields: vec![],
            labels: BTreeMap::new(),
            scaled: wanted.scaled,
            wrapped: wanted.wrapped,
            domain: wanted.domain,
            timestep: wanted.timestep,
            replace: wanted.replace,
            purge: wanted.purge,
            trim: wanted.trim,
            add: wanted.add,
            span: a.span(),
        };
        for At { value: field, span, .. } in wanted.fields {
            let (k, name) = (field as usize, FIELDS[field as usize]);
            if cx.world.settings.two_dimensional && k % 3 == 2 {
                return fail(Code::CONFLICT, span, format!("a flat scene has no `{name}` to read"));
            }
            if w.fields.contains(&k) {
                return fail(Code::CONFLICT, span, format!("`{name}` is named twice"));
            }
            w.fields.push(k);
        }
        for (field, column) in wanted.label {
            if !FIELDS.iter().chain(&["id", "type"]).any(|known| *known == field.text) {
                return Err(a.unknown(&field, &FIELDS));
            }
            w.labels.insert(field.text, column);
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
        Err(d.label(self.span, "requested here").into())
    }
}

/// Reads the snapshot of a step, which the line names at `at`, into the scene.
fn enter_snapshot(cx: &mut ActCx, file: &Word, step: i64, at: Span, wish: &Wish) -> Result<()> {
    let text = find(cx.world, file, "dump")?;
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
    log_summary(cx, &s, before, counts);
    Ok(())
}

fn log_summary(cx: &mut ActCx, s: &Snapshot, before: usize, [purged, replaced, trimmed, added]: [usize; 4]) {
    cx.print("Scanning dump file ...");
    cx.print("Reading snapshot from dump file ...");
    if let Some(d) = &*cx.world.domain {
        let line = format!("  {}", d.describe(d.lo, d.hi));
        cx.print(line);
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
        cx.print(format!("  {count} atoms {what}"));
    }
}
