//! `-partition`: one deck executed several times side by side, as LAMMPS' partitions do.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn perigrain(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_perigrain")).args(args).current_dir(folder).output().unwrap()
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn partitions_are_distinguished_and_share_values_out() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // Two rounds of values that are shared out, each given once.
    let deck = "variable w world x y z\nvariable u universe a b c d e f g\nvariable n uloop 7 pad\n\
                print \"from $w\"\nlabel again\nprint \"$u$n\" append got.$w\nnext u n\njump SELF again\n\
                variable m uloop 12 pad\nlabel more\nprint \"$m\" append more.$w\nnext m\njump SELF more\n\
                partition yes 2* print \"late\" file late.$w\npartition no *2 print \"not\" file not.$w\n";
    fs::write(at.join("in.p"), deck).unwrap();
    let o = perigrain(at, &["-in", "in.p", "-partition", "2x1", "1"]);
    let printed = String::from_utf8_lossy(&o.stdout).into_owned() + &String::from_utf8_lossy(&o.stderr);
    assert_eq!(o.status.code(), Some(0), "{printed}");
    assert_eq!(printed, "Running on 3 partitions of processors\n");
    assert_eq!(read(at, "log.lammps"), printed);
    for (number, w) in ["x", "y", "z"].iter().enumerate() {
        assert!(read(at, &format!("log.lammps.{number}")).contains(&format!("\nfrom {w}\n")), "{number}");
        assert!(read(at, &format!("screen.{number}")).contains(&format!("\nfrom {w}\n")), "{number}");
        let first = ["a1", "b2", "c3"][number];
        assert_eq!(read(at, &format!("got.{w}")).lines().next(), Some(first), "each begins with its own");
        assert_eq!(at.join(format!("late.{w}")).exists(), number > 0);
        assert_eq!(at.join(format!("not.{w}")).exists(), number == 2);
    }
    let all = |name: &str| {
        let text = ["x", "y", "z"].map(|w| read(at, &format!("{name}.{w}"))).concat();
        let mut lines: Vec<String> = text.lines().map(String::from).collect();
        lines.sort();
        lines.join(" ")
    };
    assert_eq!(all("got"), "a1 b2 c3 d4 e5 f6 g7");
    assert_eq!(all("more"), "01 02 03 04 05 06 07 08 09 10 11 12");
}

#[test]
fn what_does_not_fit_the_partitions_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (deck, args, code, why) in [
        ("variable w world 1 2\n", "-p 3x1", 1, "2 values for 3 partitions"),
        ("variable w world 1 2\n", "", 1, "2 values for the one partition there is"),
        ("variable u universe a b\n", "-p 3x1", 1, "2 values are too few for 3 partitions"),
        ("partition yes 4 print x\n", "-p 3x1", 1, "names no partitions: they have the numbers 1 to 3"),
        ("partition yes 3*2 print x\n", "-p 3x1", 1, "names no partitions"),
        ("temper 100 10\n", "-p 2x1", 1, "temper"),
    ] {
        fs::write(at.join("in.p"), deck).unwrap();
        let args: Vec<&str> = ["-in", "in.p", "-pscreen", "none", "-plog", "none"]
            .into_iter()
            .chain(args.split_whitespace())
            .collect();
        let o = perigrain(at, &args);
        let printed = String::from_utf8_lossy(&o.stderr);
        assert!(o.status.code() == Some(code) && printed.contains(why), "{deck}: {printed}");
        assert!(printed.contains("in.p:1:"), "{printed}");
        let check = perigrain(at, &[&["check"], &args[..]].concat());
        assert!(
            check.status.code() == Some(1) && String::from_utf8_lossy(&check.stderr).contains(why),
            "{deck}"
        );
    }
    let o = perigrain(at, &["-p", "2x1"]);
    assert_eq!(o.status.code(), Some(2), "a deck from standard input");
    assert_eq!(
        fs::read_dir(at).unwrap().filter(|f| f.as_ref().unwrap().file_name() != "in.p").count(),
        1,
        "log.lammps"
    );
    // One fails, the others continue.
    fs::write(at.join("in.p"), "partition yes 2 quit 3\nvariable w world a b c\nprint $w file said.$w\n")
        .unwrap();
    let o = perigrain(at, &["-in", "in.p", "-p", "3x1"]);
    assert_eq!(o.status.code(), Some(3));
    assert!(read(at, "log.lammps").contains("partition 2 failed (exit code 3)"));
    assert!(at.join("said.a").exists() && !at.join("said.b").exists() && at.join("said.c").exists());
}
