//! The act of a line that makes particles from a file, as `read_mesh`, `read_points` and `read_voxels` have it in common.

use super::words::Making;
use perigrain_base::diag::Result;
use perigrain_styles::ActCx;
use perigrain_styles::command::Act;

/// A parsed line.
pub trait Body {
    /// Its options for the particles.
    fn making(&self) -> &Making;

    /// Facts of the scene that the particles settle.
    fn settles(&self) -> Vec<&'static str> {
        self.making().settles()
    }

    /// Reads the file and makes the particles.
    ///
    /// # Errors
    /// Files that cannot be read or hold something else, particles that cannot be.
    fn make(&self, cx: &mut ActCx) -> Result<()>;
}

/// The act.
pub struct FromFile<B>(pub B);

impl<B: Body> Act for FromFile<B> {
    fn apply(self: Box<Self>, cx: &mut ActCx) -> Result<()> {
        self.0.make(cx)
    }

    /// `perigrain check` reads the file, too, but keeps no particles.
    fn needs_particles(&self) -> bool {
        false
    }

    fn makes_group(&self) -> Option<&str> {
        self.0.making().group.as_ref().map(|w| w.text.as_str())
    }

    fn settles(&self) -> Vec<&'static str> {
        self.0.settles()
    }
}
