//! The step table: which columns, when, and the op that prints a row.

mod printing;

use super::keywords;
use super::ops::Lost;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail, nearest};
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_output::thermo::{Column, Layout, Line};
use perigrain_styles::{BuildCx, Wants};
use perigrain_world::World;
use perigrain_world::bonds::LostBond;
use std::collections::BTreeSet;

/// What becomes of a run whose energy has grown beyond reason (`thermo_modify energy`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Runaway {
    /// It ends with an error.
    Error,
    /// The log warns once.
    Warn,
    /// Nothing.
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
        let named = match args.peek() {
            Some(word) if word.text.starts_with("v_") => ValueRef::parse(&word.text, word.span)?,
            _ => None,
        };
        match &named {
            Some(r) => {
                args.next();
                cx.value(r, false)?;
            }
            None => self.every = args.integer_from(0, "the interval of thermo output")?,
        }
        self.named = named;
        args.finish()
    }

    /// `thermo_style style …`; formats given before are reset, as in LAMMPS.
    ///
    /// # Errors
    /// Unknown styles and columns.
    pub fn style(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let style = args.choice("thermo style", &["one", "multi", "yaml", "custom"])?;
        let (layout, sources) = match style {
            "custom" => columns(args.rest(), cx)?,
            _ => {
                args.finish()?;
                let layout = match style {
                    "multi" => Layout::multi(),
                    "yaml" => Layout::yaml(),
                    _ => Layout::one(),
                };
                let sources = sources_of(&layout);
                (layout, sources)
            }
        };
        let Self { every, named, modified, mut forgotten, .. } = std::mem::take(self);
        if !modified.is_empty() {
            forgotten.0 = args.name_span();
            forgotten.1.extend(modified);
        }
        self.forgotten = forgotten;
        (self.every, self.named, self.layout, self.sources) = (every, named, layout, sources);
        self.built_in = style != "custom";
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
        const KNOWN: [&str; 11] = [
            "lost",
            "lost/bond",
            "energy",
            "warn",
            "norm",
            "flush",
            "line",
            "colname",
            "format",
            "temp",
            "press",
        ];
        if args.is_empty() {
            return fail(Code::MISSING_ARGUMENT, args.here(), "thermo_modify needs a keyword");
        }
        while let Some(word) = args.next() {
            self.modified.insert(word.text.clone());
            self.forgotten.1.remove(&word.text);
            match word.text.as_str() {
                "norm" => self.norm = Some(args.flag("norm")?),
                "flush" => self.layout.flush = args.flag("flush")?,
                "line" => {
                    self.layout.line = match args.choice("line style", &["one", "multi", "yaml"])? {
                        "multi" => Line::Multi,
                        "yaml" => Line::Yaml,
                        _ => Line::One,
                    }
                }
                "lost" => {
                    self.lost = match args.choice("value of lost", &["error", "warn", "ignore"])? {
                        "error" => Lost::Error,
                        "warn" => Lost::Warn,
                        _ => Lost::Ignore,
                    }
                }
                "lost/bond" => {
                    self.lost_bond = match args.choice("value of lost/bond", &["error", "warn", "ignore"])? {
                        "error" => LostBond::Error,
                        "warn" => LostBond::Warn,
                        _ => LostBond::Ignore,
                    }
                }
                "energy" => {
                    self.runaway =
                        Some(match args.choice("value of energy", &["error", "warn", "ignore"])? {
                            "error" => Runaway::Error,
                            "warn" => Runaway::Warn,
                            _ => Runaway::Ignore,
                        });
                }
                "warn" => {
                    if !["ignore", "reset", "default", "always"].contains(&args.peek_text()) {
                        args.integer_from(0, "the number of warnings (or ignore, reset, default, always)")?;
                    } else {
                        args.next();
                    }
                    no_effect(cx, word, "without effect: every warning is printed once here");
                }
                "triclinic/general" if args.flag("triclinic/general")? => {
                    let text = "there are no general triclinic boxes in perigrain";
                    return fail(Code::NOT_SUPPORTED, word.span, text);
                }
                "triclinic/general" => {}
                "format" => self.format(args)?,
                "colname" => match args.peek_text() {
                    "default" => {
                        args.next();
                        self.layout.rename_default();
                    }
                    _ => {
                        let which = args.expect("a column")?;
                        let name = args.expect("the column's new name")?;
                        self.layout.rename(&which.text, &name.text).map_err(|e| e.at(which.span))?;
                    }
                },
                "temp" => {
                    let r = existing(args, cx, "temp")?;
                    self.temp = r.name.clone();
                    self.new_temperature = Some(r);
                }
                "press" => {
                    let r = existing(args, cx, "pressure")?;
                    if cx.names.compute_style(&r.name).is_some_and(|style| style != "pressure") {
                        let d = Diagnostic::error(
                            Code::WRONG_KIND,
                            r.span,
                            format!("compute `{}` is no pressure", r.name),
                        );
                        return Err(d.help("name a `compute ID all pressure …`").into());
                    }
                    self.press = r.name;
                    self.new_temperature = None;
                }
                _ => return Err(args.unknown(word, &KNOWN)),
            }
        }
        Ok(())
    }

    fn format(&mut self, args: &mut Args) -> Result<()> {
        let which = args.expect("line, int, float, none or a column")?;
        if which.text == "none" {
            self.layout.format_none();
            return Ok(());
        }
        let text = args.expect("a format such as %20.15g")?;
        match which.text.as_str() {
            "line" => self.layout.format_line(&text.text),
            "int" => self.layout.format_int(&text.text),
            "float" => self.layout.format_float(&text.text),
            column => self.layout.format_column(column, &text.text),
        }
        .map_err(|e| e.at(text.span))
    }
}

/// A note at a word that changes nothing here.
fn no_effect(cx: &BuildCx, word: &Word, text: &str) {
    cx.note(Diagnostic::note(Code::NO_EFFECT, word.span, text));
}

/// An existing compute.
fn existing(args: &mut Args, cx: &BuildCx, what: &str) -> Result<ValueRef> {
    let word = args.expect("the ID of a compute")?;
    let r = ValueRef { kind: RefKind::Compute, name: word.text.clone(), index: vec![], span: word.span };
    cx.value(&r, false).map_err(|e| {
        let mut e = e;
        e.0.iter_mut()
            .for_each(|d| d.help.push(format!("define it with `compute {} all {what} …`", word.text)));
        e
    })?;
    match cx.names.compute(&r.name) {
        Some(s) if s.vector != 6 => {
            fail(Code::WRONG_KIND, word.span, format!("compute `{}` is no {what}", r.name))
        }
        _ => Ok(r),
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
