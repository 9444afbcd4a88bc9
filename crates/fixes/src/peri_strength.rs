//! fix peri/strength: factors on what peridynamic bonds bear, from a variable.

use super::{AtRest, AtomReference, Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, ValueRef};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::peri_view::BOND_FACTORS;
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::field::{COLUMNS, FAMILIES, MASK, SLOTS, TAG};
use perigrain_world::{GroupId, Numbers, World};

/// The style.
pub struct PeriStrength;

impl Style for PeriStrength {
    fn name(&self) -> &'static str {
        "peri/strength"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Lets the strength of peridynamic particles follow a variable during a run.",
            text: "The variable gives each particle of the group the factor that `set … peri/strength` gives once: a bond has the smaller \
                   factor of its ends. It multiplies the critical stretch s00, and under `peri_modify break` the strength or the \
                   largest strain; the work that a bond bears has its square. Particles outside the group keep theirs. Factors are \
                   those of the setup of a run and of multiples of N, from the places at the beginning of the step's forces; load steps \
                   of `statics` count as steps. They stay when the fix is removed (`set group all peri/strength 1` ends them).\n\n\
                   A variable that falls with time or with what a particle has suffered models ageing, corrosion or heat. \
                   Refused with bonds that soften, with `peri_modify horizon own` and under `compat lammps/2025`, as `set … peri/strength` is.",
            example: "variable f atom 1-0.5*(x>0)\nfix weak all peri/strength 100 v_f",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Factors are found anew at multiples of N [steps].
    #[word(name = "N", what = "the number of steps N", from = 1)]
    every: i64,
    /// An atom-style variable with the factor of each particle.
    #[word(name = "v_name", what = "peri/strength N")]
    factor: AtomReference,
}

impl FixStyle for PeriStrength {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        if !cx.world.particles.style.peri {
            return Err(Diagnostic::error(
                Code::WRONG_ORDER,
                cx.span,
                "fix peri/strength needs peridynamic particles",
            )
            .help("put `atom_style peri` (or `hybrid sphere peri`) at the top of the deck")
            .into());
        }
        let Line { every, factor } = read(args, cx)?;
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, every, factor: factor.0 }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    every: i64,
    factor: ValueRef,
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (bit, every) = (self.group.bit(), self.every);
        let factor = cx.value(&self.factor, Stage::PreForce, &When::Every(every))?;
        let column: Numbers = *BOND_FACTORS[0];
        let name = format!("fix {} peri/strength", self.id);
        let access = Needs::new().read(MASK | TAG | SLOTS).write(COLUMNS | FAMILIES);
        // The op of the pair style makes families, and anew what they bear, in the setup of a run.
        let mut given = false;
        let op = StepOp::new(name, Stage::PreForce, access, move |w, t| {
            if t.trial {
                return Ok(());
            }
            if t.setup && !t.unchanged || t.step % every == 0 {
                let n = w.n();
                let values: Vec<f64> = (0..n).map(|i| factor.atom(w, i)).collect();
                let mut factors = w.columns.scalar(column, n).clone();
                for i in (0..n).filter(|i| w.particles.mask[*i] & bit != 0) {
                    if values[i].is_nan() || values[i] <= 0.0 || values[i].is_infinite() {
                        let text = format!(
                            "fix peri/strength gives particle {} the factor {}: it must be positive",
                            w.particles.tag[i], values[i]
                        );
                        return Err(Diagnostic::error(Code::BAD_VALUE, None, text).into());
                    }
                    factors[i] = values[i];
                }
                *w.columns.scalar(column, n) = factors;
                given = false;
            }
            if !given && w.families.is_some() {
                give(w, column)?;
                given = !t.setup;
            }
            Ok(())
        });
        Ok(vec![op.boxed()])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Acts, at_rest: AtRest::Acts, ..Facts::default() }
    }
}

/// Gives families the factors of a column.
///
/// # Errors
/// Bonds that have no such factors.
fn give(w: &mut World, column: Numbers) -> Result<()> {
    let Some(mut families) = w.families.take() else { return Ok(()) };
    let (law, options) = (families.law.kind, families.options);
    let refusal = if law.softens() {
        Some(("bonds that soften have a peak, which it does not move", "use peri/pmb"))
    } else if !families.spacing.is_empty() {
        Some(("with `peri_modify horizon own` horizons decide about strengths", "leave one of both out"))
    } else if options.one_stretch() {
        let why = "under `compat lammps/2025` particles have one critical stretch";
        Some((why, "use `compat lammps` or none"))
    } else {
        None
    };
    if refusal.is_none() {
        families.set_strengths(w.columns.get_scalar(column).unwrap_or_default());
    }
    w.families = Some(families).into();
    let Some((why, help)) = refusal else { return Ok(()) };
    let text = format!("fix peri/strength does not concern this scene: {why}");
    Err(Diagnostic::error(Code::CONFLICT, None, text).help(help).into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    fn scene() -> Bench {
        let mut b =
            Bench::new(AtomStyle { peri: true, ..AtomStyle::default() }, &[[0.0; 3], [1.0, 0.0, 0.0]]);
        b.atom.insert("a".into(), vec![0.5, 2.0]);
        b.atom.insert("bad".into(), vec![0.5, 0.0]);
        b
    }

    #[test]
    fn factors_are_those_of_the_variable() {
        let mut b = scene();
        let fix = b.fix(&PeriStrength, "10 v_a").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PreForce).unwrap();
        assert_eq!(b.world.columns.get_scalar(*BOND_FACTORS[0]).unwrap(), [0.5, 2.0]);
        let fix = b.fix(&PeriStrength, "10 v_bad").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        assert!(b.stage(&mut ops, Stage::PreForce).is_err());
        for words in ["", "10", "0 v_a", "10 0.5", "10 v_none"] {
            assert!(b.fix(&PeriStrength, words).is_err(), "{words}");
        }
    }
}
