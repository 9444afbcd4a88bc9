//! The world as peridynamic families see it.

use perigrain_base::diag::Result;
use perigrain_peri::families::{Bounds, PeriView};
use perigrain_world::{Constant, Domain, World, excluded};

/// The columns that hold factors of particles on what their peridynamic bonds bear and on how stiff these are; 0 stands for 1.
pub static BOND_FACTORS: [Constant<Vec<f64>>; 2] =
    [Constant::new("peri/strength"), Constant::new("peri/stiffness")];

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
