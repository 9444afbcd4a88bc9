//! Which pairs of particles may act on each other: `neigh_modify exclude`, `special_bonds` and surfaces of solids.

use super::{Particles, World};
use perigrain_peri::families::{Excluded, Families};

/// The rules of `neigh_modify exclude`; `None` where none stands.
pub fn excluded(w: &World) -> Option<Excluded<'_>> {
    let s = &w.settings.neighbor;
    let none = s.exclude_groups.is_empty() && s.exclude_types.is_empty() && s.exclude_molecules.is_empty();
    (!none).then(|| rules(w))
}

fn rules(w: &World) -> Excluded<'_> {
    let (s, p) = (&w.settings.neighbor, &w.particles);
    Excluded {
        groups: &s.exclude_groups,
        kinds: &s.exclude_types,
        molecules: &s.exclude_molecules,
        mask: &p.mask,
        kind: &p.kind,
        molecule: &p.molecule,
    }
}

/// The rules as they stand.
pub struct Allowed<'a> {
    excluded: Excluded<'a>,
    particles: &'a Particles,
    /// Bonded pairs without pair forces, ascending.
    barred: Vec<[u32; 2]>,
    /// Group bits of solids and of their hybrid particles.
    surfaces: Vec<[u32; 2]>,
    /// Families of solids that have hybrid particles.
    families: Option<(&'a Families, [f64; 3])>,
}

impl<'a> Allowed<'a> {
    /// Of a world, bonds included.
    pub fn new(w: &'a World) -> Self {
        let bits = w.groups.surfaces().iter().map(|(g, s)| [s.parent.bit(), g.bit()]);
        let surfaces: Vec<[u32; 2]> = bits.collect();
        let families = w.families.as_ref().filter(|_| !surfaces.is_empty()).map(|f| (f, w.periods()));
        Self { barred: w.bonds.barred(), surfaces, families, ..Self::excluded(w) }
    }

    /// Of `neigh_modify exclude` alone.
    pub fn excluded(w: &'a World) -> Self {
        Self { excluded: rules(w), particles: &w.particles, barred: vec![], surfaces: vec![], families: None }
    }

    /// Whether pair forces act between these two.
    pub fn pair(&self, i: usize, j: usize) -> bool {
        let p = self.particles;
        let tags = || [p.tag[i].min(p.tag[j]), p.tag[i].max(p.tag[j])];
        !self.excluded.pair(i, j)
            && (self.surfaces.is_empty() || self.meet(i, j))
            && (self.barred.is_empty() || self.barred.binary_search(&tags()).is_err())
    }

    /// Whether neither end lies inside a solid, and they are not of one family.
    fn meet(&self, i: usize, j: usize) -> bool {
        let p = self.particles;
        let inside =
            |mask: u32| self.surfaces.iter().any(|[parent, own]| mask & parent != 0 && mask & own == 0);
        if inside(p.mask[i]) || inside(p.mask[j]) {
            return false;
        }
        self.families.is_none_or(|(families, period)| !families.related(&p.x0, &p.kind, period, i, j))
    }
}
