//! Families that follow a table of bonds: what it has taken away since, and how strained they are.

use crate::breaking::banded;
use crate::families::list::GROUP;
use crate::families::{Families, PeriView};
use crate::shares::square;
use perigrain_base::diag::{Code, Result, fail};

/// The critical and the smallest stretch of a particle's bonds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strain {
    /// The least s00 − alpha `smallest` of its living bonds.
    pub critical: f64,
    /// The smallest stretch.
    pub smallest: f64,
}

impl Families {
    /// Ends the bonds that the table no longer has; `kind` says the type − 1 of the bond between two particles if there is
    /// one, `total` how many there are. True if any was ended.
    ///
    /// # Errors
    /// Bonds that were not there at the first run, and such whose type has changed.
    pub fn follow(
        &mut self,
        view: &PeriView,
        kind: impl Fn(u32, u32) -> Option<u8>,
        total: usize,
    ) -> Result<()> {
        let (mut known, mut ended) = (0, vec![]);
        for i in 0..self.list.record.len() {
            for b in self.list.own(i).filter(|&b| self.list.lives(b)) {
                let ends = [i, self.list.partner[b] as usize].map(|r| self.list.particle[r]);
                match kind(ends[0], ends[1]) {
                    None => ended.push((b, ends)),
                    Some(k) if k == self.list.group_kind[b / GROUP] => known += 1,
                    Some(_) => {
                        let text = "peridynamic bonds keep the type that they had at the first run";
                        return fail(Code::WRONG_ORDER, None, text);
                    }
                }
            }
        }
        if known < total {
            let text = format!(
                "{} bonds were made after the first run: peridynamic bonds begin together, with one undeformed state",
                total - known
            );
            return fail(Code::NOT_SUPPORTED, None, text);
        }
        for (b, [i, j]) in ended {
            self.list.end(b);
            self.damaged[i as usize] = true;
            self.damaged[j as usize] = true;
            self.add_broken(view, (i, j), square(view, [i, j]));
        }
        Ok(())
    }

    /// The pairs of particles whose bonds broke in the step that was just advanced.
    pub fn broken(&self) -> &[[u32; 2]] {
        &self.scratch.ends
    }

    /// How strained the bonds of a particle of the list are; `None` where none lives.
    pub fn strain(&self, view: &PeriView, i: usize) -> Option<Strain> {
        let place = self.place.get(i).filter(|p| **p != u32::MAX && **p >= self.list.first_place)?;
        let (record, cell) = ((place - self.list.first_place) as usize, self.cell(view));
        let mut all = vec![];
        self.list.around(record, |other, b| {
            if self.list.lives(b) {
                let (z, length) = self.list.z(false, record, other, &cell);
                all.push((banded(z, length, &self.options), *self.list.constants(b)));
            }
        });
        let smallest = all.iter().map(|b| b.0).reduce(f64::min)?;
        let critical = all.iter().map(|b| b.1.s00 - b.1.alpha * smallest).fold(f64::INFINITY, f64::min);
        Some(Strain { critical, smallest })
    }
}
