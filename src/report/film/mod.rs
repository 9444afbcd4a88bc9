//! Snapshots of particles for the page: few of them, small, evenly spread over the run.

pub mod dump;
mod grid;
mod packed;
mod taken;

pub use grid::Grid;
pub use packed::{Packed, packed, packed_one};
pub use taken::taken;

use perigrain_world::Domain;
use std::sync::Arc;
use std::time::Duration;

/// About so many snapshots a page shows.
pub const WANTED: usize = 60;
/// And so many at most, before every other one is left out.
const MOST: usize = 64;
/// Bytes that snapshots may take in memory together.
const MEMORY: usize = 192 << 20;

/// So much time snapshots may take whatever the run takes, and this part of it besides.
const FREE: Duration = Duration::from_millis(100);
const SHARE: f64 = 0.015;

/// The state of particles at one moment, in few bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The step.
    pub step: i64,
    /// The time, if it is known.
    pub time: Option<f64>,
    /// The box.
    pub cell: Cell,
    /// What units of length, time and velocity are called; empty where that is not known.
    pub units: [&'static str; 3],
    /// Triangles of walls.
    pub walls: Arc<[Triangle]>,
    /// Lower and upper corner of what the particles take.
    pub span: [[f64; 3]; 2],
    /// What positions are counted in.
    pub grid: Grid,
    /// Positions by direction.
    pub x: [Vec<u16>; 3],
    /// What else is known.
    pub columns: Vec<Column>,
}

/// Three corners.
pub type Triangle = [[f64; 3]; 3];

/// A box, upright or leaning.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cell {
    /// Its lower corner.
    pub origin: [f64; 3],
    /// Its three edges from there.
    pub edges: [[f64; 3]; 3],
}

impl Cell {
    /// That of a scene.
    pub fn of(d: &Domain) -> Self {
        let corners = d.corners();
        let edge = |k: usize| [0, 1, 2].map(|d| corners[k][d] - corners[0][d]);
        Self { origin: corners[0], edges: [edge(1), edge(2), edge(4)] }
    }

    /// An upright box.
    pub fn upright([lo, hi]: [[f64; 3]; 2]) -> Self {
        let edge = |d: usize| {
            let mut edge = [0.0; 3];
            edge[d] = hi[d] - lo[d];
            edge
        };
        Self { origin: lo, edges: [edge(0), edge(1), edge(2)] }
    }
}

/// A number of each particle.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// What the smallest and the largest count stand for.
    pub ends: [f64; 2],
    /// The least and the greatest value.
    pub span: [f64; 2],
    /// The counts.
    pub values: Values,
}

/// Counts of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// All have the value of the lower end.
    Same,
    /// Of 256.
    Bytes(Vec<u8>),
    /// Of 65 536.
    Words(Vec<u16>),
}

impl Column {
    /// A column of whole or broken numbers: whole ones keep their value as far as the counts reach.
    pub fn of(name: &str, values: &[f64]) -> Self {
        let known = values.iter().copied().filter(|v| v.is_finite());
        let (lo, hi) = known.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        let name = name.to_string();
        if lo >= hi || !lo.is_finite() {
            let value = if lo.is_finite() { lo } else { 0.0 };
            return Self { name, ends: [value; 2], span: [value; 2], values: Values::Same };
        }
        let whole = values.iter().all(|v| v.fract() == 0.0);
        let (bits, ends) = match hi - lo {
            wide if whole && wide <= 255.0 => (8, [lo, lo + 255.0]),
            wide if whole && wide <= 65_535.0 => (16, [lo, lo + 65_535.0]),
            _ => (16, [lo, hi]),
        };
        Self { name, ends, span: [lo, hi], values: counted(values, ends, bits) }
    }

    /// A share from 0 to 1.
    pub fn of_shares(name: &str, values: &[f64]) -> Self {
        let span = Self::of(name, values).span;
        match span[0] == span[1] {
            true => Self { name: name.into(), ends: span, span, values: Values::Same },
            false => {
                Self { name: name.into(), ends: [0.0, 1.0], span, values: counted(values, [0.0, 1.0], 8) }
            }
        }
    }

    fn bytes(&self) -> usize {
        match &self.values {
            Values::Same => 0,
            Values::Bytes(list) => list.len(),
            Values::Words(list) => 2 * list.len(),
        }
    }
}

/// Values as counts between two ends; what is no number counts as the lower one.
fn counted(values: &[f64], [lo, hi]: [f64; 2], bits: u32) -> Values {
    let most = f64::from((1u32 << bits) - 1);
    // A conversion of floats saturates, and makes 0 of what is no number.
    let count = |v: &f64| (((v - lo) / (hi - lo)).clamp(0.0, 1.0) * most + 0.5) as u16;
    match bits {
        8 => Values::Bytes(values.iter().map(|v| count(v) as u8).collect()),
        _ => Values::Words(values.iter().map(count).collect()),
    }
}

impl Frame {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.x[0].len()
    }

    /// Whether it shows nothing.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn bytes(&self) -> usize {
        // Walls at rest are one for all.
        let walls = if Arc::strong_count(&self.walls) > 1 { 0 } else { 72 * self.walls.len() };
        6 * self.len() + self.columns.iter().map(Column::bytes).sum::<usize>() + walls
    }
}

/// Snapshots of a run, taken at even intervals that grow with it.
#[derive(Clone, Debug)]
pub struct Film {
    frames: Vec<(u64, Frame)>,
    every: u64,
    bytes: usize,
    /// Time that it has taken.
    spent: Duration,
    /// Moments at which one was taken.
    pub seen: usize,
}

impl Default for Film {
    fn default() -> Self {
        Self { frames: vec![], every: 1, bytes: 0, spent: Duration::ZERO, seen: 0 }
    }
}

impl Film {
    /// Time that snapshots have taken.
    pub fn took(&self) -> Duration {
        self.spent
    }

    /// The interval at present.
    pub fn every(&self) -> u64 {
        self.every
    }

    /// So many steps are going to be made: the interval of the first run that makes some goes by them.
    pub fn expect(&mut self, steps: i64) {
        if self.frames.len() <= 1 {
            self.every = self.every.max((steps.max(0) as u64).div_ceil(WANTED as u64));
        }
    }

    /// The last snapshot, to whose grid the next one keeps if it can.
    pub fn last(&self) -> Option<&Frame> {
        self.frames.last().map(|(_, frame)| frame)
    }

    /// Takes the snapshot after so many steps of all runs. Where they become too many, every other one goes.
    pub fn take(&mut self, at: u64, frame: Frame) {
        self.seen += 1;
        self.bytes += frame.bytes();
        self.frames.push((at, frame));
        while self.frames.len() > MOST || (self.bytes > MEMORY && self.frames.len() > 2) {
            self.thin();
        }
    }

    /// Snapshots have taken so much more time, in a run that has lasted for so long: the interval doubles where that is too much.
    pub fn spend(&mut self, more: Duration, elapsed: Duration) {
        self.spent += more;
        if self.spent > FREE + elapsed.mul_f64(SHARE) && self.frames.len() > 1 {
            self.thin();
        }
    }

    /// Every other one goes, and the interval doubles.
    fn thin(&mut self) {
        self.every *= 2;
        let every = self.every;
        self.frames.retain(|(at, _)| at % every == 0);
        self.bytes = self.frames.iter().map(|(_, frame)| frame.bytes()).sum();
    }

    /// All snapshots, with how it ended as the last one.
    pub fn finish(mut self, last: Frame) -> Vec<Frame> {
        if self.frames.last().is_some_and(|(_, f)| f.step == last.step && f.len() == last.len()) {
            self.frames.pop();
        }
        self.frames.push((0, last));
        self.into_frames()
    }

    /// All snapshots.
    pub fn into_frames(self) -> Vec<Frame> {
        self.frames.into_iter().map(|(_, frame)| frame).collect()
    }
}

#[cfg(test)]
mod tests;
