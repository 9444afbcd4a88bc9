//! fix wall/gran: planes normal to an axis, or a cylinder, as walls for grains.

mod places;

use super::planes::{Followed, Pair};
use super::servo::{self, Servo, Steered};
use super::words::{self, Material, Rest};
use super::{Common, Declared, Form, Surface, needs_spheres, not_across_periodic, op};
use crate::elapsed::Elapsed;
use crate::{Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_contact::Wrench;
use perigrain_contact::walls::{Cylinder, Planes, Touch, Tube, Wall};
use perigrain_lang::Args;
use perigrain_plan::{Stage, Tick};
use perigrain_styles::words::{At, Each, Form as Behind, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::region::{INFINITE, Region, Shape};
use perigrain_world::{Face, Key, Numbers, Outline, World};
use places::{Moving, Named, Standing};
use std::f64::consts::PI;

/// The style.
pub struct WallGran;

impl Style for WallGran {
    fn name(&self) -> &'static str {
        "wall/gran"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(const { &[Behind::behind(Line::GRAMMAR), servo::MODIFIED] }),
            summary: "Flat walls across an axis, or a cylinder, on which grains lean.",
            text: "Grains feel a wall as a grain of infinite mass, with the force style's law: overlap δ = R − r with r \
                   the distance of the centre, m̄ = m, R̄ = R on a plane, 1/R̄ = 1/R − 1/(2 R_c) inside a cylinder and \
                   + outside. With two planes a grain that is larger than the gap feels both (LAMMPS, and perigrain \
                   under `-compat lammps`: only the nearer one). Places are in box units; the box may not be periodic \
                   across a wall.\n\n\
                   A plane whose place is a variable stands where its value says in each step, for a piston that moves \
                   as it likes. Its velocity, which damping and friction see, is the change since the step before over \
                   the time step, none in the first step; each of two planes has its own. `shear` and `wiggle` in the \
                   plane come on top; `wiggle` across it is refused. A lower plane that does not stay below the upper \
                   one ends the run. LAMMPS has this since July 2026.\n\n\
                   LAMMPS 22Jul2025 has faults that perigrain has under `-compat lammps` alone: springs of \
                   `hooke/history`, `hertz/history` and the `…_classic` models on walls depend on the contact radius \
                   and lose it when they slide (until 2026); a cylinder with `shear x` or `y` also flies along that \
                   axis; sticky grains hold on to hollow walls and regions no longer than they touch.\n\n\
                   `servo` moves the wall along its `axis` so that it presses on grains with a wanted force, as \
                   described for `fix surface`; two planes move together. Not in LAMMPS, as are cylinders off the \
                   axis.\n\n\
                   Not in LAMMPS: the global vector is the force on the wall (1–3), the torque on it (4–6) about the \
                   origin or the point `about`, and the heat that flows into it (7). Only grains near the wall are \
                   looked at, so that a wall far from most costs nothing. The particle deepest in the wall when one is \
                   first pressed in by more than a tenth of its radius is reported after the run.\n\n\
                   Springs of sliding contacts are kept in restart files; a run cut in two has the bits of one.",
            example: "fix floor grains wall/gran granular hertz/material 5.0e7 0.7 0.3 damping tsuji tangential mindlin \
                      NULL 1.0 0.5 zplane -0.002 NULL",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "force", with = force, kind = words::FORCE)]
    force: Material,
    #[word(name = "wall")]
    wall: At<Named>,
    #[word(flatten)]
    motions: Each<Moving>,
    #[word(keyword, once, placed)]
    servo: Option<At<servo::Line>>,
    #[word(flatten)]
    rest: Rest,
}

/// The words that begin what stands behind the force.
const WALLS: [&str; 7] = ["xplane", "yplane", "zplane", "xcylinder", "ycylinder", "zcylinder", "region"];

fn force(args: &mut Args, cx: &BuildCx) -> Result<Material> {
    words::force(args, cx, &WALLS)
}

impl FixStyle for WallGran {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        needs_spheres(cx, "wall/gran")?;
        let Line { force, wall, motions: Each(motions), servo, rest } = read(args, cx)?;
        let common = rest.common(force, [0.0; 3], cx)?;
        let servo = servo.map(|at| at.value.servo(at.span)?.shifting(at.span)).transpose()?;
        let mut form = Flat { place: place(wall.value.0, wall.span, cx)?, motion: None, servo };
        if form.servo.is_some() && (!motions.is_empty() || form.follows()) {
            let text = "a servo moves this wall: it has no other motion and follows no variable";
            return fail(Code::CONFLICT, wall.span, text);
        }
        if let [_, second, ..] = &motions[..] {
            return fail(Code::CONFLICT, second.word.span, "a wall has one motion: `wiggle` or `shear`");
        }
        if let Some(moving) = motions.into_iter().next() {
            form.motion = Some(form.moved(moving.value)?);
        }
        form.warn(cx, wall.span);
        Ok(Box::new(Declared { common, form }))
    }
}

/// Position of the wall.
#[derive(Clone)]
enum Place {
    /// Normal to an axis.
    Planes(Pair),
    /// Radius of a cylinder about z.
    Tube(f64),
    /// A cylinder about any axis, which counts as flat: axis, centre, radius.
    Cylinder(usize, [f64; 2], f64),
}

/// Motion of the wall.
#[derive(Clone, Copy)]
enum Motion {
    /// Axis, amplitude, angular frequency.
    Wiggle(usize, f64, f64),
    /// Axis, speed.
    Shear(usize, f64),
}

#[derive(Clone)]
struct Flat {
    place: Place,
    motion: Option<Motion>,
    servo: Option<Servo>,
}

/// The place of a wall; refuses one across a direction that repeats.
fn place(wall: Standing, span: Span, cx: &BuildCx) -> Result<Place> {
    let (place, axes): (_, &[usize]) = match wall {
        Standing::Xplane(places) => (Place::Planes(Pair::new(0, places)?), &[0]),
        Standing::Yplane(places) => (Place::Planes(Pair::new(1, places)?), &[1]),
        Standing::Zplane(places) => (Place::Planes(Pair::new(2, places)?), &[2]),
        Standing::Xcylinder { radius, center } => (Place::Cylinder(0, center, radius), &[1, 2]),
        Standing::Ycylinder { radius, center } => (Place::Cylinder(1, center, radius), &[0, 2]),
        Standing::Zcylinder { radius, center: Some(center) } => (Place::Cylinder(2, center, radius), &[0, 1]),
        Standing::Zcylinder { radius, center: None } => (Place::Tube(radius), &[0, 1]),
    };
    not_across_periodic(cx, axes, span)?;
    Ok(place)
}

impl Flat {
    /// Whether planes of it follow variables.
    fn follows(&self) -> bool {
        matches!(&self.place, Place::Planes(pair) if pair.follows())
    }

    /// The motion of the wall; refuses those that it cannot have.
    fn moved(&self, moving: Moving) -> Result<Motion> {
        match moving {
            Moving::Wiggle { axis, amplitude, period } => {
                self.may_wiggle(axis.value.0, axis.span)?;
                Ok(Motion::Wiggle(axis.value.0, amplitude, 2.0 * PI / period))
            }
            Moving::Shear { axis, speed } => {
                if matches!(&self.place, Place::Planes(pair) if pair.axis == axis.value.0) {
                    return fail(Code::BAD_VALUE, axis.span, "a plane cannot shear along its normal");
                }
                Ok(Motion::Shear(axis.value.0, speed))
            }
        }
    }

    /// Refuses to wiggle along an axis that this wall does not allow.
    fn may_wiggle(&self, axis: usize, at: Span) -> Result<()> {
        match &self.place {
            Place::Tube(_) if axis != 2 => {
                fail(Code::BAD_VALUE, at, "a cylinder about z can wiggle along z only")
            }
            Place::Cylinder(own, ..) if axis != *own => {
                fail(Code::BAD_VALUE, at, "a cylinder can wiggle along its axis only")
            }
            Place::Planes(pair) if pair.axis == axis && pair.follows() => {
                let text = "a plane that follows a variable cannot wiggle across itself";
                let d = Diagnostic::error(Code::CONFLICT, at, text);
                Err(d.help("let the variable wiggle: `v + A*(1-cos(2*PI*time/period))`").into())
            }
            _ => Ok(()),
        }
    }

    /// Warns of walls that no grain can reach.
    fn warn(&self, cx: &BuildCx, span: Span) {
        let Some(d) = &*cx.world.domain else { return };
        let fixed = |axis: usize, side: usize| d.boundary.0[axis][side] == Face::Fixed;
        let text = match &self.place {
            Place::Planes(pair) => {
                let (a, [lo, hi]) = (pair.axis, pair.fixed());
                let beyond = lo.is_some_and(|p| p < d.lo[a] && fixed(a, 0))
                    || hi.is_some_and(|p| p > d.hi[a] && fixed(a, 1));
                let name = ["x", "y", "z"][a];
                beyond.then(|| {
                    format!("a plane lies outside the box across {name}: grains are lost before they meet it")
                })
            }
            Place::Cylinder(axis, center, r) => {
                let dims = [(axis + 1) % 3, (axis + 2) % 3];
                let far = |k: usize| (d.lo[dims[k]] - center[k]).abs().max((d.hi[dims[k]] - center[k]).abs());
                let inside = *r <= far(0).hypot(far(1));
                (!inside)
                    .then(|| format!("the cylinder of radius {r} lies outside the box: no grain meets it"))
            }
            Place::Tube(r) => {
                let r = *r;
                let far = |lo: f64, hi: f64| lo.abs().max(hi.abs());
                let near = |lo: f64, hi: f64| if lo > 0.0 { lo } else { (-hi).max(0.0) };
                let corner = far(d.lo[0], d.hi[0]).hypot(far(d.lo[1], d.hi[1]));
                let closest = near(d.lo[0], d.hi[0]).hypot(near(d.lo[1], d.hi[1]));
                (r > corner || r < closest).then(|| {
                    format!(
                        "the cylinder of radius {r} about x = y = 0 lies outside the box: no grain meets it"
                    )
                })
            }
        };
        if let Some(text) = text {
            cx.note(Diagnostic::warning(Code::SUSPICIOUS, span, text));
        }
    }
}

impl Form for Flat {
    const STYLE: &'static str = "wall/gran";

    fn declare(&self, w: &mut World, key: Numbers) {
        w.memo.remove(key);
        super::forget(w, key);
        Elapsed::load(w, key).store(w, key);
    }

    fn outline(&self) -> Outline {
        let (axis, center, radius) = match &self.place {
            Place::Planes(pair) => return pair.outline(),
            Place::Tube(radius) => (2, [0.0; 2], *radius),
            // A region's centre is in the order of the axes.
            Place::Cylinder(1, [z, x], radius) => (1, [*x, *z], *radius),
            Place::Cylinder(axis, center, radius) => (*axis, *center, *radius),
        };
        Outline::new(move |w| {
            let Some(bounds) = w.domain.as_ref().map(perigrain_world::Domain::bounds) else { return vec![] };
            let (lo, hi) = (-INFINITE, INFINITE);
            let tube = Region::inside(Shape::Cylinder { axis, center, radius, lo, hi });
            tube.outline(bounds)
        })
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        Servo::modify_some(&mut self.servo, args, cx)
    }

    fn surface(&self, fix: &Common, cx: &mut dyn SealCx) -> Result<Box<dyn Surface>> {
        if self.servo.is_none() {
            self.warn_beyond(fix, cx)?;
        }
        // Plastic grains need their walls before any forces.
        let stage = if fix.is_plastic() { Stage::PreForce } else { Stage::PostForce };
        let key = fix.key(Self::STYLE);
        let servo = self.servo.as_ref().map(|servo| servo.seal(key, stage, cx)).transpose()?;
        let stands = match &self.place {
            Place::Planes(pair) => {
                Stands::Planes(pair.seal(cx, stage, Key::new(&format!("{}/planes", fix.key(Self::STYLE))))?)
            }
            Place::Tube(radius) => Stands::Tube(*radius),
            Place::Cylinder(axis, center, radius) => Stands::Cylinder(*axis, *center, *radius),
        };
        let steered = servo.map(|servo| Steered::new(servo, cx.world()));
        Ok(Box::new(Running {
            stands,
            motion: self.motion,
            steered,
            key,
            outline: Key::new(&fix.id),
            offset: 0.0,
            velocity: [0.0; 3],
            spin: 0.0,
        }))
    }
}

impl Flat {
    /// Warns of grains on the far side of a plane, which would push them out.
    fn warn_beyond(&self, fix: &Common, cx: &mut dyn SealCx) -> Result<()> {
        let Place::Planes(pair) = &self.place else { return Ok(()) };
        let (axis, [lo, hi]) = (pair.axis, pair.fixed());
        let p = &cx.world().particles;
        let beyond = |i: &usize| {
            let x = p.x[*i][axis];
            p.mask[*i] & fix.group.bit() != 0 && (lo.is_some_and(|a| x < a) || hi.is_some_and(|a| x > a))
        };
        let Some(first) = (0..p.len()).find(beyond) else { return Ok(()) };
        let (many, tag) = ((0..p.len()).filter(beyond).count(), p.tag[first]);
        cx.log().line(&format!(
            "WARNING: fix {} {}: {many} particle(s) stand beyond the wall, the first is {tag}",
            fix.id,
            Self::STYLE
        ))
    }
}

/// Position of the wall during a run.
enum Stands {
    Planes(Followed),
    /// Radius of a cylinder about z.
    Tube(f64),
    /// Axis, centre and radius of a cylinder that counts as flat.
    Cylinder(usize, [f64; 2], f64),
}

/// The wall during a run.
struct Running {
    stands: Stands,
    motion: Option<Motion>,
    steered: Option<Steered>,
    key: Numbers,
    outline: Key<Outline>,
    /// Displacement along the axis of its motion.
    offset: f64,
    velocity: [f64; 3],
    spin: f64,
}

impl Running {
    /// Advances the motion; returns the distance moved since the last call.
    fn go(&mut self, motion: Motion, w: &mut World, t: &Tick) -> f64 {
        let mut elapsed = Elapsed::load(w, self.key);
        if !t.setup {
            elapsed.follow(t.step, t.dt);
            elapsed.store(w, self.key);
        }
        let lammps = (t.step as f64 - elapsed.origin) * t.dt;
        let time = if w.settings.lammps() { lammps } else { elapsed.time() };
        let before = self.offset;
        match (motion, &self.stands) {
            (Motion::Wiggle(axis, amplitude, omega), _) => {
                self.offset = amplitude - amplitude * (omega * time).cos();
                self.velocity[axis] = amplitude * omega * (omega * time).sin();
                if let Some(outline) = w.outlines.get_mut(self.outline) {
                    outline.pose.shift[axis] = self.offset;
                }
            }
            (Motion::Shear(axis @ (0 | 1), speed), Stands::Tube(_)) => {
                self.spin = speed;
                // LAMMPS also moves a rotating cylinder along the axis that names the rotation.
                self.velocity[axis] = if w.settings.lammps() { speed } else { 0.0 };
            }
            (Motion::Shear(axis, speed), Stands::Cylinder(own, ..)) if axis != *own => self.spin = speed,
            (Motion::Shear(axis, speed), _) => self.velocity[axis] = speed,
        }
        (self.offset - before).abs()
    }
}

impl Surface for Running {
    fn place(&mut self, w: &mut World, t: &Tick) -> Result<f64> {
        let mut way = 0.0;
        if let Stands::Planes(planes) = &mut self.stands {
            let (gone, look) = planes.follow(w, t)?;
            way += gone;
            if let (Some(look), Some(outline)) = (look, w.outlines.get_mut(self.outline)) {
                *outline = look;
            }
        }
        if let Some(steered) = &mut self.steered {
            way += steered.advance(w, t, self.outline)?;
        }
        Ok(way + self.motion.map_or(0.0, |motion| self.go(motion, w, t)))
    }

    fn stands(&self) -> bool {
        let still = match &self.stands {
            Stands::Planes(planes) => planes.stand(),
            Stands::Tube(_) | Stands::Cylinder(..) => true,
        };
        still && self.motion.is_none() && self.steered.is_none()
    }

    fn feel(&mut self, w: &mut World, _: &[(&Touch, &Wrench)], felt: [f64; op::FELT], _t: &Tick) {
        if let Some(steered) = &self.steered {
            steered.feel(w, felt);
        }
    }

    fn feels(&self) -> bool {
        self.steered.is_some()
    }

    fn show(&self, w: &World, _: Option<u16>, see: &mut dyn FnMut(&dyn Wall)) {
        match &self.steered {
            Some(steered) => self.stand(w, &mut |wall| see(&steered.shifted(wall))),
            None => self.stand(w, see),
        }
    }
}

impl Running {
    /// The wall without what a servo does.
    fn stand(&self, w: &World, see: &mut dyn FnMut(&dyn Wall)) {
        let velocity = self.velocity;
        match &self.stands {
            Stands::Planes(planes) => {
                let axis = planes.axis;
                let along = matches!(self.motion, Some(Motion::Wiggle(a, ..)) if a == axis);
                let by = if along { self.offset } else { 0.0 };
                let nearer = w.settings.lammps();
                let [lo, hi] = planes.at.map(|p| p.map(|p| p + by));
                let across = |k: usize| {
                    let mut velocity = velocity;
                    velocity[axis] += planes.velocity[k];
                    velocity
                };
                see(&Planes { axis, lo, hi, velocity: [across(0), across(1)], nearer });
            }
            Stands::Cylinder(axis, center, radius) => {
                let (axis, center, radius) = (*axis, *center, *radius);
                see(&Cylinder { axis, center, radius, velocity, omega: self.spin });
            }
            Stands::Tube(radius) => {
                let lammps = w.settings.lammps();
                see(&Tube { radius: *radius, velocity, spin: self.spin, lammps });
            }
        }
    }
}
