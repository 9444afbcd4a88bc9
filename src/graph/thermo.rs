//! The step table: which columns, when, and the op that prints a row.

use super::keywords;
use super::seal::Sealer;
use crate::diag::{Code, Diagnostic, Result, Span, fail, nearest};
use crate::lang::{Args, RefKind, ValueRef, Word};
use crate::math::cformat::Value;
use crate::out;
use crate::out::log::Log;
use crate::out::thermo::{Column, Layout, Line, memory_line};
use crate::plan::{Access, Op, Stage, Tick, When};
use crate::styles::{BuildCx, Reading, SealCx, Wants};
use crate::world::{Face, World};

/// What the step table shows and when.
#[derive(Clone, Debug)]
pub struct Thermo {
    /// Interval in steps; 0 for first and last only.
    pub every: i64,
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

    /// `thermo N`.
    ///
    /// # Errors
    /// Anything but a whole number from 0.
    pub fn interval(&mut self, args: &mut Args) -> Result<()> {
        if args.peek_text().starts_with("v_") {
            return fail(
                Code::NOT_SUPPORTED,
                args.here(),
                "thermo with a variable interval is not there yet",
            );
        }
        self.every = args.integer_from(0, "the interval of thermo output")?;
        args.finish()
    }

    /// `thermo_style style …`; formats given before are forgotten, as in LAMMPS.
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
        (self.layout, self.sources, self.norm) = (layout, sources, None);
        self.built_in = style != "custom";
        Ok(())
    }

    /// `thermo_modify …`.
    ///
    /// # Errors
    /// Unknown keywords, formats that do not fit, and `lost ignore|warn`, which is not there.
    pub fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        const KNOWN: [&str; 12] = [
            "lost",
            "lost/bond",
            "warn",
            "norm",
            "flush",
            "line",
            "colname",
            "format",
            "temp",
            "press",
            "triclinic/general",
            "pe",
        ];
        while let Some(word) = args.next() {
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
                    let how = args.expect("error, warn or ignore")?;
                    if how.text != "error" {
                        return Err(Diagnostic::error(
                            Code::NOT_SUPPORTED,
                            how.span,
                            format!(
                                "thermo_modify lost {}: perigrain always stops at a lost particle",
                                how.text
                            ),
                        )
                        .help("use boundary s or m, or a larger box, so that fragments stay inside")
                        .into());
                    }
                }
                "lost/bond" => {
                    args.choice("lost/bond", &["error", "warn", "ignore"])?;
                    cx.note(Diagnostic::note(
                        Code::NO_EFFECT,
                        word.span,
                        "without effect: bonds are never lost here",
                    ));
                }
                "warn" => {
                    args.expect("ignore, reset, default or a number")?;
                    cx.note(Diagnostic::note(
                        Code::NO_EFFECT,
                        word.span,
                        "without effect: warnings are not counted here",
                    ));
                }
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
                "temp" => self.temp = existing(args, cx, "temp")?,
                "press" => self.press = existing(args, cx, "pressure")?,
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

    /// At which steps a row is printed.
    pub fn when(&self) -> When {
        let ends = vec![When::First, When::Last];
        match self.every {
            0 => When::Any(ends),
            n => When::Any([vec![When::Every(n)], ends].concat()),
        }
    }

    /// The op that prints rows, its values asked for.
    ///
    /// # Errors
    /// Columns that name what no longer exists.
    pub fn op(&self, s: &mut Sealer, log: Log) -> Result<Box<dyn Op>> {
        let when = self.when();
        let mut layout = self.layout.clone();
        layout.norm = self.normalized(s.world());
        let mut sources = self.sources.clone();
        if self.built_in && box_changes(s.world()) {
            layout.columns.extend(Column::keyword("vol"));
            sources.push(Source::Keyword("vol".into(), Span::default()));
        }
        let mut readings = vec![];
        for source in &sources {
            readings.push(match source {
                Source::Keyword(name, span) => s.keyword_total(name, *span, Stage::Output, &when)?,
                Source::Ref(r) => s.value(r, Stage::Output, &when)?,
            });
        }
        Ok(Box::new(Row { layout, readings, when, log }))
    }
}

/// Whether a face of the box follows the particles.
fn box_changes(w: &World) -> bool {
    let follows = |f: &Face| matches!(f, Face::Shrink | Face::ShrinkMin);
    w.domain.as_ref().is_some_and(|d| d.boundary.0.iter().flatten().any(follows))
}

/// The ID of an existing compute.
fn existing(args: &mut Args, cx: &BuildCx, what: &str) -> Result<String> {
    let word = args.expect("the ID of a compute")?;
    let r = ValueRef { kind: RefKind::Compute, name: word.text.clone(), index: vec![], span: word.span };
    cx.value(&r, false).map_err(|e| {
        let mut e = e;
        e.0.iter_mut()
            .for_each(|d| d.help.push(format!("define it with `compute {} all {what} …`", word.text)));
        e
    })?;
    Ok(word.text.clone())
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

fn unknown(word: &Word) -> crate::diag::Diagnostics {
    let known = keywords::KEYWORDS.iter().map(|(n, ..)| *n);
    let text = format!("thermo output has no column `{}`", word.text);
    let d = Diagnostic::error(Code::UNKNOWN_KEYWORD, word.span, text);
    match nearest(&word.text, known) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d.help("a column is a keyword such as `step pe ke`, or c_ID, f_ID, v_name"),
    }
    .into()
}

impl Row {
    /// The row as numbers, per particle where it is printed so.
    fn kept(&self, w: &World, t: &Tick) -> (Vec<String>, out::rows::Row) {
        let columns = self.layout.columns.iter().map(|c| c.name.clone()).collect();
        let share = |c: &Column| if self.layout.norm && c.extensive { w.n().max(1) as f64 } else { 1.0 };
        let values =
            self.readings.iter().zip(&self.layout.columns).map(|(r, c)| r.get(w) / share(c)).collect();
        (columns, out::rows::Row { step: t.step, time: w.clock.time(), values })
    }
}

/// Prints a row.
struct Row {
    layout: Layout,
    readings: Vec<Reading>,
    when: When,
    log: Log,
}

impl Op for Row {
    fn name(&self) -> &str {
        "thermo"
    }
    fn stage(&self) -> Stage {
        Stage::Output
    }
    fn access(&self) -> Access {
        Access::new("slots", "log")
    }
    fn when(&self) -> When {
        self.when.clone()
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if t.setup {
            self.log.line(&memory_line(crate::world::memory::bytes(w)))?;
        }
        if t.setup && !self.layout.header().is_empty() {
            self.log.line(&self.layout.header())?;
        }
        let values: Vec<Value> = (self.readings.iter().zip(&self.layout.columns))
            .map(|(r, c)| {
                let a = r.get(w);
                match c.kind {
                    crate::out::thermo::Kind::Int => Value::Int(a as i64),
                    crate::out::thermo::Kind::Float => Value::Float(a),
                }
            })
            .collect();
        let cpu = w.clock.began.map_or(0.0, |b| b.elapsed().as_secs_f64());
        self.log.line(&self.layout.row(t.step, cpu, w.n() as u64, &values))?;
        self.log.row(|| self.kept(w, t));
        if self.layout.flush { self.log.flush() } else { Ok(()) }
    }
    fn finish(&mut self, _w: &mut World) -> Result<()> {
        self.layout.footer().map_or(Ok(()), |text| self.log.line(text))
    }
}
