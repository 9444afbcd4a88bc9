//! The words after the names of bond styles whose bonds break.

use super::breaking_weights;
use super::store_local::Store;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_styles::Fix;
use perigrain_styles::words::{At, Words};
use perigrain_world::World;

/// Words of all these styles.
#[derive(Words)]
pub struct Breaking {
    /// Whether pair forces act between bonded particles, too.
    #[word(keyword = "overlay/pair", shown = "no")]
    overlay: bool,
    /// Whether bonds break.
    #[word(keyword = "break", what = "break", placed, shown = "yes")]
    breaks: Option<At<bool>>,
    /// Keeps values of each bond that breaks.
    #[word(keyword = "store/local", name = "ID")]
    store: Option<Store>,
}

/// Words of styles with stiffnesses in the units of springs.
#[derive(Words)]
pub struct Springs {
    #[word(flatten)]
    breaking: Breaking,
    /// Whether forces fade towards breaking.
    #[word(keyword, default = true)]
    smooth: bool,
    /// Whether stiffnesses are divided by the length at rest.
    #[word(keyword, shown = "no")]
    normalize: bool,
}

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

impl Springs {
    /// The options.
    ///
    /// # Errors
    /// `break no` with smoothed forces.
    pub fn options(self) -> Result<Options> {
        Ok(Options { normalize: self.normalize, ..self.breaking.options(self.smooth)? })
    }
}

impl Breaking {
    /// The options.
    ///
    /// # Errors
    /// `break no` with smoothed forces.
    pub fn options(self, smooth: bool) -> Result<Options> {
        let Self { overlay, breaks, store } = self;
        if let Some(at) = breaks.filter(|at| smooth && !at.value) {
            let text = "`break no` does not go with smoothed forces";
            return Err(Diagnostic::error(Code::CONFLICT, at.span, text).help("add `smooth no`").into());
        }
        Ok(Options { overlay, smooth, normalize: false, breaks: breaks.is_none_or(|at| at.value), store })
    }
}

impl Options {
    /// What a bond bears before it breaks, a strain, force or torque: with `break no` any number, -1 too, as in LAMMPS.
    ///
    /// # Errors
    /// What is no such number.
    pub fn limit(&self, number: At<f64>, what: &str) -> Result<f64> {
        if self.breaks && !number.unknown && (number.value <= 0.0 || number.value.is_nan()) {
            let text = format!("{what} must be greater than zero, not {}", number.value);
            return fail(Code::BAD_VALUE, number.span, text);
        }
        Ok(number.value)
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
