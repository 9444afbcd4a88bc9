//! Walls and plastic grains (normal model `mdr`).

use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_contact::Model;
use perigrain_contact::mdr::{self, Manner, Material, PRECOMPUTED, State, WALL};
use perigrain_contact::normal::{plastic, plastic_grain};
use perigrain_contact::walls::WallSweep;
use perigrain_pairs::PLASTIC_GRAIN;
use perigrain_plan::Tick;
use perigrain_styles::SealCx;
use perigrain_styles::ledger::WALL_TOUCHES;
use perigrain_world::contacts::Contacts;
use perigrain_world::{Key, World};

/// Names of the parameters of plastic grains in decks, in their order.
const NUMBERS: [&str; 5] = ["E", "nu", "Y", "psi_b", "the restitution"];

/// Refuses a wall whose material parameters differ from those of the pair style: wall and pairs share one
/// memory per grain. Adhesion of the wall may differ.
///
/// # Errors
/// Another normal model, or another parameter.
pub fn suits(material: &super::words::Material, cx: &mut dyn SealCx) -> Result<()> {
    let model = &material.model;
    if material.lent.is_some() {
        // The laws themselves are refused where they are plastic.
        return Ok(());
    }
    let Some(grains) = cx.world().facts.get(*PLASTIC_GRAIN).copied() else { return Ok(()) };
    let Some(wall) = plastic_grain(&model.normal) else {
        let text = format!("the grains are plastic (`mdr`), the wall is `{}`", model.normal.name());
        let d = Diagnostic::error(Code::CONFLICT, cx.span(), text);
        return Err(d.help("give the wall the model and the numbers of the grains").into());
    };
    let Some(k) = (0..NUMBERS.len()).find(|&k| wall[k] != grains[k]) else { return Ok(()) };
    let text = format!(
        "{} is {} in the wall and {} in the grains: plastic grains (`mdr`) need walls of their own kind",
        NUMBERS[k], wall[k], grains[k]
    );
    let d = Diagnostic::error(Code::CONFLICT, cx.span(), text);
    Err(d.help(format!("write {} for the wall too", grains[k])).into())
}

/// A wall for plastic grains.
pub struct Plastic {
    material: Material,
    /// Key of its contact memory.
    key: Key<Contacts>,
    spare: Vec<f64>,
}

/// Key of the memory of plastic grains on the wall of this ID.
pub fn key(id: &str) -> Key<Contacts> {
    Key::new(&format!("mdr/{id}"))
}

impl Plastic {
    /// For walls with the normal model `mdr`.
    pub fn of(model: &Model, id: &str) -> Option<Self> {
        Some(Self { material: plastic(&model.normal)?, key: key(id), spare: vec![] })
    }

    /// Begins the step for all grains.
    pub fn begin(&self, w: &mut World, t: &Tick) {
        let at = (t.step, t.setup);
        if !mdr::begun(w, at) {
            mdr::begin(w, at, &self.material).put(&mut w.columns);
        }
    }

    /// Passes the approach of the wall to the grains.
    pub fn gather(&mut self, w: &mut World, t: &Tick, sweep: &WallSweep) {
        if t.setup {
            return;
        }
        let n = w.n();
        let mut state = State::take(&mut w.columns, n);
        let (touching, keys) = sweep.touching();
        let depths = touching.iter().map(|c| {
            let k = c.grain as usize;
            (k, w.particles.radius[k] - c.near.distance)
        });
        if let Some(memory) = w.wall_contacts.get(self.key) {
            mdr::gather(&mut state, memory, keys, depths);
        }
        state.put(&mut w.columns);
    }

    /// Applies the wall's pressure to the grains; `contacts` does the rest of the law.
    pub fn press(&mut self, w: &mut World, t: &Tick, sweep: &WallSweep, contacts: &mut Contacts) {
        let n = w.n();
        let mut state = State::take(&mut w.columns, n);
        let mut memory = w.wall_contacts.remove(self.key).unwrap_or_default();
        // The setup only evaluates forces.
        let kept = t.setup.then(|| state.clone());
        let (touching, keys) = sweep.touching();
        memory.carry(keys, WALL, &mut self.spare);
        let manner =
            Manner { lammps: w.settings.lammps(), setup: t.setup, booked: w.facts.has(*WALL_TOUCHES) };
        let width = contacts.width;
        let before = t.setup.then(|| memory.history.clone());
        let rows = memory.history.chunks_exact_mut(WALL).zip(contacts.history.chunks_exact_mut(width));
        for (c, (own, precomputed)) in touching.iter().zip(rows) {
            let k = c.grain as usize;
            let radius = w.particles.radius[k];
            let (depth, precomputed) = (radius - c.near.distance, &mut precomputed[width - PRECOMPUTED..]);
            let deed = mdr::press(&self.material, &state, k, radius, depth, own, precomputed, manner);
            let mut sum = mdr::Sum::default();
            sum.add(&deed, c.near.normal);
            sum.give(&mut state, k);
        }
        if let Some(before) = before {
            mdr::undo(&before, &mut memory.history, WALL, manner.lammps);
        }
        let state = kept.unwrap_or(state);
        w.wall_contacts.insert(self.key, memory);
        state.put(&mut w.columns);
    }
}
