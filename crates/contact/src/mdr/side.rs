//! One grain pressed by a rigid plane: elastic, then plastic, then unloading with or without adhesion.

use super::{Manner, Material, adhesion};
use perigrain_base::math::elementary::polynomial;
use perigrain_base::math::real::Real;
use std::f64::consts::PI;

/// History size of a side.
pub const WIDTH: usize = 11;

/// Index of `depth`.
pub const DEPTH: usize = 0;

/// Index of `area`.
pub const AREA: usize = 8;

/// Index of `deepest`.
pub const DEEPEST: usize = 4;

/// Index of `plastic`.
pub const PLASTIC: usize = 10;

/// The history of one side of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Side<R = f64> {
    /// Depth δ of the plane below the surface of radius R [length].
    pub depth: R,
    /// Depth below the original surface.
    pub first_depth: R,
    /// The part of δ that shears the contact.
    pub shearing: R,
    /// The part of δ that squeezes the whole grain.
    pub squeezing: R,
    /// Largest `shearing` so far.
    pub deepest: R,
    /// 1 once it has yielded, 0 before.
    pub yielded: R,
    /// c_A = π(δ_Y² − δ_Y R), the difference between the plastic area and that of a cap.
    pub offset: R,
    /// Radius within which the surfaces stick.
    pub stuck: R,
    /// Area of contact.
    pub area: R,
    /// Contribution to the grain's mean volumetric strain.
    pub strain: R,
    /// Residual depth without load.
    pub plastic: R,
}

/// Reaction on the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pressed<R = f64> {
    /// Force of the contact itself, without the bulk's part.
    pub force: R,
    /// Contact radius for damping.
    pub radius: R,
    /// 1 during plastic flow, else 0.
    pub flows: R,
}

/// The ellipse of the method of dimensionality reduction: a plane pressed into springs of this profile has
/// the force of the contact. Height A/2, width B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipse<R = f64> {
    /// A [length].
    pub a: R,
    /// B [length].
    pub b: R,
}

impl<R: Real> Ellipse<R> {
    /// d/A, from 0 to 1.
    #[inline(always)]
    fn part(&self, d: R) -> R {
        let x = d / self.a;
        x.like(1.0).least(x.like(0.0).most(x))
    }

    /// Force on a plane at depth `d`: E_c A B/4 (acos(1 − 2x) − (1 − 2x) √(4x − 4x²)), x = d/A.
    #[inline(always)]
    pub fn force(&self, plane: f64, d: R) -> R {
        self.a * (0.25 * plane) * self.b * segment(self.part(d))
    }

    /// Energy of the springs on a plane at depth `d`, ∫ F dd: E_c A² B/8 (sin θ − θ cos θ − sin³ θ/3), θ = acos(1 − 2x).
    #[inline(always)]
    pub fn energy(&self, plane: f64, d: R) -> R {
        self.a * (0.25 * plane) * self.a * self.b * bowl(self.part(d))
    }

    /// Force at depth A/2, where all springs are compressed: π/8 E_c A B.
    #[inline(always)]
    fn whole_force(&self, plane: f64) -> R {
        self.a * (0.125 * PI * plane) * self.b
    }

    /// Contact radius at depth `d`.
    #[inline(always)]
    pub fn radius(&self, d: R) -> R {
        let x = self.part(d);
        self.b * 0.5 * x.like(0.0).most(x * 4.0 - x * 4.0 * x).sqrt()
    }

    /// Depth at contact radius `r`.
    #[inline(always)]
    pub fn depth(&self, r: R) -> R {
        let (a, b) = (self.a, self.b);
        a * 0.5 - a / b * r.like(0.0).most(b * 0.25 * b - r * r).sqrt()
    }
}

/// acos(1 − 2x) − (1 − 2x) √(4x − 4x²) = ∫ 8 √(x − x²), without cancellation at small x.
#[inline(always)]
fn segment<R: Real>(x: R) -> R {
    let (half, less) = (x.above(x.like(0.5)), x.least(x.like(1.0) - x));
    let near = polynomial(less, &SEGMENT) * less * less.sqrt();
    // segment(x) + segment(1 − x) = π.
    R::choose(half, x.like(PI) - near, near)
}

/// ∫ [`segment`] from 0, without cancellation at small x.
#[inline(always)]
fn bowl<R: Real>(x: R) -> R {
    let (half, less) = (x.above(x.like(0.5)), x.least(x.like(1.0) - x));
    let near = polynomial(less, &BOWL) * less * less * less.sqrt();
    // bowl(x) − bowl(1 − x) = π (x − 1/2).
    R::choose(half, (x - 0.5) * PI + near, near)
}

/// [`segment`] over x^(3/2) for x up to one half: interpolates Σ 8 (−1)^k binom(1/2, k)/(k + 3/2) x^k within
/// 8e-17.
const SEGMENT: [f64; 18] = [
    5.333333333333333,
    -1.6000000000000307,
    -0.2857142857076886,
    -0.1111111116704721,
    -0.05681815688432099,
    -0.03365452008845939,
    -0.021862988313889827,
    -0.015314354863134807,
    -0.009694913653913936,
    -0.017065513677532167,
    0.036566590351932,
    -0.1637928077233139,
    0.4336575603430235,
    -0.8954429106702919,
    1.3033538925850352,
    -1.3088019480772977,
    0.8036034155478353,
    -0.23747588555199495,
];

/// The same for [`bowl`] over x^(5/2), where each term is divided by k + 5/2.
const BOWL: [f64; 16] = [
    2.1333333333333333,
    -0.4571428571429041,
    -0.06349206348411514,
    -0.020202020732052517,
    -0.008741240252004482,
    -0.004487567786921956,
    -0.002568203821263391,
    -0.001646520838079092,
    -0.0007153464577438112,
    -0.0023318599436322716,
    0.005091070956434357,
    -0.014451594580818088,
    0.024603976920906122,
    -0.02985790004501196,
    0.021401708996664666,
    -0.007615001423107151,
];

impl Side {
    /// Reads it from a contact history.
    pub fn read(m: &[f64]) -> Self {
        let mut numbers = [0.0; WIDTH];
        numbers.iter_mut().zip(m).for_each(|(a, b)| *a = *b);
        Self::of(numbers)
    }

    /// Writes it to a contact history.
    pub fn write(&self, m: &mut [f64]) {
        m.iter_mut().zip(self.numbers()).for_each(|(a, b)| *a = b);
    }
}

impl<R: Real> Side<R> {
    /// From its numbers.
    #[inline(always)]
    pub fn of(numbers: [R; WIDTH]) -> Self {
        let [depth, first_depth, shearing, squeezing, deepest, yielded, offset, stuck, area, strain, plastic] =
            numbers;
        Self {
            depth,
            first_depth,
            shearing,
            squeezing,
            deepest,
            yielded,
            offset,
            stuck,
            area,
            strain,
            plastic,
        }
    }

    /// Its numbers.
    #[inline(always)]
    pub fn numbers(&self) -> [R; WIDTH] {
        let Self {
            depth,
            first_depth,
            shearing,
            squeezing,
            deepest,
            yielded,
            offset,
            stuck,
            area,
            strain,
            plastic,
        } = *self;
        [depth, first_depth, shearing, squeezing, deepest, yielded, offset, stuck, area, strain, plastic]
    }

    /// Moves the plane to depth `depth` below the surface of radius `radius`, and keeps the squeezed part.
    /// `mean`: the area-weighted mean approach of the grain's planes in this step if the bulk responds, else
    /// 0.
    #[inline(always)]
    pub fn go(&mut self, depth: R, radius: R, first: R, mean: R) {
        self.squeezing = depth.like(0.0).most(self.squeezing + mean);
        self.shearing = depth - self.squeezing;
        self.depth = depth;
        self.first_depth = depth - (radius - first);
    }

    /// The contact's force on the plane, for a grain of radius `radius`.
    #[inline(always)]
    pub fn press(&mut self, m: &Material, radius: R, manner: Manner) -> Pressed<R> {
        let (plane, zero, one) = (m.plane(), radius.like(0.0), radius.like(1.0));
        self.deepest = self.deepest.most(self.shearing);
        let deepest = self.deepest;
        let hardness = m.hardness(deepest, radius);
        let unloads = deepest.above(self.shearing);
        let flows = R::choose(unloads, zero, one);
        if !(manner.lammps && manner.setup) {
            // Mean pressure of a Hertz contact.
            let mean = deepest.sqrt() * (4.0 * plane) / (radius.sqrt() * (3.0 * PI));
            let yields = R::both(R::both(flows.above(zero), mean.above(hardness)), one.above(self.yielded));
            self.offset = R::choose(yields, (deepest * deepest - deepest * radius) * PI, self.offset);
            self.yielded = R::choose(yields, one, self.yielded);
        }
        let (shape, lift) = self.shape(m, radius, hardness);
        let most = self.most(&shape);
        self.area = self.contact_area(radius);
        self.plastic = deepest - (most + lift);
        let pressed = most.above(zero);
        if !R::any(pressed) {
            return Pressed { force: zero, radius: zero, flows };
        }
        let mut stuck = self.stuck;
        let elastic = self.elastic(most, lift);
        let (force, contact) = adhesion::force(m, &shape, elastic, &mut stuck, unloads, manner.lammps);
        self.stuck = R::choose(pressed, stuck, self.stuck);
        Pressed { force: R::choose(pressed, force, zero), radius: R::choose(pressed, contact, zero), flows }
    }

    /// Energy returned to the plane during unloading: the energy of the springs, distributed over the height
    /// by which the rim rises [energy].
    #[inline(always)]
    pub fn energy(&self, m: &Material, radius: R) -> R {
        let zero = radius.like(0.0);
        let (shape, lift) = self.shape(m, radius, m.hardness(self.deepest, radius));
        let most = self.most(&shape);
        let springs = adhesion::energy(m, &shape, self.elastic(most, lift), self.stuck);
        R::choose(most.above(zero), (lift / most + 1.0) * springs, zero)
    }

    /// Whether it has yielded.
    #[inline(always)]
    pub fn has_yielded(&self) -> R::Mask {
        self.yielded.above(self.yielded.like(0.0))
    }

    /// The elastic depth at the largest depth so far.
    #[inline(always)]
    fn most(&self, shape: &Ellipse<R>) -> R {
        R::choose(self.has_yielded(), shape.a * 0.5, self.deepest)
    }

    /// The current elastic depth.
    #[inline(always)]
    fn elastic(&self, most: R, lift: R) -> R {
        (self.shearing - self.deepest + most + lift) / (lift / most + 1.0)
    }

    /// The ellipse, and δ_R, the lowering of the contact's rim under load.
    #[inline(always)]
    fn shape(&self, m: &Material, radius: R, hardness: R) -> (Ellipse<R>, R) {
        let zero = radius.like(0.0);
        let whole = Ellipse { a: radius * 4.0, b: radius * 2.0 };
        let yielded = self.has_yielded();
        if !R::any(yielded) {
            return (whole, zero);
        }
        let (deepest, plane, nu) = (self.deepest, m.plane(), m.poisson);
        let square = deepest * 2.0 * radius - deepest * deepest + self.offset / PI;
        let most = zero.most(square).sqrt();
        let shape = Ellipse { a: hardness * 4.0 * most / plane, b: most * 2.0 };
        // Boussinesq's displacement at depth z_R under a pressure spread over the contact.
        let half = shape.a * 0.5;
        let force = shape.whole_force(plane);
        let z = radius - (deepest - half);
        let far = (square + z * z).sqrt();
        let lift = force * (square * 2.0 * (nu - 1.0) - z * (2.0 * nu - 1.0) * (far - z))
            / (square * (2.0 * PI) * m.shear() * far);
        let lift = R::choose(R::both(yielded, most.above(zero)), lift, zero);
        let a = R::choose(yielded, shape.a, whole.a);
        (Ellipse { a, b: R::choose(yielded, shape.b, whole.b) }, lift)
    }

    #[inline(always)]
    fn contact_area(&self, radius: R) -> R {
        let (d, zero) = (self.depth, radius.like(0.0));
        let flowed = (d * 2.0 * radius - d * d) * PI + self.offset;
        let area = R::choose(self.has_yielded(), flowed, radius * PI * d);
        R::choose(d.above(zero), zero.most(area), zero)
    }
}
