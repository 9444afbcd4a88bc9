//! Which particle stands where: deletion and renumbering.

use super::World;

impl World {
    /// Deletes the marked particles as LAMMPS does: the last particle moves into the first hole, and so on.
    /// With `renumber`, ids become storage order + 1 afterwards.
    pub fn delete(&mut self, marked: &[bool], renumber: bool) {
        self.gather(&left_after(marked));
        if renumber {
            for (tag, k) in self.particles.tag.iter_mut().zip(1..) {
                *tag = k;
            }
        }
    }
}

/// Who stands where after the marked ones are gone and each hole was filled from the end.
fn left_after(marked: &[bool]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..marked.len()).collect();
    let mut k = 0;
    while k < order.len() {
        if marked[order[k]] {
            order.swap_remove(k);
        } else {
            k += 1;
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_are_filled_from_the_end() {
        let marked = [false, true, false, true, false, true];
        // By hand: 5 goes (swapped into 1, itself marked), then 4 fills hole 1, then 3 goes.
        assert_eq!(left_after(&marked), [0, 4, 2]);
    }
}
