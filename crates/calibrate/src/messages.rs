//! Messages that the kinds of `calibrate` share.

use super::Line;
use super::scene::Scene;
use super::setup::{Response, Setup};
use super::words::Words;
use perigrain_base::diag::{Code, Diagnostic};
use perigrain_base::math::cformat::general;
use perigrain_styles::ActCx;

/// The beginning of the first line.
pub fn head(kind: &str, line: &Line, scene: &Scene) -> String {
    format!("calibrate {kind} {}: {} particles, {} bonds", line.id, scene.places.len(), scene.network.bonds())
}

/// Young's modulus [pressure] and Poisson's ratio.
pub fn moduli(young: f64, poisson: f64) -> String {
    format!("E {}   nu {}", general(young, 5), general(poisson, 3))
}

/// Warns of a solution that has not come to an end.
pub fn warn_unfinished(cx: &ActCx, words: &Words, done: bool) {
    if done {
        return;
    }
    let (text, help) = if words.by_parts() {
        let text = "no balance has been found: the stiffness may be far off";
        (
            text,
            "take more `steps` or less strain; contacts that cannot slip may have no balance, `mu M` lets them",
        )
    } else {
        let text = "the solution has not converged: the stiffness is an upper bound and may be far off";
        (text, "the stiffnesses of bonds differ by too many orders of magnitude, or `tol` is below rounding")
    };
    cx.note(Diagnostic::warning(Code::UNSTABLE, cx.span, text).help(help));
}

/// Contacts that bear more than this part of the energy decide on the stiffness.
const MUCH: f64 = 0.1;

/// Warns of contacts with high loads that cannot slip.
pub fn warn_sticking(cx: &ActCx, words: &Words, setup: &Setup, r: &Response) {
    let meant = words.friction.is_some() || words.paper.is_some() || !setup.contacts.rough();
    let share = r.energies[0] / (r.modes.iter().sum::<f64>() + r.energies.iter().sum::<f64>());
    if meant || share.is_nan() || share < MUCH {
        return;
    }
    let text = format!("contacts bear {:.0} % of the energy, and none of them slips", 100.0 * share);
    let help =
        "use `mu M` with the friction of the particles: where surfaces slip the body may be far softer";
    cx.note(Diagnostic::note(Code::SUSPICIOUS, cx.span, text).help(help));
}

/// Warns of particles that can move without resistance.
pub fn warn_loose(cx: &ActCx, loose: usize) {
    if loose > 0 {
        let text = format!(
            "{loose} particles can move in some direction without resistance of their bonds; they are held there"
        );
        cx.note(Diagnostic::note(Code::NO_EFFECT, cx.span, text));
    }
}

/// A part in percent with two digits; rounding is not worth any.
pub fn percent(part: f64) -> String {
    general(100.0 * part.max(1e-14), 2)
}

/// A number of things.
pub fn count(n: usize, thing: &str) -> String {
    format!("{n} {thing}{}", if n == 1 { "" } else { "s" })
}
