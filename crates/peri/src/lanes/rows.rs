//! Rows of four numbers as columns of lanes, and forces handed back to rows of four.

use crate::lanes::{Lanes, Portable};

/// The most rows that lanes are made of.
pub const MOST: usize = 8;

/// What lanes made of rows need besides. Of arrays of rows the first [`Lanes::WIDTH`] count.
pub trait Rows: Lanes {
    /// Four consecutive numbers of each row, as columns.
    ///
    /// # Safety
    /// Each pointer must be readable for four numbers.
    unsafe fn quads(rows: &[*const f64; MOST]) -> [Self; 4];
    /// Subtracts three columns from the first three numbers of each row; with `LEAST` the fourth column comes in place of
    /// the fourth number where it is less, else it is zero.
    ///
    /// # Safety
    /// Each pointer must be writable for four numbers, different rows apart unless lanes change nothing.
    unsafe fn hand_over<const LEAST: bool>(columns: [Self; 4], rows: &[*mut f64; MOST]);
}

impl Rows for Portable {
    #[inline(always)]
    unsafe fn quads(rows: &[*const f64; MOST]) -> [Self; 4] {
        // SAFETY: readable by the caller's promise.
        let r = [0, 1, 2, 3].map(|k| unsafe { rows[k].cast::<[f64; 4]>().read() });
        [0, 1, 2, 3].map(|k| Self([r[0][k], r[1][k], r[2][k], r[3][k]]))
    }
    #[inline(always)]
    unsafe fn hand_over<const LEAST: bool>(columns: [Self; 4], rows: &[*mut f64; MOST]) {
        for lane in 0..Self::WIDTH {
            // SAFETY: writable by the caller's promise.
            let row = unsafe { &mut *rows[lane].cast::<[f64; 4]>() };
            (0..3).for_each(|k| row[k] -= columns[k].0[lane]);
            if LEAST {
                row[3] = row[3].min(columns[3].0[lane]);
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use super::{MOST, Rows};
    use crate::lanes::Avx2;
    use crate::lanes::avx512::Avx512;

    // SAFETY (all blocks): the caller promises that the processor has AVX2 and FMA, and that pointers are good.
    impl Rows for Avx2 {
        #[inline(always)]
        unsafe fn quads(rows: &[*const f64; MOST]) -> [Self; 4] {
            unsafe {
                let row = [0, 1, 2, 3].map(|k| _mm256_loadu_pd(rows[k]));
                let (ab, cd) = (_mm256_unpacklo_pd(row[0], row[1]), _mm256_unpacklo_pd(row[2], row[3]));
                let (ef, gh) = (_mm256_unpackhi_pd(row[0], row[1]), _mm256_unpackhi_pd(row[2], row[3]));
                [
                    Self(_mm256_permute2f128_pd::<0x20>(ab, cd)),
                    Self(_mm256_permute2f128_pd::<0x20>(ef, gh)),
                    Self(_mm256_permute2f128_pd::<0x31>(ab, cd)),
                    Self(_mm256_permute2f128_pd::<0x31>(ef, gh)),
                ]
            }
        }
        #[inline(always)]
        unsafe fn hand_over<const LEAST: bool>(columns: [Self; 4], rows: &[*mut f64; MOST]) {
            unsafe {
                let [x, y, z, m] = columns;
                let (xy0, xy1) = (_mm256_unpacklo_pd(x.0, y.0), _mm256_unpackhi_pd(x.0, y.0));
                let (zm0, zm1) = (_mm256_unpacklo_pd(z.0, m.0), _mm256_unpackhi_pd(z.0, m.0));
                take::<LEAST>(rows[0], _mm256_permute2f128_pd::<0x20>(xy0, zm0));
                take::<LEAST>(rows[1], _mm256_permute2f128_pd::<0x20>(xy1, zm1));
                take::<LEAST>(rows[2], _mm256_permute2f128_pd::<0x31>(xy0, zm0));
                take::<LEAST>(rows[3], _mm256_permute2f128_pd::<0x31>(xy1, zm1));
            }
        }
    }

    /// See [`Rows::hand_over`].
    #[inline(always)]
    unsafe fn take<const LEAST: bool>(row: *mut f64, f: __m256d) {
        unsafe {
            let there = _mm256_loadu_pd(row);
            let mut new = _mm256_sub_pd(there, f);
            if LEAST {
                new = _mm256_blend_pd::<0b1000>(new, _mm256_min_pd(there, f));
            }
            _mm256_storeu_pd(row, new);
        }
    }

    // SAFETY (all blocks): the caller promises that the processor has AVX-512 F and DQ, and that pointers are good.
    impl Rows for Avx512 {
        #[inline(always)]
        unsafe fn quads(rows: &[*const f64; MOST]) -> [Self; 4] {
            unsafe {
                macro_rules! two_rows {
                    ($a:literal, $b:literal) => {
                        _mm512_insertf64x4::<1>(
                            _mm512_castpd256_pd512(_mm256_loadu_pd(rows[$a])),
                            _mm256_loadu_pd(rows[$b]),
                        )
                    };
                }
                let (a, b, c, d) = (two_rows!(0, 4), two_rows!(1, 5), two_rows!(2, 6), two_rows!(3, 7));
                // Of rows 0 1 4 5, or 2 3 6 7: numbers 0 and 2, or 1 and 3.
                let (even, even2) = (_mm512_unpacklo_pd(a, b), _mm512_unpacklo_pd(c, d));
                let (odd, odd2) = (_mm512_unpackhi_pd(a, b), _mm512_unpackhi_pd(c, d));
                let first = _mm512_set_epi64(13, 12, 5, 4, 9, 8, 1, 0);
                let second = _mm512_set_epi64(15, 14, 7, 6, 11, 10, 3, 2);
                [
                    Self(_mm512_permutex2var_pd(even, first, even2)),
                    Self(_mm512_permutex2var_pd(odd, first, odd2)),
                    Self(_mm512_permutex2var_pd(even, second, even2)),
                    Self(_mm512_permutex2var_pd(odd, second, odd2)),
                ]
            }
        }
        #[inline(always)]
        unsafe fn hand_over<const LEAST: bool>(columns: [Self; 4], rows: &[*mut f64; MOST]) {
            unsafe {
                let [x, y, z, m] = columns;
                let (xy0, xy1) = (_mm512_unpacklo_pd(x.0, y.0), _mm512_unpackhi_pd(x.0, y.0));
                let (z0, z1) = (_mm512_unpacklo_pd(z.0, m.0), _mm512_unpackhi_pd(z.0, m.0));
                // Pairs 0 and 1, or 2 and 3, of both: two rows.
                let low = _mm512_set_epi64(11, 10, 3, 2, 9, 8, 1, 0);
                let high = _mm512_set_epi64(15, 14, 7, 6, 13, 12, 5, 4);
                macro_rules! two_rows {
                    ($first:literal, $second:literal, $order:expr, $xy:expr, $z:expr) => {
                        let both = _mm512_permutex2var_pd($xy, $order, $z);
                        take::<LEAST>(rows[$first], _mm512_castpd512_pd256(both));
                        take::<LEAST>(rows[$second], _mm512_extractf64x4_pd::<1>(both));
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
            let columns = L::quads(&std::array::from_fn(|r| records[r].as_ptr().add(3)));
            for (k, column) in columns.iter().enumerate() {
                let mut lanes = [0.0; MOST];
                column.store(lanes.as_mut_ptr());
                (0..L::WIDTH).for_each(|r| assert_eq!(lanes[r], records[r][k + 3]));
            }
            let start = forces.as_mut_ptr();
            let rows = std::array::from_fn(|r| start.add(r).cast::<f64>());
            L::hand_over::<true>([columns[0], columns[1], columns[3], columns[2]], &rows);
            for (r, (force, record)) in forces.iter().zip(&records).enumerate().take(L::WIDTH) {
                let [_, _, _, a, b, m, c, _] = *record;
                assert_eq!(*force, [1000.0 - a, 1000.0 - b, 1000.0 - c, m], "{r}");
            }
            let columns = [columns[0], columns[1], columns[3], L::splat(0.0)];
            L::hand_over::<false>(columns, &rows);
            let [_, _, _, a, b, m, c, _] = records[L::WIDTH - 1];
            assert_eq!(forces[L::WIDTH - 1], [1000.0 - 2.0 * a, 1000.0 - 2.0 * b, 1000.0 - 2.0 * c, m]);
        }
    }

    #[test]
    fn rows_become_columns_and_come_back() {
        // SAFETY: each form is used where the processor has it.
        unsafe {
            there_and_back::<Portable>();
            #[cfg(target_arch = "x86_64")]
            if crate::lanes::has_avx2() {
                there_and_back::<crate::lanes::Avx2>();
            }
            #[cfg(target_arch = "x86_64")]
            if crate::lanes::avx512::has_avx512() {
                there_and_back::<crate::lanes::avx512::Avx512>();
            }
        }
    }
}
