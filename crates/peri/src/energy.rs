//! Energy and virial of all bonds: asked for at some steps only, so a pass of its own.

use super::chunk::{CELLS, Chunk, Kernels, SUMS};
use super::contact::add;
use super::list::{self, kernel::RowKernels};
use super::pmb::stretch;
use crate::families::lattice::{LANES, LatticeBody, PAD};
use crate::families::{Families, FamilyOptions, ForceUnit, PeriTally, PeriView};
use perigrain_base::par::{self, Shared};

/// Takes a bond: both ends with their energies, the pull on the first and the vector it acts along.
type Add<'a> = dyn FnMut((usize, f64), (usize, f64), f64, [f64; 3]) + 'a;

/// Energy and virial of one row of cells or one record.
pub(super) type Sums = [f64; SUMS];

/// Rows per part when rows are summed.
pub(super) const ROWS: usize = 16;

/// Adds energy and virial of the bonds as they were during the force evaluation: LAMMPS gives each end half of
/// 1/2 c w V s² |xi|, and the virial one factor V.
pub fn tally<K: Kernels + RowKernels>(
    families: &mut Families,
    view: &PeriView,
    t: &mut PeriTally,
    period: [f64; 3],
) {
    let mut rows = std::mem::take(&mut families.scratch.rows);
    let options = families.options;
    for body in &families.lattices {
        if !t.per_atom() && body.cell_kind.is_empty() {
            let newton = options.unit == ForceUnit::Newton;
            // SAFETY: live bonds lead to cells of the body; forces are not touched.
            let of_chunk = |_: usize, data: &Chunk| unsafe { K::sums(data) };
            whole_rows(body, view, &mut rows, (false, newton), of_chunk);
            collect(&rows, t);
            continue;
        }
        sum(body.rows.len(), &mut rows, t, |slot, f| lattice_row(body, slot, view, families, &options, f));
    }
    families.scratch.rows = rows;
    list::energy::tally::<K>(families, t, (true, period));
}

/// Adds up `row(k, add)` for `k` below `n` in a fixed order, and per particle if asked for.
fn sum(n: usize, rows: &mut Vec<Sums>, t: &mut PeriTally, row: impl Fn(usize, &mut Add) + Sync) {
    if t.per_atom() {
        for k in 0..n {
            row(k, &mut |i, j, pull, d| add(t, i, j, pull, d));
        }
        return;
    }
    rows.clear();
    rows.resize(n, [0.0; 7]);
    let shared = Shared::new(rows);
    par::for_rows(n.div_ceil(ROWS), |part| {
        for k in part * ROWS..n.min((part + 1) * ROWS) {
            let mut own = PeriTally::default();
            row(k, &mut |i, j, pull, d| add(&mut own, i, j, pull, d));
            let v = own.virial;
            // SAFETY: each row belongs to one part.
            unsafe { shared.get(k..k + 1)[0] = [own.energy, v[0], v[1], v[2], v[3], v[4], v[5]] };
        }
    });
    collect(rows, t);
}

/// Adds up rows in their order.
pub(super) fn collect(rows: &[Sums], t: &mut PeriTally) {
    for row in rows {
        t.energy += row[0];
        for k in 0..6 {
            t.virial[k] += row[k + 1];
        }
    }
}

/// Energy and virial of each row of a body whose constants are per row, several cells at a time. Constants hold the
/// volumes of forces; `lacks` says that energies lack the second volume of
/// true ones, `newton` that forces are true.
pub(super) fn whole_rows(
    body: &LatticeBody,
    view: &PeriView,
    rows: &mut Vec<Sums>,
    (lacks, newton): (bool, bool),
    of_chunk: impl Fn(usize, &Chunk) -> [[f64; CELLS]; SUMS] + Sync,
) {
    rows.clear();
    let Some(&first) = body.particle.iter().find(|&&p| p != u32::MAX) else { return };
    let volume = view.volume[first as usize];
    let scale = [if lacks { volume } else { 1.0 }, if newton { 1.0 } else { volume }];
    let n = body.rows.len();
    rows.resize(n, [0.0; 7]);
    let shared = Shared::new(rows);
    par::for_rows(n.div_ceil(ROWS), |part| {
        for slot in part * ROWS..n.min((part + 1) * ROWS) {
            if body.rows[slot].len == 0 {
                continue;
            }
            let mut row = whole_row(body, slot, &of_chunk);
            row[0] *= scale[0];
            row[1..].iter_mut().for_each(|v| *v *= scale[1]);
            // SAFETY: each row belongs to one part.
            unsafe { shared.get(slot..slot + 1)[0] = row };
        }
    });
}

fn whole_row(
    body: &LatticeBody,
    slot: usize,
    of_chunk: impl Fn(usize, &Chunk) -> [[f64; CELLS]; SUMS],
) -> Sums {
    let (row, entries) = (&body.rows[slot], body.stencil.len());
    let u = body.u[1].as_ptr();
    let mut lanes = [[0.0; CELLS]; SUMS];
    for chunk in row.start as usize / LANES..(row.start + row.len) as usize / LANES {
        let data = Chunk {
            // SAFETY: `u` has a place for each cell and PAD more around.
            u: [0, 1, 2].map(|k| unsafe { u.add(k * body.stride + PAD + chunk * LANES) }),
            f: [std::ptr::null_mut(); 3],
            alive: &body.alive[chunk * entries..][..entries],
            to: body.leads_of(slot),
            tables: &body.tables,
            various: None,
        };
        let part = of_chunk(chunk, &data);
        for (sum, part) in lanes.iter_mut().flatten().zip(part.iter().flatten()) {
            *sum += part;
        }
    }
    lanes.map(|l| l.iter().sum())
}

/// Energies of both ends and the pull on the first, from z, |xi|, c w and the volumes.
fn bond(z: f64, length: f64, cw: f64, (vi, vj): (f64, f64), options: &FamilyOptions) -> (f64, f64, f64) {
    if z.abs() < options.dead_band(length) {
        return (0.0, 0.0, 0.0);
    }
    let s = stretch(z);
    let (own, other) = match options.unit {
        ForceUnit::Density => (vj, vi),
        ForceUnit::Newton => (vi * vj, vi * vj),
    };
    let e = 0.25 * cw * s * s * length;
    // Force density times the one volume of the virial, or the force itself: c w V_i V_j s/r either way.
    (e * own, e * other, -cw * vi * vj * s / (length * (1.0 + s)))
}

fn lattice_row(
    body: &LatticeBody,
    slot: usize,
    view: &PeriView,
    families: &Families,
    options: &FamilyOptions,
    f: &mut Add,
) {
    let row = body.rows[slot];
    let entries = body.stencil.len();
    for e in 0..entries {
        let xi = body.xi(e);
        let length = xi.iter().map(|x| x * x).sum::<f64>().sqrt();
        let weight = options.volume.weight(length, body.horizon, options.lattice_spacing);
        for chunk in row.start as usize / LANES..(row.start + row.len) as usize / LANES {
            let bits = body.alive[chunk * entries + e];
            for cell in (0..LANES).filter(|lane| bits >> lane & 1 == 1).map(|lane| chunk * LANES + lane) {
                let Some(to) = body.ahead(slot, cell, e) else { continue };
                let (i, j) = (body.particle[cell] as usize, body.particle[to] as usize);
                let Some(coeff) = families.table.get(view.kind[i], view.kind[j]) else { continue };
                let volumes = (view.volume[i], view.volume[j]);
                let (e_i, e_j, pull) =
                    bond(body.z(1, cell, to, e), length, coeff.c * weight, volumes, options);
                let u = |k: usize, c: usize| body.u[1][k * body.stride + crate::families::lattice::PAD + c];
                let d = [0, 1, 2].map(|k| -(xi[k] + u(k, to) - u(k, cell)));
                f((i, e_i), (j, e_j), pull, d);
            }
        }
    }
}
