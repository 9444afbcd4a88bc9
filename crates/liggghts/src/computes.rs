//! Small words of LIGGGHTS: the check of the time step, `set`.

use crate::Translator;
use crate::native::Line;
use crate::reading::{inside, rounded, without_counterpart};
use perigrain_base::diag::Result;
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

/// The mass that keeps a grain's density.
const MASS: &str = "liggghts_mass";

/// `set … diameter D` keeps the density (measured), and not the mass as in LAMMPS.
fn set_diameter(cmd: &Command, diameter: usize) -> Option<Vec<Command>> {
    let new = cmd.args.get(diameter + 1)?;
    if ["mass", "density"].iter().any(|name| cmd.args.iter().any(|w| w.text == *name)) {
        return None;
    }
    let mut mass = Line::new(cmd, "variable");
    mass.put(&format!("{MASS} atom mass*({}/(2*radius))^3", inside(new)), new.span);
    let mut line = Line::new(cmd, "set");
    line.words(&cmd.args[..2]).put(&format!("mass v_{MASS}"), new.span).words(&cmd.args[2..]);
    let mut done = Line::new(cmd, "variable");
    done.put(&format!("{MASS} delete"), new.span);
    Some(vec![mass.done(), line.done(), done.done()])
}

/// `set … density … diameter …`: the density counts for the new diameter, in whichever order they stand; a diameter alone keeps it.
pub(crate) fn set(cmd: &Command) -> Result<Option<Vec<Command>>> {
    for word in &cmd.args {
        if let Some((_, what, help)) = FOREIGN.iter().find(|(name, _, _)| *name == word.text) {
            return Err(without_counterpart(word, what, help).into());
        }
    }
    let at = |name: &str| cmd.args.iter().position(|w| w.text == name);
    let (density, diameter) = match (at("density"), at("diameter")) {
        (Some(density), Some(diameter)) => (density, diameter),
        (None, Some(diameter)) if diameter > 1 => return Ok(set_diameter(cmd, diameter)),
        _ => return Ok(None),
    };
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
