//! What presses plastic grains (normal model `mdr`) in the loop over contacts: growth, depths on both sides, forces.

use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_contact::driver::{Grains, Sweep};
use perigrain_contact::mdr::{Manner, Material, Meetings, PAIR, PRECOMPUTED, SIDES, State, begin, undo};
use perigrain_plan::Tick;
use perigrain_world::contacts::Contacts;
use perigrain_world::{Constant, World};

/// What the plastic grains of the pair style in force are made of: E, ν, Y, ψ_b and restitution.
pub static PLASTIC_GRAIN: Constant<[f64; 5]> = Constant::new("mdr/material");

/// Plastic grains of one pair style.
pub struct Press {
    material: Material,
    span: Span,
    meetings: Meetings,
    /// The grains while a step is under way.
    state: State,
    /// The contact history of both sides, likewise.
    plastic: Contacts,
    spare: Vec<f64>,
}

impl Press {
    /// Grains of this material, given at `span`.
    pub fn new(material: Material, span: Span) -> Self {
        let (state, plastic) = (State::default(), Contacts::default());
        Self { material, span, meetings: Meetings::default(), state, plastic, spare: vec![] }
    }

    /// Begins a step: grains grow.
    pub fn begin(&mut self, w: &mut World, t: &Tick) {
        self.plastic = w.contacts.remove(*SIDES).unwrap_or_default();
        self.state = begin(w, (t.step, t.setup), &self.material);
    }

    /// Presses the contacts that were found; the law reads in `memory` what comes of it.
    pub fn act(&mut self, grains: &Grains, sweep: &Sweep, memory: &mut Contacts, manner: Manner) {
        // In setup forces are only evaluated.
        let kept = manner.setup.then(|| self.state.clone());
        let (state, plastic) = (&mut self.state, &mut self.plastic);
        let (touching, geometry) = (sweep.touching(), sweep.geometry());
        self.meetings.meet(touching, geometry, grains.radius, state, plastic, manner.lammps);
        if manner.setup {
            // Nothing has moved.
            state.mean.fill(0.0);
        }
        let before = manner.setup.then(|| plastic.history.clone());
        let width = memory.width;
        let precomputed = (&mut memory.history[..], width);
        self.meetings.press(&self.material, grains.radius, state, plastic, precomputed, manner);
        if let Some(before) = before {
            undo(&before, &mut plastic.history, PAIR, manner.lammps);
        }
        if let Some(kept) = kept {
            self.state = kept;
        }
    }

    /// Ends a step: the history of grains and contacts goes back into the world.
    pub fn end(&mut self, w: &mut World) {
        w.contacts.insert(*SIDES, std::mem::take(&mut self.plastic));
        std::mem::take(&mut self.state).put(&mut w.columns);
    }

    /// Combines the contact history `before` a setup with the evaluation data of that setup, which probes of single pairs need.
    pub fn with_results(&mut self, mut before: Contacts, after: &Contacts) -> Contacts {
        let width = after.width;
        before.carry(&after.keys, width, &mut self.spare);
        let rows = before.history.chunks_exact_mut(width).zip(after.history.chunks_exact(width));
        rows.for_each(|(old, new)| old[width - PRECOMPUTED..].copy_from_slice(&new[width - PRECOMPUTED..]));
        before
    }

    /// Refuses forces that are no numbers.
    ///
    /// # Errors
    /// The pair that is pressed too far.
    pub fn check(&self, w: &World, sweep: &Sweep, t: &Tick) -> Result<()> {
        let mut forces = sweep.contacts();
        let Some((pair, _)) = forces.find(|(_, wrench)| !wrench.force.iter().all(|f| f.is_finite())) else {
            return Ok(());
        };
        let [a, b] = [pair.i, pair.j].map(|k| w.particles.tag[k as usize]);
        let text = format!(
            "particles {a} and {b} are pressed into each other beyond all sense of `mdr` at step {}",
            t.step
        );
        Err(Diagnostic::error(Code::SUSPICIOUS, self.span, text).help("take a shorter time step").into())
    }
}
