//! The op of a wall: who may touch it, contacts, forces, and what it feels.

use super::{Common, Surface};
use crate::diag::Result;
use crate::laws::contact::walls::{Spheres, WallSweep};
use crate::laws::contact::{Advance, Granular};
use crate::math::vec3::{scale, sub};
use crate::out::log::Log;
use crate::plan::{Access, Op, Stage, Tick};
use crate::styles::SealCx;
use crate::world::contacts::Contacts;
use crate::world::{SlotId, World};

/// Columns of `contacts`: in contact or not, force, the wall's nearest point, radius.
pub const COLUMNS: usize = 8;

/// An overlap that contact laws are no longer meant for, as a part of the radius.
const DEEP: f64 = 0.1;

/// Forces of one wall.
pub struct WallOp {
    name: String,
    id: String,
    bit: u32,
    law: Granular,
    surface: Box<dyn Surface>,
    sweep: WallSweep,
    /// The rebuild the list of particles near the wall was made at.
    generation: Option<u64>,
    /// How far the wall may have moved since.
    travelled: f64,
    slot: SlotId,
    contacts: bool,
    /// Columns of local values.
    local: usize,
    center: [f64; 3],
    log: Log,
    /// A deep overlap has been told of.
    told: bool,
}

impl WallOp {
    /// With nothing computed yet.
    pub fn new(
        style: &str,
        local: usize,
        common: &Common,
        surface: Box<dyn Surface>,
        cx: &mut dyn SealCx,
    ) -> Self {
        let compat = cx.world().settings.compat;
        Self {
            name: format!("fix {} {style}", common.id),
            id: common.id.clone(),
            bit: common.group.bit(),
            law: common.material.law(compat),
            surface,
            sweep: WallSweep::default(),
            generation: None,
            travelled: 0.0,
            slot: cx.slot(&format!("f_{}", common.id)),
            contacts: common.contacts,
            local,
            center: common.center,
            log: cx.log(),
            told: false,
        }
    }

    /// Finds out anew who may touch the wall, where particles or wall have moved too far since.
    fn list(&mut self, w: &World, grains: &Spheres) {
        let s = &w.settings.neighbor;
        // Only then no particle is ever farther than half a skin from where it was at the last rebuild.
        let followed = s.check && s.every == 1 && s.delay == 0 && !s.once;
        let fresh = self.generation == Some(w.rebuild.generation) && self.travelled <= 0.5 * s.skin;
        if followed && fresh {
            return;
        }
        let wall = self.surface.wall(w);
        // Half a skin for the wall, and one for particles that have moved half a skin already and move half a skin back.
        let far = 1.5 * s.skin;
        self.sweep.list(&*wall, grains, &w.particles.mask, self.bit, &self.law, far);
        self.generation = Some(w.rebuild.generation);
        self.travelled = 0.0;
    }

    /// Tells once of particles pressed so deep that the law no longer holds.
    fn tell_deep(&mut self, w: &World, t: &Tick) -> Result<()> {
        if self.told {
            return Ok(());
        }
        let p = &w.particles;
        let depth = |i: usize, distance: f64| 1.0 - distance / p.radius[i];
        let (mut many, mut worst) = (0, (DEEP, None));
        for (touch, _) in self.sweep.contacts() {
            let i = touch.grain as usize;
            let depth = depth(i, touch.near.distance);
            many += usize::from(depth > DEEP);
            if depth > worst.0 {
                worst = (depth, Some(i));
            }
        }
        let (depth, Some(i)) = worst else { return Ok(()) };
        self.told = true;
        let percent = (100.0 * depth).round();
        let what = if t.setup { "begins inside it" } else { "is pressed into it" };
        self.log.line(&format!(
            "WARNING: {}: {many} particle(s) deeper in the wall than {:.0} % of the radius at step {}; particle {} {what} \
             by {percent} %",
            self.name,
            100.0 * DEEP,
            t.step,
            p.tag[i]
        ))
    }

    fn publish(&mut self, w: &mut World, t: &Tick, felt: [f64; 6]) {
        let n = w.n();
        let local = self.surface.local(w, &self.sweep, t);
        let mut out = w.slots.take(self.slot);
        out.vector.clear();
        out.vector.extend(felt);
        (out.local, out.local_cols) = (local, self.local);
        if self.contacts {
            out.cols = COLUMNS;
            out.atom.clear();
            out.atom.resize(COLUMNS * n, 0.0);
            for (touch, wrench) in self.sweep.contacts() {
                let i = touch.grain as usize;
                let point = sub(w.particles.x[i], scale(touch.near.distance, touch.near.normal));
                let row = &mut out.atom[COLUMNS * i..][..COLUMNS];
                row[0] = 1.0;
                row[1..4].copy_from_slice(&wrench.force);
                row[4..7].copy_from_slice(&point);
                row[7] = w.particles.radius[i];
            }
        }
        w.slots.put(self.slot, out, t.step);
    }
}

impl Op for WallOp {
    fn name(&self) -> &str {
        &self.name
    }

    fn stage(&self) -> Stage {
        Stage::PostForce
    }

    fn access(&self) -> Access {
        Access::new("x v omega radius mass mask wall_contacts", "f torque wall_contacts")
    }

    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if t.unchanged {
            return Ok(());
        }
        self.travelled += self.surface.place(w, t)?;
        let mut memory = w.wall_contacts.remove(&self.id).unwrap_or_default();
        // In setup forces are only evaluated; LAMMPS yet shortens the springs of contacts that slide.
        let kept: Option<Contacts> = (t.setup && !w.settings.lammps()).then(|| memory.clone());
        let (p, masses) = (&w.particles, w.contact_masses());
        let grains =
            Spheres { x: &p.x, v: &p.v, omega: &p.omega, radius: &p.radius, mass: &masses, tag: &p.tag };
        self.list(w, &grains);
        let wall = self.surface.wall(w);
        let step = Advance { dt: t.dt, history: !t.setup };
        self.sweep.run(&*wall, &grains, &self.law, &mut memory, step);
        drop(wall);
        w.wall_contacts.insert(self.id.clone(), kept.unwrap_or(memory));
        let p = &mut w.particles;
        let felt = self.sweep.scatter(&mut p.f, &mut p.torque, &p.x, self.center);
        self.tell_deep(w, t)?;
        self.publish(w, t, felt);
        Ok(())
    }

    fn bytes(&self, _w: &World) -> u64 {
        // Positions and radii of those near the wall.
        self.sweep.listed() as u64 * 36
    }
}
