//! The decks that LAMMPS has run before: the same numbers from perigrain, whatever the layout, the threads or the skipping.

#[path = "lammps/artefacts.rs"]
mod artefacts;

use crate::compare::{Row, Rule, compare, read};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Switches that may change how a result is computed but not what it is.
#[derive(Clone, Copy)]
struct Variant {
    layout: &'static str,
    threads: &'static str,
    rest: &'static str,
    portable: bool,
}

/// What a run leaves: its thermo table and its last dump, as text for bits and as numbers for tolerances.
struct Outcome {
    thermo_lines: Vec<String>,
    dump: String,
    thermo: Vec<Row>,
    state: Vec<Row>,
}

/// The layouts of a deck: only bonds of peridynamics are laid out.
fn layouts(deck: &str) -> &'static [&'static str] {
    let solids = stored(&format!("decks/{deck}.in")).contains("peri/");
    if solids { &["list", "auto"] } else { &["auto"] }
}

fn check(deck: &str) {
    let rules: BTreeMap<String, Rule> = toml::from_str(&stored("tolerances.toml")).unwrap();
    let rule = &rules[deck];
    let last = rule.last.as_deref().unwrap_or(rule);
    let golden = read(&stored(&format!("golden/{deck}.csv")));
    let golden_state = read(&stored(&format!("golden/{deck}.final.csv")));

    let mut by_layout = vec![];
    for &layout in layouts(deck) {
        let first = Variant { layout, threads: "1", rest: "full", portable: false };
        let base = run(deck, first);
        let context = |what: &str| format!("{deck}, layout {layout}, {what}");
        let thermo = compare(&base.thermo, &golden, rule);
        let state = compare(&base.state, &golden_state, last);
        println!(
            "{}: {:?}, final {:?}",
            context("deviation from LAMMPS"),
            thermo.as_ref().ok(),
            state.as_ref().ok()
        );
        assert!(thermo.is_ok(), "{}:\n{}", context("thermo"), thermo.unwrap_err());
        assert!(state.is_ok(), "{}:\n{}", context("final state"), state.unwrap_err());

        // Both at once: where one changes a bit, the other does not change it back.
        let other = run(deck, Variant { threads: "2", rest: "skip", ..first });
        let what = context("2 threads, rest skip: not the same bits as 1 thread, rest full");
        assert!(base.thermo_lines == other.thermo_lines, "{what} (thermo)");
        assert!(base.dump == other.dump, "{what} (dump)");
        // Lists in portable lanes are compared with those of this processor by `families::lanes` of crate `peri`.
        if layout == "auto" {
            let portable = run(deck, Variant { portable: true, ..first });
            agree(&base, &portable, rule, &context("AVX2 path against portable path"));
        }
        by_layout.push(base);
    }
    for pair in by_layout.windows(2) {
        agree(&pair[0], &pair[1], rule, &format!("{deck}, list layout against lattice layout"));
    }
}

/// Two ways to compute one thing agree to ten times the deck's intrinsic noise, at least 1e-11.
fn agree(a: &Outcome, b: &Outcome, rule: &Rule, what: &str) {
    let last = rule.last.as_deref().unwrap_or(rule);
    let near = |r: &Rule| Rule { rtol: (10.0 * r.intrinsic).max(1e-11), ..Rule::default() };
    for (x, y, rule) in [(&a.thermo, &b.thermo, rule), (&a.state, &b.state, last)] {
        if let Err(report) = compare(x, y, &near(rule)) {
            panic!("{what}:\n{report}");
        }
    }
}

fn run(deck: &str, v: Variant) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let text = stored(&format!("decks/{deck}.in"));
    for data in ["data.peri", "data.sphere", "data.hybrid"].into_iter().filter(|data| text.contains(data)) {
        fs::write(folder.path().join(data), stored(&format!("decks/{data}"))).unwrap();
    }
    fs::write(folder.path().join("in.deck"), text).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_perigrain"));
    command.current_dir(folder.path());
    command.args(["-in", "in.deck", "-log", "log.deck", "-screen", "none", "-compat", "lammps/2025"]);
    command.args(["-threads", v.threads, "-layout", v.layout, "-rest", v.rest]);
    command.args(v.portable.then_some("-portable"));
    let output = command.output().unwrap();
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{deck}: {command:?} ended with {}:\n{complaint}", output.status);
    let log = fs::read_to_string(folder.path().join("log.deck")).unwrap();
    let doubted = log.contains("longer than peridynamic bonds allow");
    assert!(!doubted, "{deck}: its time step is stable, whatever the estimate says");
    let dump = fs::read_to_string(folder.path().join(format!("{deck}.final.dump"))).unwrap();
    let thermo_lines = log.lines().filter(|l| is_row(l)).map(String::from).collect();
    Outcome { thermo_lines, thermo: read(&log), state: read(&dump), dump }
}

/// A line of numbers only: timings stand in lines with words.
fn is_row(line: &str) -> bool {
    line.split_whitespace().count() > 1 && line.split_whitespace().all(|w| w.parse::<f64>().is_ok())
}

fn stored(name: &str) -> String {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/lammps").join(name);
    fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

macro_rules! decks {
    ($($name:ident)*) => { $(#[test] fn $name() { check(stringify!($name)); })* };
}

decks! {
    pd_pmb_wave
    pd_pmb_indent
    pd_pmb_tension
    pd_pmb_collide
    pd_pmb_alpha
    pd_pmb_periodic
    pd_pmb_lj_units
    pd_pmb_dtreset
    pd_pmb_laminate
    pd_data
    pd_restart
    pd_lps_wave
    pd_lps_notch
    pd_ves_relax
    pd_eps_tension
    gr2_g_mindlin
    gr2_g_coeffrest
    gr2_g_dmt
    gr2_g_hertz_nohist
    gr2_g_hooke
    gr2_g_jkr
    gr2_g_mindlin_force
    gr2_g_mixed
    gr2_g_rescale
    gr2_g_rescale_force
    gr2_headon
    gr2_hertz_hist
    gr2_hertz_hist_lim
    gr2_hooke
    gr2_hooke_hist
    gran_chute
    gran_drag
    gran_walls
    gran_deposit
    gran_pour
    misc_cgs
    misc_micro
    misc_data_sphere
    misc_restart_gran
    hyb_pmb_granular
    hyb_pmb_hertz
    hyb_respa
    hyb_levels
    misc_data_hybrid
    hyb_lps_multi
    gran_settle
    gran_wall_region
    mdr_pair
    mdr_box
    mdr_die
    bpm_spring
    bpm_rotational
    bpm_wall
    bpm_volume
    bpm_plastic
}

/// A deck without dynamics that matter: its thermo table and the lines it prints.
fn check_table(deck: &str) -> Vec<String> {
    let rules: BTreeMap<String, Rule> = toml::from_str(&stored("tolerances.toml")).unwrap();
    let golden = read(&stored(&format!("golden/{deck}.csv")));
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.deck"), stored(&format!("decks/{deck}.in"))).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_perigrain"));
    command.current_dir(folder.path());
    command.args(["-in", "in.deck", "-log", "log.deck", "-screen", "none", "-compat", "lammps/2025"]);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{deck}: {}", String::from_utf8_lossy(&output.stderr));
    let log = fs::read_to_string(folder.path().join("log.deck")).unwrap();
    let rows = read(&log);
    assert_eq!(rows.len(), golden.len(), "{deck}: rows");
    compare(&rows, &golden, &rules[deck]).unwrap_or_else(|report| panic!("{deck}:\n{report}"));
    log.lines().map(String::from).collect()
}

#[test]
fn misc_script() {
    let log = check_table("misc_script");
    // What LAMMPS 22Jul2025 prints for this deck.
    let printed = ["pass 1 hello 5.000", "first", "pass 2 hello 5.000", "pass 3 hello 7.000"];
    let own: Vec<&str> =
        log.iter().map(String::as_str).filter(|l| l.starts_with("pass ") || *l == "first").collect();
    assert_eq!(own, printed);
}

#[test]
fn misc_lattice() {
    check_table("misc_lattice");
}
