//! Texts and numbers as JSON has them.

use std::fmt::Write;

/// A text as a JSON string.
pub fn quoted(text: &str) -> String {
    let mut out = String::from('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            c if u32::from(c) < 0x20 => drop(write!(out, "\\u{:04x}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// A number with all its digits; JSON has no word for what is none.
pub fn number(value: f64) -> String {
    if value.is_finite() { format!("{value:e}") } else { "null".into() }
}
