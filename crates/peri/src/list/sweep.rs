//! Sweeps over the bonds of the list under any law: sums that forces need, then forces.
//!
//! Slabs, groups, partners and lengths of columns are as `build::list` makes them; of lists from restart files `families::sound` has
//! looked at each of them.

use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Mutex;

use crate::families::law::{COLUMNS, SiteState};
use crate::families::list::{ListBody, Record};
use crate::families::{Cell, FamilyOptions, LawKind, PeriView, Window};
use crate::lanes::isa::Isa;
use crate::lattice::sweep::Mode;
use crate::lattice::{keep_earlier, window};
use crate::law::settle::{Settling, Sites, columns_of};
use crate::law::terms::{Dilatation, Norm, NormLammps, Term};
use crate::law::{BondLaw, Moment, of_law};
use crate::list::breaking::{self, Judge, clear};
use crate::list::kernel::{Block, FULL, LAST, PLAIN, Row, Rules};
use crate::list::laws::{Acting, AddUp, Hand, Pull};
use perigrain_base::par::{self, Shared};

const _: () = assert!(size_of::<Record>() == 64);

/// Adds the forces of all bonds to `f`.
pub fn forces<K: Isa>(
    list: &mut ListBody,
    view: &PeriView,
    f: &Shared<[f64; 3]>,
    (mode, options): (Mode, &FamilyOptions),
    settling: &Settling,
    (windows, cell): (&[Mutex<Window>], &Cell),
) {
    let n = list.record.len();
    if n == 0 {
        return;
    }
    let kind = settling.law.kind;
    let judge = Judge::new(list, mode, options);
    let mut rules = Rules::new(cell, options, settling.law);
    rules.measures = judge.keeps;
    if mode.advance {
        list.limits.strained.resize_with(list.slabs(), Default::default);
        list.limits.next.clear();
        list.limits.next.resize(if judge.keeps { n } else { 0 }, f64::INFINITY);
    }
    let awake = kind.has_states().then(|| find_active(list, kind.memory() > 0));
    let moving = std::mem::take(&mut list.moving);
    let active = awake.as_deref().unwrap_or(&moving);
    let now = Moment { held: list.state.held, ..settling.moment };
    if kind.has_states() {
        list.state.columns.resize(COLUMNS * n, 0.0);
        keep_earlier(&mut list.state, settling);
        if kind.memory() > 0 && list.state.touched.len() != n {
            list.state.touched = vec![1; n];
        }
    }
    let particle = std::mem::take(&mut list.particle);
    let stiffness = std::mem::take(&mut list.scatter.stiffness);
    let (kind_of, only) = (view.kind, only(list));
    let sites = Sites {
        count: n,
        pad: 0,
        stride: n,
        particle: &particle,
        kind: kind_of,
        only,
        stiffness: &stiffness,
    };
    let sweep = |list: &mut ListBody, numbers: usize, task: &(dyn Fn(&Sweep, usize, &mut Window) + Sync)| {
        let mut memory = std::mem::take(&mut list.state.memory);
        let mut touched = std::mem::take(&mut list.state.touched);
        let mut lowest = std::mem::take(&mut list.lowest);
        let mut limits = std::mem::take(&mut list.limits);
        let mut sums = std::mem::take(&mut list.state.sums);
        let mut strained = std::mem::take(&mut limits.strained);
        let mut next = std::mem::take(&mut limits.next);
        list.limits = limits;
        let sweep = Sweep {
            body: list,
            ends: &in_rows(&list.state, n, numbers),
            lowest: Shared::new(&mut lowest),
            strained: Shared::new(&mut strained),
            next: Shared::new(&mut next),
            memory: Shared::new(&mut memory),
            touched: Shared::new(&mut touched),
            sums: Shared::new(&mut sums),
            mode,
            judge,
            rules: &rules,
            moment: now,
        };
        in_slabs(list, windows, |slab, window| task(&sweep, slab, window));
        (list.state.memory, list.state.touched, list.state.sums) = (memory, touched, sums);
        list.lowest = lowest;
        (list.limits.strained, list.limits.next) = (strained, next);
    };
    let clear_sums = |list: &mut ListBody| {
        list.state.sums.clear();
        list.state.sums.resize(n, 0.0);
    };
    if !kind.bond_based() {
        clear_sums(list);
        sweep(list, 0, &|s, slab, w| s.add_up::<K, Dilatation>(slab, &moving, w));
        settling.dilatations(&mut list.state, &sites);
    }
    if kind == LawKind::Shaped {
        settling.stiffen(&mut list.state, &sites);
    }
    if kind == LawKind::ElasticPlastic {
        clear_sums(list);
        sweep(list, Norm::COLUMNS, &|s, slab, w| match settling.compat {
            true => s.add_up::<K, NormLammps>(slab, active, w),
            false => s.add_up::<K, Norm>(slab, active, w),
        });
        settling.flow(&mut list.state, &sites);
    }
    let columns = columns_of(kind, settling.compat);
    let pulls = |s: &Sweep, slab: usize, w: &mut Window| of_law!(kind, settling.compat, now, W => s.pull::<K, W>(slab, active, w));
    sweep(list, columns, &|s, slab, w| {
        if pulls(s, slab, w) {
            let (own, next) = reach_of(s.body, slab);
            hand_back(s.body, &particle, own.chain(next), w, f);
        }
    });
    (list.particle, list.moving, list.scatter.stiffness) = (particle, moving, stiffness);
    settling.held(&mut list.state);
}

/// The type of all records, if they have but one.
fn only(list: &ListBody) -> Option<u16> {
    if let [only] = list.kinds[..] { Some(only) } else { None }
}

/// Columns of sites as rows: so many numbers for each of `n` records.
pub fn in_rows(state: &SiteState, n: usize, numbers: usize) -> Vec<f64> {
    let stride = Acting::stride(numbers);
    let mut rows = vec![0.0; stride * n];
    for k in 0..numbers {
        for (row, value) in rows.chunks_exact_mut(stride).zip(&state.columns[k * n..(k + 1) * n]) {
            row[k] = *value;
        }
    }
    rows
}

/// Calls `task` for every slab, in two colours.
pub fn in_slabs(list: &ListBody, windows: &[Mutex<Window>], task: impl Fn(usize, &mut Window) + Sync) {
    let slabs = list.slabs();
    // A ring of an odd number of slabs cannot be coloured with two colours: its last one goes alone.
    let odd = list.ring && slabs % 2 == 1;
    par::two_colours(slabs - usize::from(odd), |slab| task(slab, &mut window(windows)));
    if odd {
        task(slabs - 1, &mut window(windows));
    }
}

/// The records of a slab, and those of the slab that its bonds reach.
pub fn reach_of(body: &ListBody, slab: usize) -> (Range<usize>, Range<usize>) {
    let own = body.slab[slab] as usize..body.slab[slab + 1] as usize;
    let next = if slab + 1 < body.slabs() {
        own.end..body.slab[slab + 2] as usize
    } else if body.ring {
        0..body.slab[1] as usize
    } else {
        0..0
    };
    (own, next)
}

/// The record before which all come after the others in the window of a slab.
pub fn ring_start(body: &ListBody, slab: usize) -> usize {
    if body.ring && slab + 1 == body.slabs() { body.slab[slab] as usize } else { 0 }
}

/// Adds what a window has gathered for `records`, in their order, to the particles' forces.
fn hand_back(
    body: &ListBody,
    particle: &[u32],
    records: impl Iterator<Item = usize>,
    window: &Window,
    f: &Shared<[f64; 3]>,
) {
    for (k, i) in records.enumerate() {
        let p = particle[i] as usize;
        if p < f.len() {
            // SAFETY: in bounds; slabs that reach a particle run one after the other.
            let f = unsafe { &mut *f.as_ptr().add(p) };
            let w = &window.force[4 * k..4 * k + 3];
            let share = body.record[i].share;
            *f = [f[0] + share * w[0], f[1] + share * w[1], f[2] + share * w[2]];
        }
    }
}

/// Which slabs have sites with dilatations, or under a law with memory ever had.
fn find_active(list: &mut ListBody, remembers: bool) -> Vec<bool> {
    let slabs = list.slabs();
    let moving = |s: usize| list.moving.get(s).copied().unwrap_or(false);
    let mut active: Vec<bool> =
        (0..slabs).map(|s| moving(s) || moving(s + 1) || (s > 0 && moving(s - 1))).collect();
    if list.ring {
        active[0] |= moving(slabs - 1);
        active[slabs - 1] |= moving(0);
    }
    if remembers {
        let awake = &mut list.state.awake;
        awake.resize(slabs, (0, 0));
        for (awake, active) in awake.iter_mut().zip(&mut active) {
            *active |= awake.0 != 0;
            awake.0 = i32::from(*active);
        }
    }
    active
}

/// The list during one sweep, with the columns that its slabs write.
struct Sweep<'a> {
    body: &'a ListBody,
    /// What ends have, in rows.
    ends: &'a [f64],
    lowest: Shared<'a, f32>,
    strained: Shared<'a, (Vec<(u32, f64)>, f64)>,
    next: Shared<'a, f64>,
    memory: Shared<'a, f64>,
    touched: Shared<'a, u8>,
    sums: Shared<'a, f64>,
    mode: Mode,
    judge: Judge,
    rules: &'a Rules,
    moment: Moment,
}

impl Sweep<'_> {
    /// Whether a slab and the one it reaches have nothing to do.
    fn rests(&self, slab: usize, active: &[bool]) -> bool {
        let next = if slab + 1 < active.len() { slab + 1 } else { 0 };
        !active[slab] && ((next == 0 && !self.body.ring) || !active[next])
    }

    /// What laws need besides bonds, of a record whose bonds remember or not.
    fn acting(&self, known: bool) -> Acting<'_> {
        let (keep, least) = (self.mode.advance, self.judge.keeps);
        Acting { ends: self.ends, memory: self.memory.as_ptr(), known, keep, least, moment: self.moment }
    }

    /// Whether bonds of a record remember anything under a law.
    fn known(&self, i: usize, (numbers, lazy): (usize, bool)) -> bool {
        // SAFETY: a record belongs to one slab.
        numbers > 0 && (!lazy || unsafe { self.touched.get(i..i + 1)[0] } != 0)
    }

    /// Adds a term of the bonds of one slab's records to the sums of both ends.
    fn add_up<K: Isa, T: Term>(&self, slab: usize, active: &[bool], window: &mut Window) {
        if self.rests(slab, active) && self.mode.skip {
            return;
        }
        let body = self.body;
        let (own, next) = reach_of(body, slab);
        let length = own.len() + next.len();
        if window.force.len() < length {
            window.force.resize(length, 0.0);
        }
        window.force[..length].fill(0.0);
        let sums = window.force.as_mut_ptr().wrapping_sub(own.start);
        let b = &mut Block::new();
        for i in own.clone() {
            let row = Row { body, i, first: ring_start(body, slab), rules: self.rules };
            let acting = self.acting(self.known(i, (T::MEMORY, true)));
            let mut next = row.start();
            while row.fill(&mut next, b) {
                // SAFETY: the kernels are those that the processor has; bonds lead to this slab or the next.
                unsafe {
                    row.shape::<K, FULL>(b);
                    K::call(AddUp(
                        Hand::<T> { row: &row, acting: &acting, block: b, law: PhantomData },
                        sums,
                    ));
                }
            }
        }
        for (k, i) in own.chain(next).enumerate() {
            // SAFETY: slabs that reach a record run one after the other.
            unsafe { self.sums.get(i..i + 1)[0] += window.force[k] };
        }
    }

    /// Puts the forces of the bonds of one slab's records into the window; false if there are none.
    fn pull<K: Isa, W: BondLaw>(&self, slab: usize, active: &[bool], window: &mut Window) -> bool {
        let body = self.body;
        let (own, next) = reach_of(body, slab);
        // SAFETY: records belong to one slab.
        let lowest = unsafe { self.lowest.get(own.clone()) };
        let mut none = (vec![], 0.0);
        // SAFETY: each slab has its own.
        let (strained, top) = match self.mode.advance {
            true => unsafe { &mut self.strained.get(slab..slab + 1)[0] },
            false => &mut none,
        };
        strained.clear();
        *top = 0.0;
        if self.rests(slab, active) && self.mode.skip && !self.judge.keeps {
            lowest.fill(0.0);
            return false;
        }
        clear(window, own.len() + next.len());
        let force = window.force.as_mut_ptr().wrapping_sub(4 * own.start);
        let judge = self.judge.among(body, own.clone().chain(next.clone()));
        let b = &mut Block::new();
        for (i, lowest) in own.clone().zip(lowest) {
            let row = Row { body, i, first: ring_start(body, slab), rules: self.rules };
            let acting = self.acting(self.known(i, (W::MEMORY, W::LAZY)));
            let mut low = 0.0f64;
            let mut next = row.start();
            while row.fill(&mut next, b) {
                // SAFETY: the kernels are those that the processor has; bonds lead to this slab or the next.
                let woken = unsafe {
                    if W::BACK {
                        row.shape::<K, LAST>(b);
                    }
                    match W::PLAIN {
                        true => row.shape::<K, PLAIN>(b),
                        false => row.shape::<K, FULL>(b),
                    }
                    judge.measure(&row, b);
                    K::call(Pull(Hand::<W> { row: &row, acting: &acting, block: b, law: PhantomData }, force))
                };
                if woken && W::LAZY {
                    // SAFETY: a record belongs to one slab.
                    unsafe { self.touched.get(i..i + 1)[0] = 1 };
                }
                low = low.min(b.low);
                *top = top.max(b.high);
                judge.note::<K>(&row, b, strained);
            }
            // Rounded down.
            *lowest = (low * (1.0 + 1e-6)) as f32;
        }
        if self.judge.keeps {
            breaking::hand_back(own.chain(next), window, &self.next);
        }
        true
    }
}
