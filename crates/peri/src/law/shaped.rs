//! `shaped`: microelastic bonds whose micro-modulus depends on their length, on how near the surface is or on factors of particles. The
//! formula is that of [`Elastic`] with A = 0 and for B half of each end's stiffness.

use crate::law::lps::Elastic;
use crate::law::style::Style;

/// What scenes take in the place of `pmb` where bonds differ.
pub static SHAPED: Style = Style { bond_based: true, stiffened: true, ..Style::of::<Elastic>("shaped", 6) };
