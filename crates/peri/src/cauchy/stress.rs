//! What the sites of particles are like under correspondence: stress, plastic strain, damage.

use crate::cauchy::Continuum;
use crate::families::{Families, PeriView};
use perigrain_constitutive::{Failure, Memory};

/// What one particle is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Kirchhoff stress P Fᵀ of the last evaluation: xx yy zz xy xz yz [pressure].
    pub stress: [f64; 6],
    /// What its material remembers.
    pub memory: Memory,
    /// It exerts nothing: its family is torn.
    pub torn: bool,
}

impl Families {
    /// What a particle is like under correspondence; `None` of others, and before the first evaluation.
    pub fn state(&self, i: usize) -> Option<State> {
        let (own, site) = self.continuum_at(i)?;
        let stress = *own.stress.get(site)?;
        let torn = own.inverse.get(site).is_some_and(|k| k[0] <= 0.0);
        Some(State { stress, memory: own.memory_of(site), torn })
    }

    /// Adds to each particle what its flow in the last evaluation has turned into heat.
    pub fn add_plastic_heat(&self, kinds: &[u16], heat: &mut [f64]) {
        let lattices = self.lattices.iter().map(|body| (&body.state.continuum, &body.particle));
        for (own, particle) in lattices.chain([(&self.list.state.continuum, &self.list.particle)]) {
            let worked = own.flowed.iter().zip(particle).filter(|(work, _)| **work != 0.0);
            for (work, p) in worked.map(|(work, p)| (work, *p as usize)) {
                heat[p] += self.law.of(kinds[p]).taylor_quinney * work;
            }
        }
    }

    /// Whether anything is remembered beside which bonds live.
    pub fn remembers(&self) -> bool {
        let lattices = self.lattices.iter().map(|body| &body.state);
        let mut all = lattices.chain([&self.list.state]);
        self.law.kind.memory() > 0 || all.any(|state| !state.continuum.memory.is_empty())
    }

    /// The first particle whose material had no answer in the last evaluation, and why.
    pub fn fault(&self) -> Option<(u32, Failure)> {
        let lattices = self.lattices.iter().map(|body| (&body.state.continuum, &body.particle));
        let mut all = lattices.chain([(&self.list.state.continuum, &self.list.particle)]);
        all.find_map(|(own, particle)| own.fault.map(|(site, why)| (particle[site as usize], why)))
    }

    /// The first particle whose whole family lies in a plane: it has no deformation gradient.
    pub fn flat(&self, view: &PeriView) -> Option<usize> {
        let flat =
            |i: &usize| self.continuum_at(*i).is_some_and(|(own, site)| own.whole.get(site) == Some(&0.0));
        (0..view.x.len().min(self.family_size.len())).find(|i| self.family_size[*i] > 0 && flat(i))
    }

    /// Where a particle is: in which body, and which of its sites it is.
    fn site_of(&self, i: usize) -> Option<(usize, usize)> {
        let place = self.place.get(i).copied().filter(|place| *place != u32::MAX)?;
        let body = self.lattices.partition_point(|b| b.first_place + b.particle.len() as u32 <= place);
        let first = self.lattices.get(body).map_or(self.list.first_place, |body| body.first_place);
        Some((body, (place - first) as usize))
    }

    fn continuum_at(&self, i: usize) -> Option<(&Continuum, usize)> {
        let (body, site) = self.site_of(i)?;
        let state = self.lattices.get(body).map_or(&self.list.state, |body| &body.state);
        self.law.kind.correspondence.then_some((&state.continuum, site))
    }

    /// What a particle's site has under correspondence.
    pub(crate) fn continuum_of(&mut self, i: usize) -> Option<(&mut Continuum, usize)> {
        let (body, site) = self.site_of(i)?;
        let Self { lattices, list, .. } = self;
        let state = lattices.get_mut(body).map_or(&mut list.state, |body| &mut body.state);
        Some((&mut state.continuum, site))
    }

    /// What the sites of all bodies have, with their particles.
    pub(crate) fn continua(&mut self) -> impl Iterator<Item = (&mut Continuum, &[u32])> {
        let Self { lattices, list, .. } = self;
        let lattices = lattices.iter_mut().map(|body| (&mut body.state.continuum, &body.particle[..]));
        lattices.chain([(&mut list.state.continuum, &list.particle[..])])
    }
}
