//! Bytes as text and back: base64 with the standard alphabet and padding (RFC 4648).

const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Bytes as text.
pub fn encode(bytes: &[u8]) -> String {
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let bits = (0..3).fold(0, |bits, k| bits << 8 | u32::from(three.get(k).copied().unwrap_or(0)));
        for k in 0..4 {
            match k <= three.len() {
                true => out.push(char::from(ALPHABET[(bits >> (18 - 6 * k)) as usize & 63])),
                false => out.push('='),
            }
        }
    }
    out
}

/// Decodes a text up to the first byte outside the alphabet; padding inside the text ends a group, and the
/// next one follows.
pub fn decode(text: &[u8]) -> Vec<u8> {
    let value = |b: u8| match b {
        b'A'..=b'Z' => Some(b - b'A'),
        b'a'..=b'z' => Some(b - b'a' + 26),
        b'0'..=b'9' => Some(b - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    let (mut group, mut have, mut pad) = (0u32, 0, 0);
    for &b in text.iter().filter(|b| !b.is_ascii_whitespace()) {
        let bits = match (value(b), b) {
            (Some(v), _) => u32::from(v),
            (None, b'=') => {
                pad += 1;
                0
            }
            _ => break,
        };
        group = group << 6 | bits;
        have += 1;
        if have == 4 {
            let three = [(group >> 16) as u8, (group >> 8) as u8, group as u8];
            out.extend(&three[..3 - pad.min(2)]);
            (group, have, pad) = (0, 0, 0);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    // The test vectors of RFC 4648, section 10.
    #[test]
    fn bytes_of_any_number_become_text() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(encode(bytes.as_bytes()), text);
            assert_eq!(decode(text.as_bytes()), bytes.as_bytes());
        }
        let all: Vec<u8> = (0..=255).collect();
        assert_eq!(decode(encode(&all).as_bytes()), all);
    }

    #[test]
    fn groups_may_be_padded_within() {
        // RFC 4648, section 10, and two of them concatenated.
        assert_eq!(decode(b"Zm9vYmFy"), b"foobar");
        assert_eq!(decode(b" Zm9v\nYg==Zm8="), b"foobfo");
        assert_eq!(decode(b"Zm9v</Data"), b"foo");
    }
}
