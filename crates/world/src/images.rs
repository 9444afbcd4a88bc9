//! How often each particle has crossed the periodic faces.

use std::ops::{Index, IndexMut};

use super::Domain;

/// Image counts of all particles; they take memory from the first crossing on.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Images {
    particles: usize,
    /// Empty while all counts are zero: most peridynamic scenes have no periodic face at all.
    counts: Vec<[i32; 3]>,
}

impl Images {
    /// Adds a particle.
    pub fn push(&mut self, image: [i32; 3]) {
        self.particles += 1;
        if !self.counts.is_empty() {
            self.counts.push(image);
        } else {
            self.set(self.particles - 1, image);
        }
    }

    /// Sets the counts of a particle.
    pub fn set(&mut self, i: usize, image: [i32; 3]) {
        if image != self[i] {
            self[i] = image;
        }
    }

    /// Puts the counts of further particles behind the present ones.
    pub fn append(&mut self, more: &mut Self) {
        if !self.counts.is_empty() || !more.counts.is_empty() {
            self.counts.resize(self.particles, [0; 3]);
            more.counts.resize(more.particles, [0; 3]);
            self.counts.append(&mut more.counts);
        }
        self.particles += std::mem::take(&mut more.particles);
    }

    /// Makes room for exactly `more` further particles.
    pub fn reserve_exact(&mut self, more: usize) {
        if !self.counts.is_empty() {
            self.counts.reserve_exact(more);
        }
    }

    /// Keeps the counts `old[k]` at each new index `k`.
    pub fn gather(&mut self, old: &[usize]) {
        if !self.counts.is_empty() {
            self.counts = old.iter().map(|&k| self.counts[k]).collect();
        }
        self.particles = old.len();
    }

    /// Wraps the particles `out` of the box into it and counts their crossings.
    pub fn wrap(&mut self, domain: &Domain, x: &mut [[f64; 3]], out: &[usize]) {
        for &i in out {
            let mut image = self[i];
            domain.wrap(&mut x[i], &mut image);
            self.set(i, image);
        }
    }

    /// Whether there are counts for `n` particles.
    pub fn are_for(&self, n: usize) -> bool {
        self.particles == n && (self.counts.is_empty() || self.counts.len() == n)
    }

    /// Memory held.
    pub fn bytes(&self) -> usize {
        self.counts.capacity() * size_of::<[i32; 3]>()
    }
}

impl Index<usize> for Images {
    type Output = [i32; 3];
    fn index(&self, i: usize) -> &[i32; 3] {
        if self.counts.is_empty() && i < self.particles { &[0; 3] } else { &self.counts[i] }
    }
}

impl IndexMut<usize> for Images {
    fn index_mut(&mut self, i: usize) -> &mut [i32; 3] {
        if self.counts.is_empty() {
            self.counts = vec![[0; 3]; self.particles];
        }
        &mut self.counts[i]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Boundary, Face};

    #[test]
    fn counts_take_memory_from_the_first_crossing_on() {
        let faces = |face: Face| Boundary([[face; 2]; 3]);
        let domain = |face: Face| Domain::new([0.0; 3], [1.0; 3], faces(face));
        let mut images = Images::default();
        (0..3).for_each(|_| images.push([0; 3]));
        let mut x = [[0.5; 3], [1.25, 0.5, 0.5], [0.5; 3]];
        images.wrap(&domain(Face::Fixed), &mut x, &[]);
        assert_eq!((images[1], images.bytes()), ([0; 3], 0));
        images.wrap(&domain(Face::Periodic), &mut x, &[1]);
        assert_eq!((images[1], x[1][0]), ([1, 0, 0], 0.25));
        images.push([0, 0, 2]);
        images.append(&mut Images::default());
        images.gather(&[3, 1]);
        assert_eq!((images[0], images[1]), ([0, 0, 2], [1, 0, 0]));
        let mut plain = Images::default();
        plain.push([0; 3]);
        plain.push([0, -1, 0]);
        assert_eq!((plain[0], plain[1]), ([0; 3], [0, -1, 0]));
    }
}
