//! Validity of lists after displacements.

use super::*;
use perigrain_world::Travel;

/// Grains: enough for several slabs.
const ALL: usize = 288;
/// Number of grains at one position.
const HEAP: usize = 32;

/// Three heaps of grains in each of three lists, spaced 1 along x; lists reach into the next one.
fn scene() -> (Vec<List>, Vec<[f64; 3]>, Vec<u32>) {
    let x: Vec<[f64; 3]> = (0..ALL).map(|i| [(i / HEAP) as f64, 0.0, 0.0]).collect();
    let tag: Vec<u32> = (0..ALL as u32).collect();
    let list = |k: usize| {
        let (mut list, own, from) = (List::default(), 3 * HEAP, 3 * HEAP * k);
        let grains = |range: std::ops::Range<usize>| range.map(|i| i as u32).collect::<Vec<_>>();
        list.watched.push(0, HERE, &grains(from..from + own));
        list.watched.push(1, HERE, &grains(from + own..(from + 2 * own).min(ALL)));
        // One three layers further, with nothing nearby.
        if k == 0 {
            list.watched.push(4, HERE, &[ALL as u32 - 1]);
        }
        list
    };
    ((0..3).map(list).collect(), x, tag)
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
fn lists_wear_by_what_ways_differ_and_one_by_one() {
    let (lists, mut x, tag) = scene();
    let (still, radius) = ([[0.0; 3]; ALL], [0.5; ALL]);
    let mut validity = ListValidity::default();
    validity.begin(lists.len());
    let mut look = |x: &[[f64; 3]], all| {
        validity.strayed(&lists, &grains(x, &tag, (&still, &radius), Travel::default()), 0.1, all)
    };
    assert_eq!(look(&x, true), [0, 1, 2]);
    // All move far together.
    x.iter_mut().for_each(|x| x[1] += 3.0);
    assert_eq!(look(&x, false), [0usize; 0]);
    // The last grain moves away from the others of its list and of the previous list, which reaches into it.
    x[ALL - 1][0] += 0.06;
    assert_eq!(look(&x, false), [1, 2]);
    assert_eq!(look(&x, false), [0usize; 0], "the new lists know");
    x[ALL - 1][0] += 0.04;
    assert_eq!(look(&x, false), [0usize; 0], "less than half of the skin");
    x[0][2] = f64::NAN;
    assert_eq!(look(&x, false), [0], "the last list does not reach into the first");
}

#[test]
fn images_move_with_the_box() {
    let (mut lists, x, tag) = scene();
    let (still, radius) = ([[0.0; 3]; ALL], [0.5; ALL]);
    // The last list sees the first grain one period further along x.
    lists[2].watched.push(1, HERE + 1, &[0]);
    let mut validity = ListValidity::default();
    let now = |length: f64| Periods::upright([length, 0.0, 0.0]);
    let grains = |length: f64| Grains {
        period: now(length),
        ..grains(&x, &tag, (&still, &radius), Travel::default())
    };
    validity.begin(lists.len());
    validity.strayed(&lists, &grains(9.0), 0.1, true);
    validity.follow(&now(9.0), &now(9.06));
    assert_eq!(validity.strayed(&lists, &grains(9.06), 0.1, false), [2]);
}

#[test]
fn the_account_saves_looks_and_growth_counts_twice() {
    let (lists, mut x, tag) = scene();
    let (still, mut radius) = ([[0.0; 3]; ALL], [0.5; ALL]);
    let mut travel = Travel::default();
    travel.begin(true);
    let mut validity = ListValidity::default();
    validity.begin(lists.len());
    validity.strayed(&lists, &grains(&x, &tag, (&still, &radius), travel), 0.1, true);
    travel.went(0.04);
    x[4 * HEAP][0] += 0.04;
    assert!(validity.strayed(&lists, &grains(&x, &tag, (&still, &radius), travel), 0.1, false).is_empty());
    travel.went(0.04);
    assert!(
        validity.strayed(&lists, &grains(&x, &tag, (&still, &radius), travel), 0.1, false).is_empty(),
        "0.04 of 0.05"
    );
    travel.went(0.04);
    radius[4 * HEAP] += 0.006;
    assert_eq!(validity.strayed(&lists, &grains(&x, &tag, (&still, &radius), travel), 0.1, false), [0, 1]);
}
