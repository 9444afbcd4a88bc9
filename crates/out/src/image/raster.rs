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

/// What is seen in every sample.
pub(super) struct Raster {
    pub(super) discs: Vec<Disc>,
    pub(super) projection: Projection,
    width: usize,
    height: usize,
    strips: Vec<Strip>,
    /// Something wants the present work to end, and not all strips are drawn.
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
        let strips = make(height.div_ceil(TILE), |row| {
            if stop.asked() {
                cut.store(true, Ordering::Relaxed);
                return Strip { depth: vec![], seen: vec![] };
            }
            bins.strip(&discs, row, width, height)
        });
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

/// Spheres by tile.
struct Bins {
    columns: usize,
    start: Vec<u32>,
    members: Vec<u32>,
}

impl Bins {
    /// Counts, then fills.
    fn new(discs: &[Disc], width: usize, height: usize) -> Self {
        let (columns, rows) = (width.div_ceil(TILE), height.div_ceil(TILE));
        let mut start = vec![0u32; columns * rows + 1];
        let tiles = |d: &Disc| {
            let across = span(d.x, d.r, columns);
            let down = if d.r > 0.0 { span(d.y, d.r, rows) } else { 0..0 };
            down.flat_map(move |row| across.clone().map(move |column| row * columns + column))
        };
        for tile in discs.iter().flat_map(tiles) {
            start[tile + 1] += 1;
        }
        for k in 1..start.len() {
            start[k] += start[k - 1];
        }
        let mut next = start.clone();
        let mut members = vec![0u32; start[columns * rows] as usize];
        for (i, disc) in discs.iter().enumerate() {
            for tile in tiles(disc) {
                members[next[tile] as usize] = i as u32;
                next[tile] += 1;
            }
        }
        Self { columns, start, members }
    }

    /// Draws one row of tiles.
    fn strip(&self, discs: &[Disc], row: usize, width: usize, height: usize) -> Strip {
        let rows = TILE.min(height - row * TILE);
        let mut strip =
            Strip { depth: vec![f32::NEG_INFINITY; rows * width], seen: vec![NOTHING; rows * width] };
        let mut order: Vec<u64> = vec![];
        for column in 0..self.columns {
            let tile = row * self.columns + column;
            let members = &self.members[self.start[tile] as usize..self.start[tile + 1] as usize];
            order.clear();
            order.extend(members.iter().map(|&i| {
                let d = &discs[i as usize];
                u64::from(!ascending(d.z + d.rz)) << 32 | u64::from(i)
            }));
            // Nearest first, so that most of a solid body is never drawn.
            order.sort_unstable();
            let x = [column * TILE, ((column + 1) * TILE).min(width)];
            draw(&mut strip, discs, &order, x, row * TILE, rows, width);
        }
        strip
    }
}

/// Draws spheres, nearest front first, into one tile; stops when the tile is covered by nearer ones.
fn draw(
    strip: &mut Strip,
    discs: &[Disc],
    order: &[u64],
    x: [usize; 2],
    y0: usize,
    rows: usize,
    width: usize,
) {
    for (k, &key) in order.iter().enumerate() {
        let i = key as u32;
        let d = &discs[i as usize];
        let front = d.z + d.rz;
        if k % 64 == 63 && front <= farthest(strip, x, rows, width) {
            return;
        }
        let cx = d.x - 0.5;
        let from = ((d.y - 0.5 - d.r).ceil() - y0 as f32).max(0.0) as usize;
        let to = ((d.y - 0.5 + d.r).floor() - y0 as f32 + 1.0).max(0.0) as usize;
        for row in from..to.min(rows) {
            let dy = (y0 + row) as f32 + 0.5 - d.y;
            let rest = d.r * d.r - dy * dy;
            if rest <= 0.0 {
                continue;
            }
            let half = rest.sqrt();
            let hi = ((cx + half).floor() + 1.0).clamp(0.0, x[1] as f32) as usize;
            let lo = ((cx - half).ceil().max(x[0] as f32) as usize).min(hi);
            let slope = d.rz / d.r;
            let across = row * width + lo..row * width + hi;
            let samples = strip.depth[across.clone()].iter_mut().zip(&mut strip.seen[across]);
            for ((depth, seen), column) in samples.zip(lo..) {
                if front <= *depth {
                    continue;
                }
                let dx = column as f32 - cx;
                let z = d.z + slope * (rest - dx * dx).max(0.0).sqrt();
                if z > *depth {
                    (*depth, *seen) = (z, i);
                }
            }
        }
    }
}

/// The farthest depth seen in a tile.
fn farthest(strip: &Strip, x: [usize; 2], rows: usize, width: usize) -> f32 {
    let mut far = f32::INFINITY;
    for row in 0..rows {
        for &z in &strip.depth[row * width + x[0]..row * width + x[1]] {
            far = far.min(z);
        }
    }
    far
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

/// Samples per spiral.
pub(super) const RAYS: usize = 11;

/// Different spirals, shared out among the samples of a pixel.
pub(super) const ROTATIONS: usize = 16;
