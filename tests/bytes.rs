//! No panic, whatever the bytes of a deck: arbitrary text, words in the wrong places, good decks with a word changed.

use perigrain::diag::render;
use perigrain::session::{Mode, Options, Session};
use proptest::prelude::*;

const SCENE: &str = include_str!("scripts/scene.in");

/// Reads a deck in every mode; only a panic fails. Messages must be printable too.
fn swallow(deck: &str) {
    for mode in [Mode::Check, Mode::Plan, Mode::Run] {
        let mut session = Session::new(Options { mode, ..Options::default() }).unwrap();
        if let Err(problems) = session.run_text("in.deck", deck) {
            assert!(!problems.is_empty());
            assert!(!render::plain(&problems, &session.sources).is_empty());
        }
    }
}

/// Words that mean something somewhere; none that opens files or jumps, for then a test might write or never end.
const WORDS: &[&str] = &[
    "units",
    "si",
    "lj",
    "atom_style",
    "peri",
    "sphere",
    "hybrid",
    "lattice",
    "sc",
    "fcc",
    "region",
    "block",
    "r",
    "box",
    "create_box",
    "create_atoms",
    "single",
    "random",
    "set",
    "group",
    "all",
    "type",
    "density",
    "volume",
    "diameter",
    "pair_style",
    "peri/pmb",
    "granular",
    "pair_coeff",
    "*",
    "hertz/material",
    "tangential",
    "mindlin",
    "NULL",
    "fix",
    "nve",
    "setforce",
    "indent",
    "sphere",
    "gravity",
    "vector",
    "viscous",
    "compute",
    "reduce",
    "sum",
    "damage/atom",
    "ke",
    "c_1",
    "f_1",
    "v_a",
    "${a}",
    "$(1/0)",
    "$(",
    "\"",
    "'",
    "&",
    "variable",
    "equal",
    "atom",
    "index",
    "loop",
    "a",
    "sqrt(x)",
    "if",
    "then",
    "else",
    "next",
    "velocity",
    "create",
    "ramp",
    "vx",
    "displace_atoms",
    "delete_atoms",
    "overlap",
    "thermo",
    "thermo_style",
    "custom",
    "step",
    "pe",
    "press",
    "neighbor",
    "bin",
    "neigh_modify",
    "every",
    "timestep",
    "run",
    "upto",
    "start",
    "boundary",
    "p",
    "s",
    "f",
    "m",
    "mass",
    "dimension",
    "2",
    "clear",
    "unfix",
    "1",
    "0",
    "-1",
    "3",
    "0.5",
    "1e-8",
    "1e300",
    "nan",
    "inf",
    "units",
    "lattice",
    "box",
    "INF",
    "EDGE",
    "side",
    "out",
    "union",
    "intersect",
    "print",
    "reset_timestep",
    "newton",
    "off",
    "unknown",
    "größe",
    "\u{0}",
    "#",
];

fn words() -> impl Strategy<Value = String> {
    let line = prop::collection::vec(prop::sample::select(WORDS), 0..9).prop_map(|w| w.join(" "));
    prop::collection::vec(line, 0..12).prop_map(|l| l.join("\n"))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        swallow(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn words_in_any_order(deck in words()) {
        swallow(&deck);
    }

    #[test]
    fn a_scene_continues_in_any_way(deck in words()) {
        swallow(&format!("{SCENE}run 1\n{deck}\nrun 1\n"));
    }

    #[test]
    fn a_scene_with_words_exchanged(
        changes in prop::collection::vec((0..120usize, prop::sample::select(WORDS)), 1..4),
    ) {
        let mut lines: Vec<Vec<&str>> = SCENE.lines().map(|l| l.split_whitespace().collect()).collect();
        for (at, word) in changes {
            let count: usize = lines.iter().map(Vec::len).sum();
            if let Some(slot) = lines.iter_mut().flatten().nth(at % count) {
                *slot = word;
            }
        }
        let deck: Vec<String> = lines.iter().map(|l| l.join(" ")).collect();
        swallow(&format!("{}\nrun 2\n", deck.join("\n")));
    }
}
