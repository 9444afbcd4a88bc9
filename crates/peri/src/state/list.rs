//! Sweeps of state-based laws over bonds kept as a list, one bond after the other.

use std::sync::Mutex;

use super::super::lattice::Mode;
use super::super::list::{Watch, clear, hand_back, reach_of};
use super::super::single::Single;
use super::law::{BondLaw, Ends, Moment, Stretch, closed, of_law};
use super::settle::{Settling, Sites};
use super::terms::{Dilatation, Norm, NormLammps, Term};
use super::window;
use crate::families::law::COLUMNS;
use crate::families::list::ListBody;
use crate::families::{FamilyOptions, Influence, Law, LawKind, PeriView, Window};
use perigrain_base::par::{self, Shared};

/// The sweeps over the list.
pub fn body(
    list: &mut ListBody,
    view: &PeriView,
    f: &Shared<[f64; 3]>,
    (mode, options): (Mode, &FamilyOptions),
    settling: &Settling,
    (windows, period): (&[Mutex<Window>], [f64; 3]),
) {
    let n = list.record.len();
    if n == 0 {
        return;
    }
    let kind = settling.law.kind;
    let active = find_active(list, kind.memory() > 0);
    list.state.columns.resize(COLUMNS * n, 0.0);
    super::keep_earlier(&mut list.state, settling);
    let mut memory = std::mem::take(&mut list.state.memory);
    let (mut tension, mut flagged) = (std::mem::take(&mut list.tension), std::mem::take(&mut list.flagged));
    let (tension_of, flagged_of) = (Shared::new(&mut tension), Shared::new(&mut flagged));
    let memory_of = Shared::new(&mut memory);
    let particle = std::mem::take(&mut list.particle);
    let sites = Sites { count: n, pad: 0, stride: n, particle: &particle, kind: view.kind, only: None };
    let now = Moment { held: list.state.held, ..settling.moment };
    let sweep = |list: &ListBody, task: &(dyn Fn(&Sweep, usize) + Sync)| {
        let sweep = Sweep {
            body: list,
            tension: &tension_of,
            flagged: &flagged_of,
            memory: &memory_of,
            mode,
            options,
            period,
            moment: now,
            weighing: Weighing::of(settling.law),
            numbers: kind.memory(),
        };
        let slabs = list.slabs();
        // A ring of an odd number of slabs cannot be coloured with two colours: its last one goes alone.
        let odd = list.ring && slabs % 2 == 1;
        par::two_colours(slabs - usize::from(odd), |slab| task(&sweep, slab));
        if odd {
            task(&sweep, slabs - 1);
        }
    };
    let add_up = |list: &mut ListBody, task: &(dyn Fn(&Sweep, usize, &Shared<f64>) + Sync)| {
        let mut sums = std::mem::take(&mut list.state.sums);
        sums.clear();
        sums.resize(n, 0.0);
        let shared = Shared::new(&mut sums);
        sweep(list, &|sweep, slab| task(sweep, slab, &shared));
        list.state.sums = sums;
    };
    let moving = list.moving.clone();
    if !kind.bond_based() {
        add_up(list, &|s, slab, sums| {
            s.add_up::<Dilatation>(slab, &moving, &mut window(windows), sums);
        });
        settling.dilatations(&mut list.state, &sites);
    }
    if kind == LawKind::Shaped {
        settling.stiffen(&mut list.state, &sites);
    }
    if kind == LawKind::Eps {
        add_up(list, &|s, slab, sums| match settling.compat {
            true => s.add_up::<NormLammps>(slab, &active, &mut window(windows), sums),
            false => s.add_up::<Norm>(slab, &active, &mut window(windows), sums),
        });
        settling.flow(&mut list.state, &sites);
    }
    list.particle = particle;
    sweep(list, &|s, slab| {
        let w = &mut window(windows);
        of_law!(kind, settling.compat, now, W => s.pull::<W>(slab, &active, w, f));
    });
    (list.tension, list.flagged) = (tension, flagged);
    list.state.memory = memory;
    settling.held(&mut list.state);
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

/// The list during one sweep.
struct Sweep<'a> {
    body: &'a ListBody,
    tension: &'a Shared<'a, f32>,
    flagged: &'a Shared<'a, u8>,
    memory: &'a Shared<'a, f64>,
    mode: Mode,
    options: &'a FamilyOptions,
    period: [f64; 3],
    moment: Moment,
    weighing: Weighing,
    numbers: usize,
}

/// What a bond counts.
#[derive(Clone, Copy)]
pub enum Weighing {
    /// ω w.
    Influence(Influence),
    /// c w/|xi| of this shape, with the stretch at which it flows in the place of ω.
    Bond(Influence),
}

impl Weighing {
    /// That of a law.
    pub fn of(law: &Law) -> Self {
        match law.kind.bond_based() {
            true => Self::Bond(law.influence),
            false => Self::Influence(law.influence),
        }
    }

    /// ω and ω w, or what stands for them.
    pub fn weigh(self, length: f64, weight: f64, (c, horizon, yields): (f64, f64, f64)) -> (f64, f64) {
        match self {
            Self::Bond(influence) => (yields, c * influence.shape(length, horizon) * weight / length),
            Self::Influence(influence) => {
                let omega = influence.of(length, horizon);
                (omega, omega * weight)
            }
        }
    }
}

/// One bond.
pub struct Bond {
    /// xi + eta.
    pub y: [f64; 3],
    /// z.
    pub z: f64,
    /// |xi|.
    pub length: f64,
    /// ω.
    pub omega: f64,
    /// ω w.
    pub share: f64,
    /// Its stretch.
    pub stretch: Stretch<Single>,
}

/// The bond between two records, at place `k` in the list of partners.
pub fn bond(
    body: &ListBody,
    (i, j, k): (usize, usize, usize),
    period: [f64; 3],
    weighing: Weighing,
    options: &FamilyOptions,
) -> Bond {
    let (a, b) = (&body.record[i], &body.record[j]);
    let (mut q, mut square, mut y) = (0.0, 0.0, [0.0; 3]);
    for d in 0..3 {
        let mut xi = b.reference[d] - a.reference[d];
        if xi.abs() > 0.5 * period[d] {
            xi -= period[d] * (xi / period[d]).round();
        }
        let eta = b.u[d] - a.u[d];
        q += eta * (2.0 * xi + eta);
        square += xi * xi;
        y[d] = xi + eta;
    }
    let pair = body.constants(k);
    let length = square.sqrt();
    let z = q / square;
    let live = z.abs() >= options.dead_band(length);
    let stretch = banded(z, length, options);
    let weight = (pair.weight[0] - pair.weight[1] * length).min(1.0);
    let (omega, share) = weighing.weigh(length, weight, (pair.c, pair.horizon, pair.yields));
    Bond { y, z: if live { z } else { 0.0 }, length, omega, share, stretch }
}

/// A stretch, none inside the dead band; `before` as now.
pub fn banded(z: f64, length: f64, options: &FamilyOptions) -> Stretch<Single> {
    // SAFETY: plain arithmetic.
    let mut stretch = unsafe { closed(Single(z)) };
    if z.abs() < options.dead_band(length) {
        (stretch.s, stretch.share, stretch.before) = (Single(0.0), Single(0.0), Single(0.0));
    }
    stretch
}

impl Sweep<'_> {
    /// Whether a slab and the one it reaches have nothing to do.
    fn rests(&self, slab: usize, active: &[bool]) -> bool {
        let next = if slab + 1 < active.len() { slab + 1 } else { 0 };
        !active[slab] && ((next == 0 && !self.body.ring) || !active[next])
    }

    fn columns(&self, site: usize, count: usize) -> [Single; COLUMNS] {
        let (columns, n) = (&self.body.state.columns, self.body.record.len());
        std::array::from_fn(|k| Single(if k < count { columns[k * n + site] } else { 0.0 }))
    }

    fn recall(&self, b: usize) -> [Single; 2] {
        // SAFETY: a bond is its owner's, and that in one slab.
        let memory = unsafe { self.memory.get(b * self.numbers..(b + 1) * self.numbers) };
        std::array::from_fn(|k| Single(memory.get(k).copied().unwrap_or(0.0)))
    }

    /// Where a record is in the window of a slab.
    fn place(&self, own: &std::ops::Range<usize>, j: usize) -> usize {
        if j < own.start { own.len() + j } else { j - own.start }
    }

    /// Adds a term of the bonds of one slab's records to the sums of both ends.
    fn add_up<T: Term>(&self, slab: usize, active: &[bool], window: &mut Window, sums: &Shared<f64>) {
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
        for i in own.clone() {
            let near = self.columns(i, T::COLUMNS);
            let mut sum = 0.0;
            for k in body.own(i).filter(|&k| body.lives(k)) {
                let j = body.partner[k] as usize;
                let b = bond(body, (i, j, k), self.period, self.weighing, self.options);
                let ends: Ends<Single> = [near, self.columns(j, T::COLUMNS)];
                // SAFETY: plain arithmetic.
                let (a, c) = unsafe { T::terms(&b.stretch, Single(b.omega), &ends, &self.recall(k)) };
                let one = b.share * b.length * b.length;
                sum += one * body.record[j].volume * a.0;
                window.force[self.place(&own, j)] += one * body.record[i].volume * c.0;
            }
            window.force[i - own.start] += sum;
        }
        for (k, i) in own.chain(next).enumerate() {
            // SAFETY: slabs that reach a record run one after the other.
            unsafe { sums.get(i..i + 1)[0] += window.force[k] };
        }
    }

    /// Adds the forces of the bonds of one slab's records.
    fn pull<W: BondLaw>(&self, slab: usize, active: &[bool], window: &mut Window, f: &Shared<[f64; 3]>) {
        let body = self.body;
        let (own, next) = reach_of(body, slab);
        // SAFETY: records belong to one slab.
        let (tension, flagged) = unsafe { (self.tension.get(own.clone()), self.flagged.get(own.clone())) };
        flagged.fill(0);
        let rest = self.rests(slab, active);
        if rest && self.mode.advance {
            tension.fill(0.0);
        }
        if rest && self.mode.skip {
            return;
        }
        clear(window, own.len() + next.len());
        let watch = Watch::new(body, self.mode);
        for (k, i) in own.clone().enumerate() {
            let (high, low) = self.pull_one::<W>(i, &own, window);
            watch.note([high, low], &mut tension[k], &mut flagged[k]);
        }
        hand_back(body, own.chain(next), window, f);
    }

    /// Adds the forces of one record's bonds; returns the largest z and the largest −z.
    fn pull_one<W: BondLaw>(
        &self,
        i: usize,
        own: &std::ops::Range<usize>,
        window: &mut Window,
    ) -> (f64, f64) {
        let body = self.body;
        let near = self.columns(i, W::COLUMNS);
        let (mut high, mut low, mut sum) = (0.0f64, 0.0f64, [0.0; 3]);
        for k in body.own(i).filter(|&k| body.lives(k)) {
            let j = body.partner[k] as usize;
            let mut b = bond(body, (i, j, k), self.period, self.weighing, self.options);
            if W::BACK {
                b.stretch.before = banded(body.z(true, i, j, self.period).0, b.length, self.options).s;
            }
            let ends: Ends<Single> = [near, self.columns(j, W::COLUMNS)];
            let mut memory = self.recall(k);
            // SAFETY: plain arithmetic.
            let (a, c) = unsafe { W::pull(&b.stretch, Single(b.omega), &ends, &mut memory, &self.moment) };
            if self.mode.advance && self.numbers > 0 {
                // SAFETY: a bond is its owner's, and that in one slab.
                let place = unsafe { self.memory.get(k * self.numbers..(k + 1) * self.numbers) };
                place.iter_mut().zip(memory).for_each(|(place, m)| *place = m.0);
            }
            let factor = b.share * body.record[i].volume * body.record[j].volume;
            let (a, c) = (factor * a.0, factor * c.0);
            let target = 4 * self.place(own, j);
            for (d, y) in b.y.iter().enumerate() {
                sum[d] += a * y;
                window.force[target + d] -= c * y;
            }
            high = high.max(b.z);
            low = low.max(-b.z);
        }
        for (d, sum) in sum.iter().enumerate() {
            window.force[4 * (i - own.start) + d] += sum;
        }
        (high, low)
    }
}
