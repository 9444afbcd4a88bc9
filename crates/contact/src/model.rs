//! What a deck says about contacts of one type, and the law that the models of two types make together.

use super::normal::geometric;
use super::slider::Sync;
use super::tangential::{Drag, Friction, Spring};
use super::turning::{Rolling, Twisting};
use super::{Damping, Granular, Heat, Normal, Tangential, normal};
use perigrain_world::Compat;

/// Where the tangential force takes hold of the spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arm {
    /// In the middle of the overlap: R − δ/2.
    #[default]
    Middle,
    /// At the full radius, as `pair_style gran/*` has it.
    Radius,
    /// At the point of a peridynamic solid, which does not turn: the grain's arm is all of the distance, and the point has none.
    Point,
}

/// What a deck says about contacts of one pair of types.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// Along the normal.
    pub normal: Normal,
    /// Dissipation along the normal.
    pub damping: Damping,
    /// Across the normal.
    pub tangential: Tangential,
    /// Against rolling.
    pub rolling: Rolling,
    /// Against twisting.
    pub twisting: Twisting,
    /// Conduction of heat.
    pub heat: Heat,
    /// `limit_damping`: the normal force never pulls.
    pub limit_damping: bool,
    /// Lever arms of the tangential force.
    pub arm: Arm,
    /// `synchronized_verlet`: springs turn with the normal of the middle of the step.
    pub synchronized: bool,
}

/// Two models of different kinds cannot be mixed: which words differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unmixable(pub &'static str, pub &'static str);

/// The numbers of `pair_style gran/*` and `fix wall/gran hooke|hooke/history|hertz/history`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Classic {
    /// Normal and tangential stiffness [force/length; pressure for `hertz`].
    pub stiffness: [f64; 2],
    /// Normal and tangential damping [1/time; 1/(time length) for `hertz`].
    pub gamma: [f64; 2],
    /// Coefficient of friction.
    pub mu: f64,
    /// Whether the normal force never pulls.
    pub limit_damping: bool,
    /// Where friction takes hold.
    pub arm: Arm,
}

impl Model {
    /// A model that resists neither rolling nor twisting.
    pub fn new(normal: Normal, damping: Damping, tangential: Tangential) -> Self {
        Self {
            normal,
            damping,
            tangential,
            rolling: Rolling::None,
            twisting: Twisting::None,
            heat: Heat::None,
            limit_damping: false,
            arm: Arm::Middle,
            synchronized: false,
        }
    }

    /// `hooke`, `hooke/history` or `hertz/history` of the older styles: mass-proportional damping, springs projected
    /// into the tangent plane, full lever arms unless said otherwise.
    pub fn classic(hertz: bool, history: bool, c: &Classic) -> Self {
        let [stiffness, kt] = c.stiffness;
        let [eta, gamma_t] = c.gamma;
        let (style, damping, spring) = if hertz {
            (&normal::HERTZ, Damping::Viscoelastic, Friction::MindlinClassic)
        } else {
            (&normal::HOOKE, Damping::MassVelocity, Friction::LinearHistoryClassic)
        };
        let normal = Normal::new(style, &[stiffness, eta]);
        let kind = if history { spring } else { Friction::LinearNohistory };
        let tangential = Tangential { kind, stiffness: Some(kt), drag: Drag::Own(gamma_t), mu: c.mu };
        Self { limit_damping: c.limit_damping, arm: c.arm, ..Self::new(normal, damping, tangential) }
    }

    /// Whether its spring is one of those that LAMMPS 22Jul2025 shortens wrongly when they slide.
    pub fn slides_loosely(&self) -> bool {
        let Tangential { kind, drag, .. } = self.tangential;
        matches!(kind, Friction::LinearHistoryClassic | Friction::MindlinClassic)
            && matches!(drag, Drag::Times(_))
    }

    /// The law for a pair of types whose model was given.
    pub fn law(&self, compat: Compat) -> Granular {
        self.pair(self, false, compat)
    }

    /// The law for a pair of types of which only the like pairs were given, by LAMMPS' rules: geometric means,
    /// moduli as E* and G*, `limit_damping` and `synchronized_verlet` if either has it.
    ///
    /// # Errors
    /// When the models are not of one kind.
    pub fn mixed(&self, other: &Model, compat: Compat) -> Result<Granular, Unmixable> {
        for (a, b) in self.names().into_iter().zip(other.names()) {
            if a != b {
                return Err(Unmixable(a, b));
            }
        }
        if self.arm != other.arm {
            return Err(Unmixable("arms middle", "arms point"));
        }
        if let Some(number) = self.normal.unlike(&other.normal) {
            return Err(Unmixable(number, number));
        }
        Ok(self.pair(other, true, compat))
    }

    fn names(&self) -> [&'static str; 6] {
        let m = self;
        [
            m.normal.name(),
            m.damping.name(),
            m.tangential.name(),
            m.rolling.name(),
            m.twisting.name(),
            m.heat.name(),
        ]
    }

    fn pair(&self, other: &Model, mixed: bool, compat: Compat) -> Granular {
        let eta = geometric(self.normal.eta(), other.normal.eta());
        let eta = self.damping.constant(eta, self.normal.exponent(), compat);
        let normals = [&self.normal, &other.normal];
        let normal = self.normal.force(&other.normal);
        let twisting = self.twisting.mixed(&other.twisting);
        let sync = match compat {
            _ if !(self.synchronized || other.synchronized) => Sync::Off,
            Compat::Lammps2025 => Sync::Lammps2025,
            _ => Sync::Both,
        };
        let spring = self.tangential.spring(&other.tangential, normals, (self.damping, eta), mixed, compat);
        let spring = Spring { sync, ..spring };
        let by_radius = normal.by_radius()
            || self.damping.by_radius()
            || spring.by_radius()
            || twisting == Twisting::Marshall;
        Granular {
            normal,
            damping: self.damping,
            damping_constant: eta,
            limit_damping: self.limit_damping || other.limit_damping,
            spring,
            rolling: self.rolling.mixed(&other.rolling),
            twisting,
            heat: self.heat.mixed(&other.heat),
            arm: self.arm,
            by_radius,
            rubs_pulling: compat.lammps(),
            compat,
        }
    }
}
