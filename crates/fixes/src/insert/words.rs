//! The words of fix insert.

use super::clumps::{Orientation, check};
use super::face::{Face, Fault};
use super::place::Bounded;
use super::{Content, Flow, Inserting, Packets, Place, Spread, Way};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail, nearest};
use perigrain_base::math::vec3::Vec3;
use perigrain_lang::{Args, Word};
use perigrain_styles::words::{At, Grammar, Kind, Part, Value, Words, read};
use perigrain_styles::{BuildCx, UseKind, triangles};
use perigrain_world::Mixture;
use std::sync::Arc;

/// The words of the line.
#[derive(Words)]
pub struct Line {
    /// The mixture that is inserted.
    #[word(name = "MIX")]
    mixture: Mixed,
    #[word(name = "way")]
    way: At<Kinds>,
    /// Where grains appear (`pack`, `rate`): a bounded region at rest.
    #[word(keyword, name = "ID", placed)]
    region: Option<At<Word>>,
    /// What grains come out of (`stream`): a fix with a surface, or a file of triangles; all of them in one plane.
    #[word(keyword, name = "ID|FILE")]
    face: Option<Word>,
    /// The part of the region's volume that grains fill (`pack`), below 1.
    #[word(keyword, name = "f", placed)]
    share: Option<At<Share>>,
    /// How many grains: with `pack` in the region, else in all, where `INF` has no end.
    #[word(keyword, name = "N|INF", placed)]
    number: Option<At<Total>>,
    /// The mass of grains: with `pack` in the region, else in all [mass].
    #[word(keyword, name = "M|INF", placed)]
    mass: Option<At<Total>>,
    /// Grains in a unit of time (`rate`, `stream`) [1/time].
    #[word(keyword, name = "r", what = "the rate", positive, placed)]
    rate: Option<At<f64>>,
    /// Mass in a unit of time (`rate`, `stream`) [mass/time].
    #[word(keyword, name = "q", what = "the mass rate", positive, placed)]
    massrate: Option<At<f64>>,
    /// The distance of insertions: without it `pack` inserts once [steps].
    #[word(keyword, name = "N", what = "the number of steps N", from = 1, placed)]
    every: Option<At<i64>>,
    /// How far a packet reaches upstream of the face (`stream`): it sets `every` [length].
    #[word(keyword, name = "L", positive, placed)]
    length: Option<At<f64>>,
    /// The time in which a packet passes the face (`stream`): without it that of `every` [steps].
    #[word(keyword, name = "du", what = "the time during which a packet passes", from = 1, placed)]
    during: Option<At<i64>>,
    /// The seed of the random numbers.
    #[word(keyword, name = "S", from = 1, shown = "that of the mixture")]
    seed: Option<u32>,
    /// How many places are tried for each grain of an insertion, all grains together.
    #[word(keyword, name = "n", from = 1, default = 50)]
    tries: u64,
    /// Velocities: all the same, or uniform within ± f about the mean, or normal with the standard deviation f [velocity].
    #[word(keyword, name = "velocities", shown = "0 0 0")]
    vel: Option<Velocity>,
    /// Angular velocity [1/time].
    #[word(keyword, name = "wx wy wz", what = "{}", shown = "0 0 0")]
    omega: [f64; 3],
    /// Whether places where a grain would touch another one are refused.
    #[word(keyword, default = true)]
    overlap: bool,
    /// Whether whole grains lie inside, and not their centres alone.
    #[word(keyword, default = false)]
    inside: bool,
    /// How grains of several spheres are turned.
    #[word(keyword, default = Orientation::Template)]
    orientation: Orientation,
    /// The step of the first insertion: without it the one after the line.
    #[word(keyword, name = "step", from = 0)]
    start: Option<i64>,
}

/// How grains are inserted.
#[derive(Clone, Copy, Words)]
#[word(what = "way of inserting")]
enum Kinds {
    /// The region is filled up to a share of its volume, a number or a mass, counting what is in it then.
    Pack,
    /// So many grains in a unit of time at places in the region, until they are all there.
    Rate,
    /// A stream through a face: packets appear upstream of it and fly up to it free of all forces.
    Stream,
}

impl Kinds {
    fn name(self) -> &'static str {
        match self {
            Self::Pack => "pack",
            Self::Rate => "rate",
            Self::Stream => "stream",
        }
    }
}

/// A mixture by its ID.
struct Mixed(Arc<Mixture>);

impl Value for Mixed {
    const KIND: Kind = Kind::Text;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("the ID of a mixture")?;
        if let Some(mixture) = cx.world.mixtures.get(&word.text) {
            return Ok(Self(mixture.clone()));
        }
        let text = format!("there is no mixture `{}`", word.text);
        let d = Diagnostic::error(Code::UNKNOWN_NAME, word.span, text);
        Err(match nearest(&word.text, cx.world.mixtures.keys().map(String::as_str)) {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None => d.help("declare one before this line: `mixture ID number SEED sphere TYPE DIAM DENS 1`"),
        }
        .into())
    }
}

/// A part below 1.
struct Share(f64);

impl Value for Share {
    const KIND: Kind = Kind::Number;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let (span, share) = (args.here(), args.positive("the share of the volume")?);
        match share < 1.0 {
            true => Ok(Self(share)),
            false => fail(Code::BAD_VALUE, span, format!("a share of the volume is below 1: {share}")),
        }
    }
}

/// A number, or `INF` for no end.
struct Total(f64);

impl Value for Total {
    const KIND: Kind = Kind::Number;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        if args.eat("INF") {
            return Ok(Self(f64::INFINITY));
        }
        args.positive("how much there is to be").map(Self)
    }
}

/// Velocities.
struct Velocity(Vec3, Spread);

impl Value for Velocity {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[
            Part::number("vx"),
            Part::number("vy"),
            Part::number("vz"),
            Part::Maybe(&[
                Part::bare("uniform|gaussian", Kind::Text),
                Part::number("fx"),
                Part::number("fy"),
                Part::number("fz"),
            ]),
        ],
        keywords: &[],
        refused: &[],
    });
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let mean = [args.number("vx")?, args.number("vy")?, args.number("vz")?];
        Ok(match args.peek_text() {
            "uniform" => {
                args.next();
                Self(mean, Spread::Uniform(about_of(args, "half width")?))
            }
            "gaussian" => {
                args.next();
                Self(mean, Spread::Gaussian(about_of(args, "standard deviation")?))
            }
            _ => Self(mean, Spread::None),
        })
    }
}

/// Three numbers that are not negative.
fn about_of(args: &mut Args, what: &str) -> Result<Vec3> {
    let mut one = |d: &str| args.non_negative(&format!("the {what} of v{d}"));
    Ok([one("x")?, one("y")?, one("z")?])
}

/// The fix of a line.
///
/// # Errors
/// Words that are missing, or belong to another way of inserting.
pub fn build(args: &mut Args, cx: &BuildCx) -> Result<Inserting> {
    let line: Line = read(args, cx)?;
    refuse_foreign(&line)?;
    let Velocity(mean, spread) = line.vel.unwrap_or(Velocity([0.0; 3], Spread::None));
    let mixture = line.mixture.0;
    check(&mixture, cx)?;
    let named = Named { way: line.way, end: args.here() };
    let place = match line.way.value {
        Kinds::Stream => Place::Face(Arc::new(face(named.face(line.face)?, mean, cx)?)),
        _ => Place::Region(Arc::new(Bounded::new(&named.region(line.region)?, cx)?)),
    };
    let way = match line.way.value {
        Kinds::Pack => {
            let given = [line.share.is_some(), line.number.is_some(), line.mass.is_some()];
            if given.iter().filter(|there| **there).count() != 1 {
                return named.lacks("one of `share f`, `number N` and `mass M`");
            }
            let content = match (line.share, line.number, line.mass) {
                (Some(share), ..) => Content::Share(share.value.0),
                (_, Some(number), _) => Content::Number(finite(&number)?),
                (.., Some(mass)) => Content::Mass(finite(&mass)?),
                _ => return named.lacks("one of `share f`, `number N` and `mass M`"),
            };
            Way::Pack { content, every: line.every.map(|every| every.value) }
        }
        kind => {
            let mean_mass = mixture.mean_mass();
            let total = match (line.number, line.mass) {
                (Some(number), None) => number.value.0,
                // A product such as 0.3 (1/0.1) may be rounded to a little less than a whole number.
                (None, Some(mass)) => mass.value.0 / mean_mass * (1.0 + 1e-12),
                _ => return named.lacks("one of `number N` and `mass M`"),
            };
            let rate = match (line.rate, line.massrate) {
                (Some(rate), None) => rate.value,
                (None, Some(rate)) => rate.value / mean_mass,
                _ => return named.lacks("one of `rate r` and `massrate q`"),
            };
            let flow = Flow { total: total.is_finite().then_some(total as u64), rate };
            match (kind, line.length, line.every) {
                (Kinds::Stream, Some(length), None) => {
                    Way::Stream { flow, packets: Packets::Length(length.value) }
                }
                (Kinds::Stream, None, Some(every)) => {
                    let during = line.during.map_or(every.value, |during| during.value);
                    Way::Stream { flow, packets: Packets::Every(every.value, during) }
                }
                (Kinds::Stream, ..) => return named.lacks("one of `length L` and `every N`"),
                (_, _, Some(every)) => Way::Rate { flow, every: every.value },
                _ => return named.lacks("`every N`"),
            }
        }
    };
    Ok(Inserting {
        id: cx.id.to_string(),
        group: cx.group,
        seed: line.seed.unwrap_or(mixture.seed),
        mixture,
        place,
        way,
        tries: line.tries,
        mean,
        spread,
        omega: line.omega,
        overlap: line.overlap,
        inside: line.inside,
        orientation: line.orientation,
        start: line.start,
    })
}

/// Refuses keywords that belong to another way of inserting.
fn refuse_foreign(line: &Line) -> Result<()> {
    use Kinds::{Pack, Rate, Stream};
    let span = |at: &Option<At<f64>>| at.as_ref().map(|at| at.span);
    let whole = |at: &Option<At<i64>>| at.as_ref().map(|at| at.span);
    let rows: [(Option<Span>, &str, &[Kinds]); 7] = [
        (line.share.as_ref().map(|at| at.span), "share", &[Pack]),
        (line.region.as_ref().map(|at| at.span), "region", &[Pack, Rate]),
        (line.face.as_ref().map(|word| word.span), "face", &[Stream]),
        (span(&line.rate), "rate", &[Rate, Stream]),
        (span(&line.massrate), "massrate", &[Rate, Stream]),
        (span(&line.length), "length", &[Stream]),
        (whole(&line.during), "during", &[Stream]),
    ];
    let own = line.way.value.name();
    for (span, word, ways) in rows {
        if span.is_some() && !ways.iter().any(|way| way.name() == own) {
            let ways: Vec<String> = ways.iter().map(|way| format!("`{}`", way.name())).collect();
            let text = format!("`{word}` belongs to {}, not to `{own}`", ways.join(" and "));
            return fail(Code::CONFLICT, span, text);
        }
    }
    Ok(())
}

/// The way of inserting, for messages about what it lacks.
struct Named {
    way: At<Kinds>,
    end: Span,
}

impl Named {
    fn lacks<T>(&self, what: &str) -> Result<T> {
        let text = format!("`{}` needs {what}", self.way.value.name());
        let d = Diagnostic::error(Code::MISSING_ARGUMENT, self.way.span.to(self.end), text);
        Err(d.help(format!("for example: {}", self.example())).into())
    }

    fn example(&self) -> &'static str {
        match self.way.value {
            Kinds::Pack => "pack region R share 0.3",
            Kinds::Rate => "rate region R number 1000 rate 500 every 1000",
            Kinds::Stream => "stream face ID number 1000 rate 500 length 0.05 vel 0 0 -1",
        }
    }

    fn region(&self, region: Option<At<Word>>) -> Result<Word> {
        region.map_or_else(|| self.lacks("`region ID`"), |word| Ok(word.value))
    }

    fn face(&self, face: Option<Word>) -> Result<Word> {
        face.map_or_else(|| self.lacks("`face ID`"), Ok)
    }
}

/// How much is to be in a region: there is an end.
fn finite(total: &At<Total>) -> Result<f64> {
    match total.value.0 {
        x if x.is_finite() => Ok(x),
        _ => fail(Code::BAD_VALUE, total.span, "a region is filled up to an amount, not to `INF`"),
    }
}

/// The face of a word: the surface of a fix, where it is now, or of a file; `mean`: where grains go.
fn face(word: Word, mean: Vec3, cx: &BuildCx) -> Result<Face> {
    let fix = cx.names.fix(&word.text).is_some();
    let triangles = match cx.world.outlines.look_up(&word.text).filter(|_| fix) {
        Some(outline) => {
            cx.uses(UseKind::Fix, &word.text);
            outline.triangles(cx.world)
        }
        None if fix => {
            let text = format!("fix `{}` has no surface of triangles", word.text);
            return fail(Code::WRONG_KIND, word.span, text);
        }
        None => match triangles::read_faces(&word, cx)? {
            Some(surface) => surface.triangles,
            None => return Ok(Face::unseen()),
        },
    };
    Face::new(triangles, mean).map_err(|fault| {
        let help = match fault {
            Fault::Bent => "grains come out of a plane: `surface` and `wall/mesh` take other surfaces",
            Fault::Along => "write a velocity that leads through the face, for example `vel 0 0 -1`",
        };
        let text = match fault {
            Fault::Bent => format!("the triangles of `{}` are not in one plane", word.text),
            Fault::Along => {
                format!("grains of the mean velocity {mean:?} do not pass the face `{}`", word.text)
            }
        };
        Diagnostic::error(Code::BAD_VALUE, word.span, text).help(help).into()
    })
}
