//! Dumps `atom` and `custom`: LAMMPS' text format.

use super::attribute::{Attribute, Core};
use super::base::{Base, Common, Files, OfFile, OfParticles, Sort, column, foreign};
use super::columns::{ColumnFormat, Columns, Formatted, OfColumn, OfColumns, Renamed, Table, Timed, Usual};
use super::{Dump, DumpStyle, MODIFY};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Word};
use perigrain_output::binary::Binary;
use perigrain_output::dump::{Field, Snapshot};
use perigrain_output::formats::{Formats, Kind};
use perigrain_output::forms;
use perigrain_output::table_row::LATEST_ROW;
use perigrain_plan::Op;
use perigrain_styles::words::{At, Form as Line, Or, Syntax, Words, read, read_or};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};

/// `dump … atom`.
pub struct Atom;

/// `dump … custom`.
pub struct Custom;

/// Page text of `custom`.
const PAGE: &str = "Attributes: `id type mass proc procp1`, positions `x y z`, as fractions of the box `xs ys zs`, \
    with box crossings undone `xu yu zu xsu ysu zsu`, box crossings `ix iy iz`, velocities `vx vy vz`, forces \
    `fx fy fz`, the type's name `element`, for spheres `radius diameter omegax omegay omegaz tqx tqy tqz`, for peridynamic particles `volume`, and \
    per-atom values `c_ID c_ID[k] c_ID[*] f_ID f_ID[k] v_name`.\n\n\
    The keywords of `dump_modify` that all dumps have stand on its page.\n\n\
    Of a triclinic box the header has the faces of the upright box around it, with a tilt behind each pair (`BOX BOUNDS xy xz yz …`).\n\n\
    Rows are sorted by id unless set otherwise (LAMMPS: unsorted). The file is made, or emptied, when the first run begins. \
    Files of single snapshots appear only when they are complete.\n\n\
    A name that ends in `.gz` is compressed (`dump custom/gz` and its kin also know how tightly). One that ends in `.bin` or `.lammpsbin` is LAMMPS' binary form, here and for `dump atom`, \
    for which formats have no meaning; `read_dump` and `rerun` read it, too. A `%` in the name becomes the number of the process, \
    0, as there is one.";

impl Style for Atom {
    fn name(&self) -> &'static str {
        "atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Line::behind(OfFile::GRAMMAR), Line::headed(MODIFY, OfAtom::GRAMMAR)] },
            ),
            summary: "Writes id, type and position of the group's particles every N steps.",
            text: "Columns `id type xs ys zs`: positions are fractions of the box, 0 at the lower and 1 at the upper \
                   face. Everything else is as for `dump custom`.",
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
            syntax: Syntax::Forms(
                const { &[Line::behind(Columns::GRAMMAR), Line::headed(MODIFY, Table::GRAMMAR)] },
            ),
            summary: "Writes chosen attributes of the group's particles every N steps as text.",
            text: PAGE,
            example: "dump 1 all custom 100 plate.*.dump id type x y z c_damage\ndump_modify 1 thresh c_damage > 0.1",
        }
    }
}

impl DumpStyle for Atom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        atom(Files::any(self.name()), args, cx)
    }
}

impl DumpStyle for Custom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        custom(Files::any(self.name()), args, cx)
    }
}

/// A dump of style `atom` into these files.
pub(super) fn atom(files: Files, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
    let base = Base::new(files, &read::<OfFile>(args, cx)?.file, cx)?;
    Ok(Box::new(Text::new(base, Form::Native, Layout::Atom { scaled: true, image: false })))
}

/// A dump of style `custom` into these files.
pub(super) fn custom(files: Files, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
    let line: Columns = read(args, cx)?;
    let base = Base::new(files, &line.target.file, cx)?;
    Ok(Box::new(Text::new(base, Form::Native, Layout::Custom(line.attributes(cx)?))))
}

/// The keywords of `dump_modify` that dump atom has beside those of all.
#[derive(Words)]
struct OfAtom {
    #[word(flatten)]
    own: Table,
    /// `no` writes plain coordinates `x y z`.
    #[word(keyword, what = "scale")]
    scale: Option<bool>,
    /// Adds the box crossings `ix iy iz`.
    #[word(keyword, what = "image")]
    image: Option<bool>,
}

/// The keywords of `dump_modify` that dump yaml has beside those of all.
#[derive(Words)]
pub(super) struct OfYaml {
    #[word(flatten)]
    own: Table,
    /// Puts the row of the step table into snapshots of steps that have one, each number with all its digits and under its usual name.
    #[word(keyword, what = "thermo")]
    thermo: Option<bool>,
}

/// Output format of a snapshot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// LAMMPS' own text.
    Native,
    /// YAML, one document per snapshot.
    Yaml,
    /// XYZ.
    Xyz,
    /// AtomEye's CFG, with its length scale.
    Cfg(f64),
}

/// Selection of columns.
#[derive(Clone, Debug)]
pub(super) enum Layout {
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
pub(super) struct Text {
    pub(super) base: Base,
    form: Form,
    header: bool,
    layout: Layout,
    formats: Formats,
    /// Column names set by `colname`.
    names: Vec<(usize, String)>,
    time: bool,
    units: bool,
    thermo: bool,
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
                    let named = k == 1 && matches!(dump.form, Form::Cfg(_));
                    let format = dump.formats.of(k, shown[k].kind()).filter(|_| !named);
                    Field { name, format, data }
                })
                .collect();
            let target = &mut shot.state.target;
            let (fresh, binary) = (target.is_fresh(), target.pattern.binary());
            let (bounds, tilt) = (domain.bounds(), domain.tilt);
            let (step, rows, time) = (shot.step, &shot.rows, dump.time.then(|| w.clock.time()));
            let units = dump.units.then(|| w.settings.units.name());
            let row = w.facts.get(*LATEST_ROW).map(|row| &**row).filter(|r| dump.thermo && r.step == step);
            target.write(step, |to| match dump.form {
                Form::Xyz => forms::xyz(to, step, time, rows, &fields),
                Form::Cfg(scale) => forms::cfg(to, scale, domain.edges().vectors(), rows, &fields),
                Form::Yaml => {
                    let (boundary, header) = (letters.as_str(), dump.header);
                    let head = forms::Yaml { step, units, time, boundary, row, bounds, tilt, header };
                    head.write(to, rows, &fields)
                }
                Form::Native if binary => {
                    let (header, boundary) = (dump.header, letters.as_str());
                    let (magic, units) = (dump.magic(), units.filter(|_| fresh));
                    let fields = &fields;
                    Binary { magic, header, step, time, units, bounds, tilt, boundary, rows, fields }
                        .write(to)
                }
                Form::Native => {
                    let units = units.filter(|_| fresh);
                    let header = dump.header;
                    let item = "ATOMS";
                    let boundary = &letters;
                    Snapshot {
                        header,
                        item,
                        step,
                        time,
                        units,
                        bounds,
                        tilt,
                        boundary,
                        rows,
                        fields: &fields,
                    }
                    .write(to)
                }
            })
        })
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        type Shared = (Common, OfParticles);
        let (shared, formats) = match (self.form, &self.layout) {
            (Form::Native, Layout::Atom { .. }) => {
                let (shared, OfAtom { own, scale, image }): (Shared, OfAtom) = read_or(args, cx, foreign)?;
                if let Layout::Atom { scaled, image: shown } = &mut self.layout {
                    (*scaled, *shown) = (scale.unwrap_or(*scaled), image.unwrap_or(*shown));
                }
                (shared, self.table(own)?)
            }
            (Form::Native, _) => {
                let (shared, own): (Shared, Table) = read_or(args, cx, foreign)?;
                (shared, self.table(own)?)
            }
            (Form::Yaml, _) => {
                let (shared, OfYaml { own, thermo }): (Shared, OfYaml) = read_or(args, cx, foreign)?;
                self.thermo = thermo.unwrap_or(self.thermo);
                (shared, self.table(own)?)
            }
            (Form::Xyz, _) => {
                let (shared, own): (Shared, Timed) = read_or(args, cx, foreign)?;
                (shared, self.timed(own))
            }
            (Form::Cfg(_), _) => {
                let (shared, Formatted { format }): (Shared, Formatted) = read_or(args, cx, foreign)?;
                (shared, format)
            }
        };
        let (common, particles) = shared;
        self.base.modify(common, cx)?;
        self.base.select(particles, cx)?;
        formats.into_iter().try_for_each(|format| self.format(format, cx))
    }

    fn every(&self) -> Option<i64> {
        self.base.every()
    }

    fn growing(&self) -> bool {
        self.base.growing()
    }

    fn repeats_row(&self) -> bool {
        self.thermo
    }
}

impl Text {
    /// A dump with these columns.
    pub(super) fn new(base: Base, form: Form, layout: Layout) -> Self {
        let formats = Formats::default();
        Self {
            base,
            form,
            header: true,
            layout,
            formats,
            names: vec![],
            time: false,
            units: false,
            thermo: false,
        }
    }

    /// Sets the default format of a column (from 0), until `dump_modify format` changes it.
    pub(super) fn default_format(&mut self, column: usize, format: &str) -> Result<()> {
        self.formats.set_column(column, Kind::Float, format)
    }

    /// Style name in binary files.
    fn magic(&self) -> &'static str {
        match self.layout {
            Layout::Atom { .. } => "DUMPATOM",
            Layout::Custom(_) => "DUMPCUSTOM",
        }
    }

    /// Takes all but formats of a table's keywords.
    fn table(&mut self, own: Table) -> Result<Vec<At<ColumnFormat>>> {
        self.header = own.header.unwrap_or(self.header);
        self.units = own.units.unwrap_or(self.units);
        for name in own.colname {
            match name {
                Or::Word(Usual::Default) => self.names.clear(),
                Or::Else(Renamed { column, name }) => self.names.push((self.column(&column)?, name)),
            }
        }
        Ok(self.timed(own.timed))
    }

    fn timed(&mut self, own: Timed) -> Vec<At<ColumnFormat>> {
        self.time = own.time.unwrap_or(self.time);
        own.formatted.format
    }

    fn format(&mut self, At { value: format, span, .. }: At<ColumnFormat>, cx: &BuildCx) -> Result<()> {
        if self.base.state().target.pattern.binary() {
            let text = "without effect: binary dumps have numbers whole";
            cx.note(Diagnostic::note(Code::NO_EFFECT, span, text));
        }
        let mut kinds: Vec<Kind> = self.layout.attributes().iter().map(Attribute::kind).collect();
        if let (Form::Cfg(_), Some(kind)) = (self.form, kinds.get_mut(1)) {
            // The deck gives a type; the output is its name, in any format.
            *kind = Kind::Int;
        }
        let line = matches!(format, Or::Word(OfColumns::Line(_) | OfColumns::None));
        if self.form == Form::Xyz && !line {
            return fail(Code::NOT_SUPPORTED, span, "the only format of dump xyz is `format line`");
        }
        let (word, outcome) = match format {
            Or::Word(OfColumns::None) => {
                self.formats.clear();
                return Ok(());
            }
            Or::Word(OfColumns::Line(word)) => (word.span, self.formats.set_line(&word.text, &kinds)),
            Or::Word(OfColumns::Int(word)) => (word.span, self.formats.set_int(&word.text)),
            Or::Word(OfColumns::Float(word)) => (word.span, self.formats.set_float(&word.text)),
            Or::Else(OfColumn { column, format }) => {
                let k = self.column(&column)?;
                (format.span, self.formats.set_column(k, kinds[k], &format.text))
            }
        };
        outcome.map_err(|e| e.at(word))
    }

    /// Parses a column, counted from 0.
    fn column(&self, word: &Word) -> Result<usize> {
        column(word, self.layout.attributes().iter().map(|a| a.word.as_str()))
    }
}
