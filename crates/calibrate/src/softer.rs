//! Where estimates from each particle's surroundings do not hold: struts between voids bend, and a body is far softer than its parts.

use super::Line;
use super::scene::Scene;
use super::setup::Setup;
use super::ste::Estimated;
use super::touch::Hertz;
use super::words::{Method, Words};
use perigrain_base::diag::{Code, Diagnostic};
use perigrain_base::math::cformat::general;
use perigrain_statics::ends::Hold;
use perigrain_styles::ActCx;
use std::f64::consts::PI;

/// Below this share of solid there are voids wider than particles: random loose packings have 0.55.
const POROUS: f64 = 0.4;
/// After so many steps bodies whose struts bend are far below the estimate, and others are not: they cost as much as the estimate.
const STEPS: usize = 12;
/// Ratio of an estimate to the body's upper bound beyond which a warning is given: estimates of packings are 5 to 15 % off.
const APART: f64 = 1.25;

/// Warns of an estimate of a porous body where some steps of `calibrate dsm` find a far lower stiffness: every field between held
/// ends gives an upper bound. Where contacts carry load as well there is no warning.
pub fn warn_softer(cx: &ActCx, line: &Line, scene: &Scene, hertz: Option<&Hertz>, e: &Estimated) {
    let solid: f64 = scene.radius.iter().map(|r| 4.0 / 3.0 * PI * r.powi(3)).sum();
    if solid >= POROUS * e.volume {
        return;
    }
    let words = Words {
        holds: [Hold::Grip; 2],
        wall: None,
        bound: None,
        method: Method::Pcg,
        large: None,
        friction: None,
        parts: None,
        ..line.words.clone()
    };
    // A body that has no ends, or hangs together by nothing, has no stiffness to compare with.
    let Ok(setup) = Setup::new(cx.world, scene, line.group, &words, hertz, cx.span) else { return };
    if !setup.linear() {
        return;
    }
    let most = setup.at_most(scene, &words, STEPS);
    if most.is_nan() || e.body <= APART * most {
        return;
    }
    let text = format!(
        "between held ends K is {} at most, and not {}: struts between voids bend, which an estimate from a particle's surroundings cannot show",
        general(most, 5),
        general(e.body, 5)
    );
    let d = Diagnostic::warning(Code::SUSPICIOUS, cx.span, text);
    cx.note(d.help("`calibrate dsm … tol 0.1` finds K to a few percent"));
}

#[cfg(test)]
mod tests {
    use crate::testing::scene as world_of;
    use crate::testing::{Beams, act};
    use std::collections::BTreeMap;

    #[test]
    fn estimates_of_struts_that_bend_give_a_warning() {
        let of = |generator: &str, gap: &str| {
            let mut w = world_of(&format!(
                "units si\nboundary f f f\natom_style hybrid sphere bond\nregion w block -1e-7 4e-7 -1e-7 4e-7 -1e-7 4e-7 units box\n\
                 region b block 0 247e-9 0 247e-9 0 247e-9 units box\ncreate_box 1 w bond/types 2 extra/bond/per/atom 40\ncreate_atoms 1 {generator}\n\
                 special_bonds lj/coul 0 1 1\ncreate_bonds gap all all 1 -3e-9 {gap}"
            ));
            w.bonds.coeffs = Some(("beams".into(), BTreeMap::new()));
            w
        };
        let beams = || {
            let mut beams = Beams::standard(2);
            beams.0.insert(1, [70e9, 0.17, 3e-9]);
            beams
        };
        let mut opal = of("opal b 180e-9 0.97 0.45 4711 sizes mono 15e-9 axis 100", "10.5e-9");
        let ste = act(&mut opal, "calibrate ste a all axis z", beams()).unwrap();
        let dsm = act(&mut opal, "calibrate dsm b all axis z tol 1e-6", beams()).unwrap();
        let apart = ste.numbers[0] / dsm.numbers[0];
        assert!(apart > 1.5, "{apart}");
        assert_eq!(ste.notes.len(), 1);
        assert!(ste.notes[0].ends_with(
            "struts between voids bend, which an estimate from a particle's surroundings cannot show"
        ));
        // The stated upper bound is an upper bound, and not far from the actual value.
        let most: f64 = ste.notes[0].split_whitespace().nth(5).unwrap().parse().unwrap();
        assert!(most > 0.99 * dsm.numbers[0] && most < 1.5 * dsm.numbers[0], "{most} {}", dsm.numbers[0]);
        let fit = act(&mut opal, "calibrate fit c all target K 1 method ste vary bond 1 E", beams()).unwrap();
        assert_eq!(fit.notes, ste.notes);
        // A packing of spheres has no such struts.
        let mut pack = of("pack b 0.55 4711 sizes mono 30e-9", "6e-9");
        assert!(act(&mut pack, "calibrate ste a all axis z", beams()).unwrap().notes.is_empty());
    }
}
