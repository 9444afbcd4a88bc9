//! Particles sorted by cells, and cells by tiles: the spatial order used by the granular loops and the world.

mod around;
mod blocks;

use super::grid::extent;
use super::list::small;
pub use around::{Around, Neighbourhood, Neighbourhoods};
use blocks::{Blocks, CROWD, FEW, SHARES};
use perigrain_base::math::periods::Periods;
use perigrain_base::par;
use std::borrow::Cow;
use std::ops::Range;

/// Upper bound of the layers that pairs may reach across: more than can exist.
const FARTHEST: f64 = 1e9;
/// Largest ratio of radii for which one grid of cells serves all particles.
const ALIKE: f64 = 4.0;
/// Largest number of cells per particle; beyond it cells are enlarged.
const SPARSE: usize = 4;

/// Points sorted by tile (a block of cells), and within it by cell: along a fast axis, then a middle one,
/// then a slow one; within a cell by tag. The order is a function of positions and tags alone. In a tilted
/// box the cells are tilted too: they are counted in the box made upright, and their thickness between faces
/// equals their length elsewhere.
#[derive(Clone, Debug, Default)]
pub struct Tiles {
    /// Fast, middle and slow axis.
    axes: [usize; 3],
    /// Number of cells along these.
    cells: [usize; 3],
    /// Whether these are periodic.
    repeats: [bool; 3],
    /// Lower corner of the box, and its edges: cells are tilted with it.
    corner: [f64; 3],
    period: Periods,
    lo: [f64; 3],
    per_length: [f64; 3],
    /// Number of cell layers in a slab, such that every pair crosses at most one slab boundary.
    layers: usize,
    blocks: Blocks,
    /// First index of each cell in `order`, and the total number of points.
    start: Vec<u32>,
    /// The points in order.
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
    /// The cell of a point; the first or last one for points beyond the box.
    #[inline]
    fn cell(&self, x: &[f64; 3]) -> u32 {
        (((x[self.axis] - self.lo) * self.per_length) as i32).clamp(0, self.most) as u32
    }
}

/// Suitable length of cell edges, and reach of pairs, for spheres with gaps up to `more`.
///
/// For spheres of similar size, cells are as long as the reach of pairs, and neighbours are in neighbouring
/// cells. If sizes differ much, this holds for the [`small`] ones, and
/// [`pairs_of_large`](super::list::pairs_of_large) finds the others.
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

/// The unshifted image.
pub const HERE: u32 = perigrain_base::math::lanes::NO_SHIFT;

/// The shift of an image along x, y and z, in periods.
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

impl Tiles {
    /// Sorts all points into cells of at least `edge`, for pairs of at most this reach; `lo` and `period`
    /// describe the box, which is tilted only along periodic directions; there its height is at least the
    /// reach.
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
        self.blocks = Blocks::new(self.cells, self.repeats, x.len());
        let mut cell = vec![0; x.len()];
        let (lines, blocks) = ([0, 1, 2].map(|k| self.line(k)), &self.blocks);
        par::each((&mut cell[..], &straight[..]), |_, (cell, x)| {
            let of = |x| lines.map(|line| line.cell(x) as usize);
            cell.iter_mut().zip(x).for_each(|(cell, x)| *cell = blocks.cell(of(x)) as u32);
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
        // Loops over points, because there may be more cells than points.
        for place in 1..self.order.len() {
            let [before, here] = [place - 1, place].map(|p| self.order[p] as usize);
            let of = cell[here] as usize;
            if cell[before] == cell[here] && tag[before] > tag[here] {
                let members = self.start[of] as usize..self.start[of + 1] as usize;
                self.order[members].sort_unstable_by_key(|&i| tag[i as usize]);
            }
        }
    }

    /// The cells for all points, as in [`Tiles::sort`], without sorting any points.
    pub fn laid_out(x: &[[f64; 3]], edges: [f64; 2], lo: &[f64; 3], period: &Periods) -> Self {
        let mut tiles = Self::default();
        tiles.lay_out(&straightened(x, lo, period), edges, lo, period);
        tiles
    }

    /// Fast, middle and slow axis.
    pub fn axes(&self) -> [usize; 3] {
        self.axes
    }

    /// Slabs normal to the slow axis.
    pub fn slabs(&self) -> Slabs<'_> {
        Slabs { of: self, layers: self.layers }
    }

    /// The cell layer of a point.
    pub fn layer_of(&self, x: &[f64; 3]) -> usize {
        self.line(2).cell(&self.period.straightened(*x, self.corner)) as usize
    }

    /// The slab of each point in order.
    pub fn slab_of_places(&self) -> Vec<usize> {
        let of_layers = self.slabs().of_layers();
        let mut slabs = vec![0; self.order.len()];
        for tile in 0..self.count() {
            for ([.., layer], cell) in self.blocks.places(tile).zip(self.blocks.cells(tile)) {
                slabs[self.places(cell)].fill(of_layers[layer]);
            }
        }
        slabs
    }

    /// The colour of a tile: two tiles within reach of pairs of a third one never have the same colour.
    pub fn colour(&self, tile: usize) -> u8 {
        self.blocks.colour(tile)
    }

    /// The neighbours of a tile, including periodic ones: those that its pairs reach, or that share pairs
    /// with it.
    pub fn beside(&self, tile: usize) -> Vec<u32> {
        self.blocks.beside(tile)
    }

    /// Number of tiles.
    pub fn count(&self) -> usize {
        self.blocks.count()
    }

    /// The points of a tile, as a range of `order`.
    pub fn members(&self, tile: usize) -> Range<usize> {
        let cells = self.blocks.cells(tile);
        self.start[cells.start] as usize..self.start[cells.end] as usize
    }

    /// Cells along axis `k`; 2 is the slow one.
    fn line(&self, k: usize) -> Line {
        let most = self.cells[k].saturating_sub(1) as i32;
        Line { axis: self.axes[k], lo: self.lo[k], per_length: self.per_length[k], most }
    }

    /// Lays out the cells, for points of the box made upright.
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
        // Spheres larger than the system reach across all of it.
        let layers = (reach / size).ceil().min(FARTHEST) as usize;
        let far = if reach > size { layers.max(1) } else { 1 };
        // The slow axis: the longest of the directions that are not periodic, or the longest of all if these
        // are thin. A box tilted along x with y alone is usually sheared that way: grains of a slab normal to
        // y move alike.
        let slow = |open_only: bool| (0..3).filter(|&d| !open_only || open(d)).max_by_key(|&d| count[d]);
        let thin = |d: &usize| count[*d] < 4 * far;
        let sheared = Some(1).filter(|_| tilt[0] != 0.0 && tilt[1..] == [0.0; 2]);
        let slowest = sheared.or(slow(true)).filter(|d| !thin(d)).or(slow(false)).unwrap_or(2);
        let mut rest = [0, 1, 2].into_iter().filter(|&d| d != slowest);
        self.axes = [rest.next().unwrap_or(0), rest.next().unwrap_or(1), slowest];
        self.cells = self.axes.map(|d| count[d]);
        let most = if x.len() < FEW { 1 } else { SHARES.max(x.len() / CROWD) };
        self.layers = far.max(self.cells[2].div_ceil(most));
        self.repeats = self.axes.map(|d| !open(d));
        self.lo = self.axes.map(|d| origin[d]);
        let per_length =
            |d: usize| if open(d) { 1.0 / (size * spread[d]) } else { count[d] as f64 / length[d] };
        self.per_length = self.axes.map(per_length);
    }

    /// The points of a cell, as a range of `order`.
    fn places(&self, cell: usize) -> Range<usize> {
        self.start[cell] as usize..self.start[cell + 1] as usize
    }
}

/// Cells cut into slabs of several layers normal to the slow axis: pairs of a slab lie in it or reach into
/// the next one, those of the last slab into the first if the slow axis is periodic; there is then an even
/// number of slabs, or one.
#[derive(Clone, Copy, Debug)]
pub struct Slabs<'a> {
    of: &'a Tiles,
    layers: usize,
}

impl Slabs<'_> {
    /// Number of slabs.
    pub fn count(&self) -> usize {
        let slabs = (self.of.cells[2] / self.layers.max(1)).max(1);
        if self.of.repeats[2] && slabs > 1 { slabs & !1 } else { slabs }
    }

    /// The slab that pairs of slab `k` reach into, if any.
    pub fn next(&self, k: usize) -> Option<usize> {
        let next = (k + 1) % self.count();
        (next > k || self.of.repeats[2]).then_some(next)
    }

    /// The slab of each cell layer.
    pub fn of_layers(&self) -> Vec<usize> {
        let (layers, slabs) = (self.of.cells[2], self.count());
        let mut of = Vec::with_capacity(layers);
        (0..slabs).for_each(|k| of.resize((k + 1) * layers / slabs, k));
        of
    }
}

#[cfg(test)]
mod tests;
