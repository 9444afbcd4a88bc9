//! Output of a run, its progress and its tables on a real terminal, byte by byte.
//!
//! The claims about the terminal, and the test for each, which reads the bytes of a pseudo-terminal:
//!
//! | claim | test |
//! |---|---|
//! | progress is that of the whole deck, over loops around `run` | `progress_is_that_of_the_whole_deck` |
//! | a loop that reads the clock ends in sight; where the end is unknown, the bar is that of the run | the same |
//! | nothing is drawn while the scene is built | `the_line_shows_progress_and_time_left` |
//! | the step in the line is the present one | the same |
//! | time left is learnt from the run, and never 0 s | the same |
//! | the line fits a window that changes its size | `a_window_may_change_its_size` |
//! | memory is forecast before the run | `a_run_ends_in_three_lines_and_setup_prints_one_line_each` |
//! | a run ends in three lines: time and speed, where results are, what would make it faster | the same |
//! | setup says what it made in one line each | the same |
//! | LAMMPS' blocks stay in `log.lammps` | the same |
//! | LAMMPS' blocks under `-screen full`, and in pipes | `a_terminal_that_wants_all_and_a_pipe_have_lammps_blocks` |
//! | no bar where there is no terminal | the same |
//! | no bar on a terminal that cannot take a line back | `progress_is_that_of_the_whole_deck` |
//! | a limit of wall time, with a last restart file | `a_limit_of_time_leaves_a_restart_file` |
//! | `NO_COLOR` | `colours_are_left_out_where_they_are_not_wanted` |
//! | tables are cut by columns, never within a number | `tables_are_cut_between_columns`, `tables_of_sweeps_…` |
//! | rows have the columns of their heading | `rows_have_the_columns_of_their_heading` |
//! | lines of the program break between words | `lines_of_its_own_break_between_words` |
//! | files of averaged vectors name their columns | `files_of_averages_name_their_columns_and_…` |
//! | `check` notes speeds in lattice units a thousandth of others | the same |
//! | Ctrl-C ends a run at a whole step; two end the program | `interrupts::` |
//! | `examples` lists, `copy NAME` | `found::examples_and_new_decks_are_written_here` |
//! | `new` | the same |
//! | `completions SHELL` | `found::shells_and_man_get_their_pages`, `at_hand::terminal::bash_completes_…` |
//! | man pages | the same, `at_hand::terminal::man_has_a_page_for_each_subcommand` |
//! | a mistyped subcommand is taken for one, also where the deck is there | `found::a_mistyped_subcommand_is_taken_for_one` |
//! | `help` goes by topics | `found::help_goes_by_topics_through_a_pager` |
//! | pages are wrapped at words, and go through a pager | the same, `at_hand::terminal::pages_are_wrapped_…` |
//! | `help fix` lists fixes | `found::help_searches_names_and_texts` |
//! | `help wall` finds `wall/gran`: a search over names and texts | the same |
//! | for a word that is known elsewhere the message names the place | `found::a_word_that_is_known_elsewhere_is_told_…` |
//!
//! Those of the prompt are in `tests/prompt/terminal.rs`.
#![cfg(unix)]

use super::pty::{GRAINS, PLAIN, shown, start, too_wide, width};
use std::fs;

#[test]
fn a_run_ends_in_three_lines_and_setup_prints_one_line_each() {
    let folder = tempfile::tempdir().unwrap();
    let deck = format!(
        "{GRAINS}dump d all custom 5 run.dump id x\nrestart 10 run.*.restart\nrun 10\nrun 10\nrun 10 post no\n"
    );
    let text = shown(folder.path(), 200, &deck, PLAIN, &[]);
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
    let table = lines.iter().position(|l| l.starts_with("   Step")).unwrap();
    assert!(memory < table && table < end, "{text}");
    assert!(lines[end].contains(" steps/s, ") && lines[end].ends_with(" particle steps/s"), "{text}");
    assert_eq!(lines[end + 1], "results: log.lammps, run.dump, run.*.restart");
    assert!(lines[end + 2].starts_with("faster: ") && lines[end + 2].contains(" % goes into "), "{text}");
    // Nothing is printed twice.
    let count = |begin: &str| lines.iter().filter(|l| l.starts_with(begin)).count();
    assert_eq!([count("10 steps in "), count("results: "), count("27 particles, ")], [3, 1, 1], "{text}");
}

#[test]
fn a_terminal_that_wants_all_and_a_pipe_have_lammps_blocks() {
    let folder = tempfile::tempdir().unwrap();
    // Long enough for a live line, were there one.
    let deck = format!("{GRAINS}thermo 0\nrun 150000\n");
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
        "{GRAINS}thermo 100000\nvariable k loop 700\nlabel again\nrun 300 post no\nnext k\njump SELF again\n"
    );
    let text = shown(folder.path(), 120, &deck, PLAIN, &[]);
    let lines: Vec<&str> = text.split("\x1b[2K").collect();
    let bars: Vec<&&str> = lines.iter().filter(|l| l.contains(" of 210,000 steps, ")).collect();
    assert!(!bars.is_empty(), "{text}");
    let bar = bars[bars.len() - 1].lines().last().unwrap();
    assert!(
        bar.contains(" steps/s, ") && bar.contains(" left  step ") && bar.contains("  dt 1.000e-9"),
        "{bar}"
    );
    let none = ["0/0", " of 0 steps", "of this run"];
    assert!(none.iter().all(|word| !text.contains(word)), "{text}");
    // A loop that reads the clock ends in sight, perhaps earlier.
    let until = "if \"$t < 0.00016 && $(ke) < 1\" then \"jump SELF again\"";
    let deck = format!("{GRAINS}thermo 0\nvariable t equal time\nlabel again\nrun 80000 post no\n{until}\n");
    let text = shown(folder.path(), 120, &deck, PLAIN, &[]);
    assert!(text.contains(" of up to 160,000 steps, "), "{text}");
    // A loop whose number of turns depends on a run is unpredictable: the bar is that of the run.
    let deck = format!(
        "{GRAINS}thermo 0\nlabel again\nrun 120000 post no\nif \"$(ke) < 2e-8\" then \"jump SELF again\"\n"
    );
    let text = shown(folder.path(), 120, &deck, PLAIN, &[]);
    assert!(text.contains(" of 120,000 steps") && !text.contains(" of 240,000"), "{text}");
    // A terminal that cannot take a line back gets none.
    let text = shown(folder.path(), 120, &deck, PLAIN, &[("TERM", "dumb")]);
    assert!(!text.contains('\x1b') && text.contains("120,000 steps in "), "{text}");
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
        text.contains("(4 more than fit here, in log.lammps alone: TotEng Press\r\n  Volume v_speed)"),
        "{text}"
    );
    let long = |l: &&str| l.chars().count() > 60 && l.trim_start().starts_with(|c: char| c.is_ascii_digit());
    assert_eq!(table_lines(&text).find(long), None);
}

#[test]
fn rows_have_the_columns_of_their_heading() {
    let folder = tempfile::tempdir().unwrap();
    // At 53 columns the last heading fits, and so does a 0 below it, but not 2.4e-18.
    let deck = format!("{GRAINS}thermo_style custom step pe temp ke\nthermo 5\nrun 10\n");
    for (columns, fit) in [(52, 3), (53, 3), (55, 3), (56, 4), (80, 4)] {
        let text = shown(folder.path(), columns, &deck, PLAIN, &[]);
        let rows: Vec<usize> = table(&text).iter().map(Vec::len).collect();
        assert_eq!(rows, [fit; 4], "{columns}: {text}");
    }
}

#[test]
fn lines_of_its_own_break_between_words() {
    let folder = tempfile::tempdir().unwrap();
    let deck = format!("{GRAINS}dump d all custom 5 run.dump id x\nrun 1\nrun 2\n");
    for columns in [60, 80, 200] {
        let text = shown(folder.path(), columns, &deck, PLAIN, &[]);
        assert_eq!(too_wide(&text, columns.into()), None, "{text}");
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        assert!(lines.iter().any(|l| l.starts_with("1 step in ")), "{text}");
        let set = ["Setting atom values: 27 settings made for diameter, 27", "settings made for density"];
        assert_eq!(set.map(|part| lines.contains(&part)), [columns == 60; 2], "{text}");
    }
}

#[test]
fn the_line_shows_progress_and_time_left() {
    let folder = tempfile::tempdir().unwrap();
    // A scene whose building takes a while has no steps yet, and is no run.
    let deck = format!("{GRAINS}shell sleep 0.4\nthermo 0\nrun 1000000\n");
    let text = shown(folder.path(), 100, &deck, PLAIN, &[]);
    let (building, running) = text.split_once("   Step").unwrap();
    assert!(!building.contains('\x1b') && !building.contains(" steps"), "{building}");
    let bars: Vec<[f64; 4]> = running.split("\x1b[2K").filter_map(bar).collect();
    assert!(bars.len() > 1, "{running}");
    for [done, rate, left, step] in &bars {
        assert_eq!(done, step, "{running}");
        // Whole seconds, rounded up; speeds are rounded to a step.
        assert!(*left >= 1.0 && (left - (1_000_000.0 - done) / rate).abs() <= 1.01, "{running}");
    }
    // It is drawn once more below a line that comes in between.
    assert!(bars.is_sorted_by(|a, b| a[0] <= b[0]) && bars[0][0] < bars[bars.len() - 1][0], "{running}");
}

/// Steps made, steps per second, seconds left and the present step of a live line.
fn bar(text: &str) -> Option<[f64; 4]> {
    let (steps, rest) = text.split_once(" of 1,000,000 steps, ")?;
    let (rate, rest) = rest.split_once(" steps/s, ")?;
    let (left, rest) = rest.split_once(" s left  step ")?;
    let number = |t: &str| t.split_whitespace().next_back()?.replace(',', "").parse().ok();
    Some([number(steps)?, number(rate)?, number(left)?, rest.split_whitespace().next()?.parse().ok()?])
}

#[test]
fn a_window_may_change_its_size() {
    let folder = tempfile::tempdir().unwrap();
    // The window is made narrow when a line has been seen, and the run ends when a row of the table has been seen behind narrow
    // ones: however fast the machine is.
    let deck = format!("{GRAINS}thermo 20000\nrun 1000000000\n");
    let arguments = "in.deck -threads 1 & read seen; stty cols 41; read seen; kill $!; wait";
    let mut p = start(folder.path(), 120, &deck, arguments, &[]);
    let mut text = p.exp_string(" left").unwrap();
    let wide = text.lines().last().unwrap_or_default().to_string();
    assert!(wide.contains(" steps/s") && width(&wide) > 40, "{wide}");
    p.send_line("seen").unwrap();
    let step = |l: &&str| {
        l.split_whitespace().next().is_some_and(|w| w.ends_with("0000") && w.parse::<u64>().is_ok())
    };
    let mut narrow = false;
    let last = loop {
        let part = p.exp_string("\x1b[2K").unwrap();
        text += &part;
        text += "\x1b[2K";
        match part.lines().find(step).filter(|_| narrow) {
            Some(row) => break row.to_string(),
            None => {
                narrow |= part.lines().last().is_some_and(|bar| bar.contains(" steps") && width(bar) <= 40)
            }
        }
    };
    p.send_line("seen").unwrap();
    p.exp_eof().unwrap();
    let bars: Vec<&str> =
        text.split("\x1b[2K").filter_map(|l| l.lines().last()).filter(|l| l.contains(" steps")).collect();
    let narrow: Vec<&&str> = bars.iter().skip_while(|bar| width(bar) > 40).collect();
    assert!(!narrow.is_empty(), "{bars:?}");
    for bar in narrow {
        // In whole words.
        let end = bar.trim_end();
        assert!(width(bar) <= 40 && (end.ends_with(" steps") || end.ends_with(" steps/s")), "{bar}");
    }
    assert_eq!(last.split_whitespace().count(), 3, "{last}");
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
        text.contains(&format!("  to continue from: {file}")) && text.contains(&format!("then {step}")),
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
