//! Laying out a body on a lattice: rows, slabs, half stencil, alive bits.

use super::detect::{Sites, distance};
use crate::families::lattice::{LANES, LatticeBody, Row, RowMotion, staggered};
use crate::families::{FamilyOptions, PeriView, PmbTable};

/// Types mixed in a row cost this many cells' worth each when the direction of rows is chosen.
const TYPE_CHANGE: usize = 64;

/// Horizons beyond so many spacings have stencils that no body fills.
const FARTHEST: f64 = 12.0;

/// A body's bounding box may have this many sites per particle.
const SPARSEST: usize = 64;

/// The lattice layout of a body, and initial partners' volumes and numbers added up; `None`
/// if the body has several horizons, or leaves so many sites vacant that a list is better.
pub fn lay_out(
    view: &PeriView,
    members: &[u32],
    sites: &Sites,
    table: &PmbTable,
    options: &FamilyOptions,
    family_volume: &mut [f64],
    family_size: &mut [u16],
) -> Option<LatticeBody> {
    let horizon = one_horizon(view, members, table)?;
    let cut = options.volume.reach(horizon, options.lattice_spacing);
    let volume: usize = sites.size.iter().map(|&n| n as usize).product();
    if cut > FARTHEST * sites.spacing || volume > SPARSEST * members.len() + 65_536 {
        return None;
    }
    let axes = (0..3).map(|row| axes(row, sites.size)).min_by_key(|&axes| {
        let (cells, changes) = cost(view, members, sites, axes);
        // Along x, LAMMPS' creation order makes gathering cheaper.
        (cells + TYPE_CHANGE * changes) * if axes[0] == 0 { 20 } else { 23 }
    })?;
    let (cells, _) = cost(view, members, sites, axes);
    if cells > 4 * members.len() + 512 || cells > u32::MAX as usize / 32 {
        return None;
    }
    let mut body = LatticeBody { spacing: sites.spacing, axes, horizon, ..Default::default() };
    stencil(&mut body, cut);
    rows(&mut body, members, sites);
    connect(&mut body, view, table, options, (family_volume, family_size));
    Some(body)
}

fn one_horizon(view: &PeriView, members: &[u32], table: &PmbTable) -> Option<f64> {
    let mut kinds: Vec<u16> = members.iter().map(|&i| view.kind[i as usize]).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let pairs = kinds.iter().flat_map(|&a| kinds.iter().map(move |&b| (a, b)));
    let mut horizons = pairs.filter_map(|(a, b)| table.get(a, b)).map(|c| c.horizon);
    let first = horizons.next()?;
    (kinds.len() < 256 && horizons.all(|h| h == first)).then_some(first)
}

/// Rows along `row`; of the other two directions planes follow each other along the longer one.
fn axes(row: usize, size: [i32; 3]) -> [usize; 3] {
    let (a, b) = ((row + 1) % 3, (row + 2) % 3);
    if size[a] > size[b] { [row, b, a] } else { [row, a, b] }
}

/// Cells with padding, and type changes along rows.
fn cost(view: &PeriView, members: &[u32], sites: &Sites, axes: [usize; 3]) -> (usize, usize) {
    let [along, across, up] = axes.map(|a| sites.size[a] as usize);
    let mut extent = vec![(i32::MAX, i32::MIN); across * up];
    for at in &sites.at {
        let e = &mut extent[at[axes[1]] as usize + across * at[axes[2]] as usize];
        *e = (e.0.min(at[axes[0]]), e.1.max(at[axes[0]]));
    }
    let length =
        |e: &(i32, i32)| if e.0 > e.1 { 0 } else { ((e.1 - e.0 + 1) as usize).next_multiple_of(LANES) };
    let cells = extent.iter().map(length).sum();
    let first = view.kind[members[0] as usize];
    if members.iter().all(|&i| view.kind[i as usize] == first) {
        return (cells, 0);
    }
    let mut kind = vec![0u16; along * across * up];
    for (&i, at) in members.iter().zip(&sites.at) {
        let [x, y, z] = axes.map(|a| at[a] as usize);
        kind[x + along * (y + across * z)] = view.kind[i as usize];
    }
    let changes = kind
        .chunks(along)
        .map(|row| row.windows(2).filter(|w| w[0] != w[1] && w[0] != 0 && w[1] != 0).count())
        .sum();
    (cells, changes)
}

/// Half of all lattice vectors within the cut, and the row steps among them.
fn stencil(body: &mut LatticeBody, cut: f64) {
    let reach = (cut / body.spacing * (1.0 + 1e-9)).floor() as i32;
    let most = (cut / body.spacing).powi(2) * (1.0 + 2e-9);
    body.reach = reach;
    for along in -reach..=reach {
        for up in 0..=reach {
            for across in -reach..=reach {
                let after = (up, across, along) > (0, 0, 0);
                if !after || f64::from(up * up + across * across + along * along) > most {
                    continue;
                }
                body.stencil.push([along, across, up]);
                let step = (across, up as usize);
                let known = body.steps.iter().position(|&s| s == step);
                body.step_of.push(known.unwrap_or(body.steps.len()) as u16);
                if known.is_none() {
                    body.steps.push(step);
                }
            }
        }
    }
}

fn rows(body: &mut LatticeBody, members: &[u32], sites: &Sites) {
    let [_, across, up] = body.axes.map(|a| sites.size[a] as usize);
    let reach = body.reach as usize;
    body.planes = up;
    body.width = across + 2 * reach;
    // Thick slabs hand over fewer forces twice, many slabs keep threads equally busy.
    body.thickness = up.div_ceil(16).clamp(reach, 2 * reach).max(1);
    let mut extent = vec![(i32::MAX, i32::MIN); body.width * (up + reach + 1)];
    let slot = |at: &[i32; 3]| {
        let [_, y, z] = body.axes.map(|a| at[a] as usize);
        z * body.width + y + reach
    };
    for at in &sites.at {
        let e = &mut extent[slot(at)];
        *e = (e.0.min(at[body.axes[0]]), e.1.max(at[body.axes[0]]));
    }
    let mut start = 0;
    body.rows = Vec::with_capacity(extent.len());
    for (lo, hi) in extent {
        let len = if lo > hi { 0 } else { ((hi - lo + 1) as u32).next_multiple_of(LANES as u32) };
        body.rows.push(Row { start, len, lo: if len > 0 { lo } else { 0 }, kind: 0 });
        start += len;
    }
    let cells = start as usize;
    body.particle = vec![u32::MAX; cells];
    for (&i, at) in members.iter().zip(&sites.at) {
        let row = &body.rows[slot(at)];
        body.particle[row.start as usize + (at[body.axes[0]] - row.lo) as usize] = i;
    }
    let chunks = cells / LANES;
    body.stride = staggered(cells);
    body.u = [(); 2].map(|()| vec![0.0; 3 * body.stride]);
    body.alive = vec![0; chunks * body.stencil.len()];
    body.intact = vec![false; chunks];
    body.tension = vec![0.0; chunks];
    body.compression = vec![0.0; chunks];
    body.measure = vec![0.0; chunks];
    body.floor = vec![0.0; chunks];
    body.flagged = vec![0; chunks];
    body.motion = vec![RowMotion::NONE; body.rows.len()];
}

/// Sets the alive bits of all bonds.
fn connect(
    body: &mut LatticeBody,
    view: &PeriView,
    table: &PmbTable,
    options: &FamilyOptions,
    (family_volume, family_size): (&mut [f64], &mut [u16]),
) {
    let entries = body.stencil.len();
    body.contact = f64::NEG_INFINITY;
    for slot in 0..body.planes * body.width {
        let row = body.rows[slot];
        for e in 0..entries {
            let [along, across, up] = body.stencil[e];
            if row.len == 0 {
                break;
            }
            let other = body.rows[(slot + up as usize * body.width).wrapping_add_signed(across as isize)];
            let shift = along + row.lo - other.lo;
            for c in 0..row.len as i32 {
                let to = c + shift;
                if to < 0 || to >= other.len as i32 {
                    continue;
                }
                let cell = row.start as usize + c as usize;
                let (i, j) = (body.particle[cell], body.particle[other.start as usize + to as usize]);
                if i == u32::MAX || j == u32::MAX {
                    continue;
                }
                let (a, b) = (i as usize, j as usize);
                let Some(coeff) = table.get(view.kind[a], view.kind[b]) else { continue };
                let cut = options.volume.reach(coeff.horizon, options.lattice_spacing);
                let (rsq, _) = distance(view, i, j);
                if rsq <= cut * cut && !view.excludes(i, j) {
                    body.alive[cell / LANES * entries + e] |= 1 << (cell % LANES);
                    family_volume[a] += view.volume[b];
                    family_volume[b] += view.volume[a];
                    family_size[a] += 1;
                    family_size[b] += 1;
                    let contact = options.contact_range(view, i, j);
                    body.contact = body.contact.max(contact * contact / rsq - 1.0);
                }
            }
        }
    }
    for slot in 0..body.planes * body.width {
        let row = body.rows[slot];
        let leads = |e: &usize| {
            let [_, across, up] = body.stencil[*e];
            body.rows[(slot + up as usize * body.width).wrapping_add_signed(across as isize)].len > 0
        };
        let vectors: Vec<usize> = if row.len > 0 { (0..entries).filter(leads).collect() } else { vec![] };
        for chunk in row.start as usize / LANES..(row.start + row.len) as usize / LANES {
            let whole = |&e: &usize| body.alive[chunk * entries + e] == u8::MAX;
            body.intact[chunk] = vectors.iter().all(whole);
        }
    }
}
