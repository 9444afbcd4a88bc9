//! Words that change nothing here, and words that are others of LAMMPS.

use crate::Translator;
use crate::native::{Line, instead};
use crate::reading::rounded;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Command, Word};

/// `atom_style granular`.
pub(crate) fn sphere(cmd: &Command) -> Command {
    let mut line = Line::new(cmd, "atom_style");
    line.word(&instead(&cmd.args[0], "sphere")).words(&cmd.args[1..]);
    line.done()
}

/// `neigh_modify … contact_distance_factor F`: the other words stay.
pub(crate) fn neigh_modify(
    t: &mut Translator,
    cmd: &Command,
    args: &mut Args,
) -> Result<Option<Vec<Command>>> {
    if cmd.args.iter().all(|w| w.text != "contact_distance_factor") {
        return Ok(None);
    }
    let mut line = Line::new(cmd, "neigh_modify");
    let mut rest: Vec<Word> = vec![];
    let mut words = cmd.args.iter();
    while let Some(word) = words.next() {
        if word.text == "contact_distance_factor" {
            words.next();
            t.idle(word, "contacts are found at any distance that the skin allows");
        } else {
            rest.push(word.clone());
        }
    }
    args.rest();
    line.words(&rest);
    Ok(Some(if rest.is_empty() { vec![] } else { vec![line.done()] }))
}

impl Translator {
    /// Notes, once for each word, that it has no effect.
    pub(crate) fn idle(&mut self, word: &Word, why: &str) {
        if self.idle.insert(word.text.clone()) {
            let text = format!("`{}` is without effect here: {why}", word.text);
            self.notes.push(Diagnostic::note(Code::DIALECT, word.span, text));
        }
    }

    /// The line with its word `k` as a whole number, where that is written as a real.
    pub(crate) fn first_whole(&mut self, cmd: &Command, k: usize) -> Option<Vec<Command>> {
        let word = cmd.args.get(k)?;
        let (whole, note) = rounded(word);
        if whole == *word {
            return None;
        }
        self.notes.0.extend(note);
        let mut line = Line::new(cmd, &cmd.name.text);
        line.words(&cmd.args[..k]).word(&whole).words(&cmd.args[k + 1..]);
        Some(vec![line.done()])
    }

    /// `unfix` of what is only in the dialect leaves no line.
    pub(crate) fn unfix(&mut self, cmd: &Command) -> Option<Vec<Command>> {
        let id = &cmd.args.first()?.text;
        if self.bins.remove(id) {
            let mut compute = Line::new(cmd, "uncompute");
            compute.word(&instead(&cmd.args[0], format!("{id}_bins")));
            return Some(vec![cmd.clone(), compute.done()]);
        }
        self.surfaces.remove(id);
        if self.heat.as_ref().is_some_and(|heat| heat.id() == id) {
            (self.heat, self.written) = (None, None);
        }
        self.mesh_wall.take_if(|wall| wall.text == *id);
        if !self.own.remove(id) {
            return None;
        }
        self.templates.remove(id);
        if self.mixtures.remove(id) {
            return Some(vec![]);
        }
        self.properties.retain(|_, p| p.id != *id);
        self.version += 1;
        Some(vec![])
    }

    /// `fix_modify` of what is only in the dialect, and of a servo, whose options have two names each in LIGGGHTS (measured).
    pub(crate) fn fix_modify(&mut self, cmd: &Command) -> Option<Vec<Command>> {
        let word = cmd.args.first()?;
        if self.own.contains(&word.text) {
            self.idle(word, "the line is part of a table that holds for the whole deck");
            return Some(vec![]);
        }
        if !self.surfaces.contains_key(&word.text) {
            return None;
        }
        let mut line = Line::new(cmd, &cmd.name.text);
        for word in &cmd.args {
            line.word(&match word.text.as_str() {
                "integrate" => instead(word, "servo/integrate"),
                "servo/target_val" | "servo/vel_max" | "servo/ctrlParam" => {
                    instead(word, word.text.trim_start_matches("servo/"))
                }
                _ => word.clone(),
            });
        }
        Some(vec![line.done()])
    }

    /// `create_box N …` fixes how many types there are.
    pub(crate) fn create_box(&mut self, cmd: &Command) -> Option<Vec<Command>> {
        let word = cmd.args.first()?;
        self.box_types = word.text.parse().ok().filter(|_| !word.unknown);
        None
    }

    /// `pair_coeff * *` beside `pair_style gran`: what stands there is made from properties.
    pub(crate) fn pair_coeff(&mut self, cmd: &Command) -> Option<Vec<Command>> {
        self.pair.as_ref()?;
        (cmd.args.len() <= 2).then(Vec::new)
    }
}
