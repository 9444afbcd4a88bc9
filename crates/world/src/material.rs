//! A material as engineering data, and how its file is read.

mod record;

use perigrain_base::diag::{Code, Diagnostic, FileId, Result, Span};
use perigrain_constitutive::Elastic;
use perigrain_constitutive::sheet::{Fault, Quantity, Sheet};
use record::{DENSITY, ENERGY_PER_AREA, PRESSURE, Record, positive};
use toml::Spanned;

/// One material: in SI units when read from a file, in those of the deck once it is in the world.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Material {
    /// What it is.
    pub name: String,
    /// Young's modulus E, Pa in SI.
    pub young: f64,
    /// Poisson's ratio ν.
    pub nu: f64,
    /// Density ρ, kg/m³ in SI.
    pub density: f64,
    /// When its bonds break; `None`: never.
    pub strength: Option<Strength>,
    /// How much compression strengthens a bond (α of the bond limit).
    pub alpha: f64,
    /// Tensile strength f_t, Pa in SI: where bonds that soften have their peak.
    pub tensile: Option<f64>,
    /// Its elastic law, flow and damage.
    pub sheet: Sheet,
    /// How it conducts heat, stores it and expands.
    #[serde(default)]
    pub thermal: Thermal,
    /// Where the numbers come from.
    pub source: String,
    /// When the record was last checked, `YYYY-MM-DD`.
    pub date: String,
}

/// Heat in a material; what is not given is 0, but for the heat of flow.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Thermal {
    /// Conductivity k, W/(m K) in SI.
    pub conductivity: f64,
    /// Specific heat c_p, J/(kg K) in SI.
    pub heat_capacity: f64,
    /// Thermal expansion α_T, 1/K in SI.
    pub expansion: f64,
    /// The temperature at which it is free of stress, K in SI.
    pub stress_free: f64,
    /// The fraction β of plastic work that becomes heat (Taylor & Quinney 1934).
    pub taylor_quinney: f64,
}

impl Default for Thermal {
    fn default() -> Self {
        Self {
            conductivity: 0.0,
            heat_capacity: 0.0,
            expansion: 0.0,
            stress_free: 0.0,
            taylor_quinney: TAYLOR_QUINNEY,
        }
    }
}

/// What is taken of most metals.
const TAYLOR_QUINNEY: f64 = 0.9;

/// The two ways to define when a bond breaks.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Strength {
    /// Fracture energy G_c, J/m² in SI; the critical stretch depends on the horizon.
    FractureEnergy(f64),
    /// Critical stretch s00, whatever the horizon.
    Stretch(f64),
}

impl Material {
    /// Reads a material file; problems are underlined in `file`, the place where `text` was registered.
    pub fn parse(text: &str, file: FileId) -> Result<Material> {
        let at = |r: std::ops::Range<usize>| Span::new(file, r.start, r.end);
        let r: Record = toml::from_str(text).map_err(|e| {
            let message = e.message().lines().next().unwrap_or("cannot be read").to_owned();
            let code = if message.starts_with("unknown field") {
                Code::UNKNOWN_KEYWORD
            } else if message.starts_with("missing field") {
                Code::MISSING_ARGUMENT
            } else {
                Code::SYNTAX
            };
            Diagnostic::error(code, e.span().map(at), format!("material file: {message}")).help(
                "a material file has name, source, date, E, nu, rho and may have Gc or s00, alpha and ft, and the keys of heat, \
                 flow and damage in potentials/README.md",
            )
        })?;
        let quantity = |q: &Spanned<String>, units| {
            positive(q.get_ref(), units).map_err(|m| {
                Diagnostic::error(Code::BAD_VALUE, at(q.span()), m)
                    .help("write a number and a unit, as \"22.35 GPa\"")
            })
        };
        let strength = match (&r.Gc, &r.s00) {
            (Some(_), Some(s)) => {
                return Err(Diagnostic::error(
                    Code::CONFLICT,
                    at(s.span()),
                    "Gc and s00 both set when a bond breaks",
                )
                .help("keep one of them")
                .into());
            }
            (Some(g), None) => Some(Strength::FractureEnergy(quantity(g, ENERGY_PER_AREA)?)),
            (None, Some(s)) => Some(Strength::Stretch(*s.get_ref())),
            (None, None) => None,
        };
        let (sheet, thermal) = (r.sheet(file)?, r.thermal(file)?);
        let material = Material {
            sheet,
            name: r.name,
            young: quantity(&r.E, PRESSURE)?,
            nu: *r.nu.get_ref(),
            density: quantity(&r.rho, DENSITY)?,
            strength,
            alpha: r.alpha.as_ref().map_or(0.0, |a| *a.get_ref()),
            tensile: r.ft.as_ref().map(|f| quantity(f, PRESSURE)).transpose()?,
            thermal,
            source: r.source,
            date: r.date,
        };
        let place = |key: &str| match key {
            "nu" => at(r.nu.span()),
            "s00" => r.s00.as_ref().map_or(at(0..0), |s| at(s.span())),
            "alpha" => r.alpha.as_ref().map_or(at(0..0), |s| at(s.span())),
            "conductivity" => r.conductivity.as_ref().map_or(at(0..0), |s| at(s.span())),
            "heat_capacity" => r.heat_capacity.as_ref().map_or(at(0..0), |s| at(s.span())),
            "expansion" => r.expansion.as_ref().map_or(at(0..0), |s| at(s.span())),
            "stress_free" => r.stress_free.as_ref().map_or(at(0..0), |s| at(s.span())),
            "taylor_quinney" => r.taylor_quinney.as_ref().map_or(at(0..0), |s| at(s.span())),
            _ => at(r.E.span()),
        };
        match material.implausible() {
            None => Ok(material),
            Some((key, why)) => Err(Diagnostic::error(Code::BAD_VALUE, place(key), why).into()),
        }
    }

    /// From SI to units of which one length, mass and time is so many metres, kilograms and seconds.
    #[must_use]
    pub fn in_units(mut self, [length, mass, time]: [f64; 3]) -> Self {
        let pressure = mass / (length * time * time);
        self.young /= pressure;
        self.density /= mass / length.powi(3);
        self.tensile = self.tensile.map(|f| f / pressure);
        // Temperatures keep their unit: k is a power over length and temperature, c_p a velocity squared over temperature.
        self.thermal.conductivity /= pressure * length * length / time;
        self.thermal.heat_capacity /= length * length / (time * time);
        if let Some(Strength::FractureEnergy(g)) = &mut self.strength {
            *g /= pressure * length;
        }
        self.sheet.convert(|quantity| match quantity {
            Quantity::Pressure => pressure.recip(),
            Quantity::EnergyPerArea => (pressure * length).recip(),
            Quantity::Rate => time,
            Quantity::Temperature | Quantity::Angle | Quantity::Number => 1.0,
        });
        self
    }

    /// The law of stress and strain that its data make.
    ///
    /// # Errors
    /// A number is missing, is refused, or has no use in that law.
    pub fn constitutive(&self) -> std::result::Result<perigrain_constitutive::Material, Fault> {
        self.sheet.material(Elastic::from_young(self.young, self.nu), self.tensile)
    }

    /// The first number that no material can have: its key and what is wrong with it.
    pub fn implausible(&self) -> Option<(&'static str, &'static str)> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if !positive(self.young) {
            return Some(("E", "E must be positive"));
        }
        if !(self.nu > -1.0 && self.nu < 0.5) {
            return Some(("nu", "nu must lie between -1 and 0.5"));
        }
        if !positive(self.density) {
            return Some(("rho", "rho must be positive"));
        }
        match self.strength {
            Some(Strength::FractureEnergy(g)) if !positive(g) => return Some(("Gc", "Gc must be positive")),
            Some(Strength::Stretch(s)) if !positive(s) => return Some(("s00", "s00 must be positive")),
            _ => {}
        }
        if !(self.alpha.is_finite() && self.alpha >= 0.0) {
            return Some(("alpha", "alpha must not be negative"));
        }
        if self.tensile.is_some_and(|f| !positive(f)) {
            return Some(("ft", "ft must be positive"));
        }
        let Thermal { conductivity, heat_capacity, expansion, stress_free, taylor_quinney } = self.thermal;
        let given = |x: f64| x.is_finite() && x >= 0.0;
        if !given(conductivity) {
            return Some(("conductivity", "conductivity must not be negative"));
        }
        if !given(heat_capacity) {
            return Some(("heat_capacity", "heat_capacity must not be negative"));
        }
        if !expansion.is_finite() {
            return Some(("expansion", "expansion must be a number"));
        }
        if !stress_free.is_finite() {
            return Some(("stress_free", "stress_free must be a temperature"));
        }
        if !(0.0..=1.0).contains(&taylor_quinney) {
            return Some(("taylor_quinney", "taylor_quinney lies between 0 and 1"));
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::potentials;
    use perigrain_base::units::UnitSystem;
    use perigrain_constitutive::sheet::Key;

    const MINIMAL: &str = "name='x'\nsource='y'\ndate='2026-01-01'\nE='2 GPa'\nnu=0.25\nrho='1.5 g/cm3'\n";

    fn parse(text: &str) -> Result<Material> {
        Material::parse(text, FileId(7))
    }

    /// The text that the first problem underlines, and its message.
    fn refused(text: &str) -> (String, String) {
        let d = parse(text).unwrap_err().0.remove(0);
        let s = d.span.unwrap();
        assert_eq!(s.file, FileId(7));
        (text[s.start as usize..s.end as usize].to_owned(), d.message)
    }

    #[test]
    fn units_become_si() {
        let m = parse(MINIMAL).unwrap();
        assert_eq!((m.young, m.nu, m.density, m.strength, m.alpha), (2e9, 0.25, 1500.0, None, 0.0));
        let m = parse(&format!("{MINIMAL}Gc='0.01 N/mm'\nalpha=0.25\nft='3 MPa'")).unwrap();
        assert_eq!((m.strength, m.alpha), (Some(Strength::FractureEnergy(10.0)), 0.25));
        assert_eq!(m.tensile, Some(3e6));
    }

    #[test]
    fn deck_units() {
        let m = parse(&format!("{MINIMAL}Gc='10 J/m2'\nft='3 MPa'")).unwrap();
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-14;
        // 1 Pa = 10 dyn/cm², 1 kg/m³ = 1e-3 g/cm³, 1 J/m² = 1e3 erg/cm².
        let cgs = m.clone().in_units(UnitSystem::Cgs.mechanical().unwrap());
        assert!(near(cgs.young, 2e10) && near(cgs.density, 1.5) && near(cgs.tensile.unwrap(), 3e7));
        assert!(matches!(cgs.strength, Some(Strength::FractureEnergy(g)) if near(g, 1e4)));
        // 1 W/(m K) = 1e5 erg/(s cm K), 1 J/(kg K) = 1e4 erg/(g K).
        let heat = Thermal {
            conductivity: 400.0,
            heat_capacity: 380.0,
            expansion: 1e-5,
            stress_free: 293.0,
            taylor_quinney: 0.9,
        };
        let cgs =
            Material { thermal: heat, ..m.clone() }.in_units(UnitSystem::Cgs.mechanical().unwrap()).thermal;
        assert!(near(cgs.conductivity, 4e7) && near(cgs.heat_capacity, 3.8e6));
        assert_eq!((cgs.expansion, cgs.stress_free), (1e-5, 293.0));
        // One micro unit of pressure is 1e3 Pa, of density 1e3 kg/m³, of energy per area 1e-3 J/m².
        let micro = m.in_units(UnitSystem::Micro.mechanical().unwrap());
        assert!(near(micro.young, 2e6) && near(micro.density, 1.5));
        assert!(matches!(micro.strength, Some(Strength::FractureEnergy(g)) if near(g, 1e4)));
    }

    #[test]
    fn heat_of_files() {
        let text = "conductivity='401 W/(m K)'\nheat_capacity='383 J/(kg K)'\nexpansion='17e-6 1/K'\nstress_free='293 K'";
        let heat = parse(&format!("{MINIMAL}{text}")).unwrap().thermal;
        let expected = Thermal {
            conductivity: 401.0,
            heat_capacity: 383.0,
            expansion: 17e-6,
            stress_free: 293.0,
            taylor_quinney: 0.9,
        };
        assert_eq!(heat, expected);
        let short = "k='401 W/m/K'\ncp='383 J/kg/K'\nalphaT='17e-6 1/K'";
        let short = parse(&format!("{MINIMAL}{short}")).unwrap().thermal;
        assert_eq!(short, Thermal { stress_free: 0.0, ..expected });
        assert_eq!(refused(&format!("{MINIMAL}conductivity='-1 W/(m K)'")).0, "'-1 W/(m K)'");
        assert_eq!(refused(&format!("{MINIMAL}cp='383 J'")).0, "'383 J'");
    }

    #[test]
    fn flow_and_damage_in_deck_units() {
        let text = format!(
            "{MINIMAL}yield='90 MPa'\nhardening='johnson-cook'\nB='292 MPa'\nn=0.31\nC=0\nm=1.09\nrate0='1 1/s'\n\
             Tr='298 K'\nTm='1356 K'\neps_f=0.3\nGf='20 kJ/m2'"
        );
        let m = parse(&text).unwrap();
        let get = |m: &Material, key| m.sheet.get(key).unwrap();
        assert_eq!([get(&m, Key::Yield), get(&m, Key::Gf), get(&m, Key::C)], [90e6, 20e3, 0.0]);
        assert!(m.constitutive().is_ok());
        // One micro unit of pressure is 1e3 Pa, of energy per area 1e-3 J/m², of time 1e-6 s.
        let micro = m.in_units(UnitSystem::Micro.mechanical().unwrap());
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-14;
        assert!(near(get(&micro, Key::Yield), 90e3) && near(get(&micro, Key::Gf), 20e6));
        assert!(near(get(&micro, Key::Rate0), 1e-6) && get(&micro, Key::Tm) == 1356.0);
        let table = "hardening='table'\ntable=[[0.0, '90 MPa'], [0.1, '0.2 GPa']]";
        assert_eq!(parse(&format!("{MINIMAL}{table}")).unwrap().sheet.table, [[0.0, 90e6], [0.1, 0.2e9]]);
    }

    #[test]
    fn mistakes_in_flow_are_refused_where_they_stand() {
        let refused = |text: &str| refused(&format!("{MINIMAL}{text}")).0;
        assert_eq!(refused("yield=90.0"), "90.0");
        assert_eq!(refused("yield='90 MPA'"), "'90 MPA'");
        assert_eq!(refused("yield='-90 MPa'"), "'-90 MPa'");
        assert_eq!(refused("n='0.3 m'"), "'0.3 m'");
        assert_eq!(refused("hardening='vice'"), "'vice'");
        assert_eq!(refused("elastic='rubber'"), "'rubber'");
        assert_eq!(refused("phi=90.0"), "90.0");
        assert_eq!(refused("table=[[0.1, '90 MPa']]"), "[[0.1, '90 MPa']]");
        assert_eq!(refused("table=[[0.0, '90 K']]"), "[[0.0, '90 K']]");
    }

    #[test]
    fn unknown_keys_are_refused_where_they_stand() {
        let (word, message) = refused(&format!("{MINIMAL}G_c = '8 J/m2'\n"));
        assert_eq!(word, "G_c");
        assert!(message.contains("unknown field"), "{message}");
    }

    #[test]
    fn wrong_units_and_values_are_refused_where_they_stand() {
        let (word, message) = refused(&MINIMAL.replace("2 GPa", "2 Gpa"));
        assert_eq!(word, "'2 Gpa'");
        assert!(message.contains("unknown unit `Gpa`"), "{message}");
        assert_eq!(refused(&MINIMAL.replace("2 GPa", "2e9")).0, "'2e9'");
        assert_eq!(refused(&MINIMAL.replace("2 GPa", "-2 GPa")).0, "'-2 GPa'");
        assert_eq!(refused(&MINIMAL.replace("0.25", "0.5")).0, "0.5");
        assert_eq!(refused(&format!("{MINIMAL}s00=0.0")).0, "0.0");
        assert_eq!(refused(&format!("{MINIMAL}Gc='8 J/m2'\ns00=0.001")).0, "0.001");
    }

    #[test]
    fn missing_keys_are_named() {
        let d = parse("name='x'").unwrap_err().0.remove(0);
        assert_eq!(d.code, Code::MISSING_ARGUMENT);
        assert!(d.message.contains("missing field"), "{}", d.message);
    }

    #[test]
    fn every_embedded_file_is_a_material_with_a_source() {
        for (name, text) in potentials::EMBEDDED {
            let m = parse(text).unwrap_or_else(|d| panic!("{name}: {d}"));
            assert!(!m.source.trim().is_empty() && m.date.len() == 10, "{name}");
            m.constitutive().unwrap_or_else(|fault| panic!("{name}: {fault:?}"));
        }
    }

    #[test]
    fn the_brittle_plate_is_the_paper_s() {
        // Walayat et al. 2023, Table 3; 10.06 J/m^2 is assumed (see potentials/brittle-plate.toml).
        let m = parse(potentials::embedded("brittle-plate.toml").unwrap()).unwrap();
        assert_eq!((m.young, m.nu, m.density, m.alpha), (22.35e9, 0.25, 2200.0, 0.25));
        assert_eq!(m.strength, Some(Strength::FractureEnergy(10.06)));
    }
}
