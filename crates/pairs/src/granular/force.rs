//! The op of granular contacts: list when it is due, contacts, forces and torques.

mod lists;

use super::super::shared::{add_virial, find_frozen};
use super::heating::{Heating, conducts};
use super::mdr::Press;
use super::ranks::{DEEP, Deep};
use super::ranks::{agree_on_deep, contacts_of_all, virial_of_all};
use perigrain_base::diag::Result;
use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::sub;
use perigrain_contact::bodies::solids;
use perigrain_contact::driver::{Average, Curvature, Grains, Rules, Sweep};
use perigrain_contact::fast::{Fast, Laws, Sums};
use perigrain_contact::mdr::Manner;
use perigrain_contact::{Advance, Arm, MOST_MEMORY};
use perigrain_neigh::list::{Pair, Reach, Wanted};
use perigrain_plan::{About, Needs, Op, Span, Stage, Tick};
use perigrain_styles::ledger::{PAIR_WORK, WALL_TOUCHES};
use perigrain_world::Fields;
use perigrain_world::columns::{HEATFLOW, LEVEL_PATH, TEMPERATURE};
use perigrain_world::contacts::{Contacts, PairWork};
use perigrain_world::field::{
    BONDS, BOX, COLUMNS, CONTACTS, F, FACTS, FAMILIES, KIND, LISTS, MASK, MASS, MEMO, MOLECULE, OMEGA,
    RADIUS, TAG, TALLY, TORQUE, TRAVEL, V, X, X0,
};
use perigrain_world::{CONTACT_MASS, Constant, Key, World};
use std::borrow::Cow;
use std::ops::Range;

/// Forces and torques of all granular contacts of one pair style.
pub struct Force {
    rules: Rules,
    wanted: Wanted,
    /// Where contact history is kept in the world.
    key: Key<Contacts>,
    /// What the op is called.
    name: String,
    /// Whether fix freeze holds a particle; empty without one.
    frozen: Vec<bool>,
    /// Whether masses, radii and groups stay the same during steps.
    steady: bool,
    /// Masses where rigid bodies lend theirs.
    lent: Option<Vec<f64>>,
    /// The rebuild the lists were made at.
    generation: Option<u64>,
    /// The deal they were made for, where grains are shared out to ranks, and whether some in this run were those of one rank.
    deal: Option<u64>,
    was_part: bool,
    plain: Plain,
    /// The fast loop, where it knows all the rules.
    fast: Option<Fast>,
    /// Whether the fast loop has the contacts now.
    is_fast: bool,
    /// What presses plastic grains, which go by the plain loop.
    press: Option<Press>,
}

/// The plain loop: knows every rule.
#[derive(Default)]
struct Plain {
    list: Vec<Pair>,
    body: Vec<u32>,
    /// The roster at which the bodies were found.
    roster: Option<u64>,
    sweep: Sweep,
}

impl Force {
    /// With nothing computed yet.
    pub fn new(
        style: &'static str,
        rules: Rules,
        wanted: Wanted,
        types: usize,
        press: Option<Press>,
    ) -> Self {
        let fast = laws(&rules, &wanted, types).map(Fast::new);
        Self {
            rules,
            wanted,
            key: Key::new(style),
            name: format!("pair {style}"),
            frozen: vec![],
            steady: false,
            lent: None,
            generation: None,
            deal: None,
            was_part: false,
            plain: Plain::default(),
            fast,
            is_fast: false,
            press,
        }
    }

    /// The solid each particle belongs to, where some rule needs it.
    fn find_bodies(&mut self, w: &World) {
        self.plain.body.clear();
        let asked = self.rules.needs_bodies();
        if let (true, Some(families)) = (asked, &*w.families) {
            self.plain.body = solids(families, w.n());
        }
    }

    /// Contacts by the fast loop; `anew`: masses may not be those of the step before.
    fn run_fast(&mut self, w: &mut World, t: &Tick, period: Periods, store: bool, anew: bool) -> Result<()> {
        let Some(fast) = &mut self.fast else { return Ok(()) };
        w.contacts.remove(self.key);
        let step = Advance { dt: t.dt, history: !t.setup };
        let p = &mut w.particles;
        let (mut f, mut torque) = (std::mem::take(&mut p.f), std::mem::take(&mut p.torque));
        let mut heat = Heating::take(w, &self.rules);
        let mut deeds = begin_pair_work(w, t, self.key, &self.rules);
        let before = deeds.as_ref().map(|_| torque.to_vec());
        let (mass, [v, omega]) = (masses(&self.lent, w), t.phase.motion(w));
        let grains = Grains { mass, v, omega, ..grains(w, period, &[], &self.frozen)? };
        if anew {
            fast.weigh(&grains);
        }
        let heating = heat.as_mut().map(|heat| (&heat.temperature[..], &mut heat.flow[..]));
        let work =
            deeds.as_mut().map(|all| [&mut all.damping[..], &mut all.across[..], &mut all.pressing[..]]);
        let sums = Sums { force: &mut f, torque: &mut torque, heat: heating, deeds: work };
        let virial = fast.run(&grains, sums, step, store, t.virial);
        let shared = fast.is_part();
        let deep = fast.deep;
        (w.particles.f, w.particles.torque) = (f, torque);
        if let Some((mut all, before)) = deeds.zip(before) {
            let rows = all.torque.iter_mut().zip(&*w.particles.torque).zip(&before);
            rows.for_each(|((own, now), before)| *own = sub(*now, *before));
            all.held = fast.held();
            keep_pair_work(w, self.key, all);
        }
        if let Some(heat) = heat {
            heat.give(w);
        }
        if t.virial {
            add_virial(w, if shared { virial_of_all(fast) } else { virial });
        }
        if t.contacts {
            w.contacts.insert(self.key, if shared { contacts_of_all(fast) } else { fast.contacts() });
        }
        report(w, t, deep);
        if shared {
            w.act_narrowly();
        }
        Ok(())
    }

    /// As [`Force::run_fast`], tile by tile: `ready` hears which grains have all their forces. `false`, with nothing done, where more
    /// than forces is read, or tiles do not come one by one.
    fn run_per_tile(
        &mut self,
        w: &mut World,
        t: &Tick,
        (period, store, anew): (Periods, bool, bool),
        ready: &mut dyn FnMut(&mut World, Range<usize>),
    ) -> Result<bool> {
        let plain = !t.virial && !t.contacts && !conducts(&self.rules) && !w.facts.has(*PAIR_WORK);
        let alone = self.lent.is_none();
        let fast = self.fast.as_mut().filter(|fast| self.is_fast && plain && alone && fast.is_per_tile());
        let Some(fast) = fast else { return Ok(false) };
        let seen = grains(w, period, &[], &self.frozen)?;
        if anew {
            fast.weigh(&seen);
        }
        let step = Advance { dt: t.dt, history: !t.setup };
        let mut per_tile = fast.begin_per_tile(&seen, step, store);
        w.contacts.remove(self.key);
        loop {
            let p = &mut w.particles;
            let (mut f, mut torque) = (std::mem::take(&mut p.f), std::mem::take(&mut p.torque));
            let seen = grains(w, period, &[], &self.frozen)?;
            let more = fast.advance(&mut per_tile, &seen, [&mut f, &mut torque]);
            (w.particles.f, w.particles.torque) = (f, torque);
            if !more {
                break;
            }
            (0..).map_while(|part| fast.ready(part)).for_each(|particles| ready(w, particles));
        }
        let (deep, shared) = (fast.deep, fast.is_part());
        report(w, t, deep);
        if shared {
            w.act_narrowly();
        }
        Ok(true)
    }

    /// The preparation of contacts: lists where they are due; the box, whether contacts keep history, and whether masses may have
    /// changed.
    fn prepare(&mut self, w: &mut World, t: &Tick) -> Result<(Periods, bool, bool)> {
        // A run that continues an unchanged scene has no setup; added or removed particles shift the others.
        self.bring_up_to_date(w);
        if t.setup || self.generation.is_none() || self.plain.roster != Some(w.rebuild.roster) {
            self.plain.roster = Some(w.rebuild.roster);
            self.find_bodies(w);
        }
        let stale = self.is_fast && self.fast.as_ref().is_some_and(|f| f.len() != w.n());
        let renewed =
            stale || self.generation != Some(w.rebuild.generation) || self.deal != self.wanted_deal(w);
        if w.facts.has(*TILES) {
            self.fast.iter_mut().for_each(Fast::time_tiles);
        }
        if renewed {
            self.renew(w)?;
            if self.wanted_deal(w).is_some() && !self.is_part() {
                w.whole(F | TORQUE);
            }
        }
        // In setup forces are only evaluated; LAMMPS yet shortens the springs of contacts that slide, but not of plastic grains.
        let store = !t.setup || (w.settings.lammps() && self.press.is_none());
        let anew = renewed || t.setup || !self.steady;
        if anew {
            find_frozen(w, &mut self.frozen);
            // Particles join bodies where lists are made anew.
            self.lent = match w.contact_masses() {
                Cow::Owned(masses) => Some(masses),
                Cow::Borrowed(_) => None,
            };
        }
        Ok((w.periods(), store, anew))
    }

    /// All contacts.
    fn act(&mut self, w: &mut World, t: &Tick, (period, store, anew): (Periods, bool, bool)) -> Result<()> {
        match self.is_fast {
            true => self.run_fast(w, t, period, store, anew),
            false => self.run_plain(w, t, period, store),
        }
    }

    fn run_plain(&mut self, w: &mut World, t: &Tick, period: Periods, store: bool) -> Result<()> {
        let mut memory = w.contacts.remove(self.key).unwrap_or_default();
        let kept: Option<Contacts> = (!store).then(|| memory.clone());
        let manner =
            Manner { lammps: w.settings.lammps(), setup: t.setup, booked: w.facts.has(*WALL_TOUCHES) };
        let deeds = begin_pair_work(w, t, self.key, &self.rules);
        let (plain, press) = (&mut self.plain, &mut self.press);
        let (mass, [v, omega]) = (masses(&self.lent, w), t.phase.motion(w));
        let grains = Grains { mass, v, omega, ..grains(w, period, &plain.body, &self.frozen)? };
        let step = Advance { dt: t.dt, history: !t.setup };
        plain.sweep.meet(&plain.list, &grains, &self.rules, &mut memory);
        if let Some(press) = press {
            press.act(&grains, &plain.sweep, &mut memory, manner);
        }
        plain.sweep.act(&grains, &self.rules, &mut memory, step);
        let booked = deeds.map(|mut all| {
            plain.sweep.book(&grains, &self.rules, &memory, &mut all);
            all
        });
        // Plastic grains are made for deep contacts.
        let deep = if press.is_none() { plain.sweep.deep(&grains) } else { None };
        let kept = match press {
            Some(press) => {
                press.check(w, &plain.sweep, t)?;
                press.end(w);
                kept.map(|before| press.with_results(before, &memory))
            }
            None => kept,
        };
        if let Some(mut heat) = Heating::take(w, &self.rules) {
            plain.sweep.conduct(&heat.temperature, &mut heat.flow);
            heat.give(w);
        }
        report(w, t, deep);
        if let Some(all) = booked {
            keep_pair_work(w, self.key, all);
        }
        plain.sweep.scatter(&mut w.particles.f, &mut w.particles.torque);
        if t.virial {
            let part = plain.sweep.virial(&w.particles.x, &period);
            add_virial(w, part);
        }
        w.contacts.insert(self.key, kept.unwrap_or(memory));
        Ok(())
    }
}

impl Op for Force {
    fn about(&self) -> About {
        let needs = if self.press.is_some() {
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
                        | MASK
                        | MOLECULE
                        | FAMILIES
                        | BONDS,
                )
                .add(F | TORQUE)
                .write(CONTACTS | TALLY | RADIUS | FACTS)
                .keep(COLUMNS | MEMO)
        } else {
            Needs::new()
                .keep(COLUMNS)
                .read(
                    X | V
                        | OMEGA
                        | RADIUS
                        | MASS
                        | KIND
                        | BOX
                        | COLUMNS
                        | LISTS
                        | TAG
                        | TRAVEL
                        | MASK
                        | MOLECULE
                        | FAMILIES
                        | X0
                        | BONDS,
                )
                .add(F | TORQUE)
                .write(FACTS | CONTACTS | TALLY)
                .only(&[CONTACT_MASS.text(), TEMPERATURE.text(), HEATFLOW.text(), LEVEL_PATH.text()])
        };
        About::new(&self.name, Stage::Force, needs)
    }

    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if let Some(press) = &mut self.press {
            // Grains grow before lists are made.
            press.begin(w, t);
        }
        let how = self.prepare(w, t)?;
        self.act(w, t, how)?;
        self.note_work(w);
        Ok(())
    }

    fn run_streaming(
        &mut self,
        w: &mut World,
        t: &Tick,
        ready: &mut dyn FnMut(&mut World, Range<usize>),
    ) -> Result<bool> {
        if self.fast.is_none() {
            return self.run(w, t).map(|()| false);
        }
        let how = self.prepare(w, t)?;
        let streamed = self.run_per_tile(w, t, how, ready)?;
        if !streamed {
            self.act(w, t, how)?;
        }
        self.note_work(w);
        Ok(streamed)
    }

    fn span(&mut self, w: &mut World, t: &Tick) -> Span {
        if self.wanted_deal(w).is_some() {
            return Span::Requested;
        }
        let asked = t.virial || t.atom_virial || t.contacts || w.facts.past().has(*PAIR_WORK);
        let plain = !asked && !t.setup && self.press.is_none() && !conducts(&self.rules);
        let listed = self.generation == Some(w.rebuild.past().generation);
        if !plain || !listed || w.grains_dealt().is_some() {
            return Span::All;
        }
        w.list_rows((self.key.of(), w.rebuild.past().generation), || self.rows());
        Span::Listed
    }

    fn settle(&mut self, changed: Fields) {
        // Added or removed particles rebuild lists, and everything is read again.
        self.steady = !changed.has(MASS | MASK | RADIUS);
    }

    fn finish(&mut self, w: &mut World) -> Result<()> {
        if let Some(lines) = w.facts.get_mut(*TILES)
            && let Some(line) = self.fast.as_ref().and_then(Fast::describe_tiles)
        {
            lines.push(format!("{}: {line}", self.name));
        }
        if self.was_part && !w.dealings.apart {
            agree_on_deep(w);
        }
        self.hand_over(w);
        self.generation = None;
        Ok(())
    }

    fn bytes(&self, w: &World) -> u64 {
        if let Some(fast) = self.fast.as_ref().filter(|_| self.is_fast) {
            // Short lists with history; per grain what contacts read and write, and positions once more.
            return (fast.pairs()[1] * 44 + w.n() * 250) as u64;
        }
        // Pairs read with both ends (12 + 2 × 32 bytes); per contact both ends' state, wrench and history.
        let contact = if self.press.is_some() { 900 } else { 400 };
        (self.plain.list.len() * 76 + self.plain.sweep.len() * contact) as u64
    }
}

/// The laws in the form of the fast loop; `None` where some rule does not fit it.
fn laws(rules: &Rules, wanted: &Wanted, types: usize) -> Option<Laws> {
    let plain = rules.any(|r| {
        r.law.is_precomputed()
            || r.average != Average::None
            || r.curvature != Curvature::Both
            || r.law.arm == Arm::Point
            || r.law.memory() > MOST_MEMORY
    });
    let touch = |a, b| wanted.get(a, b).is_none_or(|r| r == Reach::Touch);
    let all = 1..=types as u16;
    if plain || !all.clone().all(|a| all.clone().all(|b| touch(a, b))) {
        return None;
    }
    Laws::new(types, |a, b| rules.get(a, b).map(|r| r.law))
}

/// Masses in contacts.
fn masses<'a>(lent: &'a Option<Vec<f64>>, w: &'a World) -> &'a [f64] {
    lent.as_deref().unwrap_or(&w.particles.mass)
}

/// What contacts see of the particles.
pub fn grains<'a>(w: &'a World, period: Periods, body: &'a [u32], frozen: &'a [bool]) -> Result<Grains<'a>> {
    let p = &w.particles;
    Ok(Grains {
        x: &p.x,
        v: &p.v,
        omega: &p.omega,
        radius: &p.radius,
        mass: &p.mass,
        kind: &p.kind,
        tag: &p.tag,
        period,
        flow: w.domain()?.flow.map(|flow| (flow, &p.mask[..])),
        body,
        frozen,
        travel: *w.travel,
    })
}

/// Where a plan is measured: a line for each pair style that keeps the times of its tiles, as the last run left them.
pub static TILES: Constant<Vec<String>> = Constant::new("granular/tiles");

/// Room for what contacts report to the ledger of energy, where there is one.
fn begin_pair_work(w: &mut World, t: &Tick, key: Key<Contacts>, rules: &Rules) -> Option<PairWork> {
    // Opening a memory that does not exist writes it.
    w.facts.get(*PAIR_WORK)?;
    let n = w.n();
    let all = w.facts.get_mut(*PAIR_WORK)?;
    let mut own = std::mem::take(all.get_or(key.of(), PairWork::default));
    own.begin(n, t.step, rules.any(|r| r.law.flows()));
    Some(own)
}

/// Books what they reported in the ledger.
fn keep_pair_work(w: &mut World, key: Key<Contacts>, own: PairWork) {
    if let Some(all) = w.facts.get_mut(*PAIR_WORK) {
        all.insert(key.of(), own);
    }
}

/// Keeps the first grains that were seen too deep in each other.
fn report(w: &mut World, t: &Tick, deep: Option<([u32; 2], f64)>) {
    if let (Some((ids, part)), None) = (deep, w.facts.get(*DEEP)) {
        w.facts.insert(*DEEP, Deep { step: t.step, ids, part, warned: false });
    }
}
