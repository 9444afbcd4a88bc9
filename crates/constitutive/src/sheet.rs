//! A data sheet: the numbers of a material under their keys, and the law that they make.

mod keys;

pub use keys::{Key, Quantity};

use crate::brittle::Brittle;
use crate::damage::{Damage, Onset};
use crate::drucker_prager::DruckerPrager;
use crate::elastic::Elastic;
use crate::flow::Flow;
use crate::hardening::Hardening;
use crate::johnson_cook::{FractureStrain, JohnsonCook, Reference};
use crate::material::{Law, Material};

/// How the yield stress of Mises flow grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Curve {
    /// Not at all.
    Perfect,
    /// [`Hardening::Linear`].
    Linear,
    /// [`Hardening::Voce`].
    Voce,
    /// [`Hardening::Swift`].
    Swift,
    /// [`Hardening::Table`].
    Table,
    /// [`Hardening::JohnsonCook`].
    JohnsonCook,
}

impl Curve {
    /// Each with its name.
    pub const NAMES: [(&'static str, Self); 6] = [
        ("perfect", Self::Perfect),
        ("linear", Self::Linear),
        ("voce", Self::Voce),
        ("swift", Self::Swift),
        ("table", Self::Table),
        ("johnson-cook", Self::JohnsonCook),
    ];
}

/// Elastic laws of matter that does not flow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Strain {
    /// [`Law::Hencky`], and the only one that flows.
    #[default]
    Hencky,
    /// [`Law::NeoHooke`].
    NeoHooke,
    /// [`Law::Linear`].
    Linear,
}

impl Strain {
    /// Each with its name.
    pub const NAMES: [(&'static str, Self); 3] =
        [("hencky", Self::Hencky), ("neohooke", Self::NeoHooke), ("linear", Self::Linear)];
}

/// What is wrong with a data sheet.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// A law needs a number that is not there.
    Missing {
        /// Its key.
        key: &'static str,
        /// What needs it.
        law: &'static str,
        /// How a file gives it, as `"90 MPa"`.
        example: &'static str,
    },
    /// A number that no matter has, or that no law uses.
    Refused {
        /// Its key.
        key: &'static str,
        /// Why.
        why: String,
    },
}

/// The numbers of a material besides elastic constants and density. What is not given is `None`.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Sheet {
    /// The elastic law.
    pub elastic: Option<Strain>,
    /// How the yield stress grows.
    pub hardening: Option<Curve>,
    /// Points (ε̄, σ_y) of `hardening table`.
    pub table: Vec<[f64; 2]>,
    /// The numbers, by [`Key`].
    pub numbers: [Option<f64>; Key::COUNT],
}

impl Sheet {
    /// The number of a key.
    pub fn get(&self, key: Key) -> Option<f64> {
        self.numbers[key as usize]
    }

    /// Gives a key its number.
    pub fn set(&mut self, key: Key, value: f64) {
        self.numbers[key as usize] = Some(value);
    }

    /// Converts all numbers: the factor of a quantity is what one unit of the sheet is in the new units.
    pub fn convert(&mut self, factor: impl Fn(Quantity) -> f64) {
        for key in Key::ALL {
            if let Some(value) = &mut self.numbers[key as usize] {
                *value *= factor(key.quantity());
            }
        }
        self.table.iter_mut().for_each(|point| point[1] *= factor(Quantity::Pressure));
    }

    /// The keys that are given, for laws that use none of them.
    pub fn given(&self) -> Vec<&'static str> {
        let choices = [
            ("elastic", self.elastic.is_some()),
            ("hardening", self.hardening.is_some()),
            ("table", !self.table.is_empty()),
        ];
        let choices = choices.into_iter().filter(|(_, given)| *given).map(|(key, _)| key);
        choices.chain(Key::ALL.into_iter().filter(|key| self.get(*key).is_some()).map(Key::name)).collect()
    }

    /// The first number that no matter has.
    ///
    /// # Errors
    /// Its key and why it is refused.
    pub fn plausible(&self) -> Result<(), Fault> {
        let given = Key::ALL.into_iter().filter_map(|key| Some((key, self.get(key)?)));
        for (key, value) in given {
            if let Some(why) = key.fault(value) {
                return refused(key.name(), format!("{} {why}", key.name()));
            }
        }
        let growing = self.table.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        let sound = self.table.iter().flatten().all(|x| x.is_finite());
        let positive = self.table.iter().all(|point| point[1] > 0.0);
        match self.table.first() {
            None => Ok(()),
            Some(first) if first[0] == 0.0 && growing && positive && sound => Ok(()),
            Some(_) => {
                refused("table", "table begins at strain 0, strains grow and stresses are positive".into())
            }
        }
    }

    /// The material with these elastic constants and this tensile strength, if it is given.
    ///
    /// # Errors
    /// A number is missing, is refused, or has no use in the law that the others make.
    pub fn material(&self, elastic: Elastic, tensile: Option<f64>) -> Result<Material, Fault> {
        self.plausible()?;
        let mut reading = Reading { sheet: self, tensile, used: [false; Key::COUNT], table: false };
        let (flow, brittle) = (reading.flow()?, self.get(Key::Gf).is_some());
        let law = match (flow, self.elastic.unwrap_or_default()) {
            (Some(flow), Strain::Hencky) => Law::Plastic { flow, damage: reading.damage()? },
            (None, Strain::Hencky) if brittle => Law::Brittle(reading.brittle()?),
            (Some(_), _) => return refused("elastic", "flow needs `elastic hencky`".into()),
            (None, _) if brittle => return refused("elastic", "damage needs `elastic hencky`".into()),
            (None, Strain::Hencky) => Law::Hencky,
            (None, Strain::NeoHooke) => Law::NeoHooke,
            (None, Strain::Linear) => Law::Linear,
        };
        reading.all_used()?;
        Ok(Material { elastic, law })
    }
}

/// A refusal.
fn refused<T>(key: &'static str, why: String) -> Result<T, Fault> {
    Err(Fault::Refused { key, why })
}

/// Takes numbers out of a sheet and keeps account of those with a use.
struct Reading<'a> {
    sheet: &'a Sheet,
    tensile: Option<f64>,
    used: [bool; Key::COUNT],
    table: bool,
}

impl Reading<'_> {
    /// A number that may be missing.
    fn may(&mut self, key: Key) -> Option<f64> {
        self.used[key as usize] = true;
        self.sheet.get(key)
    }

    /// A number that a law needs.
    fn need(&mut self, law: &'static str, key: Key) -> Result<f64, Fault> {
        self.may(key).ok_or(Fault::Missing { key: key.name(), law, example: key.example() })
    }

    /// The flow; `None`: elastic matter.
    fn flow(&mut self) -> Result<Option<Flow>, Fault> {
        let curve = self.sheet.hardening;
        let yields = self.sheet.get(Key::Yield).is_some();
        if self.sheet.get(Key::Cohesion).is_some() {
            if curve.is_some() || yields {
                let key = if yields { "yield" } else { "hardening" };
                return refused(
                    key,
                    format!("`cohesion` (Drucker-Prager) and `{key}` (Mises) are two flows: give one"),
                );
            }
            return self.cone().map(|cone| Some(Flow::DruckerPrager(cone)));
        }
        match (curve, yields) {
            (None, false) => Ok(None),
            (curve, _) => self.hardening(curve.unwrap_or(Curve::Perfect)).map(|h| Some(Flow::Mises(h))),
        }
    }

    /// The cone of Drucker and Prager.
    fn cone(&mut self) -> Result<DruckerPrager, Fault> {
        const LAW: &str = "flow of Drucker and Prager";
        let cohesion = self.need(LAW, Key::Cohesion)?;
        let (friction, dilation) = (self.need(LAW, Key::Phi)?, self.need(LAW, Key::Psi)?);
        if dilation > friction {
            return refused("psi", "psi must not exceed phi: flow would make energy".into());
        }
        Ok(DruckerPrager::from_angles(cohesion, self.may(Key::H).unwrap_or(0.0), friction, dilation))
    }

    /// The yield stress of Mises flow.
    fn hardening(&mut self, curve: Curve) -> Result<Hardening, Fault> {
        Ok(match curve {
            Curve::Perfect => {
                Hardening::Linear { yields: self.need("hardening perfect", Key::Yield)?, modulus: 0.0 }
            }
            Curve::Linear => {
                const LAW: &str = "hardening linear";
                Hardening::Linear { yields: self.need(LAW, Key::Yield)?, modulus: self.need(LAW, Key::H)? }
            }
            Curve::Voce => {
                const LAW: &str = "hardening voce";
                let (yields, saturation) = (self.need(LAW, Key::Yield)?, self.need(LAW, Key::SigmaInf)?);
                if saturation < yields {
                    return refused("sigma_inf", "sigma_inf must not be below yield".into());
                }
                let (exponent, modulus) = (self.need(LAW, Key::SmallB)?, self.may(Key::H).unwrap_or(0.0));
                Hardening::Voce { yields, saturation, exponent, modulus }
            }
            Curve::Swift => {
                const LAW: &str = "hardening swift";
                Hardening::Swift {
                    yields: self.need(LAW, Key::Yield)?,
                    strain: self.need(LAW, Key::Eps0)?,
                    exponent: self.need(LAW, Key::N)?,
                }
            }
            Curve::Table => {
                self.table = true;
                if self.sheet.table.is_empty() {
                    let example = "[[0.0, \"90 MPa\"], [0.1, \"230 MPa\"]]";
                    return Err(Fault::Missing { key: "table", law: "hardening table", example });
                }
                Hardening::Table(self.sheet.table.clone())
            }
            Curve::JohnsonCook => {
                const LAW: &str = "hardening johnson-cook";
                Hardening::JohnsonCook(JohnsonCook {
                    yields: self.need(LAW, Key::Yield)?,
                    modulus: self.need(LAW, Key::B)?,
                    exponent: self.need(LAW, Key::N)?,
                    rate: self.need(LAW, Key::C)?,
                    thermal: self.need(LAW, Key::M)?,
                    reference: self.reference(LAW)?,
                })
            }
        })
    }

    /// Where rate and temperature begin to act.
    fn reference(&mut self, law: &'static str) -> Result<Reference, Fault> {
        let temperature = self.need(law, Key::Tr)?;
        let reference =
            Reference { rate: self.need(law, Key::Rate0)?, temperature, melting: self.need(law, Key::Tm)? };
        match reference.melting > temperature {
            true => Ok(reference),
            false => refused("Tm", "Tm must be above Tr".into()),
        }
    }

    /// Damage; `None`: never.
    fn damage(&mut self) -> Result<Option<Damage>, Fault> {
        const LAW: &str = "damage of Johnson and Cook (D1 to D5)";
        const D: [Key; 5] = [Key::D1, Key::D2, Key::D3, Key::D4, Key::D5];
        let fracture = self.sheet.get(Key::EpsF);
        let onset = match (D.iter().any(|key| self.sheet.get(*key).is_some()), fracture) {
            (false, None) if self.sheet.get(Key::Gf).is_none() => return Ok(None),
            (false, None) => Onset::Stress(self.strength("softening without eps_f or D1 to D5")?),
            (true, Some(_)) => {
                return refused("eps_f", "eps_f and D1 to D5 both set when damage begins: give one".into());
            }
            (false, Some(strain)) => {
                self.used[Key::EpsF as usize] = true;
                Onset::Strain(strain)
            }
            (true, None) => {
                let mut d = [0.0; 5];
                for (d, key) in d.iter_mut().zip(D) {
                    *d = self.need(LAW, key)?;
                }
                Onset::JohnsonCook(FractureStrain { d, reference: self.reference(LAW)? })
            }
        };
        Ok(Some(Damage { onset, energy: self.need("softening by damage", Key::Gf)? }))
    }

    /// Damage of elastic matter.
    fn brittle(&mut self) -> Result<Brittle, Fault> {
        const LAW: &str = "softening of matter that does not flow";
        Ok(Brittle { strength: self.strength(LAW)?, energy: self.need(LAW, Key::Gf)? })
    }

    /// The tensile strength, which a law needs.
    fn strength(&self, law: &'static str) -> Result<f64, Fault> {
        self.tensile.ok_or(Fault::Missing { key: "ft", law, example: "\"3 MPa\"" })
    }

    /// Refuses what has no use.
    fn all_used(&self) -> Result<(), Fault> {
        let law = match (self.sheet.hardening, self.sheet.get(Key::Cohesion)) {
            (Some(curve), _) => {
                let name =
                    Curve::NAMES.iter().find(|(_, known)| *known == curve).map_or("", |(name, _)| name);
                format!("`hardening {name}`")
            }
            (None, Some(_)) => "flow of Drucker and Prager".into(),
            (None, None) if self.sheet.get(Key::Yield).is_some() => {
                "a yield stress without `hardening`".into()
            }
            (None, None) => "matter without `yield`, `hardening` or `cohesion`".into(),
        };
        let unused =
            Key::ALL.into_iter().find(|key| self.sheet.get(*key).is_some() && !self.used[*key as usize]);
        match unused.map(Key::name).or((!self.sheet.table.is_empty() && !self.table).then_some("table")) {
            Some(key) => refused(key, format!("{law} does not use `{key}`")),
            None => Ok(()),
        }
    }
}
