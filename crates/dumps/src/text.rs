//! Dumps `atom` and `custom`: LAMMPS' text format.

use super::attribute::{Attribute, Core, expand};
use super::base::{Base, Sort, column, unknown};
use super::{Dump, DumpStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Word};
use perigrain_output::binary::Binary;
use perigrain_output::dump::{Field, Snapshot};
use perigrain_output::formats::{Formats, Kind};
use perigrain_output::forms;
use perigrain_plan::Op;
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
    `dump_modify ID keyword value …` understands, for every text dump: `append yes|no` (append to an existing file), \
    `delay N` (nothing before step N), `element A B …` (one name per type, for the attribute `element`), `every N` or \
    `every v_name` (a variable that names the next step), `every/time T|v_name` (multiples of a time, or a variable that names the next time when a run begins and after each snapshot), `first yes|no` (also the \
    first step of the first run), `maxfiles N` (keep the last N of the files of single snapshots), `pad N` (digits of the \
    step in file names), `pbc yes|no` (wrap positions into the box first), `refresh c_ID` (see compute displace/atom), \
    `region ID|none`, `skip v_name` (no snapshot while the variable is not zero), `sort id|off|N|-N`, \
    `thresh attribute < <= > >= == != |^ value|LAST` (several must all hold; LAST is the particle's value at the last \
    snapshot; `thresh none`). This style adds `colname N name`, `format line \"…\"`, `format int %d`, `format float %g`, \
    `format N %…` (one column), `format none`, `header yes|no`, `time yes|no` and `units yes|no` (further header lines). \
    `balance buffer flush` and `types numeric` are read and without effect; `at sfactor tfactor precision \
    unwrap triclinic/general` are refused by name.\n\n\
    Of a triclinic box the header has the faces of the upright box around it, with a tilt behind each pair (`BOX BOUNDS xy xz yz …`).\n\n\
    Rows are sorted by id unless set otherwise (LAMMPS: unsorted). The file is made, or emptied, when the first run begins. \
    A `*` in the file name becomes the step, and each \
    snapshot then has a file of its own that appears only when it is complete. A name that ends in `.gz` is compressed \
    (`dump custom/gz` and its kin also know `compression_level N`). One that ends in `.bin` or `.lammpsbin` is LAMMPS' binary form, here and for `dump atom`, \
    for which formats have no meaning; `read_dump` and `rerun` read it, too. A `%` in the name becomes the number of the process, \
    0, as there is one; `nfile N` and `fileper N` then make no difference.";

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
        atom(Base::new(self.name(), args, cx, &[])?, args, cx)
    }
}

impl DumpStyle for Custom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        custom(Base::new(self.name(), args, cx, &[])?, args, cx)
    }
}

/// A dump of style `atom` into this file.
pub(super) fn atom(base: Base, _: &mut Args, _: &BuildCx) -> Result<Box<dyn Dump>> {
    Ok(Box::new(Text::new(base, Form::Native, Layout::Atom { scaled: true, image: false })))
}

/// A dump of style `custom` into this file; parses its attributes.
pub(super) fn custom(base: Base, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
    let attributes = attributes(args, cx)?;
    Ok(Box::new(Text::new(base, Form::Native, Layout::Custom(attributes))))
}

/// The attributes of a dump.
pub(super) fn attributes(args: &mut Args, cx: &BuildCx) -> Result<Vec<Attribute>> {
    let mut attributes = vec![];
    // `modify` ends the attributes of write_dump.
    while let Some(word) = args.peek().filter(|w| w.text != "modify") {
        args.next();
        attributes.extend(expand(word, cx)?);
    }
    if attributes.is_empty() {
        args.expect("a particle attribute such as id or x")?;
        return fail(Code::MISSING_ARGUMENT, args.here(), "this dump needs an attribute such as id or x");
    }
    Ok(attributes)
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

impl Form {
    /// Additional keywords of `dump_modify`.
    fn keywords(self, atom: bool) -> &'static [&'static str] {
        match self {
            Form::Native if atom => &["colname", "format", "header", "image", "scale", "time", "units"],
            Form::Native => &["colname", "format", "header", "time", "units"],
            Form::Yaml => &["colname", "format", "header", "thermo", "time", "units"],
            Form::Xyz => &["format", "time"],
            Form::Cfg(_) => &["format"],
        }
    }
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
            let row = w.parts.row.as_deref().filter(|r| dump.thermo && r.step == step);
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
        while let Some(word) = args.next() {
            if word.text == "format" && self.base.state().target.pattern.binary() {
                let text = "without effect: binary dumps have numbers whole";
                cx.note(Diagnostic::note(Code::NO_EFFECT, word.span, text));
            }
            if !self.base.modify(word, args, cx)? && !self.own(word, args)? {
                return Err(unknown(word, args, self.own_keywords()));
            }
        }
        Ok(())
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

    fn own_keywords(&self) -> &'static [&'static str] {
        self.form.keywords(matches!(self.layout, Layout::Atom { .. }))
    }

    /// Reads one keyword of these styles.
    fn own(&mut self, word: &Word, args: &mut Args) -> Result<bool> {
        if !self.own_keywords().contains(&word.text.as_str()) {
            return Ok(false);
        }
        match (word.text.as_str(), &mut self.layout) {
            ("header", _) => self.header = args.flag("header")?,
            ("time", _) => self.time = args.flag("time")?,
            ("units", _) => self.units = args.flag("units")?,
            ("thermo", _) => self.thermo = args.flag("thermo")?,
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
        let mut kinds: Vec<Kind> = self.layout.attributes().iter().map(Attribute::kind).collect();
        if let (Form::Cfg(_), Some(kind)) = (self.form, kinds.get_mut(1)) {
            // The deck gives a type; the output is its name, in any format.
            *kind = Kind::Int;
        }
        if self.form == Form::Xyz && which.text != "line" {
            return fail(Code::NOT_SUPPORTED, which.span, "the only format of dump xyz is `format line`");
        }
        let column = match which.text.as_str() {
            "line" | "int" | "float" => None,
            _ => Some(self.column(which)?),
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
        let column = self.column(which)?;
        let name = args.expect("the column's new name")?;
        self.names.push((column, name.text.clone()));
        Ok(())
    }

    /// Parses a column, counted from 0.
    fn column(&self, word: &Word) -> Result<usize> {
        column(word, self.layout.attributes().iter().map(|a| a.word.as_str()))
    }
}
