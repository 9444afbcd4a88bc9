//! compute temp/com, temp/partial, temp/ramp: temperature after a velocity bias is subtracted.

use super::thermal::{Streams, Taken, Thermal, dimension};
use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, RefKind, ValueRef};
use perigrain_styles::common::ramp;
use perigrain_styles::matter::{Masses, count, sum};
use perigrain_styles::words::{Axis, Grammar, Syntax, Units, VelocityAxis, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::{GroupId, World};

/// `compute temp/com`.
pub struct TempCom;

/// `compute temp/partial`.
pub struct TempPartial;

/// `compute temp/ramp`.
pub struct TempRamp;

impl Style for TempCom {
    fn name(&self) -> &'static str {
        "temp/com"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Temperature of the group without the motion of its centre of mass.",
            text: "As `compute temp`, of velocities from which that of the group's centre of mass is taken away. `velocity … temp ID bias \
                   yes` leaves this motion as it is.",
            example: "compute t ball temp/com",
        }
    }
}

impl Style for TempPartial {
    fn name(&self) -> &'static str {
        "temp/partial"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Partial::GRAMMAR),
            summary: "Temperature of some components of velocity.",
            text: "As `compute temp`, of some components of velocity. Of n components the degrees of freedom are \
                   n N less n/d of what `compute temp` takes off in d dimensions. `velocity … temp ID bias yes` leaves the other \
                   components as they are.",
            example: "compute t all temp/partial 1 1 0",
        }
    }
}

impl Style for TempRamp {
    fn name(&self) -> &'static str {
        "temp/ramp"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Ramp::GRAMMAR),
            summary: "Temperature of the group without a shear flow.",
            text: "As `compute temp`, of velocities from which a linear profile is taken away: one component is VLO at the coordinate CLO \
                   and VHI at CHI, constant beyond, as `velocity … ramp` makes it.",
            example: "compute t all temp/ramp vx 0.0 8.0 y 0.0 0.01 units box",
        }
    }
}

#[derive(Words)]
struct Partial {
    /// Whether the component of velocity along x, y, z counts: 1, else 0.
    #[word(name = "x y z", what = "flag of a component")]
    components: [Component; 3],
}

/// Whether a component counts.
#[derive(Clone, Copy, PartialEq, Words)]
pub(super) enum Component {
    #[word("0")]
    Off,
    #[word("1")]
    On,
}

impl Component {
    /// Whether it is 1.
    pub fn counts(self) -> bool {
        self == Component::On
    }
}

#[derive(Words)]
struct Ramp {
    /// The component of velocity.
    #[word(name = "vdim")]
    along: VelocityAxis,
    /// The velocities at the two ends.
    #[word(name = "VLO VHI", what = "a velocity")]
    by: [f64; 2],
    /// The coordinate over which it rises.
    #[word(name = "dim", what = "axis of the ramp")]
    axis: Axis,
    /// The two ends.
    #[word(name = "CLO CHI", what = "an end")]
    between: [f64; 2],
    /// Units of velocities (per time) and coordinates.
    #[word(keyword, default = Units::Lattice)]
    units: Units,
}

/// The velocity bias.
#[derive(Clone, Debug, PartialEq)]
enum Stream {
    /// The velocity of the centre of mass.
    Centre,
    /// Whole components.
    Others([bool; 3]),
    /// A linear profile of component `along` over the coordinate `axis`.
    Ramp { along: usize, by: [f64; 2], axis: usize, between: [f64; 2] },
}

impl ComputeStyle for TempCom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        declared(Stream::Centre, args, cx)
    }
}

impl ComputeStyle for TempPartial {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let counts = read::<Partial>(args, cx)?.components.map(Component::counts);
        if counts[2] && cx.world.settings.two_dimensional {
            let text = "velocities along z do not count in a flat scene (`dimension 2`)";
            return fail(Code::CONFLICT, cx.span, text);
        }
        declared(Stream::Others(counts), args, cx)
    }
}

impl ComputeStyle for TempRamp {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Ramp { along: VelocityAxis(along), by, axis: Axis(axis), between, units } = read(args, cx)?;
        let scale = units.scales(cx.world);
        let (by, between) = (by.map(|b| b * scale[along]), between.map(|c| c * scale[axis]));
        declared(Stream::Ramp { along, by, axis, between }, args, cx)
    }
}

fn declared(flow: Stream, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
    args.finish()?;
    Ok(Box::new(Thermal::new(flow, cx)))
}

/// The biased temperature compute named by the next word (`bias ID`).
///
/// # Errors
/// Unknown computes and those without a bias.
pub fn named(args: &mut Args, cx: &BuildCx) -> Result<ValueRef> {
    let word = args.expect("the ID of a temperature that takes a flow away")?;
    let r = ValueRef { kind: RefKind::Compute, name: word.text.clone(), index: vec![], span: word.span };
    cx.value(&r, false)?;
    if cx.names.compute(&r.name).is_some_and(|s| s.flow) {
        return Ok(r);
    }
    let text = format!("compute `{}` takes no flow velocity away", r.name);
    let d = Diagnostic::error(Code::WRONG_KIND, r.span, text);
    Err(d
        .help("computes temp/com, temp/deform, temp/partial, temp/profile, temp/ramp and temp/region take one away")
        .into())
}

/// The compute at the beginning of a run.
///
/// # Errors
/// A deleted compute.
pub fn known(r: &ValueRef, cx: &dyn SealCx) -> Result<Box<dyn Compute>> {
    match cx.bias(r) {
        Some(compute) => Ok(compute),
        None => fail(Code::UNKNOWN_NAME, r.span, format!("there is no compute `{}` any more", r.name)),
    }
}

/// As `known`, for a style that acts on this group.
///
/// # Errors
/// A deleted compute, or one of another group, which LAMMPS refuses too.
pub fn of_group(r: &ValueRef, group: GroupId, cx: &mut dyn SealCx) -> Result<Box<dyn Compute>> {
    let compute = known(r, cx)?;
    if compute.flow(cx.world()).is_some_and(|f| f.group != group) {
        let text = format!("compute `{}` is of another group than what it is to serve", r.name);
        return Err(Diagnostic::error(Code::CONFLICT, r.span, text)
            .help("define a temperature of the same group for this")
            .into());
    }
    Ok(compute)
}

impl Streams for Stream {
    fn taken<'a>(&'a self, w: &'a World, group: GroupId) -> Taken<'a> {
        let p = &w.particles;
        let mut drift = [0.0; 3];
        if *self == Stream::Centre {
            let masses = Masses::of(w);
            let [x, y, z, m] = sum(w, group, |i| {
                let (m, v) = (masses.get(i), p.v[i]);
                [v[0] * m, v[1] * m, v[2] * m, m]
            });
            drift = [x, y, z].map(|k| if m > 0.0 { k / m } else { 0.0 });
        }
        Box::new(move |i| match self {
            Stream::Centre => drift,
            Stream::Others(counts) => std::array::from_fn(|d| if counts[d] { 0.0 } else { p.v[i][d] }),
            Stream::Ramp { along, by, axis, between } => {
                let mut v = [0.0; 3];
                v[*along] = ramp(p.x[i][*axis], *between, *by);
                v
            }
        })
    }

    fn whole(&self) -> [bool; 3] {
        match self {
            Stream::Others(counts) => counts.map(|c| !c),
            _ => [false; 3],
        }
    }

    fn freedom(&self, w: &World, group: GroupId, extra: Option<f64>) -> f64 {
        let dimension = dimension(w);
        let counting = match self {
            Stream::Others(counts) => counts.iter().filter(|c| **c).count() as f64,
            _ => dimension,
        };
        counting * count(w, group) as f64 - counting / dimension * extra.unwrap_or(dimension)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn what_is_left_without_a_flow() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
        b.world.particles.v = vec![[1.0, 2.0, 0.0], [4.0, 2.0, 0.0], [4.0, 5.0, 0.0]].into();
        // By hand, m = 2: without the drift (3, 3, 0) Σ m v² = 2 (5 + 2 + 5) over 9 − 3 degrees of freedom.
        let c = b.compute(&TempCom, "").unwrap();
        assert!((b.evaluate(&*c).unwrap().scalar - 24.0 / 6.0).abs() < 1e-14);
        // Σ m v_y² = 66 over 3 − 1.
        let c = b.compute(&TempPartial, "0 1 0").unwrap();
        assert!((b.evaluate(&*c).unwrap().scalar - 66.0 / 2.0).abs() < 1e-14);
        assert_eq!(c.flow(&b.world).unwrap().taken[2], [4.0, 0.0, 0.0]);
        // v_x is 1 up to x = 0 and 4 from x = 1 on: only v_y remains.
        let c = b.compute(&TempRamp, "vx 1 4 x 0 1 units box").unwrap();
        assert!((b.evaluate(&*c).unwrap().scalar - 66.0 / 6.0).abs() < 1e-14);
        for words in ["", "1 1", "1 1 2", "1 1 1 1"] {
            assert!(b.compute(&TempPartial, words).is_err(), "{words}");
        }
        assert!(b.compute(&TempRamp, "vx 1 4 x 0 1 unit box").is_err());
        assert!(b.compute(&TempCom, "1").is_err());
    }
}
