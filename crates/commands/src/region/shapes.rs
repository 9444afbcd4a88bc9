//! The words of each region shape.

use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::{Args, Param};
use perigrain_styles::BuildCx;
use perigrain_styles::common;
use perigrain_world::region::{Given, INFINITE, Shape, Variable, across};

/// Reads a shape's numbers one by one and keeps which ones variables give.
pub struct Reader<'r, 'a> {
    /// The words.
    pub a: &'r mut Args<'a>,
    cx: &'r BuildCx<'r>,
    spacing: [f64; 3],
    /// Numbers that variables give.
    pub given: Vec<Given>,
    /// How many numbers have been read.
    count: usize,
}

impl<'r, 'a> Reader<'r, 'a> {
    /// A reader of distances in these units.
    pub fn new(a: &'r mut Args<'a>, cx: &'r BuildCx<'r>, spacing: [f64; 3]) -> Self {
        Self { a, cx, spacing, given: vec![], count: 0 }
    }

    /// The shape of this style.
    pub fn shape(&mut self, style: &str) -> Result<Shape> {
        match style {
            "block" => self.corners().map(|(lo, hi)| Shape::Block { lo, hi }),
            "cone" => self.cone(),
            "cylinder" => self.cylinder(),
            "ellipsoid" => {
                let center = self.triple("the centre")?;
                Ok(Shape::Ellipsoid { center, half: self.triple("half an axis")? })
            }
            "plane" => {
                let point = self.triple("a point of the plane")?;
                Ok(Shape::Plane { point, normal: self.triple("the normal")? })
            }
            "prism" => self.prism(),
            _ => {
                let center = self.triple("the centre")?;
                Ok(Shape::Sphere { center, radius: self.radius(0)? })
            }
        }
    }

    /// A number, or a variable that gives it later; NaN until then.
    fn number(&mut self, what: &str, scale: f64) -> Result<f64> {
        self.count += 1;
        match common::variable_param(self.a, what)? {
            Param::Number(x) => Ok(scale * x),
            Param::Ref(r) => {
                self.cx.value(&r, false)?;
                let variable = Variable { name: r.name, span: r.span };
                self.given.push(Given { number: self.count - 1, variable, scale });
                Ok(f64::NAN)
            }
        }
    }

    fn triple(&mut self, what: &str) -> Result<[f64; 3]> {
        let [x, y, z] = self.spacing;
        Ok([self.number(what, x)?, self.number(what, y)?, self.number(what, z)?])
    }

    /// A radius across an axis, in the spacing of the first direction across it.
    fn radius(&mut self, d: usize) -> Result<f64> {
        let span = self.a.here();
        let r = self.number("the radius", self.spacing[d])?;
        if r < 0.0 {
            return fail(Code::BAD_VALUE, span, format!("the radius must not be negative: {r}"));
        }
        Ok(r)
    }

    /// A bound along axis `d`: a number, `INF` or `EDGE`.
    fn bound(&mut self, d: usize, upper: bool) -> Result<f64> {
        let what = if upper { "the upper bound" } else { "the lower bound" };
        let Some(word) = self.a.peek().filter(|w| w.text == "INF" || w.text == "EDGE") else {
            return self.number(what, self.spacing[d]);
        };
        let Some(domain) = &*self.cx.world.domain else {
            let text = format!("`{}` means nothing before the simulation box is defined", word.text);
            return fail(Code::WRONG_ORDER, word.span, text);
        };
        self.a.next();
        self.count += 1;
        Ok(match (word.text == "INF", upper) {
            (true, true) => INFINITE,
            (true, false) => -INFINITE,
            // Of a leaning box, the upright one around it.
            (false, true) => domain.bounds()[d][1],
            (false, false) => domain.bounds()[d][0],
        })
    }

    fn range(&mut self, d: usize) -> Result<(f64, f64)> {
        let span = self.a.here();
        let unknown = |a: &Args| a.peek().is_some_and(|w| w.unknown);
        let guessed = unknown(self.a);
        let mut lo = self.bound(d, false)?;
        let span = span.to(self.a.here());
        let guessed = [guessed, unknown(self.a)];
        let mut hi = self.bound(d, true)?;
        // A number that only a run determines lies anywhere between the bounds (`perigrain check`).
        match guessed {
            [_, true] if hi <= lo => hi = lo + self.spacing[d],
            [true, false] if hi <= lo => lo = hi - self.spacing[d],
            _ => {}
        }
        if lo > hi {
            let text = format!("the lower bound {lo} lies above the upper bound {hi}");
            return fail(Code::BAD_VALUE, span, text);
        }
        Ok((lo, hi))
    }

    fn corners(&mut self) -> Result<([f64; 3], [f64; 3])> {
        let (mut lo, mut hi) = ([0.0; 3], [0.0; 3]);
        for d in 0..3 {
            (lo[d], hi[d]) = self.range(d)?;
        }
        Ok((lo, hi))
    }

    fn line(&mut self, axis: usize) -> Result<[f64; 2]> {
        let [c, d] = across(axis);
        Ok([self.number("the axis", self.spacing[c])?, self.number("the axis", self.spacing[d])?])
    }

    fn cone(&mut self) -> Result<Shape> {
        let axis = common::axis(self.a, "axis of the cone")?;
        let center = self.line(axis)?;
        let d = across(axis)[0];
        let radius = [self.radius(d)?, self.radius(d)?];
        let (lo, hi) = self.range(axis)?;
        Ok(Shape::Cone { axis, center, radius, lo, hi })
    }

    fn cylinder(&mut self) -> Result<Shape> {
        let axis = common::axis(self.a, "axis of the cylinder")?;
        let center = self.line(axis)?;
        let radius = self.radius(across(axis)[0])?;
        let given = self.given.len();
        let span = self.a.here();
        let (lo, hi) = self.range(axis)?;
        if self.given.len() > given {
            return fail(Code::NOT_SUPPORTED, span, "the ends of a cylinder must be numbers, INF or EDGE");
        }
        Ok(Shape::Cylinder { axis, center, radius, lo, hi })
    }

    fn prism(&mut self) -> Result<Shape> {
        let (lo, hi) = self.corners()?;
        let span = self.a.here();
        let [x, y, _] = self.spacing;
        let tilt =
            [self.number("the tilt xy", x)?, self.number("the tilt xz", x)?, self.number("the tilt yz", y)?];
        let endless = |d: usize| lo[d] == -INFINITE && hi[d] == INFINITE;
        for (tilt, pair) in tilt.iter().zip([[0, 1], [0, 2], [1, 2]]) {
            if *tilt != 0.0 && pair.into_iter().any(endless) {
                return fail(Code::BAD_VALUE, span, "an endless prism cannot be tilted in that direction");
            }
        }
        if self.cx.world.settings.two_dimensional && (tilt[1] != 0.0 || tilt[2] != 0.0) {
            return fail(Code::BAD_VALUE, span, "the tilts xz and yz of a flat scene must be 0");
        }
        Ok(Shape::Prism { lo, hi, tilt })
    }
}
