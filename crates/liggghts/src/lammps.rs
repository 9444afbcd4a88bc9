//! Native lines in the words of LAMMPS, where it has some.

use crate::walls::PRIMITIVES;
use perigrain_lang::{Command, Word};
use std::collections::BTreeSet;

/// Why a line has no counterpart.
type Lost = &'static str;

/// What the rewriting has met so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Seen {
    /// `pair_coeff` lines.
    laws: Vec<Command>,
    /// The types that grains have.
    kinds: BTreeSet<String>,
    /// IDs of fixes, computes and dumps that LAMMPS does not have.
    lost: BTreeSet<String>,
}

impl Seen {
    /// Takes note of a native line, and returns it as LAMMPS reads it, or why there is none. A wall that has the law of a type waits
    /// ([`wall`]) for the lines of that type, which stand below it.
    ///
    /// # Errors
    /// What LAMMPS does not have.
    pub fn line(&mut self, cmd: &Command) -> Result<String, Lost> {
        let id = cmd.args.first().map_or("", |w| w.text.as_str());
        match cmd.name.text.as_str() {
            "pair_coeff" => self.laws.push(cmd.clone()),
            "create_atoms" => drop(self.kinds.insert(id.to_string())),
            "mixture" => {
                let spheres = cmd.args.windows(2).filter(|pair| pair[0].text == "sphere");
                self.kinds.extend(spheres.map(|pair| pair[1].text.clone()));
            }
            "unfix" | "fix_modify" | "uncompute" | "undump" | "dump_modify" if self.lost.contains(id) => {
                return Err("what it is about is not in LAMMPS");
            }
            _ => {}
        }
        let found = line(cmd);
        let names = ["fix", "compute", "dump"].contains(&cmd.name.text.as_str());
        match found {
            Err(_) if names => drop(self.lost.insert(id.to_string())),
            _ => {}
        }
        found
    }

    /// `fix … wall/gran coeff T …` with the law of grains and that type.
    ///
    /// # Errors
    /// Several laws, and places that LAMMPS does not have.
    pub fn wall(&self, cmd: &Command) -> Result<String, Lost> {
        let words: Vec<&str> = cmd.args.iter().map(|w| w.text.as_str()).collect();
        let at = words.iter().position(|w| PRIMITIVES.contains(w)).ok_or("no such place of a wall")?;
        let (kind, parts, place) = (words[4], words.get(6..at).unwrap_or_default(), &words[at..]);
        let place = match place {
            ["zcylinder", radius, x, y, rest @ ..] if [x, y].iter().all(|c| c.parse() == Ok(0.0)) => {
                [&["zcylinder", radius], rest].concat()
            }
            [name, ..] if name.ends_with("cylinder") => {
                return Err("LAMMPS has cylinders about the z axis alone");
            }
            _ => place.to_vec(),
        };
        let mut laws = vec![];
        for law in &self.laws {
            let pair = [law.args[0].text.as_str(), law.args[1].text.as_str()];
            let grain = match pair {
                [a, b] if a == kind => b,
                [a, b] if b == kind => a,
                _ => continue,
            };
            if self.kinds.is_empty() || self.kinds.contains(grain) {
                let text = coefficients(law)?;
                laws.push(only(text.split_whitespace().skip(3).collect(), parts));
            }
        }
        laws.dedup();
        let [law] = &laws[..] else { return Err("a wall has one law in LAMMPS, for all types of grains") };
        Ok(format!("fix {} {} wall/gran granular {law} {}", words[0], words[1], place.join(" ")))
    }
}

/// A law without the parts that a wall leaves out.
fn only(law: Vec<&str>, parts: &[&str]) -> String {
    let from = law.iter().position(|w| *w == "tangential").unwrap_or(law.len());
    if parts.is_empty() || parts.contains(&"tangential") {
        return law.join(" ");
    }
    let tail: Vec<&str> = law[from..].iter().copied().filter(|w| *w == "limit_damping").collect();
    [&law[..from], &["tangential", "linear_nohistory", "0", "0"], &tail].concat().join(" ")
}

/// Whether a line is a wall whose law is still to come.
pub(crate) fn waits(cmd: &Command) -> bool {
    let words: Vec<&str> = cmd.args.iter().map(|w| w.text.as_str()).collect();
    cmd.name.text == "fix" && matches!(words[..], [_, _, "wall/gran", "coeff", ..])
}

/// A line that LAMMPS reads, or why there is none.
///
/// # Errors
/// What LAMMPS does not have.
fn line(cmd: &Command) -> Result<String, Lost> {
    let style = cmd.args.get(2).map_or("", |w| w.text.as_str());
    match (cmd.name.text.as_str(), style) {
        ("pair_style", _) if cmd.args.first().is_some_and(|w| w.text == "granular") => {
            Ok(format!("comm_modify vel yes\n{}", cmd.text))
        }
        ("pair_coeff", _) => coefficients(cmd),
        ("fix", "move/mesh" | "massflow/mesh") => Err("LAMMPS has no surfaces of triangles"),
        ("compute", "wall/local") => Err("LAMMPS has no table of contacts with walls"),
        ("compute", "pair/local") if cmd.args.iter().any(|w| OWN_COLUMNS.contains(&w.text.as_str())) => {
            Err("LAMMPS' pair/local has other columns")
        }
        ("region", _) if cmd.args.get(1).is_some_and(|w| w.text == "mesh") => Err("no such region"),
        ("mixture", _) => Err("distributions of sizes stand in fix pour"),
        ("fix", "surface" | "wall/mesh") => Err("LAMMPS has no walls of triangles"),
        ("fix", "insert") => Err("fix pour and fix deposit insert otherwise"),
        ("fix", "property/atom") if cmd.args.iter().any(|w| w.text == "initial") => {
            Err("`set` gives temperatures there, also to new particles")
        }
        ("fix", "heat/flow") if cmd.args.iter().any(|w| w.text == "source") => Err("no sources of heat"),
        ("clump", _) => Err("write the spheres into a molecule file, with mass and inertia"),
        ("fix", "dt/grain") => Err("no check of the time step"),
        ("fix", "wall/gran")
            if ["hooke/velocity", "hooke/hysteresis", "slip"].iter().any(|w| has(cmd, w)) =>
        {
            Err("no such law")
        }
        ("dump", "mesh/stl" | "mesh/vtk") => Err("no surfaces"),
        _ => Ok(cmd.text.clone()),
    }
}

/// Columns of `compute pair/local` that LAMMPS does not have.
const OWN_COLUMNS: &[&str] = &["x1", "vx1", "id1", "forcex", "torquex", "h1", "area", "delta", "cx", "p13"];

/// Whether a line has a word.
fn has(cmd: &Command, text: &str) -> bool {
    cmd.args.iter().any(|w| w.text == text)
}

/// Coefficients with numbers where LAMMPS takes no `NULL`.
fn coefficients(cmd: &Command) -> Result<String, Lost> {
    let has = |text: &str| has(cmd, text);
    if ["cdt", "epsd", "epsd2"].iter().any(|word| has(word)) {
        return Err("no such rolling friction");
    }
    if has("cohesion") {
        return Err("no such cohesion");
    }
    if has("heat") {
        return Err("no such conduction of heat");
    }
    if has("hooke/velocity") || has("hooke/hysteresis") {
        return Err("no such normal law");
    }
    let gliding = has("linear_nohistory");
    if has("slip") && !gliding {
        return Err("the spring of `mindlin` slides otherwise: leave `slip spring` out");
    }
    let mut words: Vec<Word> = cmd.args.clone();
    if let Some(k) = words.iter().position(|w| w.text == "slip").filter(|_| gliding) {
        // LAMMPS has the full radii as arms of slip there: a difference of d/2R.
        words.drain(k..k + 2);
    }
    if let Some(k) = words.iter().position(|w| w.text == "none") {
        // LAMMPS wants a tangential model.
        words.splice(k..=k, ["linear_nohistory", "0", "0"].map(|text| Word::new(text, cmd.span)));
    }
    if has("material") {
        return pseudo(&words).ok_or("two materials in one formula");
    }
    if let Some(k) = words.iter().position(|w| w.text == "linear_nohistory" || w.text == "mindlin") {
        let at = k + if words[k].text == "mindlin" { 2 } else { 1 };
        let nu = words.get(5).and_then(|w| w.text.parse::<f64>().ok());
        if words.get(at).is_some_and(|w| w.text == "NULL") {
            words[at].text = format!("{}", across(nu.ok_or("a formula for Poisson's ratio")?));
        }
    }
    Ok(text(&words))
}

/// `x_gamma` of two like bodies: 2 sqrt(G*/Y*), with G* = Y/(4 (2-nu)(1+nu)) and Y* = Y/(2 (1-nu^2)).
fn across(nu: f64) -> f64 {
    2.0 * ((1.0 - nu) / (2.0 * (2.0 - nu))).sqrt()
}

/// The line of two materials as one of a pseudo material with the same Y* and G*: with q = G*/Y*, nu = (1-4q)/(1-2q) and
/// E = 2 (1-nu^2) Y*.
fn pseudo(words: &[Word]) -> Option<String> {
    let number = |k: usize| words.get(k)?.text.parse::<f64>().ok();
    let k = words.iter().position(|w| w.text == "material")?;
    let [a, b] = [(number(3)?, number(5)?), (number(k + 1)?, number(k + 2)?)];
    let young = 1.0 / [a, b].iter().map(|(y, nu)| (1.0 - nu * nu) / y).sum::<f64>();
    let shear = 1.0 / [a, b].iter().map(|(y, nu)| 2.0 * (2.0 - nu) * (1.0 + nu) / y).sum::<f64>();
    let q = shear / young;
    let nu = (1.0 - 4.0 * q) / (1.0 - 2.0 * q);
    let mut out = words[..k].to_vec();
    out[3].text = format!("{}", 2.0 * (1.0 - nu * nu) * young);
    out[5].text = format!("{nu}");
    for (at, word) in out.clone().iter().enumerate().filter(|(_, w)| w.text == "NULL") {
        let last = out.get(at + 1).is_some_and(|next| next.text != "NULL");
        if last && word.text == "NULL" {
            out[at].text = format!("{}", 2.0 * q.sqrt());
        }
    }
    Some(text(&out))
}

fn text(words: &[Word]) -> String {
    words.iter().fold("pair_coeff".to_string(), |line, w| line + " " + &w.text)
}
