//! Motion of a mesh: position, rotation and velocity at each step.

use crate::elapsed::Elapsed;
use crate::shared::direction;
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::vec3::{Vec3, add, cross, length, scale, sub};
use perigrain_contact::walls::{FacetNear, Near, Wall};
use perigrain_lang::{Args, Param, ValueRef};
use perigrain_mesh::Facets;
use perigrain_plan::{Stage, Tick, When};
use perigrain_styles::words::{Kind, Nullable, Value, Words};
use perigrain_styles::{BuildCx, Reading, SealCx};
use perigrain_world::outline::Pose;
use perigrain_world::region::turned;
use perigrain_world::{Key, Numbers, Outline, World};
use std::f64::consts::PI;
use std::sync::Arc;

/// The declared motion.
#[derive(Clone, Debug)]
pub enum Motion {
    /// None.
    Rest,
    /// A velocity.
    Linear(Vec3),
    /// Amplitudes and angular frequency.
    Wiggle(Vec3, f64),
    /// A point, the unit vector of an axis, angular velocity.
    Rotate(Vec3, Vec3, f64),
    /// Displacements.
    Variable([Option<ValueRef>; 3]),
}

/// How a mesh moves, with t the time since the fix was declared.
#[derive(Words)]
#[word(what = "motion")]
pub enum Moving {
    /// A shift V t.
    Linear(#[word(name = "Vx Vy Vz", what = "{}")] [f64; 3]),
    /// A shift A sin ω t with ω = 2π/period.
    Wiggle {
        #[word(name = "Ax Ay Az", what = "{}")]
        amplitude: [f64; 3],
        #[word(positive, what = "the period")]
        period: f64,
    },
    /// A turn about the axis R through P, right-handed, one in a period.
    Rotate {
        #[word(name = "Px Py Pz", what = "{}")]
        point: [f64; 3],
        #[word(name = "Rx Ry Rz", with = direction, kind = Kind::Number)]
        axis: [f64; 3],
        #[word(name = "period")]
        period: Period,
    },
    /// Shifts by equal-style variables; the wall has the velocity of the change since the step before.
    Variable(#[word(name = "v_dx v_dy v_dz", what = "the displacement {}")] [Nullable<Shift>; 3]),
}

/// A time that is not zero.
pub struct Period(f64);

impl Value for Period {
    const KIND: Kind = Kind::Number;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let span = args.here();
        match args.number("the period")? {
            0.0 => fail(Code::BAD_VALUE, span, "the period must not be zero"),
            period => Ok(Self(period)),
        }
    }
}

/// An equal-style variable.
pub struct Shift(ValueRef);

impl Value for Shift {
    const KIND: Kind = Kind::Reference;
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        match Param::value(what, args, cx)? {
            Param::Ref(r) => Ok(Self(r)),
            Param::Number(_) => {
                let text = format!("{what} is an equal-style variable v_name, or NULL");
                fail(Code::WRONG_KIND, cx.span, text)
            }
        }
    }
}

impl Moving {
    /// The motion.
    pub fn motion(self) -> Motion {
        match self {
            Self::Linear(velocity) => Motion::Linear(velocity),
            Self::Wiggle { amplitude, period } => Motion::Wiggle(amplitude, 2.0 * PI / period),
            Self::Rotate { point, axis, period } => Motion::Rotate(point, axis, 2.0 * PI / period.0),
            Self::Variable(names) => Motion::Variable(names.map(|name| name.0.map(|shift| shift.0))),
        }
    }
}

impl Motion {
    /// A point of the axis, where there is one.
    pub fn point(&self) -> Option<Vec3> {
        match self {
            Self::Rotate(point, ..) => Some(*point),
            _ => None,
        }
    }
}

/// Key of the position of a mesh that follows variables.
pub fn place_key(key: Numbers) -> Numbers {
    key.with("/place")
}

/// A mesh during a run.
pub struct Running {
    mesh: Arc<Facets>,
    motion: Motion,
    readings: [Option<Reading>; 3],
    key: Numbers,
    place: Numbers,
    /// Its outline, for pictures.
    outline: Key<Outline>,
    shift: Vec3,
    angle: f64,
    velocity: Vec3,
    /// Distance of the farthest corner from the axis.
    arm: f64,
}

impl Running {
    /// At rest in its initial position; `keys` are those of its state and outline.
    ///
    /// # Errors
    /// Missing variables.
    pub fn new(
        mesh: Arc<Facets>,
        motion: &Motion,
        (key, outline): (Numbers, Key<Outline>),
        cx: &mut dyn SealCx,
    ) -> Result<Self> {
        let mut readings = [None; 3];
        if let Motion::Variable(names) = motion {
            for (reading, name) in readings.iter_mut().zip(names) {
                if let Some(r) = name {
                    *reading = Some(cx.value(r, Stage::PostForce, &When::Always)?);
                }
            }
        }
        let arm = match motion {
            Motion::Rotate(point, axis, _) => mesh.farthest(*point, *axis),
            _ => 0.0,
        };
        let motion = motion.clone();
        Ok(Self {
            mesh,
            motion,
            readings,
            key,
            place: place_key(key),
            outline,
            shift: [0.0; 3],
            angle: 0.0,
            velocity: [0.0; 3],
            arm,
        })
    }

    /// Moves the mesh to its position at this step; returns the largest displacement of its points.
    ///
    /// # Errors
    /// A displacement that is not finite.
    pub fn place(&mut self, w: &mut World, t: &Tick) -> Result<f64> {
        if matches!(self.motion, Motion::Rest) {
            return Ok(0.0);
        }
        let mut elapsed = Elapsed::load(w, self.key);
        if !t.setup {
            elapsed.follow(t.step, t.dt);
            elapsed.store(w, self.key);
        }
        let (time, before) = (elapsed.time(), (self.shift, self.angle));
        match &self.motion {
            Motion::Rest => {}
            Motion::Linear(v) => (self.shift, self.velocity) = (scale(time, *v), *v),
            Motion::Wiggle(a, omega) => {
                self.shift = scale((omega * time).sin(), *a);
                self.velocity = scale(omega * (omega * time).cos(), *a);
            }
            Motion::Rotate(_, _, omega) => self.angle = omega * time,
            Motion::Variable(_) => self.follow(w, t)?,
        }
        if let Some(outline) = w.outlines.get_mut(self.outline) {
            outline.pose = self.pose();
        }
        Ok(length(sub(self.shift, before.0)) + self.arm * (self.angle - before.1).abs())
    }

    /// The displacement given by the variables, and the velocity as its change since the previous step.
    fn follow(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        self.shift = self.readings.map(|r| r.map_or(0.0, |r| r.get(w)));
        if self.shift.iter().any(|a| !a.is_finite()) {
            return fail(Code::NOT_FINITE, None, format!("the wall's displacement is {:?}", self.shift));
        }
        self.velocity = match w.memo.get(self.place).map(Vec::as_slice) {
            Some(&[step, x, y, z]) if t.step as f64 - step == 1.0 => {
                scale(1.0 / t.dt, sub(self.shift, [x, y, z]))
            }
            // In the setup of a run that continues where the last one ended, nothing has moved.
            _ => [0.0; 3],
        };
        let [x, y, z] = self.shift;
        w.memo.insert(self.place, vec![t.step as f64, x, y, z]);
        Ok(())
    }

    /// Its current pose.
    fn pose(&self) -> Pose {
        let turn = match &self.motion {
            Motion::Rotate(point, axis, _) => Some((*point, *axis, self.angle)),
            _ => None,
        };
        Pose { turn, shift: self.shift }
    }

    /// A position in the frame of the mesh.
    fn undo(&self, x: Vec3) -> Vec3 {
        let x = sub(x, self.shift);
        match &self.motion {
            Motion::Rotate(point, axis, _) => turned(x, *point, *axis, (-self.angle).into()),
            _ => x,
        }
    }
}

/// A mesh at its current position.
pub struct Placed<'a>(pub &'a Running);

impl Wall for Placed<'_> {
    fn close(&self, x: Vec3, reach: f64, _spare: &mut Vec<Near>) -> bool {
        self.0.mesh.close(self.0.undo(x), reach)
    }

    fn near(&self, x: Vec3, reach: f64, out: &mut Vec<Near>) {
        let mut pieces = vec![];
        self.0.mesh.around(self.0.undo(x), reach, &mut pieces);
        self.near_pieces(&pieces, x, reach, &mut vec![], out);
    }

    fn pieces(&self, x: Vec3, reach: f64, out: &mut Vec<u32>) -> bool {
        self.0.mesh.around(self.0.undo(x), reach, out);
        true
    }

    fn near_pieces(
        &self,
        pieces: &[u32],
        x: Vec3,
        reach: f64,
        spare: &mut Vec<FacetNear>,
        out: &mut Vec<Near>,
    ) {
        let me = self.0;
        me.mesh.near_among(
            (pieces, 0),
            me.undo(x),
            reach,
            spare,
            |FacetNear { part, normal, distance, .. }| {
                let mut near = Near { part, normal, distance, radius: 0.0, velocity: me.velocity };
                if let Motion::Rotate(point, axis, omega) = &me.motion {
                    near.normal = turned(near.normal, [0.0; 3], *axis, me.angle.into());
                    let place = sub(x, scale(near.distance, near.normal));
                    let arm = sub(place, add(*point, me.shift));
                    near.velocity = add(near.velocity, scale(*omega, cross(*axis, arm)));
                }
                out.push(near);
            },
        );
    }

    fn passes_some(&self) -> bool {
        true
    }

    fn passes(&self, from: u32, to: u32) -> bool {
        self.0.mesh.passes(from, to)
    }
}
