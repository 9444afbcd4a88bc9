//! compute energy/ledger: energy balance of the system, by form and by source.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::ledger;
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{
    BONDS, BOX, COLUMNS, CONTACTS, FACTS, FAMILIES, KIND, LISTS, MASK, MASS, MEMO, MOLECULE, OMEGA, RADIUS,
    TAG, TALLY, TRAVEL, TYPE_MASS, V, VOLUME, X, X0,
};
use perigrain_world::{GroupId, SlotId, World};

/// The style.
pub struct EnergyLedger;

impl Style for EnergyLedger {
    fn name(&self) -> &'static str {
        "energy/ledger"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Energy by channel: what the scene holds, what has become heat and cracks, what came in, what is missing.",
            text: "Global vector, in energy units (joules in `units si`), true energies whatever forces are called: 1 kinetic, 2 \
                   rotational, 3 strain of all bonds, 4 elastic energy of contacts of particles with each other and with granular walls (normal and tangential \
                   springs), 5 taken up by dashpots along the normal and by flow in contacts `mdr`, 6 by friction and everything else across it, 7 set free \
                   by peridynamic bonds that broke, with what their last forces take in the half step after.\n\n\
                   Then 8 work of walls on particles, of granular ones by how they move (walls that stand do none), 9 of gravity, 10 of all else that a \
                   deck imposes (other fixes, driven particles), 11 the residual, 12 … the strain of the bonds of each type, and last \
                   the heat of bonds that relax or flow (peri/ves, peri/eps, peri/pmb/plastic), less what thermal strain adds to the energy of bonds. \
                   Scalar: the residual.\n\n\
                   residual = 1 + 2 + 3 + 4 + 5 + 6 + 7 + last − 8 − 9 − 10 less its value when the first run with a ledger began: 0 if energy is kept. \
                   What a deck changes between runs does not count, so that one run and two leave the same. \
                   In an elastic scene and where peridynamic bonds break it falls with the square of the time step; friction and bonds of grains \
                   that break leave errors of first order.\n\n\
                   Bonds that break at the end of a step are strain in its row and cracks in the next. 5 to 10 are sums since the first run with a ledger, by the trapezoidal rule over the \
                   powers at every step; 3 and 12 … are tallied at the steps at which they are read. Walls that are no granular ones give back in 8 what they store; springs of rolling and twisting count \
                   as friction.\n\n\
                   Plastic grains (`mdr`) hold what their contacts would give back if they unloaded now; what goes into such contacts \
                   besides (flow, growth of grains, torn surfaces) is booked in 5 as far as it grows, since flow gives nothing back: what seems to come back was \
                   made from nothing and stays in the residual. Where the bulk answers (`psi_b`) that law has no energy: half of its force times its depth \
                   counts as held.\n\n\
                   The heat of bonds is 2/τ times the energy of relaxing springs, and for plastic bonds what they lose when they \
                   flow, of first order in the step; under `compat lammps`, whose forces of such bonds have no energy, it is in \
                   the residual.\n\n\
                   Contacts book their work as they act; solids that relax or flow are evaluated a second time.",
            example: "compute e all energy/ledger",
        }
    }
}

impl ComputeStyle for EnergyLedger {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        args.finish()?;
        if cx.group != GroupId::ALL {
            return fail(Code::BAD_VALUE, cx.span, "compute energy/ledger must use the group `all`");
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), types: cx.world.types }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    types: usize,
}

impl Compute for Declared {
    fn elements(&self) -> Vec<String> {
        const CHANNELS: [&str; 11] = [
            "kinetic",
            "rotational",
            "strain",
            "contacts",
            "dashpots",
            "friction",
            "cracks",
            "walls",
            "gravity",
            "imposed",
            "residual",
        ];
        let strains = (1..=self.types).map(|k| format!("strain_{k}"));
        CHANNELS.map(String::from).into_iter().chain(strains).chain(["heat".into()]).collect()
    }

    fn shape(&self) -> Shape {
        Shape {
            scalar: true,
            scalar_extensive: true,
            vector: 12 + self.types,
            vector_extensive: true,
            ..Shape::default()
        }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        cx.request_energy(when);
        cx.request_atom_energy(when);
        let mut probes = cx.probes()?;
        let reads = X
            | V
            | OMEGA
            | RADIUS
            | MASS
            | KIND
            | FAMILIES
            | CONTACTS
            | TALLY
            | BONDS
            | BOX
            | COLUMNS
            | FACTS
            | TAG
            | LISTS
            | MASK
            | MEMO
            | MOLECULE
            | TRAVEL
            | TYPE_MASS
            | VOLUME
            | X0;
        Ok(fill(&self.id, &Wanted { slot, stage, when }, reads, move |w, _, out| {
            let sheet = ledger::sheet(w, &mut probes)?;
            out.scalar = sheet.residual();
            out.vector.clear();
            out.vector.extend(sheet.channels);
            out.vector.push(out.scalar);
            out.vector.extend(&sheet.strain);
            out.vector.push(sheet.heat);
            Ok(())
        }))
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        ledger::open(w)
    }
}
