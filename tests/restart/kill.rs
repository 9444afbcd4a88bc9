//! A run killed at arbitrary times: its files are whole, and a run that continues from them ends with the same bits.
//!
//! Eight kills by default; `PERIGRAIN_KILLS=100` for more.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A block that bursts, with everything written often; `STEPS` steps.
const DECK: &str = "units si\natom_style peri\nboundary s s s\nlattice sc 0.001\nregion blk block 0 6 0 4 0 4\n\
    create_box 1 blk\ncreate_atoms 1 region blk\nset group all density 2400\nset group all volume 1e-9\n\
    variable u atom 6000.0*(x-0.003)\nvelocity all set v_u 0 0 units box\n";
const AGAIN: &str = "pair_style peri/pmb\npair_coeff * * 1.6e21 0.0030001 0.0015 0.25\nneighbor 0.0006 bin\n\
    fix 1 all nve\nfix 2 all dt/reset 10 1e-9 5e-8 1e-6 units box\ncompute dmg all damage/atom\n\
    thermo_style custom step time pe ke\nthermo_modify format float %24.17g flush yes\nthermo 1\n\
    restart 3 even.restart odd.restart\nrestart 5 each.*.restart\n\
    dump 1 all custom 4 dump.*.txt id x y z vx vy vz fx fy fz c_dmg\ndump_modify 1 format float %.17g\n";
const STEPS: i64 = 160;

fn perigrain(folder: &Path, deck: &str, log: &str) -> Child {
    fs::write(folder.join(deck), text(deck)).unwrap();
    Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .args(["-in", deck, "-log", log, "-screen", "none", "-threads", "1"])
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn text(deck: &str) -> String {
    let end = format!(
        "run {STEPS} upto\nwrite_dump all custom last.txt id x y z vx vy vz fx fy fz c_dmg modify format float %.17g"
    );
    match deck.strip_prefix("from.") {
        None => format!("{DECK}{AGAIN}{end}\n"),
        Some(file) => format!("read_restart {file}\n{AGAIN}{end}\n"),
    }
}

fn finish(folder: &Path, deck: &str, log: &str) {
    let output = perigrain(folder, deck, log).wait_with_output().unwrap();
    assert!(output.status.success(), "{deck}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Files that a restart could come from.
fn restarts(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|n| n.ends_with(".restart") && !n.starts_with('.')).collect();
    names.sort();
    names
}

fn rows(log: &Path) -> Vec<String> {
    let numbers =
        |l: &&str| l.split_whitespace().count() > 1 && l.split_whitespace().all(|w| w.parse::<f64>().is_ok());
    fs::read_to_string(log).unwrap().lines().filter(numbers).map(String::from).collect()
}

/// A stream of whole numbers that is the same every time.
fn random(seed: &mut u64) -> u64 {
    *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    *seed >> 33
}

#[test]
fn what_a_killed_run_leaves_is_whole_and_continues() {
    let kills: u32 = std::env::var("PERIGRAIN_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(4);
    let whole = tempfile::tempdir().unwrap();
    let began = Instant::now();
    finish(whole.path(), "in.deck", "log.deck");
    let time = began.elapsed().as_millis() as u64;
    let last = fs::read_to_string(whole.path().join("last.txt")).unwrap();
    let whole_rows = rows(&whole.path().join("log.deck"));
    let (mut seed, mut files, mut resumed, mut early) = (2026u64, 0usize, 0, 0);
    for _ in 0..kills {
        let folder = tempfile::tempdir().unwrap();
        let mut child = perigrain(folder.path(), "in.deck", "log.deck");
        std::thread::sleep(Duration::from_millis(random(&mut seed) % (time + 1)));
        child.kill().unwrap(); // SIGKILL
        child.wait().unwrap();
        let left = restarts(folder.path());
        files += left.len();
        for file in &left {
            let saved = perigrain::output::restart::read(&folder.path().join(file));
            assert!(saved.is_ok(), "{file}: {}", saved.unwrap_err());
        }
        if left.is_empty() {
            early += 1;
            continue;
        }
        let file = &left[random(&mut seed) as usize % left.len()];
        finish(folder.path(), &format!("from.{file}"), "log.rest");
        resumed += 1;
        assert_eq!(fs::read_to_string(folder.path().join("last.txt")).unwrap(), last, "from {file}");
        // The rows of the killed run, and of the rest: every row is one of the whole run's; a line cut short is not read as a row
        // of the same length.
        let wanted: Vec<&String> = whole_rows.iter().collect();
        for row in rows(&folder.path().join("log.rest")) {
            assert!(wanted.contains(&&row), "from {file}: {row}");
        }
        for entry in fs::read_dir(whole.path()).unwrap().map(|e| e.unwrap()) {
            let name = entry.file_name().into_string().unwrap();
            let other = folder.path().join(&name);
            if name.starts_with("dump.") && other.exists() {
                assert_eq!(fs::read(entry.path()).unwrap(), fs::read(other).unwrap(), "{name} from {file}");
            }
        }
    }
    println!(
        "{kills} kills within {time} ms: {files} restart files, all whole; {resumed} runs continued to the same bits, {early} had none yet"
    );
    assert!(early < kills, "every run was killed before its first restart file");
}
