//! Tests of bonds by the gap of surfaces.

use super::Mix;
use crate::testing::{act, more, refused, scene};
use perigrain_world::World;

/// A packing in a box of this boundary, with two groups and weights that let bonds be made.
fn packing(boundary: &str) -> World {
    let mut w = scene(&format!(
        "units si\natom_style bpm/sphere\nboundary {boundary}\nregion b block 0 9 0 9 0 9 units box\n\
         create_box 1 b bond/types 2\nspecial_bonds lj/coul 0 1 1"
    ));
    more(&mut w, "create_atoms 1 pack b 0.5 77 sizes uniform 0.8 1.2");
    more(&mut w, "region low block INF INF INF INF INF 4 units box\ngroup low region low");
    w
}

/// Pairs by testing each: one in the first group, the other in the second, nearest images.
fn counted(w: &World, groups: [&str; 2], range: [f64; 2]) -> usize {
    let (p, domain) = (&w.particles, w.domain().unwrap());
    let bits = groups.map(|g| w.groups.find(g).unwrap().bit());
    let is = |i: usize, k: usize| p.mask[i] & bits[k] != 0;
    let mut count = 0;
    for i in 0..w.n() {
        for j in (0..i).filter(|&j| (is(i, 0) && is(j, 1)) || (is(j, 0) && is(i, 1))) {
            let d = domain.minimum_image([0, 1, 2].map(|k| p.x[i][k] - p.x[j][k]));
            let gap = d.iter().map(|a| a * a).sum::<f64>().sqrt() - p.radius[i] - p.radius[j];
            count += usize::from(gap >= range[0] && gap <= range[1]);
        }
    }
    count
}

#[test]
fn as_many_as_by_testing_each_pair() {
    for boundary in ["p p p", "f f p", "f f f"] {
        for (groups, range) in
            [(["all", "all"], [-0.1, 0.2]), (["low", "all"], [-0.01, 0.0]), (["low", "low"], [0.05, 0.5])]
        {
            let mut w = packing(boundary);
            let wanted = counted(&w, groups, range);
            let line = format!("create_bonds gap {} {} 2 {} {}", groups[0], groups[1], range[0], range[1]);
            let printed = act(&mut w, &line, &[]).unwrap();
            assert_eq!(printed, [format!("Added {wanted} bonds, new total = {wanted}")], "{boundary} {line}");
            assert!(wanted > 50 && w.bonds.list.iter().all(|b| b.kind == 2));
            // Bonded pairs are out of the lists.
            assert_eq!(act(&mut w, &line, &[]).unwrap(), [format!("Added 0 bonds, new total = {wanted}")]);
        }
    }
}

#[test]
fn a_mixture_goes_by_ids_alone() {
    let mut w = packing("p p p");
    let mut part = w.clone();
    more(&mut w, "create_bonds gap all all 1 -0.1 0.5 mix 2 0.3 4711");
    let second = |w: &World| w.bonds.list.iter().filter(|b| b.kind == 2).map(|b| b.ends).collect::<Vec<_>>();
    let (n, taken) = (w.bonds.len() as f64, second(&w).len() as f64);
    // Four standard deviations of a number drawn with probability 0.3 out of some thousands.
    assert!((taken / n - 0.3).abs() < 4.0 * (0.3 * 0.7 / n).sqrt(), "{taken} of {n}");
    // Bonds made piece by piece: the same ones have the other type.
    more(
        &mut part,
        "create_bonds gap low all 1 -0.1 0.5 mix 2 0.3 4711\ncreate_bonds gap all all 1 -0.1 0.5 mix 2 0.3 4711",
    );
    let (mut a, mut b) = (second(&w), second(&part));
    a.sort_unstable();
    b.sort_unstable();
    assert_eq!(a, b);
    let mix = |share: f64, seed: u32| Mix { kind: 2, share, seed };
    let of = |m: Mix| (1..=10_000u32).filter(|k| m.takes([*k, k + 1])).count();
    assert!((0..3).all(|k| mix(0.5, 7 + k).takes([12, 5]) == mix(0.5, 7 + k).takes([5, 12])));
    assert_eq!((of(mix(0.0, 3)), of(mix(1.0, 3))), (0, 10_000));
    // Four standard deviations of 10⁴ coins: 200.
    assert!(of(mix(0.5, 3)).abs_diff(5000) < 200);
    // Other seeds, others: half of them by chance.
    let both = (1..=10_000u32).filter(|k| mix(0.5, 3).takes([*k, 1]) && mix(0.5, 4).takes([*k, 1])).count();
    assert!(both.abs_diff(2500) < 200, "{both}");
}

#[test]
fn the_word_to_blame() {
    let w = packing("p p p");
    for (line, word) in [
        ("create_bonds gap all none 1 0 0.1", "none"),
        ("create_bonds gap all all 3 0 0.1", "3"),
        ("create_bonds gap all all 1 0.2 0.1", "0.1"),
        ("create_bonds gap all all 1 nan 0.1", "nan"),
        ("create_bonds gap all all 1 0 4", "4"),
        ("create_bonds gap all all 1 0 0.1 mix 3 0.5 1", "3"),
        ("create_bonds gap all all 1 0 0.1 mix 2 1.5 1", "1.5"),
        ("create_bonds gap all all 1 0 0.1 mix 2 0.5 0", "0"),
        ("create_bonds gap all all 1 0 0.1 special no", "no"),
    ] {
        assert_eq!(refused(&w, line).0, word, "{line}");
    }
    let mut w = w;
    more(&mut w, "special_bonds lj/coul 1 1 1");
    assert_eq!(refused(&w, "create_bonds gap all all 1 0 0.1").0, "create_bonds");
    let w = scene("units lj\natom_style bond\nregion b block 0 3 0 3 0 3\ncreate_box 1 b bond/types 2");
    assert_eq!(refused(&w, "create_bonds gap all all 1 0 0.1").0, "gap");
}
