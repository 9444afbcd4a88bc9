//! Bin centres as a grid over the box: sums over nearby items, and differences between neighbouring bins.

use super::Chunks;
use perigrain_base::math::vec3::Vec3;
use perigrain_base::par;
use perigrain_styles::Bins;
use perigrain_world::Domain;
use std::sync::{Mutex, PoisonError};

/// Bins along one of their axes; a direction without bins has a single one, at distance 0 from everything.
#[derive(Clone, Copy, Debug)]
struct Row {
    dim: Option<usize>,
    count: usize,
    /// Distance of neighbours in the list of chunks.
    stride: usize,
    /// Centre of the first [length].
    first: f64,
    /// Distance between centres [length].
    step: f64,
    /// Length of the box where it is periodic.
    period: Option<f64>,
}

impl Row {
    /// Calls `f(k, shift)` for each bin k between two coordinates and for each periodic image of the item
    /// there: a coordinate of the image relative to the centre is the coordinate plus `shift`.
    fn reach(&self, lo: f64, hi: f64, mut f: impl FnMut(usize, f64)) {
        if self.dim.is_none() {
            return f(0, 0.0);
        }
        if !(hi - lo).is_finite() {
            return;
        }
        let last = self.first + (self.count - 1) as f64 * self.step;
        let images = match self.period {
            Some(l) => ((self.first - hi) / l).ceil() as i64..=((last - lo) / l).floor() as i64,
            None => 0..=0,
        };
        for image in images {
            let away = self.period.map_or(0.0, |l| image as f64 * l);
            let index = |x: f64| (x + away - self.first) / self.step;
            let (from, to) = (index(lo).ceil().max(0.0), index(hi).floor().min((self.count - 1) as f64));
            if from <= to {
                (from as usize..=to as usize).for_each(|k| f(k, away - (self.first + k as f64 * self.step)));
            }
        }
    }

    /// Distance from the last bin to the first across the periodic face, if they are neighbours [length].
    fn gap(&self) -> Option<f64> {
        let gap = self.period? - (self.count - 1) as f64 * self.step;
        (self.count > 1 && gap < 1.5 * self.step).then_some(gap)
    }
}

/// All bins of a `compute chunk/atom`.
#[derive(Clone, Debug)]
pub struct Grid {
    rows: [Row; 3],
}

impl Grid {
    /// The grid of chunks that are bins, in lengths; `None` without chunks.
    pub fn of(chunks: &Chunks, bins: Bins, d: &Domain) -> Option<Self> {
        let total = chunks.count();
        if total == 0 {
            return None;
        }
        let lengths = d.lengths();
        let mut within = total;
        let rows = [0, 1, 2].map(|axis| {
            let dim = bins.axes[axis];
            let place = |k: usize| match dim {
                Some(dim) if bins.reduced => d.lo[dim] + chunks.coordinate(k, axis) * lengths[dim],
                Some(_) => chunks.coordinate(k, axis),
                None => 0.0,
            };
            // Along an axis the bins share a coordinate until the next layer begins.
            let first = place(0);
            let stride = match dim {
                Some(_) => (1..within).find(|&k| place(k) != first).unwrap_or(within),
                None => within,
            };
            let count = within / stride;
            within = stride;
            let step = if count > 1 { place(stride) - first } else { 1.0 };
            let period = dim.filter(|&dim| d.boundary.periodic(dim)).map(|dim| lengths[dim]);
            Row { dim, count, stride, first, step, period }
        });
        Some(Self { rows })
    }

    /// The number of bins.
    pub fn bins(&self) -> usize {
        self.rows.iter().map(|r| r.count).product()
    }

    /// Whether there are bins along a direction.
    pub fn has(&self, dim: usize) -> bool {
        self.rows.iter().any(|r| r.dim == Some(dim))
    }

    /// The coordinates of a vector along the axes of the bins, in their order, then zeros.
    pub fn along_axes(&self, x: Vec3) -> Vec3 {
        self.rows.map(|r| r.dim.map_or(0.0, |d| x[d]))
    }

    /// The shortest periodic length of the box along an axis of the bins [length].
    pub fn shortest_period(&self) -> Option<f64> {
        self.rows.iter().filter_map(|r| r.period).reduce(f64::min)
    }

    /// Sums `term(item, shift)` of `n` items for each bin whose centre lies between the item's two corners,
    /// given in coordinates along the axes; relative to the centre, the item is at its own coordinates plus
    /// `shift`.
    ///
    /// Slabs of bins normal to the first axis run in parallel, each summing in the order of the items: the
    /// bits are the same for any number of threads.
    pub fn spread<const N: usize>(
        &self,
        n: usize,
        corners: impl Fn(usize) -> Option<[Vec3; 2]> + Sync,
        term: impl Fn(usize, Vec3) -> [f64; N] + Sync,
    ) -> Vec<[f64; N]> {
        let [slabs, rows, cells] = &self.rows;
        let mut near: Vec<Vec<(usize, f64)>> = vec![vec![]; slabs.count];
        for i in 0..n {
            if let Some([lo, hi]) = corners(i) {
                slabs.reach(lo[0], hi[0], |k, shift| near[k].push((i, shift)));
            }
        }
        let sums: Vec<Mutex<Vec<[f64; N]>>> = near.iter().map(|_| Mutex::default()).collect();
        par::for_rows(slabs.count, |slab| {
            let mut sum = vec![[0.0; N]; slabs.stride];
            for &(i, x) in &near[slab] {
                let Some([lo, hi]) = corners(i) else { continue };
                rows.reach(lo[1], hi[1], |row, y| {
                    cells.reach(lo[2], hi[2], |cell, z| {
                        let t = term(i, [x, y, z]);
                        let into = &mut sum[row * rows.stride + cell * cells.stride];
                        (0..N).for_each(|k| into[k] += t[k]);
                    });
                });
            }
            *sums[slab].lock().unwrap_or_else(PoisonError::into_inner) = sum;
        });
        sums.into_iter().flat_map(|s| s.into_inner().unwrap_or_else(PoisonError::into_inner)).collect()
    }

    /// The derivative of bin values along a direction: a centred difference, one-sided at the ends of a box
    /// that is not periodic, 0 for a bin without neighbours.
    pub fn derivative(&self, bin: usize, dim: usize, value: impl Fn(usize) -> f64) -> f64 {
        let Some(row) = self.rows.iter().find(|r| r.dim == Some(dim)) else { return 0.0 };
        let (k, end) = ((bin / row.stride) % row.count, (row.count - 1) * row.stride);
        let up = match k + 1 < row.count {
            true => Some((bin + row.stride, row.step)),
            false => row.gap().map(|gap| (bin - end, gap)),
        };
        let down = match k > 0 {
            true => Some((bin - row.stride, row.step)),
            false => row.gap().map(|gap| (bin + end, gap)),
        };
        let (above, h) = up.unwrap_or((bin, 0.0));
        let (below, g) = down.unwrap_or((bin, 0.0));
        if above == below { 0.0 } else { (value(above) - value(below)) / (h + g) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(period: Option<f64>) -> Row {
        Row { dim: Some(0), count: 4, stride: 1, first: 0.5, step: 1.0, period }
    }

    #[test]
    fn images_are_seen_through_periodic_faces() {
        let near = |period: Option<f64>, lo: f64, hi: f64| {
            let mut list = vec![];
            row(period).reach(lo, hi, |k, shift| list.push((k, shift)));
            list
        };
        assert_eq!(near(None, -0.6, 0.6), [(0, -0.5)]);
        assert_eq!(near(Some(4.0), -0.6, 0.6), [(0, -0.5), (3, 0.5)]);
        // Wider than the box: each bin meets one or two images.
        assert_eq!(near(Some(4.0), -1.0, 5.0).len(), 6);
        assert!(near(Some(4.0), f64::NEG_INFINITY, f64::INFINITY).is_empty());
    }

    #[test]
    fn differences_are_centred_where_they_can_be() {
        let flat = Row { dim: None, count: 1, stride: 1, first: 0.0, step: 1.0, period: None };
        let value = |k: usize| [0.0, 1.0, 4.0, 9.0][k];
        let all = |period| {
            let g = Grid { rows: [row(period), flat, flat] };
            [0, 1, 2, 3].map(|k| g.derivative(k, 0, value))
        };
        assert_eq!(all(None), [1.0, 2.0, 4.0, 5.0]);
        assert_eq!(all(Some(4.0)), [-4.0, 2.0, 4.0, -2.0]);
        // Bins that do not fill the box have no neighbours across its face.
        assert_eq!(all(Some(6.0)), all(None));
        let g = Grid { rows: [row(None), flat, flat] };
        assert_eq!(g.derivative(1, 2, value), 0.0);
    }
}
