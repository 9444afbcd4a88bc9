//! Runs of a sweep and partitions of a deck, shared out to ranks, and ranks on two hosts: what comes out is that of one process, and a rank that
//! dies is named.

use crate::ranks::{
    LAUNCHERS, children, deck_of, files, left_by, output_of, same, signal, start, wait_for, works,
};
use crate::restart::scenes::SCENES;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Output;

const PERIGRAIN: &str = env!("CARGO_BIN_EXE_perigrain");

/// Two grains that meet; the third of four runs fails, and while there is a file of this name all of them wait.
const DECK: &str = "\
variable n index 1
units si
atom_style sphere
boundary s s s
region box block -1 1 -1 1 -1 1 units box
create_box 1 box
create_atoms 1 single 0 0 0
create_atoms 1 single 0.19 0 0
set group all diameter 0.2
set group all density 2500
pair_style gran/hooke/history 1e5 NULL 50 NULL 0.5 0
pair_coeff * *
velocity all set $n 0 0
fix 1 all nve/sphere
compute k all ke
timestep 1e-5
thermo_style custom step ke
shell test ! -e ../../wait || sleep 30
if \"$n == 3\" then \"print here file no/such\"
run 20
";

const SWEEP: [&str; 9] = ["sweep", "in.x", "-each", "n", "1..4", "-report", "c_k", "-screen", "none"];

fn perigrain(folder: &Path, args: &[&str]) -> Output {
    start(folder, PERIGRAIN, args).wait_with_output().unwrap()
}

fn with_deck(deck: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.x"), deck).unwrap();
    folder
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// The table of a sweep with these words before and behind those of the sweep.
fn table(folder: &Path, launcher: &[&str], own: &[&str], out: &str) -> String {
    let args = [launcher, &SWEEP, &["-out", out], own].concat();
    let o = match launcher {
        [] => perigrain(folder, &args),
        _ => start(folder, launcher[0], &args[1..]).wait_with_output().unwrap(),
    };
    assert_eq!(o.status.code(), Some(1), "{}", output_of(&o));
    read(folder, &format!("{out}/table.csv"))
}

#[test]
fn a_sweep_on_ranks_has_the_table_of_one_process() {
    let folder = with_deck(DECK);
    let at = folder.path();
    let alone = table(at, &[], &[], "alone");
    assert!(alone.contains("\n3,3,failed,0,2,") && alone.contains("in.x:19: error[PG0118]"), "{alone}");
    assert_eq!(alone, table(at, &[], &["-ranks", "3"], "three"));
    assert_eq!(alone, table(at, &[], &["-ranks", "2", "-jobs", "2", "-retry", "1"], "two"));
    let journal = read(at, "three/journal");
    let at_ranks: Vec<bool> = (0..3).map(|r| journal.contains(&format!("\trank {r} on "))).collect();
    assert_eq!(at_ranks, [true; 3], "all ranks have had runs: {journal}");
    for (launcher, own, _) in LAUNCHERS.iter().filter(|l| works(l)) {
        let words = [&[*launcher], *own, &["-n", "4", PERIGRAIN]].concat();
        assert_eq!(alone, table(at, &words, &[], &launcher[1..].replace('/', "_")), "{launcher}");
    }
}

#[test]
fn ranks_without_a_run_are_counted_once() {
    let folder = with_deck("variable n index 1\nprint \"$n\" file said\n");
    let o = perigrain(folder.path(), &["sweep", "in.x", "-each", "n", "1", "2", "-ranks", "5"]);
    let words = output_of(&o);
    assert!(o.status.success() && words.contains("5 ranks on 1 host, 2 runs: 3 ranks have nothing to do\n"));
    assert!(words.matches("nothing to do").count() == 1 && words.contains("2 runs ok"), "{words}");
    // Mistakes are reported once too.
    for (args, why) in [
        (&["sweep", "in.x", "-each", "m", "1", "2"][..], "never uses the variable `m`"),
        (&["sweep", "in.x"], "needs values"),
        (&["sweep", "in.none", "-each", "n", "1"], "cannot read the deck `in.none`"),
        (&["sweep", "in.x", "-each", "n", "1", "-partition", "2x1"], "`-partition` needs several processes"),
    ] {
        let alone = perigrain(folder.path(), args);
        let several = perigrain(folder.path(), &[args, &["-ranks", "3"]].concat());
        assert!(output_of(&alone).contains(why), "{}", output_of(&alone));
        let words = |o: &Output| output_of(o).replace(" -ranks 3", "");
        assert_eq!(
            (alone.status.code(), words(&alone)),
            (several.status.code(), words(&several)),
            "{args:?}"
        );
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_rank_that_dies_is_named_with_its_run_and_the_sweep_continues() {
    let folder = with_deck(DECK);
    let at = folder.path();
    let alone = table(at, &[], &[], "alone");
    fs::write(at.join("wait"), "").unwrap();
    let words = [&SWEEP[..], &["-out", "o", "-ranks", "3", "-jobs", "1"]].concat();
    for victim in [1, 0] {
        let first = start(at, PERIGRAIN, &words);
        wait_for("three runs begin", || {
            let logs =
                ["0001-n=1", "0002-n=2", "0003-n=3"].map(|run| at.join("o").join(run).join("log.lammps"));
            logs.iter().all(|log| log.exists())
        });
        let command = |pid: u32| fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
        let mut ranks = children(first.id());
        ranks.retain(|pid| !String::from_utf8_lossy(&command(*pid)).contains("sweep-worker"));
        ranks.sort();
        let ranks = [vec![first.id()], ranks].concat();
        assert_eq!(ranks.len(), 3);
        signal("-9", ranks[victim]);
        let o = first.wait_with_output().unwrap();
        let named = format!("rank 1 on {} has ended without a message; it was making run 2 (n=2)", host());
        assert!(!o.status.success() && output_of(&o).contains(&named) == (victim > 0), "{}", output_of(&o));
        // The next sweep's logs are waited for, not these.
        for run in ["0001-n=1", "0002-n=2", "0003-n=3"] {
            fs::remove_dir_all(at.join("o").join(run)).unwrap_or_default();
        }
    }
    // One process continues what ranks have left, and reports where it was.
    fs::remove_file(at.join("wait")).unwrap();
    let o = perigrain(at, &[&SWEEP[..], &["-out", "o"]].concat());
    let left = "under way when the sweep ended, and begun anew: ";
    let all: Vec<String> = (0..3).map(|k| format!("run {} at rank {k} on {}", k + 1, host())).collect();
    assert!(output_of(&o).contains(&format!("{left}{}", all.join(", "))), "{}", output_of(&o));
    assert_eq!(read(at, "o/table.csv"), alone);
}

/// This machine's name.
fn host() -> String {
    fs::read_to_string("/proc/sys/kernel/hostname").unwrap().trim().to_owned()
}

#[test]
fn partitions_on_ranks_share_values_out() {
    let deck = "variable w world x y z\nvariable u universe a b c d e f g\nprint \"from $w\"\nlabel again\n\
                print \"$u\" append got.$w\nnext u\njump SELF again\n";
    let run = |launcher: &[&str], own: &[&str]| {
        let folder = with_deck(deck);
        let at = folder.path();
        let args = [launcher, &["-in", "in.x", "-partition", "1", "2x1"], own].concat();
        let o = match launcher {
            [] => perigrain(at, &args),
            _ => start(at, launcher[0], &args[1..]).wait_with_output().unwrap(),
        };
        assert!(o.status.success(), "{}", output_of(&o));
        let mut got: Vec<String> = vec![];
        let mut files = BTreeMap::new();
        for (number, w) in ["x", "y", "z"].iter().enumerate() {
            let values = read(at, &format!("got.{w}"));
            assert_eq!(values.lines().next(), Some(["a", "b", "c"][number]), "each begins with its own");
            got.extend(values.lines().map(String::from));
            files.insert(number, read(at, &format!("screen.{number}")).contains(&format!("\nfrom {w}\n")));
        }
        got.sort();
        assert_eq!((got.concat().as_str(), files.values().all(|there| *there)), ("abcdefg", true));
        (output_of(&o), read(at, "log.lammps"))
    };
    for n in ["2", "3", "5"] {
        let (words, log) = run(&[], &["-ranks", n]);
        let line = format!("Running on 3 partitions of processors, {n} ranks on 1 host\n");
        assert!(words == line && log == line, "{words}");
    }
    for (launcher, own, _) in LAUNCHERS.iter().filter(|l| works(l)) {
        run(&[&[*launcher], *own, &["-n", "2", PERIGRAIN]].concat(), &[]);
    }
    let folder = with_deck("partition yes 2 quit 3\nvariable w world a b c\nprint $w file said.$w\n");
    let o = perigrain(folder.path(), &["-in", "in.x", "-p", "3x1", "-ranks", "2"]);
    assert!(
        o.status.code() == Some(3) && output_of(&o).contains("partition 2 failed (exit code 3), rank 1 on ")
    );
    assert!(folder.path().join("said.a").exists() && folder.path().join("said.c").exists());
}

#[test]
fn a_bench_on_ranks_prints_their_number() {
    let folder = with_deck(DECK);
    let words = "bench in.x -each n 1 2 -measure c_k -repeat 1 -ranks 2";
    let o = perigrain(folder.path(), &words.split(' ').collect::<Vec<_>>());
    assert!(o.status.success(), "{}", output_of(&o));
    let line = "2 ranks on 1 host, one run at once on each, which disturb each other on one host";
    assert!(output_of(&o).contains(line), "{}", output_of(&o));
}

/// Runs the program on 2 + 2 ranks of two hosts; nothing where the machine allows no such thing.
#[cfg(target_os = "linux")]
fn on_two_hosts(folder: &Path, args: &[&str]) -> Option<Output> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/common/two_hosts.sh");
    let o = start(folder, "bash", &[&[script, PERIGRAIN], args].concat()).wait_with_output().unwrap();
    let skipped = o.status.code() == Some(77);
    if skipped {
        eprintln!("skipped: this machine allows no hosts of its own, or has no MPICH");
    }
    (!skipped).then_some(o)
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "takes half a minute: `./check --ranks`"]
fn two_hosts_have_the_bytes_of_one_process() {
    let named = |name: &str| SCENES.iter().find(|scene| scene.name == name).unwrap();
    for scene in [named("lattice"), named("pile")] {
        let deck = deck_of(scene);
        let alone = left_by(&deck, &["-threads", "1"]);
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("in.deck"), &deck).unwrap();
        let words = ["-in", "in.deck", "-screen", "none", "-threads", "1"];
        let Some(o) = on_two_hosts(folder.path(), &words) else { return };
        assert!(o.status.success(), "{}: {}", scene.name, output_of(&o));
        assert!(read(folder.path(), "log.lammps").contains("(4 ranks on 2 hosts of 1 thread(s))"));
        same(&alone, &files(folder.path()), &format!("{} on two hosts", scene.name));
    }
    let folder = with_deck(DECK);
    let at = folder.path();
    let alone = table(at, &[], &[], "alone");
    let o = on_two_hosts(at, &[&SWEEP[..], &["-out", "two"]].concat()).unwrap();
    assert_eq!((o.status.code(), read(at, "two/table.csv")), (Some(1), alone), "{}", output_of(&o));
    let journal = read(at, "two/journal");
    assert!(journal.contains("\trank 1 on one\n") && journal.contains("\trank 3 on two\n"), "{journal}");
}

#[cfg(target_os = "linux")]
#[test]
fn memory_of_all_ranks_of_a_machine_is_forecast_together() {
    let text = fs::read_to_string("/proc/meminfo").unwrap();
    let kilobytes = |name: &str| {
        let line = text.lines().find_map(|l| l.strip_prefix(name)).unwrap();
        line.split_whitespace().next().unwrap().parse::<f64>().unwrap()
    };
    // Particles that five ranks have no room for, and one has.
    let free = 1024.0 * (kilobytes("MemAvailable:") + kilobytes("SwapFree:"));
    let side = (free / 3.0 / 250.0).cbrt();
    let deck = format!(
        "units si\natom_style sphere\nboundary s s s\nlattice sc 1\nregion box block 0 {side} 0 {side} 0 {side}\n\
         create_box 1 box\ncreate_atoms 1 region box\n"
    );
    let folder = with_deck(&deck);
    let o = perigrain(folder.path(), &["-in", "in.x", "-log", "none", "-ranks", "5"]);
    let words = output_of(&o);
    assert_eq!(o.status.code(), Some(1), "{words}");
    assert!(words.contains("PG0203") && words.contains("start one on each machine"), "{words}");
    // A container may have less than one rank wants.
    assert!(words.contains("for 5 ranks with ") || words.contains("for a rank"), "{words}");
    assert_eq!(words.matches("would need").count(), 1, "one rank says it: {words}");
}
