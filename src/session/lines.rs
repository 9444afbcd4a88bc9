//! The declared lines of the session's own commands: read here, shown by the manual.

pub use super::balancing::Statics;
pub use super::commands::{Compatibility, Echoing, Logging, Print};
pub use super::inert::{CommStyle, Package, Partition, Suffix};
pub use super::info::Info;
pub use super::minimizing::Minimize;
pub use super::restarting::{ReadRestart, WriteRestart};
pub use super::running::Run;
pub use super::sweeping::Sweep;
pub use super::timer::TimerLine;
pub use super::tiring::Tiring;

use super::Session;
use crate::graph::declaration::Context;
use perigrain_base::diag::{Diagnostics, Result};
use perigrain_lang::{Args, Command, Word};
use perigrain_styles::words::{Words, read_or};
use perigrain_world::GroupId;
use std::cell::RefCell;

impl Session {
    /// Takes a line apart by its declared words.
    ///
    /// # Errors
    /// Every mistake in its words.
    pub(super) fn read_line<T: Words>(&self, cmd: &Command) -> Result<T> {
        self.read_line_or(cmd, |_| None)
    }

    /// As [`Session::read_line`]; `foreign` refuses words that it has a message for.
    ///
    /// # Errors
    /// As [`Session::read_line`].
    pub(super) fn read_line_or<T: Words>(
        &self,
        cmd: &Command,
        foreign: impl Fn(&Word) -> Option<Diagnostics>,
    ) -> Result<T> {
        let (notes, uses) = (RefCell::default(), RefCell::default());
        let cx = Context { span: cmd.span, checking: self.checking(), notes: &notes, uses: &uses };
        read_or(&mut Args::new(cmd), &cx.build(&self.graph, &self.world, "", GroupId::ALL), foreign)
    }
}
