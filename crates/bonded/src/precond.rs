//! The block Jacobi preconditioner: inverses of the 6 × 6 blocks on the diagonal of a stiffness matrix.

use super::six::{Packed, Six, full, invert, times};
use perigrain_base::par;

/// Inverse blocks, and what does not move.
#[derive(Clone, Debug, Default)]
pub struct Blocks {
    /// One for each particle.
    inverse: Vec<Packed>,
    /// Components that keep the value they have, a bit each: those held, and those that nothing resists.
    pub held: Vec<u8>,
    /// How many particles can move in some direction without resistance. (Springs never resist turning: that is no news.)
    pub loose: usize,
}

impl Blocks {
    /// Of the blocks of a matrix, without the components `held`. A component of which nothing is left once those before it are
    /// eliminated would make the matrix singular and changes no energy: it is held as well.
    pub fn new(blocks: Vec<Packed>, held: &[u8]) -> Self {
        let (mut inverse, mut held) = (blocks, held.to_vec());
        let loose = par::reduce_each(
            (&mut inverse[..], &mut held[..]),
            |_, (blocks, held)| {
                blocks.iter_mut().zip(held).fold(0, |loose, (block, held)| {
                    let found = invert(&full(block), *held);
                    *block = found.inverse;
                    *held |= found.without;
                    loose + usize::from(found.without & 0b111 != 0)
                })
            },
            |a, b| a + b,
        );
        Self { inverse, held, loose: loose.unwrap_or(0) }
    }

    /// Takes another block for a particle of which the mask holds these components.
    pub fn renew(&mut self, particle: usize, block: &Packed, mask: u8) {
        let found = invert(&full(block), mask);
        (self.inverse[particle], self.held[particle]) = (found.inverse, mask | found.without);
    }

    /// M⁻¹ r of a particle.
    #[inline(always)]
    pub fn apply(&self, particle: usize, r: &Six) -> Six {
        times(&self.inverse[particle], r)
    }

    /// A row without what is held.
    #[inline(always)]
    pub fn free(&self, particle: usize, row: &Six) -> Six {
        let held = self.held[particle];
        std::array::from_fn(|c| if held >> c & 1 == 0 { row[c] } else { 0.0 })
    }
}
