//! The energy that bonds set free where they break.

use super::chunk::Kernels;
use super::energy::tally;
use super::list_kernel::RowKernels;
use super::state::{self, kernels::StateKernels};
use super::stretching::StretchKernels;
use crate::world::families::{Families, ForceUnit, LawKind, PeriTally, PeriView};

impl Families {
    /// Breaks bonds; where that is counted, adds the difference of the energies of all bonds before and after.
    pub(super) fn break_and_count<K: Kernels + RowKernels + StretchKernels + StateKernels>(
        &mut self,
        view: &PeriView,
        period: [f64; 3],
    ) {
        if !self.counts_released {
            return self.break_bonds::<K>(view, period);
        }
        let mut alive: Vec<Vec<u8>> = self.lattices.iter().map(|b| b.alive.clone()).collect();
        let mut listed = self.list.alive.clone();
        self.break_bonds::<K>(view, period);
        if self.scratch.ends.is_empty() {
            return;
        }
        let after = self.bond_energy::<K>(view, period);
        self.exchange(&mut alive, &mut listed);
        let before = self.bond_energy::<K>(view, period);
        self.exchange(&mut alive, &mut listed);
        self.released += before - after;
    }

    fn exchange(&mut self, alive: &mut [Vec<u8>], listed: &mut Vec<u8>) {
        for (body, bits) in self.lattices.iter_mut().zip(alive) {
            std::mem::swap(&mut body.alive, bits);
        }
        std::mem::swap(&mut self.list.alive, listed);
    }

    /// The energy of all bonds that live at the places of the last force evaluation.
    fn bond_energy<K: Kernels + RowKernels + StateKernels>(
        &mut self,
        view: &PeriView,
        period: [f64; 3],
    ) -> f64 {
        if self.law.kind == LawKind::Lps {
            // Dilatations are those of the bonds that live.
            let mut aside = vec![[0.0; 3]; view.x.len()];
            self.sweep_states::<K>(view, &mut aside, (false, true), period);
        }
        let mut atoms = vec![0.0; view.x.len()];
        let dense = self.options.unit == ForceUnit::Density;
        let mut sum = PeriTally { per_atom_energy: dense.then_some(&mut atoms), ..PeriTally::default() };
        match self.law.kind.has_states() {
            true => state::tally::<K>(self, view, &mut sum, (false, period)),
            false => tally::<K>(self, view, &mut sum, period),
        }
        let total = sum.energy;
        if dense { atoms.iter().zip(view.volume).map(|(e, v)| e * v).sum() } else { total }
    }
}
