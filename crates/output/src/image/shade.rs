//! Light, shade in gaps, haze and averaging of samples.

use super::gaps::Gaps;
use super::raster::{Disc, NOTHING, Raster};
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
    let gaps = Gaps::new(raster, look, frame);
    let rows = make(look.height, |y| {
        let ground = ground(look, y);
        let Some(open) = gaps.row(raster, y) else { return vec![ground.bytes(); look.width] };
        let pixel = |x: usize| {
            let mut sum = [0.0f32; 3];
            for sample in 0..n * n {
                let (sx, sy) = (x * n + sample % n, y * n + sample / n);
                let colour = match raster.seen(sx, sy) {
                    NOTHING => ground,
                    i => lit(scene.colours[i as usize], raster, [i as usize, sx, sy], look, open[x], ground),
                };
                (0..3).for_each(|k| sum[k] += colour.0[k]);
            }
            Colour(sum.map(|c| c / (n * n) as f32)).bytes()
        };
        (0..look.width).map(pixel).collect::<Vec<_>>()
    });
    Image { width: look.width, height: look.height, pixels: rows.concat() }
}

/// The background of a row.
fn ground(look: &Look, y: usize) -> Colour {
    look.background[0].mix(look.background[1], y as f32 / look.height as f32)
}

/// The outward normal of a disc's sphere at a sample: x to the right, y up, z towards the viewer.
pub(super) fn normal(disc: &Disc, x: usize, y: usize) -> [f32; 3] {
    let (nx, ny) = ((x as f32 + 0.5 - disc.x) / disc.r, (disc.y - y as f32 - 0.5) / disc.r);
    [nx, ny, (1.0 - nx * nx - ny * ny).max(0.0).sqrt()]
}

/// The colour of sphere `i` at a sample (x, y) from where so much of the sky is seen.
fn lit(
    base: Colour,
    raster: &Raster,
    [i, x, y]: [usize; 3],
    look: &Look,
    sky: f32,
    ground: Colour,
) -> Colour {
    let n = normal(&raster.discs[i], x, y);
    let dot = |l: [f32; 3]| n[0] * l[0] + n[1] * l[1] + n[2] * l[2];
    let open = 1.0 - look.occlusion * (1.0 - sky);
    // More light from above than from below; the sum of all lights is about one where a surface faces us.
    let ambient = (0.40 + 0.12 * n[1]) * open;
    let direct = (0.62 * dot(KEY).max(0.0) + 0.20 * dot(FILL).max(0.0)) * (0.45 + 0.55 * open);
    let shine = look.shiny * 0.5 * dot(HALF).max(0.0).powi(32) * open;
    let lit = Colour(base.0.map(|c| c * (ambient + direct) + shine));
    let far = 0.5 - raster.depth(x, y) / raster.projection.depth().max(1.0);
    lit.mix(ground, look.haze * far.clamp(0.0, 1.0))
}
