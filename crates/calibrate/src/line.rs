//! The words of a `calibrate` line as they stand in it.

use super::kinds::{Map, Method, Quantity, Shape, Solver, Target};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail};
use perigrain_lang::{Args, Word};
use perigrain_statics::ends::Hold;
use perigrain_statics::strength::Avalanche;
use perigrain_styles::BuildCx;
use perigrain_styles::words::{At, Axis, Forms, Kind, Or, Positive, Value, Words};
use perigrain_world::GroupId;

#[derive(Words)]
#[word(forms = "calibrate", what = "kind of calibration", foreign = foreign)]
pub enum Calibration {
    /// The direct stiffness method: both ends of the body along the axis are held and come closer by the strain times their distance.
    Dsm(Dsm),
    /// The estimate of the tensor of stiffness, without boundary conditions.
    Ste(Ste),
    /// The tensor of a cell that repeats in all directions, from six load cases, with the mean field beside.
    Periodic(Periodic),
    /// Loads the body ever more until its bonds have broken.
    Strength(Strength),
    /// Varies coefficients of bond types until targets are reached, and sets them as `bond_coeff` lines would.
    Fit(Fit),
}

/// The refusal of a keyword of another kind.
fn foreign(form: &str, word: &Word) -> Option<Diagnostics> {
    let other = Calibration::FORMS.iter().find(|f| f.grammar.has(&word.text))?.head;
    let text = format!("`{}` does not concern `calibrate {form}`", word.text);
    let d = Diagnostic::error(Code::BAD_VALUE, word.span, text);
    Some(d.help(format!("`{other}` has it")).into())
}

#[derive(Words)]
pub struct Head {
    /// The name of the results, which are read as `c_ID[1]`.
    #[word(name = "ID", what = "an ID for the results")]
    pub id: Word,
    #[word(name = "GROUP")]
    pub group: GroupId,
}

#[derive(Words)]
pub struct Dsm {
    #[word(flatten)]
    pub head: Head,
    #[word(flatten)]
    pub load: Load,
    #[word(flatten)]
    pub solution: Solution,
    #[word(flatten)]
    pub contacts: Contacts,
    #[word(flatten)]
    pub sizes: Sizes,
    /// Whether it continues until a lower bound proves the tolerance, for two `grip` ends and bonds alone.
    #[word(keyword, what = "bound", shown = "no")]
    pub bound: Option<At<bool>>,
    #[word(keyword, shown = "pcg")]
    pub method: Option<At<Way>>,
    /// Whether displacements and rotations are kept by particle.
    #[word(keyword, default = false)]
    pub fields: bool,
}

#[derive(Words)]
pub struct Ste {
    #[word(flatten)]
    pub head: Head,
    #[word(flatten)]
    pub load: Load,
    #[word(flatten)]
    pub contacts: Contacts,
    /// The order: 0 lets all particles follow the strain, 1 and 2 are those of the paper, N from 3 on takes N sweeps.
    #[word(keyword, name = "N", from = 0, default = 2)]
    pub order: usize,
    /// The height of a slab: layers of two diameters, or of a height, one behind the other [length].
    #[word(keyword, name = "H")]
    pub slabs: Option<Or<Auto, Positive>>,
    #[word(keyword)]
    pub map: Option<Mapped>,
}

#[derive(Words)]
pub struct Periodic {
    #[word(flatten)]
    pub head: Head,
    #[word(flatten)]
    pub solution: Solution,
}

#[derive(Words)]
pub struct Strength {
    #[word(flatten)]
    pub head: Head,
    #[word(flatten)]
    pub load: Load,
    #[word(flatten)]
    pub breaks: Breaks,
    #[word(flatten)]
    pub solution: Solution,
    /// Whether the motion at the largest force is kept by particle.
    #[word(keyword, default = false)]
    pub fields: bool,
    /// A file for the breaks: number, strain, force, stress, energy set free at ends that stand still, and the IDs of the bond.
    #[word(keyword, name = "FILE", what = "a file for the breaks", kind = Kind::File)]
    pub curve: Option<Word>,
}

#[derive(Words)]
pub struct Fit {
    #[word(flatten)]
    pub head: Head,
    #[word(keyword)]
    pub target: Vec<Aim>,
    #[word(keyword)]
    pub vary: Vec<Varied>,
    #[word(keyword, like = Solving, default = Solver::Dsm)]
    pub method: Solver,
    #[word(flatten)]
    pub solution: Solution,
    #[word(flatten)]
    pub contacts: Contacts,
    #[word(flatten)]
    pub sizes: Sizes,
    /// The order: 0 lets all particles follow the strain, 1 and 2 are those of the paper, N from 3 on takes N sweeps.
    #[word(keyword, name = "N", from = 0, default = 2)]
    pub order: usize,
    #[word(flatten)]
    pub load: Load,
    #[word(flatten)]
    pub breaks: Breaks,
}

/// Of a body under a load.
#[derive(Words)]
pub struct Load {
    /// The direction of the load.
    #[word(keyword, name = "x|y|z", what = "axis of the load", default = Axis(2), shown = "z")]
    pub axis: Axis,
    /// The strain; below 0 it presses.
    #[word(keyword, name = "S", with = strain, kind = Kind::Number, default = -0.01, shown = "-0.01")]
    pub strain: f64,
    #[word(keyword, shown = "grip")]
    pub low: Option<At<End>>,
    #[word(keyword, shown = "grip")]
    pub high: Option<At<End>>,
    /// The thickness of an end: all particles belong to it whose surface is so near to the outermost one; by default the mean radius [length].
    #[word(keyword, name = "T", what = "the thickness of an end", positive)]
    pub thick: Option<f64>,
    #[word(keyword, default = Shape::Block)]
    pub shape: Shape,
    #[word(keyword, default = Length::Free)]
    length: Length,
}

impl Load {
    /// Whether E is of the length of the body.
    pub fn of_body(&self) -> bool {
        self.length == Length::Body
    }
}

/// How an end is held.
#[derive(Words)]
#[word(what = "way to hold an end", of = Hold)]
pub enum End {
    /// Particles of the end are held wholly.
    Grip,
    /// Particles of the end are held along the axis only.
    Plate,
    /// A rigid plane at the outermost surface pushes what touches it, by Hertz' law with the pair style's coefficients and twice the stiffness of two
    /// such particles.
    Wall,
}

/// Which length strains are parts of.
#[derive(PartialEq, Words)]
#[word(what = "length")]
enum Length {
    /// E is that of the distance of the ends.
    Free,
    /// E is that of the distance of the outermost surfaces.
    Body,
}

/// Of breaks.
#[derive(Words)]
pub struct Breaks {
    /// Breaking ends once the force is below this part of the largest one.
    #[word(keyword, name = "P", with = until, kind = Kind::Number, default = 0.5)]
    pub until: f64,
    /// The number of breaks after which it ends, too.
    #[word(keyword, name = "N", what = "the number of breaks", from = 1, default = usize::MAX, shown = "")]
    pub most: usize,
    #[word(keyword, like = Falling, default = Avalanche::default(), shown = "all")]
    pub avalanche: Avalanche,
    /// Bonds that lack less than this part of the load break with another one: 0.005 in a fit, else none.
    #[word(keyword, name = "P", with = together, kind = Kind::Number)]
    pub together: Option<f64>,
}

/// What breaks in an avalanche.
#[derive(Words)]
#[word(what = "what breaks in an avalanche", of = Avalanche)]
enum Falling {
    /// The ends go back until one bond at a time breaks, which is the most the body could bear.
    One,
    /// The ends stand still, and all bonds beyond their strength go together.
    All,
}

/// How well the body is solved.
#[derive(Words)]
pub struct Solution {
    /// Whether particles turn; without it a body is some percent too stiff.
    #[word(keyword, default = true)]
    pub rotations: bool,
    /// The part of the energy (of `strength`: of what a break has changed; of `fit`: of the targets) to which it is to be known: 0.01, 1e-4, 0.005.
    #[word(keyword, name = "P", with = tolerance, kind = Kind::Number)]
    pub tol: Option<f64>,
}

/// Of contacts.
#[derive(Words)]
pub struct Contacts {
    /// Whether contacts between particles count; where the pair style has Hertz contacts unless given.
    #[word(keyword, what = "contacts", placed)]
    pub contacts: Option<At<bool>>,
    /// The coefficient of friction between particles, which stick without it.
    #[word(keyword, name = "M", non_negative, placed)]
    pub mu: Option<At<f64>>,
}

/// Of displacements of any size.
#[derive(Words)]
pub struct Sizes {
    #[word(keyword, default = Prestress::Remove)]
    prestress: Prestress,
    /// Whether displacements and turns may be of any size.
    #[word(keyword, what = "large", placed, shown = "no")]
    pub large: Option<At<bool>>,
    /// The number of steps in which the load is put on, with `large` or `mu`.
    #[word(keyword, name = "N", from = 1, placed, shown = "1")]
    pub steps: Option<At<usize>>,
}

impl Sizes {
    /// Whether forces that contacts have before the load are taken away.
    pub fn is_relaxed(&self) -> bool {
        self.prestress == Prestress::Remove
    }
}

/// What becomes of the force that overlaps have before the load.
#[derive(PartialEq, Words)]
#[word(what = "prestress")]
enum Prestress {
    /// The force that overlaps have before the load is taken away.
    Remove,
    /// It stays.
    Keep,
}

/// How the linear system is solved.
#[derive(Words)]
#[word(what = "method")]
pub enum Way {
    /// Conjugate gradients from the affine field.
    Pcg,
    /// From zero until the residual |r| is below FL (linear, 1e-6) and FN (with contacts, 1e-3) in force units.
    Paper(
        #[word(name = "FL", what = "the force that may be left")] Option<Limit>,
        #[word(name = "FN", what = "the force that may be left")] Option<Limit>,
    ),
}

impl Way {
    /// The method.
    pub fn method(&self) -> Method {
        match self {
            Self::Pcg => Method::Pcg,
            Self::Paper(linear, other) => {
                Method::Paper([linear.as_ref().map_or(1e-6, |l| l.0), other.as_ref().map_or(1e-3, |l| l.0)])
            }
        }
    }
}

/// A force that may be left.
pub struct Limit(f64);

impl Value for Limit {
    const KIND: Kind = Kind::Number;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.positive(what).map(Self)
    }
    fn begins(word: &Word) -> bool {
        word.text.parse::<f64>().is_ok()
    }
}

/// The word for two diameters.
#[derive(Words)]
pub enum Auto {
    Auto,
}

/// A map of the surroundings of each particle.
#[derive(Words)]
#[word(what = "map")]
pub enum Mapped {
    /// By which part the K of `stiffness` is below its mean (positive is softer).
    Deviation(#[word(name = "D", what = "the radius of the surroundings", positive)] f64),
    /// The K along x, y, z that the body had if all of it were like the ball of radius D around the particle: c_ID[1] to [3].
    Stiffness(#[word(name = "D", what = "the radius of the surroundings", positive)] f64),
}

impl Mapped {
    /// The map and the radius.
    pub fn parts(&self) -> (Map, f64) {
        match self {
            Self::Deviation(radius) => (Map::Deviation, *radius),
            Self::Stiffness(radius) => (Map::Stiffness, *radius),
        }
    }
}

/// A number to reach.
#[derive(Words)]
#[word(what = "quantity")]
pub enum Aim {
    /// The stiffness; of `periodic` the bulk modulus.
    #[word("K")]
    Stiffness(#[word(name = "V", what = "the value to reach", positive)] f64),
    /// Young's modulus.
    #[word("E")]
    Young(#[word(name = "V", what = "the value to reach", positive)] f64),
    /// Poisson's ratio.
    #[word("nu")]
    Poisson(#[word(name = "V", what = "the value to reach", positive)] f64),
    /// The largest force over the section.
    #[word("strength")]
    Strength(#[word(name = "V", what = "the value to reach", positive)] f64),
}

impl From<Aim> for Target {
    fn from(aim: Aim) -> Self {
        let (quantity, value) = match aim {
            Aim::Stiffness(value) => (Quantity::Stiffness, value),
            Aim::Young(value) => (Quantity::Young, value),
            Aim::Poisson(value) => (Quantity::Poisson, value),
            Aim::Strength(value) => (Quantity::Strength, value),
        };
        Self { quantity, value }
    }
}

/// A coefficient to vary.
#[derive(Words)]
#[word(what = "what varies")]
pub enum Varied {
    /// A coefficient of a bond type: `E`, `nu`, `radius`, `strength` of bpm/beam, `kr ks kt kb strength` of bpm/rotational, `k` of springs.
    Bond(
        #[word(name = "T", what = "a bond type", from = 1)] At<i64>,
        #[word(name = "COEFF", what = "a coefficient of the bond style")] Word,
    ),
}

impl Varied {
    /// The bond type and the coefficient.
    pub fn parts(self) -> (At<i64>, Word) {
        let Self::Bond(kind, name) = self;
        (kind, name)
    }
}

/// What solves for a fit.
#[derive(Words)]
#[word(what = "method of a fit", of = Solver)]
enum Solving {
    Dsm,
    Ste,
    Periodic,
}

fn strain(a: &mut Args, _: &BuildCx) -> Result<f64> {
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

fn tolerance(a: &mut Args, _: &BuildCx) -> Result<f64> {
    let at = a.here();
    let tolerance = a.positive("the tolerance")?;
    below_one(tolerance, at, "the tolerance is a part of the stiffness: it must be below 1")
}

fn until(a: &mut Args, _: &BuildCx) -> Result<f64> {
    let at = a.here();
    let until = a.non_negative("the part of the largest force")?;
    below_one(until, at, "the part of the largest force is to be below 1")
}

fn together(a: &mut Args, _: &BuildCx) -> Result<f64> {
    let at = a.here();
    let together = a.non_negative("the part of the load")?;
    below_one(together, at, "the part of the load is to be below 1")
}

/// A part of something, refused by this text where it is all of it or more.
fn below_one(part: f64, at: Span, text: &str) -> Result<f64> {
    if part < 1.0 { Ok(part) } else { fail(Code::BAD_VALUE, at, text) }
}
