//! Bonds that tire: cycles as powers of loads, the same bits on any number of threads and ranks, restart files.

use super::decks::run_in;

/// A row of 14 points without one of them, along which bonds reach three points far: forces are linear in displacements. `PULL` is how
/// far its right end is drawn, `FATIGUE` what follows.
const ROW: &str = "\
units si
atom_style peri
boundary s s s
lattice sc 1.0e-3
region world block -0.001 0.015 -0.001 0.001 -0.001 0.001 units box
region row block 0 0.0135 0 0.0005 0 0.0005 units box
region hole block 0.0055 0.0065 -1 1 -1 1 units box
region left block -1 0.0014 -1 1 -1 1 units box
region right block 0.0116 1 -1 1 -1 1 units box
create_box 1 world
create_atoms 1 region row
delete_atoms region hole
pair_style peri/pmb
pair_coeff 1 1 3.05e21 3.0151e-3 1.0e3 0.0
set group all density 2440
set group all volume 1.0e-9
peri_modify force newton
group lo region left
group hi region right
fix 1 all nve
fix line all setforce NULL 0 0
fix base lo move linear 0 0 0 units box
fix pull hi move linear PULL 0 0 units box
timestep 1
thermo 1000
statics 1 tol 1.0e-10
FATIGUE
";

/// The same of a notched bar of 14 x 6 x 4 points.
const BAR: &str = "\
units si
atom_style peri
boundary s s s
lattice sc 1.0e-3
region world block -0.001 0.015 -0.001 0.007 -0.001 0.005 units box
region bar block 0 0.0135 0 0.0055 0 0.0035 units box
region notch block 0.0065 0.0075 -1 0.0024 -1 1 units box
region left block -1 0.0014 -1 1 -1 1 units box
region right block 0.0116 1 -1 1 -1 1 units box
create_box 1 world
create_atoms 1 region bar
delete_atoms region notch
LAW
set group all density 2440
set group all volume 1.0e-9
peri_modify force newton
group lo region left
group hi region right
fix 1 all nve
fix base lo move linear 0 0 0 units box
fix pull hi move linear 1.0e-6 0 0 units box
timestep 1
thermo 1000
statics 1
";
const PMB: &str = "pair_style peri/pmb\npair_coeff 1 1 3.05e21 3.0151e-3 1.0 0.0";
const LPS: &str = "pair_style peri/lps\npair_coeff 1 1 4.4e10 3.0e10 3.0151e-3 1.0 0.0";

/// The rows of the file `lives` that a deck writes, and its text.
fn lives(deck: &str, words: &[&str]) -> (Vec<Vec<f64>>, String) {
    let folder = tempfile::tempdir().unwrap();
    let (text, well) = run_in(folder.path(), deck, words);
    assert!(well, "{text}");
    let file = std::fs::read_to_string(folder.path().join("lives")).unwrap();
    let rows = file.lines().filter(|line| !line.starts_with('#'));
    let numbers = |line: &str| line.split_whitespace().map(|word| word.parse().unwrap()).collect();
    (rows.map(numbers).collect(), file)
}

fn row(pull: &str, fatigue: &str) -> Vec<Vec<f64>> {
    lives(&ROW.replace("PULL", pull).replace("FATIGUE", fatigue), &[]).0
}

/// With twice the load, and with R = 1/2 the other way round, cycles at every break differ by 2^m. Balance to 1e-10 of the loads and
/// stretches of 1e-4 with 13 digits leave 1e-9.
#[test]
fn cycles_go_as_a_power_of_the_load() {
    for (m, factor) in [(3, 8.0), (4, 16.0)] {
        let line = |ratio: &str| {
            format!("fatigue init 1e9 {m} 0 grow 1e9 {m} cycles 1e20 batch 0 {ratio} tol 1e-10 file lives")
        };
        let once = row("1.0e-6", &line(""));
        let twice = row("2.0e-6", &line(""));
        let half = row("1.0e-6", &line("ratio 0.5"));
        let broken = once.last().unwrap()[3];
        // Three bonds reach over the missing point.
        assert!(once.len() == 4 && broken == 3.0, "{once:?}");
        assert_eq!((once.len(), once.len()), (twice.len(), half.len()));
        for ((once, twice), half) in once.iter().zip(&twice).zip(&half).filter(|((row, _), _)| row[2] > 0.0) {
            // Which bonds break is the same.
            assert_eq!((&once[1..4], &once[1..4]), (&twice[1..4], &half[1..4]));
            assert!((once[0] / twice[0] / factor - 1.0).abs() < 1e-9, "{m}: {once:?} {twice:?}");
            assert!((half[0] / once[0] / factor - 1.0).abs() < 1e-9, "{m}: {once:?} {half:?}");
        }
        // Torn apart: the rest of the cycles pass.
        assert_eq!(once.last().unwrap()[0], 1e20);
    }
}

/// Below E1 nothing tires; with A1 = 0 no crack begins.
#[test]
fn small_ranges_leave_no_trace() {
    for line in
        ["init 1e9 3 1e-2 grow 1e9 3", "init 0 3 0 grow 1e9 3", "init 1e9 3 1e-4 grow 1e9 3 ratio 0.9999"]
    {
        let rows = row("1.0e-6", &format!("fatigue {line} cycles 1e6 file lives"));
        assert_eq!(rows.len(), 1, "{rows:?}");
        assert_eq!((rows[0][0], rows[0][3]), (1e6, 0.0));
    }
}

/// A crack that grows from a notch leaves the same file on any number of threads and ranks, and on lists breaks as many bonds at the
/// same cycles: equilibria are found to 1e-6, of which m = 4 makes some 1e-5.
#[test]
fn threads_and_ranks_leave_the_same_bits() {
    for law in [PMB, LPS] {
        let line = "fatigue init 1e9 4 0 grow 1e10 4 cycles 1e30 batch 0.05 most 8 file lives\n";
        let deck = BAR.replace("LAW", law) + line;
        let (rows, one) = lives(&deck, &["-threads", "1"]);
        assert!(rows.len() == 8 && rows.last().unwrap()[3] > 20.0, "{one}");
        assert_eq!(one, lives(&deck, &["-threads", "3"]).1);
        assert_eq!(one, lives(&deck, &["-ranks", "3", "-threads", "1"]).1);
        let listed = lives(&deck, &["-threads", "1", "-layout", "list"]).0;
        for (a, b) in rows.iter().zip(&listed) {
            assert_eq!(a[1..4], b[1..4], "{law}");
            assert!((a[0] / b[0] - 1.0).abs() < 1e-4, "{a:?} {b:?}");
        }
    }
}

/// Lives come with restart files: cycles behind one are those of the run that was not cut.
#[test]
fn lives_come_with_restart_files() {
    let folder = tempfile::tempdir().unwrap();
    let line = "fatigue init 1e9 4 0 grow 1e10 4 cycles 1e30 most 4 file";
    let deck = BAR.replace("LAW", PMB) + &format!("{line} first\nwrite_restart half\n{line} lives\n");
    let (text, well) = run_in(folder.path(), &deck, &[]);
    assert!(well, "{text}");
    let went_on = std::fs::read_to_string(folder.path().join("lives")).unwrap();
    let again = "read_restart half\nregion left block -1 0.0014 -1 1 -1 1 units box\nfix 1 all nve\nfix base lo move linear 0 0 0 units box\n\
                 fix pull hi move linear 1.0e-6 0 0 units box\ntimestep 1\nthermo 1000\n";
    let (text, well) = run_in(folder.path(), &format!("{again}{line} lives\n"), &[]);
    assert!(well, "{text}");
    assert_eq!(went_on, std::fs::read_to_string(folder.path().join("lives")).unwrap());
}

#[test]
fn lines_that_lack_something_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (line, wanted) in [
        ("fatigue", "`fatigue` needs `init A1 m1 E1`"),
        ("fatigue init 1 3 0 grow 1 3", "needs `cycles N`"),
        ("fatigue init 1 3 0 cycles 10", "needs `grow A2 m2`"),
        ("fatigue init 1 3 0 grow 1 3 cycles 0", "the number of cycles"),
        ("fatigue init 1 3 0 grow 1 3 cycles 10 ratio 1", "the ratio of loads must be below 1"),
        ("fatigue init -1 3 0 grow 1 3 cycles 10", "init A1"),
        ("fatigue init 1 3 0 grow 1 3 cycles 10 batch 2", "between 0 and 1"),
        ("fatigue init 1 3 0 grow 1 3 cycles 10 loads 1 2", "loads"),
        ("fatigue init 1 3 0 grow 1 3 cycles 10 most 1", "the most equilibria"),
        ("fix h all langevin 1 1 1 1\nfatigue init 1 3 0 grow 1 3 cycles 10", "fix langevin cannot act"),
    ] {
        let (text, well) = run_in(folder.path(), &ROW.replace("PULL", "1e-6").replace("FATIGUE", line), &[]);
        assert!(!well && text.contains(wanted), "{line}: {text}");
    }
}

/// A crack that was cut between two layers takes less than half of the families beside it: it grows by `grow` where `cracked` says so.
#[test]
fn a_crack_that_was_cut_grows_where_less_of_a_family_counts() {
    let cut = "region cut block INF INF INF 0.0029 INF INF units box\nperi_crack plane 0.0065 0 0 1 0 0 region cut units box\nstatics 1\n";
    let whole = BAR.replace("delete_atoms region notch\n", "").replace("statics 1\n", cut);
    let broken = |words: &str| {
        let line = format!("fatigue init 0 4 0 grow 1e10 4 cycles 1e30 most 4 {words} file lives\n");
        let deck = whole.replace("LAW", PMB) + &line;
        lives(&deck, &[]).0.last().unwrap()[3]
    };
    assert_eq!(broken(""), 0.0);
    assert!(broken("cracked 0.3") > 0.0);
}

/// What a fix halts with `error continue` ends as other lines do: the deck continues.
#[test]
fn a_line_that_a_fix_halts_is_not_the_last_one() {
    let folder = tempfile::tempdir().unwrap();
    let halted = "variable n equal step\nfix h all halt 1 v_n >= 3 error continue message no\n\
                  fatigue init 1e9 4 0 grow 1e10 4 cycles 1e30 most 8\nprint \"behind $(step)\"\n";
    let (text, well) = run_in(folder.path(), &(BAR.replace("LAW", PMB) + halted), &[]);
    assert!(well && text.contains("behind 3"), "{text}");
}
