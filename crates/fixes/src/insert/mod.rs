//! fix insert: puts grains of a mixture into a region, or lets them stream through a face.

mod clumps;
mod face;
mod flight;
mod op;
mod place;
mod state;
mod words;

use super::{Facts, Fix, FixStyle, needs_spheres};
use crate::window::forget;
use clumps::Orientation;
use face::Face;
use flight::Flight;
use op::Source;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::{Vec3, dot};
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::pair::ToCome;
use perigrain_styles::words::{Syntax, Words};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::{GroupId, Key, Mixture, Numbers, World};
use place::Bounded;
use state::State;
use std::sync::Arc;
use words::Line;

/// The style.
pub struct Insert;

impl Style for Insert {
    fn name(&self) -> &'static str {
        "insert"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Inserts grains of a mixture: fills a region, adds grains at a rate, or lets a stream come out of a face.",
            text: "Not in LAMMPS. `pack` counts what is in the region when it acts: (f V − ΣV)/⟨V⟩, N − n or (M − Σm)/⟨m⟩ grains are \
                   missing, with the means over the number of grains; `rate` adds r N Δt grains every N steps until N or M/⟨m⟩, rounded \
                   down, are there. A part of a grain is one more with its probability. New grains join `all` and the fix's \
                   group, the largest kinds first. Places are tried `tries` times the number of grains; what finds none is lost \
                   to `pack`, and made up for later by the others. A warning at the end of a run counts them.\n\n\
                   `stream`: each packet appears in the volume upstream of the face, as the mean velocity leads through it, \
                   whichever way the face looks. Its grains fly along the face's normal at the mean velocity's part across the \
                   face, without any force on them, and others feel them. In the last step before its centre passes the face a grain \
                   gets its own velocity and spin. `length` L makes a packet every L/(v_n Δt) steps; with `every` it is v_n N Δt \
                   long, or with `during` v_n du Δt, which leaves gaps. The face is where the fix's surface is when the line is \
                   read.\n\n\
                   Grains of several spheres (`mixture … mol`) get molecule IDs of their own, and a `fix rigid/small … mol` of the same \
                   template moves them, unless the template has bonds; `neigh_modify exclude molecule/intra all` keeps spheres of one grain \
                   from pushing each other apart. Their centre of mass counts as their place, the sphere about it that holds them as \
                   their size for `inside`, each of their spheres for overlaps. Of such grains that are in the region already each counts \
                   by the part of its spheres inside.\n\n\
                   A region's part beyond fixed or periodic faces of the box is left out; volumes without a formula (unions, intersections) \
                   are counted on a lattice of 80 points along each axis. With `overlap no` grains may lie in each other, which a warning \
                   states. Runs continue where the last one ended, also after a restart, with grains on their way. Scalar: how many \
                   there are so far (intensive). Vector: their number and mass (intensive).\n\n\
                   Source: LIGGGHTS manual, fix insert/pack, insert/rate/region, insert/stream; counts per insertion, the flight of streams and \
                   their first steps measured with LIGGGHTS 3.8.0.",
            example: "region slot block -0.002 0.002 -0.002 0.002 0.005 0.008 units box\n\
                      mixture gravel mass 32452843 sphere 2 0.0005 2500 0.3 sphere 2 0.0006 2500 0.7\n\
                      fix fill grains insert gravel pack region slot number 20 vel 0 0 -0.1 inside yes",
        }
    }
}

impl FixStyle for Insert {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        needs_spheres(cx, "insert")?;
        if cx.world.settings.two_dimensional {
            let text = "fix insert fills volumes, and this scene is flat";
            let d = Diagnostic::error(Code::NOT_SUPPORTED, cx.span, text);
            return Err(d.help("fix pour and fix deposit insert grains in flat scenes").into());
        }
        let fix = words::build(args, cx)?;
        if !fix.overlap {
            let text = "`overlap no`: grains may lie in others, which throws both out at high speed";
            let d = Diagnostic::warning(Code::SUSPICIOUS, cx.span, text);
            cx.note(d.help("leave it out unless the region is known to be empty"));
        }
        Ok(Box::new(fix))
    }
}

/// Where grains appear.
#[derive(Clone, Debug)]
enum Place {
    /// In a region.
    Region(Arc<Bounded>),
    /// Upstream of a face.
    Face(Arc<Face>),
}

/// To what a region is filled up.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Content {
    /// A part of its volume.
    Share(f64),
    /// A number of grains.
    Number(f64),
    /// Their mass [mass].
    Mass(f64),
}

/// Grains by time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Flow {
    /// How many in all; nothing for no end.
    total: Option<u64>,
    /// How many in a unit of time [1/time].
    rate: f64,
}

/// How a stream is cut into packets.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Packets {
    /// So long [length].
    Length(f64),
    /// Steps between two packets, and those in which one passes the face.
    Every(i64, i64),
}

/// When grains are inserted, and how many.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    /// Up to a content, every so many steps or once.
    Pack { content: Content, every: Option<i64> },
    /// Steadily.
    Rate { flow: Flow, every: i64 },
    /// Packet by packet.
    Stream { flow: Flow, packets: Packets },
}

/// How velocities differ from their mean [velocity].
#[derive(Clone, Copy, Debug, PartialEq)]
enum Spread {
    /// Not.
    None,
    /// Uniform, by at most so much.
    Uniform(Vec3),
    /// Normal, with these standard deviations.
    Gaussian(Vec3),
}

impl Spread {
    fn draw(&self, mean: Vec3, stream: &mut ParkMiller) -> Vec3 {
        match self {
            Self::None => mean,
            Self::Uniform(by) => [0, 1, 2].map(|d| mean[d] + by[d] * (2.0 * stream.uniform() - 1.0)),
            Self::Gaussian(by) => [0, 1, 2].map(|d| mean[d] + by[d] * stream.gaussian()),
        }
    }
}

/// A declared fix insert.
#[derive(Clone, Debug)]
struct Inserting {
    id: String,
    group: GroupId,
    mixture: Arc<Mixture>,
    place: Place,
    way: Way,
    seed: u32,
    /// Attempts per grain.
    tries: u64,
    /// Mean velocity [velocity].
    mean: Vec3,
    spread: Spread,
    /// Angular velocity [1/time].
    omega: Vec3,
    overlap: bool,
    inside: bool,
    /// How grains of several spheres are turned.
    orientation: Orientation,
    /// The first step.
    start: Option<i64>,
}

/// The packets of a stream.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Packet {
    /// How far it reaches upstream [length].
    length: f64,
    /// How fast it flies [velocity].
    speed: f64,
}

impl Inserting {
    fn key(&self) -> Numbers {
        Key::new(&format!("insert/{}", self.id))
    }

    /// Steps between insertions, if there are several, and the packets of a stream.
    fn rhythm(&self, dt: f64, span: Span) -> Result<(Option<i64>, Option<Packet>)> {
        let (packets, face) = match (&self.way, &self.place) {
            (Way::Pack { every, .. }, _) => return Ok((*every, None)),
            (Way::Rate { every, .. }, _) => return Ok((Some(*every), None)),
            (Way::Stream { packets, .. }, Place::Face(face)) => (packets, face),
            (Way::Stream { .. }, Place::Region(_)) => return Ok((None, None)),
        };
        let speed = dot(self.mean, face.normal);
        let (every, length) = match *packets {
            Packets::Length(length) => ((length / (speed * dt) + 0.5) as i64, length),
            Packets::Every(every, during) => (every, speed * during as f64 * dt),
        };
        if every < 1 {
            let text = format!("a packet of length {length} passes the face in less than a step of {dt}");
            return fail(Code::BAD_VALUE, span, text);
        }
        let widest = self.mixture.widest();
        if self.inside && length < 2.0 * widest {
            let text = format!("packets of length {length} hold no whole grain of diameter {}", 2.0 * widest);
            let d = Diagnostic::error(Code::BAD_VALUE, span, text);
            return Err(d.help("make them longer by `length` or `every`, or leave `inside yes` out").into());
        }
        Ok((Some(every), Some(Packet { length, speed })))
    }

    fn flow(&self) -> Option<Flow> {
        match self.way {
            Way::Pack { .. } => None,
            Way::Rate { flow, .. } | Way::Stream { flow, .. } => Some(flow),
        }
    }
}

impl Fix for Inserting {
    fn facts(&self, _: &World) -> Facts {
        let streams = matches!(self.way, Way::Stream { .. });
        Facts {
            makes_particles: true,
            acts_last: streams,
            needs_whole_steps: streams.then_some("grains on their way to the face fly whole steps"),
            ..Facts::default()
        }
    }

    fn to_come(&self, _: &World) -> Vec<ToCome> {
        let mask = GroupId::ALL.bit() | self.group.bit();
        let kinds = self.mixture.kinds.iter().filter(|kind| kind.share > 0.0);
        kinds.flat_map(|kind| clumps::to_come(kind, mask)).collect()
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        State::new(self.seed).store(w, self.key());
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.key());
        forget(w, self.key());
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        let log = cx.log();
        let slot = cx.slot(&format!("f_{}", self.id));
        let dt = cx.world().clock.dt;
        let movers = clumps::movers(&self.mixture, cx)?;
        let (every, packet) = self.rhythm(dt, span)?;
        let mut ops: Vec<Box<dyn Op>> = vec![];
        if let (Some(packet), Place::Face(face)) = (packet, &self.place) {
            ops = Flight::ops(self, face.normal, packet.speed, &movers);
        }
        ops.push(Box::new(Source::new(self, cx.world(), (every, packet), (span, slot), &log)?));
        Ok(ops)
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, vector: 2, ..Shape::default() }
    }
}
