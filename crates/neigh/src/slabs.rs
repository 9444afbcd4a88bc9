//! Particles in the order of cells, and cells in slabs: the spatial order that granular loops and the world work in.

use super::grid::extent;
use super::list::small;
use perigrain_base::math::periods::Periods;
use perigrain_base::par;
use std::borrow::Cow;
use std::ops::Range;

/// Slabs are so thick that they hold this many points on average: what a list costs by itself is then little beside what its points
/// cost (discs of LAMMPS' `in.pour.2d`, 12 in a layer of cells: 48 are worth 15 % of the run, 200 are worth 19 %).
const CROWD: usize = 128;
/// But so many slabs there are at least, where cells are enough for them, that threads have something to share.
const SHARES: usize = 8;
/// Fewer points are one slab: no second thread pays for them.
const FEW: usize = 256;
/// Layers that pairs may reach over: more than there can be.
const FARTHEST: f64 = 1e9;
/// Largest radius in units of the smallest up to which one grid of cells serves all.
const ALIKE: f64 = 4.0;
/// Cells per particle at most; beyond that cells grow.
const SPARSE: usize = 4;

/// Points sorted by cell: along a fast axis, then a middle one, then a slow one; within a cell by tag. The order is a
/// function of positions and tags alone. In a box that leans cells lean with it: they are counted in the box made upright, and as
/// thick between their faces as they are long elsewhere.
#[derive(Clone, Debug, Default)]
pub struct Slabs {
    /// Fast, middle and slow axis.
    axes: [usize; 3],
    /// Cells along these.
    cells: [usize; 3],
    /// Whether these repeat.
    repeats: [bool; 3],
    /// Lower corner of the box, and its edges: cells lean with it.
    corner: [f64; 3],
    period: Periods,
    lo: [f64; 3],
    per_length: [f64; 3],
    /// Layers of cells in a slab, so that pairs of cells reach into the next slab at most, and so that all pairs do: the same for any
    /// number of threads, because it decides the order in which forces are added up.
    layers: [usize; 2],
    /// First place of each cell, and the number of all places.
    start: Vec<u32>,
    /// The point at each place.
    pub order: Vec<u32>,
}

/// Cells along one axis, for points of the box made upright.
#[derive(Clone, Copy)]
struct Line {
    axis: usize,
    lo: f64,
    per_length: f64,
    /// The last cell.
    most: i32,
}

impl Line {
    /// The cell of a point; the first or last one for what is beyond.
    #[inline]
    fn cell(&self, x: &[f64; 3]) -> u32 {
        (((x[self.axis] - self.lo) * self.per_length) as i32).clamp(0, self.most) as u32
    }
}

/// A run of neighbouring places and the image they are seen in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// First place.
    pub from: u32,
    /// Past the last place.
    pub to: u32,
    /// The code of the image, see [`shift_of`].
    pub image: u32,
}

/// How long the edges of cells should be, and how far pairs reach, for spheres whose surfaces are up to `more` apart.
///
/// Cells of spheres of about one size are as long as pairs reach, and neighbours are in neighbouring cells. Where sizes
/// differ much, this holds for the [`small`] ones, and [`pairs_of_large`](super::list::pairs_of_large) finds the others.
pub fn edges(radius: &[f64], more: f64) -> [f64; 2] {
    let (least, most) = (par::best(radius, f64::INFINITY, f64::min), par::best(radius, 0.0, f64::max));
    let reach = 2.0 * most + more;
    if most <= ALIKE * least {
        return [reach; 2];
    }
    let small = small(radius);
    let larger = par::best(radius, 0.0, |a, r| if r < small && r > a { r } else { a });
    [2.0 * larger + more, reach]
}

/// The image in which nothing is shifted.
pub const HERE: u32 = perigrain_base::math::lanes::NO_SHIFT;

/// How many periods an image is away along x, y and z.
pub fn shift_of(image: u32) -> [f64; 3] {
    [image % 3, image / 3 % 3, image / 9 % 3].map(|k| f64::from(k) - 1.0)
}

/// Points of the box made upright.
fn straightened<'a>(x: &'a [[f64; 3]], lo: &[f64; 3], period: &Periods) -> Cow<'a, [[f64; 3]]> {
    if !period.tilted() {
        return Cow::Borrowed(x);
    }
    let mut straight = x.to_vec();
    par::each(&mut straight[..], |_, points| {
        points.iter_mut().for_each(|x| *x = period.straightened(*x, *lo));
    });
    Cow::Owned(straight)
}

impl Slabs {
    /// Sorts all points into cells of at least `edge`, for pairs that reach so far at most; `lo` and `period` describe the
    /// box, which leans only where it repeats; where it does, its height is at least the reach.
    pub fn sort(
        &mut self,
        x: &[[f64; 3]],
        tag: &[u32],
        [edge, reach]: [f64; 2],
        lo: &[f64; 3],
        period: &Periods,
    ) {
        let straight = straightened(x, lo, period);
        self.lay_out(&straight, [edge, reach], lo, period);
        let mut cell = vec![0; x.len()];
        let (lines, [nx, ny, _]) = ([0, 1, 2].map(|k| self.line(k)), self.cells.map(|n| n as u32));
        par::each((&mut cell[..], &straight[..]), |_, (cell, x)| {
            let of = |x| lines.map(|line| line.cell(x));
            cell.iter_mut().zip(x).for_each(|(cell, x)| {
                let [x, y, z] = of(x);
                *cell = (z * ny + y) * nx + x;
            });
        });
        self.start.clear();
        self.start.resize(self.cells.iter().product::<usize>() + 1, 0);
        cell.iter().for_each(|&c| self.start[c as usize + 1] += 1);
        for c in 1..self.start.len() {
            self.start[c] += self.start[c - 1];
        }
        self.order.clear();
        if cell.is_sorted() {
            self.order.extend(0..x.len() as u32);
        } else {
            let mut next = self.start.clone();
            self.order.resize(x.len(), 0);
            for (i, &c) in cell.iter().enumerate() {
                self.order[next[c as usize] as usize] = i as u32;
                next[c as usize] += 1;
            }
        }
        // Point by point: there may be more cells than points.
        for place in 1..self.order.len() {
            let [before, here] = [place - 1, place].map(|p| self.order[p] as usize);
            let of = cell[here] as usize;
            if cell[before] == cell[here] && tag[before] > tag[here] {
                let members = self.start[of] as usize..self.start[of + 1] as usize;
                self.order[members].sort_unstable_by_key(|&i| tag[i as usize]);
            }
        }
    }

    /// Cells and slabs for all points, as [`Slabs::sort`] makes them, into which nobody is sorted.
    pub fn laid_out(x: &[[f64; 3]], edges: [f64; 2], lo: &[f64; 3], period: &Periods) -> Self {
        let mut slabs = Self::default();
        slabs.lay_out(&straightened(x, lo, period), edges, lo, period);
        slabs
    }

    /// Fast, middle and slow axis; along the last one slabs follow each other.
    pub fn axes(&self) -> [usize; 3] {
        self.axes
    }

    /// Slabs for pairs that reach into neighbouring cells.
    pub fn near(&self) -> Cut<'_> {
        Cut { of: self, layers: self.layers[0] }
    }

    /// Slabs for all pairs: where spheres are of about one size, the same ones.
    pub fn far(&self) -> Cut<'_> {
        Cut { of: self, layers: self.layers[1] }
    }

    /// The layer of cells that a point lies in.
    pub fn layer_of(&self, x: &[f64; 3]) -> usize {
        self.line(2).cell(&self.period.straightened(*x, self.corner)) as usize
    }

    /// Cells along one of the axes, of which 2 is the slow one.
    fn line(&self, k: usize) -> Line {
        let most = self.cells[k].saturating_sub(1) as i32;
        Line { axis: self.axes[k], lo: self.lo[k], per_length: self.per_length[k], most }
    }

    /// For points of the box made upright.
    fn lay_out(&mut self, x: &[[f64; 3]], [edge, reach]: [f64; 2], lo: &[f64; 3], period: &Periods) {
        let wider = |a: ([f64; 3], [f64; 3]), b: ([f64; 3], [f64; 3])| {
            let with =
                |f: fn(f64, f64) -> f64, a: [f64; 3], b: [f64; 3]| std::array::from_fn(|d| f(a[d], b[d]));
            (with(f64::min, a.0, b.0), with(f64::max, a.1, b.1))
        };
        let of = |range: Range<usize>| extent(x, range.start as u32..range.end as u32);
        let (from, to) = par::reduce(x.len(), of, wider).unwrap_or_else(|| extent(x, 0..0));
        (self.corner, self.period) = (*lo, *period);
        let (period, tilt, spread) = (period.length, period.tilt, period.spread());
        let open = |d: usize| period[d] == 0.0;
        let origin: [f64; 3] = std::array::from_fn(|d| if open(d) { from[d] } else { lo[d] });
        let length: [f64; 3] =
            std::array::from_fn(|d| if open(d) { (to[d] - from[d]).max(0.0) } else { period[d] });
        let room = (64 + SPARSE * x.len()) as f64;
        let mut size = edge.max(f64::MIN_POSITIVE);
        let count = loop {
            let along = |d: usize| (length[d] / (size * spread[d])).floor() + if open(d) { 1.0 } else { 0.0 };
            let count = [0, 1, 2].map(|d| along(d).max(1.0));
            let all = count[0] * count[1] * count[2];
            if all <= room || x.is_empty() {
                break count.map(|c| if x.is_empty() { 1 } else { c as usize });
            }
            size *= (all / room).cbrt().clamp(1.01, 1e100);
        };
        // Spheres larger than all that is there reach over all of it.
        let layers = (reach / size).ceil().min(FARTHEST) as usize;
        let far = if reach > size { layers.max(1) } else { 1 };
        // The slow axis: the longest of those that do not repeat, or the longest of all if these are thin. A box that leans along x
        // with y alone is mostly sheared so: grains of a slab across y go the same way.
        let slow = |open_only: bool| (0..3).filter(|&d| !open_only || open(d)).max_by_key(|&d| count[d]);
        let thin = |d: &usize| count[*d] < 4 * far;
        let sheared = Some(1).filter(|_| tilt[0] != 0.0 && tilt[1..] == [0.0; 2]);
        let slowest = sheared.or(slow(true)).filter(|d| !thin(d)).or(slow(false)).unwrap_or(2);
        let mut rest = [0, 1, 2].into_iter().filter(|&d| d != slowest);
        self.axes = [rest.next().unwrap_or(0), rest.next().unwrap_or(1), slowest];
        self.cells = self.axes.map(|d| count[d]);
        let most = if x.len() < FEW { 1 } else { SHARES.max(x.len() / CROWD) };
        let near = self.cells[2].div_ceil(most);
        self.layers = [near, far.max(near)];
        self.repeats = self.axes.map(|d| !open(d));
        self.lo = self.axes.map(|d| origin[d]);
        let per_length =
            |d: usize| if open(d) { 1.0 / (size * spread[d]) } else { count[d] as f64 / length[d] };
        self.per_length = self.axes.map(per_length);
    }

    /// The places of a cell.
    pub fn places(&self, cell: usize) -> Range<usize> {
        self.start[cell] as usize..self.start[cell + 1] as usize
    }

    /// The half neighbourhood of a cell beyond itself: every pair of neighbouring cells, each in each of its images,
    /// occurs from one side only.
    pub fn runs(&self, cell: usize, out: &mut Vec<Run>) {
        out.clear();
        let [nx, ny, _] = self.cells;
        let (row, layer) = (cell / nx, cell / nx / ny);
        let at = [cell - row * nx, row - layer * ny, layer];
        let within = |k: usize| at[k] > 0 && at[k] + 1 < self.cells[k];
        if (0..3).all(|k| !self.repeats[k] || within(k)) {
            return self.rows_within(at, out);
        }
        for (dx, dy, dz) in [(1..2, 0, 0), (-1..2, 1, 0), (-1..2, -1, 1), (-1..2, 0, 1), (-1..2, 1, 1)] {
            self.row(at, (dx, dy, dz), out);
        }
    }

    /// [`Slabs::runs`] of a cell of which no neighbour is an image: a run in each row of cells that is there.
    fn rows_within(&self, [x, y, z]: [usize; 3], out: &mut Vec<Run>) {
        let [nx, ny, nz] = self.cells;
        let mut put = |row: usize, first: usize, last: usize| {
            let run =
                Run { from: self.start[row * nx + first], to: self.start[row * nx + last + 1], image: HERE };
            if run.from < run.to {
                out.push(run);
            }
        };
        let (row, first, last) = (z * ny + y, x.saturating_sub(1), (x + 1).min(nx - 1));
        if x < last {
            put(row, last, last);
        }
        if y + 1 < ny {
            put(row + 1, first, last);
        }
        if z + 1 < nz {
            let above = row + ny;
            if y > 0 {
                put(above - 1, first, last);
            }
            put(above, first, last);
            if y + 1 < ny {
                put(above + 1, first, last);
            }
        }
    }

    /// Cells at offsets along the fast axis in one row.
    fn row(&self, at: [usize; 3], (dx, dy, dz): (Range<i32>, i32, i32), out: &mut Vec<Run>) {
        let wrapped = |k: usize, offset: i32| {
            let (c, n) = (at[k] as i32 + offset, self.cells[k] as i32);
            match self.repeats[k] {
                _ if (0..n).contains(&c) => Some((c as usize, 0)),
                true => Some((c.rem_euclid(n) as usize, c.div_euclid(n))),
                false => None,
            }
        };
        let (Some((y, sy)), Some((z, sz))) = (wrapped(1, dy), wrapped(2, dz)) else { return };
        let row = (z * self.cells[1] + y) * self.cells[0];
        // Within the row all cells are one run.
        let (first, last) = (at[0] as i32 + dx.start, at[0] as i32 + dx.end - 1);
        if (sy, sz) == (0, 0) && first >= 0 && (last as usize) < self.cells[0] {
            let (from, to) = (self.start[row + first as usize], self.start[row + last as usize + 1]);
            return out.push(Run { from, to, image: HERE });
        }
        for (x, sx) in dx.filter_map(|dx| wrapped(0, dx)) {
            let mut shift = [0; 3];
            (shift[self.axes[0]], shift[self.axes[1]], shift[self.axes[2]]) = (sx, sy, sz);
            let image = (HERE as i32 + shift[0] + 3 * shift[1] + 9 * shift[2]) as u32;
            let cell = row + x;
            let run = Run { from: self.start[cell], to: self.start[cell + 1], image };
            match out.last_mut() {
                Some(last) if last.to == run.from && last.image == image => last.to = run.to,
                _ => out.push(run),
            }
        }
    }
}

/// Cells cut into slabs across the slow axis, some layers each.
#[derive(Clone, Copy, Debug)]
pub struct Cut<'a> {
    of: &'a Slabs,
    layers: usize,
}

impl Cut<'_> {
    /// Number of slabs. Pairs of a slab lie in it or reach into the next one, of the last into the first where the slow axis
    /// repeats; there are then an even number of slabs, or one.
    pub fn count(&self) -> usize {
        let slabs = (self.of.cells[2] / self.layers.max(1)).max(1);
        if self.of.repeats[2] && slabs > 1 { slabs & !1 } else { slabs }
    }

    /// The slab that pairs of slab `k` reach into, if there is one.
    pub fn next(&self, k: usize) -> Option<usize> {
        let next = (k + 1) % self.count();
        (next > k || self.of.repeats[2]).then_some(next)
    }

    /// The cells of slab `k`.
    pub fn slab(&self, k: usize) -> Range<usize> {
        let [nx, ny, layers] = self.of.cells;
        let slabs = self.count();
        k * layers / slabs * (nx * ny)..(k + 1) * layers / slabs * (nx * ny)
    }

    /// The places of slab `k`.
    pub fn members(&self, k: usize) -> Range<usize> {
        let cells = self.slab(k);
        self.of.start[cells.start] as usize..self.of.start[cells.end] as usize
    }

    /// The slab of each layer of cells.
    pub fn of_layers(&self) -> Vec<usize> {
        let layer = self.of.cells[0] * self.of.cells[1];
        let mut of = Vec::with_capacity(self.of.cells[2]);
        (0..self.count()).for_each(|k| of.resize(self.slab(k).end / layer, k));
        of
    }
}

#[cfg(test)]
mod tests;
