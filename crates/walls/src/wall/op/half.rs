//! A wall for plastic grains as two ops: its contacts are found before all forces, its forces come behind those of pairs.

use super::WallOp;
use perigrain_base::diag::Result;
use perigrain_plan::{About, Needs, Op, Stage, Tick};
use perigrain_world::World;
use perigrain_world::field::{
    self, BOX, F, FACTS, LISTS, MASK, MASS, MEMO, OMEGA, RADIUS, REGIONS, SLOTS, TAG, TORQUE, V,
    WALL_CONTACTS, X,
};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// One wall as two ops, for plastic grains: contacts before all forces, wall forces after pair forces.
pub fn halves(wall: WallOp) -> Vec<Box<dyn Op>> {
    let name = wall.name.clone();
    let both = Arc::new(Mutex::new(wall));
    let half = |early| Box::new(Half { name: name.clone(), early, wall: both.clone() }) as Box<dyn Op>;
    vec![half(true), half(false)]
}

struct Half {
    name: String,
    early: bool,
    wall: Arc<Mutex<WallOp>>,
}

impl Half {
    fn wall(&self) -> MutexGuard<'_, WallOp> {
        self.wall.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Op for Half {
    fn about(&self) -> About {
        About::new(
            &self.name,
            if self.early { Stage::PreForce } else { Stage::PostForce },
            Needs::new()
                .read(
                    X | V
                        | OMEGA
                        | RADIUS
                        | MASS
                        | MASK
                        | WALL_CONTACTS
                        | field::COLUMNS
                        | TAG
                        | REGIONS
                        | LISTS
                        | BOX,
                )
                .add(F | TORQUE)
                .write(WALL_CONTACTS | RADIUS | FACTS | SLOTS)
                .keep(field::COLUMNS | MEMO),
        )
    }

    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let mut wall = self.wall();
        match (self.early, t.unchanged) {
            (_, true) => Ok(()),
            (true, _) => wall.approach(w, t),
            (false, _) => wall.run(w, t),
        }
    }

    fn finish(&mut self, w: &mut World) -> Result<()> {
        if self.early { Ok(()) } else { self.wall().finish(w) }
    }

    fn bytes(&self, w: &World) -> u64 {
        self.wall().bytes(w) / 2
    }
}
