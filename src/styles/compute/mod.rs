//! Computes: quantities read from the world, never changing it.

mod com;
mod damage_atom;
mod erotate_sphere;
mod ke;
mod ke_atom;
mod momentum;
mod pe;
mod pe_atom;
mod pressure;
mod property_atom;
mod reduce;
mod temp;

use super::{BuildCx, SealCx, Shape, Style};
use crate::diag::{Code, Result, fail};
use crate::lang::Args;
use crate::plan::{Op, Stage, When};
use crate::world::SlotId;

/// A compute style: one file, one line in `COMPUTES`.
pub trait ComputeStyle: Style {
    /// Reads the words after the style's name.
    ///
    /// # Errors
    /// Every mistake in the line.
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>>;
}

/// A declared compute.
pub trait Compute: Send {
    /// Which values it offers.
    fn shape(&self) -> Shape;

    /// The op that fills `slot`; it is run at most once per step, at `stage`, whenever `when` fires.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>>;

    /// `compute_modify ID …`.
    ///
    /// # Errors
    /// Unknown keywords; by default there are none.
    fn modify(&mut self, args: &mut Args, _cx: &BuildCx) -> Result<()> {
        match args.next() {
            None => Ok(()),
            Some(w) => {
                fail(Code::UNKNOWN_KEYWORD, w.span, format!("this compute has no option `{}`", w.text))
            }
        }
    }

    /// A copy, so that a failing `compute_modify` changes nothing.
    fn boxed(&self) -> Box<dyn Compute>;
}

/// Every compute style.
#[rustfmt::skip]
pub const COMPUTES: &[&dyn ComputeStyle] = &[
    &com::Com,
    &damage_atom::DamageAtom,
    &erotate_sphere::ErotateSphere,
    &ke::Ke,
    &ke_atom::KeAtom,
    &momentum::Momentum,
    &pe::Pe,
    &pe_atom::PeAtom,
    &pressure::Pressure,
    &property_atom::PropertyAtom,
    &reduce::Reduce,
    &temp::Temp,
];

/// Keywords of `pe` and `pe/atom`: whether pairs and fixes count. Terms of styles that perigrain does not have
/// are known and contribute nothing.
fn energy_terms(args: &mut Args) -> Result<(bool, bool)> {
    let all = args.is_empty();
    let (mut pair, mut fix) = (all, all);
    while !args.is_empty() {
        let terms = ["pair", "bond", "angle", "dihedral", "improper", "kspace", "fix"];
        match args.choice("term of the potential energy", &terms)? {
            "pair" => pair = true,
            "fix" => fix = true,
            _ => {}
        }
    }
    Ok((pair, fix))
}
