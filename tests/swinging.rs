//! The longest step of bonded particles: `compute dt/critical` and the warning before a run against steps that are just below and
//! just beyond it.

use perigrain::output::log::{Buffer, Log};
use perigrain::session::{Options, Session};

/// Executes a deck; its log, or the error that ended it.
fn run(deck: &str) -> Result<String, String> {
    let screen = Buffer::default();
    let options = Options { log: Log::new(Some(Box::new(screen.clone()))), ..Options::default() };
    let mut session = Session::new(options).unwrap();
    session.run_text("swinging.in", deck).map_err(|e| e.to_string())?;
    Ok(screen.text())
}

/// The text that a deck prints after a word.
fn output_of(log: &str, word: &str) -> f64 {
    let line =
        log.lines().find_map(|line| line.strip_prefix(word)).unwrap_or_else(|| panic!("no {word} in {log}"));
    line.trim().parse().unwrap()
}

/// Spheres of 1 mm on a crooked lattice, joined to their neighbours and hardly moving.
fn body(style: &str, law: &str, more: &str) -> String {
    // Springs of one length at rest have no other place to begin from.
    let off = if law.contains("harmonic") { "1e-9" } else { "1e-4" };
    let mass =
        if style == "bond" { "mass 1 1.0471975512e-6" } else { "set group all diameter 0.001 density 2000" };
    format!(
        "units si\natom_style {style}\nboundary f f f\nlattice sc 0.001\nregion world block -0.1 0.1 -0.1 0.1 -0.1 0.1 units box\n\
         region b block -0.1 3.1 -0.1 2.1 -0.1 1.1\ncreate_box 1 world bond/types 1 extra/bond/per/atom 20\n\
         create_atoms 1 region b\n{mass}\ndisplace_atoms all random {off} {off} {off} 4711 units box\nspecial_bonds lj/coul 0 1 1\n\
         create_bonds many all all 1 0.0007 0.0013\nspecial_bonds lj 0 1 1 coul 1 1 1\n{law}\n\
         velocity all create 1e10 4928 mom no rot no\n{more}"
    )
}

/// The mean kinetic energy of 100 steps, as a multiple of that before; infinite where particles fly out of the box.
fn grows(style: &str, law: &str, fix: &str, dt: f64) -> f64 {
    let more = format!(
        "fix 1 all {fix}\ntimestep {dt:e}\ncompute k all ke\nrun 0\nvariable first equal $(c_k)\n\
         fix m all ave/time 1 100 100 c_k\nrun 100\nprint \"grown $(f_m/v_first)\""
    );
    match run(&body(style, law, &more)) {
        Ok(log) => output_of(&log, "grown"),
        Err(e) => {
            assert!(e.contains("lost") || e.contains("finite"), "{e}");
            f64::INFINITY
        }
    }
}

/// The exact limit is where runs become unstable, and the local one is below it, for every law and with dashpots.
#[test]
fn runs_become_unstable_at_the_limit() {
    let rotational =
        "bond_style bpm/rotational break no smooth no\nbond_coeff 1 5e5 2e5 0.0168 0.0201 1 1 1 1";
    for (style, law, fix) in [
        ("bond", "bond_style harmonic\nbond_coeff 1 2.5e5 1e-3".to_string(), "nve"),
        ("bond", "bond_style bpm/spring break no smooth no\nbond_coeff 1 5e5 0 0".into(), "nve"),
        (
            "bond",
            "bond_style bpm/spring break no smooth no normalize yes\nbond_coeff 1 500 0 0.2".into(),
            "nve",
        ),
        ("bond", "bond_style bpm/spring/plastic break no smooth no\nbond_coeff 1 5e5 0 0 1".into(), "nve"),
        ("bpm/sphere", format!("{rotational} 0 0 0 0"), "nve/bpm/sphere"),
        ("bpm/sphere", format!("{rotational} 0.1 0.1 1e-5 2e-8"), "nve/bpm/sphere"),
        ("bpm/sphere", "bond_style bpm/beam\nbond_coeff 1 1e9 0.2 ratio 0.8".into(), "nve/bpm/sphere"),
        (
            "bpm/sphere",
            "bond_style bpm/beam\nbond_coeff 1 1e9 0.2 ratio 0.8 damping 0.1".into(),
            "nve/bpm/sphere",
        ),
    ] {
        let asked = "compute e all dt/critical bonds exact safety 1\ncompute l all dt/critical safety 1\nfix 1 all nve\n\
                     thermo_style custom step c_e[4] c_l[4] c_e\nrun 0\nprint \"exact $(c_e[4]:%.9g)\"\nprint \"local $(c_l[4]:%.9g)\"\n\
                     print \"scalar $(c_e:%.9g)\"";
        let limits = run(&body(style, &law, asked)).unwrap();
        let [exact, local, scalar] = ["exact", "local", "scalar"].map(|word| output_of(&limits, word));
        assert!(local < exact && local > 0.6 * exact && scalar == exact, "{law}: {local} {exact}");
        let [below, beyond] = [0.97, 1.06].map(|part| grows(style, &law, fix, part * exact));
        // Beside the limit a motion swings 1/√(1 − 0.97²) times as far; beyond it grows to double in each step.
        assert!(below < 20.0 && beyond > 1e6, "{law}: {below} {beyond}");
    }
}

/// A body that breaks nowhere, or whose spheres do not overlap, draws no warning of overlaps; one whose bonds were met before neither.
#[test]
fn overlaps_give_one_warning_where_bonds_break() {
    let law = |strength: &str| {
        format!(
            "pair_style granular\npair_coeff * * hertz/material 1e9 0.9 0.2 tangential mindlin NULL 0.9 0.3 damping coeff_restitution\n\
             bond_style bpm/beam\nbond_coeff 1 1e9 0.2 ratio 0.8 {strength}"
        )
    };
    let warnings = |law: &str| {
        let log =
            run(&body("bpm/sphere", law, "fix 1 all nve/bpm/sphere\ntimestep 1e-9\nrun 1\nrun 1")).unwrap();
        log.matches("would come from nowhere").count()
    };
    assert_eq!([warnings(&law("strength 1e8 1e8")), warnings(&law(""))], [1, 0]);
}
