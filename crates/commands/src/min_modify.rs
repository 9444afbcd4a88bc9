//! `min_modify`: the numbers of `minimize`.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::common::setting;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::Minimizer;
use perigrain_world::minimizer::{Fire, FireIntegrator, ForceNorm, LineSearch};

/// The command.
pub struct MinModify;

impl Style for MinModify {
    fn name(&self) -> &'static str {
        "min_modify"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Sets the numbers of `minimize`.",
            text: "`line` belongs to `cg` and `sd`; what comes behind it in the table belongs to `fire`, but for `norm`. Words that do not stand \
                   in a line stay as they are.\n\n\
                   The `forcezero` line search and what belongs to LAMMPS' spins are refused.",
            example: "min_modify dmax 1.0e-7 norm max integrator verlet tmax 6.0",
        }
    }
}

/// The words; those that are not there stay as they are.
#[derive(Words)]
#[word(least = 1, refused = "alpha_damp discrete_factor")]
struct Line {
    /// How far a coordinate may change in one line search, or in one step of `fire` [length]. By default a tenth of the smallest
    /// particle (of a diameter, or of the root of a volume), and 0.1 where none has a size; under `-compat lammps` 0.1, which is meant
    /// for units in which atoms are about 1 apart.
    #[word(keyword, name = "D", what = "the largest displacement", positive, default = cx.world.settings.minimizer.dmax)]
    dmax: Option<f64>,
    #[word(keyword, like = Search, default = cx.world.settings.minimizer.line, shown = "quadratic")]
    line: LineSearch,
    #[word(keyword, like = Norm, default = cx.world.settings.minimizer.norm, shown = "two")]
    norm: ForceNorm,
    /// How steps in time are made.
    #[word(keyword, like = Integrator, default = cx.world.settings.minimizer.fire.integrator, shown = "eulerimplicit")]
    integrator: FireIntegrator,
    /// The longest time step, in parts of `timestep`.
    #[word(keyword, name = "F", what = "the longest time step", positive, default = cx.world.settings.minimizer.fire.tmax, shown = "10")]
    tmax: f64,
    /// The shortest time step, in parts of `timestep`.
    #[word(keyword, name = "F", what = "the shortest time step", non_negative, default = cx.world.settings.minimizer.fire.tmin, shown = "0.02")]
    tmin: f64,
    /// Downhill iterations before the time step grows and the energy tolerance counts.
    #[word(keyword, name = "N", what = "the delay in iterations", from = 0, default = cx.world.settings.minimizer.fire.delay, shown = "20")]
    delaystep: i64,
    /// The factor by which the time step grows.
    #[word(keyword, name = "F", what = "the factor of growth", positive, default = cx.world.settings.minimizer.fire.grow, shown = "1.1")]
    dtgrow: f64,
    /// The factor by which the time step shrinks.
    #[word(keyword, name = "F", what = "the factor of shrinking", positive, default = cx.world.settings.minimizer.fire.shrink, shown = "0.5")]
    dtshrink: f64,
    /// The first mixing of velocity and force.
    #[word(keyword, name = "A", what = "the first mixing", non_negative, default = cx.world.settings.minimizer.fire.alpha0, shown = "0.25")]
    alpha0: f64,
    /// The factor of the mixing.
    #[word(keyword, name = "F", what = "the factor of the mixing", positive, default = cx.world.settings.minimizer.fire.alpha_shrink, shown = "0.99")]
    alphashrink: f64,
    /// Whether to go back half a step where the motion turns uphill.
    #[word(keyword, what = "halfstepback", default = cx.world.settings.minimizer.fire.half_step_back, shown = "yes")]
    halfstepback: bool,
    /// Whether the first iterations (`delaystep`) may not shorten the time step.
    #[word(keyword, what = "initialdelay", default = cx.world.settings.minimizer.fire.initial_delay, shown = "yes")]
    initialdelay: bool,
    /// Uphill iterations in a row after which it gives up; 0 for never.
    #[word(keyword, name = "N", what = "the most uphill iterations", from = 0, default = cx.world.settings.minimizer.fire.uphill_most, shown = "2000")]
    vdfmax: i64,
    /// Whether the mixing is corrected for its bias towards small velocities after a start, and speeds are limited component by component
    /// to dmax/dt (Echeverri Restrepo & Andric, Comput. Mater. Sci. 218, 111978).
    #[word(keyword, what = "abcfire", default = cx.world.settings.minimizer.fire.unbiased, shown = "no")]
    abcfire: bool,
}

/// The line search of `cg` and `sd`.
#[derive(Words)]
#[word(what = "line search", of = LineSearch, refused = "forcezero spin_cubic spin_none")]
enum Search {
    /// As `backtrack`, but goes to the zero of the force along the line where the energy is nearly quadratic.
    Quadratic,
    /// Steps are halved until the energy has fallen by 0.4 of what the slope promises.
    Backtrack,
}

/// The length of the forces that is held against `ftol`.
#[derive(Words)]
#[word(what = "norm of the forces", of = ForceNorm)]
enum Norm {
    /// The root of the sum of squares is held against `ftol`.
    Two,
    /// The longest force on a particle is held against `ftol`.
    Max,
    /// The largest component is held against `ftol`.
    Inf,
}

/// The integrator of `fire`.
#[derive(Words)]
#[word(what = "integrator", of = FireIntegrator)]
enum Integrator {
    EulerImplicit,
    Verlet,
    Leapfrog,
    EulerExplicit,
}

impl CommandStyle for MinModify {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let line: Line = read(a, cx)?;
        if line.tmin > line.tmax {
            let text = format!("tmin ({}) is above tmax ({})", line.tmin, line.tmax);
            return fail(Code::CONFLICT, a.span(), text);
        }
        let fire = Fire {
            integrator: line.integrator,
            tmax: line.tmax,
            tmin: line.tmin,
            delay: line.delaystep,
            grow: line.dtgrow,
            shrink: line.dtshrink,
            alpha0: line.alpha0,
            alpha_shrink: line.alphashrink,
            half_step_back: line.halfstepback,
            initial_delay: line.initialdelay,
            uphill_most: line.vdfmax,
            unbiased: line.abcfire,
        };
        let style = cx.world.settings.minimizer.style;
        let set = Minimizer { style, dmax: line.dmax, line: line.line, norm: line.norm, fire };
        Ok(setting(move |cx| {
            cx.world.settings.minimizer = set;
            Ok(())
        }))
    }
}
