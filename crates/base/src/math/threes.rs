//! Four vectors of three numbers, contiguous in memory, in three times four lanes.

#[cfg(target_arch = "x86_64")]
use super::four::Avx2;
use super::four::{Four, Plain};

/// Conversion between four numbers, one per vector, and the twelve components of four vectors: x y z, x y z,
/// x y z, x y z.
pub trait Threes: Four {
    /// Each number three times, aligned with the components of its vector.
    fn spread(self) -> [Self; 3];
    /// The four x, the four y and the four z.
    fn parted(twelve: [Self; 3]) -> [Self; 3];
}

/// Loads twelve numbers from `p` on.
///
/// # Safety
/// `p` must be readable for twelve numbers; the processor must support the form.
#[inline(always)]
pub unsafe fn load<F: Four>(p: *const f64) -> [F; 3] {
    // SAFETY: the caller's guarantee.
    unsafe { [F::load(p), F::load(p.add(4)), F::load(p.add(8))] }
}

/// Stores twelve numbers.
///
/// # Safety
/// `p` must be writable for twelve numbers.
#[inline(always)]
pub unsafe fn store<F: Four>(twelve: [F; 3], p: *mut f64) {
    let [a, b, c] = twelve;
    // SAFETY: the caller's guarantee.
    unsafe {
        a.store(p);
        b.store(p.add(4));
        c.store(p.add(8));
    }
}

/// The same vector four times.
///
/// # Safety
/// The processor must support the form.
#[inline(always)]
pub unsafe fn repeated<F: Four>([x, y, z]: [f64; 3]) -> [F; 3] {
    let twelve = [x, y, z, x, y, z, x, y, z, x, y, z];
    // SAFETY: an array of twelve numbers.
    unsafe { load(twelve.as_ptr()) }
}

impl Threes for Plain {
    #[inline(always)]
    fn spread(self) -> [Self; 3] {
        let Self([a, b, c, d]) = self;
        [Self([a, a, a, b]), Self([b, b, c, c]), Self([c, d, d, d])]
    }
    #[inline(always)]
    fn parted([p, q, r]: [Self; 3]) -> [Self; 3] {
        let (Self([x0, y0, z0, x1]), Self([y1, z1, x2, y2]), Self([z2, x3, y3, z3])) = (p, q, r);
        [Self([x0, x1, x2, x3]), Self([y0, y1, y2, y3]), Self([z0, z1, z2, z3])]
    }
}

#[cfg(target_arch = "x86_64")]
impl Threes for Avx2 {
    #[inline(always)]
    fn spread(self) -> [Self; 3] {
        use std::arch::x86_64::_mm256_permute4x64_pd as permute;
        // SAFETY: a value exists, so the processor has AVX2.
        unsafe {
            [
                Self(permute::<0b01_00_00_00>(self.0)),
                Self(permute::<0b10_10_01_01>(self.0)),
                Self(permute::<0b11_11_11_10>(self.0)),
            ]
        }
    }
    #[inline(always)]
    fn parted([p, q, r]: [Self; 3]) -> [Self; 3] {
        use std::arch::x86_64::*;
        // SAFETY: a value exists, so the processor has AVX2.
        unsafe {
            let x0y0x2y2 = _mm256_blend_pd::<0b1100>(p.0, q.0);
            let z0x1z2x3 = _mm256_permute2f128_pd::<0x21>(p.0, r.0);
            let y1z1y3z3 = _mm256_blend_pd::<0b1100>(q.0, r.0);
            [
                Self(_mm256_blend_pd::<0b1010>(x0y0x2y2, z0x1z2x3)),
                Self(_mm256_shuffle_pd::<0b0101>(x0y0x2y2, y1z1y3z3)),
                Self(_mm256_blend_pd::<0b1010>(z0x1z2x3, y1z1y3z3)),
            ]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::lanes::Lanes;

    unsafe fn both<F: Threes>() {
        let twelve: [f64; 12] = std::array::from_fn(|k| k as f64);
        // SAFETY: the caller's guarantee; arrays of twelve and of four numbers.
        unsafe {
            let parted = F::parted(load(twelve.as_ptr())).map(|f: F| f.numbers());
            assert_eq!(parted, [[0.0, 3.0, 6.0, 9.0], [1.0, 4.0, 7.0, 10.0], [2.0, 5.0, 8.0, 11.0]]);
            let mut out = [0.0; 12];
            store(F::load(twelve.as_ptr()).spread(), out.as_mut_ptr());
            assert_eq!(out, [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0]);
            store(repeated::<F>([7.0, 8.0, 9.0]), out.as_mut_ptr());
            assert_eq!(out[3..7], [7.0, 8.0, 9.0, 7.0]);
        }
    }

    #[test]
    fn components_find_their_places() {
        // SAFETY: the portable form has no requirements; the other one is used only with AVX2.
        unsafe {
            both::<Plain>();
            #[cfg(target_arch = "x86_64")]
            if crate::math::four::has_avx2() {
                both::<Avx2>();
            }
        }
    }
}
