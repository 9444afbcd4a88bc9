//! Block Jacobi preconditioner: factorized 6 × 6 diagonal blocks of a stiffness matrix.

use super::network::Network;
use super::six::{Factors, Packed, Six, factor, full};
use perigrain_base::par;

/// L D Lᵀ of a block.
///
/// L is stored in single precision, which halves the memory: rounding makes it the preconditioner of a
/// slightly different block, which is also symmetric and definite. The solution stays exact, and more steps
/// are needed only if the scales of a block differ by 10⁷.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Factor {
    /// 1/D, zero for components that do not move.
    over: Six,
    /// L below its diagonal, row by row.
    below: [f32; 15],
    /// Components that keep their value, one bit each: held ones, and those without resistance.
    held: u8,
}

impl Factor {
    /// For a block without the components `held`. A component that vanishes once the earlier ones are
    /// eliminated would make the matrix singular and does not change the energy: it is held as well.
    pub(crate) fn new(block: &Packed, held: u8) -> Self {
        let Factors { l, d, without, .. } = factor(&full(block), held);
        let over = d.map(|d| if d == 0.0 { 0.0 } else { 1.0 / d });
        let mut out = Self { over, below: [0.0; 15], held: held | without };
        for row in 1..6 {
            (0..row).for_each(|c| out.below[Self::at(row, c)] = l[row][c] as f32);
        }
        out
    }

    #[inline(always)]
    fn at(row: usize, column: usize) -> usize {
        row * (row - 1) / 2 + column
    }

    #[inline(always)]
    pub(crate) fn solve(&self, r: &Six) -> Six {
        let l = |row: usize, column: usize| f64::from(self.below[Self::at(row, column)]);
        let mut v = *r;
        for row in 1..6 {
            (0..row).for_each(|c| v[row] -= l(row, c) * v[c]);
        }
        for column in (0..6).rev() {
            v[column] *= self.over[column];
            (column + 1..6).for_each(|row| v[column] -= l(row, column) * v[row]);
        }
        v
    }
}

/// The blocks of all particles, and their held components.
#[derive(Clone, Debug, Default)]
pub struct Blocks {
    factors: Vec<Factor>,
    /// Number of particles that can move in some direction without resistance. (Springs never resist
    /// rotation, which is expected.)
    pub loose: usize,
}

impl Blocks {
    /// For the blocks of a matrix, without the components `held`, one bit each.
    pub fn new(blocks: &[Packed], held: &[u8]) -> Self {
        let mut factors = vec![Factor::default(); blocks.len()];
        par::each((&mut factors[..], blocks, held), |_, (factors, blocks, held)| {
            for ((factor, block), held) in factors.iter_mut().zip(blocks).zip(held) {
                *factor = Factor::new(block, *held);
            }
        });
        Self::of(factors, held)
    }

    /// For the matrix of a network, without storing its blocks.
    pub fn of_network(network: &Network, held: &[u8]) -> Self {
        let mut factors = vec![Factor::default(); network.particles];
        network.blocks_into(&mut factors, |k, block, row| *row = Factor::new(block, held[k]));
        Self::of(factors, held)
    }

    fn of(factors: Vec<Factor>, held: &[u8]) -> Self {
        let loose =
            factors.iter().zip(held).filter(|(factor, held)| factor.held & !**held & 0b111 != 0).count();
        Self { factors, loose }
    }

    /// Replaces the block of a particle with these held components.
    pub fn renew(&mut self, particle: usize, block: &Packed, mask: u8) {
        self.factors[particle] = Factor::new(block, mask);
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.factors.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.factors.is_empty()
    }

    /// The held components of a particle, one bit each.
    #[inline(always)]
    pub fn held(&self, particle: usize) -> u8 {
        self.factors[particle].held
    }

    /// M⁻¹ r for a particle.
    #[inline(always)]
    pub fn apply(&self, particle: usize, r: &Six) -> Six {
        self.factors[particle].solve(r)
    }

    /// A row without the held components.
    #[inline(always)]
    pub fn free(&self, particle: usize, row: &Six) -> Six {
        let held = self.factors[particle].held;
        std::array::from_fn(|c| if held >> c & 1 == 0 { row[c] } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::six::{Matrix6, packed};

    /// A block with the units of bonds of 10 nm, forces in N and torques in N m: translations and rotations
    /// differ in scale.
    #[test]
    fn factors_undo_a_block() {
        let (k, arm) = (8.0, 5e-9);
        let mut m: Matrix6 =
            std::array::from_fn(|r| std::array::from_fn(|c| if r == c { k * (1.0 + r as f64) } else { 0.0 }));
        for r in 0..6 {
            for c in 0..6 {
                m[r][c] += 0.3 * k / (1.0 + (r as f64 - c as f64).abs());
                m[r][c] *= if r < 3 { 1.0 } else { arm } * if c < 3 { 1.0 } else { arm };
            }
        }
        let r = [1.0, -2.0, 0.5, 1e-8, -3e-9, 2e-8];
        for held in [0, 0b010010] {
            let v = Factor::new(&packed(&m), held).solve(&r);
            for row in 0..6 {
                if held >> row & 1 == 1 {
                    assert_eq!(v[row], 0.0);
                    continue;
                }
                let back: f64 = (0..6).map(|c| m[row][c] * v[c]).sum();
                let unit = if row < 3 { 1.0 } else { 1e-8 };
                // A few times the precision of 6e-8.
                assert!((back - r[row]).abs() < 1e-6 * unit, "{back} {}", r[row]);
            }
        }
    }
}
