//! The coefficients of all pairs of types, as the deck's lines and fixes have made them.

use super::{Coeff, Declared, Law, Mix};
use perigrain_base::math::vec3::{Vec3, dot, sub};
use perigrain_neigh::list::{Pair as Near, Reach, Wanted, difference};
use perigrain_world::adapted::Coefficient;
use perigrain_world::{Numbers, World};
use std::marker::PhantomData;

/// The coefficients of a pair of types.
#[derive(Clone)]
struct Entry {
    declared: Coeff,
    now: Coeff,
    /// No line of the deck names these two types together.
    mixed: bool,
    /// Where fixes leave the numbers that they have changed.
    keys: Vec<Numbers>,
}

/// A law with its coefficients in force.
pub struct Table<L> {
    rule: Mix,
    types: usize,
    entries: Vec<Option<Entry>>,
    /// Which pairs of types act, and how far.
    pub wanted: Wanted,
    /// The farthest cutoff, squared [length²].
    farthest: f64,
    /// Which changes by fixes have been seen.
    adapted: f64,
    /// What pair forces count between two particles, by ids, where `special_bonds` has parts of 1.
    parts: Vec<([u32; 2], f64)>,
    law: PhantomData<L>,
}

/// What two particles do to each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Felt {
    /// x_i − x_j [length].
    pub d: Vec3,
    /// F/r, positive apart [force/length].
    pub force: f64,
    /// Energy of the pair [energy].
    pub energy: f64,
}

impl<L: Law> Table<L> {
    /// For a style, with the coefficients of the deck's lines.
    pub fn new(style: &Declared<L>, w: &World) -> Self {
        let types = w.types;
        let (mut entries, mut wanted) = (vec![None; types * types], Wanted::new(types));
        let mut farthest: f64 = 0.0;
        for ((i, j), (declared, mixed)) in style.pairs(types) {
            let of = |name: &&str| {
                let (style, name) = (L::NAME.to_string(), (*name).to_string());
                Coefficient { bond: false, style, name, types: (i, j) }.key()
            };
            let entry = Entry { declared, now: declared, mixed, keys: L::NUMBERS.iter().map(of).collect() };
            wanted.set(i, j, Reach::Fixed(declared.cutoff));
            farthest = farthest.max(declared.cutoff);
            for (a, b) in [(i, j), (j, i)] {
                entries[place(types, a, b)] = Some(entry.clone());
            }
        }
        let (rule, farthest) = (style.rule, farthest * farthest);
        Self { rule, law: PhantomData, types, entries, wanted, farthest, adapted: 0.0, parts: vec![] }
    }

    /// Takes in what fixes have made of the coefficients.
    pub fn renew(&mut self, w: &World) {
        if self.adapted == w.adaptations() {
            return;
        }
        self.adapted = w.adaptations();
        let own = |entry: &Entry| {
            let mut now = entry.declared;
            for (number, key) in now.own.iter_mut().zip(&entry.keys) {
                *number = w.adapted(*key).unwrap_or(*number);
            }
            now
        };
        for entry in self.entries.iter_mut().flatten().filter(|entry| !entry.mixed) {
            entry.now = own(entry);
        }
        for (i, j) in (1..=self.types as u16).flat_map(|i| (1..=self.types as u16).map(move |j| (i, j))) {
            let like = |t| Some(self.entries[place(self.types, t, t)].as_ref()?.now);
            let mixed = like(i).zip(like(j)).map(|(a, b)| L::mixed(&a, &b, self.rule));
            let at = place(self.types, i, j);
            if let (Some(entry), Some(mixed)) = (self.entries[at].as_mut().filter(|e| e.mixed), mixed) {
                entry.now = mixed;
            }
        }
    }

    /// The farthest cutoff [length].
    pub fn farthest(&self) -> f64 {
        self.farthest.sqrt()
    }

    /// Applies the weights of `special_bonds` to the present bonds.
    pub fn weigh(&mut self, w: &World) {
        self.parts = w.bonds.weakened();
    }

    /// What the two of a pair do to each other now; `None` beyond their cutoff.
    pub fn felt(&self, w: &World, pair: &Near) -> Option<Felt> {
        let p = &w.particles;
        let (i, j) = (pair.i as usize, pair.j as usize);
        let d = difference(&p.x, &w.periods(), pair);
        let square = dot(d, d);
        if square >= self.farthest {
            return None;
        }
        let Some(Entry { now, .. }) = &self.entries[place(self.types, p.kind[i], p.kind[j])] else {
            return None;
        };
        if square >= now.cutoff * now.cutoff {
            return None;
        }
        let [force, energy] = L::at(now, d, square.sqrt(), || sub(p.v[i], p.v[j]));
        let part = self.part([p.tag[i], p.tag[j]]);
        Some(Felt { d, force: part * force, energy: part * energy })
    }

    fn part(&self, ends: [u32; 2]) -> f64 {
        if self.parts.is_empty() {
            return 1.0;
        }
        let ends = perigrain_world::bonds::ascending(ends);
        self.parts.binary_search_by_key(&ends, |(pair, _)| *pair).map_or(1.0, |at| self.parts[at].1)
    }
}

fn place(types: usize, i: u16, j: u16) -> usize {
    (usize::from(i) - 1) * types + usize::from(j) - 1
}
