//! Fixes that set the time step: when they look, and what they remember.

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

/// What such fixes share: their name, how often they look, and as scalar the last step at which the step changed.
#[derive(Clone)]
pub struct Follower {
    style: &'static str,
    id: String,
    /// Steps between two looks.
    every: i64,
}

impl Follower {
    /// Of a fix with this style and ID.
    pub fn new(style: &'static str, id: &str, every: i64) -> Self {
        Self { style, id: id.to_string(), every }
    }

    fn memo(&self) -> Numbers {
        Key::new(&format!("{}/{}", self.style, self.id))
    }

    /// Counts from now on.
    pub fn declare(&self, w: &mut World) {
        w.memo.insert(self.memo(), vec![w.clock.step as f64]);
    }

    /// Forgets.
    pub fn remove(&self, w: &mut World) {
        w.memo.remove(self.memo());
    }

    /// The op that looks in the setup of a run and every so many steps; `step` says how long a step is to be. A run that merely
    /// continues another one looks at no other steps than one long run would. On ranks `step` asks for the rows it needs, or looks at those
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
