//! Which pairs of particles may act on each other: `neigh_modify exclude` and `special_bonds`.

use super::{NeighborSettings, Particles, World};

/// The rules as they stand.
pub struct Allowed<'a> {
    settings: &'a NeighborSettings,
    particles: &'a Particles,
    /// Bonded pairs without pair forces, ascending.
    barred: Vec<[u32; 2]>,
}

impl<'a> Allowed<'a> {
    /// Of a world, bonds included.
    pub fn new(w: &'a World) -> Self {
        Self { settings: &w.settings.neighbor, particles: &w.particles, barred: w.bonds.barred() }
    }

    /// Of `neigh_modify exclude` alone.
    pub fn excluded(w: &'a World) -> Self {
        Self { settings: &w.settings.neighbor, particles: &w.particles, barred: vec![] }
    }

    /// Whether pair forces act between these two.
    pub fn pair(&self, i: usize, j: usize) -> bool {
        let (s, p) = (self.settings, self.particles);
        let (mask, kind) = ([p.mask[i], p.mask[j]], [p.kind[i], p.kind[j]]);
        let [a, b] = mask;
        let groups = |&(g, h): &(u32, u32)| (a & g != 0 && b & h != 0) || (a & h != 0 && b & g != 0);
        let types = |&(g, h): &(u16, u16)| (kind[0] == g && kind[1] == h) || (kind[0] == h && kind[1] == g);
        let molecules = |&(g, inside): &(u32, bool)| {
            let same = p.molecule.get(i) == p.molecule.get(j);
            a & g != 0 && b & g != 0 && same == inside
        };
        let tags = || [p.tag[i].min(p.tag[j]), p.tag[i].max(p.tag[j])];
        !s.exclude_groups.iter().any(groups)
            && !s.exclude_types.iter().any(types)
            && !s.exclude_molecules.iter().any(molecules)
            && (self.barred.is_empty() || self.barred.binary_search(&tags()).is_err())
    }
}
