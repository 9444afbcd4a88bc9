//! `special_bonds`: how much pair forces count between bonded particles.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::common::setting;
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::bonds::Weights;

/// The command.
pub struct SpecialBonds;

impl Style for SpecialBonds {
    fn name(&self) -> &'static str {
        "special_bonds"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "special_bonds lj|coul|lj/coul W12 W13 W14 … | amber | charmm | dreiding | fene",
            summary: "Says whether pair forces act between particles that are one, two or three bonds apart.",
            text: "The weights belong to particles one, two and three bonds apart; each line begins anew from 0 0 0 for both \
                   kinds. A weight `lj` of 0 leaves the pairs out of all pair forces. One between 0 and 1 is a factor on forces and energies of `soft` and `bpm/spring`; \
                   granular styles know no half contacts, as in LAMMPS. `coul` belongs to electric forces; here only `create_bonds` looks at it. \
                   Peridynamic bonds are a matter of their own and have no such weights. `angle yes` and `dihedral yes` belong to \
                   interactions that perigrain does not have and are refused.",
            example: "special_bonds lj 0.0 1.0 1.0 coul 1.0 1.0 1.0",
        }
    }
}

impl CommandStyle for SpecialBonds {
    fn parse(&self, a: &mut Args, _cx: &BuildCx) -> Result<Box<dyn Act>> {
        let mut weights = Weights::default();
        let known = ["lj/coul", "lj", "coul", "amber", "charmm", "dreiding", "fene", "angle", "dihedral"];
        let mut first = true;
        while first || !a.is_empty() {
            first = false;
            let span = a.here();
            let key = a.choice("kind of weights", &known)?;
            match key {
                "lj/coul" => {
                    weights.lj = three(a)?;
                    weights.coul = weights.lj;
                }
                "lj" => weights.lj = three(a)?,
                "coul" => weights.coul = three(a)?,
                "amber" => weights = Weights { lj: [0.0, 0.0, 0.5], coul: [0.0, 0.0, 5.0 / 6.0] },
                "charmm" => weights = Weights::default(),
                "dreiding" => weights = Weights { lj: [0.0, 0.0, 1.0], coul: [0.0, 0.0, 1.0] },
                "fene" => weights = Weights { lj: [0.0, 1.0, 1.0], coul: [0.0, 1.0, 1.0] },
                _ => {
                    if a.flag(key)? {
                        let text = format!("special_bonds {key} yes: perigrain has no {key} interactions");
                        return fail(Code::NOT_SUPPORTED, span, text);
                    }
                }
            }
        }
        Ok(setting(move |cx| {
            cx.world.bonds.weights = weights;
            cx.world.bonds.changes += 1;
            cx.world.touch();
            Ok(())
        }))
    }
}

fn three(a: &mut Args) -> Result<[f64; 3]> {
    let mut weights = [0.0; 3];
    for (w, apart) in weights.iter_mut().zip(["one", "two", "three"]) {
        let span = a.here();
        *w = a.number(&format!("the weight of particles {apart} bonds apart"))?;
        if !(0.0..=1.0).contains(w) {
            let text = format!("a weight must lie between 0 and 1: {w}");
            return Err(Diagnostic::error(Code::BAD_VALUE, span, text).into());
        }
    }
    Ok(weights)
}
