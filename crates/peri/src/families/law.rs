//! The law of all families of a scene: which, with the moduli of types.

use crate::cauchy::site::Rules;
use crate::families::options::FamilyOptions;
use crate::families::table::PmbTable;
use crate::families::view::PeriView;
use crate::law::material::{Influence, Moduli};
use crate::law::moment::{Held, Moment};
use crate::law::settle::Settling;
use crate::law::site::Stiffness;
use crate::law::table::{LawKind, SHAPED};
use crate::list::kernel::Counting;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_constitutive::Material;

/// The law of all families of a scene.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Law {
    /// Which.
    pub kind: LawKind,
    /// How bonds of different lengths count.
    pub influence: Influence,
    /// Moduli by type − 1.
    pub moduli: Vec<Moduli>,
    /// What sites of each type − 1 are made of, under correspondence.
    pub materials: Vec<Option<Material>>,
    /// How stiff what no deformation gradient says of bonds is, over 15G/m: g of node control.
    pub control: f64,
    /// Stretches below which bonds flow or beyond which they soften, by pair of types (row by row); empty where none do.
    pub yields: Vec<f64>,
    /// Bonds that are shaped are stiffer near surfaces (`peri_modify surface energy`).
    pub surface: bool,
    /// The time step of the last force evaluation: relaxation depends on it.
    pub dt: f64,
    /// Temperatures of particles in the last force evaluation; empty where they have no effect.
    #[serde(skip)]
    pub temperature: Vec<f64>,
    /// Sites are looked at as they are: nothing flows.
    #[serde(skip)]
    pub frozen: bool,
    /// Energies asked for are those that damage of softening bonds has taken.
    #[serde(skip)]
    pub lost: bool,
}

impl Law {
    /// The (negative) stretch at which bonds between two types begin to flow, or the one beyond which they soften.
    pub fn yields(&self, a: u16, b: u16) -> f64 {
        let types = self.moduli.len();
        let place = (usize::from(a) - 1) * types + usize::from(b) - 1;
        self.yields.get(place).copied().unwrap_or(f64::NEG_INFINITY)
    }

    /// How bonds count for their length in forces: under the plain microelastic law all alike.
    pub fn shape(&self) -> Influence {
        if self.kind.plain() { Influence::One } else { self.influence }
    }

    /// How bonds kept as a list count.
    pub(crate) fn counting(&self) -> Counting {
        Counting {
            influence: self.shape(),
            microelastic: self.kind.bond_based,
            limited: self.kind.about(false).limited,
        }
    }

    /// What a bond adds to both families' weights, over the partner's volume: of the weighted volume ω w |xi|², or where
    /// bonds are microelastic of Σ c w |xi| V/c, which a solid of the same modulus has as πδ⁴ (its energy at an even
    /// growth, 9/2 K ε² = ¼ ε² Σ c w |xi| V).
    pub fn weight(&self, length: f64, delta: f64, volume: f64) -> f64 {
        match self.kind.bond_based {
            true => self.influence.shape(length, delta) * volume * length,
            false => self.influence.of(length, delta) * volume * length * length,
        }
    }

    /// Whether bonds of one kind differ: in how they count for their length, near surfaces, or as factors of particles say. Then each end
    /// has a stiffness of its own, and the plain microelastic law gives way to one that reads it.
    pub fn shape_bonds(&mut self) {
        if self.kind.plain() {
            self.kind = SHAPED;
        }
    }

    /// The law in the form that its types need: one memory for both ends of a bond serves only where all relax alike.
    /// What bonds remember `before`, the law of families that are there, cannot turn into something else.
    ///
    /// # Errors
    /// Types that relax differently where bonds remember one number.
    pub fn shared_or_apart(&mut self, before: Option<&Law>) -> Result<()> {
        let Some(other) = self.kind.apart.and_then(LawKind::named) else { return Ok(()) };
        let mut viscous = self.moduli.iter().filter(|m| m.tau > 0.0).map(|m| (m.lambda, m.tau));
        let first = viscous.next();
        let apart = viscous.any(|own| Some(own) != first);
        if apart && before.is_some_and(|law| law.kind == self.kind) {
            let text = "all types relaxed alike at the first run: they cannot relax differently now";
            return Err(Diagnostic::error(Code::WRONG_ORDER, None, text)
                .help(
                    "give types their own lambda and tau before the first run; their values may change then",
                )
                .into());
        }
        if apart || before.is_some_and(|law| law.kind == other) {
            self.kind = other;
        }
        Ok(())
    }

    /// The moment of an evaluation: a step if it advances, else a look at what is. The form in which a body's bonds have
    /// remembered is the body's own.
    pub(crate) fn moment(&self, advance: bool) -> Moment {
        // One law has one relaxation; where types relax differently, columns of sites have it.
        let own = self.moduli.iter().find(|m| m.tau > 0.0).copied().unwrap_or_default();
        let (decay, fresh) = left(own.tau, self.dt, advance);
        Moment {
            decay,
            fresh,
            lambda: own.lambda,
            flow: if advance { 1.0 } else { 0.0 },
            held: Held::default(),
            hold: Held::for_steps(decay, fresh),
            lost: self.lost,
            mended: false,
        }
    }

    /// What turns sums into columns in an evaluation in which bonds flow and relax (`acts`) and keep that (`keep`) or not, which is tallied or
    /// not, with losses counted or not.
    pub(crate) fn settling(
        &self,
        table: &PmbTable,
        options: &FamilyOptions,
        (acts, keep): (bool, bool),
        (tallied, counts): (bool, bool),
    ) -> Settling {
        let types = 1..=if self.kind.has_states() { table.types() as u16 } else { 0 };
        let of = |kind: u16| {
            let (m, horizon) = (self.of(kind), table.get(kind, kind).map(|c| c.horizon));
            let fifth = horizon.unwrap_or(1.0).powi(5);
            Stiffness {
                bulk: 3.0 * m.bulk,
                shear: 15.0 * m.shear,
                yield_stress: m.yield_stress,
                limit: 2.0 * 25.0 * m.yield_stress * m.yield_stress / (8.0 * std::f64::consts::PI * fifth),
                horizon: horizon.unwrap_or(0.0),
                lambda: m.lambda,
                left: left(m.tau, self.dt, acts),
            }
        };
        Settling {
            stiffness: types.map(of).collect(),
            surface: self.surface,
            moment: Moment { mended: options.mended, ..self.moment(acts) },
            compat: options.compat_lammps,
            advance: acts,
            keep,
            tallied,
            counted: counts && keep,
        }
    }

    /// What settles sites under correspondence.
    pub(crate) fn rules<'a>(&'a self, view: &PeriView<'a>) -> Rules<'a> {
        Rules {
            materials: &self.materials,
            control: self.control,
            dt: self.dt,
            volume: view.volume,
            temperature: &self.temperature,
            frozen: self.frozen,
        }
    }

    /// The moduli of a type.
    pub fn of(&self, kind: u16) -> Moduli {
        self.moduli.get(usize::from(kind) - 1).copied().unwrap_or_default()
    }
}

/// What is left of a Maxwell element's stretch after a step, and of the stretch that comes evenly during the step.
fn left(tau: f64, dt: f64, advance: bool) -> (f64, f64) {
    let steps = if dt > 0.0 { tau / dt } else { f64::INFINITY };
    if !advance || !steps.is_finite() || steps <= 0.0 {
        return (1.0, 1.0);
    }
    let decay = (-1.0 / steps).exp();
    (decay, steps * (1.0 - decay))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_without_moduli_have_none() {
        let law = Law { moduli: vec![Moduli { bulk: 2.0, ..Moduli::default() }], ..Law::default() };
        assert_eq!((law.of(1).bulk, law.of(2).bulk), (2.0, 0.0));
    }
}
