//! How stiff a body of microelastic bonds is as a whole where it is pulled: what its lattice, families and surfaces make of a modulus.

use crate::families::{Families, PeriView};
use crate::kinematics::determinant;
use perigrain_base::math::vec3::length;

impl Families {
    /// Young's moduli of the particles of a type pulled along x, y and z, by the mean of C_aabb = ½ Σ c w |ξ| n_a² n_b² V_j over them:
    /// strain is even along the pull, across it the mean is free. `None` without bonds in three directions, or where bonds are no springs.
    pub fn pulled(&self, view: &PeriView, kind: u16) -> Option<[f64; 3]> {
        if !self.law.kind.bond_based {
            return None;
        }
        let (mut c, mut volume) = ([[0.0; 3]; 3], 0.0);
        for i in (0..view.x.len()).filter(|&i| view.kind[i] == kind && self.family_size[i] > 0) {
            volume += view.volume[i];
            self.each(i, |n| {
                let j = n.partner as usize;
                let Some(pair) = self.table.get(view.kind[i], view.kind[j]).filter(|_| n.alive) else {
                    return;
                };
                let xi = self.first_bond(view, i, j);
                let long = length(xi);
                let shape = self.law.shape().shape(long, pair.horizon);
                let share = pair.c * shape * self.weight_of(&n, long, pair.horizon) * long;
                let square = xi.map(|x| (x / long).powi(2));
                for (a, b) in (0..3).flat_map(|a| (0..3).map(move |b| (a, b))) {
                    c[a][b] += 0.5 * share * view.volume[j] * view.volume[i] * square[a] * square[b];
                }
            });
        }
        let whole = determinant(&c);
        if volume == 0.0 || whole.is_nan() || whole <= 0.0 {
            return None;
        }
        // 1/(C⁻¹)_aa is the determinant over the minor.
        Some([0, 1, 2].map(|a| {
            let (p, q) = ((a + 1) % 3, (a + 2) % 3);
            whole / (c[p][p] * c[q][q] - c[p][q] * c[q][p]) / volume
        }))
    }
}
