//! A material file as written: numbers with units are still text.

use super::Thermal;
use perigrain_base::diag::{Code, Diagnostic, FileId, Result, Span, nearest};
use perigrain_constitutive::sheet::{Curve, Fault, Key, Quantity, Sheet, Strain};
use serde::Deserialize;
use toml::{Spanned, Value};

/// Unit names of a quantity with what one of them is in SI.
pub type Units = &'static [(&'static str, f64)];

pub const PRESSURE: Units =
    &[("Pa", 1.0), ("kPa", 1e3), ("MPa", 1e6), ("GPa", 1e9), ("N/m2", 1.0), ("N/mm2", 1e6), ("N/cm2", 1e4)];
pub const DENSITY: Units = &[("kg/m3", 1.0), ("g/cm3", 1e3)];
pub const ENERGY_PER_AREA: Units = &[("J/m2", 1.0), ("kJ/m2", 1e3), ("N/m", 1.0), ("N/mm", 1e3)];
const RATE: Units = &[("1/s", 1.0)];
const TEMPERATURE: Units = &[("K", 1.0)];
const CONDUCTIVITY: Units = &[("W/(m K)", 1.0), ("W/m/K", 1.0)];
const HEAT_CAPACITY: Units = &[("J/(kg K)", 1.0), ("J/kg/K", 1.0)];
const EXPANSION: Units = &[("1/K", 1.0)];

macro_rules! record {
    ($($key:ident $field:ident $name:literal)*) => {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        #[expect(non_snake_case, reason = "the keys of the file, named as in the papers")]
        pub struct Record {
            pub name: String,
            pub source: String,
            pub date: String,
            pub E: Spanned<String>,
            pub nu: Spanned<f64>,
            pub rho: Spanned<String>,
            pub Gc: Option<Spanned<String>>,
            pub s00: Option<Spanned<f64>>,
            pub alpha: Option<Spanned<f64>>,
            pub ft: Option<Spanned<String>>,
            #[serde(alias = "k")]
            pub conductivity: Option<Spanned<String>>,
            #[serde(alias = "cp")]
            pub heat_capacity: Option<Spanned<String>>,
            #[serde(alias = "alphaT")]
            pub expansion: Option<Spanned<String>>,
            pub stress_free: Option<Spanned<String>>,
            #[serde(alias = "beta")]
            pub taylor_quinney: Option<Spanned<f64>>,
            elastic: Option<Spanned<String>>,
            hardening: Option<Spanned<String>>,
            table: Option<Spanned<Vec<(f64, String)>>>,
            $(#[serde(rename = $name)] $field: Option<Spanned<Value>>,)*
        }

        impl Record {
            /// The numbers of the data sheet.
            fn numbers(&self) -> [(Key, &Option<Spanned<Value>>); Key::COUNT] {
                [$((Key::$key, &self.$field)),*]
            }
        }
    };
}

record! {
    Yield yields "yield"
    H H "H"
    SigmaInf sigma_inf "sigma_inf"
    SmallB b "b"
    N n "n"
    Eps0 eps0 "eps0"
    B B "B"
    C C "C"
    M m "m"
    Rate0 rate0 "rate0"
    Tr Tr "Tr"
    Tm Tm "Tm"
    D1 D1 "D1"
    D2 D2 "D2"
    D3 D3 "D3"
    D4 D4 "D4"
    D5 D5 "D5"
    EpsF eps_f "eps_f"
    Gf Gf "Gf"
    Cohesion cohesion "cohesion"
    Phi phi "phi"
    Psi psi "psi"
}

impl Record {
    /// The heat data in SI units; problems are underlined in `file`.
    pub fn thermal(&self, file: FileId) -> Result<Thermal> {
        let value = |entry: &Option<Spanned<String>>, units: Units, example: &str| {
            let Some(entry) = entry else { return Ok(0.0) };
            quantity(entry.get_ref(), units).map_err(|text| {
                let span = Span::new(file, entry.span().start, entry.span().end);
                Diagnostic::error(Code::BAD_VALUE, span, text).help(format!("write {example}"))
            })
        };
        Ok(Thermal {
            conductivity: value(&self.conductivity, CONDUCTIVITY, "`conductivity = \"401 W/(m K)\"`")?,
            heat_capacity: value(&self.heat_capacity, HEAT_CAPACITY, "`heat_capacity = \"383 J/(kg K)\"`")?,
            expansion: value(&self.expansion, EXPANSION, "`expansion = \"17e-6 1/K\"`")?,
            stress_free: value(&self.stress_free, TEMPERATURE, "`stress_free = \"293 K\"`")?,
            taylor_quinney: self
                .taylor_quinney
                .as_ref()
                .map_or(Thermal::default().taylor_quinney, |b| *b.get_ref()),
        })
    }

    /// The data sheet in SI units; problems are underlined in `file`.
    pub fn sheet(&self, file: FileId) -> Result<Sheet> {
        let wrong = |range: std::ops::Range<usize>, text: String| {
            Diagnostic::error(Code::BAD_VALUE, Span::new(file, range.start, range.end), text)
        };
        let mut sheet = Sheet {
            elastic: chosen(self.elastic.as_ref(), "elastic", &Strain::NAMES, file)?,
            hardening: chosen(self.hardening.as_ref(), "hardening", &Curve::NAMES, file)?,
            ..Sheet::default()
        };
        for (key, entry) in self.numbers() {
            let Some(entry) = entry else { continue };
            let value = number(key, entry.get_ref()).map_err(|text| {
                wrong(entry.span(), text).help(format!("write `{} = {}`", key.name(), key.example()))
            })?;
            sheet.set(key, value);
        }
        if let Some(table) = &self.table {
            for (strain, stress) in table.get_ref() {
                let stress = quantity(stress, PRESSURE).map_err(|text| wrong(table.span(), text))?;
                sheet.table.push([*strain, stress]);
            }
        }
        if let Err(Fault::Refused { key, why }) = sheet.plausible() {
            return Err(wrong(self.place(key), why).into());
        }
        Ok(sheet)
    }

    /// Where a key of the data sheet has its value.
    fn place(&self, key: &str) -> std::ops::Range<usize> {
        let numbers = self.numbers();
        let number =
            numbers.iter().find(|(known, _)| known.name() == key).and_then(|(_, entry)| entry.as_ref());
        number.map(Spanned::span).or(self.table.as_ref().map(Spanned::span)).unwrap_or_default()
    }
}

/// The choice that a name stands for.
fn chosen<T: Copy>(
    entry: Option<&Spanned<String>>,
    key: &str,
    names: &[(&'static str, T)],
    file: FileId,
) -> Result<Option<T>> {
    let Some(entry) = entry else { return Ok(None) };
    if let Some((_, found)) = names.iter().find(|(name, _)| name == entry.get_ref()) {
        return Ok(Some(*found));
    }
    let known: Vec<_> = names.iter().map(|(name, _)| *name).collect();
    let span = Span::new(file, entry.span().start, entry.span().end);
    let text = format!("unknown {key} `{}`; known are {}", entry.get_ref(), known.join(", "));
    let d = Diagnostic::error(Code::UNKNOWN_KEYWORD, span, text);
    Err(match nearest(entry.get_ref(), known.iter().copied()) {
        Some(near) => d.help(format!("did you mean `{near}`?")),
        None => d,
    }
    .into())
}

/// A number of the data sheet in SI units.
fn number(key: Key, value: &Value) -> std::result::Result<f64, String> {
    let units = match key.quantity() {
        Quantity::Pressure => PRESSURE,
        Quantity::EnergyPerArea => ENERGY_PER_AREA,
        Quantity::Rate => RATE,
        Quantity::Temperature => TEMPERATURE,
        Quantity::Angle | Quantity::Number => {
            let number = value.as_float().or(value.as_integer().map(|n| n as f64));
            return number.ok_or(format!("{} is a number without a unit", key.name()));
        }
    };
    let text = value.as_str().ok_or(format!("{} is a text with a number and a unit", key.name()))?;
    quantity(text, units)
}

/// The number of `"22.35 GPa"` as text, and what its unit is in SI.
fn split(text: &str, units: Units) -> std::result::Result<(&str, f64), String> {
    let known = || units.iter().map(|u| u.0).collect::<Vec<_>>().join(", ");
    let Some((number, unit)) = text.trim().split_once(char::is_whitespace) else {
        return Err(format!("`{text}` has no unit; known are {}", known()));
    };
    match units.iter().find(|u| u.0 == unit.trim()) {
        Some((_, factor)) => Ok((number, *factor)),
        None => Err(format!("unknown unit `{}`; known are {}", unit.trim(), known())),
    }
}

/// The value of `"22.35 GPa"` in SI.
fn quantity(text: &str, units: Units) -> std::result::Result<f64, String> {
    let (number, factor) = split(text, units)?;
    number.parse::<f64>().map(|v| v * factor).map_err(|_| format!("`{number}` is not a number"))
}

/// The value of a quantity that must be positive.
pub fn positive(text: &str, units: Units) -> std::result::Result<f64, String> {
    let (number, factor) = split(text, units)?;
    match number.parse::<f64>() {
        Ok(v) if v.is_finite() && v > 0.0 => Ok(v * factor),
        _ => Err(format!("`{number}` is not a positive number")),
    }
}
