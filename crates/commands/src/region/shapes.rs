//! The words of each region shape.

use super::{Options, parts};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::{Args, Param, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::triangles::Placing;
use perigrain_styles::words::{Alternative, At, Axis, Grammar, Kind, Part, Value, Words};
use perigrain_world::Region;
use perigrain_world::region::{Given, INFINITE, Shape, Variable, across};

/// A shape with the numbers that variables give, and what else its line says.
type Made = (Shape, Vec<Given>, Options);

#[derive(Words)]
pub struct Block {
    #[word(flatten)]
    corners: Corners,
    #[word(flatten)]
    options: Options,
}

#[derive(Words)]
pub struct Prism {
    #[word(flatten)]
    corners: Corners,
    /// The tilt.
    #[word(name = "XY XZ YZ")]
    tilt: [At<Param>; 3],
    #[word(flatten)]
    options: Options,
}

/// Two corners.
#[derive(Words)]
struct Corners {
    #[word(name = "XLO", what = "the lower bound")]
    xlo: At<Bound>,
    #[word(name = "XHI", what = "the upper bound")]
    xhi: At<Bound>,
    #[word(name = "YLO", what = "the lower bound")]
    ylo: At<Bound>,
    #[word(name = "YHI", what = "the upper bound")]
    yhi: At<Bound>,
    #[word(name = "ZLO", what = "the lower bound")]
    zlo: At<Bound>,
    #[word(name = "ZHI", what = "the upper bound")]
    zhi: At<Bound>,
}

#[derive(Words)]
pub struct Cone {
    #[word(name = "x|y|z", what = "axis of the cone")]
    axis: Axis,
    #[word(name = "C1 C2", what = "the axis")]
    line: [Param; 2],
    /// The radius.
    #[word(name = "RLO RHI")]
    radius: [At<Param>; 2],
    #[word(name = "LO", what = "the lower bound")]
    lo: At<Bound>,
    #[word(name = "HI", what = "the upper bound")]
    hi: At<Bound>,
    #[word(flatten)]
    options: Options,
}

#[derive(Words)]
pub struct Cylinder {
    #[word(name = "x|y|z", what = "axis of the cylinder")]
    axis: Axis,
    #[word(name = "C1 C2", what = "the axis")]
    line: [Param; 2],
    /// The radius.
    #[word(name = "R")]
    radius: At<Param>,
    #[word(name = "LO", what = "the lower bound")]
    lo: At<Bound>,
    #[word(name = "HI", what = "the upper bound")]
    hi: At<Bound>,
    #[word(flatten)]
    options: Options,
}

#[derive(Words)]
pub struct Ellipsoid {
    #[word(name = "X Y Z", what = "the centre")]
    center: [Param; 3],
    #[word(name = "A B C", what = "half an axis")]
    half: [Param; 3],
    #[word(flatten)]
    options: Options,
}

#[derive(Words)]
pub struct Plane {
    #[word(name = "PX PY PZ", what = "a point of the plane")]
    point: [Param; 3],
    #[word(name = "NX NY NZ", what = "the normal")]
    normal: [Param; 3],
    #[word(flatten)]
    options: Options,
}

#[derive(Words)]
pub struct Sphere {
    #[word(name = "X Y Z", what = "the centre")]
    center: [Param; 3],
    /// The radius.
    #[word(name = "R")]
    radius: At<Param>,
    #[word(flatten)]
    options: Options,
}

#[derive(Words)]
pub struct Mesh {
    /// The file.
    #[word(name = "FILE", what = "the name of a file of triangles", kind = Kind::File)]
    pub file: Word,
    #[word(flatten)]
    pub placing: Placing,
    /// Turns the body by an angle about an axis through the origin, after `scale` and `shift`; several turns are made one after another
    /// [degrees].
    #[word(keyword, name = "X Y Z ANGLE")]
    pub turn: Vec<(At<f64>, f64, f64, f64)>,
    #[word(flatten)]
    pub options: Options,
}

#[derive(Words)]
pub struct Combined {
    #[word(name = "parts")]
    pub parts: Parts,
    #[word(flatten)]
    pub options: Options,
}

/// How many regions, and which.
pub struct Parts(pub Vec<Region>);

impl Value for Parts {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[Part::bare("N", Kind::Whole), Part::Many(&[Part::bare("ID", Kind::Region)], 2)],
        ..*Grammar::NONE
    });
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        parts(args, cx).map(Self)
    }
}

/// A bound along an axis.
enum Bound {
    Number(Param),
    /// Far away.
    Infinite,
    /// The face of the box.
    Edge,
}

impl Value for Bound {
    const KIND: Kind = Kind::Or(
        &Kind::Choice(&[
            Alternative { word: "INF", about: "", parts: &[] },
            Alternative { word: "EDGE", about: "", parts: &[] },
        ]),
        &Kind::Param,
    );
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let Some(word) = args.peek().filter(|w| w.text == "INF" || w.text == "EDGE") else {
            return Param::value(what, args, cx).map(Self::Number);
        };
        if cx.world.domain.is_none() {
            let text = format!("`{}` means nothing before the simulation box is defined", word.text);
            return fail(Code::WRONG_ORDER, word.span, text);
        }
        args.next();
        Ok(if word.text == "INF" { Self::Infinite } else { Self::Edge })
    }
}

/// Takes a shape's numbers one by one into box units and keeps which ones variables give.
struct Reader<'a> {
    cx: &'a BuildCx<'a>,
    spacing: [f64; 3],
    /// Numbers that variables give.
    given: Vec<Given>,
    /// How many numbers have been read.
    count: usize,
}

impl<'a> Reader<'a> {
    fn new(options: &Options, cx: &'a BuildCx<'a>) -> Self {
        Self { cx, spacing: options.units.scales(cx.world), given: vec![], count: 0 }
    }

    /// A number, or NaN until the variable gives it.
    fn number(&mut self, p: &Param, scale: f64) -> f64 {
        self.count += 1;
        match p {
            Param::Number(x) => scale * x,
            Param::Ref(r) => {
                let variable = Variable { name: r.name.clone(), span: r.span };
                self.given.push(Given { number: self.count - 1, variable, scale });
                f64::NAN
            }
        }
    }

    fn triple(&mut self, [x, y, z]: &[Param; 3]) -> [f64; 3] {
        let [sx, sy, sz] = self.spacing;
        [self.number(x, sx), self.number(y, sy), self.number(z, sz)]
    }

    /// A radius across an axis, in the spacing of the first direction across it.
    fn radius(&mut self, radius: &At<Param>, d: usize) -> Result<f64> {
        let r = self.number(&radius.value, self.spacing[d]);
        if r < 0.0 {
            return fail(Code::BAD_VALUE, radius.span, format!("the radius must not be negative: {r}"));
        }
        Ok(r)
    }

    /// A bound along axis `d`.
    fn bound(&mut self, bound: &Bound, d: usize, upper: bool) -> f64 {
        let domain = self.cx.world.domain.as_ref();
        match (bound, domain) {
            (Bound::Number(p), _) => self.number(p, self.spacing[d]),
            // Of a leaning box, the upright one around it.
            (Bound::Edge, Some(domain)) => {
                self.count += 1;
                domain.bounds()[d][usize::from(upper)]
            }
            _ => {
                self.count += 1;
                if upper { INFINITE } else { -INFINITE }
            }
        }
    }

    fn range(&mut self, from: &At<Bound>, to: &At<Bound>, d: usize) -> Result<(f64, f64)> {
        let mut lo = self.bound(&from.value, d, false);
        let mut hi = self.bound(&to.value, d, true);
        // A number that only a run determines lies anywhere between the bounds (`perigrain check`).
        match [from.unknown, to.unknown] {
            [_, true] if hi <= lo => hi = lo + self.spacing[d],
            [true, false] if hi <= lo => lo = hi - self.spacing[d],
            _ => {}
        }
        if lo > hi {
            let text = format!("the lower bound {lo} lies above the upper bound {hi}");
            return fail(Code::BAD_VALUE, from.span.to(to.span), text);
        }
        Ok((lo, hi))
    }

    fn corners(&mut self, c: &Corners) -> Result<([f64; 3], [f64; 3])> {
        let x = self.range(&c.xlo, &c.xhi, 0)?;
        let y = self.range(&c.ylo, &c.yhi, 1)?;
        let z = self.range(&c.zlo, &c.zhi, 2)?;
        Ok(([x.0, y.0, z.0], [x.1, y.1, z.1]))
    }

    fn line(&mut self, [x, y]: &[Param; 2], axis: usize) -> [f64; 2] {
        let [c, d] = across(axis);
        [self.number(x, self.spacing[c]), self.number(y, self.spacing[d])]
    }
}

impl Block {
    /// The shape.
    ///
    /// # Errors
    /// Numbers that do not go together, here and below.
    pub fn made(self, cx: &BuildCx) -> Result<Made> {
        let mut r = Reader::new(&self.options, cx);
        let (lo, hi) = r.corners(&self.corners)?;
        Ok((Shape::Block { lo, hi }, r.given, self.options))
    }
}

impl Prism {
    /// The shape.
    pub fn made(self, cx: &BuildCx) -> Result<Made> {
        let mut r = Reader::new(&self.options, cx);
        let (lo, hi) = r.corners(&self.corners)?;
        let (span, [sx, sy, _]) = (self.tilt[0].span, r.spacing);
        let [xy, xz, yz] = self.tilt.each_ref().map(|t| &t.value);
        let tilt = [r.number(xy, sx), r.number(xz, sx), r.number(yz, sy)];
        let endless = |d: usize| lo[d] == -INFINITE && hi[d] == INFINITE;
        for (tilt, pair) in tilt.iter().zip([[0, 1], [0, 2], [1, 2]]) {
            if *tilt != 0.0 && pair.into_iter().any(endless) {
                return fail(Code::BAD_VALUE, span, "an endless prism cannot be tilted in that direction");
            }
        }
        if cx.world.settings.two_dimensional && (tilt[1] != 0.0 || tilt[2] != 0.0) {
            return fail(Code::BAD_VALUE, span, "the tilts xz and yz of a flat scene must be 0");
        }
        Ok((Shape::Prism { lo, hi, tilt }, r.given, self.options))
    }
}

impl Cone {
    /// The shape.
    pub fn made(self, cx: &BuildCx) -> Result<Made> {
        let (mut r, Axis(axis)) = (Reader::new(&self.options, cx), self.axis);
        let center = r.line(&self.line, axis);
        let d = across(axis)[0];
        let radius = [r.radius(&self.radius[0], d)?, r.radius(&self.radius[1], d)?];
        let (lo, hi) = r.range(&self.lo, &self.hi, axis)?;
        Ok((Shape::Cone { axis, center, radius, lo, hi }, r.given, self.options))
    }
}

impl Cylinder {
    /// The shape.
    pub fn made(self, cx: &BuildCx) -> Result<Made> {
        let (mut r, Axis(axis)) = (Reader::new(&self.options, cx), self.axis);
        let center = r.line(&self.line, axis);
        let radius = r.radius(&self.radius, across(axis)[0])?;
        let given = r.given.len();
        let (lo, hi) = r.range(&self.lo, &self.hi, axis)?;
        if r.given.len() > given {
            let text = "the ends of a cylinder must be numbers, INF or EDGE";
            return fail(Code::NOT_SUPPORTED, self.lo.span, text);
        }
        Ok((Shape::Cylinder { axis, center, radius, lo, hi }, r.given, self.options))
    }
}

impl Ellipsoid {
    /// The shape.
    pub fn made(self, cx: &BuildCx) -> Result<Made> {
        let mut r = Reader::new(&self.options, cx);
        let (center, half) = (r.triple(&self.center), r.triple(&self.half));
        Ok((Shape::Ellipsoid { center, half }, r.given, self.options))
    }
}

impl Plane {
    /// The shape.
    pub fn made(self, cx: &BuildCx) -> Result<Made> {
        let mut r = Reader::new(&self.options, cx);
        let (point, normal) = (r.triple(&self.point), r.triple(&self.normal));
        Ok((Shape::Plane { point, normal }, r.given, self.options))
    }
}

impl Sphere {
    /// The shape.
    pub fn made(self, cx: &BuildCx) -> Result<Made> {
        let mut r = Reader::new(&self.options, cx);
        let (center, radius) = (r.triple(&self.center), r.radius(&self.radius, 0)?);
        Ok((Shape::Sphere { center, radius }, r.given, self.options))
    }
}
