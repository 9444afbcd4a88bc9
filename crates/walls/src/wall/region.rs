//! fix wall/gran/region: the surface of a region as a wall, at rest or moving with it.

use super::servo::{self, Servo, Steered};
use super::words::{self, Material, Rest};
use super::{Common, Declared, Form, Surface, needs_spheres, op};
use crate::{Fix, FixStyle, RegionId};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_contact::Wrench;
use perigrain_contact::walls::{Near, Touch, Wall};
use perigrain_lang::Args;
use perigrain_plan::{Stage, Tick};
use perigrain_styles::words::{At, Form as Behind, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::region::{Look, Shape};
use perigrain_world::{Key, Numbers, Outline, Region, World};

/// The style.
pub struct WallGranRegion;

impl Style for WallGranRegion {
    fn name(&self) -> &'static str {
        "wall/gran/region"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(const { &[Behind::behind(Line::GRAMMAR), servo::MODIFIED] }),
            summary: "The surface of a region as a wall on which grains lean, at rest or moving.",
            text: "As `fix wall/gran`, with the surface of a region of any shape. Grains inside feel every face they \
                   touch, grains outside (`side out`) the nearest point; a region with `open` faces is a shell that is \
                   felt from both sides. R̄ counts the wall's curvature, 1/R̄ = 1/R + 1/R_w: R_w = −R_s inside a sphere \
                   of radius R_s, −2 R_c inside a cylinder or cone of radius R_c there, the same with + from outside, \
                   flat for everything else (ellipsoids too, as in LAMMPS); where the wall is too hollow for the grain, \
                   R̄ = R.\n\n\
                   Of a `union` those places count that lie in no other part, of an `intersect` those that lie in all; \
                   parts with open faces hide nothing. Edges that such a combination makes towards the grains are not \
                   rounded: avoid them.\n\n\
                   A region that follows variables moves the wall, and its surface has the velocity of that motion (the \
                   change since the step before, zero in the first). `region ID delete` and a new `region ID` of the \
                   same name between runs change the wall. `servo` moves \
                   the wall, not the region, along its `axis` so that it presses on grains with a wanted force, as \
                   described for `fix surface`; not in LAMMPS.\n\n\
                   LAMMPS takes cones for hollow from outside, open cylinders for flat from outside, feels nothing of a \
                   union's outside, misses contacts beside the ends of an ellipsoid's axes, takes moving parts of \
                   unions and intersections for resting ones, gives a turning wall a speed in proportion to the length \
                   of the axis that the deck names, and lets only cylinders and spheres push while they change their \
                   size; perigrain does the same under `-compat lammps` alone. Values as those of `fix wall/gran`.",
            example: "region funnel cone z 0.0 0.0 0.001 0.005 -0.001 0.006 units box open 1 open 2\n\
                      fix funnel grains wall/gran/region granular hertz/material 5.0e7 0.7 0.3 damping tsuji tangential \
                      mindlin NULL 1.0 0.5 region funnel",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "force", with = force, kind = words::FORCE)]
    force: Material,
    #[word(name = "wall")]
    wall: Surround,
    #[word(keyword, once, placed)]
    servo: Option<At<servo::Line>>,
    #[word(flatten)]
    rest: Rest,
}

/// The wall.
#[derive(Words)]
#[word(what = "wall")]
enum Surround {
    /// The surface of this region.
    Region(#[word(name = "regionID")] At<RegionId>),
}

fn force(args: &mut Args, cx: &BuildCx) -> Result<Material> {
    words::force(args, cx, &["region"])
}

impl FixStyle for WallGranRegion {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        needs_spheres(cx, "wall/gran/region")?;
        let Line { force, wall: Surround::Region(wall), servo, rest } = read(args, cx)?;
        let (span, RegionId(region)) = (wall.span, wall.value);
        let known = cx.world.regions.find(&region).and_then(|key| cx.world.regions.get(key));
        let turn = known.and_then(|region| region.motion.as_ref()?.turn.as_ref());
        let common = rest.common(force, turn.map_or([0.0; 3], |turn| turn.point), cx)?;
        let servo = servo.map(|at| at.value.servo(at.span)?.shifting(at.span)).transpose()?;
        if servo.is_some() && known.is_some_and(Region::follows) {
            let text = "a servo moves this wall: the region follows no variable";
            return fail(Code::CONFLICT, span, text);
        }
        Ok(Box::new(Declared { common, form: Shaped { region, span, servo } }))
    }
}

/// The region by name: it may be redefined between runs.
#[derive(Clone)]
struct Shaped {
    region: String,
    span: Span,
    servo: Option<Servo>,
}

impl Form for Shaped {
    const STYLE: &'static str = "wall/gran/region";

    fn declare(&self, w: &mut World, key: Numbers) {
        // No step and no pose: the wall has no velocity in its first step.
        super::forget(w, key);
        w.memo.insert(key, vec![]);
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        Servo::modify_some(&mut self.servo, args, cx)
    }

    fn outline(&self) -> Outline {
        let name: Key<Region> = Key::new(&self.region);
        Outline::new(move |w| match (w.regions.get(name), &*w.domain) {
            (Some(region), Some(d)) => region.outline(d.bounds()),
            _ => vec![],
        })
    }

    fn surface(&self, fix: &Common, cx: &mut dyn SealCx) -> Result<Box<dyn Surface>> {
        let w = cx.world();
        let Some((name, region)) =
            w.regions.find(&self.region).and_then(|key| Some((key, w.regions.get(key)?)))
        else {
            let text = format!("there is no region `{}` any more", self.region);
            let d = Diagnostic::error(Code::UNKNOWN_REGION, self.span, text);
            return Err(d.help("define it again before the run, or remove the fix with `unfix`").into());
        };
        let before = region.follows().then(|| region.clone());
        let span = self.span;
        let radius = w.particles.radius.iter().copied().fold(0.0, f64::max);
        let key = fix.key(Self::STYLE);
        let stage = if fix.is_plastic() { Stage::PreForce } else { Stage::PostForce };
        let servo = self.servo.as_ref().map(|servo| servo.seal(key, stage, cx)).transpose()?;
        let steered = servo.map(|servo| Steered::new(servo, cx.world()));
        let outline = Key::new(&fix.id);
        Ok(Box::new(Running { name, span, key, outline, before, elapsed: None, radius, steered }))
    }
}

/// The wall during a run.
struct Running {
    name: Key<Region>,
    span: Span,
    key: Numbers,
    /// A region that follows variables, as it was at the previous step.
    before: Option<Region>,
    /// The time since then, if the region existed then.
    elapsed: Option<f64>,
    /// The largest radius at the beginning of the run.
    radius: f64,
    outline: Key<Outline>,
    steered: Option<Steered>,
}

impl Surface for Running {
    fn place(&mut self, w: &mut World, t: &Tick) -> Result<f64> {
        if let Some(steered) = &mut self.steered {
            return steered.advance(w, t, self.outline);
        }
        let Some(region) = w.regions.get(self.name) else {
            return fail(Code::UNKNOWN_REGION, self.span, format!("region `{}` is gone", self.name));
        };
        let Some(before) = &mut self.before else { return Ok(0.0) };
        let mut nothing = vec![];
        let memo = w.memo.get_mut(self.key).unwrap_or(&mut nothing);
        let since = memo.first().map_or(f64::INFINITY, |step| t.step as f64 - step);
        self.elapsed = (since == 1.0).then_some(t.dt);
        if memo.len() < 2 {
            before.clone_from(region);
        }
        // Regions are redefined between runs only: all but the pose is unchanged.
        before.set_pose(&mut memo.iter().skip(1).copied());
        // Wall points that matter are within a radius of some particle in the box.
        let margin = 2.0 * self.radius;
        let corners = w.domain.as_ref().map(|d| {
            let bounds = d.bounds();
            let end = |k: usize, a: usize| match k & (1 << a) == 0 {
                true => bounds[a][0] - margin,
                false => bounds[a][1] + margin,
            };
            [0, 1, 2, 3, 4, 5, 6, 7].map(|k| [0, 1, 2].map(|a| end(k, a)))
        });
        memo.clear();
        memo.push(t.step as f64);
        region.pose(memo);
        Ok(region.travel(before, corners.as_ref().map_or(&[], |c| &c[..])))
    }

    fn show(&self, w: &World, _: Option<u16>, see: &mut dyn FnMut(&dyn Wall)) {
        let faces = Faces {
            // Contact points were just found, so that the region exists.
            region: w.regions.get(self.name),
            look: Look { before: self.before.as_ref().zip(self.elapsed), lammps: w.settings.lammps() },
        };
        match &self.steered {
            Some(steered) => see(&steered.shifted(&faces)),
            None => see(&faces),
        }
    }

    fn feel(&mut self, w: &mut World, _: &[(&Touch, &Wrench)], felt: [f64; op::FELT], _t: &Tick) {
        if let Some(steered) = &self.steered {
            steered.feel(w, felt);
        }
    }

    fn feels(&self) -> bool {
        self.steered.is_some()
    }
}

/// The region's surface in this step.
struct Faces<'a> {
    region: Option<&'a Region>,
    look: Look<'a>,
}

impl Wall for Faces<'_> {
    fn close(&self, x: [f64; 3], reach: f64, spare: &mut Vec<Near>) -> bool {
        self.region.is_some_and(|r| r.close(x, reach, spare))
    }

    fn near(&self, x: [f64; 3], reach: f64, out: &mut Vec<Near>) {
        if let Some(region) = self.region {
            region.near(x, reach, &self.look, out);
        }
    }

    fn passes_some(&self) -> bool {
        self.region.is_some_and(|r| matches!(r.shape, Shape::Mesh(_)))
    }

    fn passes(&self, from: u32, to: u32) -> bool {
        self.region.is_some_and(|r| r.passes(from, to))
    }

    fn holds(&self, _near: &Near) -> bool {
        // LAMMPS ends contacts with regions at once.
        !self.look.lammps
    }
}
