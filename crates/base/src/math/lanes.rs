//! Values side by side for loops that are written once for any number of them, and their ways from and to lists.

use super::four::Four;
use super::pair::Pair;
use super::real::Real;
use super::vec3::Vec3;

/// Values side by side, taken from rows of four numbers and given back as such rows.
pub trait Lanes<const N: usize>: Real {
    /// Four numbers of a row.
    type Row: Four;
    /// Element `l` of row `k` becomes element `k` of lanes `l`.
    fn of_rows(rows: [Self::Row; N]) -> [Self; 4];
    /// The way back.
    fn to_rows(lanes: [Self; 4]) -> [Self::Row; N];
    /// Two numbers.
    type Pair: Pair;
    /// Lanes 0, 2, 4 … of both in turns, and lanes 1, 3, 5 ….
    fn pairs(x: Self, y: Self) -> [Self; 2];
    /// The same number in every lane.
    ///
    /// # Safety
    /// The processor must have what the form needs.
    unsafe fn all(a: f64) -> Self;
    /// Lanes of these numbers.
    ///
    /// # Safety
    /// The processor must have what the form needs.
    unsafe fn of(a: [f64; N]) -> Self;
    /// The numbers of the lanes.
    fn numbers(self) -> [f64; N];
    /// Yes in lane `k` where bit `k` is set (`self` lends only its kind).
    fn mask(self, bits: u8) -> Self::Mask;
    /// Lane `k` of a mask as bit `k`.
    fn mask_bits(mask: Self::Mask) -> u8;
    /// As many consecutive numbers as there are lanes, aligned or not.
    ///
    /// # Safety
    /// `p` must be readable for that many; the processor must have what the form needs.
    unsafe fn read(p: *const f64) -> Self;
    /// Writes the numbers of the lanes one after the other.
    ///
    /// # Safety
    /// `p` must be writable for that many.
    unsafe fn write(self, p: *mut f64);
    /// The numbers from place `at` on of a column (`self` lends only its kind).
    ///
    /// # Panics
    /// If the column ends before.
    #[inline(always)]
    fn like_column(self, column: &[f64], at: usize) -> Self {
        // SAFETY: as many numbers as there are lanes; there is a value in lanes, so the processor has what the form needs.
        unsafe { Self::read(column[at..at + N].as_ptr()) }
    }
    /// Puts the numbers of the lanes to a column, from place `at` on.
    ///
    /// # Panics
    /// If the column ends before.
    #[inline(always)]
    fn to_column(self, column: &mut [f64], at: usize) {
        // SAFETY: as many numbers as there are lanes.
        unsafe { self.write(column[at..at + N].as_mut_ptr()) }
    }
    /// The numbers at these places of a list.
    ///
    /// # Safety
    /// `at` must be readable for as many places of the list as there are lanes.
    unsafe fn pick(list: *const f64, at: *const u32) -> Self;
    /// The vectors at these places of a list.
    ///
    /// # Safety
    /// As [`Lanes::pick`].
    unsafe fn vectors(list: *const Vec3, at: *const u32) -> Vec3<Self>;
    /// a − (b + shift) of the vectors at these places of a list, where b has entries that hold [`place`] and which of the `shifts`
    /// it is; [`NO_SHIFT`] is none.
    ///
    /// # Safety
    /// As [`Lanes::pick`], and there must be these shifts.
    unsafe fn apart(list: *const Vec3, a: *const u32, b: *const u32, shifts: &[[f64; 4]; 32]) -> Vec3<Self>;
    /// Puts `first` and the numbers of the lanes that are set to memory, and something behind them; how many are set.
    ///
    /// # Safety
    /// There must be room for as many as there are lanes.
    unsafe fn put(mask: Self::Mask, first: u32, to: *mut u32) -> usize;
    /// Puts the numbers in the lanes that are set to memory, and something behind them.
    ///
    /// # Safety
    /// As [`Lanes::put`].
    unsafe fn pack(self, mask: Self::Mask, to: *mut f64);
}

/// Says that what lies at `p` will be read soon; where nothing does, no harm is done.
#[inline(always)]
pub fn prefetch(p: *const f64) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a hint, which reads nothing.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(p.cast()) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = p;
}

/// Bits of an entry that hold a place in a list; the bits above them select the shift.
pub const PLACE_BITS: u32 = 27;

/// Of 27 shifts, by −1, 0 or 1 in three directions, the one in the middle that is none.
pub const NO_SHIFT: u32 = 13;

/// The place in an entry.
#[inline(always)]
pub fn place(entry: u32) -> usize {
    (entry & ((1 << PLACE_BITS) - 1)) as usize
}

/// By bits of a mask: the lanes that are set, in order.
const LANES: [[u32; 4]; 16] = lanes();

/// By bits of a mask, four bits each: how many lanes are set.
const COUNTS: u64 = 0x4332_3221_3221_2110;

const fn lanes() -> [[u32; 4]; 16] {
    let (mut table, mut bits) = ([[0; 4]; 16], 0);
    while bits < 16 {
        let (mut lane, mut count) = (0, 0);
        while lane < 4 {
            if bits >> lane & 1 == 1 {
                table[bits][count] = lane as u32;
                count += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    table
}

/// Rows of a − (b + shift), one for each lane.
///
/// # Safety
/// As [`Lanes::apart`].
#[inline(always)]
pub(super) unsafe fn rows_apart<F: Four, const N: usize>(
    list: *const Vec3,
    a: *const u32,
    b: *const u32,
    shifts: &[[f64; 4]; 32],
) -> [F; N] {
    // SAFETY: passed on.
    unsafe {
        let mut rows = [F::splat(0.0); N];
        for lane in 0..N {
            let (a, b) = (*a.add(lane), *b.add(lane));
            let shift = F::load(shifts.as_ptr().add((b >> PLACE_BITS) as usize).cast());
            rows[lane] =
                F::load3(list.add(a as usize).cast()) - (F::load3(list.add(place(b)).cast()) + shift);
        }
        rows
    }
}

/// The vectors at these places as rows.
///
/// # Safety
/// As [`Lanes::vectors`].
#[inline(always)]
pub(super) unsafe fn rows_at<F: Four, const N: usize>(list: *const Vec3, at: *const u32) -> [F; N] {
    // SAFETY: passed on.
    unsafe {
        let mut rows = [F::splat(0.0); N];
        for lane in 0..N {
            rows[lane] = F::load3(list.add(*at.add(lane) as usize).cast());
        }
        rows
    }
}

/// The numbers at these places.
///
/// # Safety
/// As [`Lanes::pick`].
#[inline(always)]
pub(super) unsafe fn numbers_at<const N: usize>(list: *const f64, at: *const u32) -> [f64; N] {
    // SAFETY: passed on.
    unsafe {
        let mut numbers = [0.0; N];
        for lane in 0..N {
            numbers[lane] = *list.add(*at.add(lane) as usize);
        }
        numbers
    }
}

/// Four numbers from `part` on of each of these rows, turned into lanes.
///
/// # Safety
/// The processor must have what the lanes need, and there must be such rows.
#[inline(always)]
pub unsafe fn load_rows<V: Lanes<N>, const N: usize>(rows: &[*mut f64; N], part: usize) -> [V; 4] {
    // SAFETY: passed on.
    unsafe {
        let mut four = [V::Row::splat(0.0); N];
        for lane in 0..N {
            four[lane] = V::Row::load(rows[lane].add(part));
        }
        V::of_rows(four)
    }
}

/// The way back: four numbers from `part` on of each of these rows, one row after the other.
///
/// # Safety
/// As [`load_rows`].
#[inline(always)]
pub unsafe fn store_rows<V: Lanes<N>, const N: usize>(rows: &[*mut f64; N], part: usize, lanes: [V; 4]) {
    let four = V::to_rows(lanes);
    for lane in 0..N {
        // SAFETY: passed on.
        unsafe { four[lane].store(rows[lane].add(part)) };
    }
}

impl<F: Four> Lanes<4> for F {
    type Row = F;
    #[inline(always)]
    fn of_rows(rows: [F; 4]) -> [F; 4] {
        F::transpose(rows)
    }
    #[inline(always)]
    fn to_rows(lanes: [F; 4]) -> [F; 4] {
        F::transpose(lanes)
    }
    type Pair = F::Two;
    #[inline(always)]
    fn pairs(x: F, y: F) -> [F; 2] {
        F::pairs_of(x, y)
    }
    #[inline(always)]
    unsafe fn all(a: f64) -> F {
        // SAFETY: passed on.
        unsafe { F::splat(a) }
    }
    #[inline(always)]
    unsafe fn of(a: [f64; 4]) -> F {
        // SAFETY: an array of four numbers.
        unsafe { F::load(a.as_ptr()) }
    }
    #[inline(always)]
    fn numbers(self) -> [f64; 4] {
        let mut out = [0.0; 4];
        // SAFETY: an array of four numbers.
        unsafe { self.store(out.as_mut_ptr()) };
        out
    }
    #[inline(always)]
    fn mask(self, bits: u8) -> F::Mask {
        self.with_bits(bits)
    }
    #[inline(always)]
    fn mask_bits(mask: F::Mask) -> u8 {
        F::bits(mask)
    }
    #[inline(always)]
    unsafe fn read(p: *const f64) -> F {
        // SAFETY: passed on.
        unsafe { F::load(p) }
    }
    #[inline(always)]
    unsafe fn write(self, p: *mut f64) {
        // SAFETY: passed on.
        unsafe { self.store(p) }
    }
    #[inline(always)]
    unsafe fn pick(list: *const f64, at: *const u32) -> F {
        // SAFETY: passed on.
        unsafe { F::load(numbers_at::<4>(list, at).as_ptr()) }
    }
    #[inline(always)]
    unsafe fn vectors(list: *const Vec3, at: *const u32) -> Vec3<F> {
        // SAFETY: passed on.
        let [x, y, z, _] = F::transpose(unsafe { rows_at(list, at) });
        [x, y, z]
    }
    #[inline(always)]
    unsafe fn apart(list: *const Vec3, a: *const u32, b: *const u32, shifts: &[[f64; 4]; 32]) -> Vec3<F> {
        // SAFETY: passed on.
        let [x, y, z, _] = F::transpose(unsafe { rows_apart(list, a, b, shifts) });
        [x, y, z]
    }
    #[inline(always)]
    unsafe fn put(mask: F::Mask, first: u32, to: *mut u32) -> usize {
        let bits = F::bits(mask);
        let [a, b, c, d] = LANES[usize::from(bits & 15)];
        // SAFETY: the caller's promise.
        unsafe { to.cast::<[u32; 4]>().write([first + a, first + b, first + c, first + d]) };
        (COUNTS >> (4 * bits) & 15) as usize
    }
    #[inline(always)]
    unsafe fn pack(self, mask: F::Mask, to: *mut f64) {
        let of = self.at(LANES[usize::from(F::bits(mask) & 15)]);
        // SAFETY: the caller's promise.
        unsafe { of.store(to) };
    }
}
