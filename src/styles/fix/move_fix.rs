//! fix move: prescribed motion of particles, straight or swinging.

use super::nve::half_step;
use super::{Fix, FixStyle};
use crate::diag::Result;
use crate::lang::Args;
use crate::par;
use crate::plan::{Access, Op, Stage, Tick};
use crate::styles::command::common::{choice_or_refuse, scales, units_lattice};
use crate::styles::matter::{Masses, check_masses, unwrapped};
use crate::styles::step_op::StepOp;
use crate::styles::{BuildCx, Doc, SealCx, Shape, Style};
use crate::world::{GroupId, SlotId, World};

/// The style.
pub struct Move;

impl Style for Move {
    fn name(&self) -> &'static str {
        "move"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "fix ID group move linear Vx Vy Vz | wiggle Ax Ay Az period [units lattice|box]",
            summary: "Moves particles on a prescribed path, whatever the forces on them.",
            text: "With t the time since the fix was declared and x0 the position then (unwrapped): `linear` is \
                   x = x0 + V t, v = V; `wiggle` is x = x0 + A sin ω t, v = A ω cos ω t with ω = 2π/period. Where a \
                   component is `NULL` it is integrated as by fix nve. V and A are in lattice spacings unless `units \
                   box`. It moves the particles itself: they belong to no other integrator. Particles that join the \
                   group later move on from where they are. Per-atom array: x0, 3 columns. `timestep`, \
                   `fix dt/reset` and reset_timestep do not disturb the path. LAMMPS refuses the first two beside fix move; after \
                   reset_timestep it takes the new steps since the declaration's old one, which makes the particles \
                   jump, and so does perigrain under `-compat lammps`. The motions `rotate`, `variable` and `transrot` \
                   are refused.",
            example: "fix grip top move linear 0.0 0.0 3.0 units box",
        }
    }
}

/// The path; components without a value are integrated.
#[derive(Clone, Copy, Debug)]
enum Path {
    /// Velocity.
    Linear([Option<f64>; 3]),
    /// Amplitude and angular frequency 2π/period.
    Wiggle([Option<f64>; 3], f64),
}

impl Path {
    fn given(&self) -> [bool; 3] {
        match self {
            Path::Linear(a) | Path::Wiggle(a, _) => a.map(|a| a.is_some()),
        }
    }

    /// Displacement and velocity at time `t` of the components that are given.
    fn at(&self, t: f64) -> [Option<(f64, f64)>; 3] {
        match *self {
            Path::Linear(v) => v.map(|v| v.map(|v| (v * t, v))),
            Path::Wiggle(a, omega) => {
                let (sin, cos) = (omega * t).sin_cos();
                a.map(|a| a.map(|a| (a * sin, a * omega * cos)))
            }
        }
    }
}

impl FixStyle for Move {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let other = ["rotate", "variable", "transrot"];
        let linear = choice_or_refuse(args, "motion", &["linear", "wiggle"], &other)? == "linear";
        let mut vector = [None; 3];
        for (component, axis) in vector.iter_mut().zip(["x", "y", "z"]) {
            if !args.eat("NULL") {
                *component = Some(args.number(&format!("the {axis} component"))?);
            }
        }
        let period = if linear { 1.0 } else { args.positive("the period")? };
        let mut lattice = true;
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "units" => lattice = units_lattice(args)?,
                _ => return Err(args.unknown(word, &["units"])),
            }
        }
        let scale = scales(cx.world, lattice);
        let vector = std::array::from_fn(|d| vector[d].map(|a: f64| a * scale[d]));
        let path = if linear {
            Path::Linear(vector)
        } else {
            Path::Wiggle(vector, 2.0 * std::f64::consts::PI / period)
        };
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, path }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    path: Path,
}

/// How much time has passed since the declaration, also where the time step changes or steps are renumbered.
#[derive(Clone, Copy)]
struct Elapsed {
    /// Step of the declaration.
    origin: f64,
    /// Time up to `step`.
    time: f64,
    /// Since which step `dt` holds.
    step: f64,
    /// The present time step.
    dt: f64,
    /// The latest step.
    last: f64,
}

impl Elapsed {
    fn load(w: &World, key: &str) -> Self {
        match w.memo.get(key).map(Vec::as_slice) {
            Some(&[origin, time, step, dt, last]) => Self { origin, time, step, dt, last },
            _ => {
                let step = w.clock.step as f64;
                Self { origin: step, time: 0.0, step, dt: w.clock.dt, last: step }
            }
        }
    }

    fn store(self, w: &mut World, key: &str) {
        let Self { origin, time, step, dt, last } = self;
        match w.memo.get_mut(key) {
            Some(memo) => memo.copy_from_slice(&[origin, time, step, dt, last]),
            None => drop(w.memo.insert(key.to_string(), vec![origin, time, step, dt, last])),
        }
    }

    /// The time at the latest step.
    fn now(&self) -> f64 {
        self.time + (self.last - self.step) * self.dt
    }

    /// Goes on to `step` by one time step `dt`.
    fn follow(&mut self, step: i64, dt: f64) {
        let before = (step - 1) as f64;
        self.step += before - self.last;
        self.last = before;
        if dt != self.dt {
            *self = Self { time: self.now(), step: before, dt, ..*self };
        }
        self.last = step as f64;
    }
}

impl Declared {
    fn key(&self) -> String {
        format!("move/{}", self.id)
    }

    /// Remembers where particles of the group that are not known yet would have started.
    fn capture(&self, w: &mut World) {
        let (key, n, bit) = (self.key(), w.n(), self.group.bit());
        let path = self.path.at(Elapsed::load(w, &key).now());
        w.columns.vector(&key, n);
        let mut known = std::mem::take(w.columns.scalar(&key, n));
        for (i, known) in known.iter_mut().enumerate() {
            if *known != 0.0 || w.particles.mask[i] & bit == 0 {
                continue;
            }
            *known = 1.0;
            let x = unwrapped(w, i);
            let start = std::array::from_fn(|d| path[d].map_or(x[d], |(way, _)| x[d] - way));
            w.columns.vector(&key, n)[i] = start;
        }
        *w.columns.scalar(&key, n) = known;
    }
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        Elapsed::load(w, &self.key()).store(w, &self.key());
        self.capture(w);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(&self.key());
        w.columns.remove(&self.key());
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (group, path, key, span) = (self.group, self.path, self.key(), cx.span());
        let free = path.given().map(|g| !g);
        if free.contains(&true) {
            check_masses(cx.world(), span)?;
        }
        self.capture(cx.world());
        let slot = cx.slot(&format!("f_{}", self.id));
        let name = format!("fix {} move", self.id);
        let access = Access::new("f mass mask", "x v");
        let first = StepOp::new(name.clone(), Stage::InitialIntegrate, access, move |w, t| {
            if t.setup {
                show_starts(w, &key, slot, t);
            } else {
                advance(w, group, &path, &key, t);
            }
            Ok(())
        });
        let mut ops = vec![first.in_setup(true).boxed()];
        if free.contains(&true) {
            let access = Access::new("f mass mask", "v");
            let second = StepOp::new(name, Stage::FinalIntegrate, access, move |w, t| {
                kick(w, group, free, t.dt);
                Ok(())
            });
            ops.push(second.boxed());
        }
        Ok(ops)
    }

    fn shape(&self) -> Shape {
        Shape { atom: Some(3), ..Shape::default() }
    }

    fn integrates(&self) -> bool {
        true
    }

    fn boxed(&self) -> Box<dyn Fix> {
        Box::new(self.clone())
    }
}

/// Offers the starting positions as per-atom values.
fn show_starts(w: &mut World, key: &str, slot: SlotId, t: &Tick) {
    let out = w.slots.get_mut(slot);
    (out.step, out.cols) = (Some(t.step), 3);
    out.atom.clear();
    out.atom.extend(w.columns.get_vector(key).unwrap_or_default().as_flattened());
}

/// The path's positions and velocities at this step; free components kicked and drifted.
fn advance(w: &mut World, group: GroupId, path: &Path, key: &str, t: &Tick) {
    let mut elapsed = Elapsed::load(w, key);
    elapsed.follow(t.step, t.dt);
    elapsed.store(w, key);
    let lammps = (t.step as f64 - elapsed.origin) * t.dt;
    let time = if w.settings.lammps() { lammps } else { elapsed.now() };
    let (at, bit, half) = (path.at(time), group.bit(), half_step(w, t.dt));
    let (domain, periodic) = (&w.domain, w.domain.as_ref().map_or([false; 3], |d| d.periodic()));
    let lengths = domain.as_ref().map_or([0.0; 3], |d| d.lengths());
    let Some(start) = w.columns.get_vector(key) else { return };
    let p = &mut w.particles;
    let masses = Masses::new(p.style, &p.mass, &p.kind, &w.type_mass);
    let columns = (&mut p.x[..], &mut p.v[..], &p.f[..], &p.mask[..], start);
    par::each(columns, |first, (x, v, f, mask, start)| {
        for (k, ((((x, v), f), mask), start)) in x.iter_mut().zip(v).zip(f).zip(mask).zip(start).enumerate() {
            if mask & bit == 0 {
                continue;
            }
            for d in 0..3 {
                let before = x[d];
                match at[d] {
                    Some((way, speed)) => (x[d], v[d]) = (start[d] + way, speed),
                    None => {
                        v[d] += half / masses.get(first + k) * f[d];
                        x[d] += t.dt * v[d];
                    }
                }
                if periodic[d] {
                    // The image nearest to where it was: wrapping is left to the next reneighbouring.
                    x[d] -= lengths[d] * ((x[d] - before) / lengths[d]).round();
                }
            }
        }
    });
}

/// Second half kick of the free components.
fn kick(w: &mut World, group: GroupId, free: [bool; 3], dt: f64) {
    let (half, bit) = (half_step(w, dt), group.bit());
    let p = &mut w.particles;
    let masses = Masses::new(p.style, &p.mass, &p.kind, &w.type_mass);
    par::each((&mut p.v[..], &p.f[..], &p.mask[..]), |first, (v, f, mask)| {
        for (k, ((v, f), mask)) in v.iter_mut().zip(f).zip(mask).enumerate() {
            if mask & bit != 0 {
                let by = half / masses.get(first + k);
                (0..3).filter(|&d| free[d]).for_each(|d| v[d] += by * f[d]);
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::styles::testing::Bench;
    use crate::world::{AtomStyle, Compat, Lattice};

    fn scene() -> Bench {
        let mut b = Bench::new(AtomStyle::default(), &[[1.0, 2.0, 3.0]]);
        b.world.clock.dt = 0.5;
        b.world.clock.step = 10;
        b.world.lattice = Lattice::none(2.0);
        b
    }

    /// Declares the fix and makes one step.
    fn begin(b: &mut Bench, words: &str) -> Vec<Box<dyn Op>> {
        let fix = b.fix(&Move, words).unwrap();
        fix.declare(&mut b.world).unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        step(b, &mut ops);
        ops
    }

    fn step(b: &mut Bench, ops: &mut [Box<dyn Op>]) {
        b.world.clock.step += 1;
        b.stage(ops, Stage::InitialIntegrate).unwrap();
        b.stage(ops, Stage::FinalIntegrate).unwrap();
    }

    // m = 2, f = 8, dt = 0.5: half kicks of 1, by hand.
    #[test]
    fn linear_with_a_free_component() {
        let mut b = scene();
        b.world.particles.f[0] = [8.0; 3];
        let mut ops = begin(&mut b, "linear 1 NULL -3 units box");
        assert_eq!(b.world.particles.x[0], [1.5, 2.5, 1.5]);
        assert_eq!(b.world.particles.v[0], [1.0, 2.0, -3.0]);
        step(&mut b, &mut ops);
        assert_eq!(b.world.particles.x[0], [2.0, 4.0, 0.0]);
    }

    #[test]
    fn wiggle_in_lattice_spacings() {
        let mut b = scene();
        begin(&mut b, "wiggle 1 0 NULL 2");
        // A quarter period: sin = 1, cos = 6e-17.
        let p = &b.world.particles;
        assert_eq!(p.x[0], [3.0, 2.0, 3.0]);
        assert!(p.v[0][0].abs() < 1e-15);
    }

    #[test]
    fn across_a_periodic_face_the_image_is_kept() {
        let mut b = scene();
        b.world.particles.image[0] = [1, 0, 0]; // unwrapped x = 21
        let mut ops = begin(&mut b, "linear 10 0 0 units box");
        assert_eq!(b.world.particles.x[0][0], 6.0);
        step(&mut b, &mut ops);
        assert_eq!(b.world.particles.x[0][0], 11.0); // not wrapped before reneighbouring
    }

    #[test]
    fn new_time_steps_and_numbers_do_not_jump() {
        let mut b = scene();
        let mut ops = begin(&mut b, "linear 1 0 0 units box");
        b.world.clock.set_dt(0.25);
        step(&mut b, &mut ops);
        assert_eq!(b.world.particles.x[0][0], 1.75); // 1 + 0.5 + 0.25
        b.world.clock.reset(0);
        step(&mut b, &mut ops);
        assert_eq!(b.world.particles.x[0][0], 2.0);
        b.world.settings.compat = Compat::Lammps;
        step(&mut b, &mut ops);
        assert_eq!(b.world.particles.x[0][0], -1.0); // 1 + (2 − 10) · 0.25, as LAMMPS has it
    }

    #[test]
    fn latecomers_move_on_from_where_they_are() {
        let mut b = scene();
        let fix = b.fix(&Move, "linear 1 0 0 units box").unwrap();
        begin(&mut b, "linear 1 0 0 units box");
        b.world.particles.push(2, 1, [5.0; 3]);
        b.world.columns.resize(2);
        let mut ops = b.seal(&*fix).unwrap();
        step(&mut b, &mut ops);
        assert_eq!(b.world.particles.x[1][0], 5.5);
        assert_eq!(b.world.particles.x[0][0], 2.0);
        fix.remove(&mut b.world);
        assert!(b.world.columns.get_vector("move/f").is_none() && b.world.memo.is_empty());
    }

    #[test]
    fn mistakes_are_named() {
        let b = scene();
        for words in [
            "",
            "linear 1 2",
            "rotate 0 0 0 0 0 1 5",
            "wiggle 1 1 1",
            "wiggle 1 1 1 0",
            "linear 1 1 1 unit box",
            "liner 1 1 1",
        ] {
            assert!(b.fix(&Move, words).is_err(), "{words}");
        }
    }
}
