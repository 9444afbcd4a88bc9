//! Answers to formulas about the session itself: masks, settings, which features exist and are in use.

use super::catalogue::{CATEGORIES as STYLES, Tables};
use super::measure;
use super::node::Graph;
use perigrain_base::diag::{Code, Diagnostic, Result, nearest};
use perigrain_lang::{Question, Value, Word};
use perigrain_world::{Newton, World};
use std::sync::Arc;

/// 1 for every particle in the group and in the region, else 0.
///
/// # Errors
/// Unknown names.
pub fn mask(w: &World, group: Option<&Word>, region: Option<&Word>) -> Result<Vec<f64>> {
    let bit = group.map(|name| measure::group(w, name)).transpose()?.map(|id| id.bit());
    let region = region.map(|name| measure::region(w, name)).transpose()?;
    let p = &w.particles;
    let inside =
        |i: usize| bit.is_none_or(|b| p.mask[i] & b != 0) && region.is_none_or(|r| r.contains(p.x[i]));
    Ok((0..p.len()).map(|i| f64::from(u8::from(inside(i)))).collect())
}

/// `extract_setting(name)`; `None` if there is no such setting.
pub fn setting(w: &World, blind: bool, name: &str) -> Option<Value> {
    let s = &w.particles.style;
    let flag = |b: bool| f64::from(u8::from(b));
    let number = match name {
        "dimension" => flag(!w.settings.two_dimensional) + 2.0,
        "box_exist" => flag(w.domain.is_some()),
        "nthreads" => perigrain_base::par::most_threads() as f64,
        "newton_pair" => flag(w.settings.newton.pair),
        "newton_bond" => flag(w.settings.newton.bond),
        "nlocal" | "nall" if blind => return Some(Value::Unknown),
        "nlocal" | "nall" => w.n() as f64,
        "ntypes" => w.types as f64,
        "rmass_flag" => flag(s.own_mass()),
        "radius_flag" | "omega_flag" | "torque_flag" => flag(s.sphere),
        "peri_flag" => flag(s.peri),
        "q_flag" => flag(s.charged),
        "mu_flag" => flag(s.dipole),
        "molecule_flag" => flag(s.molecules),
        "nbondtypes" => w.bonds.types as f64,
        "nangletypes" => w.bonds.angles.types as f64,
        "world_size" | "universe_size" => 1.0,
        "bigint" => 8.0,
        "tagint" | "imageint" => 4.0,
        "triclinic" => flag(w.domain.as_ref().is_some_and(|d| d.tilt.is_some())),
        "nghost" | "ndihedraltypes" | "nimpropertypes" | "ellipsoid_flag" | "angmom_flag" | "world_rank"
        | "universe_rank" | "nellipsoids" | "nlines" | "ntris" | "nbodies" | "kokkos_active"
        | "kokkos_nthreads" | "kokkos_ngpus" => 0.0,
        _ => return None,
    };
    Some(Value::Number(number))
}

/// What a deck has declared, by name: enough to answer for it inside a step.
#[derive(Clone, Default)]
pub struct Declared {
    pair: Option<&'static str>,
    /// The pair style can be probed for single pairs of particles.
    single: bool,
    bond: Option<&'static str>,
    computes: Vec<String>,
    fixes: Vec<String>,
    dumps: Vec<String>,
    tables: Arc<Tables>,
}

impl Declared {
    /// What stands in the graph now.
    pub fn new(w: &World, graph: &Graph) -> Self {
        let pair = graph.pair.as_ref().map(|p| &p.pair);
        Self {
            pair: pair.map(|p| p.facts().name),
            // A style that still lacks coefficients can be probed.
            single: pair.is_some_and(|p| p.probes(w, true).map_or(true, |probes| !probes.is_empty())),
            bond: graph.bond.as_ref().map(|b| b.force.name()),
            computes: graph.computes.iter().map(|c| c.id.clone()).collect(),
            fixes: graph.fixes.iter().map(|f| f.id.clone()).collect(),
            dumps: graph.dumps.iter().map(|d| d.id.clone()).collect(),
            tables: graph.tables.clone(),
        }
    }
}

/// `is_active`, `is_available`, `is_defined`.
///
/// # Errors
/// Categories and features that do not exist.
pub fn answer(
    w: &World,
    declared: &Declared,
    question: Question,
    category: &Word,
    name: &Word,
) -> Result<bool> {
    match question {
        Question::Active => active(w, declared, category, name),
        Question::Available => available(declared, category, name),
        Question::Defined => defined(w, declared, category, &name.text),
    }
}

/// "There is no such …", with all there are.
fn among<T>(what: &str, word: &Word, known: &[&str]) -> Result<T> {
    let text = format!("there is no {what} `{}`", word.text);
    let mut d = Diagnostic::error(Code::UNKNOWN_NAME, word.span, text);
    if let Some(n) = nearest(&word.text, known.iter().copied()) {
        d = d.help(format!("did you mean `{n}`?"));
    }
    Err(d.help(format!("one of {}", known.join(" "))).into())
}

fn active(w: &World, declared: &Declared, category: &Word, name: &Word) -> Result<bool> {
    const CATEGORIES: &[&str] = &[
        "package",
        "newton",
        "pair",
        "comm_style",
        "min_style",
        "run_style",
        "atom_style",
        "pair_style",
        "bond_style",
        "angle_style",
        "dihedral_style",
        "improper_style",
        "kspace_style",
    ];
    let word = name.text.as_str();
    let named = |known: &[&str], yes: bool| match known.contains(&word) {
        true => Ok(yes),
        false => among(&format!("feature of {}", category.text), name, known),
    };
    match category.text.as_str() {
        // Commands about packages are read and without effect.
        "package" => named(&["gpu", "intel", "kokkos", "omp"], false),
        "newton" => {
            let Newton { pair, bond } = w.settings.newton;
            let yes = (word != "bond" && pair) || (word != "pair" && bond);
            named(&["pair", "bond", "any"], yes)
        }
        "pair" => {
            named(&["single", "respa", "manybody", "tail", "shift"], word == "single" && declared.single)
        }
        "comm_style" => named(&["brick", "tiled"], (word == "tiled") == w.settings.tiled),
        "min_style" => Ok(word == w.settings.minimizer.style.name()),
        "run_style" => Ok(word == w.settings.run_style.name()),
        "atom_style" => Ok(word == w.particles.style.name()),
        "pair_style" => Ok(word == declared.pair.unwrap_or("none")),
        "bond_style" => Ok(word == declared.bond.unwrap_or("none")),
        "angle_style" => {
            Ok((word == "zero") == w.bonds.angles.style.is_some() && ["zero", "none"].contains(&word))
        }
        "dihedral_style" | "improper_style" | "kspace_style" => Ok(word == "none"),
        _ => among("category of is_active()", category, CATEGORIES),
    }
}

fn available(declared: &Declared, category: &Word, name: &Word) -> Result<bool> {
    let (category_name, name) = (category.text.as_str(), name.text.as_str());
    if category_name == "feature" {
        return Ok(["gzip", "png", "exceptions"].contains(&name));
    }
    // LAMMPS' manual has `pair_style` where LAMMPS reads `pair`.
    let of = if category_name == "pair_style" { "pair" } else { category_name };
    match declared.tables.names(of) {
        Some(names) => Ok(names.contains(&name)),
        None => {
            let known: Vec<&str> = STYLES.into_iter().chain(["pair_style", "feature"]).collect();
            among("category of is_available()", category, &known)
        }
    }
}

fn defined(w: &World, declared: &Declared, category: &Word, name: &str) -> Result<bool> {
    Ok(match category.text.as_str() {
        "compute" => {
            let own = ["thermo_temp", "thermo_press", "thermo_pe"].contains(&name);
            own || declared.computes.iter().any(|c| c == name)
        }
        "fix" => declared.fixes.iter().any(|f| f == name),
        "dump" => declared.dumps.iter().any(|d| d == name),
        "group" => w.groups.find(name).is_some(),
        "region" => w.regions.find(name).is_some(),
        _ => {
            let known = ["compute", "dump", "fix", "group", "region", "variable"];
            return among("category of is_defined()", category, &known);
        }
    })
}
