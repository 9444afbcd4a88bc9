//! K2: rigid bodies with true masses, centres and inertias.

use super::{numbers, run, text};

const STYLES: [&str; 4] = ["rigid", "rigid/small", "rigid/nve", "rigid/nve/small"];

/// What a deck prints behind `name`, with values of its variables and further arguments.
fn output_of(deck: &str, name: &str, variables: &[(&str, &str)], more: &[&str]) -> (Vec<f64>, String) {
    let variables = variables.iter().flat_map(|(name, value)| ["-var", *name, *value]);
    let arguments: Vec<&str> = variables.chain(more.iter().copied()).collect();
    let text = text(&run(deck, &arguments));
    (numbers(&text, name), text)
}

#[track_caller]
fn close(found: &[f64], expected: &[f64], most: f64) {
    assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= most), "{found:?} {expected:?}");
}

#[test]
fn bodies_of_infile_fall_with_g_and_do_not_turn() {
    let deck = "rigid_true_mass_gravity.in";
    // 100 steps of 1e-3 at g = 1: roundings; Σ v and spins of both spheres.
    let falls = [-0.1, -0.1, 0.0, 0.0, 0.0];
    for style in STYLES {
        for file in ["body.inf", "off.inf"] {
            for how in ["plain", "keyword"] {
                let deck_of = [("how", how), ("sty", style), ("inf", file)];
                let (found, text) = output_of(deck, "@", &deck_of, &[]);
                close(&found, &falls, 1e-14);
                // Where LAMMPS needs words to get there, they are named.
                assert_eq!(
                    text.contains("note[PG0301]") && text.contains("gravity g"),
                    how == "plain",
                    "{text}"
                );
            }
            let (found, text) = output_of(
                deck,
                "@",
                &[("how", "keyword"), ("sty", style), ("inf", file)],
                &["-compat", "lammps/2025"],
            );
            close(&found, &falls, 1e-14);
            assert!(!text.contains("warning"), "{text}");
        }
        // A weight that swings, pulled at the centre: g of 0.02 a step from 0 to 2, by the trapezoidal rule.
        for how in ["ramp", "swinging"] {
            close(
                &output_of(deck, "@", &[("how", how), ("sty", style), ("inf", "off.inf")], &[]).0,
                &falls,
                1e-14,
            );
        }
    }
}

#[test]
fn gravity_on_particles_of_bodies_is_lammps_and_warned_about() {
    let deck = "rigid_true_mass_gravity.in";
    // LAMMPS 22Jul2025, all its digits; Σm/M of g, and a body that turns where its centre is off.
    let lammps = [
        ("body.inf", "plain", [-0.13333333332616, -0.13333333332616, 0.0, 0.0, 0.0]),
        (
            "off.inf",
            "plain",
            [
                -0.155472526495552,
                -0.124875882256895,
                0.0698188435420876,
                -0.101983462905832,
                0.00336390548665411,
            ],
        ),
        (
            "off.inf",
            "twice",
            [
                -0.255472526495551,
                -0.224875882256894,
                0.0698188435420876,
                -0.101983462905832,
                0.00336390548665411,
            ],
        ),
        (
            "off.inf",
            "swinging",
            [
                -0.155474022790066,
                -0.124877420702453,
                0.0698258536602623,
                -0.101985005245816,
                0.00335117319492926,
            ],
        ),
    ];
    for (file, how, expected) in lammps {
        for style in ["rigid", "rigid/small"] {
            let compat = ["-compat", "lammps/2025"];
            let (found, text) = output_of(deck, "@", &[("how", how), ("sty", style), ("inf", file)], &compat);
            close(&found, &expected, 2e-14);
            assert!(text.contains("warning[PG0117]") && text.contains("`disable`"), "{text}");
        }
    }
    // Gravity that acts twice is reported by default as well.
    let (found, text) = output_of(deck, "@", &[("how", "twice"), ("inf", "off.inf")], &[]);
    close(&found[2..], &lammps[2].2[2..], 2e-14);
    assert!(text.contains("pulls these bodies twice"), "{text}");
    // And the ID must be that of a fix gravity.
    let refused = text_of_check("fix r all rigid/small molecule gravity down");
    assert!(refused.contains("there is no fix gravity `down`"), "{refused}");
}

/// The output of a run of a small scene with one more line.
fn text_of_check(line: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("in.scene");
    let scene = "units lj\natom_style sphere\nregion b block 0 4 0 4 0 4\ncreate_box 1 b\nfix m all property/atom mol\n\
                 create_atoms 1 single 1 1 1\ncreate_atoms 1 single 1.5 1 1\nset group all mol 1\npair_style zero 1.0\npair_coeff * *\n";
    std::fs::write(&path, format!("{scene}{line}\nrun 1\n")).unwrap();
    let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_perigrain"));
    text(&program.arg("-in").arg(&path).args(["-log", "none"]).current_dir(folder.path()).output().unwrap())
}

#[test]
fn templates_give_mass_centre_and_inertia() {
    let deck = "rigid_template.in";
    // Eigenvalues of the file's tensor; g over 100.5 steps of a deposited one, 101 of a created one, none of which turns.
    for style in ["rigid/small", "rigid/nve/small"] {
        for (how, steps) in [("deposit", 100.5), ("create", 101.0)] {
            for grav in ["plain", "keyword"] {
                let variables = [("how", how), ("sty", style), ("grav", grav)];
                let (mass, text) = output_of(deck, "mass", &variables, &[]);
                assert_eq!(mass, [1.5]);
                let mut moments = numbers(&text, "inertia");
                moments.sort_by(f64::total_cmp);
                close(&moments, &[0.29751942173260315, 0.3918829112562604, 0.5105976670111364], 1e-14);
                close(&numbers(&text, "v"), &[0.0, 0.0, -1e-3 * steps], 1e-14);
                close(&numbers(&text, "w"), &[0.0; 3], 1e-14);
            }
        }
    }
}

#[test]
fn templates_as_lammps_takes_them() {
    // LAMMPS 22Jul2025, all its digits: Ixy of the file stands for Iyz, a created body has the sums over its particles, and where
    // only the mass is given the centre is Σ m x over that. Which of three moments comes first is another matter.
    let deck = "rigid_template.in";
    let compat = ["-compat", "lammps/2025"];
    let cases = [
        (
            "clump3.mol",
            "plain",
            "deposit",
            1.5,
            [0.290363192043528, 0.40598370570092, 0.503653102255555],
            [0.190347593710013, 1.2299882401028, 53.2485218379088],
            [-0.040489283289315, -0.0146310842084403, 0.00161198700350243],
            -0.1675,
        ),
        (
            "clump3.mol",
            "keyword",
            "deposit",
            1.5,
            [0.290363192043528, 0.40598370570092, 0.503653102255555],
            [0.190347593710013, 1.2299882401028, 53.2518885045754],
            [0.0; 3],
            -0.1005,
        ),
        (
            "clump3.mol",
            "keyword",
            "create",
            2.5,
            [0.297700746273274, 0.418299253726725, 0.484],
            [0.495181909997947, 0.177561314358044, 49.9431956181787],
            [0.0; 3],
            -0.101,
        ),
        (
            "clump3_mass.mol",
            "plain",
            "deposit",
            1.5,
            [0.30455437353462, 0.41944562646538, 0.492],
            [0.128594620678851, 1.28978974944436, 53.3200085485778],
            [-0.00504772583668277, 0.0336649366467508, 0.0038315602205093],
            -0.1675,
        ),
    ];
    for (mol, grav, how, mass, inertia, x, w, fall) in cases {
        let (found, text) = output_of(deck, "mass", &[("mol", mol), ("grav", grav), ("how", how)], &compat);
        assert_eq!(found, [mass]);
        let mut moments = numbers(&text, "inertia");
        moments.sort_by(f64::total_cmp);
        close(&moments, &inertia, 1e-14);
        close(&numbers(&text, "x"), &x, 1e-12); // of places around 50
        close(&numbers(&text, "v"), &[0.0, 0.0, fall], 1e-14);
        close(&numbers(&text, "w"), &w, 1e-14);
    }
}

#[test]
fn nearly_straight_bodies_stay_in_their_plane() {
    let deck = "rigid_nearly_straight.in";
    // LAMMPS 22Jul2025; the exact rotations are 2 cos 20, 2 sin 20 but for the step.
    let (lammps, exact) =
        ([0.816158037326975, 1.82589322198933, 0.0], [0.816164123597137, 1.8258905014723, 0.0]);
    for style in STYLES {
        let nve = style.contains("nve");
        for off in ["1e-6", "1e-5", "1e-4", "1e-3"] {
            let expected = if nve { exact } else { lammps };
            // The larger `off`, the farther 2 is from the distance of the ends: by off².
            close(&output_of(deck, "@", &[("sty", style), ("off", off)], &[]).0, &expected, 1e-9);
        }
        // LAMMPS' steps keep to the plane in space where it is z = 0, and leave it where it leans.
        let compat = ["-compat", "lammps/2025"];
        close(
            &output_of(deck, "@", &[("sty", style), ("dim", "3")], &compat).0,
            if nve { &exact } else { &lammps },
            1e-9,
        );
        close(&output_of(deck, "@", &[("sty", style), ("dim", "3")], &[]).0, &exact, 1e-9);
        // Its plane is found from moments of 1e-7 of each other: a few roundings of 1e-16 over that.
        for off in ["1e-4", "1e-3"] {
            let leaning = [("sty", style), ("off", off)];
            close(&output_of("rigid_nearly_straight_leaning.in", "@", &leaning, &[]).0, &exact, 1e-6);
        }
    }
}

#[test]
fn free_bodies_keep_their_angular_momentum() {
    // Two equal moments, or three different ones. 3e4 steps: 3e-8 was missing under rigid/nve, growing with the square of the steps (6e-4 in 4e6).
    for style in STYLES {
        for third in ["0", "1"] {
            let (found, _) = output_of("rigid_momentum.in", "@", &[("sty", style), ("third", third)], &[]);
            close(&found, &[0.0; 3], 1e-13); // roundings of sums; LAMMPS: 1e-11
        }
    }
}

#[test]
fn the_ledger_knows_bodies() {
    // A fall by 2 and an impact on an elastic floor: the kinetic energy of the body is the work of its weight, M g, and what is imposed besides
    // is the error of a step, which falls with its square.
    for how in ["plain", "keyword"] {
        let ledger = |dt: &str| {
            let (found, text) = output_of("rigid_ledger.in", "@", &[("how", how), ("dt", dt)], &[]);
            // At t = 1: M g²/2 = 0.75, by the trapezoidal rule to the last digits; the spheres have 4/3 of it.
            let fallen = numbers(&text, "fallen");
            assert!((fallen[0] - 0.75).abs() < 1e-12 && (fallen[1] - 0.75).abs() < 1e-12, "{fallen:?}");
            (found[0] + found[1], found[3].abs() + found[4].abs())
        };
        let ((turnover, coarse), (_, fine)) = (ledger("1e-3"), ledger("5e-4"));
        assert!(coarse < 5e-3 * turnover && fine < 0.4 * coarse, "{turnover} {coarse} {fine}");
    }
}
