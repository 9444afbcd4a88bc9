//! One contact of two spheres: Hertz' force, Mindlin's tangential stiffness, and slip.
//!
//! K. Jarolin, M. Dosta, Comput. Part. Mech. 8 (2021), section 2.2, assumes small displacements, fixed
//! directions and no slip; a contact `after` a past follows the directions and slips.

use super::network::halves;
use super::six::Six;
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale, sub};

/// A contact of two spheres.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Unit vector from the lower end to the upper one.
    pub n: Vec3,
    /// R_i + R_j − l in the initial state, negative for a gap [length].
    pub overlap: f64,
    /// F/δ^3/2 = 4/3 E* √R* [force/length^3/2].
    pub normal: f64,
    /// k_t/√δ = 8 G* √R* [force/length^3/2].
    pub tangential: f64,
    /// Radii of the lower and the upper end [length].
    pub arms: [f64; 2],
    /// Whether its initial force is subtracted.
    pub relaxed: bool,
}

/// State of a contact in a field.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct State {
    /// Unit vector from the lower end to the upper one.
    pub(crate) n: Vec3,
    /// R_i + R_j − l [length].
    pub(crate) overlap: f64,
    /// Normal force, positive for repulsion [force].
    pub(crate) push: f64,
    /// dF/dδ and k_t [force/length].
    pub(crate) k: [f64; 2],
    /// Tangential displacement of the surfaces, of the upper end relative to the lower one [length].
    pub(crate) sheared: Vec3,
    /// Fraction of the displacement that remains after slip, 1 for sticking.
    pub(crate) stuck: f64,
}

/// Resistance of a contact to small motions from a given field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spring {
    /// Unit vector from the lower end to the upper one.
    pub(crate) n: Vec3,
    /// Normal and tangential stiffness [force/length].
    pub k: [f64; 2],
    /// Slip direction, which has no resistance; zero for sticking.
    pub(crate) slips: Vec3,
    /// Distance of the contact point below the surfaces, such that a rigid rotation causes no shear [length].
    pub(crate) less: f64,
}

impl Contact {
    /// The same with exchanged ends.
    pub(crate) fn turned(self) -> Self {
        Self { n: self.n.map(|a| -a), arms: [self.arms[1], self.arms[0]], ..self }
    }

    /// F_n = κ δ^3/2.
    #[inline(always)]
    pub(crate) fn hertz(&self, overlap: f64) -> f64 {
        self.normal * overlap * overlap.sqrt()
    }

    /// State at δ: F_n minus its value at δ₀, k_n = 3/2 κ √δ, k_t = κ_t √δ.
    #[inline(always)]
    pub(crate) fn pressed(&self, n: Vec3, overlap: f64) -> State {
        let held = overlap.max(0.0);
        let root = held.sqrt();
        let relief = if self.relaxed { self.hertz(self.overlap.max(0.0)) } else { 0.0 };
        State {
            n,
            overlap,
            push: self.hertz(held) - relief,
            k: [1.5 * self.normal * root, self.tangential * root],
            sheared: [0.0; 3],
            stuck: 1.0,
        }
    }

    /// At δ = δ₀ − n·(u_j − u_i), with the full displacement of the surfaces.
    #[inline(always)]
    pub(crate) fn near(&self, [a, b]: [&Six; 2]) -> State {
        let along = dot(self.n, sub(halves(b).0, halves(a).0));
        let state = self.pressed(self.n, self.overlap - along);
        State { sheared: self.slid(self.n, a, b, 0.0), ..state }
    }

    /// k_n and k_t after a further separation of the ends; with friction, secant stiffnesses over the whole
    /// path: along n the previous force counts as well, across it at most μ F_n.
    pub(crate) fn strained(&self, apart: Vec3, friction: Option<f64>) -> [f64; 2] {
        let along = dot(self.n, apart);
        let State { k, overlap, .. } = self.pressed(self.n, self.overlap - along);
        let Some(mu) = friction.filter(|_| k[0] > 0.0) else { return k };
        let bears = self.hertz(overlap);
        let chord = (bears - self.hertz(self.overlap.max(0.0))) / -along;
        let slid = length(sub(apart, scale(along, self.n)));
        [if along == 0.0 { k[0] } else { chord }, k[1].min(mu * bears / slid)]
    }

    /// At the current distance of the ends: the previous displacement, rotated into the contact plane, plus
    /// the sliding since then while they touched, reduced to μ F_n by slip.
    #[inline(always)]
    pub(crate) fn after(&self, now: [&Six; 2], then: [&Six; 2], sheared: Vec3, friction: f64) -> State {
        let between = |at: [&Six; 2]| {
            let rest = self.arms[0] + self.arms[1] - self.overlap;
            add(scale(rest, self.n), sub(halves(at[1]).0, halves(at[0]).0))
        };
        let (r, before) = (between(now), between(then));
        let (l, l_before) = (length(r), length(before));
        let reach = self.arms[0] + self.arms[1];
        let (overlap, overlap_before) = (reach - l, reach - l_before);
        let state = self.pressed(scale(1.0 / l, r), overlap);
        if overlap <= 0.0 || state.k[1] == 0.0 {
            return state;
        }
        let by: [Six; 2] = [0, 1].map(|e| std::array::from_fn(|c| now[e][c] - then[e][c]));
        let slid = self.slid(state.n, &by[0], &by[1], 0.0);
        // If contact began on the way, only the remaining part of the path counts.
        let part = if overlap_before > 0.0 { 1.0 } else { overlap / (overlap - overlap_before) };
        let laid = sub(sheared, scale(dot(state.n, sheared), state.n));
        let short = length(laid);
        let laid = if short > 0.0 { scale(length(sheared) / short, laid) } else { laid };
        let sheared = add(laid, scale(part, slid));
        let wanted = state.k[1] * length(sheared);
        let bears = if friction.is_finite() { friction * state.push.max(0.0) } else { wanted };
        let stuck = if wanted > bears { bears / wanted } else { 1.0 };
        State { sheared: scale(stuck, sheared), stuck, ..state }
    }

    /// ξ = P (u_j − u_i) + n × (R_i θ_i + R_j θ_j), with radii reduced by `less`.
    #[inline(always)]
    pub(crate) fn slid(&self, n: Vec3, a: &Six, b: &Six, less: f64) -> Vec3 {
        let ((ua, ta), (ub, tb)) = (halves(a), halves(b));
        let apart = sub(ub, ua);
        let across = sub(apart, scale(dot(n, apart), n));
        add(across, cross(n, add(scale(self.arms[0] - less, ta), scale(self.arms[1] - less, tb))))
    }

    /// Resisting forces and torques of both ends, for a normal and a tangential force on the upper end that
    /// act `less` below the surfaces.
    #[inline(always)]
    pub(crate) fn rows(&self, n: Vec3, along: f64, across: Vec3, less: f64) -> [Six; 2] {
        let f = add(scale(along, n), across);
        let turn = cross(across, n);
        let (a, b) = (scale(self.arms[0] - less, turn), scale(self.arms[1] - less, turn));
        [[-f[0], -f[1], -f[2], a[0], a[1], a[2]], [f[0], f[1], f[2], b[0], b[1], b[2]]]
    }
}
