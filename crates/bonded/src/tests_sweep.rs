//! The loop over bonds in all forms that this processor supports, compared with single evaluations of the
//! law.

use super::columns::{Columns, Member};
use super::law::{BondLaw, Ends, Motion};
use super::rotational::{Coeffs, Rotational};
use super::spring::Breaking;
use super::stiffness::Stiffness;
use super::sweep::{Body, Out, Sweep, add_up_in, all_in, nearest};
use perigrain_base::math::body::{Quat, UNTURNED, after};
use perigrain_base::math::form::Form;
use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::{Vec3, add, dot, length, scale, sub};

fn bits<const N: usize>(a: [f64; N]) -> [u64; N] {
    a.map(f64::to_bits)
}

/// Bonds of two types, some of them missing and some breaking, in a box that is periodic along x.
fn same_as_one_by_one<const C: usize, L: BondLaw<C>>(
    law: &L,
    coeffs: [L::Coeffs; 2],
    damped: bool,
    own: [f64; C],
) {
    let mut state = 4711u64;
    let mut random = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    let n = 90;
    let mut vectors =
        |size: f64| -> Vec<Vec3> { (0..n).map(|_| [(); 3].map(|()| size * random())).collect() };
    let (x, v, omega, spin) = (vectors(4.0), vectors(0.1), vectors(0.1), vectors(0.2));
    let quat: Vec<Quat> = spin.iter().map(|s| [(1.0 - dot(*s, *s)).sqrt(), s[0], s[1], s[2]]).collect();
    let body = Body { x: &x, v: &v, omega: &omega, quat: &quat, periods: Periods::upright([4.0, 0.0, 0.0]) };
    let member = |k: usize| {
        let ends = [k % n, (7 * k + 1 + k / n) % n];
        let d = nearest(sub(x[ends[0]], x[ends[1]]), &body.periods);
        let far = length(d);
        let turned = if k.is_multiple_of(5) { [0.8, 0.6, 0.0, 0.0] } else { UNTURNED };
        // Some exceed their strength.
        let length = far * if k.is_multiple_of(11) { 0.7 } else { 0.99 };
        Member {
            kind: 1 + (k % 2) as u16,
            ends: ends.map(|e| e as u32),
            length,
            axis: scale(1.0 / far, d),
            turned,
            own,
        }
    };
    let members: Vec<Member<C>> = (0..301).map(member).filter(|m| m.ends[0] != m.ends[1]).collect();
    let mut columns = Columns::new(&members, n);
    [3, 17, 18, 160].into_iter().for_each(|k| columns.lose(k));
    let coeffs = [None, Some(coeffs[0]), Some(coeffs[1])];
    let pass =
        Sweep { columns: &columns, coeffs: &coeffs, body, damped, breaks: true, counts: true, groups: None };
    for form in Form::all() {
        let mut out = Out::default();
        // SAFETY: the processor supports this form.
        unsafe { all_in(form, law, &pass, &mut out) };
        let mut breaks = 0;
        for k in columns.living() {
            let [a, b] = columns.pair(k);
            let turned = columns.turned.get(k).copied().unwrap_or(UNTURNED);
            let ends = Ends {
                r: nearest(sub(x[a], x[b]), &body.periods),
                length: columns.length[k],
                axis: [0, 1, 2].map(|d: usize| columns.axis[d][k]),
                quat: [after(quat[a], turned), quat[b]],
            };
            let motion = Motion { v: sub(v[a], v[b]), omega: [omega[a], omega[b]] };
            let own = std::array::from_fn(|c| columns.own[c][k]);
            let Some(of) = &coeffs[usize::from(columns.kind(k))] else { panic!() };
            let acts = law.act(of, &own, &ends, damped.then_some(&motion));
            let breaks_now = acts.load >= 1.0;
            breaks += u32::from(breaks_now);
            let holds = |a: f64| if breaks_now { 0.0 } else { a };
            let [f, t] = [acts.force, acts.torque[1]].map(|a| a.map(holds));
            assert_eq!(bits(out.force[k].0), bits([f[0], f[1], f[2], acts.energy]), "{form:?}, bond {k}");
            assert_eq!(out.power[k].to_bits(), holds(acts.power).to_bits());
            if L::TURNS {
                assert_eq!(bits(out.torque[k][1].0), bits([t[0], t[1], t[2], 0.0]), "{form:?}, bond {k}");
            }
            assert!(!breaks_now || out.load[k].to_bits() == acts.load.to_bits());
        }
        assert!(breaks > 5 && breaks < 150 && out.broken, "{breaks}");
        assert!([3, 17, 18, 160].iter().all(|k| out.force[*k].0 == [0.0; 4]));
        let mut sums = vec![[1.0; 3]; n];
        // SAFETY: the processor supports this form.
        unsafe { add_up_in(form, &columns, &out, 0, &mut sums, None) };
        for (p, sum) in sums.iter().enumerate() {
            let mut force = [0.0; 3];
            for entry in columns.of(p) {
                let [fx, fy, fz, _] = out.force[*entry as usize / 2].0;
                force = add(force, scale([1.0, -1.0][*entry as usize % 2], [fx, fy, fz]));
            }
            assert_eq!(bits(*sum), bits(add([1.0; 3], force)));
        }
    }
}

#[test]
fn all_forms_have_the_bits_of_one_bond_after_the_other() {
    for damped in [false, true] {
        let springs = Breaking { smooth: true, normalize: false };
        same_as_one_by_one(&springs, [[7.0, 0.2, 0.3], [3.0, 0.1, 0.1]], damped, [0.8]);
        let beams = Rotational { smooth: true, normalize: false, compat_lammps: false };
        let stiffness = Stiffness { normal: 1.0, shear: 0.5, twist: 0.1, bend: 0.1 };
        let all = |a: f64| Stiffness { normal: a, shear: a, twist: a, bend: a };
        let of = |bears| Coeffs { stiffness, strength: all(bears), damping: all(0.1) };
        same_as_one_by_one(&beams, [of(0.9), of(1.5)], damped, []);
    }
}
