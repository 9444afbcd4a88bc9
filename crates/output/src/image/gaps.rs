//! Shade in gaps and cracks: how much of the sky each pixel sees, by places of the depth buffer around it (after McGuire et
//! al., "Scalable Ambient Obscurance", HPG 2012).

use super::raster::{NOTHING, RAYS, ROTATIONS, Raster, spirals};
use super::shade::normal;
use super::{Frame, Look};
use crate::make;

/// Depth where nothing is seen: too far behind to hide anything.
const FAR: f32 = -1e18;
/// Spirals that each pixel looks along, from which rotation on.
const TURNS: [usize; 2] = [0, ROTATIONS / 2];
/// The shade looks no farther than this part of the picture's height.
const FARTHEST: f32 = 0.25;
/// Lower sides of slopes so flat are none.
const BIAS: f32 = 0.12;

/// Depths pixel by pixel, with a rim all around that is farther away than anything, and where the shade looks from each.
///
/// All pixels look along the same ways, so that no pattern shows and a row of them is worked out at once: one depth for each pixel
/// and not for each sample, which the eye does not see and which took four times as long.
pub(super) struct Gaps {
    depth: Vec<f32>,
    /// Pixels of a row with its rims, and of a rim.
    stride: usize,
    rim: usize,
    width: usize,
    samples: usize,
    /// Near and wide.
    around: [Around; 2],
}

/// Where the shade looks within a reach.
struct Around {
    /// The reach [samples].
    reach: f32,
    ways: Vec<Way>,
}

/// A place beside a pixel: in pixels, and how far that is in samples.
struct Way {
    across: isize,
    down: isize,
    length: [f32; 2],
}

impl Around {
    fn new(reach: f32, n: usize) -> Self {
        let way = |at: [f32; 2]| {
            let pixels = at.map(|o| (o * reach / n as f32).round());
            let length = pixels.map(|l| l * n as f32);
            Way { across: pixels[0] as isize, down: pixels[1] as isize, length }
        };
        let all = TURNS.iter().flat_map(|turn| spirals()[*turn]);
        let ways = all.map(way).filter(|w| w.across != 0 || w.down != 0).collect();
        Self { reach, ways }
    }
}

impl Gaps {
    /// Of what a raster shows.
    pub(super) fn new(raster: &Raster, look: &Look, frame: &Frame) -> Self {
        let n = look.samples.max(1);
        let around = reach(raster, frame, n).map(|reach| Around::new(reach, n));
        let rim = (around[0].reach.max(around[1].reach) / n as f32).ceil() as usize + 1;
        let (width, stride) = (look.width, look.width + 2 * rim);
        let rows = make(look.height, |y| {
            let mut row = vec![FAR; stride];
            for (x, depth) in row[rim..rim + width].iter_mut().enumerate() {
                *depth = raster.depth(middle(x, n), middle(y, n)).max(FAR);
            }
            row
        });
        let empty = vec![FAR; stride * rim];
        Self { depth: [&empty[..], &rows.concat(), &empty].concat(), stride, rim, width, samples: n, around }
    }

    /// The part of the sky that each pixel of a row sees; nothing where the row shows no sphere.
    pub(super) fn row(&self, raster: &Raster, y: usize) -> Option<Vec<f32>> {
        let n = self.samples;
        let shows = |x: &usize| {
            (0..n * n).any(|sample| raster.seen(x * n + sample % n, y * n + sample / n) != NOTHING)
        };
        let first = (0..self.width).find(shows)?;
        let last = (first..self.width).rev().find(shows).unwrap_or(first);
        let sy = middle(y, n);
        let own: Vec<[f32; 4]> = (first..=last)
            .map(|x| {
                let sx = middle(x, n);
                match raster.seen(sx, sy) {
                    NOTHING => [0.0, 0.0, 1.0, FAR],
                    i => {
                        let [nx, ny, nz] = normal(&raster.discs[i as usize], sx, sy);
                        [nx, ny, nz, raster.depth(sx, sy)]
                    }
                }
            })
            .collect();
        let columns: [Vec<f32>; 4] = [0, 1, 2, 3].map(|k| own.iter().map(|o| o[k]).collect());
        let mut open = vec![1.0; self.width];
        for around in &self.around {
            let start = (y + self.rim) * self.stride + self.rim + first;
            let hidden = self.hidden(around, &columns, start);
            let share = 2.6 / (RAYS * TURNS.len()) as f32;
            for (open, hidden) in open[first..=last].iter_mut().zip(hidden) {
                *open *= (1.0 - share * hidden).clamp(0.0, 1.0);
            }
        }
        Some(open)
    }

    /// What lies within a reach of pixels hides of their sky, summed over all ways. `start` is the place of the first pixel.
    fn hidden(&self, around: &Around, [nx, ny, nz, depth]: &[Vec<f32>; 4], start: usize) -> Vec<f32> {
        let within = 1.0 / (around.reach * around.reach);
        let mut hidden = vec![0.0f32; depth.len()];
        for Way { across, down, length: [dx, dy] } in &around.ways {
            let from = start.wrapping_add_signed(down * self.stride as isize + across);
            let there = &self.depth[from..from + depth.len()];
            let flat = dx * dx + dy * dy;
            let own = nx.iter().zip(ny).zip(nz).zip(depth);
            for ((hidden, there), (((nx, ny), nz), depth)) in hidden.iter_mut().zip(there).zip(own) {
                let dz = there - depth;
                let square = flat + dz * dz;
                let cosine = (dx * nx - dy * ny + dz * nz) / square.sqrt() - BIAS;
                *hidden += cosine.max(0.0) * (1.0 - square * within).max(0.0);
            }
        }
        hidden
    }
}

/// The sample in a pixel's middle.
fn middle(pixel: usize, n: usize) -> usize {
    pixel * n + n / 2
}

/// How far the shade looks, near and wide, in samples: a few spheres, and a part of the picture.
fn reach(raster: &Raster, frame: &Frame, n: usize) -> [f32; 2] {
    let drawn = raster.discs.iter().filter(|d| d.r > 0.0);
    let (count, sum) = drawn.fold((0u32, 0.0f64), |(count, sum), d| (count + 1, sum + f64::from(d.r)));
    let radius = if count > 0 { (sum / f64::from(count)) as f32 } else { 1.0 };
    let height = frame.height as f32;
    let wide = 0.045 * height;
    [
        (3.0 * radius).min(0.5 * wide).max(3.0 * n as f32),
        wide.max((4.0 * radius).min(FARTHEST * height)).max(1.0),
    ]
}
