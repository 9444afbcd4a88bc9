//! `perigrain check`: all mistakes of a deck at once, in no time, and no warning where nothing is wrong.

#[path = "checks/written.rs"]
mod written;

use perigrain::diag::{Code, Diagnostic, Severity};
use perigrain::output::log::Log;
use perigrain::session::{Mode, Options, Session};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Ten mistakes, each with the columns of the wrong word and a part of the message.
const PLANTED: &[(usize, usize, usize, &str, &str)] = &[
    (9, 1, 8, "PG0102", "unknown command `boundery`"),
    (15, 34, 37, "PG0124", "there is no region `blok`"),
    (17, 28, 35, "PG0104", "unknown keyword of set: `diametre`"),
    (20, 17, 25, "PG0103", "unknown fix style `nve/spher`"),
    (21, 7, 13, "PG0123", "there is no group `boundry`"),
    (22, 23, 26, "PG0107", "the velocity must be a number, not `-1.O`"),
    (23, 26, 30, "PG0104", "no column `epiar`"),
    (25, 18, 29, "PG0103", "unknown compute style `damage/atoms`"),
    (26, 10, 17, "PG0125", "variable `spedd` is not defined"),
    (28, 7, 11, "PG0107", "the number of steps must be a whole number, not `1000x`"),
];

#[test]
fn ten_planted_mistakes_are_all_found_at_once() {
    let deck = include_str!("checks/ten.in");
    // Once to load what is loaded once; then as long as a check of an open file in an editor takes.
    check(deck, Path::new("."));
    let begin = Instant::now();
    let (printed, session) = check(deck, Path::new("."));
    let time = begin.elapsed();
    let mut found = String::new();
    for d in printed.iter().filter(|d| d.severity == Severity::Error) {
        let span = d.span.unwrap();
        let (line, column) = session.sources.place(span);
        let _ = writeln!(
            found,
            "{line}:{column}-{} {} {}",
            column + (span.end - span.start) as usize - 1,
            d.code,
            d.message
        );
    }
    for (line, from, to, code, part) in PLANTED {
        let begin = format!("{line}:{from}-{to} {code} ");
        assert!(
            found.lines().any(|l| l.starts_with(&begin) && l.contains(part)),
            "{begin}{part} is not among\n{found}"
        );
    }
    assert_eq!(found.lines().count(), PLANTED.len(), "{found}");
    assert!(time < Duration::from_millis(50), "{time:?}");
}

fn check(deck: &str, folder: &Path) -> (Vec<Diagnostic>, Session) {
    looked_at(Mode::Check, deck, folder)
}

/// All problems of a deck that is checked or planned.
fn looked_at(mode: Mode, deck: &str, folder: &Path) -> (Vec<Diagnostic>, Session) {
    let options = Options { mode, log: Log::silent(), folder: folder.into(), ..Options::default() };
    let mut session = Session::new(options).unwrap();
    let outcome = session.run_text("in.deck", deck);
    let mut all = session.notes.0.clone();
    all.extend(outcome.err().into_iter().flat_map(|e| e.0));
    (all, session)
}

/// Decks that draw a warning rightly: name, a part of it.
const RIGHTLY: &[(&str, &str)] = &[
    // `clear` went back to units lj, so that `lattice sc 0.001` has a spacing of 10.
    ("pd_data.in", "shorter than the lattice spacing"),
    // Half of an impact is one sphere that flies.
    ("reduced.in", "no pair_style"),
    // 30 steps of loops and formulas: its contacts, which last 8 steps, do not matter.
    ("misc_script.in", "longer than a tenth of a contact"),
    // Contacts of the grains that it pours last nine steps.
    ("gran_pour.in", "longer than a tenth of a contact"),
];

#[test]
fn decks_that_are_right_give_no_messages() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let below = |folder: &str| {
        let entries = fs::read_dir(root.join(folder)).unwrap();
        entries.map(|e| e.unwrap().path()).collect::<Vec<PathBuf>>()
    };
    let examples = below("examples").into_iter().filter(|p| p.is_dir()).flat_map(|p| {
        let entries = fs::read_dir(p).unwrap();
        entries
            .map(|e| e.unwrap().path())
            .filter(|p| p.file_name().unwrap().to_string_lossy().starts_with("in."))
            .collect::<Vec<_>>()
    });
    let decks = examples.chain(below("tests/lammps/decks")).chain(below("tests/lammps/artefacts"));
    let (mut wrong, mut count) = (String::new(), 0);
    for path in decks.filter(|p| !p.to_string_lossy().contains("data.")) {
        let text = fs::read_to_string(&path).unwrap();
        let (printed, _) = check(&text, path.parent().unwrap());
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        count += 1;
        for d in printed.iter().filter(|d| d.severity > Severity::Note) {
            if !RIGHTLY.iter().any(|(n, part)| *n == name && d.message.contains(part)) {
                let _ = writeln!(wrong, "{name}: {}", d.message);
            }
        }
    }
    assert!(count > 15, "only {count} decks");
    assert!(wrong.is_empty(), "{wrong}");
}

/// Warnings that need a reason in a small deck that is good: most others are what the deck is about.
const NEEDS_REASON: [Code; 3] = [Code::UNREACHABLE, Code::UNSTABLE, Code::HORIZON];

#[test]
fn small_good_decks_are_good_for_check_too() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scripts/good");
    let (mut wrong, mut count) = (String::new(), 0);
    for file in fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()) {
        let text = fs::read_to_string(&file).unwrap();
        for block in text.split("--- ").skip(1) {
            let (name, deck) = block.split_once('\n').unwrap();
            let (printed, _) = check(&deck.replace("@scene\n", &format!("{SCENE}\n")), Path::new("."));
            count += 1;
            for d in printed.iter().filter(|d| d.severity > Severity::Note) {
                let expected = ["# warning", "# check warning"]
                    .iter()
                    .any(|w| deck.contains(&format!("{w}: {}", d.message)));
                if !expected && (d.severity == Severity::Error || NEEDS_REASON.contains(&d.code)) {
                    let _ = writeln!(
                        wrong,
                        "{} {name}: {}",
                        file.file_name().unwrap().to_string_lossy(),
                        d.message
                    );
                }
            }
        }
    }
    assert!(count > 100, "only {count} decks");
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn small_good_decks_have_plans() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scripts/good");
    let files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    let next = AtomicUsize::new(0);
    let wrong: Mutex<String> = Mutex::default();
    let work = || {
        while let Some(file) = files.get(next.fetch_add(1, Ordering::Relaxed)) {
            let text = fs::read_to_string(file).unwrap();
            for block in text.split("--- ").skip(1) {
                let (name, deck) = block.split_once('\n').unwrap();
                let deck = deck.replace("@scene\n", &format!("{SCENE}\n"));
                let (printed, _) = looked_at(Mode::Plan, &deck, Path::new("."));
                for d in printed.iter().filter(|d| d.severity == Severity::Error) {
                    let file = file.file_name().unwrap().to_string_lossy();
                    let _ = writeln!(wrong.lock().unwrap(), "{file} {name}: {}", d.message);
                }
            }
        }
    };
    std::thread::scope(|s| (0..2).for_each(|_| drop(s.spawn(work))));
    let wrong = wrong.into_inner().unwrap();
    assert!(wrong.is_empty(), "{wrong}");
}

/// Warnings of one deck as `line:from-to message`.
#[track_caller]
fn warns(deck: &str, wanted: &[&str]) {
    let (printed, session) = check(deck, Path::new("."));
    let text = |d: &Diagnostic| {
        let span = d.span.unwrap();
        let (line, column) = session.sources.place(span);
        format!("{line}:{column} {}", d.message)
    };
    let found: Vec<String> = printed.iter().filter(|d| d.severity > Severity::Note).map(text).collect();
    assert_eq!(found.len(), wanted.len(), "{found:?}");
    for w in wanted {
        assert!(found.iter().any(|f| f.starts_with(w)), "{w} is not among {found:?}");
    }
}

const SCENE: &str = include_str!("scripts/scene.in");

#[test]
fn the_time_step_is_held_against_the_stiffest_bonds() {
    // √(ρ/(π c δ²)) = √(2500/(π 2e21 0.0030001²)) = 2.1e-7
    warns(&format!("{SCENE}\ntimestep 2e-7\nrun 10\n"), &[]);
    warns(&format!("{SCENE}\ntimestep 2.2e-7\nrun 10\n"), &["16:1 the time step 2.2e-7 is longer"]);
    warns(&format!("{SCENE}\ntimestep 2.2e-7\nfix t all dt/reset 10 NULL NULL 0.1\nrun 10\n"), &[]);
}

#[test]
fn a_fix_that_moves_to_another_group_gives_a_warning() {
    let deck = format!("{SCENE}\ngroup few id 1:9\nfix d all viscous 1\nfix d GROUP viscous 2\nrun 10\n");
    warns(&deck.replace("GROUP", "few"), &["18:7 fix `d` concerns another group"]);
    warns(&deck.replace("GROUP", "all").replace("group few id 1:9", ""), &[]);
}

#[test]
fn horizons_on_a_shell_of_neighbours_are_seen() {
    let with = |h: &str| SCENE.replace("0.0030001", h) + "\nrun 1\n";
    warns(&with("0.0030001"), &[]);
    warns(
        &with("0.003"),
        &["12:26 the horizon is exactly 3 lattice spacings, where each particle has 30 neighbours"],
    );
}

#[test]
fn warnings_are_given_where_they_belong_and_nowhere_near() {
    let grains =
        "units si\natom_style sphere\nboundary f f f\nregion b block -5 5 -5 5 -5 15\ncreate_box 1 b\n";
    let law = "pair_style gran/hooke/history 20000.0 NULL 50.0 NULL 0.5 0\npair_coeff * *\ntimestep 0.0001\n";
    let pour = "region s block -4 4 -4 4 10 14\nfix g all gravity 1 vector 0 0 -1\n\
                fix p all pour 9 1 44 region s dens 2500 2500\n";
    let one = "create_atoms 1 single 0 0 0\n";
    let sized = "set group all diameter 1\nset group all density 2500\n";
    let (move_it, go) = ("fix 1 all nve/sphere\n", "run 10\n");
    // no forces
    warns(&[grains, one, sized, "timestep 0.0001\n", move_it, go].concat(), &["11:1 no pair_style"]);
    warns(&[grains, one, sized, law, move_it, go].concat(), &[]);
    // no motion, but none is wanted in a run of no steps
    warns(&[grains, one, sized, law, go].concat(), &["12:1 no fix moves any particle"]);
    warns(&[grains, one, sized, law, "run 0\n"].concat(), &[]);
    // moved twice
    warns(
        &[grains, one, sized, law, move_it, "fix 2 all nve\n", go].concat(),
        &["13:1 fixes `1` and `2` both"],
    );
    warns(&[grains, one, sized, law, move_it, "unfix 1\nfix 2 all nve\n", go].concat(), &[]);
    // never set, also where some are poured and others are not
    let never = ["13:1 the diameter of particles", "13:1 the density of particles"];
    warns(&[grains, pour, law, move_it, go].concat(), &[]);
    warns(
        &[grains, one, pour, law, move_it, go].concat(),
        &never.map(|w| w.replacen("13", "14", 1)).each_ref().map(String::as_str),
    );
    warns(&[grains, one, pour, sized, law, move_it, go].concat(), &[]);
}

#[test]
fn what_only_a_run_determines_is_no_mistake() {
    let deck = "run 10\nvariable n equal count(all)-count(all)\nvariable a equal 1/v_n\nvariable l equal ln(-v_n)\n\
        print \"$(v_a) $(c_thermo_pe/0) $(x[1]/(x[2]-x[2]))\"\nvariable i loop 3 ${n}\nlabel turn\nvariable k equal $(v_i+1)\n\
        next i\njump SELF turn\nif \"${k} == 1\" then \"unfix 1\" else \"unfix 1\"\nlabel wait\nvariable m loop 3\nlabel more\n\
        if \"$(ke) > 1\" then \"variable q equal 0\" \"jump SELF out\"\nnext m\njump SELF more\nlabel out\nprint \"$m\"\n\
        if \"$(ke) > 1\" then \"jump SELF wait\"\nvariable q equal 5\nprint \"$(1/(v_q-5+v_n))\"\n\
        fix 2 all ave/time ${n} 1 ${n} c_thermo_pe\nif \"0 && ${n}\" then nonsense\nregion r sphere 0 0 0 $(-v_n)\n\
        create_atoms 1 region r\nfix 1 all nve\nrun ${n}\nrun 10 upto\nrun 10 start 10 stop 40\nrun 1000000 every 1 NULL\n";
    for mode in [Mode::Check, Mode::Plan] {
        let (printed, session) = looked_at(mode, &format!("{SCENE}\n{deck}"), Path::new("."));
        let errors: Vec<_> = printed.iter().filter(|d| d.severity == Severity::Error).collect();
        assert!(errors.is_empty(), "{mode:?}: {errors:?}");
        assert!(session.world.n() <= 125);
    }
}

#[test]
fn lines_behind_quit_and_unused_names() {
    warns("units si\nquit\n# the rest\n\nrun 100\nrun 200\n", &["5:1 this line is never reached"]);
    warns("units si\nif \"1 > 2\" then quit\nprint a\n", &[]);
    warns("jump SELF end\nquit\nlabel end\nprint a\n", &[]);
    warns("quit\nlabel end\nprint a\n", &[]);
    warns("variable a index 1 2\nprint b\n", &["1:10 variable `a` is never used"]);
    warns(&format!("{SCENE}\ngroup left id 1\nrun 1\n"), &["16:7 group `left` is never used"]);
}

#[test]
fn a_value_put_in_shows_where_it_comes_from() {
    let (printed, session) =
        check(&format!("variable s string nve/spher\n{SCENE}\nfix 2 all $s\n"), Path::new("."));
    let d = printed.iter().find(|d| d.severity == Severity::Error).unwrap();
    assert_eq!(session.sources.place(d.span.unwrap()), (17, 11));
    assert_eq!(session.sources.place(d.labels[0].span).0, 1);
}

#[test]
fn several_decks_and_json() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.a"), "unita si\n").unwrap();
    fs::write(folder.path().join("in.b"), "units si\n").unwrap();
    let run = |args: &[&str]| {
        let o = Command::new(env!("CARGO_BIN_EXE_perigrain"))
            .args(args)
            .current_dir(folder.path())
            .output()
            .unwrap();
        (o.status.code(), String::from_utf8(o.stdout).unwrap(), String::from_utf8(o.stderr).unwrap())
    };
    let (code, out, err) = run(&["check", "in.a", "in.b"]);
    assert_eq!((code, out.as_str()), (Some(1), "in.a: 1 error\nin.b: no problems found\n"), "{err}");
    let (code, out, err) = run(&["check", "--json", "in.a", "in.b", "in.c"]);
    assert_eq!((code, err.as_str()), (Some(1), ""));
    let lines: Vec<&str> = out.lines().collect();
    assert_eq!(lines.len(), 2, "{out}");
    assert!(lines[0].starts_with(
        "[{\"file\": \"in.a\", \"line\": 1, \"column\": 1, \"end_column\": 6, \"severity\": \"error\""
    ));
    assert!(lines[1].contains("\"file\": \"in.c\", \"line\": null") && lines[1].ends_with("}]"), "{out}");
    assert_eq!(run(&["check", "--json", "in.b"]), (Some(0), "[]\n".into(), String::new()));
}
