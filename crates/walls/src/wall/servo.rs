//! Servo of walls: moves a wall along an axis, or turns it about one, so that grains press on it with a wanted force or torque.

use super::op::FELT;
use crate::shared::direction;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::vec3::{Vec3, dot, scale};
use perigrain_contact::walls::{Shifted, Wall};
use perigrain_lang::{Args, Param};
use perigrain_plan::{Stage, Tick, When};
use perigrain_styles::fix::{Counted, options};
use perigrain_styles::words::{At, Words};
use perigrain_styles::{BuildCx, Reading, SealCx};
use perigrain_world::{Key, Numbers, Outline, World};

/// The words behind `servo`.
///
/// With p the force (or torque) with which the wall presses along the axis and the wanted value F, e = (F − p)/|F|: the
/// wall moves along the axis at v = `vel_max` clamp(kp e + ki ∫ e dt + kd de/dt, ±1). Source: LIGGGHTS manual, fix
/// mesh/surface/stress/servo; order in a step, the integral at the limit and `auto` measured with LIGGGHTS 3.8.0.
#[derive(Clone, Words)]
pub struct Line {
    /// The point about which a torque counts and the surface turns; it moves with the wall [length].
    #[word(keyword, name = "x y z", what = "{}", shown = "0 0 0")]
    com: [f64; 3],
    #[word(keyword = "ctrlPV", like = Controls, default = Controlled::Force)]
    control: Controlled,
    /// The axis along which the wall moves, or about which it turns.
    #[word(keyword, name = "x y z", what = "{}", with = direction, kind = Kind::Number, shown = "required")]
    axis: Option<[f64; 3]>,
    /// The wanted force of the wall on the grains along the axis [force], or the torque about it; a number that is not 0, or a variable.
    #[word(keyword, name = "F", what = "the wanted value", placed, shown = "required")]
    target_val: Option<At<Param>>,
    /// The fastest speed [length/time, 1/time for a torque].
    #[word(keyword, name = "v", what = "the fastest speed", positive, shown = "required")]
    vel_max: Option<f64>,
    /// The gain of the error.
    #[word(keyword, name = "gain", default = 0.01)]
    kp: f64,
    /// The gain of its integral, which does not wind up: beyond the limit of the speed it is the one that gives the limit [1/time].
    #[word(keyword, name = "gain", default = 0.0)]
    ki: f64,
    /// The gain of its rate [time].
    #[word(keyword, name = "gain", default = 0.0)]
    kd: f64,
    #[word(keyword, placed)]
    mode: Option<At<Mode>>,
    /// The ratio q of `mode auto`: the part of the least radius that the wall moves in a step at most.
    #[word(keyword, name = "q", positive)]
    ratio: Option<f64>,
}

/// What is steered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Controlled {
    /// The force along the axis.
    Force,
    /// The torque about the axis.
    Torque,
}

/// What a servo steers.
#[derive(Words)]
#[word(what = "controlled value", of = Controlled)]
enum Controls {
    /// The force along the axis.
    Force,
    /// The torque about the axis; mesh surfaces alone turn.
    Torque,
}

/// How a servo finds its speed.
#[derive(Clone, Words)]
#[word(what = "mode")]
enum Mode {
    /// u = q r/Δt with the least radius r of the grains: v = u (1 − 9 s) e for s = |p/F| below 0.1, else 0.1 u e; gains and
    /// `vel_max` are not used.
    Auto,
}

/// A servo as declared.
#[derive(Clone, Debug)]
pub struct Servo {
    /// The point about which the torque counts, in the first position.
    pub com: Vec3,
    /// What it steers.
    pub control: Controlled,
    /// The unit vector of the axis.
    pub axis: Vec3,
    target: Param,
    at: Span,
    vel_max: f64,
    gains: [f64; 3],
    ratio: Option<f64>,
    /// `fix_modify … servo/integrate stop`: the wall stands.
    stopped: bool,
}

impl Line {
    /// The servo.
    ///
    /// # Errors
    /// What is missing, and a wanted value of zero.
    pub fn servo(self, span: Span) -> Result<Servo> {
        let lack = |word: &str| {
            let text = format!("the servo needs `{word}`");
            let help = "write `servo axis 0 0 1 target_val -300 vel_max 0.1 kp 1`";
            Diagnostic::error(Code::MISSING_ARGUMENT, span, text).help(help)
        };
        let axis = self.axis.ok_or_else(|| lack("axis x y z"))?;
        let At { value: target, span: at, .. } = self.target_val.ok_or_else(|| lack("target_val F"))?;
        let vel_max = self.vel_max.ok_or_else(|| lack("vel_max v"))?;
        not_zero(&target, at)?;
        let ratio = match (self.mode, self.ratio) {
            (Some(mode), None) => {
                let d = Diagnostic::error(Code::MISSING_ARGUMENT, mode.span, "`mode auto` needs `ratio q`");
                return Err(d.help("write `mode auto ratio 0.001`").into());
            }
            (None, Some(_)) => {
                let d = Diagnostic::error(Code::CONFLICT, span, "`ratio` belongs to `mode auto`");
                return Err(d.help("add `mode auto`, or leave `ratio` out").into());
            }
            (_, ratio) => ratio,
        };
        let gains = [self.kp, self.ki, self.kd];
        Ok(Servo {
            com: self.com,
            control: self.control,
            axis,
            target,
            at,
            vel_max,
            gains,
            ratio,
            stopped: false,
        })
    }
}

/// Refuses a wanted value of zero, by which errors are divided.
fn not_zero(target: &Param, at: Span) -> Result<()> {
    match target {
        Param::Number(0.0) => fail(Code::BAD_VALUE, at, "the wanted value of a servo must not be 0"),
        _ => Ok(()),
    }
}

/// Options of `fix_modify` for walls with a servo.
#[derive(Words)]
struct Options {
    #[word(keyword = "servo/integrate")]
    integrate: Option<Integrate>,
    /// Another wanted value, or a variable.
    #[word(keyword, name = "F", what = "the wanted value", placed)]
    target_val: Option<At<Param>>,
    /// Another fastest speed.
    #[word(keyword, name = "v", what = "the fastest speed", positive)]
    vel_max: Option<f64>,
    /// Other gains.
    #[word(keyword = "ctrlParam", name = "kp ki kd", what = "the gain {}")]
    gains: Option<[f64; 3]>,
}

/// Whether the wall moves.
#[derive(Words)]
#[word(what = "state of the servo")]
enum Integrate {
    /// It moves.
    Start,
    /// It stands.
    Stop,
}

/// The options as the manual shows them.
pub const MODIFIED: perigrain_styles::words::Form =
    perigrain_styles::words::Form::headed(perigrain_styles::fix::MODIFY, Options::GRAMMAR);

impl Servo {
    /// For a wall that shifts only.
    ///
    /// # Errors
    /// A torque to be controlled.
    pub fn shifting(self, span: Span) -> Result<Self> {
        match self.control {
            Controlled::Force => Ok(self),
            Controlled::Torque => {
                let d = Diagnostic::error(
                    Code::CONFLICT,
                    span,
                    "this wall does not turn: it has no torque to control",
                );
                Err(d.help("take a mesh: `fix ID all surface FILE type T servo ctrlPV torque …`").into())
            }
        }
    }

    /// Takes options of `fix_modify`.
    ///
    /// # Errors
    /// Other words, and a wanted value of zero.
    pub fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let Options { integrate, target_val, vel_max, gains } = options(args, cx)?;
        if let Some(At { value, span, .. }) = target_val {
            not_zero(&value, span)?;
            (self.target, self.at) = (value, span);
        }
        self.vel_max = vel_max.unwrap_or(self.vel_max);
        self.gains = gains.unwrap_or(self.gains);
        self.stopped = integrate.map_or(self.stopped, |state| matches!(state, Integrate::Stop));
        Ok(())
    }

    /// Takes options of `fix_modify` of a wall that may have a servo.
    ///
    /// # Errors
    /// Other words, and options of a servo where there is none.
    pub fn modify_some(servo: &mut Option<Self>, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let span = args.here();
        match servo {
            Some(servo) => servo.modify(args, cx),
            None if args.peek().is_some_and(|word| Options::GRAMMAR.has(&word.text)) => {
                options::<Options>(args, cx)?;
                let d = Diagnostic::error(Code::CONFLICT, span, "this wall has no servo");
                Err(d.help("add `servo axis 0 0 1 target_val F vel_max v` to its line").into())
            }
            None => options::<Counted>(args, cx).map(drop),
        }
    }

    /// Key of its state below that of its wall.
    pub fn key(wall: Numbers) -> Numbers {
        wall.with("/servo")
    }

    /// The servo for a run.
    ///
    /// # Errors
    /// A missing variable.
    pub fn seal(&self, wall: Numbers, stage: Stage, cx: &mut dyn SealCx) -> Result<Running> {
        let target = cx.param(&self.target, stage, &When::Always)?;
        Ok(Running { servo: self.clone(), target, key: Self::key(wall) })
    }
}

/// A servo during a run.
pub struct Running {
    /// As declared.
    pub servo: Servo,
    target: Reading,
    key: Numbers,
}

/// State of a servo between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Whether it has seen a step.
    begun: bool,
    /// Way along the axis, or angle.
    pub way: f64,
    /// Speed in this step.
    pub speed: f64,
    integral: f64,
    /// Error at the last step.
    error: f64,
    /// Force or torque of grains on the wall along the axis at the last step.
    felt: f64,
}

impl State {
    fn load(w: &World, key: Numbers) -> Self {
        match w.memo.get(key).map(Vec::as_slice) {
            Some(&[begun, way, speed, integral, error, felt]) => {
                Self { begun: begun != 0.0, way, speed, integral, error, felt }
            }
            _ => Self::default(),
        }
    }

    fn store(self, w: &mut World, key: Numbers) {
        let Self { begun, way, speed, integral, error, felt } = self;
        w.memo.insert(key, vec![f64::from(u8::from(begun)), way, speed, integral, error, felt]);
    }
}

impl Running {
    /// Whether its speed depends on the radii of grains.
    pub fn sees_radii(&self) -> bool {
        self.servo.ratio.is_some()
    }

    /// Moves on by a step; returns the state before and after it.
    ///
    /// # Errors
    /// A wanted value that is zero or not finite.
    pub fn advance(&self, w: &mut World, t: &Tick) -> Result<[State; 2]> {
        let before = State::load(w, self.key);
        if t.setup {
            return Ok([before; 2]);
        }
        let target = self.target.get(w);
        if target == 0.0 || !target.is_finite() {
            let text = format!("the wanted value of the servo has become {target} in step {}", t.step);
            return fail(Code::BAD_VALUE, self.servo.at, text);
        }
        let mut now = before;
        let size = target.abs();
        if !before.begun || self.servo.stopped {
            // No force has been felt yet: the error before the first step counts as that without any.
            (now.begun, now.speed) = (true, 0.0);
            if !before.begun {
                now.error = target / size;
            }
        } else {
            let pressing = -before.felt;
            now.error = (target - pressing) / size;
            now.speed = match self.servo.ratio {
                Some(ratio) => auto(ratio * least_radius(w) / t.dt, (pressing / size).abs(), now.error),
                None => self.by_gains(&before, &mut now, t.dt),
            };
            now.way += now.speed * t.dt;
        }
        now.store(w, self.key);
        Ok([before, now])
    }

    /// The speed by the three gains. Where it is beyond its limit, the integral becomes the one that gives the limit with the error alone
    /// (measured with LIGGGHTS 3.8.0): it does not wind up.
    fn by_gains(&self, before: &State, now: &mut State, dt: f64) -> f64 {
        let [kp, ki, kd] = self.servo.gains;
        let integral = before.integral + now.error * dt;
        let part = kp * now.error + ki * integral + kd * (now.error - before.error) / dt;
        let limited = part.abs() > 1.0 && ki != 0.0;
        now.integral = if limited { (part.signum() - kp * now.error) / ki } else { integral };
        self.servo.vel_max * part.clamp(-1.0, 1.0)
    }

    /// Takes note of the force and the torque about the point of the axis that grains exert on the wall.
    pub fn feel(&self, w: &mut World, force: Vec3, torque: Vec3) {
        let felt = match self.servo.control {
            Controlled::Force => force,
            Controlled::Torque => torque,
        };
        let state = State { felt: dot(felt, self.servo.axis), ..State::load(w, self.key) };
        state.store(w, self.key);
    }
}

/// A wall that its servo shifts.
pub struct Steered {
    servo: Running,
    state: State,
}

impl Steered {
    /// Where it is at present.
    pub fn new(servo: Running, w: &World) -> Self {
        let state = State::load(w, servo.key);
        Self { servo, state }
    }

    /// Moves on by a step; returns how far.
    ///
    /// # Errors
    /// A wanted value that is zero or not finite.
    pub fn advance(&mut self, w: &mut World, t: &Tick, outline: Key<Outline>) -> Result<f64> {
        let [before, now] = self.servo.advance(w, t)?;
        self.state = now;
        if let Some(outline) = w.outlines.get_mut(outline) {
            outline.pose.shift = scale(now.way, self.servo.servo.axis);
        }
        Ok((now.way - before.way).abs())
    }

    /// Takes note of the force of grains on the wall.
    pub fn feel(&self, w: &mut World, felt: [f64; FELT]) {
        let [x, y, z, ..] = felt;
        self.servo.feel(w, [x, y, z], [0.0; 3]);
    }

    /// The wall where it is now.
    pub fn shifted<'w>(&self, wall: &'w dyn Wall) -> Shifted<'w> {
        let axis = self.servo.servo.axis;
        Shifted { wall, shift: scale(self.state.way, axis), velocity: scale(self.state.speed, axis) }
    }
}

/// The speed of `mode auto`.
fn auto(fastest: f64, part: f64, error: f64) -> f64 {
    let slowed = if part < 0.1 { 1.0 - 9.0 * part } else { 0.1 };
    fastest * slowed * error
}

/// The least radius of all grains; 0 without any.
fn least_radius(w: &World) -> f64 {
    let least = w.particles.radius.iter().copied().filter(|r| *r > 0.0).fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    // LIGGGHTS 3.8.0, servo_auto: force 0.00330469637547 of 1, u = 1e-3 0.005/1e-5: -0.000155 → -0.000159835256627; and at
    // 0.101356943646 the other branch.
    #[test]
    fn speeds_of_mode_auto() {
        let step = |p: f64| 1e-5 * auto(0.5, p, -1.0 + p);
        assert!((step(0.00330469637547) + 4.835256627e-6).abs() < 1e-14);
        assert!((step(0.101356943646) + 4.49321528e-7).abs() < 1e-14);
    }
}
