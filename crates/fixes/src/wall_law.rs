//! Force laws of smooth walls by distance: the laws of LAMMPS' fix wall and fix wall/region.

use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::BuildCx;
use perigrain_styles::common::unknown_style;
use perigrain_styles::words::{Alternative, Kind, Part, Value};
use std::f64::consts::{PI, SQRT_2};

/// The laws: their words, the formulas of their energies, and their parameters, of which the last is the cutoff.
pub const LAWS: &[Alternative] = &[
    law("lj93", "E = ε (2/15 (σ/r)⁹ − (σ/r)³), a half-space of points of a 12-6 law.", WELL),
    law("lj126", "E = 4 ε ((σ/r)¹² − (σ/r)⁶).", WELL),
    law("lj1043", "E = 2π ε (2/5 (σ/r)¹⁰ − (σ/r)⁴ − √2 σ³/(3 (r + 0.61 σ/√2)³)), layers of a lattice.", WELL),
    law(
        "colloid",
        "E = ε (σ⁶/7560 ((6R − D)/D⁷ + (D + 8R)/(D + 2R)⁷) − 1/6 (2R r/(D (D + 2R)) + ln(D/(D + 2R)))) with D = r − R, the \
         half-space for a sphere of radius R.",
        WELL,
    ),
    law(
        "harmonic",
        "E = ε (r − cutoff)², ε in energy/distance²; sigma has no meaning here and may be any number not below zero.",
        WELL,
    ),
    law("morse", "E = D0 (exp(−2 alpha (r − r0)) − 2 exp(−alpha (r − r0))).", MORSE),
];

/// Names of a law's numbers.
pub fn numbers(name: &str) -> &'static [&'static str] {
    if name == "morse" { &["D0", "alpha", "r0"] } else { &["epsilon", "sigma"] }
}

const WELL: &[Part] = &[Part::number("epsilon"), Part::number("sigma"), Part::number("cutoff")];
const MORSE: &[Part] =
    &[Part::number("D0"), Part::number("alpha"), Part::number("r0"), Part::number("cutoff")];

const fn law(word: &'static str, about: &'static str, parts: &'static [Part]) -> Alternative {
    Alternative { word, about, parts }
}

impl Value for Law {
    const KIND: Kind = Kind::Choice(LAWS);
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let name = args.expect("the law of the wall")?;
        if !LAWS.iter().any(|law| law.word == name.text) {
            let known: Vec<_> = LAWS.iter().map(|law| law.word).collect();
            return Err(unknown_style(name, "law of a wall", &known));
        }
        let given = match name.text.as_str() {
            "morse" => [args.number("D0")?, args.number("alpha")?, args.number("r0")?],
            _ => [args.number("epsilon")?, args.non_negative("sigma")?, 0.0],
        };
        Ok(Self::new(&name.text, given, args.positive("the cutoff")?))
    }
}

/// A law E(r) with its parameters; r is the distance of the particle's centre from the wall [length].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// ε (2/15 (σ/r)⁹ − (σ/r)³): a half-space of points with the Lennard-Jones 12-6 law.
    Lj93([f64; 2]),
    /// 4 ε ((σ/r)¹² − (σ/r)⁶).
    Lj126([f64; 2]),
    /// 2π ε (2/5 (σ/r)¹⁰ − (σ/r)⁴ − √2 σ³/(3 (r + 0.61 σ/√2)³)): layers of a lattice (Steele 1973).
    Lj1043([f64; 2]),
    /// The half-space for a sphere of radius R made of such points, with D = r − R (Everaers & Ejtehadi 2003):
    /// ε (σ⁶/7560 ((6R − D)/D⁷ + (D + 8R)/(D + 2R)⁷) − 1/6 (2R r/(D (D + 2R)) + ln(D/(D + 2R)))).
    Colloid([f64; 2]),
    /// ε (r − r_c)².
    Harmonic(f64),
    /// D₀ (e^(−2α(r − r₀)) − 2 e^(−α(r − r₀))).
    Morse([f64; 3]),
}

/// A law with a cutoff.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    form: Form,
    /// Cutoff [length].
    pub cutoff: f64,
    /// Energy at the cutoff, where it is the same for all particles.
    end: Option<f64>,
    /// Uses the signs and the shift of `colloid` in fix wall/region of LAMMPS 22Jul2025.
    inverted: bool,
}

impl Law {
    /// The law of this name with its parameters, see [`LAWS`].
    pub fn new(name: &str, [a, b, c]: [f64; 3], cutoff: f64) -> Self {
        let form = match name {
            "lj93" => Form::Lj93([a, b]),
            "lj126" => Form::Lj126([a, b]),
            "lj1043" => Form::Lj1043([a, b]),
            "colloid" => Form::Colloid([a, b]),
            "morse" => Form::Morse([a, b, c]),
            _ => Form::Harmonic(a),
        };
        Self::of(form, cutoff)
    }

    fn of(form: Form, cutoff: f64) -> Self {
        let law = Self { form, cutoff, end: None, inverted: false };
        let end = (!law.needs_radii()).then(|| law.plain(cutoff, 0.0)[1]);
        Self { end, ..law }
    }

    /// The variant of fix wall/region in LAMMPS 22Jul2025.
    #[must_use]
    pub fn inverted(self) -> Self {
        Self { inverted: self.needs_radii(), ..self }
    }

    /// Whether it needs particle radii.
    pub fn needs_radii(&self) -> bool {
        matches!(self.form, Form::Colloid(_))
    }

    /// The smallest distance allowed for a particle of this radius.
    pub fn least(&self, radius: f64) -> f64 {
        if self.needs_radii() { radius } else { 0.0 }
    }

    /// The force away from the wall −dE/dr and the energy, which is 0 at the cutoff.
    pub fn at(&self, r: f64, radius: f64) -> [f64; 2] {
        let [force, energy] = self.plain(r, radius);
        match self.form {
            Form::Colloid([epsilon, sigma]) if self.inverted => {
                // Its force attracts where it should repel, its attraction counts as positive energy, and its
                // shift is that of a 9-3 law.
                let [core, _] = colloid_energy(epsilon, sigma, r, radius);
                let c = self.cutoff;
                let shift = epsilon * (sigma.powi(6) / 7560.0 / c.powi(9) - 1.0 / 6.0 / c.powi(3));
                [-force, 2.0 * core - energy - shift]
            }
            _ => [force, energy - self.end.unwrap_or_else(|| self.plain(self.cutoff, radius)[1])],
        }
    }

    /// Force and energy without the shift.
    fn plain(&self, r: f64, radius: f64) -> [f64; 2] {
        match self.form {
            Form::Lj93([epsilon, sigma]) => {
                let s = (sigma / r).powi(3);
                let nine = 2.0 / 15.0 * s * s * s;
                [epsilon * (9.0 * nine - 3.0 * s) / r, epsilon * (nine - s)]
            }
            Form::Lj126([epsilon, sigma]) => {
                let s = (sigma / r).powi(6);
                [24.0 * epsilon * (2.0 * s * s - s) / r, 4.0 * epsilon * (s * s - s)]
            }
            Form::Lj1043([epsilon, sigma]) => {
                let (ten, four) = (0.4 * (sigma / r).powi(10), (sigma / r).powi(4));
                let far = r + 0.61 / SQRT_2 * sigma;
                let three = SQRT_2 / 3.0 * (sigma / far).powi(3);
                let front = 2.0 * PI * epsilon;
                [front * (10.0 * ten / r - 4.0 * four / r - 3.0 * three / far), front * (ten - four - three)]
            }
            Form::Colloid([epsilon, sigma]) => {
                let [core, pull] = colloid_energy(epsilon, sigma, r, radius);
                [colloid_force(epsilon, sigma, r, radius), core + pull]
            }
            Form::Harmonic(epsilon) => {
                let d = self.cutoff - r;
                [2.0 * epsilon * d, epsilon * d * d]
            }
            Form::Morse([depth, alpha, r0]) => {
                let e = (-alpha * (r - r0)).exp();
                [2.0 * alpha * depth * (e * e - e), depth * (e * e - 2.0 * e)]
            }
        }
    }
}

/// Repulsion and attraction energies of `colloid`.
fn colloid_energy(epsilon: f64, sigma: f64, r: f64, radius: f64) -> [f64; 2] {
    let (near, far) = (r - radius, r + radius);
    let core = (6.0 * radius - near) / near.powi(7) + (near + 8.0 * radius) / far.powi(7);
    let pull = 2.0 * radius * r / (near * far) + (near / far).ln();
    [epsilon * sigma.powi(6) / 7560.0 * core, -epsilon / 6.0 * pull]
}

/// −dE/dr of `colloid`.
fn colloid_force(epsilon: f64, sigma: f64, r: f64, radius: f64) -> f64 {
    let (a, s) = (radius * radius, r * r);
    let inverse = 1.0 / (a - s).powi(2);
    let sum = a.powi(3) + 27.0 * a * a * s + 63.0 * a * s * s + 21.0 * s.powi(3);
    let core = 4.0 / 315.0 * sigma.powi(6) * sum * inverse.powi(4);
    epsilon * a * radius * (core - 2.0 / 3.0 * inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMS: [Form; 6] = [
        Form::Lj93([1.3, 0.9]),
        Form::Lj126([1.3, 0.9]),
        Form::Lj1043([1.3, 0.9]),
        Form::Colloid([1.3, 0.9]),
        Form::Harmonic(1.3),
        Form::Morse([1.3, 2.0, 1.2]),
    ];

    // The central difference over 1e-5 is accurate to 1e-10 of third derivatives, and to 1e-11 of the
    // energies over the step.
    #[test]
    fn forces_are_slopes_of_energies_that_end_at_the_cutoff() {
        for form in FORMS {
            let law = Law::of(form, 2.5);
            for r in [0.8, 1.1, 1.7, 2.4] {
                let [force, _] = law.at(r, 0.3);
                let slope = (law.at(r + 1e-5, 0.3)[1] - law.at(r - 1e-5, 0.3)[1]) / 2e-5;
                assert!((force + slope).abs() < 1e-7 * force.abs().max(1.0), "{form:?} {r}: {force} {slope}");
            }
            assert!(law.at(2.5, 0.3)[1].abs() < 1e-15, "{form:?}");
        }
    }
}
