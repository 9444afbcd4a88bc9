//! fix move: prescribed motion of particles.

use super::elapsed::Elapsed;
use super::lineforce::direction;
use super::nve::half_step;
use super::path::{Path, Readings};
use super::{AtRest, Facts, Fix, FixStyle, Moves, lying};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::body::Quat;
use perigrain_base::math::vec3::{add, sub};
use perigrain_base::par;
use perigrain_lang::{Args, Param, ValueRef};
use perigrain_plan::{Needs, Op, Stage, Tick, When};
use perigrain_styles::matter::{Masses, check_masses, keep_places, unwrapped};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Kind, Nullable, PerAtom, Syntax, Units, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BOX, COLUMNS, F, KIND, MASK, MASS, MEMO, OMEGA, SLOTS, TYPE_MASS, V, X};
use perigrain_world::{Fields, Grip, GroupId, Numbers, Registration, SlotId, Under, Vectors, World};
use std::f64::consts::PI;

/// Where particles began their path.
static STARTS: Registration = Registration::moved("move/", "", Under::Anchor);
/// How particles lay then, which [`Grip`] keeps, and their dipole moments.
static TURNS: Registration = Registration::moved("move/", "/turn", Under::Nothing);
static MOMENTS: Registration = Registration::moved("move/", "/turn/moment", Under::Nothing);

/// The style.
pub struct Move;

impl Style for Move {
    fn name(&self) -> &'static str {
        "move"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Moves particles on a prescribed path, whatever the forces on them.",
            text: "t is the time since the fix was declared and x0 the position then (unwrapped). Where a component is \
                   `NULL` (for `variable`: both) it is integrated as by fix nve. It moves the particles itself: they \
                   belong to no other integrator. Particles that join the group later move on from where they are. \
                   Orientations (`bpm/sphere`) turn with `rotate` and `transrot` alone. Per-atom array: x0, 3 columns.\n\n\
                   `timestep`, `fix dt/reset` and reset_timestep do not disturb the path. LAMMPS refuses the first two \
                   beside fix move; after reset_timestep it takes the new steps since the declaration's old one, which \
                   makes the particles jump, and so does perigrain under `-compat lammps`.",
            example: "fix grip top move linear 0.0 0.0 3.0 units box",
        }
    }
    fn registrations(&self) -> &'static [&'static Registration] {
        const { &[&TURNS, &MOMENTS, &STARTS] }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "motion")]
    motion: Motion,
    /// V, A and P are in these units; variables are not scaled.
    #[word(keyword)]
    units: Units,
}

/// The motion of the particles.
#[derive(Words)]
#[word(what = "motion")]
#[allow(clippy::large_enum_variant)] // there is one at a time, while a line is read
enum Motion {
    /// x = x0 + V t, v = V.
    Linear(#[word(name = "Vx Vy Vz", what = "{}")] [Nullable<f64>; 3]),
    /// x = x0 + A sin ω t, v = A ω cos ω t with ω = 2π/period.
    Wiggle {
        #[word(name = "Ax Ay Az", what = "{}")]
        amplitude: [Nullable<f64>; 3],
        #[word(positive, what = "the period")]
        period: f64,
    },
    /// The particles turn about the axis R through P, right-handed; spheres get the angular velocity ω.
    Rotate(Turn),
    /// `rotate` about an axis that flies at V.
    Transrot(#[word(name = "Vx Vy Vz", what = "{}")] [f64; 3], Turn),
    /// Displacements from x0 and velocities by equal- or atom-style variables; without a displacement the velocity moves the
    /// particle, without a velocity the velocity stays.
    Variable {
        #[word(name = "v_dx v_dy v_dz", what = "the variable {}")]
        displacement: [Nullable<Named>; 3],
        #[word(name = "v_vx v_vy v_vz", what = "the variable {}")]
        velocity: [Nullable<Named>; 3],
    },
}

/// A turn about an axis.
#[derive(Words)]
struct Turn {
    #[word(name = "Px Py Pz", what = "{}")]
    point: [f64; 3],
    #[word(name = "Rx Ry Rz", with = direction, kind = Kind::Number)]
    axis: [f64; 3],
    #[word(positive, what = "the period")]
    period: f64,
}

/// A variable with one value, or one for each particle.
struct Named(ValueRef);

impl Value for Named {
    const KIND: Kind = Kind::Reference;
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let span = args.here();
        match PerAtom::value(what, args, cx)?.0 {
            Param::Ref(r) => Ok(Self(r)),
            Param::Number(_) => fail(Code::WRONG_KIND, span, format!("{what} is written v_name, or NULL")),
        }
    }
}

impl FixStyle for Move {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { motion, units } = read(args, cx)?;
        let scale = units.scales(cx.world);
        let scaled = |a: [f64; 3]| std::array::from_fn(|d| a[d] * scale[d]);
        let some = |a: [Nullable<f64>; 3]| std::array::from_fn(|d| a[d].0.map(|a| a * scale[d]));
        let turn = |turn: Turn, velocity| {
            let (point, axis, omega) = (scaled(turn.point), turn.axis, 2.0 * PI / turn.period);
            Path::Turn { point, axis, omega, velocity }
        };
        let path = match motion {
            Motion::Linear(v) => Path::Linear(some(v)),
            Motion::Wiggle { amplitude, period } => Path::Wiggle(some(amplitude), 2.0 * PI / period),
            Motion::Rotate(about) => turn(about, [0.0; 3]),
            Motion::Transrot(velocity, about) => turn(about, scaled(velocity)),
            Motion::Variable { displacement, velocity } => {
                let names =
                    [displacement, velocity].map(|three| three.map(|name| name.0.map(|named| named.0)));
                Path::Variables(Box::new(names))
            }
        };
        let key: Numbers = STARTS.key(&format!("move/{}", cx.id));
        let turn = Grip::new(&format!("{key}/turn"));
        Ok(Box::new(Declared { id: cx.id.to_string(), key, turn, group: cx.group, path }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    key: Numbers,
    /// Orientations at the start.
    turn: Grip,
    group: GroupId,
    path: Path,
}

impl Declared {
    /// Stores the initial positions and orientations of particles that joined the group since the last call.
    fn capture(&self, w: &mut World) {
        let (key, bit) = (self.key, self.group.bit());
        let now = Elapsed::load(w, key).time();
        keep_places(w, key.of(), self.group, |w, i| self.path.start(unwrapped(w, i), now));
        let Some(turned) = self.turned(w, now) else { return };
        let new = |i: &usize| w.particles.mask[*i] & bit != 0 && !self.turn.holds(w, *i);
        let new: Vec<usize> = (0..w.n()).filter(new).collect();
        new.into_iter().for_each(|i| self.turn.take(w, i, turned));
    }

    /// The rotation by the path at time `t`, if it rotates particles that have orientations or dipole
    /// moments.
    fn turned(&self, w: &World, t: f64) -> Option<Quat> {
        self.path.turn(t).filter(|_| w.particles.style.turns())
    }
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        Elapsed::load(w, self.key).store(w, self.key);
        self.capture(w);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.key);
        w.columns.remove(self.key);
        self.turn.drop(w);
    }

    fn particles_joined(&self, w: &mut World) {
        self.capture(w);
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (group, path, key, span, me) = (self.group, self.path.clone(), self.key, cx.span(), self.clone());
        let free = path.given().map(|g| !g);
        if free.contains(&true) {
            check_masses(cx.world(), span)?;
        }
        self.capture(cx.world());
        let mut readings = Readings::default();
        for (readings, params) in readings.iter_mut().zip(path.params()) {
            for (reading, param) in readings.iter_mut().zip(params) {
                *reading = match param {
                    Some(p) => Some(cx.param(&p, Stage::InitialIntegrate, &When::Always)?),
                    None => None,
                };
            }
        }
        let slot = cx.slot(&format!("f_{}", self.id));
        let name = format!("fix {} move", self.id);
        let lie = self.turned(cx.world(), 0.0).map_or(Fields::NONE, |_| lying(cx.world()));
        let access = Needs::new()
            .read(F | MASS | MASK | BOX | COLUMNS | SLOTS | TYPE_MASS | KIND)
            .write(X | V | OMEGA | SLOTS | lie)
            .keep(MEMO)
            .only(&[key.text()])
            .only(&me.turn.names());
        let first = StepOp::new(name.clone(), Stage::InitialIntegrate, access, move |w, t| {
            if t.setup {
                show_starts(w, key.of(), slot, t);
            } else {
                let time = advance(w, group, &path, &readings, key, t);
                if let Some(turned) = me.turned(w, time) {
                    // LAMMPS leaves dipole moments unchanged.
                    let moments = !w.settings.lammps();
                    me.turn.turn(&mut w.particles, &w.columns, moments, |_| Some(turned));
                }
            }
            Ok(())
        });
        let mut ops = vec![first.in_setup(true).one_by_one().boxed()];
        if free.contains(&true) {
            let access = Needs::new().read(F | MASS | MASK | TYPE_MASS | KIND).write(V);
            let second = StepOp::new(name, Stage::FinalIntegrate, access, move |w, t| {
                kick(w, group, free, t.dt);
                Ok(())
            });
            ops.push(second.one_by_one().boxed());
        }
        Ok(ops)
    }

    fn shape(&self) -> Shape {
        Shape { atom: Some(3), ..Shape::default() }
    }

    fn facts(&self, w: &World) -> Facts {
        let free = self.path.given().contains(&false);
        let needs_whole_steps = (free && !w.settings.lammps()).then_some(
            "its free components would feel the forces of the outermost level alone, as they do in LAMMPS",
        );
        let moves = match (self.path.spin(), free) {
            (Some(_), _) => Moves::Turns,
            (None, true) => Moves::Freely,
            (None, false) => Moves::Prescribed,
        };
        let at_rest = match moves {
            Moves::Turns => AtRest::Refused,
            _ => AtRest::Leads { components: self.path.given(), rest: free },
        };
        Facts { moves, needs_whole_steps, at_rest, ..Facts::default() }
    }
}

/// Offers the initial positions as per-atom values.
fn show_starts(w: &mut World, key: Vectors, slot: SlotId, t: &Tick) {
    let out = w.slots.get_mut(slot);
    (out.step, out.cols) = (Some(t.step), 3);
    out.atom.clear();
    out.atom.extend(w.columns.get_vector(key).unwrap_or_default().as_flattened());
}

/// Sets the path's positions and velocities at this step; kicks and drifts the free components. Returns the
/// time.
fn advance(w: &mut World, group: GroupId, path: &Path, readings: &Readings, key: Numbers, t: &Tick) -> f64 {
    let mut elapsed = Elapsed::load(w, key);
    elapsed.follow(t.step, t.dt);
    elapsed.store(w, key);
    let lammps = (t.step as f64 - elapsed.origin) * t.dt;
    let time = if w.settings.lammps() { lammps } else { elapsed.time() };
    let (bit, half) = (group.bit(), half_step(w, t.dt));
    let periods = w.periods();
    let (lengths, tilted) = (periods.length, periods.tilted());
    if w.columns.get_vector(key.of()).is_none() {
        return time;
    }
    let (mut places, mut velocities) =
        (std::mem::take(&mut w.particles.x), std::mem::take(&mut w.particles.v));
    let world = &*w;
    let (start, masses) = (world.columns.get_vector(key.of()).unwrap_or_default(), Masses::of(world));
    let columns =
        (&mut places[..], &mut velocities[..], &world.particles.f[..], &world.particles.mask[..], start);
    par::each(columns, |first, (x, v, f, mask, start)| {
        for k in world.moved_in(first..first + mask.len()).flatten().map(|row| row - first) {
            let (x, v, f, start) = (&mut x[k], &mut v[k], &f[k], &start[k]);
            if mask[k] & bit == 0 {
                continue;
            }
            let given = path.at(world, first + k, *start, time, readings);
            let old = *x;
            for d in 0..3 {
                let before = x[d];
                match (given.x[d], given.v[d]) {
                    (Some(place), speed) => (x[d], v[d]) = (place, speed.unwrap_or(v[d])),
                    (None, Some(speed)) => {
                        v[d] = speed;
                        x[d] += t.dt * speed;
                    }
                    (None, None) => {
                        v[d] += half / masses.get(first + k) * f[d];
                        x[d] += t.dt * v[d];
                    }
                }
                if lengths[d] > 0.0 && !tilted {
                    // The image nearest to the previous position: wrapping happens at the next
                    // reneighbouring.
                    x[d] -= lengths[d] * ((x[d] - before) / lengths[d]).round();
                }
            }
            if tilted {
                *x = add(old, periods.nearest(sub(*x, old)));
            }
        }
    });
    (w.particles.x, w.particles.v) = (places, velocities);
    if let Some(spin) = path.spin().filter(|_| w.particles.style.sphere) {
        let p = &mut w.particles;
        for (omega, _) in p.omega.iter_mut().zip(&p.mask).filter(|(_, m)| **m & bit != 0) {
            *omega = spin;
        }
    }
    time
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
    use perigrain_styles::testing::Bench;
    use perigrain_world::{AtomStyle, Compat, Lattice};

    fn scene() -> Bench {
        let mut b = Bench::new(AtomStyle::default(), &[[1.0, 2.0, 3.0]]);
        b.world.clock.dt = 0.5;
        b.world.clock.step = 10;
        b.world.lattice = Lattice::none(2.0);
        b
    }

    /// Declares the fix and runs the first half of one step.
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
        b.world.settings.compat = Compat::Lammps2025;
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
        assert!(b.world.columns.names().is_empty() && b.world.memo.is_empty());
    }

    #[test]
    fn mistakes_are_named() {
        let b = scene();
        for words in [
            "",
            "linear 1 2",
            "rotate 0 0 0 0 0 0 5",
            "rotate 0 0 0 0 0 1",
            "transrot 1 0 0 0 0 0 1 5",
            "variable v_no NULL NULL NULL NULL NULL",
            "variable 1 NULL NULL NULL NULL NULL",
            "wiggle 1 1 1",
            "wiggle 1 1 1 0",
            "linear 1 1 1 unit box",
            "liner 1 1 1",
        ] {
            assert!(b.fix(&Move, words).is_err(), "{words}");
        }
    }
}
