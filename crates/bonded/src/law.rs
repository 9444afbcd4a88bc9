//! A bond law: the forces of **one** bond, for any number of lanes.

use crate::sweep::{Out, Sweep};
use perigrain_base::math::body::Quat;
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, choose};

/// The state of a bond's ends. The first end is the one with the lower ID.
#[derive(Clone, Copy, Debug)]
pub struct Ends<R> {
    /// From the second end to the first, across the nearest periodic faces [length].
    pub r: Vec3<R>,
    /// Rest length [length].
    pub length: R,
    /// Unit vector from the second end to the first at rest, in the frame of the second end.
    pub axis: Vec3<R>,
    /// Orientations of the ends; that of the first relative to its orientation when the bond was made.
    pub quat: [Quat<R>; 2],
}

/// Motion of the ends.
#[derive(Clone, Copy, Debug)]
pub struct Motion<R> {
    /// Velocity of the first end minus that of the second [velocity].
    pub v: Vec3<R>,
    /// Their spins [1/time].
    pub omega: [Vec3<R>; 2],
}

/// Forces and energy of a bond.
#[derive(Clone, Copy, Debug)]
pub struct Acts<R> {
    /// Force on the first end; the opposite acts on the second [force].
    pub force: Vec3<R>,
    /// Torques on both [force length].
    pub torque: [Vec3<R>; 2],
    /// Energy [energy].
    pub energy: R,
    /// Fraction of its strength used; the bond breaks at 1.
    pub load: R,
    /// Power dissipated by its dashpots [force length/time].
    pub power: R,
}

impl<R: Real> Acts<R> {
    /// All zeros; `zero` is 0.
    #[inline(always)]
    pub fn none(zero: R) -> Self {
        let none = [zero; 3];
        Self { force: none, torque: [none; 2], energy: zero, load: zero, power: zero }
    }

    /// `yes` where the mask is set, else `no`.
    #[inline(always)]
    pub fn choose(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self {
            force: choose(mask, yes.force, no.force),
            torque: [choose(mask, yes.torque[0], no.torque[0]), choose(mask, yes.torque[1], no.torque[1])],
            energy: R::choose(mask, yes.energy, no.energy),
            load: R::choose(mask, yes.load, no.load),
            power: R::choose(mask, yes.power, no.power),
        }
    }
}

/// A law: the forces of one bond. It is independent of lists, threads and instruction sets.
///
/// Each bond has `C` values in addition to its length and axis.
pub trait BondLaw<const C: usize>: Sync {
    /// Coefficients of a bond type.
    type Coeffs: Copy + Send + Sync;
    /// Whether it uses orientations and gives torques.
    const TURNS: bool;

    /// The forces of the bond. `motion` is given if some bond is damped. Always inlined, and without closures
    /// over lanes: otherwise it is not compiled for the instruction set of the form.
    fn act<R: Real>(
        &self,
        k: &Self::Coeffs,
        own: &[R; C],
        b: &Ends<R>,
        motion: Option<&Motion<R>>,
    ) -> Acts<R>;

    /// All bonds of a list: [`crate::sweep::all`], implemented beside the law so that its loop is compiled
    /// with this crate.
    fn sweep(&self, pass: &Sweep<'_, C, Self::Coeffs>, out: &mut Out);
}
