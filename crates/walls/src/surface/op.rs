//! The op of a surface: its position and velocity at each step, before walls lean on it.

use super::turns;
use crate::elapsed::Elapsed;
use crate::wall::servo::{self, Servo};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::vec3::{Vec3, add, cross, scale, sub};
use perigrain_plan::{Needs, Op, Stage, Tick, When};
use perigrain_styles::mesh_surface::{MeshSurface, Movement, Mover, SURFACES, SurfacePose};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::{Reading, SealCx};
use perigrain_world::field::{MEMO, RADIUS, SLOTS};
use perigrain_world::{Key, Numbers, SlotId, World};

/// The op of a surface.
///
/// # Errors
/// Missing variables.
pub fn ops(id: &str, servo: Option<&Servo>, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
    let Some(surface) = cx.world().facts.get(*SURFACES).and_then(|all| all.look_up(id)).cloned() else {
        return Ok(vec![]);
    };
    let mut names = surface.keys.names().to_vec();
    let mut movers = vec![];
    for mover in &surface.movers {
        names.extend(mover.names());
        let mut readings = vec![];
        for variable in mover.variables() {
            readings.push(cx.value(variable, Stage::PreForce, &When::Always)?);
        }
        movers.push(Moved { mover: mover.clone(), readings });
    }
    let wall: Numbers = Key::new(&format!("surface/{id}"));
    let servo = servo.map(|servo| servo.seal(wall, Stage::PreForce, cx)).transpose()?;
    if servo.is_some() {
        names.push(Servo::key(wall).text());
    }
    let slot = cx.slot(&format!("f_{id}"));
    let access = Needs::new().write(MEMO | SLOTS).only(&names);
    let access =
        if servo.as_ref().is_some_and(servo::Running::sees_radii) { access.read(RADIUS) } else { access };
    let running = Running { surface, movers, servo, slot };
    let op = StepOp::new(format!("fix {id} surface"), Stage::PreForce, access, move |w, t| running.run(w, t));
    Ok(vec![op.boxed()])
}

/// A mover during a run.
struct Moved {
    mover: Mover,
    readings: Vec<Reading>,
}

/// A surface during a run.
struct Running {
    surface: MeshSurface,
    movers: Vec<Moved>,
    servo: Option<servo::Running>,
    slot: SlotId,
}

/// What a mover does in a step: the way along its line or about its axis.
#[derive(Clone, Copy)]
enum Part {
    Shift(Vec3),
    Turn(Vec3, f64),
}

impl Running {
    fn run(&self, w: &mut World, t: &Tick) -> Result<()> {
        if t.unchanged {
            return Ok(());
        }
        let keys = self.surface.keys;
        let mut pose = SurfacePose::load(w, keys.pose);
        (pose.velocity, pose.omega) = ([0.0; 3], [0.0; 3]);
        match &self.servo {
            Some(servo) => self.steer(servo, &mut pose, w, t)?,
            None => self.follow(&mut pose, w, t)?,
        }
        pose.store(w, keys.pose);
        // Walls add what grains do at this step.
        w.memo.put(keys.load, [0.0; 6]);
        w.memo.put(keys.touched, []);
        let [x, y, z] = pose.at(self.surface.about);
        let out = w.slots.get_mut(self.slot);
        out.step = Some(t.step);
        out.vector.clear();
        out.vector.extend([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, x, y, z]);
        Ok(())
    }

    /// Moves by the servo, for the force of the step before.
    fn steer(&self, servo: &servo::Running, pose: &mut SurfacePose, w: &mut World, t: &Tick) -> Result<()> {
        if let (false, Some(&[fx, fy, fz, tx, ty, tz])) =
            (t.setup, w.memo.get(self.surface.keys.load).map(Vec::as_slice))
        {
            servo.feel(w, [fx, fy, fz], [tx, ty, tz]);
        }
        let [before, now] = servo.advance(w, t)?;
        let (axis, way) = (servo.servo.axis, now.way - before.way);
        match turns(&servo.servo) {
            true => {
                let com = servo.servo.com;
                pose.turn_about(com, axis, way);
                pose.omega = scale(now.speed, axis);
                pose.velocity = scale(-1.0, cross(pose.omega, com));
            }
            false => {
                pose.shift_by(scale(way, axis));
                pose.velocity = scale(now.speed, axis);
            }
        }
        Ok(())
    }

    /// Moves by the movers. A step is divided into halves, forwards and backwards through the movers: of second order
    /// where an axis carries a line, exact everywhere else.
    fn follow(&self, pose: &mut SurfacePose, w: &mut World, t: &Tick) -> Result<()> {
        let mut parts = vec![];
        let mut points: Vec<Vec3> = vec![];
        let mut rates = vec![];
        for moved in &self.movers {
            let (part, rate) = moved.step(w, t)?;
            parts.push(part);
            rates.push(rate);
            points.push(moved.point(w));
        }
        if !t.setup {
            match parts.len() {
                0 | 1 => (0..parts.len()).for_each(|k| apply(&parts, k, 1.0, pose, &mut points)),
                n => (0..n).chain((0..n).rev()).for_each(|k| apply(&parts, k, 0.5, pose, &mut points)),
            }
        }
        for ((moved, point), rate) in self.movers.iter().zip(&points).zip(rates) {
            w.memo.put(moved.mover.carried, *point);
            match rate {
                Part::Shift(v) => pose.velocity = add(pose.velocity, v),
                Part::Turn(axis, rate) => {
                    let omega = scale(rate, axis);
                    pose.omega = add(pose.omega, omega);
                    pose.velocity = sub(pose.velocity, cross(omega, *point));
                }
            }
        }
        Ok(())
    }
}

/// A part of mover `k` on the surface, and on the axes of later movers.
fn apply(parts: &[Part], k: usize, share: f64, pose: &mut SurfacePose, points: &mut [Vec3]) {
    let (own, later) = points.split_at_mut(k + 1);
    match parts[k] {
        Part::Shift(way) => {
            let way = scale(share, way);
            pose.shift_by(way);
            later.iter_mut().for_each(|point| *point = add(*point, way));
        }
        Part::Turn(axis, angle) => {
            pose.turn_about(own[k], axis, share * angle);
            for point in later {
                let mut there = SurfacePose { shift: *point, ..SurfacePose::default() };
                there.turn_about(own[k], axis, share * angle);
                *point = there.shift;
            }
        }
    }
}

impl Moved {
    /// The point of its axis at present.
    fn point(&self, w: &World) -> Vec3 {
        match w.memo.get(self.mover.carried).map(Vec::as_slice) {
            Some(&[x, y, z]) => [x, y, z],
            _ => self.mover.point,
        }
    }

    /// Its way in this step, and its rate at the end.
    fn step(&self, w: &mut World, t: &Tick) -> Result<(Part, Part)> {
        let mut elapsed = Elapsed::load(w, self.mover.elapsed);
        let before = elapsed.time();
        if !t.setup {
            elapsed.follow(t.step, t.dt);
            elapsed.store(w, self.mover.elapsed);
        }
        let now = elapsed.time();
        Ok(match &self.mover.movement {
            Movement::Line(along, course) => {
                let ([from, _], [to, rate]) = (course.at(before), course.at(now));
                (Part::Shift(scale(to - from, *along)), Part::Shift(scale(rate, *along)))
            }
            Movement::Turn(axis, course) => {
                let ([from, _], [to, rate]) = (course.at(before), course.at(now));
                (Part::Turn(*axis, to - from), Part::Turn(*axis, rate))
            }
            Movement::Velocity(_) => {
                let [was, is] = self.rates::<3>(w, t)?;
                let mean = scale(0.5 * t.dt, add(was, is));
                (Part::Shift(mean), Part::Shift(is))
            }
            Movement::Rate(axis, _) => {
                let [[was], [is]] = self.rates::<1>(w, t)?;
                (Part::Turn(*axis, 0.5 * t.dt * (was + is)), Part::Turn(*axis, is))
            }
        })
    }

    /// The values of its variables at the step before and now.
    fn rates<const N: usize>(&self, w: &mut World, t: &Tick) -> Result<[[f64; N]; 2]> {
        let now: [f64; N] = std::array::from_fn(|k| self.readings.get(k).map_or(0.0, |r| r.get(w)));
        if now.iter().any(|rate| !rate.is_finite()) {
            let text = format!("the velocity of fix {} has become {now:?} in step {}", self.mover.id, t.step);
            return fail(Code::NOT_FINITE, None, text);
        }
        let before = w.memo.get(self.mover.rates).and_then(|m| <[f64; N]>::try_from(&m[..]).ok());
        w.memo.put(self.mover.rates, now);
        Ok([before.unwrap_or(now), now])
    }
}
