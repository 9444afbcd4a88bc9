//! `min_modify`: the numbers of `minimize`.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::{Args, Word};
use perigrain_styles::common::{bad_keyword, choice_or_refuse, setting};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::Minimizer;
use perigrain_world::minimizer::{FireIntegrator, ForceNorm, LineSearch};

/// The command.
pub struct MinModify;

const KEYWORDS: [&str; 15] = [
    "dmax",
    "line",
    "norm",
    "integrator",
    "tmax",
    "tmin",
    "delaystep",
    "dtgrow",
    "dtshrink",
    "alpha0",
    "alphashrink",
    "halfstepback",
    "initialdelay",
    "vdfmax",
    "abcfire",
];

impl Style for MinModify {
    fn name(&self) -> &'static str {
        "min_modify"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "min_modify keyword value …",
            summary: "Sets the numbers of `minimize`.",
            text: "- `dmax D`: how far a coordinate may change in one line search, or in one step of `fire` [length]. By \
                   default a tenth of the smallest particle (of a diameter, or of the root of a volume), and 0.1 where none has a size; \
                   under `-compat lammps` 0.1, which is meant for units in which atoms are about 1 apart.\n\
                   - `norm two|max|inf`: the length of the forces that is held against `ftol`: root of the sum of squares, \
                   longest force on a particle, largest component.\n\
                   - `line quadratic|backtrack` (`cg`, `sd`): halve steps until the energy has fallen by 0.4 of what the slope \
                   promises; `quadratic` (the default) goes to the zero of the force along the line where the energy is \
                   nearly quadratic.\n\n\
                   Of `fire`:\n\n\
                   - `integrator eulerimplicit|verlet|leapfrog|eulerexplicit`.\n\
                   - `tmax`, `tmin`: bounds of the time step as multiples of `timestep` (10, 0.02).\n\
                   - `delaystep N`: downhill iterations before the time step grows and the energy tolerance counts (20); \
                   `initialdelay yes|no`: whether the first N iterations may not shorten the time step (yes).\n\
                   - `dtgrow`, `dtshrink`: factors of the time step (1.1, 0.5); `alpha0`, `alphashrink`: first mixing of \
                   velocity and force, and its factor (0.25, 0.99).\n\
                   - `halfstepback yes|no`: go back half a step where the motion turns uphill (yes).\n\
                   - `vdfmax N`: uphill iterations in a row after which it gives up (2000; 0 for never).\n\
                   - `abcfire yes|no`: the mixing is corrected for its bias towards small velocities after a start, and speeds are \
                   limited component by component to dmax/dt (Echeverri Restrepo & Andric, Comput. Mater. Sci. 218, 111978) \
                   (no).\n\n\
                   The `forcezero` line search and what belongs to LAMMPS' spins are refused.",
            example: "min_modify dmax 1.0e-7 norm max integrator verlet tmax 6.0",
        }
    }
}

impl CommandStyle for MinModify {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let mut set = cx.world.settings.minimizer;
        let mut word = Some(a.expect("a keyword")?);
        while let Some(keyword) = word {
            option(&mut set, keyword, a)?;
            word = a.next();
        }
        if set.fire.tmin > set.fire.tmax {
            let text = format!("tmin ({}) is above tmax ({})", set.fire.tmin, set.fire.tmax);
            return fail(Code::CONFLICT, a.span(), text);
        }
        Ok(setting(move |cx| {
            cx.world.settings.minimizer = set;
            Ok(())
        }))
    }
}

fn option(set: &mut Minimizer, keyword: &Word, a: &mut Args) -> Result<()> {
    let fire = &mut set.fire;
    match keyword.text.as_str() {
        "dmax" => set.dmax = Some(a.positive("the largest displacement")?),
        "line" => {
            let lammps = ["forcezero", "spin_cubic", "spin_none"];
            set.line = match choice_or_refuse(a, "line search", &["quadratic", "backtrack"], &lammps)? {
                "backtrack" => LineSearch::Backtrack,
                _ => LineSearch::Quadratic,
            }
        }
        "norm" => {
            set.norm = match a.choice("norm of the forces", &["two", "max", "inf"])? {
                "max" => ForceNorm::Max,
                "inf" => ForceNorm::Inf,
                _ => ForceNorm::Two,
            }
        }
        "integrator" => {
            let known = ["eulerimplicit", "verlet", "leapfrog", "eulerexplicit"];
            fire.integrator = match a.choice("integrator", &known)? {
                "verlet" => FireIntegrator::Verlet,
                "leapfrog" => FireIntegrator::Leapfrog,
                "eulerexplicit" => FireIntegrator::EulerExplicit,
                _ => FireIntegrator::EulerImplicit,
            }
        }
        "tmax" => fire.tmax = a.positive("the longest time step")?,
        "tmin" => fire.tmin = a.non_negative("the shortest time step")?,
        "delaystep" => fire.delay = a.integer_from(0, "the delay in iterations")?,
        "dtgrow" => fire.grow = a.positive("the factor of growth")?,
        "dtshrink" => fire.shrink = a.positive("the factor of shrinking")?,
        "alpha0" => fire.alpha0 = a.non_negative("the first mixing")?,
        "alphashrink" => fire.alpha_shrink = a.positive("the factor of the mixing")?,
        "halfstepback" => fire.half_step_back = a.flag("halfstepback")?,
        "initialdelay" => fire.initial_delay = a.flag("initialdelay")?,
        "vdfmax" => fire.uphill_most = a.integer_from(0, "the most uphill iterations")?,
        "abcfire" => fire.unbiased = a.flag("abcfire")?,
        _ => return Err(bad_keyword(a, keyword, &KEYWORDS, &["alpha_damp", "discrete_factor"])),
    }
    Ok(())
}
