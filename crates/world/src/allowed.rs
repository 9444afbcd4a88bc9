//! Which pairs of particles may act on each other: `neigh_modify exclude`, `special_bonds` and surfaces of solids.

use super::bonds::ascending;
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
    /// Bonded pairs without pair forces.
    barred: Barred,
    /// Group bits of solids and of their hybrid particles.
    surfaces: Vec<[u32; 2]>,
    /// Families of solids that have hybrid particles.
    families: Option<&'a Families>,
    /// Whether there is no rule at all.
    free: bool,
}

/// Pairs of ids, found by the lower one.
#[derive(Default)]
struct Barred {
    /// Ascending, the lower id of each first.
    pairs: Vec<[u32; 2]>,
    /// For each lower id where its pairs begin, and one more.
    starts: Vec<u32>,
}

impl Barred {
    fn new(pairs: Vec<[u32; 2]>) -> Self {
        let most = pairs.last().map_or(0, |p| p[0] as usize + 2);
        let mut starts = vec![0; if pairs.is_empty() { 0 } else { most }];
        for [low, _] in &pairs {
            starts[*low as usize + 1] += 1;
        }
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }
        Self { pairs, starts }
    }

    fn has(&self, a: u32, b: u32) -> bool {
        let [low, high] = ascending([a, b]);
        let Some(&[from, to]) = self.starts.get(low as usize..low as usize + 2).and_then(|s| s.first_chunk())
        else {
            return false;
        };
        self.pairs[from as usize..to as usize].iter().any(|p| p[1] == high)
    }
}

impl<'a> Allowed<'a> {
    /// Of a world, bonds included.
    pub fn new(w: &'a World) -> Self {
        let bits = w.groups.surfaces().iter().map(|(g, s)| [s.parent.bit(), g.bit()]);
        let surfaces: Vec<[u32; 2]> = bits.collect();
        let families = w.families.as_ref().filter(|_| !surfaces.is_empty());
        let excluded = Self::excluded(w);
        let barred = Barred::new(w.bonds.barred());
        let free = excluded.free && surfaces.is_empty() && barred.pairs.is_empty();
        Self { barred, surfaces, families, free, ..excluded }
    }

    /// As they stood when this step's forces were felt: pairs whose bonds have broken since act from the next step on.
    pub fn felt(w: &'a World) -> Self {
        let now = Self::new(w);
        if w.rebuild.freed.is_empty() {
            return now;
        }
        let mut pairs = now.barred.pairs;
        pairs.extend(w.rebuild.freed.iter().copied());
        pairs.sort_unstable();
        Self { barred: Barred::new(pairs), free: false, ..now }
    }

    /// Of `neigh_modify exclude` alone.
    pub fn excluded(w: &'a World) -> Self {
        Self {
            excluded: rules(w),
            particles: &w.particles,
            barred: Barred::default(),
            surfaces: vec![],
            families: None,
            free: excluded(w).is_none(),
        }
    }

    /// Whether pair forces act between these two.
    #[inline]
    pub fn pair(&self, i: usize, j: usize) -> bool {
        self.free || self.by_rules(i, j)
    }

    fn by_rules(&self, i: usize, j: usize) -> bool {
        let p = self.particles;
        !self.excluded.pair(i, j)
            && (self.surfaces.is_empty() || self.meet(i, j))
            && !self.barred.has(p.tag[i], p.tag[j])
    }

    /// Whether neither end lies inside a solid, and they are not of one family.
    fn meet(&self, i: usize, j: usize) -> bool {
        let p = self.particles;
        let inside =
            |mask: u32| self.surfaces.iter().any(|[parent, own]| mask & parent != 0 && mask & own == 0);
        if inside(p.mask[i]) || inside(p.mask[j]) {
            return false;
        }
        self.families.is_none_or(|families| !families.related(&p.x0, &p.kind, i, j))
    }
}

#[cfg(test)]
mod tests {
    use super::Barred;

    #[test]
    fn barred_pairs_are_found_from_either_end() {
        let pairs = vec![[1, 4], [1, 9], [3, 4], [7, 8]];
        let barred = Barred::new(pairs.clone());
        for a in 0..12 {
            for b in 0..12 {
                assert_eq!(barred.has(a, b), pairs.contains(&[a.min(b), a.max(b)]), "{a} {b}");
            }
        }
        assert!(!Barred::new(vec![]).has(1, 2));
    }
}
