//! The words of a `calibrate` line.

use super::conflicts;
pub use super::kinds::{Map, Method, Quantity, Shape, Solver, Target, Vary};
use super::line::{Breaks, Calibration, Contacts, Head, Load, Sizes, Solution};
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_statics::ends::Hold;
use perigrain_statics::strength::Avalanche;
use perigrain_styles::BuildCx;
use perigrain_styles::words::Or;

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

impl Default for Words {
    fn default() -> Self {
        Self {
            axis: 2,
            strain: -0.01,
            holds: [Hold::Grip; 2],
            wall: None,
            thick: None,
            rotations: true,
            contacts: None,
            relaxed: true,
            tol: 0.01,
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
            together: 0.0,
            curve: None,
        }
    }
}

impl Words {
    /// What a line says, with its ID and group.
    ///
    /// # Errors
    /// Words that do not go together.
    pub fn new(line: Calibration, cx: &BuildCx) -> Result<(Head, Self)> {
        let mut out = Self::default();
        let (kind, head) = match line {
            Calibration::Dsm(dsm) => {
                out.load(dsm.load);
                out.solution(dsm.solution);
                out.contacts(dsm.contacts);
                out.sizes(dsm.sizes);
                out.bound = dsm.bound.filter(|bound| bound.value).map(|bound| bound.span);
                if let Some(way) = dsm.method {
                    out.method = way.value.method();
                    out.paper = (out.method != Method::Pcg).then_some(way.span);
                }
                out.fields = dsm.fields;
                ("dsm", dsm.head)
            }
            Calibration::Ste(ste) => {
                out.load(ste.load);
                out.contacts(ste.contacts);
                out.order = ste.order.min(1_000_000);
                out.slabs = ste.slabs.map(|height| match height {
                    Or::Word(_) => None,
                    Or::Else(height) => Some(height.0),
                });
                out.map = ste.map.map(|map| map.parts());
                ("ste", ste.head)
            }
            Calibration::Periodic(cell) => {
                out.solution(cell.solution);
                ("periodic", cell.head)
            }
            Calibration::Strength(line) => {
                out.tol = BREAKING;
                out.load(line.load);
                out.breaks(line.breaks);
                out.solution(line.solution);
                out.fields = line.fields;
                out.curve = line.curve.map(|word| (word.text, word.span));
                ("strength", line.head)
            }
            Calibration::Fit(fit) => {
                (out.tol, out.together) = (0.005, TOGETHER);
                out.load(fit.load);
                out.breaks(fit.breaks);
                out.solution(fit.solution);
                out.contacts(fit.contacts);
                out.sizes(fit.sizes);
                (out.solver, out.order) = (fit.method, fit.order.min(1_000_000));
                out.targets = fit.target.into_iter().map(Target::from).collect();
                let types = cx.world.bonds.types;
                for vary in fit.vary {
                    let (kind, name) = vary.parts();
                    if kind.value > types as i64 {
                        let text = format!("there are bond types 1 to {types}");
                        return fail(Code::BAD_VALUE, kind.span, text);
                    }
                    out.vary.push(Vary { kind: kind.value as u16, name: name.text, span: name.span });
                }
                ("fit", fit.head)
            }
        };
        conflicts::refuse(&out, kind)?;
        Ok((head, out))
    }

    fn load(&mut self, load: Load) {
        (self.axis, self.body) = (load.axis.0, load.of_body());
        self.strain = load.strain;
        for (hold, end) in self.holds.iter_mut().zip([load.low, load.high]) {
            let Some(end) = end else { continue };
            *hold = end.value.into();
            self.wall = self.wall.or((*hold == Hold::Wall).then_some(end.span));
        }
        self.thick = load.thick;
        self.shape = load.shape;
    }

    fn breaks(&mut self, breaks: Breaks) {
        (self.until, self.most, self.avalanche) = (breaks.until, breaks.most, breaks.avalanche);
        self.together = breaks.together.unwrap_or(self.together);
    }

    fn solution(&mut self, solution: Solution) {
        self.rotations = solution.rotations;
        self.tol = solution.tol.unwrap_or(self.tol);
    }

    fn contacts(&mut self, contacts: Contacts) {
        self.contacts = contacts.contacts.map(|at| (at.value, at.span));
        self.friction = contacts.mu.map(|at| (at.value, at.span));
    }

    fn sizes(&mut self, sizes: Sizes) {
        self.relaxed = sizes.is_relaxed();
        self.large = sizes.large.filter(|large| large.value).map(|large| large.span);
        self.parts = sizes.steps.map(|steps| (steps.value, steps.span));
    }

    /// Whether the load is put on in parts, for displacements of any size.
    pub fn by_parts(&self) -> bool {
        self.large.is_some() || self.friction.is_some()
    }

    /// Whether a fit is to reach such a number.
    pub fn aims(&self, quantity: Quantity) -> bool {
        self.targets.iter().any(|t| t.quantity == quantity)
    }
}
