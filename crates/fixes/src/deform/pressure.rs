//! fix deform/pressure: a deforming box whose lengths and tilts are controlled by pressures.

use super::{Declared, Fix, FixStyle, Handling, Motion, declared, lean};
use crate::{MODIFY, options};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail};
use perigrain_lang::{Args, Param, RefKind, ValueRef, Word};
use perigrain_plan::{Stage, Tick, When};
use perigrain_styles::words::{At, Form, Or, Syntax, Words, read_or};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Style};
use perigrain_world::World;

/// The style.
pub struct DeformPressure;

impl Style for DeformPressure {
    fn name(&self) -> &'static str {
        "deform/pressure"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Line::GRAMMAR), Form::headed(MODIFY, Options::GRAMMAR)] },
            ),
            summary: "A deforming box of which pressures steer lengths and tilts.",
            text: "As [fix deform](fix_deform.md), with pressures that steer lengths and tilts. N steps lie between two \
                   changes; the pressure is the one at the end of the step.\n\n\
                   The fix brings its own computes `ID_temp` (temp) and `ID_press` (pressure), which other lines may \
                   read; `fix_modify ID press C` takes another one. Choose K so that 1/(K · bulk modulus) is some ten \
                   times what a wave needs to cross the box: above that the box swings.\n\n\
                   Under `-compat lammps` a change takes the time of one step whatever N is, and under `-compat \
                   lammps/2025` particles that cross a face of a steered length with `remap v` get the rate of strain \
                   as their velocity, as in LAMMPS. `box` and `vol/balance/p` are not here: they are refused.",
            example: "fix hold all deform/pressure 1 x pressure 0.0 1e-3 max/rate 0.1 remap x",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Acts at multiples of N [steps].
    #[word(name = "N", what = "the number of steps N", from = 1)]
    every: i64,
    #[word(keyword, name = "style", placed)]
    x: Option<At<At<Length>>>,
    #[word(keyword, name = "style", placed)]
    y: Option<At<At<Length>>>,
    #[word(keyword, name = "style", placed)]
    z: Option<At<At<Length>>>,
    #[word(keyword, name = "style", placed)]
    xy: Option<At<Tilt>>,
    #[word(keyword, name = "style", placed)]
    xz: Option<At<Tilt>>,
    #[word(keyword, name = "style", placed)]
    yz: Option<At<Tilt>>,
    #[word(flatten)]
    handling: Handling,
    #[word(keyword, shown = "none")]
    couple: Coupled,
    /// Keeps every rate of strain by pressure between −R and R.
    #[word(keyword = "max/rate", name = "R", what = "the largest rate of strain", positive)]
    most: Option<f64>,
    /// Whether (p − P)/|P| is taken in the place of p − P, K being a rate.
    #[word(keyword = "normalize/pressure", default = false)]
    normalized: bool,
}

type Length = Or<Pressing, Motion>;
type Tilt = Or<Shearing, lean::Motion>;

/// Pressures that steer a length.
#[derive(Words)]
#[word(what = "style of a deformation")]
enum Pressing {
    /// The length L changes as dL/dt = L K (p − P) with the component p of the pressure along it: it grows while that is above P and
    /// shrinks while it is below.
    Pressure(Goal),
    /// The same with the mean pressure.
    #[word("pressure/mean")]
    Mean(Goal),
}

/// A pressure that steers a tilt.
#[derive(Words)]
#[word(what = "style of a tilt")]
enum Shearing {
    /// The tilt T changes as dT/dt = L K (p − P) with the off-diagonal component p and the length L across which it leads.
    Pressure(Goal),
}

/// A pressure, a number or an equal-style variable, and a gain, a rate over a pressure.
#[derive(Words)]
struct Goal {
    #[word(name = "P", what = "the pressure")]
    target: At<Param>,
    #[word(name = "K", what = "the gain")]
    gain: f64,
}

impl Goal {
    fn pressed(self, mean: bool) -> Pressed {
        Pressed { target: self.target.value, gain: self.gain, mean, span: self.target.span }
    }
}

/// Lengths that go together.
#[derive(Clone, Copy, Default, PartialEq, Words)]
#[word(what = "lengths that go together")]
enum Coupled {
    /// Each length by itself.
    #[default]
    None,
    /// The mean of the components changes these lengths by the same factor; of a length without a style it takes that of another.
    Xyz,
    Xy,
    Yz,
    Xz,
}

impl Coupled {
    /// Which of x, y, z it names.
    fn axes(self) -> [bool; 3] {
        match self {
            Self::None => [false; 3],
            Self::Xyz => [true; 3],
            Self::Xy => [true, true, false],
            Self::Yz => [false, true, true],
            Self::Xz => [true, false, true],
        }
    }
}

/// The refusal of LAMMPS' words that change all lengths together.
fn not_of_a_box(word: &Word) -> Option<Diagnostics> {
    if !["box", "vol/balance/p"].contains(&word.text.as_str()) {
        return None;
    }
    let text = format!("`{}` of fix deform/pressure is not in perigrain", word.text);
    let d = Diagnostic::error(Code::NOT_SUPPORTED, word.span, text);
    Some(d.help("steer x, y and z by `pressure` or `pressure/mean`, with `couple xyz`").into())
}

/// The options of `fix_modify`.
#[derive(Words)]
struct Options {
    /// The compute of the pressure that takes the place of the fix's own.
    #[word(keyword, name = "C", what = "the ID of a compute of a pressure", kind = Kind::Compute)]
    press: Option<Word>,
}

impl FixStyle for DeformPressure {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let line: Line = read_or(args, cx, not_of_a_box)?;
        let length = |At { value: length, span, unknown }: At<At<Length>>| {
            let motion = match length.value {
                Or::Word(Pressing::Pressure(goal)) => Motion::Pressed(goal.pressed(false)),
                Or::Word(Pressing::Mean(goal)) => Motion::Pressed(goal.pressed(true)),
                Or::Else(motion) => motion,
            };
            At { value: At { value: motion, span: length.span, unknown: length.unknown }, span, unknown }
        };
        let tilt = |tilt: At<Tilt>| {
            let value = match tilt.value {
                Or::Word(Shearing::Pressure(goal)) => lean::Motion::Pressed(goal.pressed(false)),
                Or::Else(motion) => motion,
            };
            At { value, span: tilt.span, unknown: tilt.unknown }
        };
        let lengths = [line.x, line.y, line.z].map(|x| x.map(length));
        let tilts = [line.xy, line.xz, line.yz].map(|xy| xy.map(tilt));
        let (together, most, normalized) = (line.couple.axes(), line.most, line.normalized);
        let controls = Controls { together, most, normalized, press: None };
        Ok(Box::new(declared(line.every, (lengths, tilts), line.handling, Some(controls), cx)?))
    }
}

/// Pressure control of a length or tilt.
#[derive(Clone, Debug)]
pub struct Pressed {
    /// Target pressure.
    target: Param,
    gain: f64,
    mean: bool,
    span: Span,
}

/// Settings of the pressure control.
#[derive(Clone, Debug, Default)]
pub struct Controls {
    /// Which lengths are coupled.
    together: [bool; 3],
    most: Option<f64>,
    normalized: bool,
    /// A pressure compute other than the fix's own.
    press: Option<ValueRef>,
}

impl Controls {
    /// The axes of coupled lengths: without z in a flat scene.
    fn axes(&self, w: &World) -> Vec<usize> {
        let flat = w.settings.two_dimensional;
        (0..3).filter(|d| self.together[*d] && !(flat && *d == 2)).collect()
    }

    /// `fix_modify ID press C`.
    ///
    /// # Errors
    /// A value that is not a pressure compute, other options.
    pub fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        if let Some(word) = args.peek().filter(|w| w.text == "temp") {
            let text = "fix deform/pressure takes its temperature from its compute of the pressure";
            let d = Diagnostic::error(Code::NOT_SUPPORTED, word.span, text);
            return Err(d
                .help("use `compute ID all pressure T` with that temperature, and `fix_modify ID press` with it")
                .into());
        }
        let Some(word) = options::<Options>(args, cx)?.press else { return Ok(()) };
        if let Some(style) = cx.names.compute_style(&word.text)
            && style != "pressure"
        {
            let text = format!("compute `{}` is of style {style}: it has no pressure", word.text);
            return fail(Code::WRONG_KIND, word.span, text);
        }
        let r = component(&word.text, 1, word.span);
        cx.value(&r, false)?;
        self.press = Some(r);
        Ok(())
    }
}

/// An element of a compute's vector.
fn component(id: &str, k: usize, span: Span) -> ValueRef {
    ValueRef { kind: RefKind::Compute, name: id.into(), index: vec![k], span }
}

/// The controlled quantity: the length along an axis, or a tilt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// x, y or z.
    Length(usize),
    /// xy, xz or yz.
    Tilt(usize),
}

impl Declared {
    /// The computes that the fix creates.
    pub(super) fn pressures(&self) -> Vec<(String, &'static str, String)> {
        let steered = self.motions.iter().flatten().any(|m| matches!(m, Motion::Pressed(_)))
            || self.leans.iter().flatten().any(|m| matches!(m, lean::Motion::Pressed(_)));
        if !steered {
            return vec![];
        }
        let [temp, press] = ["temp", "press"].map(|what| format!("{}_{what}", self.id));
        vec![(temp.clone(), "temp", String::new()), (press, "pressure", temp)]
    }

    /// Gives coupled lengths the motion of the one that has one.
    ///
    /// # Errors
    /// Two with different motions, or none with a motion.
    pub(super) fn couple(&mut self, cx: &BuildCx) -> Result<()> {
        let Some(controls) = self.controls.as_ref().filter(|c| c.together != [false; 3]) else {
            return Ok(());
        };
        let axes = controls.axes(cx.world);
        let pressed = |d: &usize| match &self.motions[*d] {
            Some(Motion::Pressed(p)) if !p.mean => Some(p.clone()),
            _ => None,
        };
        let Some(first) = axes.iter().find_map(pressed) else {
            return fail(Code::CONFLICT, cx.span, "`couple`: none of these lengths has the style `pressure`");
        };
        for d in axes {
            match &self.motions[d] {
                None => {}
                Some(Motion::Pressed(p)) if !p.mean && p.target == first.target && p.gain == first.gain => {}
                Some(_) => {
                    let text = format!(
                        "`couple`: {} is to follow another pressure than the rest",
                        ["x", "y", "z"][d]
                    );
                    return fail(Code::CONFLICT, cx.span, text);
                }
            }
            self.motions[d] = Some(Motion::Pressed(first.clone()));
        }
        Ok(())
    }

    /// The pressure control of a length or tilt in a run that begins.
    ///
    /// # Errors
    /// Missing computes and variables.
    pub(super) fn steering(
        &self,
        pressed: &Pressed,
        aim: Aim,
        cx: &mut dyn SealCx,
        when: &When,
    ) -> Result<Steering> {
        let controls = self.controls.clone().unwrap_or_default();
        let (id, at) = match &controls.press {
            Some(other) => (other.name.clone(), other.span),
            None => (format!("{}_press", self.id), pressed.span),
        };
        let elements: Vec<usize> = match aim {
            Aim::Length(_) if pressed.mean => vec![],
            Aim::Length(d) if controls.together[d] => controls.axes(cx.world()),
            Aim::Length(d) => vec![d],
            Aim::Tilt(k) => vec![k + 3],
        };
        let mut now: Vec<Reading> = vec![];
        for k in elements {
            now.push(cx.value(&component(&id, k + 1, at), Stage::EndOfStep, when)?);
        }
        if now.is_empty() {
            let scalar = ValueRef { index: vec![], ..component(&id, 1, at) };
            now.push(cx.value(&scalar, Stage::EndOfStep, when)?);
        }
        let target = cx.param(&pressed.target, Stage::EndOfStep, when)?;
        let every = if cx.world().settings.lammps() { 1 } else { self.every };
        let Controls { most, normalized, .. } = controls;
        Ok(Steering { now, target, gain: pressed.gain, most, normalized, every, span: pressed.span })
    }
}

/// Pressure control of one quantity during a run.
#[derive(Clone, Debug)]
pub struct Steering {
    /// Pressure components; their mean counts.
    now: Vec<Reading>,
    target: Reading,
    gain: f64,
    most: Option<f64>,
    normalized: bool,
    /// Steps between updates.
    every: i64,
    span: Span,
}

impl Steering {
    /// Strain rate K (p − P); 0 before the first step, when no pressure is known.
    ///
    /// # Errors
    /// A relative deviation from a target pressure of 0, without a maximum rate.
    pub fn rate(&self, w: &World, t: &Tick) -> Result<f64> {
        if t.setup {
            return Ok(0.0);
        }
        let now = self.now.iter().map(|p| p.get(w)).sum::<f64>() / self.now.len() as f64;
        let target = self.target.get(w);
        let mut rate = self.gain * (now - target);
        if self.normalized {
            if target == 0.0 && self.most.is_none() {
                let text = "a pressure of 0 cannot be what others are measured by";
                let d = Diagnostic::error(Code::BAD_VALUE, self.span, text);
                return Err(d.help("use `normalize/pressure no`, or limit the rate by `max/rate`").into());
            }
            rate /= target.abs();
        }
        // 0/0: a target of 0 at a pressure of 0 needs no change.
        let rate = if rate.is_nan() && target == 0.0 && now == 0.0 { 0.0 } else { rate };
        Ok(self.most.map_or(rate, |most| rate.clamp(-most, most)))
    }

    /// The time interval of a change [time].
    pub fn span(&self, w: &World, t: &Tick) -> f64 {
        if t.setup { 0.0 } else { self.every as f64 * w.clock.dt }
    }
}
