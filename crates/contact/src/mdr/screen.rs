//! Grains between grains: a contact that reaches through a third grain has a reduced force.

use perigrain_base::math::elementary::{asin, exp};
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::lanes::Lanes;
use perigrain_base::math::vec3::{Vec3, dot, scale};
use perigrain_base::par;
use std::f64::consts::PI;

/// How sharply a contact is shielded around a right angle at the grain in between.
const SHARPNESS: f64 = 50.0;

/// A contact for this rule.
#[derive(Clone, Copy, Debug, Default)]
pub struct Line {
    /// Indices of both grains.
    pub ends: [u32; 2],
    /// Unit vector from the second to the first.
    pub normal: Vec3,
    /// Distance of the centres.
    pub length: f64,
}

/// A contact as seen from one of its grains.
#[derive(Clone, Copy, Debug, Default)]
struct Spoke {
    /// The other grain.
    to: u32,
    /// Index of the line.
    line: u32,
}

impl Spoke {
    /// Unit vector towards the other grain.
    fn along(&self, lines: &[Line]) -> Vec3 {
        let Line { ends, normal, .. } = &lines[self.line as usize];
        scale(if ends[1] == self.to { -1.0 } else { 1.0 }, *normal)
    }
}

/// Number of grains in between that are collected before their shielding is evaluated.
const MANY: usize = 64;

/// Grains between the ends of contacts.
struct Between {
    /// −cos θ of the angle at which each sees them, then its shielding.
    cosines: [f64; MANY],
    /// Index of the contact.
    lines: [u32; MANY],
    count: usize,
}

impl Between {
    /// Adds one that sees the ends of contact `line`; evaluates the collected ones first if the buffer is
    /// full.
    fn add(&mut self, cosine: f64, line: usize, out: &mut [f64]) {
        if self.count == MANY {
            self.close(out);
        }
        (self.cosines[self.count], self.lines[self.count]) = (cosine, line as u32);
        self.count += 1;
    }

    /// Adds the shielding of each to its contact, in the order in which they were found, and empties the
    /// buffer.
    fn close(&mut self, out: &mut [f64]) {
        // SAFETY: the processor supports this form.
        unsafe { Form::here().run(Close(&mut self.cosines)) };
        let found = self.lines.iter().zip(&self.cosines).take(self.count);
        found.for_each(|(line, closes)| out[*line as usize] += closes);
        self.count = 0;
    }
}

/// 1/(1 + exp(−50 (θ/π − 1/2))) of −cos θ, where θ/π − 1/2 = asin(−cos θ)/π.
struct Close<'a>(&'a mut [f64; MANY]);

impl InLanes for Close<'_> {
    type Out = ();

    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        for some in self.0.chunks_exact_mut(N) {
            let mut cosines = [0.0; N];
            cosines.copy_from_slice(some);
            // SAFETY: the caller's guarantee.
            let x = unsafe { V::of(cosines) };
            let one = x.like(1.0);
            let x = one.least((-one).most(x));
            some.copy_from_slice(&(one / (exp(asin(x) * (-SHARPNESS / PI)) + 1.0)).numbers());
        }
    }
}

/// The contacts of each grain; keeps its buffers from step to step.
#[derive(Clone, Debug, Default)]
pub struct Screen {
    /// Start of the contacts of each grain, and the end of the last.
    start: Vec<u32>,
    spokes: Vec<Spoke>,
    /// Per grain, a bit for each grain that it touches ([`bit`]); grains that share a bit are distinguished
    /// by a search.
    touched: Vec<u64>,
}

/// The bit of grain `k`.
fn bit(k: u32) -> u64 {
    1 << (k % 64)
}

impl Screen {
    /// The open fraction of every contact: 1 minus 1/(1 + exp(−50 (θ/π − 1/2))) for every grain that touches
    /// both ends, is nearer to both than they are to each other, and sees them at the angle θ.
    pub fn open(&mut self, lines: &[Line], grains: usize, out: &mut Vec<f64>) {
        self.sort(lines, grains);
        // Every element is written.
        out.resize(lines.len(), 0.0);
        par::each(&mut out[..], |first, out| {
            let mut between = Between { cosines: [0.0; MANY], lines: [0; MANY], count: 0 };
            out.fill(0.0);
            for (k, line) in lines[first..first + out.len()].iter().enumerate() {
                self.look(line, lines, |cosine| between.add(cosine, k, out));
            }
            between.close(out);
            out.iter_mut().for_each(|open| *open = (1.0 - *open).max(0.0));
        });
    }

    /// Finds the grains between the ends of this contact: −cos θ of the angle at which each sees them.
    fn look(&self, line: &Line, lines: &[Line], mut found: impl FnMut(f64)) {
        let [i, j] = line.ends;
        let touched = self.touched[j as usize];
        let shorter = |c: &Spoke| lines[c.line as usize].length < line.length;
        for from in self.of(i).iter().filter(|c| touched & bit(c.to) != 0 && shorter(c)) {
            let Some(on) = self.of(from.to).iter().find(|c| c.to == j) else { continue };
            if shorter(on) {
                found(dot(from.along(lines), on.along(lines)));
            }
        }
    }

    /// The contacts of grain `k`, in line order.
    fn of(&self, k: u32) -> &[Spoke] {
        let k = k as usize;
        &self.spokes[self.start[k] as usize..self.start[k + 1] as usize]
    }

    /// Sorts the lines by both of their grains.
    fn sort(&mut self, lines: &[Line], grains: usize) {
        self.start.clear();
        self.start.resize(grains + 2, 0);
        // Two places beyond the start of a grain's contacts: filling advances each entry to their end.
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
