//! Lines of fields with a checksum, as the journal and the workers write them.

/// The checksum of some bytes with their number: what is the same has the same digest.
pub fn digest(bytes: &[u8]) -> String {
    format!("{:08x}-{}", crc32fast::hash(bytes), bytes.len())
}

/// Fields as one text without line breaks.
pub fn join(fields: &[String]) -> String {
    let escaped =
        |f: &String| f.replace('\\', "\\\\").replace('\t', "\\t").replace('\n', "\\n").replace('\r', "\\r");
    fields.iter().map(escaped).collect::<Vec<_>>().join("\t")
}

/// The fields of a text that [`join`] made; none of an empty one.
pub fn split(text: &str) -> Vec<String> {
    if text.is_empty() {
        return vec![];
    }
    text.split('\t').map(plain).collect()
}

fn plain(field: &str) -> String {
    let mut out = String::with_capacity(field.len());
    let mut letters = field.chars();
    while let Some(c) = letters.next() {
        out.push(match c {
            '\\' => match letters.next() {
                Some('t') => '\t',
                Some('n') => '\n',
                Some('r') => '\r',
                Some(other) => other,
                None => '\\',
            },
            c => c,
        });
    }
    out
}

/// A line with a checksum that shows whether it is complete.
pub fn seal(fields: &[String]) -> String {
    let text = join(fields);
    format!("{:08x} {text}\n", crc32fast::hash(text.as_bytes()))
}

/// The fields of a line, with or without its end; `None` if it is not whole.
pub fn open(line: &str) -> Option<Vec<String>> {
    let (sum, text) = line.strip_suffix('\n').unwrap_or(line).split_once(' ')?;
    let sum = u32::from_str_radix(sum, 16).ok()?;
    (sum == crc32fast::hash(text.as_bytes())).then(|| split(text))
}

/// Pairs as a flat list, which one field can hold.
pub fn pairs(list: &[(String, String)]) -> String {
    join(&list.iter().flat_map(|(a, b)| [a.clone(), b.clone()]).collect::<Vec<_>>())
}

/// The pairs that [`pairs`] wrote.
pub fn unpaired(text: &str) -> Vec<(String, String)> {
    split(text).chunks_exact(2).map(|p| (p[0].clone(), p[1].clone())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_sealed_comes_back_and_what_is_torn_does_not() {
        let nested = pairs(&[("v".into(), "a\tb\\t\n".into()), ("w".into(), String::new())]);
        let fields = ["end".to_string(), "7".into(), nested.clone(), "\\".into()];
        let line = seal(&fields);
        assert_eq!(line.matches('\n').count(), 1);
        assert_eq!(open(&line).unwrap(), fields);
        assert_eq!(unpaired(&nested)[0].1, "a\tb\\t\n");
        for cut in 0..line.len() - 1 {
            assert_eq!(open(&line[..cut]), None, "{cut}");
        }
    }
}
