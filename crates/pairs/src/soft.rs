//! `pair_style soft`: a push that stays finite, for points that lie in each other.

use super::central::{Coeff, Declared, Law};
use super::{Mix, Pair, PairStyle};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::Vec3;
use perigrain_lang::Args;
use perigrain_styles::words::{Form, Syntax, Words, inner};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::field::Fields;
use std::f64::consts::PI;

/// The style.
pub struct SoftStyle;

impl Style for SoftStyle {
    fn name(&self) -> &'static str {
        "soft"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Line::GRAMMAR), Form::headed("pair_coeff I J", Own::GRAMMAR)] },
            ),
            summary: "A soft push that takes points apart which lie in each other.",
            text: "E = A (1 + cos(π r/rc)) for r < rc, and F = A (π/rc) sin(π r/rc) apart: at most 2 A however near two points \
                   are, so that what was placed at random can be taken apart before a harder law acts. Points at one place feel \
                   no force: `displace_atoms … random` parts them.\n\n\
                   As in LAMMPS, A of two types without a line of their own is the geometric mean; their cutoff is mixed as \
                   `pair_modify mix geometric|arithmetic|sixthpower` says. A is an energy, CUTOFF a distance; without one the \
                   style's own holds. Weights of `special_bonds` between 0 and 1 count in part.\n\n\
                   `fix adapt … pair soft a I J v_name` raises A during a run, with `ramp()` in the variable. Beside it `fix \
                   nve/limit` limits how far particles go in a step; `minimize` works as well.",
            example: "pair_style soft 0.002\npair_coeff * * 1e-6\nvariable push equal ramp(0,1e-5)\nfix harder all adapt 1 pair soft a * * v_push",
        }
    }
}

impl PairStyle for SoftStyle {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        let Line { cutoff } = inner(args, cx)?;
        Ok(Box::new(Declared::<Soft>::new(cutoff)))
    }
}

/// The words of the style.
#[derive(Words)]
struct Line {
    /// The cutoff rc [length].
    #[word(name = "CUTOFF", what = "the cutoff", positive)]
    cutoff: f64,
}

/// The words of `pair_coeff`.
#[derive(Words)]
struct Own {
    /// The energy A [energy].
    #[word(name = "A", non_negative)]
    energy: f64,
    /// The cutoff, if it is not that of the style [length].
    #[word(name = "CUTOFF", positive)]
    cutoff: Option<f64>,
}

/// E = A (1 + cos(π r/rc)).
struct Soft;

impl Law for Soft {
    const NAME: &'static str = "soft";
    const NUMBERS: &'static [&'static str] = &["a"];
    const READS: Fields = Fields::NONE;
    const SINGLE: bool = true;

    fn read(args: &mut Args, global: f64, cx: &BuildCx) -> Result<Coeff> {
        let Own { energy, cutoff } = inner(args, cx)?;
        Ok(Coeff { cutoff: cutoff.unwrap_or(global), own: [energy, 0.0] })
    }

    /// A is mixed geometrically by every rule.
    fn mixed(a: &Coeff, b: &Coeff, rule: Mix) -> Coeff {
        Coeff { cutoff: rule.distance(a.cutoff, b.cutoff), own: [(a.own[0] * b.own[0]).sqrt(), 0.0] }
    }

    fn at(c: &Coeff, _d: Vec3, r: f64, _relative: impl Fn() -> Vec3) -> [f64; 2] {
        let (a, angle) = (c.own[0], PI * r / c.cutoff);
        let force = if r > 0.0 { a * angle.sin() * PI / c.cutoff / r } else { 0.0 };
        [force, a * (1.0 + angle.cos())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Half-way to the cutoff: E = A, F = A π/rc; at the place of the other one E = 2 A and no direction.
    #[test]
    fn energy_and_force_are_finite() {
        let c = Coeff { cutoff: 2.0, own: [3.0, 0.0] };
        let at = |r: f64| Soft::at(&c, [r, 0.0, 0.0], r, || [0.0; 3]);
        let [force, energy] = at(1.0);
        assert!((force - 3.0 * PI / 2.0).abs() < 1e-15 && (energy - 3.0).abs() < 1e-15);
        assert_eq!(at(0.0), [0.0, 6.0]);
        // F = −dE/dr.
        let (h, r) = (1e-6, 0.7);
        let slope = (at(r + h)[1] - at(r - h)[1]) / (2.0 * h);
        assert!((at(r)[0] * r + slope).abs() < 1e-8);
    }
}
