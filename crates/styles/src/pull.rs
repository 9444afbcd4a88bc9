//! Bonds as their ends are.

use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::{Vec3, dot, sub};
use perigrain_world::bonds::LostBond;
use perigrain_world::index::Index;
use perigrain_world::{Bond, World};

/// What a bond does at some length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pull {
    /// Energy.
    pub energy: f64,
    /// Force over length: positive pushes the ends apart.
    pub force_per_length: f64,
}

/// A bond as its ends are and move.
#[derive(Clone, Copy, Debug)]
pub struct Stretched {
    /// Type.
    pub kind: u16,
    /// The bond itself.
    pub bond: Bond,
    /// Places of its ends in storage.
    pub ends: [usize; 2],
    /// From the second end to the first [length].
    pub d: Vec3,
    /// Velocity of the first end less that of the second.
    pub v: Vec3,
    /// Its own rest length, or 0 where it has none yet.
    pub rest: f64,
}

impl Stretched {
    /// Its length.
    pub fn length(&self) -> f64 {
        dot(self.d, self.d).sqrt()
    }

    /// By which part it is longer than at rest.
    pub fn strain(&self) -> f64 {
        if self.rest == 0.0 { 0.0 } else { (self.length() - self.rest) / self.rest }
    }
}

/// A bond whose ends have been found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Found {
    /// Type.
    pub kind: u16,
    /// Places of the ends in storage.
    pub ends: [usize; 2],
}

/// All active bonds that `wants` accepts, with the places of their ends; without those that have lost an end where the deck
/// allows it.
///
/// # Errors
/// A missing end.
pub fn find(w: &World, wants: impl Fn(&Bond) -> bool, span: Span) -> Result<Vec<(usize, Found)>> {
    let tags = &w.particles.tag;
    let index = Index::new(tags);
    let mut list = vec![];
    for (k, bond) in w.bonds.list.iter().enumerate().filter(|(_, b)| b.is_on() && wants(b)) {
        let [Some(a), Some(b)] = bond.ends.map(|t| index.find(t, tags)) else {
            if w.bonds.lost != LostBond::Error {
                continue;
            }
            let text =
                format!("an end of the bond between particles {} and {} is gone", bond.ends[0], bond.ends[1]);
            return Err(Diagnostic::error(Code::LOST, span, text)
                .help("`delete_atoms … bond yes` takes bonds of deleted particles along; `thermo_modify lost/bond ignore` continues without their forces")
                .into());
        };
        list.push((k, Found { kind: bond.kind as u16, ends: [a, b] }));
    }
    Ok(list)
}

/// x_a − x_b across the nearest periodic faces.
pub fn apart(w: &World, periods: &Periods, ends: [usize; 2]) -> Vec3 {
    let x = &w.particles.x;
    let d = sub(x[ends[0]], x[ends[1]]);
    if periods.tilted() {
        return periods.nearest(d);
    }
    let lengths = &periods.length;
    std::array::from_fn(
        |k| if lengths[k] > 0.0 { d[k] - lengths[k] * (d[k] / lengths[k]).round() } else { d[k] },
    )
}

/// Edges of the box, zero where it does not repeat.
///
/// # Errors
/// There is no box.
pub fn periods(w: &World) -> Result<Periods> {
    w.domain().map(perigrain_world::Domain::periods)
}
