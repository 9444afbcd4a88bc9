//! Names are looked up outside of steps: debug builds stop an op that looks one up.

#[cfg(debug_assertions)]
thread_local!(static STEP: std::cell::Cell<bool> = const { std::cell::Cell::new(false) });

/// Something is found by its name: debug builds stop an op that does so.
#[inline]
#[track_caller]
pub(crate) fn by_name(text: &str) {
    #[cfg(debug_assertions)]
    assert!(!STEP.get(), "state is looked up by its name `{text}` inside a step");
    let _ = text;
}

/// An op acts as long as this lives, or, inside an op, a text from the deck is read: names are looked up there alone.
pub struct Acting {
    #[cfg(debug_assertions)]
    before: bool,
}

impl Acting {
    /// An op begins to act.
    #[inline]
    pub fn op() -> Self {
        Self::begin(true)
    }

    /// A formula or text of the deck, which names what it wants, begins to be read.
    #[inline]
    pub fn text() -> Self {
        Self::begin(false)
    }

    #[inline]
    fn begin(step: bool) -> Self {
        #[cfg(not(debug_assertions))]
        let _ = step;
        Self {
            #[cfg(debug_assertions)]
            before: STEP.replace(step),
        }
    }
}

#[cfg(debug_assertions)]
impl Drop for Acting {
    fn drop(&mut self) {
        STEP.set(self.before);
    }
}
