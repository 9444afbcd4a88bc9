//! `-safe`: the limits of an untrusted deck, through the program.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Output};

const SCENE: &str = "units lj\natom_style sphere\nregion b block 0 3 0 3 0 3\ncreate_box 1 b\n\
                     create_atoms 1 single 1 1 1\npair_style zero 1\npair_coeff * *\nfix nve all nve\n";

/// A folder with a deck's folder in it, and what a deck may be after.
fn folders() -> tempfile::TempDir {
    let outer = tempfile::tempdir().unwrap();
    let deck = outer.path().join("deck");
    fs::create_dir_all(deck.join("sub")).unwrap();
    fs::write(outer.path().join("secret"), "print 'secret'\n").unwrap();
    fs::write(deck.join("part"), "print 'part'\n").unwrap();
    symlink("..", deck.join("up")).unwrap();
    symlink("../secret", deck.join("there")).unwrap();
    symlink("../new", deck.join("nowhere")).unwrap();
    symlink("part", deck.join("here")).unwrap();
    assert!(Command::new("mkfifo").arg(deck.join("fifo")).status().unwrap().success());
    outer
}

fn perigrain(folder: &Path, deck: &str, switches: &[&str]) -> (Option<i32>, String, String) {
    fs::write(folder.join("in.deck"), deck).unwrap();
    let Output { status, stdout, stderr } = Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .args(["-in", "in.deck", "-log", "none", "-threads", "1"])
        .args(switches)
        .current_dir(folder)
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    (status.code(), text(stdout), text(stderr))
}

#[track_caller]
fn refused(folder: &Path, lines: &str, switches: &[&str], part: &str) {
    let deck = format!("{SCENE}{lines}\n");
    let (code, _, printed) = perigrain(folder, &deck, switches);
    assert!(
        code == Some(1) && printed.contains("error[PG0207]") && printed.contains(part),
        "{lines}: {code:?}\n{printed}"
    );
    assert!(printed.contains("in.deck:"), "{lines} has no place:\n{printed}");
}

#[test]
fn nothing_outside_of_the_folder_is_touched() {
    let outer = folders();
    let folder = outer.path().join("deck");
    let absolute = outer.path().join("new").display().to_string();
    for (lines, part) in [
        ("shell touch ../new", "may not use `shell`"),
        ("shell cd ..", "may not use `shell`"),
        ("variable h getenv HOME", "may not read the environment"),
        ("include ../secret", "outside of the deck's folder"),
        ("include there", "outside"),
        ("include up/secret", "outside"),
        ("include ../nowhere/secret", "outside of the deck's folder"),
        ("include /no/such/folder/secret", "outside of the deck's folder"),
        ("include ../secret/below", "outside of the deck's folder"),
        ("molecule m ../nowhere/secret", "outside of the deck's folder"),
        ("clear\nunits si\nmaterial m file ../nowhere/secret.toml", "outside of the deck's folder"),
        ("read_data ../nowhere/secret add append", "outside of the deck's folder"),
        ("region m mesh ../nowhere/secret.stl", "outside of the deck's folder"),
        ("read_mesh ../nowhere/secret.msh type 1", "outside of the deck's folder"),
        ("rerun ../nowhere/secret dump x y z", "outside of the deck's folder"),
        ("read_dump ../nowhere/secret 0 x y z", "outside of the deck's folder"),
        ("variable f file ../nowhere/secret", "outside of the deck's folder"),
        ("print x file ../nowhere/secret", "outside of the deck's folder"),
        ("print $(is_file(../nowhere/secret))", "outside of the deck's folder"),
        ("jump /etc/passwd", "outside"),
        ("variable f file /etc/passwd", "outside"),
        ("print $(is_file(/etc/passwd))", "outside"),
        ("clear\nread_restart ../old.restart", "outside"),
        ("molecule m ../secret", "outside"),
        ("clear\nunits si\nmaterial m file ../secret.toml", "outside"),
        ("print x file ../new", "outside"),
        ("print x append up/new", "outside"),
        ("print x file nowhere", "leads nowhere"),
        ("print x file fifo", "no plain file"),
        ("include fifo", "no plain file"),
        (&format!("print x file {absolute}"), "outside"),
        ("log ../new", "outside"),
        ("write_data ../new", "outside"),
        ("write_restart ../new", "outside"),
        ("write_dump all custom ../new id", "outside"),
        ("dump d all custom 1 ../new id\nrun 0", "outside"),
        ("dump d all custom 1 /dev/null id\nrun 0", "outside"),
        ("dump d all image 1 ../new.*.png type type\nrun 0", "outside"),
        ("restart 1 ../new.*\nrun 2", "outside"),
        ("fix p all print 1 x file ../new\nrun 2", "outside"),
        ("variable t equal time\nfix a all ave/time 1 1 1 v_t file ../new\nrun 2", "outside"),
        ("fix h all halt 1 diskfree < 1 path /\nrun 2", "outside"),
    ] {
        refused(&folder, lines, &["-safe"], part);
    }
    let left: Vec<_> = fs::read_dir(outer.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(left.len(), 2, "{left:?}");
}

#[test]
fn what_is_inside_continues_as_ever() {
    let outer = folders();
    let folder = outer.path().join("deck");
    let deck = format!(
        "{SCENE}include part\ninclude here\ninclude ./sub/../part\nprint x file sub/x\nwrite_data sub/data\nrestart 1 r.*\n\
         dump d all custom 1 d.*.txt id\nmaterial steel E 2e11 nu 0.25 rho 7800\nprint $(is_file(part))\nrun 2\nlog new.log\n"
    );
    let (code, printed, problems) = perigrain(&folder, &deck, &["-safe"]);
    assert_eq!((code, &*problems), (Some(0), ""), "{printed}");
    assert_eq!(printed.lines().filter(|l| *l == "part").count(), 3);
    for name in ["sub/x", "sub/data", "r.1", "d.2.txt", "new.log"] {
        assert!(folder.join(name).is_file(), "{name}");
    }
    // Names are looked up in the working folder: the deck's is meant to be that.
    fs::write(folder.join("in.deck"), "print x file y\n").unwrap();
    let elsewhere = Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .args(["-in", "deck/in.deck", "-log", "none", "-safe"])
        .current_dir(outer.path())
        .output()
        .unwrap();
    assert!(elsewhere.status.code() == Some(1) && !outer.path().join("y").exists());
}

#[test]
fn limits_end_a_deck() {
    let outer = folders();
    let folder = outer.path().join("deck");
    let counted = "variable i loop 2000\nlabel a\n";
    for (lines, limit, part) in [
        ("run 60\nrun 50", ["steps", "100"], "50 steps after 60 would be more than the 100 steps"),
        ("minimize 0 0 101 1000", ["steps", "100"], "more than the 100 steps"),
        (&format!("{counted}print $i\nnext i\njump SELF a"), ["lines", "1e3"], "more than the 1000 lines"),
        (
            &format!("{counted}print x file x$i\nnext i\njump SELF a"),
            ["files", "5"],
            "5 files have been written",
        ),
        (
            "dump d all image 1 x.*.png type type size 400 300",
            ["pixels", "1e5"],
            "a picture of 120000 would be",
        ),
        (
            "variable s string xxxxxxxx\nvariable i loop 17\nlabel a\nvariable s string ${s}${s}\nnext i\njump SELF a\n\
             variable i loop 200\nlabel b\nvariable t$i string $s\nnext i\njump SELF b",
            ["memory", "60"],
            "60 are allowed",
        ),
    ] {
        refused(&folder, lines, &["-limit", limit[0], limit[1]], part);
    }
    // The memory that a line is about to request is forecast.
    let many = format!("{SCENE}lattice sc 1e6\ncreate_atoms 1 box\n");
    let (code, _, printed) = perigrain(&folder, &many, &["-limit", "memory", "200"]);
    assert!(code == Some(1) && printed.contains("0.2 GB are free"), "{printed}");
}
