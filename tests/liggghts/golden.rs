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
    /// How many grains were inserted, within so many: places and kinds come from random numbers.
    Inserted(f64),
}
use Expect::{All, Inserted};

/// LIGGGHTS prints 11 or 12 digits; perigrain adds in another order.
const DIGITS: Expect = All(1e-8);
/// STL files have six digits.
const STL: Expect = All(1e-5);
/// LIGGGHTS adds up time step times speed, of first order in the step; here movers are exact.
const FIRST_ORDER: [Expect; 3] = [All(1e-4), All(3e-3), All(6e-3)];
/// A third is 0.33333 in LIGGGHTS' law of wear.
const THIRD: Expect = All(2e-5);

/// LIGGGHTS counts random points in a grain of several spheres.
const POINTS: Expect = All(1e-3);
/// The height from which the grain falls is drawn within 1e-8 m; it meets the floor three times.
const HEIGHT: Expect = All(1e-5);

/// Every deck, and what is expected of it.
const DECKS: &[(&str, Expect)] = &[
    ("cdt_axis_and_approach", DIGITS),
    ("cdt_pair", DIGITS),
    ("cdt_torsion", DIGITS),
    ("cdt_wall_axis", DIGITS),
    ("cdt_wall_torsion", DIGITS),
    ("check_timestep_1", DIGITS),
    ("check_timestep_2", DIGITS),
    ("check_timestep_types", DIGITS),
    ("contact_opens", DIGITS),
    ("cylinder_y_shear", DIGITS),
    ("epsd2_approach_cap", DIGITS),
    ("epsd2_off_hertz_stiffness", DIGITS),
    ("epsd2_off_hooke_stiffness", DIGITS),
    ("epsd2_pair", DIGITS),
    ("epsd2_reduce", DIGITS),
    ("epsd2_wall", DIGITS),
    ("epsd3_pair", DIGITS),
    ("epsd_approach_cap", DIGITS),
    ("epsd_pair", DIGITS),
    ("epsd_reduce", DIGITS),
    ("epsd_turn", DIGITS),
    ("epsd_wall", DIGITS),
    ("frozen_pair", DIGITS),
    ("heat_area_correction_hertz", DIGITS),
    ("heat_area_correction_hooke", DIGITS),
    ("heat_pair", DIGITS),
    ("heat_projection", DIGITS),
    ("heat_wall", DIGITS),
    ("hooke_equal", DIGITS),
    ("hooke_kt_to_kn", DIGITS),
    ("hooke_unequal", DIGITS),
    ("hooke_wall", DIGITS),
    ("hysteresis_limit_force", DIGITS),
    ("hysteresis_path", DIGITS),
    ("hysteresis_wall", DIGITS),
    ("lattice_displace", DIGITS),
    ("lattice_units", DIGITS),
    ("massflow_once", DIGITS),
    ("mesh_belt_ball", DIGITS),
    ("mesh_corner", DIGITS),
    ("mesh_edge", DIGITS),
    ("mesh_linear_then_rotate", FIRST_ORDER[0]),
    ("mesh_linear_variable", FIRST_ORDER[0]),
    ("mesh_movers_in_sequence", FIRST_ORDER[0]),
    ("mesh_moving_contact", DIGITS),
    ("mesh_reference_point", DIGITS),
    ("mesh_riggle", FIRST_ORDER[0]),
    ("mesh_rotate", FIRST_ORDER[0]),
    ("mesh_rotate_then_linear", FIRST_ORDER[1]),
    ("mesh_rotate_variable", FIRST_ORDER[0]),
    ("mesh_stress_vtk", DIGITS),
    ("mesh_surface_ang_vel", DIGITS),
    ("mesh_transform_1", STL),
    ("mesh_transform_2", STL),
    ("mesh_transform_3", STL),
    ("mesh_viblin", FIRST_ORDER[2]),
    ("mesh_vibrot", FIRST_ORDER[0]),
    ("mesh_wear_1", DIGITS),
    ("mesh_wear_2", DIGITS),
    ("mesh_wear_3", THIRD),
    ("mesh_wear_spin", DIGITS),
    ("multisphere_drop", HEIGHT),
    ("multisphere_mass_inertia", POINTS),
    ("no_history_pair", DIGITS),
    ("no_history_recede", DIGITS),
    ("no_history_stiffness", DIGITS),
    ("no_history_wall", DIGITS),
    ("pack_all_in_no", Inserted(3.0)),
    ("pack_fraction", Inserted(3.0)),
    ("pack_fraction_numberbased", Inserted(3.0)),
    ("pack_full", Inserted(3.0)),
    ("pack_mass", Inserted(3.0)),
    ("pack_refill", Inserted(3.0)),
    ("pair_approach", DIGITS),
    ("pair_no_tangential_damping", DIGITS),
    ("pair_recede", DIGITS),
    ("pair_recede_limit", DIGITS),
    ("pair_two_materials", DIGITS),
    ("servo_auto", DIGITS),
    ("servo_auto_past_target", DIGITS),
    ("servo_back_calculation", DIGITS),
    ("servo_ki", DIGITS),
    ("servo_scale", DIGITS),
    ("servo_windup", DIGITS),
    ("sjkr2_pair", DIGITS),
    ("sjkr2_unequal", DIGITS),
    ("sjkr2_wall", DIGITS),
    ("sjkr_limit_force", DIGITS),
    ("sjkr_pair", DIGITS),
    ("sjkr_pair_reduce", DIGITS),
    ("sjkr_wall", DIGITS),
    ("slip_rule", DIGITS),
    ("spring_turn_y", DIGITS),
    ("stiffness_hertz", DIGITS),
    ("stiffness_hooke", DIGITS),
    ("stream_duration", Inserted(0.0)),
    ("stream_flipped_face", Inserted(0.0)),
    ("stream_mass", Inserted(0.0)),
    ("stream_oblique", Inserted(0.0)),
    ("stream_uniform", Inserted(0.0)),
    ("sums_of_contacts", DIGITS),
    ("timestep_stiffness", DIGITS),
    ("timestep_surface_vel", DIGITS),
    ("wall_both_sides", DIGITS),
    ("wall_default_tangential", DIGITS),
    ("wall_own_cylinder", DIGITS),
    ("wall_spin_arms", DIGITS),
    ("wall_ycylinder_c1_is_z", DIGITS),
    ("wall_zcylinder_outside", DIGITS),
    ("wall_zcylinder_shear_turns", DIGITS),
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

/// `PERIGRAIN_GOLDEN=NAME` runs one of them alone.
#[test]
fn decks_have_the_numbers_of_liggghts() {
    let wanted = std::env::var("PERIGRAIN_GOLDEN").unwrap_or_default();
    let mut wrong = String::new();
    for (name, expect) in DECKS {
        let runs = wanted.is_empty() || wanted == *name;
        if let Some(Err(why)) = runs.then(|| compare(name, *expect)) {
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
    if let Inserted(within) = expect {
        return inserted(&golden.thermo, &text, within);
    }
    rows(&golden.thermo, &text, tolerance)?;
    snapshots(name, &golden, there.path(), tolerance)?;
    surfaces(name, &golden, there.path(), tolerance)
}

/// A row that was written, and the golden one.
type Pair<'g> = (Vec<f64>, &'g Vec<f64>);

/// The rows of the step table beside those of LIGGGHTS, without those of setups: there LIGGGHTS has zeros for forces on surfaces.
fn pairs<'g>(golden: &'g [Vec<f64>], text: &str) -> Result<Vec<Pair<'g>>, String> {
    let Some(first) = golden.first() else { return Ok(vec![]) };
    let ours = text.lines().filter_map(reading::numbers).filter(|row| row.len() == first.len());
    let ours: Vec<Vec<f64>> = ours.collect();
    if ours.len() != golden.len() {
        return Err(format!("{} rows of the step table, not {}: {ours:?}", ours.len(), golden.len()));
    }
    // A setup repeats the step of the row above it.
    let steps = (1..golden.len()).filter(|&k| golden[k][0] != golden[k - 1][0]);
    Ok(steps.map(|k| (ours[k].clone(), &golden[k])).collect())
}

/// How many grains were inserted up to each row.
fn inserted(golden: &[Vec<f64>], text: &str, within: f64) -> Result<(), String> {
    // Step, atoms, inserted grains, their mass.
    let number = 2;
    for (a, b) in pairs(golden, text)? {
        if (a[number] - b[number]).abs() > within {
            return Err(format!("step {}: {} grains inserted, not {}", b[0], a[number], b[number]));
        }
    }
    Ok(())
}

/// The step table.
fn rows(golden: &[Vec<f64>], text: &str, tolerance: f64) -> Result<(), String> {
    let pairs = pairs(golden, text)?;
    for k in 1..golden.first().map_or(0, Vec::len) {
        let scale = golden.iter().map(|row| row[k].abs()).fold(0.0, f64::max);
        for (a, b) in &pairs {
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
    // In a setup a surface that moves has no velocity in LIGGGHTS, and no heat flows.
    let deck = fs::read_to_string(folder().join(format!("{name}.in"))).unwrap();
    let first = if ["move/mesh", "heat/gran"].iter().any(|word| deck.contains(word)) { 1 } else { 0 };
    for (step, golden) in golden.dumps.range(first..) {
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
