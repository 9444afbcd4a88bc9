//! How a deck of LIGGGHTS is recognised, and what becomes of its lines.

use super::{perigrain, printed};
use crate::decks::run_with;
use std::fs;

/// A grain above a floor, in words that LAMMPS' old styles have too.
const FALLS: &str = "\
atom_style granular
boundary m m m
newton off
communicate single vel yes
units si
region reg block -0.05 0.05 -0.05 0.05 0. 0.15 units box
create_box 1 reg
neighbor 0.002 bin
pair_style gran/hertz/history 266000.0 NULL 500.0 NULL 0.5 1
pair_coeff * *
timestep 0.00001
create_atoms 1 single 0 0 0.006 units box
set atom 1 density 2500 diameter 0.01 omegax 3. omegaz 20
fix g all gravity 9.81 vector 0.0 0.0 -1.0
fix floor all wall/gran 266000.0 NULL 500.0 NULL 0.5 1 zplane 0.0 0.15
fix integr all nve/sphere
thermo_style custom step atoms ke
thermo 1000.0
run 3000.0
";

/// The same by hand.
const NATIVE: &str = "\
atom_style sphere
boundary m m m
units si
region reg block -0.05 0.05 -0.05 0.05 0. 0.15 units box
create_box 1 reg
neighbor 0.002 bin
pair_style gran/hertz/history 266000.0 NULL 500.0 NULL 0.5 1
pair_coeff * *
timestep 0.00001
create_atoms 1 single 0 0 0.006 units box
set atom 1 diameter 0.01 density 2500 omega 3. 0 20
fix g all gravity 9.81 vector 0.0 0.0 -1.0
fix floor all wall/gran hertz/history 266000.0 NULL 500.0 NULL 0.5 1 zplane 0.0 0.15
fix integr all nve/sphere
thermo_style custom step atoms ke
thermo 1000
run 3000
";

/// The rows of the step table.
fn rows(text: &str) -> Vec<&str> {
    let row = |l: &&str| {
        l.split_whitespace().count() == 3 && l.split_whitespace().all(|w| w.parse::<f64>().is_ok())
    };
    text.lines().filter(row).collect()
}

#[test]
fn a_deck_is_recognised_and_has_the_bits_of_native_lines() {
    let (text, well) = run_with(FALLS, &[]);
    assert!(well, "{text}");
    assert!(text.contains("note[PG0305]: this deck speaks LIGGGHTS (atom_style granular)"), "{text}");
    assert_eq!(text.matches("`communicate` is without effect here").count(), 1);
    let native = run_with(NATIVE, &[]).0;
    assert_eq!(rows(&text).len(), 4);
    assert_eq!(rows(&text), rows(&native));
    assert!(!native.contains("PG0305"));
}

#[test]
fn compat_chooses_whose_words_a_deck_has() {
    let (text, well) = run_with(&format!("compat none\n{FALLS}"), &[]);
    assert!(!well && text.contains("`compat none` does not read: `compat liggghts` does"), "{text}");
    let (text, well) = run_with(FALLS, &["-compat", "lammps"]);
    assert!(!well && text.contains("is a word of LIGGGHTS"), "{text}");
    for (deck, words) in
        [(FALLS.to_string(), &["-compat", "liggghts"][..]), (format!("compat liggghts\n{FALLS}"), &[])]
    {
        let (text, well) = run_with(&deck, words);
        assert!(well && !text.contains("this deck speaks LIGGGHTS"), "{text}");
    }
}

#[test]
fn translate_writes_a_deck_with_the_same_bits() {
    let there = tempfile::tempdir().unwrap();
    fs::write(
        there.path().join("in.falls"),
        FALLS.replace("run 3000.0", "label a\nvariable n loop 3\nrun 1000 # once\nnext n\njump SELF a"),
    )
    .unwrap();
    let out = perigrain(there.path(), &["translate", "in.falls", "-o", "in.native"]);
    assert!(out.status.success(), "{}", printed(&out));
    let new = fs::read_to_string(there.path().join("in.native")).unwrap();
    assert!(new.contains("# LIGGGHTS: atom_style granular\natom_style sphere\n"), "{new}");
    assert!(new.contains("variable n loop 3\n# LIGGGHTS: what lines above mean for a run\nthermo_modify lost ignore\nrun 1000 # once\nnext n\n"), "{new}");
    let both = ["in.falls", "in.native"].map(|deck| {
        let text = printed(&perigrain(there.path(), &["-in", deck, "-log", "none"]));
        rows(&text).into_iter().map(String::from).collect::<Vec<_>>()
    });
    assert!(!both[0].is_empty());
    assert_eq!(both[0], both[1]);
    let out = perigrain(there.path(), &["translate", "in.falls", "-o", "in.falls"]);
    assert_eq!(out.status.code(), Some(2));
}

#[test]
fn a_check_names_each_word_without_counterpart_once() {
    let there = tempfile::tempdir().unwrap();
    let deck = "atom_style granular\nunits si\nregion b block 0 1 0 1 0 1\ncreate_box 1 b\n\
                pair_style gran model hertz surface multicontact\npair_coeff * *\nfix 1 all nve/sphere\n\
                fix x all propert/global k scalar 1\nfix c all couple/cfd couple_every 1 mpi\nfix d all couple/cfd/force\n\
                run 1\n";
    fs::write(there.path().join("in.odd"), deck).unwrap();
    let text = printed(&perigrain(there.path(), &["check", "in.odd"]));
    assert_eq!(text.matches("error[PG0148]").count(), 2, "{text}");
    assert_eq!(text.matches("error[").count(), 3, "{text}");
    assert!(text.contains("or `property/global`, as LIGGGHTS has it?"), "{text}");
}

/// The head of a deck with a material, up to where grains come.
const HEAD: &str = "\
atom_style granular
boundary f f f
newton off
units si
region reg block -0.06 0.06 -0.06 0.06 -0.06 0.06 units box
create_box 1 reg
neighbor 0.002 bin
fix m1 all property/global youngsModulus peratomtype 5.e6
fix m2 all property/global poissonsRatio peratomtype 0.45
fix m3 all property/global coefficientRestitution peratomtypepair 1 0.7
fix m4 all property/global coefficientFriction peratomtypepair 1 0.5
timestep 1e-5
pair_style gran model hertz tangential history
pair_coeff * *
fix p1 all particletemplate/sphere 15485863 atom_type 1 density constant 2500 radius constant 0.002
fix d1 all particledistribution/discrete 32452843 1 p1 1.0
fix n all nve/sphere
";

/// Each mistake with its error's words and its remedy: one error, no follow-ups.
const MISTAKES: &[(&str, &str, &str, &str)] = &[
    (
        "1 0.7",
        "2 0.7 0.6 0.5 0.7",
        "differs for pair 1 2 and pair 2 1: 0.6 and 0.5",
        "write the same number at both places",
    ),
    (
        "fix m1 all property/global youngsModulus peratomtype 5.e6\n",
        "",
        "needs property `youngsModulus`",
        "write `fix ID all",
    ),
    (
        "fix m1 all property/global",
        "fix m1 all propertie/global",
        "unknown fix style `propertie/global`",
        "property/global",
    ),
    ("model hertz", "model jkr", "`jkr`, a law of a fork", "pair_coeff * * jkr"),
    ("model hertz", "model hertz/stiffness/viscous", "`hertz/stiffness/viscous`", "coefficientRestitution"),
    ("tangential history\n", "tangential history surface superquadric\n", "`superquadric`", "clumps"),
    (
        "tangential history\n",
        "tangential history cohesion washino/capillary/viscous\n",
        "liquid bridges",
        "cohesion capillary",
    ),
    ("fix n all", "fix n grains", "there is no group `grains`", "group ID"),
    ("END", "coarsegraining 2", "`coarsegraining`", "larger diameters"),
    ("END", "fix c all couple/cfd couple_every 1 mpi", "a coupling to another program", "fix external"),
    ("END", "fix c all sph/density/continuity", "a fluid of particles", "no fluid"),
    ("END", "fix s all mesh/surface file gone.stl type 1", "`gone.stl` cannot be read", "read as"),
    ("END", "fix s all mesh/surface file odd.stl type 1", "`odd.stl` is no STL file", "read as"),
    ("END", "fix s all mesh/surface/planar file bent.stl type 1", "is not planar", "one flat face"),
    (
        "END",
        "fix s all mesh/surface/planar file flat.stl type 1\nfix i all insert/stream seed 1 distributiontemplate d1 \
         nparticles 10 particlerate 100 vel constant 1 0 0 insertion_face s extrude_length 0.02",
        "do not pass the face `s`",
        "velocity that leads through the face",
    ),
    (
        "END",
        "fix s all mesh/surface/stress/servo file flat.stl type 1 com 0 0 0 ctrlPV force axis 0 0 1 vel_max 1",
        "needs `target_val F`",
        "target_val -300",
    ),
    ("END", "fix m4 all nve/sphere", "fix `m4` is a property/global already", "another ID"),
    ("END", "compute c all wall/gran/local", "needs a `fix wall/gran … mesh` above", "store_force yes"),
];

#[test]
fn a_mistake_has_one_error_with_its_remedy() {
    let there = tempfile::tempdir().unwrap();
    let flat = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/liggghts/flow.stl")).unwrap();
    fs::write(there.path().join("bent.stl"), flat.replace("vertex -0.03 0.03 0", "vertex -0.03 0.03 0.004"))
        .unwrap();
    fs::write(there.path().join("flat.stl"), flat).unwrap();
    fs::write(there.path().join("odd.stl"), "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n").unwrap();
    let fill = "fix i1 all insert/pack seed 32452867 distributiontemplate d1 insert_every once region reg particles_in_region 9\n";
    for (from, to, error, remedy) in MISTAKES {
        let deck = format!("{HEAD}{fill}END\nrun 1\n").replacen(from, to, 1).replace("END\n", "");
        fs::write(there.path().join("in.bad"), deck).unwrap();
        let text = printed(&perigrain(there.path(), &["check", "in.bad"]));
        assert_eq!(text.matches("error[").count(), 1, "{to}: {text}");
        let shown = text.split("error[").nth(1).unwrap();
        assert!(shown.contains(error) && shown.contains(remedy), "{to}: {text}");
    }
    // A template that nothing inserts is no error, and a group that is missing in two lines is one.
    fs::write(there.path().join("in.bad"), format!("{HEAD}{}run 1\n", fill.replace("i1 all", "i1 grains")))
        .unwrap();
    let text = printed(&perigrain(there.path(), &["check", "in.bad"]));
    assert!(text.matches("error[").count() == 1 && !text.contains("never set"), "{text}");
    fs::write(there.path().join("in.bad"), format!("{HEAD}create_atoms 1 single 0 0 0 units box\nrun 1\n"))
        .unwrap();
    let text = printed(&perigrain(there.path(), &["check", "in.bad"]));
    assert!(text.contains("particledistribution `d1` is never inserted"), "{text}");
}

/// A distribution that stands again under its ID counts for the insertions below it.
#[test]
fn a_later_distribution_replaces_the_first() {
    let more = "fix p2 all particletemplate/sphere 15485863 atom_type 1 density constant 2500 radius constant 0.003\n\
                fix d1 all particledistribution/discrete 32452843 1 p2 1.0\n\
                fix i1 all insert/pack seed 32452867 distributiontemplate d1 insert_every once region reg particles_in_region 9\n\
                thermo_style custom step atoms ke\ncompute d all property/atom diameter\ncompute r all reduce max c_d\n\
                run 2\nprint \"widest $(c_r)\"\n";
    let (text, well) = run_with(&format!("{HEAD}{more}"), &[]);
    assert!(well && text.contains("widest 0.006"), "{text}");
}

/// Friction without a spring acts at arms R - d/2, measured: two grains that touch, one step after the setup.
#[test]
fn friction_without_history_has_the_arms_of_the_real_program() {
    let deck = format!(
        "{}create_atoms 1 single 0 0 0.006 units box\ncreate_atoms 1 single 0 0 0.0159 units box\n\
         set group all diameter 0.01 density 2500\nset atom 1 vx 0.01 vz 0.1\n\
         compute f all property/atom fx fz tqy\ncompute r all reduce min c_f[1] c_f[2] c_f[3]\n\
         thermo_style custom step c_r[1] c_r[2] c_r[3]\nthermo_modify format float %.12g\nthermo 1\nrun 1\n",
        HEAD.replace("tangential history", "tangential no_history").replace("1 0.7", "1 0.3")
    );
    let (text, well) = run_with(&deck, &[]);
    assert!(well, "{text}");
    let last: Vec<f64> =
        text.lines().filter_map(super::reading::numbers).rfind(|row| row.len() == 4).unwrap();
    // LIGGGHTS 3.8.0, twelve digits.
    for (own, theirs) in last[1..].iter().zip([-0.00773654714517, -0.303700837858, -3.83072230944e-05]) {
        assert!((own / theirs - 1.0).abs() < 1e-10, "{own} beside {theirs}");
    }
}
