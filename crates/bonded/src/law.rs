//! What a bond law is: what **one** bond does, for any number of lanes.

use crate::sweep::{Out, Sweep};
use perigrain_base::math::body::Quat;
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, choose};

/// A bond as its ends stand. The first end is that with the lower ID.
#[derive(Clone, Copy, Debug)]
pub struct Ends<R> {
    /// From the second end to the first, across the nearest periodic faces [length].
    pub r: Vec3<R>,
    /// Length at rest [length].
    pub length: R,
    /// Unit vector from the second end to the first at rest, as the second end carries it.
    pub axis: Vec3<R>,
    /// Orientations of the ends; that of the first such that both were alike when the bond was made.
    pub quat: [Quat<R>; 2],
}

/// How the ends move.
#[derive(Clone, Copy, Debug)]
pub struct Motion<R> {
    /// Velocity of the first end less that of the second [velocity].
    pub v: Vec3<R>,
    /// Their spins [1/time].
    pub omega: [Vec3<R>; 2],
}

/// What a bond does to its ends.
#[derive(Clone, Copy, Debug)]
pub struct Acts<R> {
    /// Force on the first end; the opposite acts on the second [force].
    pub force: Vec3<R>,
    /// Torques on both [force length].
    pub torque: [Vec3<R>; 2],
    /// Energy [energy].
    pub energy: R,
    /// How much of what it bears; it breaks at 1.
    pub load: R,
    /// What its dashpots turn into heat [force length/time].
    pub power: R,
}

impl<R: Real> Acts<R> {
    /// Nothing; `zero` is 0.
    #[inline(always)]
    pub fn none(zero: R) -> Self {
        let none = [zero; 3];
        Self { force: none, torque: [none; 2], energy: zero, load: zero, power: zero }
    }

    /// `yes` where the mask says so, else `no`.
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

/// A law: what one bond does. It knows neither lists nor threads nor instruction sets.
///
/// `C` numbers belong to every single bond besides its length and axis.
pub trait BondLaw<const C: usize>: Sync {
    /// What is the same for all bonds of a type.
    type Coeffs: Copy + Send + Sync;
    /// Whether orientations enter and torques come out.
    const TURNS: bool;

    /// What the bond does. `motion` is there where some bond is damped. Inlined always, and without closures that work on lanes:
    /// only then is it compiled for the instructions of a form.
    fn act<R: Real>(
        &self,
        k: &Self::Coeffs,
        own: &[R; C],
        b: &Ends<R>,
        motion: Option<&Motion<R>>,
    ) -> Acts<R>;

    /// All bonds of a list: [`crate::sweep::all`], called where the law stands so that its loop is compiled with this crate.
    fn sweep(&self, pass: &Sweep<'_, C, Self::Coeffs>, out: &mut Out);
}
