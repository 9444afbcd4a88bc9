//! Tiles compared with exhaustive search, upright and tilted.

use super::*;
use perigrain_base::math::rng::ParkMiller;
use std::collections::BTreeSet;

fn points(n: usize, box_: [f64; 3]) -> Vec<[f64; 3]> {
    let mut random = ParkMiller::new(7);
    (0..n).map(|_| box_.map(|l| l * random.uniform())).collect()
}

/// Pairs closer than `cut`, each with the image of the second, by exhaustive search.
fn all(x: &[[f64; 3]], cut: f64, period: Periods) -> BTreeSet<(usize, usize, u32)> {
    let mut found = BTreeSet::new();
    for image in 0..27 {
        let s = shift_of(image);
        if (0..3).any(|d| period.length[d] == 0.0 && s[d] != 0.0) {
            continue;
        }
        let by = period.shift(s);
        for (i, j) in (0..x.len()).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let square: f64 = (0..3).map(|d| (x[i][d] - x[j][d] - by[d]).powi(2)).sum();
            if square < cut * cut {
                found.insert((i, j, image));
            }
        }
    }
    found
}

#[test]
fn every_pair_is_met_once() {
    let edges = [8.0, 3.2, 5.0];
    let upright = points(300, edges);
    let tag: Vec<u32> = (0..300).map(|i| (i * 7919) % 300).collect();
    let boxes = [
        ([0.0; 3], [0.0; 3]),
        (edges, [0.0; 3]),
        ([8.0, 0.0, 0.0], [0.0; 3]),
        ([0.0, 3.2, 5.0], [0.0; 3]),
        (edges, [1.6, -4.0, 1.2]),
        (edges, [-1.5, 3.0, -1.6]),
        ([8.0, 3.2, 0.0], [1.6, 0.0, 0.0]),
        ([8.0, 0.0, 5.0], [0.0, 3.9, 0.0]),
        ([0.0, 3.2, 5.0], [1.6, 2.0, -1.0]),
    ];
    // Several tiles, and one tile of all.
    let cases = [(300, 1.0, 500), (300, 0.5, 100), (200, 1.0, 200)];
    for ((n, cut, least), (length, tilt)) in cases.into_iter().flat_map(|case| boxes.map(|of| (case, of))) {
        let period = Periods { length, tilt };
        assert!(period.repeats_where_it_leans());
        let lean = |x: &[f64; 3]| {
            let part = |d: usize| if period.length[d] > 0.0 { x[d] / period.length[d] } else { 0.0 };
            let ([y, z], [xy, xz, yz]) = ([part(1), part(2)], period.tilt);
            [x[0] + y * xy + z * xz, x[1] + z * yz, x[2]]
        };
        let x: Vec<[f64; 3]> = upright[..n].iter().map(lean).collect();
        let mut tiles = Tiles::default();
        tiles.sort(&x, &tag[..n], [cut; 2], &[0.0; 3], &period);
        assert!(tiles.count() > 1 || n < FEW);
        let mut found = BTreeSet::new();
        for k in 0..tiles.count() {
            let (beside, mut seen) = (tiles.beside(k), vec![]);
            let around = tiles.around(k, |_, image, places| seen.extend(places.map(|at| (at, image))));
            let is_beside = |at: &usize| beside.iter().any(|o| tiles.members(*o as usize).contains(at));
            let mut met = 0;
            for Neighbourhood { own, mut rows } in around.neighbourhoods() {
                let in_tile = |(at, image): &(usize, u32)| tiles.members(k).contains(at) && *image == HERE;
                assert!(seen[own.clone()].iter().all(in_tile));
                met += own.len();
                for i in own {
                    rows[0].start = i + 1;
                    for j in rows.iter().cloned().flatten() {
                        let ((i, _), (j, image)) = (seen[i], seen[j]);
                        assert!(tiles.members(k).contains(&j) || is_beside(&j));
                        let (a, b) = (tiles.order[i] as usize, tiles.order[j] as usize);
                        let entry = if a > b { (a, b, image) } else { (b, a, 26 - image) };
                        assert!(found.insert(entry), "{entry:?} twice");
                    }
                }
            }
            assert_eq!(met, tiles.members(k).len());
        }
        let wanted = all(&x, cut, period);
        assert!(wanted.len() > least && wanted.is_subset(&found), "{period:?}");
    }
}

#[test]
fn slabs_of_small_cells_are_as_thick_as_pairs_reach() {
    let x = points(3000, [9.0, 4.0, 3.0]);
    for period in [[0.0; 3], [9.0, 4.0, 3.0]].map(Periods::upright) {
        let tiles = Tiles::laid_out(&x, [0.3, 1.1], &[0.0; 3], &period);
        let (slabs, of_layers) = (tiles.slabs(), tiles.slabs().of_layers());
        let count = slabs.count();
        assert!(count >= 4);
        let of = |i: usize| of_layers[tiles.layer_of(&x[i])];
        for (i, j, _) in all(&x[..300], 1.1, period) {
            let (a, b) = (of(i), of(j));
            assert!(a == b || slabs.next(a) == Some(b) || slabs.next(b) == Some(a), "{a} {b}");
        }
    }
    assert_eq!(edges(&[1.0, 4.0], 0.5), [8.5, 8.5]);
    assert_eq!(edges(&[1.0, 3.9, 4.1], 0.5), [8.3, 8.7]);
}

#[test]
fn pairs_may_reach_beyond_all_numbers() {
    let (x, tag) = (points(20, [4.0; 3]), (0..20).collect::<Vec<u32>>());
    let mut tiles = Tiles::default();
    tiles.sort(&x, &tag, [1.0, 1e308], &[0.0; 3], &Periods::default());
    assert_eq!(tiles.slabs().count(), 1);
}

#[test]
fn the_order_depends_on_places_and_tags_alone() {
    let x = points(200, [3.0; 3]);
    let tag: Vec<u32> = (0..200).collect();
    let sorted = |x: &[[f64; 3]], tag: &[u32]| {
        let mut s = Tiles::default();
        s.sort(x, tag, [1.0; 2], &[0.0; 3], &Periods::default());
        s.order.iter().map(|&i| tag[i as usize]).collect::<Vec<_>>()
    };
    let (back, mixed): (Vec<_>, Vec<_>) = x.iter().copied().zip(tag.iter().copied()).rev().unzip();
    assert_eq!(sorted(&x, &tag), sorted(&back, &mixed));
    assert_eq!(sorted(&[], &[]), []);
    // Far points do not cost memory.
    let mut s = Tiles::default();
    s.sort(&[[0.0; 3], [1e12, 3.0, 4.0]], &[1, 2], [1.0; 2], &[0.0; 3], &Periods::default());
    assert!(s.start.len() < 200);
}
