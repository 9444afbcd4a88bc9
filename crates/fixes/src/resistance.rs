//! Shared by fix viscous, fix viscous/sphere and fix damping/cundall: a damping coefficient scaled by type or
//! by particle.

use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::par;
use perigrain_lang::{Args, Param};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::common::variable_param;
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, Grammar, Kind, Part, Types, Value};
use perigrain_styles::{BuildCx, Reading, SealCx};
use perigrain_world::{GroupId, Particles, World};

/// Scale factor of a coefficient.
#[derive(Clone)]
pub enum Scale {
    /// By type − 1.
    Kinds(Vec<f64>),
    /// By particle.
    Each(Param),
}

/// What stands behind `scale`.
pub enum Factor {
    /// A ratio for a type or a range of types.
    ByType(Types, f64),
    /// A variable with a value for each particle.
    Each(Param),
}

impl Value for Factor {
    const KIND: Kind = Kind::Or(
        &Kind::Reference,
        &Kind::Words(&Grammar {
            parts: &[Part::bare("type", Kind::Types), Part::number("ratio")],
            keywords: &[],
            refused: &[],
        }),
    );
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        if args.peek_text().starts_with("v_") {
            let by = variable_param(args, "the factor")?;
            cx.param(&by, true)?;
            return Ok(Self::Each(by));
        }
        Ok(Self::ByType(Types::value("", args, cx)?, args.number("the ratio of coefficients")?))
    }
}

/// The same during a run.
pub struct Factors {
    kinds: Vec<f64>,
    each: Option<Reading>,
}

impl Factors {
    /// The factor of a particle.
    pub fn of(&self, w: &World, i: usize) -> f64 {
        match &self.each {
            Some(reading) => reading.atom(w, i),
            None => self.kinds[usize::from(w.particles.kind[i]) - 1],
        }
    }
}

impl Scale {
    /// By ranges of types, of which later ones count.
    pub fn by_type(ranges: &[(Types, f64)], types: usize) -> Self {
        let mut ratio = vec![1.0; types];
        for (Types(first, last), by) in ranges {
            (*first..=*last).for_each(|k| ratio[usize::from(k) - 1] = *by);
        }
        Self::Kinds(ratio)
    }

    /// By ranges of types, or by one variable.
    ///
    /// # Errors
    /// Both, and several variables.
    pub fn of(factors: Vec<At<At<Factor>>>, types: usize) -> Result<Self> {
        let mut ranges = vec![];
        let several = factors.len() > 1;
        for At { value: factor, span, .. } in factors {
            match factor.value {
                Factor::ByType(range, ratio) => ranges.push((range, ratio)),
                Factor::Each(by) if !several => return Ok(Self::Each(by)),
                Factor::Each(_) => {
                    return fail(
                        Code::CONFLICT,
                        span.to(factor.span),
                        "scale either by type or by a variable",
                    );
                }
            }
        }
        Ok(Self::by_type(&ranges, types))
    }

    /// The factors at each step.
    ///
    /// # Errors
    /// A variable that is gone.
    pub fn factors(&self, cx: &mut dyn SealCx) -> Result<Factors> {
        Ok(match self {
            Scale::Kinds(ratio) => Factors { kinds: ratio.clone(), each: None },
            Scale::Each(by) => {
                Factors { kinds: vec![], each: Some(cx.param(by, Stage::PostForce, &When::Always)?) }
            }
        })
    }
}

/// A declared damping.
#[derive(Clone)]
pub struct Resistance {
    /// Name of the op.
    pub name: String,
    group: GroupId,
    gamma: f64,
    scale: Scale,
}

/// The column that is damped.
pub type Against = fn(&mut Particles) -> &mut Vec<[f64; 3]>;

/// The velocities that it is damped by.
pub type Motion = fn(&Particles) -> &[[f64; 3]];

impl Resistance {
    /// Of the fix that a line declares.
    pub fn new(style: &str, gamma: f64, scale: Scale, cx: &BuildCx) -> Self {
        Self { name: format!("fix {} {style}", cx.id), group: cx.group, gamma, scale }
    }

    /// The op: subtracts γ times the second column from the first.
    ///
    /// # Errors
    /// A variable that is gone.
    pub fn op(
        &self,
        needs: Needs,
        (against_in, motion_in): (Against, Motion),
        cx: &mut dyn SealCx,
    ) -> Result<Box<dyn Op>> {
        let (gamma, bit) = (self.gamma, self.group.bit());
        let factors = self.scale.factors(cx)?;
        let op = StepOp::new(self.name.clone(), Stage::PostForce, needs, move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            let mut against = std::mem::take(against_in(&mut w.particles));
            let world = &*w;
            let motion = motion_in(&world.particles);
            let p = &world.particles;
            par::each((&mut against[..], motion, &p.mask[..]), |start, (against, motion, mask)| {
                for k in world.moved_in(start..start + mask.len()).flatten().map(|row| row - start) {
                    if mask[k] & bit != 0 {
                        let drag = gamma * factors.of(world, start + k);
                        (0..3).for_each(|d| against[k][d] -= drag * motion[k][d]);
                    }
                }
            });
            *against_in(&mut w.particles) = against;
            Ok(())
        });
        Ok(op.one_by_one().boxed())
    }
}
