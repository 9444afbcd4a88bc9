//! The words of a `calibrate` line.

use super::conflicts;
pub use super::kinds::{Map, Method, Quantity, Shape, Solver, Target, Vary};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_bonded::ends::Hold;
use perigrain_bonded::strength::Avalanche;
use perigrain_lang::Args;
use perigrain_styles::common::axis;

/// The accuracy to which a break is resolved, relative to the change it causes, by default.
const BREAKING: f64 = 1e-4;
/// The same for the way to strength of a fit, where bonds that lack more than that of the load go together anyway.
pub const BREAKING_IN_FITS: f64 = 1e-3;
/// The part of the load that bonds may lack to break together with another one in a fit, by default.
const TOGETHER: f64 = 0.005;

/// All words, with their defaults.
#[derive(Clone, Debug)]
pub struct Words {
    /// Direction of the load.
    pub axis: usize,
    /// Its strain.
    pub strain: f64,
    /// The ends.
    pub holds: [Hold; 2],
    /// The place of the first end that is a wall.
    pub wall: Option<Span>,
    /// How far an end reaches [length].
    pub thick: Option<f64>,
    /// Whether particles turn.
    pub rotations: bool,
    /// Whether contacts count; `None`: where the pair style has some.
    pub contacts: Option<(bool, Span)>,
    /// Whether forces that contacts have before the load are taken away.
    pub relaxed: bool,
    /// The part of the energy to which it is to be known.
    pub tol: f64,
    /// For certain.
    pub bound: Option<Span>,
    /// How.
    pub method: Method,
    /// The word `paper`, if given.
    pub paper: Option<Span>,
    /// Cross-section.
    pub shape: Shape,
    /// Whether E is of the length of the body, not of the distance of the ends.
    pub body: bool,
    /// Whether fields are kept.
    pub fields: bool,
    /// The word `large`, if displacements are of any size.
    pub large: Option<Span>,
    /// Friction between particles, and its word; `None`: they stick.
    pub friction: Option<(f64, Span)>,
    /// The number of parts in which the load is applied, and the word, if given.
    pub parts: Option<(usize, Span)>,
    /// Order of the estimate.
    pub order: usize,
    /// Height of slabs: `None` none, `Some(None)` two diameters.
    pub slabs: Option<Option<f64>>,
    /// A map, and the radius of the surroundings [length].
    pub map: Option<(Map, f64)>,
    /// To be reached.
    pub targets: Vec<Target>,
    /// To be varied.
    pub vary: Vec<Vary>,
    /// What solves for a fit.
    pub solver: Solver,
    /// Breaking ends once the force is below this part of the largest one.
    pub until: f64,
    /// Or after so many breaks.
    pub most: usize,
    /// What breaks together.
    pub avalanche: Avalanche,
    /// The part of the load that bonds may lack to break with another one.
    pub together: f64,
    /// A file for the breaks, and its word.
    pub curve: Option<(String, Span)>,
}

/// Of a body under a load.
const LOAD: &[&str] = &["axis", "strain", "low", "high", "thick", "shape", "length"];
/// Of breaks.
const BREAKS: &[&str] = &["until", "most", "avalanche", "together"];

/// What of [`Words`] a kind of calibration has.
pub fn keywords(kind: &str) -> Vec<&'static str> {
    match kind {
        "dsm" => {
            let own = [
                "rotations",
                "contacts",
                "prestress",
                "tol",
                "bound",
                "method",
                "fields",
                "large",
                "mu",
                "steps",
            ];
            [LOAD, &own].concat()
        }
        "ste" => [LOAD, &["contacts", "order", "slabs", "map", "mu"]].concat(),
        "periodic" => vec!["rotations", "tol"],
        "strength" => [LOAD, BREAKS, &["rotations", "tol", "fields", "curve"]].concat(),
        _ => {
            let own = [
                "target",
                "vary",
                "method",
                "tol",
                "rotations",
                "contacts",
                "prestress",
                "order",
                "large",
                "mu",
                "steps",
            ];
            [&own, LOAD, BREAKS].concat()
        }
    }
}

impl Words {
    /// Reads the words behind the group.
    ///
    /// # Errors
    /// Every mistake in them.
    pub fn read(a: &mut Args, kind: &str, types: usize) -> Result<Self> {
        let mut out = Self {
            axis: 2,
            strain: -0.01,
            holds: [Hold::Grip; 2],
            wall: None,
            thick: None,
            rotations: true,
            contacts: None,
            relaxed: true,
            tol: match kind {
                "fit" => 0.005,
                "strength" => BREAKING,
                _ => 0.01,
            },
            bound: None,
            method: Method::Pcg,
            paper: None,
            shape: Shape::Block,
            body: false,
            fields: false,
            large: None,
            friction: None,
            parts: None,
            order: 2,
            slabs: None,
            map: None,
            targets: vec![],
            vary: vec![],
            solver: Solver::Dsm,
            until: 0.5,
            most: usize::MAX,
            avalanche: Avalanche::default(),
            together: if kind == "fit" { TOGETHER } else { 0.0 },
            curve: None,
        };
        let known = keywords(kind);
        while let Some(word) = a.next() {
            let Some(name) = known.iter().find(|k| **k == word.text) else {
                return Err(out.unknown(a, word, kind));
            };
            out.keyword(a, name, kind == "fit", types, word.span)?;
        }
        conflicts::refuse(&out, kind)?;
        Ok(out)
    }

    /// Whether the load is put on in parts, for displacements of any size.
    pub fn by_parts(&self) -> bool {
        self.large.is_some() || self.friction.is_some()
    }

    /// Whether a fit is to reach such a number.
    pub fn aims(&self, quantity: Quantity) -> bool {
        self.targets.iter().any(|t| t.quantity == quantity)
    }

    fn unknown(
        &self,
        a: &Args,
        word: &perigrain_lang::Word,
        kind: &str,
    ) -> perigrain_base::diag::Diagnostics {
        let elsewhere = ["dsm", "ste", "periodic", "strength", "fit"]
            .into_iter()
            .find(|k| keywords(k).contains(&word.text.as_str()));
        match elsewhere {
            Some(other) => {
                let text = format!("`{}` does not concern `calibrate {kind}`", word.text);
                Diagnostic::error(Code::BAD_VALUE, word.span, text)
                    .help(format!("`calibrate {other}` has it"))
                    .into()
            }
            None => a.unknown(word, &keywords(kind)),
        }
    }

    fn keyword(&mut self, a: &mut Args, name: &str, fit: bool, types: usize, at: Span) -> Result<()> {
        let value = a.here();
        match name {
            "axis" => self.axis = axis(a, "axis of the load")?,
            "strain" => self.strain = strain(a)?,
            "low" => self.hold(a, 0)?,
            "high" => self.hold(a, 1)?,
            "thick" => self.thick = Some(a.positive("the thickness of an end")?),
            "rotations" => self.rotations = a.flag("rotations")?,
            "prestress" => self.relaxed = a.choice("prestress", &["remove", "keep"])? == "remove",
            "contacts" => self.contacts = Some((a.flag("contacts")?, at)),
            "tol" => self.tol = tolerance(a)?,
            "bound" => self.bound = a.flag("bound")?.then_some(value),
            "method" if fit => {
                self.solver = match a.choice("method of a fit", &["dsm", "ste", "periodic"])? {
                    "dsm" => Solver::Dsm,
                    "ste" => Solver::Ste,
                    _ => Solver::Periodic,
                }
            }
            "method" => {
                self.method = method(a)?;
                self.paper = (self.method != Method::Pcg).then_some(value);
            }
            "large" => self.large = a.flag("large")?.then_some(at),
            "mu" => self.friction = Some((a.non_negative("the coefficient of friction")?, at)),
            "steps" => self.parts = Some((a.integer_from(1, "the number of steps")? as usize, at)),
            "until" | "most" | "avalanche" | "together" | "curve" => self.breaking(a, name)?,
            "shape" | "length" | "fields" | "order" | "slabs" | "map" => self.measure(a, name)?,
            "target" => self.targets.push(target(a)?),
            _ => self.vary(a, types)?,
        }
        Ok(())
    }

    fn measure(&mut self, a: &mut Args, name: &str) -> Result<()> {
        match name {
            "shape" => {
                self.shape = match a.choice("shape", &["block", "cylinder", "area"])? {
                    "block" => Shape::Block,
                    "cylinder" => Shape::Cylinder,
                    _ => Shape::Area(a.positive("the area")?),
                }
            }
            "length" => self.body = a.choice("length", &["free", "body"])? == "body",
            "fields" => self.fields = a.flag("fields")?,
            "order" => self.order = a.integer_from(0, "the order")?.min(1_000_000) as usize,
            "map" => {
                let deviation = a.choice("map", &["deviation", "stiffness"])? == "deviation";
                let map = if deviation { Map::Deviation } else { Map::Stiffness };
                self.map = Some((map, a.positive("the radius of the surroundings")?));
            }
            _ => {
                self.slabs =
                    Some(if a.eat("auto") { None } else { Some(a.positive("the height of a slab")?) })
            }
        }
        Ok(())
    }

    fn breaking(&mut self, a: &mut Args, name: &str) -> Result<()> {
        let span = a.here();
        match name {
            "until" => {
                self.until = a.non_negative("the part of the largest force")?;
                if self.until >= 1.0 {
                    return fail(Code::BAD_VALUE, span, "the part of the largest force is to be below 1");
                }
            }
            "avalanche" => {
                let one = a.choice("what breaks in an avalanche", &["one", "all"])? == "one";
                self.avalanche = if one { Avalanche::One } else { Avalanche::All };
            }
            "together" => {
                self.together = a.non_negative("the part of the load")?;
                if self.together >= 1.0 {
                    return fail(Code::BAD_VALUE, span, "the part of the load is to be below 1");
                }
            }
            "most" => self.most = a.integer_from(1, "the number of breaks")? as usize,
            _ => {
                let word = a.expect("a file for the breaks")?;
                self.curve = Some((word.text.clone(), word.span));
            }
        }
        Ok(())
    }

    fn hold(&mut self, a: &mut Args, end: usize) -> Result<()> {
        let span = a.here();
        self.holds[end] = match a.choice("way to hold an end", &["grip", "plate", "wall"])? {
            "grip" => Hold::Grip,
            "plate" => Hold::Plate,
            _ => {
                self.wall = self.wall.or(Some(span));
                Hold::Wall
            }
        };
        Ok(())
    }

    fn vary(&mut self, a: &mut Args, types: usize) -> Result<()> {
        a.choice("what varies", &["bond"])?;
        let span = a.here();
        let kind = a.integer_from(1, "a bond type")?;
        if kind > types as i64 {
            return fail(Code::BAD_VALUE, span, format!("there are bond types 1 to {types}"));
        }
        let word = a.expect("a coefficient of the bond style")?;
        self.vary.push(Vary { kind: kind as u16, name: word.text.clone(), span: word.span });
        Ok(())
    }
}

fn strain(a: &mut Args) -> Result<f64> {
    let span = a.here();
    let strain = a.number("the strain")?;
    if strain == 0.0 {
        return fail(Code::BAD_VALUE, span, "without a strain there is no stiffness: write about -0.01");
    }
    if strain <= -1.0 {
        let text = format!("a strain of {strain} turns bonds inside out");
        let d = Diagnostic::error(Code::BAD_VALUE, span, text);
        return Err(d
            .help("strains are above -1; displacements are small ones, so that about -0.01 is meant")
            .into());
    }
    Ok(strain)
}

fn tolerance(a: &mut Args) -> Result<f64> {
    let span = a.here();
    let tol = a.positive("the tolerance")?;
    if tol >= 1.0 {
        return fail(Code::BAD_VALUE, span, "the tolerance is a part of the stiffness: it must be below 1");
    }
    Ok(tol)
}

fn method(a: &mut Args) -> Result<Method> {
    if a.choice("method", &["pcg", "paper"])? == "pcg" {
        return Ok(Method::Pcg);
    }
    let mut limits = [1e-6, 1e-3];
    for limit in &mut limits {
        if a.peek().is_some_and(|w| w.text.parse::<f64>().is_ok()) {
            *limit = a.positive("the force that may be left")?;
        }
    }
    Ok(Method::Paper(limits))
}

fn target(a: &mut Args) -> Result<Target> {
    let quantity = match a.choice("quantity", &["K", "E", "nu", "strength"])? {
        "K" => Quantity::Stiffness,
        "E" => Quantity::Young,
        "nu" => Quantity::Poisson,
        _ => Quantity::Strength,
    };
    Ok(Target { quantity, value: a.positive("the value to reach")? })
}
