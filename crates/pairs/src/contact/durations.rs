//! How long contacts last, for a judgement of the time step.

use perigrain_contact::Granular;
use perigrain_contact::driver::Rules;
use perigrain_contact::elastic::Form;
use perigrain_world::World;
use std::f64::consts::PI;

/// The overlap over radius that grains are taken to reach while nobody moves.
const USUAL_OVERLAP: f64 = 0.01;

/// Lightest mass and smallest radius of a type.
type Smallest = Option<[f64; 2]>;

/// The shortest contact between equal grains of the lightest kind of each type, at the largest speed there is now;
/// `said`: density and diameter, where there are no particles yet.
pub fn between_grains(w: &World, rules: &Rules<Granular>, said: Option<(f64, f64)>) -> Option<f64> {
    let types = 1..=w.types as u16;
    let kind = &w.particles.kind;
    let sizes: Vec<Smallest> = types.clone().map(|t| smallest(w, |i| kind[i] == t, said)).collect();
    // Equal grains meet at twice the speed of each.
    let speed = 2.0 * largest_speed(w);
    let units = w.settings.units.constants().ftm2v;
    let pairs = types.clone().flat_map(|a| types.clone().map(move |b| (a, b)));
    let times = pairs.filter_map(|(a, b)| {
        let [ma, ra] = sizes[usize::from(a) - 1]?;
        let [mb, rb] = sizes[usize::from(b) - 1]?;
        let law = &rules.get(a, b)?.law;
        duration(law, units, ma * mb / (ma + mb), [ra.min(rb), ra * rb / (ra + rb)], speed)
    });
    times.reduce(f64::min)
}

/// The contact of the lightest grain of a group with a flat wall; `said` as above.
pub fn on_wall(w: &World, law: &Granular, group: u32, said: Option<(f64, f64)>) -> Option<f64> {
    let [mass, radius] = smallest(w, |i| w.particles.mask[i] & group != 0, said)?;
    duration(law, w.settings.units.constants().ftm2v, mass, [radius; 2], largest_speed(w))
}

fn largest_speed(w: &World) -> f64 {
    w.particles.v.iter().map(|v| perigrain_base::math::vec3::length(*v)).fold(0.0, f64::max)
}

fn smallest(w: &World, chosen: impl Fn(usize) -> bool, said: Option<(f64, f64)>) -> Smallest {
    let p = &w.particles;
    if p.is_empty() {
        let (density, diameter) = said?;
        return Some([PI / 6.0 * density * diameter.powi(3), 0.5 * diameter]);
    }
    let own = (0..p.len()).filter(|&i| chosen(i) && p.radius.get(i).is_some_and(|r| *r > 0.0));
    let sizes = own.filter_map(|i| Some([*p.mass.get(i)?, p.radius[i]]));
    sizes.filter(|s| s[0] > 0.0).reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1])])
}

/// The duration of an undamped impact: π √(m̄/k) for F = k δ, 2.943 δ/v for F = k √R̄ δ^1.5 with
/// δ = (5 m̄ v²/(4 k √R̄))^(2/5).
fn duration(law: &Granular, units: f64, mass: f64, [radius, curvature]: [f64; 2], speed: f64) -> Option<f64> {
    let stiffness = law.elastic.stiffness * units;
    if stiffness <= 0.0 || law.elastic.form == Form::None {
        return None;
    }
    if law.elastic.form == Form::Hooke {
        return Some(PI * (mass / stiffness).sqrt());
    }
    let k = stiffness * curvature.sqrt();
    let reached = |overlap: f64| (4.0 * k * overlap.powf(2.5) / (5.0 * mass)).sqrt();
    let v = if speed > 0.0 { speed } else { reached(USUAL_OVERLAP * radius) };
    // Faster grains than those that sink in by a tenth of a radius are reported when they do.
    let v = v.min(reached(0.1 * radius));
    Some(2.943_275 * (5.0 * mass * v * v / (4.0 * k)).powf(0.4) / v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_contact::{Damping, Model, Normal, Tangential};
    use perigrain_world::Compat;

    #[test]
    fn durations_of_closed_forms() {
        let law = |normal| Model::new(normal, Damping::None, Tangential::SMOOTH).law(Compat::Perigrain);
        // Chung & Ooi test 1, glass: 40.340 µs at ±10 m/s, radius 10 mm (test-cases.md).
        let mass = 0.5 * 4.0 / 3.0 * PI * 1e-6 * 2800.0;
        let glass = law(Normal::HertzMaterial { young: 48e9, eta: 0.0, poisson: 0.2 });
        let t = duration(&glass, 1.0, mass, [0.01, 0.005], 20.0).unwrap();
        assert!((t / 40.340e-6 - 1.0).abs() < 1e-4, "{t}");
        // Half a period of m̄ x″ = −k x.
        let hooke = law(Normal::Hooke { stiffness: 4.0, eta: 0.0 });
        assert!((duration(&hooke, 1.0, 1.0, [1.0, 0.5], 0.0).unwrap() - PI / 2.0).abs() < 1e-15);
        assert_eq!(duration(&law(Normal::None), 1.0, 1.0, [1.0, 0.5], 1.0), None);
    }
}
