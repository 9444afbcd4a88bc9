//! compute statics: numbers of the load step of `statics` that was made last.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::run::statics::{Ledger, NUMBERS};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::SlotId;
use perigrain_world::field::FACTS;

/// The style.
pub struct Statics;

/// The values, by their names in outputs.
const NAMES: [&str; 12] = [
    "time",
    "newton",
    "products",
    "unbalanced",
    "error",
    "broken",
    "work",
    "energy",
    "released",
    "relaxed",
    "load",
    "lost",
];

impl Style for Statics {
    fn name(&self) -> &'static str {
        "statics"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Numbers of the load step of `statics` that was made last: its work, what cracks took, how it was balanced.",
            text: "Global vector: 1 time of the loads, 2 Newton's steps, 3 products with the stiffness, 4 unbalanced force over the \
                   larger one of reactions and loads, 5 the error of the place over the root of twice the work, in the norm of the energy \
                   (estimated), 6 bonds that broke in this load step, 7 work since the first load step of the line, 8 change of the \
                   energy, 9 energy released by bonds where they broke, 10 energy given up between breaks and equilibria, \
                   11 the load: the larger one of the two-norms of reactions and loads, 12 energy \
                   that bonds lose which flow, soften or relax.\n\n\
                   Energies are true ones [energy], the load is a force. In the row of the scene that load steps begin with all are 0 but for the \
                   time; without `statics` all are 0. The group counts nothing.",
            example: "compute s all statics\nfix motion plate nve\nfix base foot setforce 0.0 0.0 0.0\nthermo_style custom step c_s[1] c_s[7] c_s[9]\n\
                      statics 2 time 1.0e-6",
        }
    }
}

impl ComputeStyle for Statics {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        args.finish()?;
        Ok(Box::new(Declared { id: cx.id.to_string() }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
}

impl Compute for Declared {
    fn elements(&self) -> Vec<String> {
        NAMES.map(String::from).into()
    }

    fn shape(&self) -> Shape {
        Shape { vector: NAMES.len(), ..Shape::default() }
    }

    fn op(&self, _: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        Ok(fill(&self.id, &Wanted { slot, stage, when }, FACTS, move |w, _, out| {
            let n = w.facts.get(*NUMBERS).copied().unwrap_or_default();
            let Ledger { work, energy, released, relaxed, lost, .. } = n.ledger;
            let error = if work > 0.0 { n.error / (2.0 * work).sqrt() } else { 0.0 };
            let (newton, products, broken) = (n.newton as f64, n.products as f64, n.broken as f64);
            let row = [
                n.time, newton, products, n.force, error, broken, work, energy, released, relaxed, n.load,
                lost,
            ];
            out.vector.clear();
            out.vector.extend(row);
            Ok(())
        }))
    }
}
