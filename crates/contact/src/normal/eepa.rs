//! `eepa E eta nu lambda_p f0 gamma n chi`: the Edinburgh elasto-plastic adhesion model (Morrissey 2013; Thakur et al. 2014).
//!
//! Morrissey, J. P.: Discrete Element Modelling of Iron Ore Pellets to Include the Effects of Moisture and Fines, PhD thesis,
//! University of Edinburgh 2013. Thakur, S. C., Morrissey, J. P., Sun, J., Chen, J. F. & Ooi, J. Y.: Granular Matter 16 (2014)
//! 383–400, doi 10.1007/s10035-014-0506-4, eq. 5 (branches) and 13 (limit of friction).
//!
//! With k_1 = (4/3) E* R̄^(2−n), k_2 = k_1/(1 − λ_p) and the plastic overlap δ_p, δ_p^n = λ_p δ_max^n, the force is
//!
//! ```text
//! loading               −f_0 + k_1 δ^n               where k_2 (δ^n − δ_p^n) ≥ k_1 δ^n, which is δ ≥ δ_max
//! unloading, reloading  −f_0 + k_2 (δ^n − δ_p^n)     between
//! adhesive              −f_0 − k_adh δ^χ             where −k_adh δ^χ ≥ k_2 (δ^n − δ_p^n)
//! ```
//!
//! Adhesion grows with the load the contact has carried: the last two branches meet where the pull equals
//! that of the surface energy over the rim of the plastic contact, (3/2) π γ a_p, a_p = √(R̄ δ_p)
//! (Morrissey), so that k_adh = (3/2) π γ a_p/δ_min^χ with δ_min^n = δ_p^n − (3/2) π γ a_p/k_2. The pull is
//! limited to that of δ_min = δ_p/2: small contacts could not carry more. On the adhesive branch the contact
//! separates irreversibly: δ_max decreases such that reloading starts from there with k_2, until the contact
//! loads with k_1 again; k_adh is that of the last loading.
//! it loads anew with k_1; k_adh is that of the last loading.
//!
//! The history of a contact is δ_max^n and k_adh.

use super::{Bound, Geometry, NormalLaw, Number, Push, Real, Role, Style};
use std::f64::consts::PI;

/// The style.
pub const EEPA: Style = Style {
    name: "eepa",
    numbers: &[
        Number::YOUNG,
        Number::ETA,
        Number::POISSON,
        Number {
            word: "lambda_p",
            name: "the plasticity lambda_p",
            bound: Bound::Where {
                ok: |part| (0.0..1.0).contains(&part),
                wrong: "lambda_p = 1 - k1/k2 is at least 0 and below 1, {} is not",
                help: Some(
                    "unloading is at least as stiff as loading: 0 is elastic, 0.5 unloads twice as stiff",
                ),
            },
            role: Role::Own,
        },
        Number::own("f0", "the constant pull f0", Role::Own),
        Number::GAMMA,
        Number { name: "the exponent n", ..EXPONENT },
        Number { word: "chi", name: "the exponent chi", ..EXPONENT },
    ],
    formula: "Plastic and adhesive grains, below.",
    text: include_str!("eepa.md"),
    exponent: |numbers| numbers[6],
    pulls: |numbers| numbers[4] > 0.0 || numbers[5] > 0.0,
    force: |pair| {
        let [_, _, _, plasticity, pull, gamma, exponent, adhesive, ..] = pair.numbers;
        Eepa { stiffness: 4.0 / 3.0 * pair.young, plasticity, pull, gamma, exponent, adhesive }.into()
    },
    ..Style::PUSHES
};

/// An exponent: forces that grow slower than δ would be infinitely stiff at first touch.
const EXPONENT: Number = Number {
    word: "n",
    name: "",
    bound: Bound::Where {
        ok: |n| (1.0..=10.0).contains(&n),
        wrong: "exponents of eepa lie between 1 and 10, {} does not",
        help: Some("1.5 is that of Hertz' spheres, 1 is linear"),
    },
    role: Role::Same,
};

/// The fraction of the plastic overlap at which the adhesive branch begins, at least.
const LEAST: f64 = 0.5;

/// Loading, unloading and adhesive branches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eepa {
    /// (4/3) E* [pressure].
    stiffness: f64,
    /// λ_p = 1 − k_1/k_2.
    plasticity: f64,
    /// f_0 [force].
    pull: f64,
    /// γ [energy/area].
    gamma: f64,
    /// n.
    exponent: f64,
    /// χ.
    adhesive: f64,
}

/// x^n for x ≥ 0; the usual powers without a call.
#[inline(always)]
fn power<R: Real>(x: R, n: f64) -> R {
    match n {
        0.0 => x.like(1.0),
        0.5 => x.sqrt(),
        1.0 => x,
        1.5 => x * x.sqrt(),
        _ => x.each(|x| x.powf(n)),
    }
}

/// x with x^n = `y` ≥ 0.
#[inline(always)]
fn root<R: Real>(y: R, n: f64) -> R {
    match n {
        1.0 => y,
        1.5 => (y * y).each(f64::cbrt),
        _ => y.each(|y| y.powf(1.0 / n)),
    }
}

impl Eepa {
    /// k_1 [force/length^n].
    #[inline(always)]
    fn loading<R: Real>(&self, curvature: R) -> R {
        power(curvature, 2.0 - self.exponent) * self.stiffness
    }

    /// k_2 from k_1.
    #[inline(always)]
    fn unloading<R: Real>(&self, loading: R) -> R {
        loading / (1.0 - self.plasticity)
    }

    /// k_adh for the plastic overlap `plastic` = δ_p^n.
    #[inline(always)]
    fn adhesion<R: Real>(&self, curvature: R, unloading: R, plastic: R) -> R {
        let zero = plastic.like(0.0);
        let radius = (curvature * root(plastic, self.exponent)).sqrt();
        let asked = plastic - radius * (1.5 * PI * self.gamma) / unloading;
        let least = asked.most(plastic * LEAST.powf(self.exponent));
        let pull = unloading * (plastic - least);
        let stiffness = pull / power(root(least, self.exponent), self.adhesive);
        // Elastic grains have no plastic overlap: 0/0.
        R::choose(pull.above(zero), stiffness, zero)
    }
}

impl NormalLaw for Eepa {
    const BY_RADIUS: bool = false;
    const STICKS: bool = true;
    const MEMORY: usize = 2;

    #[inline(always)]
    fn push<R: Real>(&self, g: &Geometry<R>, _a: R, memory: &mut [R]) -> Push<R> {
        let zero = g.overlap.like(0.0);
        let depth = g.overlap.most(zero);
        let [mut most, mut stick] = [memory[0], memory[1]];
        let loading = self.loading(g.curvature);
        let unloading = self.unloading(loading);
        let now = power(depth, self.exponent);
        let deeper = now.above(most);
        if R::any(deeper) {
            most = R::choose(deeper, now, most);
            let anew = self.adhesion(g.curvature, unloading, most * self.plasticity);
            stick = R::choose(deeper, anew, stick);
        }
        let line = unloading * (now - most * self.plasticity);
        let pulled = stick * power(depth, self.adhesive);
        let apart = (-pulled).above(line);
        memory[0] = R::choose(apart, (now + pulled / unloading) / self.plasticity, most);
        memory[1] = stick;
        Push {
            force: R::choose(apart, -pulled, line) - self.pull,
            secant: loading * power(depth, self.exponent - 1.0),
            hold: pulled + self.pull,
        }
    }

    /// The energy of the unloading branch from δ to δ_p, minus the work of the constant pull from δ on.
    fn energy(&self, g: &Geometry, memory: &[f64]) -> f64 {
        let n = self.exponent;
        let depth = g.overlap.max(0.0);
        let plastic = self.plasticity * memory[0].max(power(depth, n));
        let k = self.unloading(self.loading(g.curvature));
        let rest = root(plastic, n);
        let bent = (power(depth, n) * depth - plastic * rest) / (n + 1.0) - plastic * (depth - rest);
        k * bent - self.pull * depth
    }

    /// The slope of the unloading branch, k_2 n δ^(n−1).
    fn tangent(&self, g: &Geometry) -> f64 {
        let depth = g.overlap.max(0.0);
        let k = self.unloading(self.loading(g.curvature));
        k * self.exponent * power(depth, self.exponent - 1.0)
    }

    fn power_law(&self, curvature: f64, _mass: f64) -> Option<[f64; 2]> {
        Some([self.unloading(self.loading(curvature)), self.exponent])
    }
}
