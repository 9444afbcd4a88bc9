//! Kicks and drifts of a few particles, with and without fused forces. Masses are looked up as in the
//! program: any other closure would be compiled for all forms of a pass.

use super::*;
use perigrain_base::math::body::Quat;
use perigrain_base::math::vec3::Vec3;
use perigrain_plan::Pull;

const N: usize = 11;

fn some(seed: usize) -> Vec<Vec3> {
    let at = |i: usize| (((i * 7919 + seed * 104_729) % 1013) as f64 - 506.0) / 97.0;
    (0..N).map(|i| [at(3 * i), at(3 * i + 1), at(3 * i + 2)]).collect()
}

/// Positions, velocities and spins after these parts, by any form, and the last largest v².
fn moved(parts: &[Part], wide: bool) -> (Vec<Vec3>, Vec<Vec3>, Vec<Vec3>, f64) {
    let (mut x, mut v, mut omega) = (some(1), some(2), some(3));
    let (mut f, mut torque) = (some(4), some(5));
    let radius: Vec<f64> = (0..N).map(|i| 0.3 + 0.01 * i as f64).collect();
    let mask: Vec<u32> = (0..N).map(|i| if i == 6 { 1 } else { 3 }).collect();
    let k = Kick { half: 0.01, spin: 0.025, dt: 0.02, bit: 2, oriented: false };
    let mass: Vec<f64> = (0..N).map(|i| 1.0 + i as f64 / 3.0).collect();
    let masses = |k: usize| std::array::from_fn(|l| mass.get(4 * k + l).copied().unwrap_or(1.0));
    let mut fastest = 0.0;
    for part in parts {
        let (x, v, f, omega, torque) = (&mut x[..], &mut v[..], &mut f[..], &mut omega[..], &mut torque[..]);
        let c = Chunk { x, v, f, mask: &mask, omega, torque, radius: &radius, quat: &mut [] };
        let beside = Beside::default();
        fastest = match (part, wide) {
            (_, true) => k.block(c, true, *part, &Masses::Own(&mass), 0, &beside),
            // SAFETY: the portable form has no requirements.
            (Part::First, _) => unsafe { k.four::<Plain, 1, true, true>(c, &beside, masses) },
            // SAFETY: as above.
            (Part::Second, _) => unsafe { k.four::<Plain, 1, false, true>(c, &beside, masses) },
            // SAFETY: as above.
            (Part::Both, _) => unsafe { k.four::<Plain, 2, true, true>(c, &beside, masses) },
        }
        .most;
    }
    (x, v, omega, fastest)
}

#[test]
fn one_pass_has_the_bits_of_two_on_any_processor() {
    let two = moved(&[Part::First, Part::Second, Part::First], false);
    assert_eq!(moved(&[Part::First, Part::Both], false), two);
    assert_eq!(moved(&[Part::First, Part::Both], true), two);
}

#[test]
fn the_formula_of_a_kick_and_a_drift() {
    let (x, v, omega, fastest) = moved(&[Part::First], true);
    let (x0, v0, omega0, f, torque) = (some(1), some(2), some(3), some(4), some(5));
    let mut most = 0.0_f64;
    for i in 0..N {
        let (m, r) = (1.0 + i as f64 / 3.0, 0.3 + 0.01 * i as f64);
        for d in 0..3 {
            let here = if i == 6 { 0.0 } else { 1.0 };
            let now = v0[i][d] + here * (0.01 / m) * f[i][d];
            assert_eq!(v[i][d], now);
            assert_eq!(x[i][d], x0[i][d] + here * 0.02 * now);
            assert_eq!(omega[i][d], omega0[i][d] + here * (0.025 / (r * r * m)) * torque[i][d]);
        }
        if i != 6 {
            most = most.max(v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2]);
        }
    }
    assert_eq!(fastest, most);
    assert_eq!([largest(1.0, f64::NAN), largest(f64::INFINITY, 2.0)], [f64::INFINITY; 2]);
}

#[test]
fn what_stands_beside_a_motion_has_the_bits_it_has_alone() {
    let (pull, held) = (Pull { bit: 1, a: [0.3, -0.7, 1.1] }, 4);
    let k = Kick { half: 0.01, spin: 0.025, dt: 0.02, bit: 2, oriented: false };
    let mass: Vec<f64> = (0..N).map(|i| 1.0 + i as f64 / 3.0).collect();
    let radius: Vec<f64> = (0..N).map(|i| 0.3 + 0.01 * i as f64).collect();
    // All alike, one held, one not pulled, one not moving.
    let masks = [[3; N], [3, 3, 3, 3, 7, 3, 3, 3, 3, 3, 7], [3, 3, 3, 3, 3, 2, 3, 3, 1, 3, 3]];
    for (mask, flat, clears) in masks.into_iter().flat_map(|m| [(m, 0, true), (m, 2, true), (m, 2, false)]) {
        let beside = Beside { pull: Some(pull), held, flat, clears };
        let run = |together: bool| {
            let (mut x, mut v, mut omega) = (some(1), some(2), some(3));
            let (mut f, mut torque) = (some(4), some(5));
            let (mut energy, mut taken) = (0.0, [0.0; 3]);
            if !together {
                energy = pulled_each(&mut f, &x, &mass, &mask, pull.bit, pull.a);
                for i in (0..N).filter(|&i| mask[i] & held != 0) {
                    (0..3).for_each(|d| taken[d] += f[i][d]);
                    (f[i], torque[i]) = ([0.0; 3], [0.0; 3]);
                }
                flatten([&mut v, &mut f], &mask, flat);
                flatten_turning([&mut omega, &mut torque], &mask, flat);
            }
            let c = Chunk {
                x: &mut x,
                v: &mut v,
                f: &mut f,
                mask: &mask,
                omega: &mut omega,
                torque: &mut torque,
                radius: &radius,
                quat: &mut [],
            };
            let with = if together { beside } else { Beside::default() };
            let came = k.block(c, true, Part::Both, &Masses::Own(&mass), 0, &with);
            if together {
                (energy, taken) = (came.energy, came.held);
            }
            if together && clears {
                assert_eq!([f, torque], [vec![[0.0; 3]; N], vec![[0.0; 3]; N]]);
                return ((x, v, omega, taken, came.most, None), energy);
            }
            let left = (!clears).then_some([f, torque]);
            ((x, v, omega, taken, came.most, left), energy)
        };
        let ((one, energy), (each, expected)) = (run(true), run(false));
        assert_eq!(one, each);
        // Eleven terms of about 10, summed in a different order.
        assert!((energy - expected).abs() < 1e-13, "{energy} {expected}");
    }
}

#[test]
fn a_motion_by_no_number_is_infinitely_fast_whatever_follows() {
    let k = Kick { half: 0.01, spin: 0.025, dt: 0.02, bit: 1, oriented: false };
    for i in 0..N {
        let (mut x, mut v, mut f) = (some(1), some(2), some(4));
        v[i][1] = f64::NAN;
        let (x, v, f) = (&mut x[..], &mut v[..], &mut f[..]);
        let c = Chunk { x, v, f, mask: &[1; N], omega: &mut [], torque: &mut [], radius: &[], quat: &mut [] };
        let most = k.block(c, false, Part::First, &Masses::Own(&[1.0; N]), 0, &Beside::default()).most;
        assert_eq!(most, f64::INFINITY, "{i}");
    }
}

#[test]
fn particles_that_do_not_turn_keep_the_orientation_bit_by_bit() {
    let k = Kick { half: 0.01, spin: 0.025, dt: 0.02, bit: 1, oriented: true };
    let (mut x, mut v, mut f, mut omega) = (some(1), some(2), some(4), some(5));
    // One of the first four rotates, all of the next four, none of the rest.
    (0..N).filter(|i| !(*i == 2 || (4..8).contains(i))).for_each(|i| omega[i] = [0.0; 3]);
    let (spins, radius) = (omega.clone(), [0.5; N]);
    // Lengths are 1 up to rounding, which an empty step would change.
    let before: Vec<Quat> = (0..N).map(|i| [0.3 + 0.1 * i as f64, -0.2, 0.4, 0.1 * i as f64]).collect();
    let (mut quat, mut torque) = (before.clone(), vec![[0.0; 3]; N]);
    let c = Chunk {
        x: &mut x,
        v: &mut v,
        f: &mut f,
        mask: &[1; N],
        omega: &mut omega,
        torque: &mut torque,
        radius: &radius,
        quat: &mut quat,
    };
    k.block(c, true, Part::First, &Masses::Own(&[1.0; N]), 0, &Beside::default());
    for i in 0..N {
        let turned = if spins[i] == [0.0; 3] { before[i] } else { rolled(before[i], spins[i], 0.01) };
        assert_eq!(quat[i], turned, "{i}");
    }
}
