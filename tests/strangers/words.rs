//! K6: decks and files as users write them, and helpful messages.

use super::{numbers, run, text};
use std::process::{Command, Output, Stdio};

/// What the program does with the first of these files, all of which lie in one folder.
fn work(files: &[(&str, &str)], arguments: &[&str]) -> Output {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in files {
        std::fs::write(folder.path().join(name), content).unwrap();
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_perigrain"));
    command.args(arguments).current_dir(folder.path()).stdin(Stdio::null());
    command.output().unwrap()
}

/// The output of `perigrain check` for a deck.
fn check(deck: &str) -> String {
    text(&work(&[("in.deck", deck)], &["check", "in.deck"]))
}

/// How many lines begin so.
fn lines(text: &str, begin: &str) -> usize {
    text.lines().filter(|line| line.starts_with(begin)).count()
}

const SCENE: &str = "units lj\natom_style sphere\nregion b block 0 4 0 4 0 4\ncreate_box 1 b\n";

/// Row 26: LAMMPS replaces these characters in decks and data files, with one warning (utils::utf8_subst).
#[test]
fn characters_that_look_like_others_are_read_as_these() {
    let deck = "\u{feff}units\u{a0}lj # a\u{a0}comment\natom_style\u{2002}atomic\n\u{200b}read_data data.x\n\
                include more.in\nvariable list file list.txt\nprint \u{201c}said ${word} ${list} \u{201d}\n\
                variable v equal \u{2212}2\nprint \"in quotes \u{201c}stay\u{201d}, v is $v\"\nprint \"$(count(all))\"\n";
    let data = "atoms\n\n2\u{a0}atoms\n1\u{3000}atom types\n0 4\u{200b} xlo xhi\n0 4 ylo yhi\n0 4 zlo zhi\n\nMasses\n\n1 1\n\n\
                Atoms\n\n1\u{a0}1 1 1 1\n2 1 \u{2212}0.0 2 2\n";
    let files = [
        ("in.deck", deck),
        ("data.x", data),
        ("more.in", "mass\u{2009}1 2.0\n"),
        ("list.txt", "\u{feff}one\u{a0}two\n"),
    ];
    let output = work(&files, &["-in", "in.deck", "-log", "none", "-var", "word", "a\u{a0}b"]);
    let printed = text(&output);
    assert!(output.status.success(), "{printed}");
    for line in ["\nsaid a b ", "\nin quotes \u{201c}stay\u{201d}, v is -2\n", "\n2\n"] {
        assert!(printed.contains(line), "{line:?}: {printed}");
    }
    // One note for each text: the deck, the included file, the data file, the list, the value.
    assert_eq!(lines(&printed, "note[PG0149]"), 5, "{printed}");
    for part in [
        "U+FEFF (byte order mark) is read as a blank, U+00A0 (no-break space) is read as a blank, U+2002",
        "U+201D (right double quotation mark) is read as `\"`",
        "U+2212 (minus sign) is read as `-`",
        "`data.x`, line 3: U+00A0 (no-break space, 2 times)",
        "`list.txt`, line 1: U+FEFF",
        "-var word: U+00A0",
        "in.deck:1:1",
    ] {
        assert!(printed.contains(part), "{part:?}: {printed}");
    }
}

/// Row 26: molecule files, material files and tables of surfaces too, and decks that are read from a pipe.
#[test]
fn other_files_may_have_such_characters_too() {
    let molecule = "\u{feff}two\n\n2\u{a0}atoms\n\nCoords\n\n1 0\u{a0}0 0\n2 1 0 0\n\nTypes\n\n1 1\n2 1\n";
    let material = "\u{feff}name\u{a0}= 'x'\nsource = 'y'\ndate = '2026-01-01'\nE = '2 GPa'\nnu = 0.25\nrho = '1.5 g/cm3'\n";
    let stl = "\u{feff}solid s\nfacet normal 0 0 1\nouter\u{a0}loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
    let deck = "units si\natom_style sphere\nregion b block 0 4 0 4 0 4 units box\ncreate_box 1 b\nmolecule m two.mol\n\
                material x file x.toml\ncreate_atoms 1 mesh s.stl units box\nprint \"$(count(all))\"\n";
    let files = [("in.deck", deck), ("two.mol", molecule), ("x.toml", material), ("s.stl", stl)];
    let output = work(&files, &["-in", "in.deck", "-log", "none"]);
    let printed = text(&output);
    assert!(output.status.success(), "{printed}");
    for file in ["`two.mol`", "`x.toml`", "`s.stl`"] {
        assert!(printed.contains(&format!("note[PG0149]: {file}, line 1: U+FEFF")), "{file}: {printed}");
    }
}

/// Row 27: LAMMPS skips the line under a heading, whatever it contains; a row of numbers there would be lost.
#[test]
fn text_under_headings_of_files_is_passed_over() {
    let data = |under: &str| {
        format!(
            "t\n\n2 atoms\n1 atom types\n0 1 xlo xhi\n0 1 ylo yhi\n0 1 zlo zhi\n\nMasses\nsome text\n1 1.0\n\nAtoms # atomic\n{under}\n\
             1 1 0.1 0.1 0.1\n2 1 0.5 0.5 0.5\n"
        )
    };
    let deck = "units lj\natom_style atomic\nread_data data.x\nmolecule m m.mol\nprint \"$(count(all))\"\n";
    let molecule = "m\n\n1 atoms\n\nCoords\nid x y z\n1 0 0 0\n\nTypes\n\n1 1\n";
    let files = |under: &str| data(under);
    let good = files("id type x y z");
    let output = work(
        &[("in.deck", deck), ("data.x", &good), ("m.mol", molecule)],
        &["-in", "in.deck", "-log", "none"],
    );
    let printed = text(&output);
    assert!(output.status.success() && printed.contains("\n2\n"), "{printed}");
    assert_eq!(lines(&printed, "note[PG0116]: the text under the heading "), 3, "{printed}");
    assert!(printed.contains("data.x:14:1"), "{printed}");
    let lost = files("1 1 0.1 0.1 0.1");
    let output = work(
        &[("in.deck", deck), ("data.x", &lost), ("m.mol", molecule)],
        &["-in", "in.deck", "-log", "none"],
    );
    assert!(text(&output).contains("the line after the heading Atoms must be blank"), "{}", text(&output));
}

/// Rows 29 and 36: strengths that are not needed may be any numbers; angles of 1e-8 bend a bond, which bears kb times them.
#[test]
fn bonds_that_do_not_break_need_no_strength_and_feel_the_smallest_angle() {
    for (degrees, angle) in
        [("5.729577951308232e-3", 1e-4), ("5.729577951308232e-7", 1e-8), ("5.729577951308232e-8", 1e-9)]
    {
        for compat in [&["-var", "a", degrees][..], &["-var", "a", degrees, "-compat", "lammps"]] {
            let output = run("bond_angle.in", compat);
            assert!(output.status.success(), "{}", text(&output));
            // kb = 1e6; the formula is printed with six digits by its variable.
            let torque = numbers(&text(&output), "torque")[0];
            assert!((torque / (1e6 * angle) - 1.0).abs() < 1e-5, "{torque} {angle}");
        }
    }
    let breaking = "units lj\natom_style bpm/sphere\nregion b block 0 4 0 4 0 4\ncreate_box 1 b bond/types 1\n\
                    bond_style bpm/spring\nbond_coeff 1 1 -1 0\n";
    assert!(check(breaking).contains("error[PG0108]"), "{}", check(breaking));
}

/// Row 32 (lammps#4606): 600 pairs in range are two bonds apart, and the default weights keep them out.
#[test]
fn bonds_that_are_left_out_are_named() {
    let deck = |weights: &str| {
        format!(
            "units lj\ndimension 2\natom_style bond\nlattice hex 1.1547005383792515\nregion b block 0 10 0 10 -0.5 0.5\n\
             create_box 1 b bond/types 2 extra/bond/per/atom 12 extra/special/per/atom 200\ncreate_atoms 1 box\nmass 1 1\n\
             {weights}\ncreate_bonds many all all 1 0.9 1.1\ncreate_bonds many all all 2 1.6 1.8\nprint \"bonds $(bonds)\"\n"
        )
    };
    let printed = text(&work(&[("in.deck", &deck(""))], &["-in", "in.deck", "-log", "none"]));
    assert!(
        printed
            .contains("warning[PG0117]: 600 pairs in range were left out: they are two or three bonds apart"),
        "{printed}"
    );
    assert!(printed.contains("put `special_bonds lj/coul 0 1 1` before this line"), "{printed}");
    assert!(printed.contains("\nbonds 600\n") && lines(&printed, "warning") == 1, "{printed}");
    let printed = text(&work(
        &[("in.deck", &deck("special_bonds lj/coul 0 1 1"))],
        &["-in", "in.deck", "-log", "none"],
    ));
    assert!(printed.contains("\nbonds 1200\n") && lines(&printed, "warning") == 0, "{printed}");
    let printed = text(&work(
        &[(
            "in.deck",
            &deck("group half id <= 100\nspecial_bonds lj/coul 0 1 1\nneigh_modify exclude group half half"),
        )],
        &["-in", "in.deck", "-log", "none"],
    ));
    assert!(printed.contains("excluded by `neigh_modify exclude`"), "{printed}");
}

/// Row 33: a loop without an end in sight is left after a bound, with a note; one with an end is followed to it.
#[test]
fn endless_loops_are_left_and_named() {
    let scene = "clear\nunits si\natom_style sphere\nregion b block 0 1 0 1 0 1\ncreate_box 1 b\ncreate_atoms 1 single 0.5 0.5 0.5\n\
                 set group all diameter 0.1 density 1000\npair_style gran/hooke/history 1e4 NULL 10 NULL 0.5 1\npair_coeff * *\n\
                 fix 1 all nve/sphere\n";
    let endless = format!(
        "variable i equal 0\nlabel a\nvariable n equal $i+1\nvariable i equal $n\n{}run 10\njump SELF a\n",
        scene.repeat(8)
    );
    let begin = std::time::Instant::now();
    let printed = check(&endless);
    // 50,000 lines are a second or two in a test build; without the bound there were 10,000 turns of 85.
    assert!(begin.elapsed().as_secs() < 60, "{:?}", begin.elapsed());
    assert!(printed.contains("note[PG0150]: the end of this loop is not in sight after 5"), "{printed}");
    assert!(printed.contains("in.deck: 1 note\n"), "{printed}");
    let finite = "variable i loop 3000\nlabel a\nprint \"$i\"\nnext i\njump SELF a\n";
    assert!(check(finite).ends_with("in.deck: no problems found\n"), "{}", check(finite));
}

/// Row 34: consequences of a refused atom style are not reported as well.
#[test]
fn only_the_atom_style_is_refused() {
    let dipoles = "units lj\natom_style hybrid sphere dipole/x\nregion b block 0 9 0 9 0 9\ncreate_box 1 b\n\
                   create_atoms 1 random 10 123 b\nset group all diameter 1.0 density 1.0\n\
                   pair_style gran/hooke/history 100 NULL 1 NULL 0.5 1\npair_coeff * *\ncompute r all erotate/sphere\n\
                   fix 1 all nve/sphere\nthermo_style custom step c_r\nrun 10\n";
    let printed = check(dipoles);
    assert_eq!((lines(&printed, "error"), lines(&printed, "warning")), (1, 0), "{printed}");
    assert!(printed.contains("atom_style `dipole/x`"), "{printed}");
    let charges = "units lj\natom_style amoeba\nregion b block 0 9 0 9 0 9\ncreate_box 1 b bond/types 1 angle/types 1\n\
                   create_atoms 1 random 10 123 b\nmass 1 1\nset group all charge 1\nbond_style harmonic\nbond_coeff 1 1 1\n\
                   angle_style harmonic\nangle_coeff 1 1 180\nkspace_style pppm 1e-4\nfix 1 all nve\nrun 10\n";
    let printed = check(charges);
    assert_eq!((lines(&printed, "error"), lines(&printed, "warning")), (1, 0), "{printed}");
    assert!(
        printed.contains("LAMMPS' atom_style `amoeba` is not in perigrain")
            && printed.contains("charges and moments feel fields"),
        "{printed}"
    );
    // Other mistakes stay.
    let printed = check(&charges.replace("fix 1 all nve", "fxi 1 all nve"));
    assert!(printed.contains("unknown command `fxi`") && lines(&printed, "error") == 2, "{printed}");
}

/// Row 34: words of LAMMPS that are missing here are named as such, with an alternative.
#[test]
fn words_of_lammps_lead_on() {
    for (line, message, help) in [
        ("fix 1 all nph/sphere iso 0 0 1", "LAMMPS' fix style `nph/sphere`", "use `fix deform/pressure`"),
        ("fix 1 all nvt temp 1 1 1", "LAMMPS' fix style `nvt`", "use `fix langevin`"),
        ("fix 1 all nve/asphere", "LAMMPS' fix style `nve/asphere`", "grains here are spheres"),
        ("fix 1 all graphics/arrows 10 velocity", "LAMMPS' fix style `graphics/arrows`", "`dump image`"),
        (
            "compute 1 all stress/cartesian x 0.1",
            "LAMMPS' compute style `stress/cartesian`",
            "`compute stress/atom`",
        ),
        ("compute 1 all voronoi/atom", "LAMMPS' compute style `voronoi/atom`", "`compute coord/atom`"),
        ("pair_style lj/cut 2.5", "LAMMPS' pair style `lj/cut`", "`pair_style soft` or `bpm/spring`"),
        (
            "pair_style hybrid lj/cut 2.5 zero 1",
            "LAMMPS' pair style `lj/cut`",
            "`pair_style soft` or `bpm/spring`",
        ),
        ("dump 1 all netcdf 10 x.nc id", "LAMMPS' dump style `netcdf`", "`dump vtk`"),
        ("angle_style harmonic", "LAMMPS' angle_style `harmonic`", "`bond_style bpm/rotational`"),
        ("kspace_style pppm 1e-4", "LAMMPS' command `kspace_style`", "leave the line out"),
        ("labelmap atom 1 C", "LAMMPS' command `labelmap`", "write types as numbers"),
        ("min_style hftn", "LAMMPS' minimization style `hftn`", "`fire`"),
        (
            "pair_style gran model hertz tangential history",
            "LIGGGHTS' pair style `gran`",
            "`pair_style granular`",
        ),
        (
            "fix 1 all mesh/surface file x.stl type 1",
            "LIGGGHTS' fix style `mesh/surface`",
            "use `fix surface FILE type T`",
        ),
        ("communicate single vel yes", "LIGGGHTS' command `communicate`", "leave the line out"),
        ("fix 1 all nve/spher", "unknown fix style `nve/spher`", "did you mean `nve/sphere`?"),
        (
            "fix 1 all wall/gran hertz/material 1e5 0.1 0.3 zplane 0 NULL",
            "unknown force style of a wall: `hertz/material`",
            "write `granular hertz/material …`",
        ),
        (
            "fix 1 all wall/mesh hertz/material 1e5 0.1 0.3 mesh x.stl",
            "unknown force style of a wall: `hertz/material`",
            "write `granular hertz/material …`",
        ),
        (
            "fix 1 all wall/mesh mesh x.stl hooke 1 NULL 0 0 0 0",
            "`mesh`",
            "write the force first: `granular hertz/material",
        ),
    ] {
        // By itself the first word of LIGGGHTS makes a deck one of LIGGGHTS.
        let compat = if message.starts_with("LIGGGHTS") { "compat none\n" } else { "" };
        let printed = check(&format!("{compat}{SCENE}{line}\n"));
        assert!(printed.contains(message) && printed.contains(help), "{line}: {printed}");
        assert_eq!(lines(&printed, "error"), 1, "{line}: {printed}");
    }
    // The accelerated forms of styles are these styles; a renamed one has both names.
    let deck = "fix 1 all nve/sphere/omp\nfix 2 all addtorque/group 0 0 0\npair_style gran/hooke/history/kk 1e4 NULL 10 NULL 0.5 1\n\
                pair_coeff * *\nrun 0\n";
    let printed = check(&format!("{SCENE}create_atoms 1 single 1 1 1\n{deck}"));
    assert_eq!(lines(&printed, "error"), 0, "{printed}");
}

/// Row 35: notes about LAMMPS' faults are true for the year that `-compat` names, and lead to the other year.
#[test]
fn notes_name_the_year() {
    let output_of = |compat: &str| text(&run("hertz_history_wall.in", &["-compat", compat]));
    let fault = "springs of walls with history that depend on the contact radius";
    let old = output_of("lammps/2025");
    assert!(old.contains(&format!("note[PG0301]: compat lammps/2025: {fault}")), "{old}");
    for newest in ["lammps", "lammps/2026"] {
        let new = output_of(newest);
        assert!(
            new.contains("note[PG0301]: LAMMPS 22Jul2025 has springs of walls")
                && new.contains("lammps/2026 has not"),
            "{new}"
        );
        assert!(new.contains("older than 2026, write `-compat lammps/2025`"), "{new}");
    }
    let own = text(&run("hertz_history_wall.in", &[]));
    assert!(!own.contains("PG0301"), "{own}");
}

/// Row 35a: the numbers that LAMMPS publishes with its tests of 4 Jul 2026 and 30 Mar 2026 (unittest/granular), whose tolerance is
/// 1e-10.
#[test]
fn compat_lammps_has_what_2026_has_mended() {
    let near = |have: &[f64], want: &[f64]| {
        assert_eq!(have.len(), want.len());
        have.iter().zip(want).all(|(a, b)| (a - b).abs() <= 1e-10 * b.abs().max(1e-3))
    };
    for (deck, moment, new, old) in [
        // The old numbers are those of LAMMPS 22Jul2025, run with these decks.
        (
            "tsuji_pair.in",
            "touching",
            &[-2.4980771847769199e-03, 1.8175852473916858][..],
            &[-0.00249805776149033, 1.85990296772608][..],
        ),
        (
            "tsuji_pair.in",
            "parted",
            &[-2.5034867026327494e-03, -9.9971769309661351e-01][..],
            &[-0.00250476678204333, -1.23209642250942][..],
        ),
        (
            "tsuji_wall.in",
            "parted",
            &[-2.5034880148754384e-03, -9.9974392334184659e-01][..],
            &[-0.00250491891874881, -1.23216007217362][..],
        ),
        (
            "hertz_history_wall.in",
            "parted",
            &[
                7.1039114481321816e-02,
                5.0143479228817511e-01,
                4.3229008746243802e-01,
                9.9321877551794191e-01,
                2.8385495626877999,
            ][..],
            &[0.07108036700396531, 0.501434792288175, 0.433956783523448, 0.993218775517942, 2.83021608238276]
                [..],
        ),
    ] {
        for (compat, want) in [("lammps", new), ("lammps/2025", old)] {
            let printed = text(&run(deck, &["-compat", compat]));
            assert!(near(&numbers(&printed, moment), want), "{deck} {moment} {compat}: {printed}");
        }
    }
}
