//! `create_atoms … mol`: copies of a molecule template in place of single particles.

use super::places::New;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::body::Quat;
use perigrain_base::math::rng::Marsaglia;
use perigrain_lang::Args;
use perigrain_styles::BuildCx;
use perigrain_styles::common;
use perigrain_styles::molecules::{self, any_turn, fits, named};
use perigrain_styles::words::{Grammar, Kind, Part, Value};
use perigrain_world::template::Numbering;
use perigrain_world::{Template, World};
use std::sync::Arc;

/// The words of `mol` and `rotate`.
pub struct Copies {
    set: Arc<[Template]>,
    seed: u32,
    /// The turn of all copies; random by default.
    turned: Option<Quat>,
    span: Span,
}

impl Value for Copies {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[Part::bare("ID", Kind::Molecule), Part::bare("SEED", Kind::Whole)],
        ..*Grammar::NONE
    });
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("a molecule template")?;
        let set = named(word, cx)?;
        if set.len() > 1 {
            let text = format!("only the first of the {} molecules of this template is used", set.len());
            cx.note(Diagnostic::warning(Code::SUSPICIOUS, word.span, text));
        }
        let c = Self { set, seed: common::marsaglia_seed(args)?, turned: None, span: word.span };
        fits(c.template(), cx, c.span)?;
        Ok(c)
    }
}

impl Copies {
    /// The same with a turn of all copies, if there is one.
    pub fn turned(self, turned: Option<Quat>) -> Self {
        Self { turned, ..self }
    }

    fn template(&self) -> &Template {
        &self.set[0]
    }

    /// The random numbers that turn copies.
    pub fn stream(&self) -> Marsaglia {
        Marsaglia::new(self.seed)
    }

    /// How the next copy is turned.
    pub fn turn(&self, stream: &mut Marsaglia, flat: bool) -> Quat {
        self.turned.unwrap_or_else(|| any_turn(|| stream.uniform(), flat, None))
    }

    /// Where the particles of a copy are.
    pub fn at(&self, x: [f64; 3], turn: Quat) -> Vec<[f64; 3]> {
        self.template().turned(x, turn)
    }

    /// Whether the types exist when `kind` is added to them.
    pub fn check_types(&self, kind: u16, types: usize) -> Result<()> {
        molecules::check_types(self.template(), kind, types, self.span)
    }

    /// Puts a copy at each of these places; their number of particles.
    pub fn put(&self, w: &mut World, places: &[New], kind: u16) -> Result<usize> {
        let t = self.template();
        let flat = w.settings.two_dimensional;
        let mut stream = self.stream();
        let mut numbers = Numbering::behind(w, kind);
        let more = u32::try_from(places.len().saturating_mul(t.count)).ok();
        if more.and_then(|n| numbers.tag.checked_add(n)).is_none() {
            return fail(Code::TOO_LARGE, None, "more particles than there are ids");
        }
        for new in places {
            let q = new.turn.unwrap_or_else(|| self.turn(&mut stream, flat));
            w.insert_molecule(t, &self.at(new.x, q), q, &mut numbers);
        }
        if !t.bonds.is_empty() {
            w.bonds.find_special();
        }
        Ok(places.len() * t.count)
    }
}
