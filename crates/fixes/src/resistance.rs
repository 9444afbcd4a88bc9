//! What fix viscous and fix viscous/sphere share: a resistance against motion, scaled by type or by particle.

use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::par;
use perigrain_lang::{Args, Param};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::common::variable_param;
use perigrain_styles::step_op::StepOp;
use perigrain_styles::{BuildCx, Reading, SealCx};
use perigrain_world::{GroupId, Particles};

/// What the coefficient is multiplied by.
#[derive(Clone)]
enum Scale {
    /// By type − 1.
    Kinds(Vec<f64>),
    /// By particle.
    Each(Param),
}

/// A declared resistance.
#[derive(Clone)]
pub struct Resistance {
    /// What the op is called.
    pub name: String,
    group: GroupId,
    gamma: f64,
    scale: Scale,
}

/// The column that loses.
pub type Against = fn(&mut Particles) -> &mut Vec<[f64; 3]>;

/// The column that it loses by.
pub type Motion = fn(&Particles) -> &[[f64; 3]];

impl Resistance {
    /// Reads `gamma [scale type ratio]…`, and `scale v_name` where particles may differ (`each`).
    ///
    /// # Errors
    /// Every mistake in the words.
    pub fn read(style: &str, each: bool, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let types = cx.world.types;
        let gamma = args.number("the drag coefficient gamma")?;
        let (mut scale, mut given) = (Scale::Kinds(vec![1.0; types]), false);
        while let Some(word) = args.next() {
            if word.text != "scale" {
                return Err(args.unknown(word, &["scale"]));
            }
            let twice = "scale either by type or by a variable";
            if each && args.peek_text().starts_with("v_") {
                if given {
                    return fail(Code::CONFLICT, word.span.to(args.here()), twice);
                }
                let by = variable_param(args, "the factor")?;
                cx.param(&by, true)?;
                scale = Scale::Each(by);
            } else {
                let Scale::Kinds(ratio) = &mut scale else { return fail(Code::CONFLICT, word.span, twice) };
                let (lo, hi) = args.type_range(types)?;
                let by = args.number("the ratio of drag coefficients")?;
                (lo..=hi).for_each(|k| ratio[usize::from(k) - 1] = by);
            }
            given = true;
        }
        Ok(Self { name: format!("fix {} {style}", cx.id), group: cx.group, gamma, scale })
    }

    /// The op: the first column loses γ times the second.
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
        let (kinds, each) = match &self.scale {
            Scale::Kinds(ratio) => (ratio.clone(), None),
            Scale::Each(by) => (vec![], Some(cx.param(by, Stage::PostForce, &When::Always)?)),
        };
        let op = StepOp::new(self.name.clone(), Stage::PostForce, needs, move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            let mut against = std::mem::take(against_in(&mut w.particles));
            let world = &*w;
            let motion = motion_in(&world.particles);
            let p = &world.particles;
            let factor = |i: usize| match each {
                Some(reading) => Reading::atom(&reading, world, i),
                None => kinds[usize::from(p.kind[i]) - 1],
            };
            par::each((&mut against[..], motion, &p.mask[..]), |start, (against, motion, mask)| {
                for (k, ((against, motion), mask)) in against.iter_mut().zip(motion).zip(mask).enumerate() {
                    if mask & bit != 0 {
                        let drag = gamma * factor(start + k);
                        (0..3).for_each(|d| against[d] -= drag * motion[d]);
                    }
                }
            });
            *against_in(&mut w.particles) = against;
            Ok(())
        });
        Ok(op.boxed())
    }
}
