//! One grain pressed by a rigid plane: elastic, then plastic, then unloading with or without adhesion.

use super::{Manner, Material, adhesion};
use std::f64::consts::PI;

/// How many numbers a side remembers.
pub const WIDTH: usize = 11;

/// Where `deepest` stands among the numbers.
pub const DEEPEST: usize = 4;

/// Where `plastic` stands among the numbers.
pub const PLASTIC: usize = 10;

/// What one grain remembers of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Side {
    /// Depth δ of the plane below the surface of radius R [length].
    pub depth: f64,
    /// Depth below the surface the grain had at first.
    pub first_depth: f64,
    /// The part of δ that shears the contact.
    pub shearing: f64,
    /// The part of δ that squeezes the whole grain.
    pub squeezing: f64,
    /// Largest `shearing` so far.
    pub deepest: f64,
    /// Whether it has yielded.
    pub yielded: bool,
    /// c_A = π(δ_Y² − δ_Y R), by which the plastic area differs from that of a cap.
    pub offset: f64,
    /// Radius inside which the surfaces stick.
    pub stuck: f64,
    /// Area of contact.
    pub area: f64,
    /// Part in the grain's mean volumetric strain.
    pub strain: f64,
    /// Depth that would be left without load.
    pub plastic: f64,
}

/// What the plane feels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pressed {
    /// Force of the contact itself, without the bulk's.
    pub force: f64,
    /// Radius of contact for damping.
    pub radius: f64,
    /// Whether plastic flow goes on.
    pub flows: bool,
}

/// The ellipse of the method of dimensionality reduction: a plane pressed into springs of this profile has the force of
/// the contact. Height A/2, width B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipse {
    /// A [length].
    pub a: f64,
    /// B [length].
    pub b: f64,
}

impl Ellipse {
    /// Force on a plane at depth `d`: E_c A B/4 (acos(1 − 2x) − (1 − 2x) √(4x − 4x²)), x = d/A.
    pub fn force(&self, plane: f64, d: f64) -> f64 {
        let x = (d / self.a).clamp(0.0, 1.0);
        0.25 * plane * self.a * self.b * segment(x)
    }

    /// Energy of the springs on a plane at depth `d`, ∫ F dd: E_c A² B/8 (sin θ − θ cos θ − sin³ θ/3), θ = acos(1 − 2x).
    pub fn energy(&self, plane: f64, d: f64) -> f64 {
        let x = (d / self.a).clamp(0.0, 1.0);
        0.25 * plane * self.a * self.a * self.b * bowl(x)
    }

    /// Force at the depth A/2, where all springs are pressed: π/8 E_c A B.
    fn whole_force(&self, plane: f64) -> f64 {
        0.125 * PI * plane * self.a * self.b
    }

    /// Radius of contact at depth `d`.
    pub fn radius(&self, d: f64) -> f64 {
        let x = (d / self.a).clamp(0.0, 1.0);
        0.5 * self.b * (4.0 * x - 4.0 * x * x).max(0.0).sqrt()
    }

    /// Depth at which the radius of contact is `r`.
    pub fn depth(&self, r: f64) -> f64 {
        0.5 * self.a - self.a / self.b * (0.25 * self.b * self.b - r * r).max(0.0).sqrt()
    }
}

/// acos(1 − 2x) − (1 − 2x) √(4x − 4x²) = ∫ 8 √(x − x²), without cancellation at small x.
fn segment(x: f64) -> f64 {
    if x > SMALL {
        return 2.0 * x.sqrt().asin() - 2.0 * (1.0 - 2.0 * x) * (x * (1.0 - x)).sqrt();
    }
    SERIES.iter().rev().fold(0.0, |sum, c| c + x * sum) * x * x.sqrt()
}

/// ∫ [`segment`] from 0, without cancellation at small x.
fn bowl(x: f64) -> f64 {
    if x > SMALL {
        let (theta, sine) = (2.0 * x.sqrt().asin(), 2.0 * (x * (1.0 - x)).sqrt());
        return 0.5 * (sine - theta * (1.0 - 2.0 * x) - sine * sine * sine / 3.0);
    }
    let terms = SERIES.iter().zip(0..10u8).rev();
    terms.fold(0.0, |sum, (c, k)| c / (f64::from(k) + 2.5) + x * sum) * x * x * x.sqrt()
}

/// Up to here the series leaves less than 1e-17 of its sum.
pub(super) const SMALL: f64 = 0.0223;

/// The integral's series, x^(3/2) Σ 8 (−1)^k binom(1/2, k)/(k + 3/2) x^k.
const SERIES: [f64; 10] = {
    let (mut series, mut binomial, mut k) = ([0.0; 10], 1.0, 0);
    while k < 10 {
        series[k] = 8.0 * binomial / (k as f64 + 1.5);
        binomial *= (k as f64 - 0.5) / (k as f64 + 1.0);
        k += 1;
    }
    series
};

impl Side {
    /// From what a contact remembers.
    pub fn read(m: &[f64]) -> Self {
        let mut numbers = [0.0; WIDTH];
        numbers.iter_mut().zip(m).for_each(|(a, b)| *a = *b);
        let [depth, first_depth, shearing, squeezing, deepest, yielded, offset, stuck, area, strain, plastic] =
            numbers;
        Self {
            depth,
            first_depth,
            shearing,
            squeezing,
            deepest,
            yielded: yielded != 0.0,
            offset,
            stuck,
            area,
            strain,
            plastic,
        }
    }

    /// Into what a contact remembers.
    pub fn write(&self, m: &mut [f64]) {
        let yielded = f64::from(u8::from(self.yielded));
        let (s, t) = ([self.depth, self.first_depth, self.shearing, self.squeezing], [self.deepest, yielded]);
        let u = [self.offset, self.stuck, self.area, self.strain, self.plastic];
        m.iter_mut().zip(s.into_iter().chain(t).chain(u)).for_each(|(a, b)| *a = b);
    }

    /// Moves the plane to depth `depth` below the surface of radius `radius`, what was squeezed staying so; `mean`: by how much the grain's planes
    /// came nearer in this step, on average over their areas, where the bulk answers.
    pub fn go(&mut self, depth: f64, radius: f64, first: f64, mean: Option<f64>) {
        self.squeezing = mean.map_or(self.squeezing, |mean| (self.squeezing + mean).max(0.0));
        self.shearing = depth - self.squeezing;
        self.depth = depth;
        self.first_depth = depth - (radius - first);
    }

    /// The contact's force on the plane, for a grain of radius `radius`.
    pub fn press(&mut self, m: &Material, radius: f64, manner: Manner) -> Pressed {
        let plane = m.plane();
        self.deepest = self.deepest.max(self.shearing);
        let deepest = self.deepest;
        let hardness = m.hardness(deepest, radius);
        // Mean pressure of Hertz' contact.
        let flows = self.shearing >= deepest;
        let may = flows && !(manner.lammps && manner.setup);
        if !self.yielded && may && 4.0 * plane * deepest.sqrt() / (3.0 * PI * radius.sqrt()) > hardness {
            self.yielded = true;
            self.offset = PI * (deepest * deepest - deepest * radius);
        }
        let (shape, lift) = self.shape(m, radius, hardness);
        let most = self.most(&shape);
        self.area = self.contact_area(radius);
        self.plastic = deepest - (most + lift);
        if most <= 0.0 {
            return Pressed { flows, ..Pressed::default() };
        }
        let elastic = self.elastic(most, lift);
        let (force, contact) = adhesion::force(m, &shape, elastic, &mut self.stuck, flows, manner.lammps);
        Pressed { force, radius: contact, flows }
    }

    /// What the plane gets back if it goes as it does when it unloads: the energy of the springs, spread over the way by which the rim rises
    /// [energy].
    pub fn energy(&self, m: &Material, radius: f64) -> f64 {
        let (shape, lift) = self.shape(m, radius, m.hardness(self.deepest, radius));
        let most = self.most(&shape);
        if most <= 0.0 {
            return 0.0;
        }
        (1.0 + lift / most) * adhesion::energy(m, &shape, self.elastic(most, lift), self.stuck)
    }

    /// The elastic depth at the largest depth.
    fn most(&self, shape: &Ellipse) -> f64 {
        if self.yielded { 0.5 * shape.a } else { self.deepest }
    }

    /// The elastic depth now.
    fn elastic(&self, most: f64, lift: f64) -> f64 {
        (self.shearing - self.deepest + most + lift) / (1.0 + lift / most)
    }

    /// The ellipse, and δ_R, by which the rim of the contact lies lower while it is loaded.
    fn shape(&self, m: &Material, radius: f64, hardness: f64) -> (Ellipse, f64) {
        if !self.yielded {
            return (Ellipse { a: 4.0 * radius, b: 2.0 * radius }, 0.0);
        }
        let (deepest, plane, nu) = (self.deepest, m.plane(), m.poisson);
        let square = 2.0 * deepest * radius - deepest * deepest + self.offset / PI;
        let most = square.max(0.0).sqrt();
        let shape = Ellipse { a: 4.0 * hardness * most / plane, b: 2.0 * most };
        if most == 0.0 {
            return (shape, 0.0);
        }
        // Boussinesq's displacement at depth z_R under a pressure spread over the contact.
        let half = 0.5 * shape.a;
        let force = shape.whole_force(plane);
        let z = radius - (deepest - half);
        let far = (square + z * z).sqrt();
        let lift = force * (2.0 * square * (nu - 1.0) - (2.0 * nu - 1.0) * z * (far - z))
            / (2.0 * PI * square * m.shear() * far);
        (shape, lift)
    }

    fn contact_area(&self, radius: f64) -> f64 {
        let d = self.depth;
        if d <= 0.0 {
            return 0.0;
        }
        let area = if self.yielded { PI * (2.0 * d * radius - d * d) + self.offset } else { PI * radius * d };
        area.max(0.0)
    }
}
