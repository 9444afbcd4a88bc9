//! Displacements of any size and contacts that slip, by lines of a deck.

use super::testing::{Beams, Law, act_with};
use super::tests::{fcc, near, refused, two_spheres};

#[test]
fn a_pair_between_walls_does_not_turn() {
    let mut w = two_spheres();
    // Section 10.5 of the page on bonded particles: along one line directions stay, and K is that of small displacements.
    for words in ["large yes", "mu 0.3 steps 3", "large yes prestress keep"] {
        let line = format!("calibrate dsm a all strain -0.02 low wall high wall tol 1e-9 {words}");
        let did = act_with(&mut w, &line, Beams::standard(1), Law::Hertz).unwrap();
        near(did.numbers[0], 57814.74222, 1e-9);
        near(did.numbers[5], -2.31258968887, 1e-9);
        assert!(did.numbers[4].is_nan() && did.notes.is_empty(), "{did:?}");
        assert!(did.lines[0].contains("ends held: 1 at a wall + 1 at a wall"));
    }
    let line = "calibrate fit f all target K 57814.74222 vary bond 1 E strain -0.02 low wall high wall tol 1e-8 large yes";
    let mut start = Beams::standard(1);
    start.0.insert(1, [0.3e9, 0.2, 0.4e-3]);
    let did = act_with(&mut w, line, start, Law::Hertz).unwrap();
    near(did.then[0].split(' ').nth(2).unwrap().parse().unwrap(), 1e9, 1e-6);
}

#[test]
fn friction_between_nothing_and_sticking() {
    let mut w = fcc();
    w.bonds.weights.lj = [1.0; 3];
    let mut k = |words: &str| {
        let line = format!("calibrate dsm a all strain -0.01 tol 1e-5 {words}");
        let did = act_with(&mut w, &line, Beams::standard(2), Law::Hertz).unwrap();
        assert!(did.notes.is_empty(), "{words}: {did:?}");
        (did.numbers[0], did.lines[0].clone())
    };
    let all = [k("mu 0"), k("mu 0.1"), k("mu 0.1 steps 4"), k("large yes")];
    assert!(all[0].0 < all[1].0 && all[1].0 < all[3].0, "{all:?}");
    // The way is the same to a thousandth: all contacts slip more and more in one direction.
    near(all[2].0, all[1].0, 1e-3);
    assert!(all[1].1.contains(" slip);") && !all[3].1.contains("slip"), "{all:?}");
    let mut e = |words: &str| {
        let line = format!("calibrate ste a all strain -0.01 {words}");
        act_with(&mut w, &line, Beams::standard(2), Law::Hertz).unwrap().numbers[1]
    };
    let (slick, rough, sticks) = (e("mu 0"), e("mu 0.1"), e("mu 1e6"));
    assert!(slick < rough && rough < sticks && sticks < e(""), "{slick} {rough} {sticks}");
}

#[test]
fn contacts_that_bear_much_and_stick_give_a_warning() {
    let mut w = fcc();
    w.bonds.weights.lj = [1.0; 3];
    let mut soft = Beams::standard(2);
    soft.0.values_mut().for_each(|b| b[0] = 1e7);
    let mut notes = |words: &str, law: Law| {
        let line = format!("calibrate {words}");
        act_with(&mut w, &line, soft.clone(), law).unwrap().notes
    };
    let stuck = "contacts bear ";
    let warnings = notes("dsm a all strain -0.02", Law::Hertz);
    assert!(
        warnings.len() == 1 && warnings[0].starts_with(stuck) && warnings[0].contains(" none of them slips"),
        "{warnings:?}"
    );
    assert!(
        notes("fit a all strain -0.02 target K 3e6 vary bond 1 E", Law::Hertz)[0]
            .starts_with("contacts bear ")
    );
    for quiet in [
        "dsm a all strain -0.02 mu 0.3",
        "dsm a all strain -0.02 contacts no",
        "dsm a all strain -0.02 method paper",
    ] {
        assert_eq!(notes(quiet, Law::Hertz), Vec::<String>::new(), "{quiet}");
    }
}

#[test]
fn words_that_do_not_go_together() {
    let w = fcc();
    for (line, wanted) in [
        (
            "calibrate dsm a all mu 0.3 contacts no",
            "[mu] `mu` is about contacts, and `contacts no` leaves them out",
        ),
        ("calibrate dsm a all steps 3", "[steps] `steps` is for displacements of any size"),
        (
            "calibrate dsm a all large yes bound yes",
            "[yes] `bound yes` is for small displacements of bonds alone",
        ),
        ("calibrate dsm a all large yes method paper", "[paper] `method paper` has small displacements"),
        ("calibrate dsm a all mu -1", "[-1] "),
        ("calibrate dsm a all large yes steps 0", "[0] "),
        ("calibrate dsm a all mu 0.3", "[mu] contacts need the coefficients of Hertz contacts"),
        (
            "calibrate strength a all large yes",
            "[large] `large` does not concern `calibrate strength` | `calibrate dsm` has it",
        ),
        (
            "calibrate fit a all target K 1e6 vary bond 1 E large yes method ste",
            "[large] this method of a fit has small displacements",
        ),
        (
            "calibrate fit a all target K 1e6 vary bond 1 E mu 0.3 steps 2 method ste",
            "[steps] this method of a fit has small displacements",
        ),
        (
            "calibrate fit a all target K 1e9 vary bond 1 E mu 0.3 method periodic",
            "[mu] this method of a fit has small displacements, and a periodic cell no contacts",
        ),
        (
            "calibrate fit a all target nu 0.3 vary bond 1 nu large yes",
            "`target nu` is for small displacements of bonds alone | leave `large` and `mu` out",
        ),
    ] {
        let warnings = refused(&w, line, Beams::standard(2));
        assert!(warnings.contains(wanted), "{line}: {warnings}");
    }
}
