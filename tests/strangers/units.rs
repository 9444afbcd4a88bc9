//! K3: no bare number that has a unit; mistakes of scale are named before the run.

use super::{numbers, run, text};
use std::fs;
use std::path::Path;
use std::process::Command;

// Oracle: LAMMPS 22Jul2025 pours 305.
#[test]
fn a_slot_narrower_than_one_holds_what_it_holds() {
    let printed = text(&run("pour_narrow_slot.in", &[]));
    assert_eq!(numbers(&printed, "RESULT"), [305.0], "{printed}");
}

// Oracle: LAMMPS 22Jul2025, to the digits printed.
#[test]
fn distances_of_new_particles_count_in_lattice_spacings() {
    let printed = text(&run("overlap_in_spacings.in", &[]));
    assert_eq!(numbers(&printed, "ATOMS"), [100.0], "{printed}");
    assert_eq!(numbers(&printed, "FIRST"), FIRST, "{printed}");
    assert_eq!(numbers(&printed, "LAST"), LAST, "{printed}");
    assert_eq!(numbers(&printed, "FEW"), [20.0], "{printed}");
}

const FIRST: [f64; 3] = [0.05214324368, 0.07149649582, 0.04160531519];
const LAST: [f64; 3] = [0.07495506619, 0.0697974332, 0.08545979573];

// The length at rest, by 1e-8 of the excess; LAMMPS 22Jul2025 stays where it began.
#[test]
fn small_energies_are_minimized_too() {
    let far = |arguments: &[&str]| numbers(&text(&run("minimize_small_energies.in", arguments)), "RESULT")[0];
    assert!((far(&[]) - 1e-3).abs() < 1e-16, "{:e}", far(&[]) - 1e-3);
    assert!((far(&["-compat", "lammps/2025"]) - 1.00001e-3).abs() < 1e-12);
}

/// The messages of `check` and of a run about a deck in a folder, each by itself.
fn both(folder: &Path, deck: &str) -> [String; 2] {
    fs::write(folder.join("in.deck"), deck).unwrap();
    [&["check", "in.deck"][..], &["-in", "in.deck", "-log", "none"]].map(|words| {
        let out =
            Command::new(env!("CARGO_BIN_EXE_perigrain")).args(words).current_dir(folder).output().unwrap();
        text(&out)
    })
}

/// The corner of a cube of this edge as an STL file.
fn corner_of_cube(edge: f64) -> String {
    let vertex = |c: [f64; 3]| format!("vertex {} {} {}\n", c[0] * edge, c[1] * edge, c[2] * edge);
    let faces = [
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
        [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
    ];
    let facet = |f: &[[f64; 3]; 3]| {
        format!("facet normal 0 0 1\nouter loop\n{}endloop\nendfacet\n", f.map(vertex).concat())
    };
    format!("solid c\n{}endsolid c\n", faces.iter().map(facet).collect::<String>())
}

const GRAIN: &str = "create_atoms 1 single 0.5 0.5 0.5 units box\nset group all diameter 0.1 density 2500\npair_style none\n\
                     fix n all nve/sphere\ntimestep 1e-6\n";

#[test]
fn a_box_within_one_spacing_was_meant_otherwise() {
    let folder = tempfile::tempdir().unwrap();
    let deck = |end: &str, edge: &str| {
        format!(
            "units si\natom_style sphere\nlattice sc 0.001\nregion b block 0 {edge} 0 {edge} 0 {edge}{end}\ncreate_box 1 b\n\
             create_atoms 1 box\nset group all diameter 0.001 density 2500\npair_style none\nfix n all nve/sphere\nrun 1\n"
        )
    };
    for printed in both(folder.path(), &deck("", "0.04")) {
        assert!(printed.contains("the box is 0.04 lattice spacings wide"), "{printed}");
        assert!(
            printed.contains("did you mean `units box`?") && printed.contains("in.deck:4:1"),
            "{printed}"
        );
        assert_eq!(printed.matches("lattice spacings wide").count(), 1, "{printed}");
    }
    for (end, edge) in [(" units box", "0.04"), (" units lattice", "0.04"), ("", "4"), ("", "1")] {
        for printed in both(folder.path(), &deck(end, edge)) {
            assert!(!printed.contains("spacings wide"), "{end} {edge}: {printed}");
        }
    }
}

#[test]
fn a_mesh_in_millimetres_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "units si\natom_style sphere\nregion b block 0 1 0 1 0 1 units box\ncreate_box 1 b\n";
    let wall = "fix w all wall/mesh granular hertz/material 1e7 0.5 0.3 tangential linear_nohistory 1 0.5 mesh c.stl";
    for (edge, with, printed) in [
        (700.0, "", Some(("700 times as large as the box", "`scale 0.001`"))),
        (700.0, " scale 0.001", None),
        (5e-5, "", Some(("20000 times as small as the box", "`scale 1000`"))),
        (20.0, "", None),
        (0.01, "", None),
    ] {
        fs::write(folder.path().join("c.stl"), corner_of_cube(edge)).unwrap();
        for line in [format!("region m mesh c.stl units box{with}"), format!("{wall}{with}")] {
            let region = line.starts_with("region");
            for found in both(folder.path(), &format!("{scene}{line}\n{GRAIN}run 0\n")) {
                let Some((size, scale)) = printed else {
                    assert!(!found.contains("as the box"), "{line}: {found}");
                    continue;
                };
                assert!(found.contains(size) && found.contains(scale), "{edge} {region} {line}: {found}");
                assert_eq!(found.matches(size).count(), 1, "{found}");
            }
        }
    }
}

#[test]
fn a_fix_of_an_empty_group_is_named_unless_the_group_fills() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "units si\natom_style sphere\nregion b block 0 1 0 1 0 1 units box\ncreate_box 1 b\n\
                 region far block 0.9 1 0.9 1 0.9 1 units box\ngroup g region far\n";
    let run = |lines: &str| both(folder.path(), &format!("{scene}{GRAIN}{lines}run 1\n"))[1].clone();
    let printed = run("fix f g setforce 0 0 0\n");
    assert!(printed.contains("there is no particle in group `g`: this fix does nothing"), "{printed}");
    for lines in [
        "fix g all gravity 1 vector 0 0 -1\nfix p g pour 1 1 1 region far diam one 0.01\nfix f g setforce 0 0 0\n",
        "fix p g print 1 x screen no\n",
        "group h dynamic all region far\nfix f h setforce 0 0 0\n",
        "fix f all setforce 0 0 0\n",
    ] {
        let printed = run(lines);
        assert!(!printed.contains("no particle in group"), "{lines}{printed}");
    }
}

#[test]
fn spheres_wider_than_the_box_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "units si\natom_style sphere\nregion b block 0 0.04 0 0.04 0 0.04 units box\ncreate_box 1 b\n\
                 create_atoms 1 single 0.02 0.02 0.02 units box\nset group all diameter 0.01 density 2500\npair_style none\n\
                 fix n all nve/sphere\ntimestep 1e-6\n";
    let pictures = "view 60 30 size 16 16";
    for line in [
        format!("write_dump all image x.png type type {pictures}"),
        format!("dump d all image 1 x.*.png type type {pictures}\nrun 1\nrun 1"),
    ] {
        for printed in both(folder.path(), &format!("{scene}{line}\n")) {
            let named = "spheres of diameter 1, as `type` draws them, are 25 times as wide as the box";
            assert!(printed.contains(named) && printed.contains("write `auto`"), "{line}: {printed}");
            assert_eq!(printed.matches(named).count(), 1, "{printed}");
        }
    }
    for line in [
        format!("write_dump all image x.png type auto {pictures}"),
        format!("dump d all image 1 x.*.png type type {pictures}\ndump_modify d adiam 1 0.01\nrun 1"),
    ] {
        for printed in both(folder.path(), &format!("{scene}{line}\n")) {
            assert!(!printed.contains("as wide as the box"), "{line}: {printed}");
        }
    }
}

#[test]
fn a_box_without_volume_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let deck = "units si\nlattice sc 0.001\nregion b block 0 4 0 4 0 1e-308\ncreate_box 1 b\n";
    for printed in both(folder.path(), deck) {
        assert!(
            printed.contains("has no volume that can be computed with") && printed.contains("in.deck:4"),
            "{printed}"
        );
    }
}
