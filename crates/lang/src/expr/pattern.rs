//! The small regular expressions of `is_os()`: `^ $ . [a-z] [^a-z] * + ? \d \D \w \W \s \S`.

/// What one character may be.
#[derive(Clone, Debug)]
enum Unit {
    Any,
    Char(char),
    Digit(bool),
    Word(bool),
    Space(bool),
    Set { items: Vec<Unit>, ranges: Vec<(char, char)>, negated: bool },
}

impl Unit {
    fn holds(&self, c: char) -> bool {
        match self {
            Unit::Any => c != '\n',
            Unit::Char(x) => *x == c,
            Unit::Digit(yes) => c.is_ascii_digit() == *yes,
            Unit::Word(yes) => (c.is_ascii_alphanumeric() || c == '_') == *yes,
            Unit::Space(yes) => c.is_ascii_whitespace() == *yes,
            Unit::Set { items, ranges, negated } => {
                let inside = items.iter().any(|u| u.holds(c));
                (inside || ranges.iter().any(|(a, b)| (*a..=*b).contains(&c))) != *negated
            }
        }
    }

    fn escaped(c: char) -> Self {
        match c {
            'd' | 'D' => Unit::Digit(c == 'd'),
            'w' | 'W' => Unit::Word(c == 'w'),
            's' | 'S' => Unit::Space(c == 's'),
            other => Unit::Char(other),
        }
    }
}

/// A unit and how often it may stand.
struct Part {
    unit: Unit,
    /// It may be missing.
    optional: bool,
    /// It may stand again.
    repeated: bool,
}

/// Whether `pattern` is found in `text`; the error explains what is wrong with the pattern.
pub(super) fn matches(pattern: &str, text: &str) -> Result<bool, String> {
    let (from_start, rest) = match pattern.strip_prefix('^') {
        Some(rest) => (true, rest),
        None => (false, pattern),
    };
    let (to_end, rest) = match rest.strip_suffix('$').filter(|r| !r.ends_with('\\')) {
        Some(rest) => (true, rest),
        None => (false, rest),
    };
    let parts = parse(rest)?;
    // the parts that may come next, all at once
    let mut now = vec![false; parts.len() + 1];
    let mut characters = text.chars().peekable();
    let mut first = true;
    loop {
        now[0] |= first || !from_start;
        first = false;
        for k in 0..parts.len() {
            now[k + 1] |= now[k] && parts[k].optional;
        }
        let over = characters.peek().is_none();
        if now[parts.len()] && (!to_end || over) {
            return Ok(true);
        }
        let Some(c) = characters.next() else { return Ok(false) };
        let mut then = vec![false; parts.len() + 1];
        for (k, p) in parts.iter().enumerate().filter(|(k, _)| now[*k]) {
            if p.unit.holds(c) {
                then[k + 1] = true;
                then[k] |= p.repeated;
            }
        }
        now = then;
    }
}

fn parse(pattern: &str) -> Result<Vec<Part>, String> {
    let mut parts: Vec<Part> = vec![];
    let mut rest = pattern.chars();
    while let Some(c) = rest.next() {
        let unit = match c {
            '*' | '+' | '?' => {
                let Some(last) = parts.last_mut() else { return Err(format!("nothing stands before {c}")) };
                last.optional |= c != '+';
                last.repeated |= c != '?';
                continue;
            }
            '.' => Unit::Any,
            '\\' => Unit::escaped(rest.next().ok_or("the pattern breaks off after \\")?),
            '[' => set(&mut rest)?,
            other => Unit::Char(other),
        };
        parts.push(Part { unit, optional: false, repeated: false });
    }
    Ok(parts)
}

/// What stands between `[` and `]`.
fn set(rest: &mut std::str::Chars<'_>) -> Result<Unit, String> {
    let (mut items, mut ranges, mut negated) = (vec![], vec![], false);
    let mut start = true;
    loop {
        let c = rest.next().ok_or("a [ is never closed")?;
        match c {
            '^' if start => negated = true,
            ']' => return Ok(Unit::Set { items, ranges, negated }),
            '\\' => items.push(Unit::escaped(rest.next().ok_or("the pattern breaks off after \\")?)),
            _ => {
                let mut ahead = rest.clone();
                match (ahead.next(), ahead.next()) {
                    (Some('-'), Some(end)) if end != ']' => {
                        ranges.push((c, end));
                        *rest = ahead;
                    }
                    _ => items.push(Unit::Char(c)),
                }
            }
        }
        start = false;
    }
}

/// What `is_os()` searches: the system's name, its release and the processor.
pub(super) fn os_info() -> String {
    let os = std::env::consts::OS;
    let name = match os {
        "linux" => "Linux",
        "macos" => "macOS",
        "windows" => "Windows",
        other => other,
    };
    let release = || std::fs::read_to_string("/proc/sys/kernel/osrelease").ok();
    let release = perigrain_base::comm::broadcast::text(release).unwrap_or_default();
    format!("{name} {} {}", release.trim(), std::env::consts::ARCH)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_what_it_should() {
        for (pattern, text, expected) in [
            ("^Linux", "Linux 6.1", true),
            ("^inux", "Linux 6.1", false),
            ("Win", "Linux", false),
            ("6\\.\\d$", "Linux 6.1", true),
            ("6.1$", "Linux 6.12", false),
            ("ab*c", "xxac", true),
            ("ab*c", "xxabbbc", true),
            ("ab+c", "xxac", false),
            ("ab?c$", "abbc", false),
            ("[A-F0-3]+x", "zzB2x", true),
            ("[^a-z]", "abc", false),
            ("", "anything", true),
            ("\\w+ \\d", "Linux 6", true),
            ("^a+$", "aaa", true),
            ("^a+$", "aab", false),
            ("^a*$", "", true),
            ("a.c", "a\nc", false),
        ] {
            assert_eq!(matches(pattern, text), Ok(expected), "{pattern} in {text}");
        }
        for bad in ["*a", "[a", "a\\", "[\\"] {
            assert!(matches(bad, "a").is_err(), "{bad}");
        }
    }
}
