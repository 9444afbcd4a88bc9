//! The prompt on a terminal, byte by byte.
//!
//! | claim | test |
//! |---|---|
//! | `?`, `exit`, `%time LINE` work | `habits_work_or_get_a_hint` |
//! | shell habits without meaning here get a hint what to write | the same |
//! | Tab knows files of materials | `tab_knows_what_the_syntax_wants` |
//! | Tab knows colours | the same |
//! | Tab knows groups wherever the syntax has them | the same |
//! | Tab knows `INF` and `EDGE` | the same |
//! | Tab knows regions wherever the syntax has them | the same |
//! | Tab knows fixes (and computes) | the same |
//! | the decks of `howto/prompt.md` work as typed, in order, from nothing | `what_the_guide_shows_works_as_typed` |
//! | an interrupted run stays in `:graph` as far as it went | `a_session_through_a_terminal` |
//! | the last table stays in sight | `a_saved_session_stands_alone_and_keeps_its_last_table_in_sight` |
//! | `:save` writes a deck that stands alone | the same; stopped runs: `a_session_through_a_terminal` |
//! | `:plot`, `:slice`, `:show` fit the screen | `pictures_and_curves_are_no_wider_than_the_screen` |
//! | a second Ctrl-C is confirmed beside the live line | `interrupts::at_the_prompt_the_second_is_confirmed_on_a_line_of_its_own` |

use super::{SCENE, err, lines_with, out, program, settle};
use crate::pty::width;
use rexpect::session::{PtySession, spawn_command};
use std::fs;
use std::path::Path;
use std::process::Command;

const PATIENCE: u64 = 60_000;

/// Wide enough that no line is wrapped: a line break then is the end of an answer's line.
fn start(folder: &Path) -> PtySession {
    begin(folder, 400, "-threads 1")
}

fn begin(folder: &Path, columns: u16, args: &str) -> PtySession {
    let mut command = Command::new("sh");
    let line = format!("stty cols {columns} rows 50 && exec \"$0\" {args}");
    command.args(["-c", &line, env!("CARGO_BIN_EXE_perigrain")]);
    settle(&mut command, folder);
    let mut p = spawn_command(command, Some(PATIENCE)).unwrap();
    p.exp_string("Ctrl-D").unwrap();
    p.exp_string("perigrain> ").unwrap();
    p
}

/// Types without Enter.
fn type_in(p: &mut PtySession, text: &str) {
    p.send(text).unwrap();
    p.flush().unwrap();
}

/// Ctrl-C, and waits for the next prompt.
fn give_up(p: &mut PtySession) {
    p.send_control('c').unwrap();
    p.exp_string("\n").unwrap();
    p.exp_string("perigrain> ").unwrap();
}

/// Types a line and waits until the next prompt; what stood between.
fn say(p: &mut PtySession, line: &str) -> String {
    p.send_line(line).unwrap();
    // The line is shown as it is typed; its end is where the answer begins.
    p.exp_string("\n").unwrap();
    p.exp_string("perigrain> ").unwrap()
}

#[test]
fn what_the_guide_shows_works_as_typed() {
    let folder = tempfile::tempdir().unwrap();
    let mut p = start(folder.path());
    let guide = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/howto/prompt.md");
    let guide = fs::read_to_string(guide).unwrap();
    let typed: Vec<&str> = guide.lines().filter_map(|l| l.strip_prefix("perigrain> ")).collect();
    assert!(typed.len() > 15, "{typed:?}");
    for line in typed {
        let printed = say(&mut p, line);
        assert!(!printed.contains("error"), "{line}: {printed}");
        if line.starts_with("run ") {
            // A short end leaves the table in sight.
            assert!(printed.contains(" steps in ") && !printed.contains("Loop time"), "{printed}");
        }
    }
}

#[test]
fn habits_work_or_get_a_hint() {
    let folder = tempfile::tempdir().unwrap();
    let mut p = start(folder.path());
    assert!(say(&mut p, "?").contains("at the prompt"));
    assert!(say(&mut p, "?timestep").contains("# timestep"));
    for line in ["units si", "region b block 0 1 0 1 0 1", "create_box 1 b", "mass 1 1"] {
        assert!(!say(&mut p, line).contains("error"), "{line}");
    }
    assert!(say(&mut p, "%time create_atoms 1 single 0.5 0.5 0.5").contains("(that took "));
    assert!(say(&mut p, "print \"atoms $(atoms)\"").contains("atoms 1\r\n"));
    assert!(say(&mut p, "ls -l").contains("write `shell ls -l`"));
    assert!(say(&mut p, "plot ke").contains("write `:plot ke`"));
    p.send_line("exit").unwrap();
    p.exp_eof().unwrap();
}

#[test]
fn tab_knows_what_the_syntax_wants() {
    let folder = tempfile::tempdir().unwrap();
    let mut p = start(folder.path());
    for line in [
        "units si",
        "atom_style peri",
        "region hole sphere 0 0 0 1",
        "region b block 0 1 0 1 0 1",
        "create_box 1 b",
        "fix fall all gravity 9.81 vector 0 0 -1",
        "compute kin all ke",
        "group heavy empty",
    ] {
        say(&mut p, line);
    }
    for (typed, wanted) in [
        // Files of materials, and colours.
        ("material m file alu\t", "material m file alumina.toml"),
        ("dump_modify d backcolor gol\t", "dump_modify d backcolor gold"),
        ("dump d all image 9 a.png type type boxcolor gol\t", "boxcolor gold"),
        ("dump_modify d acolor 1 gol\t", "acolor 1 gold"),
        // Regions without an end.
        ("region r block IN\t EDG\t", "region r block INF EDGE"),
        ("region r cylinder z 0 0 1 IN\t", "cylinder z 0 0 1 INF"),
        // Groups.
        ("velocity h\t", "velocity heavy"),
        ("fix m h\t", "fix m heavy"),
        ("set group h\t", "set group heavy"),
        ("group g subtract all h\t", "subtract all heavy"),
        ("displace_atoms h\t", "displace_atoms heavy"),
        ("write_dump h\t", "write_dump heavy"),
        ("variable v equal vcm(h\t", "vcm(heavy"),
        // Regions.
        ("fix w all wall/gran/region granular hooke 1 0.5 region ho\t", "0.5 region hole"),
        ("create_atoms 1 region ho\t", "create_atoms 1 region hole"),
        ("delete_atoms region ho\t", "delete_atoms region hole"),
        ("group g region ho\t", "group g region hole"),
        ("region u union 2 ho\t", "union 2 hole"),
        ("fix m all setforce 0 0 0 region ho\t", "0 0 0 region hole"),
        ("fix e all evaporate 1 1 ho\t", "evaporate 1 1 hole"),
        ("compute r all reduce/region ho\t", "reduce/region hole"),
        ("peri_modify nofail region ho\t", "nofail region hole"),
        ("peri_crack plane 0 0 0 0 1 0 region ho\t", "0 region hole"),
        // Fixes and computes.
        ("unfix f\t", "unfix fall"),
        ("fix_modify f\t", "fix_modify fall"),
        ("thermo_style custom step f_f\t", "step f_fall"),
        ("fix a all ave/time 1 1 1 c_k\t", "1 1 1 c_kin"),
        // Behind the words of the prompt, too.
        ("%time unfix f\t", "%time unfix fall"),
        ("?fix gravi\t", "?fix gravity"),
    ] {
        type_in(&mut p, typed);
        p.exp_string(wanted).unwrap();
        give_up(&mut p);
    }
}

#[test]
fn a_session_through_a_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let mut p = start(folder.path());

    // completion: a style, then a name of the session
    type_in(&mut p, "pair_sty\t");
    p.exp_string("pair_style").unwrap();
    type_in(&mut p, " peri/pm\t");
    p.exp_string("peri/pmb").unwrap();
    give_up(&mut p);

    // hint: the rest of the syntax
    type_in(&mut p, "fix 1 all viscous ");
    p.exp_string("gamma [scale type ratio]").unwrap();
    give_up(&mut p);

    // a mistake is shown and changes nothing
    let printed = say(&mut p, "unita si");
    assert!(
        printed.contains("unknown command `unita`") && printed.contains("did you mean `units`?"),
        "{printed}"
    );
    for line in SCENE.lines() {
        let printed = say(&mut p, line);
        assert!(!printed.contains("error["), "{line}: {printed}");
    }
    let printed = say(&mut p, "set group all denstiy 1");
    assert!(printed.contains("density"), "{printed}");
    say(&mut p, "velocity all ramp vx 0 20 x 0 0.004 units box");
    say(&mut p, "thermo 100");
    say(&mut p, "thermo_style custom step pe ke");

    // Ctrl-C stops a run at a whole step and gives the prompt back
    p.send_line("run 100000000").unwrap();
    p.exp_regex(" {4}200 {2}").unwrap();
    p.exp_string("dt 1.000e-8").unwrap();
    p.send_control('c').unwrap();
    p.exp_string("Interrupted at step").unwrap();
    p.exp_string("perigrain> ").unwrap();
    let stopped = say(&mut p, "print \"state $(step) $(x[1]:%.17g) $(ke:%.17g)\"");
    let state = lines_with(&stopped, "state ")[0].to_string();
    // the run is in the list of lines as far as it went
    let printed = say(&mut p, ":graph");
    let step = state.split(' ').nth(1).unwrap();
    let line = lines_with(&printed, "").into_iter().find(|l| l.contains("run 100000000"));
    assert!(
        line.is_some_and(|l| l.contains(&format!("# stopped at step {step}, after {step}"))),
        "{printed}"
    );

    // undo goes back to before the run, and forwards again by another one
    say(&mut p, ":undo");
    let printed = say(&mut p, ":undo");
    assert!(printed.contains("taken back: run 100000000"), "{printed}");
    let printed = say(&mut p, "print \"step $(step)\"");
    assert!(printed.lines().any(|l| l.trim() == "step 0"), "{printed}");
    say(&mut p, "run 50");
    let printed = say(&mut p, ":plot pe ke");
    // (The terminal's bytes come one by one as characters: only ASCII can be looked for.)
    assert!(printed.lines().any(|l| l.contains(" step ")) && printed.contains("ke\r\n"), "{printed}");
    let printed = say(&mut p, ":slice vx z 0.002");
    assert!(printed.contains("vx at z = 0.002"), "{printed}");

    // a stopped run is saved as one of so many steps; the deck comes to the same numbers, which are not the
    // first run's, at whatever step the two happened to stop
    say(&mut p, "velocity all set NULL 1 NULL sum yes units box");
    p.send_line("run 100000000").unwrap();
    p.exp_regex(" {4}300 {2}").unwrap();
    give_up(&mut p);
    let printed = say(&mut p, "print \"state $(step) $(x[1]:%.17g) $(ke:%.17g)\"");
    let second = lines_with(&printed, "state ")[0].to_string();
    assert_ne!(state, second);
    say(&mut p, ":save saved.in");
    p.send_control('d').unwrap();
    p.exp_eof().unwrap();

    let o = program(folder.path(), &["saved.in", "-log", "none"]).output().unwrap();
    assert_eq!(o.status.code(), Some(0), "{}", err(&o));
    assert_eq!(
        lines_with(&out(&o), "state "),
        [second.as_str()],
        "{}",
        fs::read_to_string(folder.path().join("saved.in")).unwrap()
    );
    let history = fs::read_to_string(folder.path().join("state/perigrain/history")).unwrap();
    assert!(history.contains("thermo 100\n") && history.contains(":save saved.in"), "{history}");
}

#[test]
fn pictures_and_curves_are_no_wider_than_the_screen() {
    let folder = tempfile::tempdir().unwrap();
    let run = "\nthermo 1\ndump p all image 5 p.*.png type 0.001\nrun 5\n";
    fs::write(folder.path().join("in.scene"), SCENE.to_owned() + run).unwrap();
    for columns in [60, 80] {
        let mut p = begin(folder.path(), columns as u16, "repl in.scene -threads 1");
        for (line, across) in [(":plot temp", 77), (":slice x z 0.002", 56), (":show p.5.png", 80)] {
            let printed = say(&mut p, line);
            let most = printed.split("\r\n").filter(|l| !l.contains('\x1b')).map(width).max().unwrap();
            assert!(most <= columns && most + 12 > columns.min(across), "{columns} {line} {most}: {printed}");
        }
        p.send_control('d').unwrap();
        p.exp_eof().unwrap();
    }
}

#[test]
fn a_saved_session_stands_alone_and_keeps_its_last_table_in_sight() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.first"), SCENE).unwrap();
    fs::write(folder.path().join("in.more"), "velocity all set 1 0 0 units box\n").unwrap();
    let mut p = begin(folder.path(), 400, "repl in.first -threads 1");
    say(&mut p, "include in.more");
    // Between table and prompt there are three lines.
    let printed = say(&mut p, "run 20");
    let lines: Vec<&str> =
        printed.lines().map(str::trim_end).filter(|l| !l.is_empty() && !l.contains('\x1b')).collect();
    let last =
        lines.iter().rposition(|l| l.trim_start().starts_with("20 ") && !l.contains("steps in")).unwrap();
    let rest: Vec<&str> = lines[last + 1..].iter().map(|l| l.split(' ').next().unwrap()).collect();
    assert_eq!(rest, ["20", "results:", "faster:"], "{printed}");
    let printed = say(&mut p, "print \"state $(step) $(x[7]:%.17g)\"");
    let state = lines_with(&printed, "state ")[0].to_string();
    assert!(say(&mut p, ":save saved.in").contains("wrote saved.in"));
    p.send_line("exit").unwrap();
    p.exp_eof().unwrap();
    for gone in ["in.first", "in.more"] {
        fs::remove_file(folder.path().join(gone)).unwrap();
    }
    let mut command = Command::new("sh");
    command.args(["-c", "stty cols 100 && exec \"$0\" saved.in -threads 1", env!("CARGO_BIN_EXE_perigrain")]);
    settle(&mut command, folder.path());
    let printed = spawn_command(command, Some(PATIENCE)).unwrap().exp_eof().unwrap();
    assert_eq!(lines_with(&printed, "state "), [state.as_str()], "{printed}");
}
