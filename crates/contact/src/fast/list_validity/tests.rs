//! How lists wear.

use super::*;
use perigrain_world::Travel;

/// Grains: enough for several slabs.
const ALL: usize = 288;
/// How many stand in one place.
const HEAP: usize = 32;

/// Three heaps of grains in each of three slabs, 1 apart along x.
fn scene() -> (Slabs, Vec<[f64; 3]>, Vec<u32>) {
    let x: Vec<[f64; 3]> = (0..ALL).map(|i| [(i / HEAP) as f64, 0.0, 0.0]).collect();
    let tag: Vec<u32> = (0..ALL as u32).collect();
    let mut slabs = Slabs::default();
    slabs.sort(&x, &tag, [2.8; 2], &[0.0; 3], &Periods::default());
    assert_eq!(slabs.near().count(), 3);
    (slabs, x, tag)
}

fn grains<'a>(
    x: &'a [[f64; 3]],
    tag: &'a [u32],
    more: (&'a [[f64; 3]], &'a [f64]),
    travel: Travel,
) -> Grains<'a> {
    let (still, radius) = more;
    let none = (&[][..], &[][..]);
    Grains {
        x,
        v: still,
        omega: still,
        radius,
        mass: radius,
        kind: &[1; ALL],
        tag,
        period: Default::default(),
        flow: None,
        body: none.0,
        frozen: none.1,
        travel,
    }
}

#[test]
fn lists_wear_by_what_ways_differ_and_slab_by_slab() {
    let (slabs, mut x, tag) = scene();
    let (still, radius) = ([[0.0; 3]; ALL], [0.5; ALL]);
    let mut validity = ListValidity::default();
    validity.divide(&slabs);
    let mut look = |x: &[[f64; 3]], all| {
        validity.strayed(&grains(x, &tag, (&still, &radius), Travel::default()), 0.1, all)
    };
    assert_eq!(look(&x, true), [0, 1, 2]);
    // All go far together.
    x.iter_mut().for_each(|x| x[1] += 3.0);
    assert_eq!(look(&x, false), [0usize; 0]);
    // The last grain leaves the others of its slab and of the slab before, which reaches into it.
    x[ALL - 1][0] += 0.06;
    assert_eq!(look(&x, false), [1, 2]);
    assert_eq!(look(&x, false), [0usize; 0], "the new lists know");
    x[ALL - 1][0] += 0.04;
    assert_eq!(look(&x, false), [0usize; 0], "less than half of the skin");
    x[0][2] = f64::NAN;
    assert_eq!(look(&x, false), [0], "the last slab reaches into the first only where the axis repeats");
    let mut around = Slabs::default();
    around.sort(&x[..8 * HEAP], &tag[..8 * HEAP], [2.8; 2], &[0.0; 3], &Periods::upright([8.0, 0.0, 0.0]));
    assert_eq!([0, 1, 2].map(|k| slabs.near().next(k)), [Some(1), Some(2), None]);
    assert_eq!([0, 1].map(|k| around.near().next(k)), [Some(1), Some(0)]);
}

#[test]
fn the_account_saves_looks_and_growth_counts_twice() {
    let (slabs, mut x, tag) = scene();
    let (still, mut radius) = ([[0.0; 3]; ALL], [0.5; ALL]);
    let mut travel = Travel::default();
    travel.begin(true);
    let mut validity = ListValidity::default();
    validity.divide(&slabs);
    validity.strayed(&grains(&x, &tag, (&still, &radius), travel), 0.1, true);
    travel.went(0.04);
    x[4 * HEAP][0] += 0.04;
    assert!(validity.strayed(&grains(&x, &tag, (&still, &radius), travel), 0.1, false).is_empty());
    travel.went(0.04);
    assert!(
        validity.strayed(&grains(&x, &tag, (&still, &radius), travel), 0.1, false).is_empty(),
        "0.04 of 0.05"
    );
    travel.went(0.04);
    radius[4 * HEAP] += 0.006;
    assert_eq!(validity.strayed(&grains(&x, &tag, (&still, &radius), travel), 0.1, false), [0, 1]);
}
