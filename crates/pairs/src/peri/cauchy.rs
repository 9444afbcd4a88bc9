//! `pair_style peri/cauchy`: solids whose materials are laws of stress and strain, by correspondence.

use super::lines::of_materials;
use super::solid;
use crate::{Pair, PairStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_peri::law;
use perigrain_styles::words::{At, Form, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};
use std::sync::LazyLock;

/// The style.
pub struct PeriCauchy;

impl Style for PeriCauchy {
    fn name(&self) -> &'static str {
        "peri/cauchy"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(*FORMS),
            summary: "Correspondence: solids of any law of stress and strain, elastic or plastic, with bonds that break.",
            text: include_str!("cauchy.md"),
            example: "pair_style peri/cauchy control node 0.2\nmaterial steel E 2.0e11 nu 0.3 rho 7800\n\
                      pair_coeff * * material steel horizon 2.015",
        }
    }
}

/// The words of the style.
#[derive(Words)]
struct Line {
    /// What resists motions between particles that no deformation gradient shows.
    #[word(keyword, shown = "node 0.2")]
    control: Option<Control>,
}

/// What resists motions that no deformation gradient shows.
#[derive(Words)]
#[word(what = "control of motions that no deformation gradient shows")]
enum Control {
    /// Springs of the stiffness g 15G/m, g being this factor and 15G/m the stiffness of the bonds of `peri/lps`.
    Node {
        /// The factor, above 0 and at most 0.5.
        #[word(name = "g", what = "the factor of node control")]
        factor: At<f64>,
    },
}

/// The factor of node control where the line does not say it.
const CONTROL: f64 = 0.2;

/// The largest factor: beyond it shear waves are more than a tenth too fast.
const MOST: f64 = 0.5;

static FORMS: LazyLock<&[Form]> = LazyLock::new(|| of_materials(law::CAUCHY.style(), Line::GRAMMAR));

impl PairStyle for PeriCauchy {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        let line: Line = read(args, cx)?;
        let mut solid = solid(self.name(), law::CAUCHY, cx)?;
        solid.law.control = CONTROL;
        if let Some(Control::Node { factor }) = line.control {
            let right = factor.value > 0.0 && factor.value <= MOST;
            if !(factor.unknown || right) {
                let text = format!(
                    "the factor of node control must be above 0 and at most {MOST}: without control some motions have no energy, \
                     with more of it shear waves are too fast"
                );
                return fail(Code::BAD_VALUE, factor.span, text);
            }
            solid.law.control = factor.value;
        }
        Ok(Box::new(solid))
    }
}
