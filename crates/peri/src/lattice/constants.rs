//! What the kernels of lattices look up: constants of bonds, weighted volumes of families.

use crate::cauchy::lattice::TERM;
use crate::families::lattice::{CONSTANTS, LANES, LatticeBody, PAD};
use crate::families::list::ListBody;
use crate::families::{Cell, FamilyOptions, ForceUnit, Law, PeriView, PmbTable};
use crate::lattice::chunk::constant;
use crate::lattice::kernels::{FROM_TERM, TWICE_XI};
use crate::law::series::{SERIES, STRETCH};
use crate::law::state::SiteState;
use crate::law::weighing::Weighing;

/// Fills the tables of constants: under state-based laws the same for all pairs of types, since moduli belong to the
/// ends; under bond-based ones c/|xi| stands for ω, and the place of ω has the stretch at which bonds flow. `volume` is that of
/// all sites; where they have various ones, kernels multiply by those, and by the micromoduli of plain microelastic bonds.
pub fn fill(
    body: &mut LatticeBody,
    table: &PmbTable,
    options: &FamilyOptions,
    law: &Law,
    volume: Option<f64>,
) {
    let plain = law.kind.plain();
    let unit_moduli = plain && volume.is_none();
    let volume = volume.unwrap_or(1.0);
    let forces = if options.unit == ForceUnit::Newton { volume * volume } else { volume };
    body.tables.clear();
    body.state.tables.clear();
    let n = body.kinds.len();
    for pair in 0..n * n {
        let (a, b) = (body.kinds[pair / n], body.kinds[pair % n]);
        let (c, limit) = table.get(a, b).map_or((0.0, 0.0), |k| (k.c, k.s00));
        let c = if unit_moduli { 1.0 } else { c };
        for e in 0..body.stencil.len() {
            let xi = body.xi(e);
            let square = xi.iter().map(|x| x * x).sum::<f64>();
            let length = square.sqrt();
            let weight = options.volume.weight(length, body.horizon, options.lattice_spacing);
            let (omega, share) = Weighing::of(law).weigh(length, weight, (c, body.horizon, law.yields(a, b)));
            let mut row = [0.0; CONSTANTS];
            row[constant::XI..constant::XI + 3].copy_from_slice(&xi);
            row[constant::DEAD] = options.dead_band(length) * square;
            row[constant::INVERSE] = 1.0 / square;
            row[constant::OMEGA] = omega;
            row[constant::LIMIT] = limit;
            let series = |row: &mut [f64; CONSTANTS], terms: &[f64; 8], factor: f64, first: f64| {
                row[constant::FACTOR] = factor;
                let mut scale = first / square;
                for (k, a) in terms.iter().enumerate() {
                    row[constant::SERIES + k] = scale * a;
                    scale /= square;
                }
            };
            let factor = share * forces;
            series(&mut row, &SERIES, factor, if plain { factor } else { 1.0 });
            body.tables.extend_from_slice(&row);
            let term = share * square * volume;
            series(&mut row, &STRETCH, term, term);
            row[FROM_TERM] = if term == 0.0 { 0.0 } else { 1.0 / term };
            row[TWICE_XI..TWICE_XI + 3].copy_from_slice(&xi.map(|x| 2.0 * x));
            if law.kind.correspondence {
                row[TERM..TERM + 3].copy_from_slice(&xi.map(|x| share * volume * x));
            }
            body.state.tables.extend_from_slice(&row);
        }
    }
}

/// Columns for `n` sites and memory for `numbers` numbers of bonds, all zero.
fn columns(n: usize, numbers: usize) -> SiteState {
    let column = || vec![0.0; n];
    SiteState {
        weighted: column(),
        spread: column(),
        theta: column(),
        before: column(),
        unrelaxed: column(),
        plastic: column(),
        memory: vec![0.0; numbers],
        ..SiteState::default()
    }
}

/// Weighs the families of a body on a lattice as they are now.
pub fn weigh_lattice(body: &mut LatticeBody, view: &PeriView, options: &FamilyOptions, law: &Law) {
    let entries = body.stencil.len();
    let mut state = columns(body.particle.len() + 2 * PAD, body.alive.len() * law.kind.memory() * LANES);
    state.tables = std::mem::take(&mut body.state.tables);
    state.touched = vec![0; body.intact.len()];
    let volume = |cell: usize| view.volume[body.particle[cell] as usize];
    for slot in (0..body.rows.len()).filter(|&slot| body.rows[slot].len > 0) {
        let row = body.rows[slot];
        for e in 0..entries {
            let length = body.xi(e).iter().map(|x| x * x).sum::<f64>().sqrt();
            let omega = law.influence.of(length, body.horizon);
            let volumes = options.volume.weight(length, body.horizon, options.lattice_spacing);
            let one = law.weight(length, body.horizon, volumes);
            for cell in row.start as usize..(row.start + row.len) as usize {
                if !body.lives(cell, e) {
                    continue;
                }
                let Some(to) = body.ahead(slot, cell, e) else { continue };
                for (a, b) in [(cell, to), (to, cell)] {
                    state.weighted[PAD + a] += one * volume(b);
                    state.spread[PAD + a] += omega * one * volume(b);
                }
            }
        }
    }
    body.state = state;
}

/// Weighs the families of the list as they are now.
pub fn weigh_list(body: &mut ListBody, cell: &Cell, law: &Law) {
    let mut state = columns(body.record.len(), body.partner.len() * law.kind.memory());
    for i in 0..body.record.len() {
        for b in body.own(i).filter(|&b| body.lives(b)) {
            let j = body.partner[b] as usize;
            let pair = body.constants(b);
            let length = body.z(false, i, j, cell).1;
            let omega = law.influence.of(length, pair.horizon);
            let one = law.weight(length, pair.horizon, body.weight(b, length));
            for (a, b) in [(i, j), (j, i)] {
                state.weighted[a] += one * body.record[b].volume;
                state.spread[a] += omega * one * body.record[b].volume;
            }
        }
    }
    state.touched = vec![0; body.record.len()];
    body.state = state;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_of_the_stretch_is_exact_where_it_is_used() {
        use crate::law::series::{UP_TO_3, UP_TO_7, stretch};
        for (degree, edge) in [(3, UP_TO_3), (7, UP_TO_7)] {
            for z in [edge, -edge, 0.3 * edge] {
                let series = STRETCH[..=degree].iter().rev().fold(0.0, |sum, a| sum * z + a) * z;
                // Truncation below 1e-15 and a few roundings of 1e-16.
                assert!((series / stretch(z) - 1.0).abs() < 2e-15, "{degree} {z}");
            }
        }
    }
}
