//! `pair_style granular`: contacts of spheres, with models chosen per pair of types.

pub mod declared;
pub mod force;
pub mod heating;
mod images;
pub mod mdr;
pub mod ranks;
pub mod reach;

pub use declared::{Declared, classic};

use super::contact::words;
use super::{Pair, PairStyle};
use perigrain_base::diag::Result;
use perigrain_contact::normal::STYLES;
use perigrain_lang::{Args, Word};
use perigrain_styles::words::{Form, Kind, Syntax, Value, Words, inner};
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
            syntax: Syntax::Forms(
                const { &[Form::behind(Line::GRAMMAR), Form::headed("pair_coeff I J", words::Line::GRAMMAR)] },
            ),
            summary: "Contacts of spheres: a law along the normal, damping, friction, rolling and twisting resistance.",
            text: &TEXT,
            example: "pair_style granular\n\
                      pair_coeff * * hertz/material 5.0e7 0.7 0.3 damping tsuji tangential mindlin NULL 1.0 0.4\n\n\
                      pair_style granular\n\
                      pair_coeff * * eepa 5.0e7 0.7 0.3 0.6 0.0 2.0 1.5 1.5 damping coeff_restitution \
                      tangential mindlin NULL 1.0 0.4\n\n\
                      pair_style granular\n\
                      pair_coeff * * hertz/material 5.0e6 0.7 0.45 damping coeff_restitution \
                      tangential mindlin NULL NULL 0.5 slip spring rolling cdt 0.1 cohesion sjkr 1.0e4",
        }
    }
}

impl PairStyle for GranularStyle {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        declared::needs_spheres(self.name(), cx)?;
        let Line { cutoff } = inner(args, cx)?;
        let cutoff = cutoff.map(|Cutoff(cutoff)| cutoff);
        Ok(Box::new(Declared::new(self.name(), cutoff)))
    }
}

/// The words of the style.
#[derive(Words)]
struct Line {
    /// The global cutoff, which sets the reach of the neighbour list by hand [length].
    cutoff: Option<Cutoff>,
}

/// A cutoff, which begins as a number does.
struct Cutoff(f64);

impl Value for Cutoff {
    const KIND: Kind = Kind::Number;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.positive(what).map(Self)
    }
    fn begins(word: &Word) -> bool {
        word.text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
    }
}

/// The page's text, with the paragraphs of the normal models.
static TEXT: LazyLock<String> = LazyLock::new(|| {
    let paragraphs: Vec<&str> =
        STYLES.iter().map(|style| style.text.trim()).filter(|text| !text.is_empty()).collect();
    include_str!("granular/page.md").replace("{paragraphs}", &paragraphs.join("\n\n"))
});
