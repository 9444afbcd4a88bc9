//! Horizons that end exactly on a shell of neighbours.

use perigrain_base::diag::{Code, Diagnostic, Span};
use perigrain_styles::BuildCx;

/// Relative distance from a shell below which rounding decides: positions carry some 16 digits, and a spacing
/// given with six should still draw the warning.
const NEAR: f64 = 1e-7;

/// Leaves a warning where neighbours of a cubic lattice lie exactly on the horizon: `ratio` is the horizon in lattice
/// spacings, `unit` what one spacing is written as in the deck.
pub(super) fn warn(ratio: f64, unit: f64, span: Span, cx: &BuildCx) {
    let Some(count) = on_shell(ratio) else { return };
    let text = format!(
        "the horizon is exactly {ratio} lattice spacings, where each particle has {count} neighbours: rounding \
         decides which of them have bonds"
    );
    // As far beyond the shell as the usual 3.015 is beyond 3.
    let better = (ratio * 1.005 * unit * 1e12).round() / 1e12;
    cx.note(Diagnostic::warning(Code::HORIZON, span, text).help(format!("write {better} instead")));
}

/// Leaves a warning where a horizon is too short for bonds to make a solid, or so long that they cost more than they
/// give: `ratio` in lattice spacings.
pub(super) fn range(ratio: f64, span: Span, cx: &BuildCx) {
    if (1.5..=8.0).contains(&ratio) {
        return;
    }
    let text = match ratio {
        r if r < 1.0 => format!("the horizon is {ratio:.3} lattice spacings: no bonds"),
        r if r < 1.5 => {
            format!(
                "the horizon is {ratio:.3} lattice spacings: bonds to at most 18 neighbours make no isotropic solid"
            )
        }
        _ => format!(
            "the horizon is {ratio:.3} lattice spacings: each particle has some {:.0} bonds",
            4.0 / 3.0 * std::f64::consts::PI * ratio.powi(3)
        ),
    };
    cx.note(
        Diagnostic::warning(Code::SUSPICIOUS, span, text)
            .help("about 3 spacings is usual; 1.5 to 8 are sensible"),
    );
}

/// How many sites of a simple cubic lattice lie at exactly this distance in spacings; `None` if none does.
fn on_shell(ratio: f64) -> Option<usize> {
    let square = ratio * ratio;
    let n = square.round();
    if !(1.0..=400.0).contains(&n) || (square - n).abs() > NEAR * n {
        return None;
    }
    let (n, edge) = (n as i64, ratio.ceil() as i64);
    let side = -edge..=edge;
    let sites =
        side.clone().flat_map(|x| side.clone().flat_map(move |y| (-edge..=edge).map(move |z| [x, y, z])));
    let count = sites.filter(|[x, y, z]| x * x + y * y + z * z == n).count();
    (count > 0).then_some(count)
}

#[cfg(test)]
mod tests {
    use super::on_shell;

    #[test]
    fn shells_of_the_cubic_lattice() {
        assert_eq!(on_shell(3.0), Some(30)); // 6 of (3 0 0) and 24 of (2 2 1)
        assert_eq!(on_shell(0.0015 / 0.0005), Some(30));
        assert_eq!(on_shell(2f64.sqrt()), Some(12));
        assert_eq!(on_shell(7f64.sqrt()), None); // 7 is no sum of three squares
        assert_eq!(on_shell(3.015), None);
        assert_eq!(on_shell(3.0001), None);
        assert_eq!(on_shell(1e9), None);
        assert_eq!(on_shell(f64::NAN), None);
    }
}
