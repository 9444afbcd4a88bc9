//! What the lattice kernels look up: constants of bonds, types of rows, data of cells.

use crate::families::lattice::{LatticeBody, Leads, MIXED, PAD, Slackest};
use crate::families::{FamilyOptions, Law, PeriView, PmbTable};

/// Fills the tables of constants, row types and per-cell data from coefficients, types and volumes.
pub fn refresh(
    body: &mut LatticeBody,
    view: &PeriView,
    table: &PmbTable,
    options: &FamilyOptions,
    law: &Law,
) {
    let some = body.particle.iter().copied().filter(|&p| p != u32::MAX);
    if some.clone().next().is_none() {
        // All of it has been deleted: what its rows look up stays as it was.
        return;
    }
    body.leads = Leads::default();
    body.slackest = Slackest::default();
    let first = some.clone().next().map_or(0.0, |p| view.volume[p as usize]);
    let mut various = some.clone().any(|p| view.volume[p as usize].to_bits() != first.to_bits());
    body.kinds.clear();
    for p in some {
        let kind = view.kind[p as usize];
        if !body.kinds.contains(&kind) {
            body.kinds.push(kind);
        }
    }
    body.kinds.sort_unstable();
    for row in &mut body.rows {
        let cells = row.start as usize..(row.start + row.len) as usize;
        let mut of_row = body.particle[cells].iter().filter(|&&p| p != u32::MAX);
        let kind = of_row.next().map_or(0, |&p| local(&body.kinds, view.kind[p as usize]));
        let same = of_row.all(|&p| local(&body.kinds, view.kind[p as usize]) == kind);
        row.kind = if same { kind } else { MIXED };
        various |= !same;
    }
    body.cell_kind.clear();
    body.cell_volume.clear();
    if various {
        let cells = body.particle.len();
        body.cell_kind.resize(cells + 2 * PAD, 0);
        body.cell_volume.resize(cells + 2 * PAD, 0.0);
        for (cell, &p) in body.particle.iter().enumerate() {
            if p != u32::MAX {
                body.cell_kind[PAD + cell] = local(&body.kinds, view.kind[p as usize]) as u8;
                body.cell_volume[PAD + cell] = view.volume[p as usize];
            }
        }
    }
    fill_pairs(body, table);
    crate::lattice::constants::fill(body, table, options, law, (!various).then_some(first));
}

fn local(kinds: &[u16], kind: u16) -> u16 {
    kinds.iter().position(|&k| k == kind).unwrap_or(0) as u16
}

/// The coefficients of pairs of local types.
fn fill_pairs(body: &mut LatticeBody, table: &PmbTable) {
    let n = body.kinds.len();
    body.pairs.clear();
    for pair in 0..n * n {
        let coeff = table.get(body.kinds[pair / n], body.kinds[pair % n]);
        body.pairs.push(coeff.map_or([0.0, f64::INFINITY, 0.0], |k| [k.c, k.s00, k.alpha]));
    }
}
