//! Records of eight numbers as columns of lanes, and forces handed back to rows of four.

use super::lanes::{Lanes, Portable};

/// The most rows that lanes are made of.
pub const MOST: usize = 8;

/// What lanes made of rows need besides. Of arrays of rows the first [`Lanes::WIDTH`] count.
pub trait Rows: Lanes {
    /// Four lanes: sums are taken in four lanes by all forms, so that their bits do not depend on the width.
    type Sum: Copy;
    /// Zeros.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn none() -> Self::Sum;
    /// Adds `self * b`, the first four lanes before the rest.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn add_to(self, b: Self, sum: Self::Sum) -> Self::Sum;
    /// The total of a sum.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn total(sum: Self::Sum) -> f64;
    /// The first seven of eight consecutive numbers of each row, as columns.
    ///
    /// # Safety
    /// Each pointer must be readable for eight numbers.
    unsafe fn transposed(rows: &[*const f64; MOST]) -> [Self; 7];
    /// Subtracts three columns from the first three numbers of each row (and zero from the fourth).
    ///
    /// # Safety
    /// Each pointer must be writable for four numbers, different rows apart unless lanes are zero.
    unsafe fn subtract_transposed(columns: [Self; 3], rows: &[*mut f64; MOST]);
}

/// The total of four numbers, in the order that all forms take.
fn total(f: [f64; 4]) -> f64 {
    (f[0] + f[1]) + (f[2] + f[3])
}

impl Rows for Portable {
    type Sum = Self;
    #[inline(always)]
    unsafe fn none() -> Self {
        // SAFETY: any processor has this form.
        unsafe { Self::splat(0.0) }
    }
    #[inline(always)]
    unsafe fn add_to(self, b: Self, sum: Self) -> Self {
        // SAFETY: as above.
        unsafe { self.fma(b, sum) }
    }
    #[inline(always)]
    unsafe fn total(sum: Self) -> f64 {
        total(sum.0)
    }
    #[inline(always)]
    unsafe fn transposed(rows: &[*const f64; MOST]) -> [Self; 7] {
        // SAFETY: readable by the caller's promise.
        let r = [0, 1, 2, 3].map(|k| unsafe { rows[k].cast::<[f64; 7]>().read() });
        [0, 1, 2, 3, 4, 5, 6].map(|k| Self([r[0][k], r[1][k], r[2][k], r[3][k]]))
    }
    #[inline(always)]
    unsafe fn subtract_transposed(columns: [Self; 3], rows: &[*mut f64; MOST]) {
        for lane in 0..Self::WIDTH {
            for (k, column) in columns.iter().enumerate() {
                // SAFETY: writable by the caller's promise.
                unsafe { *rows[lane].add(k) -= column.0[lane] };
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use super::super::lanes::{Avx2, Lanes};
    use super::super::lanes512::Avx512;
    use super::{MOST, Rows, total};

    // SAFETY (all blocks): the caller promises that the processor has AVX2 and FMA, and that pointers are good.
    impl Rows for Avx2 {
        type Sum = Self;
        #[inline(always)]
        unsafe fn none() -> Self {
            unsafe { Self::splat(0.0) }
        }
        #[inline(always)]
        unsafe fn add_to(self, b: Self, sum: Self) -> Self {
            unsafe { self.fma(b, sum) }
        }
        #[inline(always)]
        unsafe fn total(sum: Self) -> f64 {
            let mut out = [0.0; 4];
            unsafe { _mm256_storeu_pd(out.as_mut_ptr(), sum.0) }
            total(out)
        }
        #[inline(always)]
        unsafe fn transposed(rows: &[*const f64; MOST]) -> [Self; 7] {
            unsafe {
                macro_rules! halves {
                    ($p:expr, $q:expr) => {
                        _mm256_insertf128_pd::<1>(_mm256_castpd128_pd256(_mm_loadu_pd($p)), _mm_loadu_pd($q))
                    };
                }
                macro_rules! columns {
                    ($at:literal) => {{
                        let ac = halves!(rows[0].add($at), rows[2].add($at));
                        let bd = halves!(rows[1].add($at), rows[3].add($at));
                        [Self(_mm256_unpacklo_pd(ac, bd)), Self(_mm256_unpackhi_pd(ac, bd))]
                    }};
                }
                let ([x, y], [z, volume], [u, v], [w, _]) =
                    (columns!(0), columns!(2), columns!(4), columns!(6));
                [x, y, z, volume, u, v, w]
            }
        }
        #[inline(always)]
        unsafe fn subtract_transposed(columns: [Self; 3], rows: &[*mut f64; MOST]) {
            unsafe {
                let [x, y, z] = columns;
                let zero = _mm256_setzero_pd();
                let (xy0, xy1) = (_mm256_unpacklo_pd(x.0, y.0), _mm256_unpackhi_pd(x.0, y.0));
                let (z0, z1) = (_mm256_unpacklo_pd(z.0, zero), _mm256_unpackhi_pd(z.0, zero));
                take(rows[0], _mm256_permute2f128_pd::<0x20>(xy0, z0));
                take(rows[1], _mm256_permute2f128_pd::<0x20>(xy1, z1));
                take(rows[2], _mm256_permute2f128_pd::<0x31>(xy0, z0));
                take(rows[3], _mm256_permute2f128_pd::<0x31>(xy1, z1));
            }
        }
    }

    /// Subtracts from four numbers.
    #[inline(always)]
    unsafe fn take(row: *mut f64, f: __m256d) {
        unsafe { _mm256_storeu_pd(row, _mm256_sub_pd(_mm256_loadu_pd(row), f)) }
    }

    // SAFETY (all blocks): the caller promises that the processor has AVX-512 F and DQ, and that pointers are good.
    impl Rows for Avx512 {
        type Sum = Avx2;
        #[inline(always)]
        unsafe fn none() -> Avx2 {
            unsafe { Avx2::splat(0.0) }
        }
        #[inline(always)]
        unsafe fn add_to(self, b: Self, sum: Avx2) -> Avx2 {
            unsafe {
                let first =
                    _mm256_fmadd_pd(_mm512_castpd512_pd256(self.0), _mm512_castpd512_pd256(b.0), sum.0);
                let (a, b) = (_mm512_extractf64x4_pd::<1>(self.0), _mm512_extractf64x4_pd::<1>(b.0));
                Avx2(_mm256_fmadd_pd(a, b, first))
            }
        }
        #[inline(always)]
        unsafe fn total(sum: Avx2) -> f64 {
            unsafe { Avx2::total(sum) }
        }
        #[inline(always)]
        unsafe fn transposed(rows: &[*const f64; MOST]) -> [Self; 7] {
            unsafe {
                macro_rules! load {
                    ($k:literal) => {
                        _mm512_loadu_pd(rows[$k])
                    };
                }
                let (a, b, c, d) = (load!(0), load!(1), load!(2), load!(3));
                let (e, f, g, h) = (load!(4), load!(5), load!(6), load!(7));
                // Two rows side by side: numbers 0 2 4 6, and 1 3 5 7.
                let even = [
                    _mm512_unpacklo_pd(a, b),
                    _mm512_unpacklo_pd(c, d),
                    _mm512_unpacklo_pd(e, f),
                    _mm512_unpacklo_pd(g, h),
                ];
                let odd = [
                    _mm512_unpackhi_pd(a, b),
                    _mm512_unpackhi_pd(c, d),
                    _mm512_unpackhi_pd(e, f),
                    _mm512_unpackhi_pd(g, h),
                ];
                // The first and third (0x88), or the second and fourth (0xdd) pair of numbers of two registers.
                macro_rules! pick {
                    ($which:literal, $a:expr, $b:expr) => {
                        _mm512_shuffle_f64x2::<$which>($a, $b)
                    };
                }
                let (xu, xu2) = (pick!(0x88, even[0], even[1]), pick!(0x88, even[2], even[3]));
                let (zw, zw2) = (pick!(0xdd, even[0], even[1]), pick!(0xdd, even[2], even[3]));
                let (yv, yv2) = (pick!(0x88, odd[0], odd[1]), pick!(0x88, odd[2], odd[3]));
                let (vs, vs2) = (pick!(0xdd, odd[0], odd[1]), pick!(0xdd, odd[2], odd[3]));
                [
                    Self(pick!(0x88, xu, xu2)),
                    Self(pick!(0x88, yv, yv2)),
                    Self(pick!(0x88, zw, zw2)),
                    Self(pick!(0x88, vs, vs2)),
                    Self(pick!(0xdd, xu, xu2)),
                    Self(pick!(0xdd, yv, yv2)),
                    Self(pick!(0xdd, zw, zw2)),
                ]
            }
        }
        #[inline(always)]
        unsafe fn subtract_transposed(columns: [Self; 3], rows: &[*mut f64; MOST]) {
            unsafe {
                let [x, y, z] = columns;
                let zero = _mm512_setzero_pd();
                let (xy0, xy1) = (_mm512_unpacklo_pd(x.0, y.0), _mm512_unpackhi_pd(x.0, y.0));
                let (z0, z1) = (_mm512_unpacklo_pd(z.0, zero), _mm512_unpackhi_pd(z.0, zero));
                // Pairs 0 and 1, or 2 and 3, of both: two rows.
                let low = _mm512_set_epi64(11, 10, 3, 2, 9, 8, 1, 0);
                let high = _mm512_set_epi64(15, 14, 7, 6, 13, 12, 5, 4);
                macro_rules! two_rows {
                    ($first:literal, $second:literal, $order:expr, $xy:expr, $z:expr) => {
                        let both = _mm512_permutex2var_pd($xy, $order, $z);
                        take(rows[$first], _mm512_castpd512_pd256(both));
                        take(rows[$second], _mm512_extractf64x4_pd::<1>(both));
                    };
                }
                two_rows!(0, 2, low, xy0, z0);
                two_rows!(1, 3, low, xy1, z1);
                two_rows!(4, 6, high, xy0, z0);
                two_rows!(5, 7, high, xy1, z1);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of distinct numbers, through columns and back.
    unsafe fn there_and_back<L: Rows>() {
        let records: Vec<[f64; 8]> =
            (0..8).map(|r| std::array::from_fn(|k| f64::from(10 * r) + k as f64)).collect();
        let mut forces = [[1000.0; 4]; 8];
        // SAFETY: rows of eight and of four numbers; the caller has the processor.
        unsafe {
            let columns = L::transposed(&std::array::from_fn(|r| records[r].as_ptr()));
            for (k, column) in columns.iter().enumerate() {
                let mut lanes = [0.0; MOST];
                column.store(lanes.as_mut_ptr());
                (0..L::WIDTH).for_each(|r| assert_eq!(lanes[r], records[r][k]));
            }
            let start = forces.as_mut_ptr();
            let rows = std::array::from_fn(|r| start.add(r).cast::<f64>());
            L::subtract_transposed([columns[1], columns[4], columns[6]], &rows);
            let total = L::total(columns[0].add_to(columns[1], L::none()));
            let sums: [f64; 4] = std::array::from_fn(|k| {
                (k..L::WIDTH).step_by(4).map(|r| records[r][0] * records[r][1]).sum()
            });
            assert_eq!(total, sums.iter().sum::<f64>());
        }
        for r in 0..L::WIDTH {
            let [_, a, _, _, b, _, c, _] = records[r];
            assert_eq!(forces[r], [1000.0 - a, 1000.0 - b, 1000.0 - c, 1000.0]);
        }
    }

    #[test]
    fn rows_become_columns_and_come_back() {
        // SAFETY: each form is used where the processor has it.
        unsafe {
            there_and_back::<Portable>();
            #[cfg(target_arch = "x86_64")]
            if super::super::lanes::has_avx2() {
                there_and_back::<super::super::lanes::Avx2>();
            }
            #[cfg(target_arch = "x86_64")]
            if super::super::lanes512::has_avx512() {
                there_and_back::<super::super::lanes512::Avx512>();
            }
        }
    }
}
