//! Tests of lines as text: what each becomes, and what is refused.

use super::*;
use perigrain_base::diag::{Code, Diagnostics, FileId};

const MATERIAL: &str = "atom_style granular
fix m1 all property/global youngsModulus peratomtype 5.e6
fix m2 all property/global poissonsRatio peratomtype 0.45
fix m3 all property/global coefficientRestitution peratomtypepair 1 0.3
fix m4 all property/global coefficientFriction peratomtypepair 1 0.5
";

/// What stands before the first run.
const LOST: &str = "thermo_modify lost ignore";

/// The native lines of a deck, without comments.
fn native(deck: &str) -> Vec<String> {
    let out = rewrite(deck, FileId(0), Target::Perigrain);
    assert!(!out.problems.has_errors(), "{}", out.problems);
    let shown = |l: &&str| !l.starts_with('#') && !l.is_empty() && *l != LOST;
    out.text.lines().filter(shown).map(String::from).collect()
}

/// The native lines of a deck behind the material.
pub(crate) fn behind(lines: &str) -> Vec<String> {
    native(&format!("{MATERIAL}{lines}"))[1..].to_vec()
}

/// The problems of lines behind the material.
pub(crate) fn wrong(lines: &str) -> Diagnostics {
    rewrite(&format!("{MATERIAL}{lines}"), FileId(0), Target::Perigrain).problems
}

/// The one `pair_coeff` line of a model, with more properties.
pub(crate) fn coefficients(model: &str, more: &str) -> String {
    let lines = behind(&format!("{more}pair_style gran {model}\npair_coeff * *\nrun 1\n"));
    assert_eq!((lines[0].as_str(), lines[2].as_str()), ("pair_style granular", "run 1"));
    lines[1].clone()
}

#[test]
fn the_core_of_a_conveyor_is_as_the_manual_shows_it() {
    let deck = "pair_style gran model hertz tangential history #Hertzian without cohesion
pair_coeff * *
fix cv all mesh/surface file meshes/conveyor.stl type 1 surface_vel -4.5 0. 0.
fix bx all mesh/surface file meshes/box.stl      type 1
fix inface all mesh/surface file meshes/insertion_face.stl type 1
fix wall all wall/gran model hertz tangential history mesh n_meshes 2 meshes bx cv
fix pts1 all particletemplate/sphere 15485863 atom_type 1 density constant 2500 radius constant 0.015
fix pts2 all particletemplate/sphere 15485867 atom_type 1 density constant 2500 radius constant 0.025
fix pdd1 all particledistribution/discrete 32452843 2 pts1 0.3 pts2 0.7
fix ins nve_group insert/stream seed 32452867 distributiontemplate pdd1 &
    maxattempt 100 mass 30. massrate 30. overlapcheck yes vel constant 0. 0. -1.0&
    insertion_face inface extrude_length 0.1
fix ts all check/timestep/gran 1000 0.1 0.1
run 1
dump dmp all custom/vtk 400 post/c_*.vtk id type type x y
";
    assert_eq!(
        behind(deck),
        [
            "pair_style granular",
            "fix cv all surface meshes/conveyor.stl type 1 speed -4.5 0. 0.",
            "fix bx all surface meshes/box.stl type 1",
            "fix inface all surface meshes/insertion_face.stl type 1",
            "fix wall all wall/mesh coeff 1 of bx cv",
            "mixture pdd1 mass 32452843 sphere 1 0.03 2500 0.3 sphere 1 0.05 2500 0.7",
            "fix ins nve_group insert pdd1 stream face inface mass 30. massrate 30. length 0.1 vel 0. 0. -1.0 \
             tries 100 seed 32452867",
            "fix ts all dt/grain 1000 0.1 0.1",
            "pair_coeff 1 1 hertz/material 5.e6 0.3 0.45 damping coeff_restitution tangential mindlin NULL NULL 0.5 \
             slip spring",
            "run 1",
            "dump dmp all vtk 400 post/c_*.vtk id type x y",
        ]
    );
}

#[test]
fn models_become_laws_of_pairs() {
    let hertz = "pair_coeff 1 1 hertz/material 5.e6 0.3 0.45 damping coeff_restitution";
    let history = format!("{hertz} tangential mindlin NULL NULL 0.5 slip spring");
    let roll = "fix r all property/global coefficientRollingFriction peratomtypepair 1 0.1\n";
    let damp =
        format!("{roll}fix v all property/global coefficientRollingViscousDamping peratomtypepair 1 0.2\n");
    let stiff = format!("{damp}fix s all property/global rollingStiffness scalar 1.3\n");
    let stick = "fix c all property/global cohesionEnergyDensity peratomtypepair 1 3.e5\n";
    let quick = "fix v all property/global characteristicVelocity scalar 2.\n";
    for (model, more, wanted) in [
        // The default of `tangential` is off, that of `model` hertz.
        ("model hertz", "", format!("{hertz} tangential none")),
        ("tangential history", "", history.clone()),
        ("model hertz tangential no_history", "", format!("{hertz} tangential linear_nohistory NULL 0.5 slip spring")),
        (
            "model hertz tangential history tangential_damping off",
            "",
            format!("{hertz} tangential mindlin NULL 0 0.5 slip spring"),
        ),
        ("model hertz tangential history limitForce on", "", format!("{history} limit_damping")),
        ("tangential history rolling_friction cdt", roll, format!("{history} rolling cdt 0.1")),
        (
            "tangential history rolling_friction cdt torsionTorque on",
            roll,
            format!("{history} rolling cdt 0.1 full"),
        ),
        ("tangential history rolling_friction epsd", &damp, format!("{history} rolling epsd 0.1 0.2")),
        ("tangential history rolling_friction epsd2", roll, format!("{history} rolling epsd2 0.1")),
        ("tangential history rolling_friction epsd3", &stiff, format!("{history} rolling epsd 0.1 0.2 1.3")),
        ("tangential history cohesion sjkr", stick, format!("{history} cohesion sjkr 3.e5")),
        (
            "tangential history cohesion sjkr2 tangential_reduce on",
            stick,
            format!("{history} cohesion sjkr2 3.e5 reduce"),
        ),
        (
            "model hooke tangential history",
            quick,
            "pair_coeff 1 1 hooke/velocity 5.e6 0.3 0.45 2. damping coeff_restitution tangential linear_history NULL \
             NULL 0.5 slip spring"
                .into(),
        ),
    ] {
        assert_eq!(coefficients(model, more), wanted, "{model}");
    }
}

#[test]
fn stiffnesses_are_numbers() {
    let springs = |gn: &str, gt: &str| {
        format!(
            "fix a all property/global kn peratomtypepair 1 2000.\nfix b all property/global kt peratomtypepair 1 1000.\n\
             fix c all property/global gamman peratomtypepair 1 {gn}\nfix d all property/global gammat peratomtypepair 1 {gt}\n\
             fix e all property/global gamman_abs peratomtypepair 1 {gn}\n\
             fix f all property/global gammat_abs peratomtypepair 1 {gt}\n"
        )
    };
    assert_eq!(
        coefficients("model hertz/stiffness tangential history", &springs("100.", "50.")),
        "pair_coeff 1 1 hertz 2000. 100. damping viscoelastic tangential mindlin 1000. 0.5 0.5 slip spring"
    );
    assert_eq!(
        coefficients("model hooke/stiffness tangential history", &springs("100.", "50.")),
        "pair_coeff 1 1 hooke 2000. 100. damping mass_velocity tangential linear_history 1000. 0.5 0.5 slip spring"
    );
    assert_eq!(
        coefficients("model hooke/stiffness tangential history absolute_damping on", &springs("0.", "2.")),
        "pair_coeff 1 1 hooke 2000. 1e-100 damping velocity tangential linear_history 1000. 2e100 0.5 slip spring"
    );
}

#[test]
fn two_types_have_three_pairs() {
    let deck = "atom_style granular
fix m1 all property/global youngsModulus peratomtype 5e6 6e6
fix m2 all property/global poissonsRatio peratomtype 0.45 0.3
fix m3 all property/global coefficientRestitution peratomtypepair 2 0.1 0.2 0.2 0.3
fix m4 all property/global coefficientFriction peratomtypepair 2 0.4 0.5 0.5 0.6
pair_style gran model hertz tangential history
pair_coeff * *
minimize 1 1 1 1
";
    let tail = "damping coeff_restitution tangential mindlin NULL NULL";
    assert_eq!(
        native(deck)[2..5],
        [
            format!("pair_coeff 1 1 hertz/material 5e6 0.1 0.45 {tail} 0.4 slip spring"),
            format!("pair_coeff 1 2 hertz/material 5e6 0.2 0.45 {tail} 0.5 slip spring material 6e6 0.3"),
            format!("pair_coeff 2 2 hertz/material 6e6 0.3 0.3 {tail} 0.6 slip spring"),
        ]
    );
}

#[test]
fn coefficients_come_anew_when_a_property_has_changed() {
    let lines = behind(
        "pair_style gran tangential history\nrun 1\nrun 1\n\
         fix m4 all property/global coefficientFriction peratomtypepair 1 0.9\nrun 1\n",
    );
    let coeffs: Vec<_> = lines.iter().filter(|l| l.starts_with("pair_coeff")).collect();
    assert_eq!(coeffs.len(), 2);
    assert!(coeffs[1].contains("NULL NULL 0.9 slip"), "{}", coeffs[1]);
}

#[test]
fn walls_lean_on_the_law_of_the_grains() {
    let roll = "fix r all property/global coefficientRollingFriction peratomtypepair 1 0.1\n";
    let pair = format!("{roll}pair_style gran model hertz tangential history rolling_friction cdt\n");
    for (wall, wanted) in [
        (
            "model hertz tangential history rolling_friction cdt primitive type 1 zplane 0.",
            "wall/gran coeff 1 zplane 0. NULL",
        ),
        (
            "model hertz tangential history primitive type 1 xplane -0.05 shear y 2.",
            "wall/gran coeff 1 only normal damping tangential xplane -0.05 NULL shear y 2.",
        ),
        (
            "model hertz primitive type 2 ycylinder 0.03 0.001 0.002",
            "wall/gran coeff 2 only normal damping ycylinder 0.03 0.001 0.002",
        ),
        (
            "model hertz tangential history rolling_friction cdt primitive type 1 zplane 0. store_force yes",
            "wall/gran coeff 1 zplane 0. NULL contacts",
        ),
    ] {
        let lines = behind(&format!("{pair}fix w all wall/gran {wall}\n"));
        assert_eq!(lines[1], format!("fix w all {wanted}"));
    }
    // Above `pair_style` the parts of a wall are all that is known.
    let early = behind("fix w all wall/gran model hertz tangential history primitive type 1 zplane 0.\n");
    assert_eq!(early, ["fix w all wall/gran coeff 1 only normal damping tangential zplane 0. NULL"]);
    let own = behind(&format!(
        "fix v all property/global characteristicVelocity scalar 2.\n{pair}\
         fix w all wall/gran model hooke tangential history primitive type 1 zplane 0.\n"
    ));
    assert!(
        own[1].starts_with("fix w all wall/gran granular hooke/velocity 5.e6 0.3 0.45 2. damping"),
        "{}",
        own[1]
    );
}

#[test]
fn surfaces_are_placed_in_the_order_of_their_words() {
    let lines = behind(
        "fix k all property/global k_finnie peratomtypepair 1 1.5\n\
         fix c all mesh/surface/stress file a.stl type 1 move -50 -250 0 scale 0.002 rotate axis 0 1 0 angle 90 &\n\
         surface_ang_vel origin 0 0 1 axis 0 1 0 omega 5. reference_point 1 2 3 wear finnie heal no curvature 1e-5\n\
         fix m all move/mesh mesh c linear 1 0 0\ndump d all mesh/stl 300 post/dump*.stl\n\
         dump e all mesh/gran/VTK 200 post/m*.vtk stress wear c\nunfix m\n",
    );
    assert_eq!(
        lines,
        [
            "fix c all surface a.stl type 1 shift -50 -250 0 scale 0.002 turn 0 1 0 90 spin 0 0 1 0 1 0 5. about 1 2 3 \
             wear finnie 1.5",
            "fix m all move/mesh mesh c linear 1 0 0",
            "dump d all mesh/stl 300 post/dump*.stl c",
            "dump e all mesh/vtk 200 post/m*.vtk stress wear c",
            "unfix m",
        ]
    );
}

#[test]
fn insertions_keep_their_amounts() {
    let head = "fix p all particletemplate/sphere 1 density constant 2500 radius constant ${r}\n\
                fix d all particledistribution/discrete/numberbased 5 1 p 1.0\n\
                fix f all mesh/surface file f.stl type 1\n";
    for (line, wanted) in [
        (
            "insert/pack seed 7 distributiontemplate d vel constant 0. 0. -0.8 insert_every 2000.0 overlapcheck yes \
             all_in yes particles_in_region 1500 region bc",
            "insert d pack region bc number 1500 every 2000 vel 0. 0. -0.8 seed 7 inside yes",
        ),
        (
            "insert/pack seed 7 distributiontemplate d insert_every once overlapcheck no volumefraction_region ${a} region bc",
            "insert d pack region bc share ${a} seed 7 overlap no",
        ),
        (
            "insert/rate/region seed 7 distributiontemplate d nparticles INF particlerate 1000 insert_every 100 region bc",
            "insert d rate region bc number INF rate 1000 every 100 seed 7",
        ),
        (
            "insert/stream seed 7 distributiontemplate d nparticles 60 massrate 0.2 insert_every 600 duration 300 \
             vel uniform 0 0 -1 0.2 0.2 0.3 insertion_face f",
            "insert d stream face f number 60 massrate 0.2 every 600 during 300 vel 0 0 -1 uniform 0.2 0.2 0.3 seed 7",
        ),
    ] {
        let lines = behind(&format!("{head}fix i all {line}\n"));
        assert_eq!(lines[0], "mixture d number 5 sphere 1 $(2*${r}) 2500 1.0");
        assert_eq!(lines[2], format!("fix i all {wanted}"));
    }
}

#[test]
fn grains_that_leave_the_box_are_deleted_unless_a_line_forbids_it() {
    let text = |deck: &str| rewrite(deck, FileId(0), Target::Perigrain).text;
    let once = text("atom_style granular\nrun 1\nrun 1\n");
    assert_eq!(once.matches(LOST).count(), 1);
    assert_eq!(text("atom_style granular\nthermo_modify lost error\nrun 1\n").matches(LOST).count(), 0);
    // A new step table has its defaults again.
    let again = text("atom_style granular\nthermo_modify lost error\nthermo_style one\nrun 1\n");
    assert_eq!(again.matches(LOST).count(), 1);
}

#[test]
fn old_words_are_those_of_lammps() {
    let deck = "atom_style granular\npair_style gran/hertz/history 266000.0 NULL 500.0 NULL 0.5 1\npair_coeff * *\n\
                fix z all wall/gran 266000.0 NULL 500.0 NULL 0.5 1 zplane 0.0 0.15\n\
                fix i all pour 1000 1 1 vol 0.7 1000 diam 0.003 0.003 dens 2500 2500 region bc\nrun 1\n";
    assert_eq!(
        native(deck)[1..],
        [
            "pair_style gran/hertz/history 266000.0 NULL 500.0 NULL 0.5 1",
            "pair_coeff * *",
            "fix z all wall/gran hertz/history 266000.0 NULL 500.0 NULL 0.5 1 zplane 0.0 0.15",
            "fix i all pour 1000 1 1 vol 0.7 1000 diam range 0.003 0.003 dens 2500 2500 region bc",
            "run 1",
        ]
    );
}

#[test]
fn what_is_missing_is_shown_as_the_line_to_write() {
    let problems = wrong("unfix m4\npair_style gran model hertz tangential history\nrun 1\n");
    assert_eq!(problems.0[0].code, Code::INCOMPLETE);
    assert_eq!(
        problems.0[0].help,
        ["write `fix ID all property/global coefficientFriction peratomtypepair 1 X`"]
    );
}

#[test]
fn wrong_words_have_the_nearest_right_one() {
    for (line, code, help) in [
        ("pair_style gran model herz", Code::UNKNOWN_KEYWORD, "did you mean `hertz`?"),
        ("pair_style gran model hertz limitforce on", Code::UNKNOWN_KEYWORD, "did you mean `limitForce`?"),
        ("pair_style gran tangential history model hertz", Code::WRONG_ORDER, "the order is"),
        ("fix w all wall/gran model hertz mesh n_meshes 1 meshes no", Code::UNKNOWN_FIX, ""),
        (
            "fix a all property/global coefficientFriction peratomtypepair 2 1 2 3 4",
            Code::CONFLICT,
            "a pair has",
        ),
        ("pair_style gran surface superquadric", Code::NO_COUNTERPART, "clumps"),
        ("fix c all couple/cfd couple_every 1 mpi", Code::NO_COUNTERPART, "`fix external`"),
    ] {
        let problems = wrong(&format!("{line}\n"));
        assert_eq!(problems.0[0].code, code, "{line}");
        assert!(help.is_empty() || problems.0[0].help[0].contains(help), "{line}: {:?}", problems.0[0].help);
    }
}

#[test]
fn other_decks_have_no_mark() {
    let deck = "atom_style sphere\nfix w all wall/gran hertz/history 1 NULL 1 NULL 0.5 1 zplane 0 NULL\n\
                fix m all wall/mesh granular hertz 1 1 tangential none mesh a.stl\ndump d all vtk 1 a.vtu id\nrun 1\n";
    assert_eq!(rewrite(deck, FileId(0), Target::Perigrain).text, deck);
    // `compat none` forbids what would be recognised below it.
    let forbidden = format!("compat none\n{MATERIAL}");
    assert_eq!(rewrite(&forbidden, FileId(0), Target::Perigrain).text, forbidden);
}

#[test]
fn lammps_has_numbers_in_the_place_of_null_and_lacks_the_rest() {
    let deck = "atom_style granular
fix m1 all property/global youngsModulus peratomtype 5e6 5e7
fix m2 all property/global poissonsRatio peratomtype 0.45 0.3
fix m3 all property/global coefficientRestitution peratomtypepair 2 0.7 0.5 0.5 0.7
fix m4 all property/global coefficientFriction peratomtypepair 2 0.5 0.5 0.5 0.5
pair_style gran model hertz tangential no_history
fix c all mesh/surface file a.stl type 1
run 1
";
    let out = rewrite(deck, FileId(0), Target::Lammps);
    assert_eq!(out.lost, 1, "{}", out.text);
    assert!(
        out.text
            .contains("# NOT IN LAMMPS: fix c all surface a.stl type 1 (LAMMPS has no walls of triangles)")
    );
    let line = out.text.lines().find(|l| l.starts_with("pair_coeff 1 2")).unwrap();
    let number = |k: usize| line.split_whitespace().nth(k).unwrap().parse::<f64>().unwrap();
    // E* and G* of the two materials from the line's one, by the formulas of two like bodies.
    let (young, nu) = (number(4), number(6));
    let young_star = 1.0 / ((1.0 - 0.45_f64.powi(2)) / 5e6 + (1.0 - 0.09) / 5e7);
    let shear_star = 1.0 / (2.0 * 1.55 * 1.45 / 5e6 + 2.0 * 1.7 * 1.3 / 5e7);
    assert!((young / (2.0 * (1.0 - nu * nu)) / young_star - 1.0).abs() < 1e-12);
    assert!((young / (4.0 * (2.0 - nu) * (1.0 + nu)) / shear_star - 1.0).abs() < 1e-12);
    // x_gamma = 2 sqrt(G*/E*).
    assert!((number(11) / (2.0 * (shear_star / young_star).sqrt()) - 1.0).abs() < 1e-12, "{line}");
}

#[test]
fn mass_flow_writes_no_file_and_nothing_to_the_screen() {
    let mesh = "fix m all mesh/surface file m.stl type 1\n";
    let lines =
        behind(&format!("{mesh}fix f all massflow/mesh mesh m vec_side 0 0 1 screen yes count once\n"));
    assert_eq!(lines.last().unwrap(), "fix f all massflow/mesh mesh m vec_side 0 0 1 count once");
    let d = wrong(&format!("{mesh}fix f all massflow/mesh mesh m vec_side 0 0 1 file f.txt writeTime\n"))
        .to_string();
    assert!(d.contains("a file of the grains that pass"), "{d}");
}

/// Columns stand in LIGGGHTS' order, whatever that of the keywords; the manual's words of 2014 get what LAMMPS added since.
#[test]
fn tables_of_contacts_and_older_computes() {
    let of = |line: &str, rolling: &str| {
        let lines = behind(&format!("pair_style gran model hertz tangential history{rolling}\n{line}\n"));
        lines.last().unwrap().clone()
    };
    assert_eq!(
        of("compute c all pair/gran/local contactArea id delta force", ""),
        "compute c all pair/local id1 id2 crosses forcex forcey forcez area delta cutoff radius"
    );
    let all = of("compute c all pair/gran/local", " rolling_friction epsd2");
    // 25 numbers with three of history, three more for the torque of the rolling spring.
    assert_eq!(all.split_whitespace().count(), 4 + 28 + 2, "{all}");
    assert!(all.contains(" h1 h2 h3 h4 h5 h6 area cutoff"), "{all}");
    assert_eq!(of("compute 2 all erotate", ""), "compute 2 all erotate/sphere");
    assert_eq!(of("compute s all stress/atom virial", ""), "compute s all stress/atom NULL virial");
    assert_eq!(of("compute s all stress/atom", ""), "compute s all stress/atom NULL");
    assert_eq!(of("compute s all stress/atom NULL pair", ""), "compute s all stress/atom NULL pair");
    let d = wrong("compute c all pair/gran/local ids\n").to_string();
    assert!(d.contains("ids"), "{d}");
}
