//! The world as peridynamic families see it.

use perigrain_base::diag::Result;
use perigrain_peri::families::{Bounds, PeriView};
use perigrain_world::{Domain, World, excluded};

/// The particle data that families need.
///
/// # Errors
/// Without a box.
pub fn view(w: &World) -> Result<PeriView<'_>> {
    let Domain { lo, hi, .. } = *w.domain()?;
    let p = &w.particles;
    let bounds = Bounds { lo, hi, periodic: w.domain()?.periodic(), tilt: w.edges().tilt };
    let x0 = if p.x0.is_empty() { &p.x } else { &p.x0 };
    Ok(PeriView { x: &p.x, x0, kind: &p.kind, volume: w.volumes(), bounds, excluded: excluded(w) })
}
