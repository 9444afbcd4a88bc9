//! Every example of the manual runs in a small scene, and the pages list what there is.

use crate::scene::{Folder, SCENE, deck, hosted, is_for_the_shell};
use perigrain::cli::manual::pages;
use perigrain::diag::render;
use perigrain::graph::catalogue::DECLARATIONS;
use perigrain::output::log::Log;
use perigrain::session::{Mode, OWN, Options, Session};
use std::fmt::Write as _;
use std::io::Write;
use std::process::Command;
use std::sync::{Arc, Mutex};

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

/// A ball on a spring, for benches.
const BALL: &str = "\
variable     dt index 0.01
units        si
atom_style   sphere
atom_modify  map array
boundary     f f f
region       box block -2 2 -2 2 -2 2
create_box   1 box
create_atoms 1 single 0 0 1
set          group all diameter 0.1
set          group all density $(6/PI/0.001)
variable     pull equal -z[1]
fix          spring all addforce 0 0 v_pull
fix          move all nve
timestep     ${dt}
variable     height equal z[1]
thermo_style custom step time ke
thermo       $(round(0.04/v_dt))
run          $(round(0.4/v_dt))
";

/// The output of a session.
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

/// Runs a deck through the library: its output, or the messages that refuse it.
fn works(name: &str, deck: &str) -> Result<String, String> {
    works_in(Mode::Run, name, deck)
}

fn works_in(mode: Mode, name: &str, deck: &str) -> Result<String, String> {
    let heard = Heard::default();
    let log = Log::new(Some(Box::new(heard.clone())));
    let mut session = hosted(Session::new(Options { mode, log, ..Options::default() }).unwrap());
    match session.run_text(name, deck) {
        Ok(_) => Ok(String::from_utf8_lossy(&heard.0.lock().unwrap()).into_owned()),
        Err(problems) => Err(render::plain(&problems, &session.sources)),
    }
}

/// The part of a session's output before the first run, which holds what examples print.
fn own(printed: &str) -> String {
    printed
        .lines()
        .filter(|l| !l.starts_with(' '))
        .take_while(|l| !l.starts_with("Loop time"))
        .fold(String::new(), |t, l| t + l + "\n")
}

#[test]
fn every_example_runs() {
    let mut wrong = String::new();
    let mut ran = 0;
    for page in pages().iter().filter(|p| !is_for_the_shell(p)) {
        let title = page.title();
        let _folder = Folder::new(super::folder());
        let deck = deck(&title, page.doc.example);
        ran += 1;
        if let Err(printed) = works_in(Mode::Check, &title, &deck) {
            let _ = writeln!(wrong, "--- check {title}\n{printed}");
        }
        match works(&title, &deck) {
            Err(printed) => {
                let _ = writeln!(wrong, "--- {title}\n{printed}");
            }
            Ok(printed) => {
                for (_, line) in PRINTS.iter().filter(|(t, _)| *t == title) {
                    if !printed.lines().any(|l| l.trim() == *line) {
                        let _ =
                            writeln!(wrong, "--- {title}\ndoes not print {line:?} but\n{}", own(&printed));
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
    let _folder = Folder::new(super::folder());
    std::fs::write("in.plate", SCENE).unwrap();
    std::fs::write("in.ball", BALL).unwrap();
    std::fs::write("in.grains", include_str!("liggghts/golden/epsd_pair.in")).unwrap();
    for page in pages().iter().filter(|p| is_for_the_shell(p)) {
        for line in page.doc.example.lines() {
            let words = line.split_whitespace().skip(1);
            let output = Command::new(env!("CARGO_BIN_EXE_perigrain")).args(words).output().unwrap();
            let printed = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{line}\n{printed}");
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
    let _folder = Folder::new(super::folder());
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
    if let Err(printed) = works("formulas", &deck) {
        panic!("{printed}");
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
    let _folder = Folder::new(super::folder());
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
    let printed = works("in.fall", &deck.replacen("diameter", "diametre", 1)).unwrap_err();
    assert_eq!(printed.trim(), shown.trim());
}

#[test]
fn every_command_has_one_page() {
    let commands = DECLARATIONS.iter().chain(&OWN);
    for name in commands {
        let found = pages().iter().filter(|p| p.kind == "command" && p.name == *name).count();
        assert_eq!(found, 1, "{name}");
    }
}
