//! Shared by the fixes that set the time step: their schedule and their state.

use perigrain_base::diag::Result;
use perigrain_plan::{Needs, Op, Stage, Tick, When};
use perigrain_styles::SealCx;
use perigrain_styles::matter::publish;
use perigrain_styles::step_op::StepOp;
use perigrain_world::field::{
    BONDS, BOX, CLOCK, COLUMNS, FACTS, FAMILIES, Fields, KIND, LISTS, MASK, MEMO, MOLECULE, OMEGA, SLOTS,
    TAG, TRAVEL, TYPE_MASS, X0,
};
use perigrain_world::{Key, Numbers, World};

/// Name, schedule and, as scalar output, the last step at which the time step changed.
#[derive(Clone)]
pub struct Follower {
    style: &'static str,
    id: String,
    /// Steps between updates.
    every: i64,
}

impl Follower {
    /// For a fix of this style and ID.
    pub fn new(style: &'static str, id: &str, every: i64) -> Self {
        Self { style, id: id.to_string(), every }
    }

    fn memo(&self) -> Numbers {
        Key::new(&format!("{}/{}", self.style, self.id))
    }

    /// Starts counting at the current step.
    pub fn declare(&self, w: &mut World) {
        w.memo.insert(self.memo(), vec![w.clock.step as f64]);
    }

    /// Deletes the state.
    pub fn remove(&self, w: &mut World) {
        w.memo.remove(self.memo());
    }

    /// The op that updates the time step in the setup of a run and every N steps; `step` computes it. A run
    /// that continues another one updates at the same steps as one long run. On ranks `step` requests the
    /// rows it needs, or reads those of its own rank (`one_by_one`), and all ranks agree on the result.
    /// of its rank (`one_by_one`), and all agree.
    pub fn ops(
        &self,
        cx: &mut dyn SealCx,
        (reads, one_by_one): (Fields, bool),
        mut step: impl FnMut(&mut World) -> Result<f64> + Send + 'static,
    ) -> Vec<Box<dyn Op>> {
        let (memo, slot) = (self.memo(), cx.slot(&format!("f_{}", self.id)));
        let name = format!("fix {} {}", self.id, self.style);
        let look = move |w: &mut World, t: &Tick| {
            let mut last = w.memo.get(memo).and_then(|m| m.first().copied()).unwrap_or(0.0);
            if !t.unchanged {
                let dt = step(w)?;
                if dt != w.clock.dt {
                    w.clock.set_dt(dt);
                    last = t.step as f64;
                    w.memo.insert(memo, vec![last]);
                }
            }
            publish(w, slot, t, last, &[]);
            Ok(())
        };
        let op = StepOp::new(
            name,
            Stage::EndOfStep,
            Needs::new()
                .read(
                    reads
                        | BOX
                        | COLUMNS
                        | TYPE_MASS
                        | FACTS
                        | KIND
                        | X0
                        | FAMILIES
                        | LISTS
                        | OMEGA
                        | MASK
                        | BONDS
                        | MOLECULE
                        | TRAVEL
                        | TAG,
                )
                .write(CLOCK | SLOTS)
                .keep(MEMO),
            look,
        );
        let op = op.when(When::Every(self.every).or(When::First)).in_setup(true);
        vec![if one_by_one { op.one_by_one() } else { op }.boxed()]
    }
}
