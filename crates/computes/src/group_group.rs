//! compute group/group: energy and force between two groups.

use super::pair_local::answering;
use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::probe::{Interaction, Request, look_all};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{
    BONDS, BOX, COLUMNS, CONTACTS, FACTS, FAMILIES, KIND, LISTS, MASK, MASS, MEMO, MOLECULE, OMEGA, RADIUS,
    TAG, TRAVEL, V, VOLUME, X, X0,
};
use perigrain_world::{GroupId, SlotId, World};

/// The style.
pub struct GroupGroup;

impl Style for GroupGroup {
    fn name(&self) -> &'static str {
        "group/group"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Energy and force between two groups.",
            text: "Scalar and vector of 3 (both extensive): the energy of all pairs with one end in the group and the other in group2, and \
                   the force on the ends in the group, in energy and force units. Pairs are those of compute pair/local with the \
                   same numbers: of granular styles only the force along the line of centres counts, and there is no energy, as in \
                   LAMMPS. A pair both of whose ends are in both groups counts once and has no force. Bonds of bond styles do not count. Where no pair style can be asked about single pairs the line is refused, as \
                   in LAMMPS: `peri/lps`, `peri/ves`, `peri/eps`.",
            example: "compute push all group/group all",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The second group.
    #[word(name = "group2")]
    other: GroupId,
    /// Whether there are pairs at all.
    #[word(keyword, default = true)]
    pair: bool,
    #[word(keyword, placed)]
    molecule: Option<At<Molecules>>,
    /// `yes` is refused: there are no electric forces.
    #[word(keyword, placed)]
    kspace: Option<At<bool>>,
    /// Changes nothing without electric forces.
    #[word(keyword)]
    boundary: bool,
}

/// Selection of pairs by molecule.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "value of molecule")]
enum Molecules {
    /// All pairs.
    #[word("off")]
    Any,
    /// Pairs of different molecules only.
    #[word("inter")]
    Different,
    /// Pairs of the same molecule only.
    #[word("intra")]
    Same,
}

impl ComputeStyle for GroupGroup {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { other, pair, molecule, kspace, boundary: _ } = read(args, cx)?;
        if let Some(At { span, .. }) = kspace.filter(|k| k.value) {
            let text = "there are no electric forces in perigrain: `kspace yes` has nothing to add";
            let d = Diagnostic::error(Code::NOT_SUPPORTED, span, text);
            return Err(d.help("leave `kspace` out").into());
        }
        let molecules = molecule.map_or(Molecules::Any, |m| m.value);
        if let Some(At { span, .. }) = molecule.filter(|_| molecules != Molecules::Any)
            && !cx.world.particles.style.molecules
        {
            let text = "particles of this atom_style belong to no molecules";
            let d = Diagnostic::error(Code::CONFLICT, span, text);
            return Err(d.help("`fix ID all property/atom mol` gives them molecule IDs").into());
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, other, pair, molecules }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    other: GroupId,
    pair: bool,
    molecules: Molecules,
}

impl Declared {
    fn counts(&self, w: &World, p: &Interaction) -> bool {
        let molecule = |i: u32| w.particles.molecule[i as usize];
        match self.molecules {
            Molecules::Any => true,
            Molecules::Different => molecule(p.i) != molecule(p.j),
            Molecules::Same => molecule(p.i) == molecule(p.j),
        }
    }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { scalar: true, scalar_extensive: true, vector: 3, vector_extensive: true, ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let mut probes = answering(&self.id, cx)?;
        let me = self.clone();
        let reads = X
            | V
            | OMEGA
            | RADIUS
            | MASS
            | KIND
            | MASK
            | CONTACTS
            | BOX
            | COLUMNS
            | FACTS
            | FAMILIES
            | TAG
            | LISTS
            | MEMO
            | MOLECULE
            | TRAVEL
            | VOLUME
            | X0
            | BONDS;
        Ok(fill(&self.id, &Wanted { slot, stage, when }, reads, move |w, _, out| {
            let pairs = if me.pair { look_all(&mut probes, w, Request::Acting)? } else { vec![] };
            let is = |i: u32, g: GroupId| w.particles.mask[i as usize] & g.bit() != 0;
            let (mut energy, mut force) = (0.0, [0.0; 3]);
            for p in pairs.iter().filter(|p| me.counts(w, p)) {
                let ahead = is(p.i, me.group) && is(p.j, me.other);
                let back = is(p.j, me.group) && is(p.i, me.other);
                if !ahead && !back {
                    continue;
                }
                energy += p.energy;
                let sign = f64::from(u8::from(ahead)) - f64::from(u8::from(back));
                let along = sign * p.central() / p.distance();
                (0..3).for_each(|d| force[d] += along * p.d[d]);
            }
            (out.scalar, out.vector) = (energy, force.to_vec());
            Ok(())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn words() {
        let b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 2]);
        for words in ["", "missing", "all kspace yes", "all molecule inter", "all pair maybe", "all tail yes"]
        {
            assert!(b.compute(&GroupGroup, words).is_err(), "{words}");
        }
        let c = b.compute(&GroupGroup, "all pair yes kspace no boundary no molecule off").unwrap();
        assert_eq!((c.shape().scalar_extensive, c.shape().vector), (true, 3));
    }
}
