//! Dumps `xyz`, `yaml` and `cfg`: like `dump custom` in other formats.

use super::attribute::{Attribute, Core, Source};
use super::base::{Base, Files, OfFile};
use super::columns::{Columns, Formatted, Timed};
use super::text::{Form, Layout, OfYaml, Text};
use super::{Dump, DumpStyle, MODIFY};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_styles::words::{Form as Line, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// `dump … xyz`.
pub struct Xyz;

/// `dump … yaml`.
pub struct Yaml;

/// `dump … cfg`.
pub struct Cfg;

impl Style for Xyz {
    fn name(&self) -> &'static str {
        "xyz"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Line::behind(OfFile::GRAMMAR), Line::headed(MODIFY, Timed::GRAMMAR)] },
            ),
            summary: "Writes the group's particles every N steps as an XYZ file.",
            text: "Each snapshot is the number of particles, a line of comment with the step, and a row `name x y z` per \
                   particle. The name is the type's number unless `dump_modify ID element A B …` names types. \
                   The only format is `format line \"%s %g %g %g\"`; the time stands in the comment. Rows are sorted by id unless set otherwise.",
            example: "dump 1 all xyz 100 grains.xyz",
        }
    }
}

impl Style for Yaml {
    fn name(&self) -> &'static str {
        "yaml"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Line::behind(Columns::GRAMMAR), Line::headed(MODIFY, OfYaml::GRAMMAR)] },
            ),
            summary: "Writes chosen attributes of the group's particles every N steps as YAML documents.",
            text: "Each snapshot is a YAML document that any YAML reader takes. With `thermo yes`, in the first snapshot of a second run \
                   LAMMPS repeats the last run's row; here it is that run's own.",
            example: "dump 1 all yaml 100 flow.yaml id type x y z",
        }
    }
}

impl Style for Cfg {
    fn name(&self) -> &'static str {
        "cfg"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Line::behind(Columns::GRAMMAR), Line::headed(MODIFY, Formatted::GRAMMAR)] },
            ),
            summary: "Writes the group's particles every N steps in the extended CFG format of AtomEye, one file each.",
            text: "The file name needs a `*`. The first five attributes are `mass type xs ys zs` or `mass type xsu ysu zsu`; \
                   all others of `dump custom` may follow as auxiliary properties. Types are written by name: `C` unless \
                   `dump_modify ID element A B …` names them. With unwrapped positions the cell is ten times larger, as \
                   in LAMMPS.",
            example: "dump 1 all cfg 100 flow.*.cfg mass type xs ys zs vx",
        }
    }
}

impl DumpStyle for Xyz {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        xyz(Files::any(self.name()), args, cx)
    }
}

impl DumpStyle for Yaml {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        let line: Columns = read(args, cx)?;
        let base = Base::new(Files::any(self.name()), &line.target.file, cx)?;
        Ok(Box::new(Text::new(base, Form::Yaml, Layout::Custom(line.attributes(cx)?))))
    }
}

impl DumpStyle for Cfg {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        cfg(Files::any(self.name()), args, cx)
    }
}

/// A dump of style `xyz` into these files.
pub(super) fn xyz(files: Files, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
    let mut base = Base::new(files, &read::<OfFile>(args, cx)?.file, cx)?;
    base.elements = (1..=cx.world.types).map(|k| k.to_string()).collect();
    let mut columns = vec![Attribute::core("element", Core::Element)];
    columns.extend((0..3).map(|k| Attribute::core(["x", "y", "z"][k], Core::X(k))));
    Ok(Box::new(Text::new(base, Form::Xyz, Layout::Custom(columns))))
}

/// A dump of style `cfg` into these files.
pub(super) fn cfg(files: Files, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
    let line: Columns = read(args, cx)?;
    let base = Base::new(files, &line.target.file, cx)?;
    base.needs_star(line.attributes[0].span, cx)?;
    let mut columns = line.attributes(cx)?;
    let begins =
        |names: [&str; 5]| columns.len() >= 5 && columns.iter().zip(names).all(|(c, name)| c.word == name);
    let unwrapped = begins(["mass", "type", "xsu", "ysu", "zsu"]);
    if !unwrapped && !begins(["mass", "type", "xs", "ys", "zs"]) {
        let text = "the attributes of dump cfg begin with `mass type xs ys zs` or `mass type xsu ysu zsu`";
        return Err(Diagnostic::error(Code::BAD_VALUE, line.attributes[0].span, text).into());
    }
    columns[1].source = Source::Core(Core::Element);
    for c in &mut columns {
        // As in LAMMPS: no brackets in the names of auxiliary properties.
        c.word = c.word.replace("][", "_").replace('[', "_").replace(']', "");
    }
    if unwrapped {
        (0..3).for_each(|k| columns[2 + k].source = Source::Core(Core::Tenth(k)));
    }
    let form = Form::Cfg(if unwrapped { 10.0 } else { 1.0 });
    let mut dump = Text::new(base, form, Layout::Custom(columns));
    dump.default_format(0, "%f")?;
    Ok(Box::new(dump))
}
