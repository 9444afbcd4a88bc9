//! `pair_style granular`: contacts of spheres, with models chosen per pair of types.

mod declared;
pub mod force;
pub mod heating;
mod images;
pub mod mdr;
mod ranks;
pub mod reach;

pub use declared::{Declared, classic};

use super::{Pair, PairStyle};
use perigrain_base::diag::Result;
use perigrain_contact::normal::{STYLES, Style as Normal};
use perigrain_lang::Args;
use perigrain_styles::words::Syntax;
use perigrain_styles::{BuildCx, Doc, Style};
use std::sync::LazyLock;

/// The style.
pub struct GranularStyle;

impl Style for GranularStyle {
    fn name(&self) -> &'static str {
        "granular"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Written(&PAGE[0]),
            summary: "Contacts of spheres: a law along the normal, damping, friction, rolling and twisting resistance.",
            text: &PAGE[1],
            example: "pair_style granular\n\
                      pair_coeff * * hertz/material 5.0e7 0.7 0.3 damping tsuji tangential mindlin NULL 1.0 0.4\n\n\
                      pair_style granular\n\
                      pair_coeff * * eepa 5.0e7 0.7 0.3 0.6 0.0 2.0 1.5 1.5 damping coeff_restitution \
                      tangential mindlin NULL 1.0 0.4",
        }
    }
}

impl PairStyle for GranularStyle {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        declared::needs_spheres(self.name(), cx)?;
        let number = args.peek_text().starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
        let cutoff = if number { Some(args.positive("the global cutoff")?) } else { None };
        Ok(Box::new(Declared::new(self.name(), cutoff)))
    }
}

const SYNTAX: &str = "pair_style granular [cutoff]\n\
    pair_coeff i j normal … tangential … [damping …] [rolling …] [twisting …] [heat …] [limit_damping] [synchronized_verlet] \
    [cutoff C] [average none|particle|body] [curvature both|impactor] [arms middle|point]\n\
    normal: {normals}\n\
    damping: none | velocity | mass_velocity | viscoelastic | tsuji | coeff_restitution | mdr 1|2\n\
    tangential: none | linear_nohistory x_gamma mu | linear_history kt x_gamma mu | \
    linear_history_classic kt x_gamma mu | mindlin_classic kt x_gamma mu | \
    mindlin[/force] kt|NULL x_gamma mu | mindlin_rescale[/force] kt|NULL x_gamma mu\n\
    rolling: none | sds k gamma mu\n\
    twisting: none | marshall | sds k gamma mu\n\
    heat: none | area h | radius k";

const TEXT: &str = include_str!("granular/page.md");

/// Syntax and text of the page, with the paragraphs of the normal models.
static PAGE: LazyLock<[String; 2]> = LazyLock::new(|| {
    let line = |style: &&Normal| {
        [style.name].into_iter().chain(style.numbers.iter().map(|n| n.word)).collect::<Vec<_>>().join(" ")
    };
    let formula = |style: &&Normal| format!("- `{}`: {}", style.name, style.formula);
    let normals: Vec<String> = STYLES.iter().map(line).collect();
    let formulas: Vec<String> = STYLES.iter().filter(|style| style.name != "none").map(formula).collect();
    let paragraphs: Vec<&str> =
        STYLES.iter().map(|style| style.text.trim()).filter(|text| !text.is_empty()).collect();
    let text = TEXT.replace("{formulas}", &formulas.join("\n"));
    [
        SYNTAX.replace("{normals}", &normals.join(" | ")),
        text.replace("{paragraphs}", &paragraphs.join("\n\n")),
    ]
});
