//! fix deposit: inserts particles one by one.

mod words;

use super::{Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::rng::ParkMiller;
use perigrain_lang::{Args, ValueRef};
use perigrain_plan::{About, Needs, Op, Span as Rows, Stage, Tick, When};
use perigrain_styles::matter::publish;
use perigrain_styles::molecules::{self, Copy, Molecules};
use perigrain_styles::newcomers::{Account, Ids, Newcomer, admit};
use perigrain_styles::pair::ToCome;
use perigrain_styles::words::{Syntax, Words};
use perigrain_styles::{BuildCx, Doc, PlaceTest, SealCx, Shape, Style};
use perigrain_world::Fields;
use perigrain_world::field::X;
use perigrain_world::{GroupId, Key, Numbers, Region, SlotId, World};
use words::Line;

/// The style.
pub struct Deposit;

impl Style for Deposit {
    fn name(&self) -> &'static str {
        "deposit"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Puts a new particle or molecule into the scene every M steps, N in all.",
            text: "At the next step and every M steps a place is drawn in the region, uniform or with `gaussian` around \
                   a point. It is taken if no particle is too near and, with `var` and `set` as in `create_atoms`, if \
                   the variable is not zero there. The new particle is of LAMMPS' default size, for spheres diameter 1 \
                   and density 1, and belongs to `all` and the fix's group. In flat scenes above means along y, and z \
                   is 0 (LAMMPS, and `compat lammps`, leaves it where it was drawn).\n\n\
                   Molecules are put in about their geometric centre; `near` is the distance of each of their \
                   particles. `shake` is refused.\n\n\
                   Random numbers and their order are LAMMPS'. A second run continues where the first one ended, also \
                   after a restart. Steps whose particle found no place are made up for by later ones and warned about \
                   at the end of the run. Scalar (intensive): how many there are so far.",
            example: "region high block -0.002 0.002 -0.002 0.002 0.005 0.008 units box\n\
                      fix dep grains deposit 3 2 5 4711 region high vz -1 -1 near 0.0015 units box",
        }
    }
}

impl FixStyle for Deposit {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        words::build(args, cx).map(|fix| -> Box<dyn Fix> { Box::new(fix) })
    }
}

/// Vertical position of a new particle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Height {
    /// As drawn.
    Drawn,
    /// This far above all particles.
    Global([f64; 2]),
    /// This far above the particles within a lateral distance.
    Local([f64; 2], f64),
}

/// A declared fix deposit; distances in box units.
#[derive(Clone, Debug)]
struct Depositing {
    id: String,
    group: GroupId,
    count: u64,
    kind: u16,
    every: i64,
    seed: u32,
    region: Region,
    corners: ([f64; 3], [f64; 3]),
    ids: Ids,
    height: Height,
    near: f64,
    /// Centre and width.
    gaussian: Option<([f64; 3], f64)>,
    tries: i64,
    rate: f64,
    velocity: [[f64; 2]; 3],
    target: Option<[f64; 3]>,
    /// Molecules inserted instead of single particles.
    molecules: Option<Molecules>,
    /// The deciding variable, and the variables that receive the coordinates.
    test: Option<(ValueRef, [Option<ValueRef>; 3])>,
}

impl Depositing {
    fn key(&self) -> Numbers {
        Key::new(&format!("deposit/{}", self.id))
    }

    /// Draws a position in the region.
    fn draw(&self, stream: &mut ParkMiller) -> [f64; 3] {
        let (lo, hi) = self.corners;
        loop {
            let x = match self.gaussian {
                None => std::array::from_fn(|d| lo[d] + stream.uniform() * (hi[d] - lo[d])),
                Some((middle, sigma)) => middle.map(|m| m + stream.gaussian() * sigma),
            };
            if self.region.contains(x) {
                return x;
            }
        }
    }

    /// The height above the particles that count.
    fn above(&self, w: &World, x: [f64; 3], stream: &mut ParkMiller) -> Result<Option<f64>> {
        let ([lo, hi], delta) = match self.height {
            Height::Drawn => return Ok(None),
            Height::Global(by) => (by, f64::INFINITY),
            Height::Local(by, delta) => (by, delta),
        };
        let (domain, flat) = (w.domain()?, w.settings.two_dimensional);
        let up = if flat { 1 } else { 2 };
        let beside = |y: &&[f64; 3]| {
            let d = domain.minimum_image([x[0] - y[0], x[1] - y[1], 0.0]);
            let aside = if flat { d[0] * d[0] } else { d[0] * d[0] + d[1] * d[1] };
            delta.is_infinite() || aside <= delta * delta
        };
        let top = w.particles.x.iter().filter(beside).fold(domain.lo[up], |a, y| a.max(y[up]));
        Ok(Some(top + lo + stream.uniform() * (hi - lo)))
    }

    /// Whether no particle is nearer than `near`.
    fn free(&self, w: &World, x: [f64; 3]) -> Result<bool> {
        let domain = w.domain()?;
        Ok(!w.particles.x.iter().any(|y| {
            let d = domain.minimum_image(std::array::from_fn(|k| x[k] - y[k]));
            d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < self.near * self.near
        }))
    }

    /// A free position for a new particle or molecule, if one is found.
    fn find(
        &self,
        w: &World,
        offset: f64,
        account: &mut Account,
        test: &mut Option<PlaceTest>,
    ) -> Result<Option<([f64; 3], Option<Copy>)>> {
        let flat = w.settings.two_dimensional;
        let up = if flat { 1 } else { 2 };
        for _ in 0..self.tries {
            let mut x = self.draw(&mut account.stream);
            if flat && !w.settings.lammps() {
                // LAMMPS leaves them off the plane.
                x[2] = 0.0;
            }
            if let Some(test) = test
                && !test(w, x)?
            {
                continue;
            }
            x[up] += offset;
            if let Some(height) = self.above(w, x, &mut account.stream)? {
                x[up] = height;
            }
            let copy = self.molecules.as_ref().map(|m| m.draw(x, flat, &mut account.stream));
            let places = copy.as_ref().map_or(std::slice::from_ref(&x), |c| &c.places);
            let mut free = true;
            for x in places {
                free = free && self.free(w, *x)?;
            }
            if free {
                return Ok(Some((x, copy)));
            }
        }
        Ok(None)
    }

    fn velocity(&self, x: [f64; 3], stream: &mut ParkMiller) -> [f64; 3] {
        let v = self.velocity.map(|[lo, hi]| lo + stream.uniform() * (hi - lo));
        let Some(target) = self.target else { return v };
        let way: [f64; 3] = std::array::from_fn(|d| target[d] - x[d]);
        let square = |a: [f64; 3]| a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
        let (speed, distance) = (square(v).sqrt(), square(way));
        if distance > 0.0 { way.map(|a| a * (1.0 / distance).sqrt() * speed) } else { v }
    }

    /// Warns if new spheres may overlap others.
    fn check_distance(&self, w: &mut World, span: Span) {
        if !w.particles.style.sphere {
            return;
        }
        // Radius of LAMMPS' default sphere.
        let own = self.molecules.as_ref().map_or(0.5, Molecules::widest);
        let widest = w.particles.radius.iter().fold(own, |a, r| r.max(a));
        if self.near >= own + widest {
            return;
        }
        let text =
            format!("new spheres may overlap others: `near {}` is less than {}", self.near, own + widest);
        let d = Diagnostic::warning(Code::SUSPICIOUS, span, text);
        w.notes.push(d.help(format!("use `near {}` (box units)", own + widest)));
    }
}

impl Fix for Depositing {
    fn to_come(&self, w: &World) -> Vec<ToCome> {
        let mask = GroupId::ALL.bit() | self.group.bit();
        if let Some(molecules) = &self.molecules {
            return molecules.to_come(w, mask);
        }
        molecules::default_sphere(w, self.kind, mask).into_iter().collect()
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        Account::maker(w, self.seed).store(w, self.key());
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.key());
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        let test = match &self.test {
            Some((r, sets)) => Some(cx.test(r, sets, Stage::Exchange, &When::Always)?),
            None => None,
        };
        if let Some(molecules) = &self.molecules {
            molecules.check_rigid(cx)?;
        }
        let slot = cx.slot(&format!("f_{}", self.id));
        let w = cx.world();
        let Some(mut account) = Account::load(w, self.key()) else { return Ok(vec![]) };
        if account.next.is_none() && account.done == 0 {
            self.check_distance(w, span);
        }
        let now = w.clock.step;
        let planned = account.next.filter(|n| (now + 1..=now + self.every).contains(n));
        account.next = (account.done < self.count).then(|| planned.unwrap_or(now + 1));
        account.store(w, self.key());
        w.slots.get_mut(slot).scalar = account.done as f64;
        let name = format!("fix {} deposit", self.id);
        Ok(vec![Box::new(Drop { name, key: self.key(), fix: self.clone(), span, slot, test, failed: 0 })])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { makes_particles: true, ..Facts::default() }
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, ..Shape::default() }
    }
}

/// The op that inserts particles.
struct Drop {
    name: String,
    key: Numbers,
    fix: Depositing,
    span: Span,
    slot: SlotId,
    test: Option<PlaceTest>,
    /// Number of insertions in this run that found no free position.
    failed: u64,
}

impl Op for Drop {
    fn about(&self) -> About {
        About::new(&self.name, Stage::Exchange, Needs::new().read(X).write(Fields::ALL))
    }
    fn span(&mut self, _: &mut World, _: &Tick) -> Rows {
        Rows::Requested
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let (fix, key) = (&self.fix, self.key);
        let due = |a: &Account| a.next == Some(t.step);
        let Some(mut account) = Account::load(w, key).filter(due) else { return Ok(()) };
        w.whole(Fields::ALL);
        // LAMMPS counts the steps to the next insertion.
        let offset = (t.step + fix.every - account.start) as f64 * t.dt * fix.rate;
        match fix.find(w, offset, &mut account, &mut self.test)? {
            Some((x, copy)) => {
                let v = fix.velocity(x, &mut account.stream);
                let before = fix.ids.before(w, &account);
                account.last = match (&fix.molecules, copy) {
                    (Some(m), Some(copy)) => m.admit(w, fix.group, before, &[Copy { v, ..copy }])?,
                    _ => {
                        let tag = before[0] + 1;
                        admit(w, fix.group, tag, &[Newcomer { kind: fix.kind, x, v, size: None }])?;
                        [tag, before[1]]
                    }
                };
                account.done += 1;
            }
            None => self.failed += 1,
        }
        account.next = (account.done < fix.count).then_some(t.step + fix.every);
        account.store(w, key);
        w.rebuild.due = true;
        publish(w, self.slot, t, account.done as f64, &[]);
        Ok(())
    }
    fn finish(&mut self, w: &mut World) -> Result<()> {
        let steps = std::mem::take(&mut self.failed);
        // Later steps may have made up for the failures.
        let all_in = Account::load(w, self.key).is_some_and(|a| a.done >= self.fix.count);
        if steps > 0 && !all_in {
            let tries = self.fix.tries;
            let text = format!("at {steps} steps no place was found for a particle in {tries} attempts");
            w.notes.push(
                Diagnostic::warning(Code::SUSPICIOUS, self.span, text)
                    .help("allow more of them with `attempt`, lower `near`, or enlarge the region"),
            );
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
