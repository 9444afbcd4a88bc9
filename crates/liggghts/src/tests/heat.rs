//! Tests of lines about heat as text.

use super::{behind, wrong};

/// Materials and temperatures.
const WARM: &str = "fix h1 all property/global thermalConductivity peratomtype 100.
fix h2 all property/global thermalCapacity peratomtype 10.
fix hg all heat/gran initial_temperature 300.
";

/// What `WARM` becomes.
const NATIVE: [&str; 7] = [
    "fix Temp all property/atom temperature initial 300.",
    "fix heatFlux all property/atom heatflow",
    "fix heatSource all property/atom d_heatSource",
    "compute f_Temp all property/atom temperature",
    "compute f_heatFlux all property/atom heatflow",
    "compute f_heatSource all property/atom d_heatSource",
    "fix hg all heat/flow constant 10. source d_heatSource",
];

const HERTZ: &str = "pair_coeff 1 1 hertz/material 5.e6 0.3 0.45 damping coeff_restitution tangential none";

/// The native lines of a deck with heat, behind those of `WARM`.
fn warm(lines: &str) -> Vec<String> {
    let all = behind(&format!("pair_style gran model hertz\n{WARM}{lines}"));
    assert_eq!(all[1..8], NATIVE);
    all[8..].to_vec()
}

#[test]
fn contacts_conduct_and_grains_have_temperatures() {
    assert_eq!(warm("run 1\n"), [format!("{HERTZ} heat contact 100."), "run 1".into()]);
    let none = warm("unfix hg\nrun 1\n");
    assert_eq!(none, ["unfix hg", HERTZ, "run 1"]);
    // A property that changes later changes the fix and the coefficients.
    let again = warm("run 1\nfix h2 all property/global thermalCapacity peratomtype 20.\nrun 1\n");
    assert_eq!(again[2], "fix hg all heat/flow constant 20. source d_heatSource");
    assert_eq!(again[3..], [format!("{HERTZ} heat contact 100."), "run 1".into()]);
}

#[test]
fn references_and_set_are_native() {
    assert_eq!(
        warm(
            "dump d all custom 1 f id f_Temp[0] f_heatFlux[0]\nvariable t atom f_Temp*2\ncompute a all reduce ave f_Temp[0]\n\
             set region half property/atom Temp 800. property/peratom heatSource 1.5\nset atom 1 property/atom heatFlux 3\n\
             set atom 1 density 5 diameter 2 property/atom own 4\n"
        ),
        [
            "dump d all custom 1 f id c_f_Temp c_f_heatFlux",
            "dump_modify d colname c_f_Temp f_Temp[0]",
            "dump_modify d colname c_f_heatFlux f_heatFlux[0]",
            "variable t atom c_f_Temp*2",
            "compute a all reduce ave c_f_Temp",
            "set region half temperature 800. d_heatSource 1.5",
            "set atom 1 diameter 2 density 5 d_own 4",
        ]
    );
    // Without temperatures these are any other names.
    assert_eq!(behind("variable t equal f_Temp[0]\n"), ["variable t equal f_Temp[0]"]);
}

#[test]
fn walls_have_heat_with_a_temperature() {
    let walls = "fix w all wall/gran model hertz primitive type 1 zplane 0.0 temperature 800.
fix s all mesh/surface file a.stl type 1 temperature 500.
fix v all wall/gran model hertz mesh n_meshes 1 meshes s
";
    assert_eq!(
        warm(walls),
        [
            "fix w all wall/gran coeff 1 zplane 0.0 NULL temperature 800.",
            "fix s all surface a.stl type 1 temperature 500.",
            "fix v all wall/mesh coeff 1 of s",
        ]
    );
    // A wall with a part of the law has heat where it is warm.
    let only = behind(&format!("pair_style gran model hertz tangential history\n{walls}"));
    assert_eq!(
        only[1],
        "fix w all wall/gran coeff 1 only normal damping heat zplane 0.0 NULL temperature 800."
    );
    assert_eq!(only[3], "fix v all wall/mesh coeff 1 only normal damping heat of s");
    // And one with a law of its own, which needs the conductivity.
    let own =
        "fix w all wall/gran model hertz tangential history primitive type 1 zplane 0.0 temperature 800.\n";
    assert!(
        warm(own)[0].ends_with("slip spring heat contact 100. arms middle zplane 0.0 NULL temperature 800.")
    );
    let text = wrong(&format!("pair_style gran model hertz\n{own}")).to_string();
    assert!(text.contains("stands above `fix heat/gran`"), "{text}");
}

#[test]
fn areas_of_contact() {
    let two = "fix m1 all property/global youngsModulus peratomtype 5.e6 9.e6
fix m2 all property/global poissonsRatio peratomtype 0.45 0.3
fix m3 all property/global coefficientRestitution peratomtypepair 2 0.3 0.3 0.3 0.3
fix h1 all property/global thermalConductivity peratomtype 100. 30.
fix h2 all property/global thermalCapacity peratomtype 10. 25.
fix h3 all property/global youngsModulusOriginal peratomtype 5.e8 2.e9
";
    let law = |model: &str, words: &str| {
        let deck = format!(
            "{two}pair_style gran model {model}\nfix hg all heat/gran/conduction initial_temperature 300. {words}\n"
        );
        let lines = behind(&format!("{deck}run 1\n"));
        assert_eq!(lines[7], "fix hg all heat/flow type 10. 25. source d_heatSource");
        lines[8..11].iter().map(|l| l.split_once(" heat ").unwrap().1.to_string()).collect::<Vec<_>>()
    };
    // 2 100 30/130.
    let mixed = 2.0 * 100.0 * 30.0 / 130.0;
    let plain =
        ["contact 100.".to_string(), format!("contact {mixed} material 9.e6 0.3"), "contact 30.".into()];
    assert_eq!(law("hertz", ""), plain);
    assert_eq!(law("hertz", "contact_area overlap area_correction no store_contact_data no"), plain);
    assert_eq!(law("hertz", "contact_area constant 1e-6")[0], "contact 100. area constant 1e-6");
    assert_eq!(law("hertz", "contact_area projection")[2], "contact 30. area projection");
    let factor = |model: &str, k: usize| {
        let words = law(model, "area_correction yes")[k].clone();
        words.split_once(" scaled ").unwrap().1.split(' ').next().unwrap().parse::<f64>().unwrap()
    };
    assert!((factor("hertz", 0) - 0.01_f64.powf(2.0 / 3.0)).abs() < 1e-15);
    assert!((factor("hertz", 2) - 0.0045_f64.powf(2.0 / 3.0)).abs() < 1e-15);
    // 1/Y* = 0.7975/5e6 + 0.91/9e6 and the same of the originals.
    let both: f64 = (0.7975 / 5e8 + 0.91 / 2e9) / (0.7975 / 5e6 + 0.91 / 9e6);
    assert!((factor("hertz", 1) - both.powf(2.0 / 3.0)).abs() < 1e-15);
    let hooke = law("hertz", "area_correction yes");
    assert!(hooke[1].ends_with(" material 9.e6 0.3"), "{hooke:?}");
}

#[test]
fn values_of_variables_stay_formulas() {
    let lines = behind(
        "fix h1 all property/global thermalConductivity peratomtype ${k}\nfix h2 all property/global thermalCapacity peratomtype ${c}\n\
         fix h3 all property/global youngsModulusOriginal peratomtype ${y}\npair_style gran model hertz\n\
         fix hg all heat/gran initial_temperature ${t} area_correction yes\nrun 1\n",
    );
    assert_eq!(lines[1], "fix Temp all property/atom temperature initial ${t}");
    assert_eq!(lines[7], "fix hg all heat/flow constant ${c} source d_heatSource");
    let sum = |y: &str| format!("(1-(0.45)^2)/({y})+(1-(0.45)^2)/({y})");
    let factor = format!("$((({})/({}))^(2/3))", sum("v_y"), sum("5.e6"));
    assert_eq!(lines[8], format!("{HERTZ} heat contact ${{k}} scaled {factor}"));
}

#[test]
fn what_is_wrong_with_heat_is_named() {
    for (line, text) in [
        ("fix hg all heat/gran\n", "lacks `initial_temperature T`"),
        (
            "fix hg all heat/gran initial_temperature 300. area\n",
            "unknown keyword of fix heat/gran of LIGGGHTS: `area`",
        ),
        (
            "fix hg all heat/gran initial_temperature 300. contact_area projection area_correction yes\n",
            "`area_correction` is for `contact_area overlap`",
        ),
        ("fix hg all heat/gran initial_temperature 300. store_contact_data yes\n", "columns of contacts"),
        (
            "fix hg all heat/gran/radiation initial_temperature 300.\n",
            "heat that does not flow through contacts",
        ),
    ] {
        let found = wrong(&format!("{WARM}unfix hg\n{line}")).to_string();
        assert!(found.contains(text), "{line}: {found}");
    }
    let found = wrong("fix hg all heat/gran initial_temperature 300.\n").to_string();
    assert!(found.contains("needs property `thermalCapacity`"), "{found}");
}
