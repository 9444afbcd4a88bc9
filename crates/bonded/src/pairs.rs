//! Pairs of particles in an order in which what they do can be added up by particle, with the same bits for any number of threads.

use super::six::Six;
use perigrain_base::math::vec3::Vec3;
use perigrain_base::par;

/// Pairs by the place of their lower end, cut where particles are cut into chunks of [`par::CHUNK`].
#[derive(Clone, Debug, Default)]
pub struct Pairs {
    /// Places of both ends, the lower one first; ascending.
    pub ends: Vec<[u32; 2]>,
    /// Where each was in the list that this was made from.
    pub origin: Vec<u32>,
    /// The first pair of each chunk of particles, and the number of pairs.
    first: Vec<u32>,
    /// Pairs whose lower end is in an earlier chunk, by the chunk of their upper end.
    late: Vec<u32>,
    /// Where those of each chunk begin.
    first_late: Vec<u32>,
}

impl Pairs {
    /// Puts pairs of places below `particles` in order.
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

    /// What pairs give to each particle, `pull(pair, places)` to the lower end and to the upper one, added up and handed to
    /// `take(particle, sum, row)` with the row of the particle in `out`.
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

    /// Adds what each pair gives to its lower end and to its upper one, `pull(pair, places)`, to the rows of `out`: one for each
    /// particle. What crosses a border of chunks is reckoned on both sides; each row is added to in the order of the pairs
    /// within its chunk, then of those from before.
    pub fn gather<const N: usize>(
        &self,
        out: &mut [[f64; N]],
        pull: impl Fn(usize, [usize; 2]) -> [[f64; N]; 2] + Sync,
    ) {
        par::each(out, |start, rows: &mut [[f64; N]]| self.gather_chunk(start, rows, &pull));
    }

    /// That of the chunk of particles that begins with `start`.
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
        // One loop, so that there is one place into which `pull` is compiled.
        for k in own.chain(late.iter().copied()).map(|k| k as usize) {
            let [i, j] = self.ends[k].map(|place| place as usize);
            let [low, high] = pull(k, [i, j]);
            // An end outside of the chunk is below its first row or beyond its last.
            for (place, more) in [(i, low), (j, high)] {
                if let Some(row) = rows.get_mut(place.wrapping_sub(start)) {
                    row.iter_mut().zip(more).for_each(|(sum, a)| *sum += a);
                }
            }
        }
    }
}

/// Something that ties particles together pair by pair and resists their motion as springs do.
pub trait Ties: Sync {
    /// Both ends of each, the lower one first; ascending, as [`Pairs`] have them.
    fn ends(&self) -> &[[u32; 2]];
    /// From the lower end of one to its upper one [length].
    fn vector(&self, k: usize) -> Vec3;
    /// Whether it resists anything.
    fn bears(&self, k: usize) -> bool;
    /// The resisting forces and torques of both ends where these are moved.
    fn resist(&self, k: usize, ends: [&Six; 2]) -> [Six; 2];
}

/// Lists of numbers, one for each place.
#[derive(Clone, Debug, Default)]
pub struct Lists {
    first: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    /// Of pairs of a place below `places` and a number, which stay in their order.
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

    /// How many places.
    pub fn len(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// That of a place.
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
        // Some pairs within chunks, some across, in both orders of ends.
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
        // Whole numbers below 2^53: sums are exact in any order.
        assert_eq!(out, wanted);
        assert!(!pairs.is_empty() && pairs.len() == ends.len());
    }
}
