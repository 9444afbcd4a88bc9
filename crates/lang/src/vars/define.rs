//! The `variable` command: what each style reads, and LAMMPS' rules for names that exist.

use super::files::{AtomFile, Lines};
use super::{Data, Kind, Variable, Vars, bad_name, is_name};
use crate::args::{Args, blame};
use crate::command::{Command, Word};
use crate::flow::Files;
use crate::substitute::{float_format, substitute_known};
use crate::value::Env;
use perigrain_base::comm::broadcast;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail, nearest};
use perigrain_base::math::cformat::Spec;
use std::time::Instant;

const STYLES: &[(&str, Kind)] = &[
    ("index", Kind::Index),
    ("loop", Kind::Loop),
    ("world", Kind::World),
    ("universe", Kind::Universe),
    ("uloop", Kind::Uloop),
    ("string", Kind::Text),
    ("getenv", Kind::Getenv),
    ("file", Kind::File),
    ("atomfile", Kind::Atomfile),
    ("format", Kind::Format),
    ("equal", Kind::Equal),
    ("atom", Kind::Atom),
    ("vector", Kind::Vector),
    ("bond", Kind::Bond),
    ("timer", Kind::Timer),
    ("internal", Kind::Internal),
    ("python", Kind::Python),
];

/// What `timer` variables count from.
static BIRTH: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);

impl Vars {
    /// The `variable` command.
    pub fn define(&mut self, command: &Command, env: &mut dyn Env, files: &dyn Files) -> Result<()> {
        let mut args = Args::new(command);
        let name = args.expect("the variable's name")?;
        if !is_name(&name.text) {
            return Err(bad_name(&name.text).at(name.span).into());
        }
        let style = args.expect("a style such as equal, index or loop")?;
        if style.text == "delete" {
            args.finish()?;
            self.remove(&name.text);
            return Ok(());
        }
        let kind = kind_of(style)?;
        if kind == Kind::Python && self.functions().is_none() {
            return Err(no_python(style).into());
        }
        let old = self.find(&name.text);
        if old.is_some_and(|v| !v.adrift) && kind.stays() {
            return Ok(());
        }
        if let Some(old) = old.filter(|v| v.kind != kind && !v.adrift) {
            let (name, old_kind) = (&name.text, old.kind.name());
            let message = format!("variable `{name}` is of style {old_kind} already");
            let mut d = blame(style, Code::DUPLICATE_NAME, message)
                .help(format!("`variable {name} delete` first, or choose another name"));
            if let Some(span) = old.span {
                d = d.label(span, "defined here");
            }
            return Err(d.into());
        }
        let mut variable = self.read(kind, args, env, files)?;
        if kind.is_shared() {
            self.begin_round(&mut variable);
        }
        variable.unknown |= command.args.iter().any(|w| w.unknown);
        variable.span = Some(command.span);
        self.put_line(&name.text, variable);
        Ok(())
    }

    /// Reads what follows the style.
    fn read(&self, kind: Kind, mut args: Args<'_>, env: &mut dyn Env, files: &dyn Files) -> Result<Variable> {
        let mut unknown = false;
        let data = match kind {
            Kind::Index | Kind::Universe => {
                args.clone().expect("at least one value")?;
                let span = args.here();
                let words = args.rest();
                let span = words.last().map_or(span, |last| span.to(last.span));
                let values: Vec<String> = words.iter().map(|w| w.text.clone()).collect();
                self.same_turns(kind, values.len() as i64, span)?;
                Data::List { values: values.into(), at: 0 }
            }
            Kind::World => {
                let (number, of) = self.partition();
                args.clone().expect("a value for each partition")?;
                let words = args.rest();
                if words.len() != of {
                    let span = words[0].span.to(words[words.len() - 1].span);
                    let text = match of {
                        1 => format!("{} values for the one partition there is", words.len()),
                        _ => format!("{} values for {of} partitions", words.len()),
                    };
                    let d = Diagnostic::error(Code::CONFLICT, span, text);
                    return Err(d
                        .help("`-partition` on the command line sets the number of partitions")
                        .into());
                }
                Data::Text(words[number].text.clone())
            }
            Kind::Loop => read_loop(&mut args, true)?,
            Kind::Uloop => {
                let span = args.here();
                let data = read_loop(&mut args, false)?;
                if let Data::Range { last, .. } = data {
                    self.same_turns(kind, last, span)?;
                }
                data
            }
            Kind::Text => {
                let word = args.expect("the text, in quotes if it holds spaces")?;
                let value = substitute_known(&word.text, word.span, self, env)?;
                unknown = value.unknown;
                Data::Text(value.text)
            }
            Kind::Getenv => {
                let name = args.expect("the environment variable's name")?;
                if let Some(d) = perigrain_base::gate::forbids("a deck may not read the environment") {
                    return Err(d.at(name.span).into());
                }
                Data::Getenv(name.text.clone())
            }
            Kind::File | Kind::Atomfile => {
                let path = args.expect("a file name")?;
                match read_file(kind, path, files)? {
                    Some(data) => data,
                    None => {
                        unknown = true;
                        Data::Text(String::new())
                    }
                }
            }
            Kind::Format => self.read_format(&mut args)?,
            Kind::Equal | Kind::Atom | Kind::Vector | Kind::Bond => {
                args.clone().expect("a formula")?;
                let (text, span) = joined(args.rest());
                Data::Formula(self.formula(&text, span)?)
            }
            Kind::Python => Data::Python(args.expect("the function's name")?.text.clone()),
            Kind::Timer => Data::Number(broadcast::number(|| BIRTH.elapsed().as_secs_f64())),
            Kind::Internal => Data::Number(args.number("the value")?),
        };
        args.finish()?;
        Ok(Variable { unknown, ..Variable::new(kind, data) })
    }

    /// Partitions take from all universe and uloop variables together, so that their lengths must agree.
    fn same_turns(&self, kind: Kind, turns: i64, span: Span) -> Result<()> {
        if kind == Kind::Index {
            return Ok(());
        }
        let (_, of) = self.partition();
        if turns < of as i64 {
            let text = format!("{turns} values are too few for {of} partitions, which begin with one each");
            return fail(Code::CONFLICT, span, text);
        }
        for (name, v) in self.table.iter() {
            let other = match (&v.data, v.kind) {
                (Data::List { values, .. }, Kind::Universe) => values.len() as i64,
                (Data::Range { last, .. }, Kind::Uloop) => *last,
                _ => continue,
            };
            if other != turns && v.turns_known() {
                let message = format!(
                    "universe and uloop variables must have equally many values: `{name}` has {other}, this one {turns}"
                );
                return fail(Code::CONFLICT, span, message);
            }
        }
        Ok(())
    }

    fn read_format(&self, args: &mut Args<'_>) -> Result<Data> {
        let of = args.expect("the equal-style variable to format")?;
        match self.kind(&of.text) {
            Some(Kind::Equal | Kind::Timer | Kind::Internal) => {}
            Some(k) => {
                let message = format!(
                    "`{}` is of style {}; an equal, timer or internal variable is needed",
                    of.text,
                    k.name()
                );
                return Err(blame(of, Code::WRONG_KIND, message).into());
            }
            None => return Err(self.unknown(&of.text, of.span).into()),
        }
        let format = args.expect("a format such as %.6g")?;
        float_format(&format.text, format.span)?;
        let Ok(spec) = Spec::parse(&format.text) else {
            let message = format!("`{}` holds more than a conversion such as %.6g", format.text);
            return Err(blame(format, Code::SYNTAX, message).into());
        };
        if spec.plus || spec.alternate || format.text.contains(['l', 'L']) {
            let message = format!("`{}` has a flag or length that is not taken here", format.text);
            let d = blame(format, Code::FORMAT, message);
            return Err(d.help("write %, then `-` or `0`, a width and a precision, as %-10.4g").into());
        }
        Ok(Data::Format { name: of.text.clone(), format: format.text.clone() })
    }
}

/// The refusal of Python where no Python hosts the session.
pub fn no_python(word: &Word) -> Diagnostic {
    let text = "perigrain has no Python inside, so no python variables";
    blame(word, Code::NOT_SUPPORTED, text)
        .help("a deck that Python executes has them: `perigrain.lammps().file(…)`")
        .help("or compute the value outside and pass it by `-var NAME value`")
}

/// The kind a style word names.
fn kind_of(style: &Word) -> Result<Kind> {
    if let Some((_, kind)) = STYLES.iter().find(|(name, _)| *name == style.text) {
        return Ok(*kind);
    }
    let d = blame(style, Code::UNKNOWN_STYLE, format!("`{}` is no style of variable", style.text));
    let names: Vec<&str> = STYLES.iter().map(|(n, _)| *n).chain(["delete"]).collect();
    Err(match nearest(&style.text, names.iter().copied()) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d.help(format!("one of {}", names.join(" "))),
    }
    .into())
}

/// The content of a file; `None` if it is not there yet but will be (`check` mode).
fn read_file(kind: Kind, path: &Word, files: &dyn Files) -> Result<Option<Data>> {
    if path.unknown {
        return Ok(None);
    }
    let text = match files.read_data(&path.text) {
        Ok(text) => text,
        Err(_) if files.comes_later(&path.text) => return Ok(None),
        Err(e) => return Err(crate::flow::unreadable(path, &e).into()),
    };
    Ok(Some(match kind {
        Kind::File => Data::Lines(Lines::read(&path.text, &text, path.span)?),
        _ => Data::Atoms(AtomFile::read(&path.text, &text, path.span)?),
    }))
}

/// `loop N [pad]`, and where `from` is allowed `loop N1 N2 [pad]`.
fn read_loop(args: &mut Args<'_>, from: bool) -> Result<Data> {
    let mut span = args.here();
    let unknown = args.clone().rest().iter().any(|w| w.unknown);
    let mut bounds = vec![args.integer("the last number of the loop")?];
    if from && args.peek().is_some_and(|w| w.text != "pad") {
        span = span.to(args.here());
        bounds.push(args.integer("the last number of the loop, or pad")?);
    }
    let pad = args.eat("pad");
    let (now, mut last) = if bounds.len() == 1 { (1, bounds[0]) } else { (bounds[0], bounds[1]) };
    if unknown {
        last = last.max(now);
    }
    if last < now || last < 0 {
        return fail(Code::BAD_VALUE, span, format!("a loop from {now} to {last} has no turns"));
    }
    let width = if pad { last.to_string().len() } else { 0 };
    Ok(Data::Range { now, last, width })
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
