//! Rows of four numbers as columns of lanes, and forces handed back to rows of four.

use super::lanes::{Lanes, Portable};

/// The most rows that lanes are made of.
pub const MOST: usize = 8;

/// What lanes made of rows need besides. Of arrays of rows the first [`Lanes::WIDTH`] count.
pub trait Rows: Lanes {
    /// Four consecutive numbers of each row, as columns.
    ///
    /// # Safety
    /// Each pointer must be readable for four numbers.
    unsafe fn quads(rows: &[*const f64; MOST]) -> [Self; 4];
    /// Subtracts three columns from the first three numbers of each row (and zero from the fourth).
    ///
    /// # Safety
    /// Each pointer must be writable for four numbers, different rows apart unless lanes are zero.
    unsafe fn subtract_transposed(columns: [Self; 3], rows: &[*mut f64; MOST]);
}

impl Rows for Portable {
    #[inline(always)]
    unsafe fn quads(rows: &[*const f64; MOST]) -> [Self; 4] {
        // SAFETY: readable by the caller's promise.
        let r = [0, 1, 2, 3].map(|k| unsafe { rows[k].cast::<[f64; 4]>().read() });
        [0, 1, 2, 3].map(|k| Self([r[0][k], r[1][k], r[2][k], r[3][k]]))
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

    use super::super::lanes::Avx2;
    use super::super::lanes512::Avx512;
    use super::{MOST, Rows};

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
            let columns = L::quads(&std::array::from_fn(|r| records[r].as_ptr().add(3)));
            for (k, column) in columns.iter().enumerate() {
                let mut lanes = [0.0; MOST];
                column.store(lanes.as_mut_ptr());
                (0..L::WIDTH).for_each(|r| assert_eq!(lanes[r], records[r][k + 3]));
            }
            let start = forces.as_mut_ptr();
            let rows = std::array::from_fn(|r| start.add(r).cast::<f64>());
            L::subtract_transposed([columns[0], columns[1], columns[3]], &rows);
        }
        for r in 0..L::WIDTH {
            let [_, _, _, a, b, _, c, _] = records[r];
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
