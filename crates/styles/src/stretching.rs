//! How the box is deformed: what fixes deform leave and temperatures read.

use perigrain_world::{Constant, World};

/// The role in `memo` of how fast a fix deforms the box.
pub static RATES: Constant<Vec<f64>> = Constant::new("/rates");

/// How the box is deformed by all fixes deform.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stretching {
    /// How fast each length grows [length/time].
    pub rate: [f64; 3],
    /// How fast each tilt grows [length/time].
    pub tilt: [f64; 3],
    /// How fast each lower face moves [length/time].
    pub low: [f64; 3],
    /// Positions move with the box, and velocities do not.
    pub remapped: bool,
}

/// How the box is deformed; `None` without a fix deform that has been in a run.
pub fn stretching(w: &World) -> Option<Stretching> {
    w.memo.playing(*RATES).map(|(_, row)| row).fold(None, |all, row| {
        let mut s: Stretching = all.unwrap_or_default();
        for d in 0..3 {
            s.rate[d] += row.get(d).copied().unwrap_or(0.0);
            s.low[d] += row.get(d + 3).copied().unwrap_or(0.0);
            s.tilt[d] += row.get(d + 7).copied().unwrap_or(0.0);
        }
        s.remapped |= row.get(6).is_some_and(|r| *r != 0.0);
        Some(s)
    })
}
