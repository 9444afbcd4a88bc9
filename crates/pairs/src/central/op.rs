//! The op of central forces.

use super::table::Felt;
use super::{Law, Table};
use crate::shared::{admit, built_at, near, push};
use perigrain_base::diag::Result;
use perigrain_base::par;
use perigrain_neigh::list::Pair as Near;
use perigrain_plan::{About, Needs, Op, Stage, Tick};
use perigrain_styles::near::room_for_pairs;
use perigrain_world::field::{
    BONDS, BOX, F, FAMILIES, KIND, LISTS, MASK, MEMO, MOLECULE, RADIUS, TAG, TALLY, X, X0,
};
use perigrain_world::{Allowed, Key, World};

/// Pushes pairs apart.
pub struct Push<L> {
    name: String,
    key: Key<f64>,
    table: Table<L>,
    /// Rebuild and change of bonds at which the list was made.
    made: Option<(u64, u64)>,
    list: Vec<Near>,
    /// What each pair of the list feels.
    felt: Vec<Option<Felt>>,
}

impl<L: Law> Push<L> {
    /// With these coefficients.
    pub fn new(table: Table<L>) -> Self {
        let name = format!("pair {}", L::NAME);
        Self { name, key: Key::new(L::NAME), table, made: None, list: vec![], felt: vec![] }
    }

    /// The list, as it stands: made anew, or with the pairs that bonds have freed.
    fn renew(&mut self, w: &World, t: &Tick) -> Result<()> {
        self.table.renew(w);
        let now = (w.rebuild.generation, w.bonds.changes);
        if !t.setup && self.made == Some(now) {
            return Ok(());
        }
        let (skin, wanted) = (w.settings.neighbor.skin, &self.table.wanted);
        let freed = self.made.filter(|_| !t.setup).and_then(|(since, _)| w.rebuild.only_parted(since));
        if let Some(pairs) = freed {
            admit(w, pairs, wanted, &Allowed::new(w), &mut self.list);
        } else {
            room_for_pairs(w, wanted, skin)?;
            self.list = near(w, built_at(w), wanted, skin, &Allowed::new(w));
        }
        self.table.weigh(w);
        self.made = Some(now);
        Ok(())
    }
}

impl<L: Law> Op for Push<L> {
    fn about(&self) -> About {
        let reads = X | KIND | BONDS | BOX | MEMO | LISTS | RADIUS | FAMILIES | TAG | MOLECULE | X0 | MASK;
        About::new(&self.name, Stage::Force, Needs::new().read(reads | L::READS).add(F).write(TALLY))
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        self.renew(w, t)?;
        let (table, list, felt) = (&self.table, &self.list, &mut self.felt);
        felt.resize(list.len(), None);
        let scene: &World = w;
        par::each(&mut felt[..], |start, felt: &mut [Option<Felt>]| {
            let near = list[start..].iter();
            felt.iter_mut().zip(near).for_each(|(felt, pair)| *felt = table.felt(scene, pair));
        });
        // Pairs that can be probed report their own part of the virials of particles.
        let t = &Tick { atom_virial: t.atom_virial && !L::SINGLE, ..t.clone() };
        let mut energy = 0.0;
        for (pair, felt) in list.iter().zip(felt.iter()) {
            let Some(felt) = felt else { continue };
            energy += felt.energy;
            let force = felt.d.map(|d| d * felt.force);
            push(w, t, [pair.i as usize, pair.j as usize], felt.d, force, felt.energy);
        }
        if t.energy {
            w.tally.add_pair(self.key, energy);
        }
        Ok(())
    }
}
