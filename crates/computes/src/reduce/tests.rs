//! Sums, extremes and means by hand.

use super::*;
use perigrain_styles::testing::Bench;
use perigrain_styles::words::Value;
use perigrain_world::{AtomStyle, Compat};

fn scene() -> Bench {
    let mut b = Bench::new(
        AtomStyle::default(),
        &[[1.0, 1.0, 1.0], [-2.5, 1.5, 0.0], [4.0, 3.5, 2.0], [9.0, 9.0, 9.0]],
    );
    b.world.particles.mask[3] = 0;
    b
}

fn value(b: &mut Bench, words: &str) -> f64 {
    let c = b.compute(&Reduce, words).unwrap();
    b.evaluate(&*c).unwrap().scalar
}

#[test]
fn all_modes() {
    let mut b = scene();
    // From 1, -2.5, 4 by hand.
    let expected = [2.5, -2.5, 4.0, 2.5 / 3.0, 23.25, 23.25 / 3.0, 7.5, 2.5, 1.0, 4.0];
    for (mode, a) in Mode::KIND.choices().iter().map(|m| m.word).zip(expected) {
        assert_eq!(value(&mut b, &format!("{mode} x")), a, "{mode}");
    }
    // Oracle: LAMMPS 22Jul2025 prints the sum for aveabs of several inputs, and 1e20 for minabs.
    b.world.settings.compat = Compat::Lammps2025;
    assert_eq!((value(&mut b, "aveabs x"), value(&mut b, "minabs x")), (2.5, 1e20));
    let c = b.compute(&Reduce, "aveabs x x").unwrap();
    assert_eq!(b.evaluate(&*c).unwrap().vector, [7.5, 7.5]);
}

// Oracle: an empty group gives 1e20, -1e20, 0, 0 for min, max, maxabs, ave.
#[test]
fn nothing_has_lammps_extremes() {
    let mut b = scene();
    b.world.particles.mask.fill(0);
    let got = ["min", "max", "maxabs", "ave"].map(|m| value(&mut b, &format!("{m} x")));
    assert_eq!(got, [1e20, -1e20, 0.0, 0.0]);
}

#[test]
fn several_inputs_make_a_vector() {
    let mut b = scene();
    b.atom.insert("a".into(), vec![1.0, 2.0, 3.0, 4.0]);
    b.computes.insert("p".into(), Shape { atom: Some(2), ..Shape::default() });
    let s = b.world.slots.id("c_p");
    let slot = b.world.slots.get_mut(s);
    (slot.cols, slot.atom) = (2, vec![1.0, 10.0, 2.0, 20.0, 3.0, 30.0, 4.0, 40.0]);
    let c = b.compute(&Reduce, "sum z v_a c_p[2] c_p[*]").unwrap();
    assert_eq!(c.shape().vector, 5);
    assert_eq!(b.evaluate(&*c).unwrap().vector, [3.0, 6.0, 60.0, 6.0, 60.0]);
}

#[test]
fn replaced_by_what_stands_at_the_extreme() {
    let mut b = scene();
    // The largest x (4) has z = 2; it also has the largest z.
    let c = b.compute(&Reduce, "max z x y replace 1 2 replace 3 2").unwrap();
    assert_eq!(b.evaluate(&*c).unwrap().vector, [2.0, 4.0, 3.5]);
    let c = b.compute(&Reduce, "min z x replace 1 2").unwrap();
    assert_eq!(b.evaluate(&*c).unwrap().vector, [0.0, -2.5]);
}

#[test]
fn mistakes_are_named() {
    let mut b = scene();
    b.equal.insert("e".into(), 1.0);
    for words in [
        "",
        "sum",
        "total x",
        "sum q",
        "sum c_no",
        "sum v_e",
        "max x y replace 1 3",
        "ave x y replace 1 2",
        "max x y replace 1 1",
        "max x inputs local",
        "sum C_a[1]",
    ] {
        assert!(b.compute(&Reduce, words).is_err(), "{words}");
    }
}
