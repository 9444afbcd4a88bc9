//! Computes of LIGGGHTS: tables of contacts, energies of rotation, stress without the word for the temperature.

use crate::Translator;
use crate::model::{Rolling, Tangential};
use crate::native::{Line, instead};
use crate::reading::unknown;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Command};

/// A keyword, its columns of pairs and of walls, whether they are there without keywords.
type Column = (&'static str, &'static str, &'static str, bool);

/// Keywords of `compute pair/gran/local` with the columns of `compute pair/local`, in the order in which LIGGGHTS writes them whatever the order of the
/// keywords (measured: delta behind contactArea), and whether they are there without keywords.
/// Then those of `compute wall/local`: the mesh and the triangle from 0, foot and centre (measured); the contact point is the foot, which LIGGGHTS leaves 0.
const COLUMNS: &[Column] = &[
    ("pos", "x1 y1 z1 x2 y2 z2", "x1 y1 z1 x2 y2 z2", true),
    ("vel", "vx1 vy1 vz1 vx2 vy2 vz2", "vx1 vy1 vz1 vx2 vy2 vz2", true),
    ("id", "id1 id2 crosses", "surface triangle id", true),
    ("force", "forcex forcey forcez", "forcex forcey forcez", true),
    ("force_normal", "fx fy fz", "fx fy fz", false),
    ("force_tangential", "p1 p2 p3", "tx ty tz", false),
    ("torque", "torquex torquey torquez", "torquex torquey torquez", true),
    ("history", "", "", true),
    ("contactArea", "area", "area", true),
    ("delta", "delta", "delta", false),
    ("heatFlux", "p13", "heat", false),
    ("contactPoint", "cx cy cz", "x1 y1 z1", false),
];

/// Keywords of `compute stress/atom` of LAMMPS ten years ago, where no temperature stood before them.
const STRESSES: &[&str] = &["ke", "pair", "bond", "angle", "dihedral", "improper", "kspace", "fix", "virial"];

impl Translator {
    /// `compute ID group pair/gran/local [keywords]`.
    pub(crate) fn contacts(&mut self, cmd: &Command, args: &mut Args) -> Result<Option<Vec<Command>>> {
        self.local_values(cmd);
        let mut line = Line::styled(cmd, "pair/local");
        self.columns(&mut line, cmd, args, |(_, pair, _, _)| pair)?;
        line.put("cutoff radius", cmd.span);
        Ok(Some(vec![line.done()]))
    }

    /// `compute ID group wall/gran/local [keywords]`: of the wall on surfaces, which stands above.
    pub(crate) fn wall_contacts(&mut self, cmd: &Command, args: &mut Args) -> Result<Option<Vec<Command>>> {
        let Some(wall) = &self.mesh_wall else {
            let text = "`wall/gran/local` needs a `fix wall/gran … mesh` above it";
            let d = Diagnostic::error(Code::INCOMPLETE, cmd.args[2].span, text);
            return Err(d
                .help("contacts with planes and cylinders: `store_force yes` behind that wall")
                .into());
        };
        let mut line = Line::styled(cmd, "wall/local");
        line.word(&instead(&cmd.args[2], wall.text.as_str()));
        self.local_values(cmd);
        self.columns(&mut line, cmd, args, |(_, _, wall, _)| wall)?;
        Ok(Some(vec![line.done()]))
    }

    /// The columns of a table of contacts.
    fn columns(
        &self,
        line: &mut Line,
        cmd: &Command,
        args: &mut Args,
        of: fn(&Column) -> &'static str,
    ) -> Result<()> {
        let asked = args.rest().to_vec();
        let known: Vec<&str> = COLUMNS.iter().map(|(word, ..)| *word).collect();
        if let Some(word) = asked.iter().find(|word| !known.contains(&word.text.as_str())) {
            return Err(unknown(word, &format!("keyword of compute {}", cmd.args[2].text), &known).into());
        }
        for column in COLUMNS {
            let (word, .., usual) = column;
            let given = asked.iter().find(|a| a.text == *word);
            if given.is_none() && !(asked.is_empty() && *usual) {
                continue;
            }
            let at = given.map_or(cmd.span, |a| a.span);
            match *word {
                "history" => {
                    for k in 1..=self.remembered() {
                        line.put(&format!("h{k}"), at);
                    }
                }
                _ => {
                    line.put(of(column), at);
                }
            }
        }
        Ok(())
    }

    /// A compute whose values are those of contacts or bonds.
    pub(crate) fn local_values(&mut self, cmd: &Command) -> Option<Vec<Command>> {
        self.local.insert(cmd.args.first()?.text.clone());
        None
    }

    /// `compute ID group reduce MODE inputs`: native lines have a word for values of contacts.
    pub(crate) fn reduced(&self, cmd: &Command) -> Option<Vec<Command>> {
        let is_local = |text: &str| {
            let id = text.strip_prefix("c_").and_then(|t| t.split('[').next());
            id.is_some_and(|id| self.local.contains(id))
        };
        let input = cmd.args.iter().find(|w| is_local(&w.text))?;
        if cmd.args.iter().any(|w| w.text == "inputs") {
            return None;
        }
        let mut line = Line::new(cmd, &cmd.name.text);
        line.words(&cmd.args).put("inputs local", input.span);
        Some(vec![line.done()])
    }

    /// How many numbers a contact remembers: the tangential spring, the torque of a rolling spring.
    fn remembered(&self) -> usize {
        let Some((_, given)) = &self.pair else { return 3 };
        let slides = if given.model.tangential == Tangential::History { 3 } else { 0 };
        let rolls = match given.model.rolling {
            Rolling::Off | Rolling::Cdt => 0,
            _ => 3,
        };
        slides + rolls
    }
}

/// `compute ID group erotate`: of spheres.
pub(crate) fn rotation(cmd: &Command) -> Vec<Command> {
    renamed(cmd, "erotate/sphere")
}

/// A compute with the same words that has another name here.
pub(crate) fn renamed(cmd: &Command, style: &str) -> Vec<Command> {
    let mut line = Line::styled(cmd, style);
    line.words(cmd.args.get(3..).unwrap_or_default());
    vec![line.done()]
}

/// `compute ID group stress/atom [keywords]` without the word for the temperature: NULL.
pub(crate) fn stress(cmd: &Command) -> Option<Vec<Command>> {
    let first = cmd.args.get(3);
    if first.is_some_and(|word| !STRESSES.contains(&word.text.as_str())) {
        return None;
    }
    let mut line = Line::styled(cmd, "stress/atom");
    let style = cmd.args.get(2)?;
    line.word(&instead(style, "NULL")).words(cmd.args.get(3..).unwrap_or_default());
    Some(vec![line.done()])
}
