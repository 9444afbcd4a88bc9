//! The op of fix insert that makes grains.

use super::clumps::{Inside, Placed};
use super::flight::Held;
use super::state::State;
use super::{Content, Inserting, Packet, Place, Way};
use crate::crowd::Crowd;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::body::{Quat, UNTURNED};
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::{Vec3, add, scale, sub};
use perigrain_output::log::Log;
use perigrain_plan::{About, Needs, Op, Span as Rows, Stage, Tick};
use perigrain_styles::matter::publish;
use perigrain_styles::newcomers::{Newcomer, admit, settle};
use perigrain_world::field::{MASS, RADIUS, X};
use perigrain_world::region::Near;
use perigrain_world::template::Numbering;
use perigrain_world::{Domain, Fields, Ingredient, Numbers, SlotId, World, memory};

/// The op.
pub struct Source {
    name: String,
    /// Key of its state in the world.
    key: Numbers,
    held: Numbers,
    fix: Inserting,
    every: Option<i64>,
    packet: Option<Packet>,
    span: Span,
    slot: SlotId,
    /// Grains of this run that found no place, and the first step at which this happened.
    failed: Option<(u64, i64)>,
    near: Vec<Near>,
}

/// A new grain; of a stream, where and how far from the face its centre passes it.
struct Grain {
    /// Its kind in the mixture.
    which: usize,
    x: Vec3,
    v: Vec3,
    turn: Quat,
    foot: (Vec3, f64),
}

/// Grains of one insertion, kind by kind.
#[derive(Default)]
struct Batch {
    grains: Vec<Grain>,
    mass: f64,
    missing: u64,
}

impl Source {
    /// Plans its insertions and prints the plan.
    ///
    /// # Errors
    /// Grains that exceed any memory, a log that cannot be written.
    pub fn new(
        fix: &Inserting,
        w: &mut World,
        (every, packet): (Option<i64>, Option<Packet>),
        (span, slot): (Span, SlotId),
        log: &Log,
    ) -> Result<Self> {
        let key = fix.key();
        let mut state = State::load(w, key).unwrap_or_else(|| State::new(fix.seed));
        let now = w.clock.step;
        let first = if state.begun { None } else { fix.start.filter(|step| *step > now) };
        let planned = match (state.begun, every) {
            (false, _) => Some(first.unwrap_or(now + 1)),
            (true, None) => None,
            // Steps may have been renumbered.
            (true, Some(every)) => {
                Some(state.next.filter(|n| (now + 1..=now + every).contains(n)).unwrap_or(now + 1))
            }
        };
        let left = fix.flow().and_then(|flow| flow.total).map(|total| total.saturating_sub(state.done));
        state.next = planned.filter(|_| left != Some(0));
        state.store(w, key);
        if let Some(step) = state.next {
            memory::forecast(w, fix.guess(w, every)).map_err(|e| e.at(span))?;
            log.line(&fix.plan(w.clock.dt, every, left, step))?;
        }
        let out = w.slots.get_mut(slot);
        out.scalar = state.done as f64;
        out.vector = vec![state.done as f64, state.mass];
        let name = format!("fix {} insert", fix.id);
        let (fix, near) = (fix.clone(), vec![]);
        Ok(Self { name, key, held: key.with("/held"), fix, every, packet, span, slot, failed: None, near })
    }

    /// How many grains this insertion makes.
    fn wanted(&self, w: &World, t: &Tick, state: &mut State) -> u64 {
        let fix = &self.fix;
        let exact = match (&fix.way, &fix.place) {
            (Way::Pack { content, .. }, Place::Region(place)) => {
                let there = Inside::of(place, &fix.mixture, w);
                match content {
                    Content::Number(n) => n - there.number,
                    Content::Mass(m) => (m - there.mass) / fix.mixture.mean_mass(),
                    Content::Share(f) => (f * place.volume - there.volume) / fix.mixture.mean_volume(),
                }
            }
            (Way::Rate { flow, .. } | Way::Stream { flow, .. }, _) => {
                flow.rate * self.every.unwrap_or(1) as f64 * t.dt
            }
            (Way::Pack { .. }, Place::Face(_)) => 0.0,
        };
        let left = fix.flow().and_then(|flow| flow.total).map_or(u64::MAX, |n| n.saturating_sub(state.done));
        // A product such as 1000 (1e-5 1000) may be rounded to a little less than a whole number.
        let exact = exact.max(0.0) * (1.0 + 1e-12);
        let part = exact.fract();
        let more = part > 1e-9 && state.stream.uniform() < part;
        (exact as u64).saturating_add(u64::from(more)).min(left)
    }

    /// The grains of this insertion.
    fn batch(&mut self, w: &World, n: u64, stream: &mut ParkMiller) -> Result<Batch> {
        let (fix, domain) = (&self.fix, w.domain()?);
        let mut crowd = fix.crowd(w, domain, self.packet, n);
        let (mut made, mut left) = (Batch::default(), n.saturating_mul(fix.tries));
        let counts = fix.mixture.counts(n, stream);
        let region = matches!(fix.place, Place::Region(_));
        for ((which, kind), count) in fix.mixture.kinds.iter().enumerate().zip(counts) {
            // Of this size none fits into the region, be it empty.
            let mut never = false;
            for _ in 0..count {
                let mut found = None;
                while left > 0 && found.is_none() && !never {
                    left -= 1;
                    let drawn = fix.draw(self.packet, kind.radius, stream, &mut self.near);
                    never = region && drawn.is_none();
                    let turn = if kind.clump.is_some() { fix.orientation.draw(stream) } else { UNTURNED };
                    let fits = |x: Vec3| kind.spheres(x, turn).iter().all(|(x, r)| crowd.fits(*x, *r));
                    let drawn = drawn.filter(|(x, _)| !fix.overlap || fits(*x));
                    found = drawn.map(|(x, foot)| (x, turn, foot));
                }
                let Some((x, turn, foot)) = found else {
                    made.missing += 1;
                    continue;
                };
                kind.spheres(x, turn).iter().for_each(|(x, r)| crowd.add(*x, *r));
                let v = fix.spread.draw(fix.mean, stream);
                made.grains.push(Grain { which, x, v, turn, foot });
                made.mass += kind.mass();
            }
        }
        Ok(made)
    }

    /// Puts the grains into the scene, kind by kind; those of a stream are held.
    fn admit(&self, w: &mut World, made: &Batch) -> Result<()> {
        let (first, tag) = (w.n(), w.particles.last_tag().saturating_add(1));
        let omega = self.fix.omega;
        let (mut held, mut bonds) = (vec![], false);
        for grains in made.grains.chunk_by(|a, b| a.which == b.which) {
            let kind = &self.fix.mixture.kinds[grains[0].which];
            match &kind.clump {
                Some(clump) => {
                    w.fall_back();
                    let mut numbers = Numbering::behind(w, 0);
                    for grain in grains {
                        let Grain { x, v, turn, .. } = *grain;
                        let placed = Placed { clump, places: clump.places(x, turn), x, turn, v, omega };
                        held.extend((0..clump.template.count).map(|k| {
                            let (foot, left) = grain.foot;
                            (add(foot, sub(placed.places[k], x)), left, placed.velocity(k))
                        }));
                        placed.admit(w, self.fix.group, &mut numbers)?;
                    }
                    bonds |= !clump.template.bonds.is_empty();
                    settle(w);
                }
                None => {
                    let start = w.n();
                    let size = Some([kind.radius, kind.density]);
                    let list =
                        grains.iter().map(|grain| Newcomer { kind: kind.kind, x: grain.x, v: grain.v, size });
                    let next = w.particles.last_tag().saturating_add(1);
                    admit(w, self.fix.group, next, &list.collect::<Vec<_>>())?;
                    w.particles.omega[start..].fill(omega);
                    held.extend(grains.iter().map(|grain| (grain.foot.0, grain.foot.1, grain.v)));
                }
            }
        }
        if bonds {
            w.bonds.find_special();
        }
        if let (Some(packet), Place::Face(face)) = (self.packet, &self.fix.place) {
            w.particles.v[first..].fill(scale(packet.speed, face.normal));
            w.particles.omega[first..].fill([0.0; 3]);
            let held = held.into_iter().zip(tag..);
            let held = held.map(|((foot, left, v), tag)| Held { tag, foot, left, v, omega });
            Held::add(w, self.held, tag, held);
        }
        Ok(())
    }
}

/// Spheres of a grain of this kind at a place.
trait Spheres {
    fn spheres(&self, x: Vec3, turn: Quat) -> Vec<(Vec3, f64)>;
}

impl Spheres for Ingredient {
    fn spheres(&self, x: Vec3, turn: Quat) -> Vec<(Vec3, f64)> {
        match &self.clump {
            Some(clump) => {
                clump.places(x, turn).into_iter().zip(clump.template.radii.iter().copied()).collect()
            }
            None => vec![(x, self.radius)],
        }
    }
}

impl Inserting {
    /// A place for a grain; of a stream, the point where it passes the face and how far that is.
    fn draw(
        &self,
        packet: Option<Packet>,
        radius: f64,
        stream: &mut ParkMiller,
        near: &mut Vec<Near>,
    ) -> Option<(Vec3, (Vec3, f64))> {
        let distance = if self.inside { radius } else { 0.0 };
        match (&self.place, packet) {
            (Place::Face(face), Some(packet)) => {
                let foot = face.draw(stream);
                let left = distance + stream.uniform() * (packet.length - 2.0 * distance);
                let fits = !self.inside || face.holds(foot, radius);
                fits.then(|| (add(foot, scale(-left, face.normal)), (foot, left)))
            }
            (Place::Face(_), None) => None,
            (Place::Region(place), _) => place.draw(distance, stream, near).map(|x| (x, (x, 0.0))),
        }
    }

    /// The grains that are near already.
    fn crowd<'a>(&self, w: &World, domain: &'a Domain, packet: Option<Packet>, n: u64) -> Crowd<'a> {
        let (lo, hi) = match &self.place {
            Place::Region(place) => (place.lo, place.hi),
            Place::Face(face) => face.bounds(packet.map_or(0.0, |packet| packet.length)),
        };
        let (p, own, largest) = (&w.particles, self.mixture.widest(), self.mixture.largest());
        let widest = if self.overlap { p.radius.iter().fold(largest, |a, r| r.max(a)) } else { largest };
        let mut crowd = Crowd::new(domain, lo, hi, largest + widest, p.len() + n as usize);
        if !self.overlap {
            return crowd;
        }
        let middle: Vec3 = std::array::from_fn(|d| 0.5 * (lo[d] + hi[d]));
        for (x, r) in p.x.iter().zip(&p.radius) {
            let off = domain.minimum_image(std::array::from_fn(|d| x[d] - middle[d]));
            if (0..3).all(|d| off[d].abs() <= 0.5 * (hi[d] - lo[d]) + own + r) {
                crowd.add(*x, *r);
            }
        }
        crowd
    }

    /// About how many grains the next insertion makes.
    fn guess(&self, w: &World, every: Option<i64>) -> f64 {
        let exact = match (&self.way, &self.place) {
            (Way::Pack { content: Content::Share(f), .. }, Place::Region(place)) => {
                f * place.volume / self.mixture.mean_volume()
            }
            (Way::Pack { content: Content::Number(n), .. }, _) => *n,
            (Way::Pack { content: Content::Mass(m), .. }, _) => m / self.mixture.mean_mass(),
            _ => self.flow().map_or(0.0, |flow| flow.rate * every.unwrap_or(1) as f64 * w.clock.dt),
        };
        exact * (1.0 + 1e-12)
    }

    /// The line of the log about what comes.
    fn plan(&self, dt: f64, every: Option<i64>, left: Option<u64>, step: i64) -> String {
        let (id, lots) = (&self.id, every.map_or(String::new(), |n| format!(", then every {n} steps")));
        match self.flow() {
            Some(flow) => {
                let each = perigrain_styles::common::about(flow.rate * every.unwrap_or(1) as f64 * dt);
                let left = left.map_or("without end".to_string(), |n| format!("{n} in all"));
                format!("Particle insertion {id}: {each} at step {step}{lots}, {left}")
            }
            None => format!("Particle insertion {id}: fills up its region at step {step}{lots}"),
        }
    }
}

impl Op for Source {
    fn about(&self) -> About {
        About::new(&self.name, Stage::Exchange, Needs::new().read(X | RADIUS | MASS).write(Fields::ALL))
    }
    fn span(&mut self, _: &mut World, _: &Tick) -> Rows {
        Rows::Requested
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if State::next(w, self.key) != Some(t.step) {
            return Ok(());
        }
        let Some(mut state) = State::load(w, self.key) else { return Ok(()) };
        w.whole(Fields::ALL);
        let n = self.wanted(w, t, &mut state);
        let made = self.batch(w, n, &mut state.stream)?;
        if !made.grains.is_empty() {
            self.admit(w, &made)?;
            w.rebuild.due = true;
        }
        state.done += made.grains.len() as u64;
        state.mass += made.mass;
        state.begun = true;
        let more = self.fix.flow().and_then(|flow| flow.total).is_none_or(|total| state.done < total);
        state.next = self.every.filter(|_| more).map(|every| t.step + every);
        state.store(w, self.key);
        if made.missing > 0 {
            let (before, step) = self.failed.unwrap_or((0, t.step));
            self.failed = Some((before + made.missing, step));
        }
        publish(w, self.slot, t, state.done as f64, &[state.done as f64, state.mass]);
        Ok(())
    }
    fn finish(&mut self, w: &mut World) -> Result<()> {
        let Some((count, step)) = self.failed.take() else { return Ok(()) };
        let total = self.fix.flow().and_then(|flow| flow.total);
        let done = State::load(w, self.key).map_or(0, |state| state.done);
        // Those that later insertions have made up for are there.
        if total.is_some_and(|total| done >= total) {
            return Ok(());
        }
        let text = format!(
            "fewer insertions than planned: {count} grains found no place in {} attempts each, from step {step} on",
            self.fix.tries
        );
        let d = Diagnostic::warning(Code::SUSPICIOUS, self.span, text);
        w.notes.push(match self.fix.way {
            Way::Pack { .. } => d.help("grains at random places fill little more than a third of a region: ask for fewer, or raise `tries`"),
            Way::Rate { .. } => d.help("see that grains leave the region sooner than new ones come, or raise `tries`"),
            Way::Stream { .. } => d.help("lower the rate, let the stream be faster or the face larger, or raise `tries`"),
        });
        Ok(())
    }
}
