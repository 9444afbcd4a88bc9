//! What formulas ask about the session itself: masks, settings, which features exist and are in use.

use super::build::DECLARATIONS;
use super::node::Graph;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, nearest};
use perigrain_commands::COMMANDS;
use perigrain_computes::COMPUTES;
use perigrain_fixes::FIXES;
use perigrain_lang::{Question, Value};
use perigrain_pairs::PAIRS;
use perigrain_world::{Newton, World};

/// Commands of the session and of the cursor through the deck, which stand in no table.
pub const SESSION_COMMANDS: [&str; 25] = [
    "print",
    "log",
    "echo",
    "clear",
    "compat",
    "run",
    "variable",
    "if",
    "jump",
    "label",
    "next",
    "include",
    "quit",
    "suffix",
    "package",
    "write_restart",
    "read_restart",
    "rerun",
    "minimize",
    "shell",
    "info",
    "timer",
    "partition",
    "balance",
    "comm_style",
];

/// 1 for every particle in the group and in the region, else 0.
///
/// # Errors
/// Unknown names.
pub fn mask(w: &World, group: Option<&str>, region: Option<&str>, span: Span) -> Result<Vec<f64>> {
    let missing = |what: &str, name: &str, known: Option<&str>| {
        let d = Diagnostic::error(Code::UNKNOWN_NAME, span, format!("there is no {what} `{name}`"));
        match known {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None => d,
        }
    };
    let bit = match group {
        None => None,
        Some(g) => match w.groups.find(g) {
            Some(id) => Some(id.bit()),
            None => return Err(missing("group", g, nearest(g, w.groups.names())).into()),
        },
    };
    let region = match region {
        None => None,
        Some(r) => match w.regions.get(r) {
            Some(region) => Some(region),
            None => {
                let known = nearest(r, w.regions.keys().map(String::as_str));
                return Err(missing("region", r, known).into());
            }
        },
    };
    let p = &w.particles;
    let inside =
        |i: usize| bit.is_none_or(|b| p.mask[i] & b != 0) && region.is_none_or(|r| r.contains(p.x[i]));
    Ok((0..p.len()).map(|i| f64::from(u8::from(inside(i)))).collect())
}

/// `extract_setting(name)`; `None` if there is no such setting.
pub fn setting(w: &World, checking: bool, name: &str) -> Option<Value> {
    let s = &w.particles.style;
    let flag = |b: bool| f64::from(u8::from(b));
    let number = match name {
        "dimension" => flag(!w.settings.two_dimensional) + 2.0,
        "box_exist" => flag(w.domain.is_some()),
        "nthreads" => perigrain_base::par::threads() as f64,
        "newton_pair" => flag(w.settings.newton.pair),
        "newton_bond" => flag(w.settings.newton.bond),
        "nlocal" | "nall" if checking => return Some(Value::Unknown),
        "nlocal" | "nall" => w.n() as f64,
        "ntypes" => w.types as f64,
        "rmass_flag" => flag(s.own_mass()),
        "radius_flag" | "omega_flag" | "torque_flag" => flag(s.sphere),
        "peri_flag" => flag(s.peri),
        "molecule_flag" => flag(s.molecules),
        "nbondtypes" => w.bonds.types as f64,
        "world_size" | "universe_size" => 1.0,
        "bigint" => 8.0,
        "tagint" | "imageint" => 4.0,
        "nghost" | "triclinic" | "nangletypes" | "ndihedraltypes" | "nimpropertypes" | "q_flag"
        | "mu_flag" | "ellipsoid_flag" | "angmom_flag" | "world_rank" | "universe_rank" | "nellipsoids"
        | "nlines" | "ntris" | "nbodies" | "kokkos_active" | "kokkos_nthreads" | "kokkos_ngpus" => 0.0,
        _ => return None,
    };
    Some(Value::Number(number))
}

/// What a deck has declared, by name: enough to answer for it inside a step.
#[derive(Clone, Debug, Default)]
pub struct Declared {
    pair: Option<String>,
    computes: Vec<String>,
    fixes: Vec<String>,
    dumps: Vec<String>,
}

impl Declared {
    /// What stands in the graph now.
    pub fn new(graph: &Graph) -> Self {
        Self {
            pair: graph.pair.as_ref().map(|p| p.pair.name().to_owned()),
            computes: graph.computes.iter().map(|c| c.id.clone()).collect(),
            fixes: graph.fixes.iter().map(|f| f.id.clone()).collect(),
            dumps: graph.dumps.iter().map(|d| d.id.clone()).collect(),
        }
    }
}

/// `is_active`, `is_available`, `is_defined`.
///
/// # Errors
/// Categories and names that do not exist.
pub fn answer(
    w: &World,
    declared: &Declared,
    question: Question,
    category: &str,
    name: &str,
    span: Span,
) -> Result<bool> {
    match question {
        Question::Active => active(w, declared, category, name, span),
        Question::Available => available(category, name, span),
        Question::Defined => defined(w, declared, category, name, span),
    }
}

fn among<T>(what: &str, word: &str, known: &[&str], span: Span) -> Result<T> {
    let d = Diagnostic::error(Code::UNKNOWN_NAME, span, format!("there is no {what} `{word}`"));
    Err(match nearest(word, known.iter().copied()) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d.help(format!("one of {}", known.join(" "))),
    }
    .into())
}

fn active(w: &World, declared: &Declared, category: &str, name: &str, span: Span) -> Result<bool> {
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
    let named = |known: &[&str], yes: bool| match known.contains(&name) {
        true => Ok(yes),
        false => among(&format!("feature of {category}"), name, known, span),
    };
    match category {
        "package" => named(&["gpu", "intel", "kokkos", "omp"], false),
        "newton" => {
            let Newton { pair, bond } = w.settings.newton;
            let yes = (name != "bond" && pair) || (name != "pair" && bond);
            named(&["pair", "bond", "any"], yes)
        }
        "pair" => named(
            &["single", "respa", "manybody", "tail", "shift"],
            name == "single" && declared.pair.is_some(),
        ),
        "comm_style" => named(&["brick", "tiled"], (name == "tiled") == w.settings.tiled),
        "min_style" => Ok(name == w.settings.minimizer.style.name()),
        "run_style" => Ok(name == "verlet"),
        "atom_style" => Ok(name == atom_style(w)),
        "pair_style" => Ok(name == declared.pair.as_deref().unwrap_or("none")),
        "bond_style" | "angle_style" | "dihedral_style" | "improper_style" | "kspace_style" => {
            Ok(name == "none")
        }
        _ => among("category of is_active()", category, CATEGORIES, span),
    }
}

fn atom_style(w: &World) -> &'static str {
    match (w.particles.style.sphere, w.particles.style.peri) {
        (true, true) => "hybrid",
        (true, false) => "sphere",
        (false, true) => "peri",
        (false, false) => "atomic",
    }
}

fn available(category: &str, name: &str, span: Span) -> Result<bool> {
    Ok(match category {
        "command" => {
            COMMANDS.iter().any(|c| c.name() == name)
                || DECLARATIONS.contains(&name)
                || SESSION_COMMANDS.contains(&name)
        }
        "compute" => COMPUTES.iter().any(|c| c.name() == name),
        "fix" => FIXES.iter().any(|f| f.name() == name),
        "pair_style" => PAIRS.iter().any(|p| p.name() == name),
        "feature" => ["png", "exceptions"].contains(&name),
        _ => {
            let known = ["command", "compute", "fix", "pair_style", "feature"];
            return among("category of is_available()", category, &known, span);
        }
    })
}

fn defined(w: &World, declared: &Declared, category: &str, name: &str, span: Span) -> Result<bool> {
    Ok(match category {
        "compute" => {
            let own = ["thermo_temp", "thermo_press", "thermo_pe"].contains(&name);
            own || declared.computes.iter().any(|c| c == name)
        }
        "fix" => declared.fixes.iter().any(|f| f == name),
        "dump" => declared.dumps.iter().any(|d| d == name),
        "group" => w.groups.find(name).is_some(),
        "region" => w.regions.contains_key(name),
        _ => {
            let known = ["compute", "dump", "fix", "group", "region", "variable"];
            return among("category of is_defined()", category, &known, span);
        }
    })
}
