//! bpm/rotational: a bond with stretch, shear, twist and bending, all angles in the frame of the second end.
//!
//! X. Wang and others, Acta Geotech. 4, 117 (2009), in the form of LAMMPS' `bond_style bpm/rotational`
//! (`frame particle`, `damping dem`). Written without the frame whose z axis is the bond: with n along the
//! bond and p = (p₀, p⃗) the rotation of the first end relative to the second, twist is p⃗·n and bending the
//! part of p⃗ perpendicular to n.

use crate::law::{Acts, BondLaw, Ends, Motion};
use crate::stiffness::Stiffness;
use crate::sweep::{Out, Sweep, all};
use perigrain_base::math::angle::angle;
use perigrain_base::math::body::{after, back, turned};
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale, sub};

/// Coefficients of a bond type.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coeffs {
    /// Stiffnesses.
    pub stiffness: Stiffness,
    /// Strength in stretch and shear [force], twist and bending [force length].
    pub strength: Stiffness,
    /// Damping of stretch and shear [force/velocity], roll (with the current length) and twist [force length
    /// time].
    pub damping: Stiffness,
}

/// The law with the options of its line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotational {
    /// Whether forces fade towards breaking by 1 − B⁴.
    pub smooth: bool,
    /// Whether stiffnesses of stretch and shear are divided by the rest length.
    pub normalize: bool,
    /// As in LAMMPS, a bond exactly along −z of its second end neither bends nor twists.
    pub compat_lammps: bool,
}

/// Normalizes a vector: a / |a|, zero for zero.
#[inline(always)]
fn over<R: Real>(a: R, length: R) -> R {
    let none = a.like(0.0);
    let there = length.above(none);
    R::choose(there, a / R::choose(there, length, a.like(1.0)), none)
}

impl BondLaw<0> for Rotational {
    type Coeffs = Coeffs;
    const TURNS: bool = true;

    #[inline(always)]
    fn act<R: Real>(&self, k: &Coeffs, _own: &[R; 0], b: &Ends<R>, motion: Option<&Motion<R>>) -> Acts<R> {
        let r = length(b.r);
        let (none, one) = (r.like(0.0), r.like(1.0));
        let n = scale(one / r, b.r);
        let per_length = if self.normalize { one / b.length } else { one };

        // Stretch.
        let pull = (r - b.length) * k.stiffness.normal * per_length;

        // Shear: the angle γ between the carried and the current axis.
        let axis = turned(b.quat[1], b.axis);
        let s = cross(axis, n);
        let sine = length(s);
        let ks_r = per_length * r * k.stiffness.shear;
        let gamma = over(angle(sine, dot(axis, n)), sine) * ks_r;
        let mut shear = scale(-gamma, cross(n, s));
        let mut lever = scale(gamma * r * 0.5, s);

        // Bending by θ about n × e, and twist by ψ about n.
        let p = after(b.quat[0], back(b.quat[1]));
        let (p0, p) = (p[0], [p[1], p[2], p[3]]);
        let along = dot(p, n);
        let across = sub(p, scale(along, n));
        let (bent, upright) = (length(across), (p0 * p0 + along * along).sqrt());
        let theta = angle(bent, upright) * 2.0;
        let aside = cross(n, across);
        let norm = over(one, bent);
        let e = scale(norm, sub(scale(over(along, upright), across), scale(cosine(p0, upright), aside)));
        let ne = cross(n, e);
        let half = angle(along.abs(), p0) * 2.0;
        let psi = R::choose(along.above(none), half, R::choose((-along).above(none), -half, none));
        let (mut bend, mut twist) = (theta * k.stiffness.bend, psi * k.stiffness.twist);
        let mut sheared = ks_r * theta;
        if self.compat_lammps {
            let seen = turned(back(b.quat[1]), b.r);
            let below = R::both(
                none.above(seen[2]),
                one.above((seen[0].abs() + seen[1].abs()) * (1.0 / f64::MIN_POSITIVE)),
            );
            bend = R::choose(below, none, bend);
            twist = R::choose(below, none, twist);
            sheared = R::choose(below, none, sheared);
        }
        shear = sub(shear, scale(sheared * 0.5, e));
        lever = sub(lever, scale(sheared * r * 0.25, ne));
        let turning = add(scale(bend, ne), scale(twist, n));

        let load = pull / k.strength.normal
            + length(shear) / k.strength.shear
            + (bend * R::choose(bent.above(none), one, none)) / k.strength.bend
            + twist.abs() / k.strength.twist;
        let load = load.most(none);

        // On the second end; the opposite acts on the first.
        let mut on_second = add(scale(pull, n), shear);
        let mut torque = [sub(lever, turning), add(lever, turning)];
        if let Some(motion) = motion {
            let (drag, slow) = damped(k, b.r, r, n, motion);
            on_second = add(on_second, drag);
            torque[0] = add(torque[0], slow[0]);
            torque[1] = add(torque[1], slow[1]);
        }
        if self.smooth {
            let square = load * load;
            let fade = one - square * square;
            on_second = scale(fade, on_second);
            torque = [scale(fade, torque[0]), scale(fade, torque[1])];
        }
        Acts { force: scale(-one, on_second), torque, energy: none, load, power: none }
    }

    fn sweep(&self, pass: &Sweep<'_, 0, Coeffs>, out: &mut Out) {
        all(self, pass, out);
    }
}

/// a / b; 1 if the ends differ by half a turn (b = 0) and a direction must be chosen.
#[inline(always)]
fn cosine<R: Real>(a: R, b: R) -> R {
    R::choose(b.above(b.like(0.0)), over(a, b), b.like(1.0))
}

/// Dashpots: force on the second end and torques on both.
#[inline(always)]
fn damped<R: Real>(
    k: &Coeffs,
    r: Vec3<R>,
    distance: R,
    n: Vec3<R>,
    m: &Motion<R>,
) -> (Vec3<R>, [Vec3<R>; 2]) {
    let g = &k.damping;
    let along = dot(m.v, n);
    let both = add(m.omega[0], m.omega[1]);
    let half = distance.like(0.5);
    let slip = sub(sub(m.v, scale(along, n)), scale(half, cross(both, r)));
    let shear = scale(half.like(g.shear), slip);
    let lever = scale(half, cross(r, shear));
    let turning = sub(m.omega[0], m.omega[1]);
    let twist = dot(turning, n);
    let roll = sub(turning, scale(twist, n));
    let slow = add(scale(distance * (0.5 * g.bend), roll), scale(twist * (0.5 * g.twist), n));
    (add(scale(along * g.normal, n), shear), [sub(lever, slow), add(lever, slow)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_base::math::body::{Quat, UNTURNED, turn};

    const LAW: Rotational = Rotational { smooth: false, normalize: false, compat_lammps: false };

    fn coeffs() -> Coeffs {
        let one = Stiffness { normal: 1.0, shear: 1.0, twist: 1.0, bend: 1.0 };
        let stiffness = Stiffness { normal: 1.0, shear: 0.4, twist: 0.03, bend: 0.04 };
        Coeffs { stiffness, strength: one, damping: Stiffness::default() }
    }

    /// The first particle at the origin, the second at `a`, then displaced by `u`; both rotated.
    fn ends(a: Vec3, u: Vec3, quat: [Quat; 2]) -> Ends<f64> {
        let l = length(a);
        Ends { r: scale(-1.0, add(a, u)), length: l, axis: scale(-1.0 / l, a), quat }
    }

    fn near(ours: [Vec3; 3], wanted: [Vec3; 3]) {
        for (a, b) in ours.iter().flatten().zip(wanted.iter().flatten()) {
            // LAMMPS computes angles by arc cosines: for γ = 0.01 the relative error is ε/γ² = 2e-12.
            assert!((a - b).abs() <= 2e-15 + 2e-12 * b.abs(), "{ours:?}\n{wanted:?}");
        }
    }

    fn act(law: Rotational, k: &Coeffs, b: &Ends<f64>, m: Option<&Motion<f64>>) -> [Vec3; 3] {
        let acts = law.act(k, &[], b, m);
        [acts.force, acts.torque[0], acts.torque[1]]
    }

    /// From LAMMPS 22Jul2025 after `run 0`, `displace_atoms`, `set … quat`, `run 0`.
    #[test]
    fn states_as_lammps_prints_them() {
        let (k, x, at_rest) = (coeffs(), [1.0, 0.0, 0.0], [UNTURNED; 2]);
        let resultant = |b: Ends<f64>| act(LAW, &k, &b, None);
        near(resultant(ends(x, [0.01, 0.0, 0.0], at_rest)), [[0.01, 0.0, 0.0], [0.0; 3], [0.0; 3]]);
        let t = [0.0, 0.0, 2.00013333066379e-3];
        near(
            resultant(ends(x, [0.0, 0.01, 0.0], at_rest)),
            [[9.9975835657721e-6, 4.00036663716323e-3, 0.0], t, t],
        );
        let twisted = [UNTURNED, turn([1.0, 0.0, 0.0], 0.1)];
        near(resultant(ends(x, [0.0; 3], twisted)), [[0.0; 3], [0.003, 0.0, 0.0], [-0.003, 0.0, 0.0]]);
        let bent = [turn([0.0, 0.0, 1.0], -0.05), turn([0.0, 0.0, 1.0], 0.05)];
        near(resultant(ends(x, [0.0; 3], bent)), [[0.0; 3], [0.0, 0.0, 0.004], [0.0, 0.0, -0.004]]);
        let one = [UNTURNED, turn([0.0, 0.0, 1.0], 0.1)];
        near(resultant(ends(x, [0.0; 3], one)), [[0.0, -0.02, 0.0], [0.0, 0.0, -0.006], [0.0, 0.0, -0.014]]);
        let third = 1.0 / 3.0;
        let mixed = [
            turn([third, 2.0 * third, 2.0 * third], 7f64.to_radians()),
            turn([2.0 * third, -third, 2.0 * third], -11f64.to_radians()),
        ];
        near(
            resultant(ends([0.6, 0.48, 0.64], [0.02, -0.03, 0.01], mixed)),
            [
                [-0.0175660884121439, -0.00933536312176919, 0.0304659717104813],
                [0.00398792484777191, -0.0148212347301654, -0.00509519644298989],
                [0.0157897484510947, -0.0154856251982266, 0.00721201109295776],
            ],
        );
    }

    /// A bond along the z axis, its first end rotated by 6° about x: LAMMPS' numbers with the first end
    /// above; with the first end below LAMMPS gives zeros, and ours are the mirror image.
    #[test]
    fn bonds_along_z() {
        let (k, quat) = (coeffs(), [turn([1.0, 0.0, 0.0], 6f64.to_radians()), UNTURNED]);
        let torques = [[-0.01466076571675, 0.0, 0.0], [-0.006283185307179, 0.0, 0.0]];
        let wanted = |f: f64| [[0.0, f, 0.0], torques[0], torques[1]];
        let (above, below) = (ends([0.0, 0.0, -1.0], [0.0; 3], quat), ends([0.0, 0.0, 1.0], [0.0; 3], quat));
        near(act(LAW, &k, &above, None), wanted(-0.02094395102393));
        near(act(LAW, &k, &below, None), wanted(0.02094395102393));
        let compat = Rotational { compat_lammps: true, ..LAW };
        near(act(compat, &k, &above, None), wanted(-0.02094395102393));
        assert_eq!(act(compat, &k, &below, None), [[0.0; 3]; 3]);
    }

    #[test]
    fn dashpots_and_fading_as_lammps_has_them() {
        let mut k = coeffs();
        k.damping = Stiffness { normal: 0.1, shear: 0.02, twist: 0.005, bend: 0.003 };
        let motion = Motion { v: [-0.3, -0.2, 0.0], omega: [[0.0; 3], [0.5, 0.0, 0.7]] };
        let b = ends([1.0, 0.0, 0.0], [0.0; 3], [UNTURNED; 2]);
        near(
            act(LAW, &k, &b, Some(&motion)),
            [[0.03, -0.003, 0.0], [0.00125, 0.0, -0.00045], [-0.00125, 0.0, -0.00255]],
        );
        let mut k = coeffs();
        k.strength.normal = 0.02;
        let smooth = Rotational { smooth: true, ..LAW };
        let pulled =
            |u: f64| act(smooth, &k, &ends([1.0, 0.0, 0.0], [u, 0.0, 0.0], [UNTURNED; 2]), None)[0][0];
        assert!((pulled(0.01) - 0.009375).abs() < 1e-15 && (pulled(-0.01) + 0.01).abs() < 1e-15);
    }

    /// Conservation for a pair: T₁ + T₂ + r × F₁ = 0 with and without damping and fading.
    #[test]
    fn angular_momentum_is_kept() {
        let mut k = coeffs();
        k.damping = k.stiffness;
        let law = Rotational { smooth: true, ..LAW };
        let quat = [turn([0.6, 0.0, 0.8], 0.9), turn([0.0, -0.8, 0.6], -0.5)];
        let b = ends([0.2, -0.9, 0.4], [0.1, 0.05, -0.2], quat);
        let motion = Motion { v: [0.1, 0.2, -0.3], omega: [[0.2, -0.4, 0.1], [0.3, 0.3, -0.2]] };
        for m in [None, Some(&motion)] {
            let acts = law.act(&k, &[], &b, m);
            let sum = add(add(acts.torque[0], acts.torque[1]), cross(b.r, acts.force));
            assert!(length(sum) < 1e-15, "{sum:?}");
        }
    }
}
