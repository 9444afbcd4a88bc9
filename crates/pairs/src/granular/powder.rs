//! The op of plastic grains (normal model `mdr`): growth, contacts on both sides, forces and torques.

use super::super::shared::{add_virial, built_at, find_frozen, near};
use super::force::{conducts, grains};
use super::reach::reaching;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::vec3::Vec3;
use perigrain_contact::driver::{Grains, Rules, Sweep};
use perigrain_contact::powder::{Manner, Material, Meetings, PAIR, TOLD, begin, undo};
use perigrain_contact::{Advance, Granular};
use perigrain_neigh::list::{Pair, Wanted, difference};
use perigrain_plan::{Needs, Op, Stage, Tick};
use perigrain_world::columns::{HEATFLOW, TEMPERATURE};
use perigrain_world::contacts::{Contacts, PLASTIC};
use perigrain_world::field::{
    BONDS, BOX, COLUMNS, CONTACTS, F, FACTS, FAMILIES, KIND, LISTS, MASK, MASS, MEMO, MOLECULE, OMEGA,
    RADIUS, TAG, TALLY, TORQUE, TRAVEL, V, X,
};
use perigrain_world::{Allowed, World};

/// Forces and torques among plastic grains.
pub struct Powder {
    rules: Rules<Granular>,
    wanted: Wanted,
    material: Material,
    style: &'static str,
    name: String,
    span: Span,
    /// Whether fix freeze holds a particle; empty without one.
    frozen: Vec<bool>,
    /// The rebuild the list was made at.
    generation: Option<u64>,
    list: Vec<Pair>,
    sweep: Sweep,
    meetings: Meetings,
    spare: Vec<f64>,
}

impl Powder {
    /// With nothing computed yet.
    pub fn new(
        style: &'static str,
        rules: Rules<Granular>,
        wanted: Wanted,
        material: Material,
        span: Span,
    ) -> Self {
        Self {
            rules,
            wanted,
            material,
            style,
            name: format!("pair {style}"),
            span,
            frozen: vec![],
            generation: None,
            list: vec![],
            sweep: Sweep::default(),
            meetings: Meetings::default(),
            spare: vec![],
        }
    }

    /// The list from the positions of the last rebuild.
    fn renew(&mut self, w: &World) {
        self.generation = Some(w.rebuild.generation);
        let wanted = reaching(&self.rules, &self.wanted, w);
        self.list = near(w, built_at(w), &wanted, w.settings.neighbor.skin, &Allowed::new(w));
    }

    /// What contacts remembered `before` a setup, and what they were told in it: whoever asks for single pairs needs that.
    fn still(&mut self, mut before: Contacts, after: &Contacts) -> Contacts {
        let width = after.width;
        before.carry(&after.keys, width, &mut self.spare);
        let rows = before.history.chunks_exact_mut(width).zip(after.history.chunks_exact(width));
        rows.for_each(|(old, new)| old[width - TOLD..].copy_from_slice(&new[width - TOLD..]));
        before
    }

    /// Adds the heat that flows through the contacts.
    fn conduct(&self, w: &mut World, period: Vec3) -> Result<()> {
        let names = [TEMPERATURE, HEATFLOW].map(|name| w.columns.custom(name));
        let (true, [Some(temperature), Some(heat)]) = (conducts(&self.rules), names) else { return Ok(()) };
        let n = w.n();
        let mut flow = std::mem::take(w.columns.scalar(&heat, n));
        let temperature = w.columns.scalar(&temperature, n).clone();
        self.sweep.conduct(&grains(w, period, &[], &self.frozen)?, &self.rules, &temperature, &mut flow);
        *w.columns.scalar(&heat, n) = flow;
        Ok(())
    }

    fn check(&self, w: &World, t: &Tick) -> Result<()> {
        let mut forces = self.sweep.contacts();
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

impl Op for Powder {
    fn name(&self) -> &str {
        &self.name
    }

    fn stage(&self) -> Stage {
        Stage::Force
    }

    fn needs(&self) -> Needs {
        Needs::new()
            .read(
                X | V
                    | OMEGA
                    | RADIUS
                    | MASS
                    | KIND
                    | BOX
                    | LISTS
                    | TAG
                    | TRAVEL
                    | FACTS
                    | MASK
                    | MOLECULE
                    | FAMILIES
                    | BONDS,
            )
            .add(F | TORQUE)
            .write(CONTACTS | TALLY | RADIUS)
            .keep(COLUMNS | MEMO)
    }

    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let mut state = begin(w, (t.step, t.setup), &self.material);
        if self.generation != Some(w.rebuild.generation) {
            self.renew(w);
        }
        find_frozen(w, &mut self.frozen);
        let period = w.periods();
        let mut memory = w.contacts.remove(self.style).unwrap_or_default();
        let mut plastic = w.contacts.remove(PLASTIC).unwrap_or_default();
        // In setup forces are only evaluated.
        let kept = t.setup.then(|| (memory.clone(), state.clone()));
        let masses = w.contact_masses();
        let grains = Grains { mass: &masses, ..grains(w, period, &[], &self.frozen)? };
        self.sweep.meet(&self.list, &grains, &self.rules, &mut memory);
        let (touching, keys) = self.sweep.touching();
        let distance = |p: &Pair| difference(grains.x, &period, p);
        self.meetings.meet(
            touching,
            keys,
            grains.radius,
            &mut state,
            &mut plastic,
            distance,
            w.settings.lammps(),
        );
        if t.setup {
            // Nothing has moved.
            state.mean.fill(0.0);
        }
        let manner = Manner { lammps: w.settings.lammps(), setup: t.setup };
        let width = self.rules.memory();
        let before = t.setup.then(|| plastic.history.clone());
        let told = (&mut memory.history[..], width);
        self.meetings.press(&self.material, grains.radius, &mut state, &mut plastic, told, manner);
        let step = Advance { dt: t.dt, history: !t.setup };
        self.sweep.act(&grains, &self.rules, &mut memory, step);
        drop(masses);
        self.check(w, t)?;
        self.conduct(w, period)?;
        self.sweep.scatter(&mut w.particles.f, &mut w.particles.torque);
        if t.virial {
            let part = self.sweep.virial(&w.particles.x, &period);
            add_virial(w, part);
        }
        if let Some(before) = before {
            undo(&before, &mut plastic.history, PAIR, manner.lammps);
        }
        let (memory, state) = match kept {
            Some((before, state)) => (self.still(before, &memory), state),
            None => (memory, state),
        };
        w.contacts.insert(self.style.to_string(), memory);
        w.contacts.insert(PLASTIC.to_string(), plastic);
        state.put(&mut w.columns);
        Ok(())
    }

    fn finish(&mut self, _w: &mut World) -> Result<()> {
        self.generation = None;
        Ok(())
    }

    fn bytes(&self, _w: &World) -> u64 {
        // Pairs read with both ends (12 + 2 × 32 bytes); per contact both ends' state, wrench and history.
        (self.list.len() * 76 + self.sweep.len() * 900) as u64
    }
}
