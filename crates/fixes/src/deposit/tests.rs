//! Positions and velocities by hand.

use super::*;
use perigrain_styles::testing::Bench;
use perigrain_world::AtomStyle;
use perigrain_world::region::Shape as Volume;

fn scene() -> Bench {
    let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [3.0, 0.0, 1.0]]);
    for (name, shape) in [
        ("slab", Volume::Block { lo: [-5.0, -5.0, 4.0], hi: [5.0, 5.0, 9.0] }),
        ("high", Volume::Block { lo: [-5.0, -5.0, 4.0], hi: [5.0, 5.0, 19.0] }),
    ] {
        b.world.regions.insert(Key::new(name), Region::inside(shape));
    }
    b.equal.insert("e".into(), 1.0);
    b
}

/// Position and velocity of the particle inserted in step 1.
fn first(b: &mut Bench, words: &str) -> Option<([f64; 3], [f64; 3])> {
    b.world.clock.step = 0;
    let fix = b.fix(&Deposit, words).unwrap();
    fix.declare(&mut b.world).unwrap();
    let mut ops = b.seal(&*fix).unwrap();
    b.world.clock.step = 1;
    b.stage(&mut ops, Stage::Exchange).unwrap();
    let p = &b.world.particles;
    let found = (p.len() == 3).then(|| (p.x[2], p.v[2]));
    b.world.gather(&[0, 1]);
    ops.iter_mut().for_each(|o| o.finish(&mut b.world).unwrap());
    found
}

#[test]
fn heights_and_directions() {
    let mut b = scene();
    b.world.clock.dt = 0.5;
    let (x, v) = first(&mut b, "5 1 10 44 region slab units box vz -2 -2").unwrap();
    assert!(x[2] > 4.0 && x[2] < 9.0 && v == [0.0, 0.0, -2.0]);
    // The top is at 1, both of all particles and of those within a lateral distance of 20.
    let (x, _) = first(&mut b, "5 1 10 44 region slab units box global 2 2").unwrap();
    assert_eq!(x[2], 3.0);
    let (x, _) = first(&mut b, "5 1 10 44 region slab units box local 2 2 20").unwrap();
    assert_eq!(x[2], 3.0);
    // No particle is that near: above the bottom of the box.
    let (x, _) = first(&mut b, "5 1 10 44 region slab units box local 2 2 0").unwrap();
    assert_eq!(x[2], -8.0);
    // Ten steps of 0.5 to the next insertion.
    let (still, _) = first(&mut b, "5 1 10 44 region slab units box").unwrap();
    let (x, _) = first(&mut b, "5 1 10 44 region slab units box rate 2").unwrap();
    assert_eq!(x[2], still[2] + 10.0);
    let (x, v) = first(&mut b, "5 1 10 44 region slab units box vz -2 -2 target 0 0 4").unwrap();
    let speed = v.map(|a| a * a).iter().sum::<f64>();
    assert!((speed - 4.0).abs() < 1e-14 && (v[0] / v[2] - x[0] / (x[2] - 4.0)).abs() < 1e-13);
    let (x, _) = first(&mut b, "5 1 10 44 region slab units box gaussian 1 2 8 0").unwrap();
    assert_eq!(x, [1.0, 2.0, 8.0]);
    // The bench's test accepts only positions with positive x.
    let (x, _) = first(&mut b, "5 1 10 44 region slab units box var e set x e attempt 50").unwrap();
    assert!(x[0] > 0.0);
    assert!(b.world.notes.is_empty());
    assert!(first(&mut b, "5 1 10 44 region slab units box near 30").is_none());
    assert!(b.world.notes.0[0].message.starts_with("at 1 steps"));
}

#[test]
fn mistakes_are_named() {
    let b = scene();
    for words in [
        "",
        "5 1 10 44",
        "5 2 10 44 region slab",
        "5 1 0 44 region slab",
        "5 1 10 0 region slab",
        "-5 1 10 44 region slab",
        "5 1 10 44 region high",
        "5 1 10 44 region no",
        "5 1 10 44 region slab near -1",
        "5 1 10 44 region slab attempt 0",
        "5 1 10 44 region slab gaussian 0 0 0 -1",
        "5 1 10 44 region slab var e",
        "5 1 10 44 region slab set x e",
        "5 1 10 44 region slab mol m",
        "5 1 10 44 region slab id last",
        "5 1 10 44 region slab unit box",
    ] {
        assert!(b.fix(&Deposit, words).is_err(), "{words}");
    }
}
