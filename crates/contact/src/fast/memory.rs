//! Contact histories, carried from list to list and exchanged with the world.

use super::Fast;
use super::lists::Short;
use perigrain_base::math::lanes::place;
use perigrain_world::contacts::{Contacts, mirror};
use std::ops::Range;

/// Histories by the index of the grain with the smaller tag, seen from that grain.
#[derive(Clone, Debug)]
pub struct Book {
    start: Vec<u32>,
    partner: Vec<u32>,
    width: usize,
    history: Vec<f64>,
}

impl Book {
    /// The history of the contact of two grains, the one with the smaller tag first.
    #[inline]
    pub fn get(&self, first: u32, second: u32) -> Option<&[f64]> {
        let of: Range<usize> = self.start[first as usize] as usize..self.start[first as usize + 1] as usize;
        let k = of.start + self.partner[of].iter().position(|p| *p == second)?;
        Some(&self.history[k * self.width..][..self.width])
    }
}

/// A contact of the last evaluation.
struct Live<'a> {
    /// Current index of the grain with the smaller tag, and of the other one.
    first: u32,
    second: u32,
    /// Whether the history is stored as seen from the other grain.
    turned: bool,
    history: &'a [f64],
}

/// Index of each tag.
pub(super) enum Places {
    /// By tag; `u32::MAX` for missing tags.
    Table(Vec<u32>),
    /// Tag and index, sorted.
    List(Vec<[u32; 2]>),
}

impl Places {
    pub(super) fn new(tag: &[u32]) -> Self {
        let last = tag.iter().copied().max().unwrap_or(0) as usize;
        if last > 8 * tag.len() + 1024 {
            let mut list: Vec<[u32; 2]> = tag.iter().zip(0..).map(|(t, k)| [*t, k]).collect();
            list.sort_unstable();
            return Self::List(list);
        }
        let mut table = vec![u32::MAX; last + 1];
        tag.iter().zip(0..).for_each(|(t, k)| table[*t as usize] = k);
        Self::Table(table)
    }

    pub(super) fn of(&self, tag: u32) -> Option<u32> {
        match self {
            Self::Table(t) => t.get(tag as usize).copied().filter(|k| *k != u32::MAX),
            Self::List(list) => list.binary_search_by_key(&tag, |[t, _]| *t).ok().map(|k| list[k][1]),
        }
    }
}

impl Fast {
    /// The contacts of the last evaluation and the known ones, for grains in this new order.
    pub(super) fn remember(&self, tag: &[u32], known: Option<&Contacts>) -> Book {
        let places = Places::new(tag);
        let width = self.width - 1;
        let mut start = vec![0; tag.len() + 1];
        let both = |a: u32, b: u32| places.of(a).zip(places.of(b));
        let live = self.live(both);
        live.iter().for_each(|l| start[l.first as usize] += 1);
        for &[a, b] in known.iter().flat_map(|c| &c.keys) {
            if let Some((p, _)) = both(a, b) {
                start[p as usize] += 1;
            }
        }
        let mut sum = 0;
        for s in &mut start {
            sum += *s;
            *s = sum;
        }
        let (mut partner, mut history) = (vec![0; sum as usize], vec![0.0; sum as usize * width]);
        // Filled from the end: each start ends up at its first contact.
        let mut put = |p: u32, q: u32, h: &[f64], turned: bool| {
            start[p as usize] -= 1;
            let k = start[p as usize] as usize;
            partner[k] = q;
            let kept = width.min(h.len());
            let row = &mut history[k * width..][..width];
            row[..kept].copy_from_slice(&h[..kept]);
            if turned {
                mirror(row);
            }
        };
        if let Some(c) = known {
            for (k, &[a, b]) in c.keys.iter().enumerate().rev() {
                if let Some((p, q)) = both(a, b) {
                    put(p, q, &c.history[k * c.width..][..c.width], false);
                }
            }
        }
        for l in &live {
            put(l.first, l.second, l.history, l.turned);
        }
        Book { start, partner, width, history }
    }

    /// The contacts of the last evaluation between grains that still exist; `both` maps two tags to their
    /// current indices.
    fn live(&self, both: impl Fn(u32, u32) -> Option<(u32, u32)>) -> Vec<Live<'_>> {
        let (width, mut live) = (self.width, vec![]);
        for short in self.lists.iter().map(|list| &list.short) {
            let rows = short.history.chunks_exact(width);
            for ((i, w), row) in short.i.iter().zip(&short.w).zip(rows) {
                if row[width - 1] != self.now {
                    continue;
                }
                let (a, b) = (self.tag[*i as usize], self.tag[place(*w)]);
                let turned = a > b;
                if let Some((first, second)) = both(a.min(b), a.max(b)) {
                    live.push(Live { first, second, turned, history: &row[..width - 1] });
                }
            }
        }
        live
    }

    /// Writes the history of a pair of grains into the row of a short list, with the number of the step.
    pub(super) fn look_up(&self, book: &Book, i: u32, w: u32, row: &mut [f64]) {
        let j = place(w) as u32;
        let memory = self.width - 1;
        row.fill(0.0);
        row[memory] = -1.0;
        let first = self.tag[i as usize] <= self.tag[j as usize];
        let found = if first { book.get(i, j) } else { book.get(j, i) };
        if let Some(h) = found {
            row[..memory].copy_from_slice(h);
            row[memory] = self.now;
            if !first {
                mirror(&mut row[..memory]);
            }
        }
    }

    /// The contacts with a history from the last evaluation, in the form of the world; on ranks only those of
    /// whole lists.
    pub fn contacts(&self) -> Contacts {
        let (memory, width) = (self.laws.memory(), self.width);
        let is_live = |s: &Short, k: usize| s.history[(k + 1) * width - 1] == self.now;
        let live = |s: &Short| (0..s.i.len()).filter(|&k| is_live(s, k)).count();
        let own = || self.whole_lists().map(|(_, list)| &list.short);
        let count = own().map(live).sum();
        // Keys with the number of the pair, counted across all lists.
        let mut entries = Vec::with_capacity(count);
        let mut first = vec![0];
        let lists: Vec<&Short> = own().collect();
        for short in &lists {
            let before = first[first.len() - 1];
            for k in (0..short.i.len()).filter(|&k| is_live(short, k)) {
                let (p, q) = self.tags(short, k);
                entries.push(([p.min(q), p.max(q)], before + k as u32));
            }
            first.push(before + short.i.len() as u32);
        }
        entries.sort_unstable();
        let mut history = Vec::with_capacity(count * memory);
        for (_, number) in &entries {
            let list = first.partition_point(|f| f <= number) - 1;
            let (short, k) = (lists[list], (number - first[list]) as usize);
            let from = history.len();
            history.extend_from_slice(&short.history[k * width..][..memory]);
            let (p, q) = self.tags(short, k);
            if p > q {
                mirror(&mut history[from..]);
            }
        }
        let mut keys: Vec<[u32; 2]> = entries.into_iter().map(|(key, _)| key).collect();
        keys.shrink_to_fit();
        Contacts { keys, width: memory, history }
    }

    /// The tags of a pair of a short list.
    fn tags(&self, short: &Short, k: usize) -> (u32, u32) {
        (self.tag[short.i[k] as usize], self.tag[place(short.w[k])])
    }

    /// Releases everything except contact histories, which [`Fast::contacts`] still returns.
    pub fn keep_contacts(&mut self) {
        self.lists.iter_mut().for_each(|l| (l.long, l.watched) = Default::default());
        self.spare = vec![];
        self.validity.forget();
    }
}
