//! fix deform: a box that changes its lengths while a run goes on.

mod track;

use super::{Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_plan::{About, Needs, Op, Stage, Tick, When};
use perigrain_styles::common::{not_here, scales, units_lattice};
use perigrain_styles::near::bonds_allow;
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::domain::Flow;
use perigrain_world::field::{BOX, FAMILIES, MASK, MEMO, SLOTS, X, X0};
use perigrain_world::{Face, GroupId, Key, Numbers, RATES, World};
use track::{Track, tracks};

/// The style.
pub struct Deform;

impl Style for Deform {
    fn name(&self) -> &'static str {
        "deform"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "fix ID group deform N x|y|z STYLE … [x|y|z STYLE …] [remap x|v|none] [units lattice|box]",
            summary: "Changes the lengths of the box while a run goes on.",
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
                   All but `final` and `delta` move both faces alike. `remap x` (default) stretches the positions of the group's \
                   particles with the box; `remap v` leaves them and gives particles that cross a periodic face the velocity \
                   of that face; with `none` nothing happens to them. Distances are in lattice spacings unless `units box`. \
                   A dimension with shrink-wrapped faces cannot be deformed, and none by two fixes. Peridynamic bonds \
                   that cross a periodic face keep its length: such a run is refused. There are no tilted boxes here: `xy xz yz` are refused, and `flip yes|no` is without effect.",
            example: "fix squeeze all deform 1 x scale 0.9999 remap x",
        }
    }
}

/// What a dimension does.
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
        let every = args.integer_from(1, "the number of steps N")?;
        let mut fix = Declared {
            id: cx.id.to_string(),
            group: cx.group,
            every,
            motions: [const { None }; 3],
            remap: Remap::Positions,
            scales: [1.0; 3],
        };
        let (mut lattice, mut any) = (true, false);
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "x" | "y" | "z" => {
                    let d = ["x", "y", "z"].iter().position(|n| *n == word.text).unwrap_or(0);
                    check_faces(cx, word, d)?;
                    fix.motions[d] = Some(motion(args, cx)?);
                    any = true;
                }
                "xy" | "xz" | "yz" => return Err(not_here(word, "a tilt of the box")),
                "flip" => {
                    args.flag("flip")?;
                    let text = "without effect: only a tilted box is ever flipped";
                    cx.note(Diagnostic::note(Code::NO_EFFECT, word.span, text));
                }
                "remap" => {
                    fix.remap = match args.choice("value of remap", &["x", "v", "none"])? {
                        "x" => Remap::Positions,
                        "v" => Remap::Velocities,
                        _ => Remap::None,
                    }
                }
                "units" => lattice = units_lattice(args)?,
                _ => return Err(args.unknown(word, &["x", "y", "z", "remap", "units"])),
            }
        }
        if !any {
            return fail(Code::MISSING_ARGUMENT, cx.span, "fix deform needs a dimension: x, y or z");
        }
        fix.scales = scales(cx.world, lattice);
        fix.check_volume(cx)?;
        Ok(Box::new(fix))
    }
}

/// Refuses dimensions whose faces follow the particles.
fn check_faces(cx: &BuildCx, word: &Word, d: usize) -> Result<()> {
    let Some(domain) = &*cx.world.domain else { return Ok(()) };
    if cx.world.settings.two_dimensional && d == 2 {
        return fail(Code::CONFLICT, word.span, "a flat scene cannot be deformed along z");
    }
    if domain.boundary.0[d].iter().any(|f| matches!(f, Face::Shrink | Face::ShrinkMin)) {
        let text = format!("the faces of `{}` follow the particles: no fix can move them", word.text);
        return Err(Diagnostic::error(Code::CONFLICT, word.span, text)
            .help("use `boundary` p or f for this dimension")
            .into());
    }
    Ok(())
}

fn motion(args: &mut Args, cx: &BuildCx) -> Result<Motion> {
    let two = |args: &mut Args, a: &str, b: &str| {
        Ok::<_, perigrain_base::diag::Diagnostics>((args.number(a)?, args.number(b)?))
    };
    Ok(match args.choice("style of a deformation", &STYLES)? {
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
    remap: Remap,
    /// Factors from the line's distances to the box's.
    scales: [f64; 3],
}

impl Declared {
    fn key(&self) -> Numbers {
        Key::new(&format!("deform/{}", self.id))
    }

    /// How fast it deforms the box.
    fn rates(&self) -> Numbers {
        self.key().with(RATES.text())
    }

    /// `volume` needs another dimension that moves by itself.
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
        w.memo.insert(self.key(), [d.lo, d.hi].concat());
        tell(w, self.rates(), [[0.0; 3]; 2], self.remap);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.key());
        w.memo.remove(self.rates());
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let when = When::Every(self.every);
        let tracks = tracks(self, cx, &when)?;
        let when = when.or(When::First);
        let (remap, group) = (self.remap, self.group);
        let w = cx.world();
        // Forces of the setup see the flow already; a variable's rate is known from the first change on.
        let t = Tick::between_runs(&w.clock);
        let (_, _, rate) = track::faces(&tracks, w, &t)?;
        let stretch = self.rates();
        tell(w, stretch, track::streaming(&tracks, w, rate, true), remap);
        if remap == Remap::Velocities {
            w.domain.iter_mut().for_each(|d| d.flow = Some(Flow { rate, group }));
        }
        let name = format!("fix {} deform", self.id);
        Ok(vec![Box::new(Move { name, stretch, tracks, remap, group, when })])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { deforms: self.motions.each_ref().map(Option::is_some), ..Facts::default() }
    }
}

/// Lets the world remember how fast lengths grow and lower faces move.
fn tell(w: &mut World, key: Numbers, [rate, low]: [[f64; 3]; 2], remap: Remap) {
    let remapped = f64::from(u8::from(remap == Remap::Positions));
    let row = w.memo.get_or(key, Vec::new);
    row.clear();
    row.extend(rate.into_iter().chain(low).chain([remapped]));
}

/// Moves the faces.
struct Move {
    name: String,
    /// Where the world remembers the rates.
    stretch: Numbers,
    tracks: [Track; 3],
    remap: Remap,
    group: GroupId,
    when: When,
}

impl Op for Move {
    fn about(&self) -> About {
        About {
            when: self.when.clone(),
            in_setup: true,
            ..About::new(
                &self.name,
                Stage::EndOfStep,
                Needs::new().read(MASK | SLOTS | FAMILIES | X0).write(X | BOX).keep(MEMO),
            )
        }
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let (lo, hi, rate) = track::faces(&self.tracks, w, t)?;
        tell(w, self.stretch, track::streaming(&self.tracks, w, rate, t.setup), self.remap);
        if self.remap == Remap::Velocities
            && let Some(domain) = &mut *w.domain
        {
            domain.flow = Some(Flow { rate, group: self.group });
        }
        if t.setup {
            return bonds_allow(w, self.tracks.each_ref().map(Track::moves));
        }
        let Some(domain) = &mut *w.domain else { return Ok(()) };
        let (from, length) = (domain.lo, domain.lengths());
        (domain.lo, domain.hi) = (lo, hi);
        if self.remap == Remap::Positions {
            let (p, bit) = (&mut w.particles, self.group.bit());
            for (x, _) in p.x.iter_mut().zip(&p.mask).filter(|(_, m)| **m & bit != 0) {
                // Where in the box, then there in the new one: dimensions that stay keep their bits.
                for d in (0..3).filter(|&d| self.tracks[d].moves()) {
                    x[d] = (x[d] - from[d]) / length[d] * (hi[d] - lo[d]) + lo[d];
                }
            }
        }
        Ok(())
    }
    fn finish(&mut self, w: &mut World) -> Result<()> {
        w.domain.iter_mut().for_each(|d| d.flow = None);
        Ok(())
    }
}
