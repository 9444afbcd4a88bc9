//! What a run, its progress and its tables look like on a terminal: the bytes of a real one.
#![cfg(unix)]

use rexpect::session::{PtySession, spawn_command};
use std::fs;
use std::path::Path;
use std::process::Command;

const PATIENCE: u64 = 60_000;

/// Grains that fall without touching.
const GRAINS: &str = "units si\natom_style sphere\nboundary f f f\nregion box block 0 0.1 0 0.1 0 0.1 units box\ncreate_box 1 box\n\
                      lattice sc 0.025\nregion r block 0.5 3.5 0.5 3.5 0.5 3.5\ncreate_atoms 1 region r\n\
                      set group all diameter 0.004 density 2500\npair_style granular\npair_coeff * * hooke 1e3 0.1 tangential none\n\
                      fix 1 all nve/sphere\nfix 2 all gravity 9.81 vector 0 0 -1\ntimestep 1e-9\nneighbor 0.001 bin\n";

/// The program on a terminal of so many columns, in a folder with this deck.
fn start(folder: &Path, columns: u16, deck: &str, args: &str, env: &[(&str, &str)]) -> PtySession {
    fs::write(folder.join("in.deck"), deck).unwrap();
    let line = format!("stty cols {columns} rows 50 && \"$0\" {args}");
    let mut command = Command::new("sh");
    command.args(["-c", &line, env!("CARGO_BIN_EXE_perigrain")]).current_dir(folder).env("TERM", "xterm");
    command.env_remove("NO_COLOR").envs(env.iter().copied());
    spawn_command(command, Some(PATIENCE)).unwrap()
}

/// All that it shows.
fn shown(folder: &Path, columns: u16, deck: &str, args: &str, env: &[(&str, &str)]) -> String {
    start(folder, columns, deck, args, env).exp_eof().unwrap()
}

const PLAIN: &str = "in.deck -threads 1";

#[test]
fn a_run_ends_in_three_lines_and_setup_says_one_line_each() {
    let folder = tempfile::tempdir().unwrap();
    let deck = format!(
        "{GRAINS}dump d all custom 5 run.dump id x\nrestart 10 run.*.restart\nrun 10\nrun 10\nrun 10 post no\n"
    );
    let text = shown(folder.path(), 100, &deck, PLAIN, &[]);
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    let log = fs::read_to_string(folder.path().join("log.lammps")).unwrap();
    for block in [
        "Loop time of",
        "MPI task timing",
        "Neighbor list builds",
        "Time by op",
        "processor grid",
        "Per MPI rank",
    ] {
        assert!(!text.contains(block) && log.contains(block), "{block}: {text}");
    }
    // The line of setup, and those of LAMMPS in the log.
    let set = "Setting atom values: 27 settings made for diameter, 27 settings made for density";
    assert!(lines.contains(&set) && lines.contains(&"Created 27 atoms"), "{text}");
    assert!(log.contains("Setting atom values ...\n  27 settings made for diameter\n"), "{log}");
    // A forecast before the run, and its end: time and speed, where results are, what would make it faster.
    let memory = lines
        .iter()
        .position(|l| l.starts_with("27 particles, about ") && l.ends_with("kB of memory"))
        .unwrap();
    let end = lines.iter().position(|l| l.starts_with("10 steps in ")).unwrap();
    assert!(
        memory < end && lines[end].contains(" steps/s, ") && lines[end].ends_with(" particle steps/s"),
        "{text}"
    );
    assert_eq!(lines[end + 1], "results: log.lammps, run.dump, run.*.restart");
    assert!(lines[end + 2].starts_with("faster: ") && lines[end + 2].contains(" % goes into "), "{text}");
    // What has been said is not said again.
    let count = |begin: &str| lines.iter().filter(|l| l.starts_with(begin)).count();
    assert_eq!([count("10 steps in "), count("results: "), count("27 particles, ")], [3, 1, 1], "{text}");
}

#[test]
fn a_terminal_that_wants_all_and_a_pipe_have_lammps_blocks() {
    let folder = tempfile::tempdir().unwrap();
    let deck = format!("{GRAINS}run 10\n");
    let full = shown(folder.path(), 100, &deck, "in.deck -threads 1 -screen full", &[]);
    let piped = shown(folder.path(), 100, &deck, "in.deck -threads 1 2> err.txt | cat > out.txt", &[]);
    assert_eq!(piped, "");
    let [out, err] = ["out.txt", "err.txt"].map(|name| fs::read_to_string(folder.path().join(name)).unwrap());
    for block in
        ["Loop time of", "MPI task timing", "Setting atom values ...", "  1 by 1 by 1 MPI processor grid"]
    {
        assert!(full.contains(block) && out.contains(block), "{block}: {full}\n{out}");
    }
    assert!(
        !out.contains('\x1b') && !out.contains('\r') && err.is_empty() && !out.contains("results:"),
        "{out}{err}"
    );
}

#[test]
fn progress_is_that_of_the_whole_deck() {
    let folder = tempfile::tempdir().unwrap();
    // So many runs that each is shorter than the pause between two lines, and all together longer.
    let deck = format!(
        "{GRAINS}thermo 100000\nvariable k loop 500\nlabel again\nrun 300 post no\nnext k\njump SELF again\n"
    );
    let text = shown(folder.path(), 120, &deck, PLAIN, &[]);
    let lines: Vec<&str> = text.split("\x1b[2K").collect();
    let bars: Vec<&&str> = lines.iter().filter(|l| l.contains(" of 150,000 steps, ")).collect();
    assert!(!bars.is_empty(), "{text}");
    let bar = bars[bars.len() - 1].lines().last().unwrap();
    assert!(
        bar.contains(" steps/s, ") && bar.contains(" left  step ") && bar.contains("  dt 1.000e-9"),
        "{bar}"
    );
    let none = ["0/0", " of 0 steps", "of this run"];
    assert!(none.iter().all(|word| !text.contains(word)), "{text}");
    // A loop that asks the clock ends in sight, perhaps earlier.
    let until = "if \"$t < 0.00016 && $(ke) < 1\" then \"jump SELF again\"";
    let deck = format!("{GRAINS}thermo 0\nvariable t equal time\nlabel again\nrun 80000 post no\n{until}\n");
    let text = shown(folder.path(), 120, &deck, PLAIN, &[]);
    assert!(text.contains(" of up to 160,000 steps, "), "{text}");
    // How often a loop comes that hangs on a run nobody knows: the bar is that of the run.
    let deck = format!(
        "{GRAINS}thermo 0\nlabel again\nrun 150000 post no\nif \"$(ke) < 3e-9\" then \"jump SELF again\"\n"
    );
    let text = shown(folder.path(), 120, &deck, PLAIN, &[]);
    assert!(text.contains(" of 150,000 steps") && !text.contains(" of 300,000"), "{text}");
    // A terminal that cannot take a line back gets none.
    let text = shown(folder.path(), 120, &deck, PLAIN, &[("TERM", "dumb")]);
    assert!(!text.contains('\x1b') && text.contains("150,000 steps in "), "{text}");
}

#[test]
fn tables_are_cut_between_columns() {
    let folder = tempfile::tempdir().unwrap();
    let style = "thermo_style custom step temp pe ke etotal press vol v_speed\n";
    let deck = format!("{GRAINS}variable speed equal vcm(all,z)\n{style}thermo 5\nrun 10\n");
    let text = shown(folder.path(), 60, &deck, PLAIN, &[]);
    let log = fs::read_to_string(folder.path().join("log.lammps")).unwrap();
    let whole: Vec<Vec<&str>> = table(&log);
    let cut: Vec<Vec<&str>> = table(&text);
    assert_eq!([whole.len(), cut.len()], [4, 4], "{text}");
    for (whole, cut) in whole.iter().zip(&cut) {
        assert_eq!((whole.len(), cut.len()), (8, 4), "{text}");
        assert_eq!(whole[..4], cut[..]);
    }
    assert!(
        text.contains("(4 more than fit here, in log.lammps alone: TotEng Press Volume v_speed)"),
        "{text}"
    );
    let long = |l: &&str| l.chars().count() > 60 && l.trim_start().starts_with(|c: char| c.is_ascii_digit());
    assert_eq!(table_lines(&text).find(long), None);
}

/// The lines of the step table.
fn table_lines(text: &str) -> impl Iterator<Item = &str> {
    let rows = |l: &&str| {
        let l = l.trim_start();
        l.starts_with("Step ")
            || l.split_whitespace().all(|w| w.parse::<f64>().is_ok()) && !l.trim().is_empty()
    };
    text.lines().filter(rows)
}

fn table(text: &str) -> Vec<Vec<&str>> {
    table_lines(text).map(|l| l.split_whitespace().collect()).collect()
}

#[test]
fn files_of_averages_name_their_columns_and_a_check_notes_lattice_units() {
    let folder = tempfile::tempdir().unwrap();
    let ledger = "compute e all energy/ledger\nvariable q equal step\nfix a all ave/time 1 5 10 c_e[1] v_q c_e[11] file a.txt\n\
                  fix b all ave/time 1 5 10 c_e mode vector file b.txt\n";
    let deck = format!(
        "{GRAINS}velocity all set 0 0 -2 units box\n{ledger}fix m all move linear 0 0 -0.5\nunfix m\nrun 10\n"
    );
    let text = shown(folder.path(), 100, &deck, PLAIN, &[]);
    assert!(text.contains("results: log.lammps, a.txt, b.txt\r\n"), "{text}");
    let head = |file: &str, n| {
        let text = fs::read_to_string(folder.path().join(file)).unwrap();
        text.lines().nth(n).unwrap_or_default().to_string()
    };
    assert_eq!(head("a.txt", 1), "# TimeStep c_e[1] v_q c_e[11]");
    assert_eq!(head("a.txt", 2), "# columns: step c_e[kinetic] v_q c_e[residual]");
    assert!(head("b.txt", 3).starts_with("# rows: kinetic rotational strain contacts "));
    shown(folder.path(), 100, &deck, "in.deck -threads 1 -compat lammps", &[]);
    assert!(head("a.txt", 2).starts_with("10 "));
    // Spacings of 0.025 are no thousandth; of 0.001 they nearly are.
    let deck = deck.replace("lattice sc 0.025", "lattice sc 0.001").replace("unfix m\n", "");
    let text = shown(folder.path(), 100, &deck, "check in.deck", &[("NO_COLOR", "1")]);
    assert!(text.contains("this speed counts in lattice spacings of 1e-3: it is 5e-4"), "{text}");
}

#[test]
fn tables_of_sweeps_are_cut_between_columns_too() {
    let folder = tempfile::tempdir().unwrap();
    let deck = format!(
        "{GRAINS}velocity all set 0 0 -${{v}} units box\nthermo_style custom step ke etotal press vol\nrun 5\n"
    );
    let text = shown(folder.path(), 60, &deck, "sweep in.deck -each v 1.25 2.5 -threads 1", &[]);
    let rows: Vec<&str> = text.lines().filter(|l| l.contains("  ok  ")).collect();
    let csv = fs::read_to_string(folder.path().join("in.deck.sweep/table.csv")).unwrap();
    let numbers: Vec<&str> = csv.split([',', '\n']).collect();
    let table: Vec<&&str> = rows.iter().filter(|l| !l.contains('/')).collect();
    assert_eq!(table.len(), 2, "{text}");
    for row in table {
        let cells: Vec<&str> = row.split_whitespace().collect();
        let seconds = 3;
        assert!(row.trim_end().chars().count() <= 60, "{text}");
        assert!(
            cells.iter().enumerate().all(|(k, c)| k == seconds || k == seconds + 1 || numbers.contains(c)),
            "{row}: {csv}"
        );
    }
    assert!(text.contains(" columns more than fit here: "), "{text}");
}

#[test]
fn colours_are_left_out_where_they_are_not_wanted() {
    let folder = tempfile::tempdir().unwrap();
    let with = shown(folder.path(), 80, "unita si\n", PLAIN, &[]);
    let without = shown(folder.path(), 80, "unita si\n", PLAIN, &[("NO_COLOR", "1")]);
    assert!(with.contains("\x1b[") && with.contains("unknown command"), "{with:?}");
    assert!(!without.contains('\x1b') && without.contains("unknown command `unita`"), "{without:?}");
}

#[test]
fn a_limit_of_time_leaves_a_restart_file() {
    let folder = tempfile::tempdir().unwrap();
    let deck = format!("{GRAINS}thermo 0\nrun 1000000000\nprint \"then $(step)\"\nrun 10\n");
    let text = shown(folder.path(), 100, &deck, "in.deck -threads 1 -timeout 1", &[]);
    let (_, step) = text.split_once("Wall time limit reached at step ").unwrap();
    let step: i64 = step.lines().next().unwrap().trim().parse().unwrap();
    let file = format!("in.deck.{step}.restart");
    assert!(
        text.contains(&format!("  to go on from: {file}")) && text.contains(&format!("then {step}")),
        "{text}"
    );
    assert!(text.contains("The limit of `-timeout` has passed: no further run"), "{text}");
    let fixes = "fix 1 all nve/sphere\nfix 2 all gravity 9.81 vector 0 0 -1\n";
    let rest = format!("read_restart {file}\n{fixes}thermo 0\nrun 10\nprint \"end $(step)\"\n");
    let text = shown(folder.path(), 100, &rest, PLAIN, &[]);
    assert!(text.contains(&format!("Reading restart file {file}: 27 atoms at step {step}\r\n")), "{text}");
    assert!(text.contains(&format!("end {}", step + 10)), "{text}");
    let text = shown(folder.path(), 100, "", "-in in.deck -timeout soon", &[]);
    assert!(text.contains("`soon` is no time") && text.contains("-timeout 23:30:00"), "{text}");
}

#[test]
fn commands_of_the_program_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let pager = [("PAGER", "cat")];
    let text = shown(folder.path(), 80, "", "chekc in.fall", &[]);
    assert!(text.contains("did you mean `perigrain check in.fall`?"), "{text}");
    let text = shown(folder.path(), 80, "", "help fix", &pager);
    assert!(text.contains("\n  fix nve/sphere ") && text.contains("\n  fix wall/gran "), "{text}");
    let text = shown(folder.path(), 80, "", "help wall", &pager);
    assert!(text.contains("\n  fix wall/gran "), "{text}");
    // Pages go through the pager, and their lines break at words.
    let text = shown(folder.path(), 60, "", "help fix", &[("PAGER", "sed s/^/@/")]);
    let lines: Vec<&str> = text.lines().map(|l| l.trim_end().trim_start_matches('@')).collect();
    assert!(text.lines().filter(|l| !l.trim().is_empty()).all(|l| l.starts_with('@')), "{text}");
    assert!(
        lines.iter().any(|l| l.ends_with("Lets the diameter of spheres")) && !text.contains("\x1b"),
        "{text}"
    );
    assert!(lines.iter().filter(|l| l.starts_with("  ")).all(|l| l.chars().count() <= 60), "{text}");
    let deck = "units si\natom_style sphere\npair_style granular hertz/material 1e7 0.5 0.3\n";
    let text = shown(folder.path(), 80, deck, PLAIN, &[("NO_COLOR", "1")]);
    assert!(text.contains("pair_coeff"), "{text}");
    for (args, wanted) in [("examples list", "hopper"), ("completions bash", "complete"), ("man", ".TH")] {
        let text = shown(folder.path(), 80, "", args, &pager);
        assert!(text.contains(wanted), "{args}: {text}");
    }
    let text = shown(folder.path(), 80, "", "new in.mine && exec \"$0\" check in.mine", &[]);
    assert!(text.contains("in.mine"), "{text}");
}
