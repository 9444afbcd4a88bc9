//! The shape of an indenter, of which a line has one.

use super::form::{Form, check_ends};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::{Args, Param, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{At, Axis, Grammar, Keyword, Kind, Part, Value, Words};

/// The shape.
pub struct Indenter(pub Option<Form<Param>>);

#[derive(Words)]
struct Sphere {
    #[word(name = "x y z", what = "{}")]
    center: [Param; 3],
    #[word(name = "R")]
    radius: Radius,
}

#[derive(Words)]
struct Cylinder {
    #[word(name = "dim", what = "axis of the cylinder")]
    axis: Axis,
    #[word(name = "c1 c2", what = "{}")]
    center: [Param; 2],
    #[word(name = "R")]
    radius: Radius,
}

#[derive(Words)]
struct Cone {
    #[word(name = "dim", what = "axis of the cone")]
    axis: Axis,
    #[word(name = "c1 c2", what = "{}")]
    center: [Param; 2],
    #[word(name = "radlo radhi")]
    radii: [Radius; 2],
    #[word(name = "lo", what = "the cone's lower end")]
    low: At<Param>,
    #[word(name = "hi", what = "the cone's upper end")]
    high: At<Param>,
}

#[derive(Words)]
struct Plane {
    #[word(name = "dim", what = "direction of the plane")]
    axis: Axis,
    #[word(name = "pos", what = "the plane's position")]
    place: Param,
    #[word(name = "side")]
    end: End,
}

/// The end of an axis from which a plane pushes.
#[derive(PartialEq, Words)]
#[word(what = "side of the plane")]
enum End {
    /// What is below is pushed upwards.
    Lo,
    /// What is above is pushed downwards.
    Hi,
}

/// A number that is not negative, or an equal-style variable.
struct Radius(Param);

impl Value for Radius {
    const KIND: Kind = Kind::Param;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let span = args.here();
        match Param::value("the radius", args, cx)? {
            Param::Number(r) if r < 0.0 => fail(Code::BAD_VALUE, span, "the radius must not be negative"),
            p => Ok(Self(p)),
        }
    }
}

const fn shape(word: &'static str, values: &'static [Part], about: &'static str) -> Keyword {
    Keyword { word, values, about, default: "", repeats: false }
}

impl Words for Indenter {
    const GRAMMAR: &'static Grammar = &Grammar {
        parts: &[],
        keywords: &[
            shape(
                "sphere",
                &[Part::All(Sphere::GRAMMAR)],
                "A sphere around (x, y, z): numbers, or `v_name` of equal-style variables.",
            ),
            shape(
                "cylinder",
                &[Part::All(Cylinder::GRAMMAR)],
                "A cylinder without ends along an axis through the other two coordinates.",
            ),
            shape(
                "cone",
                &[Part::All(Cone::GRAMMAR)],
                "A cone between discs of the radii radlo and radhi at the places lo and hi on its axis, one of which may be a point; the \
                 depth is that below the nearest face, end faces included, and the force is across it.",
            ),
            shape(
                "plane",
                &[Part::All(Plane::GRAMMAR)],
                "A half-space: `lo` pushes what is below pos upwards, `hi` what is above downwards.",
            ),
        ],
        refused: &[],
    };

    fn begin(_: &mut Args, _: &BuildCx) -> Result<Self> {
        Ok(Self(None))
    }

    fn keyword(&mut self, word: &Word, args: &mut Args, cx: &BuildCx) -> Result<bool> {
        if self.0.is_some() && Self::GRAMMAR.has(&word.text) {
            return fail(Code::CONFLICT, word.span, "an indenter has one shape; use a second fix");
        }
        self.0 = Some(match word.text.as_str() {
            "sphere" => {
                let Sphere { center, radius } = Sphere::begin(args, cx)?;
                Form::Sphere { center, radius: radius.0 }
            }
            "cylinder" => {
                let Cylinder { axis, center, radius } = Cylinder::begin(args, cx)?;
                Form::Cylinder { axis: axis.0, center, radius: radius.0 }
            }
            "cone" => {
                let Cone { axis, center, radii, low, high } = Cone::begin(args, cx)?;
                if let (Param::Number(lo), Param::Number(hi)) = (&low.value, &high.value) {
                    check_ends(*lo, *hi).map_err(|e| e.at(low.span.to(high.span)))?;
                }
                let (radii, ends) = (radii.map(|r| r.0), [low.value, high.value]);
                Form::Cone { axis: axis.0, center, radii, ends }
            }
            "plane" => {
                let Plane { axis, place, end } = Plane::begin(args, cx)?;
                Form::Plane { axis: axis.0, place, high: end == End::Hi }
            }
            _ => return Ok(false),
        });
        Ok(true)
    }
}
