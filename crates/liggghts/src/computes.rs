//! Small words of LIGGGHTS: the check of the time step, `set`.

use crate::Translator;
use crate::native::Line;
use crate::reading::{rounded, without_counterpart};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Command, Word};

impl Translator {
    /// `fix ID group check/timestep/gran N fr fh …`. Where coefficients of pairs are springs, the materials of the types stand here.
    pub(crate) fn time_step(&mut self, cmd: &Command, args: &mut Args) -> Result<Vec<Command>> {
        let mut line = Line::styled(cmd, "dt/grain");
        let words: Vec<Word> = args.rest().to_vec();
        if let Some((first, rest)) = words.split_first() {
            line.word(&rounded(first).0).words(rest);
        }
        if self.pair.as_ref().is_some_and(|(_, given)| given.model.is_stiffness()) {
            let reader = cmd.args[2].clone();
            for i in 0..self.types().max(1) {
                line.put(&format!("material {}", i + 1), reader.span);
                for name in ["youngsModulus", "poissonsRatio"] {
                    line.word(&self.of(name, &reader, i, i)?);
                }
            }
        }
        Ok(vec![line.done()])
    }
}

/// Keywords of `set` that have no counterpart, with what they are about and what to take instead.
const FOREIGN: &[(&str, &str, &str)] = &[
    ("shape", "a shape that is no sphere", "clumps of spheres: `molecule` and `fix rigid/small`"),
    ("blockiness", "a shape that is no sphere", "clumps of spheres: `molecule` and `fix rigid/small`"),
    ("meso_rho", "a fluid of particles", "grains and solids alone are computed here"),
    ("sphkernel", "a fluid of particles", "grains and solids alone are computed here"),
];

impl Translator {
    /// `set …`: a diameter alone keeps the density in LIGGGHTS (measured), which is noted once.
    pub(crate) fn sized(&mut self, cmd: &Command) -> Result<Option<Vec<Command>>> {
        let at = |name: &str| cmd.args.iter().find(|w| w.text == name);
        if let (Some(word), None, None) = (at("diameter"), at("density"), at("mass"))
            && self.idle.insert("set diameter".into())
        {
            let text = "`set diameter` keeps the mass of grains here, and their density in LIGGGHTS";
            let note = Diagnostic::note(Code::DIALECT, word.span, text);
            self.notes.push(note.help("write `density` behind it, here or in a line below"));
        }
        ordered(cmd)
    }
}

/// `set … density … diameter …`: the density counts for the new diameter, in whichever order they stand.
fn ordered(cmd: &Command) -> Result<Option<Vec<Command>>> {
    for word in &cmd.args {
        if let Some((_, what, help)) = FOREIGN.iter().find(|(name, _, _)| *name == word.text) {
            return Err(without_counterpart(word, what, help).into());
        }
    }
    let at = |name: &str| cmd.args.iter().position(|w| w.text == name);
    let (Some(density), Some(diameter)) = (at("density"), at("diameter")) else { return Ok(None) };
    if density > diameter || diameter + 1 >= cmd.args.len() {
        return Ok(None);
    }
    let mut words = cmd.args.clone();
    let moved: Vec<Word> = words.drain(diameter..diameter + 2).collect();
    words.splice(density..density, moved);
    let mut line = Line::new(cmd, "set");
    line.words(&words);
    Ok(Some(vec![line.done()]))
}
