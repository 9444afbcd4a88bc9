//! The spacing around each particle, where bodies have no lattice: horizons count in it.

use crate::families::{Cells, PeriView, PmbTable};

/// How far around a particle its spacing is looked for, in edges of its own volume.
const AROUND: f64 = 2.0;

/// The spacing around each particle over that of the lattice: the cube root of the mean volume of the particles of solids within
/// two edges of its own, an edge being the cube root of a volume. 1 for particles of no solid.
pub fn spacings(view: &PeriView, table: &PmbTable, lattice: f64) -> Vec<f64> {
    let solid = |i: &u32| table.get(view.kind[*i as usize], view.kind[*i as usize]).is_some();
    let members: Vec<u32> = (0..view.x.len() as u32).filter(solid).collect();
    let reach = |i: u32| AROUND * view.volume[i as usize].cbrt();
    let far = members.iter().map(|i| reach(*i)).fold(0.0, f64::max);
    let mut around: Vec<(f64, f64)> = view.volume.iter().map(|v| (*v, 1.0)).collect();
    let mut cells = Cells::default();
    cells.fill(view.x, members.iter().copied(), &view.bounds, far);
    cells.within(&view.bounds, far, |i, j, square, _| {
        for (own, other) in [(i, j), (j, i)] {
            if square <= reach(own).powi(2) {
                let (sum, count) = &mut around[own as usize];
                *sum += view.volume[other as usize];
                *count += 1.0;
            }
        }
    });
    let mut found = vec![1.0; view.x.len()];
    for i in members {
        let (sum, count) = around[i as usize];
        found[i as usize] = (sum / count).cbrt() / lattice;
    }
    found
}
