//! Grains between grains: contacts that reach through a third grain push less.

use perigrain_base::math::elementary::{asin, exp};
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::lanes::Lanes;
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

/// So many grains between others are gathered before what they close is evaluated.
const MANY: usize = 64;

/// Grains between the ends of contacts.
struct Between {
    /// −cos θ of the angle under which each sees them, then what it closes.
    cosines: [f64; MANY],
    /// Whose ends.
    lines: [u32; MANY],
    count: usize,
}

impl Between {
    /// One that sees the ends of contact `line`; room for it is made where all is taken.
    fn add(&mut self, cosine: f64, line: usize, out: &mut [f64]) {
        if self.count == MANY {
            self.close(out);
        }
        (self.cosines[self.count], self.lines[self.count]) = (cosine, line as u32);
        self.count += 1;
    }

    /// Adds what each closes to its contact, in the order in which they were found, and forgets them.
    fn close(&mut self, out: &mut [f64]) {
        // SAFETY: the form is one of this processor.
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
            // SAFETY: passed on.
            let x = unsafe { V::of(cosines) };
            let one = x.like(1.0);
            let x = one.least((-one).most(x));
            some.copy_from_slice(&(one / (exp(asin(x) * (-SHARPNESS / PI)) + 1.0)).numbers());
        }
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
            let mut between = Between { cosines: [0.0; MANY], lines: [0; MANY], count: 0 };
            out.fill(0.0);
            for (k, line) in lines[first..first + out.len()].iter().enumerate() {
                self.look(line, lines, |cosine| between.add(cosine, k, out));
            }
            between.close(out);
            out.iter_mut().for_each(|open| *open = (1.0 - *open).max(0.0));
        });
    }

    /// Grains between the ends of this contact: −cos θ of the angle under which each sees them.
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
