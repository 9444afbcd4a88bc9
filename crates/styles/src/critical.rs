//! The longest stable steps of a scene as it is: of peridynamic solids and of grains in contact.

use crate::peri_view::view;
use crate::probe::Probe;
use crate::words::Words;
use perigrain_base::diag::Result;
use perigrain_base::math::body::principal;
use perigrain_base::math::vec3::{SIX, Vec3};
use perigrain_peri::families::{Families, ForceUnit};
use perigrain_world::contacts::WallSpring;
use perigrain_world::{Constant, Facts, Named, World};

/// How the step of peridynamic solids is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Words)]
#[word(what = "estimate of the solids' step")]
pub enum Estimate {
    /// h/√(K/ρ) with h = V^(1/3) (Hartmann et al. 2022, equations 41 and 42).
    #[default]
    Cfl,
    /// √(2 ρ/Σ c w V/|ξ|) over the bonds that live (Silling & Askari 2005).
    Silling,
    /// 2/ω of the scene as it is: ω² is the largest eigenvalue of M⁻¹K.
    Exact,
}

/// The longest step of the solids [time]; infinite without bonds.
///
/// # Errors
/// Without a box.
pub fn solids(w: &World, how: Estimate) -> Result<f64> {
    let Some(families) = &*w.families else { return Ok(f64::INFINITY) };
    let (p, ftm2v, view) = (&w.particles, w.settings.units.constants().ftm2v, view(w)?);
    if families.place.len() != p.len() {
        return Ok(f64::INFINITY);
    }
    let density = || match families.options.unit {
        ForceUnit::Density => p.mass.clone(),
        ForceUnit::Newton => p.mass.iter().zip(view.volume).map(|(m, v)| m / v).collect(),
    };
    let step = match how {
        Estimate::Cfl => families.sound_step(&view, &density(), ftm2v),
        Estimate::Silling => families.silling_step(&view, &density(), ftm2v),
        Estimate::Exact => families.largest_eigenvalue(&view, &p.mass, ftm2v).map(|a| 2.0 / a.sqrt()),
    };
    Ok(step.unwrap_or(f64::INFINITY))
}

/// Interval in steps at which contacts are examined: whether the time step is within their present limit. Walls report the
/// springs of their contacts then.
pub const LOOK: i64 = 1000;

/// The springs of wall contacts, as walls have reported them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WallSprings {
    /// Whether walls report at each step (compute and fix dt/critical).
    pub always: bool,
    /// By the fix's ID.
    pub lists: Named<ReportedSprings>,
}

/// The report of one wall.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReportedSprings {
    /// When.
    pub step: i64,
    /// Of each contact.
    pub list: Vec<WallSpring>,
}

/// The springs of wall contacts in the facts of a scene.
pub static WALL_SPRINGS: Constant<WallSprings> = Constant::new("wall/springs");

/// Whether a wall reports at this step: before a run's first step, now and then, and at least at its last one.
pub fn walls_report(facts: &Facts, step: i64, setup: bool, last: i64) -> bool {
    setup || step == last || step % LOOK == 0 || walls_always_report(facts)
}

/// Whether walls report at each step.
pub fn walls_always_report(facts: &Facts) -> bool {
    facts.get(*WALL_SPRINGS).is_some_and(|springs| springs.always)
}

/// Makes walls report the springs of their contacts, from the next step on.
pub fn request_wall_springs(w: &mut World) {
    if !walls_always_report(&w.facts) {
        w.facts.get_or_default(*WALL_SPRINGS).always = true;
        w.touch();
    }
}

/// Visits the contacts with walls, as reported last; only those whose step `fresh` accepts.
pub(crate) fn add_walls(w: &World, fresh: impl Fn(i64) -> bool, mut each: impl FnMut(usize, &WallSpring)) {
    let lists = || w.facts.get(*WALL_SPRINGS).into_iter().flat_map(|springs| springs.lists.values());
    let reports = || lists().filter(|report| fresh(report.step));
    let springs = || reports().flat_map(|report| &report.list);
    if springs().next().is_none() {
        return;
    }
    let mut places: Vec<(u32, usize)> = w.particles.tag.iter().copied().zip(0..).collect();
    places.sort_unstable();
    for spring in springs() {
        if let Ok(at) = places.binary_search_by_key(&spring.tag, |p| p.0) {
            each(places[at].1, spring);
        }
    }
}

/// The families of a particle of a solid.
pub(crate) fn solid(w: &World, i: usize) -> Option<&Families> {
    w.families.as_ref().filter(|f| f.place.get(i).is_some_and(|p| *p != u32::MAX))
}

/// The mass of a particle, given those that contacts see [mass].
pub(crate) fn true_mass(w: &World, masses: &[f64], i: usize) -> f64 {
    match solid(w, i) {
        Some(f) if f.options.unit == ForceUnit::Density => masses[i] * w.volumes()[i],
        _ => masses[i],
    }
}

/// The longest stable step of two ends of contacts that swing against each other [time]: the largest Δt with Δt² a + 2 Δt b ≤ 4.
pub(crate) fn damped_limit(a: f64, b: f64) -> f64 {
    4.0 / (b + (b * b + 4.0 * a).sqrt())
}

/// What the contacts of one particle resist with, as tensors xx yy zz xy xz yz.
#[derive(Clone, Copy, Default)]
struct Held {
    /// Σ k_n n⊗n + k_t (1 − n⊗n), and Σ R² k_t (1 − n⊗n): the diagonals.
    straight: Vec3,
    turning: Vec3,
    /// Bounds on ω² and on the damping of what goes and of what turns, times mass and moment of inertia.
    going: [[f64; 6]; 2],
    spinning: [[f64; 6]; 2],
}

/// How much of what slides at a contact is the way and how much the spin of each end: a sphere of inertia 2/5 m R² yields 5/2 as
/// easily by turning. A contact's energy is a square of the sum of what its ends do, and these are the parts in which it is shared.
const SLIDES: f64 = 3.5;

impl Held {
    /// Adds a contact; `ends`: 2 between grains, 1 on a wall.
    fn add(&mut self, n: Vec3, resistance: [[f64; 4]; 2], arm: f64, ends: f64) {
        let [along, across, ..] = resistance[0];
        for d in 0..3 {
            self.straight[d] += along * n[d] * n[d] + across * (1.0 - n[d] * n[d]);
            self.turning[d] += arm * arm * across * (1.0 - n[d] * n[d]);
        }
        for (k, [along, across, rolling, twisting]) in resistance.into_iter().enumerate() {
            spread(&mut self.going[k], n, ends * along, ends * SLIDES * across);
            // Of the spin alone, over 5/2: that of a sphere's moment of inertia.
            let sliding = ends * SLIDES * 0.4 * arm * arm * across;
            spread(&mut self.spinning[k], n, ends * twisting, sliding + ends * rolling);
        }
    }

    /// The longest step by √(m/k) and √(I/k_r), at most what the bound allows [time].
    fn step(&self, mass: f64, inertia: Option<f64>) -> f64 {
        let most = |k: Vec3| k.into_iter().fold(0.0, f64::max);
        let root = |inertia: f64, k: f64| if k > 0.0 { (inertia / k).sqrt() } else { f64::INFINITY };
        let largest = |tensor: [f64; 6]| principal(tensor).0.into_iter().fold(0.0, f64::max);
        let of = |k: usize| {
            let turning = inertia.map_or(0.0, |i| largest(self.spinning[k]) / i);
            (largest(self.going[k]) / mass).max(turning)
        };
        let usual = root(mass, most(self.straight));
        let usual = inertia.map_or(usual, |i| usual.min(root(i, most(self.turning))));
        usual.min(damped_limit(of(0), of(1)))
    }
}

/// Adds along n⊗n + across (1 − n⊗n).
fn spread(tensor: &mut [f64; 6], n: Vec3, along: f64, across: f64) {
    for (t, (a, b)) in tensor.iter_mut().zip(SIX) {
        let same = if a == b { across } else { 0.0 };
        *t += same + (along - across) * n[a] * n[b];
    }
}

/// The longest step of what touches, walls too [time]: the least √(m/k) and √(I/k_r), k being the largest entry on the diagonal of
/// Σ k_n n⊗n + k_t (1 − n⊗n) and k_r of Σ R² k_t (1 − n⊗n) (Chareyre & Villard 2005; Hartmann et al. 2022, equation 43), and at most
/// what no motion of these contacts exceeds, whatever their directions, dashpots, rolling and twisting included.
/// Infinite while nothing touches.
///
/// # Errors
/// What is missing in the scene.
pub fn grains(w: &World, probes: &mut [Box<dyn Probe>]) -> Result<f64> {
    let n = w.n();
    let mut held = vec![Held::default(); n];
    for probe in probes {
        probe.springs(w, &mut |s| {
            for (k, i) in s.ends.into_iter().enumerate() {
                held[i as usize].add(s.normal, [s.stiffness, s.damping], s.arms[k], 2.0);
            }
        })?;
    }
    add_walls(w, |_| true, |i, s| held[i].add(s.normal, [s.stiffness, s.damping], s.arm, 1.0));
    let (p, masses, ftm2v) = (&w.particles, w.contact_masses(), w.settings.units.constants().ftm2v);
    let mut least = f64::INFINITY;
    for (i, held) in held.iter().enumerate() {
        let mass = true_mass(w, &masses, i) / ftm2v;
        // Particles of solids do not turn.
        let radius = p.radius.get(i).filter(|_| solid(w, i).is_none());
        let inertia = radius.map(|r| 0.4 * mass * r * r);
        least = least.min(held.step(mass, inertia));
    }
    Ok(least)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two equal spheres of mass 1 and radius 1 at each end of a contact along `n`.
    fn step(n: Vec3, stiffness: [f64; 4], damping: [f64; 4]) -> f64 {
        let mut held = Held::default();
        held.add(n, [stiffness, damping], 1.0, 2.0);
        held.step(1.0, Some(0.4))
    }

    #[test]
    fn the_estimate_is_never_above_the_limit_of_a_pair() {
        let diagonal = [1.0 / 3f64.sqrt(); 3];
        for n in [[1.0, 0.0, 0.0], diagonal] {
            // Closed forms: ω² = 2 k/m apart, 7 k_t/m sliding while turning, 2 k_r/I rolling and twisting.
            for (part, square) in [(0, 2.0), (1, 7.0), (2, 5.0), (3, 5.0)] {
                let mut stiffness = [0.0; 4];
                stiffness[part] = 1.0;
                let limit = 2.0 / f64::sqrt(square);
                let found = step(n, stiffness, [0.0; 4]);
                assert!(
                    found <= limit * (1.0 + 1e-12) && found > 0.6 * limit,
                    "{n:?} {part}: {found} {limit}"
                );
            }
        }
        // With a dashpot Δt² ω² + 4 ζ ω Δt = 4: here ω² = 2 and 2 ζ ω = 2 c.
        for c in [0.1, 1.0, 10.0] {
            let limit = 4.0 / (2.0 * c + (4.0 * c * c + 8.0_f64).sqrt());
            let found = step(diagonal, [1.0, 0.0, 0.0, 0.0], [c, 0.0, 0.0, 0.0]);
            assert!((found / limit - 1.0).abs() < 1e-12, "{c}: {found} {limit}");
        }
    }

    #[test]
    fn along_an_axis_and_without_dashpots_it_is_the_root_of_mass_over_stiffness() {
        assert_eq!(step([0.0, 1.0, 0.0], [4.0, 0.0, 0.0, 0.0], [0.0; 4]), 0.5);
    }
}
