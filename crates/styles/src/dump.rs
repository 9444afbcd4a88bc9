//! What a dump is: a style that reads its line, and what it declares.

use super::{BuildCx, SealCx, Style};
use dyn_clone::DynClone;
use perigrain_base::diag::{Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_world::World;

/// A dump style: one file, one line in `DUMPS`.
pub trait DumpStyle: Style {
    /// Reads the words after `dump ID group style N`: the file name and the attributes.
    ///
    /// # Errors
    /// Every mistake in the line.
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>>;
}

/// A declared dump.
pub trait Dump: DynClone + Send {
    /// The op that writes a snapshot each time it runs; `every` is the interval in steps (0: `write_dump`, which runs the op once
    /// between runs). Its name is `dump ID style`, its stage `Output`, its times those of the dump: multiples of `every`, and the
    /// first step of a run when it is such a multiple or with `dump_modify first yes`.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn op(&self, cx: &mut dyn SealCx, every: i64) -> Result<Box<dyn Op>>;

    /// `dump_modify ID …`.
    ///
    /// # Errors
    /// Unknown keywords.
    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()>;

    /// A warning about snapshots that would not show what is meant, given before any is made; `w` may be a scene that is only
    /// checked.
    fn doubts(&self, w: &World) -> Option<Diagnostic> {
        let _ = w;
        None
    }

    /// The interval that `dump_modify … every N` set, if it did.
    fn every(&self) -> Option<i64> {
        None
    }

    /// Whether it has written snapshots into a file that keeps growing.
    fn growing(&self) -> bool {
        false
    }

    /// Whether snapshots repeat the row of the step table, which must then be there before them.
    fn repeats_row(&self) -> bool {
        false
    }
}

dyn_clone::clone_trait_object!(Dump);
