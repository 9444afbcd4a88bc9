//! Small decks of our own with the numbers of LIGGGHTS 3.8.0: `golden/NAME.in` and `NAME.txt`.

use super::reading::{self, Frame, Golden};
use super::{perigrain, printed};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// What of a deck is compared.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Expect {
    /// All numbers, each to so much of the largest of its kind in the snapshot.
    All(f64),
    /// The step table alone: places and velocities come from random numbers.
    Counts,
    /// It is not read yet.
    Waits,
}
use Expect::{All, Counts, Waits};

/// LIGGGHTS prints 11 or 12 digits; perigrain adds in another order.
const DIGITS: Expect = All(1e-8);
/// STL files have six digits.
const STL: Expect = All(1e-5);

/// Every deck, and what is expected of it.
const DECKS: &[(&str, Expect)] = &[
    ("cdt_axis_and_approach", Waits),
    ("cdt_pair", Waits),
    ("cdt_torsion", Waits),
    ("cdt_wall_axis", Waits),
    ("cdt_wall_torsion", Waits),
    ("check_timestep_1", Waits),
    ("check_timestep_2", Waits),
    ("check_timestep_types", Waits),
    ("epsd2_approach_cap", Waits),
    ("epsd2_pair", Waits),
    ("epsd2_wall", Waits),
    ("epsd3_pair", Waits),
    ("epsd_approach_cap", Waits),
    ("epsd_pair", Waits),
    ("epsd_turn", Waits),
    ("epsd_wall", Waits),
    ("heat_area_correction_hertz", Waits),
    ("heat_area_correction_hooke", Waits),
    ("heat_pair", Waits),
    ("heat_projection", Waits),
    ("heat_wall", Waits),
    ("hooke_equal", Waits),
    ("hooke_kt_to_kn", Waits),
    ("hooke_unequal", Waits),
    ("hooke_wall", Waits),
    ("hysteresis_path", Waits),
    ("hysteresis_wall", Waits),
    ("massflow_once", Waits),
    ("mesh_belt_ball", Waits),
    ("mesh_corner", Waits),
    ("mesh_edge", Waits),
    ("mesh_linear_then_rotate", Waits),
    ("mesh_linear_variable", Waits),
    ("mesh_movers_in_sequence", Waits),
    ("mesh_moving_contact", Waits),
    ("mesh_reference_point", Waits),
    ("mesh_riggle", Waits),
    ("mesh_rotate", Waits),
    ("mesh_rotate_then_linear", Waits),
    ("mesh_rotate_variable", Waits),
    ("mesh_stress_vtk", Waits),
    ("mesh_surface_ang_vel", Waits),
    ("mesh_transform_1", Waits),
    ("mesh_transform_2", Waits),
    ("mesh_transform_3", Waits),
    ("mesh_viblin", Waits),
    ("mesh_vibrot", Waits),
    ("mesh_wear_1", Waits),
    ("mesh_wear_2", Waits),
    ("mesh_wear_3", Waits),
    ("mesh_wear_spin", Waits),
    ("multisphere_mass_inertia", Waits),
    ("pack_all_in_no", Waits),
    ("pack_fraction", Waits),
    ("pack_fraction_numberbased", Waits),
    ("pack_full", Waits),
    ("pack_mass", Waits),
    ("pack_refill", Waits),
    ("pair_approach", Waits),
    ("pair_no_tangential_damping", Waits),
    ("pair_recede", Waits),
    ("pair_recede_limit", Waits),
    ("pair_two_materials", Waits),
    ("servo_auto", Waits),
    ("servo_auto_past_target", Waits),
    ("servo_ki", Waits),
    ("servo_scale", Waits),
    ("servo_windup", Waits),
    ("sjkr2_pair", Waits),
    ("sjkr2_unequal", Waits),
    ("sjkr2_wall", Waits),
    ("sjkr_limit_force", Waits),
    ("sjkr_pair", Waits),
    ("sjkr_pair_reduce", Waits),
    ("sjkr_wall", Waits),
    ("slip_rule", Waits),
    ("spring_turn_y", Waits),
    ("stiffness_hertz", Waits),
    ("stiffness_hooke", Waits),
    ("stream_duration", Waits),
    ("stream_flipped_face", Waits),
    ("stream_mass", Waits),
    ("stream_oblique", Waits),
    ("stream_uniform", Waits),
    ("wall_both_sides", Waits),
    ("wall_default_tangential", Waits),
    ("wall_spin_arms", Waits),
    ("wall_ycylinder_c1_is_z", Waits),
    ("wall_zcylinder_outside", Waits),
    ("wall_zcylinder_shear_turns", Waits),
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/liggghts/golden")
}

#[test]
fn every_deck_is_in_the_table() {
    let names = fs::read_dir(folder()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter_map(|n| n.strip_suffix(".in").map(String::from)).collect();
    names.sort();
    assert_eq!(names, DECKS.iter().map(|d| d.0).collect::<Vec<_>>());
}

/// `PERIGRAIN_GOLDEN=all` runs those that wait as well, and a name runs one.
#[test]
fn decks_have_the_numbers_of_liggghts() {
    let wanted = std::env::var("PERIGRAIN_GOLDEN").unwrap_or_default();
    let mut wrong = String::new();
    for (name, expect) in DECKS {
        let runs = match wanted.as_str() {
            "" => *expect != Waits,
            "all" => true,
            one => one == *name,
        };
        let expect = if *expect == Waits { DIGITS } else { *expect };
        if let Some(Err(why)) = runs.then(|| compare(name, expect)) {
            writeln!(wrong, "{name}: {why}").unwrap();
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// Runs a deck and compares what it printed and wrote.
fn compare(name: &str, expect: Expect) -> Result<(), String> {
    let there = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(folder()).unwrap().map(|e| e.unwrap().path()) {
        let file = entry.file_name().unwrap();
        if entry.extension().is_some_and(|e| e != "txt" && e != "in") || file == format!("{name}.in").as_str()
        {
            fs::copy(&entry, there.path().join(file)).unwrap();
        }
    }
    let out = perigrain(there.path(), &["-in", &format!("{name}.in"), "-log", "none"]);
    let text = printed(&out);
    if !out.status.success() {
        let error = text.find("error[").map_or(text.as_str(), |k| &text[k..]);
        return Err(error.lines().take(8).collect::<Vec<_>>().join("\n    "));
    }
    let golden = reading::golden(&fs::read_to_string(folder().join(format!("{name}.txt"))).unwrap());
    let tolerance = if let All(tolerance) = expect { tolerance } else { 1e-8 };
    rows(&golden.thermo, &text, tolerance)?;
    if expect == Counts {
        return Ok(());
    }
    snapshots(name, &golden, there.path(), tolerance)?;
    surfaces(name, &golden, there.path(), tolerance)
}

/// The step table: a run's setup repeats a row in both programs.
fn rows(golden: &[Vec<f64>], text: &str, tolerance: f64) -> Result<(), String> {
    let Some(first) = golden.first() else { return Ok(()) };
    let ours = text.lines().filter_map(reading::numbers).filter(|row| row.len() == first.len());
    let ours: Vec<Vec<f64>> = ours.collect();
    if ours.len() != golden.len() {
        return Err(format!("{} rows of the step table, not {}: {ours:?}", ours.len(), golden.len()));
    }
    for k in 1..first.len() {
        let scale = golden.iter().map(|row| row[k].abs()).fold(0.0, f64::max);
        for (a, b) in ours.iter().zip(golden) {
            // The table prints eight digits where the deck sets no format.
            near(a[k], b[k], scale, tolerance.max(1e-7))
                .map_err(|e| format!("step {}, column {k}: {e}", b[0]))?;
        }
    }
    Ok(())
}

/// The snapshots of `dump.NAME`.
fn snapshots(name: &str, golden: &Golden, there: &Path, tolerance: f64) -> Result<(), String> {
    if golden.dumps.is_empty() {
        return Ok(());
    }
    let text = fs::read_to_string(there.join(format!("dump.{name}"))).map_err(|e| e.to_string())?;
    let ours = reading::dump(&text);
    for (step, golden) in &golden.dumps {
        let Some(ours) = ours.get(step) else { return Err(format!("no snapshot of step {step}")) };
        let count = golden.count.unwrap_or(golden.rows.len());
        if ours.rows.len() != count {
            return Err(format!("step {step}: {} rows, not {count}", ours.rows.len()));
        }
        frame(ours, golden, tolerance).map_err(|e| format!("step {step}, {e}"))?;
    }
    Ok(())
}

/// Numbers of a snapshot, those of a vector against the vector's size.
fn frame(ours: &Frame, golden: &Frame, tolerance: f64) -> Result<(), String> {
    let kind = |k: usize| golden.columns[k].trim_end_matches(['x', 'y', 'z']).to_string();
    let mut scales: BTreeMap<String, f64> = BTreeMap::new();
    for row in &golden.rows {
        for (k, x) in row.iter().enumerate() {
            let scale = scales.entry(kind(k)).or_default();
            *scale = scale.max(x.abs());
        }
    }
    for (a, b) in ours.rows.iter().zip(&golden.rows) {
        for k in 0..b.len() {
            near(a[k], b[k], scales[&kind(k)], tolerance)
                .map_err(|e| format!("id {}, {}: {e}", b[0], golden.columns[k]))?;
        }
    }
    Ok(())
}

/// Corners and fields of surfaces.
fn surfaces(name: &str, golden: &Golden, there: &Path, tolerance: f64) -> Result<(), String> {
    for (step, golden) in &golden.surfaces {
        let file = there.join(format!("{name}_{step}.stl"));
        let ours = reading::stl(&fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?);
        all(&ours, golden, tolerance.max(1e-5)).map_err(|e| format!("STL of step {step}: {e}"))?;
    }
    for (step, golden) in &golden.fields {
        let file = there.join(format!("{name}_{step}.vtk"));
        let ours = reading::vtk(&fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?);
        for (field, golden) in golden {
            let Some(ours) = ours.get(field) else { return Err(format!("no field {field}: {ours:?}")) };
            all(ours, golden, tolerance).map_err(|e| format!("{field} of step {step}: {e}"))?;
        }
    }
    Ok(())
}

fn all(ours: &[f64], golden: &[f64], tolerance: f64) -> Result<(), String> {
    if ours.len() != golden.len() {
        return Err(format!("{} numbers, not {}", ours.len(), golden.len()));
    }
    let scale = golden.iter().map(|x| x.abs()).fold(0.0, f64::max);
    ours.iter().zip(golden).try_for_each(|(a, b)| near(*a, *b, scale, tolerance))
}

/// Zeros of LIGGGHTS are sums that cancel: 1e-14 is far below all forces and torques of the decks.
fn near(ours: f64, golden: f64, scale: f64, tolerance: f64) -> Result<(), String> {
    if (ours - golden).abs() <= tolerance * scale.max(golden.abs()) + 1e-14 {
        return Ok(());
    }
    Err(format!("{ours:.12e} instead of {golden:.12e}"))
}
