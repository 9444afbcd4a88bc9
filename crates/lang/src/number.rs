//! Numbers as decks write them: the grammar of a literal, and C formats for one value.

use super::scan::taken;
use nom::bytes::complete::take_while1;
use nom::character::complete::one_of;
use nom::combinator::{all_consuming, opt};
use nom::error::{Error, ErrorKind};
use perigrain_base::math::cformat::{Format, Value, general};

use nom::{IResult, Parser};

/// An unsigned literal: digits with at most one point, and an exponent.
///
/// Loops read millions of them: by bytes this takes a third of what nom's `digit1` and `opt` take.
pub(super) fn literal(input: &str) -> IResult<&str, &str> {
    let bytes = input.as_bytes();
    let digits = |from: usize| from + bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let whole = digits(0);
    let mut end = whole;
    if bytes.get(whole) == Some(&b'.') {
        end = digits(whole + 1);
        if end == 1 {
            end = 0;
        }
    }
    if end == 0 {
        return Err(nom::Err::Error(Error::new(input, ErrorKind::Digit)));
    }
    if let Some(b'e' | b'E') = bytes.get(end) {
        let signed = matches!(bytes.get(end + 1), Some(b'+' | b'-'));
        let first = end + 1 + usize::from(signed);
        let last = digits(first.min(bytes.len()));
        if last > first {
            end = last;
        }
    }
    Ok((&input[end..], &input[..end]))
}

/// The number a whole word is, if it is one: no `inf`, no `nan`, nothing left over.
pub fn parse(word: &str) -> Option<f64> {
    let signed = taken((opt(one_of("+-")), literal));
    let (_, text) = all_consuming(signed).parse(word).ok()?;
    text.parse::<f64>().ok().filter(|v| v.is_finite())
}

/// The whole number a word is, if it is one.
pub fn parse_integer(word: &str) -> Option<i64> {
    let digits = take_while1(|c: char| c.is_ascii_digit());
    let signed = taken((opt(one_of("+-")), digits));
    let (_, text) = all_consuming(signed).parse(word).ok()?;
    text.parse().ok()
}

/// One number in a C format (`%20.15g`, `%-8d` …); the error says what is wrong with the format.
pub fn printf(format: &str, value: f64) -> Result<String, String> {
    let parsed = Format::parse(format).map_err(|e| e.message)?;
    match parsed.specs().count() {
        1 => Ok(parsed.text(&[Value::Float(value)])),
        0 => Err(format!("`{format}` holds no conversion such as %g")),
        _ => Err(format!("`{format}` holds more than one conversion")),
    }
}

/// A number as a variable's value is put into a line: `%.15g`, and no minus before a zero.
pub fn value_text(value: f64) -> String {
    general(value + 0.0, 15)
}

/// A number as it is after a way through its text of 15 digits.
pub(super) fn rounded(value: f64) -> f64 {
    if value.abs() < 1e15 && value == value.trunc() {
        return value + 0.0;
    }
    value_text(value).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_numbers_and_nothing_else() {
        for (word, value) in
            [("1", 1.0), ("1.5", 1.5), (".5", 0.5), ("-1.", -1.0), ("+2e3", 2000.0), ("1E-3", 1e-3)]
        {
            assert_eq!(parse(word), Some(value), "{word}");
        }
        // What is no exponent is left over.
        for (text, number) in
            [("1e+", "1"), ("1.e5x", "1.e5"), (".5e-3-", ".5e-3"), ("7..", "7."), ("2Ee", "2")]
        {
            assert_eq!(literal(text).map(|(_, n)| n), Ok(number), "{text}");
        }
        for word in ["", "-", "1e", "1e+", "1.2.3", "inf", "nan", "0x10", "1e400", "1 ", "e5", "1_000", "."] {
            assert_eq!(parse(word), None, "{word}");
        }
        assert_eq!(parse_integer("-7"), Some(-7));
        assert_eq!(parse_integer("1.0"), None);
        assert_eq!(parse_integer("99999999999999999999"), None);
    }

    #[test]
    fn prints_like_lammps() {
        // LAMMPS: variable x equal -0.0 / 1/3 / 1e20 / 123456789012, print $x
        assert_eq!(value_text(-0.0), "0");
        assert_eq!(value_text(1.0 / 3.0), "0.333333333333333");
        assert_eq!(value_text(1e20), "1e+20");
        assert_eq!(value_text(123456789012.0), "123456789012");
        // LAMMPS: variable x equal 2/3, print "$(v_x)"
        assert_eq!(rounded(2.0 / 3.0), 0.66666666666666696273);
        assert_eq!((rounded(-0.0), rounded(1e15 + 3.0), rounded(0.1 + 0.2)), (0.0, 1e15, 0.3));
        assert!(rounded(f64::INFINITY).is_infinite());
        assert_eq!(printf("%8.3f", 1.0).as_deref(), Ok("   1.000"));
        assert!(printf("%d %d", 1.0).is_err());
        assert!(printf("none", 1.0).is_err());
    }
}
