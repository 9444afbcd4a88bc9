//! Which sphere is seen in every sample, and how near: a depth buffer filled strip by strip.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use super::camera::Projection;
use super::{Frame, Scene, View};
use crate::make;
use perigrain_base::{par, stop};

/// Sample rows per strip and columns per tile.
const TILE: usize = 64;

/// No sphere.
pub(super) const NOTHING: u32 = u32::MAX;

/// A sphere in the picture, all in supersampled pixels.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Disc {
    pub(super) x: f32,
    pub(super) y: f32,
    /// Towards the viewer.
    pub(super) z: f32,
    /// As seen; zero or less is not drawn.
    pub(super) r: f32,
    /// Radius along the depth.
    rz: f32,
}

impl Disc {
    /// The depth of the sphere at a place; nothing but the farthest where it does not cover it.
    #[cfg(test)]
    pub(super) fn depth(&self, x: f32, y: f32) -> f32 {
        let rest = self.r * self.r - (x - self.x).powi(2) - (y - self.y).powi(2);
        if self.r > 0.0 && rest > 0.0 { self.z + self.rz / self.r * rest.sqrt() } else { f32::NEG_INFINITY }
    }
}

/// What is seen in every sample.
pub(super) struct Raster {
    pub(super) discs: Vec<Disc>,
    pub(super) projection: Projection,
    width: usize,
    height: usize,
    strips: Vec<Strip>,
    /// The present work was requested to end, and not all strips are drawn.
    pub(super) cut: bool,
}

struct Strip {
    depth: Vec<f32>,
    seen: Vec<u32>,
}

impl Raster {
    /// Draws all spheres into the depth buffer.
    pub(super) fn new(scene: &Scene<'_>, view: &View, frame: &Frame) -> Self {
        let projection = Projection::new(view, frame.centre, frame.room);
        let discs = project(scene, &projection);
        let (width, height) = (frame.width, frame.height);
        let bins = Bins::new(&discs, width, height);
        let (stop, cut) = (stop::present(), AtomicBool::new(false));
        let ends = || {
            let ends = stop.must_end();
            cut.fetch_or(ends, Ordering::Relaxed);
            ends
        };
        let strips = make(height.div_ceil(TILE), |row| bins.strip(&discs, row, width, height, ends));
        Self { discs, projection, width, height, strips, cut: cut.into_inner() }
    }

    /// Depth of a sample, far behind where nothing is seen.
    pub(super) fn depth(&self, x: usize, y: usize) -> f32 {
        self.strips[y / TILE].depth[y % TILE * self.width + x]
    }

    /// The sphere seen in a sample.
    pub(super) fn seen(&self, x: usize, y: usize) -> u32 {
        self.strips[y / TILE].seen[y % TILE * self.width + x]
    }

    /// Depth of a sample that may lie outside; `None` there.
    pub(super) fn depth_at(&self, x: i32, y: i32) -> Option<f32> {
        let inside = x >= 0 && y >= 0 && (x as usize) < self.width && (y as usize) < self.height;
        inside.then(|| self.depth(x as usize, y as usize))
    }
}

fn project(scene: &Scene<'_>, projection: &Projection) -> Vec<Disc> {
    let n = scene.positions.len().min(scene.radii.len()).min(scene.colours.len());
    let mut discs = vec![Disc::default(); n];
    par::each((&mut discs[..], &scene.positions[..n], &scene.radii[..n]), |_, (discs, x, r)| {
        for ((disc, &x), &radius) in discs.iter_mut().zip(x).zip(r) {
            let Some(([px, py], z, scale)) = projection.point(x) else { continue };
            if !(radius > 0.0 && radius.is_finite()) {
                continue;
            }
            let r = radius as f32 * scale;
            // A sphere smaller than a sample still shows.
            *disc = Disc { x: px, y: py, z, r: r.max(0.71), rz: r };
        }
    });
    discs
}

/// Spheres by tile; those that touch many tiles stand apart.
struct Bins {
    columns: usize,
    start: Vec<u32>,
    members: Vec<u32>,
    large: Vec<u32>,
}

/// A sphere that touches more tiles than this is looked at from every tile.
const MANY_TILES: usize = 64;

impl Bins {
    /// Counts, then fills.
    fn new(discs: &[Disc], width: usize, height: usize) -> Self {
        let (columns, rows) = (width.div_ceil(TILE), height.div_ceil(TILE));
        let mut start = vec![0u32; columns * rows + 1];
        let ranges = |d: &Disc| {
            let down = if d.r > 0.0 { span(d.y, d.r, rows) } else { 0..0 };
            (down, span(d.x, d.r, columns))
        };
        let is_large = |d: &Disc| {
            let (down, across) = ranges(d);
            down.len() * across.len() > MANY_TILES
        };
        let tiles = |d: &Disc| {
            let (down, across) = ranges(d);
            down.flat_map(move |row| across.clone().map(move |column| row * columns + column))
        };
        let large: Vec<u32> = (0..discs.len() as u32).filter(|i| is_large(&discs[*i as usize])).collect();
        for tile in discs.iter().filter(|d| !is_large(d)).flat_map(tiles) {
            start[tile + 1] += 1;
        }
        for k in 1..start.len() {
            start[k] += start[k - 1];
        }
        let mut next = start.clone();
        let mut members = vec![0u32; start[columns * rows] as usize];
        for (i, disc) in discs.iter().enumerate().filter(|(_, d)| !is_large(d)) {
            for tile in tiles(disc) {
                members[next[tile] as usize] = i as u32;
                next[tile] += 1;
            }
        }
        Self { columns, start, members, large }
    }

    /// Draws one row of tiles, or some of them, where the work `ends`.
    fn strip(
        &self,
        discs: &[Disc],
        row: usize,
        width: usize,
        height: usize,
        ends: impl Fn() -> bool,
    ) -> Strip {
        let rows = TILE.min(height - row * TILE);
        let mut strip =
            Strip { depth: vec![f32::NEG_INFINITY; rows * width], seen: vec![NOTHING; rows * width] };
        let mut order: Vec<u64> = vec![];
        for column in (0..self.columns).take_while(|_| !ends()) {
            let tile = row * self.columns + column;
            let members = &self.members[self.start[tile] as usize..self.start[tile + 1] as usize];
            let x = [column * TILE, ((column + 1) * TILE).min(width)];
            let mut page = Page { strip: &mut strip, top: row * TILE, width };
            let block = Block { x, y: [row * TILE, row * TILE + rows] };
            if !self.large.is_empty() {
                page.narrow(discs, block, &self.large, &mut order);
            }
            page.sorted(discs, block, members, &mut order);
        }
        strip
    }
}

/// A rectangle of samples, ends not included.
#[derive(Clone, Copy)]
struct Block {
    x: [usize; 2],
    y: [usize; 2],
}

/// Blocks are not cut into smaller ones than this.
const SMALLEST: usize = 4;
/// Of so few spheres each is drawn.
const FEW: usize = 8;

impl Block {
    /// Its middle and how far its samples lie from there.
    fn middle(&self) -> ([f32; 2], f32) {
        let half = [self.x, self.y].map(|[lo, hi]| 0.5 * (hi - lo) as f32);
        ([self.x[0] as f32 + half[0], self.y[0] as f32 + half[1]], half[0].hypot(half[1]))
    }

    /// Its quarters.
    fn quarters(&self) -> [Self; 4] {
        let [mx, my] = [self.x, self.y].map(|[lo, hi]| (lo + hi).div_ceil(2));
        let ([x0, x1], [y0, y1]) = (self.x, self.y);
        [([x0, mx], [y0, my]), ([mx, x1], [y0, my]), ([x0, mx], [my, y1]), ([mx, x1], [my, y1])]
            .map(|(x, y)| Self { x, y })
    }
}

/// How a sphere looks from the middle of a block.
struct Facing {
    /// Depth there.
    z: f32,
    /// How it changes along x and y.
    slope: [f32; 2],
    /// A bound of how the slope changes within the block.
    bend: f32,
}

impl Facing {
    /// Of a sphere that covers the block wholly, and not with its rim, where it bends too much.
    fn of(d: &Disc, middle: [f32; 2], reach: f32) -> Option<Self> {
        let (dx, dy) = (middle[0] - d.x, middle[1] - d.y);
        let square = dx * dx + dy * dy;
        let far = square.sqrt() + reach;
        let (rest, least) = (d.r * d.r - square, d.r * d.r - far * far);
        if least < 0.05 * d.r * d.r {
            return None;
        }
        let (k, height) = (d.rz / d.r, rest.sqrt());
        let bend = k * d.r * d.r / (least * least.sqrt());
        Some(Self { z: d.z + k * height, slope: [-k * dx / height, -k * dy / height], bend })
    }
}

/// Where a strip is drawn into.
struct Page<'s> {
    strip: &'s mut Strip,
    /// Its first row.
    top: usize,
    width: usize,
}

impl Page<'_> {
    /// Draws large spheres into a block: most of those that lie behind others in all of it are never drawn.
    ///
    /// Two surfaces that cover a block differ at a place of it by what they differ in the middle, plus the difference of their slopes,
    /// plus half of what these can change, times the way from the middle (squared for the last one).
    fn narrow(&mut self, discs: &[Disc], block: Block, among: &[u32], order: &mut Vec<u64>) {
        let (middle, reach) = block.middle();
        let facing = |i: &u32| Facing::of(&discs[*i as usize], middle, reach);
        let front = among.iter().filter_map(facing).max_by(|a, b| a.z.total_cmp(&b.z));
        let shows = |i: &u32| {
            let Some(front) = &front else { return touches(&discs[*i as usize], block) };
            let Some(own) = facing(i) else {
                let d = &discs[*i as usize];
                let least =
                    front.z - reach * front.slope[0].hypot(front.slope[1]) - 0.5 * reach * reach * front.bend;
                return d.z + d.rz >= least && touches(d, block);
            };
            let [sx, sy] = [0, 1].map(|k| own.slope[k] - front.slope[k]);
            let gains = reach * sx.hypot(sy) + 0.5 * reach * reach * (own.bend + front.bend);
            // Rounding's share of depths besides.
            own.z + gains + 1e-5 * (own.z.abs() + front.z.abs()) >= front.z
        };
        let left: Vec<u32> = among.iter().copied().filter(shows).collect();
        let small = block.x[1] - block.x[0] <= SMALLEST || block.y[1] - block.y[0] <= SMALLEST;
        if left.len() <= FEW || small {
            return self.sorted(discs, block, &left, order);
        }
        for quarter in block.quarters() {
            self.narrow(discs, quarter, &left, order);
        }
    }

    /// Draws spheres into a block, nearest front first, so that most of a solid body is never drawn.
    fn sorted(&mut self, discs: &[Disc], block: Block, members: &[u32], order: &mut Vec<u64>) {
        order.clear();
        order.extend(members.iter().map(|&i| {
            let d = &discs[i as usize];
            u64::from(!ascending(d.z + d.rz)) << 32 | u64::from(i)
        }));
        order.sort_unstable();
        self.draw(discs, block, order);
    }

    /// Draws spheres, nearest front first; stops when the block is covered by nearer ones.
    fn draw(&mut self, discs: &[Disc], block: Block, order: &[u64]) {
        let Block { x, y } = block;
        for (k, &key) in order.iter().enumerate() {
            let i = key as u32;
            let d = &discs[i as usize];
            let front = d.z + d.rz;
            if k % 32 == 31 && front <= self.farthest(block) {
                return;
            }
            let cx = d.x - 0.5;
            let from = ((d.y - 0.5 - d.r).ceil().max(0.0) as usize).max(y[0]);
            let to = ((d.y - 0.5 + d.r).floor() + 1.0).max(0.0) as usize;
            let slope = d.rz / d.r;
            for row in from..to.min(y[1]) {
                let dy = row as f32 + 0.5 - d.y;
                let rest = d.r * d.r - dy * dy;
                if rest <= 0.0 {
                    continue;
                }
                let half = rest.sqrt();
                let hi = ((cx + half).floor() + 1.0).clamp(0.0, x[1] as f32) as usize;
                let lo = ((cx - half).ceil().max(x[0] as f32) as usize).min(hi);
                let start = (row - self.top) * self.width;
                let across = start + lo..start + hi;
                let samples = self.strip.depth[across.clone()].iter_mut().zip(&mut self.strip.seen[across]);
                // Without branches, so that several samples are drawn at once.
                for ((depth, seen), column) in samples.zip(lo as u32..) {
                    let dx = column as f32 - cx;
                    let z = d.z + slope * (rest - dx * dx).max(0.0).sqrt();
                    let nearer = z > *depth;
                    *depth = if nearer { z } else { *depth };
                    *seen = if nearer { i } else { *seen };
                }
            }
        }
    }

    /// The farthest depth seen in a block.
    fn farthest(&self, block: Block) -> f32 {
        let mut far = f32::INFINITY;
        for row in block.y[0]..block.y[1] {
            let start = (row - self.top) * self.width;
            for &z in &self.strip.depth[start + block.x[0]..start + block.x[1]] {
                far = if z < far { z } else { far };
            }
        }
        far
    }
}

/// Whether a sphere covers some of a block.
fn touches(d: &Disc, block: Block) -> bool {
    let away = |c: f32, [lo, hi]: [usize; 2]| (lo as f32 - c).max(c - hi as f32).max(0.0);
    let (dx, dy) = (away(d.x, block.x), away(d.y, block.y));
    d.r > 0.0 && dx * dx + dy * dy <= d.r * d.r
}

/// Tiles that `c ± r` touches.
fn span(c: f32, r: f32, count: usize) -> std::ops::Range<usize> {
    let lo = ((c - r) / TILE as f32).floor().max(0.0);
    let hi = ((c + r) / TILE as f32).floor() + 1.0;
    if hi <= 0.0 || lo >= count as f32 { 0..0 } else { lo as usize..(hi as usize).min(count) }
}

/// Bits of a float that sort as the float does.
fn ascending(x: f32) -> u32 {
    let bits = x.to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

/// Offsets of the shade's samples: `ROTATIONS` spirals of `RAYS` points in the unit disc.
pub(super) fn spirals() -> &'static [[[f32; 2]; RAYS]; ROTATIONS] {
    static SPIRALS: OnceLock<[[[f32; 2]; RAYS]; ROTATIONS]> = OnceLock::new();
    SPIRALS.get_or_init(|| {
        std::array::from_fn(|rotation| {
            std::array::from_fn(|ray| {
                let radius =
                    (ray as f32 + 0.5 + rotation as f32 / ROTATIONS as f32 * 0.5) / (RAYS as f32 + 0.5);
                // Three turns per spiral keep the points apart.
                let turn = 3.0 * ray as f32 / RAYS as f32 + rotation as f32 / ROTATIONS as f32;
                let (sin, cos) = (turn * std::f32::consts::TAU).sin_cos();
                [radius * cos, radius * sin]
            })
        })
    })
}

/// Places per spiral.
pub(super) const RAYS: usize = 11;

/// Different spirals.
pub(super) const ROTATIONS: usize = 16;
