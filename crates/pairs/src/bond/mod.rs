//! Bond styles: forces along bonds between particles.

/// What the pages of bond styles add about `store/local`, after their own text.
macro_rules! with_store {
    ($file:literal) => {
        concat!(include_str!($file), "\n", include_str!("store_local.md"))
    };
}

mod bpm_beam;
pub mod bpm_peri;
mod bpm_rotational;
mod bpm_spring;
mod bpm_spring_plastic;
pub mod driver;
mod harmonic;
mod hybrid;
mod options;
mod store_local;
mod zero;

use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_styles::BuildCx;
pub use perigrain_styles::bond::{BondForce, BondStyle};
pub use perigrain_styles::pull::{Pull, Stretched, apart};
use perigrain_world::World;
pub use store_local::NAME as BROUGHT;

/// Every bond style.
#[rustfmt::skip]
pub const BONDS: &[&dyn BondStyle] = &[
    &bpm_beam::BpmBeam,
    &bpm_peri::BpmPeri,
    &bpm_rotational::BpmRotational,
    &bpm_spring::BpmSpring,
    &bpm_spring_plastic::BpmSpringPlastic,
    &harmonic::HarmonicStyle,
    &hybrid::Hybrid,
    &zero::ZeroStyle,
];

/// Bonds that twist and bend need particles with orientations.
///
/// # Errors
/// They have none.
fn needs_orientations(style: &str, cx: &BuildCx) -> Result<()> {
    if cx.world.particles.style.oriented {
        return Ok(());
    }
    let text = format!("bond_style {style} needs particles with orientations");
    let d = Diagnostic::error(Code::WRONG_ORDER, cx.span, text);
    Err(d.help("put `atom_style bpm/sphere` (or a hybrid with it) at the top of the deck").into())
}

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
