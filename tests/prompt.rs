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

/// The session's output for lines from a pipe.
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
mod terminal;

#[test]
fn mistakes_are_shown_and_the_rest_continues() {
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
    let (printed, wrong) = (out(&o), err(&o));
    assert!(printed.lines().any(|l| l == "lost 0 0.5"), "{printed}{wrong}");
    assert!(lines_with(&printed, "half 1").len() == 1 || wrong.contains("is_defined"), "{printed}{wrong}");
    assert!(printed.lines().any(|l| l == "ten 10 0.6"), "{printed}{wrong}");
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
    let printed = out(&o);
    assert!(
        printed.contains("taken back: velocity all scale 1") && printed.contains("wrote s.in"),
        "{printed}\n{}",
        err(&o)
    );
    assert!(printed.contains("run      run 20") && printed.contains("fix 1 nve"), "{printed}");
    let again = program(folder.path(), &["s.in", "-log", "none"]).output().unwrap();
    assert_eq!(again.status.code(), Some(0), "{}", err(&again));
    assert_eq!(lines_with(&out(&again), "state "), lines_with(&printed, "state "));
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
