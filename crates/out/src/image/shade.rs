//! Light, shade in gaps, haze and averaging of samples.

use super::raster::{Disc, NOTHING, RAYS, ROTATIONS, Raster, spirals};
use super::{Colour, Frame, Image, Look, Scene};
use crate::make;

/// Direction to the main light: from the upper left, behind the viewer's shoulder. Normalised.
const KEY: [f32; 3] = [-0.4472, 0.6261, 0.6386];

/// Direction to the weak light that opens the shadows. Normalised.
const FILL: [f32; 3] = [0.7, 0.14, 0.7003];

/// Halfway between the main light and the viewer, for the highlight. Normalised.
const HALF: [f32; 3] = [-0.2470, 0.3459, 0.9052];

/// Colours every pixel.
pub(super) fn shade(scene: &Scene<'_>, raster: &Raster, look: &Look, frame: &Frame) -> Image {
    let n = look.samples.max(1);
    let around = reach(raster, frame, n).map(Around::new);
    let rows = make(look.height, |y| {
        let ground = look.background[0].mix(look.background[1], y as f32 / look.height as f32);
        let pixel = |x: usize| {
            let mut sum = [0.0f32; 3];
            for sample in 0..n * n {
                let (sx, sy) = (x * n + sample % n, y * n + sample / n);
                let colour = match raster.seen(sx, sy) {
                    NOTHING => ground,
                    i => {
                        // Every pixel has the same spirals, so that no pattern shows.
                        let lit = Sample::new(raster, i, [sx, sy], sample * ROTATIONS / (n * n));
                        lit.colour(scene.colours[i as usize], raster, look, &around, ground)
                    }
                };
                (0..3).for_each(|k| sum[k] += colour.0[k]);
            }
            Colour(sum.map(|c| c / (n * n) as f32)).bytes()
        };
        (0..look.width).map(pixel).collect::<Vec<_>>()
    });
    Image { width: look.width, height: look.height, pixels: rows.concat() }
}

/// How far the shade looks, near and wide, in samples: a few spheres, and a part of the picture.
fn reach(raster: &Raster, frame: &Frame, n: usize) -> [f32; 2] {
    let drawn = raster.discs.iter().filter(|d| d.r > 0.0);
    let (count, sum) = drawn.fold((0u32, 0.0f64), |(count, sum), d| (count + 1, sum + f64::from(d.r)));
    let radius = if count > 0 { (sum / f64::from(count)) as f32 } else { 1.0 };
    let wide = 0.045 * frame.height as f32;
    [(3.0 * radius).min(0.5 * wide).max(3.0 * n as f32), wide.max(4.0 * radius)]
}

/// Where the shade looks from every sample: offsets in whole samples, which take longer to round than to look at.
struct Around {
    reach: f32,
    spirals: [[Offset; RAYS]; ROTATIONS],
}

/// An offset, as what is added to places and as a length.
#[derive(Clone, Copy)]
struct Offset {
    places: [i32; 2],
    length: [f32; 2],
}

impl Around {
    fn new(reach: f32) -> Self {
        let offset = |at: [f32; 2]| {
            let length = at.map(|o| (o * reach).round());
            Offset { places: length.map(|l| l as i32), length }
        };
        Self { reach, spirals: spirals().map(|rays| rays.map(offset)) }
    }
}

/// One sample on a sphere.
struct Sample {
    x: usize,
    y: usize,
    spiral: usize,
    depth: f32,
    /// Outward, x to the right, y up, z towards the viewer.
    normal: [f32; 3],
}

impl Sample {
    fn new(raster: &Raster, i: u32, [x, y]: [usize; 2], spiral: usize) -> Self {
        let Disc { x: cx, y: cy, r, .. } = raster.discs[i as usize];
        let (nx, ny) = ((x as f32 + 0.5 - cx) / r, (cy - y as f32 - 0.5) / r);
        let nz = (1.0 - nx * nx - ny * ny).max(0.0).sqrt();
        Self { x, y, spiral, depth: raster.depth(x, y), normal: [nx, ny, nz] }
    }

    fn colour(
        &self,
        base: Colour,
        raster: &Raster,
        look: &Look,
        around: &[Around; 2],
        ground: Colour,
    ) -> Colour {
        let n = self.normal;
        let dot = |l: [f32; 3]| n[0] * l[0] + n[1] * l[1] + n[2] * l[2];
        let near = self.openness(raster, &around[0]);
        let wide = self.openness(raster, &around[1]);
        let open = 1.0 - look.occlusion * (1.0 - near * wide);
        // More light from above than from below; the sum of all lights is about one where a surface faces us.
        let ambient = (0.40 + 0.12 * n[1]) * open;
        let direct = (0.62 * dot(KEY).max(0.0) + 0.20 * dot(FILL).max(0.0)) * (0.45 + 0.55 * open);
        let shine = look.shiny * 0.5 * dot(HALF).max(0.0).powi(32) * open;
        let lit = Colour(base.0.map(|c| c * (ambient + direct) + shine));
        let far = 0.5 - self.depth / raster.projection.depth().max(1.0);
        lit.mix(ground, look.haze * far.clamp(0.0, 1.0))
    }

    /// The part of the sky that is not hidden by what lies within `reach`, by points of the depth buffer
    /// (after McGuire et al., "Scalable Ambient Obscurance", HPG 2012).
    fn openness(&self, raster: &Raster, around: &Around) -> f32 {
        let rays = &around.spirals[self.spiral % ROTATIONS];
        let limit = around.reach * around.reach;
        let mut hidden = 0.0;
        for Offset { places, length: [dx, dy] } in rays {
            let Some(depth) = raster.depth_at(self.x as i32 + places[0], self.y as i32 + places[1]) else {
                continue;
            };
            let dz = depth - self.depth;
            let square = dx * dx + dy * dy + dz * dz;
            if square < limit && square > 0.0 {
                let along = dx * self.normal[0] - dy * self.normal[1] + dz * self.normal[2];
                let cosine = along / square.sqrt() - 0.12;
                let fade = 1.0 - square / limit;
                hidden += cosine.max(0.0) * fade;
            }
        }
        (1.0 - 2.6 * hidden / rays.len() as f32).clamp(0.0, 1.0)
    }
}
