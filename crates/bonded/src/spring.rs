//! Springs along bonds.

use crate::columns::Columns;
use crate::law::{Acts, BondLaw, Ends, Motion};
use crate::sweep::{BELOW_ONE, Body, Out, Sweep, all, nearest};
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, dot, length, scale, sub};
use perigrain_base::par;

/// Result of a force along r: force over length, positive for repulsion.
#[inline(always)]
fn central<R: Real>(r: Vec3<R>, force_per_length: R, energy: R, load: R, power: R) -> Acts<R> {
    let none = [energy.like(0.0); 3];
    Acts { force: scale(force_per_length, r), torque: [none; 2], energy, load, power }
}

/// Stiffness and rest length: E = K (r − r0)².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonic;

impl BondLaw<0> for Harmonic {
    type Coeffs = [f64; 2];
    const TURNS: bool = false;

    #[inline(always)]
    fn act<R: Real>(&self, k: &[f64; 2], _: &[R; 0], b: &Ends<R>, _: Option<&Motion<R>>) -> Acts<R> {
        let r = length(b.r);
        let (none, one) = (r.like(0.0), r.like(1.0));
        let longer = r - k[1];
        let there = r.above(none);
        // Coincident ends have no direction.
        let force = longer * (-2.0 * k[0]) / R::choose(there, r, one);
        central(b.r, R::choose(there, force, none), longer * longer * k[0], none, none)
    }

    fn sweep(&self, pass: &Sweep<'_, 0, [f64; 2]>, out: &mut Out) {
        all(self, pass, out);
    }
}

/// Damped springs that break at a strain. J. Clemmer, M. Robbins, Phys. Rev. Lett. 129, 078002 (2022).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breaking {
    /// Whether forces fade towards breaking by 1 − (strain/limit)⁸.
    pub smooth: bool,
    /// Whether the stiffness is divided by the rest length.
    pub normalize: bool,
}

/// A spring that is `longer` than its rest length, with a further repulsion `more`, damped and fading, with
/// its load.
#[inline(always)]
fn damped_and_fading<R: Real>(
    law: &Breaking,
    &[k, limit, gamma]: &[f64; 3],
    strain: R,
    (longer, more): (R, R),
    b: &Ends<R>,
    m: Option<&Motion<R>>,
) -> Acts<R> {
    let r = length(b.r);
    let spring = (if law.normalize { longer / b.length } else { longer }) * -k;
    let per_length = r.like(1.0) / r;
    let (mut force, mut power) = (spring + more, r.like(0.0));
    if let Some(m) = m {
        let rate = dot(b.r, m.v) * per_length;
        force = force - rate * gamma;
        power = rate * rate * gamma;
    }
    force = force * per_length;
    let share = strain * (1.0 / limit);
    if law.smooth {
        let square = share * share;
        let fourth = square * square;
        let fade = r.like(1.0) - fourth * fourth;
        force = force * fade;
        power = power * fade;
    }
    // A bond exactly at its limit does not break.
    let over = strain.abs().above(r.like(limit));
    let load = R::choose(over, share.abs().most(r.like(1.0)), share.abs().least(r.like(BELOW_ONE)));
    central(b.r, force, spring * longer * -0.5, load, power)
}

impl BondLaw<1> for Breaking {
    /// Stiffness, breaking strain, damping; the bond's own value is the inverse of its rest length.
    type Coeffs = [f64; 3];
    const TURNS: bool = false;

    #[inline(always)]
    fn act<R: Real>(&self, k: &[f64; 3], own: &[R; 1], b: &Ends<R>, m: Option<&Motion<R>>) -> Acts<R> {
        let longer = length(b.r) - b.length;
        damped_and_fading(self, k, longer * own[0], (longer, longer.like(0.0)), b, m)
    }

    fn sweep(&self, pass: &Sweep<'_, 1, [f64; 3]>, out: &mut Out) {
        all(self, pass, out);
    }
}

/// Breaking springs with a volumetric term. J. Clemmer, J. Monti, J. Lechman, Soft Matter 20, 1702 (2024).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Voluminous(pub Breaking);

impl BondLaw<2> for Voluminous {
    /// As for [`Breaking`], and the volumetric stiffness [force]; the bond's own values are the inverse of
    /// its rest length, and the relative length for the current volumes of its ends: see [`swell`].
    type Coeffs = ([f64; 3], f64);
    const TURNS: bool = false;

    #[inline(always)]
    fn act<R: Real>(&self, k: &([f64; 3], f64), own: &[R; 2], b: &Ends<R>, m: Option<&Motion<R>>) -> Acts<R> {
        let longer = length(b.r) - b.length;
        let strain = longer * own[0];
        let volume = (own[1] - 1.0 - strain) * k.1;
        damped_and_fading(&self.0, &k.0, strain, (longer, volume), b, m)
    }

    fn sweep(&self, pass: &Sweep<'_, 2, ([f64; 3], f64)>, out: &mut Out) {
        all(self, pass, out);
    }
}

/// Breaking springs that yield: the rest length follows when the elongation exceeds a fraction of it. J.
/// Clemmer, J. Lechman, Powder Technol. (2025).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Yielding(pub Breaking);

impl BondLaw<2> for Yielding {
    /// As for [`Breaking`], and the yield strain; the bond's own values are the inverse of its rest length,
    /// and the rest length after yielding: see [`give_way`].
    type Coeffs = ([f64; 3], f64);
    const TURNS: bool = false;

    #[inline(always)]
    fn act<R: Real>(&self, k: &([f64; 3], f64), own: &[R; 2], b: &Ends<R>, m: Option<&Motion<R>>) -> Acts<R> {
        let r = length(b.r);
        let acts = damped_and_fading(&self.0, &k.0, (r - b.length) * own[0], (r - own[1], r.like(0.0)), b, m);
        Acts { energy: r.like(0.0), ..acts }
    }

    fn sweep(&self, pass: &Sweep<'_, 2, ([f64; 3], f64)>, out: &mut Out) {
        all(self, pass, out);
    }
}

/// The distance between the ends of a bond [length].
fn distance<const C: usize>(columns: &Columns<C>, body: &Body, bond: usize) -> f64 {
    let [a, b] = columns.pair(bond);
    length(nearest(sub(body.x[a], body.x[b]), &body.periods))
}

/// The second value of each bond: (ΣV/ΣV₀)^(1/d) with the volumes of both its ends, V = Σ r^d over the intact
/// bonds of a particle, V₀ = Σ L^d, in d dimensions.
pub fn swell(columns: &mut Columns<2>, body: &Body, dimension: i32) {
    let mut powers = vec![[0.0; 2]; columns.rows()];
    let known = &*columns;
    par::each(&mut powers[..], |first, powers| {
        for (k, power) in powers.iter_mut().enumerate() {
            let lengths = [distance(known, body, first + k), known.length[first + k]];
            *power = lengths.map(|l| if known.alive()[first + k] > 0.0 { l.powi(dimension) } else { 0.0 });
        }
    });
    let mut volumes = vec![[0.0; 2]; known.particles()];
    par::each(&mut volumes[..], |first, volumes| {
        for (k, volume) in volumes.iter_mut().enumerate() {
            for entry in known.of(first + k) {
                let power = powers[*entry as usize / 2];
                (0..2).for_each(|d| volume[d] += power[d]);
            }
        }
    });
    let mut grown = std::mem::take(&mut columns.own[1]);
    let known = &*columns;
    par::each(&mut grown[..], |first, grown| {
        for (k, grown) in grown.iter_mut().enumerate() {
            let [a, b] = known.pair(first + k);
            let ratio = (volumes[a][0] + volumes[b][0]) / (volumes[a][1] + volumes[b][1]);
            *grown = if dimension == 2 { ratio.sqrt() } else { ratio.cbrt() };
        }
    });
    columns.own[1] = grown;
}

/// The second value of each bond: its rest length r_eq follows so that |r − r_eq| ≤ ε L, with ε of its type
/// and the initial rest length L. Returns the bonds that yielded, with their new rest lengths.
pub fn give_way(columns: &mut Columns<2>, body: &Body, limit: impl Fn(u16) -> f64) -> Vec<(usize, f64)> {
    let mut yielded = vec![];
    for bond in 0..columns.rows() {
        let most = limit(columns.kind(bond)) * columns.length[bond];
        let (r, rest) = (distance(columns, body, bond), columns.own[1][bond]);
        if columns.alive()[bond] > 0.0 && (r - rest).abs() > most {
            let now = if r > rest { r - most } else { r + most };
            columns.own[1][bond] = now;
            yielded.push((bond, now));
        }
    }
    yielded
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::Member;
    use perigrain_base::math::body::UNTURNED;

    fn at(r: f64) -> Ends<f64> {
        Ends { r: [r, 0.0, 0.0], length: 1.25, axis: [1.0, 0.0, 0.0], quat: [UNTURNED; 2] }
    }

    #[test]
    fn forces_are_slopes_of_energies() {
        let (r, h) = (1.5, 1e-6);
        let check = |energy: &dyn Fn(f64) -> f64, force: f64| {
            let slope = (energy(r + h) - energy(r - h)) / (2.0 * h);
            // Central differences of a parabola are exact up to rounding, about 1e-16/1e-6.
            assert!((force + slope).abs() < 1e-8, "{force} {slope}");
        };
        let k = [7.0, 1.2];
        check(&|r| Harmonic.act(&k, &[], &at(r), None).energy, Harmonic.act(&k, &[], &at(r), None).force[0]);
        let still = Harmonic.act(&k, &[], &at(1.2), None);
        assert!(still.energy == 0.0 && still.force == [-0.0, -0.0, -0.0]);
        assert_eq!(Harmonic.act(&k, &[], &at(0.0), None).force, [0.0; 3]);
        for normalize in [false, true] {
            let (law, k) = (Breaking { smooth: false, normalize }, [7.0, 0.5, 0.0]);
            check(&|r| law.act(&k, &[0.8], &at(r), None).energy, law.act(&k, &[0.8], &at(r), None).force[0]);
        }
    }

    /// LAMMPS 22Jul2025 for a bond of 1.25 that yields at 0.1: stretched to 1.45 its rest length is 1.325,
    /// compressed to 0.95 it is 1.075.
    #[test]
    fn springs_give_way() {
        let member = Member {
            kind: 1,
            ends: [0, 1],
            length: 1.25,
            axis: [1.0, 0.0, 0.0],
            turned: UNTURNED,
            own: [0.8, 1.25],
        };
        for (r, rest) in [(1.3, 1.25), (1.45, 1.325), (0.95, 1.075)] {
            let mut columns = Columns::new(&[member], 2);
            let x = [[r, 0.0, 0.0], [0.0; 3]];
            let body = Body { x: &x, v: &[], omega: &[], quat: &[], periods: Default::default() };
            let yielded = give_way(&mut columns, &body, |_| 0.1);
            assert!((columns.own[1][0] - rest).abs() < 1e-15 && yielded.len() == usize::from(r != 1.3));
            let law = Yielding(Breaking { smooth: false, normalize: false });
            let acts = law.act(&([1.0, 1.0, 0.0], 0.1), &[0.8, rest], &at(r), None);
            assert!((acts.force[0] - (rest - r)).abs() < 1e-15 && acts.energy == 0.0);
        }
    }

    /// A chain of three: V of the middle is 1.5³ + 1, of the ends 1.5³ and 1.
    #[test]
    fn volumes_swell() {
        let member = |ends| Member {
            kind: 1,
            ends,
            length: 1.0,
            axis: [1.0, 0.0, 0.0],
            turned: UNTURNED,
            own: [1.0, 1.0],
        };
        let mut columns = Columns::new(&[member([0, 1]), member([1, 2])], 3);
        let x = [[0.0; 3], [1.5, 0.0, 0.0], [2.5, 0.0, 0.0]];
        let body = Body { x: &x, v: &[], omega: &[], quat: &[], periods: Default::default() };
        swell(&mut columns, &body, 3);
        let grown = |v: f64| (v / 3.0).cbrt();
        assert!((columns.own[1][0] - grown(2.0 * 3.375 + 1.0)).abs() < 1e-15);
        assert!((columns.own[1][1] - grown(3.375 + 2.0)).abs() < 1e-15);
        swell(&mut columns, &body, 2);
        assert!((columns.own[1][0] - ((2.0 * 2.25 + 1.0) / 3.0f64).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn springs_fade_are_damped_and_break_beyond_their_limit() {
        let law = Breaking { smooth: true, normalize: false };
        let k = [7.0, 0.25, 0.5];
        let motion = Motion { v: [0.3, 5.0, 0.0], omega: [[0.0; 3]; 2] };
        let acts = law.act(&k, &[0.8], &at(1.375), Some(&motion));
        // By hand: strain 0.1, (0.1/0.25)⁸ = 6.5536e-4.
        let force = -(7.0 * 0.125 + 0.5 * 0.3) * (1.0 - 6.5536e-4);
        let power = 0.5 * 0.09 * (1.0 - 6.5536e-4);
        assert!((acts.force[0] - force).abs() < 1e-15 && (acts.power - power).abs() < 1e-16);
        assert!((acts.load - 0.4).abs() < 1e-15);
        assert!(law.act(&k, &[0.8], &at(1.5625), None).load < 1.0);
        assert!(law.act(&k, &[0.8], &at(1.5626), None).load >= 1.0);
        assert!(law.act(&k, &[0.8], &at(0.9), None).load >= 1.0);
    }
}
