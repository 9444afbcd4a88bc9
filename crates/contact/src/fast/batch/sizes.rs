//! Contact geometry in lanes.

use crate::Geometry;
use crate::driver::DEEP;
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, scale};

/// Radii of two grains, their sum, and derived sizes.
#[derive(Clone, Copy)]
pub(super) struct Sizes<R> {
    radii: [R; 2],
    sum: R,
    /// The effective radius.
    curvature: R,
}

impl<R: Real> Sizes<R> {
    #[inline(always)]
    pub(super) fn of(radii: [R; 2]) -> Self {
        let sum = radii[0] + radii[1];
        Self { radii, sum, curvature: radii[0] * radii[1] / sum }
    }
}

/// The geometry of touching spheres, like `Geometry::of_spheres`.
#[inline(always)]
pub(super) fn geometry<R: Real>(d: Vec3<R>, sizes: &Sizes<R>, mass: R) -> Geometry<R> {
    let distance = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    Geometry {
        normal: scale(distance.like(1.0) / distance, d),
        overlap: sizes.sum - distance,
        radii: sizes.radii,
        curvature: sizes.curvature,
        mass,
    }
}

/// Whether grains overlap by more than [`DEEP`] of the smaller radius.
#[inline(always)]
pub(super) fn too_deep<R: Real>(g: &Geometry<R>) -> R::Mask {
    g.overlap.above(g.radii[0].least(g.radii[1]) * DEEP)
}

/// The reduced mass.
#[inline(always)]
pub(super) fn reduced<R: Real>(mi: R, mj: R) -> R {
    mi * mj / (mi + mj)
}

/// The reduced mass, where frozen grains have negative mass and count as infinitely heavy; `free`: the
/// reduced mass of two grains that are not frozen, if known. Of two frozen grains the one with the smaller tag counts, the first
/// where `side` is positive.
#[inline(always)]
pub(super) fn beside_frozen<R: Real>(mi: R, mj: R, side: R, free: Option<R>) -> R {
    let (zero, a, b) = (mi.like(0.0), mi.abs(), mj.abs());
    let free = match free {
        Some(mass) => mass,
        None => reduced(a, b),
    };
    let both = R::both(zero.above(mi), zero.above(mj));
    let one = R::choose(zero.above(mj), a, R::choose(zero.above(mi), b, free));
    R::choose(both, R::choose(side.above(zero), a, b), one)
}
