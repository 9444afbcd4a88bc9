//! Vector algebra on three components, for kernels.

use super::real::Real;

/// Three components.
pub type Vec3<R = f64> = [R; 3];

/// The components of symmetric tensors in LAMMPS' order: xx yy zz xy xz yz.
pub const SIX: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// a + b.
#[inline(always)]
pub fn add<R: Real>(a: Vec3<R>, b: Vec3<R>) -> Vec3<R> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// a − b.
#[inline(always)]
pub fn sub<R: Real>(a: Vec3<R>, b: Vec3<R>) -> Vec3<R> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Whether a = b: inlined comparisons, where `==` of arrays is a loop.
#[inline(always)]
pub fn same(a: Vec3, b: Vec3) -> bool {
    a[0] == b[0] && a[1] == b[1] && a[2] == b[2]
}

/// s a.
#[inline(always)]
pub fn scale<R: Real>(s: R, a: Vec3<R>) -> Vec3<R> {
    [s * a[0], s * a[1], s * a[2]]
}

/// a · b.
#[inline(always)]
pub fn dot<R: Real>(a: Vec3<R>, b: Vec3<R>) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
#[inline(always)]
pub fn cross<R: Real>(a: Vec3<R>, b: Vec3<R>) -> Vec3<R> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// |a|.
#[inline(always)]
pub fn length<R: Real>(a: Vec3<R>) -> R {
    dot(a, a).sqrt()
}

/// `yes` where the mask is set, else `no`.
#[inline(always)]
pub fn choose<R: Real>(mask: R::Mask, yes: Vec3<R>, no: Vec3<R>) -> Vec3<R> {
    [R::choose(mask, yes[0], no[0]), R::choose(mask, yes[1], no[1]), R::choose(mask, yes[2], no[2])]
}
