//! Forces along the normal: one file for each law, one table of the words that decks use.
//!
//! A law is a type with [`NormalLaw`], written once for single contacts and for lanes of them; a [`Style`] is the word, the
//! numbers behind it and how the law of two types comes of those of each. Everything else (reading decks, mixing, help
//! pages, pairs, walls, memory) goes by the table at the end of this file.

mod dmt;
mod eepa;
mod hertz;
mod hooke;
mod jkr;
mod mdr;
mod nothing;
mod style;

pub use mdr::{grain as plastic_grain, material as plastic};
pub use style::{
    Bound, Mixed, Normal, Number, Numbers, Role, Style, effective_shear, effective_young, geometric,
};

use super::{Geometry, Real};
use std::fmt::Debug;

/// The force of one contact along the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push<R> {
    /// Elastic and cohesive force on i, positive apart.
    pub force: R,
    /// The stiffness that damping models see, F/δ of loading [force/length].
    pub secant: R,
    /// What counts for friction besides the force, of laws that stick (else nobody asks): friction of grains that stick
    /// together counts from where they would let go (Thornton 1991).
    pub hold: R,
}

/// The force along the normal between grains of two types.
pub trait NormalLaw: Copy + Debug + PartialEq {
    /// Whether [`NormalLaw::push`] asks for the radius of the contact.
    const BY_RADIUS: bool = true;
    /// Whether friction counts from the force and [`Push::hold`], not from the damped force.
    const STICKS: bool = false;
    /// Whether contacts remember the force that somebody has told them.
    const IS_TOLD: bool = false;
    /// Whether what the force takes besides [`NormalLaw::energy`] is flow and torn surfaces, which the ledger books as such.
    const FLOWS: bool = false;
    /// How many numbers a contact remembers for it; they begin as zeros and are the same seen from j.
    const MEMORY: usize = 0;

    /// The radius of the area of contact, √(R̄ δ).
    #[inline(always)]
    fn radius<R: Real>(&self, g: &Geometry<R>) -> R {
        (g.curvature * g.overlap).sqrt()
    }

    /// The force of a contact of radius `a`; what it remembers moves on.
    fn push<R: Real>(&self, g: &Geometry<R>, a: R, memory: &mut [R]) -> Push<R>;

    /// What the contact can give back, ∫ F dδ from touch on where the force is one of δ alone [energy].
    fn energy(&self, g: &Geometry, memory: &[f64]) -> f64;

    /// dF/dδ [force/length]; of laws with several branches that of the steepest.
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

    /// How far the surfaces of an existing contact come apart before it breaks [length].
    fn gap(&self, _curvature: f64) -> f64 {
        0.0
    }

    /// k and n of a force that grows about as k δⁿ, the stiffest there is, from which the time step is judged; `None`
    /// without a force.
    fn power_law(&self, curvature: f64) -> Option<[f64; 2]>;
}

macro_rules! normal_laws {
    ($($module:ident::$Law:ident: $($STYLE:ident),+;)*) => {
        /// The law along the normal of one pair of types: one of the table.
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

        /// All words that decks use, in the order of the help page.
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

            /// See [`NormalLaw::IS_TOLD`].
            pub fn is_told(&self) -> bool {
                match self { $(Self::$Law(_) => $module::$Law::IS_TOLD,)* }
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
            pub fn power_law(&self, curvature: f64) -> Option<[f64; 2]> {
                match self { $(Self::$Law(law) => law.power_law(curvature),)* }
            }
        }
    };
}

normal_laws! {
    nothing::Nothing: NONE;
    hooke::Hooke: HOOKE;
    hertz::Hertz: HERTZ, HERTZ_MATERIAL;
    dmt::Dmt: DMT;
    jkr::Jkr: JKR;
    mdr::Mdr: MDR;
    eepa::Eepa: EEPA;
}
