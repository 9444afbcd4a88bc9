//! Bodies of more than one tile: what tiles cover, and that cutting a body changes its forces by rounding alone.

use std::collections::HashSet;

use super::scene::named;
use super::threads;
use perigrain_base::par;
use perigrain_peri::families::*;

/// A brick in whose middle some particles are missing, and a horizon: cut across planes alone, and across rows too.
const BRICKS: [([i32; 3], f64); 2] = [([24, 19, 14], 3.01), ([8, 66, 67], 1.8)];

fn brick([along, across, up]: [i32; 3]) -> Vec<[f64; 3]> {
    let at = |i: i32| [i % along, i / along % across, i / (along * across)].map(f64::from);
    let middle = [across, up].map(|n| 0.5 * f64::from(n - 1));
    let hole = |x: &[f64; 3]| (x[1] - middle[0]).abs() < 1.6 && (x[2] - middle[1]).abs() < 2.6;
    (0..along * across * up).map(at).filter(|x| !hole(x)).collect()
}

fn bounds() -> Bounds {
    Bounds { lo: [-50.0; 3], hi: [90.0; 3], periodic: [false; 3], tilt: [0.0; 3] }
}

fn families(
    (x0, horizon): (&[[f64; 3]], f64),
    kind: &'static str,
    layout: Layout,
    skip_rest: bool,
) -> Families {
    let mut table = PmbTable::new(1);
    table.set(1, 1, PmbCoeff { c: 1.0, horizon, s00: 0.02, alpha: 0.25 }).unwrap();
    let moduli = Moduli {
        bulk: 2.0,
        shear: 1.0,
        lambda: 0.4,
        tau: 3.0,
        yield_stress: 0.004,
        syc: -0.003,
        ..Moduli::default()
    };
    let law = Law {
        kind: named(kind).into(),
        moduli: vec![moduli],
        yields: vec![-0.003],
        dt: 1.0,
        ..Law::default()
    };
    let options = FamilyOptions { layout, skip_rest, ..FamilyOptions::new(1.0) };
    let (kinds, volume) = (vec![1; x0.len()], vec![1.0; x0.len()]);
    let view = PeriView { x: x0, x0, kind: &kinds, volume: &volume, bounds: bounds(), excluded: None };
    Families::build_of(&view, &table, options, law).unwrap()
}

/// Forces of some steps in which a part of the brick is pulled until bonds break, the other part at rest for long.
fn forces(x0: &[[f64; 3]], mut families: Families) -> (Vec<Vec<[f64; 3]>>, u64) {
    let (kind, volume) = (vec![1; x0.len()], vec![1.0; x0.len()]);
    let middle = 0.5 * x0.iter().fold(0.0, |most: f64, x| most.max(x[0]));
    let moved = |step: i32| {
        let at = move |x: &[f64; 3]| {
            let pull = 0.004 * f64::from(step) * (x[0] - middle).max(0.0);
            [
                x[0] + pull * (1.0 + 0.1 * (x[1] * 0.7).sin()),
                x[1] - 0.2 * pull,
                x[2] + 0.1 * pull * (x[2] * 0.9).cos(),
            ]
        };
        x0.iter().map(at).collect::<Vec<_>>()
    };
    let steps = (0..6).map(|step| {
        let x = moved(step);
        let view = PeriView { x: &x, x0, kind: &kind, volume: &volume, bounds: bounds(), excluded: None };
        let mut f = vec![[0.0; 3]; x.len()];
        families.force(&view, &mut f, true, None);
        f
    });
    let steps = steps.collect();
    (steps, families.live_bonds() as u64)
}

const LAWS: [&str; 7] = ["pmb", "lps", "ves", "eps", "plastic", "nonlinear", "shaped"];

#[test]
fn tiles_have_each_row_once_and_what_its_bonds_reach() {
    for ((size, horizon), at_least) in BRICKS.into_iter().zip([8, 32]) {
        let families = families((&brick(size), horizon), "pmb", Layout::Auto, true);
        look_at_tiles(families, at_least);
    }
}

fn look_at_tiles(mut families: Families, at_least: usize) {
    families.time_tiles();
    let body = &families.lattices[0];
    let tiles = &body.tiles;
    assert!(tiles.all.len() > at_least, "{}", tiles.all.len());
    let mut owner = vec![usize::MAX; body.rows.len()];
    for (k, tile) in tiles.all.iter().enumerate() {
        for slot in tile.planes.clone().flat_map(|p| tile.rows.clone().map(move |r| (p, r))) {
            let slot = body.slot(slot.0, slot.1);
            assert_eq!(owner[slot], usize::MAX, "a row is in two tiles");
            owner[slot] = k;
        }
    }
    let (mut across, mut claimed) = (HashSet::new(), HashSet::new());
    for (slot, row) in body.rows.iter().enumerate().filter(|(_, row)| row.len > 0) {
        let k = owner[slot];
        assert!(k < tiles.all.len(), "a row is in no tile");
        for &(beside, up) in &body.steps {
            let other = (slot + up * body.width).wrapping_add_signed(beside as isize);
            if body.rows[other].len == 0 {
                continue;
            }
            let (plane, place) = (other / body.width, other % body.width);
            let at = tiles.reached(k)[plane - tiles.all[k].planes.start];
            assert!(at.rows[0] <= place && place < at.rows[1], "a bond leads out of the window");
            let cell = body.rows[other].start as usize;
            assert!(at.cells[0] <= cell && cell < at.cells[1] && at.first <= cell);
            across.insert((k, owner[other]));
        }
        assert!(row.start as usize >= tiles.reached(k)[slot / body.width - tiles.all[k].planes.start].first);
    }
    for k in 0..tiles.all.len() {
        claimed.extend(tiles.graph.givers(k).iter().map(|&giver| (giver as usize, k)));
        assert!(
            tiles
                .graph
                .takers(k)
                .iter()
                .all(|&t| t as usize == k || tiles.graph.givers(t as usize).contains(&(k as u32)))
        );
        let window = tiles.reached(k);
        let apart = |w: &[tiles::Reached]| w[0].cells[1] - w[0].first <= w[1].cells[0] - w[1].first;
        assert!(window.windows(2).all(apart), "planes of a window overlap");
    }
    across.retain(|(giver, taker)| giver != taker);
    assert!(across.is_subset(&claimed));
}

/// The list adds bonds up in another order: of 122 terms each differs by some 1e-16 of the largest.
#[test]
fn tiles_give_the_forces_of_lists() {
    for (k, (size, horizon)) in BRICKS.into_iter().enumerate() {
        let x0 = brick(size);
        for kind in if k == 0 { &LAWS[..] } else { &LAWS[..2] } {
            let (tiled, bonds) = forces(&x0, families((&x0, horizon), kind, Layout::Auto, true));
            let (listed, same) = forces(&x0, families((&x0, horizon), kind, Layout::List, true));
            assert_eq!(bonds, same, "{kind:?}");
            let listed = listed.iter().flatten().flatten();
            let largest = listed.clone().fold(0.0, |most: f64, f| most.max(f.abs()));
            let off = tiled.iter().flatten().flatten().zip(listed);
            let off = off.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            assert!(largest > 0.0 && off < 1e-12 * largest, "{kind:?}: off by {off:e} of {largest:e}");
        }
    }
}

#[test]
fn same_bits_for_any_threads_with_and_without_skipping() {
    let _alone = threads::alone();
    for (k, (size, horizon)) in BRICKS.into_iter().enumerate() {
        let x0 = brick(size);
        for kind in if k == 0 { &LAWS[..] } else { &LAWS[..2] } {
            // Lists have fewer layouts of what bonds remember: three laws show all.
            let layouts =
                if LAWS[..3].contains(kind) { &[Layout::Auto, Layout::List][..] } else { &[Layout::Auto] };
            for &layout in layouts {
                let once = forces(&x0, families((&x0, horizon), kind, layout, true));
                for (count, skip) in [(1, false), (3, true), (7, false)] {
                    par::set_threads(count);
                    let again = forces(&x0, families((&x0, horizon), kind, layout, skip));
                    par::set_threads(1);
                    assert_eq!(once, again, "{kind:?}, {layout:?}, {count} threads, skipping {skip}");
                }
            }
        }
    }
}

/// Of a brick, of one that closes along its longest axis, and of one with a narrow waist.
#[test]
fn slabs_of_a_list_cover_what_their_bonds_reach() {
    let closed = Bounds { lo: [-0.5; 3], hi: [39.5, 8.5, 6.5], periodic: [true; 3], tilt: [0.0; 3] };
    let waist = |x: &[f64; 3]| (x[0] - 19.5).abs() < 12.0 && (x[1] - 4.0).abs() > 1.1;
    for (name, bounds, thin) in
        [("brick", bounds(), false), ("ring", closed, false), ("waist", bounds(), true)]
    {
        let x0: Vec<[f64; 3]> = (0..40 * 9 * 7)
            .map(|i| [i % 40, i / 40 % 9, i / 360].map(f64::from))
            .filter(|x| !thin || !waist(x))
            .collect();
        let mut table = PmbTable::new(1);
        table.set(1, 1, PmbCoeff { c: 1.0, horizon: 2.2, s00: 1.0, alpha: 0.0 }).unwrap();
        let (kind, volume) = (vec![1; x0.len()], vec![1.0; x0.len()]);
        let options = FamilyOptions { layout: Layout::List, ..FamilyOptions::new(1.0) };
        let view = PeriView { x: &x0, x0: &x0, kind: &kind, volume: &volume, bounds, excluded: None };
        let mut families = Families::build(&view, &table, options).unwrap();
        families.time_tiles();
        let (list, tiles) = (&families.list, &families.list.tiles);
        assert!(list.slabs() > 8, "{name}: {}", list.slabs());
        assert_eq!(list.ring, name == "ring");
        let slab_of = |record: usize| list.slab.partition_point(|first| *first as usize <= record) - 1;
        let mut wrapped = 0;
        for i in 0..list.record.len() {
            let slab = slab_of(i);
            let [ahead, back] = tiles.reached[slab];
            for j in list.own(i).map(|b| list.partner[b] as usize) {
                let first = list.slab[slab] as usize;
                assert!(
                    if j < first { j < back } else { j < ahead },
                    "{name}: a bond leads out of the window"
                );
                assert!(tiles.graph.takers(slab).contains(&(slab_of(j) as u32)), "{name}");
                wrapped += usize::from(j < first);
            }
            assert!(back == 0 || ahead == list.record.len(), "{name}");
        }
        assert_eq!(wrapped > 0, name == "ring");
        // All slabs have as many records, in sixteens.
        let slabs = list.slab.windows(2).map(|ends| ends[1] - ends[0]);
        assert!(slabs.clone().all(|records| records.abs_diff(list.slab[1]) <= 31), "{name}");
    }
}
