//! How many bonds apart two particles are.

use super::World;
use super::index::Index;

/// For each particle the places of those that it is bonded to, by bonds that count (`special_bonds`).
pub struct Partners {
    /// Where the partners of each particle begin in `all`, and one more.
    starts: Vec<u32>,
    all: Vec<u32>,
    /// Whether pairs one, two and three bonds apart have weights of zero for both kinds of forces.
    zero: [bool; 3],
}

impl Partners {
    /// As bonds are now.
    pub fn new(w: &World) -> Self {
        let index = Index::new(&w.particles.tag);
        let ends: Vec<[usize; 2]> = w
            .bonds
            .special
            .iter()
            .filter_map(|ids| {
                let [a, b] = ids.map(|id| index.find(id, &w.particles.tag));
                Some([a?, b?])
            })
            .collect();
        let mut starts = vec![0; w.n() + 1];
        ends.iter().flatten().for_each(|i| starts[i + 1] += 1);
        (1..starts.len()).for_each(|k| starts[k] += starts[k - 1]);
        let (mut next, mut all) = (starts.clone(), vec![0; 2 * ends.len()]);
        for [a, b] in ends {
            for (from, to) in [(a, b), (b, a)] {
                all[next[from] as usize] = to as u32;
                next[from] += 1;
            }
        }
        let weights = w.bonds.weights;
        let zero = std::array::from_fn(|k| weights.lj[k] == 0.0 && weights.coul[k] == 0.0);
        Self { starts, all, zero }
    }

    fn of(&self, i: u32) -> &[u32] {
        let i = i as usize;
        &self.all[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    /// How many bonds apart two particles are, if at most three.
    pub fn apart(&self, [a, b]: [usize; 2]) -> Option<usize> {
        let (a, b) = (a as u32, b as u32);
        let (near, far) = (self.of(a), self.of(b));
        if near.contains(&b) {
            return Some(1);
        }
        if near.iter().any(|m| far.contains(m)) {
            return Some(2);
        }
        near.iter().any(|m| self.of(*m).iter().any(|n| far.contains(n))).then_some(3)
    }

    /// The same where LAMMPS' neighbour lists leave the pair out, because its weights are zero.
    pub fn unlisted(&self, pair: [usize; 2]) -> Option<usize> {
        self.apart(pair).filter(|apart| self.zero[apart - 1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bond, Particles};

    #[test]
    fn places_along_a_chain() {
        let mut w = World { particles: Particles::default(), ..World::default() };
        w.particles.tag = vec![5, 4, 3, 2, 1, 9].into();
        w.particles.x = vec![[0.0; 3]; 6].into();
        for ends in [[2, 1], [2, 3], [4, 3], [4, 5]] {
            w.bonds.push(Bond::new(1, ends));
        }
        w.bonds.find_special();
        w.bonds.weights.lj = [0.0, 0.0, 1.0];
        w.bonds.weights.coul = [0.0, 1.0, 1.0];
        let p = Partners::new(&w);
        let of = |a: u32, b: u32| [a, b].map(|id| w.particles.tag.iter().position(|t| *t == id).unwrap());
        let apart = [2, 3, 4, 5, 9].map(|other| p.apart(of(1, other)));
        assert_eq!(apart, [Some(1), Some(2), Some(3), None, None]);
        // Weights of both kinds are zero one bond apart alone.
        assert_eq!([2, 3, 4].map(|other| p.unlisted(of(1, other))), [Some(1), None, None]);
    }
}
