//! Bond styles: forces along bonds between particles.

mod bpm_beam;
pub mod bpm_peri;
mod bpm_rotational;
mod bpm_spring;
mod driver;
mod harmonic;
mod hybrid;
mod options;
mod zero;

use perigrain_base::diag::{Code, Diagnostic, Result, Span};
pub use perigrain_styles::bond::{BondForce, BondStyle};
pub use perigrain_styles::pull::{Pull, Stretched, apart};
use perigrain_world::World;

/// Every bond style.
#[rustfmt::skip]
pub const BONDS: &[&dyn BondStyle] = &[
    &bpm_beam::BpmBeam,
    &bpm_peri::BpmPeri,
    &bpm_rotational::BpmRotational,
    &bpm_spring::BpmSpring,
    &harmonic::HarmonicStyle,
    &hybrid::Hybrid,
    &zero::ZeroStyle,
];

/// Bonds that break need weights of bonded pairs that can be taken back: no pair forces between those joined, or with
/// `overlay` all of them.
///
/// # Errors
/// Other weights.
fn breaking_weights(w: &World, overlay: bool, span: Span) -> Result<()> {
    let lj = if overlay { [1.0; 3] } else { [0.0, 1.0, 1.0] };
    if w.bonds.weights.lj == lj && w.bonds.weights.coul == [1.0; 3] {
        return Ok(());
    }
    let wanted = if overlay { "lj/coul 1 1 1" } else { "lj 0 1 1 coul 1 1 1" };
    let d = Diagnostic::error(Code::CONFLICT, span, "bonds that break need other weights of bonded pairs");
    Err(d.help(format!("put `special_bonds {wanted}` before the run")).into())
}
