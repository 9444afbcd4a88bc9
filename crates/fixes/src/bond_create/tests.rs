//! Which bonds fix bond/create makes in a row of particles, and what it refuses.

use super::*;
use perigrain_styles::testing::Bench;
use perigrain_world::AtomStyle;

/// Five in a row at distances of 1, 0.8, 0.9 and 1.2.
fn row() -> Bench {
    let places: Vec<[f64; 3]> = [-3.0, -2.0, -1.2, -0.3, 0.9].map(|x| [x, 0.0, 0.0]).into();
    let mut b = Bench::new(AtomStyle { bonded: true, ..AtomStyle::default() }, &places);
    b.world.bonds.types = 1;
    b.world.bonds.weights.lj = [0.0, 1.0, 1.0];
    b
}

fn made(b: &mut Bench, words: &str) -> Vec<usize> {
    let fix = b.fix(&BondCreate, words).unwrap();
    fix.declare(&mut b.world).unwrap();
    let mut ops = b.seal(&*fix).unwrap();
    let mut sizes = vec![];
    for _ in 0..4 {
        b.world.clock.step += 1;
        b.stage(&mut ops, Stage::PostIntegrate).unwrap();
        sizes.push(b.world.bonds.len());
    }
    assert_eq!(b.slot_of("f_f").vector[1], sizes[3] as f64);
    sizes
}

// By hand: 2 and 3 are nearest to each other; then 1 chooses 2 and 2 chooses 1, and 3 and 4 each other; then 4 and 5.
#[test]
fn each_particle_gets_its_nearest_partner() {
    assert_eq!(made(&mut row(), "1 1 1 1.25 1"), [1, 3, 4, 4]);
    // The weights 0 0 0 exclude second neighbours as well; nothing but neighbours is nearer than 1.25 here.
    let mut b = row();
    b.world.bonds.weights.lj = [0.0; 3];
    assert_eq!(made(&mut b, "1 1 1 3.5 1"), [1, 3, 4, 4]);
    // With 0 1 1 they are not excluded: once the chain is closed, second neighbours are bonded.
    assert!(made(&mut row(), "1 1 1 3.5 1")[3] > 4);
}

// With at most one bond each: 2 with 3, then only 4 and 5 have a free neighbour within reach.
#[test]
fn limits_hold() {
    assert_eq!(made(&mut row(), "1 1 1 1.25 1 iparam 1 1 jparam 1 1"), [1, 2, 2, 2]);
    assert_eq!(made(&mut row(), "1 1 1 1.25 1 prob 0 7"), [0, 0, 0, 0]);
}

#[test]
fn mistakes_are_named() {
    let b = row();
    for words in [
        "",
        "0 1 1 1.4 1",
        "1 2 1 1.4 1",
        "1 1 1 -1 1",
        "1 1 1 1.4 2",
        "1 1 1 1.4 1 iparam 2 1",
        "1 1 1 1.4 1 iparam -1 1 jparam -1 1",
        "1 1 1 1.4 1 iparam 1 3 jparam 1 3",
        "1 1 1 1.4 1 prob 2 7",
        "1 1 1 1.4 1 atype 1",
        "1 1 1 1.4 1 odds 1",
    ] {
        assert!(b.fix(&BondCreate, words).is_err(), "{words}");
    }
    let atoms = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
    assert!(atoms.fix(&BondCreate, "1 1 1 1.4 1").is_err());
}
