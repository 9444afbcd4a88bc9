//! The suite: decks that the program carries, with their knobs, their measures, and the theory.
//!
//! They are described in lines that begin with `#|` at the head of a deck, which are comments for the deck.

use super::norm::Norm;
use super::reference::Against;
use super::{Bench, Measure, PROGRAM};
use crate::heads::{self, Headed};
use crate::session::axes::Axis;
use crate::sweep::ranks::Ranks;
use crate::sweep::starter::Starter;
use crate::sweep::{Deck, Settings, Sweep, lammps};
use perigrain_base::diag::Result;
use serde::Deserialize;
use std::path::{Path, PathBuf};

macro_rules! decks {
    ($($name:literal,)*) => {
        &[$(($name, include_str!(concat!("cases/", $name, ".in")))),*]
    };
}

/// The name and text of every case, in the order of the page.
pub const DECKS: &[(&str, &str)] = decks![
    "hertz_impact",
    "oblique_impact",
    "bar_wave",
    "patch_modulus",
    "plate_impact",
    "dense_bed",
    "multiscale_bed",
    "staggered_friction",
    "oblique_ledger",
    "heap_ledger",
    "cantilever",
    "bonded_wave",
    "running_crack",
    "shear_flow",
];

/// A case.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// The deck's name.
    #[serde(skip)]
    pub name: String,
    /// The deck.
    #[serde(skip)]
    pub deck: String,
    /// What it shows, a line.
    pub title: String,
    /// The scene in one or two sentences.
    pub about: String,
    /// Which order is to be expected, and why.
    pub theory: String,
    knob: Vec<Knob>,
    measure: Vec<Wanted>,
    /// Whether LAMMPS can run the deck.
    #[serde(default)]
    pub lammps: Lammps,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Knob {
    name: String,
    values: Vec<String>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Wanted {
    name: String,
    word: String,
    norm: Option<String>,
    form: Option<String>,
    #[serde(default)]
    finest: Vec<String>,
}

/// Whether LAMMPS can run a deck.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lammps {
    /// Why not.
    pub no: Option<String>,
}

/// How the cases are run.
#[derive(Clone, Debug)]
pub struct Manner {
    /// Where the runs of all cases are.
    pub folder: PathBuf,
    /// Threads of each run.
    pub threads: usize,
    /// How often each setting is run; `None` until its runs have taken [`super::LEAST`].
    pub repeat: Option<usize>,
    /// A LAMMPS that runs the decks too.
    pub lammps: Option<PathBuf>,
    /// This program.
    pub program: Starter,
    /// Whether runs report their progress.
    pub reports_progress: bool,
    /// The ranks that make the runs, if there are several.
    pub ranks: Option<Ranks>,
}

impl Headed for Case {
    fn read(name: &str, deck: &str) -> std::result::Result<Self, String> {
        let mut case: Self = heads::read(name, deck)?;
        (case.name, case.deck) = (name.into(), deck.into());
        let unknown = |m: &Wanted| m.norm.as_deref().is_some_and(|n| Norm::named(n).is_none());
        match case.measure.iter().find(|m| unknown(m)) {
            Some(m) => Err(format!("{name}: `{}` has a norm that does not exist", m.name)),
            None if case.knob.is_empty() || case.measure.is_empty() => {
                Err(format!("{name}: it needs a knob and a measure"))
            }
            None => Ok(case),
        }
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn title(&self) -> &str {
        &self.title
    }
}

impl Case {
    /// Whether a LAMMPS that is there runs this case too.
    pub fn has_lammps(&self, manner: &Manner) -> bool {
        manner.lammps.is_some() && self.lammps.no.is_none()
    }

    /// The runs of the case.
    ///
    /// # Errors
    /// Knobs that make no sense.
    pub fn bench(&self, manner: &Manner) -> Result<Bench> {
        let mut axes = vec![];
        if self.has_lammps(manner) {
            let rows = ["perigrain", lammps::PROGRAM].map(|p| vec![p.to_string()]).to_vec();
            axes.push(Axis { names: vec![PROGRAM.into()], rows });
        }
        for knob in &self.knob {
            axes.push(Axis::each(&knob.name, &knob.values)?);
        }
        let measure = |m: &Wanted| Measure {
            word: m.word.clone(),
            against: m.form.clone().map_or_else(|| Against::Finest(m.finest.clone()), Against::Form),
            norm: Norm::named(m.norm.as_deref().unwrap_or("rel")).unwrap_or_default(),
            name: m.name.clone(),
        };
        let sweep = Sweep {
            deck: Deck {
                name: format!("{}.in", self.name),
                text: self.deck.clone(),
                // Nothing is read but what the program carries.
                folder: Path::new(".").to_owned(),
            },
            jobs: vec![],
            report: vec![],
            settings: Settings { lammps: manner.lammps.clone(), ..Settings::default() },
            folder: manner.folder.join(&self.name),
            at_once: 1,
            threads: manner.threads,
            retry: 0,
            program: manner.program.clone(),
            reports_progress: manner.reports_progress,
            ranks: manner.ranks.clone(),
        };
        Bench::new(sweep, axes, manner.repeat, self.measure.iter().map(measure).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_can_be_read_and_has_words_for_its_knobs() {
        let cases = heads::chosen::<Case>(DECKS, "").unwrap();
        assert_eq!(cases.len(), DECKS.len());
        for case in &cases {
            for knob in &case.knob {
                let words = ["variable", &knob.name, "index"];
                let defines = |line: &str| line.split_whitespace().take(3).eq(words);
                assert!(case.deck.lines().any(defines), "{}: {words:?}", case.name);
            }
        }
        assert_eq!(heads::chosen::<Case>(DECKS, "OBLIQUE_I").unwrap().len(), 1);
        assert!(Case::read("x", "#| title = \"t\"\n").is_err());
    }
}
