//! How `minimize` goes about it: what `min_style` and `min_modify` have chosen.

/// The algorithm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MinStyle {
    /// Conjugate gradients with line searches (Polak and Ribière).
    #[default]
    Cg,
    /// Steepest descent with line searches.
    Sd,
    /// Damped motion that steers towards the force (fast inertial relaxation engine).
    Fire,
    /// Damped motion along the forces alone.
    Quickmin,
}

impl MinStyle {
    /// Every style with its name in a deck.
    pub const ALL: [(&'static str, MinStyle); 4] = [
        ("cg", MinStyle::Cg),
        ("sd", MinStyle::Sd),
        ("fire", MinStyle::Fire),
        ("quickmin", MinStyle::Quickmin),
    ];

    /// The name in a deck.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, s)| *s == self).map_or("cg", |(n, _)| n)
    }
}

/// How far to go along a direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LineSearch {
    /// Halve the step until the energy has fallen enough.
    Backtrack,
    /// As `Backtrack`, and the zero of the force along the line where the energy is nearly quadratic.
    #[default]
    Quadratic,
}

/// The length of all forces together that is held against `ftol`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ForceNorm {
    /// The root of the sum of all squares.
    #[default]
    Two,
    /// The longest force on a particle.
    Max,
    /// The largest component.
    Inf,
}

/// How FIRE moves the particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FireIntegrator {
    /// Kick, then drift.
    #[default]
    EulerImplicit,
    /// Half kick, drift, half kick.
    Verlet,
    /// As `EulerImplicit`, with velocities half a step behind.
    Leapfrog,
    /// Drift, then kick.
    EulerExplicit,
}

/// What FIRE's damping knows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fire {
    /// How particles move.
    pub integrator: FireIntegrator,
    /// Longest time step, as a multiple of `timestep`.
    pub tmax: f64,
    /// Shortest time step, as a multiple of `timestep`.
    pub tmin: f64,
    /// Iterations of falling energy before the time step grows.
    pub delay: i64,
    /// Factor of growth of the time step.
    pub grow: f64,
    /// Factor of shrinking of the time step.
    pub shrink: f64,
    /// First mixing of velocity and force.
    pub alpha0: f64,
    /// Factor of the mixing when the time step grows.
    pub alpha_shrink: f64,
    /// Go back half a step where the motion turns uphill.
    pub half_step_back: bool,
    /// The first iterations do not shorten the time step.
    pub initial_delay: bool,
    /// Uphill iterations in a row after which to give up; 0: never.
    pub uphill_most: i64,
    /// Mixing corrected for its bias towards the velocities at a start, speeds limited by component.
    pub unbiased: bool,
}

impl Default for Fire {
    fn default() -> Self {
        Self {
            integrator: FireIntegrator::default(),
            tmax: 10.0,
            tmin: 0.02,
            delay: 20,
            grow: 1.1,
            shrink: 0.5,
            alpha0: 0.25,
            alpha_shrink: 0.99,
            half_step_back: true,
            initial_delay: true,
            uphill_most: 2000,
            unbiased: false,
        }
    }
}

/// The choices of `min_style` and `min_modify`; the numbers of a new scene are LAMMPS' own.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Minimizer {
    /// The algorithm.
    pub style: MinStyle,
    /// How far a coordinate may change in one line search or step [length], if a line sets it.
    pub dmax: Option<f64>,
    /// The line search of `cg` and `sd`.
    pub line: LineSearch,
    /// Which length of the forces counts.
    pub norm: ForceNorm,
    /// FIRE's own.
    pub fire: Fire,
}

/// LAMMPS' longest move, meant for units in which atoms are about 1 apart.
pub const FARTHEST: f64 = 0.1;

impl Minimizer {
    /// How far a coordinate may change where particles are of this size; where none has a size as in units of which it is 1.
    pub fn farthest(&self, size: Option<f64>) -> f64 {
        self.dmax.unwrap_or_else(|| FARTHEST * size.unwrap_or(1.0))
    }

    /// Whether `min_modify` has changed something.
    pub fn modified(&self) -> bool {
        *self != Self { style: self.style, ..Self::default() }
    }
}
