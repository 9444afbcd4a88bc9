//! The op of fix pour: inserts batches of spheres in a falling stream.

use super::{Pouring, Sizes};
use crate::crowd::Crowd;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_output::log::Log;
use perigrain_plan::{About, Needs, Op, Span as Rows, Stage, Tick};
use perigrain_styles::matter::publish;
use perigrain_styles::molecules::{Copy, Molecules};
use perigrain_styles::newcomers::{Account, Newcomer, admit};
use perigrain_world::Fields;
use perigrain_world::field::{RADIUS, X};
use perigrain_world::{Numbers, SlotId, World, memory};

/// The op.
pub struct Rain {
    name: String,
    /// Key of its account in the world.
    key: Numbers,
    fix: Pouring,
    span: Span,
    slot: SlotId,
    /// Downward acceleration.
    gravity: f64,
    /// Spheres in a full batch.
    batch: u64,
    /// Steps between batches.
    every: i64,
    /// Spheres of this run's batches that found no free position, and the first step at which this happened.
    failed: Option<(u64, i64)>,
}

/// The insertions of one step: spheres or molecules.
#[derive(Default)]
struct Batch {
    spheres: Vec<Newcomer>,
    molecules: Vec<Copy>,
}

impl Batch {
    fn len(&self) -> u64 {
        (self.spheres.len() + self.molecules.len()) as u64
    }
}

impl Rain {
    /// Computes size and interval of the batches and prints them.
    pub fn new(
        fix: &Pouring,
        w: &mut World,
        gravity: f64,
        span: Span,
        slot: SlotId,
        log: &Log,
    ) -> Result<Self> {
        let flat = w.settings.two_dimensional;
        let held = |m: &Molecules| Sizes::One(m.extent()).space(flat);
        let one = fix.molecules.as_ref().map_or_else(|| fix.sizes.space(flat), held);
        let space = fix.volume.space(flat);
        let batch = (fix.fraction * space / one) as u64;
        if batch == 0 {
            let text = format!(
                "the insertion region takes no sphere: {} of its {space} is less than one sphere's {one}",
                fix.fraction
            );
            return Err(Diagnostic::error(Code::BAD_VALUE, span, text)
                .help("enlarge the region, raise the volume fraction of `vol`, or pour smaller spheres")
                .into());
        }
        let down = if flat { 1 } else { 2 };
        let (lo, hi) = fix.volume.corners();
        let relative = fix.fall - fix.rate;
        let time =
            (relative + (relative * relative + 2.0 * gravity * (hi[down] - lo[down])).sqrt()) / gravity;
        let every = ((time / w.clock.dt + 0.5) as i64).max(1);
        let key = fix.key();
        let mut account = Account::load(w, key).unwrap_or_else(|| Account::maker(w, fix.seed));
        let now = w.clock.step;
        let again = w.settings.lammps() && !w.clock.onward;
        let planned = account.next.filter(|n| (now + 1..=now + every).contains(n) && !again);
        let first = planned.unwrap_or(now + 1);
        account.next = (account.done < fix.count).then_some(first);
        account.store(w, key);
        if let Some(left) = fix.count.checked_sub(account.done).filter(|n| *n > 0) {
            // A batch of tiny spheres may exceed any memory.
            memory::forecast(w, batch.min(left) as f64).map_err(|e| e.at(span))?;
            let last = first + ((left - 1) / batch) as i64 * every;
            log.line(&format!("Particle insertion: {batch} every {every} steps, {left} by step {last}"))?;
        }
        w.slots.get_mut(slot).scalar = account.done as f64;
        let name = format!("fix {} pour", fix.id);
        Ok(Self { name, key, fix: fix.clone(), span, slot, gravity, batch, every, failed: None })
    }

    /// The spheres or molecules of one batch.
    fn batch(&self, w: &World, t: &Tick, account: &mut Account) -> Result<Batch> {
        let (fix, domain) = (&self.fix, w.domain()?);
        let flat = w.settings.two_dimensional;
        let down = if flat { 1 } else { 2 };
        let wanted = self.batch.min(fix.count - account.done);
        let (mut lo, mut hi) = fix.volume.corners();
        let risen = (t.step - account.start) as f64 * t.dt * fix.rate;
        (lo[down], hi[down]) = (lo[down] + risen, hi[down] + risen);
        let mut crowd = self.crowd(w, domain, lo, hi);
        let (mut made, mut left) = (Batch::default(), wanted.saturating_mul(fix.tries));
        let stream = &mut account.stream;
        let between = |[a, b]: [f64; 2], u: f64| a + u * (b - a);
        while made.len() < wanted {
            let deep = stream.uniform();
            let height = hi[down] - deep * deep * (hi[down] - lo[down]);
            let radius = if fix.molecules.is_none() { fix.sizes.sample(stream) } else { 0.0 };
            let mut place = None;
            while left > 0 && place.is_none() {
                left -= 1;
                let x = fix.volume.place(height, flat, stream);
                let copy = fix.molecules.as_ref().map(|m| m.draw(x, flat, stream));
                let spheres: Vec<([f64; 3], f64)> = match (&fix.molecules, &copy) {
                    (Some(m), Some(copy)) => copy.places.iter().copied().zip(m.radii(copy)).collect(),
                    _ => vec![(x, radius)],
                };
                if spheres.iter().all(|(x, r)| crowd.fits(*x, *r)) {
                    spheres.iter().for_each(|(x, r)| crowd.add(*x, *r));
                    place = Some((x, copy));
                }
            }
            let Some((x, copy)) = place else { break };
            // v = vz + g t and z = top + vz t + g t²/2 with t eliminated.
            let fallen = -(fix.fall * fix.fall - 2.0 * self.gravity * (x[down] - hi[down])).sqrt();
            let mut v = [between(fix.drift[0], stream.uniform()), fallen, 0.0];
            if !flat {
                v = [v[0], between(fix.drift[1], stream.uniform()), fallen];
            }
            if let Some(copy) = copy {
                made.molecules.push(Copy { v, ..copy });
                continue;
            }
            let density = between(fix.density, stream.uniform());
            made.spheres.push(Newcomer { kind: fix.kind, x, v, size: Some([radius, density]) });
        }
        Ok(made)
    }

    /// The particles already near the region.
    fn crowd<'a>(
        &self,
        w: &World,
        domain: &'a perigrain_world::Domain,
        lo: [f64; 3],
        hi: [f64; 3],
    ) -> Crowd<'a> {
        let own = match &self.fix.molecules {
            // Where the file gives no radii, extents are those of the centres.
            Some(m) => m.extent() + m.widest(),
            None => self.fix.sizes.largest(),
        };
        let p = &w.particles;
        let widest = p.radius.iter().fold(own, |a, r| r.max(a));
        let expected = p.len() + self.batch as usize;
        let mut crowd = Crowd::new(domain, lo, hi, own + widest, expected);
        let middle: [f64; 3] = std::array::from_fn(|d| 0.5 * (lo[d] + hi[d]));
        for (x, r) in p.x.iter().zip(&p.radius) {
            let off = domain.minimum_image(std::array::from_fn(|d| x[d] - middle[d]));
            if (0..3).all(|d| off[d].abs() <= 0.5 * (hi[d] - lo[d]) + own + r) {
                crowd.add(*x, *r);
            }
        }
        crowd
    }
}

impl Op for Rain {
    fn about(&self) -> About {
        About::new(&self.name, Stage::Exchange, Needs::new().read(X | RADIUS).write(Fields::ALL))
    }
    fn span(&mut self, _: &mut World, _: &Tick) -> Rows {
        Rows::Requested
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let Some(mut account) = Account::load(w, self.key).filter(|a| a.next == Some(t.step)) else {
            return Ok(());
        };
        w.whole(Fields::ALL);
        let wanted = self.batch.min(self.fix.count - account.done);
        let made = self.batch(w, t, &mut account)?;
        let before = self.fix.ids.before(w, &account);
        account.last = match &self.fix.molecules {
            Some(m) => m.admit(w, self.fix.group, before, &made.molecules)?,
            None => {
                admit(w, self.fix.group, before[0] + 1, &made.spheres)?;
                [before[0] + made.len() as u32, before[1]]
            }
        };
        account.done += made.len();
        account.next = (account.done < self.fix.count).then_some(t.step + self.every);
        account.store(w, self.key);
        let missing = wanted - made.len();
        if missing > 0 {
            let (before, step) = self.failed.unwrap_or((0, t.step));
            self.failed = Some((before + missing, step));
        }
        w.rebuild.due = true;
        publish(w, self.slot, t, account.done as f64, &[]);
        Ok(())
    }
    fn finish(&mut self, w: &mut World) -> Result<()> {
        let left = Account::load(w, self.key).map_or(0, |a| self.fix.count.saturating_sub(a.done));
        // Those that later batches have made up for are counted as inserted.
        let failed = self.failed.take().map(|(count, step)| (count.min(left), step));
        if let Some((count, step)) = failed.filter(|(count, _)| *count > 0) {
            let text =
                format!("fewer insertions than planned: {count} spheres found no place, from step {step} on");
            w.notes.push(
                Diagnostic::warning(Code::SUSPICIOUS, self.span, text)
                    .help("lower the volume fraction of `vol` (0.2 to 0.4 is usual), or allow more attempts")
                    .help("or see that what was poured before has left the region: a larger or higher one, a larger vz"),
            );
        }
        Ok(())
    }
}
