//! Tangential friction: the models named in decks, and their constants for a pair of types.

use super::damping::Damping;
use super::normal::{Force, effective_shear, effective_young, geometric};
use super::slider::{Look, Memory, Slider, Slip, Sync};
use super::turning::Grip;
use super::{Advance, Normal};
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, length, scale};
use perigrain_world::Compat;

/// The kinds of friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Friction {
    /// `none`: smooth spheres.
    None,
    /// `linear_nohistory`: F_t = −η_t v_t.
    LinearNohistory,
    /// `linear_history`: F_t = −k_t ξ − η_t v_t.
    LinearHistory,
    /// `linear_history_classic`: the same, ξ projected into the tangent plane as in
    /// `pair_style gran/hooke/history`.
    LinearHistoryClassic,
    /// `mindlin`: F_t = −k_t a ξ − η_t v_t.
    Mindlin,
    /// `mindlin_classic`: the same, ξ projected as in `pair_style gran/hertz/history`.
    MindlinClassic,
    /// `mindlin/force`: the history is the force, dF_t = −k_t a v_t dt.
    MindlinForce,
    /// `mindlin_rescale`: like `mindlin`; ξ shrinks with the contact radius (Thornton et al. 2013, eq. 18b).
    MindlinRescale,
    /// `mindlin_rescale/force`: like `mindlin/force`; the force shrinks with the contact radius.
    MindlinRescaleForce,
}

impl Friction {
    /// All of them.
    pub const ALL: [Friction; 9] = [
        Friction::None,
        Friction::LinearNohistory,
        Friction::LinearHistory,
        Friction::LinearHistoryClassic,
        Friction::Mindlin,
        Friction::MindlinClassic,
        Friction::MindlinForce,
        Friction::MindlinRescale,
        Friction::MindlinRescaleForce,
    ];

    /// The word in decks.
    pub const fn name(self) -> &'static str {
        match self {
            Friction::None => "none",
            Friction::LinearNohistory => "linear_nohistory",
            Friction::LinearHistory => "linear_history",
            Friction::LinearHistoryClassic => "linear_history_classic",
            Friction::Mindlin => "mindlin",
            Friction::MindlinClassic => "mindlin_classic",
            Friction::MindlinForce => "mindlin/force",
            Friction::MindlinRescale => "mindlin_rescale",
            Friction::MindlinRescaleForce => "mindlin_rescale/force",
        }
    }

    /// What its spring is, for the help page.
    pub const fn formula(self) -> &'static str {
        match self {
            Friction::None => "Smooth spheres.",
            Friction::LinearNohistory => "No spring.",
            Friction::LinearHistory => "k_t = kt.",
            Friction::LinearHistoryClassic => {
                "k_t = kt; drops the part of ξ along the normal, as pair_style gran/hooke/history."
            }
            Friction::Mindlin => "k_t = kt a, and with `NULL` 8 G* a, 1/G* = (2−ν_i)/G_i + (2−ν_j)/G_j.",
            Friction::MindlinClassic => {
                "k_t = kt a; drops the part of ξ along the normal, as pair_style gran/hertz/history."
            }
            Friction::MindlinForce => "The same k_t; remembers the force, dF = −k_t v_t dt.",
            Friction::MindlinRescale => {
                "The same k_t; ξ shrinks with a when the contact unloads, so that unloading makes no energy (Thornton et al. \
                 2013)."
            }
            Friction::MindlinRescaleForce => {
                "The same k_t; remembers the force, which shrinks with a when the contact unloads."
            }
        }
    }

    /// Whether k_t is multiplied by the contact radius.
    #[inline(always)]
    pub const fn by_radius(self) -> bool {
        !matches!(
            self,
            Friction::None
                | Friction::LinearNohistory
                | Friction::LinearHistory
                | Friction::LinearHistoryClassic
        )
    }

    /// Whether k_t may be derived from the material (`NULL`).
    pub const fn takes_material(self) -> bool {
        self.by_radius() && !matches!(self, Friction::MindlinClassic)
    }

    #[inline(always)]
    fn rescales(self) -> bool {
        matches!(self, Friction::MindlinRescale | Friction::MindlinRescaleForce)
    }

    /// Whether its spring can slide without the dashpot ([`Slip::Spring`]); without a spring the word concerns
    /// arms and the limit only.
    pub fn slips_by_spring(self) -> bool {
        !matches!(self, Friction::None | Friction::MindlinForce) && !self.rescales()
    }

    /// Whether the stiffness grows with the contact radius.
    fn stiffens(self) -> bool {
        self.by_radius() && self.memory() != Memory::Force
    }

    fn memory(self) -> Memory {
        match self {
            Friction::LinearHistoryClassic | Friction::MindlinClassic => Memory::Projected,
            Friction::MindlinForce | Friction::MindlinRescaleForce => Memory::Force,
            _ => Memory::Displacement,
        }
    }
}

/// Tangential damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drag {
    /// η_t = x_gamma η_n.
    Times(f64),
    /// η_t from a constant of its own, in the form of the normal damping (`pair_style gran/*`).
    Own(f64),
    /// `NULL`: η_t = √(k_t/S_n) η_n with S_n = dF_n/dδ, so that both directions are damped alike (LIGGGHTS
    /// manual, gran_model_hertz and gran_model_hooke).
    Matched,
}

/// A tangential model with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangential {
    /// Its kind.
    pub kind: Friction,
    /// k_t [pressure, or force/length for linear models]; `None` (NULL): 8 G* from the normal model's material.
    pub stiffness: Option<f64>,
    /// Whether `stiffness` is the ratio of k_t to the normal stiffness F_n/δ.
    pub of_normal: bool,
    /// Tangential damping.
    pub drag: Drag,
    /// Coefficient of friction.
    pub mu: f64,
    /// What slides.
    pub slip: Slip,
}

impl Tangential {
    /// Smooth spheres.
    pub const SMOOTH: Tangential = Tangential {
        kind: Friction::None,
        stiffness: Some(0.0),
        of_normal: false,
        drag: Drag::Times(0.0),
        mu: 0.0,
        slip: Slip::Whole,
    };

    /// The usual coefficients of this kind of friction.
    pub fn new(kind: Friction, stiffness: Option<f64>, x_gamma: f64, mu: f64) -> Self {
        Self { kind, stiffness, drag: Drag::Times(x_gamma), mu, ..Self::SMOOTH }
    }

    /// The word in decks.
    pub fn name(&self) -> &'static str {
        self.kind.name()
    }

    /// The spring between grains of two types; `eta` is the constant of the normal damping. Coefficients are
    /// mixed geometrically, G* by Mindlin's theory. For a mixed pair, LAMMPS 22Jul2025 uses E* of the pair
    /// for both moduli and √(ν_i ν_j) for both Poisson ratios, against its own manual; `mixed` and `compat`
    /// together reproduce this.
    pub fn spring(
        &self,
        other: &Tangential,
        normals: [&Normal; 2],
        (form, eta): (Damping, f64),
        force: &Force,
        mixed: bool,
        compat: Compat,
    ) -> Spring {
        let stiffness = match (self.stiffness, other.stiffness) {
            (Some(k1), Some(k2)) => geometric(k1, k2),
            _ => 8.0 * shear(normals, mixed && compat.lammps()),
        };
        let damping = match (self.drag, other.drag) {
            (Drag::Times(x), Drag::Times(y)) => geometric(x, y) * eta,
            (Drag::Own(a), Drag::Own(b)) => geometric(a, b),
            (Drag::Own(a), _) | (_, Drag::Own(a)) => a,
            (Drag::Matched, _) | (_, Drag::Matched) => self.matched(stiffness, normals, force) * eta,
        };
        // Both errors are fixed in 2026.
        let classic = matches!(self.kind, Friction::LinearHistoryClassic | Friction::MindlinClassic);
        let loose = classic && compat == Compat::Lammps2025 && matches!(self.drag, Drag::Times(_));
        Spring {
            kind: self.kind,
            stiffness,
            of_normal: self.of_normal,
            damping,
            mu: geometric(self.mu, other.mu),
            slip: self.slip,
            loose,
            capped: !compat.lammps() && damping > 0.0 && self.kind.stiffens() && !form.by_radius(),
            look: Look::First,
            sync: Sync::Off,
        }
    }

    /// √(k_t/S_n) for k_t from `stiffness`. Friction without a spring takes the k_t of the material, or k_n for
    /// linear forces.
    fn matched(&self, stiffness: f64, normals: [&Normal; 2], force: &Force) -> f64 {
        if self.of_normal {
            return stiffness.sqrt();
        }
        let Some([k, n]) = force.power_law(1.0, 1.0) else { return 0.0 };
        match self.kind {
            Friction::LinearNohistory if n == 1.0 => 1.0,
            Friction::LinearNohistory => (8.0 * shear(normals, false) / (n * k)).sqrt(),
            _ => (stiffness / (n * k)).sqrt(),
        }
    }
}

/// G* of two materials; zero for normal models without a material (decks that need it are refused).
fn shear(normals: [&Normal; 2], artefact: bool) -> f64 {
    let [Some((e1, nu1)), Some((e2, nu2))] = normals.map(Normal::material) else { return 0.0 };
    if artefact {
        let (e, nu) = (effective_young([e1, e2], [nu1, nu2]), geometric(nu1, nu2));
        return effective_shear([e, e], [nu, nu]);
    }
    effective_shear([e1, e2], [nu1, nu2])
}

/// A friction slider for contacts of one pair of types.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Its kind.
    pub kind: Friction,
    /// k_t [pressure, or force/length for linear models].
    pub stiffness: f64,
    /// Whether `stiffness` is the ratio of k_t to the normal stiffness F_n/δ.
    pub of_normal: bool,
    /// Constant of the tangential damping, in the form of the normal damping.
    pub damping: f64,
    /// Coefficient of friction.
    pub mu: f64,
    /// What slides.
    pub slip: Slip,
    /// `…_classic` springs of granular models and walls in LAMMPS 22Jul2025: the contact radius also stiffens
    /// `linear_history_classic`, and it is omitted when a sliding spring is shortened.
    pub loose: bool,
    /// Whether the drag subtracted from a sliding spring is limited along the sliding direction. Luding's
    /// rule leaves −k ξ = F + η v. In young contacts η v exceeds the friction limit, and a spring with k ∝ a,
    /// which stiffens faster than η grows, then drives the sliding that it should resist, more strongly the
    /// shorter the first steps are. LAMMPS 22Jul2025 behaves that way.
    pub capped: bool,
    /// Whether a contact is evaluated again.
    pub look: Look,
    /// Which normal it rotates with.
    pub sync: Sync,
}

impl Spring {
    /// Whether its stiffness grows with the contact radius.
    #[inline(always)]
    pub fn by_radius(&self) -> bool {
        self.kind.by_radius() || self.loose
    }

    /// The k_t from which `rolling epsd2` takes its stiffness: that of this spring, without one that of the material
    /// or of the normal force (measured with LIGGGHTS 3.8.0).
    pub fn grip(&self, normals: [&Normal; 2]) -> Grip {
        match self.kind {
            Friction::None | Friction::LinearNohistory if normals[0].exponent() == 1.0 => Grip::OfNormal(1.0),
            Friction::None | Friction::LinearNohistory => Grip::ByRadius(8.0 * shear(normals, false)),
            _ if self.of_normal => Grip::OfNormal(self.stiffness),
            _ if self.by_radius() => Grip::ByRadius(self.stiffness),
            _ => Grip::Is(self.stiffness),
        }
    }

    /// Size of its history: a displacement or force and, for rescaling, the contact radius.
    #[inline(always)]
    pub fn memory(&self) -> usize {
        match self.kind {
            Friction::None | Friction::LinearNohistory => 0,
            kind if kind.rescales() => 4,
            _ => 3,
        }
    }

    /// The spring that reproduces the force of the last evaluation from the history it left behind.
    #[must_use]
    pub fn again(&self, setup: bool) -> Self {
        // All others give the same force twice.
        let look = if self.loose { Look::Again { setup } } else { Look::First };
        Self { look, ..*self }
    }

    /// k_t at contact radius `a` and normal stiffness `secant` = F_n/δ [force/length]; 0 for friction without a
    /// spring.
    pub fn present(&self, a: f64, secant: f64) -> f64 {
        match self.kind {
            Friction::None | Friction::LinearNohistory => 0.0,
            _ => self.current(a, secant),
        }
    }

    #[inline(always)]
    fn current<R: Real>(&self, a: R, secant: R) -> R {
        if self.of_normal {
            return secant * self.stiffness;
        }
        if self.by_radius() { a * self.stiffness } else { a.like(self.stiffness) }
    }

    /// The energy of a spring of this stiffness with this `history`: ½ k_t ξ², or F²/(2 k_t) if the history is the
    /// force.
    pub fn energy(&self, stiffness: f64, history: &[f64]) -> f64 {
        let [x, y, z, ..] = *history else { return 0.0 };
        let square = x * x + y * y + z * z;
        match self.kind.memory() {
            Memory::Force if stiffness > 0.0 => 0.5 * square / stiffness,
            Memory::Force => 0.0,
            _ => 0.5 * stiffness * square,
        }
    }

    /// The tangential force on i, at most `mu` times `carried`, the normal load for friction; `a`: contact
    /// radius, `form`: normal damping divided by its constant, `secant`: F_n/δ, `v`: slip velocity, `n` as in
    /// [`Slider`].
    #[inline(always)]
    pub fn force<R: Real>(
        &self,
        n: [Vec3<R>; 2],
        [a, form, secant]: [R; 3],
        v: Vec3<R>,
        carried: R,
        history: &mut [R],
        step: Advance,
    ) -> Vec3<R> {
        let limit = carried * self.mu;
        let damping = form * self.damping;
        let stiffness = self.current(a, secant);
        match self.kind {
            Friction::None => [a.like(0.0); 3],
            Friction::LinearNohistory => {
                let speed = length(v);
                let size = limit.least(damping * speed);
                let factor = R::choose(speed.above(a.like(0.0)), size / speed, a.like(0.0));
                scale(-factor, v)
            }
            kind => {
                let mut xi = [history[0], history[1], history[2]];
                if kind.rescales() {
                    let shrinks = history[3].above(a);
                    xi = scale(R::choose(shrinks, a / history[3], a.like(1.0)), xi);
                    // Where LAMMPS stores results of a setup, it discards that the spring has shrunk, so that
                    // it shrinks again.
                    if step.history {
                        history[3] = a;
                    }
                }
                let slack = if self.loose { a.like(self.stiffness) } else { stiffness };
                let slider =
                    Slider { n, sync: self.sync, stiffness, slack, damping, capped: self.capped, limit, v };
                if let Look::Again { setup } = self.look {
                    return slider.again(xi, setup);
                }
                let force = match self.slip {
                    Slip::Whole => slider.force(&mut xi, kind.memory(), step),
                    Slip::Spring => slider.force_of_spring(&mut xi, step),
                };
                history[..3].copy_from_slice(&xi);
                force
            }
        }
    }
}
