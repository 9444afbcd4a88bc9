//! The innermost loops of the list layout: all bonds that a record owns, four or eight at a time.

use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

use super::lanes::{Lanes, Portable};
use super::pmb::{SERIES, UP_TO_3, UP_TO_7, closed};
use super::rows::{MOST, Rows};
use super::wide::{self, FARTHEST, UP_TO_FARTHEST};
use crate::families::FamilyOptions;
use crate::families::list::{GROUP, ListBody, PairConstants};

/// An expression for each partner that there is a lane for, else `$none`; see `chunk::xyz` for why this is no
/// closure.
macro_rules! partners {
    ($lanes:ty, $none:expr, |$k:ident| $e:expr) => {
        [
            partners!(@ $lanes, $none, 0, $k, $e),
            partners!(@ $lanes, $none, 1, $k, $e),
            partners!(@ $lanes, $none, 2, $k, $e),
            partners!(@ $lanes, $none, 3, $k, $e),
            partners!(@ $lanes, $none, 4, $k, $e),
            partners!(@ $lanes, $none, 5, $k, $e),
            partners!(@ $lanes, $none, 6, $k, $e),
            partners!(@ $lanes, $none, 7, $k, $e),
        ]
    };
    (@ $lanes:ty, $none:expr, $n:literal, $k:ident, $e:expr) => {
        if $n < <$lanes>::WIDTH {
            let $k = $n as usize;
            $e
        } else {
            $none
        }
    };
}

/// One record's bonds, as a kernel sees them.
pub struct RowTask<'a> {
    /// The bonds.
    pub body: &'a ListBody,
    /// The record.
    pub i: usize,
    /// Where the forces of record 0 would be in the window, four numbers per record.
    pub force: *mut f64,
    /// First record of the window; in the last slab of a ring, records before it come after the others.
    pub first: usize,
    /// Periods of the box; infinite where it is open.
    pub period: [f64; 3],
    /// |z| below which there is no force: the first number plus the second over |xi|.
    pub dead: [f64; 2],
}

/// See [`RowTask::dead`].
pub fn dead(options: &FamilyOptions) -> [f64; 2] {
    let band = options.dead_band(1.0);
    if options.compat_lammps { [0.0, band] } else { [band, 0.0] }
}

/// The record itself, in all lanes.
struct Own<L> {
    x: [L; 3],
    u: [L; 3],
    volume: L,
}

impl<L: Lanes> Own<L> {
    #[inline(always)]
    unsafe fn of(a: &RowTask) -> Self {
        // SAFETY: passed on to the caller.
        unsafe {
            let own = &a.body.record[a.i];
            let [x, u] = [own.reference, own.u];
            Self {
                x: [L::splat(x[0]), L::splat(x[1]), L::splat(x[2])],
                u: [L::splat(u[0]), L::splat(u[1]), L::splat(u[2])],
                volume: L::splat(own.volume),
            }
        }
    }
}

/// The groups of a record's bonds, as many at a time as fill the lanes.
struct Walk {
    group: usize,
    end: usize,
    /// Where a group is alone but lanes are eight, the owner fills up the rest; for each place in a block.
    alone: *mut [u32; MOST],
}

/// So many times the lanes are reckoned before their forces are handed over: the processor looks ahead farther when
/// it need not wait for stores (measured: a fifth of the time).
const BLOCK: usize = 8;

/// Some bonds of one record: where their partners stand, and which of them live.
struct Few<'a> {
    partner: *const u32,
    alive: u8,
    pair: &'a PairConstants,
}

impl Walk {
    #[inline(always)]
    fn of(a: &RowTask, alone: &mut [[u32; MOST]; BLOCK]) -> Self {
        let start = &a.body.start;
        Self { group: start[a.i] as usize, end: start[a.i + 1] as usize, alone: alone.as_mut_ptr() }
    }

    /// The next bonds of a pair of types, to be used before the same `place` is asked for again.
    ///
    /// # Safety
    /// There must be a group left, and `place` is below [`BLOCK`]; what the walk was made with lives.
    #[inline(always)]
    unsafe fn next<'a, L: Lanes>(&mut self, a: &RowTask<'a>, place: usize) -> Few<'a> {
        // SAFETY: groups lie within the body's columns, kinds within its pairs.
        unsafe {
            let (kinds, bits) = (a.body.group_kind.as_ptr(), a.body.alive.as_ptr());
            let mut partner = a.body.partner.as_ptr().add(GROUP * self.group);
            let kind = *kinds.add(self.group);
            let mut alive = *bits.add(self.group);
            let pairs = usize::from(*a.body.kind.get_unchecked(a.i)) * a.body.kinds.len();
            let pair = a.body.pairs.get_unchecked(pairs + usize::from(kind));
            self.group += 1;
            if L::WIDTH > GROUP {
                if self.group < self.end && *kinds.add(self.group) == kind {
                    alive |= *bits.add(self.group) << GROUP;
                    self.group += 1;
                } else {
                    let alone = self.alone.add(place).cast::<u32>();
                    partner.copy_to_nonoverlapping(alone, GROUP);
                    partner = alone;
                }
            }
            Few { partner, alive, pair }
        }
    }
}

/// What a law needs of some bonds.
struct Shape<L> {
    /// xi + eta.
    bond: [L; 3],
    /// z, anything for bonds that do not live.
    z: L,
    /// Bonds that live and are stretched.
    live: L,
    /// Their mask without the dead band.
    alive: L,
    /// |xi|.
    length: L,
    /// Share of the partner's volume within the horizon.
    weight: L,
    /// c w V_i V_j/|xi|.
    scale: L,
    /// The partner's volume.
    volume: L,
}

#[inline(always)]
unsafe fn shape<L: Rows, const PERIODIC: bool>(a: &RowTask, own: &Own<L>, few: &Few) -> Shape<L> {
    // SAFETY: partners are records.
    unsafe {
        let one = L::splat(1.0);
        let (record, partner, pair) = (a.body.record.as_ptr(), few.partner, few.pair);
        let rows = partners!(L, null(), |k| record.add(*partner.add(k) as usize).cast::<f64>());
        let [xj, yj, zj, vj, uj, wj, qj] = L::transposed(&rows);
        let (mut ax, mut ay, mut az) = (xj.sub(own.x[0]), yj.sub(own.x[1]), zj.sub(own.x[2]));
        if PERIODIC {
            ax = nearest(ax, a.period[0]);
            ay = nearest(ay, a.period[1]);
            az = nearest(az, a.period[2]);
        }
        let (ex, ey, ez) = (uj.sub(own.u[0]), wj.sub(own.u[1]), qj.sub(own.u[2]));
        let square = ax.fma(ax, ay.fma(ay, az.mul(az)));
        let (bx, by, bz) = (ax.add(ex), ay.add(ey), az.add(ez));
        let q = ex.fma(bx.add(ax), ey.fma(by.add(ay), ez.mul(bz.add(az))));
        let (inverse_square, length) = (one.div(square), square.sqrt());
        let z = q.mul(inverse_square);
        let alive = L::mask(few.alive);
        let inverse = length.mul(inverse_square);
        let weight = L::splat(pair.weight[1]).fnma(length, L::splat(pair.weight[0])).min(one);
        let live = z.abs().ge(inverse.fma(L::splat(a.dead[1]), L::splat(a.dead[0]))).keep(alive);
        let scale = L::splat(pair.c).mul(inverse).mul(weight).mul(own.volume.mul(vj));
        Shape { bond: [bx, by, bz], z, live, alive, length, weight, scale, volume: vj }
    }
}

/// Adds the forces of a record's own bonds, times the volumes of both ends, to both ends; returns the largest
/// z and the largest -z. `PERIODIC`: bonds cross faces. `RING`: the window closes the ring.
///
/// # Safety
/// Every partner must lie in the window behind `force`, untouched by others; the processor must have what `L`
/// needs.
#[inline(always)]
unsafe fn force<L: Rows, const PERIODIC: bool, const RING: bool>(a: &RowTask) -> (f64, f64) {
    // SAFETY: partners are records; their places in the window exist by the caller's promise.
    unsafe {
        let n = a.body.record.len();
        let own = Own::<L>::of(a);
        let mut sum = [L::none(); 3];
        let (mut high, mut low) = (L::splat(0.0), L::splat(0.0));
        let mut alone = [[a.i as u32; MOST]; BLOCK];
        let mut walk = Walk::of(a, &mut alone);
        let mut ready = [MaybeUninit::<([L; 3], *const u32)>::uninit(); BLOCK];
        while walk.group < walk.end {
            let mut count = 0;
            while count < BLOCK && walk.group < walk.end {
                let few = walk.next::<L>(a, count);
                let s = shape::<L, PERIODIC>(a, &own, &few);
                let h = pull(s.z, s.alive);
                let z = s.z.keep(s.live);
                high = z.max(high);
                low = z.min(low);
                let factor = s.scale.mul(z).mul(h).keep(s.live);
                let [bx, by, bz] = s.bond;
                sum = [factor.add_to(bx, sum[0]), factor.add_to(by, sum[1]), factor.add_to(bz, sum[2])];
                ready[count].write(([factor.mul(bx), factor.mul(by), factor.mul(bz)], few.partner));
                count += 1;
            }
            for some in &ready[..count] {
                let (columns, partner) = some.assume_init();
                let place = partners!(L, null_mut(), |k| {
                    let j = *partner.add(k) as usize;
                    a.force.wrapping_add(4 * if RING && j < a.first { j + n } else { j })
                });
                L::subtract_transposed(columns, &place);
            }
        }
        let own = a.force.wrapping_add(4 * a.i);
        *own += L::total(sum[0]);
        *own.add(1) += L::total(sum[1]);
        *own.add(2) += L::total(sum[2]);
        let mut most = [[0.0f64; MOST]; 2];
        high.store(most[0].as_mut_ptr());
        low.store(most[1].as_mut_ptr());
        (most[0].iter().copied().fold(0.0, f64::max), -most[1].iter().copied().fold(0.0, f64::min))
    }
}

/// Energy and the six components of the virial.
pub const SUMS: usize = 7;

/// Energy of both ends of a record's own bonds, 1/4 c w s² |xi| times the volumes V_i + V_j, or 2 V_i V_j if
/// `newton`, and their virial −c w V_i V_j s/(1 + s)/|xi| y_a y_b with y = xi + eta.
///
/// # Safety
/// The processor must have what `L` needs.
#[inline(always)]
unsafe fn sums<L: Rows, const PERIODIC: bool>(a: &RowTask, newton: bool) -> [f64; SUMS] {
    // SAFETY: partners are records.
    unsafe {
        let one = L::splat(1.0);
        let own = Own::<L>::of(a);
        let mut sum = [L::none(); SUMS];
        let mut alone = [[a.i as u32; MOST]; BLOCK];
        let mut walk = Walk::of(a, &mut alone);
        while walk.group < walk.end {
            let few = walk.next::<L>(a, 0);
            let s = shape::<L, PERIODIC>(a, &own, &few);
            let root = one.add(s.z.keep(s.live)).sqrt();
            // s/(1 + s), and s.
            let share = s.z.div(root.fma(root, root)).keep(s.live);
            let stretch = share.mul(root);
            let both = match newton {
                true => own.volume.mul(s.volume).mul(L::splat(2.0)),
                false => own.volume.add(s.volume),
            };
            let cw = L::splat(0.25 * few.pair.c).mul(s.weight);
            let energy = cw.mul(s.length).mul(both).mul(stretch);
            let pull = s.scale.mul(share).keep(s.live);
            let [x, y, z] = s.bond;
            let p = [pull.mul(x), pull.mul(y), pull.mul(z)];
            sum[0] = energy.add_to(stretch, sum[0]);
            sum[1] = p[0].add_to(x, sum[1]);
            sum[2] = p[1].add_to(y, sum[2]);
            sum[3] = p[2].add_to(z, sum[3]);
            sum[4] = p[0].add_to(y, sum[4]);
            sum[5] = p[0].add_to(z, sum[5]);
            sum[6] = p[1].add_to(z, sum[6]);
        }
        let [energy, virial @ ..] = sum;
        let [a, b, c, d, e, f] = virial;
        [L::total(energy), -L::total(a), -L::total(b), -L::total(c), -L::total(d), -L::total(e), -L::total(f)]
    }
}

/// h(z), by the cheapest way that is exact for all living bonds of a group. The choice is made group by group
/// for any number of lanes: the bits do not depend on it.
#[inline(always)]
unsafe fn pull<L: Lanes>(z: L, alive: L) -> L {
    // SAFETY: passed on to the caller.
    unsafe {
        let size = z.abs();
        let warm = size.ge(L::splat(UP_TO_3)).keep(alive).bits();
        if warm == 0 {
            return series::<L, 3>(z);
        }
        let hot = size.ge(L::splat(UP_TO_7)).keep(alive).bits();
        let (first, rest) = (ONE_GROUP, !ONE_GROUP);
        let low = by_heat(z, warm & first, hot & first);
        if L::WIDTH == GROUP {
            return low;
        }
        low.keep(L::mask(first)).add(by_heat(z, warm & rest, hot & rest).keep(L::mask(rest)))
    }
}

/// Lanes of the first group.
const ONE_GROUP: u8 = (1 << GROUP) - 1;

#[inline(always)]
unsafe fn by_heat<L: Lanes>(z: L, warm: u8, hot: u8) -> L {
    // SAFETY: passed on to the caller.
    unsafe {
        match (warm, hot) {
            (0, _) => series::<L, 3>(z),
            (_, 0) => series::<L, 7>(z),
            _ if z.abs().ge(L::splat(UP_TO_FARTHEST)).bits() & hot == 0 => wide::share::<L, FARTHEST>(z),
            _ => closed(z),
        }
    }
}

/// h(z) by its series up to z^`DEGREE`.
#[inline(always)]
unsafe fn series<L: Lanes, const DEGREE: usize>(z: L) -> L {
    // SAFETY: passed on to the caller.
    unsafe {
        let mut h = L::splat(SERIES[DEGREE]);
        let mut k = DEGREE;
        while k > 0 {
            k -= 1;
            h = h.fma(z, L::splat(SERIES[k]));
        }
        h
    }
}

/// The shortest image of a difference.
#[inline(always)]
unsafe fn nearest<L: Lanes>(d: L, period: f64) -> L {
    // SAFETY: passed on to the caller.
    unsafe {
        let half = L::splat(0.5 * period);
        let full = L::splat(period);
        let d = d.sub(full.keep(d.ge(half)));
        d.add(full.keep(L::splat(0.0).sub(half).ge(d)))
    }
}

/// The kernels of one instruction set.
pub trait RowKernels: Sync {
    /// Adds forces; see `force` above.
    ///
    /// # Safety
    /// Every partner must lie in the window behind the task's `force`, untouched by others; the processor must
    /// have the instruction set.
    unsafe fn row<const PERIODIC: bool, const RING: bool>(a: &RowTask) -> (f64, f64);
    /// Energy and virial of a record's own bonds; see `sums` above.
    ///
    /// # Safety
    /// The processor must have the instruction set.
    unsafe fn row_sums<const PERIODIC: bool>(a: &RowTask, newton: bool) -> [f64; SUMS];
}

/// Kernels of one instruction set from those for its lanes.
macro_rules! compiled_for {
    ($kernels:ty, $lanes:ty $(, $features:literal)?) => {
        impl RowKernels for $kernels {
            unsafe fn row<const PERIODIC: bool, const RING: bool>(a: &RowTask) -> (f64, f64) {
                $(#[target_feature(enable = $features)])?
                unsafe fn inner<const PERIODIC: bool, const RING: bool>(a: &RowTask) -> (f64, f64) {
                    // SAFETY: the caller's promise.
                    unsafe { force::<$lanes, PERIODIC, RING>(a) }
                }
                // SAFETY: the caller's promise includes the instruction set.
                unsafe { inner::<PERIODIC, RING>(a) }
            }
            unsafe fn row_sums<const PERIODIC: bool>(a: &RowTask, newton: bool) -> [f64; SUMS] {
                $(#[target_feature(enable = $features)])?
                unsafe fn inner<const PERIODIC: bool>(a: &RowTask, newton: bool) -> [f64; SUMS] {
                    // SAFETY: the caller's promise.
                    unsafe { sums::<$lanes, PERIODIC>(a, newton) }
                }
                // SAFETY: the caller's promise includes the instruction set.
                unsafe { inner::<PERIODIC>(a, newton) }
            }
        }
    };
}

compiled_for!(super::chunk::Plain, Portable);
#[cfg(target_arch = "x86_64")]
compiled_for!(super::chunk::Wide, super::lanes::Avx2, "avx2,fma");
#[cfg(target_arch = "x86_64")]
compiled_for!(super::chunk::Widest, super::lanes512::Avx512, "avx512f,avx512dq,avx512vl,avx2,fma");
