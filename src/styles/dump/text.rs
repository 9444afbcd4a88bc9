//! Dumps `atom` and `custom`: LAMMPS' text format.

use super::attribute::{Attribute, Core, expand};
use super::base::{Base, Sort, unknown};
use super::{Dump, DumpStyle};
use crate::diag::{Code, Result, fail};
use crate::lang::{Args, Word};
use crate::out::dump::{Field, Snapshot};
use crate::out::formats::{Formats, Kind};
use crate::plan::Op;
use crate::styles::{BuildCx, Doc, SealCx, Style};

/// `dump … atom`.
pub struct Atom;

/// `dump … custom`.
pub struct Custom;

/// The page of `custom`.
const PAGE: &str = "Attributes: `id type mass proc procp1`, positions `x y z`, as fractions of the box `xs ys zs`, \
    with box crossings undone `xu yu zu xsu ysu zsu`, box crossings `ix iy iz`, velocities `vx vy vz`, forces \
    `fx fy fz`, for spheres `radius diameter omegax omegay omegaz tqx tqy tqz`, for peridynamic particles `volume`, and \
    per-atom values `c_ID c_ID[k] c_ID[*] f_ID f_ID[k] v_name`.\n\n\
    `dump_modify ID keyword value …` understands `append yes|no` (go on behind an existing file), `colname N name`, \
    `every N`, `first yes|no` (also the first step of the first run), `format line \"…\"`, `format int %d`, \
    `format float %g`, `format N %…` (one column), `format none`, `pad N` (digits of the step in file names), \
    `region ID|none`, `sort id|off|N|-N`, `thresh attribute < <= > >= == != value` (several must all hold; \
    `thresh none`), `time yes|no` and `units yes|no` (further header lines).\n\n\
    Rows are sorted by id unless told otherwise (LAMMPS: unsorted). A `*` in the file name becomes the step, and each \
    snapshot then has a file of its own that appears only when it is complete. Compressed and binary files are refused.";

impl Style for Atom {
    fn name(&self) -> &'static str {
        "atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "dump ID group atom N file",
            summary: "Writes id, type and position of the group's particles every N steps.",
            text: "Columns `id type xs ys zs`: positions are fractions of the box, 0 at the lower and 1 at the upper \
                   face. `dump_modify ID scale no` writes plain coordinates `x y z`, `image yes` adds the box \
                   crossings `ix iy iz`. Everything else is as for `dump custom`.",
            example: "dump 1 all atom 100 flow.dump",
        }
    }
}

impl Style for Custom {
    fn name(&self) -> &'static str {
        "custom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "dump ID group custom N file attribute …",
            summary: "Writes chosen attributes of the group's particles every N steps as text.",
            text: PAGE,
            example: "dump 1 all custom 100 plate.*.dump id type x y z c_damage\ndump_modify 1 thresh c_damage > 0.1",
        }
    }
}

impl DumpStyle for Atom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        let base = Base::new("atom", args, cx, &[])?;
        let layout = Layout::Atom { scaled: true, image: false };
        Ok(Box::new(Text {
            base,
            layout,
            formats: Formats::default(),
            names: vec![],
            time: false,
            units: false,
        }))
    }
}

impl DumpStyle for Custom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        let base = Base::new("custom", args, cx, &[])?;
        let mut attributes = vec![];
        // `modify` ends the attributes of write_dump.
        while let Some(word) = args.peek().filter(|w| w.text != "modify") {
            args.next();
            attributes.extend(expand(word, cx)?);
        }
        if attributes.is_empty() {
            args.expect("a particle attribute such as id or x")?;
            return fail(
                Code::MISSING_ARGUMENT,
                args.here(),
                "dump custom needs an attribute such as id or x",
            );
        }
        let layout = Layout::Custom(attributes);
        Ok(Box::new(Text {
            base,
            layout,
            formats: Formats::default(),
            names: vec![],
            time: false,
            units: false,
        }))
    }
}

/// Which columns.
#[derive(Clone, Debug)]
enum Layout {
    Atom { scaled: bool, image: bool },
    Custom(Vec<Attribute>),
}

impl Layout {
    fn attributes(&self) -> Vec<Attribute> {
        let (scaled, image) = match self {
            Self::Custom(attributes) => return attributes.clone(),
            Self::Atom { scaled, image } => (*scaled, *image),
        };
        let mut list = vec![Attribute::core("id", Core::Id), Attribute::core("type", Core::Kind)];
        for k in 0..3 {
            list.push(match scaled {
                true => Attribute::core(["xs", "ys", "zs"][k], Core::Scaled(k)),
                false => Attribute::core(["x", "y", "z"][k], Core::X(k)),
            });
        }
        if image {
            list.extend((0..3).map(|k| Attribute::core(["ix", "iy", "iz"][k], Core::Image(k))));
        }
        list
    }
}

/// A declared text dump.
#[derive(Clone, Debug)]
struct Text {
    base: Base,
    layout: Layout,
    formats: Formats,
    /// Column names that `colname` has set.
    names: Vec<(usize, String)>,
    time: bool,
    units: bool,
}

impl Dump for Text {
    fn op(&self, cx: &mut dyn SealCx, every: i64) -> Result<Box<dyn Op>> {
        let attributes = self.layout.attributes();
        if let Sort::Column(k, _) = self.base.sort
            && k >= attributes.len()
        {
            return fail(
                Code::BAD_VALUE,
                cx.span(),
                format!("dump_modify sort: there is no column {}", k + 1),
            );
        }
        let dump = self.clone();
        let shown = attributes.clone();
        self.base.seal(cx, every, &attributes, move |shot| {
            let w = shot.world;
            let domain = w.domain()?;
            let letters = domain.boundary.letters();
            let fields: Vec<Field<'_>> = shot
                .data
                .into_iter()
                .enumerate()
                .map(|(k, data)| {
                    let renamed = dump.names.iter().rev().find(|(column, _)| *column == k);
                    let name = renamed.map_or(shown[k].word.as_str(), |(_, name)| name);
                    Field { name, format: dump.formats.of(k, shown[k].kind()), data }
                })
                .collect();
            let target = &mut shot.state.target;
            let snapshot = Snapshot {
                step: shot.step,
                time: dump.time.then(|| w.clock.time()),
                units: (dump.units && target.is_fresh()).then(|| w.settings.units.name()),
                bounds: [0, 1, 2].map(|k| [domain.lo[k], domain.hi[k]]),
                boundary: &letters,
                rows: &shot.rows,
                fields: &fields,
            };
            target.write(shot.step, |to| snapshot.write(to))
        })
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        while let Some(word) = args.next() {
            if !self.base.modify(word, args, cx)? && !self.own(word, args)? {
                let own: &[&str] = match self.layout {
                    Layout::Atom { .. } => &["colname", "format", "image", "scale", "time", "units"],
                    Layout::Custom(_) => &["colname", "format", "time", "units"],
                };
                return Err(unknown(word, args, own));
            }
        }
        Ok(())
    }

    fn every(&self) -> Option<i64> {
        self.base.every()
    }

    fn boxed(&self) -> Box<dyn Dump> {
        Box::new(self.clone())
    }
}

impl Text {
    /// One keyword of these two styles.
    fn own(&mut self, word: &Word, args: &mut Args) -> Result<bool> {
        match (word.text.as_str(), &mut self.layout) {
            ("time", _) => self.time = args.flag("time")?,
            ("units", _) => self.units = args.flag("units")?,
            ("format", _) => self.format(args)?,
            ("colname", _) => self.rename(args)?,
            ("scale", Layout::Atom { scaled, .. }) => *scaled = args.flag("scale")?,
            ("image", Layout::Atom { image, .. }) => *image = args.flag("image")?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn format(&mut self, args: &mut Args) -> Result<()> {
        let which = args.expect("line, int, float, a column or none")?;
        if which.text == "none" {
            self.formats.clear();
            return Ok(());
        }
        let kinds: Vec<Kind> = self.layout.attributes().iter().map(Attribute::kind).collect();
        let column = match which.text.as_str() {
            "line" | "int" | "float" => None,
            _ => Some(self.column(which, kinds.len())?),
        };
        let word = args.expect("a format such as %g")?;
        let outcome = match column {
            Some(k) => self.formats.set_column(k, kinds[k], &word.text),
            None if which.text == "line" => self.formats.set_line(&word.text, &kinds),
            None if which.text == "int" => self.formats.set_int(&word.text),
            None => self.formats.set_float(&word.text),
        };
        outcome.map_err(|e| e.at(word.span))
    }

    fn rename(&mut self, args: &mut Args) -> Result<()> {
        let which = args.expect("a column or default")?;
        if which.text == "default" {
            self.names.clear();
            return Ok(());
        }
        let column = self.column(which, self.layout.attributes().len())?;
        let name = args.expect("the column's new name")?;
        self.names.push((column, name.text.clone()));
        Ok(())
    }

    /// A column by number from 1, from -1 backwards, or by name; counted from 0.
    fn column(&self, word: &Word, n: usize) -> Result<usize> {
        if let Some(k) = self.layout.attributes().iter().position(|a| a.word == word.text) {
            return Ok(k);
        }
        let Ok(k) = word.text.parse::<i64>() else {
            return fail(Code::UNKNOWN_NAME, word.span, format!("this dump has no column `{}`", word.text));
        };
        let index = if k < 0 { n as i64 + k } else { k - 1 };
        match usize::try_from(index) {
            Ok(index) if index < n => Ok(index),
            _ => fail(Code::BAD_VALUE, word.span, format!("this dump has columns 1 to {n}")),
        }
    }
}
