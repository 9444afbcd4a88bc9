//! Forces of bonds kept as a list: four bonds of one particle at a time.

use super::lanes::{Lanes, Portable, Rows};
use super::lattice::{MAY_BREAK, Mode, SQUEEZED, least_critical};
use super::pmb::{SERIES, UP_TO_3, UP_TO_7, closed};
use crate::par::{self, Shared};
use crate::world::families::lattice::RowMotion;
use crate::world::families::list::{GROUP, ListBody, PairConstants, Record};
use crate::world::families::{FamilyOptions, ForceUnit, PeriView, PmbTable, VolumeRule, Window};

/// An expression for each of four partners; see `chunk::xyz` for why this is no closure.
macro_rules! four {
    (|$k:ident| $e:expr) => {
        [
            {
                let $k = 0usize;
                $e
            },
            {
                let $k = 1usize;
                $e
            },
            {
                let $k = 2usize;
                $e
            },
            {
                let $k = 3usize;
                $e
            },
        ]
    };
}

/// Fills constants, types and volumes.
pub fn refresh(body: &mut ListBody, view: &PeriView, table: &PmbTable, options: &FamilyOptions) {
    let n = body.kinds.len();
    body.pairs.clear();
    for pair in 0..n * n {
        let constants = table.get(body.kinds[pair / n], body.kinds[pair % n]).map(|k| {
            let half = 0.5 * options.lattice_spacing;
            let weight = match options.volume {
                VolumeRule::None => [1.0, 0.0],
                _ => [1.0 + (k.horizon - half) / (2.0 * half), 1.0 / (2.0 * half)],
            };
            PairConstants { c: k.c, s00: k.s00, alpha: k.alpha, weight }
        });
        body.pairs.push(constants.unwrap_or(PairConstants { s00: f64::INFINITY, ..Default::default() }));
    }
    for (r, &p) in body.particle.iter().enumerate() {
        if p != u32::MAX {
            let volume = view.volume[p as usize];
            body.record[r].volume = volume;
            body.record[r].share = if options.unit == ForceUnit::Density { 1.0 / volume } else { 1.0 };
        }
    }
}

/// Gathers displacements from positions; returns their change since the last step that advanced.
pub fn gather(body: &mut ListBody, view: &PeriView) -> RowMotion {
    let (record, moving) = (Shared::new(&mut body.record), Shared::new(&mut body.moving));
    let (slab, particle, last) = (&body.slab, &body.particle, &body.last);
    par::for_rows(moving.len(), |s| {
        let range = slab[s] as usize..slab[s + 1] as usize;
        // SAFETY: slabs do not share records.
        let (record, moving) = unsafe { (record.get(range.clone()), &mut moving.get(s..s + 1)[0]) };
        *moving = false;
        for (record, i) in record.iter_mut().zip(range) {
            let Some(x) = view.x.get(particle[i] as usize) else { continue };
            for k in 0..3 {
                record.u[k] = x[k] - record.reference[k];
                if view.bounds.periodic[k] {
                    let length = view.bounds.hi[k] - view.bounds.lo[k];
                    record.u[k] -= length * ((record.u[k] - last[i][k]) / length).round();
                }
            }
            *moving |= record.u != [0.0; 3];
        }
    });
    let changes = par::reduce(
        body.record.len(),
        |range| {
            let mut motion = RowMotion::NONE;
            for i in range.filter(|&i| particle[i] != u32::MAX) {
                let change = [0, 1, 2].map(|k| body.record[i].u[k] - last[i][k]);
                motion = motion.with(&RowMotion { least: change, most: change, ..RowMotion::NONE });
            }
            motion
        },
        |a, b| a.with(&b),
    );
    changes.unwrap_or(RowMotion::NONE)
}

/// Makes this step's displacements those of the last step that advanced.
pub fn keep(body: &mut ListBody) {
    let record = &body.record;
    par::each(&mut body.last[..], |start, last| {
        for (last, record) in last.iter_mut().zip(&record[start..]) {
            *last = record.u;
        }
    });
}

/// The list during one force evaluation, with the columns that its slabs write.
pub struct Sweep<'a> {
    /// The bonds.
    pub body: &'a ListBody,
    /// See [`ListBody::tension`].
    pub tension: Shared<'a, f32>,
    /// See [`ListBody::flagged`].
    pub flagged: Shared<'a, u8>,
    /// How bonds are treated.
    pub mode: Mode,
    /// Rules.
    pub options: FamilyOptions,
    /// Periods of the box; infinite where it is open.
    pub period: [f64; 3],
}

/// One record's bonds, as a kernel sees them.
pub struct RowTask<'a> {
    body: &'a ListBody,
    i: usize,
    /// Where the forces of record 0 would be in the window, four numbers per record.
    force: *mut f64,
    /// First record of the window; in the last slab of a ring, records before it come after the others.
    first: usize,
    period: [f64; 3],
    /// |z| below which there is no force: the first number plus the second over |xi|.
    dead: [f64; 2],
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
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let n = a.body.record.len();
        let record = a.body.record.as_ptr();
        let own = &*record.add(a.i);
        let x = [L::splat(own.reference[0]), L::splat(own.reference[1]), L::splat(own.reference[2])];
        let u = [L::splat(own.u[0]), L::splat(own.u[1]), L::splat(own.u[2])];
        let volume = L::splat(own.volume);
        let pairs = a.body.pairs.as_ptr().add(usize::from(a.body.kind[a.i]) * a.body.kinds.len());
        let (partners, alive_bits) = (a.body.partner.as_ptr(), a.body.alive.as_ptr());
        let group_kind = a.body.group_kind.as_ptr();
        let force = a.force;
        let (mut fx, mut fy, mut fz) = (zero, zero, zero);
        let (mut high, mut low) = (zero, zero);
        let mut group = a.body.start[a.i] as usize;
        let end = a.body.start[a.i + 1] as usize;
        while group < end {
            let partner = partners.add(GROUP * group);
            let alive = L::mask(*alive_bits.add(group));
            let pair = &*pairs.add(usize::from(*group_kind.add(group)));
            group += 1;
            let p = four!(|k| record.add(*partner.add(k) as usize).cast::<f64>());
            let [xj, yj, zj, vj] = L::transposed(p);
            let [uj, wj, qj, _] = L::transposed([p[0].add(4), p[1].add(4), p[2].add(4), p[3].add(4)]);
            let (mut ax, mut ay, mut az) = (xj.sub(x[0]), yj.sub(x[1]), zj.sub(x[2]));
            if PERIODIC {
                ax = nearest(ax, a.period[0]);
                ay = nearest(ay, a.period[1]);
                az = nearest(az, a.period[2]);
            }
            let (ex, ey, ez) = (uj.sub(u[0]), wj.sub(u[1]), qj.sub(u[2]));
            let square = ax.fma(ax, ay.fma(ay, az.mul(az)));
            let (bx, by, bz) = (ax.add(ex), ay.add(ey), az.add(ez));
            let q = ex.fma(bx.add(ax), ey.fma(by.add(ay), ez.mul(bz.add(az))));
            let (inverse_square, length) = (one.div(square), square.sqrt());
            let z = q.mul(inverse_square);
            let size = z.abs();
            let h = if !size.ge(L::splat(UP_TO_3)).keep(alive).any() {
                series::<L, 3>(z)
            } else if !size.ge(L::splat(UP_TO_7)).keep(alive).any() {
                series::<L, 7>(z)
            } else {
                closed(z)
            };
            let inverse = length.mul(inverse_square);
            let weight = L::splat(pair.weight[1]).fnma(length, L::splat(pair.weight[0])).min(one);
            let live = size.ge(inverse.fma(L::splat(a.dead[1]), L::splat(a.dead[0]))).keep(alive);
            let z = z.keep(live);
            high = z.max(high);
            low = z.min(low);
            let scale = L::splat(pair.c).mul(inverse).mul(weight).mul(volume.mul(vj)).mul(z);
            let factor = scale.mul(h).keep(live);
            fx = factor.fma(bx, fx);
            fy = factor.fma(by, fy);
            fz = factor.fma(bz, fz);
            let place = four!(|k| {
                let j = *partner.add(k) as usize;
                force.wrapping_add(4 * if RING && j < a.first { j + n } else { j })
            });
            L::subtract_transposed([factor.mul(bx), factor.mul(by), factor.mul(bz)], place);
        }
        let own = force.wrapping_add(4 * a.i);
        let (fx, fy, fz) = (fx.array(), fy.array(), fz.array());
        *own += (fx[0] + fx[1]) + (fx[2] + fx[3]);
        *own.add(1) += (fy[0] + fy[1]) + (fy[2] + fy[3]);
        *own.add(2) += (fz[0] + fz[1]) + (fz[2] + fz[3]);
        let (high, low) = (high.array(), low.array());
        (
            high[0].max(high[1]).max(high[2]).max(high[3]).max(0.0),
            -low[0].min(low[1]).min(low[2]).min(low[3]).min(0.0),
        )
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
    /// [`force`] for this instruction set.
    ///
    /// # Safety
    /// As for [`force`].
    unsafe fn row<const PERIODIC: bool, const RING: bool>(a: &RowTask) -> (f64, f64);
}

impl RowKernels for super::chunk::Plain {
    unsafe fn row<const PERIODIC: bool, const RING: bool>(a: &RowTask) -> (f64, f64) {
        // SAFETY: the caller's promise.
        unsafe { force::<Portable, PERIODIC, RING>(a) }
    }
}

#[cfg(target_arch = "x86_64")]
impl RowKernels for super::chunk::Wide {
    unsafe fn row<const PERIODIC: bool, const RING: bool>(a: &RowTask) -> (f64, f64) {
        #[target_feature(enable = "avx2,fma")]
        unsafe fn wide<const PERIODIC: bool, const RING: bool>(a: &RowTask) -> (f64, f64) {
            // SAFETY: the caller's promise.
            unsafe { force::<super::lanes::Avx2, PERIODIC, RING>(a) }
        }
        // SAFETY: the caller's promise includes the instruction set.
        unsafe { wide::<PERIODIC, RING>(a) }
    }
}

#[cfg(target_arch = "x86_64")]
impl RowKernels for super::chunk::Widest {
    unsafe fn row<const PERIODIC: bool, const RING: bool>(a: &RowTask) -> (f64, f64) {
        // Four lanes still, but twice as many registers.
        #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
        unsafe fn widest<const PERIODIC: bool, const RING: bool>(a: &RowTask) -> (f64, f64) {
            // SAFETY: the caller's promise.
            unsafe { force::<super::lanes::Avx2, PERIODIC, RING>(a) }
        }
        // SAFETY: the caller's promise includes the instruction set.
        unsafe { widest::<PERIODIC, RING>(a) }
    }
}

impl Sweep<'_> {
    /// Adds the forces of the bonds of one slab's records to `f`: written are the particles of this slab and
    /// of the next.
    pub fn slab<K: RowKernels>(&self, slab: usize, window: &mut Window, f: &Shared<[f64; 3]>) {
        let body = self.body;
        let slabs = body.slabs();
        let own = body.slab[slab] as usize..body.slab[slab + 1] as usize;
        let next = if slab + 1 < slabs {
            own.end..body.slab[slab + 2] as usize
        } else if body.ring {
            0..body.slab[1] as usize
        } else {
            0..0
        };
        // SAFETY: records belong to one slab.
        let (tension, flagged) = unsafe { (self.tension.get(own.clone()), self.flagged.get(own.clone())) };
        flagged.fill(0);
        let after = if slab + 1 < slabs { slab + 1 } else { 0 };
        let rest = !body.moving[slab] && (next.is_empty() || !body.moving[after]);
        if rest && self.mode.advance {
            tension.fill(0.0);
        }
        if rest && self.mode.skip {
            return;
        }
        let length = 4 * (own.len() + next.len());
        if window.force.len() < length {
            window.force.resize(length, 0.0);
        }
        window.force[..length].fill(0.0);
        let periodic = self.period.iter().any(|p| p.is_finite());
        let limit =
            body.pairs.iter().fold((f64::INFINITY, 0.0f64), |l, p| (l.0.min(p.s00), l.1.max(p.alpha)));
        let closes = body.ring && slab + 1 == slabs;
        let band = self.options.dead_band(1.0);
        let dead = if self.options.compat_lammps { [0.0, band] } else { [band, 0.0] };
        let force = window.force.as_mut_ptr().wrapping_sub(4 * own.start);
        for (k, i) in own.clone().enumerate() {
            let task = RowTask { body, i, force, first: own.start, period: self.period, dead };
            // SAFETY: bonds lead to this slab or the next, which the window covers in this order.
            let (high, low) = unsafe {
                match (periodic, closes) {
                    (false, _) => K::row::<false, false>(&task),
                    (true, false) => K::row::<true, false>(&task),
                    (true, true) => K::row::<true, true>(&task),
                }
            };
            let floor = least_critical(limit, f64::from(tension[k]));
            if self.mode.armed && self.mode.advance && high >= floor {
                flagged[k] |= MAY_BREAK;
            }
            if low >= -body.contact {
                flagged[k] |= SQUEEZED;
            }
            if self.mode.advance {
                tension[k] = (high * (1.0 + 1e-6)) as f32;
            }
        }
        for (k, i) in own.chain(next).enumerate() {
            let p = body.particle[i] as usize;
            if p < f.len() {
                // SAFETY: in bounds; slabs that reach a particle run one after the other.
                let f = unsafe { &mut *f.as_ptr().add(p) };
                let w = &window.force[4 * k..4 * k + 3];
                let share = body.record[i].share;
                *f = [f[0] + share * w[0], f[1] + share * w[1], f[2] + share * w[2]];
            }
        }
    }
}

const _: () = assert!(size_of::<Record>() == 64);
