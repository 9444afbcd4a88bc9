//! The words of fix wall/gran for the place of the wall and its motion.

use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Param};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{At, Axis, Kind, Nullable, Value, Words};

/// The wall.
#[derive(Words)]
#[word(what = "wall")]
pub enum Standing {
    /// Planes across x at two places: numbers, `v_name` of equal-style variables, or one of them `NULL` where there is one plane.
    Xplane(#[word(name = "lo hi", what = "the {} plane")] At<[Nullable<Param>; 2]>),
    /// Planes across y.
    Yplane(#[word(name = "lo hi", what = "the {} plane")] At<[Nullable<Param>; 2]>),
    /// Planes across z.
    Zplane(#[word(name = "lo hi", what = "the {} plane")] At<[Nullable<Param>; 2]>),
    /// A cylinder about an axis parallel to x through y = c1, z = c2, which counts as flat; not in LAMMPS.
    Xcylinder {
        #[word(name = "R", what = "the radius of the cylinder", positive)]
        radius: f64,
        #[word(name = "c1 c2", what = "the place {} of the axis")]
        center: [f64; 2],
    },
    /// The same parallel to y through z = c1, x = c2.
    Ycylinder {
        #[word(name = "R", what = "the radius of the cylinder", positive)]
        radius: f64,
        #[word(name = "c1 c2", what = "the place {} of the axis")]
        center: [f64; 2],
    },
    /// A cylinder about z, whose curvature counts; or the same as the others parallel to z through x = c1, y = c2.
    Zcylinder {
        #[word(name = "R", what = "the radius of the cylinder", positive)]
        radius: f64,
        #[word(name = "c1 c2", what = "the place {} of the axis")]
        center: Option<[f64; 2]>,
    },
}

/// The wall; a region is that of another fix.
pub struct Named(pub Standing);

impl Value for Named {
    const KIND: Kind = <Standing as Value>::KIND;
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        if args.peek_text() == "region" {
            let d = Diagnostic::error(Code::UNKNOWN_STYLE, args.here(), "a region is a wall of another fix");
            return Err(d.help("write `fix … wall/gran/region … region ID`").into());
        }
        if args.is_empty() {
            args.expect("the wall: xplane yplane zplane xcylinder ycylinder or zcylinder")?;
        }
        Standing::value(what, args, cx).map(Self)
    }
}

/// A motion of the wall, of which there is one at most.
#[derive(Words)]
#[word(keywords)]
pub enum Moving {
    /// The wall is at its place + A − A cos ω t, ω = 2π/period, t since the fix was declared.
    #[word(once)]
    Wiggle {
        #[word(name = "x|y|z", what = "direction of the motion")]
        axis: At<Axis>,
        #[word(name = "A", what = "the amplitude")]
        amplitude: f64,
        #[word(positive, what = "the period")]
        period: f64,
    },
    /// The wall moves in its own plane at V; a cylinder along its axis. For another axis a cylinder about z turns clockwise seen from
    /// above at the speed V, one with a centre right-handed at the angular velocity V, as seen from the centre of each grain.
    #[word(once)]
    Shear {
        #[word(name = "x|y|z", what = "direction of the motion")]
        axis: At<Axis>,
        #[word(name = "V", what = "the velocity")]
        speed: f64,
    },
}
