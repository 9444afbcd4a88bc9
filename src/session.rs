//! One deck being worked off: text in, diagnostics and results out.
