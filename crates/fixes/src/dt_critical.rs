//! fix dt/critical: a time step that follows the stability limits of the scene.

use super::time_step::Follower;
use super::{Fix, FixStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_computes::swing;
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::critical::{self, Estimate};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{CONTACTS, FAMILIES, KIND, MASS, RADIUS, TYPE_MASS, V, VOLUME, X};
use perigrain_world::{GroupId, RunStyle, World};

/// The style.
pub struct DtCritical;

impl Style for DtCritical {
    fn name(&self) -> &'static str {
        "dt/critical"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Sets the time step to a part of what peridynamic solids, contacts and bonds stand.",
            text: "In the setup of a run and every N steps the step becomes `safety` times the shortest of the limits \
                   of compute dt/critical. As bonds break and contacts come and go the limits change, and the step \
                   follows. Where no limit is known, as for grains that do not touch, the step is that of `max`, or \
                   stays. Scalar (intensive): the last step at which it changed.\n\n\
                   Under `run_style staggered` bonded particles count as grains: the long step becomes the grains' \
                   limit, shortened to what `m N` short steps of the solids fill; with `faster grains` the step becomes \
                   the grains', shortened to the N-th part of the solids'.\n\n\
                   Contacts that begin between two looks are stiffer than was known: give `max`, or a small N. `pd \
                   exact` costs some 50 to 200 force evaluations per look.",
            example: "fix ct all dt/critical 100 0.8 pd exact max 2.0e-7",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The number of steps between two looks [steps].
    #[word(name = "N", from = 1)]
    every: i64,
    /// The part of the limit, below 1.
    #[word(positive)]
    safety: At<f64>,
    #[word(keyword, default = Estimate::Exact)]
    pd: Estimate,
    #[word(keyword, default = swing::Estimate::Local)]
    bonds: swing::Estimate,
    /// The longest step [time].
    #[word(keyword, name = "T", positive)]
    max: Option<f64>,
}

impl FixStyle for DtCritical {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        if cx.group != GroupId::ALL {
            return fail(Code::BAD_VALUE, cx.span, "fix dt/critical must use the group `all`");
        }
        let Line { every, safety, pd, bonds, max } = read(args, cx)?;
        if safety.value >= 1.0 {
            let text = format!("a part of the limit is below 1: {} lets waves grow", safety.value);
            return fail(Code::BAD_VALUE, safety.span, text);
        }
        let rule = Rule { how: pd, bonds, safety: safety.value, longest: max };
        Ok(Box::new(Declared { follower: Follower::new("dt/critical", cx.id, every), rule }))
    }
}

/// How the step follows from the stability limits.
#[derive(Clone, Copy)]
struct Rule {
    how: Estimate,
    bonds: swing::Estimate,
    safety: f64,
    longest: Option<f64>,
}

impl Rule {
    fn step(&self, w: &World, solids: f64, grains: f64, bonds: f64) -> f64 {
        let contacts = grains;
        // Only time step levels treat contacts and bonds separately.
        let grains = contacts.min(bonds);
        let limit = match &w.settings.run_style {
            RunStyle::Verlet => solids.min(grains),
            RunStyle::Staggered { ratio: None, .. } => grains,
            RunStyle::Staggered { ratio: Some(m), rare: false, .. } => grains.min(*m as f64 * solids),
            RunStyle::Staggered { ratio: Some(m), .. } => grains.min(solids / *m as f64),
            // A force that acts at the outermost level limits the longest step.
            RunStyle::Respa(r) => {
                let pairs = r.subs.iter().flatten().copied().max().unwrap_or(r.pair);
                (solids.min(contacts) * r.steps(pairs) as f64).min(bonds * r.steps(r.bond) as f64)
            }
        };
        let step = (self.safety * limit).min(self.longest.unwrap_or(f64::INFINITY));
        if step.is_finite() { step } else { w.clock.dt }
    }
}

#[derive(Clone)]
struct Declared {
    follower: Follower,
    rule: Rule,
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        self.follower.declare(w);
        critical::request_wall_springs(w);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        self.follower.remove(w);
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (rule, style, span) = (self.rule, cx.bonds(), cx.span());
        let mut probes = cx.probes()?;
        let reads = X | V | RADIUS | MASS | TYPE_MASS | KIND | VOLUME | FAMILIES | CONTACTS;
        Ok(self.follower.ops(cx, (reads, false), move |w| {
            let (solids, grains) = (critical::solids(w, rule.how)?, critical::grains(w, &mut probes)?);
            let bonds = rule.bonds.step(w, style.as_deref(), span)?;
            Ok(rule.step(w, solids, grains, bonds))
        }))
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, ..Shape::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::{AtomStyle, Respa};

    #[test]
    fn the_step_suits_the_way_steps_are_made() {
        let mut w = World::default();
        w.clock.dt = 7.0;
        let rule = Rule { how: Estimate::Cfl, bonds: swing::Estimate::Local, safety: 0.5, longest: None };
        let staggered = |ratio, rare| RunStyle::Staggered { ratio, rare, twice: None };
        let inf = f64::INFINITY;
        let levels = |subs| RunStyle::Respa(Respa { loops: vec![3, 5], bond: 0, pair: 2, subs });
        for (style, solids, grains, step) in [
            (RunStyle::Verlet, 2.0, 8.0, 1.0),
            (RunStyle::Verlet, 2.0, inf, 1.0),
            (RunStyle::Verlet, inf, inf, 7.0),
            (staggered(Some(3), false), 2.0, 8.0, 3.0),
            (staggered(Some(5), false), 2.0, 8.0, 4.0),
            (staggered(None, false), 2.0, 8.0, 4.0),
            (staggered(None, false), 2.0, inf, 7.0),
            (staggered(Some(4), true), 8.0, 3.0, 1.0),
            (levels(None), 2.0, 8.0, 1.0),
            (levels(Some(vec![0, 1])), 2.0, 8.0, 5.0),
        ] {
            w.settings.run_style = style.clone();
            assert_eq!(rule.step(&w, solids, grains, inf), step, "{style:?}");
        }
        // Bonds act at the innermost of three levels, with fifteen steps in one outer step.
        assert_eq!(rule.step(&w, 2.0, inf, 0.1), 0.75);
        w.settings.run_style = RunStyle::Verlet;
        assert_eq!(rule.step(&w, inf, 8.0, 0.5), 0.25);
        assert_eq!(Rule { longest: Some(0.25), ..rule }.step(&w, inf, inf, inf), 0.25);
    }

    #[test]
    fn mistakes_are_named() {
        let b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        for words in ["", "0 0.8", "10", "10 1.0", "10 0.8 pd fast", "10 0.8 max 0", "10 0.8 emax 3"] {
            assert!(b.fix(&DtCritical, words).is_err(), "{words}");
        }
    }
}
