//! Messages over two pipes: `Content-Length: N`, an empty line, N bytes of JSON.

use serde_json::Value;
use std::io::{BufRead, Read, Result, Write};

/// A message that claims to be longer is not read.
const LONGEST: u64 = 1 << 28;

/// A line of a header that is longer is none.
const LONGEST_LINE: u64 = 1 << 14;

/// What came over the pipe.
#[derive(Clone, Debug, PartialEq)]
pub enum Heard {
    /// A message.
    Message(Value),
    /// Bytes that are none, and what is the matter with them.
    Garbled(String),
}

/// The next message; `None` where the pipe ends, within a message or before one.
///
/// # Errors
/// A pipe that cannot be read.
pub fn read(input: &mut impl BufRead) -> Result<Option<Heard>> {
    let mut length = None;
    let mut lines = 0;
    loop {
        let mut line = vec![];
        if input.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line)? == 0 {
            return Ok(None);
        }
        let line = String::from_utf8_lossy(&line);
        let line = line.trim();
        if line.is_empty() && lines > 0 {
            break;
        }
        // Empty lines between messages do no harm.
        lines += usize::from(!line.is_empty());
        if let Some((name, value)) = line.split_once(':')
            && name.trim().eq_ignore_ascii_case("content-length")
        {
            length = value.trim().parse::<u64>().ok();
        }
    }
    let garbled = |why: &str| Ok(Some(Heard::Garbled(why.to_string())));
    let Some(length) = length.filter(|length| *length <= LONGEST) else {
        return garbled("a header without a sensible Content-Length");
    };
    let mut bytes = vec![];
    input.by_ref().take(length).read_to_end(&mut bytes)?;
    if (bytes.len() as u64) < length {
        return Ok(None);
    }
    match serde_json::from_slice::<Value>(&bytes) {
        Ok(message) if message.is_object() => Ok(Some(Heard::Message(message))),
        Ok(_) => garbled("a message is an object"),
        Err(e) => garbled(&format!("no JSON: {e}")),
    }
}

/// Sends one.
///
/// # Errors
/// A pipe that is closed.
pub fn write(output: &mut impl Write, message: &Value) -> Result<()> {
    let text = message.to_string();
    write!(output, "Content-Length: {}\r\n\r\n{text}", text.len())?;
    output.flush()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_is_written_is_read_and_garbage_is_passed_over() {
        let mut pipe = vec![];
        write(&mut pipe, &json!({"a": "ä"})).unwrap();
        pipe.extend(
            b"Content-Length: 3\r\n\r\n{]}Content-Type: x\r\n\r\n\r\ncontent-length: 2\r\nX: y\r\n\r\n[]",
        );
        write(&mut pipe, &json!({"b": 1})).unwrap();
        pipe.extend(b"Content-Length: 30\r\n\r\n{\"half\": ");
        let mut input = pipe.as_slice();
        let mut heard = vec![];
        while let Some(one) = read(&mut input).unwrap() {
            heard.push(one);
        }
        assert_eq!(heard.first(), Some(&Heard::Message(json!({"a": "ä"}))));
        assert_eq!(heard.last(), Some(&Heard::Message(json!({"b": 1}))));
        assert!(
            heard[1..4].iter().all(|one| matches!(one, Heard::Garbled(_))) && heard.len() == 5,
            "{heard:?}"
        );
    }
}
