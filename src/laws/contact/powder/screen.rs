//! Grains between grains: contacts that reach through a third grain push less.

use crate::math::vec3::{Vec3, dot};
use std::f64::consts::PI;

/// How sharply a contact closes about a right angle at the grain in between.
const SHARPNESS: f64 = 50.0;

/// A contact as this rule sees it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Line {
    /// Indices of both grains.
    pub ends: [u32; 2],
    /// Unit vector from the second to the first.
    pub normal: Vec3,
    /// Distance of the centres.
    pub length: f64,
}

/// The open part of every contact: 1 less 1/(1 + exp(−50 (θ/π − 1/2))) for every grain that touches both ends, is
/// nearer to both than they are to each other, and sees them under the angle θ.
pub fn open(lines: &[Line], grains: usize, out: &mut Vec<f64>) {
    // Contacts of each grain: the other one, the direction to it, how far.
    let mut of: Vec<Vec<(u32, Vec3, f64)>> = vec![vec![]; grains];
    for line in lines {
        let [i, j] = line.ends;
        of[i as usize].push((j, line.normal.map(|a| -a), line.length));
        of[j as usize].push((i, line.normal, line.length));
    }
    out.clear();
    out.extend(lines.iter().map(|line| {
        let [i, j] = line.ends;
        let mut closed = 0.0;
        for (k, from, _) in of[i as usize].iter().filter(|c| c.2 < line.length) {
            let Some((_, to, far)) = of[*k as usize].iter().find(|c| c.0 == j) else { continue };
            if *far >= line.length {
                continue;
            }
            let angle = (-dot(*from, *to)).clamp(-1.0, 1.0).acos();
            closed += 1.0 / (1.0 + (-SHARPNESS * (angle / PI - 0.5)).exp());
        }
        (1.0 - closed).max(0.0)
    }));
}
