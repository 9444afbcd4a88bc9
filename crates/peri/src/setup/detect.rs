//! Bodies: which particles hang together by bonds.

use crate::families::{Cells, FamilyOptions, PeriView, PmbTable};
use perigrain_base::math::forest::{find, join};

/// The bodies of a scene.
#[derive(Debug)]
pub struct Bodies {
    /// Particles of each body, in order; bodies in the order of their first particles. Particles without
    /// bonds belong to none.
    pub members: Vec<Vec<u32>>,
    /// Smallest bond length per body.
    pub nearest: Vec<f64>,
    /// Whether a bond of the body crosses a periodic face.
    pub wraps: Vec<bool>,
}

/// Squared length of the shortest image of the vector from `j` to `i`, and whether it is not the plain one.
pub fn distance(view: &PeriView, i: u32, j: u32) -> (f64, bool) {
    let (a, b) = (view.x[i as usize], view.x[j as usize]);
    let plain = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let d = view.bounds.nearest(plain);
    (d[0] * d[0] + d[1] * d[1] + d[2] * d[2], d != plain)
}

/// Calls `f(i, j, |x_i - x_j|^2, whether the shortest image crosses a periodic face)` for every bond. Where particles have spacings
/// of their own, over that of the lattice, there is a bond if one end is within the horizon of the other.
pub fn bonds(
    view: &PeriView,
    which: impl Iterator<Item = u32> + Clone,
    (table, options, spacing): (&PmbTable, &FamilyOptions, &[f64]),
    mut f: impl FnMut(u32, u32, f64, bool),
) {
    let far = reach(table, options, spacing);
    if far <= 0.0 {
        return;
    }
    let mut cells = Cells::default();
    cells.fill(view.x, which, &view.bounds, far);
    let cut_of = |a: u16, b: u16| -> Option<f64> {
        Some(options.volume.reach(table.get(a, b)?.horizon, options.lattice_spacing))
    };
    let mut last = ((0, 0), None);
    cells.within(&view.bounds, far, |i, j, rsq, wraps| {
        let kinds = (view.kind[i as usize], view.kind[j as usize]);
        if last.0 != kinds {
            last = (kinds, cut_of(kinds.0, kinds.1));
        }
        let Some(cut) = last.1 else { return };
        let cut = match spacing {
            [] => cut,
            own => cut * own[i as usize].max(own[j as usize]),
        };
        if rsq <= cut * cut && !view.excludes(i, j) {
            f(i, j, rsq, wraps);
        }
    });
}

/// The longest reach of any family.
pub fn reach(table: &PmbTable, options: &FamilyOptions, spacing: &[f64]) -> f64 {
    let widest = spacing.iter().copied().reduce(f64::max).unwrap_or(1.0);
    widest
        * table.iter().map(|c| options.volume.reach(c.horizon, options.lattice_spacing)).fold(0.0, f64::max)
}

/// Finds the bodies of a scene.
pub fn bodies(view: &PeriView, table: &PmbTable, options: &FamilyOptions, spacing: &[f64]) -> Bodies {
    let n = view.x.len();
    let mut parent: Vec<u32> = (0..n as u32).collect();
    let mut shortest = vec![f64::INFINITY; n];
    let mut crosses = vec![false; n];
    bonds(view, 0..n as u32, (table, options, spacing), |i, j, rsq, wraps| {
        if parent[i as usize] != parent[j as usize] {
            join(&mut parent, i, j);
        }
        shortest[i as usize] = shortest[i as usize].min(rsq);
        shortest[j as usize] = shortest[j as usize].min(rsq);
        crosses[i as usize] |= wraps;
    });
    let mut found = Bodies { members: vec![], nearest: vec![], wraps: vec![] };
    let mut body = vec![u32::MAX; n];
    for i in 0..n {
        if shortest[i].is_infinite() {
            continue;
        }
        let r = find(&mut parent, i as u32) as usize;
        if body[r] == u32::MAX {
            body[r] = found.members.len() as u32;
            found.members.push(vec![]);
            found.nearest.push(f64::INFINITY);
            found.wraps.push(false);
        }
        let b = body[r] as usize;
        found.members[b].push(i as u32);
        found.nearest[b] = found.nearest[b].min(shortest[i].sqrt());
        found.wraps[b] |= crosses[i];
    }
    found
}
