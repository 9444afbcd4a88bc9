//! K6: words and styles of LAMMPS that were refused.

use super::{numbers, run, text};

/// What the deck prints behind `RESULT`, its number words only.
fn result(deck: &str, arguments: &[&str]) -> Vec<f64> {
    let printed = text(&run(deck, arguments));
    numbers(&printed, "RESULT")
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
    let printed = text(&run("pair_local_heat.in", &[]));
    let found = numbers(&printed, "RESULT");
    assert!((found[0].abs() / flow - 1.0).abs() < 1e-7 && found[0] == found[1], "{found:?} for {flow}");
}

#[test]
fn properties_are_declared_again_behind_a_restart() {
    for (what, value) in [("mol", 3.0), ("d_foo", 3.5), ("temperature", 3.5)] {
        let printed = text(&run("property_atom_after_restart.in", &["-var", "what", what]));
        let line = printed.lines().rev().find(|l| l.starts_with("RESULT"));
        let found: Option<f64> = line.and_then(|l| l.split_whitespace().nth(2)?.parse().ok());
        assert_eq!(found, Some(value), "{printed}");
    }
}

/// A bonded lattice that is repeated: energy per atom is that of the unrepeated one, LAMMPS' 0.5167 (22Jul2025, `bond/periodic`).
#[test]
fn bonds_through_periodic_faces_join_the_nearest_copies() {
    let energy = |repeat: &str| {
        let printed = text(&run("replicate_bonds_through_faces.in", &["-var", "rep", repeat]));
        let line = printed.lines().rev().find(|l| l.starts_with("@ ")).unwrap_or_else(|| panic!("{printed}"));
        let words: Vec<&str> = line.split_whitespace().collect();
        let behind = |name: &str| {
            let at = words.iter().position(|w| *w == name).unwrap();
            words[at + 1].parse::<f64>().unwrap()
        };
        (behind("e/atom"), behind("longest"), printed.contains("span whole repetitions"))
    };
    let (alone, longest, _) = energy("1 1 1");
    let (e, l, warned) = energy("2 2 2 bond/periodic");
    // Sums of 1,000 times as many terms; printed with six digits.
    assert!((e / alone - 1.0).abs() < 2e-5 && (l / longest - 1.0).abs() < 2e-5 && !warned, "{e} {alone} {l}");
    assert!((alone - 0.5167).abs() < 5e-5, "{alone}");
    let (far, _, warned) = energy("2 2 2");
    assert!(far > 100.0 && warned, "{far}");
}

/// Two planes that move by variables, with dashpots and friction. LAMMPS 22Jul2025 has no such planes; its numbers for two
/// `region … plane … move` of `fix wall/gran/region` with the same variables.
#[test]
fn planes_of_walls_follow_variables() {
    let wanted = [0.02834081701, -0.004490246985, 0.2283940762, -0.2035019254];
    // Ten digits are printed.
    close(&result("wall_planes_by_variables.in", &["-compat", "lammps/2025"]), &wanted, 1e-8);
    // Springs that slide are cut otherwise by default; the planes are the same.
    close(&result("wall_planes_by_variables.in", &[]), &wanted, 0.02);
    // A run cut in two by a restart file has the same bits, also in the middle of a contact.
    let cut = |half: &str| {
        let printed = text(&run("wall_planes_by_variables.in", &["-var", "half", half]));
        printed.lines().rev().find(|l| l.starts_with("RESULT")).map(str::to_string)
    };
    assert!(cut("1000").is_some() && cut("1000") == cut("437"));
    // An elastic piston: twice its velocity, but for what a step of a fiftieth of the contact leaves.
    close(&result("wall_piston.in", &[]), &[-1.0], 1e-6);
}

#[test]
fn planes_that_pass_through_each_other_end_the_run() {
    let printed =
        text(&run("wall_planes_by_variables.in", &["-var", "hi", "v_floor", "-var", "lo", "v_top"]));
    assert!(
        printed.contains("lies not below the upper one") && printed.contains("two fixes may do so"),
        "{printed}"
    );
    let printed = text(&run("wall_planes_by_variables.in", &["-var", "hi", "v_nothing"]));
    assert!(printed.contains("v_nothing") || printed.contains("`nothing`"), "{printed}");
}

/// Diameters 1 + id t at t = 0.1 of the grains 1 and 3, the second one is in no group; masses go with the cube, from those of 0.8.
#[test]
fn sizes_follow_a_variable_of_each_particle() {
    let mass = |d: f64| 1000.0 * std::f64::consts::PI / 6.0 * d.powi(3);
    let sized = |words: &str| result("adapt_each.in", &["-var", "words", words]);
    close(&sized("reset no"), &[0.55, 0.4, 0.65, mass(1.1), mass(1.3)], 1e-12);
    close(&sized("mass no"), &[0.55, 0.4, 0.65, mass(0.8), mass(0.8)], 1e-12);
    // As factors, in a thousand steps of products.
    close(&sized("scale yes"), &[0.44, 0.4, 0.52, mass(0.88), mass(1.04)], 1e-11);
    // What was changed is put back at the end of each run.
    close(&sized("scale yes reset yes"), &[0.4, 0.4, 0.4, mass(0.8), mass(0.8)], 1e-15);
}

/// LAMMPS 22Jul2025's numbers for the same deck.
#[test]
fn synchronized_springs_are_lammps() {
    let cases = [
        (
            "tangential linear_history 7e4 0.8 0.3",
            [0.30753894514549, 0.57043918844601, 0.05125426224417, 0.41954983409966, 0.14590769070139]
                .into_iter()
                .chain([0.040720458041973, 2.3065786992267, 19.388650111055, 4.068470532626]),
        ),
        (
            "tangential linear_history 7e4 0.8 0.3 rolling sds 1e4 5 0.2 twisting sds 10 0.1 0.05",
            [0.30753567520281, 0.57044072201944, 0.05125662440791, 0.41916617608593, 0.14608837317839]
                .into_iter()
                .chain([0.040996222409431, 2.6438501502266, 18.675259811107, 3.7658645116662]),
        ),
    ];
    for (models, wanted) in cases {
        let wanted: Vec<f64> = wanted.collect();
        let words = ["-var", "models", models];
        // Fourteen digits are printed.
        let found = result("synchronized.in", &[&["-compat", "lammps/2025"][..], &words].concat());
        close(&found, &wanted, 1e-12);
        // By default forces act along the normal at the end of the step: half a step's turn of it, v_t dt / (2 r), is 5e-5.
        let own = result("synchronized.in", &words);
        close(&own, &wanted, 2e-3);
        assert!((own[3] / wanted[3] - 1.0).abs() > 1e-6, "{own:?}");
    }
}

/// Without friction and dashpot a grain on another keeps its energy; LAMMPS' normal of the middle of the step brakes it.
#[test]
fn synchronized_springs_brake_nothing_that_does_not_rub() {
    let words = ["-var", "models", "tangential none"];
    let energy = |found: Vec<f64>| found[3..6].iter().map(|v| v * v).sum::<f64>();
    let plain = energy(result("synchronized.in", &words));
    let lammps = energy(result("synchronized.in", &[&["-compat", "lammps"][..], &words].concat()));
    assert!(lammps < plain, "{lammps} {plain}");
}

/// LAMMPS 22Jul2025: lz, area and ly; its particles leave the plane with a box that does not lie alike on both sides of it.
#[test]
fn flat_scenes_change_their_length_along_z() {
    let lammps = ["-compat", "lammps/2025"];
    close(&result("flat_deform.in", &lammps), &[2.0, 36.0, 6.0, -0.3], 1e-12);
    close(&result("flat_deform.in", &[]), &[2.0, 36.0, 6.0, 0.0], 1e-12);
    let words = ["-var", "words", "x erate 0.1 z volume"];
    close(&result("flat_deform.in", &words), &[1.0 / 1.001, 36.036, 6.0], 1e-12);
    let printed = text(&run("flat_deform.in", &["-var", "words", "z final 0.1 0.7"]));
    assert!(printed.contains("must hold the plane z = 0"), "{printed}");
}

/// η = e √(m̄ k) of `damping mdr 1` is 0 where e is: the same bits.
#[test]
fn plastic_grains_need_no_dashpot() {
    let none = text(&run("mdr_undamped.in", &[]));
    let mdr = text(&run("mdr_undamped.in", &["-var", "damping", "mdr 1"]));
    let line = |printed: &str| printed.lines().find(|l| l.starts_with("RESULT")).map(str::to_string);
    assert!(line(&none).is_some() && line(&none) == line(&mdr), "{none}\n{mdr}");
}

/// LAMMPS 22Jul2025: energy, pressure and the force on the wall in the beginning, and places after 100 steps.
#[test]
fn walls_of_regions_are_lammps() {
    let cases: [(&str, &str, [f64; 5], [f64; 6]); 6] = [
        (
            "ball",
            "lj93 1.0 0.9 2.5",
            [-0.3432703453, -0.0004230450394, 0.4854401004, -0.9056559, 0.4600243492],
            [1.204882987, 1.104476072, 2.008138312, -1.614757114, 1.513834795, -1.917524073],
        ),
        (
            "out",
            "lj126 1.0 0.9 2.5",
            [-0.07981530637, -0.0001988314318, 0.1496976708, 0.2789253092, 0.2861158507],
            [1.195446793, 1.095826227, 1.992411322, -1.598468969, 1.498564658, -1.898181901],
        ),
        (
            "cyl",
            "lj1043 1.0 0.9 2.5",
            [-2.502670513, 0.004950608415, -33.07839195, 25.82391746, -0.1399051442],
            [1.258293111, 1.153435351, 2.014279456, -1.431276417, 1.341821641, -1.911451658],
        ),
        (
            "blk",
            "harmonic 20.0 0.0 2.5",
            [72.7, 0.06543209877, -16.0, 64.0, 4.0],
            [0.7107905948, 0.6806776527, 0.9516941317, -0.8312423632, 0.8011294211, -0.9215811896],
        ),
        (
            "pr",
            "morse 1.0 2.0 1.2 2.5",
            [-1.386338149, 0.0008060215427, -4.070314986, -1.242398648, 2.098106203],
            [1.206988255, 1.111109754, 1.944883811, -1.531548594, 1.514270141, -1.883060232],
        ),
        (
            "moves",
            "lj93 1.0 0.9 2.5",
            [-0.3432703453, -0.0004230450394, 0.4854401004, -0.9056559, 0.4600243492],
            [1.204585725, 1.104321894, 2.007857988, -1.615808631, 1.514508715, -1.918377706],
        ),
    ];
    for (region, law, start, end) in cases {
        let printed = text(&run("wall_region.in", &["-var", "region", region, "-var", "law", law]));
        // Ten digits are printed.
        close(&numbers(&printed, "START"), &start, 1e-8);
        close(&numbers(&printed, "RESULT"), &end, 1e-8);
    }
}

/// `colloid` attracts in LAMMPS where it should repel.
#[test]
fn colloids_are_repelled_unless_lammps_is_wanted() {
    let words = ["-var", "region", "blk", "-var", "law", "colloid 1.0 0.9 2.5"];
    let start = |more: &[&str]| numbers(&text(&run("wall_region.in", &[more, &words].concat())), "START");
    let wanted = [0.04159479181, 8.084826028e-06, -0.003128176269, 0.00519933727, 0.0003364160943];
    let (lammps, own) = (start(&["-compat", "lammps/2025"]), start(&[]));
    close(&lammps, &wanted, 1e-8);
    (2..5).for_each(|k| assert!((lammps[k] + own[k]).abs() < 1e-12, "{lammps:?} {own:?}"));
    let printed = text(&run("wall_region.in", &["-var", "law", "lj93 1e4 0.9 2.5"]));
    assert!(printed.contains("is on or beyond the surface of region `ball` in step 9"), "{printed}");
}

/// LAMMPS 22Jul2025: energy, pressure and forces on two walls in the beginning, and places after 100 steps. The upper wall comes
/// down, and all walls get stronger.
#[test]
fn flat_walls_are_lammps() {
    let cases = [
        (
            "lj93",
            "v_e 0.9",
            [-0.5549301465, -0.0006111219048, 1.314509583, -1.722095413],
            [1.2, 2.159848202, -1.6, -2.021901952],
        ),
        (
            "lj126",
            "v_e 0.9",
            [-0.9093224226, -0.0004008565213, 2.618249052, 0.8020337511],
            [1.2, 1.958958993, -1.6, -2.033363989],
        ),
        (
            "lj1043",
            "v_e 0.9",
            [-3.397989671, -0.003627948772, 8.487887251, -9.470610457],
            [1.2, 2.022472964, -1.6, -2.020543649],
        ),
        (
            "colloid",
            "v_e 0.9",
            [-0.004775229579, -4.513324272e-06, 0.01098126521, -0.0113176813],
            [1.2, 2.000950301, -1.6, -1.900951973],
        ),
        ("harmonic", "v_e 0.9", [2.105, 0.001172839506, -2.8, 3.0], [1.2, 1.747260452, -1.6, -1.665568678]),
        (
            "morse",
            "v_e 2.0 1.2",
            [-0.7115140507, 0.0007956638613, -1.081687758, 2.934864923],
            [1.2, 1.807007443, -1.6, -1.825149345],
        ),
    ];
    for (law, words, start, end) in cases {
        let printed = text(&run("wall_flat.in", &["-var", "law", law, "-var", "words", words]));
        // Ten digits are printed.
        close(&numbers(&printed, "START"), &start, 1e-8);
        close(&numbers(&printed, "RESULT"), &end, 1e-8);
    }
}

/// LAMMPS 22Jul2025: bonds, those of the last look and of all, energies, and particles of type 1 at the end.
#[test]
fn bonds_are_made_as_lammps_makes_them() {
    let cases = [
        ("0 1 1", "1 2 0.9 1 prob 0.5 85784", [150.0, 4.0, 150.0, 0.4792871254, 1.555298574, 150.0]),
        ("0 1 1", "1 1 0.9 1 iparam 2 1 jparam 2 1", [87.0, 0.0, 87.0, 0.321995316, 1.620579891, 150.0]),
        ("0 0 0", "1 1 1.2 1 iparam 3 2 jparam 3 2", [146.0, 4.0, 146.0, 0.7129669294, 2.222101271, 108.0]),
        (
            "0.5 0 1",
            "2 1 1.2 1 iparam 3 2 jparam 1 1 prob 0.9 77",
            [129.0, 1.0, 129.0, 0.6169228563, 1.930390108, 150.0],
        ),
    ];
    for (weights, words, wanted) in cases {
        let printed = text(&run("bond_create.in", &["-var", "weights", weights, "-var", "words", words]));
        // A hundred steps of stiff bonds between particles at random places.
        close(&[numbers(&printed, "RESULT"), numbers(&printed, "FIRST")].concat(), &wanted, 1e-7);
    }
}

/// LAMMPS 22Jul2025: the force is 0 in the step in which the bond is made (33), and grows from there.
#[test]
fn bonds_that_are_made_are_at_rest() {
    let rotational = "10.0 5 1 1 10 10 10 10 0.2 0.0 0.0 0.0";
    for (style, coeff, wanted) in [
        ("bpm/spring", "10.0 0.5 0.0", [40.0, 1.0, 0.4814032591, -0.7652692873]),
        ("bpm/rotational", rotational, [40.0, 1.0, 0.4536236859, -0.6575244848]),
    ] {
        let words = ["-compat", "lammps/2025", "-var", "style", style, "-var", "coeff", coeff];
        // Ten digits are printed.
        close(&result("bond_create_rest.in", &words), &wanted, 1e-8);
    }
}

/// One thread, three, and a run cut in two by a restart file: the same bits, and the same random numbers.
#[test]
fn bonds_are_made_alike_with_threads_and_behind_a_restart() {
    let last = |more: &[&str]| {
        let printed =
            text(&run("bond_create.in", &[&["-var", "words", "1 2 0.9 1 prob 0.5 85784"], more].concat()));
        let line = printed.lines().rev().find(|l| l.starts_with("RESULT")).map(str::to_string);
        line.unwrap_or_else(|| panic!("{printed}"))
    };
    let one = last(&["-threads", "1"]);
    assert_eq!(one, last(&["-threads", "3"]));
    assert_eq!(one, last(&["-var", "half", "50"]));
}
