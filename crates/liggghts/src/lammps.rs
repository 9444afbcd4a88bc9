//! Native lines in the words of LAMMPS, where it has some.

use perigrain_lang::{Command, Word};

/// A line that LAMMPS reads, or why there is none.
///
/// # Errors
/// What LAMMPS does not have.
pub(crate) fn line(cmd: &Command) -> Result<String, &'static str> {
    let style = cmd.args.get(2).map_or("", |w| w.text.as_str());
    match (cmd.name.text.as_str(), style) {
        ("pair_coeff", _) => coefficients(cmd),
        ("mixture", _) => Err("distributions of sizes stand in fix pour"),
        ("fix", "surface" | "wall/mesh") => Err("LAMMPS has no walls of triangles"),
        ("fix", "insert") => Err("fix pour and fix deposit insert otherwise"),
        ("fix", "dt/grain") => Err("no check of the time step"),
        ("fix", "wall/gran") if cmd.args.iter().any(|w| w.text == "coeff") => {
            Err("write the law of the wall behind `wall/gran granular`")
        }
        ("dump", "mesh/stl" | "mesh/vtk") => Err("no surfaces"),
        _ => Ok(cmd.text.clone()),
    }
}

/// Coefficients with numbers where LAMMPS takes no `NULL`.
fn coefficients(cmd: &Command) -> Result<String, &'static str> {
    let has = |text: &str| cmd.args.iter().any(|w| w.text == text);
    if ["cdt", "epsd", "epsd2"].iter().any(|word| has(word)) {
        return Err("no such rolling friction");
    }
    if has("cohesion") {
        return Err("no such cohesion");
    }
    if has("hooke/velocity") || has("hooke/hysteresis") {
        return Err("no such normal law");
    }
    let mut words: Vec<Word> = cmd.args.clone();
    if let Some(k) = words.iter().position(|w| w.text == "slip") {
        if !has("linear_nohistory") {
            return Err("the spring of `mindlin` slides otherwise: leave `slip spring` out");
        }
        // Without a spring the words are about arms of friction, R − δ/2 instead of R.
        words.drain(k..k + 2);
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
