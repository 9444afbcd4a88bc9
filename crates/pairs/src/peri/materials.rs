//! Coefficients of peridynamic bonds from materials: `pair_coeff … material ID …` and `pair_coeff … mix RULE`.

use super::lines::keywords;
use super::numbers::read;
use super::softening::last_stretch;
use super::{Coeff, short_range, unloading};
use crate::TypePairs;
use perigrain_base::diag::{Code, Diagnostic, Result, Severity, Span, fail, nearest};
use perigrain_constitutive::Material as Stress;
use perigrain_lang::Args;
use perigrain_peri::families::{Moduli, PmbCoeff};
use perigrain_peri::law::Style;
use perigrain_peri::law::style::Curve;
use perigrain_peri::moduli::{self, BOND_NU, Elastic, Form, Mix};
use perigrain_styles::words::{Keyword, Kind, Part, Value, Words, alternatives, inner, one_in};
use perigrain_styles::{BuildCx, UseKind};
use perigrain_world::material::{Material, Strength};
use std::collections::BTreeMap;

/// What bonds between particles of one type are made of.
#[derive(Clone, Debug)]
struct Stuff {
    solid: Elastic,
    density: f64,
    strength: Option<Strength>,
    alpha: f64,
    tensile: Option<f64>,
    form: Form,
    horizon: f64,
    law: &'static Style,
    /// What a state-based law needs besides K and G.
    extra: Moduli,
    /// The law of stress and strain, under correspondence.
    stress: Option<Stress>,
}

/// The materials of a peridynamic body's types.
#[derive(Clone, Debug, Default)]
pub struct Materials {
    types: BTreeMap<u16, Stuff>,
}

impl Materials {
    /// Reads the words of `pair_coeff` after the types if they speak of materials (`None` if they do not):
    /// coefficients for all of `pairs`.
    ///
    /// # Errors
    /// Every mistake in the line.
    pub fn coeff(
        &mut self,
        law: &'static Style,
        pairs: &TypePairs,
        args: &mut Args,
        cx: &BuildCx,
    ) -> Result<Option<Coeff>> {
        match args.peek_text() {
            "material" => {
                args.next();
                let at = args.here();
                let stuff = stuff(law, args, cx)?;
                for &(i, _) in pairs.iter().filter(|(i, j)| i == j) {
                    self.types.insert(i, stuff.clone());
                }
                stuff.coefficients(at).map(Some)
            }
            "mix" => {
                args.next();
                self.mixed(pairs, args, cx).map(Some)
            }
            _ => Ok(None),
        }
    }

    /// Whether no type has a material.
    pub fn is_empty(&self) -> bool {
        self.types.is_empty()
    }

    /// The density of a type that has a material.
    pub fn density(&self, kind: u16) -> Option<f64> {
        self.types.get(&kind).map(|s| s.density)
    }

    /// The law of stress and strain of a type, under correspondence.
    pub fn stress(&self, kind: u16) -> Option<Stress> {
        self.types.get(&kind).and_then(|s| s.stress.clone())
    }

    /// Young's modulus of a type that has a material.
    pub fn young(&self, kind: u16) -> Option<f64> {
        self.types.get(&kind).map(|s| s.solid.young)
    }

    /// Whether the critical stretch of a type's bonds follows from a fracture energy.
    pub fn by_energy(&self, kind: u16) -> bool {
        self.types.get(&kind).is_some_and(|s| matches!(s.strength, Some(Strength::FractureEnergy(_))))
    }

    /// `mix RULE`: means of the properties of exactly two types.
    fn mixed(&self, pairs: &TypePairs, args: &mut Args, cx: &BuildCx) -> Result<Coeff> {
        let word = args.peek().map_or(cx.span, |w| w.span);
        let Blend { rule: Rule(rule) } = inner(args, cx)?;
        let [(i, j)] = pairs else {
            return fail(Code::BAD_VALUE, cx.span, "mix concerns two types: name them, without a range");
        };
        let find = |t: &u16| {
            self.types.get(t).ok_or_else(|| {
                Diagnostic::error(Code::WRONG_ORDER, word, format!("type {t} has no material to mix"))
                    .help(format!("say `pair_coeff {t} {t} … material ID horizon …` before this line"))
            })
        };
        let (a, b) = (find(i)?, find(j)?);
        let between = a.mixed(b, rule, word)?;
        between.coefficients(word)
    }
}

impl Stuff {
    /// The coefficients that LAMMPS has: c, horizon, s00, alpha.
    fn coeff(&self) -> PmbCoeff {
        let states = !self.law.bond_based;
        let c = match states {
            true => short_range(self.solid.bulk(), self.horizon),
            false => self.form.micro_modulus(self.solid, self.horizon),
        };
        let s00 = match self.strength {
            None => f64::INFINITY,
            Some(Strength::Stretch(s)) => s,
            Some(Strength::FractureEnergy(g)) if states => {
                moduli::critical_stretch_of_states(g, self.solid, self.horizon)
            }
            Some(Strength::FractureEnergy(g)) => moduli::critical_stretch(g, c, self.horizon),
        };
        PmbCoeff { c, horizon: self.horizon, s00, alpha: self.alpha }
    }

    /// The same of bonds that soften: c, horizon, and where nothing is left.
    fn softening(&self, curve: &Curve, at: Span) -> Result<PmbCoeff> {
        let c = self.form.micro_modulus(self.solid, self.horizon);
        let s00 = last_stretch(curve, (self.extra.peak, self.fracture_energy()), (c, self.horizon), at)?;
        Ok(PmbCoeff { c, horizon: self.horizon, s00, alpha: 0.0 })
    }

    /// The coefficients of bonds, of whatever law.
    fn coefficients(&self, at: Span) -> Result<Coeff> {
        let coeff = match &self.law.curve {
            Some(curve) => self.softening(curve, at)?,
            None => self.coeff(),
        };
        Ok((coeff, self.moduli()))
    }

    /// What the ends of bonds have under a state-based law.
    fn moduli(&self) -> Moduli {
        Moduli { bulk: self.solid.bulk(), shear: self.solid.shear(), ..self.extra }
    }

    /// What a bond to another body is made of; with itself: the same to the last bit.
    fn mixed(&self, other: &Stuff, rule: Mix, at: Span) -> Result<Stuff> {
        if self.horizon != other.horizon || self.form != other.form {
            let text = "the two types have different horizons or forms, which do not mix";
            return fail(Code::CONFLICT, at, text);
        }
        let strength = match (self.strength, other.strength) {
            (None, None) => None,
            (Some(Strength::Stretch(a)), Some(Strength::Stretch(b))) => {
                Some(Strength::Stretch(rule.mean(a, b)))
            }
            (Some(_), Some(_)) => {
                Some(Strength::FractureEnergy(rule.mean(self.fracture_energy(), other.fracture_energy())))
            }
            _ => {
                return Err(Diagnostic::error(
                    Code::CONFLICT,
                    at,
                    "one of the two types breaks and the other never does",
                )
                .help("give both a Gc or s00, or write this pair's coefficients as numbers")
                .into());
            }
        };
        Ok(Stuff {
            solid: rule.elastic(self.solid, other.solid),
            density: rule.mean(self.density, other.density),
            strength,
            alpha: rule.mean(self.alpha, other.alpha),
            extra: Moduli {
                syc: -rule.mean(-self.extra.syc, -other.extra.syc),
                peak: rule.mean(self.extra.peak, other.extra.peak),
                ..self.extra
            },
            stress: None,
            ..*self
        })
    }

    /// G_c, whichever way the strength was given.
    fn fracture_energy(&self) -> f64 {
        match self.strength {
            Some(Strength::FractureEnergy(g)) => g,
            _ => {
                let p = self.coeff();
                match !self.law.bond_based {
                    true => moduli::fracture_energy_of_states(p.s00, self.solid, p.horizon),
                    false => moduli::fracture_energy(p.s00, p.c, p.horizon),
                }
            }
        }
    }
}

/// The words behind `mix`.
#[derive(Words)]
pub struct Blend {
    /// The mean of the data of the two types that this pair takes, both of which have a material.
    #[word(name = "RULE")]
    rule: Rule,
}

/// A rule of mixing.
struct Rule(Mix);

impl Value for Rule {
    const KIND: Kind = Kind::Choice(&alternatives(&Mix::NAMES));
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        one_in("rule of mixing", args, &Mix::NAMES).map(Self)
    }
}

const fn keyword(
    word: &'static str,
    values: &'static [Part],
    about: &'static str,
    default: &'static str,
) -> Keyword {
    Keyword { word, values, about, default, repeats: false }
}

/// How far bonds reach.
pub const HORIZON: Keyword =
    keyword("horizon", &[Part::number("H")], "The horizon, in spacings of the lattice.", Keyword::NEEDED);

/// Which modulus bond-based laws keep.
pub const FORM: Keyword = keyword(
    "form",
    &[Part::bare("modulus", Kind::Choice(&alternatives(&Form::NAMES)))],
    "Which modulus of the material the bonds keep, as they fix ν = 1/4: c = 18K/(πδ⁴), 30G/(πδ⁴) (Walayat et al. 2023) or \
     12E/(πδ⁴).",
    "bulk",
);

/// The critical stretch.
pub const S00: Keyword = keyword(
    "s00",
    &[Part::number("value")],
    "The critical stretch, in place of that of the material or of its fracture energy.",
    "",
);

/// By which part compression strengthens bonds.
pub const ALPHA: Keyword =
    keyword("alpha", &[Part::number("value")], "In place of that of the material.", "");

/// Reads `ID horizon H [s00 S] [alpha A]` and the law's own words.
fn stuff(law: &'static Style, args: &mut Args, cx: &BuildCx) -> Result<Stuff> {
    let id = args.expect("the material's ID")?;
    let Some(m) = cx.world.materials.get(&id.text) else {
        let d =
            Diagnostic::error(Code::UNKNOWN_MATERIAL, id.span, format!("there is no material `{}`", id.text));
        return Err(match nearest(&id.text, cx.world.materials.keys().map(String::as_str)) {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None => d.help("define it before this line with `material ID …`"),
        }
        .into());
    };
    cx.uses(UseKind::Material, &id.text);
    let mut horizon = None;
    let mut s = Stuff { stress: stress(m, law), ..of(m, law) };
    let mut chosen = false;
    let keywords = keywords(law);
    let known: Vec<&'static str> = keywords.iter().map(|keyword| keyword.word).collect();
    let needed = keywords.iter().filter(|keyword| keyword.needed() && keyword.word != HORIZON.word);
    let mut missing: Vec<&str> = needed.map(|keyword| keyword.word).collect();
    while let Some(word) = args.peek().filter(|w| unloading(&w.text).is_none()) {
        let key = args.choice("keyword of a material", &known)?;
        missing.retain(|k| *k != key);
        match key {
            "horizon" => {
                let span = args.here();
                let ratio = args.positive("the horizon in lattice spacings")?;
                super::horizon::range(ratio, span, cx);
                super::horizon::warn(ratio, 1.0, span, cx);
                horizon = Some(ratio);
            }
            "form" => {
                s.form = one_in("form of the micro-modulus", args, &Form::NAMES)?;
                chosen = true;
            }
            "s00" => s.strength = Some(Strength::Stretch(args.positive("s00")?)),
            "alpha" => s.alpha = args.non_negative("alpha")?,
            _ => {
                let number = law.numbers.iter().find(|number| number.keyword == key);
                number.map_or(Ok(()), |number| read(number, 1, args, &mut s.extra))?;
            }
        }
        if word.text == "horizon" {
            s.horizon = horizon.unwrap_or_default() * spacing(word.span, cx)?;
        }
    }
    if horizon.is_none() {
        return Err(Diagnostic::error(
            Code::MISSING_ARGUMENT,
            args.here(),
            "a material needs a horizon to become a bond",
        )
        .help("add `horizon 3.015`: in lattice spacings")
        .into());
    }
    if let Some(key) = missing.first() {
        let text = format!("this style needs `{key}` beside the material");
        return fail(Code::MISSING_ARGUMENT, args.here(), text);
    }
    if let Some(warning) = without_flow(m, &id.text, id.span).filter(|_| !law.correspondence) {
        cx.note(warning);
    }
    if law.softens() {
        softens(&mut s, id.span, &id.text)?;
    }
    if law.bond_based && s.solid.defies_bonds() {
        let warning = poisson(&id.text, &s, id.span);
        // Where the deck names the modulus to keep, that the others are off is no surprise.
        cx.note(if chosen { Diagnostic { severity: Severity::Note, ..warning } } else { warning });
    }
    Ok(s)
}

/// Checks that a material says where its bonds soften and how far.
fn softens(s: &mut Stuff, at: Span, id: &str) -> Result<()> {
    let missing = |what: &str, help: &str| {
        let text = format!("material `{id}` has no {what}, which bonds that soften need");
        Err(Diagnostic::error(Code::MISSING_ARGUMENT, at, text).help(help).into())
    };
    if !matches!(s.strength, Some(Strength::FractureEnergy(_))) {
        return missing("fracture energy Gc", "give it with `material ID … Gc value`, or in its file");
    }
    if s.extra.peak > 0.0 {
        return Ok(());
    }
    let Some(tensile) = s.tensile else {
        return missing("tensile strength ft", "say `peak value` here, or `ft` in the material or its file");
    };
    s.extra.peak = tensile / s.solid.young;
    Ok(())
}

/// A material before its horizon is known.
fn of(m: &Material, law: &'static Style) -> Stuff {
    Stuff {
        solid: Elastic { young: m.young, nu: m.nu },
        density: m.density,
        strength: m.strength,
        alpha: m.alpha,
        tensile: m.tensile,
        form: Form::default(),
        horizon: 0.0,
        law,
        extra: Moduli {
            conductivity: m.thermal.conductivity,
            heat_capacity: m.thermal.heat_capacity,
            expansion: m.thermal.expansion,
            stress_free: m.thermal.stress_free,
            taylor_quinney: m.thermal.taylor_quinney,
            ..Moduli::default()
        },
        stress: None,
    }
}

/// The law of stress and strain of a material, under a law that needs it.
///
/// The line of a material has been read with its law: a number that does not fit is one that is not known yet, while a deck is checked.
fn stress(m: &Material, law: &Style) -> Option<Stress> {
    law.correspondence.then(|| m.constitutive().ok()).flatten()
}

/// The lattice spacing that horizons are counted in.
fn spacing(at: Span, cx: &BuildCx) -> Result<f64> {
    let [x, y, z] = cx.world.lattice.spacing;
    if x == y && y == z {
        return Ok(x);
    }
    Err(Diagnostic::error(Code::CONFLICT, at, "a horizon in lattice spacings needs a cubic lattice")
        .help("use `lattice sc SPACING`, or give c, horizon, s00 and alpha as numbers")
        .into())
}

/// The warning that laws of bonds use nothing of a material's elastic law, flow and damage.
fn without_flow(m: &Material, id: &str, at: Span) -> Option<Diagnostic> {
    let idle = m.sheet.given();
    if idle.is_empty() {
        return None;
    }
    let text = format!("bonds do not use {} of material `{id}`", idle.join(", "));
    Some(Diagnostic::warning(Code::MATERIAL, at, text).help("`pair_style peri/cauchy` does"))
}

/// The warning that bonds fix Poisson's ratio.
fn poisson(id: &str, s: &Stuff, at: Span) -> Diagnostic {
    let (kept, lost) = match s.form {
        Form::Bulk => ("the bulk modulus K", "E and G are"),
        Form::Shear => ("the shear modulus G", "E and K are"),
        Form::Young => ("Young's modulus E", "K and G are"),
    };
    let text = format!("bonds fix Poisson's ratio at {BOND_NU}, but material `{id}` has nu = {}", s.solid.nu);
    Diagnostic::warning(Code::MATERIAL, at, text)
        .help(format!("`form` bulk, shear or young says which modulus is kept: now {kept}, while {lost} off"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ply(young: f64, nu: f64, strength: Strength) -> Stuff {
        Stuff {
            solid: Elastic { young, nu },
            density: 1400.0,
            strength: Some(strength),
            alpha: 0.25,
            tensile: None,
            form: Form::Shear,
            horizon: 1.5e-3,
            law: perigrain_peri::law::PMB.style(),
            extra: Moduli::default(),
            stress: None,
        }
    }

    #[test]
    fn the_brittle_plate_becomes_lammps_coefficients() {
        let plate = Stuff { form: Form::Bulk, ..ply(22.35e9, 0.25, Strength::FractureEnergy(10.06)) };
        let p = plate.coeff();
        // c as in LAMMPS' peri example; s00 = 5e-4 there (Gc printed with four digits, hence the tolerance).
        assert!((p.c / 1.6863e22 - 1.0).abs() < 5e-5 && (p.s00 / 5e-4 - 1.0).abs() < 5e-4);
        assert_eq!((p.horizon, p.alpha), (1.5e-3, 0.25));
    }

    #[test]
    fn equal_plies_make_an_interface_that_is_none() {
        for strength in [Strength::Stretch(2.5e-3), Strength::FractureEnergy(10.0)] {
            let a = ply(7e9, 0.33, strength);
            for (_, rule) in Mix::NAMES {
                assert_eq!(a.mixed(&a, rule, Span::default()).unwrap().coeff(), a.coeff());
            }
        }
    }

    #[test]
    fn an_interface_between_unlike_plies() {
        let a = ply(7e9, 0.33, Strength::Stretch(2.5e-3));
        let b = ply(3.5e9, 0.33, Strength::Stretch(2.5e-3));
        let m = a.mixed(&b, Mix::Arithmetic, Span::default()).unwrap().coeff();
        // The mean E of equal nu gives the mean c; (4.964 + 2.482)/2 e21 (Walayat et al. 4.4, G preserved).
        assert!((m.c / 3.723e21 - 1.0).abs() < 2e-4, "{}", m.c);
        assert_eq!(m.s00, 2.5e-3);
        // Strengths given in unlike ways meet as fracture energies: 74.1 and 20 J/m^2.
        let c = ply(3.5e9, 0.33, Strength::FractureEnergy(20.0));
        let m = a.mixed(&c, Mix::Arithmetic, Span::default()).unwrap();
        assert!((m.fracture_energy() - 0.5 * (20.0 + a.fracture_energy())).abs() < 1e-12);
    }

    #[test]
    fn what_cannot_be_mixed() {
        let a = ply(7e9, 0.33, Strength::Stretch(2.5e-3));
        let tough = Stuff { strength: None, ..a.clone() };
        assert!(tough.coeff().s00.is_infinite());
        let far = Stuff { horizon: 2e-3, ..a.clone() };
        for other in [tough, far] {
            assert!(a.mixed(&other, Mix::Arithmetic, Span::default()).is_err());
        }
    }
}
