//! Which pairs of particles may act on each other: `neigh_modify exclude`, `special_bonds` and surfaces of solids.

use super::families::Families;
use super::{NeighborSettings, Particles, World};

/// The rules of `neigh_modify exclude` as they stand.
#[derive(Clone, Copy, Debug)]
pub struct Excluded<'a> {
    settings: &'a NeighborSettings,
    particles: &'a Particles,
}

impl<'a> Excluded<'a> {
    /// Of a world; `None` where no rule stands.
    pub fn of(w: &'a World) -> Option<Self> {
        let s = &w.settings.neighbor;
        let none =
            s.exclude_groups.is_empty() && s.exclude_types.is_empty() && s.exclude_molecules.is_empty();
        (!none).then(|| Self::new(w))
    }

    fn new(w: &'a World) -> Self {
        Self { settings: &w.settings.neighbor, particles: &w.particles }
    }

    /// Whether a rule takes this pair away.
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
        s.exclude_groups.iter().any(groups)
            || s.exclude_types.iter().any(types)
            || s.exclude_molecules.iter().any(molecules)
    }
}

/// The rules as they stand.
pub struct Allowed<'a> {
    excluded: Excluded<'a>,
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
        Self { excluded: Excluded::new(w), barred: vec![], surfaces: vec![], families: None }
    }

    /// Whether pair forces act between these two.
    pub fn pair(&self, i: usize, j: usize) -> bool {
        let p = self.excluded.particles;
        let tags = || [p.tag[i].min(p.tag[j]), p.tag[i].max(p.tag[j])];
        !self.excluded.pair(i, j)
            && (self.surfaces.is_empty() || self.meet(i, j))
            && (self.barred.is_empty() || self.barred.binary_search(&tags()).is_err())
    }

    /// Whether neither end lies inside a solid, and they are not of one family.
    fn meet(&self, i: usize, j: usize) -> bool {
        let p = self.excluded.particles;
        let inside =
            |mask: u32| self.surfaces.iter().any(|[parent, own]| mask & parent != 0 && mask & own == 0);
        if inside(p.mask[i]) || inside(p.mask[j]) {
            return false;
        }
        self.families.is_none_or(|(families, period)| !families.related(&p.x0, &p.kind, period, i, j))
    }
}
