//! The ends of a sample that is loaded along an axis: their particles, and the components held.

use super::network::Network;
use super::six::Six;
use perigrain_base::math::vec3::Vec3;
use std::collections::BTreeMap;

/// Spheres that make up a body.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Centres [length].
    pub x: &'a [Vec3],
    /// Radii [length].
    pub radius: &'a [f64],
    /// The direction of the load.
    pub axis: usize,
}

impl Sample<'_> {
    /// Range of the spheres in a direction [length].
    pub fn extent(&self, d: usize) -> [f64; 2] {
        let mut out = [f64::INFINITY, f64::NEG_INFINITY];
        for (x, r) in self.x.iter().zip(self.radius) {
            out = [out[0].min(x[d] - r), out[1].max(x[d] + r)];
        }
        out
    }

    /// The two directions perpendicular to the load.
    pub fn across(&self) -> [usize; 2] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    /// Mean radius [length].
    pub fn mean_radius(&self) -> f64 {
        self.radius.iter().sum::<f64>() / self.radius.len().max(1) as f64
    }
}

/// Particles at the low and the high end, and the positions of these ends.
#[derive(Clone, Debug, Default)]
pub struct Ends {
    /// Particle indices.
    pub members: [Vec<u32>; 2],
    /// Mean coordinates of their centres [length].
    pub planes: [f64; 2],
}

impl Ends {
    /// All particles with a surface within `thick` of the sample's end.
    pub fn new(sample: &Sample, thick: f64) -> Self {
        let [lo, hi] = sample.extent(sample.axis);
        let mut out = Self::default();
        for (k, (x, r)) in sample.x.iter().zip(sample.radius).enumerate() {
            let x = x[sample.axis];
            // A particle that touches the border at one point is included, despite rounding.
            for (end, away) in [(x - r) - lo, hi - (x + r)].into_iter().enumerate() {
                if away <= thick * (1.0 - 1e-9) {
                    out.members[end].push(k as u32);
                }
            }
        }
        for end in 0..2 {
            let sum: f64 = out.members[end].iter().map(|k| sample.x[*k as usize][sample.axis]).sum();
            out.planes[end] = sum / out.members[end].len().max(1) as f64;
        }
        out
    }

    /// The distance between the ends [length].
    pub fn free_length(&self) -> f64 {
        self.planes[1] - self.planes[0]
    }

    /// Whether a particle belongs to both ends.
    pub fn overlap(&self) -> bool {
        self.members[0].iter().any(|k| self.members[1].binary_search(k).is_ok())
    }
}

/// How an end is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// All components of all particles.
    Grip,
    /// Displacements along the axis.
    Plate,
    /// By a plane that pushes particles in contact.
    Wall,
}

/// All six components.
pub const WHOLE: u8 = 0b111111;
/// The three rotations.
pub const ROTATIONS: u8 = 0b111000;

/// Held components of every particle, and excluded particles.
#[derive(Clone, Debug, Default)]
pub struct Held {
    /// Held components, one bit each.
    pub mask: Vec<u8>,
    /// Particles of pieces that are not held: they do not move.
    pub out: Vec<bool>,
    /// The number of these particles and of their pieces.
    pub left_out: [usize; 2],
    /// Whether a piece connects the ends.
    pub through: bool,
}

impl Held {
    /// For the ends of a sample with these connected `pieces` (the smallest index in the piece of each
    /// particle).
    ///
    /// Pieces held by plates alone can still move perpendicularly to the axis and rotate about it. No load
    /// excites these motions, and conjugate gradients leave them unchanged; holding single particles against
    /// them would double the number of steps. Only without `rotations`, where bonds also resist a rotation of
    /// the whole, one particle is held perpendicularly to the axis, and another one against rotation.
    pub fn new(sample: &Sample, ends: &Ends, holds: [Hold; 2], rotations: bool, pieces: &[u32]) -> Self {
        let n = sample.x.len();
        let mut out = Self { mask: vec![0; n], out: vec![false; n], ..Self::default() };
        // Per piece, the ends it reaches.
        let mut at_ends = vec![0u8; n];
        let mut gripped = vec![false; n];
        for (end, members) in ends.members.iter().enumerate().filter(|(end, _)| holds[*end] != Hold::Wall) {
            for &k in members {
                let piece = pieces[k as usize] as usize;
                at_ends[piece] |= 1 << end;
                gripped[piece] |= holds[end] == Hold::Grip;
                out.mask[k as usize] |= if holds[end] == Hold::Grip { WHOLE } else { 1 << sample.axis };
            }
        }
        if !rotations {
            out.mask.iter_mut().for_each(|m| *m |= ROTATIONS);
            let plate = holds.iter().position(|hold| *hold == Hold::Plate);
            let members = plate.map_or(&[][..], |end| &ends.members[end]);
            out.anchor(sample, members, |k| pieces[k as usize], |piece| gripped[piece as usize]);
        }
        let walls = holds.contains(&Hold::Wall);
        for k in 0..n {
            let piece = pieces[k] as usize;
            out.through |= at_ends[piece] == 0b11;
            if at_ends[piece] == 0 && !walls {
                (out.mask[k], out.out[k]) = (WHOLE, true);
                out.left_out[0] += 1;
                out.left_out[1] += usize::from(piece == k);
            }
        }
        out
    }

    /// Holds the first member of each piece perpendicularly to the axis, and against rotation about it the
    /// member of the same piece that is farthest along one perpendicular direction and nearest along the
    /// other.
    fn anchor(
        &mut self,
        sample: &Sample,
        members: &[u32],
        piece: impl Fn(u32) -> u32,
        gripped: impl Fn(u32) -> bool,
    ) {
        let [a, b] = sample.across();
        let (a, b) = (a.min(b), a.max(b));
        // Per piece: its first member, and the best other member with its score.
        let mut best: BTreeMap<u32, (u32, Option<(f64, u32)>)> = BTreeMap::new();
        for &k in members.iter().filter(|k| !gripped(piece(**k))) {
            let (first, far) = best.entry(piece(k)).or_insert((k, None));
            let away = |d: usize| (sample.x[k as usize][d] - sample.x[*first as usize][d]).abs();
            let along = away(a) - away(b);
            let more = 1e-9 * sample.radius[k as usize];
            if k != *first && along > far.map_or(0.0, |(best, _)| best + more) {
                *far = Some((along, k));
            }
        }
        for (first, far) in best.into_values() {
            self.mask[first as usize] |= 1 << a | 1 << b;
            if let Some((_, k)) = far {
                self.mask[k as usize] |= 1 << b;
            }
        }
    }
}

/// The affine field between the ends: along the axis from 0 at the low plane to `delta` at the high one, with
/// lateral contraction by `nu` times the strain; ends as they are held.
pub fn affine(sample: &Sample, ends: &Ends, holds: [Hold; 2], held: &Held, delta: f64, nu: Vec3) -> Vec<Six> {
    let strain = delta / ends.free_length();
    let centre: Vec3 = std::array::from_fn(|d| {
        let [lo, hi] = sample.extent(d);
        0.5 * (lo + hi)
    });
    let mut u: Vec<Six> = sample
        .x
        .iter()
        .zip(&held.out)
        .map(|(x, out)| {
            let mut row = [0.0; 6];
            if !out {
                (0..3).for_each(|d| row[d] = -nu[d] * strain * (x[d] - centre[d]));
                row[sample.axis] =
                    (strain * (x[sample.axis] - ends.planes[0])).clamp(delta.min(0.0), delta.max(0.0));
            }
            row
        })
        .collect();
    for (end, members) in ends.members.iter().enumerate().filter(|(end, _)| holds[*end] != Hold::Wall) {
        for k in members.iter().map(|k| *k as usize) {
            if holds[end] == Hold::Grip {
                u[k] = [0.0; 6];
            }
            u[k][sample.axis] = if end == 0 { 0.0 } else { delta };
        }
    }
    u
}

/// Poisson's ratio of the sample: the slope of lateral displacement over lateral position in its middle half,
/// by least squares, negated and divided by the strain; for both directions of [`Sample::across`].
pub fn poisson(sample: &Sample, u: &[Six], out: &[bool], strain: f64) -> [f64; 2] {
    let weights = slope(sample, out);
    [0, 1].map(|k| {
        let d = sample.across()[k];
        -weights.iter().zip(u).map(|(w, u)| w[k] * u[d]).sum::<f64>() / strain
    })
}

/// The weights of the particles' lateral displacements in the two slopes of [`poisson`].
pub fn slope(sample: &Sample, out: &[bool]) -> Vec<[f64; 2]> {
    let [lo, hi] = sample.extent(sample.axis);
    let quarter = 0.25 * (hi - lo);
    let middle = |k: usize| {
        let x = sample.x[k][sample.axis];
        !out[k] && x >= lo + quarter && x <= hi - quarter
    };
    let members: Vec<usize> = (0..sample.x.len()).filter(|k| middle(*k)).collect();
    let mut weights = vec![[0.0; 2]; sample.x.len()];
    for (side, d) in sample.across().into_iter().enumerate() {
        let mean = members.iter().map(|k| sample.x[*k][d]).sum::<f64>() / members.len().max(1) as f64;
        let spread: f64 = members.iter().map(|k| (sample.x[*k][d] - mean).powi(2)).sum();
        // Without width there is no slope.
        if spread > 1e-12 * sample.mean_radius().powi(2) {
            members.iter().for_each(|k| weights[*k][side] = (sample.x[*k][d] - mean) / spread);
        }
    }
    weights
}

/// The sum of forces along the axis on particles of one end [force].
pub fn reaction(network: &Network, u: &[Six], members: &[u32], axis: usize) -> f64 {
    let mut f = vec![[0.0; 6]; u.len()];
    network.product(u, &mut f);
    members.iter().map(|k| f[*k as usize][axis]).sum()
}
