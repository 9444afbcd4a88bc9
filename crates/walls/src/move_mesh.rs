//! fix move/mesh: moves a surface on a path; several movers add up.

use crate::elapsed::Elapsed;
use crate::shared::direction;
use crate::shared::forget;
use crate::surface::SurfaceId;
use crate::{Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::vec3::Vec3;
use perigrain_lang::{Args, Word};
use perigrain_plan::Op;
use perigrain_styles::mesh_surface::{Course, MeshSurface, Movement, Mover, SURFACES};
use perigrain_styles::words::{At, Kind, Reference, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style, UseKind};
use perigrain_world::{Key, World};
use std::f64::consts::PI;

/// The style.
pub struct MoveMesh;

impl Style for MoveMesh {
    fn name(&self) -> &'static str {
        "move/mesh"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Moves a surface of `fix surface` along a line or about an axis.",
            text: "With t the time since this line and ω = 2π/period. The surface moves from where it is. `wiggle` shifts \
                   it by A sin ω t, `riggle` turns it by A sin ω t, `viblin` and `vibrot` by Σ C (cos(ω t + φ) − cos φ) \
                   along or about their axis; `linear/variable` and `rotate/variable` take velocities from equal-style \
                   variables, which are integrated by the trapezoidal rule. Contacts feel the velocity.\n\n\
                   Several movers of one surface add up: the velocity of each point is the sum of theirs. A mover \
                   carries the axes of those declared after it; directions stay. So a wheel that drives along a line \
                   is `linear`, then `rotate`. `unfix` ends a mover and leaves the surface where it is.\n\n\
                   Positions are exact functions of time, whatever the time step; where a turn carries a shift (`rotate`, \
                   then `linear`) they are of second order in the step. LIGGGHTS adds up time step times velocity.",
            example: "fix gear all surface blade.stl type 1 scale 0.001\nfix drive all move/mesh mesh gear linear 0.1 0 0\n\
                      fix turn all move/mesh mesh gear rotate origin 0 0 0 axis 0 0 1 period 0.5",
        }
    }
}

/// The words of the line.
#[derive(Words)]
struct Line {
    #[word(name = "mesh")]
    mesh: Meshes,
    #[word(name = "motion")]
    motion: At<Motion>,
}

/// The surface.
#[derive(Words)]
#[word(what = "word before the ID of a surface")]
enum Meshes {
    /// The surface that moves.
    Mesh(#[word(name = "surfaceID", what = "the ID of a surface")] SurfaceId),
}

/// The motion.
#[derive(Words)]
#[word(what = "motion")]
enum Motion {
    /// A velocity [length/time].
    Linear(#[word(name = "vx vy vz", what = "{}")] [f64; 3]),
    /// A velocity by equal-style variables.
    #[word("linear/variable")]
    LinearVariable(#[word(name = "v_vx v_vy v_vz")] [Reference; 3]),
    /// A shift A sin ω t.
    Wiggle(Wiggle),
    /// A turn about an axis, one in a period.
    Rotate(Rotate),
    /// A turn about an axis at an angular velocity by an equal-style variable [1/time].
    #[word("rotate/variable")]
    RotateVariable(RotateVariable),
    /// A turn by A sin ω t.
    Riggle(Riggle),
    /// A shift along an axis by a sum of vibrations.
    Viblin(Viblin),
    /// A turn about an axis by a sum of vibrations.
    Vibrot(Vibrot),
}

#[derive(Words)]
struct Wiggle {
    #[word(keyword, name = "x y z", what = "{}", shown = "required")]
    amplitude: Option<[f64; 3]>,
    #[word(keyword, positive, shown = "required")]
    period: Option<f64>,
}

/// An axis.
#[derive(Words)]
struct Line3 {
    #[word(keyword, name = "x y z", what = "{}", shown = "required")]
    origin: Option<[f64; 3]>,
    #[word(keyword, name = "x y z", with = direction, kind = Kind::Number, shown = "required")]
    axis: Option<[f64; 3]>,
}

#[derive(Words)]
struct Rotate {
    #[word(flatten)]
    about: Line3,
    #[word(keyword, name = "P", what = "the period", shown = "required")]
    period: Option<At<f64>>,
}

#[derive(Words)]
struct RotateVariable {
    #[word(flatten)]
    about: Line3,
    #[word(keyword, name = "v_omega", shown = "required")]
    omega: Option<Reference>,
}

#[derive(Words)]
struct Riggle {
    #[word(flatten)]
    about: Line3,
    #[word(keyword, positive, shown = "required")]
    period: Option<f64>,
    #[word(keyword, name = "degrees", what = "the amplitude", shown = "required")]
    amplitude: Option<f64>,
}

#[derive(Words)]
struct Viblin {
    #[word(keyword, name = "x y z", with = direction, kind = Kind::Number, shown = "required")]
    axis: Option<[f64; 3]>,
    #[word(flatten)]
    modes: Modes,
}

#[derive(Words)]
struct Vibrot {
    #[word(flatten)]
    about: Line3,
    #[word(flatten)]
    modes: Modes,
}

/// Vibrations that add up.
#[derive(Words)]
struct Modes {
    #[word(keyword, name = "n", what = "the number of vibrations", from = 1, shown = "required")]
    order: Option<usize>,
    #[word(keyword, name = "C", what = "an amplitude", list, least = 1, shown = "required")]
    amplitude: Vec<Amount>,
    #[word(keyword, name = "phi", what = "a phase", list, least = 1, shown = "required")]
    phase: Vec<Amount>,
    #[word(keyword, name = "P", what = "a period", list, least = 1, shown = "required")]
    period: Vec<Amount>,
}

/// A number in a list, which ends before the next word.
struct Amount(f64);

impl Value for Amount {
    const KIND: Kind = Kind::Number;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.number(what).map(Self)
    }
    fn begins(word: &Word) -> bool {
        word.unknown || word.text.parse::<f64>().is_ok()
    }
}

impl Line3 {
    /// A point of the axis and its direction.
    fn axis(self, span: Span) -> Result<(Vec3, Vec3)> {
        Ok((needed(self.origin, "origin x y z", span)?, needed(self.axis, "axis x y z", span)?))
    }
}

/// What a motion must have.
fn needed<T>(value: Option<T>, word: &str, span: Span) -> Result<T> {
    let Some(value) = value else {
        return fail(Code::MISSING_ARGUMENT, span, format!("this motion needs `{word}`"));
    };
    Ok(value)
}

impl Modes {
    fn course(self, span: Span) -> Result<Course> {
        let order = needed(self.order, "order n", span)?;
        for (list, name) in
            [(&self.amplitude, "amplitudes"), (&self.phase, "phases"), (&self.period, "periods")]
        {
            if list.len() != order {
                let text = format!("{order} vibrations need {order} {name}, not {}", list.len());
                return fail(Code::BAD_VALUE, span, text);
            }
        }
        let mut modes = vec![];
        for ((c, phase), period) in self.amplitude.iter().zip(&self.phase).zip(&self.period) {
            modes.push([c.0, phase.0, 2.0 * PI / not_zero(period.0, span)?]);
        }
        Ok(Course::Modes(modes))
    }
}

/// A period, which divides.
fn not_zero(period: f64, span: Span) -> Result<f64> {
    match period {
        0.0 => fail(Code::BAD_VALUE, span, "the period must not be zero"),
        _ => Ok(period),
    }
}

impl Motion {
    /// The movement, and a point of its axis.
    fn movement(self, span: Span) -> Result<(Movement, Vec3)> {
        let none = [0.0; 3];
        Ok(match self {
            Self::Linear(v) => (Movement::Line(v, Course::Steady(1.0)), none),
            Self::LinearVariable(all) => (Movement::Velocity(Box::new(all.map(|r| r.0))), none),
            Self::Wiggle(Wiggle { amplitude, period }) => {
                let amplitude = needed(amplitude, "amplitude x y z", span)?;
                let period = needed(period, "period P", span)?;
                (Movement::Line(amplitude, Course::Sine(1.0, 2.0 * PI / period)), none)
            }
            Self::Rotate(Rotate { about, period }) => {
                let (point, axis) = about.axis(span)?;
                let period = needed(period, "period P", span)?;
                let rate = 2.0 * PI / not_zero(period.value, period.span)?;
                (Movement::Turn(axis, Course::Steady(rate)), point)
            }
            Self::RotateVariable(RotateVariable { about, omega }) => {
                let (point, axis) = about.axis(span)?;
                (Movement::Rate(axis, needed(omega, "omega v_name", span)?.0), point)
            }
            Self::Riggle(Riggle { about, period, amplitude }) => {
                let (point, axis) = about.axis(span)?;
                let amplitude = needed(amplitude, "amplitude degrees", span)?.to_radians();
                let period = needed(period, "period P", span)?;
                (Movement::Turn(axis, Course::Sine(amplitude, 2.0 * PI / period)), point)
            }
            Self::Viblin(Viblin { axis, modes }) => {
                (Movement::Line(needed(axis, "axis x y z", span)?, modes.course(span)?), none)
            }
            Self::Vibrot(Vibrot { about, modes }) => {
                let (point, axis) = about.axis(span)?;
                (Movement::Turn(axis, modes.course(span)?), point)
            }
        })
    }
}

impl FixStyle for MoveMesh {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { mesh: Meshes::Mesh(SurfaceId(word)), motion } = read(args, cx)?;
        let (movement, point) = motion.value.movement(motion.span)?;
        let known = cx.world.facts.get(*SURFACES).and_then(|all| all.look_up(&word.text));
        if known.is_some_and(|surface| surface.steered) {
            let text = format!("surface `{}` has a servo, which moves it", word.text);
            let d = Diagnostic::error(Code::CONFLICT, word.span, text);
            return Err(d.help("leave out one of the two").into());
        }
        let others = known.map_or(&[][..], |surface| &surface.movers);
        // A mover that is declared again keeps its place among the others.
        if let Some(before) = others.iter().take_while(|other| other.id != cx.id).last() {
            cx.uses(UseKind::Fix, &before.id);
        }
        Ok(Box::new(Declared { surface: word.text.clone(), mover: Mover::new(cx.id, movement, point) }))
    }
}

#[derive(Clone)]
struct Declared {
    surface: String,
    mover: Mover,
}

impl Declared {
    /// The surface, if it is still there.
    fn surface<'w>(&self, w: &'w mut World) -> Option<&'w mut MeshSurface> {
        w.facts.get_mut(*SURFACES)?.get_mut(Key::new(&self.surface))
    }
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        w.memo.remove(self.mover.elapsed);
        forget(w, self.mover.elapsed);
        Elapsed::load(w, self.mover.elapsed).store(w, self.mover.elapsed);
        w.memo.insert(self.mover.carried, self.mover.point.to_vec());
        let mover = self.mover.clone();
        if let Some(surface) = self.surface(w) {
            match surface.movers.iter_mut().find(|other| other.id == mover.id) {
                Some(same) => *same = mover,
                None => surface.movers.push(mover),
            }
        }
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.mover.elapsed);
        forget(w, self.mover.elapsed);
        let id = self.mover.id.clone();
        if let Some(surface) = self.surface(w) {
            surface.movers.retain(|other| other.id != id);
        }
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let id = self.mover.id.clone();
        if self.surface(cx.world()).is_some_and(|surface| surface.movers.iter().any(|own| own.id == id)) {
            // The surface moves itself.
            return Ok(vec![]);
        }
        let text = format!("surface `{}` is gone, or its line stands behind this one", self.surface);
        let d = Diagnostic::error(Code::UNKNOWN_NAME, cx.span(), text);
        Err(d.help("declare this mover again behind the surface, or remove it with `unfix`").into())
    }
}
