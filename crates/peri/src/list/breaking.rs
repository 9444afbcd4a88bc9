//! Breaking in the list: bonds are judged where their stretch is found, by the least measures of the step before.
//!
//! The measure of a bond is its z, since a larger z is a larger stretch and alpha is not negative; under `compat lammps` with
//! several pairs of types, whose limits differ, it is alpha s − s00. Forces keep the least of each family as they go along
//! while bonds are near their limits; where they have not and a bond may break, a sweep over the last step's places finds
//! the same numbers.

use crate::families::list::{GROUP, ListBody, PairConstants};
use crate::families::shares::BodyShare;
use crate::families::tiles::TileWindow;
use crate::families::{Candidate, FamilyOptions};
use crate::lattice::sweep::Mode;
use crate::law::series::stretch;
use crate::list::kernel::{Block, LAST, MOST, Row, Rules, partners};
use crate::list::tiles::{self, ROW};
use crate::shares::dues::share_sums;
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::lanes::Lanes;
use perigrain_base::par::Shared;

/// Bonds keep measures when the most stretched of them has come this close to its limit.
const NEAR: f64 = 0.8;

/// How the bonds of a body are judged in this evaluation.
#[derive(Clone, Copy)]
pub struct Judge {
    /// Bonds may break.
    breaking_enabled: bool,
    /// Measures of families are kept for the next step.
    pub keeps: bool,
    /// The measures of the last step are known, or not needed.
    known: bool,
    /// z below which no bond breaks.
    floor: f64,
    /// Measures are LAMMPS' critical stretches.
    critical: bool,
}

impl Judge {
    /// For the bonds of a body.
    pub fn new(body: &ListBody, mode: Mode, options: &FamilyOptions) -> Self {
        let critical = options.one_stretch() && body.pairs.len() > 1;
        let measured = critical || body.pairs.iter().any(|p| p.alpha != 0.0);
        let known = body.limits.least.len() == body.record.len();
        let breaking_enabled = mode.breaking_enabled && mode.advance;
        let keeps = mode.advance && measured && body.limits.near;
        let most = if known { f64::INFINITY } else { body.limits.top.unwrap_or(f64::INFINITY) };
        let floor = floor(body, most);
        Self { breaking_enabled, keeps, known: known || !measured, floor, critical }
    }

    /// The same for bonds between records of some slabs alone.
    pub fn among(self, body: &ListBody, slabs: &[u32]) -> Self {
        let highest = &body.limits.highest;
        if !self.breaking_enabled || highest.is_empty() {
            return self;
        }
        let most = slabs.iter().fold(f64::NEG_INFINITY, |most: f64, slab| most.max(highest[*slab as usize]));
        Self { floor: if self.critical { lowered(-most) } else { floor(body, most) }, ..self }
    }

    /// The stretch at which the bond between two records breaks.
    fn limit(&self, body: &ListBody, pair: &PairConstants, ends: [usize; 2]) -> f64 {
        let s00 = body.scatter.limit(pair.s00, ends);
        let measure = |i: usize| body.limits.least.get(i).copied().unwrap_or(f64::INFINITY);
        let most = f64::max(measure(ends[0]), measure(ends[1]));
        match self.critical {
            true => -most,
            false if pair.alpha == 0.0 => s00,
            false => s00 - pair.alpha * stretch(most),
        }
    }

    /// Puts measures in the place of the z of the bonds in hand, where they are not the same.
    #[inline]
    pub fn measure(&self, row: &Row, b: &mut Block) {
        if !self.critical {
            return;
        }
        for at in 0..b.count {
            let place = b.place(at);
            if row.body.lives(place) {
                let pair = row.body.constants(place);
                b.measure[at] = pair.alpha * stretch(b.measure[at]) - pair.s00;
            }
        }
    }

    /// Notes which of the bonds in hand may break.
    #[inline]
    pub fn note(&self, form: Form, row: &Row, b: &Block, strained: &mut Vec<(u32, f64)>) {
        if !self.breaking_enabled || b.high < self.floor {
            return;
        }
        let body = row.body;
        let mut weak = [0; MOST / GROUP];
        // Several bonds at a time where limits are those of a pair of types, raised by measures.
        let alike = self.known && !self.critical && !body.scatter.uneven();
        // SAFETY: the kernels are those that the processor has; bonds in hand are those of the body.
        unsafe { form.run(Weak { judge: self, row, b, alike, weak: &mut weak }) };
        for (k, mut bits) in weak.into_iter().enumerate() {
            while bits != 0 {
                let at = GROUP * k + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                let (bond, z) = (b.place(at), b.z[at]);
                let ends = [row.i, body.partner[bond] as usize];
                if alike || !self.known || !self.bears(body, body.constants(bond), ends, z) {
                    strained.push((bond as u32, z));
                }
            }
        }
    }

    /// Whether a bond of this z is sure to bear it: s ≤ z/2 for its own stretch and that of the measure, and rounding takes
    /// far less than 1e-12.
    fn bears(&self, body: &ListBody, pair: &PairConstants, ends: [usize; 2], z: f64) -> bool {
        let least = &body.limits.least;
        let alone = pair.alpha == 0.0 && !self.critical;
        let most = if alone { 0.0 } else { f64::max(least[ends[0]], least[ends[1]]) };
        let s00 = body.scatter.limit(pair.s00, ends);
        let limit = if self.critical { -most } else { s00 - 0.5 * pair.alpha * most };
        0.5 * z < limit - 1e-12 * limit.abs()
    }
}

/// Finds the living bonds in hand that reach the floor of z, of each group; where limits are `alike`, without those that are sure to bear it as
/// [`Judge::bears`] says.
struct Weak<'a, 'b> {
    judge: &'a Judge,
    row: &'a Row<'b>,
    b: &'a Block,
    alike: bool,
    weak: &'a mut [u8; MOST / GROUP],
}

impl InLanes for Weak<'_, '_> {
    type Out = ();
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let Self { judge, row, b, alike, weak } = self;
        let body = row.body;
        // SAFETY: blocks hold `count` bonds of the body, whole groups; where measures are known, each record has one.
        unsafe {
            let zero = V::all(0.0);
            let (floor, z) = (zero.like(judge.floor), b.z.as_ptr());
            for first in (0..b.count).step_by(GROUP) {
                let mut bits = 0;
                for v in (0..GROUP).step_by(N) {
                    bits |= V::mask_bits(V::read(z.add(first + v)).at_least(floor)) << v;
                }
                let place = *b.place.get_unchecked(first / GROUP) as usize;
                bits &= *body.alive.get_unchecked(place / GROUP);
                let pair = body.constants(place);
                if bits != 0 && alike {
                    let least = body.limits.least.as_ptr();
                    let rises = pair.alpha != 0.0;
                    let own = if rises { *least.add(row.i) } else { 0.0 };
                    let mut reach = 0;
                    for v in (0..GROUP).step_by(N) {
                        let partner = body.partner.as_ptr().add(place + v);
                        let mut most = zero.like(own);
                        if rises {
                            most =
                                V::of(partners!(N, 0.0, |k| *least.add(*partner.add(k) as usize))).most(most);
                        }
                        let limit = zero.like(pair.s00) - zero.like(0.5 * pair.alpha) * most;
                        let limit = limit - limit.abs() * 1e-12;
                        let reaches = (V::read(z.add(first + v)) * 0.5).at_least(limit);
                        reach |= V::mask_bits(reaches) << v;
                    }
                    bits &= reach;
                }
                *weak.get_unchecked_mut(first / GROUP) = bits;
            }
        }
    }
}

/// The z below which no bond breaks where no family's least z is larger than `most`: limits are the lower the larger that is.
fn floor(body: &ListBody, most: f64) -> f64 {
    let limit = |p: &PairConstants| match p.alpha {
        0.0 => body.scatter.lowest(p.s00),
        _ if most == f64::INFINITY => f64::NEG_INFINITY,
        alpha => body.scatter.lowest(p.s00) - alpha * stretch(most.max(-1.0)),
    };
    lowered(body.pairs.iter().map(limit).fold(f64::INFINITY, f64::min))
}

/// The z of a limit, or less: rounding of limits takes far less.
fn lowered(s: f64) -> f64 {
    let s = s - 1e-12 * s.abs();
    if s > -1.0 { s * (2.0 + s) } else { f64::NEG_INFINITY }
}

/// A record's row of a window before anything has come to it: no force, and no bond.
pub const FORCE_AND_MEASURE: [f64; ROW] = [0.0, 0.0, 0.0, f64::INFINITY];

/// Adds forces and finds the least measure.
pub fn add_rows(sum: &mut [f64; ROW], row: &[f64; ROW]) {
    *sum = [sum[0] + row[0], sum[1] + row[1], sum[2] + row[2], sum[3].min(row[3])];
}

/// Finds the bonds that break in this step; of several ranks each finds those of its `share`, where `some` of any may break.
pub fn candidates(
    form: Form,
    body: &mut ListBody,
    (rules, options): (&Rules, &FamilyOptions),
    (share, some): (Option<&mut BodyShare>, bool),
    found: &mut Vec<Candidate>,
) {
    found.clear();
    let mode = Mode { advance: true, breaking_enabled: true, skip: false, form };
    let judge = Judge::new(body, mode, options);
    if !some {
        return;
    }
    if !judge.known {
        for b in body.broken.clone() {
            body.set(b as usize, true);
        }
        body.limits.least = least(form, body, rules, &judge, share);
        for b in body.broken.clone() {
            body.set(b as usize, false);
        }
    }
    for &(bond, z) in body.limits.strained.iter().flat_map(|(bonds, _)| bonds) {
        let (b, pair) = (bond as usize, *body.constants(bond as usize));
        let ends = [body.owner[b / GROUP], body.partner[b]];
        if stretch(z) > judge.limit(body, &pair, ends.map(|r| r as usize)) {
            let (alpha, at) = (pair.alpha, ends.map(|r| r as usize));
            let s00 = pair.s00 * body.scatter.strength(at);
            let stretch = stretch(z) - body.scatter.strain_between(at);
            found.push(Candidate { ends, bond, stretch, s00, alpha });
        }
    }
}

impl ListBody {
    /// Whether bonds may break in this step.
    pub(in super::super) fn is_strained(&self) -> bool {
        self.limits.strained.iter().any(|(bonds, _)| !bonds.is_empty())
    }

    /// Leaves out bonds of particles that are `spared`.
    pub(in super::super) fn spare(&self, bonds: &mut Vec<Candidate>, spared: &dyn Fn(u32) -> bool) {
        bonds.retain(|c| !c.ends.iter().any(|record| spared(self.particle[*record as usize])));
    }

    /// Breaks bonds and remembers them as those of this step.
    pub(in super::super) fn break_all(&mut self, bonds: &[Candidate]) {
        self.broken.clear();
        for c in bonds {
            self.broken.push(c.bond);
            self.set(c.bond as usize, false);
        }
    }
}

/// The least measures of all families in the last step that advanced; on a rank with a share, of those that its bonds lead to.
fn least(
    form: Form,
    body: &mut ListBody,
    rules: &Rules,
    judge: &Judge,
    mut share: Option<&mut BodyShare>,
) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; body.record.len()];
    let mut windows = std::mem::take(&mut body.tiles.windows);
    let (list, shared): (&ListBody, _) = (body, Shared::new(&mut least));
    let act = |slab: usize, window: &mut TileWindow| {
        let rows = tiles::open(list, slab, window, FORCE_AND_MEASURE);
        let b = &mut Block::new();
        for i in list.records(slab) {
            let row = Row { body: list, i, first: list.ring_start(slab), rules };
            let mut next = row.start();
            while row.fill(&mut next, b) {
                row.shape::<LAST>(form, b);
                judge.measure(&row, b);
                for (measure, target) in b.measure[..b.count].iter().zip(&b.target) {
                    for row in [i, *target as usize] {
                        // SAFETY: the window covers the slab's records and those that its bonds lead to.
                        let least = unsafe { &mut *rows.wrapping_add(ROW * row + 3) };
                        *least = least.min(*measure);
                    }
                }
            }
        }
        true
    };
    let over = (&mut windows[..], false, share.as_deref_mut());
    tiles::sweep(list, over, act, (FORCE_AND_MEASURE, add_rows), |records, rows| {
        // SAFETY: each record settles once.
        let least = unsafe { shared.get(records) };
        least.iter_mut().zip(rows).for_each(|(least, row)| *least = row[3]);
    });
    if let Some(share) = share {
        share_sums(|slab| list.records(slab), &mut share.rows, &mut least);
    }
    body.tiles.windows = windows;
    least
}

/// Makes the measures of this step, which has advanced, those of the last one; of several ranks all have agreed upon the largest z of all bonds.
pub fn roll(body: &mut ListBody, agreed: Option<f64>) {
    let (s00, alpha) =
        body.pairs.iter().fold((f64::INFINITY, 0.0f64), |l, p| (l.0.min(p.s00), l.1.max(p.alpha)));
    let s00 = body.scatter.lowest(s00);
    let limits = &mut body.limits;
    let kept = limits.next.len() == body.record.len();
    std::mem::swap(&mut limits.least, &mut limits.next);
    limits.next.clear();
    if !kept {
        limits.least.clear();
    }
    let top = agreed.unwrap_or_else(|| limits.strained.iter().map(|s| s.1).fold(0.0, f64::max));
    limits.near = 0.5 * top * (1.0 + alpha) >= NEAR * s00;
    limits.top = Some(top);
}
