//! Pairs of particles that a deck takes away.

/// The rules of `neigh_modify exclude` as they stand, with the columns of the particles that they speak of.
#[derive(Clone, Copy, Debug)]
pub struct Excluded<'a> {
    /// Pairs of groups, by their bits.
    pub groups: &'a [(u32, u32)],
    /// Pairs of types.
    pub kinds: &'a [(u16, u16)],
    /// Groups within which molecules count, and whether pairs inside one are taken away or those of two.
    pub molecules: &'a [(u32, bool)],
    /// Group bits of the particles.
    pub mask: &'a [u32],
    /// Types of the particles.
    pub kind: &'a [u16],
    /// Molecules of the particles; empty where they have none.
    pub molecule: &'a [u32],
}

impl Excluded<'_> {
    /// Whether a rule takes this pair away.
    pub fn pair(&self, i: usize, j: usize) -> bool {
        let (mask, kind) = ([self.mask[i], self.mask[j]], [self.kind[i], self.kind[j]]);
        let [a, b] = mask;
        let groups = |&(g, h): &(u32, u32)| (a & g != 0 && b & h != 0) || (a & h != 0 && b & g != 0);
        let kinds = |&(g, h): &(u16, u16)| (kind[0] == g && kind[1] == h) || (kind[0] == h && kind[1] == g);
        let molecules = |&(g, inside): &(u32, bool)| {
            let same = self.molecule.get(i) == self.molecule.get(j);
            a & g != 0 && b & g != 0 && same == inside
        };
        self.groups.iter().any(groups) || self.kinds.iter().any(kinds) || self.molecules.iter().any(molecules)
    }
}
