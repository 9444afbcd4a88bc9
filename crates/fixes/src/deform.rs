//! fix deform: changes the lengths and tilts of the box during a run.

mod lean;
mod op;
mod pressure;
mod track;

pub use pressure::DeformPressure;

use super::{Facts, Fix, FixStyle};
use op::{Move, Shape, store_streaming};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, RefKind, ValueRef};
use perigrain_plan::{Op, Tick, When};
use perigrain_styles::stretching::RATES;
use perigrain_styles::words::{self, At, Syntax, Units, Words};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::{Face, GroupId, Key, Numbers, Registration, World};
use pressure::{Controls, Pressed};
use track::tracks;

/// How fast a fix deforms the box.
static RATE: Registration = Registration::role("deform/", "/rates", &RATES);

/// The style.
pub struct Deform;

impl Style for Deform {
    fn name(&self) -> &'static str {
        "deform"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Changes the lengths and tilts of the box during a run.",
            text: "Every N steps, at the end of the step, lengths and tilts are changed. The start of a dimension is \
                   the box at the run's beginning (with `run … start`, that at this line). All styles but `final` and \
                   `delta` move both faces alike. The tilts `xy`, `xz` and `yz` are those of a triclinic box (`region \
                   prism`).\n\n\
                   A dimension with shrink-wrapped faces cannot be deformed, and none by two fixes. In a flat scene `z` \
                   changes the length that the box has along z, and no particle; it must still hold the plane z = 0. \
                   (LAMMPS, and perigrain under `-compat lammps`, lets `remap x` move particles out of the plane where \
                   its faces do not lie alike on both sides of it.)\n\n\
                   Where peridynamic bonds cross a periodic face, its edge may change with `remap x` and `flip no` \
                   alone: the body is strained evenly with the box, from the state at the first run. Under `-compat \
                   lammps` particles that cross a face just before a flip keep their velocity with `remap v`, as in \
                   LAMMPS.",
            example: "fix squeeze all deform 1 x scale 0.9999 remap x",
        }
    }
    fn registrations(&self) -> &'static [&'static Registration] {
        const { &[&RATE] }
    }
}

#[derive(Words)]
struct Line {
    /// Acts at multiples of N [steps].
    #[word(name = "N", what = "the number of steps N", from = 1)]
    every: i64,
    #[word(keyword, name = "style", placed)]
    x: Option<At<At<Motion>>>,
    #[word(keyword, name = "style", placed)]
    y: Option<At<At<Motion>>>,
    #[word(keyword, name = "style", placed)]
    z: Option<At<At<Motion>>>,
    #[word(keyword, name = "style", placed)]
    xy: Option<At<lean::Motion>>,
    #[word(keyword, name = "style", placed)]
    xz: Option<At<lean::Motion>>,
    #[word(keyword, name = "style", placed)]
    yz: Option<At<lean::Motion>>,
    #[word(flatten)]
    handling: Handling,
}

/// Words of all deforming boxes.
#[derive(Words)]
struct Handling {
    #[word(keyword, shown = "x")]
    remap: Remap,
    /// Whether the box is put in the place of the one a whole edge less where a tilt passes half the length of x (`xy`, `xz`) or y
    /// (`yz`), at the next rebuild of lists: another box of the same lattice, in which all particles are where they were.
    #[word(keyword, default = true)]
    flip: bool,
    #[word(keyword, shown = "lattice")]
    units: Units,
}

/// Motion of a dimension.
#[derive(Clone, Debug, Words)]
#[word(what = "style of a deformation")]
enum Motion {
    /// These faces at the end of the run; linear in time.
    Final(
        #[word(name = "lo", what = "the lower face")] f64,
        #[word(name = "hi", what = "the upper face")] f64,
    ),
    /// Faces moved by this much at the end of the run; linear in time.
    Delta(
        #[word(name = "dlo", what = "the way of the lower face")] f64,
        #[word(name = "dhi", what = "the way of the upper face")] f64,
    ),
    /// F times as long at the end of the run; linear in time.
    Scale(#[word(name = "F", what = "the factor of the length", positive)] f64),
    /// The length grows by V per time.
    #[word("vel")]
    Velocity(#[word(name = "V", what = "the velocity")] f64),
    /// The length grows by R times the first length per time.
    #[word("erate")]
    Rate(#[word(name = "R", what = "the strain rate")] f64),
    /// The length grows as exp(R t).
    #[word("trate")]
    TrueRate(#[word(name = "R", what = "the true strain rate")] f64),
    /// Follows the other dimensions so that the box keeps its volume; two such dimensions share it.
    Volume,
    /// Length + A sin(2π t/T).
    Wiggle(
        #[word(name = "A", what = "the amplitude")] f64,
        #[word(name = "T", what = "the period", positive)] f64,
    ),
    /// The change of the length and its rate in time, both equal-style, in the units of the box.
    Variable(
        #[word(name = "v_change", with = variable, kind = Kind::Reference)] ValueRef,
        #[word(name = "v_rate", with = variable, kind = Kind::Reference)] ValueRef,
    ),
    #[word(skip)]
    Pressed(Pressed),
}

/// What happens to the particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Words)]
#[word(what = "value of remap")]
enum Remap {
    /// The positions of the group's particles are stretched with the box.
    #[default]
    #[word("x")]
    Positions,
    /// Particles that cross a periodic face get the velocity of that face.
    #[word("v")]
    Velocities,
    /// Nothing.
    None,
}

fn variable(args: &mut Args, cx: &BuildCx) -> Result<ValueRef> {
    let word = args.expect("a variable v_name")?;
    match ValueRef::parse(&word.text, word.span)? {
        Some(r) if r.kind == RefKind::Variable => cx.value(&r, false).map(|()| r),
        _ => fail(Code::WRONG_KIND, word.span, format!("a variable v_name is needed, not `{}`", word.text)),
    }
}

impl FixStyle for Deform {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { every, x, y, z, xy, xz, yz, handling } = words::read(args, cx)?;
        Ok(Box::new(declared(every, ([x, y, z], [xy, xz, yz]), handling, None, cx)?))
    }
}

/// Lengths along x, y, z and tilts xy, xz, yz that change.
type Changes = ([Option<At<At<Motion>>>; 3], [Option<At<lean::Motion>>; 3]);

/// The fix of a line; with `controls`, pressures may steer it.
///
/// # Errors
/// Dimensions that the box cannot change, and words that do not go together.
fn declared(
    every: i64,
    (lengths, tilts): Changes,
    handling: Handling,
    controls: Option<Controls>,
    cx: &BuildCx,
) -> Result<Declared> {
    for (d, length) in lengths.iter().enumerate() {
        let Some(At { value, span, .. }) = length else { continue };
        check_faces(cx, *span, d)?;
        if d == 2 && cx.world.settings.two_dimensional && matches!(value.value, Motion::Pressed(_)) {
            return fail(Code::CONFLICT, value.span, "no pressure steers a flat scene along z");
        }
    }
    for (k, tilt) in tilts.iter().enumerate() {
        tilt.as_ref().map_or(Ok(()), |tilt| check_tilt(cx, tilt.span, k))?;
    }
    let any = lengths.iter().any(Option::is_some) || tilts.iter().any(Option::is_some);
    let mut fix = Declared {
        id: cx.id.to_string(),
        group: cx.group,
        every,
        motions: lengths.map(|length| length.map(|at| at.value.value)),
        leans: tilts.map(|tilt| tilt.map(|at| at.value)),
        flips: handling.flip,
        remap: handling.remap,
        scales: handling.units.scales(cx.world),
        controls,
    };
    if !any {
        let text = format!("fix {} needs a length or tilt: x, y, z, xy, xz or yz", fix.style());
        return fail(Code::MISSING_ARGUMENT, cx.span, text);
    }
    fix.couple(cx)?;
    fix.check_volume(cx)?;
    let keeps_volume = fix.motions.iter().any(|m| matches!(m, Some(Motion::Volume)));
    if fix.remap == Remap::Velocities && (keeps_volume || fix.controls.is_some()) {
        cx.fault(cx.span, "with `remap v` the rate of strain in the place of the rate of a length", true);
    }
    Ok(fix)
}

/// Refuses dimensions whose faces are shrink-wrapped.
fn check_faces(cx: &BuildCx, span: Span, d: usize) -> Result<()> {
    let Some(domain) = &*cx.world.domain else { return Ok(()) };
    if domain.boundary.0[d].iter().any(|f| matches!(f, Face::Shrink | Face::ShrinkMin)) {
        let text =
            format!("the faces of `{}` follow the particles: no fix can move them", ["x", "y", "z"][d]);
        return Err(Diagnostic::error(Code::CONFLICT, span, text)
            .help("use `boundary` p or f for this dimension")
            .into());
    }
    Ok(())
}

/// Refuses tilts that the box cannot have.
fn check_tilt(cx: &BuildCx, span: Span, k: usize) -> Result<()> {
    let Some(domain) = &*cx.world.domain else { return Ok(()) };
    if cx.world.settings.two_dimensional && k > 0 {
        let text = format!("the tilt {} of a flat scene must stay 0", lean::NAMES[k]);
        return fail(Code::CONFLICT, span, text);
    }
    if domain.tilt.is_none() {
        let d = Diagnostic::error(Code::CONFLICT, span, "an orthogonal box cannot lean");
        return Err(d
            .help("make it triclinic: `change_box all triclinic`, or `create_box` with a `region prism`")
            .into());
    }
    if domain.boundary.0[lean::ACROSS[k]].iter().any(|f| matches!(f, Face::Shrink | Face::ShrinkMin)) {
        let axis = ["x", "y", "z"][lean::ACROSS[k]];
        let text = format!("the faces of `{axis}`, which {} tilts, follow the particles", lean::NAMES[k]);
        let d = Diagnostic::error(Code::CONFLICT, span, text);
        return Err(d.help("use `boundary` p or f for this dimension").into());
    }
    Ok(())
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
        RATE.key(self.key().text())
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
