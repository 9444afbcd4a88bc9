//! Servos: the plates of LIGGGHTS step by step, a plate on a packing as plane, region and mesh, ledger, restart, options.

use super::{Rows, close, folder, golden, grain, head, ran, table};
use crate::decks::run_in;
use std::fs;

/// A plate that a servo moves above a grain at rest.
fn plate(servo: &str, place: &str, every: i64, run: &str) -> String {
    format!(
        "{}{}fix cad all surface plate.stl type 1 servo {servo}\nfix w all wall/mesh coeff 1 of cad\n\
         thermo_style custom step f_cad[3] f_cad[9]\nthermo_modify format float %.12g\nthermo {every}\n{run}\n",
        head(0.06, 1e-5, 0.999999),
        grain(place, "0 0 0")
    )
}

#[test]
fn plates_move_as_the_real_ones() {
    let common = "com 0. 0. 0. ctrlPV force axis 0. 0. 1.";
    for (name, servo, place, every, steps) in [
        ("servo_auto", "target_val -1. vel_max 1.0 mode auto ratio 1e-3", "0.004 0.007 -0.00515", 1, 120),
        (
            "servo_auto_past_target",
            "target_val -1. vel_max 1. mode auto ratio 1e-3",
            "0.004 0.007 -0.00468",
            20,
            300,
        ),
        ("servo_ki", "target_val -2. vel_max 0.5 kp 0 ki 100.", "0.004 0.007 -0.006", 1, 5),
        ("servo_scale", "target_val -2. vel_max 0.5 kp 0.6", "0.004 0.007 -0.006", 1, 4),
        // The integral rests while the speed is at its limit: one step more or less after 5000 steps.
        ("servo_windup", "target_val -2. vel_max 0.01 kp 0 ki 1000.", "0.004 0.007 -0.00505", 50, 5500),
    ] {
        let (text, _) = ran(&plate(&format!("{common} {servo}"), place, every, &format!("run {steps}")));
        let (own, theirs) = (table(&text, 2), table(&golden(name), 2));
        let part = if name == "servo_windup" { 1e-8 } else { 2e-11 };
        for (step, row) in theirs.iter().filter(|(step, _)| **step > 0) {
            close(name, *step, &own[step], row, part);
        }
    }
}

// Acceptance 14: a plate presses with 1 N on a grain at rest: F = 4/3 E* √R δ^1.5 gives δ = 2.2537788e-4; the error decays with
// kp vel_max S/|F| = 0.01 · 1 · dF/dδ = 66.55 1/s, S = 1.5 F/δ.
#[test]
fn a_plate_comes_to_rest_at_the_wanted_force() {
    let deck = plate("axis 0 0 1 target_val -1 vel_max 1", "0.004 0.007 -0.00522", 1000, "run 20000");
    let own = table(&ran(&deck).0, 2);
    let last = &own[&20000];
    assert!((last[0] - 1.0).abs() < 1e-4, "{last:?}");
    // The top of the grain lies at -0.00022.
    let depth = -0.00022 - last[1];
    assert!((depth / 2.2537788e-4 - 1.0).abs() < 1e-4, "{depth:e}");
    let rate = ((1.0 - own[&15000][0]) / (1.0 - own[&16000][0])).ln() / 0.01;
    assert!((rate / 66.55 - 1.0).abs() < 0.02, "{rate}");
}

/// 125 grains between walls, and a top that presses on them with 300 N.
fn packing(top: &str, force: &str, run: &str) -> String {
    format!(
        "units si\natom_style sphere\nboundary f f f\nregion box block -0.026 0.026 -0.026 0.026 -0.001 0.1 units box\n\
         create_box 1 box\nlattice sc 0.0102\nregion fill block -0.021 0.021 -0.021 0.021 0.004 0.055 units box\n\
         create_atoms 1 region fill\nset group all diameter 0.01 density 2500\nvariable d atom 0.0096+0.0004*random(0,1,4711)\n\
         set group all diameter v_d\nneighbor 0.002 bin\ntimestep 1e-5\npair_style granular\n\
         pair_coeff 1 1 hertz/material 1e8 0.5 0.3 damping coeff_restitution tangential mindlin NULL 0.8 0.5\n\
         fix g all gravity 9.81 vector 0 0 -1\nfix in all nve/sphere\nfix sx all wall/gran coeff 1 xplane -0.0255 0.0255\n\
         fix sy all wall/gran coeff 1 yplane -0.0255 0.0255\nfix fl all wall/gran coeff 1 zplane 0 NULL\n{top}\n\
         compute en all energy/ledger\nvariable f equal {force}\nthermo_style custom step v_f c_en c_en[4] c_en[8]\n\
         thermo_modify format float %.12g\nthermo 4000\n{run}\n"
    )
}

const SERVO: &str = "servo axis 0 0 1 target_val -300 vel_max 0.1 kp 0.5 ki 20";

fn tops() -> [(String, &'static str); 3] {
    [
        (format!("fix top all wall/gran coeff 1 zplane NULL 0.056 {SERVO}"), "f_top[3]"),
        (
            format!(
                "region slab plane 0 0 0.056 0 0 -1 units box\nfix top all wall/gran/region coeff 1 region slab {SERVO}"
            ),
            "f_top[3]",
        ),
        (
            format!(
                "fix pl all surface plate.stl type 1 shift 0 0 0.056 {SERVO}\nfix top all wall/mesh coeff 1 of pl"
            ),
            "f_pl[3]",
        ),
    ]
}

#[test]
fn a_plate_on_a_packing_holds_its_force_as_plane_region_and_mesh() {
    let mut first: Option<Rows> = None;
    for (top, force) in tops() {
        let rows = table(&ran(&packing(&top, force, "run 40000")).0, 4);
        for step in [32000, 36000, 40000] {
            assert!((rows[&step][0] - 300.0).abs() < 0.005 * 300.0, "{top}: {:?}", rows[&step]);
        }
        // The plate has done work; what is missing is of first order in the step where the speed of the wall changes.
        let [_, missing, held, work] = rows[&40000][..] else { panic!() };
        assert!(work > held && held > 0.1 && missing.abs() < 0.002 * work, "{top}: {:?}", rows[&40000]);
        match &first {
            None => first = Some(rows),
            // The same plate in three forms: rounding of places grows a little while grains bounce.
            Some(first) => close(&top, 40000, &rows[&40000], &first[&40000], 1e-5),
        }
    }
}

#[test]
fn restarts_and_cuts_of_runs_continue_servos_to_the_bit() {
    for (top, force) in tops() {
        let whole = table(&ran(&packing(&top, force, "run 12000")).0, 4);
        let cut = table(&ran(&packing(&top, force, "run 8000\nrun 4000")).0, 4);
        assert_eq!(whole[&12000], cut[&12000], "{top}");
        let (_, place) = ran(&packing(&top, force, "run 8000\nwrite_restart half.restart"));
        let deck = packing(&top, force, "run 4000");
        let (head, tail) = (deck.find("region box").unwrap(), deck.find("neighbor").unwrap());
        let deck = format!("{}read_restart half.restart\n{}", &deck[..head], &deck[tail..]);
        let deck = deck.replace("region slab plane 0 0 0.056 0 0 -1 units box\n", "");
        let (text, well) = run_in(place.path(), &deck, &[]);
        assert!(well, "{text}");
        assert_eq!(table(&text, 4)[&12000], whole[&12000], "{top}\n{text}");
    }
}

#[test]
fn several_ranks_steer_alike() {
    for (top, force) in tops() {
        let deck = packing(&top, force, "run 12000");
        let (alone, place) = ran(&deck);
        let (several, well) = run_in(place.path(), &deck, &["-ranks", "3", "-threads", "1"]);
        assert!(well, "{several}");
        assert_eq!(table(&several, 4), table(&alone, 4), "{top}");
    }
}

#[test]
fn options_hold_and_change_a_servo() {
    let run = "run 100\nfix_modify cad servo/integrate stop\nrun 100\nfix_modify cad servo/integrate start target_val 2 vel_max 0.1 \
               ctrlParam 1 0 0\nrun 100";
    let own = table(
        &ran(&plate("axis 0 0 1 target_val -2 vel_max 0.5 kp 0.6", "0.004 0.007 -0.03", 100, run)).0,
        2,
    );
    // 0.3 m/s down for 99 steps, at rest, 0.1 m/s up.
    for (step, place) in [(100, -2.97e-4), (200, -2.97e-4), (300, -1.97e-4)] {
        assert!((own[&step][1] - place).abs() < 1e-15, "{step}: {:?}", own[&step]);
    }
}

#[test]
fn a_torque_turns_a_surface() {
    // The axis is y through the origin: a grain below x = 0.02 presses up, with the torque −0.02 F about y.
    let deck = plate(
        "ctrlPV torque axis 0 1 0 target_val 0.01 vel_max 1 kp 0.5",
        "0.02 0 -0.0049",
        5000,
        "run 40000",
    )
    .replace("f_cad[3] f_cad[9]", "f_cad[5] f_cad[3]");
    let own = table(&ran(&deck).0, 2);
    assert!((own[&40000][0] + 0.01).abs() < 1e-4, "{:?}", own[&40000]);
}

#[test]
fn mistakes_are_named() {
    let place = tempfile::tempdir().unwrap();
    fs::copy(folder().join("plate.stl"), place.path().join("plate.stl")).unwrap();
    for (lines, words) in [
        ("fix s all surface plate.stl", "needs the type"),
        ("fix s all surface plate.stl type 1 servo axis 0 0 1 target_val 0 vel_max 1", "must not be 0"),
        ("fix s all surface plate.stl type 1 servo axis 0 0 1 vel_max 1", "target_val"),
        ("fix s all surface plate.stl type 1 servo axis 0 0 1 target_val 1 vel_max 1 mode auto", "ratio"),
        ("fix s all surface plate.stl type 1 speed 1 0 0 spin 0 0 0 0 0 1 5", "not both"),
        ("fix s all surface plate.stl type 1 wear finnie 1 2 3", "coefficients of wear"),
        ("fix w all wall/mesh coeff 1 of no", "no surface `no`"),
        (
            "fix s all surface plate.stl type 1\nfix w all wall/mesh coeff 1 of s scale 2",
            "place by its own line",
        ),
        (
            "fix s all surface plate.stl type 1 servo axis 0 0 1 target_val 1 vel_max 1\nfix m all move/mesh mesh s linear 1 0 0",
            "has a servo",
        ),
        (
            "fix s all surface plate.stl type 1\nfix m all move/mesh mesh s rotate origin 0 0 0 axis 0 0 1",
            "period",
        ),
        (
            "create_atoms 1 single 0 0 0.02\nset group all diameter 0.01 density 1000\nfix s all surface plate.stl type 1\n\
             fix m all move/mesh mesh s linear 1 0 0\nunfix s\nrun 1",
            "surface `s`",
        ),
        (
            "create_atoms 1 single 0 0 0.02\nset group all diameter 0.01 density 1000\nfix s all surface plate.stl type 1\n\
             fix w all wall/mesh coeff 1 of s\nunfix s\nrun 1",
            "no surface `s`",
        ),
        (
            "fix w all wall/gran coeff 1 zplane 0 NULL servo ctrlPV torque axis 0 0 1 target_val 1 vel_max 1",
            "does not turn",
        ),
        (
            "fix w all wall/gran coeff 1 zplane 0 NULL wiggle z 1 1 servo axis 0 0 1 target_val 1 vel_max 1",
            "no other motion",
        ),
        ("fix w all wall/gran coeff 1 material 1e7 0.3 zplane 0 NULL", ""),
        ("fix s all surface plate.stl type 1\nfix f all massflow/mesh mesh s", "outer side"),
        (
            "fix s all surface plate.stl type 1\nfix f all massflow/mesh mesh s vec_side 0 0 1 delete_atoms yes",
            "count once",
        ),
        ("dump d all mesh/stl 1 s_*.stl no", "no surface `no`"),
    ] {
        let (text, well) = run_in(place.path(), &format!("{}{lines}\n", head(0.06, 1e-5, 0.7)), &[]);
        assert!(!well && text.contains("error[") && text.contains(words), "{lines}\n{text}");
    }
    // Without `pair_style granular` there are no laws to lend.
    let deck = "units si\natom_style sphere\nregion r block 0 1 0 1 0 1 units box\nboundary f f f\ncreate_box 1 r\n\
                create_atoms 1 single 0.5 0.5 0.5 units box\nset group all diameter 0.1 density 1000\n\
                fix w all wall/gran coeff 1 zplane 0 NULL\nrun 0\n";
    let (text, well) = run_in(place.path(), deck, &[]);
    assert!(!well && text.contains("pair_style granular"), "{text}");
}
