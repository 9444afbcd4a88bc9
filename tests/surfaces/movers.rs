//! Places of surfaces: what is done to the file, and movers, beside the files of LIGGGHTS.

use super::{golden, head, ran};
use std::f64::consts::PI;
use std::fs;

/// Corners of one triangle.
type Corners = Vec<f64>;

/// The corners in a golden line `STEP.stl x y z | …`.
fn theirs(name: &str, step: i64) -> Corners {
    let text = golden(name);
    let line = text.lines().find_map(|line| line.strip_prefix(&format!("{step}.stl "))).unwrap();
    line.split_whitespace().filter(|w| *w != "|").map(|w| w.parse().unwrap()).collect()
}

/// The corners of the surface at these steps.
fn places(surface: &str, movers: &str, dt: f64, runs: &str, steps: &[i64]) -> Vec<Corners> {
    let deck = format!(
        "{}variable vx equal 1.+step*dt*100\nvariable vy equal 0\nvariable om equal 10.+1000*step*dt\n\
         fix cad all surface {surface}\n{movers}\n\
         dump s all mesh/stl 1 s_*.stl cad\nthermo_modify lost ignore\n{runs}\n",
        head(5.0, dt, 0.7)
    );
    let (_, place) = ran(&deck);
    let read = |step: &i64| {
        let text = fs::read_to_string(place.path().join(format!("s_{step}.stl"))).unwrap();
        let corners = text.lines().filter_map(|line| line.trim().strip_prefix("vertex "));
        corners.flat_map(|line| line.split(' ').map(|w| w.parse().unwrap()).collect::<Vec<f64>>()).collect()
    };
    steps.iter().map(read).collect()
}

/// Whether all corners agree within a distance.
fn agree(name: &str, own: &Corners, theirs: &Corners, within: f64) {
    assert_eq!(own.len(), theirs.len(), "{name}");
    let worst = own.iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst <= within, "{name}: {worst:e}\n{own:?}\n{theirs:?}");
}

#[test]
fn the_file_is_changed_in_the_order_of_the_words() {
    for (name, line) in [
        ("mesh_transform_1", "shift -50 -250 0 scale 0.002 turn 0 1 0 90 turn 0 0 1 90"),
        ("mesh_transform_2", "scale 0.002 shift -0.1 -0.5 0. turn 0 0 1 90"),
        ("mesh_transform_3", "turn 0 0 1 90 scale 0.002 shift 0.1 0.5 0"),
    ] {
        let own = places(&format!("far.stl type 1 {line}"), "", 1e-5, "run 0", &[0]);
        // The files have six digits of numbers below 1.
        agree(name, &own[0], &theirs(name, 0), 1e-6);
    }
}

// LIGGGHTS adds up time step times speed at the step's end, which is off by dt/2 |v - v₀|; its files have six digits.
#[test]
fn movers_are_where_the_real_ones_are() {
    let about = "origin 0. 0. 0. axis 0. 0. 1.";
    let omega = 2.0 * PI / 0.07;
    let steps = [1, 999, 1000];
    let speed_of_modes = |t: f64| -> f64 {
        [[0.4, 1.3, 2.0 * PI / 0.02], [0.1, 2.0, omega]]
            .iter()
            .map(|[c, p, w]: &[f64; 3]| -c * w * (w * t + p).sin())
            .sum()
    };
    for (name, motion, speed) in [
        ("mesh_rotate", format!("rotate {about} period 0.07"), None),
        (
            "mesh_linear_variable",
            "linear/variable v_vx v_vy v_vy".into(),
            Some(Box::new(|t: f64| 1.0 + 100.0 * t) as Box<dyn Fn(f64) -> f64>),
        ),
        (
            "mesh_rotate_variable",
            format!("rotate/variable {about} omega v_om"),
            Some(Box::new(|t: f64| 0.1 * (10.0 + 1000.0 * t))),
        ),
        (
            "mesh_riggle",
            format!("riggle {about} period 0.07 amplitude 10."),
            Some(Box::new(move |t: f64| 0.1 * 10f64.to_radians() * omega * (omega * t).cos())),
        ),
        (
            "mesh_viblin",
            "viblin axis 1. 0. 0. order 2 amplitude 0.4 0.1 phase 1.3 2. period 0.02 0.07".into(),
            Some(Box::new(speed_of_modes)),
        ),
        (
            "mesh_vibrot",
            format!("vibrot {about} order 1 amplitude 0.1 phase 1.3 period 0.07"),
            Some(Box::new(move |t: f64| -0.1 * 0.1 * omega * (omega * t + 1.3).sin())),
        ),
    ] {
        let own = places(
            "tri.stl type 1",
            &format!("fix mv all move/mesh mesh cad {motion}"),
            1e-5,
            "run 1000",
            &steps,
        );
        for (own, step) in own.iter().zip(steps) {
            let lag = speed.as_ref().map_or(0.0, |v| 0.5e-5 * (v(1e-5 * step as f64) - v(0.0)).abs());
            agree(name, own, &theirs(name, step), lag + 1.5e-6);
        }
    }
}

#[test]
fn movers_are_exact_functions_of_time() {
    // 0.1 of a period and 0.3 of it, by hand; a step of a hundredth.
    let own = places(
        "tri.stl type 1",
        "fix mv all move/mesh mesh cad wiggle amplitude 0 0 0.2 period 1",
        0.01,
        "run 30",
        &[10, 30],
    );
    for (corners, t) in own.iter().zip([0.1f64, 0.3]) {
        assert!((corners[2] - 0.2 * (2.0 * PI * t).sin()).abs() < 1e-14, "{corners:?}");
    }
    let own = places(
        "tri.stl type 1",
        "fix mv all move/mesh mesh cad viblin axis 1 0 0 order 2 amplitude 0.4 0.1 phase 1.3 2. period 0.02 0.07",
        1e-3,
        "run 10",
        &[10],
    );
    // The sum -0.2040375978 less that at the start, 0.4 cos 1.3 + 0.1 cos 2 = 0.0653848 (acceptance 13).
    let start = 0.4 * 1.3f64.cos() + 0.1 * 2f64.cos();
    assert!((own[0][0] + 0.2040375978 + start).abs() < 1e-9, "{:?}", own[0]);
}

#[test]
fn movers_add_up() {
    let turn = "rotate origin 0. 0. 0. axis 0. 0. 1. period 1.";
    let (a, b) =
        ("fix a all move/mesh mesh cad linear 1. 0. 0.", format!("fix b all move/mesh mesh cad {turn}"));
    let own = places("tri.stl type 1", &format!("{a}\n{b}"), 1e-3, "run 250", &[249, 250]);
    for (own, step) in own.iter().zip([249, 250]) {
        agree("mesh_linear_then_rotate", own, &theirs("mesh_linear_then_rotate", step), 1.5e-6);
    }
    // LIGGGHTS turns, then shifts in each step, which is off by half a step's way: ∫ R(t − s) v ds is 1/(2π) in x and y.
    let own = places("tri.stl type 1", &format!("{b}\n{a}"), 1e-3, "run 250", &[250]);
    let theirs_first = theirs("mesh_rotate_then_linear", 250);
    agree("mesh_rotate_then_linear", &own[0], &theirs_first, 0.5e-3 + 2e-6);
    assert!((own[0][0] - 0.5 / PI).abs() < 1e-6 && (own[0][1] - 0.5 / PI).abs() < 1e-6, "{:?}", own[0]);
    // One after the other.
    let runs = format!("run 100\nunfix a\nfix a all move/mesh mesh cad {turn}\nrun 250");
    let own = places("tri.stl type 1", a, 1e-3, &runs, &[349, 350]);
    for (own, step) in own.iter().zip([349, 350]) {
        agree("mesh_movers_in_sequence", own, &theirs("mesh_movers_in_sequence", step), 1.5e-6);
    }
}

// Two turns about fixed axes add their angular velocities (LIGGGHTS 3.8.0, measured: 250 steps of 1e-3, periods 1, axes z and x, the second
// through x = 0.05); the splitting there is of first order, 2 steps' way.
#[test]
fn turns_about_two_axes_add_their_angular_velocities() {
    let movers = "fix b all move/mesh mesh cad rotate origin 0. 0. 0. axis 0. 0. 1. period 1.\n\
                  fix a all move/mesh mesh cad rotate origin 0.05 0. 0. axis 1. 0. 0. period 1.";
    let own = places("tri.stl type 1", movers, 1e-3, "run 250", &[250]);
    let theirs = vec![
        -0.00985734,
        0.0219941,
        -0.0402306,
        0.00985734,
        0.0780059,
        0.0402306,
        -0.0663735,
        -0.0385749,
        0.0157811,
    ];
    agree("two turns", &own[0], &theirs, 2.0 * PI * 1e-3 * 0.12);
    let finer = places("tri.stl type 1", movers, 1e-4, "run 2500", &[2500]);
    agree("two turns in finer steps", &own[0], &finer[0], 1e-6);
}
