//! Functions of the step number: ramps and sequences of steps.

use super::super::value::Clock;

/// What LAMMPS gives for "no further step" (`stride` past its end).
const NEVER: f64 = 9_223_372_036_854_774_784.0;

/// Time since the run began.
pub(super) fn elapsed(c: &Clock) -> f64 {
    (c.step - c.begin) as f64 * c.dt
}

/// From `a[0]` at the run's begin to `a[1]` at its end; `a[0]` between runs.
pub(super) fn ramp(a: &[f64], c: &Clock) -> Result<f64, String> {
    if !c.running || c.end == c.begin {
        return Ok(a[0]);
    }
    Ok(a[0] + (a[1] - a[0]) * ((c.step - c.begin) as f64 / (c.end - c.begin) as f64))
}

/// Arguments cut to whole numbers, as LAMMPS does; refused if `ok` does not hold.
fn whole<const N: usize>(a: &[f64], ok: impl Fn(&[i64; N]) -> bool, rule: &str) -> Result<[i64; N], String> {
    let mut out = [0; N];
    for (o, v) in out.iter_mut().zip(a) {
        if !v.is_finite() {
            return Err("step numbers must be finite".into());
        }
        *o = *v as i64;
    }
    // far from the ends of i64, so that what follows cannot overflow
    if out.iter().all(|v| v.abs() < 1 << 53) && ok(&out) { Ok(out) } else { Err(rule.to_owned()) }
}

/// x, x+y, 2x, 2x+y … : the one after the present step.
pub(super) fn stagger(a: &[f64], c: &Clock) -> Result<f64, String> {
    let [x, y] = whole(a, |[x, y]| *x > 0 && *y > 0 && x > y, "x, y > 0 and x > y are required")?;
    let lower = c.step / x * x;
    Ok((if c.step - lower < y { lower + y } else { lower + x }) as f64)
}

/// x, 2x, …, yx, zx, 2zx … : the one after the present step.
pub(super) fn logfreq(a: &[f64], c: &Clock) -> Result<f64, String> {
    let rule = "x, y, z > 0 and y < z are required";
    let [x, y, z] = whole(a, |[x, y, z]| *x > 0 && *y > 0 && y < z, rule)?;
    if c.step < x {
        return Ok(x as f64);
    }
    let lower = decade(x, z, c.step);
    let multiple = c.step as i128 / lower;
    Ok((if multiple < i128::from(y) { (multiple + 1) * lower } else { lower * i128::from(z) }) as f64)
}

/// The largest x zᵏ that is not beyond `step`.
fn decade(x: i64, z: i64, step: i64) -> i128 {
    let (mut lower, z) = (i128::from(x), i128::from(z));
    while i128::from(step) >= lower * z {
        lower *= z;
    }
    lower
}

/// Each interval from x zᵏ to x zᵏ⁺¹ in y equal parts, rounded up.
pub(super) fn logfreq2(a: &[f64], c: &Clock) -> Result<f64, String> {
    let rule = "x, y > 0 and z > 1 are required";
    let [x, y, z] = whole(a, |[x, y, z]| *x > 0 && *y > 0 && *z > 1, rule)?;
    if c.step < x {
        return Ok(x as f64);
    }
    let lower = decade(x, z, c.step) as f64;
    let delta = lower * (z - 1) as f64 / y as f64;
    let mut k = ((c.step as f64 - lower) / delta).floor();
    while (lower + k * delta).ceil() <= c.step as f64 {
        k += 1.0;
    }
    Ok((lower + k * delta).ceil())
}

/// y points between x and z at a constant ratio, rounded up; none after z.
pub(super) fn logfreq3(a: &[f64], c: &Clock) -> Result<f64, String> {
    let rule = "x, z > 0, y > 1 and z - x >= y - 1 are required";
    let [x, y, z] = whole(a, |[x, y, z]| *x > 0 && *y > 1 && *z > 0 && z - x >= y - 1, rule)?;
    if c.step < x {
        return Ok(x as f64);
    }
    if c.step >= z {
        return Ok(NEVER);
    }
    let ratio = (z as f64 / x as f64).powf(1.0 / (y - 1) as f64);
    let step = c.step as f64;
    let k = ((step / x as f64).ln() / ratio.ln()).floor() - 1.0;
    let point = |k: f64| (x as f64 * ratio.powf(k) - 1e-9).ceil();
    let next = (0..4).map(|j| point((k + f64::from(j)).max(0.0))).find(|p| *p > step);
    Ok(next.unwrap_or(z as f64).min(z as f64))
}

/// x, x+z, x+2z … up to y.
pub(super) fn stride(a: &[f64], c: &Clock) -> Result<f64, String> {
    let rule = "x, y >= 0, z > 0 and x <= y are required";
    let [x, y, z] = whole(a, |[x, y, z]| *x >= 0 && *y >= 0 && *z > 0 && x <= y, rule)?;
    if c.step < x {
        return Ok(x as f64);
    }
    let next = after(c.step, x, z);
    Ok(if c.step >= y || next > y { NEVER } else { next as f64 })
}

/// Coarse steps z from x to y, with fine steps c between a and b.
pub(super) fn stride2(v: &[f64], clock: &Clock) -> Result<f64, String> {
    let rule = "x, y, a, b >= 0, z, c > 0, x <= y, a < b, a >= x and b <= y are required";
    let ok = |[x, y, z, a, b, c]: &[i64; 6]| {
        *x >= 0 && *z > 0 && x <= y && *a >= 0 && *c > 0 && a < b && a >= x && b <= y
    };
    let [x, y, z, a, b, c] = whole(v, ok, rule)?;
    let step = clock.step;
    let next = if step < x {
        x
    } else if step < a {
        after(step, x, z).min(a)
    } else if step < b {
        let fine = after(step, a, c);
        if fine > b { after(b, x, z) } else { fine }
    } else if step < y {
        after(step, x, z)
    } else {
        return Ok(NEVER);
    };
    Ok(next as f64)
}

/// The first of x, x+z, x+2z … after `step`.
fn after(step: i64, x: i64, z: i64) -> i64 {
    step - (step - x) % z + z
}
