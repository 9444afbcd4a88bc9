//! Insertion volume of poured spheres: a box or an upright cylinder, which may rise.

use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::rng::ParkMiller;
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::common;
use perigrain_styles::words::{Kind, Value};
use perigrain_world::region::Shape;
use std::f64::consts::PI;

/// An insertion volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Volume {
    /// Lower and upper corner.
    Block([f64; 3], [f64; 3]),
    /// Axis, radius, lower and upper end.
    Cylinder([f64; 2], f64, f64, f64),
}

impl Value for Volume {
    const KIND: Kind = Kind::Region;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        Self::of(args.expect("the region's ID")?, cx)
    }
}

impl Volume {
    /// The volume of a region.
    ///
    /// # Errors
    /// Regions of other shapes, moving regions, outsides, and regions that leave the box.
    pub fn of(word: &Word, cx: &BuildCx) -> Result<Self> {
        let domain = common::domain(cx)?;
        let flat = cx.world.settings.two_dimensional;
        let region = cx.region(word)?;
        let wrong = |text: &str, help: &str| {
            let d = Diagnostic::error(Code::WRONG_KIND, word.span, format!("region `{}` {text}", word.text));
            Err(d.help(help).into())
        };
        if region.outside {
            return wrong("is an outside", "spheres are poured into the inside: leave `side out` off");
        }
        if region.motion.is_some() || region.follows() {
            return wrong("moves", "let the insertion volume rise with `rate`");
        }
        let volume = match &region.shape {
            Shape::Block { lo, hi } => Self::Block(*lo, *hi),
            Shape::Cylinder { axis: 2, center, radius, lo, hi } if !flat => {
                Self::Cylinder(*center, *radius, *lo, *hi)
            }
            Shape::Cylinder { axis: 2, .. } => return wrong("is a cylinder", "a flat scene needs a block"),
            Shape::Cylinder { .. } => return wrong("is a lying cylinder", "use one along z, or a block"),
            _ => {
                return wrong(
                    "is no block or cylinder",
                    "spheres are poured into a block or a cylinder along z",
                );
            }
        };
        let (lo, hi) = volume.corners();
        let beyond = (0..3).any(|d| lo[d] < domain.lo[d] || hi[d] > domain.hi[d]);
        if beyond && !cx.checking {
            let d = Diagnostic::error(
                Code::BAD_VALUE,
                word.span,
                format!(
                    "region `{}` from {lo:?} to {hi:?} leaves the box from {:?} to {:?}",
                    word.text, domain.lo, domain.hi
                ),
            );
            return Err(d.help("let the insertion volume lie inside the box").into());
        }
        Ok(volume)
    }

    /// Opposite corners of its bounding box.
    pub fn corners(&self) -> ([f64; 3], [f64; 3]) {
        match *self {
            Self::Block(lo, hi) => (lo, hi),
            Self::Cylinder([x, y], r, lo, hi) => ([x - r, y - r, lo], [x + r, y + r, hi]),
        }
    }

    /// Its volume, in a flat scene its area.
    pub fn space(&self, flat: bool) -> f64 {
        match *self {
            Self::Block(lo, hi) if flat => (hi[0] - lo[0]) * (hi[1] - lo[1]),
            Self::Block(lo, hi) => (hi[0] - lo[0]) * (hi[1] - lo[1]) * (hi[2] - lo[2]),
            Self::Cylinder(_, r, lo, hi) => PI * r * r * (hi - lo),
        }
    }

    /// Draws the next position at this height.
    pub fn place(&self, height: f64, flat: bool, stream: &mut ParkMiller) -> [f64; 3] {
        match *self {
            Self::Block(lo, hi) => {
                let x = lo[0] + stream.uniform() * (hi[0] - lo[0]);
                if flat {
                    return [x, height, 0.0];
                }
                [x, lo[1] + stream.uniform() * (hi[1] - lo[1]), height]
            }
            Self::Cylinder([x, y], r, ..) => loop {
                let (a, b) = (stream.uniform() - 0.5, stream.uniform() - 0.5);
                if a * a + b * b < 0.25 {
                    return [x + 2.0 * a * r, y + 2.0 * b * r, height];
                }
            },
        }
    }
}
