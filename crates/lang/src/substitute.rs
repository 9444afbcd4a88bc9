//! `$x`, `${name}`, `$(formula)` and `$(formula:%8.3f)` inside lines and inside quoted text.

use super::expr::balanced;
use super::lex::{Quote, opening, unclosed};
use super::number::printf;
use super::scan::{place, taken};
use super::text::{Mapped, within};
use super::value::Env;
use super::vars::{Text, Vars};
use nom::bytes::complete::{tag, take_until};
use nom::character::complete::{anychar, char};
use nom::combinator::verify;
use nom::sequence::{delimited, preceded};
use nom::{IResult, Parser, branch::alt};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};

/// What stands for a value that is not known yet, so that the line around it can still be checked.
const STAND_IN: &str = "1";

/// How many bytes a line may have with its values in.
const LONGEST: usize = 1 << 24;

/// How many bytes the echoes of one line may have; of the others the last is kept.
const ECHOED: usize = 1 << 20;

/// A text after substitution.
#[derive(Clone, Debug, PartialEq)]
pub struct Substituted {
    /// The text.
    pub text: String,
    /// Whether an unknown value went into it (`check` mode).
    pub unknown: bool,
}

/// What follows a dollar sign.
enum Dollar<'a> {
    Name(&'a str),
    Formula(&'a str),
}

/// Puts values into a text that stands at `span`, outside the quotes within it (as `print` and `if` do).
pub fn substitute(text: &str, span: Span, vars: &Vars, env: &mut dyn Env) -> Result<String> {
    Ok(substitute_known(text, span, vars, env)?.text)
}

/// As [`substitute`], and returns whether all values were known.
pub fn substitute_known(text: &str, span: Span, vars: &Vars, env: &mut dyn Env) -> Result<Substituted> {
    let line = expand(&Mapped::whole(text, span, None, false), vars, env, None)?;
    let unknown = line.unknown(0..line.text.len().max(1));
    Ok(Substituted { text: line.text, unknown })
}

/// Puts values into a line outside its quotes; `echoes` gets the line after each of them.
pub(super) fn expand(
    line: &Mapped,
    vars: &Vars,
    env: &mut dyn Env,
    mut echoes: Option<&mut Vec<String>>,
) -> Result<Mapped> {
    let text = line.text.as_str();
    let mut out = Mapped::with_room(text.len());
    let (mut rest, mut from) = (text, 0);
    let (mut echoed, mut passed_over) = (0, false);
    let open_quote = |(q, open): (Quote, &str)| {
        let at = place(text, open);
        unclosed(q, line.span(at..at + 1))
    };
    while let Some(found) = outside_quotes(rest).map_err(open_quote)? {
        rest = found;
        let at = place(text, rest);
        let Ok((after, dollar)) = dollar(rest) else { return Err(no_dollar(line, rest)) };
        let range = at..place(text, after);
        let value = lookup(line, &dollar, range.clone(), vars, env)?;
        out.append(line, from..at);
        let shown = if value.unknown { STAND_IN } else { &value.text };
        if out.text.len() + shown.len() > LONGEST {
            let text = format!("with this value in, the line would be longer than {LONGEST} characters");
            return fail(Code::TOO_LARGE, line.span(range), text);
        }
        out.push_value(shown, line.span(range.clone()), value.origin, value.unknown);
        (rest, from) = (after, range.end);
        echoed += out.text.len() + rest.len();
        passed_over = echoed > ECHOED;
        if let Some(echoes) = echoes.as_mut().filter(|_| !passed_over) {
            let mut echo = String::with_capacity(out.text.len() + rest.len());
            echo.push_str(&out.text);
            echo.push_str(rest);
            echoes.push(echo);
        }
    }
    if from == 0 {
        return Ok(line.clone());
    }
    out.append(line, from..text.len());
    if let Some(echoes) = echoes.filter(|_| passed_over) {
        echoes.push(out.text.clone());
    }
    Ok(out)
}

/// The text from its first `$` outside quotes on, `None` if there is none; an error is the quote that is never closed, and
/// the text from it on.
pub(super) fn outside_quotes(text: &str) -> std::result::Result<Option<&str>, (Quote, &str)> {
    let mut rest = text;
    while let Some(k) = rest.bytes().position(|b| matches!(b, b'"' | b'\'' | b'$')) {
        rest = &rest[k..];
        if rest.starts_with('$') {
            return Ok(Some(rest));
        }
        let Ok((inside, quote)) = opening(rest) else { return Ok(None) };
        let Some(end) = inside.find(quote.mark()) else { return Err((quote, rest)) };
        rest = &inside[end + quote.mark().len()..];
    }
    Ok(None)
}

fn dollar(input: &str) -> IResult<&str, Dollar<'_>> {
    let braces = delimited(tag("{"), take_until("}"), char('}')).map(Dollar::Name);
    let formula = delimited(char('('), balanced, char(')')).map(Dollar::Formula);
    let single = taken(verify(anychar, |c| !"{(\"' \t\r\n$".contains(*c))).map(Dollar::Name);
    preceded(char('$'), alt((braces, formula, single))).parse(input)
}

/// A dollar sign that no variable follows.
fn no_dollar(line: &Mapped, rest: &str) -> perigrain_base::diag::Diagnostics {
    let at = place(&line.text, rest);
    let (end, message) = match rest.as_bytes().get(1) {
        Some(b'{') => (line.text.len(), "this ${ is never closed by }"),
        Some(b'(') => (line.text.len(), "this $( is never closed by )"),
        _ => (at + 1, "a variable's name is expected after $"),
    };
    let d = Diagnostic::error(Code::SYNTAX, line.span(at..end), message);
    d.help("write $x, ${name} or $(formula); put text with a $ of its own into quotes").into()
}

fn lookup(
    line: &Mapped,
    dollar: &Dollar<'_>,
    range: std::ops::Range<usize>,
    vars: &Vars,
    env: &mut dyn Env,
) -> Result<Text> {
    let span = line.span(range.clone());
    let whole = match dollar {
        Dollar::Name(name) => {
            let braced = line.text[range.start..].starts_with("${");
            let longer = if braced { "" } else { &line.text[range.start + 1..] };
            return vars.text(name, longer, span, env);
        }
        Dollar::Formula(text) => *text,
    };
    let at = range.start + 2;
    let (formula, format) = match whole.rfind(':') {
        Some(k) => (&whole[..k], Some(&whole[k + 1..])),
        None => (whole, None),
    };
    let place = line.span(at..(at + formula.len()).max(at + 1));
    let place = if formula.is_empty() { span } else { place };
    let value = vars.formula(formula, place)?.number(vars, env)?;
    let Some(value) = value else {
        return Ok(Text { text: String::new(), origin: None, unknown: true });
    };
    let text = match format {
        None => perigrain_base::math::cformat::general(value + 0.0, 20),
        Some(f) => {
            let place = within(line.span(at..at + whole.len()), whole.len(), formula.len() + 1..whole.len());
            inline_format(f, place)?;
            printf(f, value + 0.0).or_else(|e| fail(Code::FORMAT, place, e))?
        }
    };
    Ok(Text { text, origin: None, unknown: false })
}

/// Refuses a format that LAMMPS does not take behind the colon: zeros, blanks, a width, and a precision that must be there.
fn inline_format(format: &str, span: Span) -> Result<()> {
    float_format(format, span)?;
    let width = |c: char| c == ' ' || c.is_ascii_digit();
    let precision = format.strip_prefix('%').and_then(|f| f.trim_start_matches(width).strip_prefix('.'));
    let letter = precision.map_or("", |p| p.trim_start_matches(|c: char| c.is_ascii_digit()));
    if letter != precision.unwrap_or("") && letter.starts_with(['e', 'f', 'g', 'E', 'F', 'G']) {
        return Ok(());
    }
    let text =
        format!("the format `{format}` must be % with a width and a precision alone, as %8.3f or %.6g");
    let d = Diagnostic::error(Code::FORMAT, span, text);
    Err(match format {
        "%e" | "%f" | "%g" | "%E" | "%F" | "%G" => d.help(format!("`%.6{}` prints the same", &format[1..])),
        _ => d.help("other formats: `variable NAME format v %-10.4g`, then ${NAME}"),
    }
    .into())
}

/// Refuses a format that does not suit a number with a fraction.
pub(super) fn float_format(format: &str, span: Span) -> Result<()> {
    let parsed = perigrain_base::math::cformat::Format::parse(format);
    let specs: Vec<_> = match &parsed {
        Ok(f) => f.specs().collect(),
        Err(e) => return fail(Code::FORMAT, span, format!("`{format}` is no format: {}", e.message)),
    };
    if specs.len() == 1 && specs[0].is_float() {
        return Ok(());
    }
    fail(Code::FORMAT, span, format!("`{format}` is no format for a number; one %g, %f or %e is expected"))
}
