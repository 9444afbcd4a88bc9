//! Places inside a text by what a nom parser has left of it.
//!
//! nom's own `Offset` compares pointers, and some of its parsers return an empty rest that points elsewhere than
//! at the end of the text; lengths are right in every case.

use nom::error::Error;
use nom::{IResult, Parser};

/// The byte of `text` at which its end `rest` begins.
pub(super) fn place(text: &str, rest: &str) -> usize {
    text.len().saturating_sub(rest.len())
}

/// What a parser consumes, as text.
pub(super) fn taken<'a, O>(
    mut parser: impl Parser<&'a str, Output = O, Error = Error<&'a str>>,
) -> impl FnMut(&'a str) -> IResult<&'a str, &'a str> {
    move |input| {
        let (rest, _) = parser.parse(input)?;
        Ok((rest, &input[..place(input, rest)]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nom::character::complete::{char, digit0};

    #[test]
    fn sees_the_end_of_the_text() {
        let parsed = taken((char('1'), char('.'), digit0)).parse("1.5");
        assert_eq!(parsed, Ok(("", "1.5")));
    }
}
