//! Pairs of particles in an order that allows summation by particle with the same bits for any number of
//! threads.

use super::six::Six;
use perigrain_base::math::vec3::Vec3;
use perigrain_base::par;

/// Pairs sorted by the index of their lower end, divided where particles are divided into chunks of
/// [`par::CHUNK`].
#[derive(Clone, Debug, Default)]
pub struct Pairs {
    /// Indices of both ends, the lower one first; ascending.
    pub ends: Vec<[u32; 2]>,
    /// Index of each pair in the list this was made from.
    pub origin: Vec<u32>,
    /// The first pair of each chunk of particles, and the number of pairs.
    first: Vec<u32>,
    /// Pairs whose lower end is in an earlier chunk, by the chunk of their upper end.
    late: Vec<u32>,
    /// Start of each chunk's range in `late`.
    first_late: Vec<u32>,
}

impl Pairs {
    /// Sorts pairs of indices below `particles`.
    pub fn new(particles: usize, ends: &[[u32; 2]]) -> Self {
        let sorted = |k: u32| {
            let [a, b] = ends[k as usize];
            [a.min(b), a.max(b)]
        };
        let mut origin: Vec<u32> = (0..ends.len() as u32).collect();
        origin.sort_unstable_by_key(|k| (sorted(*k), *k));
        let ends: Vec<[u32; 2]> = origin.iter().map(|k| sorted(*k)).collect();
        let chunks = particles.div_ceil(par::CHUNK);
        let chunk = |place: u32| place as usize / par::CHUNK;
        let first = (0..=chunks).map(|c| ends.partition_point(|e| chunk(e[0]) < c) as u32).collect();
        let mut late: Vec<u32> = (0..ends.len() as u32)
            .filter(|k| chunk(ends[*k as usize][0]) != chunk(ends[*k as usize][1]))
            .collect();
        late.sort_by_key(|k| chunk(ends[*k as usize][1]));
        let first_late =
            (0..=chunks).map(|c| late.partition_point(|k| chunk(ends[*k as usize][1]) < c) as u32).collect();
        Self { ends, origin, first, late, first_late }
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Sums the contributions of pairs, `pull(pair, places)` to the lower and the upper end, by particle, and
    /// passes them to `take(particle, sum, row)` with the row of the particle in `out`.
    pub fn gather_into<const N: usize, T: Send>(
        &self,
        out: &mut [T],
        pull: impl Fn(usize, [usize; 2]) -> [[f64; N]; 2] + Sync,
        take: impl Fn(usize, &[f64; N], &mut T) + Sync,
    ) {
        par::each(out, |start, rows: &mut [T]| {
            let mut sums = vec![[0.0; N]; rows.len()];
            self.gather_chunk(start, &mut sums, &pull);
            for (k, (sum, row)) in sums.iter().zip(rows).enumerate() {
                take(start + k, sum, row);
            }
        });
    }

    /// Adds the contribution of each pair to its lower and its upper end, `pull(pair, places)`, to the rows
    /// of `out`, one per particle. Pairs across a chunk boundary are evaluated on both sides; each row is
    /// summed over the pairs within its chunk in order, then over those from earlier chunks.
    pub fn gather<const N: usize>(
        &self,
        out: &mut [[f64; N]],
        pull: impl Fn(usize, [usize; 2]) -> [[f64; N]; 2] + Sync,
    ) {
        par::each(out, |start, rows: &mut [[f64; N]]| self.gather_chunk(start, rows, &pull));
    }

    /// The same for the chunk of particles that begins at `start`.
    #[inline(always)]
    pub fn gather_chunk<const N: usize>(
        &self,
        start: usize,
        rows: &mut [[f64; N]],
        pull: &(impl Fn(usize, [usize; 2]) -> [[f64; N]; 2] + Sync),
    ) {
        if self.is_empty() {
            return;
        }
        let chunk = start / par::CHUNK;
        let own = self.first[chunk]..self.first[chunk + 1];
        let late = &self.late[self.first_late[chunk] as usize..self.first_late[chunk + 1] as usize];
        // A single loop, so that `pull` is inlined in one place only.
        for k in own.chain(late.iter().copied()).map(|k| k as usize) {
            let [i, j] = self.ends[k].map(|place| place as usize);
            let [low, high] = pull(k, [i, j]);
            // An end outside the chunk is before its first row or after its last.
            for (place, more) in [(i, low), (j, high)] {
                if let Some(row) = rows.get_mut(place.wrapping_sub(start)) {
                    row.iter_mut().zip(more).for_each(|(sum, a)| *sum += a);
                }
            }
        }
    }
}

/// Connections between particles that resist motion like springs.
pub trait Ties: Sync {
    /// Both ends of each, the lower one first; ascending, as in [`Pairs`].
    fn ends(&self) -> &[[u32; 2]];
    /// Vector from the lower end to the upper one [length].
    fn vector(&self, k: usize) -> Vec3;
    /// Whether it has any resistance.
    fn bears(&self, k: usize) -> bool;
    /// The resisting forces and torques of both ends for these motions.
    fn resist(&self, k: usize, ends: [&Six; 2]) -> [Six; 2];
}

/// Lists of numbers, one per index.
#[derive(Clone, Debug, Default)]
pub struct Lists {
    first: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    /// From pairs of an index below `places` and a number; the order is kept.
    pub fn new(places: usize, items: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let mut first = vec![0; places + 1];
        items.clone().for_each(|(place, _)| first[place as usize + 1] += 1);
        (0..places).for_each(|place| first[place + 1] += first[place]);
        let (mut next, mut list) = (first.clone(), vec![0; first[places] as usize]);
        for (place, item) in items {
            let at = &mut next[place as usize];
            list[*at as usize] = item;
            *at += 1;
        }
        Self { first, items: list }
    }

    /// The number of indices.
    pub fn len(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// Whether there are no indices.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The list of an index.
    pub fn of(&self, place: usize) -> &[u32] {
        &self.items[self.first[place] as usize..self.first[place + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_end_gets_its_part_once() {
        let n = 3 * par::CHUNK + 5;
        // Some pairs within chunks, some across, with both orders of ends.
        let ends: Vec<[u32; 2]> = (0..9 * n)
            .map(|k| [(k * 7919) % n, (k * 104_729 + 1) % n].map(|i| i as u32))
            .filter(|[a, b]| a != b)
            .collect();
        let pairs = Pairs::new(n, &ends);
        let mut out = vec![[0.0; 2]; n];
        pairs.gather(&mut out, |k, [i, j]| {
            assert!(i < j);
            let id = f64::from(pairs.origin[k]) + 1.0;
            [[1.0, id], [1.0, -id]]
        });
        let mut wanted = vec![[0.0; 2]; n];
        for (k, [a, b]) in ends.iter().enumerate() {
            let id = k as f64 + 1.0;
            for (place, sign) in [(a.min(b), 1.0), (a.max(b), -1.0)] {
                wanted[*place as usize][0] += 1.0;
                wanted[*place as usize][1] += sign * id;
            }
        }
        // Integers below 2^53: sums are exact in any order.
        assert_eq!(out, wanted);
        assert!(!pairs.is_empty() && pairs.len() == ends.len());
    }
}
