//! fix deform: changes the lengths and tilts of the box during a run.

mod lean;
mod op;
mod pressure;
mod track;

pub use pressure::DeformPressure;

use super::{Facts, Fix, FixStyle};
use op::{Move, Shape, store_streaming};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_plan::{Op, Tick, When};
use perigrain_styles::common::{scales, units_lattice};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::{Face, GroupId, Key, Numbers, RATES, World};
use pressure::{Controls, Pressed};
use track::tracks;

/// The style.
pub struct Deform;

impl Style for Deform {
    fn name(&self) -> &'static str {
        "deform"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "fix ID group deform N x|y|z|xy|xz|yz STYLE … [x|y|z|xy|xz|yz STYLE …] [remap x|v|none] [flip yes|no] [units lattice|box]",
            summary: "Changes the lengths and tilts of the box during a run.",
            text: "Every N steps, at the end of the step. The styles of a dimension, of which the start is the box at the run's \
                   beginning (with `run … start`, that at this line):\n\n\
                   - `final lo hi`: these faces at the end of the run; `delta dlo dhi`: faces moved by this much at its end; \
                   `scale F`: F times as long at its end. Linear in time.\n\
                   - `vel V`: the length grows by V per time; `erate R`: by R times the first length per time; `trate R`: as \
                   exp(R t).\n\
                   - `volume`: follows the other dimensions so that the box keeps its volume; two such dimensions share it.\n\
                   - `wiggle A T`: length + A sin(2π t/T).\n\
                   - `variable v_change v_rate`: the change of the length and its rate in time, both equal-style, in the units of \
                   the box.\n\n\
                   All but `final` and `delta` move both faces alike. The tilts `xy`, `xz` and `yz` of a triclinic box \
                   (`region prism`) have the same styles but for `scale` and `volume`, with one number for `final` and `delta`; \
                   `erate R` is R times the first length of y (`xy`) or z (`xz`, `yz`) per time. Where a tilt passes half the \
                   length of x (`xy`, `xz`) or y (`yz`), with `flip yes` (default) the box is put in the place of the one a whole \
                   edge less, at the next rebuild of lists: another box of the same lattice, in which all particles are where they were. `remap x` (default) stretches the positions of the group's \
                   particles with the box; `remap v` leaves them and gives particles that cross a periodic face the velocity \
                   of that face; with `none` nothing happens to them. Distances are in lattice spacings unless `units box`. \
                   In a flat scene `z` changes the length that the box has along z, and no particle; it must still hold the plane z = 0. (LAMMPS, \
                   and perigrain under `-compat lammps`, lets `remap x` move particles out of the plane where its faces do not lie alike on both sides of it.) \
                   A dimension with shrink-wrapped faces cannot be deformed, and none by two fixes. Where peridynamic bonds \
                   cross a periodic face, its edge may change with `remap x` and `flip no` alone: the body is strained evenly with the box, \
                   from the state at the first run. \
                   Under `-compat lammps` particles that cross a face just before a flip keep their velocity with `remap v`, as in \
                   LAMMPS.",
            example: "fix squeeze all deform 1 x scale 0.9999 remap x",
        }
    }
}

/// Motion of a dimension.
#[derive(Clone, Debug)]
enum Motion {
    Final(f64, f64),
    Delta(f64, f64),
    Scale(f64),
    Velocity(f64),
    Rate(f64),
    TrueRate(f64),
    Volume,
    Wiggle(f64, f64),
    Variable(ValueRef, ValueRef),
    Pressed(Pressed),
}

/// What happens to the particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Remap {
    Positions,
    Velocities,
    None,
}

const STYLES: [&str; 9] =
    ["final", "delta", "scale", "vel", "erate", "trate", "volume", "wiggle", "variable"];

impl FixStyle for Deform {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        Ok(Box::new(read(args, cx, None)?))
    }
}

/// Reads the words of a line; with `controls`, the words of pressure control are allowed.
///
/// # Errors
/// Every mistake in them.
fn read(args: &mut Args, cx: &BuildCx, controls: Option<Controls>) -> Result<Declared> {
    let every = args.integer_from(1, "the number of steps N")?;
    let mut fix = Declared {
        id: cx.id.to_string(),
        group: cx.group,
        every,
        motions: [const { None }; 3],
        leans: [const { None }; 3],
        flips: true,
        remap: Remap::Positions,
        scales: [1.0; 3],
        controls,
    };
    let (mut lattice, mut any) = (true, false);
    while let Some(word) = args.next() {
        match word.text.as_str() {
            "x" | "y" | "z" => {
                let d = ["x", "y", "z"].iter().position(|n| *n == word.text).unwrap_or(0);
                check_faces(cx, word, d)?;
                let span = args.here();
                let motion = motion(args, cx, fix.controls.is_some())?;
                if d == 2 && cx.world.settings.two_dimensional && matches!(motion, Motion::Pressed(_)) {
                    return fail(Code::CONFLICT, span, "no pressure steers a flat scene along z");
                }
                fix.motions[d] = Some(motion);
                any = true;
            }
            "xy" | "xz" | "yz" => {
                let k = lean::NAMES.iter().position(|n| *n == word.text).unwrap_or(0);
                check_tilt(cx, word, k)?;
                fix.leans[k] = Some(lean::motion(args, cx, fix.controls.is_some())?);
                any = true;
            }
            "flip" => fix.flips = args.flag("flip")?,
            "remap" => {
                fix.remap = match args.choice("value of remap", &["x", "v", "none"])? {
                    "x" => Remap::Positions,
                    "v" => Remap::Velocities,
                    _ => Remap::None,
                }
            }
            "units" => lattice = units_lattice(args)?,
            _ => match &mut fix.controls {
                Some(controls) => controls.keyword(word, args)?,
                None => return Err(args.unknown(word, &WORDS)),
            },
        }
    }
    if !any {
        let text = format!("fix {} needs a length or tilt: x, y, z, xy, xz or yz", fix.style());
        return fail(Code::MISSING_ARGUMENT, cx.span, text);
    }
    fix.scales = scales(cx.world, lattice);
    fix.couple(cx)?;
    fix.check_volume(cx)?;
    let keeps_volume = fix.motions.iter().any(|m| matches!(m, Some(Motion::Volume)));
    if fix.remap == Remap::Velocities && (keeps_volume || fix.controls.is_some()) {
        cx.fault(cx.span, "with `remap v` the rate of strain in the place of the rate of a length", true);
    }
    Ok(fix)
}

/// The words that begin a section of the line.
const WORDS: [&str; 9] = ["x", "y", "z", "xy", "xz", "yz", "remap", "flip", "units"];

/// Refuses dimensions whose faces are shrink-wrapped.
fn check_faces(cx: &BuildCx, word: &Word, d: usize) -> Result<()> {
    let Some(domain) = &*cx.world.domain else { return Ok(()) };
    if domain.boundary.0[d].iter().any(|f| matches!(f, Face::Shrink | Face::ShrinkMin)) {
        let text = format!("the faces of `{}` follow the particles: no fix can move them", word.text);
        return Err(Diagnostic::error(Code::CONFLICT, word.span, text)
            .help("use `boundary` p or f for this dimension")
            .into());
    }
    Ok(())
}

/// Refuses tilts that the box cannot have.
fn check_tilt(cx: &BuildCx, word: &Word, k: usize) -> Result<()> {
    let Some(domain) = &*cx.world.domain else { return Ok(()) };
    if cx.world.settings.two_dimensional && k > 0 {
        let text = format!("the tilt {} of a flat scene must stay 0", word.text);
        return fail(Code::CONFLICT, word.span, text);
    }
    if domain.tilt.is_none() {
        let d = Diagnostic::error(Code::CONFLICT, word.span, "an orthogonal box cannot lean");
        return Err(d
            .help("make it triclinic: `change_box all triclinic`, or `create_box` with a `region prism`")
            .into());
    }
    if domain.boundary.0[lean::ACROSS[k]].iter().any(|f| matches!(f, Face::Shrink | Face::ShrinkMin)) {
        let axis = ["x", "y", "z"][lean::ACROSS[k]];
        let text = format!("the faces of `{axis}`, which {} tilts, follow the particles", word.text);
        let d = Diagnostic::error(Code::CONFLICT, word.span, text);
        return Err(d.help("use `boundary` p or f for this dimension").into());
    }
    Ok(())
}

fn motion(args: &mut Args, cx: &BuildCx, steered: bool) -> Result<Motion> {
    let two = |args: &mut Args, a: &str, b: &str| {
        Ok::<_, perigrain_base::diag::Diagnostics>((args.number(a)?, args.number(b)?))
    };
    let styles = [&STYLES[..], if steered { &pressure::STYLES } else { &[] }].concat();
    Ok(match args.choice("style of a deformation", &styles)? {
        style @ ("pressure" | "pressure/mean") => {
            Motion::Pressed(Pressed::read(args, cx, style == "pressure/mean")?)
        }
        "final" => {
            let (lo, hi) = two(args, "the lower face", "the upper face")?;
            Motion::Final(lo, hi)
        }
        "delta" => {
            let (lo, hi) = two(args, "the way of the lower face", "the way of the upper face")?;
            Motion::Delta(lo, hi)
        }
        "scale" => Motion::Scale(args.positive("the factor of the length")?),
        "vel" => Motion::Velocity(args.number("the velocity")?),
        "erate" => Motion::Rate(args.number("the strain rate")?),
        "trate" => Motion::TrueRate(args.number("the true strain rate")?),
        "volume" => Motion::Volume,
        "wiggle" => {
            let amplitude = args.number("the amplitude")?;
            Motion::Wiggle(amplitude, args.positive("the period")?)
        }
        _ => {
            let change = variable(args, cx, "the variable of the change in length")?;
            Motion::Variable(change, variable(args, cx, "the variable of its rate")?)
        }
    })
}

fn variable(args: &mut Args, cx: &BuildCx, what: &str) -> Result<ValueRef> {
    let word = args.expect(what)?;
    match ValueRef::parse(&word.text, word.span)? {
        Some(r) if r.kind == RefKind::Variable => cx.value(&r, false).map(|()| r),
        _ => fail(Code::WRONG_KIND, word.span, format!("a variable v_name is needed, not `{}`", word.text)),
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    every: i64,
    motions: [Option<Motion>; 3],
    /// Motion of xy, xz and yz.
    leans: [Option<lean::Motion>; 3],
    /// Whether a box that tilts too far is flipped.
    flips: bool,
    remap: Remap,
    /// Factors from the units of the line to box units.
    scales: [f64; 3],
    /// Settings of pressure control, for styles that have it.
    controls: Option<Controls>,
}

impl Declared {
    fn style(&self) -> &'static str {
        if self.controls.is_some() { "deform/pressure" } else { "deform" }
    }

    fn key(&self) -> Numbers {
        Key::new(&format!("deform/{}", self.id))
    }

    /// Key of the deformation rates.
    fn rates(&self) -> Numbers {
        self.key().with(RATES.text())
    }

    /// `volume` needs another dimension with a motion of its own.
    fn check_volume(&self, cx: &BuildCx) -> Result<()> {
        let follows = |m: &Option<Motion>| matches!(m, Some(Motion::Volume));
        let leads = |m: &Option<Motion>| m.is_some() && !follows(m);
        if self.motions.iter().any(follows) && !self.motions.iter().any(leads) {
            let text = "`volume` needs another dimension that moves by itself";
            return fail(Code::CONFLICT, cx.span, text);
        }
        Ok(())
    }
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        let Some(d) = &*w.domain else { return Ok(()) };
        w.memo.insert(self.key(), [d.lo, d.hi, d.tilt.unwrap_or_default()].concat());
        store_streaming(w, self.rates(), [[0.0; 3]; 3], self.remap);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.key());
        w.memo.remove(self.rates());
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let when = When::Every(self.every);
        let tracks = tracks(self, cx, &when)?;
        let start = track::start(self, cx.world())?;
        let leans = lean::leans(self, cx, &when, start)?;
        let when = when.or(When::First);
        let (remap, group) = (self.remap, self.group);
        let w = cx.world();
        // The forces of the setup already see the flow; the rate of a variable is known after the first
        // change.
        let t = Tick::between_runs(&w.clock);
        let now = Shape::at(&tracks, &leans, w, &t)?;
        let leans_now = w.domain.as_ref().is_some_and(|d| d.tilt.is_some());
        let (stretch, flips) = (self.rates(), self.flips && leans_now);
        store_streaming(w, stretch, now.streaming(&tracks, &leans, w, true), remap);
        if remap == Remap::Velocities {
            let flow = now.flow(&tracks, &leans, (w, group), true);
            w.domain.iter_mut().for_each(|d| d.flow = Some(flow));
        }
        let name = format!("fix {} {}", self.id, self.style());
        Ok(vec![Box::new(Move { name, stretch, tracks, leans, flips, remap, group, when, crossed: false })])
    }

    fn computes(&self) -> Vec<(String, &'static str, String)> {
        self.pressures()
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        match &mut self.controls {
            Some(controls) => controls.modify(args, cx),
            None => super::no_option(args),
        }
    }

    fn facts(&self, _: &World) -> Facts {
        let ([x, y, z], [xy, xz, yz]) =
            (self.motions.each_ref().map(Option::is_some), self.leans.each_ref().map(Option::is_some));
        Facts { deforms: [x, y, z, xy, xz, yz], ..Facts::default() }
    }
}
