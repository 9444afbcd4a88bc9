//! The step table: which columns, when, and the op that prints a row.

mod printing;
pub mod words;

use super::keywords;
use super::ops::Lost;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail, nearest};
use perigrain_lang::{Args, ValueRef, Word};
use perigrain_output::thermo::{Column, Layout, Line};
use perigrain_styles::words::{Forms, Given, Or, Reference, Steps, Words, read};
use perigrain_styles::{BuildCx, Wants};
use perigrain_world::World;
use perigrain_world::bonds::LostBond;
use std::collections::BTreeSet;
use words::{Interval, Modify, Style};

/// What becomes of a run whose energy has grown beyond reason (`thermo_modify energy`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Words)]
#[word(what = "value of energy")]
pub enum Runaway {
    /// Energy that has grown beyond reason ends the run; the default but for `compat lammps`.
    Error,
    /// The log warns once; the default of `compat lammps`.
    Warn,
    /// It is not checked.
    Ignore,
}

/// What the step table shows and when.
#[derive(Clone, Debug)]
pub struct Thermo {
    /// Interval in steps; 0 for first and last only.
    pub every: i64,
    /// The variable that names the next step with a row, instead of an interval.
    pub named: Option<ValueRef>,
    /// What happens to particles beyond a fixed face.
    pub lost: Lost,
    /// `thermo_modify lost/bond`.
    pub lost_bond: LostBond,
    /// `thermo_modify temp` names another temperature, which the pressure is still to take.
    pub new_temperature: Option<ValueRef>,
    /// The settings of `thermo_modify`, which a new style resets.
    modified: BTreeSet<String>,
    /// The settings that a new style has reset and no `thermo_modify` has made since, and the place of that style.
    forgotten: (Span, BTreeSet<String>),
    /// `thermo_modify energy`.
    pub runaway: Option<Runaway>,
    /// Columns and formats.
    pub layout: Layout,
    /// What each column reads.
    pub sources: Vec<Source>,
    /// ID of the temperature compute.
    pub temp: String,
    /// ID of the pressure compute.
    pub press: String,
    /// ID of the potential-energy compute.
    pub pe: String,
    /// A built-in style (`one`, `multi`, `yaml`) shows the volume too where the box changes.
    pub built_in: bool,
    /// `thermo_modify norm`; by default yes in lj units.
    pub norm: Option<bool>,
}

/// What a column reads.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A thermo keyword.
    Keyword(String, Span),
    /// A compute, fix or variable.
    Ref(ValueRef),
}

impl Default for Thermo {
    fn default() -> Self {
        let layout = Layout::one();
        let sources = sources_of(&layout);
        let id = |s: &str| format!("thermo_{s}");
        Self {
            every: 0,
            named: None,
            lost: Lost::Error,
            lost_bond: LostBond::Error,
            new_temperature: None,
            modified: BTreeSet::new(),
            forgotten: Default::default(),
            runaway: None,
            layout,
            sources,
            temp: id("temp"),
            press: id("press"),
            pe: id("pe"),
            built_in: true,
            norm: None,
        }
    }
}

fn sources_of(layout: &Layout) -> Vec<Source> {
    layout.columns.iter().map(|c| Source::Keyword(c.name.clone(), Span::default())).collect()
}

impl Thermo {
    /// Whether energies are printed per particle.
    pub fn normalized(&self, w: &World) -> bool {
        self.norm.unwrap_or(w.settings.units.is_reduced())
    }

    /// `thermo N` or `thermo v_name`.
    ///
    /// # Errors
    /// Anything but a whole number from 0 or an equal-style variable.
    pub fn interval(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        self.named = match read::<Interval>(args, cx)?.every {
            Or::Word(Reference(r)) => Some(r),
            Or::Else(Steps(n)) => {
                self.every = n;
                None
            }
        };
        Ok(())
    }

    /// `thermo_style style …`; formats given before are reset, as in LAMMPS.
    ///
    /// # Errors
    /// Unknown styles and columns.
    pub fn style(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let built_in = |layout: Layout| (sources_of(&layout), layout, true);
        let (sources, layout, built_in) = match Style::form(args, cx)? {
            Style::One => built_in(Layout::one()),
            Style::Multi => built_in(Layout::multi()),
            Style::Yaml => built_in(Layout::yaml()),
            Style::Custom(custom) => {
                let (layout, sources) = columns(&custom.columns, cx)?;
                (sources, layout, false)
            }
        };
        let Self { every, named, modified, mut forgotten, .. } = std::mem::take(self);
        if !modified.is_empty() {
            forgotten.0 = args.name_span();
            forgotten.1.extend(modified);
        }
        self.forgotten = forgotten;
        (self.every, self.named, self.layout, self.sources) = (every, named, layout, sources);
        self.built_in = built_in;
        Ok(())
    }

    /// One more column, behind the others.
    ///
    /// # Errors
    /// Words that are no column here.
    pub fn add_column(&mut self, word: &Word, cx: &BuildCx) -> Result<()> {
        let (layout, sources) = columns(std::slice::from_ref(word), cx)?;
        self.layout.columns.extend(layout.columns);
        self.sources.extend(sources);
        Ok(())
    }

    /// A note on the settings that a new style has reset, if no line has made them again by the time of a run.
    pub fn forgotten(&self) -> Option<Diagnostic> {
        let (span, words) = &self.forgotten;
        if words.is_empty() {
            return None;
        }
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let text =
            format!("this thermo_style resets what thermo_modify has set before: {}", words.join(", "));
        let note = Diagnostic::note(Code::SUSPICIOUS, *span, text);
        Some(note.help("put the thermo_modify line behind it"))
    }

    /// `thermo_modify …`.
    ///
    /// # Errors
    /// Unknown keywords and formats that do not fit.
    pub fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        if args.is_empty() {
            return fail(Code::MISSING_ARGUMENT, args.here(), "thermo_modify needs a keyword");
        }
        for Given { word, value, .. } in read::<Modify>(args, cx)?.settings.0 {
            self.modified.insert(word.text.clone());
            self.forgotten.1.remove(&word.text);
            self.set(value, &word, cx)?;
        }
        Ok(())
    }
}

fn columns(words: &[Word], cx: &BuildCx) -> Result<(Layout, Vec<Source>)> {
    let (mut list, mut sources) = (vec![], vec![]);
    for word in words {
        if keywords::find(&word.text).is_some()
            && let Some(column) = Column::keyword(&word.text)
        {
            list.push(column);
            sources.push(Source::Keyword(word.text.clone(), word.span));
            continue;
        }
        for word in cx.expand(word, Wants::Number)? {
            let Some(r) = ValueRef::parse(&word.text, word.span)? else { return Err(unknown(&word)) };
            cx.value(&r, false)?;
            list.push(Column::reference(&word.text, cx.names.extensive(&r)));
            sources.push(Source::Ref(r));
        }
    }
    if list.is_empty() {
        return fail(Code::MISSING_ARGUMENT, cx.span, "thermo_style custom needs at least one column");
    }
    Ok((Layout::new(list, Line::One), sources))
}

fn unknown(word: &Word) -> perigrain_base::diag::Diagnostics {
    let known = keywords::KEYWORDS.iter().map(|(n, ..)| *n);
    let text = format!("thermo output has no column `{}`", word.text);
    let d = Diagnostic::error(Code::UNKNOWN_KEYWORD, word.span, text);
    match nearest(&word.text, known) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d.help("a column is a keyword such as `step pe ke`, or c_ID, f_ID, v_name"),
    }
    .into()
}
