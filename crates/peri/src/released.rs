//! The energy that bonds set free where they break, and what they turn into heat where they relax or flow.

use crate::energy::tally;
use crate::families::lattice::PAD;
use crate::families::{Cell, Families, ForceUnit, PeriTally, PeriView};
use crate::law::freed::Freed;
use crate::law::state::SiteState;
use crate::law::style::Losses;

/// K⁻¹ of all sites of a body.
type Shape = Vec<[f64; 6]>;

impl Families {
    /// Breaks bonds; where that is counted, adds the difference of the energies of all bonds before and after. The force of a broken bond
    /// has been computed and acts in the first half of the next step still: it takes what the bond would have gained in that time, half
    /// of what it has gained in the last step, to second order.
    pub(super) fn break_and_count(&mut self, view: &PeriView, cell: &Cell) {
        if !self.counts_losses {
            return self.break_bonds(view, cell, None);
        }
        let mut alive: Vec<Vec<u8>> = self.lattices.iter().map(|b| b.alive.clone()).collect();
        let mut listed = self.list.alive.clone();
        let mut freed: Vec<Freed> = self.states().map(|s| s.freed.clone()).collect();
        let mut shapes: Vec<Shape> = self.states().map(|s| s.continuum.inverse.clone()).collect();
        self.break_bonds(view, cell, None);
        if self.scratch.ends.is_empty() {
            return;
        }
        let mut fall = |bonds: &mut Self| {
            let after = bonds.living_energy(view, cell);
            bonds.exchange((&mut alive, &mut listed), &mut freed, &mut shapes);
            let before = bonds.living_energy(view, cell);
            bonds.exchange((&mut alive, &mut listed), &mut freed, &mut shapes);
            before - after
        };
        self.swap_places();
        let earlier = fall(self);
        self.swap_places();
        let now = fall(self);
        let trailing = 0.5 * (now - earlier);
        self.released += now;
        self.trailing += trailing;
        self.late = now + trailing;
    }

    /// Puts the places of the last step that advanced in the place of the present ones, and back.
    fn swap_places(&mut self) {
        self.lattices.iter_mut().for_each(|body| body.u.swap(0, 1));
        let list = &mut self.list;
        list.record
            .iter_mut()
            .zip(&mut list.last)
            .for_each(|(record, last)| std::mem::swap(&mut record.u, last));
    }

    /// Adds what has become heat since the last step: at the present places plastic bonds have lost the difference of the
    /// energies before and after they flowed; what softening bonds have lost counts with that of broken ones; the dashpots of viscous ones take up 2/τ times the energy of their springs, by
    /// the trapezoidal rule. Nothing under LAMMPS' laws, whose forces have no energy.
    pub(super) fn count_heat(&mut self, view: &PeriView, cell: &Cell) {
        self.heat += self.heat_of_broken(view);
        self.taken = 0.0;
        match self.law.kind.losses {
            _ if self.options.compat_lammps => {}
            Losses::None => {}
            Losses::Sites => {
                self.heat += self.lost[0];
                self.released += self.lost[1];
                self.taken = self.lost[0] + self.lost[1];
            }
            Losses::Flow => {
                if !self.flowed() {
                    return self.forget_earlier();
                }
                let before = self.bond_energy(view, cell);
                self.forget_earlier();
                self.heat += before - self.bond_energy(view, cell);
            }
            Losses::Damage => {
                if !self.flowed() {
                    return self.forget_earlier();
                }
                self.law.lost = true;
                let before = self.bond_energy(view, cell);
                self.forget_earlier();
                self.taken = self.bond_energy(view, cell) - before;
                self.released += self.taken;
                self.law.lost = false;
            }
            Losses::Relaxation => {
                let own = self.law.moduli.iter().find(|m| m.tau > 0.0).copied().unwrap_or_default();
                if own.tau <= 0.0 {
                    return;
                }
                // What is left without the dilatation and the springs that do not relax.
                let mut springs = self.law.clone();
                springs.moduli.iter_mut().for_each(|m| (m.bulk, m.lambda) = (0.0, 1.0));
                let law = std::mem::replace(&mut self.law, springs);
                let power = 2.0 / own.tau * own.lambda * self.bond_energy(view, cell);
                self.law = law;
                self.relax(power);
            }
            Losses::RelaxationApart => {
                // The same with 2λ/τ of each end in its modulus.
                let kept = self.springs_alone(view);
                let law = self.law.clone();
                self.law.moduli.iter_mut().for_each(|m| m.bulk = 0.0);
                let power = self.bond_energy(view, cell);
                self.law = law;
                self.states().zip(kept).for_each(|(state, columns)| state.columns = columns);
                self.relax(power);
            }
        }
    }

    /// Whether [`Families::taken`] has all that is lost between two equilibria, however far apart they are.
    pub fn knows_what_it_takes(&self) -> bool {
        matches!(self.law.kind.losses, Losses::Damage | Losses::Sites)
    }

    /// Adds up what flow and damage of materials have taken in this step.
    pub(super) fn add_lost(&mut self) {
        let add = |sum: [f64; 2], lost: &[f64; 2]| [sum[0] + lost[0], sum[1] + lost[1]];
        self.lost = self.states().fold([0.0; 2], |sum, state| state.continuum.lost.iter().fold(sum, add));
    }

    /// Changes thermal strains from `old` to `new`, columns by particle: what that adds to the energy of all bonds at the places of the
    /// last evaluation.
    pub fn warming(&mut self, view: &PeriView, [old, new]: [&[f64]; 2]) -> f64 {
        let cell = self.cell(view);
        let [before, after] = [old, new].map(|strain| {
            self.warm(strain);
            self.living_energy(view, &cell)
        });
        after - before
    }

    /// Books a part of ∫ ∂U/∂T dT: heat that has become elastic energy.
    pub fn book_warming(&mut self, energy: f64) {
        self.warmed += energy;
        if self.counts_losses {
            self.heat -= energy;
        }
    }

    /// Adds the heat of a step at whose end the power is this.
    fn relax(&mut self, power: f64) {
        self.heat += 0.5 * self.law.dt * (self.relaxing.unwrap_or(power) + power);
        self.relaxing = Some(power);
    }

    /// Puts 2λ/τ times the modulus of the springs in the place of all moduli of sites; returns the columns as they were.
    fn springs_alone(&mut self, view: &PeriView) -> Vec<Vec<f64>> {
        let law = &self.law;
        let scale = |columns: &mut [f64], (pad, stride): (usize, usize), particle: &[u32]| {
            for (site, &p) in particle.iter().enumerate().filter(|(_, p)| **p != u32::MAX) {
                let own = law.of(view.kind[p as usize]);
                columns[stride + pad + site] *= if own.tau > 0.0 { 2.0 * own.lambda / own.tau } else { 0.0 };
                columns[3 * stride + pad + site] = 1.0;
            }
        };
        let mut kept = Vec::new();
        for body in &mut self.lattices {
            kept.push(body.state.columns.clone());
            scale(&mut body.state.columns, (PAD, body.stride), &body.particle);
        }
        kept.push(self.list.state.columns.clone());
        scale(&mut self.list.state.columns, (0, self.list.record.len()), &self.list.particle);
        kept
    }

    /// Whether what bonds remember has changed in this step.
    fn flowed(&self) -> bool {
        let changed = |s: &SiteState| !s.earlier.is_empty() && s.earlier != s.memory;
        self.lattices.iter().any(|b| changed(&b.state)) || changed(&self.list.state)
    }

    fn forget_earlier(&mut self) {
        self.lattices.iter_mut().for_each(|b| b.state.earlier.clear());
        self.list.state.earlier.clear();
    }

    /// What sites of all bodies carry.
    fn states(&mut self) -> impl Iterator<Item = &mut SiteState> {
        self.lattices.iter_mut().map(|body| &mut body.state).chain([&mut self.list.state])
    }

    /// What the broken bonds of all sites have turned into heat in the step that advances.
    fn heat_of_broken(&self, view: &PeriView) -> f64 {
        let of = |particle: &[u32], state: &SiteState, pad: usize| -> f64 {
            let own = particle.iter().zip(state.freed.heat.iter().skip(pad)).filter(|(p, _)| **p != u32::MAX);
            own.map(|(p, heat)| heat * view.volume[*p as usize]).sum()
        };
        let lattices: f64 = self.lattices.iter().map(|b| of(&b.particle, &b.state, PAD)).sum();
        lattices + of(&self.list.particle, &self.list.state, 0)
    }

    fn exchange(
        &mut self,
        (alive, listed): (&mut [Vec<u8>], &mut Vec<u8>),
        freed: &mut [Freed],
        shapes: &mut [Shape],
    ) {
        for ((state, freed), shape) in self.states().zip(freed).zip(shapes) {
            std::mem::swap(&mut state.freed, freed);
            std::mem::swap(&mut state.continuum.inverse, shape);
        }
        for (body, bits) in self.lattices.iter_mut().zip(alive) {
            std::mem::swap(&mut body.alive, bits);
        }
        std::mem::swap(&mut self.list.alive, listed);
    }

    /// The energy of all bonds that live at the places of the last force evaluation, dilatations being theirs too. Materials do not flow
    /// for it: what they take is counted where they do.
    fn living_energy(&mut self, view: &PeriView, cell: &Cell) -> f64 {
        if !self.law.kind.bond_based || self.heated() {
            let mut aside = vec![[0.0; 3]; view.x.len()];
            self.law.frozen = true;
            self.sweep_lattices(view, &mut aside, (false, true), None);
            self.sweep_list(view, &mut aside, (false, true), (cell, None));
            self.law.frozen = false;
        }
        self.bond_energy(view, cell)
    }

    /// The energy of all bonds that live at the places of the last force evaluation, with the dilatations of that.
    fn bond_energy(&mut self, view: &PeriView, cell: &Cell) -> f64 {
        let mut atoms = vec![0.0; view.x.len()];
        let dense = self.options.unit == ForceUnit::Density;
        let mut sum = PeriTally { per_atom_energy: dense.then_some(&mut atoms), ..PeriTally::default() };
        tally(self, view, &mut sum, (true, cell, None));
        let total = sum.energy;
        if dense { atoms.iter().zip(view.volume).map(|(e, v)| e * v).sum() } else { total }
    }
}
