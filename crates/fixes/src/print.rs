//! fix print: prints a line of text with current values every N steps.

use super::{Facts, Fix, FixStyle};
use perigrain_base::diag::{Result, Span};
use perigrain_lang::{Args, RefKind, ValueRef};
use perigrain_output::Sheet;
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::step_op::StepOp;
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
            syntax: "fix ID group print N \"text\" [file name] [append name] [screen yes|no] [title \"text\"]",
            summary: "Prints a text with the values of variables and formulas in it every N steps.",
            text: "`$x`, `${name}` and `$(formula:%8.3f)` in the text are replaced anew each time: write it in double quotes, \
                   in which they wait. N is a number of steps, or `v_name` of an equal-style variable that names the next \
                   step each time it has come (`logfreq`, `stride` …). `file` or `append`: the text also goes to that file, \
                   whose first line is `title` (`# Fix print output for fix ID`); `screen no` keeps it from screen and log. \
                   Prints at the start of a run too if that step is a multiple of N. The group means nothing.",
            example: "fix say all print 1 \"step $(step): ke $(ke:%.4g)\" file said.txt screen no",
        }
    }
}

/// When to print.
#[derive(Clone)]
pub enum Pace {
    /// At multiples of a number.
    Every(i64),
    /// At the steps that a variable names.
    Named(ValueRef),
}

impl Pace {
    /// Parses a number not below `least`, or a variable.
    ///
    /// # Errors
    /// Other words.
    pub fn read(args: &mut Args, cx: &BuildCx, least: i64, what: &str) -> Result<Self> {
        if let Some(word) = args.peek()
            && let Some(r) = ValueRef::parse(&word.text, word.span)?
            && r.kind == RefKind::Variable
        {
            args.next();
            cx.value(&r, false)?;
            return Ok(Pace::Named(r));
        }
        Ok(Pace::Every(args.integer_from(least, what)?))
    }

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
        let pace = Pace::read(args, cx, 1, "the number of steps N")?;
        let word = args.expect("the text to print")?;
        let mut fix = Declared {
            id: cx.id.to_string(),
            pace,
            text: word.text.clone(),
            place: word.span,
            file: None,
            screen: true,
            title: format!("# Fix print output for fix {}", cx.id),
        };
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "file" | "append" => {
                    let name = PathBuf::from(&args.expect("the file's name")?.text);
                    fix.file = Some((name, word.text == "append"));
                }
                "screen" => fix.screen = args.flag("screen")?,
                "title" => fix.title = args.expect("the title")?.text.clone(),
                _ => return Err(args.unknown(word, &["file", "append", "screen", "title"])),
            }
        }
        Ok(Box::new(fix))
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
        Facts { file: self.file.as_ref().map(|(path, _)| path.clone()), ..Facts::default() }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        match &self.file {
            Some((path, append)) if !w.parts.promised.instead => {
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
