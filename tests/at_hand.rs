//! Help for beginners: decks to start from, examples, pages on a terminal, completions.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn perigrain(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_perigrain")).args(args).current_dir(folder).output().unwrap()
}

fn out(o: &Output) -> String {
    String::from_utf8_lossy(&o.stdout).into_owned()
}

fn err(o: &Output) -> String {
    String::from_utf8_lossy(&o.stderr).into_owned()
}

#[test]
fn new_decks_run_as_they_stand() {
    let folder = tempfile::tempdir().unwrap();
    // Grains take 100,000 steps to come to rest: ten of them are enough here.
    for (kind, fewer) in [("crack", &[][..]), ("pour", &["-var", "n", "10"]), ("bonded", &[])] {
        let deck = format!("in.{kind}");
        let o = perigrain(folder.path(), &["new", &deck, "-kind", kind]);
        assert_eq!(out(&o), format!("run it: perigrain {deck}\n"), "{}", err(&o));
        let o = perigrain(folder.path(), &[&[&deck, "-log", "none"], fewer].concat());
        assert_eq!((o.status.code(), err(&o).as_str()), (Some(0), ""), "{kind}: {}", out(&o));
        assert!(folder.path().join(format!("{kind}.png")).is_file());
    }
    let o = perigrain(folder.path(), &["new", "in.crack"]);
    assert!(o.status.code() == Some(2) && err(&o).contains("`in.crack` is there already"), "{}", err(&o));
}

#[test]
fn examples_are_listed_shown_and_copied() {
    let folder = tempfile::tempdir().unwrap();
    let list = out(&perigrain(folder.path(), &["examples"]));
    assert!(list.contains("\n  hopper "), "{list}");
    assert_eq!(out(&perigrain(folder.path(), &["examples", "list"])), list);
    assert!(out(&perigrain(folder.path(), &["examples", "show", "hopper"])).starts_with("# Hopper\n"));
    let o = perigrain(folder.path(), &["examples", "copy", "hopper"]);
    assert_eq!(out(&o), "run it: perigrain hopper/in.hopper\n");
    let o = perigrain(folder.path(), &["check", "hopper/in.hopper"]);
    assert_eq!(o.status.code(), Some(0), "{}", err(&o));
    let o = perigrain(folder.path(), &["examples", "copy", "hopper"]);
    assert!(err(&o).contains("`hopper` is there already") && err(&o).contains("OTHER_FOLDER"), "{}", err(&o));
}

#[test]
fn a_mistyped_subcommand_is_taken_for_one() {
    let folder = tempfile::tempdir().unwrap();
    let o = perigrain(folder.path(), &["chekc", "in.fall"]);
    let printed = "error: `chekc` is no subcommand, and there is no such deck\n  = help: did you mean `perigrain check in.fall`?\n";
    assert_eq!((o.status.code(), err(&o).as_str()), (Some(2), printed));
    fs::write(folder.path().join("chekc"), "print \"a deck\"\n").unwrap();
    assert!(out(&perigrain(folder.path(), &["chekc", "-log", "none"])).contains("a deck\n"));
}

#[cfg(unix)]
mod terminal {
    use super::*;

    /// The output of the program on a terminal of 60 columns and 20 rows.
    fn on_a_terminal(args: &str, pager: &str) -> String {
        let line = format!("stty cols 60 rows 20; exec {} {args}", env!("CARGO_BIN_EXE_perigrain"));
        let mut command = Command::new("sh");
        command.args(["-c", &line]).env("PAGER", pager).env("TERM", "xterm");
        let mut session = rexpect::session::spawn_command(command, Some(60_000)).unwrap();
        session.exp_eof().unwrap().replace('\r', "")
    }

    #[test]
    fn pages_are_wrapped_at_words_and_go_through_the_pager() {
        let text = on_a_terminal("help bond_style", "");
        let prose = text.lines().filter(|l| !l.starts_with("bond_style ") && !l.starts_with("  "));
        assert!(text.starts_with("# bond_style") && prose.clone().count() > 10, "{text}");
        assert!(prose.clone().all(|l| l.chars().count() <= 60), "{text}");
        // What is no ASCII comes back from the terminal as something else.
        let letters = |t: &str| t.chars().filter(char::is_ascii_alphabetic).collect::<String>();
        let piped = out(&perigrain(Path::new("."), &["help", "bond_style"]));
        assert_eq!(letters(&text), letters(&piped));
        // `tr` is no pager, but it shows that the text has gone through one; a short text needs none.
        assert!(on_a_terminal("help bond_style", "tr a-z A-Z").starts_with("# BOND_STYLE"));
        assert!(on_a_terminal("help echo", "tr a-z A-Z").starts_with("# echo"));
        assert!(on_a_terminal("help bond_style", "no_such_pager").starts_with("# bond_style"));
    }

    #[test]
    fn bash_completes_subcommands_switches_and_kinds() {
        let Ok(version) = Command::new("bash").arg("--version").output() else { return };
        assert!(version.status.success());
        let folder = tempfile::tempdir().unwrap();
        let script = out(&perigrain(folder.path(), &["completions", "bash"]));
        fs::write(folder.path().join("completions"), script).unwrap();
        let complete = |words: &str| {
            let asked = format!(
                "source ./completions; COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); \
                 _perigrain perigrain \"${{COMP_WORDS[-1]}}\" \"${{COMP_WORDS[-2]}}\"; echo \"${{COMPREPLY[@]}}\""
            );
            let o = Command::new("bash").args(["-c", &asked]).current_dir(folder.path()).output().unwrap();
            assert_eq!(err(&o), "", "{words}");
            out(&o).trim().to_string()
        };
        assert_eq!(complete("perigrain swe"), "sweep");
        assert_eq!(complete("perigrain --thr"), "--threads");
        assert_eq!(complete("perigrain new --kind po"), "pour");
        assert_eq!(complete("perigrain examples co"), "copy");
    }

    #[test]
    fn man_has_a_page_for_each_subcommand() {
        let folder = tempfile::tempdir().unwrap();
        let o = perigrain(folder.path(), &["man", "pages"]);
        assert_eq!((o.status.code(), err(&o).as_str()), (Some(0), ""));
        let page = fs::read_to_string(folder.path().join("pages/perigrain-check.1")).unwrap();
        assert!(page.contains(".TH perigrain-check 1") && page.contains("json"), "{page}");
        assert!(out(&perigrain(folder.path(), &["man"])).contains(".TH perigrain 1"));
    }
}

#[test]
fn decks_are_laid_out_anew_and_written_only_where_they_change() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (wide, tidy) = ("units   lj  \nprint  \"a   b\"# c\n", "units lj\nprint \"a   b\" # c\n");
    fs::write(path("in.wide"), wide).unwrap();
    fs::write(path("in.tidy"), tidy).unwrap();
    fs::write(path("in.open"), "print  \"a\nprint  'b\n").unwrap();
    fs::write(path("in.bytes"), b"print  \xff\n").unwrap();
    let before = fs::metadata(path("in.tidy")).unwrap().modified().unwrap();

    let o = perigrain(folder.path(), &["fmt", "--check", "in.wide", "in.tidy"]);
    assert_eq!((o.status.code(), out(&o).as_str(), err(&o).as_str()), (Some(1), "in.wide\n", ""));
    let o = perigrain(folder.path(), &["fmt", "in.wide", "-diff"]);
    assert!(o.status.success() && out(&o).contains("\n-units   lj  \n+units lj\n"), "{}", out(&o));
    assert_eq!(fs::read_to_string(path("in.wide")).unwrap(), wide);

    let o = perigrain(folder.path(), &["fmt", "in.wide", "in.tidy"]);
    assert_eq!((o.status.code(), out(&o).as_str()), (Some(0), "in.wide: laid out anew\n"), "{}", err(&o));
    assert_eq!(fs::read_to_string(path("in.wide")).unwrap(), tidy);
    assert_eq!(fs::metadata(path("in.tidy")).unwrap().modified().unwrap(), before);

    let o = perigrain(folder.path(), &["fmt", "in.open", "in.bytes", "in.none", "in.tidy"]);
    let printed = err(&o);
    assert_eq!((o.status.code(), out(&o).as_str()), (Some(1), ""));
    for part in
        ["in.open:1:8", "in.open:2:8", "PG0136", "`in.bytes` is no text", "cannot read the deck `in.none`"]
    {
        assert!(printed.contains(part), "{part}: {printed}");
    }
    assert_eq!(fs::read_to_string(path("in.open")).unwrap(), "print  \"a\nprint  'b\n");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 4);
    assert_eq!(perigrain(folder.path(), &["fmt"]).status.code(), Some(2));
}

#[test]
fn standard_input_is_laid_out_to_standard_output() {
    use std::io::Write;
    use std::process::Stdio;
    let mut command = Command::new(env!("CARGO_BIN_EXE_perigrain"));
    let mut child = command.args(["fmt", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(b"run   1\r\n").unwrap();
    assert_eq!(out(&child.wait_with_output().unwrap()), "run 1\r\n");
}
