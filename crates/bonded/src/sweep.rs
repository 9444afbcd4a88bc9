//! The loop over bonds: forces of all bonds, in lanes and threads, then sums by particle. Sums run in the
//! order of the columns: the same bits for any number of threads and any form of lanes.

use crate::columns::{Columns, GROUP};
use crate::law::{Acts, BondLaw, Ends, Motion};
use perigrain_base::math::body::{Quat, after};
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::four::Four;
use perigrain_base::math::lanes::Lanes;
use perigrain_base::math::periods::Periods;
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, add, sub};
use perigrain_base::par;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// Particle data: one row per particle in each column.
#[derive(Clone, Copy, Debug)]
pub struct Body<'a> {
    /// Positions [length].
    pub x: &'a [Vec3],
    /// Velocities [velocity].
    pub v: &'a [Vec3],
    /// Spins [1/time]; may be empty for laws without torques.
    pub omega: &'a [Vec3],
    /// Orientations; may be empty for laws without torques.
    pub quat: &'a [Quat],
    /// Edge lengths of the box, 0 along directions that are not periodic [length].
    pub periods: Periods,
}

/// A pass over all bonds.
#[derive(Clone, Copy, Debug)]
pub struct Sweep<'a, const C: usize, K> {
    /// The bonds.
    pub columns: &'a Columns<C>,
    /// Coefficients by type, from 1.
    pub coeffs: &'a [Option<K>],
    /// The particles.
    pub body: Body<'a>,
    /// Whether some bond is damped.
    pub damped: bool,
    /// Whether bonds break.
    pub breaks: bool,
    /// Whether dissipated power is recorded.
    pub counts: bool,
    /// Which groups of bonds are evaluated, if not all.
    pub groups: Option<&'a [bool]>,
}

/// Four numbers within one cache line: rows across two lines are read at half the speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub struct Row(pub [f64; 4]);

/// Results per bond, one row each.
#[derive(Clone, Debug, Default)]
pub struct Out {
    /// Force on the first end, and the energy; for a bond that breaks, the energy it had.
    pub force: Vec<Row>,
    /// Torques on both ends; empty for laws without torques.
    pub torque: Vec<[Row; 2]>,
    /// Fraction of its strength used by each bond of a group in which one breaks; other values are
    /// meaningless, and below 1.
    pub load: Vec<f64>,
    /// Dissipated power; empty if not recorded.
    pub power: Vec<f64>,
    /// Whether some bond exceeds its strength: its force is zero.
    pub broken: bool,
}

/// The largest number below 1: any larger number is at least 1.
pub const BELOW_ONE: f64 = 1.0 - 0.5 * f64::EPSILON;

/// All bonds under a law.
///
/// # Panics
/// If columns refer to missing particles, or to types without coefficients.
pub fn all<const C: usize, L: BondLaw<C>>(law: &L, pass: &Sweep<'_, C, L::Coeffs>, out: &mut Out) {
    // SAFETY: the processor supports this form.
    unsafe { all_in(Form::here(), law, pass, out) };
}

/// The same in a form.
///
/// # Safety
/// The processor must support the form.
pub(crate) unsafe fn all_in<const C: usize, L: BondLaw<C>>(
    form: Form,
    law: &L,
    pass: &Sweep<'_, C, L::Coeffs>,
    out: &mut Out,
) {
    let (rows, particles) = (pass.columns.rows(), pass.body.x.len());
    assert!(pass.columns.reach <= particles && (!pass.damped || pass.body.v.len() == particles));
    assert!(!L::TURNS || (pass.body.quat.len() == particles && pass.body.omega.len() == particles));
    assert!(!L::TURNS || pass.columns.axis.iter().all(|axis| axis.len() == rows));
    assert!(pass.columns.own.iter().all(|own| own.len() == rows));
    assert!(particles < 1 << perigrain_base::math::lanes::PLACE_BITS);
    out.force.resize(rows, Row::default());
    out.load.resize(rows, 0.0);
    out.torque.resize(if L::TURNS { rows } else { 0 }, [Row::default(); 2]);
    out.power.resize(if pass.counts { rows } else { 0 }, 0.0);
    let broken = AtomicBool::new(false);
    let torque = L::TURNS.then_some(&mut out.torque[..]);
    let power = pass.counts.then_some(&mut out.power[..]);
    let columns = (&mut out.force[..], &mut out.load[..], torque, power);
    par::each(columns, |first, (force, load, torque, power)| {
        let chunk = Chunk { law, pass, first, force, load, torque, power };
        // SAFETY: the processor supports the form (caller), and the lists have the lengths asserted above.
        if unsafe { form.run(chunk) } {
            broken.store(true, Ordering::Relaxed);
        }
    });
    out.broken = broken.into_inner();
}

/// A part of a pass: whole groups from `first` on.
struct Chunk<'a, 'b, const C: usize, L: BondLaw<C>> {
    law: &'a L,
    pass: &'a Sweep<'b, C, L::Coeffs>,
    first: usize,
    force: &'a mut [Row],
    load: &'a mut [f64],
    torque: Option<&'a mut [[Row; 2]]>,
    power: Option<&'a mut [f64]>,
}

impl<const C: usize, L: BondLaw<C>> InLanes for Chunk<'_, '_, C, L> {
    /// Whether some bond broke.
    type Out = bool;

    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(mut self) -> bool {
        let (mut at, mut broken) = (0, false);
        // Chunks consist of whole groups.
        let groups = self.first / GROUP..(self.first + self.force.len()) / GROUP;
        let (kinds, evaluated) = (&self.pass.columns.kinds, self.pass.groups);
        let is_evaluated = |group: usize| evaluated.is_none_or(|groups| groups[group]);
        let mut group = groups.start;
        // SAFETY: the caller's guarantee; all rows are of this chunk.
        unsafe {
            while group < groups.end {
                let (kind, acts) = (kinds[group], is_evaluated(group));
                let alike = |next: &usize| kinds[*next] == kind && is_evaluated(*next) == acts;
                let many = (group..groups.end).take_while(alike).count();
                group += many;
                let to = at + many * GROUP;
                if let Some(k) = self.pass.coeffs[usize::from(kind)].filter(|_| acts) {
                    broken |= match self.pass.damped {
                        true => self.stretch::<N, V, true>(at..to, k),
                        false => self.stretch::<N, V, false>(at..to, k),
                    };
                }
                at = to;
            }
        }
        broken
    }
}

impl<const C: usize, L: BondLaw<C>> Chunk<'_, '_, C, L> {
    /// Rows of this chunk with bonds of one type. Returns whether some bond broke.
    ///
    /// # Safety
    /// As of [`InLanes::run`].
    #[inline(always)]
    unsafe fn stretch<const N: usize, V: Lanes<N>, const DAMPED: bool>(
        &mut self,
        rows: Range<usize>,
        k: L::Coeffs,
    ) -> bool {
        // Hoisted out of the loop: the compiler must assume that the stores of forces could change these
        // values.
        let (columns, Body { x, v, omega, quat, periods }) = (self.pass.columns, self.pass.body);
        let (x, v, omega) = (x.as_ptr(), v.as_ptr(), omega.as_ptr());
        let [firsts, seconds] = [0, 1].map(|end: usize| columns.ends[end].as_ptr());
        let (lengths, whole) = (columns.length.as_ptr(), columns.whole().as_ptr());
        let owns: [*const f64; C] = std::array::from_fn(|c| columns.own[c].as_ptr());
        let (repeats, breaks) = (periods.length != [0.0; 3], self.pass.breaks);
        let force = self.force.as_mut_ptr();
        let mut broken = false;
        // SAFETY: the processor supports the lanes (caller); all columns have as many rows as forces, in
        // whole groups, and all indices are particles (checked in `all`).
        unsafe {
            let (none, one) = (V::all(0.0), V::all(1.0));
            for at in rows.step_by(N) {
                let row = self.first + at;
                let (first, second) = (firsts.add(row), seconds.add(row));
                let mut ends = Ends {
                    r: sub(V::vectors(x, first), V::vectors(x, second)),
                    length: column(lengths.add(row)),
                    axis: [none, none, one],
                    quat: [[one, none, none, none]; 2],
                };
                if repeats {
                    ends.r = nearest(ends.r, &periods);
                }
                if L::TURNS {
                    ends.axis = [
                        column(columns.axis[0].as_ptr().add(row)),
                        column(columns.axis[1].as_ptr().add(row)),
                        column(columns.axis[2].as_ptr().add(row)),
                    ];
                    ends.quat = [quats::<N, V>(quat, first), quats::<N, V>(quat, second)];
                    if !columns.turned.is_empty() {
                        ends.quat[0] = after(ends.quat[0], rows_of::<N, V>(&columns.turned[row..]));
                    }
                }
                let mut motion = None;
                if DAMPED {
                    let mut spins = [[none; 3]; 2];
                    if L::TURNS {
                        spins = [V::vectors(omega, first), V::vectors(omega, second)];
                    }
                    let v = sub(V::vectors(v, first), V::vectors(v, second));
                    motion = Some(Motion { v, omega: spins });
                }
                let mut own = [none; C];
                for c in 0..C {
                    own[c] = column(owns[c].add(row));
                }
                let mut acts = self.law.act(&k, &own, &ends, motion.as_ref());
                // Few groups have lost a bond: the others skip this read.
                if !*whole.add(row / GROUP) {
                    let holds = column::<N, V>(columns.alive().as_ptr().add(row)).above(none);
                    acts = Acts::choose(holds, acts, Acts::none(none));
                }
                if breaks {
                    let over = acts.load.above(V::all(BELOW_ONE));
                    if V::any(over) {
                        broken = true;
                        self.load[at..at + N].copy_from_slice(&acts.load.numbers());
                        let energy = acts.energy;
                        acts = Acts { energy, ..Acts::choose(over, Acts::none(none), acts) };
                    }
                }
                let f = acts.force;
                let rows = V::to_rows([f[0], f[1], f[2], acts.energy]);
                for lane in 0..N {
                    rows[lane].store(force.add(at + lane).cast());
                }
                if let Some(power) = &mut self.power {
                    power[at..at + N].copy_from_slice(&acts.power.numbers());
                }
                if let Some(torque) = self.torque.as_mut().filter(|_| L::TURNS) {
                    for end in 0..2 {
                        let t = acts.torque[end];
                        let rows = V::to_rows([t[0], t[1], t[2], none]);
                        for lane in 0..N {
                            rows[lane].store(torque[at + lane][end].0.as_mut_ptr());
                        }
                    }
                }
            }
        }
        broken
    }
}

/// Numbers of a column.
///
/// # Safety
/// The processor must support the lanes; there must be one number per lane.
#[inline(always)]
unsafe fn column<const N: usize, V: Lanes<N>>(from: *const f64) -> V {
    // SAFETY: the caller's guarantee.
    unsafe { V::of(from.cast::<[f64; N]>().read()) }
}

/// Rows of four numbers as lanes.
///
/// # Safety
/// The processor must support the lanes; there must be one row per lane.
#[inline(always)]
unsafe fn rows_of<const N: usize, V: Lanes<N>>(list: &[[f64; 4]]) -> [V; 4] {
    // SAFETY: the caller's guarantee.
    unsafe {
        let mut rows = [V::Row::splat(0.0); N];
        for lane in 0..N {
            rows[lane] = V::Row::load(list.as_ptr().add(lane).cast());
        }
        V::of_rows(rows)
    }
}

/// The orientations at these indices.
///
/// # Safety
/// The processor must support the lanes; there must be one index per lane, all within the list.
#[inline(always)]
unsafe fn quats<const N: usize, V: Lanes<N>>(list: &[Quat], at: *const u32) -> Quat<V> {
    // SAFETY: the caller's guarantee.
    unsafe {
        let mut rows = [V::Row::splat(0.0); N];
        for lane in 0..N {
            rows[lane] = V::Row::load(list.as_ptr().add(*at.add(lane) as usize).cast());
        }
        V::of_rows(rows)
    }
}

/// The minimum-image vector of two points in the box or slightly outside.
#[inline(always)]
pub fn nearest<R: Real>(d: Vec3<R>, periods: &Periods) -> Vec3<R> {
    if periods.tilted() {
        return nearest_tilted(d, periods);
    }
    let length = &periods.length;
    [across(d[0], length[0]), across(d[1], length[1]), across(d[2], length[2])]
}

/// The same for a tilted box: along z, then y, then x.
#[inline(always)]
fn nearest_tilted<R: Real>(mut d: Vec3<R>, periods: &Periods) -> Vec3<R> {
    for k in [2, 1, 0] {
        if periods.length[k] == 0.0 {
            continue;
        }
        let half = d[k].like(0.5 * periods.length[k]);
        let (over, under) = (d[k].above(half), (-d[k]).above(half));
        let edge = periods.shift([0, 1, 2].map(|j| if j == k { 1.0 } else { 0.0 }));
        for (d, edge) in d.iter_mut().zip(edge) {
            *d = R::choose(over, *d - edge, R::choose(under, *d + edge, *d));
        }
    }
    d
}

#[inline(always)]
fn across<R: Real>(d: R, period: f64) -> R {
    if period == 0.0 {
        return d;
    }
    let half = d.like(0.5 * period);
    let d = R::choose(d.above(half), d - period, d);
    R::choose((-d).above(half), d + period, d)
}

/// Adds the forces, and torques if there are any, of all bonds to the particles of these rows.
///
/// # Panics
/// If there are fewer particles than the columns refer to, or no row for some bond.
pub fn add_up<const C: usize>(
    columns: &Columns<C>,
    out: &Out,
    rows: &[Range<usize>],
    f: &mut [Vec3],
    mut torque: Option<&mut [Vec3]>,
) {
    for rows in rows {
        let torque = torque.as_mut().map(|torque| &mut torque[rows.clone()]);
        // SAFETY: the processor supports this form.
        unsafe { add_up_in(Form::here(), columns, out, rows.start, &mut f[rows.clone()], torque) };
    }
}

/// The same in a form, for the particles from `from` on.
///
/// # Safety
/// The processor must support the form.
pub(crate) unsafe fn add_up_in<const C: usize>(
    form: Form,
    columns: &Columns<C>,
    out: &Out,
    from: usize,
    f: &mut [Vec3],
    torque: Option<&mut [Vec3]>,
) {
    assert!(from + f.len() <= columns.particles() && out.force.len() == columns.rows());
    assert!(torque.is_none() || out.torque.len() == columns.rows());
    par::each((f, torque), |first, (f, torque)| {
        // SAFETY: the processor supports this form (caller); entries are bonds, and each has a row (asserted
        // above).
        unsafe { form.run(AddUp { columns, out, first: from + first, f, torque }) };
    });
}

/// Sign of a bond's force at its ends. A static, because a local array would be written in every iteration.
static SIGNS: [f64; 2] = [1.0, -1.0];

struct AddUp<'a, const C: usize> {
    columns: &'a Columns<C>,
    out: &'a Out,
    first: usize,
    f: &'a mut [Vec3],
    torque: Option<&'a mut [Vec3]>,
}

impl<const C: usize> InLanes for AddUp<'_, C> {
    type Out = ();

    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(mut self) {
        // SAFETY: the processor supports the lanes; entries are bonds, and each has a row (caller).
        unsafe {
            for k in 0..self.f.len() {
                let entries = self.columns.of(self.first + k);
                if entries.is_empty() {
                    continue;
                }
                let (mut force, mut turning) = (V::Row::splat(0.0), V::Row::splat(0.0));
                for entry in entries {
                    let (bond, end) = (*entry as usize / 2, *entry as usize % 2);
                    force = force + V::Row::load(self.out.force.as_ptr().add(bond).cast()) * SIGNS[end];
                    if self.torque.is_some() {
                        let row = self.out.torque.as_ptr().add(bond).cast::<Row>().add(end);
                        turning = turning + V::Row::load(row.cast());
                    }
                }
                let (mut sum, mut row) = (self.f[k], [0.0; 4]);
                force.store(row.as_mut_ptr());
                sum = add(sum, [row[0], row[1], row[2]]);
                self.f[k] = sum;
                if let Some(torque) = &mut self.torque {
                    turning.store(row.as_mut_ptr());
                    torque[k] = add(torque[k], [row[0], row[1], row[2]]);
                }
            }
        }
    }
}
