//! K6: words and styles of LAMMPS that were refused.

use super::{numbers, run, text};

/// What the deck prints behind `RESULT`, its number words only.
fn result(deck: &str, arguments: &[&str]) -> Vec<f64> {
    let said = text(&run(deck, arguments));
    numbers(&said, "RESULT")
}

fn close(found: &[f64], wanted: &[f64], tolerance: f64) {
    assert!(found.len() >= wanted.len(), "{found:?} for {wanted:?}");
    for (a, b) in found.iter().zip(wanted) {
        assert!((a - b).abs() <= tolerance * b.abs().max(1e-3), "{found:?} for {wanted:?}");
    }
}

/// Hertz: 4/3 E* √R̄ δ^1.5 with E* = E/2 for equal bodies, R̄ = 1/4, δ = 0.01 and 0.02: each fix has the force on its own group.
#[test]
fn several_fixes_freeze_hold_a_group_each() {
    let force = |overlap: f64| -4.0 / 3.0 * 1e6 / (2.0 * (1.0 - 0.09)) * (0.25f64).sqrt() * overlap.powf(1.5);
    // Overlaps of decimal places are known to 1e-14 of 1, a billionth of themselves.
    close(&result("two_fix_freeze.in", &[]), &[force(0.01), force(0.02)], 1e-9);
}

/// A grain thrown up at 1 under g = 1 with γ = 0.2 rises to v²/(2 g (1 + γ)), against a force that is larger by γ.
#[test]
fn damping_of_cundall_brakes_a_grain_that_rises() {
    // 8333 steps of 1e-4 end 3e-5 before the top; the height is off by half of the square of that, and a step's end by v dt.
    let found = result("damping_cundall.in", &[]);
    assert!((found[0] - 1.0 / 2.4).abs() < 1e-4 && found[1].abs() < 2e-4, "{found:?}");
}

/// 2 k a ΔT with k = 10 and a = √(R̄ δ): 10·2·√(0.25·0.02)·100, into the colder and out of the warmer grain.
#[test]
fn heat_of_a_contact_is_the_thirteenth_number_of_its_pair() {
    let flow = 20.0 * (0.25f64 * 0.02).sqrt() * 100.0;
    let said = text(&run("pair_local_heat.in", &[]));
    let found = numbers(&said, "RESULT");
    assert!((found[0].abs() / flow - 1.0).abs() < 1e-7 && found[0] == found[1], "{found:?} for {flow}");
}

#[test]
fn properties_are_declared_again_behind_a_restart() {
    for (what, value) in [("mol", 3.0), ("d_foo", 3.5), ("temperature", 3.5)] {
        let said = text(&run("property_atom_after_restart.in", &["-var", "what", what]));
        let line = said.lines().rev().find(|l| l.starts_with("RESULT"));
        let found: Option<f64> = line.and_then(|l| l.split_whitespace().nth(2)?.parse().ok());
        assert_eq!(found, Some(value), "{said}");
    }
}

/// A bonded lattice that is repeated: energy per atom is that of the unrepeated one, LAMMPS' 0.5167 (22Jul2025, `bond/periodic`).
#[test]
fn bonds_through_periodic_faces_join_the_nearest_copies() {
    let energy = |repeat: &str| {
        let said = text(&run("replicate_bonds_through_faces.in", &["-var", "rep", repeat]));
        let line = said.lines().rev().find(|l| l.starts_with("@ ")).unwrap_or_else(|| panic!("{said}"));
        let words: Vec<&str> = line.split_whitespace().collect();
        let behind = |name: &str| {
            let at = words.iter().position(|w| *w == name).unwrap();
            words[at + 1].parse::<f64>().unwrap()
        };
        (behind("e/atom"), behind("longest"), said.contains("span whole repetitions"))
    };
    let (alone, longest, _) = energy("1 1 1");
    let (e, l, warned) = energy("2 2 2 bond/periodic");
    // Sums of 1,000 times as many terms; printed with six digits.
    assert!((e / alone - 1.0).abs() < 2e-5 && (l / longest - 1.0).abs() < 2e-5 && !warned, "{e} {alone} {l}");
    assert!((alone - 0.5167).abs() < 5e-5, "{alone}");
    let (far, _, warned) = energy("2 2 2");
    assert!(far > 100.0 && warned, "{far}");
}
