//! The stretch of a bond in the forms that laws need, and what its ends have.

use crate::law::moment::COLUMNS;
use perigrain_base::math::real::Real;

/// A bond's stretch s in the forms that laws need.
#[derive(Clone, Copy)]
pub struct Stretch<R> {
    /// s.
    pub s: R,
    /// s/(1 + s).
    pub share: R,
    /// 1/(1 + s).
    pub inverse: R,
    /// s at the last step that advanced; only for laws that look back.
    pub before: R,
    /// The pair's critical stretch; only for laws that are limited by it.
    pub limit: R,
}

/// What both ends of a bond have in columns.
pub type Ends<R> = [[R; COLUMNS]; 2];

/// The stretch from z = |y|²/|xi|² − 1, its closed form, `before` as now.
#[inline(always)]
pub fn closed<R: Real>(z: R) -> Stretch<R> {
    let one = z.like(1.0);
    let root = (one + z).sqrt();
    let more = one + root;
    let inverse = one / (root * more);
    let s = z * root * inverse;
    Stretch { s, share: z * inverse, inverse: more * inverse, before: s, limit: s }
}
