//! The interactive session, through a real terminal and through a pipe.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

const SCENE: &str = include_str!("scripts/scene.in");

/// The program with its own history file, no colours, one thread.
fn program(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_perigrain"));
    command.args(args).args(["-threads", "1"]);
    settle(&mut command, folder);
    command
}

fn settle(command: &mut Command, folder: &Path) {
    command.current_dir(folder);
    command
        .env("XDG_STATE_HOME", folder.join("state"))
        .env("NO_COLOR", "1")
        .env("TERM", "xterm")
        .env("PAGER", "cat");
}

/// What the session says to lines from a pipe.
fn piped(folder: &Path, lines: &str) -> Output {
    let mut command = program(folder, &["repl"]);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let _ = child.stdin.take().unwrap().write_all(lines.as_bytes());
    child.wait_with_output().unwrap()
}

fn out(o: &Output) -> String {
    String::from_utf8_lossy(&o.stdout).into_owned()
}

fn err(o: &Output) -> String {
    String::from_utf8_lossy(&o.stderr).into_owned()
}

/// The lines that begin with a word, as a deck prints them.
fn lines_with<'a>(text: &'a str, begin: &str) -> Vec<&'a str> {
    text.lines().map(str::trim).filter(|l| l.starts_with(begin)).collect()
}

#[cfg(unix)]
mod terminal {
    use super::*;
    use rexpect::session::{PtySession, spawn_command};

    const PATIENCE: u64 = 60_000;

    fn start(folder: &Path) -> PtySession {
        // Wide enough that no line is wrapped: a line break then is the end of an answer's line.
        let mut command = Command::new("sh");
        command.args([
            "-c",
            "stty cols 400 rows 50 && exec \"$0\" -threads 1",
            env!("CARGO_BIN_EXE_perigrain"),
        ]);
        settle(&mut command, folder);
        let mut p = spawn_command(command, Some(PATIENCE)).unwrap();
        p.exp_string("Ctrl-D leaves").unwrap();
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
            let said = say(&mut p, line);
            assert!(!said.contains("error"), "{line}: {said}");
            if line.starts_with("run ") {
                // A short end leaves the table in sight.
                assert!(said.contains(" steps in ") && !said.contains("Loop time"), "{said}");
            }
        }
    }

    #[test]
    fn habits_work_or_are_told() {
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
        for line in ["units si", "region hole sphere 0 0 0 1", "region b block 0 1 0 1 0 1", "create_box 1 b"]
        {
            say(&mut p, line);
        }
        say(&mut p, "fix fall all gravity 9.81 vector 0 0 -1");
        say(&mut p, "group heavy empty");
        for (typed, wanted) in [
            ("material m file stee\t", "material m file steel.toml"),
            ("region r block IN\t EDG\t", "region r block INF EDGE"),
            ("fix w all wall/gran/region granular hooke 1 0.5 region ho\t", "0.5 region hole"),
            ("unfix f\t", "unfix fall"),
            ("velocity h\t", "velocity heavy"),
            ("dump_modify d backcolor gol\t", "dump_modify d backcolor gold"),
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
        let said = say(&mut p, "unita si");
        assert!(said.contains("unknown command `unita`") && said.contains("did you mean `units`?"), "{said}");
        for line in SCENE.lines() {
            let said = say(&mut p, line);
            assert!(!said.contains("error["), "{line}: {said}");
        }
        let said = say(&mut p, "set group all denstiy 1");
        assert!(said.contains("density"), "{said}");
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
        let said = say(&mut p, ":graph");
        let step = state.split(' ').nth(1).unwrap();
        let line = lines_with(&said, "").into_iter().find(|l| l.contains("run 100000000"));
        assert!(
            line.is_some_and(|l| l.contains(&format!("# stopped at step {step}, after {step}"))),
            "{said}"
        );

        // undo goes back to before the run, and forwards again by another one
        say(&mut p, ":undo");
        let said = say(&mut p, ":undo");
        assert!(said.contains("taken back: run 100000000"), "{said}");
        let said = say(&mut p, "print \"step $(step)\"");
        assert!(said.lines().any(|l| l.trim() == "step 0"), "{said}");
        say(&mut p, "run 50");
        let said = say(&mut p, ":plot pe ke");
        // (The terminal's bytes come one by one as characters: only ASCII can be looked for.)
        assert!(said.lines().any(|l| l.contains(" step ")) && said.contains("ke\r\n"), "{said}");
        let said = say(&mut p, ":slice vx z 0.002");
        assert!(said.contains("vx at z = 0.002"), "{said}");

        // a stopped run is saved as one of so many steps; the deck comes to the same numbers, which are not the
        // first run's, at whatever step the two happened to stop
        say(&mut p, "velocity all set NULL 1 NULL sum yes units box");
        p.send_line("run 100000000").unwrap();
        p.exp_regex(" {4}300 {2}").unwrap();
        give_up(&mut p);
        let said = say(&mut p, "print \"state $(step) $(x[1]:%.17g) $(ke:%.17g)\"");
        let second = lines_with(&said, "state ")[0].to_string();
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
}

#[test]
fn mistakes_are_shown_and_the_rest_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let o = piped(
        folder.path(),
        &format!("unita si\n{SCENE}\nset group all densty 5\nrun 0\nprint \"end $(step)\"\n"),
    );
    assert_eq!(o.status.code(), Some(1));
    assert!(
        err(&o).contains("did you mean `units`?") && err(&o).contains("did you mean `density`?"),
        "{}",
        err(&o)
    );
    assert!(out(&o).lines().any(|l| l == "end 0"), "{}", out(&o));
    let o = piped(
        folder.path(),
        "print \"\"\"two\nlines\"\"\"\nprint a &\n screen yes\nquit 3\nprint \"no more\"\n",
    );
    assert_eq!(o.status.code(), Some(3), "{}", err(&o));
    assert!(out(&o).contains("two\nlines\n") && out(&o).contains("\na\n") && !out(&o).contains("no more"));
    let left: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
    assert!(left.is_empty(), "a session leaves no log unless asked: {left:?}");
}

#[test]
fn a_line_that_fails_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    // A particle leaves the box in the middle of the run; the include fails behind lines that did something.
    let deck = "units si\natom_style sphere\nboundary f f f\nregion b block 0 1 0 1 0 1 units box\ncreate_box 1 b\n\
        create_atoms 1 single 0.5 0.5 0.5 units box\nset group all diameter 0.1 density 1\nvelocity all set 1 0 0\n\
        fix 1 all nve\npair_style none\ntimestep 0.01\nthermo 10\n";
    fs::write(
        folder.path().join("in.half"),
        "create_atoms 1 single 0.1 0.1 0.1 units box\nvariable a equal 5\nno_such\n",
    )
    .unwrap();
    let after = "run 100\nprint \"lost $(step) $(x[1]:%.6g)\"\ninclude in.half\nprint \"half $(atoms) $(is_defined(variable,a))\"\n\
        jump SELF\nrun 10\nprint \"ten $(step) $(x[1]:%.6g)\"\n:undo 99\n:undo\n";
    let o = piped(folder.path(), &format!("{deck}{after}"));
    let (said, wrong) = (out(&o), err(&o));
    assert!(said.lines().any(|l| l == "lost 0 0.5"), "{said}{wrong}");
    assert!(lines_with(&said, "half 1").len() == 1 || wrong.contains("is_defined"), "{said}{wrong}");
    assert!(said.lines().any(|l| l == "ten 10 0.6"), "{said}{wrong}");
    assert!(
        wrong.contains("`jump SELF` works there") && wrong.contains("there is no line to take back"),
        "{wrong}"
    );
}

#[test]
fn a_deck_may_come_first() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("decks")).unwrap();
    let deck = "units si\natom_style sphere\nmaterial m file own.toml\nprint \"read\"\n";
    fs::write(folder.path().join("decks/in.first"), deck).unwrap();
    let steel = Path::new(env!("CARGO_MANIFEST_DIR")).join("potentials/steel.toml");
    fs::copy(steel, folder.path().join("decks/own.toml")).unwrap();
    let o = program(folder.path(), &["repl", "decks/in.first"]).stdin(Stdio::null()).output().unwrap();
    assert_eq!(o.status.code(), Some(0), "{}", err(&o));
    assert!(out(&o).contains("read"), "{}", out(&o));
}

#[test]
fn a_saved_session_stands_alone() {
    let folder = tempfile::tempdir().unwrap();
    let decks = folder.path().join("decks");
    fs::create_dir(&decks).unwrap();
    fs::create_dir(folder.path().join("kept")).unwrap();
    let steel = Path::new(env!("CARGO_MANIFEST_DIR")).join("potentials/steel.toml");
    fs::copy(steel, decks.join("own.toml")).unwrap();
    fs::write(decks.join("in.first"), "units si\natom_style sphere\nmaterial m file own.toml\n").unwrap();
    let mut command = program(folder.path(), &["repl", "decks/in.first"]);
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let lines = "region b block 0 1 0 1 0 1\ncreate_box 1 b\n:save s.in\n:save kept/s.in\n";
    child.stdin.take().unwrap().write_all(lines.as_bytes()).unwrap();
    let o = child.wait_with_output().unwrap();
    assert_eq!(o.status.code(), Some(0), "{}", err(&o));
    // The included deck is gone; where its files are is known.
    fs::remove_file(decks.join("in.first")).unwrap();
    for deck in ["s.in", "kept/s.in"] {
        let o = program(folder.path(), &[deck, "-log", "none"]).output().unwrap();
        let text = fs::read_to_string(folder.path().join(deck)).unwrap();
        assert_eq!(o.status.code(), Some(0), "{text}{}", err(&o));
        assert!(text.contains("atom_style sphere") && !text.contains("include"), "{text}");
    }
}

#[test]
fn loops_live_in_files() {
    let folder = tempfile::tempdir().unwrap();
    let text = "variable n loop 3\nlabel again\nprint \"turn $n\"\nnext n\njump SELF again\n";
    fs::write(folder.path().join("in.loop"), text).unwrap();
    let o = piped(
        folder.path(),
        "include in.loop\nvariable k loop 2\nnext k\nprint \"k $k\"\nnext k\njump in.loop\nprint done\n",
    );
    assert_eq!(o.status.code(), Some(0), "{}", err(&o));
    assert_eq!(lines_with(&out(&o), "turn "), ["turn 1", "turn 2", "turn 3"], "{}", out(&o));
    assert!(out(&o).contains("k 2") && out(&o).contains("done"), "{}", out(&o));
}

#[test]
fn a_saved_session_is_a_deck_with_the_same_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let state = "print \"state $(step) $(x[7]:%.17g) $(ke:%.17g)\"\n";
    let lines = format!(
        "{SCENE}\nvelocity all create 300 4711 dist gaussian\nrun 20\nfix 9 all no_such\ncompute d all damage/atom\n\
         velocity all scale 1\n:undo\nrun 10\n{state}:graph\n:plan\n:save s.in\n"
    );
    let o = piped(folder.path(), &lines);
    let said = out(&o);
    assert!(
        said.contains("taken back: velocity all scale 1") && said.contains("wrote s.in"),
        "{said}\n{}",
        err(&o)
    );
    assert!(said.contains("run      run 20") && said.contains("fix 1 nve"), "{said}");
    let again = program(folder.path(), &["s.in", "-log", "none"]).output().unwrap();
    assert_eq!(again.status.code(), Some(0), "{}", err(&again));
    assert_eq!(lines_with(&out(&again), "state "), lines_with(&said, "state "));
}

#[test]
fn pictures_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    let lines = format!(
        "{SCENE}\ndump p all image 1 p.*.png type 0.001\nrun 0\n:show p.0.png\n:show no.png\n:show p.0.png x\n"
    );
    let o = piped(folder.path(), &lines);
    let picture =
        out(&o).lines().filter(|l| l.len() > 40 && l.chars().all(|c| " .:-=+*o#%@".contains(c))).count();
    assert!(picture > 10, "{}", out(&o));
    assert!(
        err(&o).contains("cannot read `no.png`") && err(&o).contains("write `:show FILE.png`"),
        "{}",
        err(&o)
    );
}
