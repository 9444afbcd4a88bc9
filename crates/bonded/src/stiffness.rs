//! The four stiffnesses of a bond.
//!
//! K. Jarolin, M. Dosta, Comput. Part. Mech. 8 (2021), Eq. 1–4.

use std::f64::consts::PI;

/// Stiffnesses of a bond for stretch, shear, twist and bending.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stiffness {
    /// Stretch [force/length].
    pub normal: f64,
    /// Shear [force/length].
    pub shear: f64,
    /// Twist [force length/rad].
    pub twist: f64,
    /// Bending [force length/rad].
    pub bend: f64,
}

impl Stiffness {
    /// All four times a factor.
    pub fn times(&self, a: f64) -> Self {
        Self { normal: a * self.normal, shear: a * self.shear, twist: a * self.twist, bend: a * self.bend }
    }

    /// The sum of two in parallel.
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            normal: self.normal + other.normal,
            shear: self.shear + other.shear,
            twist: self.twist + other.twist,
            bend: self.bend + other.bend,
        }
    }
}

/// Energies of stretch, shear, bend and twist [energy].
pub type Modes = [f64; 4];

/// Model of a beam's shear stiffness.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Shear {
    /// G A/L, as in Jarolin and Dosta: a chain of bonds converges to a beam.
    #[default]
    Paper,
    /// That of a Timoshenko beam with shear factor κ: 1/k = L/(κ G A) + L³/(12 E I). Chains are exact at
    /// their nodes.
    Timoshenko(f64),
    /// None.
    None,
}

/// A cylindrical beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Young's modulus [pressure].
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Radius [length].
    pub radius: f64,
    /// Rest length [length].
    pub length: f64,
}

impl Beam {
    /// Cross-section π r² [length²].
    pub fn area(&self) -> f64 {
        PI * self.radius.powi(2)
    }

    /// Second moment of the cross-section π r⁴/4 [length⁴]; the polar moment is twice that.
    pub fn moment(&self) -> f64 {
        0.25 * PI * self.radius.powi(4)
    }

    /// Shear modulus E/(2 (1 + ν)) [pressure].
    pub fn shear_modulus(&self) -> f64 {
        self.young / (2.0 * (1.0 + self.poisson))
    }

    /// k_n = E A/L, k_s, k_t = G 2I/L, k_b = E I/L.
    pub fn stiffness(&self, shear: Shear) -> Stiffness {
        let (a, i, g, l) = (self.area(), self.moment(), self.shear_modulus(), self.length);
        let shear = match shear {
            Shear::Paper => g * a / l,
            Shear::Timoshenko(kappa) => 1.0 / (l / (kappa * g * a) + l.powi(3) / (12.0 * self.young * i)),
            Shear::None => 0.0,
        };
        Stiffness { normal: self.young * a / l, shear, twist: 2.0 * g * i / l, bend: self.young * i / l }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The standard bond of the documentation of bonded particles: E = 1 GPa, ν = 0.2, r = 0.4 mm, L = 1 mm.
    /// Printed with 12 digits: the tolerance of 5e-12 is their rounding.
    /// rounding.
    #[test]
    fn the_standard_bond() {
        let beam = Beam { young: 1e9, poisson: 0.2, radius: 0.4e-3, length: 1e-3 };
        let near = |a: f64, b: f64| assert!((a - b).abs() <= 5e-12 * b, "{a} {b}");
        let k = beam.stiffness(Shear::Paper);
        near(k.normal, 502654.824574);
        near(k.shear, 209439.510239);
        near(k.twist, 0.0167551608191);
        near(k.bend, 0.020106192983);
        // A clamped beam of ten times the length: 3 E I/L³ and κ G A/L in series, compared with w of one
        // element with rotations of both ends.
        let long = Beam { length: 1e-2, ..beam };
        let k = long.stiffness(Shear::Timoshenko(0.9));
        let w = 1e-3 / k.shear + 1e-3 * long.length.powi(2) / (4.0 * k.bend);
        near(w, 1.66316915531e-5);
        assert_eq!(beam.stiffness(Shear::None).shear, 0.0);
    }
}
