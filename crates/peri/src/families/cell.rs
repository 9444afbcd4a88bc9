//! The box that families were found in: reference bonds go by its edges, whatever has become of it since.
//!
//! A bond across a face that repeats leads to an image, t edges away. At the start that was H₀ t away and now it is H t, so that the
//! bond is xi + (u_j − u_i) + (H − H₀) t long, with xi the one by the edges at the start.

use perigrain_base::math::periods::Periods;

/// The edges of a box, as a scene keeps them.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Edges {
    length: [f64; 3],
    tilt: [f64; 3],
}

impl From<Periods> for Edges {
    fn from(p: Periods) -> Self {
        Self { length: p.length, tilt: p.tilt }
    }
}

impl Edges {
    /// As images are sought.
    pub fn periods(self) -> Periods {
        Periods { length: self.length, tilt: self.tilt }
    }
}

/// F − 1 of a box whose edges H are those at the start strained by F: an upper triangle.
pub type BoxStrain = [[f64; 3]; 3];

/// The box of families during an evaluation.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cell {
    /// Its edges when they were found.
    pub birth: Periods,
    /// How it is strained now, and how it was in the last step that advanced.
    pub strain: [BoxStrain; 2],
}

impl Cell {
    /// A box that is as it was when families were found.
    pub fn unstrained(birth: Periods) -> Self {
        Self { birth, ..Self::default() }
    }

    /// Whether it is not.
    pub fn strained(&self) -> bool {
        self.strain != [BoxStrain::default(); 2]
    }

    /// What is to be taken from the displacement between the ends of a bond that leads `by` images' edges away.
    pub fn shift(&self, before: bool, by: [f64; 3]) -> [f64; 3] {
        self.strain[usize::from(before)].map(|row| row[0] * by[0] + row[1] * by[1] + row[2] * by[2])
    }
}

/// (H − H₀) H₀⁻¹; an edge that repeats no more counts as it was.
pub(crate) fn strain(birth: &Periods, now: &Periods) -> BoxStrain {
    let mut x = BoxStrain::default();
    if birth == now {
        return x;
    }
    let edges = |p: &Periods| {
        let length: [f64; 3] = std::array::from_fn(|k| match (p.length[k] > 0.0, birth.length[k] > 0.0) {
            (true, true) => p.length[k],
            (_, true) => birth.length[k],
            _ => 1.0,
        });
        [[length[0], p.tilt[0], p.tilt[1]], [0.0, length[1], p.tilt[2]], [0.0, 0.0, length[2]]]
    };
    let (first, present) = (edges(birth), edges(now));
    for row in 0..3 {
        for k in row..3 {
            let known: f64 = (row..k).map(|m| x[row][m] * first[m][k]).sum();
            x[row][k] = (present[row][k] - first[row][k] - known) / first[k][k];
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strained_edges_are_the_strain_times_the_first_ones() {
        let birth = Periods { length: [4.0, 2.0, 8.0], tilt: [1.0, -2.0, 0.5] };
        let now = Periods { length: [4.4, 2.1, 7.0], tilt: [0.7, -1.5, 0.6] };
        let cell = Cell { birth, strain: [strain(&birth, &now), BoxStrain::default()] };
        for t in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, -1.0, 2.0]] {
            let (first, present) = (birth.shift(t), now.shift(t));
            let more = cell.shift(false, first);
            assert!((0..3).all(|k| (first[k] + more[k] - present[k]).abs() < 1e-14), "{t:?}");
            assert_eq!(cell.shift(true, first), [0.0; 3]);
        }
        assert!(cell.strained() && !Cell::unstrained(birth).strained());
        // Faces that do not repeat know no strain.
        let open = Periods { length: [4.0, 0.0, 8.0], tilt: [0.0; 3] };
        assert_eq!(strain(&open, &Periods { length: [5.0, 0.0, 8.0], tilt: [0.0; 3] })[1], [0.0; 3]);
    }
}
