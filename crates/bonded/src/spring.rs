//! Springs along bonds.

use crate::law::{Acts, BondLaw, Ends, Motion};
use crate::sweep::{Out, Sweep, all};
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, dot, length, scale};

/// What acts along r alone: a force over length, positive where it pushes the ends apart.
#[inline(always)]
fn central<R: Real>(r: Vec3<R>, force_per_length: R, energy: R, load: R, power: R) -> Acts<R> {
    let none = [energy.like(0.0); 3];
    Acts { force: scale(force_per_length, r), torque: [none; 2], energy, load, power }
}

/// Stiffness and length at rest: E = K (r − r0)².
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
        // Ends at one place have no direction.
        let force = longer * (-2.0 * k[0]) / R::choose(there, r, one);
        central(b.r, R::choose(there, force, none), longer * longer * k[0], none, none)
    }

    fn sweep(&self, pass: &Sweep<'_, 0, [f64; 2]>, out: &mut Out) {
        all(self, pass, out);
    }
}

/// The largest number below 1.
const BELOW_ONE: f64 = 1.0 - 0.5 * f64::EPSILON;

/// Damped springs that break at a strain. J. Clemmer, M. Robbins, Phys. Rev. Lett. 129, 078002 (2022).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breaking {
    /// Forces fade towards breaking by 1 − (strain/limit)⁸.
    pub smooth: bool,
    /// The stiffness is divided by the length at rest.
    pub normalize: bool,
}

impl BondLaw<1> for Breaking {
    /// Stiffness, breaking strain, damping; a bond's own number is 1 over its length at rest.
    type Coeffs = [f64; 3];
    const TURNS: bool = false;

    #[inline(always)]
    fn act<R: Real>(&self, k: &[f64; 3], own: &[R; 1], b: &Ends<R>, m: Option<&Motion<R>>) -> Acts<R> {
        let &[k, limit, gamma] = k;
        let r = length(b.r);
        let longer = r - b.length;
        let strain = longer * own[0];
        let spring = (if self.normalize { strain } else { longer }) * -k;
        let per_length = r.like(1.0) / r;
        let (mut force, mut power) = (spring, r.like(0.0));
        if let Some(m) = m {
            let rate = dot(b.r, m.v) * per_length;
            force = spring - rate * gamma;
            power = rate * rate * gamma;
        }
        force = force * per_length;
        let share = strain * (1.0 / limit);
        if self.smooth {
            let square = share * share;
            let fourth = square * square;
            let fade = r.like(1.0) - fourth * fourth;
            force = force * fade;
            power = power * fade;
        }
        // A bond at its limit still holds.
        let over = strain.abs().above(r.like(limit));
        let load = R::choose(over, share.abs().most(r.like(1.0)), share.abs().least(r.like(BELOW_ONE)));
        central(b.r, force, spring * longer * -0.5, load, power)
    }

    fn sweep(&self, pass: &Sweep<'_, 1, [f64; 3]>, out: &mut Out) {
        all(self, pass, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_base::math::body::UNTURNED;

    fn at(r: f64) -> Ends<f64> {
        Ends { r: [r, 0.0, 0.0], length: 1.25, axis: [1.0, 0.0, 0.0], quat: [UNTURNED; 2] }
    }

    #[test]
    fn forces_are_slopes_of_energies() {
        let (r, h) = (1.5, 1e-6);
        let check = |energy: &dyn Fn(f64) -> f64, force: f64| {
            let slope = (energy(r + h) - energy(r - h)) / (2.0 * h);
            // Central differences of a parabola are exact but for rounding, about 1e-16/1e-6.
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
