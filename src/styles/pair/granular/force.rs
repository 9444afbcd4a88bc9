//! The op of granular contacts: list when it is due, contacts, forces and torques.

use crate::diag::Result;
use crate::laws::contact::bodies::solids;
use crate::laws::contact::driver::{Average, Curvature, Grains, Rules, Sweep};
use crate::laws::contact::{Advance, ContactLaw, Granular};
use crate::math::vec3::Vec3;
use crate::neigh::list::{Pair, Reach, View, Wanted, pairs};
use crate::plan::{Access, Op, Stage, Tick};
use crate::world::contacts::Contacts;
use crate::world::{Allowed, World};

/// Forces and torques of all granular contacts of one pair style.
pub struct Force {
    rules: Rules<Granular>,
    wanted: Wanted,
    /// The style's name, under which contact history is kept in the world.
    style: &'static str,
    /// What the op is called.
    name: String,
    list: Vec<Pair>,
    /// The rebuild the list was made at.
    generation: Option<u64>,
    body: Vec<u32>,
    /// Whether fix freeze holds a particle; empty without one.
    frozen: Vec<bool>,
    sweep: Sweep,
}

impl Force {
    /// With nothing computed yet.
    pub fn new(style: &'static str, rules: Rules<Granular>, wanted: Wanted) -> Self {
        let (sweep, name) = (Sweep::default(), format!("pair {style}"));
        Self {
            rules,
            wanted,
            style,
            name,
            list: vec![],
            generation: None,
            body: vec![],
            frozen: vec![],
            sweep,
        }
    }

    /// Which solid each particle belongs to, where some rule asks.
    fn find_bodies(&mut self, w: &World) {
        self.body.clear();
        let asked = self.rules.any(|r| r.average == Average::Body || r.curvature == Curvature::Impactor);
        if let (true, Some(families)) = (asked, &w.families) {
            self.body = solids(families, w.n());
        }
    }

    /// Which particles fix freeze holds.
    fn find_frozen(&mut self, w: &World) {
        self.frozen.clear();
        if let Some((_, group)) = &w.parts.frozen {
            self.frozen.extend(w.particles.mask.iter().map(|m| m & group.bit() != 0));
        }
    }

    /// How far types reach for each other, with what contacts that hold span beyond touch.
    fn reaching(&self, w: &World) -> Wanted {
        let mut wanted = self.wanted.clone();
        let mut largest = vec![0.0_f64; w.types];
        for (kind, r) in w.particles.kind.iter().zip(&w.particles.radius) {
            let of_type = &mut largest[usize::from(*kind) - 1];
            *of_type = of_type.max(*r);
        }
        let types = 1..=w.types as u16;
        for (a, b) in types.clone().flat_map(|a| types.clone().map(move |b| (a, b))) {
            let [ra, rb] = [a, b].map(|k| largest[usize::from(k) - 1]);
            let (Some(rule), Some(Reach::Touch)) = (self.rules.get(a, b), wanted.get(a, b)) else { continue };
            let gap = if ra + rb > 0.0 { rule.law.gap(ra * rb / (ra + rb)) } else { 0.0 };
            if gap > 0.0 {
                wanted.set(a, b, Reach::Beyond(gap));
            }
        }
        wanted
    }

    /// The list, from the positions of the last rebuild: later positions are within half a skin of those.
    fn find_pairs(&mut self, w: &World) -> Result<()> {
        let p = &w.particles;
        let held = w.held();
        let x = if held.len() == p.len() { held } else { &p.x };
        let v = View { x, tag: &p.tag, kind: &p.kind, radius: &p.radius, period: period(w)? };
        let allowed = Allowed::new(w);
        self.list = pairs(&v, &self.reaching(w), w.settings.neighbor.skin, &|i, j| allowed.pair(i, j));
        self.generation = Some(w.rebuild.generation);
        Ok(())
    }
}

impl Op for Force {
    fn name(&self) -> &str {
        &self.name
    }

    fn stage(&self) -> Stage {
        Stage::Force
    }

    fn access(&self) -> Access {
        Access::new("x v omega radius mass type contacts", "f torque contacts tally")
    }

    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        // A run that continues an unchanged scene has no setup.
        if t.setup || self.generation.is_none() {
            self.find_bodies(w);
        }
        if self.generation != Some(w.rebuild.generation) {
            self.find_pairs(w)?;
        }
        let period = period(w)?;
        self.find_frozen(w);
        let mut memory = w.contacts.remove(self.style).unwrap_or_default();
        // In setup forces are only evaluated; LAMMPS yet shortens the springs of contacts that slide.
        let kept: Option<Contacts> = (t.setup && !w.settings.lammps()).then(|| memory.clone());
        let p = &w.particles;
        let grains = Grains {
            x: &p.x,
            v: &p.v,
            omega: &p.omega,
            radius: &p.radius,
            mass: &p.mass,
            kind: &p.kind,
            tag: &p.tag,
            period,
            flow: w.domain()?.flow.map(|flow| (flow, &p.mask[..])),
            body: &self.body,
            frozen: &self.frozen,
        };
        let step = Advance { dt: t.dt, history: !t.setup };
        self.sweep.run(&self.list, &grains, &self.rules, &mut memory, step);
        self.sweep.scatter(&mut w.particles.f, &mut w.particles.torque);
        if t.virial {
            let virial = self.sweep.virial(&w.particles.x, &period);
            for (total, part) in w.tally.virial.iter_mut().zip(virial) {
                *total += part;
            }
        }
        w.contacts.insert(self.style.to_string(), kept.unwrap_or(memory));
        Ok(())
    }

    fn bytes(&self, _w: &World) -> u64 {
        // Pairs read with both ends (12 + 2 × 32 bytes); per contact both ends' state, wrench and history.
        (self.list.len() * 76 + self.sweep.len() * 400) as u64
    }
}

/// Edge lengths of the box; zero where it does not repeat.
fn period(w: &World) -> Result<Vec3> {
    let domain = w.domain()?;
    let (lengths, periodic) = (domain.lengths(), domain.periodic());
    Ok(std::array::from_fn(|d| if periodic[d] { lengths[d] } else { 0.0 }))
}
