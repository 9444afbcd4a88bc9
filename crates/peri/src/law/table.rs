//! The laws of bonds: one file and one line each.

use crate::law::style::Style;
use crate::law::{cauchy, eps, lps, nonlinear, plastic, pmb, shaped, softening, ves};
use std::ops::Deref;

/// Which law the bonds of a scene have; in restart files its number.
#[derive(Clone, Copy, Debug)]
pub struct LawKind(&'static Style);

macro_rules! bond_laws {
    ($($module:ident::$STYLE:ident;)*) => {
        $(#[doc = concat!("See `", stringify!($module), ".rs`.")] pub const $STYLE: LawKind = LawKind(&$module::$STYLE);)*

        /// All laws that scenes have by name.
        pub const LAWS: &[LawKind] = &[$($STYLE),*];
    };
}

bond_laws! {
    pmb::PMB;
    shaped::SHAPED;
    plastic::PLASTIC;
    nonlinear::NONLINEAR;
    softening::LINEAR;
    softening::EXPONENTIAL;
    lps::LPS;
    ves::VES;
    ves::VES_APART;
    eps::EPS;
    cauchy::CAUCHY;
}

impl LawKind {
    /// What it is like.
    pub fn style(self) -> &'static Style {
        self.0
    }

    /// The law of the table with this name.
    pub fn named(name: &str) -> Option<Self> {
        LAWS.iter().copied().find(|law| law.name == name)
    }

    /// The law of the table whose bonds unload as this word says.
    pub fn unloading_as(word: &str) -> Option<Self> {
        LAWS.iter().copied().find(|law| law.unloading == Some(word))
    }
}

impl From<&'static Style> for LawKind {
    /// Any law, also one that is not in the table.
    fn from(style: &'static Style) -> Self {
        Self(style)
    }
}

impl Default for LawKind {
    fn default() -> Self {
        PMB
    }
}

impl Deref for LawKind {
    type Target = Style;
    fn deref(&self) -> &Style {
        self.0
    }
}

impl PartialEq for LawKind {
    fn eq(&self, other: &Self) -> bool {
        self.number == other.number && self.name == other.name
    }
}

impl Eq for LawKind {}

impl serde::Serialize for LawKind {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_u32(self.number)
    }
}

impl<'de> serde::Deserialize<'de> for LawKind {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let number = u32::deserialize(from)?;
        let law = LAWS.iter().copied().find(|law| law.number == number);
        law.ok_or_else(|| {
            serde::de::Error::custom(format!("there is no law of bonds with the number {number}"))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers are those of restart files that exist.
    #[test]
    fn numbers_and_names_are_of_one_law_each() {
        let known = ["pmb", "lps", "ves", "eps", "plastic", "nonlinear", "shaped", "ves/apart"];
        let known = known.into_iter().chain(["softening/linear", "softening/exponential", "cauchy"]);
        for (number, name) in known.enumerate() {
            assert_eq!(LawKind::named(name).map(|law| law.number as usize), Some(number));
        }
        for (k, law) in LAWS.iter().enumerate() {
            assert!(LAWS[..k].iter().all(|other| other.number != law.number && other.name != law.name));
            assert!(law.apart.is_none_or(|name| LawKind::named(name).is_some()));
        }
    }
}
