//! Contact models of one type as declared in a deck, and the law for a pair of types.

use super::normal::geometric;
use super::slider::{Slip, Sync};
use super::tangential::{Drag, Friction, Spring};
use super::turning::{Rolling, Twisting};
use super::{Cohesion, Damping, Granular, Heat, Normal, Tangential, normal};
use perigrain_world::Compat;

/// Lever arm of the tangential force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arm {
    /// In the middle of the overlap: R − δ/2.
    #[default]
    Middle,
    /// At the full radius, as in `pair_style gran/*`.
    Radius,
    /// At the point of a peridynamic solid, which does not rotate: the grain's arm is the whole distance, the
    /// point's is zero.
    Point,
}

/// The contact model of a pair of types as declared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// Normal force.
    pub normal: Normal,
    /// Normal damping.
    pub damping: Damping,
    /// Tangential force.
    pub tangential: Tangential,
    /// Rolling resistance.
    pub rolling: Rolling,
    /// Twisting resistance.
    pub twisting: Twisting,
    /// Cohesion by the area of contact.
    pub cohesion: Cohesion,
    /// Heat conduction.
    pub heat: Heat,
    /// `limit_damping`: the normal force without cohesion is never attractive.
    pub limit_damping: bool,
    /// Lever arms of the tangential force.
    pub arm: Arm,
    /// `synchronized_verlet`: springs rotate with the normal in the middle of the step.
    pub synchronized: bool,
}

/// The words of two models that differ, so that the models cannot be mixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unmixable(pub &'static str, pub &'static str);

/// The parameters of `pair_style gran/*` and `fix wall/gran hooke|hooke/history|hertz/history`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Classic {
    /// Normal and tangential stiffness [force/length; pressure for `hertz`].
    pub stiffness: [f64; 2],
    /// Normal and tangential damping [1/time; 1/(time length) for `hertz`].
    pub gamma: [f64; 2],
    /// Coefficient of friction.
    pub mu: f64,
    /// Whether the normal force is never attractive.
    pub limit_damping: bool,
    /// Lever arm of friction.
    pub arm: Arm,
}

impl Model {
    /// No force at all.
    pub fn none() -> Self {
        Self::new(Normal::new(&normal::NONE, &[]), Damping::None, Tangential::SMOOTH)
    }

    /// A model without rolling and twisting resistance.
    pub fn new(normal: Normal, damping: Damping, tangential: Tangential) -> Self {
        Self {
            normal,
            damping,
            tangential,
            rolling: Rolling::None,
            twisting: Twisting::None,
            cohesion: Cohesion::None,
            heat: Heat::None,
            limit_damping: false,
            arm: Arm::Middle,
            synchronized: false,
        }
    }

    /// `hooke`, `hooke/history` or `hertz/history` of the older styles: mass-proportional damping, springs
    /// projected into the tangent plane, full lever arms by default.
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
        let tangential =
            Tangential { drag: Drag::Own(gamma_t), ..Tangential::new(kind, Some(kt), 0.0, c.mu) };
        Self { limit_damping: c.limit_damping, arm: c.arm, ..Self::new(normal, damping, tangential) }
    }

    /// Whether LAMMPS 22Jul2025 shortens its spring incorrectly when it slides.
    pub fn slides_loosely(&self) -> bool {
        let Tangential { kind, drag, .. } = self.tangential;
        matches!(kind, Friction::LinearHistoryClassic | Friction::MindlinClassic)
            && matches!(drag, Drag::Times(_))
    }

    /// The law for a pair of types whose model was declared.
    pub fn law(&self, compat: Compat) -> Granular {
        self.pair(self, false, compat)
    }

    /// The law for a declared pair of types of which the second has the material of `other`.
    pub fn beside(&self, other: &Model, compat: Compat) -> Granular {
        self.pair(other, false, compat)
    }

    /// The law for an undeclared pair of different types, by LAMMPS' mixing rules: geometric means, moduli as
    /// E* and G*, `limit_damping` and `synchronized_verlet` if either model has it.
    ///
    /// # Errors
    /// Models of different kinds.
    pub fn mixed(&self, other: &Model, compat: Compat) -> Result<Granular, Unmixable> {
        for (a, b) in self.names().into_iter().zip(other.names()) {
            if a != b {
                return Err(Unmixable(a, b));
            }
        }
        let unlike = self.words().into_iter().zip(other.words()).find(|(a, b)| a != b);
        if let Some((a, b)) = unlike {
            return Err(Unmixable(a, b));
        }
        if self.arm != other.arm {
            return Err(Unmixable("arms middle", "arms point"));
        }
        if let Some(number) = self.normal.unlike(&other.normal) {
            return Err(Unmixable(number, number));
        }
        Ok(self.pair(other, true, compat))
    }

    /// Words behind the models that must be the same for mixing.
    fn words(&self) -> [&'static str; 5] {
        let Tangential { of_normal, slip, drag, .. } = &self.tangential;
        [
            if *slip == Slip::Spring { "slip spring" } else { "slip whole" },
            if *of_normal { "kt as a ratio" } else { "kt as a number" },
            if *drag == Drag::Matched { "x_gamma NULL" } else { "x_gamma as a number" },
            if self.rolling.is_full() { "rolling … full" } else { "rolling without full" },
            self.cohesion.detail(),
        ]
    }

    /// Names of the models.
    fn names(&self) -> [&'static str; 7] {
        let m = self;
        [
            m.normal.name(),
            m.damping.name(),
            m.tangential.name(),
            m.rolling.name(),
            m.twisting.name(),
            m.cohesion.name(),
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
        let spring =
            self.tangential.spring(&other.tangential, normals, (self.damping, eta), &normal, mixed, compat);
        let spring = Spring { sync, ..spring };
        let rolling = self.rolling.mixed(&other.rolling).gripping(spring.grip(normals));
        let by_radius = normal.by_radius()
            || self.damping.by_radius()
            || spring.by_radius()
            || rolling.by_radius()
            || twisting == Twisting::Marshall;
        Granular {
            normal,
            damping: self.damping,
            damping_constant: eta,
            limit_damping: self.limit_damping || other.limit_damping,
            spring,
            rolling,
            twisting,
            cohesion: self.cohesion.mixed(&other.cohesion),
            heat: self.heat.mixed(&other.heat),
            arm: self.arm,
            by_radius,
            is_on_wall: false,
            rubs_pulling: compat.lammps() || spring.slip == Slip::Spring,
            compat,
        }
    }
}
