//! The words after the names of bond styles whose bonds break.

use super::breaking_weights;
use super::store_local::Store;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_lang::Args;
use perigrain_styles::Fix;
use perigrain_world::World;

/// The options of a style's line.
#[derive(Clone)]
pub struct Options {
    /// Pair forces act between bonded particles too.
    pub overlay: bool,
    /// Forces fade towards breaking.
    pub smooth: bool,
    /// Stiffnesses are divided by the length at rest.
    pub normalize: bool,
    /// Bonds break.
    pub breaks: bool,
    /// What is kept of those that did.
    pub store: Option<Store>,
}

/// The words that all these styles know.
pub const WORDS: [&str; 5] = ["overlay/pair", "smooth", "normalize", "break", "store/local"];

impl Options {
    /// Reads the line; `smooth` is the default of that option, `more` reads the words of a single style and returns whether there
    /// was one.
    ///
    /// # Errors
    /// Every mistake in the line.
    pub fn read(
        args: &mut Args,
        smooth: bool,
        mut more: impl FnMut(&str, &mut Args) -> Result<bool>,
    ) -> Result<Self> {
        let mut options = Self { overlay: false, smooth, normalize: false, breaks: true, store: None };
        let mut last = args.here();
        while let Some(word) = args.next() {
            last = word.span;
            match word.text.as_str() {
                "overlay/pair" => options.overlay = args.flag("overlay/pair")?,
                "smooth" => options.smooth = args.flag("smooth")?,
                "normalize" => options.normalize = args.flag("normalize")?,
                "store/local" => options.store = Some(Store::read(args)?),
                "break" => options.breaks = args.flag("break")?,
                other if more(other, args)? => {}
                _ => return Err(args.unknown(word, &WORDS)),
            }
        }
        if options.smooth && !options.breaks {
            let d = Diagnostic::error(Code::CONFLICT, last, "`break no` does not go with smoothed forces");
            return Err(d.help("add `smooth no`").into());
        }
        Ok(options)
    }

    /// What a bond bears before it breaks, a strain, force or torque: with `break no` any number, -1 too, as in LAMMPS.
    ///
    /// # Errors
    /// What is no such number.
    pub fn limit(&self, args: &mut Args, what: &str) -> Result<f64> {
        if self.breaks { args.positive(what) } else { args.number(what) }
    }

    /// The fix that `store/local` requests.
    pub fn fixes(&self) -> Vec<(String, Box<dyn Fix>)> {
        self.store.iter().map(|s| (s.id().to_string(), Box::new(s.clone()) as _)).collect()
    }

    /// Whether weights of bonded pairs are such that bonds can break.
    ///
    /// # Errors
    /// They are not.
    pub fn check(&self, w: &World, span: Span) -> Result<()> {
        if self.breaks { breaking_weights(w, self.overlay, span) } else { Ok(()) }
    }
}
