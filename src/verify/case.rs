//! One case: a deck whose first lines state what it shows, where the expected numbers come from, and how near they must be met.
//!
//! Lines that begin with `#|` are together a TOML document; for the deck they are comments, so that a case runs by itself, too.

use super::running::Point;
use crate::heads::{self, Headed};
use crate::plot::{self, BLUE, Chart, GREY, Look};
use serde::Deserialize;

/// A deck with what must come out.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// The deck's path below `cases`, without its ending.
    #[serde(skip)]
    pub name: String,
    /// The deck.
    #[serde(skip)]
    pub deck: String,
    /// What it shows, a line.
    pub title: String,
    /// The scene in one or two sentences.
    pub about: String,
    /// Paper, section, table, equation.
    pub source: String,
    /// Numbers.
    #[serde(default)]
    pub check: Vec<Check>,
    /// Series.
    #[serde(default)]
    pub curve: Vec<Curve>,
}

/// One number that must come out, or a whole curve whose worst point counts.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// What is measured.
    pub what: String,
    /// The formula that gives it when the deck has ended.
    #[serde(default)]
    pub measure: String,
    /// The number that is to be met, a formula of the deck's variables, or the two ends of a range.
    pub expected: Option<Expected>,
    /// Instead of both: a curve that gives closed forms.
    pub curve: Option<String>,
    /// Unit of both.
    #[serde(default)]
    pub unit: String,
    /// Where the expected number stands, if not in the case's source.
    pub source: Option<String>,
    /// Largest deviation, as a part of the expected number; a range has none.
    #[serde(default)]
    pub tolerance: f64,
    /// The deviation is a part of this kind of size instead.
    #[serde(default)]
    pub of: Size,
    /// Why that tolerance.
    pub why: String,
    /// The number is known not to be met.
    pub known: Option<Known>,
}

/// What a deviation is a part of.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Size {
    /// The expected number.
    #[default]
    Expected,
    /// The largest expected number of the curve.
    Largest,
    /// One: an absolute deviation.
    One,
}

/// An expected number, or the formula for it.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub enum Expected {
    /// As printed in the source.
    Number(f64),
    /// A closed form.
    Formula(String),
    /// Somewhere between two ends.
    Range([f64; 2]),
}

/// What perigrain gives where it does not give the field's number.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Known {
    /// Its number.
    pub ours: f64,
    /// How far it may be from that, as a part of it.
    pub within: f64,
    /// Why it is another one.
    pub reason: String,
}

/// Points that the deck prints as `curve NAME x ours [expected]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// The NAME.
    pub name: String,
    /// What it shows.
    pub title: String,
    /// Label of the horizontal axis.
    pub x: String,
    /// Label of the vertical axis.
    pub y: String,
    /// What the expected points are: a closed form, a table.
    #[serde(default = "closed_form")]
    pub expected: String,
    /// They are drawn as marks, not as a line.
    #[serde(default)]
    pub marks: bool,
}

impl Curve {
    /// Its picture: ours as dots on the line, or beside the marks, of what was expected.
    pub fn chart(&self, points: &[Point]) -> Chart {
        let curve = |name: &str, points: Vec<[f64; 2]>, look, colour| plot::Curve {
            name: name.into(),
            points,
            look,
            colour,
        };
        let expected: Vec<[f64; 2]> = points.iter().filter_map(|p| Some([p.0, p.2?])).collect();
        let look = if self.marks { Look::Crosses } else { Look::Line };
        let mut curves = vec![];
        if !expected.is_empty() {
            curves.push(curve(&self.expected, expected, look, GREY));
        }
        curves.push(curve("perigrain", points.iter().map(|p| [p.0, p.1]).collect(), Look::Dots, BLUE));
        let (title, x, y) = (self.title.clone(), self.x.clone(), self.y.clone());
        Chart { title, x, y, logarithmic: false, curves }
    }
}

fn closed_form() -> String {
    "closed form".into()
}

impl Headed for Case {
    fn read(name: &str, deck: &str) -> Result<Self, String> {
        let mut case: Self = heads::read(name, deck)?;
        case.name = name.into();
        case.deck = deck.into();
        match case.check.iter().find_map(|check| case.fault(check)) {
            Some(fault) => Err(format!("{name}: {fault}")),
            None if case.check.is_empty() => Err(format!("{name}: nothing is checked")),
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
    /// What is wrong with a check.
    fn fault(&self, check: &Check) -> Option<String> {
        let what = &check.what;
        let reasons = check.known.as_ref().map_or("given", |known| &known.reason);
        if check.why.trim().is_empty() || reasons.trim().is_empty() {
            return Some(format!("`{what}` gives no reason"));
        }
        let is_range = matches!(check.expected, Some(Expected::Range(_)));
        if is_range != (check.tolerance == 0.0) {
            return Some(format!("`{what}` needs a tolerance, and a range none"));
        }
        match (&check.curve, check.measure.is_empty(), check.expected.is_some()) {
            (None, false, true) => None,
            (Some(name), true, false) if self.curve.iter().any(|c| c.name == *name) => None,
            (Some(name), true, false) => Some(format!("`{what}` names `{name}`, which is no curve")),
            _ => Some(format!("`{what}` needs `measure` and `expected`, or `curve` alone")),
        }
    }

    /// The deck without the lines that are read here.
    pub fn lines(&self) -> String {
        heads::without(&self.deck)
    }

    /// The folder it stands in.
    pub fn group(&self) -> &str {
        self.name.split('/').next().unwrap_or_default()
    }
}
