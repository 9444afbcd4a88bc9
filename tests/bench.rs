//! `perigrain bench` from outside: errors, orders, the front, what is left out, and the suite.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// A mass on a spring, which has a closed form: cos(t).
const DECK: &str = "\
variable        n index 50
variable        k index 1
units           si
atom_style      sphere
atom_modify     map array
boundary        f f f
region          box block -2 2 -2 2 -2 2
create_box      1 box
create_atoms    1 single 1 0 0
set             group all diameter 0.1
set             group all density $(6/PI/0.001)
variable        f equal -v_k*x[1]
fix             pull all addforce v_f 0 0
fix             move all nve
timestep        $(1/v_n)
variable        place equal x[1]
variable        exact equal cos(time)
compute         k all ke
thermo_style    custom step time v_place
thermo          $(v_n/10)
run             $(2*v_n)
";

/// Each run once unless repeats are given: what is tested but once is not waited for.
fn bench(folder: &Path, args: &[&str]) -> Output {
    let once: &[&str] = if args.contains(&"-repeat") { &[] } else { &["-repeat", "1"] };
    timed(folder, &[args, once].concat())
}

fn timed(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_perigrain"));
    command.arg("bench").args(args).current_dir(folder).stdin(Stdio::null());
    command.output().unwrap()
}

fn output_of(o: &Output) -> String {
    String::from_utf8_lossy(&o.stdout).into_owned() + &String::from_utf8_lossy(&o.stderr)
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn with_deck(deck: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.x"), deck).unwrap();
    folder
}

/// The numbers of a column of `bench.csv`; none where it is empty.
fn column(folder: &Path, file: &str, name: &str) -> Vec<Option<f64>> {
    let text = read(folder, file);
    let mut rows = text.lines().map(|l| l.split(',').collect::<Vec<_>>());
    let head = rows.next().unwrap();
    let at = head.iter().position(|h| *h == name).unwrap_or_else(|| panic!("no {name} in {head:?}"));
    rows.map(|row| row[at].parse().ok()).collect()
}

#[test]
fn steps_halved_show_the_order_of_velocity_verlet() {
    let folder = with_deck(DECK);
    let at = folder.path();
    let args = [
        "in.x", "-each", "n", "10", "20", "40", "80", "-measure", "v_place", "c_k", "-norm", "rel-l2",
        "-repeat", "2",
    ];
    let o = bench(at, &args);
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    // Differences to the finest run, whose own error is reckoned with: the next term is of fourth order, 0.1 % at these steps.
    let orders = column(at, "in.x.bench/bench.csv", "v_place_order_n");
    assert!(orders[0].is_none() && orders[3].is_none(), "{orders:?}");
    assert!(orders[1..3].iter().all(|p| (p.unwrap() - 2.0).abs() < 5e-3), "{orders:?}");
    // The energy is no column of the deck's own table, and has a series all the same.
    let orders = column(at, "in.x.bench/bench.csv", "c_k_order_n");
    assert!((orders[2].unwrap() - 2.0).abs() < 5e-3, "{orders:?}");
    let text = output_of(&o);
    for words in ["order in n", "reference", "Pareto front", "the least of 2", "a n: order 2.00"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let svg = read(at, "in.x.bench/pareto-1-v_place.svg");
    assert!(svg.contains("n: order 2.00") && svg.contains("Pareto front"), "{svg}");
    assert_eq!(&fs::read(at.join("in.x.bench/pareto-2-c_k.png")).unwrap()[1..4], b"PNG");
    assert_eq!(column(at, "in.x.bench/bench.csv", "repeats"), [Some(2.0); 4]);

    // Nothing is left to do; where a run is missing it is made.
    let before = read(at, "in.x.bench/bench.csv");
    let o = bench(at, &args);
    assert!(o.status.success() && output_of(&o).contains("8 of 8 runs are done"), "{}", output_of(&o));
    assert_eq!(read(at, "in.x.bench/bench.csv"), before);
    let journal = read(at, "in.x.bench/journal");
    // Killed in the fifth run.
    let cut: Vec<&str> = journal.lines().take(10).collect();
    fs::write(at.join("in.x.bench/journal"), cut.join("\n") + "\n").unwrap();
    fs::remove_file(at.join("in.x.bench/0005-repeat=2-n=10/.result")).unwrap();
    for run in ["0006-repeat=2-n=20", "0007-repeat=2-n=40", "0008-repeat=2-n=80"] {
        fs::remove_dir_all(at.join("in.x.bench").join(run)).unwrap();
    }
    let o = bench(at, &args);
    assert!(o.status.success() && output_of(&o).contains("4 of 8 runs are done"), "{}", output_of(&o));
    let o = bench(at, &["in.x", "-status"]);
    assert!(output_of(&o).contains("8 runs ok"), "{}", output_of(&o));
}

#[test]
fn short_runs_are_made_again_until_they_have_taken_50_ms() {
    let folder = with_deck(DECK);
    let at = folder.path();
    let args = ["in.x", "-each", "n", "2000", "4000", "-measure", "v_place"];
    let o = timed(at, &args);
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    let [seconds, runs] = ["seconds", "repeats"].map(|name| column(at, "in.x.bench/bench.csv", name));
    for (s, n) in seconds.into_iter().zip(runs) {
        let (s, n) = (s.unwrap(), n.unwrap());
        // The first run, which takes no less than the least, determines how many there are.
        assert!((n - 1.0) * s < 0.05 && n <= 100.0, "{n} runs of {s} s");
        assert!(n > 1.0 || s >= 0.05, "one run of {s} s");
    }
    // Nothing is left to do.
    let o = timed(at, &args);
    assert!(o.status.success() && output_of(&o).contains("2 of 2 runs are done"), "{}", output_of(&o));
}

#[test]
fn closed_forms_and_files_are_references_too() {
    let folder = with_deck(DECK);
    let at = folder.path();
    let knob = ["in.x", "-each", "n", "20", "40", "80", "-measure", "v_place"];
    let run = |more: &[&str]| bench(at, &[&knob[..], more].concat());
    // A form that changes over time, and a number at the end.
    let o = run(&["-against", "form", "v_exact", "-norm", "max", "-out", "a"]);
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    let errors = column(at, "a/bench.csv", "v_place_error");
    // Velocity Verlet's phase is ahead by t dt²/24: 2.1e-4 sin 2 at n = 20.
    assert!((errors[0].unwrap() - 0.05f64.powi(2) / 12.0 * 2f64.sin()).abs() < 2e-6, "{errors:?}");
    // An order against a form is one over three settings.
    let orders = column(at, "a/bench.csv", "v_place_order_n");
    assert!(orders[1].is_none() && (orders[2].unwrap() - 2.0).abs() < 2e-2, "{orders:?}");
    let o = run(&["-against", "form", "cos(2)", "-norm", "end", "-out", "b"]);
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    assert_eq!(column(at, "b/bench.csv", "v_place_error")[0], errors[0]);
    // Its own log, and a table.
    let log = "b/0002-n=40/log.lammps";
    let o = run(&["-against", "file", log, "-norm", "max", "-out", "c"]);
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    let errors = column(at, "c/bench.csv", "v_place_error");
    assert!(errors[0].unwrap() > 1e-5 && errors[1].unwrap() < 1e-8, "a log has eight digits: {errors:?}");
    let rows: Vec<String> =
        (0..=40).map(|k| f64::from(k) * 0.05).map(|t| format!("{t},{}\n", t.cos())).collect();
    fs::write(at.join("exact.csv"), format!("time,v_place\n{}", rows.concat())).unwrap();
    let o = run(&["-against", "file", "exact.csv", "-norm", "max", "-out", "d"]);
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    let close = column(at, "d/bench.csv", "v_place_error")[0].unwrap()
        / column(at, "a/bench.csv", "v_place_error")[0].unwrap();
    assert!((close - 1.0).abs() < 1e-6, "{close}");
}

#[test]
fn what_is_not_there_is_named_and_the_rest_continues() {
    let folder = with_deck(DECK);
    let at = folder.path();
    let o = bench(
        at,
        &[
            "in.x", "-each", "nn", "1", "2", "-each", "n", "10", "20", "40", "-measure", "v_palce",
            "v_place", "c_q",
        ],
    );
    let text = output_of(&o);
    assert_eq!(o.status.code(), Some(1), "{text}");
    for words in [
        "the deck never uses the variable `nn`",
        "command line:1:28",
        "left out",
        "no variable `palce`",
        "did you mean `v_place`",
        "no compute `q`",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let orders = column(at, "in.x.bench/bench.csv", "v_place_order_n");
    assert!((orders[1].unwrap() - 2.0).abs() < 0.05, "{orders:?}");
    // A reference that ends earlier, one without the column, and one that is not there.
    fs::write(at.join("short.csv"), "time,v_place\n0,1\n0.2,0.98\n0.4,0.92\n").unwrap();
    fs::write(at.join("other.csv"), "time,pe\n0,1\n2,1\n").unwrap();
    for (file, words) in [
        ("short.csv", "it goes from 0 to 2, the reference from 0 to 0.4"),
        ("other.csv", "has no column `v_place`: it has time, pe"),
        ("none.csv", "the reference `none.csv` cannot be read"),
    ] {
        let o = bench(
            at,
            &[
                "in.x",
                "-each",
                "n",
                "10",
                "20",
                "-measure",
                "v_place",
                "-norm",
                "max",
                "-against",
                "file",
                file,
                "-out",
                file.trim_end_matches(".csv"),
            ],
        );
        assert!(o.status.code() == Some(1) && output_of(&o).contains(words), "{file}: {}", output_of(&o));
    }
    // A run that fails is named, the others are measured.
    let o =
        bench(at, &["in.x", "-each", "n", "10", "20", "0", "40", "-measure", "v_place", "-out", "failing"]);
    let text = output_of(&o);
    assert!(o.status.code() == Some(1) && text.contains("n=0: in.x:"), "{text}");
    assert!(column(at, "failing/bench.csv", "v_place_error")[1].is_some());
    // Nothing to turn, nothing to measure, a deck that is wrong.
    assert_eq!(bench(at, &["in.x", "-measure", "pe"]).status.code(), Some(2));
    assert_eq!(bench(at, &["in.x", "-each", "n", "1", "2"]).status.code(), Some(2));
    fs::write(at.join("in.bad"), "variable n index 1\nunitz $n\n").unwrap();
    let o = bench(at, &["in.bad", "-each", "n", "1", "2", "-measure", "pe"]);
    assert!(o.status.code() == Some(1) && output_of(&o).contains("in.bad:2:1"), "{}", output_of(&o));
}

#[test]
fn threads_and_layouts_are_knobs_and_laws_have_their_own_finest_run() {
    let folder = with_deck(DECK);
    let at = folder.path();
    let o = bench(
        at,
        &[
            "in.x", "-threads", "1", "2", "-each", "k", "1", "4", "-each", "n", "10", "20", "40", "-measure",
            "v_place", "-against", "finest", "n",
        ],
    );
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    assert_eq!(column(at, "in.x.bench/bench.csv", "threads")[0], Some(1.0));
    assert_eq!(column(at, "in.x.bench/bench.csv", "threads")[6], Some(2.0));
    let errors = column(at, "in.x.bench/bench.csv", "v_place_error");
    let orders = column(at, "in.x.bench/bench.csv", "v_place_order_n");
    // Each k is compared with its own finest run, with one thread: with two the same bits are no error.
    assert_eq!(errors[0], errors[6]);
    assert!(errors[2].is_none() && errors[5].is_none() && errors[8] == Some(0.0), "{errors:?}");
    assert!([1, 4, 7].iter().all(|k| (orders[*k].unwrap() - 2.0).abs() < 0.1), "{orders:?}");
}

#[test]
fn the_suite_writes_its_page_and_a_lammps_stands_beside() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let o = bench(at, &["-suite", "-list"]);
    assert!(o.status.success() && output_of(&o).lines().count() >= 8, "{}", output_of(&o));
    let o = bench(at, &["--suite", "--only", "hertz", "-markdown", "page.md"]);
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    let page = read(at, "page.md");
    for words in [
        "# Benchmarks",
        "## Hertz impact",
        "Theory: ",
        "](page/hertz_impact-1.svg)",
        "| N | seconds |",
        "1 thread,",
    ] {
        assert!(page.contains(words), "{words}: {page}");
    }
    assert!(read(at, "page/hertz_impact-2.svg").contains("rebound"));
    let orders = column(at, "bench.suite/hertz_impact/bench.csv", "overlap_order_N");
    assert!(orders[1..5].iter().all(|p| (p.unwrap() - 2.0).abs() < 0.1), "{orders:?}");
    assert_eq!(bench(at, &["-suite", "-only", "hrtz_impact"]).status.code(), Some(2));
    assert_eq!(bench(at, &["-suite", "-lammps", "no/lmp"]).status.code(), Some(2));
}

#[test]
fn rows_of_bonds_bend_as_rods_to_second_order() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let o = bench(at, &["-suite", "-only", "bonded_wave", "-markdown", "page.md"]);
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    let csv = "bench.suite/bonded_wave/bench.csv";
    let orders: Vec<f64> = column(at, csv, "frequency_order_N").into_iter().flatten().collect();
    // 2.11 and 1.96, in steps of three lengths.
    assert!(orders.len() == 6 && orders.iter().all(|p| (p - 2.0).abs() < 0.2), "{orders:?}");
}

/// A program that answers as LAMMPS does, or fails.
#[cfg(unix)]
fn lammps(folder: &Path, fails: bool) -> String {
    use std::os::unix::fs::PermissionsExt;
    let end = if fails { "ERROR: Unknown pair style (src/force.cpp:1)" } else { "Total wall time: 0:00:01" };
    let log = format!(
        "LAMMPS (22 Jul 2025)\\n   Step  Time  v_overlap  v_rebound\\n 0 0 0 -1\\n 28 4.518e-05 -9.7e-05 1\\n\
         Loop time of 0.5 on 1 procs for 28 steps with 2 atoms\\n{end}\\n"
    );
    let path = folder.join(if fails { "bad" } else { "good" });
    fs::write(&path, format!("#!/bin/sh\nprintf '{log}' > log.lammps\necho \"$@\" > words\n")).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    path.display().to_string()
}

#[cfg(unix)]
#[test]
fn runs_of_lammps_are_read_from_its_log() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let o = bench(at, &["-suite", "-only", "hertz", "-lammps", &lammps(at, false), "-markdown", "a.md"]);
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    let page = read(at, "a.md");
    assert!(page.contains("LAMMPS (22 Jul 2025)") && page.contains("LAMMPS takes "), "{page}");
    let csv = "bench.suite/hertz_impact/bench.csv";
    assert_eq!(column(at, csv, "seconds")[6], Some(0.5));
    assert_eq!(column(at, csv, "rebound")[6], Some(1.0));
    let words = read(at, "bench.suite/hertz_impact/0007-program=lammps-N=25/words");
    assert!(words.contains("-log log.lammps") && words.contains("-var N 25"), "{words}");
    // One that fails is named, and the page has the other numbers.
    let o = bench(
        at,
        &["-suite", "-only", "hertz", "-lammps", &lammps(at, true), "-markdown", "b.md", "-out", "b"],
    );
    let text = output_of(&o);
    assert!(
        o.status.code() == Some(1) && text.contains("program=lammps N=25 and 5 more: LAMMPS: ERROR"),
        "{text}"
    );
    assert!(read(at, "b.md").contains("LAMMPS gave no numbers"));
}
