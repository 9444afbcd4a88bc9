//! From engineering moduli to what a peridynamic bond and a contact need, and back.

use std::f64::consts::PI;

/// The only Poisson's ratio a bond-based peridynamic solid in three dimensions can have.
pub const BOND_NU: f64 = 0.25;

/// How far a material's Poisson's ratio may be from [`BOND_NU`] before it deserves a warning.
pub const BOND_NU_TOLERANCE: f64 = 0.01;

/// An isotropic elastic solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastic {
    /// Young's modulus E, a pressure.
    pub young: f64,
    /// Poisson's ratio ν.
    pub nu: f64,
}

impl Elastic {
    /// The solid with bulk modulus K and shear modulus G: E = 9KG/(3K + G), ν = (3K − 2G)/(2(3K + G)).
    pub fn from_bulk_shear(bulk: f64, shear: f64) -> Self {
        let d = 3.0 * bulk + shear;
        Self { young: 9.0 * bulk * shear / d, nu: (3.0 * bulk - 2.0 * shear) / (2.0 * d) }
    }

    /// Bulk modulus K = E/(3(1 − 2ν)).
    pub fn bulk(self) -> f64 {
        self.young / (3.0 * (1.0 - 2.0 * self.nu))
    }

    /// Shear modulus G = E/(2(1 + ν)).
    pub fn shear(self) -> f64 {
        self.young / (2.0 * (1.0 + self.nu))
    }

    /// Whether ν is too far from 1/4 for a bond-based solid to honour more than one modulus.
    pub fn defies_bonds(self) -> bool {
        (self.nu - BOND_NU).abs() > BOND_NU_TOLERANCE
    }
}

/// Which modulus the micro-modulus of a bond preserves; all three agree at ν = 1/4.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// K, as LAMMPS and Hartmann et al. (2023) after Eq. 10.
    #[default]
    Bulk,
    /// G, as Walayat et al. (2023) Eq. 3.
    Shear,
    /// E.
    Young,
}

impl Form {
    /// The words of a deck with their meaning.
    pub const NAMES: [(&'static str, Form); 3] =
        [("bulk", Form::Bulk), ("shear", Form::Shear), ("young", Form::Young)];

    /// Micro-modulus c (force per volume squared; N/m⁶ in SI) of a bond with horizon δ:
    /// bulk 18K/(πδ⁴), shear 30G/(πδ⁴), young 12E/(πδ⁴).
    pub fn micro_modulus(self, solid: Elastic, horizon: f64) -> f64 {
        let numerator = match self {
            Form::Bulk => 18.0 * solid.bulk(),
            Form::Shear => 30.0 * solid.shear(),
            Form::Young => 12.0 * solid.young,
        };
        numerator / (PI * horizon.powi(4))
    }
}

/// Stretch at which a bond breaks so that a unit of crack area costs G_c:
/// s_c = √(10 G_c/(π c δ⁵)) (Silling and Askari 2005; Walayat et al. 2023, Eq. 5).
pub fn critical_stretch(fracture_energy: f64, micro_modulus: f64, horizon: f64) -> f64 {
    (10.0 * fracture_energy / (PI * micro_modulus * horizon.powi(5))).sqrt()
}

/// What a unit of crack area costs when bonds break at this stretch: G_c = π c δ⁵ s_c²/10.
pub fn fracture_energy(critical_stretch: f64, micro_modulus: f64, horizon: f64) -> f64 {
    PI * micro_modulus * horizon.powi(5) * critical_stretch * critical_stretch / 10.0
}

/// The area under the curve g(s) of bonds c g(s) that release this energy for each area of a crack:
/// 5 G/(π c δ⁵) (Silling & Askari 2005, equation 21, where it is ½ s₀²).
pub fn curve_area(fracture_energy: f64, micro_modulus: f64, horizon: f64) -> f64 {
    0.5 * critical_stretch(fracture_energy, micro_modulus, horizon).powi(2)
}

/// The same for a linear peridynamic solid: s_c = √(G_c/((3G + (3/4)⁴ (K − 5G/3)) δ)) (Madenci and Oterkus 2014); at
/// ν = 1/4 that of bonds.
pub fn critical_stretch_of_states(fracture_energy: f64, solid: Elastic, horizon: f64) -> f64 {
    (fracture_energy / resistance(solid, horizon)).sqrt()
}

/// What a unit of crack area of a linear peridynamic solid costs when bonds break at this stretch.
pub fn fracture_energy_of_states(critical_stretch: f64, solid: Elastic, horizon: f64) -> f64 {
    resistance(solid, horizon) * critical_stretch * critical_stretch
}

fn resistance(solid: Elastic, horizon: f64) -> f64 {
    let (bulk, shear) = (solid.bulk(), solid.shear());
    (3.0 * shear + 0.75f64.powi(4) * (bulk - 5.0 * shear / 3.0)) * horizon
}

/// Contact modulus E* of two solids: 1/E* = (1 − ν_i²)/E_i + (1 − ν_j²)/E_j (Hertz).
pub fn contact_young(i: Elastic, j: Elastic) -> f64 {
    1.0 / ((1.0 - i.nu * i.nu) / i.young + (1.0 - j.nu * j.nu) / j.young)
}

/// Contact modulus G* of two solids: 1/G* = (2 − ν_i)/G_i + (2 − ν_j)/G_j (Mindlin).
pub fn contact_shear(i: Elastic, j: Elastic) -> f64 {
    1.0 / ((2.0 - i.nu) / i.shear() + (2.0 - j.nu) / j.shear())
}

/// How the property of a bond between two materials follows from theirs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mix {
    /// (a + b)/2, as Walayat et al. (2023), section 4.4.
    #[default]
    Arithmetic,
    /// 2ab/(a + b): springs in series.
    Harmonic,
    /// √(ab).
    Geometric,
}

impl Mix {
    /// The words of a deck with their meaning.
    pub const NAMES: [(&'static str, Mix); 3] =
        [("arithmetic", Mix::Arithmetic), ("harmonic", Mix::Harmonic), ("geometric", Mix::Geometric)];

    /// The mean of two values that are not negative; of two equal values, that value to the last bit.
    pub fn mean(self, a: f64, b: f64) -> f64 {
        if a == b {
            return a;
        }
        match self {
            Mix::Arithmetic => 0.5 * (a + b),
            Mix::Harmonic => 2.0 * a * b / (a + b),
            Mix::Geometric => (a * b).sqrt(),
        }
    }

    /// The solid between two solids: means of E and of ν.
    pub fn elastic(self, a: Elastic, b: Elastic) -> Elastic {
        Elastic { young: self.mean(a.young, b.young), nu: self.mean(a.nu, b.nu) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The brittle plate: Walayat et al. 2023, Table 3.
    const PLATE: Elastic = Elastic { young: 22.35e9, nu: 0.25 };
    /// Plate and ball of section 4.1 there.
    const STEEL: Elastic = Elastic { young: 206e9, nu: 0.28 };

    /// Equal to `digits` significant digits, as many as the reference was printed with.
    fn agrees(a: f64, b: f64, digits: i32) -> bool {
        (a / b - 1.0).abs() < 0.5 * 10f64.powi(1 - digits)
    }

    #[test]
    fn moduli_of_the_brittle_plate() {
        // E = 22.35 GPa, nu = 1/4: K = 14.9 GPa and G = 8.94 GPa (Silling and Askari's disc).
        assert!(agrees(PLATE.bulk(), 14.9e9, 12));
        assert!(agrees(PLATE.shear(), 8.94e9, 12));
        let back = Elastic::from_bulk_shear(14.9e9, 8.94e9);
        assert!(agrees(back.young, 22.35e9, 12) && agrees(back.nu, 0.25, 12));
    }

    #[test]
    fn micro_modulus_of_the_silling_askari_disc() {
        // LAMMPS' manual: c = 1.6863e22 N/m^6 for K = 14.9 GPa and a horizon of 1.5 mm.
        let c = Form::Bulk.micro_modulus(PLATE, 1.5e-3);
        assert!(agrees(c, 1.6863e22, 5), "{c:e}");
    }

    #[test]
    fn critical_stretch_of_the_brittle_plate() {
        let c = Form::Bulk.micro_modulus(PLATE, 1.5e-3);
        // Closed form sqrt(5 Gc / (9 K delta)), printed values for a horizon of 1.5 mm.
        for (gc, s) in [(4.0, 3.15e-4), (8.0, 4.46e-4), (20.0, 7.05e-4), (50.0, 1.11e-3), (100.0, 1.58e-3)] {
            assert!(agrees(critical_stretch(gc, c, 1.5e-3), s, 3));
        }
        // s_c = 5e-4 there costs 10.06 J/m^2.
        assert!(agrees(fracture_energy(5e-4, c, 1.5e-3), 10.06, 4));
        assert!(agrees(fracture_energy(critical_stretch(10.06, c, 1.5e-3), c, 1.5e-3), 10.06, 14));
    }

    #[test]
    fn bonds_and_states_break_alike_at_one_quarter() {
        let c = Form::Bulk.micro_modulus(PLATE, 1.5e-3);
        let s = critical_stretch_of_states(10.06, PLATE, 1.5e-3);
        assert!(agrees(s, critical_stretch(10.06, c, 1.5e-3), 13));
        assert!(agrees(fracture_energy_of_states(s, PLATE, 1.5e-3), 10.06, 13));
    }

    #[test]
    fn micro_moduli_of_the_laminate() {
        // Walayat et al. 4.4 with c preserving G at a horizon of 1.5 mm, computed by hand from 15E/(pi delta^4 (1 + nu)).
        for (young, nu, c) in [(7e9, 0.33, 4.964e21), (3.5e9, 0.33, 2.482e21), (4e9, 0.3, 2.902e21)] {
            let got = Form::Shear.micro_modulus(Elastic { young, nu }, 1.5e-3);
            assert!(agrees(got, c, 4), "{got:e} {c:e}");
        }
        // The stretch 2.5e-3 there stands for 74, 37 and 43 J/m^2.
        for (young, nu, gc) in [(7e9, 0.33, 74.0), (3.5e9, 0.33, 37.0), (4e9, 0.3, 43.0)] {
            let c = Form::Shear.micro_modulus(Elastic { young, nu }, 1.5e-3);
            assert!((fracture_energy(2.5e-3, c, 1.5e-3) - gc).abs() < 0.5);
        }
    }

    #[test]
    fn forms_coincide_at_one_quarter_only() {
        let [b, s, y] = [Form::Bulk, Form::Shear, Form::Young].map(|f| f.micro_modulus(PLATE, 3e-3));
        assert!(agrees(b, s, 14) && agrees(b, y, 14));
        // bulk / shear = 6(1 + nu) / (15(1 - 2 nu)): 1.164 for steel, 1.565 for the laminate.
        for (nu, ratio) in [(0.28, 1.164), (0.33, 1.565)] {
            let m = Elastic { young: 1.0, nu };
            let got = Form::Bulk.micro_modulus(m, 1.0) / Form::Shear.micro_modulus(m, 1.0);
            assert!(agrees(got, ratio, 4), "{got}");
        }
    }

    #[test]
    fn poisson_warning_has_a_margin() {
        assert!(!PLATE.defies_bonds());
        assert!(STEEL.defies_bonds());
        assert!(!Elastic { young: 1.0, nu: 0.2595 }.defies_bonds());
        assert!(Elastic { young: 1.0, nu: 0.2395 }.defies_bonds());
    }

    #[test]
    fn contact_moduli() {
        // Steel on steel: E* = 206 GPa / (2 (1 - 0.28^2)) = 1.11762e11 Pa.
        assert!(agrees(contact_young(STEEL, STEEL), 1.11762e11, 6));
        // Alumina on soda-lime glass: E* = 6.2952e10 Pa; G* = 1.35147e10 Pa with alumina's G rounded to 154 GPa.
        let alumina = Elastic { young: 380e9, nu: 0.23 };
        let glass = Elastic { young: 70e9, nu: 0.25 };
        assert!(agrees(contact_young(alumina, glass), 6.2952e10, 5));
        assert!(agrees(contact_shear(alumina, glass), 1.35147e10, 3));
    }

    #[test]
    fn interfaces_of_the_laminate() {
        // Walayat et al. 4.4, arithmetic means: 5.25 GPa and 0.33, 3.75 GPa and 0.315, 4 GPa and 0.30.
        let plies =
            [(7e9, 0.33), (3.5e9, 0.33), (4e9, 0.3), (4e9, 0.3)].map(|(young, nu)| Elastic { young, nu });
        for (k, (young, nu)) in [(5.25e9, 0.33), (3.75e9, 0.315), (4e9, 0.3)].into_iter().enumerate() {
            let m = Mix::Arithmetic.elastic(plies[k], plies[k + 1]);
            assert!(agrees(m.young, young, 14) && agrees(m.nu, nu, 14));
        }
    }

    #[test]
    fn equal_materials_mix_to_themselves_and_means_are_ordered() {
        for (_, mix) in Mix::NAMES {
            assert_eq!(mix.elastic(STEEL, STEEL), STEEL);
            assert_eq!(mix.mean(3.0, 0.0) == 0.0, mix != Mix::Arithmetic);
        }
        let [a, h, g] = [Mix::Arithmetic, Mix::Harmonic, Mix::Geometric].map(|m| m.mean(2.0, 8.0));
        assert_eq!([a, h, g], [5.0, 3.2, 4.0]);
    }
}
