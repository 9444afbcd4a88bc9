//! The op of a wall: lists nearby particles, finds contacts, and computes forces on particles and wall.

mod half;
mod looking;

use super::peace::Peace;
use super::plastic::Plastic;
use super::words::Ruled;
use super::{Common, Surface};
use perigrain_base::comm::rows;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::vec3::{Vec3, length, scale, sub};
use perigrain_base::par;
use perigrain_contact::driver::DEEP;
use perigrain_contact::walls::{Meeting, Spheres, Touch, WallSweep};
use perigrain_contact::{Advance, Granular, Heat, Wrench};
use perigrain_plan::{About, Needs, Op, Room, Span as Rows, Stage, Tick, Way, When};
use perigrain_styles::critical::{ReportedSprings, WALL_SPRINGS, walls_always_report, walls_report};
use perigrain_styles::ledger::WALL_TOUCHES;
use perigrain_styles::{Reading, SealCx};
use perigrain_world::columns::{HEATFLOW, TEMPERATURE};
use perigrain_world::contacts::Contacts;
use perigrain_world::field::{
    self, BOX, F, FACTS, KIND, LISTS, MASK, MASS, MEMO, OMEGA, RADIUS, REGIONS, SLOTS, TAG, TORQUE, TRAVEL,
    V, WALL_CONTACTS, X,
};
use perigrain_world::{Key, Numbers, Seen, SlotId, World};
use std::borrow::Cow;
use std::ops::Range;

pub use half::halves;
pub use looking::Looking;

/// Columns of `contacts`: in contact or not, force, the wall's nearest point, radius.
pub const COLUMNS: usize = 8;

/// Length of the global vector: force, torque, heat.
pub const FELT: usize = 7;

/// Forces of one wall.
pub struct WallOp {
    name: String,
    bit: u32,
    surface: Box<dyn Surface>,
    /// Contacts by law; one part for all grains where they have one law.
    parts: Vec<Part>,
    /// Generation of the rebuild for which the list of particles near the wall was made.
    generation: Option<u64>,
    /// The deal of rows to ranks for which it lists this rank's own particles, if such a list was made in
    /// this run.
    deal: Option<u64>,
    was_part: bool,
    /// Upper bound of the wall's displacement since then.
    travelled: f64,
    /// Positions of particles at that time, and their radii; empty where rebuilds cover their motion.
    anchors: Vec<(Vec3, f64)>,
    slot: SlotId,
    contacts: bool,
    /// Columns of local values.
    local: usize,
    center: [f64; 3],
    span: Span,
    /// The particle too deep in the wall: ID, depth as a fraction of its radius, step.
    deep: Option<(u32, f64, i64)>,
    warmth: Option<Warmth>,
    /// Data for plastic grains.
    plastic: Option<Plastic>,
    /// The period in which no particle can touch the wall.
    peace: Peace,
}

/// The contacts of one law.
struct Part {
    law: Granular,
    /// Whether each type of grains (from 1) has this law; all have where nothing stands.
    kinds: Option<Vec<bool>>,
    /// The type of the surfaces that have it; all have where nothing stands.
    on: Option<u16>,
    /// Key of the contact memory.
    key: Key<Contacts>,
    sweep: WallSweep,
    /// Contact memory before a setup that only evaluates forces.
    kept: Option<Contacts>,
}

impl Part {
    /// Those of a wall.
    fn all(common: &Common, kinds: &[u16], w: &World) -> Result<Vec<Self>> {
        let part = |(k, Ruled { law, kinds, surface }): (usize, Ruled)| {
            let key = Key::new(&memory_name(&common.id, k));
            Self { law, kinds, on: surface, key, sweep: WallSweep::default(), kept: None }
        };
        Ok(common.material.laws(w, kinds)?.into_iter().enumerate().map(part).collect())
    }
}

impl Part {
    /// Evaluates the contacts found, and books them; the memory goes back into the world.
    fn act(&mut self, w: &mut World, t: &Tick, mut memory: Contacts) {
        let p = &w.particles;
        // Particles of rigid bodies touch with the mass of their body.
        let masses = match self.sweep.touching().0 {
            [] => Cow::Borrowed(&p.mass[..]),
            _ => w.contact_masses(),
        };
        let [v, omega] = t.phase.motion(w);
        let grains = Spheres { x: &p.x, v, omega, radius: &p.radius, mass: &masses, tag: &p.tag };
        let step = Advance { dt: t.dt, history: !t.setup };
        self.sweep.act(&grains, &self.law, &mut memory, step);
        let asked = walls_report(&w.facts, t.step, t.setup, t.last);
        let springs = asked.then(|| self.sweep.springs(&grains, &self.law, &memory));
        let booked = w.facts.has(*WALL_TOUCHES);
        let touches = booked.then(|| self.sweep.touches(&grains, &self.law, &memory));
        if let Some(list) = springs {
            let report = ReportedSprings { step: t.step, list };
            w.facts.get_or_default(*WALL_SPRINGS).lists.insert(self.key.of(), report);
        }
        if let Some((all, touches)) = w.facts.get_mut(*WALL_TOUCHES).zip(touches) {
            all.insert(self.key.of(), touches);
        }
        give(w, self.key, self.kept.take().unwrap_or(memory));
    }
}

/// Name of the contact memory of part `k` of a wall.
pub fn memory_name(id: &str, k: usize) -> String {
    if k == 0 { id.to_string() } else { format!("{id}/{k}") }
}

/// Data for a wall that conducts heat.
struct Warmth {
    /// Its temperature.
    wall: Reading,
    /// Columns of particle temperatures and heat flows.
    temperature: Numbers,
    flow: Numbers,
}

impl Warmth {
    /// For a wall with a temperature.
    fn new(common: &Common, conducts: bool, cx: &mut dyn SealCx) -> Result<Option<Self>> {
        // Contacts that have their law from coefficients conduct no heat to a wall without a temperature; a law of the wall's own with heat
        // is refused without one.
        let Some((wall, _)) = &common.temperature else { return Ok(None) };
        if !conducts {
            return Ok(None);
        }
        let wall = cx.param(wall, Stage::PostForce, &When::Always)?;
        let columns = &cx.world().columns;
        let (Some(temperature), Some(flow)) = (columns.property(*TEMPERATURE), columns.property(*HEATFLOW))
        else {
            let text = "walls that conduct heat need particles with a temperature";
            return Err(Diagnostic::error(Code::INCOMPLETE, cx.span(), text)
                .help("add `fix ID all property/atom temperature heatflow` and `set group all temperature …`")
                .into());
        };
        Ok(Some(Self { wall, temperature, flow }))
    }
}

impl WallOp {
    /// The op before its first step.
    ///
    /// # Errors
    /// Anything that a wall with a temperature lacks.
    pub fn new(
        (style, local): (&str, usize),
        common: &Common,
        surface: Box<dyn Surface>,
        kinds: &[u16],
        cx: &mut dyn SealCx,
    ) -> Result<Self> {
        let parts = Part::all(common, kinds, cx.world())?;
        let conducts = parts.iter().any(|part| part.law.heat != Heat::None);
        let warmth = Warmth::new(common, conducts, cx)?;
        Ok(Self {
            name: format!("fix {} {style}", common.id),
            bit: common.group.bit(),
            surface,
            parts,
            generation: None,
            deal: None,
            was_part: false,
            travelled: 0.0,
            anchors: vec![],
            slot: cx.slot(&format!("f_{}", common.id)),
            contacts: common.contacts,
            local,
            center: common.center,
            span: cx.span(),
            deep: None,
            warmth,
            plastic: Plastic::of(&common.material.model, &common.id),
            peace: Peace::default(),
        })
    }

    /// Whether it is a wall for plastic grains.
    pub fn is_plastic(&self) -> bool {
        self.plastic.is_some()
    }

    /// Updates the list of particles near the wall, if particles or wall have moved too far since the last
    /// update.
    fn list(&mut self, w: &World, grains: &Spheres) {
        let (s, followed) = (&w.settings.neighbor, followed(w));
        let deal = w.narrow_share().map(|share| share.deal);
        let all = 0..w.n();
        let rows = w.narrow_share().map_or(std::slice::from_ref(&all), |share| &share.own);
        let fresh = (self.generation, self.deal) == (Some(w.rebuild.generation), deal);
        let near = self.travelled <= 0.5 * s.skin;
        if fresh && near && (followed || stayed(grains, rows, &self.anchors, s.skin)) {
            return;
        }
        // Half a skin for the wall, and one for the particles: one that has moved half a skin already may
        // move half a skin back, and one whose anchor is known a whole skin.
        let far = 1.5 * s.skin;
        let Self { surface, parts, bit, .. } = self;
        for Part { law, kinds, on, sweep, .. } in parts {
            let kinds = kinds.as_deref().map(|some| (&w.particles.kind[..], some));
            let which = Meeting { mask: &w.particles.mask, group: *bit, rows, kinds };
            surface.show(w, *on, &mut |wall| sweep.list(wall, grains, &which, law, far));
        }
        (self.generation, self.deal) = (Some(w.rebuild.generation), deal);
        self.was_part |= deal.is_some();
        self.travelled = 0.0;
        self.anchors.clear();
        if !followed {
            self.anchors.extend(grains.x.iter().copied().zip(grains.radius.iter().copied()));
        }
    }

    /// Moves the wall to its current position and takes its contact memory out of the world.
    fn place(&mut self, w: &mut World, t: &Tick) -> Result<Vec<Contacts>> {
        self.travelled += self.surface.place(w, t)?;
        Ok(self.take(w))
    }

    /// Takes the contact memory of the wall out of the world, part by part.
    fn take(&self, w: &mut World) -> Vec<Contacts> {
        self.parts.iter().map(|part| take(w, part.key)).collect()
    }

    /// Finds the contacts.
    fn meet(&mut self, w: &World, t: &Tick, memories: &mut [Contacts]) {
        let p = &w.particles;
        // Masses are needed for forces only.
        let grains =
            Spheres { x: &p.x, v: &p.v, omega: &p.omega, radius: &p.radius, mass: &p.mass, tag: &p.tag };
        self.list(w, &grains);
        let Self { surface, parts, .. } = self;
        for (Part { law, on, sweep, kept, .. }, memory) in parts.iter_mut().zip(memories) {
            // The setup only evaluates forces; LAMMPS nevertheless shortens the springs of sliding contacts.
            *kept = (t.setup && !w.settings.lammps()).then(|| memory.clone());
            match sweep.listed() {
                0 => sweep.leave(law, memory),
                _ => surface.show(w, *on, &mut |wall| sweep.meet(wall, &grains, law, memory)),
            }
        }
    }

    /// Before all forces: passes this wall's data to plastic grains.
    fn approach(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let Some(plastic) = &self.plastic else { return Ok(()) };
        // Grains expand before they meet the wall.
        plastic.begin(w, t);
        let mut memories = self.place(w, t)?;
        self.meet(w, t, &mut memories);
        // Plastic grains have one law.
        let Self { parts, plastic, .. } = self;
        for (part, memory) in parts.iter().zip(memories) {
            give(w, part.key, memory);
            if let Some(plastic) = plastic {
                plastic.gather(w, t, &part.sweep);
            }
        }
        Ok(())
    }

    /// Records the deepest particle when the contact law first becomes invalid.
    fn find_deep(&mut self, w: &World, t: &Tick) {
        // Plastic grains are made for deep contacts.
        if self.deep.is_some() || self.plastic.is_some() {
            return;
        }
        let p = &w.particles;
        let deep = contacts(&self.parts).map(|(touch, _)| {
            let i = touch.grain as usize;
            (p.tag[i], 1.0 - touch.near.distance / p.radius[i])
        });
        let deeper = |a: (u32, f64), b: (u32, f64)| if b.1 > a.1 { b } else { a };
        self.deep = deep.filter(|d| d.1 > DEEP).reduce(deeper).map(|(tag, part)| (tag, part, t.step));
    }

    /// Adds the heat flow between the wall and the particles; returns the heat the wall gains.
    fn conduct(&mut self, w: &mut World) -> f64 {
        let (Some(warmth), n) = (&self.warmth, w.n()) else { return 0.0 };
        let wall = warmth.wall.get(w);
        let mut flow = std::mem::take(w.columns.scalar(warmth.flow, n));
        let temperature = w.columns.scalar(warmth.temperature, n).clone();
        let p = &w.particles;
        let grains =
            Spheres { x: &p.x, v: &p.v, omega: &p.omega, radius: &p.radius, mass: &p.mass, tag: &p.tag };
        let conduct = |part: &mut Part| part.sweep.conduct(&grains, &part.law, wall, &temperature, &mut flow);
        let lost: f64 = self.parts.iter_mut().map(conduct).sum();
        *w.columns.scalar(warmth.flow, n) = flow;
        -lost
    }

    /// How far particles can move before one touches the wall [length]; at most a skin.
    fn room(&mut self, w: &World) -> f64 {
        let (p, skin) = (&w.particles, w.settings.neighbor.skin);
        let grains =
            Spheres { x: &p.x, v: &p.v, omega: &p.omega, radius: &p.radius, mass: &p.mass, tag: &p.tag };
        let Self { surface, parts, .. } = self;
        let mut least = skin;
        for Part { law, on, sweep, .. } in parts.iter_mut().filter(|part| part.sweep.listed() > 0) {
            surface.show(w, *on, &mut |wall| least = least.min(sweep.room(wall, &grains, law, skin)));
        }
        least
    }

    /// For a wall at rest without contacts, determines how long none can occur.
    fn look_ahead(&mut self, w: &World, t: &Tick) {
        let touched = contacts(&self.parts).next().is_some();
        let still = self.surface.stands() && self.local == 0 && self.plastic.is_none();
        // A rank knows contacts of its own particles only.
        if touched || !still || t.setup || !followed(w) || w.is_narrow() {
            return self.peace.end();
        }
        if self.peace.is_worth_a_look(t.step) {
            let room = self.room(w);
            self.peace.begin(t.step, Seen::measured(*w.travel, 0.0), room);
        }
    }

    fn publish(&mut self, w: &mut World, t: &Tick, felt: [f64; FELT]) {
        let n = w.n();
        let mut touching = vec![];
        if self.local > 0 || self.surface.shares() {
            touching.reserve(self.parts.iter().map(|part| part.sweep.touching().0.len()).sum());
            touching.extend(contacts(&self.parts));
        }
        let local = self.surface.local(w, &touching, t);
        self.surface.feel(w, &touching, felt, t);
        if w.is_narrow() {
            // Nothing reads sums over the particles of a single rank.
            let out = w.slots.get_mut(self.slot);
            out.step = Some(t.step);
            out.vector.clear();
            return out.vector.extend([f64::NAN; FELT]);
        }
        let (p, out) = (&w.particles, w.slots.get_mut(self.slot));
        out.step = Some(t.step);
        out.vector.clear();
        out.vector.extend(felt);
        (out.local, out.local_cols) = (local, self.local);
        if self.contacts {
            let cols = COLUMNS + usize::from(self.warmth.is_some());
            out.cols = cols;
            out.atom.clear();
            out.atom.resize(cols * n, 0.0);
            let heats = self
                .parts
                .iter()
                .flat_map(|part| (0..part.sweep.touching().0.len()).map(|k| part.sweep.heat(k)));
            for ((touch, wrench), heat) in contacts(&self.parts).zip(heats) {
                let i = touch.grain as usize;
                let point = sub(p.x[i], scale(touch.near.distance, touch.near.normal));
                let row = &mut out.atom[cols * i..][..cols];
                row[0] = 1.0;
                row[1..4].copy_from_slice(&wrench.force);
                row[4..7].copy_from_slice(&point);
                row[7] = p.radius[i];
                if let Some(place) = row.get_mut(COLUMNS) {
                    *place = heat;
                }
            }
        }
    }
}

/// The contacts of the last evaluation with their forces and torques.
fn contacts(parts: &[Part]) -> impl Iterator<Item = (&Touch, &Wrench)> {
    parts.iter().flat_map(|part| part.sweep.contacts())
}

/// Whether particles always stay within half a skin of their positions at the last rebuild.
fn followed(w: &World) -> bool {
    let s = &w.settings.neighbor;
    s.check && s.every == 1 && s.delay == 0 && !s.once
}

/// Whether no particle surface of these rows has moved more than `far` since.
fn stayed(grains: &Spheres, rows: &[Range<usize>], anchors: &[(Vec3, f64)], far: f64) -> bool {
    let grown = |k: usize| {
        let (from, radius) = anchors[k];
        length(sub(grains.x[k], from)) + grains.radius[k] - radius
    };
    let come = |rows: &Range<usize>| {
        let some = |range: Range<usize>| range.map(|k| grown(rows.start + k)).fold(0.0, f64::max);
        par::reduce(rows.len(), some, f64::max).unwrap_or(0.0)
    };
    anchors.len() == grains.x.len() && rows.iter().map(come).fold(0.0, f64::max) <= far
}

/// The deepest of the particles that the ranks recorded, the same on all ranks.
fn deepest_of_all(own: Option<(u32, f64, i64)>) -> Option<(u32, f64, i64)> {
    let all = rows::of_all(own.map(|(tag, part, step)| ([tag], [part, step as f64])));
    all.into_iter()
        .map(|([tag], [part, step])| (tag, part, step as i64))
        .min_by(|a, b| a.2.cmp(&b.2).then(b.1.total_cmp(&a.1)).then(a.0.cmp(&b.0)))
}

/// Takes the contact memory of a wall out of the world.
fn take(w: &mut World, key: Key<Contacts>) -> Contacts {
    w.wall_contacts.get_mut(key).map(std::mem::take).unwrap_or_default()
}

/// Puts it back.
fn give(w: &mut World, key: Key<Contacts>, memory: Contacts) {
    match w.wall_contacts.get_mut(key) {
        Some(place) => *place = memory,
        None => drop(w.wall_contacts.insert(key, memory)),
    }
}

impl Op for WallOp {
    fn about(&self) -> About {
        let needs = Needs::new()
            .read(
                BOX | X | V | OMEGA | RADIUS | MASS | MASK | field::COLUMNS | TAG | REGIONS | LISTS | TRAVEL,
            )
            .add(F | TORQUE)
            .write(WALL_CONTACTS | FACTS | SLOTS);
        let needs = match self.surface.shares() {
            true => needs.write(MEMO).keep(field::COLUMNS),
            false => needs.keep(MEMO | field::COLUMNS),
        };
        let by_kind = self.surface.shares() || self.parts.iter().any(|part| part.kinds.is_some());
        let needs = if by_kind { needs.read(KIND) } else { needs };
        About { collective: true, ..About::new(&self.name, Stage::PostForce, needs) }
    }

    fn span(&mut self, w: &mut World, t: &Tick) -> Rows {
        let facts = w.facts.past();
        let asked = facts.has(*WALL_TOUCHES) || walls_report(facts, t.step, t.setup, t.last);
        let asked = asked || self.surface.feels();
        match asked || t.setup || self.plastic.is_some() || self.warmth.is_some() {
            true => Rows::All,
            false => Rows::Own,
        }
    }

    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if t.unchanged {
            return Ok(());
        }
        let mut memories = match self.plastic {
            Some(_) => self.take(w),
            None => self.place(w, t)?,
        };
        if self.plastic.is_none() {
            self.meet(w, t, &mut memories);
        }
        let mut felt = [0.0; 6];
        for (k, (part, mut memory)) in self.parts.iter_mut().zip(memories).enumerate() {
            if let Some(plastic) = &mut self.plastic {
                plastic.press(w, t, &part.sweep, &mut memory);
            }
            part.act(w, t, memory);
            let p = &mut w.particles;
            let own = part.sweep.scatter(&mut p.f, &mut p.torque, &p.x, self.center);
            // A single part keeps the sign of a zero.
            felt = if k == 0 { own } else { std::array::from_fn(|d| felt[d] + own[d]) };
        }
        let [fx, fy, fz, tx, ty, tz] = felt;
        let heat = self.conduct(w);
        self.find_deep(w, t);
        self.publish(w, t, [fx, fy, fz, tx, ty, tz, heat]);
        self.look_ahead(w, t);
        Ok(())
    }

    fn way(&mut self, w: &mut World, t: &Tick, _room: &mut Room) -> Way {
        let rests = !t.setup
            && !t.unchanged
            && self.peace.lasts(*w.travel)
            && self.generation == Some(w.rebuild.generation)
            && !walls_always_report(&w.facts);
        if rests {
            w.slots.get_mut(self.slot).step = Some(t.step);
            debug_assert!(self.room(w) > 0.0, "{} rests and is touched", self.name);
        }
        if rests { Way::Rests } else { Way::Alone }
    }

    fn finish(&mut self, w: &mut World) -> Result<()> {
        if self.was_part && !w.dealings.apart {
            self.deep = deepest_of_all(self.deep);
        }
        if let Some((tag, part, step)) = self.deep.take() {
            let percent = 100.0 * part;
            let text = format!(
                "{}: particle {tag} is {percent:.0} % of its radius deep in the wall at step {step}: contact laws hold below \
                 10 %",
                self.name
            );
            w.notes.push(
                Diagnostic::warning(Code::SUSPICIOUS, self.span, text)
                    .help("look for particles that were created inside it, or take a stiffer wall and a shorter step")
                    .help("only the first step at which it is so is reported"),
            );
        }
        Ok(())
    }

    fn bytes(&self, _w: &World) -> u64 {
        // Positions and radii of those near the wall.
        self.parts.iter().map(|part| part.sweep.listed() as u64 * 36).sum()
    }
}
