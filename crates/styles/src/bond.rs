//! What a bond style is: a style that reads its line, and what it declares.

use super::pull::{Pull, Stretched};
use super::{BuildCx, Fix, SealCx, Style};
use dyn_clone::DynClone;
use perigrain_base::diag::Result;
pub use perigrain_bonded::stiffness::Stiffness;
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_world::World;
use perigrain_world::field::Fields;

/// A bond style: one file, one line in `BONDS`.
pub trait BondStyle: Style {
    /// Reads the words after the style's name.
    ///
    /// # Errors
    /// Every mistake in the line.
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn BondForce>>;
}

/// A bond in its present state, whose fastest oscillation is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Standing {
    /// Type.
    pub kind: u16,
    /// Length at rest [length].
    pub length: f64,
    /// Radii of the ends [length].
    pub radii: [f64; 2],
    /// Their masses, in units of force and time [force time²/length].
    pub masses: [f64; 2],
}

/// A loaded bond, whose distance from its strength is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Loaded {
    /// Type.
    pub kind: u16,
    /// Length at rest [length].
    pub length: f64,
    /// Radii of the ends [length].
    pub radii: [f64; 2],
    /// Their IDs.
    pub ids: [u32; 2],
    /// Tension, below 0 where it is pressed, and shear force [force]; moments of bending and twist at its middle [force length].
    pub bears: [f64; 4],
}

/// What stands against the motion of a bond's ends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Swing {
    /// How hard it may become: not less than the slope of its forces wherever it is near rest.
    pub stiffness: Stiffness,
    /// What its dashpots do: force per velocity, torque per spin.
    pub dashpots: Stiffness,
}

/// A declared bond style with its coefficients.
pub trait BondForce: DynClone + Send + Sync {
    /// The style's name.
    fn name(&self) -> &'static str;

    /// Reads the words of `bond_coeff` after the types.
    ///
    /// # Errors
    /// Every mistake in the line.
    fn coeff(&mut self, kinds: &[u16], args: &mut Args, cx: &BuildCx) -> Result<()>;

    /// Whether a bond type has coefficients.
    fn covers(&self, kind: u16) -> bool;

    /// Limits the style to some bond types (as a sub-style of `hybrid`); by default it acts on all.
    fn restrict(&mut self, _kinds: &[u16]) {}

    /// The ops it contributes to a step.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>>;

    /// The fixes that it brings along, by their IDs: they go when the style goes.
    fn fixes(&self) -> Vec<(String, Box<dyn Fix>)> {
        vec![]
    }

    /// The names of additional numbers per bond, for `compute bond/local`.
    fn extras(&self) -> &'static [&'static str] {
        &[]
    }

    /// What `single` and `extra` read of the world beyond positions, velocities and the bond.
    fn looks_at(&self) -> Fields {
        Fields::NONE
    }

    /// These numbers, in that order.
    fn extra(&self, _w: &World, _bond: &Stretched) -> Vec<f64> {
        vec![]
    }

    /// What a bond does, by the coefficients it has at the moment, for `compute bond/local`; `None` where that takes more than
    /// its two ends.
    fn single(&self, w: &World, bond: &Stretched) -> Option<Pull>;

    /// The stiffnesses of a bond of this length at rest between spheres of these radii, for small displacements; `None` where the
    /// style has none.
    fn stiffness(&self, _kind: u16, _length: f64, _radii: [f64; 2]) -> Option<Stiffness> {
        None
    }

    /// What stands against the motion of a bond's ends, for the longest stable step; `None` where the style has no bonds of its own, or
    /// they do nothing.
    fn swing(&self, bond: &Standing) -> Option<Swing> {
        let stiffness = self.stiffness(bond.kind, bond.length, bond.radii)?;
        Some(Swing { stiffness, ..Swing::default() })
    }

    /// Whether bonds of a type bend and twist with the orientations of their ends, which then have to follow spins.
    fn turns(&self, _kind: u16) -> bool {
        false
    }

    /// Whether bonds of a type may break, after which the pair style acts between their ends.
    fn may_break(&self, _kind: u16) -> bool {
        false
    }

    /// How much of its strength a bond has used up, proportional to what it bears while that is little; `None` where nothing breaks it.
    fn used(&self, _bond: &Loaded) -> Option<f64> {
        None
    }

    /// The coefficients that `calibrate fit` may vary, by name.
    fn tunable(&self) -> &'static [&'static str] {
        &[]
    }

    /// A copy in which one of them is `factor` times what it is for a type, and its value there; `None` where the type has none.
    fn tuned(&self, _name: &str, _kind: u16, _factor: f64) -> Option<(Box<dyn BondForce>, f64)> {
        None
    }

    /// The pair styles of which one has to be in force besides; any will do by default.
    fn companions(&self) -> &'static [&'static str] {
        &[]
    }

    /// The coefficients that `fix adapt` may change, by name.
    fn coefficients(&self) -> &'static [&'static str] {
        &[]
    }

    /// The value of a coefficient as the deck's lines set it.
    fn coefficient(&self, _name: &str, _kind: u16) -> Option<f64> {
        None
    }

    /// The coefficients of a type as a data file has them.
    fn written(&self, kind: u16) -> Option<String>;
}

dyn_clone::clone_trait_object!(BondForce);
