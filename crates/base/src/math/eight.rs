//! Eight numbers side by side in one AVX-512 register, with the bits of four and four.

use super::four::{Avx2, operators};
use super::lanes::{Lanes, NO_SHIFT, PLACE_BITS, numbers_at, rows_apart, rows_at};
use super::pair::Sse;
use super::real::{EXPONENT, Real, lane_by_lane};
use super::vec3::Vec3;
use std::arch::x86_64::*;
use std::hint::black_box;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Whether the processor has the parts of AVX-512 that are used here.
pub fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("fma")
        && is_x86_feature_detected!("popcnt")
}

/// Whether gathering loads are faster on this processor than loads of rows that are turned into lanes. Tried out once, within
/// some 50 µs: some processors take one cycle per number for a gathering load, others four. The numbers are the same.
pub fn gathers_pay() -> bool {
    static PAY: OnceLock<bool> = OnceLock::new();
    *PAY.get_or_init(|| {
        let list = vec![[1.0; 3]; 256];
        let at: Vec<u32> = (0..1024).map(|k| k * 37 % 256).collect();
        // The first round wakes the processor up.
        let best = |sum: unsafe fn(&[Vec3], &[u32]) -> f64| {
            let mut best = Duration::MAX;
            for _ in 0..4 {
                let begin = Instant::now();
                // SAFETY: only processors with AVX-512 are asked; all places are in the list.
                black_box(unsafe { sum(black_box(&list), black_box(&at)) });
                best = best.min(begin.elapsed());
            }
            best
        };
        best(sum::<true>) < best(sum::<false>)
    })
}

/// The sum of what stands at some places of a list.
#[target_feature(enable = "avx2,fma,avx512f,avx512dq,avx512vl,popcnt")]
unsafe fn sum<const GATHERS: bool>(list: &[Vec3], at: &[u32]) -> f64 {
    // SAFETY: passed on.
    unsafe {
        let mut sum = Avx512::<GATHERS>::all(0.0);
        for at in at.chunks_exact(8) {
            let [x, y, z] = Avx512::vectors(list.as_ptr(), at.as_ptr());
            sum = sum + x * y * z * Avx512::pick(list.as_ptr().cast(), at.as_ptr());
        }
        sum.numbers()[0]
    }
}

/// Eight lanes in one register. There is a value of this type only where the processor has AVX-512: what makes one from
/// nothing is unsafe and promises that. Lists are read by `GATHERS` or row by row.
#[derive(Clone, Copy, Debug)]
pub struct Avx512<const GATHERS: bool>(__m512d);

// SAFETY (all blocks): a value exists, so the processor has AVX-512; or the caller promises that.

operators! { [const GATHERS: bool] Avx512<GATHERS>, a b:
    Self(unsafe { _mm512_add_pd(a.0, b.0) }),
    Self(unsafe { _mm512_sub_pd(a.0, b.0) }),
    Self(unsafe { _mm512_mul_pd(a.0, b.0) }),
    Self(unsafe { _mm512_div_pd(a.0, b.0) })
}

impl<const GATHERS: bool> Neg for Avx512<GATHERS> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm512_xor_pd(_mm512_set1_pd(-0.0), self.0) })
    }
}

impl<const GATHERS: bool> Real for Avx512<GATHERS> {
    type Mask = __mmask8;

    #[inline(always)]
    fn like(self, a: f64) -> Self {
        Self(unsafe { _mm512_set1_pd(a) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(unsafe { _mm512_andnot_pd(_mm512_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        let bits = unsafe { _mm512_castpd_si512((self + EXPONENT).0) };
        Self(unsafe { _mm512_castsi512_pd(_mm512_slli_epi64::<52>(bits)) })
    }
    #[inline(always)]
    fn most(self, other: Self) -> Self {
        Self(unsafe { _mm512_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn least(self, other: Self) -> Self {
        Self(unsafe { _mm512_min_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn fma(self, b: Self, c: Self) -> Self {
        Self(unsafe { _mm512_fmadd_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn fnma(self, b: Self, c: Self) -> Self {
        Self(unsafe { _mm512_fnmadd_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn above(self, other: Self) -> __mmask8 {
        unsafe { _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn at_least(self, other: Self) -> __mmask8 {
        unsafe { _mm512_cmp_pd_mask::<_CMP_GE_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn keep(self, mask: __mmask8) -> Self {
        Self(unsafe { _mm512_maskz_mov_pd(mask, self.0) })
    }
    #[inline(always)]
    fn both(a: __mmask8, b: __mmask8) -> __mmask8 {
        a & b
    }
    #[inline(always)]
    fn choose(mask: __mmask8, yes: Self, no: Self) -> Self {
        Self(unsafe { _mm512_mask_blend_pd(mask, no.0, yes.0) })
    }
    #[inline(always)]
    fn any(mask: __mmask8) -> bool {
        mask != 0
    }
    #[inline(always)]
    fn each_of<const K: usize>(of: [Self; K], f: impl Fn([f64; K]) -> f64) -> Self {
        let a = lane_by_lane(of.map(Self::numbers), f);
        Self(unsafe { _mm512_loadu_pd(a.as_ptr()) })
    }
}

/// Two halves side by side.
#[inline(always)]
unsafe fn joined(low: Avx2, high: Avx2) -> __m512d {
    unsafe { _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(low.0), high.0) }
}

#[inline(always)]
unsafe fn halves(v: __m512d) -> [Avx2; 2] {
    unsafe { [Avx2(_mm512_castpd512_pd256(v)), Avx2(_mm512_extractf64x4_pd::<1>(v))] }
}

impl<const GATHERS: bool> Lanes<8> for Avx512<GATHERS> {
    type Row = Avx2;
    type Pair = Sse;
    #[inline(always)]
    fn of_rows(rows: [Avx2; 8]) -> [Self; 4] {
        let [a, b, c, d, e, f, g, h] = rows;
        unsafe {
            let (ac, bd, eg, fh) = (joined(a, c), joined(b, d), joined(e, g), joined(f, h));
            // x and z of rows a b | c d, of rows e f | g h; then y and w.
            let (xz, xz2) = (_mm512_unpacklo_pd(ac, bd), _mm512_unpacklo_pd(eg, fh));
            let (yw, yw2) = (_mm512_unpackhi_pd(ac, bd), _mm512_unpackhi_pd(eg, fh));
            [
                Self(_mm512_shuffle_f64x2::<0b10_00_10_00>(xz, xz2)),
                Self(_mm512_shuffle_f64x2::<0b10_00_10_00>(yw, yw2)),
                Self(_mm512_shuffle_f64x2::<0b11_01_11_01>(xz, xz2)),
                Self(_mm512_shuffle_f64x2::<0b11_01_11_01>(yw, yw2)),
            ]
        }
    }
    #[inline(always)]
    fn to_rows(lanes: [Self; 4]) -> [Avx2; 8] {
        let [Self(x), Self(y), Self(z), Self(w)] = lanes;
        unsafe {
            // x and y of every other row; then z and w.
            let (xy0, xy1) = (_mm512_unpacklo_pd(x, y), _mm512_unpackhi_pd(x, y));
            let (zw0, zw1) = (_mm512_unpacklo_pd(z, w), _mm512_unpackhi_pd(z, w));
            let (low, high) =
                (_mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11), _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15));
            let (ac, eg) = (_mm512_permutex2var_pd(xy0, low, zw0), _mm512_permutex2var_pd(xy0, high, zw0));
            let (bd, fh) = (_mm512_permutex2var_pd(xy1, low, zw1), _mm512_permutex2var_pd(xy1, high, zw1));
            let ([a, c], [b, d], [e, g], [f, h]) = (halves(ac), halves(bd), halves(eg), halves(fh));
            [a, b, c, d, e, f, g, h]
        }
    }
    #[inline(always)]
    fn pairs(x: Self, y: Self) -> [Self; 2] {
        unsafe { [Self(_mm512_unpacklo_pd(x.0, y.0)), Self(_mm512_unpackhi_pd(x.0, y.0))] }
    }
    #[inline(always)]
    unsafe fn all(a: f64) -> Self {
        Self(unsafe { _mm512_set1_pd(a) })
    }
    #[inline(always)]
    unsafe fn of(a: [f64; 8]) -> Self {
        Self(unsafe { _mm512_loadu_pd(a.as_ptr()) })
    }
    #[inline(always)]
    fn numbers(self) -> [f64; 8] {
        let mut out = [0.0; 8];
        unsafe { _mm512_storeu_pd(out.as_mut_ptr(), self.0) };
        out
    }
    #[inline(always)]
    fn mask(self, bits: u8) -> __mmask8 {
        bits
    }
    #[inline(always)]
    fn mask_bits(mask: __mmask8) -> u8 {
        mask
    }
    #[inline(always)]
    unsafe fn read(p: *const f64) -> Self {
        Self(unsafe { _mm512_loadu_pd(p) })
    }
    #[inline(always)]
    unsafe fn write(self, p: *mut f64) {
        unsafe { _mm512_storeu_pd(p, self.0) }
    }
    #[inline(always)]
    unsafe fn pick(list: *const f64, at: *const u32) -> Self {
        unsafe {
            if GATHERS {
                return Self(_mm512_i32gather_pd::<8>(_mm256_loadu_si256(at.cast()), list));
            }
            Self::of(numbers_at(list, at))
        }
    }
    #[inline(always)]
    unsafe fn vectors(list: *const Vec3, at: *const u32) -> Vec3<Self> {
        unsafe {
            if GATHERS {
                return gathered(list.cast(), thrice(_mm256_loadu_si256(at.cast())));
            }
            let [x, y, z, _] = Self::of_rows(rows_at(list, at));
            [x, y, z]
        }
    }
    #[inline(always)]
    unsafe fn apart(list: *const Vec3, a: *const u32, b: *const u32, shifts: &[[f64; 4]; 32]) -> Vec3<Self> {
        unsafe {
            if !GATHERS {
                let [x, y, z, _] = Self::of_rows(rows_apart(list, a, b, shifts));
                return [x, y, z];
            }
            let ([ax, ay, az], [bx, by, bz]) =
                (Self::vectors(list, a), gathered(list.cast(), thrice(places(b))));
            let which = _mm256_srli_epi32::<{ PLACE_BITS as _ }>(_mm256_loadu_si256(b.cast()));
            let mut shift = [Self::all(0.0); 3];
            if _mm256_cmpneq_epi32_mask(which, _mm256_set1_epi32(NO_SHIFT as i32)) != 0 {
                shift = gathered(shifts.as_ptr().cast(), _mm256_slli_epi32::<2>(which));
            }
            [ax - (bx + shift[0]), ay - (by + shift[1]), az - (bz + shift[2])]
        }
    }
    #[inline(always)]
    unsafe fn put(mask: __mmask8, first: u32, to: *mut u32) -> usize {
        unsafe {
            let lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
            let numbers = _mm256_add_epi32(lanes, _mm256_set1_epi32(first as i32));
            _mm256_storeu_si256(to.cast(), _mm256_maskz_compress_epi32(mask, numbers));
        }
        mask.count_ones() as usize
    }
    #[inline(always)]
    unsafe fn pack(self, mask: __mmask8, to: *mut f64) {
        // Not straight to memory: some processors take a hundred cycles for that.
        unsafe { _mm512_storeu_pd(to, _mm512_maskz_compress_pd(mask, self.0)) };
    }
}

/// The places in eight entries.
#[inline(always)]
unsafe fn places(at: *const u32) -> __m256i {
    unsafe { _mm256_and_si256(_mm256_loadu_si256(at.cast()), _mm256_set1_epi32((1 << PLACE_BITS) - 1)) }
}

/// Where the vectors at these places begin in a list of numbers.
#[inline(always)]
unsafe fn thrice(at: __m256i) -> __m256i {
    unsafe { _mm256_add_epi32(at, _mm256_add_epi32(at, at)) }
}

/// Three consecutive numbers from each of these places on, in lanes.
#[inline(always)]
unsafe fn gathered<const GATHERS: bool>(list: *const f64, at: __m256i) -> Vec3<Avx512<GATHERS>> {
    unsafe {
        [
            Avx512(_mm512_i32gather_pd::<8>(at, list)),
            Avx512(_mm512_i32gather_pd::<8>(at, list.add(1))),
            Avx512(_mm512_i32gather_pd::<8>(at, list.add(2))),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::four::Four;
    use crate::math::lanes::place;

    /// The same operations on eight numbers in these lanes.
    fn several<const N: usize, V: Lanes<N>>(rows: [V::Row; N]) -> Vec<[f64; N]> {
        let [a, b, c, d] = V::of_rows(rows);
        let mask = V::both(a.above(b), c.above(d));
        let back = V::to_rows([a + b, b - c, c * d, d / a]);
        let [p, q, r, s] = V::of_rows(back);
        let [even, odd] = V::pairs(a * b, c).map(|v| v.numbers());
        let mut two = [[0.0; N]; 2];
        for k in 0..N {
            let pairs = if k % 2 == 0 { even } else { odd };
            (two[0][k], two[1][k]) = (pairs[k / 2 * 2], pairs[k / 2 * 2 + 1]);
        }
        let none = if V::any(V::both(mask, b.above(a))) { a } else { -a };
        [
            a,
            b,
            p,
            q,
            r,
            s,
            c.abs().sqrt(),
            a.most(b),
            a.least(c),
            V::choose(mask, a, d),
            a.keep(b.at_least(c)),
            a.fma(b, c),
            a.fnma(b, c),
            none,
            a.each(f64::cbrt),
        ]
        .map(|v| v.numbers())
        .into_iter()
        .chain(two)
        .collect()
    }

    #[test]
    fn eight_lanes_have_the_bits_of_four() {
        if !has_avx512() {
            return;
        }
        let table: [[f64; 4]; 8] =
            std::array::from_fn(|k| std::array::from_fn(|l| (k as f64 - 3.5) * (l as f64 + 0.7) / 0.3));
        // SAFETY: the processor was asked; arrays of four numbers.
        let row = |k: usize| unsafe { Avx2::load(table[k].as_ptr()) };
        let eight = several::<8, Avx512<true>>(std::array::from_fn(row));
        let low = several::<4, Avx2>(std::array::from_fn(row));
        let high = several::<4, Avx2>(std::array::from_fn(|k| row(k + 4)));
        for ((e, l), h) in eight.iter().zip(&low).zip(&high) {
            let (first, second) = e.split_at(4);
            assert_eq!(first.iter().map(|a| a.to_bits()).collect::<Vec<_>>(), l.map(f64::to_bits));
            assert_eq!(second.iter().map(|a| a.to_bits()).collect::<Vec<_>>(), h.map(f64::to_bits));
        }
    }

    /// What lanes take from lists, and the numbers of the lanes that are set, by places in the middle of the list.
    fn taken<const N: usize, V: Lanes<N>>() -> Vec<u64> {
        let list: Vec<Vec3> =
            (0..40).map(|k| [0.1, 0.7, -0.3].map(|a| a * f64::from(k * k % 17 + 1))).collect();
        let numbers: Vec<f64> = (0..40).map(|k| 1.0 / f64::from(k + 3)).collect();
        let shifts = std::array::from_fn(|k| [k as f64 - 13.0, 0.3 * (k as f64 - 13.0), 0.0, 0.0]);
        let own: Vec<u32> = (0..16).map(|k| k * 7 % 40).collect();
        let with = |image: fn(u32) -> u32| (0..16).map(|k| (k * 11 % 40) | image(k) << PLACE_BITS).collect();
        let other: [Vec<u32>; 2] = [with(|_| 13), with(|k| if k % 3 == 0 { 13 } else { 2 * k % 27 })];
        let mut out = vec![];
        let mut hits = [0; 24];
        let (mut count, mut packed) = (0, [0.0; 24]);
        for k in (0..16).step_by(N) {
            // SAFETY: all places are in the lists; the test asked the processor. Hits have room for all lanes.
            let all = unsafe {
                let own = own.as_ptr().add(k);
                let others = [0, 1].map(|list: usize| other[list].as_ptr().add(k));
                let places: Vec<u32> = (0..N).map(|l| place(*others[1].add(l)) as u32).collect();
                let r = V::pick(numbers.as_ptr(), places.as_ptr());
                r.pack(r.above(V::all(0.06)), packed.as_mut_ptr().add(count));
                count += V::put(r.above(V::all(0.06)), k as u32, hits.as_mut_ptr().add(count));
                let [a, b] = others.map(|other| V::apart(list.as_ptr(), own, other, &shifts));
                [a, b, V::vectors(list.as_ptr(), places.as_ptr()), [r; 3]]
            };
            out.extend(all.map(|v| v.map(|v| v.numbers().map(f64::to_bits).to_vec())));
        }
        assert!((4..12).contains(&count), "{count}");
        // By lanes, whatever their number.
        let lanes = (0..12)
            .flat_map(|which| out.iter().skip(which / 3).step_by(4).flat_map(move |v| v[which % 3].clone()));
        let hits = hits[..count].iter().map(|k| u64::from(*k));
        lanes.chain(hits).chain(packed[..count].iter().map(|r| r.to_bits())).collect()
    }

    #[test]
    fn lists_are_read_alike() {
        let plain = taken::<4, crate::math::four::Plain>();
        if has_avx512() {
            assert_eq!(taken::<8, Avx512<false>>(), plain);
            assert_eq!(taken::<8, Avx512<true>>(), plain);
        }
    }
}
