//! A number in the fewest digits that give it back, as modern C++ prints it.

use super::push_exponent;

/// The fewest digits that read back as the same number: plain from 0.0001 up to 10¹⁶, else with an exponent.
pub fn shortest(x: f64) -> String {
    if !x.is_finite() || x == 0.0 {
        return match x {
            _ if x.is_nan() => "nan".into(),
            _ if x == 0.0 => if x.is_sign_negative() { "-0" } else { "0" }.into(),
            _ => if x < 0.0 { "-inf" } else { "inf" }.into(),
        };
    }
    let scientific = format!("{x:e}");
    let (digits, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-4..16).contains(&exponent) {
        return format!("{x}");
    }
    let mut text = digits.as_bytes().to_vec();
    push_exponent(&mut text, exponent, false);
    String::from_utf8_lossy(&text).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    // The first three as LAMMPS 22Jul2025 prints them in messages of fix halt and files of fix ave/histo.
    #[test]
    fn few_digits() {
        for (x, text) in [
            (7.570999999997885e-06, "7.570999999997885e-06"),
            (54.00000000000002, "54.00000000000002"),
            (6.0, "6"),
            (-1e20, "-1e+20"),
            (1e15, "1000000000000000"),
            (1e16, "1e+16"),
            (0.0001, "0.0001"),
            (0.00001, "1e-05"),
            (0.0, "0"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(shortest(x), text);
        }
    }
}
