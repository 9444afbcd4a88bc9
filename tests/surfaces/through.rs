//! Grains that pass through surfaces: how often they count, mass per time, what is deleted; surfaces on ranks and in restarts.

use super::{close, folder, golden, head, ran, table};
use crate::decks::run_in;
use std::fs;

/// Four grains of 4 mm: two fall through, one rises through, one falls beside.
fn four(count: &str, runs: &str) -> String {
    format!(
        "{}create_atoms 1 single 0 0 0.01 units box\ncreate_atoms 1 single 0.01 0 0.01 units box\n\
         create_atoms 1 single 0.02 0 -0.01 units box\ncreate_atoms 1 single 0.045 0 0.01 units box\n\
         set group all diameter 0.004 density 2500\nset atom 1 vz -1\nset atom 2 vz -1\nset atom 3 vz 1\nset atom 4 vz -1\n\
         fix fm all surface flow.stl type 1\nfix mf all massflow/mesh mesh fm vec_side 0. 0. -1. {count}\nfix i all nve/sphere\n\
         thermo_style custom step atoms f_mf[1] f_mf[2] f_mf[3] f_mf[4] f_mf[5] f_mf[6]\nthermo_modify format float %.12g\n\
         thermo 50\n{runs}\n",
        head(0.06, 1e-4, 0.7)
    )
}

const RUNS: &str =
    "run 200\nset atom 1 vz 1\nrun 200\nset atom 1 vz -1\nset atom 2 vz 1\nset atom 3 vz -1\nrun 200";

#[test]
fn grains_count_once_as_in_the_real_program() {
    let (text, _) = ran(&four("count once", RUNS));
    let (own, theirs) = (table(&text, 7), table(&golden("massflow_once"), 7));
    for (step, row) in &theirs {
        // The table of the real program has eight digits.
        close("massflow_once", *step, &own[step], row, 1e-7);
    }
}

#[test]
fn grains_count_again_or_are_deleted() {
    // Grain 1 comes back up and falls through again.
    let own = table(&ran(&four("", RUNS)).0, 7);
    assert_eq!(own[&600][2], 3.0, "{:?}", own[&600]);
    let own = table(&ran(&four("count once delete_atoms yes", "run 200")).0, 7);
    assert_eq!((own[&200][0], own[&200][2], own[&200][6]), (2.0, 2.0, 2.0), "{:?}", own[&200]);
    assert!((own[&200][5] - own[&200][1]).abs() < 1e-18);
    // Towards a point below, or away from one above.
    for side in ["point_at_outlet 0 0 -1", "point_at_outlet 0 0 1 inside_out"] {
        let deck = four("count once", "run 200").replace("vec_side 0. 0. -1.", side);
        assert_eq!(table(&ran(&deck).0, 7)[&200][2], 2.0, "{side}");
    }
}

#[test]
fn a_surface_that_moves_passes_over_grains() {
    let deck = four("", "run 200")
        .replace("flow.stl type 1", "flow.stl type 1\nfix m all move/mesh mesh fm linear 0 0 2")
        .replace("set atom 1 vz -1\nset atom 2 vz -1\nset atom 3 vz 1\nset atom 4 vz -1", "");
    // It rises through the two grains at z = 0.01, which so pass downwards.
    assert_eq!(table(&ran(&deck).0, 7)[&200][2], 2.0);
}

#[test]
fn counts_and_places_continue_after_a_restart() {
    let deck = |runs: &str| {
        four("", runs).replace(
            "flow.stl type 1",
            "flow.stl type 1\nfix m all move/mesh mesh fm wiggle amplitude 0 0 0.002 period 0.05",
        )
    };
    let whole = table(&ran(&deck("run 200")).0, 7);
    let (_, place) = ran(&deck("run 90\nwrite_restart half.restart"));
    let text = deck("run 110");
    let (head, tail) = (text.find("region reg").unwrap(), text.find("neighbor").unwrap());
    let text = format!("{}read_restart half.restart\n{}", &text[..head], &text[tail..]);
    let lines = text.lines().filter(|line| !line.starts_with("create_atoms") && !line.starts_with("set "));
    let (out, well) = run_in(place.path(), &lines.collect::<Vec<_>>().join("\n"), &[]);
    assert!(well, "{out}");
    let own = table(&out, 7);
    assert_eq!(own[&200][..3], whole[&200][..3], "{out}");
    assert_eq!(own[&200][2], 2.0);
}

#[test]
fn check_and_plan_take_surfaces() {
    let place = tempfile::tempdir().unwrap();
    fs::copy(folder().join("flow.stl"), place.path().join("flow.stl")).unwrap();
    fs::write(place.path().join("in.flow"), four("", "run 10")).unwrap();
    for command in ["check", "plan"] {
        let out = std::process::Command::new(env!("CARGO_BIN_EXE_perigrain"))
            .args([command, "in.flow"])
            .current_dir(place.path())
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&out.stdout).into_owned() + &String::from_utf8_lossy(&out.stderr);
        assert!(out.status.success(), "{command}: {text}");
        assert!(command == "check" || text.contains("massflow/mesh"), "{text}");
    }
}

#[test]
fn the_reference_point_is_there_before_a_run() {
    let deck = format!(
        "{}fix fm all surface flow.stl type 1 about 0.5 -2 3\nvariable z equal f_fm[9]\nprint \"at $(f_fm[7]) $(f_fm[8]) ${{z}} $(f_fm[1])\"\n",
        head(0.06, 1e-4, 0.7)
    );
    assert!(ran(&deck).0.contains("at 0.5 -2 3 0\n"), "{}", ran(&deck).0);
}
