//! Decks of LIGGGHTS: each line becomes native lines, whose words keep their places.
//!
//! A [`Translator`] reads a deck line by line. It holds what LIGGGHTS keeps in fixes and the native language in lines: properties of
//! materials, templates of grains, their mixtures, surfaces. The physics is native; this crate deals with words alone.
//!
//! Source: the manual of LIGGGHTS-PUBLIC 3.8.0; what it leaves open was measured with that program.

mod averages;
mod clumps;
mod coefficients;
mod computes;
mod contacts;
mod dumps;
mod finding;
mod heat;
mod idle;
mod ids;
mod insertion;
mod lammps;
mod meshes;
mod mixtures;
mod model;
mod native;
mod old;
mod properties;
mod reading;
mod regions;
mod rewrite;
mod spacing;
mod walls;
mod words;

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_shapes;

use finding::{find, style_at};
use perigrain_base::diag::{Diagnostics, Result, Span};
use perigrain_lang::{Args, Command, Word};
use std::collections::{BTreeMap, BTreeSet};
use words::Take;

pub use finding::known;
pub use rewrite::{Rewritten, Target, rewrite};

/// What became of a line.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// It is no word of LIGGGHTS, or the native word is the same.
    NotMine,
    /// These lines, in order; none where the line is kept in the dialect's own tables.
    Native(Vec<Command>),
}

/// What a deck of LIGGGHTS has defined so far.
#[derive(Clone, Debug, Default)]
pub struct Translator {
    properties: BTreeMap<String, properties::Property>,
    /// Names of properties whose lines were refused.
    refused: BTreeSet<String>,
    /// Counts changes of properties.
    version: u64,
    /// The number of atom types, where `create_box` gave it.
    box_types: Option<usize>,
    /// The `pair_style gran` line.
    pair: Option<(Command, model::Given)>,
    /// The old pair style, as walls name it.
    old_pair: Option<&'static str>,
    /// The version of the properties that coefficients were written for, and how many atom types there were.
    written: Option<(u64, usize)>,
    templates: BTreeMap<String, mixtures::Template>,
    mixtures: BTreeSet<String>,
    movers: clumps::Movers,
    surfaces: BTreeMap<String, meshes::Surface>,
    /// Conduction of heat.
    heat: Option<heat::Heat>,
    /// Computes that show what LIGGGHTS has as properties of fixes: `f_Temp` for `f_Temp[0]`.
    shown: BTreeSet<String>,
    /// The deck needs another program: what follows is not read.
    ended: bool,
    /// Models of walls above `pair_style`.
    early: Vec<model::Given>,
    /// The wall on surfaces, of which LIGGGHTS has one.
    mesh_wall: Option<Word>,
    /// Computes with local values.
    local: BTreeSet<String>,
    /// The deck has a lattice.
    lattice: bool,
    /// IDs of fixes that are only here.
    own: BTreeSet<String>,
    /// IDs of fixes whose bins are a compute of their own here.
    bins: BTreeSet<String>,
    /// Templates and distributions that no line has used yet.
    unused: BTreeMap<String, Span>,
    /// The styles of all fixes by their IDs.
    fixes: BTreeMap<String, String>,
    /// Words whose lack of effect has been noted.
    idle: BTreeSet<String>,
    /// The deck has chosen what becomes of grains that are lost.
    lost: bool,
    notes: Diagnostics,
}

/// The words of a line that only a deck of LIGGGHTS has; `None` for any other line.
pub fn mark(cmd: &Command) -> Option<String> {
    let command = cmd.name.text.as_str();
    // Lines of decks that have none are dismissed by their command.
    let may = [
        "atom_style",
        "communicate",
        "hard_particles",
        "soft_particles",
        "thermo_log",
        "pair_style",
        "fix",
        "dump",
    ];
    if !may.contains(&command) {
        return None;
    }
    let style = cmd.args.get(style_at(command)).map_or("", |w| w.text.as_str());
    if command == "fix" && style == "wall/gran" {
        return walls::is_dialect(cmd).then(|| "fix wall/gran model".to_string());
    }
    if !find(cmd).is_some_and(|e| e.mark) {
        return None;
    }
    let bare = style.is_empty()
        || ["communicate", "thermo_log"].contains(&command)
        || command.ends_with("_particles");
    Some(if bare { command.to_string() } else { format!("{command} {style}") })
}

impl Translator {
    /// Translates one line, whose values are put in, or are still to be where a deck is rewritten.
    ///
    /// # Errors
    /// Words that are wrong in LIGGGHTS too, and words without counterpart.
    pub fn line(&mut self, cmd: &Command) -> Result<Outcome> {
        if self.ended {
            return Ok(Outcome::Native(vec![]));
        }
        let Some((line, more)) = self.with_references(cmd) else { return self.carried(cmd) };
        let mut lines = match self.carried(&line)? {
            Outcome::NotMine => vec![line],
            Outcome::Native(lines) => lines,
        };
        lines.extend(more);
        Ok(Outcome::Native(lines))
    }

    /// A line whose references are native ones.
    fn carried(&mut self, cmd: &Command) -> Result<Outcome> {
        let mut before = match cmd.name.text.as_str() {
            "run" | "minimize" | "rerun" | "write_data" => self.before_run(cmd)?,
            "clear" => {
                *self = Self::default();
                vec![]
            }
            "pair_style" => {
                self.note_pair(cmd);
                vec![]
            }
            "lattice" => {
                self.lattice = true;
                vec![]
            }
            "thermo_style" => {
                self.lost = false;
                vec![]
            }
            "thermo_modify" => {
                self.lost |= cmd.args.iter().any(|w| w.text == "lost");
                vec![]
            }
            _ => vec![],
        };
        self.one_style(cmd)?;
        let lines = match find(cmd) {
            None => None,
            Some(entry) => match entry.take {
                Take::Same => None,
                Take::Idle(why) => {
                    self.idle(&cmd.name, why);
                    Some(vec![])
                }
                Take::Refused(what, help) => {
                    self.ended = help == words::PARTNER;
                    let at = cmd.args.get(style_at(entry.command)).filter(|_| !entry.style.is_empty());
                    return Err(reading::without_counterpart(at.unwrap_or(&cmd.name), what, help).into());
                }
                Take::Lines(carry) => {
                    let mut args = Args::new(cmd);
                    let words = if entry.style.is_empty() { 0 } else { style_at(entry.command) + 1 };
                    (0..words).for_each(|_| {
                        args.next();
                    });
                    carry(self, cmd, &mut args)?
                }
            },
        };
        // The same words may mean other lengths.
        let boxed = |line: &Command| spacing::in_box(line).filter(|_| self.lattice);
        Ok(match (lines, before.is_empty()) {
            (None, true) => boxed(cmd).map_or(Outcome::NotMine, |line| Outcome::Native(vec![line])),
            (None, false) => {
                before.push(cmd.clone());
                Outcome::Native(before)
            }
            (Some(lines), _) => {
                before.extend(lines.into_iter().map(|line| boxed(&line).unwrap_or(line)));
                Outcome::Native(before)
            }
        })
    }

    /// A line with native references in place of those to properties of fixes, such as `f_Temp[0]`.
    pub fn referring(&self, cmd: &Command) -> Option<Command> {
        self.with_references(cmd).map(|(line, _)| line)
    }

    /// Notes since the last call.
    pub fn take_notes(&mut self) -> Diagnostics {
        std::mem::take(&mut self.notes)
    }

    /// What stands before a run: the coefficients, and that grains which leave the box are deleted, unless the deck says otherwise
    /// (LIGGGHTS' default: measured).
    fn before_run(&mut self, cmd: &Command) -> Result<Vec<Command>> {
        let mut lines = self.bodies()?;
        lines.extend(self.heat_again()?);
        lines.extend(self.coefficients()?);
        if !std::mem::replace(&mut self.lost, true) && cmd.name.text != "write_data" {
            let mut line = native::Line::new(cmd, "thermo_modify");
            line.put("lost ignore", cmd.name.span);
            lines.push(line.done());
        }
        Ok(lines)
    }

    /// `pair_style gran`.
    fn pair_line(&mut self, cmd: &Command) -> Result<Option<Vec<Command>>> {
        self.pair_style(cmd, &mut Args::new(cmd)).map(Some)
    }
}
