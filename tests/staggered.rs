//! Steps of two lengths: with one short step the bits of plain ones, momentum kept, close to plain short steps, refusals.

use std::process::Command;

/// A bead that hits a small block of bonds obliquely; `STYLE`, `DT`, `EVERY` and `STEPS` are filled in.
const DECK: &str = "\
units si
atom_style hybrid sphere peri
boundary s s s
lattice sc 5.0e-4
region plate block -0.00126 0.00126 -0.00126 0.00126 -0.00151 0.00001 units box
region world block -0.006 0.006 -0.006 0.006 -0.004 0.006 units box
create_box 2 world
create_atoms 1 region plate
create_atoms 2 single 0.0001 0.00007 0.00127 units box
material glass E 65e9 nu 0.25 rho 2230 Gc 204
set type 1 diameter 5.0e-4
set type 1 density 2230
set type 1 volume 1.25e-10
set type 2 diameter 0.002
set type 2 density 7800
set type 2 volume 1.25e-10
group pd type 1
group grain type 2
pair_style hybrid/overlay peri/pmb granular
pair_coeff 1 1 peri/pmb material glass horizon 3.015
pair_coeff * 2 granular hertz/material 5e8 0.9 0.28 damping coeff_restitution tangential mindlin NULL 0.5 0.3
neighbor 2.0e-4 bin
velocity grain set 1.0 0.0 -10.0 units box
fix 1 pd nve
fix 2 grain nve/sphere
timestep DT
STYLE
compute mom all momentum
variable vx equal vcm(grain,x)
variable vz equal vcm(grain,z)
thermo_style custom time pe ke c_mom[1] c_mom[2] c_mom[3] v_vx v_vz
thermo EVERY
thermo_modify format float %23.17g
run STEPS
";

/// Standard output and whether it went well.
fn run(deck: &str) -> (String, bool) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("in.deck"), deck).unwrap();
    let out = Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .args(["-in", "in.deck", "-log", "none"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&out.stdout).into_owned() + &String::from_utf8_lossy(&out.stderr);
    (text, out.status.success())
}

fn deck(style: &str, dt: f64, steps: u32) -> String {
    DECK.replace("STYLE", style)
        .replace("DT", &dt.to_string())
        .replace("EVERY", &(steps / 10).to_string())
        .replace("STEPS", &steps.to_string())
}

/// The rows of the thermo table.
fn rows(style: &str, dt: f64, steps: u32) -> Vec<Vec<f64>> {
    let (text, well) = run(&deck(style, dt, steps));
    assert!(well, "{text}");
    let lines = text.lines().skip_while(|l| !l.trim_start().starts_with("Time")).skip(1);
    let rows: Vec<Vec<f64>> = lines
        .filter_map(|l| l.split_whitespace().map(|a| a.parse().ok()).collect::<Option<Vec<f64>>>())
        .filter(|row| row.len() == 8)
        .collect();
    assert_eq!(rows.len(), 11, "{text}");
    rows
}

#[test]
fn one_short_step_in_a_long_one_is_a_plain_step() {
    let plain = rows("run_style verlet", 4e-8, 300);
    assert_eq!(plain, rows("run_style staggered m 1", 4e-8, 300));
    assert_eq!(plain, rows("run_style staggered m 1 faster grains", 4e-8, 300));
}

#[test]
fn long_steps_end_where_short_ones_do() {
    let fine = rows("run_style verlet", 2e-8, 800);
    for (style, dt, steps) in [
        ("run_style staggered m 4", 8e-8, 200),
        ("run_style staggered", 8e-8, 200),
        ("run_style staggered m 4 faster grains", 1e-8, 1600),
    ] {
        let two = rows(style, dt, steps);
        for (a, b) in fine.iter().zip(&two) {
            // The impulse scheme keeps momentum to rounding: 1e-12 of the bead's 3.3e-4 kg m/s.
            for k in 3..6 {
                assert!((b[k] - fine[0][k]).abs() < 1e-12 * 3.3e-4, "{style}: momentum {:?}", &b[3..6]);
            }
            // The contact lasts about 60 long steps: its error of second order in the step is below 1 % of 10 m/s.
            assert!((a[7] - b[7]).abs() < 0.1 && (a[6] - b[6]).abs() < 0.1, "{style}: {a:?} {b:?}");
        }
    }
}

#[test]
fn hybrid_particles_that_drift_twice_are_warned_about() {
    let text = run(&deck("run_style staggered m 2 scheme hartmann pd", 4e-8, 10)).0;
    assert!(text.contains("half their inertia"), "{text}");
}

#[test]
fn scenes_and_fixes_without_two_kinds_of_step_are_refused() {
    let all = deck("run_style staggered m 2", 4e-8, 10);
    let alone = all
        .replace("create_atoms 2 single 0.0001 0.00007 0.00127 units box\n", "")
        .replace("set type 2", "#");
    let gripped = all.replace("fix 2", "region foot block INF INF INF INF INF -0.0011 units box\ngroup foot region foot\nfix 3 foot move linear 0 0 0 units box\nfix 2");
    for (deck, message) in [
        (alone, "every particle is peridynamic"),
        (gripped, "fix move cannot act on peridynamic particles in steps of two lengths"),
    ] {
        let (text, well) = run(&deck);
        assert!(!well && text.contains(message), "{text}");
    }
}
