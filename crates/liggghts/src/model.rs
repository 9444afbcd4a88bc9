//! The words of a contact model, as `pair_style gran` and `fix wall/gran` have them.

use crate::reading::{choice, unknown, without_counterpart};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_lang::{Args, Word, blame};

/// The law along the normal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Normal {
    #[default]
    Hertz,
    Hooke,
    HertzStiffness,
    HookeStiffness,
    Hysteresis,
}

/// The law across the normal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Tangential {
    #[default]
    Off,
    History,
    NoHistory,
}

/// Attraction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Cohesion {
    #[default]
    Off,
    Sjkr,
    Sjkr2,
}

/// Resistance to rolling.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Rolling {
    #[default]
    Off,
    Cdt,
    Epsd,
    Epsd2,
    Epsd3,
}

/// A contact model.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Model {
    pub normal: Normal,
    pub tangential: Tangential,
    pub cohesion: Cohesion,
    pub rolling: Rolling,
    /// `limitForce`.
    pub limit: bool,
    /// `tangential_damping off`.
    pub undamped: bool,
    /// `ktToKnUser`.
    pub softer: bool,
    /// `absolute_damping`.
    pub absolute: bool,
    /// `tangential_reduce`.
    pub reduce: bool,
    /// `torsionTorque`.
    pub torsion: bool,
}

/// The model with the places of its words.
#[derive(Clone, Debug)]
pub(crate) struct Given {
    pub model: Model,
    /// `pair_style`, or the style of a wall.
    pub reader: Word,
    pub normal: Span,
    pub tangential: Span,
    pub cohesion: Span,
    pub rolling: Span,
}

const NORMALS: &[(&str, Normal)] = &[
    ("hertz", Normal::Hertz),
    ("hooke", Normal::Hooke),
    ("hertz/stiffness", Normal::HertzStiffness),
    ("hooke/stiffness", Normal::HookeStiffness),
    ("hooke/hysteresis", Normal::Hysteresis),
];
const TANGENTIALS: &[(&str, Tangential)] =
    &[("off", Tangential::Off), ("history", Tangential::History), ("no_history", Tangential::NoHistory)];
const COHESIONS: &[(&str, Cohesion)] =
    &[("off", Cohesion::Off), ("sjkr", Cohesion::Sjkr), ("sjkr2", Cohesion::Sjkr2)];
const ROLLINGS: &[(&str, Rolling)] = &[
    ("off", Rolling::Off),
    ("cdt", Rolling::Cdt),
    ("epsd", Rolling::Epsd),
    ("epsd2", Rolling::Epsd2),
    ("epsd3", Rolling::Epsd3),
];

/// Words of models that have no counterpart, each with what it is and what to take instead.
const REFUSED: &[(&str, &str, &str)] = &[
    ("jkr", "a law of a fork of LIGGGHTS", "write native lines: `pair_coeff * * jkr E nu gamma …`"),
    ("hertz/break", "a law of a fork of LIGGGHTS", "bonds that break: `bond_style bpm/beam`"),
    ("luding", "a law of a fork of LIGGGHTS", "`model hooke/hysteresis` is the nearest one"),
    ("tan_luding", "a law of a fork of LIGGGHTS", "`tangential history` beside `model hooke/hysteresis`"),
    ("vdw", "a law of a fork of LIGGGHTS", "native lines: `pair_coeff * * … cohesion …`, or `dmt`"),
    ("edinburgh", "a law of a fork of LIGGGHTS", "`model hooke/hysteresis` is the nearest one"),
    ("thorn_ning", "a law of a fork of LIGGGHTS", "native lines: `pair_coeff * * mdr …`"),
    ("bond", "a law of a fork of LIGGGHTS", "`bond_style bpm/beam` joins grains"),
    ("easo/capillary/viscous", "liquid bridges", "native lines: `pair_coeff … cohesion capillary …`"),
    ("washino/capillary/viscous", "liquid bridges", "native lines: `pair_coeff … cohesion capillary …`"),
    ("viscous", "a damping by viscosity of a fluid", "`model hertz` with coefficientRestitution"),
    ("multicontact", "a law that is not pairwise", "`surface default` leaves it out"),
    ("superquadric", "a shape that is no sphere", "clumps of spheres: `molecule` and `fix rigid/small`"),
];

/// The switches of models.
const SWITCHES: &[&str] = &[
    "limitForce",
    "tangential_damping",
    "ktToKnUser",
    "absolute_damping",
    "tangential_reduce",
    "torsionTorque",
    "computeElasticPotential",
    "computeDissipatedEnergy",
    "heating_normal_hertz",
    "heating_normal_hooke",
    "heating_tangential_history",
    "heating_rolling_epsd",
    "heating_tracking",
    "disableTangentialWhenBonded",
    "disableNormalWhenBonded",
];

/// The heads of a model's parts, in the order of LIGGGHTS.
pub(crate) const PARTS: [&str; 5] = ["model", "tangential", "cohesion", "rolling_friction", "surface"];

/// Parts of models of forks.
const OTHER_PARTS: &[(&str, &str, &str)] = &[
    ("viscous", "a damping by viscosity of a fluid", "`model hertz` with coefficientRestitution"),
    ("heat_transfer", "a part of a model of a fork of LIGGGHTS", "`fix heat/gran`"),
];

impl Model {
    /// Whether its constants are those of springs and not of materials.
    pub fn is_stiffness(&self) -> bool {
        matches!(self.normal, Normal::HertzStiffness | Normal::HookeStiffness)
    }

    /// Whether it is one of Hertz' laws.
    pub fn is_hertz(&self) -> bool {
        matches!(self.normal, Normal::Hertz | Normal::HertzStiffness)
    }
}

/// Takes one of the words of a table, or refuses it by name.
fn of<T: Copy>(args: &mut Args, what: &str, table: &[(&str, T)]) -> Result<T> {
    let word = args.expect(what)?;
    if let Some((_, value)) = table.iter().find(|(name, _)| *name == word.text) {
        return Ok(*value);
    }
    let tail = word.text.rsplit('/').next().unwrap_or("");
    let listed = |text: &str| REFUSED.iter().find(|(name, _, _)| *name == text);
    if let Some((_, what, help)) = listed(&word.text).or_else(|| listed(tail)) {
        return Err(without_counterpart(word, what, help).into());
    }
    let known: Vec<&str> = table.iter().map(|(name, _)| *name).collect();
    Err(unknown(word, what, &known).into())
}

/// Reads the parts of a model, up to a word that is none.
pub(crate) fn parts(args: &mut Args, reader: &Word) -> Result<Given> {
    let mut model = Model::default();
    let at = reader.span;
    let mut given = Given {
        model: model.clone(),
        reader: reader.clone(),
        normal: at,
        tangential: at,
        cohesion: at,
        rolling: at,
    };
    let mut next = 0;
    while let Some(head) = args.peek().cloned() {
        if let Some((_, what, help)) = OTHER_PARTS.iter().find(|(name, _, _)| *name == head.text) {
            return Err(without_counterpart(&head, what, help).into());
        }
        let Some(k) = PARTS.iter().position(|part| *part == head.text) else { break };
        if k < next {
            let text = format!("`{}` stands too late", head.text);
            let d = Diagnostic::error(Code::WRONG_ORDER, head.span, text);
            return Err(d.help(format!("the order is: {}, then switches", PARTS.join(" "))).into());
        }
        next = k + 1;
        args.next();
        let span = head.span.to(args.here());
        match k {
            0 => (model.normal, given.normal) = (of(args, "model", NORMALS)?, span),
            1 => {
                (model.tangential, given.tangential) = (of(args, "tangential model", TANGENTIALS)?, span);
            }
            2 => (model.cohesion, given.cohesion) = (of(args, "cohesion model", COHESIONS)?, span),
            3 => (model.rolling, given.rolling) = (of(args, "rolling friction model", ROLLINGS)?, span),
            _ => of(args, "surface model", &[("default", ())])?,
        }
    }
    given.model = model;
    Ok(given)
}

/// Reads a switch, where one stands; a note where it changes nothing here.
pub(crate) fn switch(args: &mut Args, model: &mut Model) -> Result<Option<Option<Diagnostic>>> {
    let Some(word) = args.peek().filter(|w| SWITCHES.contains(&w.text.as_str())).cloned() else {
        return Ok(None);
    };
    args.next();
    let on = choice(args, "state of a switch", &["on", "off"])? == "on";
    let wrong = |text: &str| Err(blame(&word, Code::CONFLICT, text).into());
    match word.text.as_str() {
        "limitForce" => model.limit = on,
        "tangential_damping" => model.undamped = !on,
        "ktToKnUser" if on && model.normal != Normal::Hooke => {
            return wrong("`ktToKnUser` is a switch of `model hooke`");
        }
        "ktToKnUser" => model.softer = on,
        "absolute_damping" if on && model.normal != Normal::HookeStiffness => {
            return wrong("`absolute_damping` is a switch of `model hooke/stiffness`");
        }
        "absolute_damping" => model.absolute = on,
        "tangential_reduce" => model.reduce = on,
        "torsionTorque" => model.torsion = on,
        "disableTangentialWhenBonded" | "disableNormalWhenBonded" if on => {
            let help = "`special_bonds` and `neigh_modify exclude` leave pairs out";
            return Err(without_counterpart(&word, "a switch about bonded grains", help).into());
        }
        _ if on => {
            let text = format!("`{} on` is without effect here", word.text);
            let help = "`compute energy/ledger` has the energies of contacts";
            return Ok(Some(Some(Diagnostic::note(Code::DIALECT, word.span, text).help(help))));
        }
        _ => {}
    }
    Ok(Some(None))
}

/// Every word that a switch of a model may be, for `known:` lists.
pub(crate) fn switches() -> &'static [&'static str] {
    SWITCHES
}
