//! Young's modulus of a body whose bonds follow from a material's, noted before its first run.

use super::Solid;
use perigrain_base::diag::{Code, Diagnostic};
use perigrain_peri::families::{Families, PeriView};

/// Moduli nearer to the material's than this need no word.
const NEAR: f64 = 0.05;

/// Notes for each type whose body is softer or stiffer in a pull than its material.
pub fn notes(style: &Solid, families: &Families, view: &PeriView) -> Vec<Diagnostic> {
    // Corrected energies are in the law, not in weights.
    if style.law.surface {
        return vec![];
    }
    let of = |kind: u16| {
        let young = style.materials.young(kind)?;
        let shares = families.pulled(view, kind)?.map(|e| e / young);
        let (least, most) = (
            shares.iter().copied().fold(f64::INFINITY, f64::min),
            shares.iter().copied().fold(0.0, f64::max),
        );
        if least > 1.0 - NEAR && most < 1.0 + NEAR {
            return None;
        }
        let [x, y, z] = shares;
        let text = format!(
            "bodies of type {kind} pulled along x, y, z will have about {x:.2}, {y:.2}, {z:.2} of the material's E: so much do the bonds of \
             this lattice make that count in part, and those that its surfaces lack"
        );
        let mends = if style.law.kind.softens() {
            "`peri_modify volume full surface tensor` makes it E within some 3 %"
        } else {
            "`peri_modify volume full surface tensor` makes it E within some 3 %, `peri_modify calibrate young` where there are hardly any surfaces"
        };
        Some(Diagnostic::note(Code::MATERIAL, None, text).help(mends))
    };
    (1..=style.table.types() as u16).filter_map(of).collect()
}
