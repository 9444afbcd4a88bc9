//! The cases as the tables state them.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Variables of a deck.
pub type Vars = BTreeMap<String, String>;

/// Cases of one kind.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Section {
    pub title: String,
    /// What is done, and what is expected.
    pub about: String,
    /// The deck, unless a case names its own.
    pub scene: String,
    /// What all cases set.
    #[serde(default)]
    pub set: Vars,
    /// What the short form sets besides.
    #[serde(default)]
    pub short: Vars,
    /// What the long form sets besides.
    #[serde(default)]
    pub long: Vars,
    /// What is measured, with bounds for all cases.
    #[serde(default)]
    pub figure: Vec<Figure>,
    pub case: Vec<Case>,
}

/// A number that a run gives, and between which bounds it lies.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Figure {
    pub name: String,
    pub least: Option<f64>,
    pub most: Option<f64>,
    /// Where the bound comes from.
    pub why: String,
}

/// How a case is run.
#[derive(Clone, Copy, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum How {
    /// Once; the deck prints its figures.
    #[default]
    Run,
    /// Once; it must be refused, by words that the case gives.
    Refused,
    /// In steps of 1, 1/2, 1/4 and 1/8: `order`, the mean of two halvings.
    Order,
    /// The scene and its image in a mirror: `mirror`.
    Mirror,
    /// With 1, 2, 7 and 16 threads: `threads`.
    Threads,
    /// Whole, and cut in two by a restart file: `restart`.
    Restart,
}

/// One case.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    pub name: String,
    pub scene: Option<String>,
    #[serde(default)]
    pub set: Vars,
    #[serde(default)]
    pub how: How,
    /// Words of the log or the message.
    #[serde(default)]
    pub prints: Vec<String>,
    /// Figures of the section that mean nothing here, or have bounds of their own below.
    #[serde(default)]
    pub without: Vec<String>,
    /// Figures of this case alone.
    #[serde(default)]
    pub figure: Vec<Figure>,
}

impl Section {
    /// The figures that a case is judged by.
    pub fn figures(&self, case: &Case) -> Vec<Figure> {
        if case.how == How::Refused {
            return vec![];
        }
        let own = |f: &&Figure| !case.without.contains(&f.name);
        let replaced = |f: &&Figure| !case.figure.iter().any(|g| g.name == f.name);
        self.figure.iter().filter(own).filter(replaced).chain(&case.figure).cloned().collect()
    }
}

/// The sections in the order of their files; with a text only cases whose name or title holds it.
pub fn sections(wanted: &str) -> Vec<Section> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/stress/tables");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    let read = |path: &std::path::PathBuf| -> Section {
        let text = std::fs::read_to_string(path).unwrap();
        toml::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    };
    let mut all: Vec<Section> = files.iter().map(read).collect();
    for s in all.iter_mut().filter(|s| !s.title.contains(wanted)) {
        s.case.retain(|c| c.name.contains(wanted));
    }
    all
}
