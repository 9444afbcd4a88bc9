//! `pair_style peri/pmb/softening`: bonds that lose their strength little by little beyond a peak.

use super::lines::forms;
use super::start;
use crate::{Pair, PairStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_lang::Args;
use perigrain_peri::law;
use perigrain_peri::law::style::Curve;
use perigrain_peri::moduli::curve_area;
use perigrain_styles::words::{Form, Syntax, Value, Words, inner};
use perigrain_styles::{BuildCx, Doc, Style};
use std::sync::LazyLock;

/// The style.
pub struct PeriPmbSoftening;

impl Style for PeriPmbSoftening {
    fn name(&self) -> &'static str {
        "peri/pmb/softening"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(*FORMS),
            summary: "Bond-based peridynamics whose bonds soften beyond a peak: concrete, ceramics, rock.",
            text: "Up to the stretch `peak` a bond is that of `peri/pmb`. Beyond it the force falls as the style's word \
                says, p being the peak. How far is settled by the \
                fracture energy G [energy/area]: the area under the curve is 5 G/(π c δ⁵), that of whole families that a \
                crack parts. A linear bond breaks where nothing is left, an exponential one where a thousandth of the peak is, \
                which ends the curve. One curve holds for all pairs.\n\n\
                Back from the largest stretch so far a bond unloads to the origin and comes back the same way; compressed it \
                pushes as if whole, as cracks close. Damage stays; what it has taken is counted with the energy of broken \
                bonds (`fracture` of compute energy/ledger). There is no alpha: compression does not strengthen bonds.\n\n\
                With a material, c comes from E and nu, G is its Gc, and the peak is `ft`/E unless `peak` says otherwise; a \
                material whose strength is a stretch (`s00`) has no G and is refused. A G below the energy up to the peak would \
                make bonds snap back, and is refused with the largest peak that the horizon allows: with a finer lattice \
                (a shorter horizon) the peak may be higher.\n\n\
                `peri_modify surface energy|tensor` multiplies the force of a bond by its factor and leaves its curve where it is: \
                missing bonds and stiffer ones make up for each other. With `peri_modify horizon own` the peak stays, and \
                nothing is left where a body of the bond's own horizon would have it; horizons beyond 10 Gc/(18 K peak²) are refused.\n\n\
                perigrain's own style; options of `peri_modify` as under `peri/pmb`, but for `influence`. Bodies of \
                one type and one volume on a lattice run fast, all others as lists.",
            example: "pair_style peri/pmb/softening exponential\npair_coeff * * 1.6863e22 0.0015001 3.0e-4 25.0",
        }
    }
}

/// The words of the style.
#[derive(Words)]
struct Line {
    #[word(with = curve, kind = Curves::KIND)]
    curve: Option<Curves>,
}

/// How the force falls beyond the peak.
#[derive(Words)]
enum Curves {
    /// As c p (s_f − s)/(s_f − p), the default.
    Linear,
    /// As c p exp(−(s − p)/a).
    Exponential,
}

fn curve(args: &mut Args, cx: &BuildCx) -> Result<Curves> {
    Curves::value("curve", args, cx)
}

static FORMS: LazyLock<&[Form]> = LazyLock::new(|| forms(law::LINEAR.style(), Line::GRAMMAR, false));

impl PairStyle for PeriPmbSoftening {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        let kind = match inner::<Line>(args, cx)?.curve {
            Some(Curves::Exponential) => law::EXPONENTIAL,
            Some(Curves::Linear) | None => law::LINEAR,
        };
        start(self.name(), kind, cx)
    }
}

/// The stretch at which bonds break whose curve has its peak here and this fracture energy under it.
///
/// # Errors
/// Less energy than it takes to the peak.
pub fn last_stretch(
    curve: &Curve,
    (peak, energy): (f64, f64),
    (c, horizon): (f64, f64),
    at: Span,
) -> Result<f64> {
    let area = curve_area(energy, c, horizon);
    let beyond = (curve.beyond)(area, peak);
    if beyond > 0.0 {
        return Ok(peak + beyond);
    }
    let most = (2.0 * area).sqrt();
    Err(Diagnostic::error(
        Code::BAD_VALUE,
        at,
        format!("bonds with a peak at {peak} take more energy than G = {energy} before they soften"),
    )
    .help(format!("take a peak below {most:.6e}, or a shorter horizon: G/δ⁵ counts"))
    .into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_peri::moduli::fracture_energy;

    #[test]
    fn areas_are_those_of_the_fracture_energy() {
        let (c, horizon, peak) = (1.6863e22, 1.5001e-3, 3e-4);
        // Brittle bonds with this critical stretch take the same.
        let energy = fracture_energy(1.2e-3, c, horizon);
        let area = 0.5 * 1.2e-3f64.powi(2);
        let [linear, exponential] = [law::LINEAR, law::EXPONENTIAL].map(|law| law.style().curve.unwrap());
        let last = last_stretch(&linear, (peak, energy), (c, horizon), Span::default()).unwrap();
        assert!((0.5 * peak * last / area - 1.0).abs() < 1e-14);
        let last = last_stretch(&exponential, (peak, energy), (c, horizon), Span::default()).unwrap();
        // A thousandth of the peak is left at the end.
        let scale = (last - peak) / 1000f64.ln();
        assert!((0.5 * peak * peak + peak * scale * (1.0 - 1e-3) - area).abs() < 1e-14 * area);
        // At the peak of brittle bonds nothing is left to soften with.
        assert!(last_stretch(&linear, (1.2e-3, energy), (c, horizon), Span::default()).is_err());
    }
}
