//! Contacts of many grains: spatial order, short lists, four contacts at a time; the same numbers as the plain driver.
//!
//! Grains are copied into records that stand in the order of cells ([`Slabs`]). Each slab of cells has a list of the pairs
//! within the skin, and of those a shorter list of pairs within a thin second skin, which holds what contacts remember.
//! A step tests the distances of the short list four at a time and evaluates the law for four contacts at a time; slabs
//! in two colours keep the order of additions for any number of threads.

mod deep;
mod lists;
mod memory;
mod sweep;

use super::driver::Grains;
use super::{Advance, ContactLaw};
use crate::math::four::has_avx2;
use crate::math::vec3::Vec3;
use crate::neigh::slabs::{Slabs, shift_of};
use crate::par;
use crate::world::contacts::Contacts;
use lists::{Short, Slab};
use memory::Book;

/// How many numbers at most a contact of the fast loop remembers.
pub const MOST_MEMORY: usize = 7;
/// How many grains at most: a place and an image share 32 bits.
pub const MOST_GRAINS: usize = (1 << sweep::PLACE_BITS) - 1;
/// The second skin in units of the first.
const THIN: f64 = 0.2;
/// No law.
const NONE: u8 = u8::MAX;

/// Which law holds between which types.
#[derive(Clone, Debug)]
pub struct Laws<L> {
    distinct: Vec<L>,
    types: usize,
    which: Vec<u8>,
}

impl<L: ContactLaw + PartialEq> Laws<L> {
    /// A table from `law(a, b)` for types from 1, symmetric; `None` where there are too many different laws.
    pub fn new(types: usize, law: impl Fn(u16, u16) -> Option<L>) -> Option<Self> {
        let mut t = Self { distinct: vec![], types, which: vec![] };
        for a in 1..=types as u16 {
            for b in 1..=types as u16 {
                let Some(law) = law(a, b) else {
                    t.which.push(NONE);
                    continue;
                };
                let at = t.distinct.iter().position(|l| *l == law).unwrap_or_else(|| {
                    t.distinct.push(law);
                    t.distinct.len() - 1
                });
                t.which.push(u8::try_from(at).ok().filter(|at| *at < NONE)?);
            }
        }
        Some(t)
    }

    /// The laws, each once.
    pub fn distinct(&self) -> &[L] {
        &self.distinct
    }
}

impl<L: ContactLaw> Laws<L> {
    #[inline]
    fn which(&self, a: u16, b: u16) -> u8 {
        self.which[(usize::from(a) - 1) * self.types + usize::from(b) - 1]
    }

    /// How many numbers a contact remembers at most.
    pub fn memory(&self) -> usize {
        self.distinct.iter().map(ContactLaw::memory).max().unwrap_or(0)
    }
}

/// A record that lies within a line of memory.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug, Default)]
struct Four([f64; 4]);

/// A record that fills a line of memory.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Default)]
struct Eight([f64; 8]);

/// The box as lists see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Lower corner [length].
    pub lo: [f64; 3],
    /// Edge lengths; zero where the box does not repeat.
    pub period: [f64; 3],
    /// How far beyond touching the lists reach [length].
    pub skin: f64,
}

/// Records, lists and contacts of all grains.
#[derive(Clone, Debug)]
pub struct Fast<L> {
    laws: Laws<L>,
    slabs: Slabs,
    /// By place: identity and type of the grain there.
    tag: Vec<u32>,
    kind: Vec<u16>,
    /// The place of each grain.
    place: Vec<u32>,
    /// By place: position and radius. One more, all zeros, fills lists up.
    position: Vec<Four>,
    /// By place: velocity and mass (negative where frozen), angular velocity and radius.
    motion: Vec<Eight>,
    /// By place: force and 0, torque and 0.
    force: Vec<Eight>,
    lists: Vec<Slab>,
    /// How far a place is shifted in each image, and 0.
    shifts: [[f64; 4]; 32],
    /// The second skin [length].
    thin: f64,
    /// How far any grain may have moved since the short lists were made [length].
    moved: f64,
    /// Number of the present step among those that remember; contacts of the last one carry it.
    now: f64,
    /// Numbers per pair in the short list: what is remembered and the step it was.
    width: usize,
    /// What contacts remembered before the lists were made anew.
    book: Option<Book>,
    /// Of the pairs that were the first to overlap too far, the one of smallest ids, and by which part of its radius.
    pub deep: Option<([u32; 2], f64)>,
    /// Room for new short lists.
    spare: Vec<Short>,
}

impl<L: ContactLaw> Fast<L> {
    /// Without grains.
    pub fn new(laws: Laws<L>) -> Self {
        let width = if laws.memory() <= 3 { 4 } else { 8 };
        Self {
            laws,
            slabs: Slabs::default(),
            tag: vec![],
            kind: vec![],
            place: vec![],
            position: vec![],
            motion: vec![],
            force: vec![],
            lists: vec![],
            shifts: [[0.0; 4]; 32],
            thin: 0.0,
            moved: f64::INFINITY,
            now: 0.0,
            width,
            book: None,
            deep: None,
            spare: vec![],
        }
    }

    /// Forgets grains and contacts.
    pub fn clear(&mut self) {
        *self = Self::new(self.laws.clone());
    }

    /// Number of grains the lists were made for.
    pub fn len(&self) -> usize {
        self.tag.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.tag.is_empty()
    }

    /// Makes all lists anew from these positions (wrapped into the box), pairs for which `keep(i, j)`. Contacts of the last
    /// evaluation keep what they remember; `known` are taken in addition. An evaluation must follow.
    pub fn rebuild(
        &mut self,
        grains: &Grains,
        frame: &Frame,
        known: Option<&Contacts>,
        keep: &(impl Fn(usize, usize) -> bool + Sync),
    ) {
        let n = grains.x.len();
        let largest = grains.radius.iter().copied().fold(0.0, f64::max);
        let mut slabs = std::mem::take(&mut self.slabs);
        slabs.sort(grains.x, grains.tag, 2.0 * largest + frame.skin, &frame.lo, &frame.period);
        let tag: Vec<u32> = slabs.order.iter().map(|&i| grains.tag[i as usize]).collect();
        let book = self.remember(&tag, known);
        self.slabs = slabs;
        self.tag = tag;
        self.kind.clear();
        self.kind.extend(self.slabs.order.iter().map(|&i| grains.kind[i as usize]));
        self.place.resize(n, 0);
        for (k, &i) in self.slabs.order.iter().enumerate() {
            self.place[i as usize] = k as u32;
        }
        self.position.clear();
        self.position.resize(n + 1, Four::default());
        self.motion.resize(n + 1, Eight::default());
        self.motion[n] = Eight::default();
        self.force.clear();
        self.force.resize(n + 1, Eight::default());
        for (image, shift) in self.shifts.iter_mut().take(27).enumerate() {
            let s = shift_of(image as u32);
            (0..3).for_each(|d| shift[d] = s[d] * frame.period[d]);
        }
        self.thin = THIN * frame.skin;
        // Long lists from the positions of the rebuild, short ones from the present ones.
        let held: Vec<[f64; 4]> = self.slabs.order.iter().map(|&i| record(grains, i as usize)).collect();
        self.make_long(&held, frame.skin, keep);
        drop(held);
        self.book = Some(book);
        self.moved = f64::INFINITY;
    }

    /// Takes the grains' present state into the records: in the order of the grains, as writing two records somewhere
    /// costs less than reading five columns somewhere.
    fn gather(&mut self, grains: &Grains) {
        let n = self.len();
        let place = &self.place[..n];
        let position = par::Shared::new(&mut self.position);
        let motion = par::Shared::new(&mut self.motion);
        let copy = |range: std::ops::Range<usize>| {
            let (mut far, mut grown) = (0.0_f64, 0.0_f64);
            let of = grains.x[range.clone()].iter().zip(&grains.radius[range.clone()]);
            let moving = grains.v[range.clone()].iter().zip(&grains.omega[range.clone()]);
            let rest = grains.mass[range.clone()].iter().zip(&place[range.clone()]);
            for (i, (((x, r), (v, w)), (m, k))) in range.zip(of.zip(moving).zip(rest)) {
                let k = *k as usize;
                // SAFETY: every grain has a place of its own, and records are as many as places.
                let (p, motion) =
                    unsafe { (&mut (*position.as_ptr().add(k)).0, &mut (*motion.as_ptr().add(k)).0) };
                let d = [x[0] - p[0], x[1] - p[1], x[2] - p[2]];
                far = far.max(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
                grown = grown.max((r - p[3]).abs());
                *p = [x[0], x[1], x[2], *r];
                let m = if grains.frozen.get(i) == Some(&true) { -m } else { *m };
                *motion = [v[0], v[1], v[2], m, w[0], w[1], w[2], *r];
            }
            [far, grown]
        };
        let join = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].max(b[1])];
        let [far, grown] = par::reduce(n, copy, join).unwrap_or([0.0; 2]);
        self.moved += far.sqrt() + grown;
    }

    /// Evaluates all contacts for the grains' present state; [`Fast::scatter`] must follow. With `store` they remember, else nothing is changed but
    /// forces. With `virial` returns Σ d ⊗ F: xx yy zz xy xz yz.
    pub fn run(&mut self, grains: &Grains, step: Advance, store: bool, virial: bool) -> [f64; 6] {
        self.gather(grains);
        // Two grains came closer by twice what one moved at most.
        if 2.0 * self.moved >= self.thin {
            self.make_short();
            self.moved = 0.0;
        }
        self.sweep(step, store, virial, !grains.frozen.is_empty());
        if self.deep.is_none() && self.lists.iter().any(|l| l.deep) {
            self.deep = self.find_deep();
        }
        self.now += if store { 1.0 } else { 0.0 };
        let mut total = [0.0; 6];
        for slab in self.lists.iter().filter(|_| virial) {
            (0..6).for_each(|k| total[k] += slab.virial[k]);
        }
        total
    }

    /// Adds forces and torques to the grains' own. Once after each evaluation.
    pub fn scatter(&mut self, f: &mut [Vec3], torque: &mut [Vec3]) {
        let force = par::Shared::new(&mut self.force);
        par::each((f, torque, &self.place[..]), |_, (f, torque, place)| {
            for ((f, torque), &k) in f.iter_mut().zip(torque).zip(place) {
                // SAFETY: every grain has a place of its own, and records are as many as places.
                let own = unsafe { &mut (*force.as_ptr().add(k as usize)).0 };
                for d in 0..3 {
                    f[d] += own[d];
                    torque[d] += own[4 + d];
                }
                // The next evaluation starts from zero.
                *own = [0.0; 8];
            }
        });
    }

    /// Pairs in long lists and in short ones.
    pub fn pairs(&self) -> [usize; 2] {
        let sum = |f: fn(&Slab) -> usize| self.lists.iter().map(f).sum();
        [sum(|s| s.long.i.len()), sum(|s| s.short.i.len())]
    }
}

/// Position and radius of a grain.
#[inline]
fn record(g: &Grains, i: usize) -> [f64; 4] {
    let x = g.x[i];
    [x[0], x[1], x[2], g.radius[i]]
}

#[cfg(test)]
mod tests;
