//! Lists are the same to the last bit in four and in eight lanes, and to rounding in portable ones.

use super::scene::named;
use perigrain_base::math::rng::ParkMiller;
use perigrain_peri::families::*;

/// What a few steps of a body that is shaken come to: forces, memory, measures, and the bonds that live.
type Outcome = (Vec<[f64; 3]>, Vec<f64>, Vec<f64>, Vec<u8>);

/// Kernels that a processor with eight lanes has.
#[derive(Clone, Copy, PartialEq)]
enum Kernels {
    Portable,
    Four,
    Widest,
}

const SIDE: i32 = 7;

fn shaken(kernels: Kernels, law: &Law, compat_lammps: bool, periodic: bool) -> Outcome {
    let mut random = ParkMiller::new(4711);
    let mut near = |x: [f64; 3], by: f64| x.map(|a| a + by * (random.uniform() - 0.5));
    let place = |i: i32| [i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE].map(f64::from);
    let x0: Vec<[f64; 3]> = (0..SIDE.pow(3)).map(|i| near(place(i), 0.3)).collect();
    let n = x0.len();
    let (kind, volume) = ((0..n).map(|i| 1 + (i % 3 / 2) as u16).collect::<Vec<_>>(), vec![1.0; n]);
    let bounds =
        Bounds { lo: [-0.5; 3], hi: [f64::from(SIDE) - 0.5; 3], periodic: [periodic; 3], tilt: [0.0; 3] };
    let mut table = PmbTable::new(2);
    for (a, b, c) in [(1, 1, 1.0), (1, 2, 0.7), (2, 2, 1.3)] {
        table.set(a, b, PmbCoeff { c, horizon: 3.01, s00: 0.02 * c, alpha: 0.25 }).unwrap();
    }
    let options = FamilyOptions {
        layout: Layout::List,
        volume: VolumeRule::Lammps,
        compat_lammps,
        no_repulsion: true,
        portable: kernels == Kernels::Portable,
        ..FamilyOptions::new(1.0)
    };
    macro_rules! view {
        ($x:expr) => {
            PeriView { x: $x, x0: &x0, kind: &kind, volume: &volume, bounds, excluded: None }
        };
    }
    let mut families = Families::build_of(&view!(&x0), &table, options, law.clone()).unwrap();
    families.four_lanes = kernels == Kernels::Four;
    let mut f = vec![];
    for step in 0..6 {
        let x: Vec<[f64; 3]> = x0.iter().map(|x| near(*x, 0.006 * f64::from(step))).collect();
        f = vec![[0.0; 3]; n];
        families.force(&view!(&x), &mut f, true, None);
    }
    let list = families.list;
    (f, list.state.memory, list.limits.least, list.alive)
}

#[test]
fn bits_do_not_depend_on_how_many_lanes_there_are() {
    let own =
        Moduli { bulk: 1.0, shear: 0.6, lambda: 0.5, tau: 3.0, yield_stress: 0.001, ..Moduli::default() };
    let kinds = [
        ("pmb", Influence::Inverse),
        ("lps", Influence::Gaussian),
        ("ves", Influence::Inverse),
        ("eps", Influence::One),
        ("shaped", Influence::Inverse),
    ];
    for (kind, influence) in kinds {
        for (compat, periodic) in [(false, false), (true, false), (false, true)] {
            let moduli = vec![own; 2];
            let law = Law { kind: named(kind).into(), influence, moduli, dt: 1.0, ..Law::default() };
            let (f, memory, least, alive) = shaken(Kernels::Portable, &law, compat, periodic);
            let living: u32 = alive.iter().map(|b| b.count_ones()).sum();
            assert!(living > 1000 && f.len() == SIDE.pow(3) as usize);
            assert!(named(kind).memory() == 0 || memory.iter().any(|m| *m != 0.0), "{kind:?} remembers");
            assert!(least.iter().filter(|z| **z < 0.0).count() > 300, "{kind:?} has measures");
            let four = shaken(Kernels::Four, &law, compat, periodic);
            assert_eq!(four.3, alive);
            let most = f.iter().flatten().fold(0.0f64, |m, f| m.max(f.abs()));
            let off = f.iter().flatten().zip(four.0.iter().flatten()).map(|(a, b)| (a - b).abs());
            // Sums of some hundred forces, rounded once or twice for each product.
            assert!(off.fold(0.0, f64::max) < 1e-12 * most, "{kind:?} {compat} {periodic}");
            assert!(four == shaken(Kernels::Widest, &law, compat, periodic), "{kind:?} {compat} {periodic}");
        }
    }
}
