//! Every example of the manual really runs in a small scene, and the pages tell what there is.

use perigrain::cli::manual::{Page, pages};
use perigrain::diag::render;
use perigrain::graph::build::DECLARATIONS;
use perigrain::out::log::Log;
use perigrain::session::{Mode, OWN, Options, Session};
use std::fmt::Write as _;
use std::io::Write;
use std::process::Command;
use std::sync::{Arc, Mutex, MutexGuard};

/// A bonded plate of type 1 and a sphere of type 2 above it, with everything that examples name.
///
/// An example takes the place of the scene's own lines that say the same ([`subject`]), so that `atom_style …`
/// or `lattice …` stand where such a line belongs; all others come before the last line.
const SCENE: &str = "\
units si
dimension 3
boundary s s s
atom_style hybrid sphere peri
atom_modify map array
newton on
processors * * *
package omp 1
lattice sc 0.001
region world block -0.006 0.006 -0.006 0.006 -0.003 0.009 units box
create_box 3 world
region plate block -0.004 0.004 -0.004 0.004 -0.001 0.001 units box
region disc cylinder z 0 0 0.004 -0.001 0.001 units box
region notch block -0.0005 0.0005 -0.006 0.0 -0.002 0.002 units box
region half block INF INF INF 0.0 INF INF units box
region ball sphere 0 0 0.004 0.001 units box
create_atoms 1 region plate
create_atoms 2 single 0 0 0.004 units box
group plate type 1
group ball type 2
group bullet type 2
group grains type 2
group wall type 3
group foot region half
group top region half
set group ball diameter 0.001
set group all density 2235.0
set group all volume 1e-9
timestep 1.0e-8
neighbor 0.0005 bin
neigh_modify every 5 delay 0 check yes
pair_style peri/pmb
pair_coeff * * 1.6863e22 0.0030001 5.0e-4 0.25
velocity ball set 0 0 -1 units box
fix motion all nve
compute dmg all damage/atom
compute damage all damage/atom
variable force equal fcm(plate,z)
variable speed equal vcm(ball,z)
variable z equal 0.006-2*time
thermo_style custom step time pe ke
thermo 1
run 1
";

/// What a line of the scene is about, if an example's line about the same takes its place: a setting that is
/// there once, or a thing with a name.
fn subject(line: &str) -> Option<Vec<&str>> {
    let mut words = line.split_whitespace();
    let first = words.next()?;
    match first {
        "units" | "dimension" | "boundary" | "atom_style" | "atom_modify" | "newton" | "package"
        | "processors" | "lattice" | "create_box" | "timestep" | "neighbor" | "neigh_modify"
        | "pair_style" | "pair_coeff" | "thermo" | "thermo_style" => Some(vec![first]),
        "region" | "group" | "compute" | "fix" | "variable" => Some(vec![first, words.next()?]),
        _ => None,
    }
}

/// Pages whose examples need other lines in the scene: title, how the scene's line begins, what stands in its place.
const CHANGED: &[(&str, &str, &str)] = &[
    // Only an atom style without masses of its own takes them by type.
    ("mass", "atom_style", "atom_style atomic"),
    ("mass", "set group", ""),
    ("mass", "pair_style", "pair_style none"),
    ("mass", "pair_coeff", ""),
    ("mass", "compute", ""),
    // A flat scene is periodic along z.
    ("fix enforce2d", "dimension", "dimension 2"),
    ("fix enforce2d", "boundary", "boundary s s p"),
    ("fix deform", "boundary", "boundary f s s"),
    ("fix enforce2d", "lattice", "lattice sq 0.001"),
    (
        "fix enforce2d",
        "region world",
        "region world block -0.006 0.006 -0.006 0.006 -0.0005 0.0005 units box",
    ),
    ("fix enforce2d", "create_atoms 2", "create_atoms 2 single 0 0.005 0 units box"),
    ("fix enforce2d", "velocity", "velocity ball set 0 -1 0 units box"),
    // One integrator per particle: the fix moves these itself.
    ("fix move", "fix motion", "group rest subtract all top\nfix motion rest nve"),
];

/// Files that examples read: name, text.
const FILES: &[(&str, &str)] = &[
    ("plate.inc", "print \"from the other file\"\n"),
    (
        "blade.stl",
        "solid blade\nfacet normal 0 0 1\nouter loop\nvertex -3 -3 0\nvertex 3 -3 0\nvertex 0 3 0\nendloop\nendfacet\n\
         endsolid blade\n",
    ),
];

/// What examples must print besides running: title, a line.
const PRINTS: &[(&str, &str)] = &[
    ("decks", "plate of 0.001: half a spacing is 0.0005 m, a third 0.0003333333333333333222"),
    ("formulas", "1.00 m/s, 204 particles in the rim, x of particle 7: 0.0020000000000000000416"),
    ("variable", "impact at 35 m/s, the fastest at 160 m/s: 0.000717 J, turn 1 of [35,70,160]"),
    ("if", "slow"),
    ("label", "turn 2"),
    ("next", "at 160 m/s"),
    ("include", "from the other file"),
    ("clear", "a box of 8"),
];

/// A folder of its own as the working folder, with the files that examples read.
struct Folder {
    path: tempfile::TempDir,
    _alone: MutexGuard<'static, ()>,
}

impl Folder {
    fn new() -> Self {
        let alone = super::folder();
        let path = tempfile::tempdir().unwrap();
        std::env::set_current_dir(&path).unwrap();
        for (name, text) in FILES {
            std::fs::write(name, text).unwrap();
        }
        Self { path, _alone: alone }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // The folder cannot be the working folder when it goes.
        let _ = std::env::set_current_dir(self.path.path().parent().unwrap());
    }
}

/// What a session says.
#[derive(Clone, Default)]
struct Heard(Arc<Mutex<Vec<u8>>>);

impl Write for Heard {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Works a deck off through the library: its output, or the messages that refuse it.
fn works(name: &str, deck: &str) -> Result<String, String> {
    works_in(Mode::Run, name, deck)
}

fn works_in(mode: Mode, name: &str, deck: &str) -> Result<String, String> {
    let heard = Heard::default();
    let log = Log::new(Some(Box::new(heard.clone())));
    let mut session = Session::new(Options { mode, log, ..Options::default() }).unwrap();
    match session.run_text(name, deck) {
        Ok(_) => Ok(String::from_utf8_lossy(&heard.0.lock().unwrap()).into_owned()),
        Err(problems) => Err(render::plain(&problems, &session.sources)),
    }
}

/// The part of a session's output before the first run, which holds what examples print.
fn own(said: &str) -> String {
    said.lines()
        .filter(|l| !l.starts_with(' '))
        .take_while(|l| !l.starts_with("Loop time"))
        .fold(String::new(), |t, l| t + l + "\n")
}

/// The first word of a line.
fn command(line: &str) -> &str {
    line.split_whitespace().next().unwrap_or("")
}

/// Whether an example brings its own integrator for all particles.
fn integrates(example: &str) -> bool {
    example.lines().any(|l| {
        let words: Vec<&str> = l.split_whitespace().collect();
        words.first() == Some(&"fix") && words.get(3).is_some_and(|s| s.starts_with("nve"))
    })
}

/// The scene with an example in it.
fn deck(title: &str, example: &str) -> String {
    if is_whole(example) {
        return example.to_string();
    }
    let subjects: Vec<_> = example.lines().filter_map(subject).collect();
    let no_motion = integrates(example);
    let mut waiting = Some(example.trim_end());
    let mut deck = String::new();
    for line in SCENE.lines() {
        let replaced = subject(line).is_some_and(|s| subjects.contains(&s));
        if (replaced || line == "run 1")
            && let Some(text) = waiting.take()
        {
            let _ = writeln!(deck, "{text}");
        }
        let changed = CHANGED.iter().find(|(t, begin, _)| *t == title && line.starts_with(begin));
        match changed {
            _ if replaced || (no_motion && line.starts_with("fix motion")) => {}
            Some((.., text)) => drop(writeln!(deck, "{text}")),
            None => drop(writeln!(deck, "{line}")),
        }
    }
    deck
}

/// Whether an example is a deck by itself.
fn is_whole(example: &str) -> bool {
    command(example) == "units" && example.lines().count() > 1
}

/// The example of the page about the program itself is for the shell.
fn is_for_the_shell(page: &Page) -> bool {
    command(page.doc.example) == "perigrain"
}

#[test]
fn every_example_runs() {
    let mut wrong = String::new();
    let mut ran = 0;
    for page in pages().iter().filter(|p| !is_for_the_shell(p)) {
        let title = page.title();
        let _folder = Folder::new();
        let deck = deck(&title, page.doc.example);
        ran += 1;
        if let Err(said) = works_in(Mode::Check, &title, &deck) {
            let _ = writeln!(wrong, "--- check {title}\n{said}");
        }
        match works(&title, &deck) {
            Err(said) => {
                let _ = writeln!(wrong, "--- {title}\n{said}");
            }
            Ok(said) => {
                for (_, line) in PRINTS.iter().filter(|(t, _)| *t == title) {
                    if !said.lines().any(|l| l.trim() == *line) {
                        let _ = writeln!(wrong, "--- {title}\ndoes not print {line:?} but\n{}", own(&said));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    assert!(ran > 50, "only {ran} pages");
}

#[test]
fn calls_of_the_program_work() {
    let _folder = Folder::new();
    std::fs::write("in.plate", SCENE).unwrap();
    for page in pages().iter().filter(|p| is_for_the_shell(p)) {
        for line in page.doc.example.lines() {
            let words = line.split_whitespace().skip(1);
            let output = Command::new(env!("CARGO_BIN_EXE_perigrain")).args(words).output().unwrap();
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{line}\n{said}");
        }
    }
}

/// Each function that the page of formulas names, with numbers for its arguments' names.
#[test]
fn every_function_on_the_page_of_formulas_is_there() {
    let page = pages().into_iter().find(|p| p.name == "formulas").unwrap();
    let refused = ["charge(g)"];
    let calls: Vec<&str> = page
        .doc
        .text
        .split('`')
        .skip(1)
        .step_by(2)
        .filter(|c| c.contains('(') && !refused.contains(c))
        .collect();
    assert!(calls.len() > 40, "{calls:?}");
    let _folder = Folder::new();
    let mut deck = SCENE.to_string();
    deck += "variable list vector [3,1,2]\nprint 7 file seven.txt\nvariable NAME file seven.txt\nregion slab block EDGE EDGE EDGE EDGE EDGE EDGE\n";
    for call in &calls {
        let (name, arguments) = call.trim_end_matches(')').split_once('(').unwrap();
        let count = arguments.split(',').count();
        let numbers = match name {
            "sqrt" | "exp" | "ln" | "log" | "abs" | "sin" | "cos" | "tan" | "asin" | "acos" | "atan"
            | "ceil" | "floor" | "round" | "sign" => "0.5",
            "sum" | "min" | "max" | "ave" | "trap" | "slope" => "v_list",
            "sort" | "rsort" => {
                let _ = writeln!(deck, "variable {name} vector {name}(v_list)\nprint ${{{name}}}");
                continue;
            }
            "gmask" | "rmask" | "grmask" => {
                let names = arguments.replace("group", "all").replace("region", "slab");
                let _ = writeln!(deck, "variable {name} atom {name}({names})\nprint $(v_{name}[1])");
                continue;
            }
            "next" => "NAME",
            "is_file" => "seven.txt",
            "is_os" if arguments == "pattern" => "^Linux",
            "is_os" => arguments,
            "is_timeout" => "",
            "is_defined" => "variable,list",
            "is_available" => "fix,nve",
            "is_active" => "pair,single",
            "extract_setting" => "ntypes",
            "stagger" => "10,4",
            "stride" => "0,100,10",
            "stride2" => "0,100,10,20,40,5",
            "logfreq" | "logfreq2" => "10,3,10",
            "logfreq3" => "10,25,1000",
            _ if arguments.starts_with('g') || arguments.starts_with("plate") => {
                let _ = writeln!(deck, "print \"{name} $({name}({}))\"", arguments.replacen('g', "all", 1));
                continue;
            }
            _ => ["1", "1,2", "1,2,3"][count - 1],
        };
        let _ = writeln!(deck, "print \"{name} $({name}({numbers}))\"");
    }
    if let Err(said) = works("formulas", &deck) {
        panic!("{said}");
    }
}

/// Every thermo keyword there is stands on its page.
#[test]
fn the_page_of_thermo_style_names_every_keyword() {
    let page = pages().into_iter().find(|p| p.name == "thermo_style").unwrap();
    let words: Vec<&str> = page.doc.text.split(|c: char| !c.is_ascii_alphanumeric()).collect();
    let missing: Vec<&str> =
        perigrain::graph::keywords::KEYWORDS.iter().map(|k| k.0).filter(|k| !words.contains(k)).collect();
    assert!(missing.is_empty(), "{missing:?}");
    let _folder = Folder::new();
    let all: Vec<&str> = perigrain::graph::keywords::KEYWORDS.iter().map(|k| k.0).collect();
    let deck = SCENE.replace("custom step time pe ke", &format!("custom {}", all.join(" ")));
    works("thermo_style", &deck).unwrap();
}

#[test]
fn the_tour_shows_the_message_that_comes() {
    let tour = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/tour.md")).unwrap();
    let blocks: Vec<&str> =
        tour.split("```text\n").skip(1).filter_map(|block| block.split("```").next()).collect();
    let deck = blocks.iter().find(|b| b.starts_with("units")).unwrap();
    let shown = blocks.iter().find(|b| b.starts_with("error")).unwrap();
    let said = works("in.fall", &deck.replacen("diameter", "diametre", 1)).unwrap_err();
    assert_eq!(said.trim(), shown.trim());
}

#[test]
fn every_command_has_one_page() {
    let commands = DECLARATIONS.iter().chain(&OWN);
    for name in commands {
        let found = pages().iter().filter(|p| p.kind == "command" && p.name == *name).count();
        assert_eq!(found, 1, "{name}");
    }
}
