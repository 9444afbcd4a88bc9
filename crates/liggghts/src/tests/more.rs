//! More tests of lines as text: files of mass flow, tables of contacts on walls, walls of several types, IDs, averages, LAMMPS.

use super::{MATERIAL, behind, wrong};
use crate::{Target, rewrite};
use perigrain_base::diag::{Code, FileId, Severity};

const MESH: &str = "fix m all mesh/surface file m.stl type 1\n";

#[test]
fn mass_flow_writes_files_and_nothing_to_the_screen() {
    let of = |words: &str| {
        behind(&format!("{MESH}fix f all massflow/mesh mesh m vec_side 0 0 1 {words}\n")).pop().unwrap()
    };
    assert_eq!(of("screen yes count once"), "fix f all massflow/mesh mesh m vec_side 0 0 1 count once");
    assert_eq!(
        of("file f.txt writeTime screen no"),
        "fix f all massflow/mesh mesh m vec_side 0 0 1 file f.txt writeTime"
    );
    assert_eq!(of("writeTime"), "fix f all massflow/mesh mesh m vec_side 0 0 1");
}

#[test]
fn a_wall_on_meshes_of_several_types_has_the_law_of_each() {
    let lines = behind(&format!(
        "{MESH}fix n all mesh/surface/planar file n.stl type 2\n\
         pair_style gran model hertz tangential history\n\
         fix w all wall/gran model hertz tangential history mesh n_meshes 2 meshes m n\n\
         compute c all wall/gran/local force id contactPoint\nunfix w\n"
    ));
    assert_eq!(lines[1], "fix n all surface n.stl type 2 planar");
    assert_eq!(lines[3], "fix w all wall/mesh coeff NULL of m n");
    assert_eq!(lines[4], "compute c all wall/local w surface triangle id forcex forcey forcez x1 y1 z1");
}

#[test]
fn a_table_of_contacts_on_walls_needs_the_wall_above() {
    let d = wrong("compute c all wall/gran/local\n").to_string();
    assert!(d.contains("needs a `fix wall/gran … mesh` above it"), "{d}");
    let all = behind(&format!(
        "{MESH}pair_style gran model hertz tangential history rolling_friction epsd2\n\
         fix r all property/global coefficientRollingFriction peratomtypepair 1 0.1\n\
         fix w all wall/gran model hertz tangential history mesh n_meshes 1 meshes m\ncompute c all wall/gran/local\n"
    ));
    // 25 numbers of LIGGGHTS' default with three of history, and three more for the torque of the rolling spring.
    assert_eq!(all.last().unwrap().split_whitespace().count(), 5 + 28, "{all:?}");
}

#[test]
fn an_id_has_one_style_and_a_name_one_line() {
    let again = "fix m4 all property/global coefficientFriction peratomtypepair 1 0.3\n";
    assert!(!wrong(again).has_errors());
    for (line, code, word) in [
        ("fix x all property/global coefficientFriction peratomtypepair 1 0.3", Code::DUPLICATE_NAME, "`m4`"),
        ("fix m4 all nve/sphere", Code::DUPLICATE_NAME, "property/global already"),
        (
            "fix p all nve/sphere\nfix p all particletemplate/sphere 1 density constant 1",
            Code::DUPLICATE_NAME,
            "nve/sphere already",
        ),
    ] {
        let problems = wrong(&format!("{line}\n"));
        let error = problems.0.iter().find(|d| d.severity == Severity::Error).unwrap();
        assert!(error.code == code && error.message.contains(word), "{line}: {problems}");
    }
    // The later distribution of an ID is a line of its own.
    let twice = behind(
        "fix p all particletemplate/sphere 1 density constant 2500 radius constant 0.1\n\
         fix d all particledistribution/discrete 5 1 p 1.0\nfix d all particledistribution/discrete 7 1 p 1.0\n",
    );
    assert_eq!(twice, ["mixture d mass 5 sphere 1 0.2 2500 1.0", "mixture d mass 7 sphere 1 0.2 2500 1.0"]);
}

#[test]
fn a_property_that_was_refused_is_not_missed_again() {
    for line in [
        "fix m4 all property/global coefficientFriction peratomtypepair 2 1 2 3 4",
        "fix m4 all propertie/global coefficientFriction peratomtypepair 1 0.5",
    ] {
        let material: String =
            MATERIAL.lines().filter(|l| !l.starts_with("fix m4")).map(|l| format!("{l}\n")).collect();
        let deck = format!("{material}{line}\npair_style gran model hertz tangential history\nrun 1\n");
        let problems = rewrite(&deck, FileId(0), Target::Perigrain).problems;
        let missing = problems.0.iter().filter(|d| d.code == Code::INCOMPLETE).count();
        assert_eq!(missing, 0, "{problems}");
    }
}

#[test]
fn options_of_a_servo_have_two_names() {
    // All eight change the run in LIGGGHTS 3.8.0.
    let of = |words: &str| behind(&format!("{MESH}fix_modify m {words}\n")).pop().unwrap();
    for (words, native) in [
        ("servo/target_val v_f", "target_val v_f"),
        ("servo/vel_max 0.5 servo/integrate stop", "vel_max 0.5 servo/integrate stop"),
        ("servo/ctrlParam 0.1 0. 0.", "ctrlParam 0.1 0. 0."),
        ("target_val -2. integrate start", "target_val -2. servo/integrate start"),
    ] {
        assert_eq!(of(words), format!("fix_modify m {native}"));
    }
}

#[test]
fn averages_over_bins_are_chunks() {
    let lines = behind(
        "fix a all ave/spatial 10 5 100 z lower 0.01 x 0.0 0.02 vx v_t norm sample file a.txt units box write_ts no ave window 3\nunfix a\n\
         fix l all nve/limit absolute 0.001\n",
    );
    assert_eq!(
        lines,
        [
            "compute a_bins all chunk/atom bin/2d z lower 0.01 x 0.0 0.02 units box",
            "fix a all ave/chunk 10 5 100 a_bins vx v_t norm sample file a.txt ave window 3",
            "unfix a",
            "uncompute a_bins",
            "fix l all nve/limit 0.001",
        ]
    );
    // A grain of 5 mm at 104 m/s: 0.1 R and 0.5 mm give the same 0.5 m/s at a step of 1 ms in LIGGGHTS 3.8.0.
    assert_eq!(behind("fix l all nve/limit radius_ratio 0.1\n"), ["fix l all nve/limit radius 0.1"]);
}

#[test]
fn words_of_forks_are_named() {
    for line in [
        "pair_style gran model hertz/stiffness/viscous",
        "pair_style gran model hertz tangential tan_luding",
        "pair_style gran model hertz viscous on",
        "fix c all mesh/surface/stress/deform file a.stl type 1",
        "fix c all buoyancy level 0 dim z density 1000",
        "fix c all remove nevery 10 massrate 1 style delete seed 1",
        "fix c all particledistribution/discrete/face 1",
        "compute c all nparticles/tracer/region region_count b",
        "dump d all custom/vtm 1 a",
        "dump d all euler/vtk 1 a",
    ] {
        let problems = wrong(&format!("{line}\n"));
        let errors: Vec<_> = problems.0.iter().filter(|d| d.severity == Severity::Error).collect();
        assert!(errors.len() == 1 && errors[0].code == Code::NO_COUNTERPART, "{line}: {problems}");
        assert!(!errors[0].help.is_empty(), "{line}");
    }
}

/// Walls wait for the coefficients below them; what they are about is in LAMMPS' words, the rest is lost with its followers.
#[test]
fn planes_have_the_law_of_their_type_in_lammps() {
    let deck = format!(
        "{MATERIAL}pair_style gran model hertz tangential no_history\npair_coeff * *\n\
         create_atoms 1 single 0 0 0.1\n\
         fix z all wall/gran model hertz tangential no_history primitive type 1 zplane 0.0\n\
         fix c all wall/gran model hertz primitive type 1 zcylinder 0.05 0 0\n\
         fix y all wall/gran model hertz primitive type 1 ycylinder 0.05 0 0\n\
         {MESH}fix mm all move/mesh mesh m linear 0 0 1\nrun 10 # on\nunfix mm\nunfix z\n"
    );
    let out = rewrite(&deck, FileId(0), Target::Lammps);
    let line = |start: &str| {
        out.text.lines().find(|l| l.starts_with(start)).unwrap_or_else(|| panic!("{}", out.text))
    };
    let law = line("pair_coeff 1 1").strip_prefix("pair_coeff 1 1 ").unwrap();
    assert_eq!(line("fix z"), format!("fix z all wall/gran granular {law} zplane 0.0 NULL"));
    let normal = law.split(" tangential").next().unwrap();
    assert_eq!(
        line("fix c"),
        format!("fix c all wall/gran granular {normal} tangential linear_nohistory 0 0 zcylinder 0.05")
    );
    for lost in ["fix y", "fix m ", "fix mm", "unfix mm"] {
        assert!(line(&format!("# NOT IN LAMMPS: {lost}")).ends_with(')'));
    }
    assert!(out.text.contains("comm_modify vel yes\n") && out.text.contains("\nrun 10 # on\n"));
    assert_eq!((out.lost, line("unfix z")), (4, "unfix z"));
}

#[test]
fn what_nothing_inserts_is_named() {
    let mut t = crate::Translator::default();
    let text = "fix p all particletemplate/sphere 1 density constant 1 radius constant 1\n\
                fix q all particletemplate/sphere 1 density constant 1 radius constant 1\n\
                fix d all particledistribution/discrete 5 1 p 1.0\n";
    for raw in perigrain_lang::raw_lines(text, FileId(0)) {
        let (name, args) = raw.words.split_first().unwrap();
        let cmd = perigrain_lang::Command {
            name: name.clone(),
            args: args.to_vec(),
            span: raw.span,
            text: String::new(),
        };
        t.line(&cmd).unwrap();
    }
    let text = t.unused().to_string();
    assert!(text.contains("particletemplate `q` is never inserted"), "{text}");
    assert!(text.contains("particledistribution `d` is never inserted") && !text.contains("`p`"), "{text}");
}
