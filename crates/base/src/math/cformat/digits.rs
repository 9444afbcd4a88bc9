//! Decimal digits of a double, exactly rounded: by integer arithmetic where 128 bits suffice, else by `std`.

use std::io::Write;

/// 10^27 is the largest power that leaves room for the shift below.
const MOST: i32 = 27;

/// 10^k.
const fn ten(k: i32) -> u128 {
    let (mut power, mut i) = (1, 0);
    while i < k {
        power *= 10;
        i += 1;
    }
    power
}

/// The powers 10^0 … 10^27.
const TENS: [u128; MOST as usize + 1] = {
    let mut list = [1; MOST as usize + 1];
    let mut k = 0;
    while k <= MOST {
        list[k as usize] = ten(k);
        k += 1;
    }
    list
};

/// `size`·10^k rounded to an integer, ties to even; `None` if 128 bits do not suffice.
fn scaled(size: f64, k: i32) -> Option<u64> {
    let bits = size.to_bits();
    let exponent = (bits >> 52) as i32 & 0x7ff;
    if exponent == 0 || k.abs() > MOST {
        return None;
    }
    let mantissa = u128::from(bits & ((1 << 52) - 1) | 1 << 52);
    let shift = 1075 - exponent;
    let (quotient, rest, half) = if k >= 0 {
        // mantissa·10^k / 2^shift
        if k > 22 || !(1..128).contains(&shift) {
            return None;
        }
        let value = mantissa * TENS[k as usize];
        (value >> shift, value & ((1 << shift) - 1), 1 << (shift - 1))
    } else {
        // mantissa·2^-shift / 10^-k, doubled so that half a divisor is an integer
        let divisor = TENS[-k as usize];
        let (value, divisor) = match shift {
            1..=36 => (mantissa, divisor << shift),
            -70..=0 => (mantissa << -shift, divisor),
            _ => return None,
        };
        let quotient = value / divisor;
        (quotient, 2 * (value - quotient * divisor), divisor)
    };
    let up = rest > half || (rest == half && quotient & 1 == 1);
    u64::try_from(quotient).ok().filter(|q| *q < 1_000_000_000_000_000_000).map(|q| q + u64::from(up))
}

/// Writes `count` significant digits without a point and returns the decimal exponent of the first.
pub(super) fn significant(out: &mut Vec<u8>, size: f64, count: usize) -> i32 {
    if size == 0.0 {
        // Columns of dumps are full of it.
        out.resize(out.len() + count.max(1), b'0');
        return 0;
    }
    if (1..=17).contains(&count) {
        let binary = (size.to_bits() >> 52) as i32 - 1023;
        // floor(binary·log10 2) is the exponent or one less.
        let mut exponent = (binary * 78_913) >> 18;
        let limit = TENS[count] as u64;
        while let Some(n) = scaled(size, count as i32 - 1 - exponent) {
            if n < limit {
                whole(out, n, count);
                return exponent;
            }
            exponent += 1;
        }
    }
    spelled(out, size, count)
}

/// The same by `std`, for any size and count.
fn spelled(out: &mut Vec<u8>, size: f64, count: usize) -> i32 {
    // Rust's `{:e}` rounds the exact binary value, ties to even, like glibc; only the exponent is formatted
    // differently.
    let (start, decimals) = (out.len(), count.saturating_sub(1));
    // Writing to a Vec cannot fail.
    let _ = write!(out, "{size:.decimals$e}");
    let Some(mark) = out[start..].iter().rposition(|&b| b == b'e').map(|k| start + k) else {
        return 0;
    };
    let exponent = std::str::from_utf8(&out[mark + 1..]).ok().and_then(|t| t.parse().ok());
    out.truncate(mark);
    if decimals > 0 {
        out.remove(start + 1);
    }
    exponent.unwrap_or(0)
}

/// Writes a number with `decimals` after the point, as `%.{decimals}f`.
pub(super) fn fixed(out: &mut Vec<u8>, size: f64, decimals: usize) {
    if decimals <= 17
        && let Some(n) = scaled(size, decimals as i32)
    {
        let digits = (n.checked_ilog10().unwrap_or(0) as usize + 1).max(decimals + 1);
        whole(out, n, digits);
        if decimals > 0 {
            out.insert(out.len() - decimals, b'.');
        }
        return;
    }
    let _ = write!(out, "{size:.decimals$}");
}

/// Writes the last `count` digits of an integer, at most 20.
fn whole(out: &mut Vec<u8>, mut n: u64, count: usize) {
    let mut digits = [b'0'; 20];
    for digit in digits[20 - count..].iter_mut().rev() {
        *digit = b'0' + (n % 10) as u8;
        n /= 10;
    }
    out.extend_from_slice(&digits[20 - count..]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(write: impl FnOnce(&mut Vec<u8>)) -> String {
        let mut out = vec![];
        write(&mut out);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn zero_has_as_many_digits() {
        for count in [0, 1, 6, 17, 20] {
            let (mut a, mut b) = (1, 1);
            let ours = text(|out| a = significant(out, 0.0, count));
            let theirs = text(|out| b = spelled(out, 0.0, count));
            assert_eq!((a, ours), (b, theirs), "{count}");
        }
    }

    #[test]
    fn both_ways_agree() {
        // A fixed linear congruential stream; sizes from 1e-30 to 1e30, some with few bits so that ties
        // occur.
        let mut state = 1u64;
        let mut quick = 0;
        for round in 0..60_000u32 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let unit = (state >> 11) as f64 / (1u64 << 53) as f64;
            let size = match round % 3 {
                0 => 10f64.powf(60.0 * unit - 30.0),
                1 => 10f64.powf(16.0 * unit - 8.0),
                _ => (unit * 4096.0).floor() / 64.0,
            };
            let count = [1, 2, 3, 6, 8, 15, 16, 17][round as usize / 3 % 8];
            let (mut a, mut b) = (0, 0);
            let ours = text(|out| a = significant(out, size, count));
            let theirs = text(|out| b = spelled(out, size, count));
            assert_eq!((a, ours), (b, theirs), "{size:e} {count}");
            let decimals = count - 1;
            assert_eq!(text(|out| fixed(out, size, decimals)), format!("{size:.decimals$}"), "{size:e}");
            quick += u32::from(scaled(size, 3).is_some());
        }
        assert!(quick > 20_000, "the quick way is taken: {quick}");
    }
}
