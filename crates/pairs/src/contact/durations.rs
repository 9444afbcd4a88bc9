//! How long contacts last, for a judgement of the time step.

use perigrain_contact::Granular;
use perigrain_contact::driver::Rules;
use perigrain_styles::pair::{Deck, ToCome};
use perigrain_world::World;
use std::f64::consts::PI;

/// The overlap over radius assumed for grains at rest.
const USUAL_OVERLAP: f64 = 0.01;

/// Lightest mass and smallest radius of a type.
type Smallest = Option<[f64; 2]>;

/// The shortest contact between equal grains of the lightest kind of each type, at the present largest speed; `deck`: what the
/// deck states about grains that do not exist yet.
pub fn between_grains(w: &World, rules: &Rules, deck: Deck) -> Option<f64> {
    let types = 1..=w.types as u16;
    let kind = &w.particles.kind;
    let of = |t: u16| smallest(w, deck, |i| kind[i] == t, |c| c.kind == t);
    let sizes: Vec<Smallest> = types.clone().map(of).collect();
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

/// The contact of the lightest grain of a group with a flat wall; `deck` as above.
pub fn on_wall(w: &World, law: &Granular, group: u32, deck: Deck) -> Option<f64> {
    let [mass, radius] = smallest(w, deck, |i| w.particles.mask[i] & group != 0, |c| c.mask & group != 0)?;
    duration(law, w.settings.units.constants().ftm2v, mass, [radius; 2], largest_speed(w))
}

fn largest_speed(w: &World) -> f64 {
    w.particles.v.iter().map(|v| perigrain_base::math::vec3::length(*v)).fold(0.0, f64::max)
}

fn smallest(
    w: &World,
    deck: Deck,
    chosen: impl Fn(usize) -> bool,
    comes: impl Fn(&ToCome) -> bool,
) -> Smallest {
    let p = &w.particles;
    let least = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].min(b[1])];
    let to_come = deck.to_come.iter().filter(|c| comes(c)).map(|c| [c.mass, c.radius]);
    if let (true, Some((density, diameter))) = (p.is_empty(), deck.density_and_diameter()) {
        let given = [PI / 6.0 * density * diameter.powi(3), 0.5 * diameter];
        return Some(to_come.fold(given, least));
    }
    let own = (0..p.len()).filter(|&i| chosen(i) && p.radius.get(i).is_some_and(|r| *r > 0.0));
    let sizes = own.filter_map(|i| Some([*p.mass.get(i)?, p.radius[i]]));
    sizes.chain(to_come).filter(|s| s[0] > 0.0).reduce(least)
}

/// The duration of an undamped impact: π √(m̄/k) for F = k δ, 2.943 δ/v for F = k δ^1.5; c δ/v for F = k δⁿ with
/// δ = ((n+1) m̄ v²/(2 k))^(1/(n+1)).
fn duration(law: &Granular, units: f64, mass: f64, [radius, curvature]: [f64; 2], speed: f64) -> Option<f64> {
    let [k, n] = law.normal.power_law(curvature, mass)?;
    let k = k * units;
    if n == 1.0 {
        return Some(PI * (mass / k).sqrt());
    }
    let reached = |overlap: f64| (2.0 * k * overlap.powf(n + 1.0) / ((n + 1.0) * mass)).sqrt();
    let v = if speed > 0.0 { speed } else { reached(USUAL_OVERLAP * radius) };
    // Faster grains than those that sink in by a tenth of a radius are reported when they do.
    let v = v.min(reached(0.1 * radius));
    Some(there_and_back(n) * ((n + 1.0) * mass * v * v / (2.0 * k)).powf(1.0 / (n + 1.0)) / v)
}

/// The c of an impact on a spring F = k δⁿ: 2 ∫₀¹ dx/√(1 − x^(n+1)), which is 2 ∫ (sin θ/θ)^(s−1) du from 0 to (π/2)^s with
/// s = 2/(n+1) and θ = u^(1/s), smooth, by Simpson's rule.
fn there_and_back(n: f64) -> f64 {
    const PANELS: u32 = 64;
    let s = 2.0 / (n + 1.0);
    let end = (0.5 * PI).powf(s);
    let at = |k: u32| {
        let theta = (end * f64::from(k) / f64::from(PANELS)).powf(1.0 / s);
        if theta > 0.0 { (theta.sin() / theta).powf(s - 1.0) } else { 1.0 }
    };
    let weight = |k: u32| if k == 0 || k == PANELS { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
    let sum: f64 = (0..=PANELS).map(|k| weight(k) * at(k)).sum();
    2.0 * sum * end / f64::from(3 * PANELS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_contact::{Damping, Model, Normal, Tangential, normal};
    use perigrain_world::Compat;

    #[test]
    fn durations_of_closed_forms() {
        let law = |normal| Model::new(normal, Damping::None, Tangential::SMOOTH).law(Compat::Perigrain);
        // Chung & Ooi test 1, glass: 40.340 µs at ±10 m/s, radius 10 mm (test-cases.md).
        let mass = 0.5 * 4.0 / 3.0 * PI * 1e-6 * 2800.0;
        let glass = law(Normal::new(&normal::HERTZ_MATERIAL, &[48e9, 0.0, 0.2]));
        let t = duration(&glass, 1.0, mass, [0.01, 0.005], 20.0).unwrap();
        assert!((t / 40.340e-6 - 1.0).abs() < 1e-4, "{t}");
        // Half a period of m̄ x″ = −k x.
        let hooke = law(Normal::new(&normal::HOOKE, &[4.0, 0.0]));
        assert!((duration(&hooke, 1.0, 1.0, [1.0, 0.5], 0.0).unwrap() - PI / 2.0).abs() < 1e-15);
        assert_eq!(duration(&law(Normal::new(&normal::NONE, &[])), 1.0, 1.0, [1.0, 0.5], 1.0), None);
        // π, and 2 √π Γ(7/5)/Γ(9/10) = 2.943275 (Johnson 1985); Simpson's rule is exact to 1e-8 here.
        assert!((there_and_back(1.0) - PI).abs() < 1e-12 && (there_and_back(1.5) - 2.943_275).abs() < 1e-6);
    }
}
