//! Bonds that break are set free: what both ends lose is noted at their sites.

use super::cell::Cell;
use super::lattice::{CONSTANTS, LANES, LatticeBody, PAD};
use super::law::Law;
use super::list::{GROUP, ListBody};
use crate::lattice::chunk::constant;
use crate::law::freed::Loss;
use crate::law::series::stretch;
use crate::law::site::Unrelaxed;
use crate::law::state::SiteState;
use crate::law::style::Style;

/// Which displacements the memory of bonds belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moved {
    /// Those of the step that is being advanced.
    Now,
    /// Those of the last step that advanced.
    Before,
}

impl SiteState {
    /// By what stretch each end of a bond has flowed or relaxed: `memory` is what the bond remembers, `s` its stretch then, `at` where
    /// its ends are in the columns.
    fn slips(&self, law: &Style, memory: [f64; 2], s: f64, at: [usize; 2]) -> [f64; 2] {
        let ends = at.map(|at| Unrelaxed { before: self.before[at], left: self.unrelaxed[at] });
        law.loops(false).slips(s, memory, self.held, ends)
    }

    /// Notes a bond at both ends, which are `at` these places in the columns: what it weighs there, its ω and its stretch.
    fn free(&mut self, at: [usize; 2], weights: [f64; 2], (omega, stretch): (f64, f64), slips: [f64; 2]) {
        let entries = self.weighted.len();
        for end in 0..2 {
            let whole = self.before[at[end]] * self.weighted[at[end]] / 3.0;
            let loss = Loss { weight: weights[end], omega, slip: slips[end], stretch };
            self.freed.add((at[end], entries), whole, loss);
        }
    }
}

impl LatticeBody {
    /// Sets the extension of the bond from a cell along a stencil vector free, under a law that does so.
    pub(crate) fn free(&mut self, cell: usize, e: usize, law: &Style, moved: Moved) {
        let slot = self.slot_of(cell);
        let Some(to) = self.ahead(slot, cell, e) else { return };
        // State-based constants are the same for all pairs of types.
        let constants = &self.state.tables[e * CONSTANTS..(e + 1) * CONSTANTS];
        let (term, omega) = (constants[constant::FACTOR], constants[constant::OMEGA]);
        let volume = |cell: usize| self.cell_volume.get(PAD + cell).copied().unwrap_or(1.0);
        let weights = [term * volume(to), term * volume(cell)];
        let numbers = law.memory();
        let first = (cell / LANES * self.stencil.len() + e) * numbers * LANES + cell % LANES;
        let memory =
            std::array::from_fn(|k| if k < numbers { self.state.memory[first + k * LANES] } else { 0.0 });
        let which = if moved == Moved::Now { 1 } else { 0 };
        let s = if numbers > 0 { stretch(self.z(which, cell, to, e)) } else { 0.0 };
        let at = [PAD + cell, PAD + to];
        let slips = self.state.slips(law, memory, s, at);
        self.state.free(at, weights, (omega, s), slips);
    }
}

impl ListBody {
    /// Sets the extension of the bond at a place free, under a law that does so.
    pub(crate) fn free(&mut self, b: usize, law: &Law, cell: &Cell, moved: Moved) {
        let at = [self.owner[b / GROUP], self.partner[b]].map(|r| r as usize);
        let numbers = law.kind.memory();
        let (z, length) = self.z(moved == Moved::Before, at[0], at[1], cell);
        let horizon = self.constants(b).horizon;
        let omega = law.influence.of(length, horizon);
        let one = law.weight(length, horizon, self.weight(b, length));
        let weights = [one * self.record[at[1]].volume, one * self.record[at[0]].volume];
        let first = ListBody::memory(b, numbers);
        let memory =
            std::array::from_fn(|k| if k < numbers { self.state.memory[first + k * GROUP] } else { 0.0 });
        let slips = self.state.slips(law.kind.style(), memory, stretch(z), at);
        self.state.free(at, weights, (omega, stretch(z)), slips);
    }
}
