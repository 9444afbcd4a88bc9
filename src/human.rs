//! Numbers, times and amounts of memory as people read them: `1,234`, `3 min 20 s`, `1.3 MB`.

/// A number from 0 with three digits, or whole with commas where it is larger.
pub fn count(x: f64) -> String {
    if x < 99.5 {
        let digits = if x < 9.995 { 2 } else { 1 };
        let text = format!("{x:.digits$}");
        return text.trim_end_matches('0').trim_end_matches('.').into();
    }
    let digits = format!("{x:.0}");
    if !digits.bytes().all(|b| b.is_ascii_digit()) {
        return digits;
    }
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A large number as `41.4 million`.
pub fn about(x: f64) -> String {
    match x {
        x if x >= 1e9 => format!("{} billion", count(x / 1e9)),
        x if x >= 1e6 => format!("{} million", count(x / 1e6)),
        x => count(x),
    }
}

/// Seconds as `3.4 ms`, `0.35 s`, `42 s`, `3 min 20 s`, `2 h 5 min`, `3 d 4 h`.
pub fn duration(seconds: f64) -> String {
    let whole = seconds.round().max(0.0) as u64;
    if seconds < 0.0995 {
        return format!("{} ms", count(1e3 * seconds.max(0.0)));
    }
    match whole {
        0..60 => format!("{} s", count(seconds)),
        60..3600 => format!("{} min {} s", whole / 60, whole % 60),
        3600..86400 => format!("{} h {} min", whole / 3600, whole / 60 % 60),
        _ => format!("{} d {} h", whole / 86400, whole / 3600 % 24),
    }
}

/// Bytes as `840 kB`, `1.3 MB`, `12 GB`.
pub fn bytes(bytes: f64) -> String {
    let (size, unit) = match bytes {
        b if b >= 1e9 => (b / 1e9, "GB"),
        b if b >= 1e6 => (b / 1e6, "MB"),
        b => (b / 1e3, "kB"),
    };
    if size < 9.95 { format!("{size:.1} {unit}") } else { format!("{size:.0} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_whole_ones_have_commas() {
        let numbers = [0.0, 0.314, 3.0, 31.41, 99.9, 1234.5, 1234567.0];
        assert_eq!(numbers.map(count), ["0", "0.31", "3", "31.4", "100", "1,234", "1,234,567"]);
        let times = [0.0034, 0.25, 59.4, 61.0, 3720.0, 90000.0];
        assert_eq!(times.map(duration), ["3.4 ms", "0.25 s", "59.4 s", "1 min 1 s", "1 h 2 min", "1 d 1 h"]);
        assert_eq!([1234.0, 41_358_798.0, 2.5e9].map(about), ["1,234", "41.4 million", "2.5 billion"]);
        assert_eq!([1300.0, 1.3e6, 12.4e9].map(bytes), ["1.3 kB", "1.3 MB", "12 GB"]);
    }
}
