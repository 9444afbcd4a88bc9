//! `read_dump`: positions, velocities, image flags and forces from a snapshot of a text dump.

mod reel;
mod snapshot;

use super::data::dump::{self, Snapshot};
use super::data::text::{Lines, comes, find};
use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, Word};
use perigrain_styles::common::{bad_keyword, domain, on_particles};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
pub use reel::{Reel, Rerun};
use snapshot::{enter, particles};
use std::collections::BTreeMap;

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
            example: "write_dump all custom now.dump id type x y z vx vy vz\nread_dump now.dump 0 x y z vx vy vz",
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
        let file = a.expect("a file name")?.clone();
        let at = a.here();
        let step = a.integer("the snapshot's step")?;
        let wish = Wish::read(a, cx)?;
        if cx.checking {
            comes(cx.world, &file, "dump")?;
        }
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
                "format" => drop(perigrain_styles::common::choice_or_refuse(
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
        Err(d.label(self.span, "requested here").into())
    }
}

/// Reads the snapshot of a step, which the line names at `at`, into the scene.
fn read(cx: &mut ActCx, file: &Word, step: i64, at: Span, wish: &Wish) -> Result<()> {
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
