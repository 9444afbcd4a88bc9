//! A run as one web page that needs nothing else: what it was, its step table as curves, its pictures, where the time went.

mod curves;
pub mod film;
pub mod log;
mod page;
mod pictures;

pub use curves::row_json;
pub use page::html;
pub use pictures::{Gallery, Picture, gathered};

use crate::session::Part;
use perigrain_output::rows::Tables;

/// How a run came to its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The deck was finished.
    Well,
    /// It was ended from outside, at a whole step.
    Interrupted,
    /// It was refused or failed, for this reason.
    Failed(String),
    /// A log was read, which does not state it.
    Unknown,
}

/// The severity of a run's message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// Worth knowing.
    Note,
    /// It runs, but probably not as it was meant.
    Warning,
}

/// A file of text that the page shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    /// What it is.
    pub what: &'static str,
    /// Its name.
    pub name: String,
    /// What stands in it.
    pub text: String,
}

/// All that a page shows.
#[derive(Clone, Debug)]
pub struct Report {
    /// What the run is called.
    pub title: String,
    /// How it ended.
    pub ended: Ended,
    /// Program, machine, day, in one line.
    pub origin: String,
    /// What is shown large: name and value.
    pub figures: Vec<(String, String)>,
    /// What is shown small.
    pub facts: Vec<(String, String)>,
    /// The deck, if it is known.
    pub deck: Option<Text>,
    /// The step tables.
    pub tables: Tables,
    /// What columns of them are, by their words.
    pub columns: Vec<(String, String)>,
    /// Warnings and notes in their order.
    pub messages: Vec<(Weight, String)>,
    /// Parts of steps and what they took.
    pub parts: Vec<Part>,
    /// The last run's plan.
    pub plan: Option<String>,
    /// Pictures that the run drew.
    pub gallery: Gallery,
    /// Snapshots of the particles.
    pub film: Vec<film::Frame>,
    /// It is shown during the run.
    pub live: bool,
    /// Remarks of the page itself: what was left out, what could not be read.
    pub remarks: Vec<String>,
}

impl Report {
    /// A page about nothing yet.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            ended: Ended::Unknown,
            origin: String::new(),
            figures: vec![],
            facts: vec![],
            deck: None,
            tables: Tables::default(),
            columns: vec![],
            messages: vec![],
            parts: vec![],
            plan: None,
            gallery: Gallery::default(),
            film: vec![],
            live: false,
            remarks: vec![],
        }
    }
}

/// A number with as many digits as a reader needs.
fn short(value: f64) -> String {
    perigrain_base::math::cformat::general(value, 6)
}

#[cfg(test)]
mod tests;
