//! fix print: prints a line of text with current values every N steps.

use super::ave_time::later;
use super::{AtRest, Facts, Fix, FixStyle};
use perigrain_base::diag::{Result, Span};
use perigrain_lang::{Args, RefKind, ValueRef};
use perigrain_output::Sheet;
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, Kind, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, FORMULAS, SealCx, Style};
use perigrain_world::World;
use perigrain_world::field::{F, TORQUE};
use std::path::PathBuf;

/// The style.
pub struct Print;

impl Style for Print {
    fn name(&self) -> &'static str {
        "print"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Prints a text with the values of variables and formulas in it every N steps.",
            text: "Prints at the start of a run too if that step is a multiple of N. The group means nothing.",
            example: "fix say all print 1 \"step $(step): ke $(ke:%.4g)\" file said.txt screen no",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Prints at multiples of N, or at the steps that `v_name` of an equal-style variable names: each time the next one
    /// (`logfreq`, `stride` …).
    #[word(name = "N")]
    pace: Pace,
    /// The text to print, in double quotes, in which `$x`, `${name}` and `$(formula:%8.3f)` wait: they are replaced anew each
    /// time.
    #[word(name = "\"text\"")]
    text: At<String>,
    /// The text also goes to this file.
    #[word(keyword, name = "name", what = "the file's name")]
    file: Option<At<PathBuf>>,
    /// The text also goes to this file, behind what it holds.
    #[word(keyword, name = "name", what = "the file's name")]
    append: Option<At<PathBuf>>,
    /// Whether screen and log get the text.
    #[word(keyword, what = "screen", default = true)]
    screen: bool,
    /// The first line of the file.
    #[word(keyword, name = "\"text\"", what = "the title", shown = "# Fix print output for fix ID")]
    title: Option<String>,
}

/// When to print.
#[derive(Clone)]
pub enum Pace {
    /// At multiples of a number.
    Every(i64),
    /// At the steps that a variable names.
    Named(ValueRef),
}

impl Value for Pace {
    const KIND: Kind = Kind::Param;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        if let Some(word) = args.peek()
            && let Some(r) = ValueRef::parse(&word.text, word.span)?
            && r.kind == RefKind::Variable
        {
            args.next();
            cx.value(&r, false)?;
            return Ok(Pace::Named(r));
        }
        Ok(Pace::Every(args.integer_from(1, "the number of steps N")?))
    }
}

impl Pace {
    /// The steps of the coming run.
    ///
    /// # Errors
    /// A variable that names no steps.
    pub fn when(&self, cx: &mut dyn SealCx) -> Result<When> {
        match self {
            Pace::Every(n) => Ok(When::Every(*n)),
            Pace::Named(r) => cx.steps(r),
        }
    }
}

impl FixStyle for Print {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { pace, text, file, append, screen, title } = read(args, cx)?;
        let id = cx.id.to_string();
        let file = later(file.as_ref(), append.as_ref()).map(|(path, append)| (path.to_path_buf(), append));
        let title = title.unwrap_or_else(|| format!("# Fix print output for fix {id}"));
        Ok(Box::new(Declared { id, pace, text: text.value, place: text.span, file, screen, title }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    pace: Pace,
    text: String,
    place: Span,
    file: Option<(PathBuf, bool)>,
    screen: bool,
    title: String,
}

impl Fix for Declared {
    fn facts(&self, _: &World) -> Facts {
        Facts {
            at_rest: AtRest::Acts,
            file: self.file.as_ref().map(|(path, _)| path.clone()),
            ..Facts::default()
        }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        match &self.file {
            Some((path, append)) if !w.promised.instead => {
                Sheet::begin(path, *append, &format!("{}\n", self.title)).map(drop)
            }
            _ => Ok(()),
        }
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let when = self.pace.when(cx)?;
        let mut text = cx.text(&self.text, self.place, Stage::Output, &when)?;
        let mut sheet = self.file.as_ref().map(|(path, _)| Sheet::new(path, None));
        let (log, screen) = (cx.log(), self.screen);
        let access = Needs::new().read(FORMULAS | F | TORQUE);
        let op = StepOp::new(format!("fix {} print", self.id), Stage::Output, access, move |w, t| {
            // `pre no` omits the line that a setup prints.
            if t.setup && w.clock.onward {
                return Ok(());
            }
            let line = text(w)?;
            if screen {
                log.line(&line)?;
            }
            sheet.as_mut().map_or(Ok(()), |s| s.block(&format!("{line}\n")))
        });
        Ok(vec![op.when(when).boxed()])
    }
}
