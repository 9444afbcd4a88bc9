//! Where the bonds of a lattice's rows lead: found once, looked up in every step.

use std::collections::VecDeque;

use crate::families::lattice::{CONSTANTS, LANES, LatticeBody, Lead, Leads, MIXED};
use crate::families::tiles::{Reached, Tile};
use crate::lattice::tiles::lay_tiles;

/// The row slot that bonds with a row step lead to.
pub(crate) fn ahead(body: &LatticeBody, slot: usize, (across, up): (i32, usize)) -> usize {
    (slot + up * body.width).wrapping_add_signed(across as isize)
}

/// The row slot that bonds with a row step lead to, and the pair of local types if both rows have one each.
fn meet(body: &LatticeBody, slot: usize, step: (i32, usize)) -> (usize, Option<usize>) {
    let other = ahead(body, slot, step);
    let (a, b) = (body.rows[slot].kind, body.rows[other].kind);
    let uniform = a != MIXED && b != MIXED;
    (other, uniform.then(|| usize::from(a) * body.kinds.len() + usize::from(b)))
}

/// An s00 that no bond of a row has less of, and the largest alpha.
pub(crate) fn row_limit(body: &LatticeBody, slot: usize) -> (f64, f64) {
    if let [[_, s00, alpha]] = body.pairs[..] {
        return (body.scatter.lowest(s00), alpha.max(0.0));
    }
    let mut limit = (f64::INFINITY, 0.0f64);
    for &step in &body.steps {
        let pair = meet(body, slot, step).1;
        let known = pair.map_or(&body.pairs[..], |pair| &body.pairs[pair..=pair]);
        for [_, s00, alpha] in known {
            limit = (limit.0.min(body.scatter.lowest(*s00)), limit.1.max(*alpha));
        }
    }
    limit
}

/// Rows before that are looked at for one that meets others alike: on most lattices every second or third does.
const RECENT: usize = 8;

/// Finds where the bonds of all rows lead, and lays out tiles, if that has not been done yet.
pub(crate) fn find_leads(body: &mut LatticeBody) {
    lay_tiles(body);
    if body.leads.of_row.len() == body.rows.len() {
        return;
    }
    let mut leads = Leads::default();
    let mut recent: VecDeque<(Vec<Met>, (u32, u32))> = VecDeque::new();
    leads.of_row.resize(body.rows.len(), (0, 0));
    for (tile, Tile { planes, rows, .. }) in body.tiles.all.iter().enumerate() {
        let slots = planes.clone().flat_map(|plane| rows.clone().map(move |row| (plane, row)));
        for (plane, row) in slots {
            let slot = body.slot(plane, row);
            if body.rows[slot].len == 0 {
                continue;
            }
            let meets = met_by(body, slot, &body.tiles.reached(tile)[plane - planes.start..]);
            let known = recent.iter().find(|(before, _)| *before == meets).map(|(_, range)| *range);
            leads.of_row[slot] = known.unwrap_or_else(|| {
                let begin = leads.to.len() as u32;
                for (e, (vector, &step)) in body.stencil.iter().zip(&body.step_of).enumerate() {
                    if let Some([to, due, pair]) = meets[usize::from(step)] {
                        let table = pair as u32 + (e * CONSTANTS) as u32;
                        leads.to.push(Lead { to: to + vector[0], due: due + vector[0], table, e: e as u32 });
                    }
                }
                let range = (begin, leads.to.len() as u32);
                recent.truncate(RECENT - 1);
                recent.push_front((meets, range));
                range
            });
        }
    }
    for (slot, row) in body.rows.iter().enumerate() {
        leads.slot.resize((row.start + row.len) as usize / LANES, slot as u32);
    }
    let vacant = |cells: &[u32]| cells[LANES / 2..].iter().all(|&p| p == u32::MAX);
    leads.half = body.particle.chunks(LANES).map(vacant).collect();
    body.leads = leads;
    body.growth.resize(body.rows.len(), 0.0);
}

/// How many cells further a row begins in the body and in the window of the tile, coordinates being counted too, and the place of
/// the first table of its pair of types; nothing where there is no row.
type Met = Option<[i32; 3]>;

/// What a row meets along the row steps; `reached` are its plane and those above in the window of its tile.
fn met_by(body: &LatticeBody, slot: usize, reached: &[Reached]) -> Vec<Met> {
    let row = &body.rows[slot];
    let various = !body.cell_kind.is_empty();
    let met = |&step: &(i32, usize)| {
        let (other, uniform) = meet(body, slot, step);
        let other = &body.rows[other];
        let to = other.start as i32 - row.start as i32 + row.lo - other.lo;
        let table = if various { 0 } else { uniform.unwrap_or(0) * body.stencil.len() };
        // A row that is there lies in a plane of the window.
        let less = reached.get(step.1).map_or(0, |at| at.first - reached[0].first);
        (other.len > 0).then_some([to, to - less as i32, (table * CONSTANTS) as i32])
    };
    body.steps.iter().map(met).collect()
}
