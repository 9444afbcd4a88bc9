//! compute temp/deform: temperature of the group relative to the flow of a deforming box.

use super::thermal::{Streams, Taken, Thermal, dimension};
use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::add;
use perigrain_lang::Args;
use perigrain_styles::matter::count;
use perigrain_styles::stretching::{Stretching, stretching};
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::{GroupId, World};

/// The style.
pub struct TempDeform;

impl Style for TempDeform {
    fn name(&self) -> &'static str {
        "temp/deform"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Temperature of the group without the flow of a box that `fix deform` stretches.",
            text: "As `compute temp`, of velocities from which that of a point is taken away which goes with the box: of the lower face \
                   plus the rate of the length times how far up the particle is, in the dimensions that `fix deform` changes. It means something \
                   where particles do flow so: with `remap v`, or `none`. With `remap x` positions move and velocities do not: \
                   a warning says so, as it does where there is no fix deform. Under `-compat lammps/2025` a length that keeps the `volume` counts with its rate over itself, and under all of `-compat lammps` `trate`, `wiggle` and `variable` only \
                   from the first change of a run on, as in LAMMPS.",
            example: "compute t all temp/deform",
        }
    }
}

impl ComputeStyle for TempDeform {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        args.finish()?;
        Ok(Box::new(Thermal::new(WithTheBox, cx)))
    }
}

/// The velocity field of the deforming box.
#[derive(Clone)]
struct WithTheBox;

impl Streams for WithTheBox {
    fn taken<'a>(&'a self, w: &'a World, _group: GroupId) -> Taken<'a> {
        let Stretching { rate, tilt, low, .. } = stretching(w).unwrap_or_default();
        if let Some(domain) = w.domain.as_ref().filter(|d| d.tilted() || tilt != [0.0; 3]) {
            let edges = Periods { length: rate, tilt };
            return Box::new(move |i| add(edges.shift(domain.fractions(&w.particles.x[i])), low));
        }
        let (from, lengths) = w.domain.as_ref().map_or(([0.0; 3], [1.0; 3]), |d| (d.lo, d.lengths()));
        let inverse = lengths.map(|l| 1.0 / l);
        let x = &w.particles.x;
        Box::new(move |i| std::array::from_fn(|d| rate[d] * ((x[i][d] - from[d]) * inverse[d]) + low[d]))
    }

    fn freedom(&self, w: &World, group: GroupId, extra: Option<f64>) -> f64 {
        dimension(w) * count(w, group) as f64 - extra.unwrap_or(dimension(w))
    }

    fn check(&self, cx: &mut dyn SealCx) -> Result<()> {
        let text = match stretching(cx.world()) {
            None => "no fix deform is there: compute temp/deform takes nothing away",
            Some(s) if s.remapped => {
                "fix deform moves positions (remap x): velocities have no flow for compute temp/deform to take away"
            }
            _ => return Ok(()),
        };
        let at = cx.span();
        let notes = &mut cx.world().notes;
        // Once per run, for all users of the compute.
        if notes.0.iter().all(|n| n.message != text) {
            notes.push(Diagnostic::warning(Code::SUSPICIOUS, at, text));
        }
        Ok(())
    }
}
