//! What the lattice kernels look up: constants of bonds, types of rows, data of cells.

use super::chunk::constant;
use crate::families::lattice::{CONSTANTS, LatticeBody, Leads, MIXED, PAD, Slackest};
use crate::families::{FamilyOptions, ForceUnit, Law, PeriView, PmbTable};

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
    fill_tables(body, table, options, first);
    if law.kind.has_states() {
        super::state::tables::fill(body, table, options, law, if various { 1.0 } else { first });
    }
}

fn local(kinds: &[u16], kind: u16) -> u16 {
    kinds.iter().position(|&k| k == kind).unwrap_or(0) as u16
}

fn fill_tables(body: &mut LatticeBody, table: &PmbTable, options: &FamilyOptions, volume: f64) {
    let n = body.kinds.len();
    let various = !body.cell_kind.is_empty();
    body.tables.clear();
    body.pairs.clear();
    for pair in 0..n * n {
        let coeff = table.get(body.kinds[pair / n], body.kinds[pair % n]);
        body.pairs.push(coeff.map_or([0.0, f64::INFINITY, 0.0], |k| [k.c, k.s00, k.alpha]));
        let volumes = match options.unit {
            ForceUnit::Density => volume,
            ForceUnit::Newton => volume * volume,
        };
        let c = if various { 1.0 } else { coeff.map_or(0.0, |k| k.c) * volumes };
        for e in 0..body.stencil.len() {
            let mut row = [0.0; CONSTANTS];
            let xi = body.xi(e);
            row[constant::XI..constant::XI + 3].copy_from_slice(&xi);
            let length = xi.iter().map(|x| x * x).sum::<f64>().sqrt();
            let inverse = 1.0 / (length * length);
            let weight = options.volume.weight(length, body.horizon, options.lattice_spacing);
            let factor = c * weight / length;
            row[constant::DEAD] = options.dead_band(length) * length * length;
            let mut scale = factor * inverse;
            for (k, a) in super::pmb::SERIES.iter().enumerate() {
                row[constant::SERIES + k] = scale * a;
                scale *= inverse;
            }
            row[constant::INVERSE] = inverse;
            row[constant::FACTOR] = factor;
            row[constant::ENERGY] = c * weight * length;
            body.tables.extend_from_slice(&row);
        }
    }
}
