//! Planes at the ends of a sample, with Hertz contacts along the axis.
//!
//! K. Jarolin, M. Dosta, Comput. Part. Mech. 8 (2021), section 2.2. The force does not depend on rotations,
//! so displacements may have any size.

use super::six::Six;

/// Contacts of particles with the planes at both ends of a sample, with forces along the axis. The low plane
/// is fixed.
#[derive(Clone, Debug, Default)]
pub struct Walls {
    /// Direction of the axis.
    pub axis: usize,
    /// Displacement of the high plane along the axis [length].
    pub delta: f64,
    /// Possible contacts of each end: particle, initial overlap, 4/3 E* √R.
    pub near: [Vec<(u32, f64, f64)>; 2],
}

impl Walls {
    /// Force and stiffness of a contact at an end.
    fn state(&self, end: usize, u: &[Six], (particle, overlap, normal): (u32, f64, f64)) -> [f64; 2] {
        let moved = u[particle as usize][self.axis];
        let overlap = (overlap + if end == 0 { -moved } else { moved - self.delta }).max(0.0);
        [normal * overlap * overlap.sqrt(), 1.5 * normal * overlap.sqrt()]
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.near.iter().all(Vec::is_empty)
    }

    /// The number of contacts at each end.
    pub fn touching(&self, u: &[Six]) -> [usize; 2] {
        [0, 1].map(|end| self.near[end].iter().filter(|c| self.state(end, u, **c)[0] > 0.0).count())
    }

    /// The approach of the two planes under a force [length].
    pub fn yielding(&self, force: f64) -> f64 {
        (0..2).map(|end| self.depth(end, force)).sum()
    }

    /// Solves Σ κ (δ − gap)^3/2 = F for the depth δ of one plane, by bisection.
    fn depth(&self, end: usize, force: f64) -> f64 {
        let near = &self.near[end];
        if near.is_empty() || force <= 0.0 {
            return 0.0;
        }
        let push = |depth: f64| near.iter().map(|c| c.2 * (c.1 + depth).max(0.0).powf(1.5)).sum::<f64>();
        let (mut low, mut high) = (0.0, 1e-12 * (force / near[0].2).cbrt().powi(2));
        while push(high) < force {
            high *= 2.0;
        }
        while high - low > 1e-15 * high {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if push(middle) < force { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// The force of each plane [force].
    pub fn push(&self, u: &[Six]) -> [f64; 2] {
        [0, 1].map(|end| self.near[end].iter().map(|c| self.state(end, u, *c)[0]).sum())
    }

    /// out += h(u).
    pub fn add_forces(&self, u: &[Six], out: &mut [Six]) {
        for (end, sign) in [(0, -1.0), (1, 1.0)] {
            for c in &self.near[end] {
                out[c.0 as usize][self.axis] += sign * self.state(end, u, *c)[0];
            }
        }
    }

    /// Axial stiffnesses by particle, summed over both planes.
    pub fn tangent(&self, u: &[Six]) -> Vec<(u32, f64)> {
        let of = |end: usize| self.near[end].iter().map(move |c| (c.0, self.state(end, u, *c)[1]));
        of(0).chain(of(1)).filter(|(_, k)| *k > 0.0).collect()
    }

    /// ∫ F dδ over all contacts [energy].
    pub fn energy(&self, u: &[Six]) -> f64 {
        let before = |c: &(u32, f64, f64)| 0.4 * c.2 * c.1.max(0.0).powf(2.5);
        let now = |end: usize, c: &(u32, f64, f64)| {
            let force = self.state(end, u, *c)[0];
            0.4 * force * (force / c.2).cbrt().powi(2)
        };
        (0..2).flat_map(|end| self.near[end].iter().map(move |c| now(end, c) - before(c))).sum()
    }
}
