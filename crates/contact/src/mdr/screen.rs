//! Grains between grains: contacts that reach through a third grain push less.

use perigrain_base::math::vec3::{Vec3, dot, scale};
use perigrain_base::par;
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

/// A contact as one of its grains sees it.
#[derive(Clone, Copy, Debug, Default)]
struct Spoke {
    /// The other grain.
    to: u32,
    /// Which line it is.
    line: u32,
}

impl Spoke {
    /// Unit vector towards the other grain.
    fn along(&self, lines: &[Line]) -> Vec3 {
        let Line { ends, normal, .. } = &lines[self.line as usize];
        scale(if ends[1] == self.to { -1.0 } else { 1.0 }, *normal)
    }
}

/// The contacts of each grain; keeps its room from step to step.
#[derive(Clone, Debug, Default)]
pub struct Screen {
    /// Where the contacts of a grain begin, and behind the last grain.
    start: Vec<u32>,
    spokes: Vec<Spoke>,
    /// By grain: a bit for each that it touches ([`bit`]); grains that share a bit are told apart by looking.
    touched: Vec<u64>,
}

/// The bit of grain `k`.
fn bit(k: u32) -> u64 {
    1 << (k % 64)
}

impl Screen {
    /// The open part of every contact: 1 less 1/(1 + exp(−50 (θ/π − 1/2))) for every grain that touches both ends, is
    /// nearer to both than they are to each other, and sees them under the angle θ.
    pub fn open(&mut self, lines: &[Line], grains: usize, out: &mut Vec<f64>) {
        self.sort(lines, grains);
        // All of them are written.
        out.resize(lines.len(), 0.0);
        par::each(&mut out[..], |first, out| {
            let own = lines[first..].iter();
            out.iter_mut()
                .zip(own)
                .for_each(|(open, line)| *open = (1.0 - self.closed(line, lines)).max(0.0));
        });
    }

    /// What the grains between the ends of this contact close of it.
    fn closed(&self, line: &Line, lines: &[Line]) -> f64 {
        let [i, j] = line.ends;
        let touched = self.touched[j as usize];
        let shorter = |c: &Spoke| lines[c.line as usize].length < line.length;
        let mut closed = 0.0;
        for from in self.of(i).iter().filter(|c| touched & bit(c.to) != 0 && shorter(c)) {
            let Some(on) = self.of(from.to).iter().find(|c| c.to == j) else { continue };
            if !shorter(on) {
                continue;
            }
            let angle = (-dot(from.along(lines), on.along(lines))).clamp(-1.0, 1.0).acos();
            closed += 1.0 / (1.0 + (-SHARPNESS * (angle / PI - 0.5)).exp());
        }
        closed
    }

    /// The contacts of grain `k`, in the order of the lines.
    fn of(&self, k: u32) -> &[Spoke] {
        let k = k as usize;
        &self.spokes[self.start[k] as usize..self.start[k + 1] as usize]
    }

    /// Puts every line under both of its grains.
    fn sort(&mut self, lines: &[Line], grains: usize) {
        self.start.clear();
        self.start.resize(grains + 2, 0);
        // Two places further than where a grain's contacts begin: filling them moves each entry on to where they end.
        lines.iter().flat_map(|l| l.ends).for_each(|k| self.start[k as usize + 2] += 1);
        let mut sum = 0;
        for count in &mut self.start {
            sum += *count;
            *count = sum;
        }
        self.spokes.resize(sum as usize, Spoke::default());
        self.touched.clear();
        self.touched.resize(grains, 0);
        for (line, number) in lines.iter().zip(0..) {
            let [i, j] = line.ends;
            for (own, to) in [(i, j), (j, i)] {
                let at = &mut self.start[own as usize + 1];
                self.spokes[*at as usize] = Spoke { to, line: number };
                *at += 1;
                self.touched[own as usize] |= bit(to);
            }
        }
    }
}
