//! A full disk, and two runs in one folder: the messages, and the files left behind.
#![cfg(target_os = "linux")] // /dev/full, and `ulimit` of the shell

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A scene of some size.
const SCENE: &str = "units si\natom_style peri\nboundary s s s\nlattice sc 0.001\nregion b block 0 9 0 9 0 9\ncreate_box 1 b\n\
    create_atoms 1 region b\nset group all density 2400\nset group all volume 1e-9\n";

/// Executes a deck where no file may grow beyond some kilobytes; the messages.
fn cramped(folder: &Path, kilobytes: u32, line: &str, log: &str) -> String {
    fs::write(folder.join("in.deck"), format!("{SCENE}{line}\n")).unwrap();
    // Without its signal the limit is an error of the write, as a full disk is.
    let shell = format!("trap '' XFSZ; ulimit -f {kilobytes}; exec \"$0\" in.deck -log {log}");
    let program = env!("CARGO_BIN_EXE_perigrain");
    let out = Command::new("bash").args(["-c", &shell, program]).current_dir(folder).output().unwrap();
    assert_eq!(out.status.code(), Some(1), "{line}: {}", String::from_utf8_lossy(&out.stdout));
    String::from_utf8_lossy(&out.stderr).into_owned()
}

#[test]
fn write_errors_have_the_words_of_the_system() {
    let folder = tempfile::tempdir().unwrap();
    for (line, path) in [
        ("write_restart a.restart", "a.restart"),
        ("write_data a.data", "a.data"),
        ("write_dump all custom a.txt id x y z", "a.txt"),
        ("dump 1 all custom 1 b.txt id x y z\nfix 1 all nve\nrun 0", "b.txt"),
        ("dump 1 all custom 1 c.txt.gz id x y z vx fx\nfix 1 all nve\nrun 0", "c.txt.gz"),
        ("dump 1 all custom 1 d.bin id x y z\nfix 1 all nve\nrun 0", "d.bin"),
        ("write_dump all vtk a.*.vtu", "a.0.vtu"),
        ("write_dump all image a.ppm type type", "a.ppm"),
        ("restart 1 e.*.restart\nfix 1 all nve\nrun 1", "e.1.restart"),
    ] {
        // Packed, 1000 places on a lattice are small.
        let packed = path.ends_with(".gz") || path.ends_with(".vtu");
        let printed = cramped(folder.path(), if packed { 1 } else { 8 }, line, "none");
        assert!(
            printed.contains("File too large") && printed.contains(&format!("`{path}`")),
            "{line}: {printed}"
        );
        let left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert!(left.iter().all(|n| !n.to_string_lossy().ends_with(".part")), "{line}: {left:?}");
    }
    let lines: String = (0..900).map(|k| format!("print \"line {k} of a long log\"\n")).collect();
    let printed = cramped(folder.path(), 8, &lines, "a.log");
    assert!(printed.contains("`a.log`") && printed.contains("File too large"), "{printed}");
}

#[test]
fn a_full_disk_is_named() {
    let folder = tempfile::tempdir().unwrap();
    for (line, log) in [
        ("dump 1 all custom 1 /dev/full id x y z\nfix 1 all nve\nrun 0", "none"),
        ("print \"on the log\"", "/dev/full"),
        ("print \"on a file\" file /dev/full", "none"),
    ] {
        let printed = cramped(folder.path(), 10_000, line, log);
        assert!(
            printed.contains("`/dev/full`") && printed.contains("No space left on device"),
            "{line}: {printed}"
        );
    }
}

fn start(folder: &Path, deck: &str, log: &str) -> Child {
    fs::write(
        folder.join(deck),
        format!("{SCENE}fix 1 all nve\nthermo_modify flush yes\nthermo 1\nrun 100000000\n"),
    )
    .unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_perigrain"));
    program
        .args([deck, "-log", log])
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

#[test]
fn a_second_run_on_the_same_log_is_warned() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("a.log");
    let mut first = start(folder.path(), "in.first", "a.log");
    let begin = Instant::now();
    while fs::metadata(&log).map_or(0, |m| m.len()) == 0 && begin.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let second = |log: &str| {
        fs::write(folder.path().join("in.second"), "print hello\n").unwrap();
        let mut program = Command::new(env!("CARGO_BIN_EXE_perigrain"));
        let out = program.args(["in.second", "-log", log]).current_dir(folder.path()).output().unwrap();
        assert!(out.status.success());
        String::from_utf8_lossy(&out.stdout).into_owned()
    };
    let (shared, own) = (second("a.log"), second("b.log"));
    first.kill().unwrap();
    first.wait().unwrap();
    let after = second("a.log");
    let warning = "another run is writing `a.log` now";
    assert!(shared.contains(warning) && shared.contains("PG0117"), "{shared}");
    assert!(!own.contains("another run") && !after.contains("another run"), "{own} {after}");
}
