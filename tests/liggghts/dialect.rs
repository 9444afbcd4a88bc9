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
                pair_style gran model hertz surface multicontact\npair_coeff * *\n\
                fix c all couple/cfd couple_every 1 mpi\nfix d all couple/cfd/force\nfix 1 all nve/sphere\n\
                fix x all propert/global k scalar 1\nrun 1\n";
    fs::write(there.path().join("in.odd"), deck).unwrap();
    let text = printed(&perigrain(there.path(), &["check", "in.odd"]));
    assert_eq!(text.matches("error[PG0148]").count(), 2, "{text}");
    assert_eq!(text.matches("error[").count(), 3, "{text}");
    assert!(text.contains("or `property/global`, as LIGGGHTS has it?"), "{text}");
}
