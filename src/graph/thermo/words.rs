//! The words of `thermo`, `thermo_style` and `thermo_modify`.

use super::{Runaway, Thermo};
use crate::graph::ops::Lost;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{RefKind, ValueRef, Word};
use perigrain_output::thermo::Line;
use perigrain_styles::BuildCx;
use perigrain_styles::words::{Each, Idle, Or, Reference, Steps, Words};
use perigrain_world::bonds::LostBond;

/// The words of a `thermo` line.
#[derive(Words)]
pub struct Interval {
    /// Rows are printed at its multiples, and always at the first and last step of a run; with 0 (as without the command) only there.
    /// A variable names the next step with a row each time one has come, from the clock alone: `logfreq(10,3,10)`, `stride(0,100,7)`.
    #[word(name = "N", what = "the interval of thermo output")]
    pub(super) every: Or<Reference, Steps>,
}

/// The styles of `thermo_style`.
#[derive(Words)]
#[word(forms = "thermo_style", what = "thermo style")]
pub enum Style {
    /// One row for a step with `step temp epair emol etotal press`, the default.
    One,
    /// Several lines for a step with `etotal ke temp pe ebond eangle edihed eimp evdwl ecoul elong press`.
    Multi,
    /// A YAML document with `step temp ke pe ebond eangle edihed eimp evdwl ecoul elong press`.
    Yaml,
    /// One row for a step with these columns.
    Custom(Custom),
}

/// The columns of `thermo_style custom`.
#[derive(Words)]
pub struct Custom {
    #[word(name = "column", kind = Kind::Column)]
    pub(super) columns: Vec<Word>,
}

/// The words of a `thermo_modify` line.
#[derive(Words)]
pub struct Modify {
    #[word(flatten)]
    pub(super) settings: Each<Setting>,
}

/// A setting of `thermo_modify`.
#[derive(Words)]
#[word(keywords)]
pub(super) enum Setting {
    /// Whether energies are those per particle; without it yes in `units lj` and no elsewhere.
    #[word(once)]
    Norm(#[word(what = "norm")] bool),
    /// Whether every row reaches the log file at once; without it rows that come faster than ten in a second wait for the next one.
    #[word(once)]
    Flush(#[word(what = "flush")] bool),
    #[word(once)]
    Line(#[word(name = "layout", like = Layouts)] Line),
    Format(#[word(name = "format")] Or<Formats, OfColumn>),
    Colname(#[word(name = "name")] Or<Names, Renamed>),
    /// The temperature that `temp` and `ke` show; the pressure uses it too, unless `press` follows.
    #[word(once)]
    Temp(#[word(name = "ID", what = "the ID of a compute", kind = Kind::Compute)] Word),
    /// The pressure.
    #[word(once)]
    Press(#[word(name = "ID", what = "the ID of a compute", kind = Kind::Compute)] Word),
    #[word(once)]
    Lost(#[word(name = "lost")] Lost),
    /// A bond of which one end is lost: `error` (default) ends the run; `ignore` and `warn` continue without its force.
    #[word(word = "lost/bond", once)]
    LostBond(#[word(name = "lost", like = LostBonds)] LostBond),
    #[word(once)]
    Energy(#[word(name = "energy")] Runaway),
    /// Read for LAMMPS' decks, with a note that it has no effect.
    #[word(once)]
    Warn(
        #[word(name = "N", what = "the number of warnings (or ignore, reset, default, always)")]
        Idle<Or<Warnings, Steps>>,
    ),
    /// Read for LAMMPS' decks: `yes` is refused.
    #[word(word = "triclinic/general", once)]
    Triclinic(#[word(what = "triclinic/general")] bool),
}

/// The layouts of a row.
#[derive(Words)]
#[word(what = "line style", of = Line)]
pub(super) enum Layouts {
    /// All columns of a step are on one line.
    One,
    /// All columns of a step are on several lines.
    Multi,
    /// All columns of a step are an item of a YAML list.
    Yaml,
}

/// What becomes of a run in which a bond has lost one of its ends.
#[derive(Words)]
#[word(what = "value of lost/bond", of = LostBond)]
pub(super) enum LostBonds {
    Error,
    Warn,
    Ignore,
}

/// Formats of many columns.
#[derive(Words)]
#[word(what = "format")]
pub(super) enum Formats {
    /// Takes all formats back.
    None,
    /// One conversion per column.
    Line(#[word(name = "\"F\"", what = "a format such as %20.15g")] Word),
    /// The format of whole numbers, as `%d`; it wins over that of the line.
    Int(#[word(name = "F", what = "a format such as %20.15g")] Word),
    /// The format of other numbers, as `%g`; it wins over that of the line.
    Float(#[word(name = "F", what = "a format such as %20.15g")] Word),
}

/// The format of one column.
#[derive(Words)]
pub(super) struct OfColumn {
    /// The format of one column, which wins over all others; N counts from 1, from -1 backwards.
    #[word(name = "N|NAME", what = "line, int, float, none or a column", kind = Kind::Column)]
    column: Word,
    #[word(name = "F", what = "a format such as %20.15g")]
    format: Word,
}

/// Names of all columns.
#[derive(Words)]
#[word(what = "name")]
pub(super) enum Names {
    /// Takes all names back.
    Default,
}

/// The name of one column.
#[derive(Words)]
pub(super) struct Renamed {
    /// The name of a column in the head of the table.
    #[word(name = "N|NAME", what = "a column", kind = Kind::Column)]
    column: Word,
    #[word(name = "text", what = "the column's new name")]
    name: Word,
}

/// Which warnings LAMMPS prints.
#[derive(Words)]
#[word(what = "value of warn")]
pub(super) enum Warnings {
    Ignore,
    Reset,
    Default,
    Always,
}

impl Thermo {
    /// Makes a setting of `thermo_modify`; `word` is its keyword.
    ///
    /// # Errors
    /// Formats and names that do not fit, computes that are none.
    pub(super) fn set(&mut self, setting: Setting, word: &Word, cx: &BuildCx) -> Result<()> {
        match setting {
            Setting::Norm(yes) => self.norm = Some(yes),
            Setting::Flush(yes) => self.layout.flush = yes,
            Setting::Line(line) => self.layout.line = line,
            Setting::Format(format) => self.format(format)?,
            Setting::Colname(Or::Word(Names::Default)) => self.layout.rename_default(),
            Setting::Colname(Or::Else(Renamed { column, name })) => {
                self.layout.rename(&column.text, &name.text).map_err(|e| e.at(column.span))?;
            }
            Setting::Temp(id) => {
                let r = existing(&id, cx, "temp")?;
                self.temp = r.name.clone();
                self.new_temperature = Some(r);
            }
            Setting::Press(id) => {
                let r = existing(&id, cx, "pressure")?;
                if cx.names.compute_style(&r.name).is_some_and(|style| style != "pressure") {
                    let text = format!("compute `{}` is no pressure", r.name);
                    let d = Diagnostic::error(Code::WRONG_KIND, r.span, text);
                    return Err(d.help("name a `compute ID all pressure …`").into());
                }
                self.press = r.name;
                self.new_temperature = None;
            }
            Setting::Lost(lost) => self.lost = lost,
            Setting::LostBond(lost) => self.lost_bond = lost,
            Setting::Energy(runaway) => self.runaway = Some(runaway),
            Setting::Warn(_) => {
                let text = "without effect: every warning is printed once here";
                cx.note(Diagnostic::note(Code::NO_EFFECT, word.span, text));
            }
            Setting::Triclinic(false) => {}
            Setting::Triclinic(true) => {
                let text = "there are no general triclinic boxes in perigrain";
                return fail(Code::NOT_SUPPORTED, word.span, text);
            }
        }
        Ok(())
    }

    fn format(&mut self, format: Or<Formats, OfColumn>) -> Result<()> {
        let (outcome, text) = match format {
            Or::Word(Formats::None) => {
                self.layout.format_none();
                return Ok(());
            }
            Or::Word(Formats::Line(text)) => (self.layout.format_line(&text.text), text),
            Or::Word(Formats::Int(text)) => (self.layout.format_int(&text.text), text),
            Or::Word(Formats::Float(text)) => (self.layout.format_float(&text.text), text),
            Or::Else(OfColumn { column, format }) => {
                (self.layout.format_column(&column.text, &format.text), format)
            }
        };
        outcome.map_err(|e| e.at(text.span))
    }
}

/// An existing compute.
fn existing(word: &Word, cx: &BuildCx, what: &str) -> Result<ValueRef> {
    let r = ValueRef { kind: RefKind::Compute, name: word.text.clone(), index: vec![], span: word.span };
    cx.value(&r, false).map_err(|mut e| {
        let help = format!("define it with `compute {} all {what} …`", word.text);
        e.0.iter_mut().for_each(|d| d.help.push(help.clone()));
        e
    })?;
    match cx.names.compute(&r.name) {
        Some(s) if s.vector != 6 => {
            fail(Code::WRONG_KIND, word.span, format!("compute `{}` is no {what}", r.name))
        }
        _ => Ok(r),
    }
}
