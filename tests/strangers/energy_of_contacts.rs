//! K4, contacts: springs, dashpots and friction never make energy.

use super::{decks, numbers, run, text};
use std::process::Command;

/// What a deck prints behind a name; it must end well.
fn output_of(deck: &str, name: &str, variables: &[(&str, &str)]) -> Vec<f64> {
    output_with(deck, name, variables, &[])
}

/// The same with more switches.
fn output_with(deck: &str, name: &str, variables: &[(&str, &str)], switches: &[&str]) -> Vec<f64> {
    let mut arguments = switches.to_vec();
    variables.iter().for_each(|(name, value)| arguments.extend(["-var", name, value]));
    let output = run(deck, &arguments);
    let text = text(&output);
    assert!(output.status.success(), "{text}");
    numbers(&text, name)
}

#[test]
fn staggered_steps_make_no_energy_by_friction() {
    let of = |scheme, m, dt| {
        output_of("staggered_friction.in", "ENERGY", &[("scheme", scheme), ("m", m), ("dt", dt)])
    };
    // Plain steps: 0.98728, 0.98763, 0.98766 with 1e-4, 2e-5, 5e-6 s.
    const RIGHT: f64 = 0.98766;
    let kick = of("kick", "4", "1e-4");
    // Springs that grew by the step times the velocity at its end: 1.0154, and friction that gave 0.015.
    assert!((kick[0] - RIGHT).abs() < 1e-3, "{kick:?}");
    assert!(kick[1] > 0.0, "friction gives nothing: {kick:?}");
    // First order at least: 6.9e-4, 3.6e-4, 1.1e-4.
    let off = ["2e-4", "1e-4", "5e-5"].map(|dt| (of("kick", "4", dt)[0] - RIGHT).abs());
    assert!(off[1] < 0.6 * off[0] && off[2] < 0.6 * off[1], "{off:?}");
}

#[test]
fn a_block_at_rest_on_a_rough_floor_is_given_nothing_by_friction() {
    let [friction, kinetic] = output_of("staggered_resting_block.in", "REST", &[])[..] else { panic!() };
    let plain = output_of("staggered_resting_block.in", "REST", &[("scheme", "verlet")]);
    // Nothing slides: plain steps leave -4e-9 J in the channel, rounding of what the springs hold. Staggered ones left -1.7e-5 J and
    // gave a block that falls asleep a fifth more energy of motion.
    assert!(friction.abs() < 1e-7, "{friction} {plain:?}");
    assert!(kinetic < 1.05 * plain[1], "{kinetic} {plain:?}");
}

#[test]
fn staggered_beds_with_friction_press_as_plain_ones() {
    let short = ("u", "0.0005");
    let plain = output_of("staggered_bed.in", "FORCE", &[short])[0];
    let kick =
        output_of("staggered_bed.in", "FORCE", &[short, ("scheme", "kick"), ("m", "5"), ("dt", "2e-4")])[0];
    // 12.182 and 12.196 N; it was 12.475 N with velocities at the ends of steps. The whole bed: 482.98 and 483.06 N, it was 492.79 N.
    assert!((kick / plain - 1.0).abs() < 2e-3, "{kick} {plain}");
}

#[test]
fn respa_friction_is_right_and_lammps_has_its_own() {
    let of =
        |scheme, switches| output_with("respa_friction.in", "BOUNCE", &[("scheme", scheme)], switches)[0];
    // LAMMPS 22Jul2025 prints -0.18750 for plain steps.
    let plain = of("verlet", &[]);
    assert!((plain + 0.18750).abs() < 1e-4, "{plain}");
    let respa = of("respa", &[]);
    assert!((respa - plain).abs() < 2e-4, "{respa} {plain}");
    // And -0.18524 for steps of two lengths.
    let lammps = of("respa", &["-compat", "lammps/2025"]);
    assert!((lammps + 0.18524).abs() < 1e-5, "{lammps}");
}

#[test]
fn the_ledger_of_a_pair_closes_in_second_order() {
    for tangential in ["mindlin NULL 1.0 0.5", "mindlin_rescale NULL 1.0 0.5"] {
        for what in ["pair", "wall"] {
            let residual = |dt| {
                let variables = [("what", what), ("dt", dt), ("tan", tangential)];
                output_of("ledger_mindlin_pair.in", "RESIDUAL", &variables)[0].abs()
            };
            let [coarse, middle, fine] = ["1e-5", "5e-6", "2.5e-6"].map(residual);
            // Trapezoidal sums over the forces that acted: of second order, a quarter for each half (3.7 to 4.1 measured). For pairs it
            // was 2.6e-3, 5.3e-4, 8.1e-4 and stayed at 5.7e-4.
            assert!(fine < 1e-6, "{tangential} {what}: {coarse} {middle} {fine}");
            assert!(
                middle < coarse / 3.0 && fine < middle / 3.0,
                "{tangential} {what}: {coarse} {middle} {fine}"
            );
        }
    }
}

#[test]
fn the_ledger_of_a_heap_closes_with_the_step() {
    let residual = |dt| output_of("ledger_heap.in", "RESIDUAL", &[("dt", dt)])[0].abs();
    let [coarse, fine] = ["1e-4", "5e-5"].map(residual);
    // A share of the work of gravity: -2.3e-2 and -1.5e-2 it was; -1.15e-3 and -2.9e-4. First order requires a half.
    assert!(coarse < 2e-3 && fine < 0.5 * coarse, "{coarse} {fine}");
}

#[test]
fn sliding_impacts_end_where_what_presses_rubs() {
    let of = |name, e, limit| {
        output_of("sliding_impact.in", "SLID", &[("name", name), ("e", e), ("limit", limit)])
    };
    let impacts =
        [("spin_wall", 0.4, 0.2, "0.5"), ("spin_heavy", 0.4, 0.2, "0.5"), ("oblique", 0.25, 1.0, "0.7")];
    for (name, mu, speed, e) in impacts {
        // Nothing pulls: the impulse across is mu times that along the normal. The oblique pair turns while it touches: LAMMPS' own
        // tolerance.
        let limited = of(name, e, "limit_damping");
        let closed = mu * (speed + limited[1]);
        let tolerance = if name == "oblique" { 1e-2 } else { 1e-4 };
        assert!((limited[0] / closed - 1.0).abs() < tolerance, "{name}: {limited:?} {closed}");
        // A dashpot that pulls takes back normal impulse, and no friction: the impulse across is that of the impact without the pull.
        // It was 0.12805 and 0.42959 with friction in the pull, 6.7 % and 1.1 % above mu (1 + e) v.
        let usual = of(name, e, "");
        assert!((usual[0] / limited[0] - 1.0).abs() < 1e-3, "{name}: {usual:?} {limited:?}");
        let rebound = e.parse::<f64>().unwrap() * speed;
        assert!((usual[1] / rebound - 1.0).abs() < 1e-2, "{name}: {usual:?}");
    }
    // The closed form of dem15-hertz-oblique, mu (1 + e) v within LAMMPS' 1 %.
    let oblique = of("oblique", "0.7", "")[0];
    assert!((oblique / (0.25 * 1.7) - 1.0).abs() < 0.01, "{oblique}");
}

#[test]
fn energy_from_nothing_ends_a_run_of_grains() {
    let output = run("granular_explodes.in", &["-var", "dt", "0.05", "-var", "N", "2000"]);
    let text = text(&output);
    // 720 times the energy at first in the long run of a step three times the longest.
    assert!(!output.status.success() && text.contains("PG0206"), "{text}");
    assert!(text.contains("times all there was when the run began"), "{text}");
    assert!(!text.contains("stiffer grains"), "{text}");
    // Within the limit the run continues.
    let output = run("granular_explodes.in", &["-var", "dt", "0.005", "-var", "N", "2000"]);
    assert!(output.status.success());
}

#[test]
fn the_step_is_judged_by_grains_that_come_later() {
    let check = |dt: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_perigrain"))
            .arg("check")
            .arg(decks().join("pour_step.in"))
            .args(["-var", "dt", dt])
            .output()
            .unwrap();
        text(&output)
    };
    // A contact of the grains of 3 mm that sink in by a hundredth of their radius lasts 7e-4 s.
    let long = check("2e-4");
    assert!(long.contains("PG0121") && long.contains("longer than a tenth of a contact"), "{long}");
    assert!(!long.contains("stiffer grains"), "{long}");
    assert!(!check("2e-5").contains("PG0121"));
}

#[test]
fn arms_of_the_older_styles_can_keep_angular_momentum() {
    for style in ["hooke", "hertz"] {
        let of = |arms| output_of("gran_angular_momentum.in", "MOMENTUM", &[("sty", style), ("arms", arms)]);
        let off = |all: &[f64]| (0..3).map(|k| (all[3 + k] - all[k]).abs()).fold(0.0, f64::max);
        // Rounding of 20,000 steps: parts of 51 to 1e-9.
        assert!(off(&of("middle")) < 1e-9 * 51.0, "{style}: {:?}", of("middle"));
        // LAMMPS' arms: -51.4467 becomes -48.4313 (hooke, overlaps of a tenth of the radius).
        assert!(off(&of("radius")) > 1.0, "{style}: {:?}", of("radius"));
    }
}

#[test]
fn points_of_solids_can_take_friction_where_they_are() {
    let of = |arms| output_of("hybrid_angular_momentum.in", "MOMENTUM", &[("arms", arms)]);
    let [before, after, spin] = of("point")[..] else { panic!() };
    // Rounding of 300 steps.
    assert!((after - before).abs() < 1e-12 * spin.abs().max(before.abs()), "{before} {after} {spin}");
    // Arms that end in the middle of the overlap lose the part of a point that does not turn: a quarter of the grain's spin.
    let [before, after, spin] = of("middle")[..] else { panic!() };
    let lost = ((after - before) / spin).abs();
    assert!(lost > 0.2 && lost < 0.35, "{lost}");
}
