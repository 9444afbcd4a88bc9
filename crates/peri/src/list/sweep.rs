//! Sweeps over the bonds of the list under any law: sums that forces need, then forces.
//!
//! Slabs, groups, partners and lengths of columns are as `setup::list` makes them; of lists from restart files `families::sound` has
//! looked at each of them.

use crate::cauchy::list::add_gradients;
use crate::cauchy::site::{Places, ROW, settle};
use crate::families::list::{ListBody, Record};
use crate::families::shares::BodyShare;
use crate::families::tiles::TileWindow;
use crate::families::{Cell, FamilyOptions, Law, PeriView};
use crate::lattice::sweep::Mode;
use crate::lattice::{dilate, hold, keep_earlier};
use crate::law::kernels::Loops;
use crate::law::moment::COLUMNS;
use crate::law::moment::Moment;
use crate::law::settle::{Settling, Sites, stiffen};
use crate::law::terms::{Dilatation, Norm, NormLammps, Sum, Term};
use crate::list::breaking::{FORCE_AND_MEASURE, Judge, add_rows};
use crate::list::kernel::{APART, Block, FULL, LAST, PLAIN, Row, Rules};
use crate::list::laws::{Acting, Hand, add_up};
use crate::list::tiles::{self, lay_slabs};
use crate::shares::dues::share_sums;
use perigrain_base::par::{self, Shared};

const _: () = assert!(size_of::<Record>() == 64);

/// A sweep over a list with windows, and a rank's share of it.
type Act<'a> = dyn Fn(&Sweep, &mut [TileWindow], Option<&mut BodyShare>) + 'a;

/// Adds the forces of all bonds to `f`; of several ranks each adds those of its share.
pub fn forces(
    list: &mut ListBody,
    view: &PeriView,
    f: &Shared<[f64; 3]>,
    (mode, options): (Mode, &FamilyOptions),
    (law, settling, mut share): (&Law, &Settling, Option<&mut BodyShare>),
    cell: &Cell,
) {
    let n = list.record.len();
    if n == 0 {
        return;
    }
    lay_slabs(list);
    list.limits.find_highest(&list.slab);
    let (kind, loops) = (law.kind.style(), law.kind.loops(settling.compat));
    let judge = Judge::new(list, mode, options);
    let mut rules = Rules::new(cell, options, law.counting());
    rules.measures = judge.keeps;
    if mode.advance {
        list.limits.strained.resize_with(list.slabs(), Default::default);
        list.limits.next.clear();
        list.limits.next.resize(if judge.keeps { n } else { 0 }, f64::INFINITY);
    }
    let remembers = kind.memory() > 0 || kind.correspondence;
    let awake = kind.has_states().then(|| find_active(list, remembers));
    let moving = std::mem::take(&mut list.moving);
    let active = awake.as_deref().unwrap_or(&moving);
    let now = Moment { held: list.state.held, ..settling.moment };
    if kind.has_states() {
        let numbers = if kind.correspondence { ROW } else { COLUMNS };
        list.state.columns.resize(numbers * n, 0.0);
        keep_earlier(&mut list.state, kind, settling);
        if kind.memory() > 0 && list.state.touched.len() != n {
            list.state.touched = vec![1; n];
        }
    }
    let particle = std::mem::take(&mut list.particle);
    let stiffness = std::mem::take(&mut list.scatter.stiffness);
    let strain = list.scatter.strains().to_vec();
    let (kind_of, only) = (view.kind, only(list));
    let sites = Sites {
        count: n,
        pad: 0,
        stride: n,
        particle: &particle,
        kind: kind_of,
        only,
        stiffness: &stiffness,
        strain: &strain,
    };
    let mut sweep = |list: &mut ListBody, numbers: usize, act: &Act| {
        let columns = std::mem::take(&mut list.state.columns);
        let rows;
        // Under correspondence numbers of sites are rows already.
        let ends = match kind.correspondence {
            true => &columns,
            false => {
                rows = in_rows(&columns, n, numbers);
                &rows
            }
        };
        let mut memory = std::mem::take(&mut list.state.memory);
        let mut touched = std::mem::take(&mut list.state.touched);
        let mut lowest = std::mem::take(&mut list.lowest);
        let mut sums = std::mem::take(&mut list.state.sums);
        let mut strained = std::mem::take(&mut list.limits.strained);
        let mut next = std::mem::take(&mut list.limits.next);
        let mut windows = std::mem::take(&mut list.tiles.windows);
        let sweep = Sweep {
            body: list,
            ends,
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
        act(&sweep, &mut windows, share.as_deref_mut());
        (list.state.memory, list.state.touched, list.state.sums) = (memory, touched, sums);
        list.lowest = lowest;
        (list.limits.strained, list.limits.next) = (strained, next);
        list.tiles.windows = windows;
        list.state.columns = columns;
    };
    let clear_sums = |list: &mut ListBody, numbers: usize| {
        list.state.sums.clear();
        list.state.sums.resize(numbers * n, 0.0);
    };
    if kind.correspondence {
        clear_sums(list, ROW);
        sweep(list, 0, &|s, w, _| s.add_gradients(&moving, w));
        settle(settling, &mut list.state, &sites, Places::RECORDS, &law.rules(view));
    } else if !kind.bond_based {
        clear_sums(list, 1);
        sweep(list, 0, &|s, w, share| s.add_up::<Dilatation>(&moving, w, share));
        dilate(loops, settling, &mut list.state, &sites);
    }
    if kind.stiffened {
        stiffen(settling, &mut list.state, &sites);
    }
    if let Some(norm) = loops.about().norm {
        clear_sums(list, 1);
        sweep(list, Norm::COLUMNS, &|s, w, share| match norm {
            Sum::Dilatation => s.add_up::<Dilatation>(active, w, share),
            Sum::Norm => s.add_up::<Norm>(active, w, share),
            Sum::NormLammps => s.add_up::<NormLammps>(active, w, share),
        });
        loops.flow(settling, &mut list.state, &sites);
    }
    let now_loops = kind.loops_at(settling.compat, &now);
    sweep(list, loops.about().columns, &|s, w, share| {
        s.pull_all((w, share), |slab, w| s.pull(now_loops, slab, active, w), &particle, f);
    });
    (list.particle, list.moving, list.scatter.stiffness) = (particle, moving, stiffness);
    hold(&mut list.state, kind, settling);
}

/// The type of all records, if they have but one.
fn only(list: &ListBody) -> Option<u16> {
    if let [only] = list.kinds[..] { Some(only) } else { None }
}

/// Columns of sites as rows: so many numbers for each of `n` records.
pub fn in_rows(columns: &[f64], n: usize, numbers: usize) -> Vec<f64> {
    let stride = Acting::stride(numbers);
    let mut rows = vec![0.0; stride * n];
    let shared = Shared::new(&mut rows);
    par::for_chunks(if numbers == 0 { 0 } else { n }, |range| {
        // SAFETY: each record's row is one task's.
        let rows = unsafe { shared.get(stride * range.start..stride * range.end) };
        for k in 0..numbers {
            let column = &columns[k * n..][range.clone()];
            rows.chunks_exact_mut(stride).zip(column).for_each(|(row, value)| row[k] = *value);
        }
    });
    rows
}

/// Which slabs have sites with dilatations, or under a law with memory ever had: those that reach into moving ones or that these reach into.
fn find_active(list: &mut ListBody, remembers: bool) -> Vec<bool> {
    let (graph, moving) = (&list.tiles.graph, &list.moving);
    let near = |slab: usize| graph.takers(slab).iter().chain(graph.givers(slab));
    let mut active: Vec<bool> =
        (0..list.slabs()).map(|slab| near(slab).any(|other| moving[*other as usize])).collect();
    if remembers {
        let awake = &mut list.state.awake;
        awake.resize(active.len(), (0, 0));
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
    /// Whether a slab and those it reaches have nothing to do.
    fn rests(&self, slab: usize, active: &[bool]) -> bool {
        self.body.tiles.graph.takers(slab).iter().all(|taker| !active[*taker as usize])
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

    /// Adds a term of all bonds to the sums of both ends.
    fn add_up<T: Term>(
        &self,
        active: &[bool],
        windows: &mut [TileWindow],
        mut share: Option<&mut BodyShare>,
    ) {
        let add = |sum: &mut [f64; 1], more: &[f64; 1]| sum[0] += more[0];
        let act = |slab: usize, window: &mut TileWindow| self.add_up_slab::<T>(slab, active, window);
        let over = (windows, false, share.as_deref_mut());
        tiles::sweep(self.body, over, act, ([0.0], add), |records, sums| {
            // SAFETY: each record settles once.
            let own = unsafe { self.sums.get(records) };
            own.iter_mut().zip(sums).for_each(|(own, sum)| *own += sum[0]);
        });
        self.share(share, &self.sums);
    }

    /// The same of one slab's bonds into its window; false if these rest.
    fn add_up_slab<T: Term>(&self, slab: usize, active: &[bool], window: &mut TileWindow) -> bool {
        if self.rests(slab, active) && self.mode.skip {
            return false;
        }
        let (body, form) = (self.body, self.mode.form);
        let sums = tiles::open(body, slab, window, [0.0]);
        let b = &mut Block::new();
        for i in body.records(slab) {
            let row = Row { body, i, first: body.ring_start(slab), rules: self.rules };
            let acting = self.acting(self.known(i, (T::MEMORY, true)));
            let mut next = row.start();
            while row.fill(&mut next, b) {
                row.shape::<FULL>(form, b);
                // SAFETY: bonds lead to records that the window covers, and a record belongs to one slab.
                let hand = unsafe { Hand::new((&row, &acting), b, sums) };
                add_up::<T>(form, hand);
            }
        }
        true
    }

    /// Adds eta⊗xi of all bonds to the sums of both ends, [`ROW`] numbers for each record.
    fn add_gradients(&self, active: &[bool], windows: &mut [TileWindow]) {
        let add =
            |sum: &mut [f64; ROW], more: &[f64; ROW]| sum.iter_mut().zip(more).for_each(|(s, m)| *s += m);
        let act = |slab: usize, window: &mut TileWindow| {
            if self.rests(slab, active) && self.mode.skip {
                return false;
            }
            let (body, form) = (self.body, self.mode.form);
            let sums = tiles::open(body, slab, window, [0.0; ROW]);
            let b = &mut Block::new();
            for i in body.records(slab) {
                let row = Row { body, i, first: body.ring_start(slab), rules: self.rules };
                let acting = self.acting(false);
                let mut next = row.start();
                while row.fill(&mut next, b) {
                    row.shape::<APART>(form, b);
                    // SAFETY: bonds lead to records that the window covers, and a record belongs to one slab.
                    let hand = unsafe { Hand::new((&row, &acting), b, sums) };
                    add_gradients(form, hand);
                }
            }
            true
        };
        tiles::sweep(self.body, (windows, false, None), act, ([0.0; ROW], add), |records, sums| {
            // SAFETY: each record settles once.
            let own = unsafe { self.sums.get(ROW * records.start..ROW * records.end) };
            own.copy_from_slice(sums.as_flattened());
        });
    }

    /// Takes the numbers of records that this rank's bonds lead to from the ranks that have them.
    fn share(&self, share: Option<&mut BodyShare>, numbers: &Shared<f64>) {
        if let Some(share) = share {
            // SAFETY: all slabs have settled.
            let numbers = unsafe { numbers.get(0..numbers.len()) };
            share_sums(|slab| self.body.records(slab), &mut share.rows, numbers);
        }
    }

    /// Adds the forces of all bonds to those on particles, and keeps the least measures of families where these are wanted.
    fn pull_all(
        &self,
        (windows, mut share): (&mut [TileWindow], Option<&mut BodyShare>),
        pull: impl Fn(usize, &mut TileWindow) -> bool + Sync,
        particle: &[u32],
        f: &Shared<[f64; 3]>,
    ) {
        let record = &self.body.record;
        let over = (windows, true, share.as_deref_mut());
        tiles::sweep(self.body, over, pull, (FORCE_AND_MEASURE, add_rows), |records, rows| {
            for (i, &[x, y, z, _]) in records.clone().zip(rows) {
                let p = particle[i] as usize;
                if p < f.len() {
                    // SAFETY: in bounds; each particle has one record, which settles once.
                    let f = unsafe { &mut *f.as_ptr().add(p) };
                    let share = record[i].share;
                    *f = [f[0] + share * x, f[1] + share * y, f[2] + share * z];
                }
            }
            if self.judge.keeps {
                // SAFETY: each record settles once.
                let next = unsafe { self.next.get(records) };
                next.iter_mut().zip(rows).for_each(|(next, row)| *next = row[3]);
            }
        });
        if self.judge.keeps {
            self.share(share, &self.next);
        }
    }

    /// Puts the forces of the bonds of one slab's records into the window; false if there are none.
    fn pull(&self, law: &dyn Loops, slab: usize, active: &[bool], window: &mut TileWindow) -> bool {
        let (body, form) = (self.body, self.mode.form);
        let own = body.records(slab);
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
        let force = tiles::open(body, slab, window, FORCE_AND_MEASURE);
        let about = law.about();
        let judge = self.judge.among(body, body.tiles.graph.takers(slab));
        let b = &mut Block::new();
        for (i, lowest) in own.zip(lowest) {
            let row = Row { body, i, first: body.ring_start(slab), rules: self.rules };
            let acting = self.acting(self.known(i, (about.memory, about.lazy)));
            let mut low = 0.0f64;
            let mut next = row.start();
            while row.fill(&mut next, b) {
                if about.back {
                    row.shape::<LAST>(form, b);
                }
                match (about.plain, about.apart) {
                    (true, _) => row.shape::<PLAIN>(form, b),
                    (_, true) => row.shape::<APART>(form, b),
                    _ => row.shape::<FULL>(form, b),
                }
                judge.measure(&row, b);
                // SAFETY: bonds lead to records that the window covers, and a record belongs to one slab.
                let woken = law.in_hand(form, unsafe { Hand::new((&row, &acting), b, force) });
                if woken && about.lazy {
                    // SAFETY: a record belongs to one slab.
                    unsafe { self.touched.get(i..i + 1)[0] = 1 };
                }
                low = low.min(b.low);
                *top = top.max(b.high);
                judge.note(form, &row, b, strained);
            }
            // Rounded down.
            *lowest = (low * (1.0 + 1e-6)) as f32;
        }
        true
    }
}
