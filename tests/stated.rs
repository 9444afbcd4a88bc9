//! What ops state about the fields that they touch is true: none touches more, and none states more than it ever uses.
//!
//! Marks on the fields and the account of them are there in debug builds only, and are the process's: a binary of its own.
#![cfg(debug_assertions)]
#![allow(clippy::unwrap_used)] // a test fails by panicking

#[path = "common/examples.rs"]
mod examples;
#[path = "common/pages.rs"]
mod scene;

use examples::{Vars, examples};
use perigrain::cli::manual::pages;
use perigrain::diag::render;
use perigrain::session::{Options, Session};
use perigrain_plan::needs::{collect, collected, how};
use perigrain_world::{Compat, field};
use scene::{Folder, deck, hosted, is_for_the_shell};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// What may be stated and not be used by any of these decks: the file of the statement, fields, why.
const SPARED: &[(&str, &str, &str)] = &[
    ("dumps/src/base.rs", "omega torque molecule", "which columns a dump has is the deck's"),
    ("fixes/src/ave_atom.rs", "f", "what is averaged is the deck's"),
    ("fixes/src/ave_chunk.rs", "f", "what is averaged is the deck's"),
    ("fixes/src/ave_histo.rs", "f", "what is averaged is the deck's"),
    ("deform/op.rs", "slots", "only where a variable moves the box"),
    (
        "fixes/src/time_step.rs",
        "contacts radius bonds id lists molecule omega travel",
        "only where grains touch",
    ),
    (
        "graph/ledger.rs",
        "x f torque contacts id molecule box bonds lists travel facts",
        "only where grains touch",
    ),
    (
        "graph/values.rs",
        "f lists memo molecule omega regions torque type_mass",
        "what formulas read is the deck's",
    ),
    ("fixes/src/evaporate.rs", "x mask", "only where its time has come"),
    ("graph/dynamic.rs", "x regions", "only groups by region look at places"),
    (
        "graph/joined.rs",
        "box columns image x v quat mask memo radius mass",
        "only where particles come during a run, and by what takes note of them",
    ),
    ("granular/mdr.rs", "tally", "only where virials are asked for"),
    ("bpm_peri/op.rs", "v", "only where bonds are damped"),
    // `tests/scripts/good` uses these, in processes of their own.
    ("chunk/atom.rs", "regions", "only bins of regions"),
    ("property_atom.rs", "molecule", "only `mol`"),
    ("addforce.rs", "regions", "only with `region`"),
    ("deform/op.rs", "x0", "only where solids follow the box"),
    ("deform/op.rs", "lists", "only where a box leans so far that it is flipped"),
    ("rigid.rs", "tally columns", "only with virials, and those of particles"),
    ("viscous_sphere.rs", "slots", "only with a variable for each"),
    ("bond/driver.rs", "lists", "only where broken bonds free pairs"),
    ("granular/force.rs", "columns", "only with heat"),
    ("peri/force.rs", "radius lists", "only beside grains"),
    ("graph/ledger.rs", "x0", "only beside solids"),
    ("graph/ledger.rs", "v omega radius volume families mask columns", "only where fixes push or drive"),
    ("wall_region.rs", "id tally", "only where a particle is lost, and where virials are asked for"),
    ("graph/row.rs", "lists", "only rows that count rebuilds"),
    ("wall/op.rs", "columns", "only with heat"),
    ("contact_atom.rs", "x0", "only beside solids"),
    ("graph/virials.rs", "x0", "only beside solids"),
    ("graph/pressed.rs", "x0", "only where solids touch"),
    (
        "fixes/src/print.rs",
        "x f torque omega radius mass type type_mass mask image molecule columns controls memo box regions v id",
        "what formulas read is the deck's",
    ),
    ("bond_break.rs", "v", "only beside a ledger"),
    ("massflow_mesh.rs", "v mass id", "only where a grain passes"),
    ("langevin.rs", "rank", "only where grains stand in the order of space"),
    ("wall/op.rs", "box", "only where grains of a restart file touch regions"),
    ("damping_cundall.rs", "slots", "only with `scale v_name`"),
    ("granular/force.rs", "facts", "only where plastic grains overlap deeply"),
    ("graph/joined.rs", "v mask", "only where molecules that come are bodies"),
    ("deform/op.rs", "id", "only where peridynamic bonds cross faces"),
    ("pair_local.rs", "memo", "only where pairs of central laws are asked"),
    ("group_group.rs", "memo", "only where pairs of central laws are asked"),
    ("property_local.rs", "memo", "only where pairs of central laws are asked"),
    ("fabric.rs", "memo", "only where pairs of central laws are asked"),
    ("graph/virials.rs", "memo", "only where pairs of central laws are asked"),
    ("addtorque_atom.rs", "regions", "only with `region`"),
    ("settorque_atom.rs", "regions", "only with `region`"),
    ("efield.rs", "regions", "only with `region`"),
    ("heat/peri.rs", "facts", "only with edges"),
    ("insert/op.rs", "mass", "only where a mass is filled up"),
    ("peri_strength.rs", "id", "only where a factor is refused"),
    ("surface/op.rs", "radius", "only with `mode auto`"),
    ("wall/op.rs", "type", "only with laws by type, or wear"),
];

/// Pages whose example solids of LAMMPS refuse.
const OWN: [&str; 1] = ["fix peri/strength"];

/// The ops that put particles elsewhere, by file. `tests/strangers/movers.rs` holds what each does to whatever has a direction: an op that
/// joins this list has its lines there.
const MOVERS: [&str; 10] = [
    "/nve.rs",
    "/nve_sphere.rs",
    "/nve_limit.rs",
    "/nve_noforce.rs",
    "/move_fix.rs",
    "/rigid.rs",
    "/recenter.rs",
    "/deform/op.rs",
    "/wall_reflect.rs",
    "/insert/flight.rs",
];

/// Examples that end after a few steps of each run; others wait for something that takes its time.
const EXAMPLES: [&str; 3] = ["in.multiscale_bed", "in.plate_impact", "in.laminate_erosion"];

/// The working folder is this test's.
static ALONE: Mutex<()> = Mutex::new(());

/// So many steps show what an op does.
const STEPS: &str = "12";

#[test]
fn ops_touch_what_they_state_and_state_what_they_touch() {
    collect();
    let mut wrong = String::new();
    for page in pages().iter().filter(|p| !is_for_the_shell(p)) {
        let _folder = Folder::new(ALONE.lock().unwrap());
        let deck = deck(&page.title(), page.doc.example);
        for compat in [false, true] {
            if compat && OWN.contains(&&*page.title()) {
                continue;
            }
            wrong += &run(Path::new(&page.title()), &deck, &vec![], compat);
        }
    }
    for (place, short) in [
        ("fixes", false),
        ("computes", false),
        ("dumps", false),
        ("lammps/decks", true),
        ("lammps/artefacts", true),
    ] {
        for path in files(place) {
            let _folder = Folder::new(ALONE.lock().unwrap());
            for data in files(place).iter().filter(|p| p.extension().is_some_and(|e| e != "in")) {
                fs::copy(data, data.file_name().unwrap()).unwrap();
            }
            if path.extension().is_none_or(|e| e != "in") && !name(&path).starts_with("in.") {
                continue;
            }
            let text = fs::read_to_string(&path).unwrap();
            wrong += &run(&path, &if short { shortened(&text) } else { text }, &vec![], true);
        }
    }
    for (path, vars) in examples().iter().filter(|(path, _)| EXAMPLES.contains(&&*name(path))) {
        let _folder = Folder::new(ALONE.lock().unwrap());
        let text = shortened(&fs::read_to_string(path).unwrap());
        wrong += &run(path, &text, vars, false);
    }
    let (seen, wrong) = judged(wrong);
    assert!(seen.lines().count() > 50, "only these ops ran:\n{seen}");
    assert!(wrong.is_empty(), "{wrong}");
}

/// The kinds of ops that ran, and what is wrong with their statements besides.
fn judged(mut wrong: String) -> (String, String) {
    let mut seen = String::new();
    for ((file, line), account) in collected() {
        for (op, fields) in &account.unstated {
            let _ = writeln!(wrong, "{file}:{line}: op `{op}` {} and does not state it", how(*fields));
        }
        if account.stated[1].has(field::X) && !MOVERS.iter().any(|own| file.ends_with(own)) {
            let _ = writeln!(
                wrong,
                "{file}:{line}: moves particles, and tests/strangers/movers.rs does not know it"
            );
        }
        let [reads, changes] = account.idle();
        for (how, fields) in [("read", reads), ("changed", changes)] {
            for (_, name) in field::FIELDS.iter().filter(|(one, _)| fields.has(*one)) {
                let spared = |(f, words, _): &&(&str, &str, &str)| {
                    file.ends_with(f) && words.split(' ').any(|w| w == *name)
                };
                if !SPARED.iter().any(|s| spared(&s)) {
                    let _ = writeln!(wrong, "{file}:{line}: {name} is stated to be {how} and never is");
                }
            }
        }
        let _ = writeln!(seen, "{file}:{line}");
    }
    (seen, wrong)
}

/// Runs a deck; what is wrong with it.
fn run(path: &Path, text: &str, vars: &Vars, compat: bool) -> String {
    let (name, folder) = (&name(path), path.parent().unwrap().to_path_buf());
    let here = std::env::current_dir().unwrap().to_string_lossy().into_owned();
    let vars = vars.iter().cloned().chain([("dir".to_string(), vec![here])]).collect();
    let compat = if compat { Compat::Lammps2025 } else { Compat::Perigrain };
    let mut session = hosted(Session::new(Options { vars, folder, compat, ..Options::default() }).unwrap());
    match session.run_text(name, text) {
        Ok(_) => String::new(),
        Err(e) => format!("--- {name}\n{}\n", render::plain(&e, &session.sources)),
    }
}

/// Runs of a few steps, pictures of few pixels.
fn shortened(text: &str) -> String {
    let line = |line: &str| match line.trim_start().strip_prefix("run ") {
        Some(rest) => {
            let more = rest.trim_start().split_once(char::is_whitespace).map_or("", |(_, more)| more);
            format!("run {STEPS} {}\n", if more.contains("upto") { "" } else { more })
        }
        // A picture of a sixteenth of the size shows as much of what an op does.
        None => format!("{}\n", line.replace("size 1280 480", "size 320 120")),
    };
    text.lines().map(line).collect()
}

fn files(place: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(place);
    let mut all: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_file()).collect();
    all.sort();
    all
}

fn name(path: &Path) -> String {
    path.file_name().unwrap().to_string_lossy().into_owned()
}
