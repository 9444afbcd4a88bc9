//! The longest stable steps of a scene as it is: of peridynamic solids and of grains in contact.

use crate::peri_view::view;
use crate::probe::Probe;
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::Vec3;
use perigrain_lang::Args;
use perigrain_peri::families::{Families, ForceUnit};
use perigrain_world::World;
use perigrain_world::contacts::WallSpring;

/// How the step of peridynamic solids is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Estimate {
    /// h/√(K/ρ).
    #[default]
    Cfl,
    /// Silling & Askari.
    Silling,
    /// 2/ω of the present scene.
    Exact,
}

impl Estimate {
    /// Reads its name.
    ///
    /// # Errors
    /// Another word.
    pub fn read(args: &mut Args) -> Result<Self> {
        Ok(match args.choice("estimate of the solids' step", &["cfl", "silling", "exact"])? {
            "silling" => Estimate::Silling,
            "exact" => Estimate::Exact,
            _ => Estimate::Cfl,
        })
    }
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

/// Asks walls for the springs of their contacts, from the next step on.
pub fn ask_walls(w: &mut World) {
    if !w.parts.wall_springs.always {
        w.parts.wall_springs.always = true;
        w.touch();
    }
}

/// Goes through the contacts with walls, as they were told last; only those that `fresh` takes by their step.
pub(crate) fn add_walls(w: &World, fresh: impl Fn(i64) -> bool, mut each: impl FnMut(usize, &WallSpring)) {
    let told = || w.parts.wall_springs.lists.values().filter(|told| fresh(told.step));
    let springs = || told().flat_map(|told| &told.list);
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

/// The longest step of what touches, walls too [time]: the least √(m/k) and √(I/k_r), k being the largest entry on the diagonal of
/// Σ k_n n⊗n + k_t (1 − n⊗n) and k_r of Σ R² k_t (1 − n⊗n) (Chareyre & Villard 2005; Hartmann et al. 2022, equation 43).
/// Infinite while nothing touches.
///
/// # Errors
/// What is missing in the scene.
pub fn grains(w: &World, probes: &mut [Box<dyn Probe>]) -> Result<f64> {
    let n = w.n();
    let (mut straight, mut turning) = (vec![[0.0; 3]; n], vec![[0.0; 3]; n]);
    let add = |sum: &mut Vec3, normal: Vec3, [along, across]: [f64; 2]| {
        (0..3).for_each(|d| sum[d] += along * normal[d] * normal[d] + across * (1.0 - normal[d] * normal[d]));
    };
    for probe in probes {
        for s in probe.springs(w)? {
            for (k, i) in s.ends.into_iter().enumerate() {
                add(&mut straight[i as usize], s.normal, s.stiffness);
                let lever = s.arms[k] * s.arms[k] * s.stiffness[1];
                add(&mut turning[i as usize], s.normal, [0.0, lever]);
            }
        }
    }
    add_walls(
        w,
        |_| true,
        |i, spring| {
            add(&mut straight[i], spring.normal, spring.stiffness);
            add(&mut turning[i], spring.normal, [0.0, spring.arm * spring.arm * spring.stiffness[1]]);
        },
    );
    let (p, masses, ftm2v) = (&w.particles, w.contact_masses(), w.settings.units.constants().ftm2v);
    let most = |k: Vec3| k.into_iter().fold(0.0, f64::max);
    let mut least = f64::INFINITY;
    for i in 0..n {
        let mass = true_mass(w, &masses, i);
        let k = ftm2v * most(straight[i]);
        if k > 0.0 {
            least = least.min((mass / k).sqrt());
        }
        // Particles of solids do not turn.
        let k = ftm2v * most(turning[i]);
        if k > 0.0 && solid(w, i).is_none() {
            least = least.min((0.4 * mass * p.radius[i] * p.radius[i] / k).sqrt());
        }
    }
    Ok(least)
}
