//! Bond-style variables in a run: one value for each living bond of peridynamic families.

use super::seal::Sealer;
use super::step_env::RunEnv;
use super::texts::{of_variable, sources};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::vec3::{Vec3, length, sub};
use perigrain_lang::{Bonds, Kind, ValueRef, Vars};
use perigrain_peri::families::Families;
use perigrain_plan::{Stage, When};
use perigrain_styles::BondFormula;
use perigrain_styles::peri_view::view;
use perigrain_world::World;
use perigrain_world::columns::TEMPERATURE;
use std::sync::Arc;

/// Plans the values that a bond-style variable needs and returns what evaluates it.
///
/// # Errors
/// Unknown variables, and those of other styles.
pub fn formula(
    s: &mut Sealer,
    vars: Arc<Vars>,
    r: &ValueRef,
    stage: Stage,
    when: &When,
) -> Result<BondFormula> {
    let kind = vars.kind(&r.name);
    if kind != Some(Kind::Bond) {
        let text = match kind {
            None => format!("there is no variable `{}`", r.name),
            Some(kind) => format!("`{r}` is of style {}; a bond-style variable is needed", kind.name()),
        };
        let code = if kind.is_none() { Code::UNKNOWN_VARIABLE } else { Code::WRONG_KIND };
        let d = Diagnostic::error(code, r.span, text);
        return Err(d.help(format!("define it by `variable {} bond \"s/0.01\"`", r.name)).into());
    }
    let from = sources(s, of_variable(&r.name, &vars), r.span, stage, when)?;
    let (r, declared) = (r.clone(), s.declared());
    Ok(Box::new(move |w| {
        let Some(families) = &*w.families else { return Ok(vec![]) };
        let ends = families.living();
        let word = |name: &str| word(w, families, &ends, name, r.span);
        let mut env = RunEnv::new(w, &declared, &from);
        vars.of_bonds(&r, &mut env, &Bonds { ends: &ends, word: &word })
    }))
}

/// A word of the formula for all bonds.
fn word(w: &World, families: &Families, ends: &[[u32; 2]], name: &str, at: Span) -> Result<Vec<f64>> {
    let view = view(w)?;
    let first = |[i, j]: [u32; 2]| length(families.first_bond(&view, i as usize, j as usize));
    let now = |[i, j]: [u32; 2]| -> Vec3 { view.bounds.nearest(sub(view.x[j as usize], view.x[i as usize])) };
    let each = |of: &dyn Fn([u32; 2]) -> f64| ends.iter().map(|ends| of(*ends)).collect::<Vec<f64>>();
    let end = if name.ends_with('1') { 0 } else { 1 };
    Ok(match name {
        "s" => each(&|ends| {
            let first = first(ends);
            (length(now(ends)) - first) / first
        }),
        "L" => each(&first),
        "nx" | "ny" | "nz" => {
            let axis = ["nx", "ny", "nz"].iter().position(|n| *n == name).unwrap_or_default();
            each(&|ends| {
                let y = now(ends);
                y[axis] / length(y)
            })
        }
        "d1" | "d2" => {
            let mut damage = vec![0.0; w.n()];
            families.damage_all(view.volume, &mut damage);
            each(&|ends| damage[ends[end] as usize])
        }
        _ => {
            let column = w.columns.property(*TEMPERATURE).and_then(|key| w.columns.get_scalar(key));
            let Some(temperature) = column else {
                let text = format!("particles have no temperature, which `{name}` names");
                let d = Diagnostic::error(Code::WRONG_KIND, at, text);
                return Err(d.help("`fix ID all property/atom temperature` gives them one").into());
            };
            each(&|ends| temperature.get(ends[end] as usize).copied().unwrap_or(0.0))
        }
    })
}
