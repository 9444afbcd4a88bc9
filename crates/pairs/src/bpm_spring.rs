//! `pair_style bpm/spring`: damped repulsion of particles of bonded solids.

use super::central::{Coeff, Declared, Law};
use super::{Mix, Pair, PairStyle};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{Vec3, dot};
use perigrain_lang::Args;
use perigrain_styles::words::{Form, Grammar, Syntax, Words, inner};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::field::{Fields, V};

/// The style.
pub struct BpmSpringStyle;

impl Style for BpmSpringStyle {
    fn name(&self) -> &'static str {
        "bpm/spring"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Grammar::NONE), Form::headed("pair_coeff I J", Own::GRAMMAR)] },
            ),
            summary: "Damped repulsion within a distance, for particles of bonded solids.",
            text: "F = k (rc − r) − γ (1 − (r/rc)⁸) r̂·v pushes particles apart while r < rc, with the energy k (rc − r)²/2. Bonded particles \
                   are left out, or count in part, as `special_bonds` says. Two types without a line of their own take the geometric means of k and γ, and a cutoff \
                   mixed as `pair_modify mix` says.",
            example: "pair_style bpm/spring\npair_coeff * * 1.0 0.0009 0.5",
        }
    }
}

impl PairStyle for BpmSpringStyle {
    fn build(&self, _args: &mut Args, _cx: &BuildCx) -> Result<Box<dyn Pair>> {
        Ok(Box::new(Declared::<Spring>::new(0.0)))
    }
}

/// The words of `pair_coeff`.
#[derive(Words)]
struct Own {
    /// The stiffness k [force/length].
    #[word(non_negative)]
    k: f64,
    /// The cutoff rc [length].
    #[word(positive)]
    rc: f64,
    /// The damping gamma [force/velocity].
    #[word(non_negative)]
    gamma: f64,
}

/// F = k (rc − r) − γ (1 − (r/rc)⁸) r̂·v.
struct Spring;

impl Law for Spring {
    const NAME: &'static str = "bpm/spring";
    const NUMBERS: &'static [&'static str] = &["k", "gamma"];
    const READS: Fields = V;
    const SINGLE: bool = false;

    fn read(args: &mut Args, _global: f64, cx: &BuildCx) -> Result<Coeff> {
        let Own { k, rc, gamma } = inner(args, cx)?;
        Ok(Coeff { cutoff: rc, own: [k, gamma] })
    }

    fn mixed(a: &Coeff, b: &Coeff, rule: Mix) -> Coeff {
        let cutoffs = [a.cutoff, b.cutoff];
        let own = [0, 1].map(|k| rule.energy([a.own[k], b.own[k]], cutoffs));
        Coeff { cutoff: rule.distance(a.cutoff, b.cutoff), own }
    }

    fn at(c: &Coeff, d: Vec3, r: f64, relative: impl Fn() -> Vec3) -> [f64; 2] {
        let ([k, gamma], cut) = (c.own, c.cutoff);
        let near = 1.0 - (r / cut).powi(2).powi(2).powi(2);
        let force = (k * (cut - r) - gamma * dot(d, relative()) * near / r) / r;
        [force, 0.5 * k * (cut - r) * (cut - r)]
    }
}
