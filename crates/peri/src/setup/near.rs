//! Pairs without a living bond that may come into short-range contact: found now and then, kept in between.
//!
//! Any two particles closer than the reach of families when these were built are bonded. So no particle without a
//! bond can be in contact before two particles have come closer by the reach minus the contact range, and later
//! searches keep all pairs within the contact range plus a skin. How much closer two particles may have come is
//! bounded by the range of displacement changes, added up over steps: a body that flies undeformed needs no search. Where that is
//! used up, neighbours may have moved far less than the ends of the body: they are looked at place by place ([`super::wear`]).

use crate::families::lattice::RowMotion;
use crate::families::shares::Shares;
use crate::families::{Families, NearPair, PeriView};
use crate::setup::joined::Joined;
use crate::shares::{agreed_motion, pairs_everywhere};

/// Contact between unbonded particles never reaches farther than this many lattice spacings.
const CONTACT: f64 = 1.35;
/// Pairs are kept up to this many spacings beyond that.
const SKIN: f64 = 0.35;
/// The part of the skin that must be left for pairs to last longer: below it looking again soon costs more than a search.
const ENOUGH: f64 = 0.2;

impl Families {
    /// Starts with no pairs, good until something has moved by more than the reach of families leaves free.
    pub(crate) fn start_near(&mut self, shortest_reach: f64) {
        let free = shortest_reach - CONTACT * self.options.lattice_spacing;
        self.near.skin = free;
        self.near.allowed = [free; 2];
        self.near.spent = [0.0; 2];
        self.near.pairs.iter_mut().for_each(Vec::clear);
    }

    /// Forgets pairs; they are searched anew at the next force evaluation.
    pub fn forget_near(&mut self) {
        self.near.allowed = [f64::NEG_INFINITY; 2];
        self.near.looked.clear();
        self.near.pairs.iter_mut().for_each(Vec::clear);
        self.scratch.contact.forget();
    }

    /// Whether pairs are to be searched anew, or looked at place by place, after such changes; see [`Families::update_near`].
    pub(crate) fn searches(&self, (within, all): (f64, f64)) -> bool {
        let near = &self.near;
        [within, all]
            .into_iter()
            .enumerate()
            .any(|(part, change)| near.spent[part] + change >= near.allowed[part])
    }

    /// Brings the pairs up to date with positions. `within` and `all` are the ranges of displacement changes
    /// since the last step that advanced: the largest in one body, and that of all particles together. Returns
    /// how much closer particles may be now than when pairs were searched. Several ranks may share the search out.
    pub(crate) fn update_near(
        &mut self,
        view: &PeriView,
        changes: (f64, f64),
        (advance, shares): (bool, Option<&Shares>),
    ) -> [f64; 2] {
        let mut closer = [0.0; 2];
        for (part, change) in [changes.0, changes.1].into_iter().enumerate() {
            let spent = self.near.spent[part] + change;
            if spent >= self.near.allowed[part] {
                // Where nothing is kept there may be a way back, which has not been added up.
                if !(part == 0 && advance && self.lasts(view, spent)) {
                    self.search(view, part, shares);
                    continue;
                }
            }
            closer[part] = spent;
            if advance {
                self.near.spent[part] = spent;
            }
        }
        closer
    }

    /// Looks place by place how much closer particles of a body have come, and lets pairs last longer where that leaves enough.
    fn lasts(&mut self, view: &PeriView, spent: f64) -> bool {
        let skin = self.near.skin;
        let left = self.wear(view, CONTACT * self.options.lattice_spacing, skin);
        if left < ENOUGH * skin {
            return false;
        }
        self.near.allowed[0] = spent + left;
        true
    }

    fn search(&mut self, view: &PeriView, part: usize, shares: Option<&Shares>) {
        let lc = self.options.lattice_spacing;
        let range = (CONTACT + SKIN) * lc;
        let mut cells = std::mem::take(&mut self.scratch.cells);
        self.near.spent[part] = 0.0;
        self.near.allowed[part] = SKIN * lc;
        self.near.skin = SKIN * lc;
        let bodied = |p: &u32| self.place[*p as usize] != u32::MAX;
        if part == 0 {
            cells.fill(view.x, (0..self.place.len() as u32).filter(bodied), &view.bounds, range);
        } else {
            let (chosen, gap) = self.across(view, range);
            cells.fill(view.x, chosen.iter().copied(), &view.bounds, range);
            self.near.allowed[part] = self.near.allowed[part].max(gap - CONTACT * lc);
        }
        let (joined, unbonded) = (Joined::of(self), (part == 0).then_some(false));
        let rows = shares.map_or(0..cells.rows(), |shares| cells.part(shares.me, shares.ranks));
        let found = cells.gather(&view.bounds, (range, rows), |i, j, square| {
            if square >= range * range
                || self.table.get(view.kind[i as usize], view.kind[j as usize]).is_none()
            {
                return None;
            }
            // What cannot come into contact before the next search is not needed.
            let pair = self.near_pair(view, (i, j), square, 0.0);
            let soon = f64::from(pair.after) <= self.near.allowed[part];
            (soon && joined.bond(i, j) == unbonded).then_some(pair)
        });
        self.near.pairs[part] = match shares {
            Some(shares) => pairs_everywhere(found, shares.me),
            None => found,
        };
        self.scratch.contact.near[part].clear();
        self.scratch.cells = cells;
        if part == 0 {
            self.looked_at(view);
        }
    }

    /// Particles that may be within `range` of another body, and the least gap between bodies if there are none.
    fn across(&self, view: &PeriView, range: f64) -> (Vec<u32>, f64) {
        let bodies = self.lattices.len() + 1;
        let mut boxes = vec![([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]); bodies];
        for p in 0..self.place.len() as u32 {
            if let Some((lo, hi)) = boxes.get_mut(self.body_of(p) as usize) {
                for k in 0..3 {
                    lo[k] = lo[k].min(view.x[p as usize][k]);
                    hi[k] = hi[k].max(view.x[p as usize][k]);
                }
            }
        }
        let loose = self.near.loose.iter().map(|l| l.0);
        if view.bounds.periodic != [false; 3] || self.near.loose.len() > 64 || bodies > 1000 {
            let all = (0..self.place.len() as u32).filter(|&p| self.place[p as usize] != u32::MAX);
            return (all.chain(loose).collect(), 0.0);
        }
        let mut gap = f64::INFINITY;
        for (a, own) in boxes.iter().enumerate() {
            for other in &boxes[a + 1..] {
                gap = gap.min(separation(own, other));
            }
        }
        if gap > range && self.near.loose.is_empty() {
            return (vec![], gap);
        }
        let near = |x: &[f64; 3], b: &([f64; 3], [f64; 3])| separation(&(*x, *x), b) <= range;
        let bonded = (0..self.place.len() as u32).filter(|&p| {
            let (own, x) = (self.body_of(p), &view.x[p as usize]);
            own != u32::MAX
                && (boxes.iter().enumerate().any(|(b, other)| b as u32 != own && near(x, other))
                    || self.near.loose.iter().any(|l| near(x, &(view.x[l.0 as usize], view.x[l.0 as usize]))))
        });
        (bonded.chain(loose).collect(), 0.0)
    }

    /// Keeps a pair in view whose bond has just broken; `square` is that of its distance.
    pub(crate) fn add_broken(&mut self, view: &PeriView, (i, j): (u32, u32), square: f64) {
        // Since a search in which places were kept, ways there and back are not added up: both may be a skin long.
        let skins = if self.near.looked.is_empty() { 1.0 } else { 2.0 };
        let range = CONTACT * self.options.lattice_spacing + skins * self.near.skin.max(0.0);
        if square < range * range {
            let pair = self.near_pair(view, (i, j), square, self.near.spent[0]);
            self.near.pairs[0].push(pair);
        }
    }

    /// Two particles, the `square` of whose distance is given, that cannot touch before they have come closer by what lies between them now;
    /// `spent` is what has been spent so far.
    fn near_pair(&self, view: &PeriView, (i, j): (u32, u32), square: f64, spent: f64) -> NearPair {
        let contact = self.options.contact_range(view, i, j);
        let gap = square.sqrt() - contact;
        // Rounded down by more than f32 and the sum of many steps may lose.
        let after = if gap > 0.0 { (spent + gap) * (1.0 - 1e-6) } else { 0.0 };
        let within = contact * contact * (1.0 + 1e-6);
        NearPair { ends: [i.min(j), i.max(j)], after: after as f32, within: within as f32 }
    }

    /// The ranges of displacement changes within bodies and over everything; loose particles are looked at here. Where work is shared
    /// out, each rank has those of its own tiles, and all agree.
    pub(crate) fn ranges(
        &mut self,
        view: &PeriView,
        list: &RowMotion,
        (advance, shares): (bool, Option<&Shares>),
    ) -> (f64, f64) {
        let agreed = shares.map(|shares| agreed_motion(&self.lattices, list, shares)).unwrap_or_default();
        let own =
            self.lattices.iter().map(|body| body.motion.iter().fold(RowMotion::NONE, |m, row| m.with(row)));
        let (mut all, mut within) = (RowMotion::NONE, 0.0f64);
        for (k, own) in own.chain([*list]).enumerate() {
            let motion = agreed.get(k).unwrap_or(&own);
            within = within.max(diagonal(motion));
            all = all.with(motion);
        }
        for (p, last) in &mut self.near.loose {
            let x = view.x[*p as usize];
            let d = view.bounds.nearest([0, 1, 2].map(|k| x[k] - last[k]));
            all = all.with(&RowMotion { least: d, most: d, ..RowMotion::NONE });
            if advance {
                *last = x;
            }
        }
        (within, diagonal(&all))
    }
}

/// The length of the diagonal of the box of displacement changes.
fn diagonal(m: &RowMotion) -> f64 {
    (0..3).map(|k| (m.most[k] - m.least[k]).max(0.0).powi(2)).sum::<f64>().sqrt()
}

/// The distance of two boxes.
fn separation(a: &([f64; 3], [f64; 3]), b: &([f64; 3], [f64; 3])) -> f64 {
    (0..3).map(|k| (a.0[k] - b.1[k]).max(b.0[k] - a.1[k]).max(0.0).powi(2)).sum::<f64>().sqrt()
}
