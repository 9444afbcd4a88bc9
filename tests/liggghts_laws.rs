//! Contact laws of LIGGGHTS in native words: decks of our own with the numbers that LIGGGHTS 3.8.0 (Debian) printed for them,
//! `tests/liggghts/golden`. Grains are held; `set` moves them between runs of one step.

use super::decks::run_in;
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write;
use std::path::Path;

/// Friction of a hertz contact, of a linear one, and none.
const MINDLIN: &str = "tangential mindlin NULL NULL 0.5 slip spring";
const LINEAR: &str = "tangential linear_history NULL NULL 0.5 slip spring";
const NONE: &str = "tangential none";

/// `model hertz` with coefficientRestitution 0.7, and `model hooke` with 0.9 and a characteristic velocity of 2.
const HERTZ: &str = "hertz/material 5.e6 0.7 0.45 damping coeff_restitution";
const HOOKE: &str = "hooke/velocity 5.e6 0.9 0.45 2. damping coeff_restitution";

/// Twelve printed digits, and rounding of sums in another order.
const DIGITS: f64 = 2e-11;

/// Native lines for a golden deck: the same grains, moves and steps with a law in native words.
fn native(name: &str, law: &str) -> String {
    let file = Path::new("tests/liggghts/golden").join(format!("{name}.in"));
    let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{name}: {e}"));
    let heat = name.starts_with("heat");
    let (mut deck, mut spins) = (String::new(), HashMap::new());
    for line in text.lines() {
        let words: Vec<&str> = line.split('#').next().unwrap_or_default().split_whitespace().collect();
        match &words[..] {
            [] | ["atom_modify" | "communicate" | "newton" | "thermo" | "thermo_style", ..] => {}
            ["atom_style", ..] => deck += "atom_style sphere\n",
            ["fix", id, "all", "wall/gran", rest @ ..] => {
                let at = rest.iter().position(|word| *word == "type").unwrap();
                let warm = if heat { "temperature 800" } else { "" };
                let [plane, place] = [rest[at + 2], rest[at + 3]];
                writeln!(deck, "fix {id} all wall/gran granular {law} {plane} {place} NULL {warm}").unwrap();
            }
            ["fix", ..] => {}
            ["pair_style", ..] => deck += "pair_style granular\n",
            ["pair_coeff", ..] => {
                let lines = law.split(" | ").map(|law| match law.starts_with("pair_coeff") {
                    true => format!("{law}\n"),
                    false => format!("pair_coeff * * {law}\n"),
                });
                deck.extend(lines);
                if heat {
                    deck += "fix heat all property/atom temperature heatflow\nfix flow all heat/flow constant 10.0\n";
                }
            }
            ["set", "atom", id, "property/atom", _, value] => {
                writeln!(deck, "set atom {id} temperature {value}").unwrap();
            }
            ["set", "atom", id, rest @ ..] => {
                let spin: &mut [&str; 3] = spins.entry(id.to_string()).or_insert(["0"; 3]);
                deck += &set(id, rest, spin);
                if heat {
                    writeln!(deck, "set atom {id} temperature 300").unwrap();
                }
            }
            ["dump", _, _, _, _, file, ..] if heat => {
                writeln!(deck, "dump dmp all custom 1 {file} id temperature heatflow").unwrap();
            }
            ["dump_modify", ..] if heat => {
                deck += "dump_modify dmp format line \"%d %.12g %.12g\" sort id\n";
            }
            ["dump_modify", ..] => writeln!(deck, "{}", line.replace("format \"", "format line \"")).unwrap(),
            _ => writeln!(deck, "{line}").unwrap(),
        }
    }
    deck
}

/// A line of `set`; `spin` holds the grain's last components.
fn set<'a>(id: &str, words: &[&'a str], spin: &mut [&'a str; 3]) -> String {
    let (mut line, mut turns) = (format!("set atom {id}"), false);
    for pair in words.chunks(2) {
        match ["omegax", "omegay", "omegaz"].iter().position(|name| *name == pair[0]) {
            Some(axis) => (spin[axis], turns) = (pair[1], true),
            None => write!(line, " {} {}", pair[0], pair[1]).unwrap(),
        }
    }
    if turns {
        write!(line, " omega {}", spin.join(" ")).unwrap();
    }
    line + "\n"
}

/// Rows of numbers by step.
type Frames = BTreeMap<u64, Vec<Vec<f64>>>;

fn numbers(line: &str) -> Option<Vec<f64>> {
    line.split_whitespace()
        .map(|word| word.parse().ok())
        .collect::<Option<Vec<f64>>>()
        .filter(|all| !all.is_empty())
}

/// The rows behind lines `step N …`.
fn golden(name: &str) -> Frames {
    let text = std::fs::read_to_string(format!("tests/liggghts/golden/{name}.txt")).unwrap();
    let (mut frames, mut now) = (Frames::new(), None);
    for line in text.lines() {
        if let Some(step) = line.strip_prefix("step ") {
            now = step.split(' ').next().and_then(|step| step.parse().ok());
        } else if let Some(step) = now {
            frames.entry(step).or_default().extend(numbers(line));
        }
    }
    frames
}

/// The rows of a dump.
fn dumped(text: &str) -> Frames {
    let snapshot = |part: &str| {
        let step = part.lines().next().and_then(|step| step.trim().parse().ok())?;
        let rows = part.rsplit("ITEM: ATOMS").next()?.lines().skip(1).filter_map(numbers).collect();
        Some((step, rows))
    };
    text.split("ITEM: TIMESTEP\n").filter_map(snapshot).collect()
}

/// Runs a golden deck in native words and compares all numbers of all its steps; columns from `columns` on are not compared.
fn agrees(name: &str, law: &str, columns: usize) {
    let deck = native(name, law);
    let folder = tempfile::tempdir().unwrap();
    let (text, well) = run_in(folder.path(), &deck, &[]);
    assert!(well, "{name}\n{deck}\n{text}");
    let found = dumped(&std::fs::read_to_string(folder.path().join(format!("dump.{name}"))).unwrap());
    let expected = golden(name);
    assert!(!expected.is_empty(), "{name}");
    for (step, rows) in expected {
        if step == 0 && name.starts_with("heat") {
            // LIGGGHTS conducts nothing in the setup of a run.
            continue;
        }
        let own = found.get(&step).unwrap_or_else(|| panic!("{name}: no step {step}"));
        assert_eq!(own.len(), rows.len(), "{name}");
        for (a, b) in own.iter().zip(&rows) {
            for (k, (x, y)) in a.iter().zip(b).enumerate().take(columns) {
                // Zeros may be sums that cancel.
                let close = (x - y).abs() <= DIGITS * x.abs().max(y.abs()) + 1e-17;
                assert!(close, "{name} step {step} grain {} column {k}: {x} {y}", a[0]);
            }
        }
    }
}

#[test]
fn springs_dashpots_and_limits_of_pairs() {
    let hertz = format!("{HERTZ} {MINDLIN}");
    let hooke = format!("{HOOKE} {LINEAR}");
    let unlike = |types: &str, material: &str, rest: &str| {
        let damping = "damping coeff_restitution";
        format!("pair_coeff {types} hertz/material {material} {damping} {MINDLIN}{rest}")
    };
    let first = unlike("1 1", "5.e6 0.5 0.45", "");
    let two =
        [first, unlike("2 2", "5.e7 0.5 0.3", ""), unlike("1 2", "5.e6 0.5 0.45", " material 5.e7 0.3")];
    for (name, law) in [
        ("pair_approach", &hertz[..]),
        ("pair_recede", &hertz),
        ("pair_recede_limit", &format!("{hertz} limit_damping")),
        ("pair_no_tangential_damping", &format!("{HERTZ} tangential mindlin NULL 0 0.5 slip spring")),
        ("pair_two_materials", &two.join(" | ")),
        ("hooke_equal", &hooke),
        ("hooke_unequal", &hooke),
        (
            "hooke_kt_to_kn",
            &format!("{HOOKE} tangential linear_history ratio 0.2857142857142857 1 0.5 slip spring"),
        ),
        (
            "stiffness_hertz",
            "hertz 2000 100 damping viscoelastic tangential mindlin 1000 0.5 0.5 slip spring",
        ),
        (
            "stiffness_hooke",
            "hooke 2000 100 damping mass_velocity tangential linear_history 1000 0.5 0.5 slip spring",
        ),
        ("slip_rule", "hooke 2000 1 damping velocity tangential linear_history 1000 2 0.5 slip spring"),
        ("spring_turn_y", "hooke 2000 0 damping velocity tangential linear_history 1000 0 0.5 slip spring"),
    ] {
        agrees(name, law, usize::MAX);
    }
}

#[test]
fn torques_against_rolling() {
    let free = format!("{HERTZ} {NONE} rolling");
    for (name, words) in [
        ("cdt_pair", "cdt 0.1"),
        ("cdt_axis_and_approach", "cdt 0.1"),
        ("cdt_torsion", "cdt 0.1 full"),
        ("cdt_wall_axis", "cdt 0.1"),
        ("cdt_wall_torsion", "cdt 0.1 full"),
        ("epsd_pair", "epsd 0.1 0.3"),
        ("epsd_turn", "epsd 0.1 0.3"),
        ("epsd_approach_cap", "epsd 0.1 0.3"),
        ("epsd_wall", "epsd 0.1 0.3"),
        ("epsd3_pair", "epsd 0.1 0.3 1.3"),
        ("epsd2_pair", "epsd2 0.1"),
        ("epsd2_approach_cap", "epsd2 0.1"),
        ("epsd2_wall", "epsd2 0.1"),
    ] {
        agrees(name, &format!("{free} {words}"), usize::MAX);
    }
}

#[test]
fn cohesion_and_yielding() {
    let sticky = |e: &str, words: &str| {
        let friction = MINDLIN.replace("0.5", "0.05");
        format!("hertz/material 5.e6 {e} 0.45 damping coeff_restitution {friction} cohesion {words}")
    };
    for (name, law) in [
        ("sjkr_pair", sticky("0.9", "sjkr 3.e5")),
        ("sjkr_pair_reduce", sticky("0.9", "sjkr 3.e5 reduce")),
        ("sjkr_limit_force", sticky("0.3", "sjkr 3.e5 limit_damping")),
        ("sjkr2_pair", sticky("0.9", "sjkr2 3.e5")),
        ("sjkr2_unequal", sticky("0.9", "sjkr2 3.e5")),
    ] {
        agrees(name, &law, usize::MAX);
    }
    let yielding =
        format!("hooke/hysteresis 5.e6 0.9 0.45 2. 2. 0.2 0.05 damping coeff_restitution {LINEAR}");
    agrees("hysteresis_path", &yielding, usize::MAX);
    agrees("hysteresis_wall", &yielding, usize::MAX);
    agrees("wall_default_tangential", &format!("{HERTZ} {NONE}"), usize::MAX);
    // Walls with a model of their own have full arms: the torque of friction is another.
    agrees("hooke_wall", &format!("{HOOKE} {LINEAR}"), 13);
}

#[test]
fn heat_through_the_area_of_contact() {
    let hertz = format!("{HERTZ} {MINDLIN} heat contact 100");
    let hooke = format!("{} {LINEAR} heat contact 100", HOOKE.replace("0.9", "0.7"));
    // (E*/E*_true)^(2/3) and E*/E*_true of moduli 5e6 and 5e8.
    let softened = 0.01_f64.powf(2.0 / 3.0);
    for (name, law) in [
        ("heat_pair", hertz.clone()),
        ("heat_projection", format!("{hertz} area projection")),
        ("heat_area_correction_hertz", format!("{hertz} scaled {softened}")),
        ("heat_area_correction_hooke", format!("{hooke} scaled 0.01")),
    ] {
        agrees(name, &law, 3);
    }
    agrees("heat_wall", &hertz, 3);
}

#[test]
fn a_rolling_ball_slows_down_by_its_rolling_friction() {
    // From 0.1 m/s with 5/7 mu_r g it stops after 7.1356 mm; as long as it turns it rolls.
    let law = format!("{HERTZ} {MINDLIN} rolling cdt 0.1");
    let deck = format!(
        "units si\natom_style sphere\nboundary f f f\nregion box block -0.02 0.05 -0.02 0.02 -0.001 0.02 units box\n\
         create_box 1 box\npair_style granular\npair_coeff * * {law}\n\
         fix floor all wall/gran granular {law} zplane 0.0 NULL\n\
         create_atoms 1 single 0 0 0.004993 units box\nset atom 1 diameter 0.01 density 2500 vx 0.1 omega 0 20 0\n\
         fix move all nve/sphere\nfix g all gravity 9.81 vector 0 0 -1\ntimestep 1e-5\nneighbor 0.002 bin\n\
         variable x equal x[1]\nrun 20000\nprint \"at ${{x}}\"\n"
    );
    let (text, well) = super::decks::run_with(&deck, &[]);
    let at = text.lines().find_map(|line| line.strip_prefix("at ")).and_then(|x| x.parse::<f64>().ok());
    // 2 %: the ball bounces a little while it rolls, and rocks by less than its overlap where it stops.
    assert!(well && at.is_some_and(|x| (x / 7.1356e-3 - 1.0).abs() < 0.02), "{at:?} {text}");
}

/// Two grains, the second of which is put at distances H of their surfaces: the force on it.
fn forces(law: &str, distances: &[f64]) -> Vec<f64> {
    let mut deck = format!(
        "units si\natom_style sphere\nboundary f f f\nregion box block -0.01 0.01 -0.01 0.01 -0.01 0.01 units box\n\
         create_box 1 box\npair_style granular\npair_coeff * * {law}\nneighbor 0.0005 bin\ntimestep 1e-6\n\
         create_atoms 1 single 0 0 0 units box\ncreate_atoms 1 single 0.002 0 0 units box\n\
         set group all diameter 0.002 density 2500\nvariable f equal fx[2]\n"
    );
    for h in distances {
        writeln!(deck, "set atom 2 x {:.15}\nrun 1\nprint \"force ${{f}}\"", 0.002 + h).unwrap();
    }
    let (text, well) = super::decks::run_with(&deck, &[]);
    assert!(well, "{text}");
    text.lines().filter_map(|line| line.strip_prefix("force ")?.parse().ok()).collect()
}

#[test]
fn bridges_form_at_touch_and_rupture_at_their_distance() {
    let (volume, tension, angle) = (1e-11_f64, 0.072, 20.0_f64);
    let theta = angle.to_radians();
    let rupture = (1.0 + 0.5 * theta) * volume.cbrt();
    let most = 2.0 * std::f64::consts::PI * 0.001 * tension * theta.cos();
    // Willett et al. 2000, the short fit, with the radius of equal spheres.
    let pull = |h: f64| {
        let s = h * (0.001 / volume).sqrt();
        -most / (1.0 + 1.05 * s + 2.5 * s * s)
    };
    let law = format!("{HERTZ} {MINDLIN} cohesion capillary {volume} {tension} {angle} force willett");
    let [near, far] = [0.99 * rupture, 1.01 * rupture];
    let found = forces(&law, &[near, -1e-10, near, far, near, -1e-10, 1e-5]);
    let expected = [0.0, -most, pull(near), 0.0, 0.0, -most, pull(1e-5)];
    for (found, expected) in found.iter().zip(expected) {
        // Places of 15 digits; at touch Hertz' contact pushes with 2e-7 of the pull.
        assert!((found - expected).abs() < 1e-6 * most, "{found} {expected}");
    }
    assert_eq!(found.len(), expected.len());
    let given = forces(&format!("{law} rupture 1e-4"), &[-1e-10, 0.99e-4, 1.01e-4]);
    assert!(given[1] < -0.1 * most && given[2] == 0.0, "{given:?}");
}

#[test]
fn energy_is_accounted_for() {
    // A head-on impact: what is held, lost and moving is what there was; the residual falls with the square of the step.
    let elastic = "hertz/material 5.e6 1 0.45 damping coeff_restitution";
    for (law, speed) in [
        (format!("{elastic} {MINDLIN} cohesion sjkr 1e5"), 0.1),
        (format!("{elastic} {MINDLIN} cohesion sjkr2 1e5"), 0.1),
        (format!("{HERTZ} {MINDLIN} cohesion capillary 1e-11 0.072 20"), 0.2),
        (format!("{HERTZ} {MINDLIN} cohesion capillary 1e-11 0.072 20 force willett"), 0.2),
        (format!("hooke/hysteresis 5.e6 1 0.45 2 2 0.2 0.05 damping coeff_restitution {LINEAR}"), 0.1),
        (format!("{HERTZ} {MINDLIN} rolling cdt 0.1"), 0.1),
    ] {
        for wall in [false, true] {
            let second = "create_atoms 1 single 0.0021 0 0 units box\n";
            let (other, v) = if wall {
                (format!("fix w all wall/gran granular {law} xplane NULL 0.0011\n"), speed)
            } else {
                (second.into(), 0.5 * speed)
            };
            let deck = format!(
                "units si\natom_style sphere\nboundary f f f\nregion box block -0.05 0.05 -0.01 0.01 -0.01 0.01 units box\n\
                 create_box 1 box\npair_style granular\npair_coeff * * {law}\nneighbor 0.0005 bin\ntimestep 1e-7\n\
                 create_atoms 1 single 0 0 0 units box\n{other}set group all diameter 0.002 density 2500\n\
                 variable v atom {v}*(1-2*(id-1))\nset group all vx v_v\nfix move all nve/sphere\n\
                 compute e all energy/ledger\nthermo_style custom step ke c_e[5] c_e[6] c_e[11]\nthermo 20000\n\
                 thermo_modify format float %20.14g\nrun 60000\n"
            );
            let (text, well) = super::decks::run_with(&deck, &[]);
            assert!(well, "{law}\n{text}");
            let rows: Vec<Vec<f64>> = text.lines().filter_map(numbers).filter(|row| row.len() == 5).collect();
            let (first, last) = (&rows[0], &rows[rows.len() - 1]);
            assert!(rows.len() == 4 && last[1] != first[1], "{law} {wall} {text}");
            // Measured: below 1e-4 of the impact's energy at some hundred steps per contact.
            assert!(last[4].abs() < 1e-3 * first[1], "{law} {wall}: {rows:?}");
        }
    }
}

#[test]
fn words_that_do_not_go_together_are_refused() {
    for (law, message) in [
        (format!("{HERTZ} tangential linear_history NULL 1 0.5"), "needs a stiffness kt"),
        (format!("{HERTZ} tangential mindlin ratio 0.5 1 0.5"), "ratio of two constant stiffnesses"),
        (format!("{HERTZ} tangential mindlin/force NULL 1 0.5 slip spring"), "does not remember"),
        (format!("{HERTZ} tangential linear_history 1e5 NULL 0.5"), "`NULL` for x_gamma"),
        (format!("{HERTZ} {MINDLIN} synchronized_verlet"), "synchronized_verlet"),
        (format!("hertz 1e5 0 {NONE} rolling epsd2 0.1"), "takes k_t from"),
        (format!("{HERTZ} {MINDLIN} material 5e7 0.3"), "second of two types"),
        (format!("{HERTZ} {MINDLIN} cohesion sjkr 1e5 arms point"), "does not go with"),
        (format!("hooke/hysteresis 5e6 0.9 0.45 2 1 0.2 0.05 {NONE}"), "above 1"),
        (format!("{HERTZ} {MINDLIN} rolling cdt"), "mu"),
        (format!("{HERTZ} {MINDLIN} slips spring"), "slips"),
    ] {
        let deck = format!(
            "units si\natom_style sphere\nregion box block 0 1 0 1 0 1\ncreate_box 1 box\npair_style granular\n\
             pair_coeff * * {law}\n"
        );
        let (text, well) = super::decks::run_with(&deck, &[]);
        assert!(!well && text.contains(message) && text.contains("error[PG"), "{law}\n{text}");
    }
}
