//! Normal forces: one file per law, one table of the words in decks.
//!
//! A law is a type with [`NormalLaw`], written once for single contacts and for lanes of them; a [`Style`] is
//! the word, its parameters, and the construction of the law for two types. Everything else (reading decks,
//! mixing, help pages, pairs, walls, histories) uses the table at the end of this file.

mod dmt;
mod eepa;
mod hertz;
mod hooke;
mod hooke_hysteresis;
mod hooke_velocity;
mod jkr;
mod mdr;
mod nothing;
mod style;

#[cfg(test)]
use crate::tests::new_law;

pub use mdr::{grain as plastic_grain, material as plastic};
pub use style::{
    Bound, MOST, Mixed, Normal, Number, Numbers, Role, Style, effective_shear, effective_young, geometric,
};

use super::{Geometry, Real};
use std::fmt::Debug;

/// The normal force of one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push<R> {
    /// Elastic and cohesive force on i, positive for repulsion.
    pub force: R,
    /// The stiffness that damping models use, F/δ of loading [force/length].
    pub secant: R,
    /// Addition to the normal load for friction, for cohesive laws (unused otherwise): the friction of
    /// cohesive grains counts from the pull-off force (Thornton 1991).
    pub hold: R,
}

/// The normal force between grains of two types.
pub trait NormalLaw: Copy + Debug + PartialEq {
    /// Whether [`NormalLaw::push`] needs the contact radius.
    const BY_RADIUS: bool = true;
    /// Whether the normal load for friction is the force plus [`Push::hold`] instead of the damped force.
    const STICKS: bool = false;
    /// Whether the force is computed elsewhere and read from the history.
    const IS_PRECOMPUTED: bool = false;
    /// Whether the stiffness depends on the effective mass.
    const BY_MASS: bool = false;
    /// Whether the work of the force apart from [`NormalLaw::energy`] is plastic flow and new surface, which
    /// the energy ledger records as such.
    const FLOWS: bool = false;
    /// Size of its history; it begins with zeros and is the same seen from j.
    const MEMORY: usize = 0;

    /// The contact radius, √(R̄ δ).
    #[inline(always)]
    fn radius<R: Real>(&self, g: &Geometry<R>) -> R {
        (g.curvature * g.overlap).sqrt()
    }

    /// The force of a contact of radius `a`; updates its history.
    fn push<R: Real>(&self, g: &Geometry<R>, a: R, memory: &mut [R]) -> Push<R>;

    /// Energy that the contact can return: ∫ F dδ from first touch if the force depends on δ alone [energy].
    fn energy(&self, g: &Geometry, memory: &[f64]) -> f64;

    /// dF/dδ [force/length]; for laws with several branches that of the steepest.
    fn tangent(&self, g: &Geometry) -> f64 {
        let small = 1e-6 * g.overlap.abs();
        if small == 0.0 {
            return 0.0;
        }
        let at = |overlap: f64| {
            let g = Geometry { overlap, ..*g };
            let mut memory = vec![0.0; Self::MEMORY];
            self.push(&g, self.radius(&g), &mut memory).force
        };
        (at(g.overlap + small) - at(g.overlap - small)) / (2.0 * small)
    }

    /// The gap at which an existing contact breaks [length].
    fn gap(&self, _curvature: f64) -> f64 {
        0.0
    }

    /// k and n of an upper bound k δⁿ of the force at this effective radius and mass, from which the time step is
    /// estimated; `None` without a force.
    fn power_law(&self, curvature: f64, mass: f64) -> Option<[f64; 2]>;
}

macro_rules! normal_laws {
    ($($module:ident::$Law:ident: $($STYLE:ident),+;)*) => {
        /// The normal law of one pair of types: one of the table.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Force {
            $(#[doc = concat!("See `", stringify!($module), ".rs`.")] $Law($module::$Law),)*
        }

        $(impl From<$module::$Law> for Force {
            fn from(law: $module::$Law) -> Self {
                Self::$Law(law)
            }
        })*

        $(pub use $module::{$($STYLE),+};)*

        /// All words, in the order of the help page.
        pub const STYLES: &[&Style] = &[$($(&$module::$STYLE),+),*];

        impl Force {
            /// See [`NormalLaw::BY_RADIUS`].
            #[inline(always)]
            pub fn by_radius(&self) -> bool {
                match self { $(Self::$Law(_) => $module::$Law::BY_RADIUS,)* }
            }

            /// See [`NormalLaw::STICKS`].
            #[inline(always)]
            pub fn sticks(&self) -> bool {
                match self { $(Self::$Law(_) => $module::$Law::STICKS,)* }
            }

            /// See [`NormalLaw::IS_PRECOMPUTED`].
            pub fn is_precomputed(&self) -> bool {
                match self { $(Self::$Law(_) => $module::$Law::IS_PRECOMPUTED,)* }
            }

            /// See [`NormalLaw::BY_MASS`].
            pub fn by_mass(&self) -> bool {
                match self { $(Self::$Law(_) => $module::$Law::BY_MASS,)* }
            }

            /// See [`NormalLaw::FLOWS`].
            pub fn flows(&self) -> bool {
                match self { $(Self::$Law(_) => $module::$Law::FLOWS,)* }
            }

            /// See [`NormalLaw::MEMORY`].
            #[inline(always)]
            pub fn memory(&self) -> usize {
                match self { $(Self::$Law(_) => $module::$Law::MEMORY,)* }
            }

            /// See [`NormalLaw::radius`].
            #[inline(always)]
            pub fn radius<R: Real>(&self, g: &Geometry<R>) -> R {
                match self { $(Self::$Law(law) => law.radius(g),)* }
            }

            /// See [`NormalLaw::push`].
            #[inline(always)]
            pub fn push<R: Real>(&self, g: &Geometry<R>, a: R, memory: &mut [R]) -> Push<R> {
                match self { $(Self::$Law(law) => law.push(g, a, memory),)* }
            }

            /// See [`NormalLaw::energy`].
            pub fn energy(&self, g: &Geometry, memory: &[f64]) -> f64 {
                match self { $(Self::$Law(law) => law.energy(g, memory),)* }
            }

            /// See [`NormalLaw::tangent`].
            pub fn tangent(&self, g: &Geometry) -> f64 {
                match self { $(Self::$Law(law) => law.tangent(g),)* }
            }

            /// See [`NormalLaw::gap`].
            pub fn gap(&self, curvature: f64) -> f64 {
                match self { $(Self::$Law(law) => law.gap(curvature),)* }
            }

            /// See [`NormalLaw::power_law`].
            pub fn power_law(&self, curvature: f64, mass: f64) -> Option<[f64; 2]> {
                match self { $(Self::$Law(law) => law.power_law(curvature, mass),)* }
            }
        }
    };
}

/// The table, with further lines at its end.
macro_rules! table {
    ($($more:tt)*) => {
        normal_laws! {
            nothing::Nothing: NONE;
            hooke::Hooke: HOOKE;
            hooke_velocity::HookeVelocity: HOOKE_VELOCITY;
            hooke_hysteresis::HookeHysteresis: HOOKE_HYSTERESIS;
            hertz::Hertz: HERTZ, HERTZ_MATERIAL;
            dmt::Dmt: DMT;
            jkr::Jkr: JKR;
            mdr::Mdr: MDR;
            eepa::Eepa: EEPA;
            $($more)*
        }
    };
}

#[cfg(not(test))]
table! {}
// What a law costs is tested with one that only tests have.
#[cfg(test)]
table! { new_law::Quadratic: QUADRATIC; }
