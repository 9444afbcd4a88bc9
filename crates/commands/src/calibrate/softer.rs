//! Where estimates from each particle's surroundings do not hold: struts between voids bend, and a body is far softer than its parts.

use super::Line;
use super::scene::Scene;
use super::setup::Setup;
use super::touch::Hertz;
use super::words::{Method, Words};
use perigrain_base::diag::{Code, Diagnostic};
use perigrain_base::math::cformat::general;
use perigrain_bonded::ends::Hold;
use perigrain_styles::ActCx;
use std::f64::consts::PI;

/// Below this share of solid there are voids wider than particles: random loose packings have 0.55.
const POROUS: f64 = 0.4;
/// After so many steps bodies whose struts bend are far below the estimate, and others are not: they cost as much as the estimate.
const STEPS: usize = 12;
/// An estimate that is more than so many times what the body has at most is told: those of packings are 5 to 15 % off.
const APART: f64 = 1.25;

/// Warns of an estimated `stiffness` of a porous body [force/length], over this `volume`, where some steps of `calibrate dsm` find a far
/// lower one: every field between held ends gives an upper bound. Where contacts carry as well nothing is told.
pub fn warn_softer(
    cx: &ActCx,
    line: &Line,
    scene: &Scene,
    hertz: Option<&Hertz>,
    (stiffness, volume): (f64, f64),
) {
    let solid: f64 = scene.radius.iter().map(|r| 4.0 / 3.0 * PI * r.powi(3)).sum();
    if solid >= POROUS * volume {
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
    if most.is_nan() || stiffness <= APART * most {
        return;
    }
    let text = format!(
        "between held ends K is {} at most, and not {}: struts between voids bend, of which a particle's surroundings tell nothing",
        general(most, 5),
        general(stiffness, 5)
    );
    let d = Diagnostic::warning(Code::SUSPICIOUS, cx.span, text);
    cx.note(d.help("`calibrate dsm … tol 0.1` finds K to a few percent"));
}
