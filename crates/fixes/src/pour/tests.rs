//! Batches compared with hand calculations and with LAMMPS.

use super::*;
use perigrain_plan::Stage;
use perigrain_styles::testing::Bench;
use perigrain_world::AtomStyle;
use perigrain_world::region::{Region, Shape as Volume};

fn scene() -> Bench {
    let mut b = Bench::new(AtomStyle { sphere: true, sphere_mass: true, ..AtomStyle::default() }, &[]);
    b.pulls = vec![Pull::Constant([0.0, 0.0, -1.0])];
    b.world.clock.dt = 0.01;
    for (name, shape) in [
        ("slab", Volume::Block { lo: [-5.0, -5.0, 4.0], hi: [5.0, 5.0, 9.0] }),
        ("pipe", Volume::Cylinder { axis: 2, center: [1.0, 0.0], radius: 4.0, lo: 0.0, hi: 8.0 }),
        ("log", Volume::Cylinder { axis: 0, center: [1.0, 0.0], radius: 4.0, lo: 0.0, hi: 8.0 }),
        ("ball", Volume::Sphere { center: [0.0; 3], radius: 3.0 }),
        ("high", Volume::Block { lo: [-5.0, -5.0, 4.0], hi: [5.0, 5.0, 19.0] }),
    ] {
        b.world.regions.insert(Key::new(name), Region::inside(shape));
    }
    let out = Region { outside: true, ..b.world.regions["slab"].clone() };
    b.world.regions.insert(Key::new("out"), out);
    b
}

#[test]
fn batches_come_when_the_last_one_has_fallen_out() {
    let mut b = scene();
    let fix = b.fix(&Pour, "100 1 4711 region slab vol 0.2 50 vel 0 0 0 0 -2 diam one 1").unwrap();
    fix.declare(&mut b.world).unwrap();
    let mut ops = b.seal(&*fix).unwrap();
    // 0.2 · 500/(π/6) = 190 spheres would fit: all 100 are inserted at once. −2 + √(4 + 10) = 1.7417 time
    // units.
    b.world.clock.step = 1;
    b.stage(&mut ops, Stage::Exchange).unwrap();
    assert_eq!(b.world.n(), 100);
    let p = &b.world.particles;
    for i in 0..100 {
        let fallen = -(4.0f64 + 2.0 * (9.0 - p.x[i][2])).sqrt();
        assert!((p.v[i][2] - fallen).abs() < 1e-14 && p.x[i][2] > 4.0 && p.radius[i] == 0.5);
        assert!((0..i).all(|j| {
            let d = [0, 1, 2].map(|k| p.x[i][k] - p.x[j][k]);
            d.map(|a| a * a).iter().sum::<f64>() > 1.0
        }));
    }
    assert!(b.world.rebuild.due && b.world.memo["pour/f"][1].is_nan());
}

#[test]
fn what_was_poured_is_remembered_across_runs() {
    let mut b = scene();
    let fix = b.fix(&Pour, "9 1 4711 region pipe vol 0.004 50 diam range 0.5 1").unwrap();
    fix.declare(&mut b.world).unwrap();
    let mut ops = b.seal(&*fix).unwrap();
    b.world.clock.step = 1;
    b.stage(&mut ops, Stage::Exchange).unwrap();
    assert_eq!((b.world.n(), b.slot_of("f_f").scalar), (3, 3.0));
    // √(2 · 8) = 4 time units of 100 steps: next at step 401, however often runs begin.
    b.world.clock.step = 77;
    let mut ops = b.seal(&*fix).unwrap();
    for step in 78..401 {
        b.world.clock.step = step;
        b.stage(&mut ops, Stage::Exchange).unwrap();
    }
    assert_eq!(b.world.n(), 3);
    b.world.clock.step = 401;
    b.stage(&mut ops, Stage::Exchange).unwrap();
    assert_eq!(b.world.n(), 6);
}

#[test]
fn mistakes_are_named() {
    let mut b = scene();
    for words in [
        "",
        "10 1 44",
        "10 2 44 region slab",
        "10 1 0 region slab",
        "-1 1 44 region slab",
        "10 1 44 region log",
        "10 1 44 region ball",
        "10 1 44 region high",
        "10 1 44 region out",
        "10 1 44 region nowhere",
        "10 1 44 region slab diam two 1 2",
        "10 1 44 region slab diam one 0",
        "10 1 44 region slab diam range 2 1",
        "10 1 44 region slab diam poly 2 1 0.5 2 0.4",
        "10 1 44 region slab vol 1.1 10",
        "10 1 44 region slab vol 0.1 0",
        "10 1 44 region slab dens 2 1",
        "10 1 44 region slab dens 0 1",
        "10 1 44 region slab vel 1 0 0 0 0",
        "10 1 44 region slab id last",
        "10 1 44 region slab mol m",
        "10 1 44 region slab units box",
    ] {
        assert!(b.fix(&Pour, words).is_err(), "{words}");
    }
    let fix = b.fix(&Pour, "10 1 44 region slab diam one 30").unwrap();
    assert_eq!(b.seal(&*fix).err().unwrap().0[0].code, Code::BAD_VALUE);
    let fix = b.fix(&Pour, "10 1 44 region slab").unwrap();
    let down = Pull::Constant([0.0, 0.0, -1.0]);
    for pulls in [vec![], vec![down, down], vec![Pull::Varying], vec![Pull::Constant([0.0, 0.1, -1.0])]] {
        b.pulls = pulls;
        assert_eq!(b.seal(&*fix).err().unwrap().0[0].code, Code::INCOMPLETE);
    }
}
