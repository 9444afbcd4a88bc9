//! The `variable` command: what each style reads, and LAMMPS' rules for names that exist.

use super::{Data, Kind, Variable, Vars, bad_name, is_name};
use crate::diag::{Code, Result, Span, fail, nearest};
use crate::lang::args::{Args, blame};
use crate::lang::command::{Command, Word};
use crate::lang::expr::Expr;
use crate::lang::substitute::{float_format, substitute_known};
use crate::lang::value::Env;

const STYLES: &[&str] = &["index", "loop", "string", "getenv", "format", "equal", "atom", "delete"];
const LATER: &[&str] =
    &["atomfile", "file", "internal", "python", "timer", "uloop", "universe", "world", "vector"];

impl Vars {
    /// The `variable` command.
    pub fn define(&mut self, command: &Command, env: &mut dyn Env) -> Result<()> {
        let mut args = Args::new(command);
        let name = args.expect("the variable's name")?;
        if !is_name(&name.text) {
            return Err(bad_name(&name.text).at(name.span).into());
        }
        let style = args.expect("a style such as equal, index or loop")?;
        if LATER.contains(&style.text.as_str()) {
            let message = format!("variable style `{}` is not in perigrain yet", style.text);
            return Err(blame(style, Code::NOT_SUPPORTED, message).into());
        }
        let Some(style_name) = STYLES.iter().find(|s| **s == style.text) else {
            let d = blame(style, Code::UNKNOWN_STYLE, format!("`{}` is no style of variable", style.text));
            return Err(match nearest(&style.text, STYLES.iter().copied()) {
                Some(n) => d.help(format!("did you mean `{n}`?")),
                None => d.help(format!("one of {}", STYLES.join(" "))),
            }
            .into());
        };
        if *style_name == "delete" {
            args.finish()?;
            self.table.remove(&name.text);
            return Ok(());
        }
        let unknown = command.args.iter().any(|w| w.unknown);
        let mut variable = self.read(style_name, args, env)?;
        variable.unknown |= unknown;
        variable.span = Some(command.span);
        self.insert(name, style, variable)
    }

    /// Takes a new definition in, by LAMMPS' rules for a name that exists.
    fn insert(&mut self, name: &Word, style: &Word, variable: Variable) -> Result<()> {
        let Some(old) = self.table.get(&name.text) else {
            self.table.insert(name.text.clone(), variable);
            return Ok(());
        };
        let kind = variable.kind();
        if matches!(kind, Kind::Index | Kind::Loop) {
            return Ok(());
        }
        if old.kind() != kind {
            let (name, old_kind) = (&name.text, old.kind().name());
            let mut d = blame(
                style,
                Code::DUPLICATE_NAME,
                format!("variable `{name}` is of style {old_kind} already"),
            )
            .help(format!("`variable {name} delete` first, or choose another name"));
            if let Some(span) = old.span {
                d = d.label(span, "defined here");
            }
            return Err(d.into());
        }
        self.table.insert(name.text.clone(), variable);
        Ok(())
    }

    /// Reads what follows the style.
    fn read(&self, style: &str, mut args: Args<'_>, env: &mut dyn Env) -> Result<Variable> {
        let mut unknown = false;
        let data = match style {
            "index" => {
                args.clone().expect("at least one value")?;
                Data::Index { values: args.rest().iter().map(|w| w.text.clone()).collect(), at: 0 }
            }
            "loop" => return read_loop(args).map(|data| Variable { data, span: None, unknown }),
            "string" => {
                let word = args.expect("the text, in quotes if it holds spaces")?;
                let value = substitute_known(&word.text, word.span, self, env)?;
                unknown = value.unknown;
                Data::Text(value.text)
            }
            "getenv" => Data::Getenv(args.expect("the environment variable's name")?.text.clone()),
            "format" => self.read_format(&mut args)?,
            _ => {
                args.clone().expect("a formula")?;
                let (text, span) = joined(args.rest());
                let formula = Expr::parse(&text, span)?;
                if style == "equal" { Data::Equal(formula) } else { Data::Atom(formula) }
            }
        };
        args.finish()?;
        Ok(Variable { data, span: None, unknown })
    }

    fn read_format(&self, args: &mut Args<'_>) -> Result<Data> {
        let of = args.expect("the equal-style variable to format")?;
        match self.kind(&of.text) {
            Some(Kind::Equal) => {}
            Some(k) => {
                let message =
                    format!("`{}` is of style {}, an equal-style variable is needed", of.text, k.name());
                return Err(blame(of, Code::WRONG_KIND, message).into());
            }
            None => return Err(self.unknown(&of.text, of.span).into()),
        }
        let format = args.expect("a format such as %.6g")?;
        float_format(&format.text, format.span)?;
        Ok(Data::Format { name: of.text.clone(), format: format.text.clone() })
    }
}

/// `loop N [pad]` or `loop N1 N2 [pad]`.
fn read_loop(mut args: Args<'_>) -> Result<Data> {
    let mut span = args.here();
    let mut bounds = vec![args.integer("the last number of the loop")?];
    if args.peek().is_some_and(|w| w.text != "pad") {
        span = span.to(args.here());
        bounds.push(args.integer("the last number of the loop, or pad")?);
    }
    let pad = args.eat("pad");
    args.finish()?;
    let (now, last) = if bounds.len() == 1 { (1, bounds[0]) } else { (bounds[0], bounds[1]) };
    if last < now || last < 0 {
        return fail(Code::BAD_VALUE, span, format!("a loop from {now} to {last} has no turns"));
    }
    let width = if pad { last.to_string().len() } else { 0 };
    Ok(Data::Loop { now, last, width })
}

/// Several words as one formula that stands where they stand, with their distances if they fit.
fn joined(words: &[Word]) -> (String, Span) {
    let (Some(first), Some(last)) = (words.first(), words.last()) else {
        return (String::new(), Span::default());
    };
    let mut text = first.text.clone();
    for pair in words.windows(2) {
        let gap = (pair[1].span.start as usize).saturating_sub(pair[0].span.end as usize);
        text.push_str(&" ".repeat(gap.clamp(1, 1000)));
        text.push_str(&pair[1].text);
    }
    (text, first.span.to(last.span))
}
