//! Grains in the order of space: neighbours near each other in memory while a run lasts.

use crate::neigh::slabs::{Slabs, edges};
use crate::world::World;

/// Fewer than these fit the fastest memory in any order.
const FEW: usize = 256;

/// Puts the grains of a scene in the order of cells; peridynamic bodies keep theirs. The order is a function of positions
/// and ids alone.
pub fn line_up(w: &mut World) {
    let order = order(w, &w.particles.x);
    if let Some(order) = order {
        w.line_up(&order);
    }
}

/// The same from the positions of the last rebuild of lists: a run that continues one has the order that this one had.
pub fn line_up_again(w: &mut World) {
    let held = w.held();
    let order = if held.len() == w.n() { order(w, held) } else { None };
    if let Some(order) = order {
        w.line_up(&order);
    }
}

fn order(w: &World, x: &[[f64; 3]]) -> Option<Vec<usize>> {
    let p = &w.particles;
    if !p.style.sphere || p.style.peri || w.families.is_some() || p.len() < FEW {
        return None;
    }
    let (domain, period) = (w.domain.as_ref()?, w.periods());
    let mut slabs = Slabs::default();
    slabs.sort(x, &p.tag, edges(&p.radius, w.settings.neighbor.skin), &domain.lo, &period);
    Some(slabs.order.iter().map(|&i| i as usize).collect())
}
