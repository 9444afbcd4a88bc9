//! Tests of lines about grains of several spheres and about regions.

use super::*;
use perigrain_base::diag::{Diagnostics, FileId, Severity};

/// The native lines of a deck, without comments; what stands before a run is left out.
fn native(deck: &str) -> Vec<String> {
    let out = rewrite(&format!("atom_style granular\n{deck}"), FileId(0), Target::Perigrain);
    assert!(!out.problems.has_errors(), "{}", out.problems);
    let shown = |l: &&str| !l.starts_with('#') && !l.is_empty();
    out.text.lines().skip(2).filter(shown).map(String::from).collect()
}

fn wrong(deck: &str) -> Diagnostics {
    rewrite(&format!("atom_style granular\n{deck}"), FileId(0), Target::Perigrain).problems
}

const STONE: &str =
    "fix pts1 all particletemplate/multisphere 15485863 atom_type 1 density constant 2500 nspheres 50 &
    ntry 1000000 spheres file data/stone1.multisphere scale 0.001 type 1
";

#[test]
fn a_multisphere_is_a_clump_that_a_rigid_fix_moves() {
    let deck = format!(
        "{STONE}fix pdd1 all particledistribution/discrete 15485867 1 pts1 1.0
fix ins all insert/pack seed 32452843 distributiontemplate pdd1 vel constant 0. 0. -1. insert_every once overlapcheck yes &
    orientation random region bc volumefraction_region 0.0004
fix integr all multisphere
compute 1 all erotate/multisphere
compute 2 all rigid property inertia
dump d all custom 1 f id id_multisphere x
"
    );
    assert_eq!(
        native(&deck),
        [
            "fix pts1_mol all property/atom mol",
            "clump pts1 1 file data/stone1.multisphere scale 0.001 count 50",
            "mixture pdd1 mass 15485867 mol pts1 2500 1.0",
            "fix ins all insert pdd1 pack region bc share 0.0004 vel 0. 0. -1. seed 32452843 orientation random",
            "fix integr all rigid/small molecule mol pts1",
            "neigh_modify exclude molecule/intra all",
            "compute 1 all erotate/rigid integr",
            "compute 2 all rigid/local integr inertiax inertiay inertiaz",
            "dump d all custom 1 f id mol x",
        ]
    );
}

#[test]
fn spheres_mass_and_inertia_may_stand_in_the_line() {
    let with = |more: &str| {
        native(&format!(
            "fix p all particletemplate/multisphere 1 density constant 2600 nspheres 2 ntry 10 spheres 0 0 0 1 1 0 0 1 type 1 {more}
fix d all particledistribution/discrete 7 1 p 1.0\n"
        ))
    };
    let lines = with("mass 2 inertia_tensor 1 12 13 2 23 3 use_density");
    assert_eq!(lines[1], "clump p 1 spheres 0 0 0 1 1 0 0 1 mass 2 com 0 0 0 inertia 1 2 3 12 13 23");
    assert_eq!(lines[2], "mixture d mass 7 mol p 2600 1.0");
    assert_eq!(with("mass 2 inertia_tensor 1 12 13 2 23 3 use_volume")[2], "mixture d mass 7 mol p NULL 1.0");
    let out = wrong(
        "fix p all particletemplate/multisphere 1 nspheres 2 ntry 10 spheres 0 0 0 1 1 0 0 1 type 1 mass 2\n",
    );
    assert!(out.to_string().contains("lacks `inertia_tensor`"), "{out}");
}

#[test]
fn what_multispheres_cannot_do_is_refused_by_name() {
    for (line, word) in [
        (format!("{} fflag on off on\n", STONE.trim_end()), "fflag"),
        (format!("{STONE}fix ms all multisphere CAddRhoFluid 0.5 1000\n"), "CAddRhoFluid"),
        (format!("{STONE}fix ms all multisphere\nfix_modify ms tflag on on off\n"), "tflag"),
        (format!("{STONE}fix ms all multisphere\ncompute 1 all rigid property ex_space\n"), "ex_space"),
        ("compute 1 all ke/multisphere\n".to_string(), "ke/multisphere"),
        (
            format!("{STONE}fix ms all multisphere\n{}", STONE.replace("pts1", "pts2")),
            "below the fix multisphere",
        ),
        ("fix ms all multisphere\nrun 1\n".to_string(), "particletemplate/multisphere"),
    ] {
        let out = wrong(&line);
        let errors = out.0.iter().filter(|d| d.severity == Severity::Error).count();
        assert!(errors == 1 && out.to_string().contains(word), "{line}: {out}");
    }
}

#[test]
fn a_fix_above_its_templates_waits_for_them() {
    let lines = native(&format!("fix ms all multisphere\n{STONE}{}run 1\n", STONE.replace("pts1", "pts2")));
    assert_eq!(lines[3], "fix ms all rigid/small molecule mol pts1 mol pts2");
    assert_eq!(lines[4], "neigh_modify exclude molecule/intra all");
}

#[test]
fn tetrahedra_are_shifted_scaled_and_turned() {
    let deck = "region m mesh/tet file t.vtk scale 2. move 1. 0. -3. rotate 0. 30. 50. units box side out\n\
                region n mesh/tet file t.vtk scale 1. move 0. 0. 0. rotate 0. 0. 0. units box\n";
    assert_eq!(
        native(deck),
        [
            "region m mesh t.vtk scale 2. shift 2 0 -6 turn 0 1 0 30. turn 0 0 1 50. units box side out",
            "region n mesh t.vtk scale 1. units box",
        ]
    );
    assert!(wrong("region m mesh/tet scale 2.\n").to_string().contains("lacks `file FILE`"));
}

#[test]
fn wedges_are_intersections() {
    let wedge =
        |words: &str| native(&format!("region w wedge axis y center 1 2 radius 3 bounds 0 4 {words}\n"));
    assert_eq!(
        wedge("angle0 0 angle 90 units box side out"),
        [
            "region w_cylinder cylinder y 2 1 3 0 4 units box",
            "region w_begin plane 2 0 1 1 0 0 units box",
            "region w_end plane 2 0 1 -0.00000000000000006123233995736766 0 1 units box",
            "region w intersect 3 w_cylinder w_begin w_end side out",
        ]
    );
    assert_eq!(
        wedge("angle0 10 angle 200")[3..],
        ["region w_sides union 2 w_begin w_end", "region w intersect 2 w_cylinder w_sides"]
    );
    assert_eq!(wedge("angle0 10 angle 360 side out"), ["region w cylinder y 2 1 3 0 4 side out"]);
    assert!(wrong("region w wedge axis y center 1 2 radius 3 bounds 0 4 angle0 0 angle 0\n").has_errors());
    // What a variable gives becomes a formula.
    let open = native(
        "variable a equal 20\nregion w wedge axis z center 0 0 radius 3 bounds 0 4 angle0 ${a} angle 45\n",
    );
    assert!(open[2].contains("$(-sin(v_a*PI/180))") && open[3].contains("$(sin("), "{open:?}");
}
