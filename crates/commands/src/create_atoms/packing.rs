//! Dense random packings of spheres ("force-biased"): places at random, then spheres that overlap push each other away.

pub mod aggregate;
pub mod nearby;
pub mod pores;
pub mod room;
pub mod sizes;

use nearby::Nearby;
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::{Vec3, add, dot, scale, sub};
use perigrain_base::par;
use perigrain_base::stop;
use room::Room;

/// The part of its overlap that each of two equal spheres goes back by in a round, twice.
const PUSH: f64 = 0.54;
/// How much of its last step a sphere keeps: with this momentum rounds come to rest several times sooner.
const MEMORY: f64 = 0.9;
/// Lists reach so many mean diameters farther than touch.
const SKIN: f64 = 0.3;
/// The mean overlap that is small enough by default.
const MEAN: f64 = 1e-3;
/// Rounds that spheres get once they have shrunk.
const LAST: usize = 100;
/// Neighbours that are looked at together: a row has seldom more.
const MET: usize = 16;

/// Spheres that reach farther through walls, in mean diameters, do not fit into their room.
pub const THROUGH: f64 = 0.05;

/// When a packing is done.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// The largest overlap, as a part of the distance of touching spheres; without it the mean must be below 10⁻³.
    pub overlap: Option<f64>,
    /// Rounds at most.
    pub rounds: usize,
}

/// What has come out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Rounds that were needed.
    pub rounds: usize,
    /// Overlap as a part of the distance of touching spheres: the mean of pairs that overlap.
    pub mean: f64,
    /// The largest.
    pub largest: f64,
    /// How far a sphere reaches through a wall at most [length].
    pub beyond: f64,
    /// Whether the goal is reached.
    pub reached: bool,
    /// The factor that all radii were made smaller by.
    pub shrunk: f64,
}

/// Spheres that lie in their places.
pub struct Packing {
    /// Their middles.
    pub x: Vec<Vec3>,
    /// Their radii.
    pub radius: Vec<f64>,
    /// How well they lie.
    pub came: Outcome,
}

/// Sums of a round.
#[derive(Clone, Copy, Default)]
struct Round {
    /// Overlaps as parts of the distance of touching spheres, those of each pair twice.
    sum: f64,
    count: u64,
    largest: f64,
    /// The square of the longest way since lists were made.
    moved: f64,
    /// Steps times pushes: not above zero where memory leads the wrong way.
    along: f64,
}

impl Round {
    fn join(self, b: Self) -> Self {
        Self {
            sum: self.sum + b.sum,
            count: self.count + b.count,
            largest: self.largest.max(b.largest),
            moved: self.moved.max(b.moved),
            along: self.along + b.along,
        }
    }

    fn mean(&self) -> f64 {
        if self.count > 0 { self.sum / self.count as f64 } else { 0.0 }
    }

    fn meets(&self, goal: &Goal) -> bool {
        match goal.overlap {
            // Shrinking does the rest.
            Some(o) if o > 0.0 => self.largest <= o,
            _ => self.mean() < MEAN,
        }
    }
}

/// Packs spheres of these radii; `None` where places inside the room are too rare to be found.
pub fn pack(room: &Room, radius: Vec<f64>, stream: &mut ParkMiller, goal: &Goal) -> Option<Packing> {
    let mut bed = Bed::scatter(room, radius, stream)?;
    let (mut rounds, mut last) = bed.relax(goal.rounds, |round| round.meets(goal));
    let reached = last.meets(goal);
    let mut shrunk = 1.0;
    // Where spheres do not fit they would shrink to nothing.
    let fits = bed.beyond() <= THROUGH * bed.mean;
    if goal.overlap == Some(0.0) && last.largest > 0.0 && fits {
        bed.shrink(1.0 - last.mean());
        rounds += bed.relax(LAST, |round| round.largest == 0.0).0;
        let rest = bed.room_left();
        bed.shrink(rest);
        shrunk = (1.0 - last.mean()) * rest;
        last = bed.measure();
    }
    let beyond = bed.beyond();
    let came = Outcome { rounds, mean: last.mean(), largest: last.largest, beyond, reached, shrunk };
    bed.x.iter_mut().for_each(|x| room.wrap(x));
    Some(Packing { x: bed.x, radius: bed.radius, came })
}

/// Spheres on their way.
struct Bed<'a> {
    room: &'a Room,
    x: Vec<Vec3>,
    radius: Vec<f64>,
    /// R³, by which pairs share their way.
    weight: Vec<f64>,
    /// The last step of each sphere.
    step: Vec<Vec3>,
    near: Nearby,
    /// Where they were when lists were made.
    listed: Vec<Vec3>,
    /// Spheres that may reach a wall before lists are rebuilt.
    walled: Vec<bool>,
    skin: f64,
    /// The mean diameter.
    mean: f64,
}

impl<'a> Bed<'a> {
    /// Spheres at random places, in the order of space: what is near in memory is near in the room.
    fn scatter(room: &'a Room, radius: Vec<f64>, stream: &mut ParkMiller) -> Option<Self> {
        let n = radius.len();
        let mean = 2.0 * radius.iter().sum::<f64>() / n.max(1) as f64;
        let mut tries = 1_000_000 + 10_000 * n;
        let mut placed: Vec<(Vec3, f64)> = Vec::with_capacity(n);
        while let Some(r) = radius.get(placed.len()) {
            tries = tries.checked_sub(1).filter(|tries| !stop::cuts_at(*tries))?;
            let x = std::array::from_fn(|d| room.lo[d] + stream.uniform() * (room.hi[d] - room.lo[d]));
            if room.contains(x) {
                placed.push((x, *r));
            }
        }
        let cell = |x: Vec3| {
            let [a, b, c] = std::array::from_fn(|d| ((x[d] - room.lo[d]) / (1.5 * mean)) as u32);
            [c, b, a]
        };
        placed.sort_by_cached_key(|(x, _)| cell(*x));
        let (x, radius): (Vec<Vec3>, Vec<f64>) = placed.into_iter().unzip();
        let mut bed = Self {
            room,
            weight: radius.iter().map(|r| r.powi(3)).collect(),
            step: vec![[0.0; 3]; n],
            near: Nearby::find(room, &[], &[], 0.0),
            listed: vec![],
            walled: vec![true; n],
            skin: SKIN * mean,
            mean,
            x,
            radius,
        };
        bed.list();
        Some(bed)
    }

    /// Makes lists anew.
    fn list(&mut self) {
        let Self { room, x, radius, walled, .. } = self;
        let skin = self.skin;
        x.iter_mut().for_each(|x| room.wrap(x));
        self.near = Nearby::find(room, x, radius, skin);
        self.listed.clone_from(x);
        par::each((&x[..], &radius[..], &mut walled[..]), |_, (x, radius, walled)| {
            let mut spare = vec![];
            for ((x, r), walled) in x.iter().zip(radius).zip(walled) {
                *walled = room.close(*x, r + skin, &mut spare);
            }
        });
    }

    /// Rounds until `done`, at most so many; how many, and how spheres overlap after them.
    fn relax(&mut self, rounds: usize, done: impl Fn(&Round) -> bool) -> (usize, Round) {
        let mut memory = 0.0;
        for k in 0..rounds {
            let (next, round) = self.round(memory);
            if done(&round) || stop::cuts() {
                return (k, round);
            }
            self.x = next;
            memory = if round.along >= 0.0 { MEMORY } else { 0.0 };
            if round.moved > 0.25 * self.skin * self.skin {
                self.list();
            }
        }
        (rounds, self.measure())
    }

    /// Where spheres go, and how they overlap before.
    fn round(&mut self, memory: f64) -> (Vec<Vec3>, Round) {
        let mut next = vec![[0.0; 3]; self.x.len()];
        let mut step = std::mem::take(&mut self.step);
        let bed = &*self;
        let some = |first: usize, (next, step): (&mut [Vec3], &mut [Vec3])| {
            let (mut round, mut spare) = (Round::default(), vec![]);
            for (k, (next, step)) in next.iter_mut().zip(step).enumerate() {
                let i = first + k;
                let push = bed.push(i, &mut round);
                round.along += dot(push, *step);
                let mut to = add(bed.x[i], add(scale(memory, *step), push));
                if bed.walled[i] {
                    bed.room.keep(&mut to, bed.radius[i], &mut spare);
                }
                *step = sub(to, bed.x[i]);
                let way = sub(to, bed.listed[i]);
                round.moved = round.moved.max(dot(way, way));
                *next = to;
            }
            round
        };
        let round = par::reduce_each((&mut next[..], &mut step[..]), some, Round::join).unwrap_or_default();
        self.step = step;
        (next, round)
    }

    /// How the others push a sphere.
    #[inline]
    fn push(&self, i: usize, round: &mut Round) -> Vec3 {
        let (x, radius, weight) = (self.x[i], self.radius[i], self.weight[i]);
        let mut push = [0.0; 3];
        // Overlapping ones are selected without a branch, which would be unpredictable.
        let mut met = [(0, [0.0; 3], 0.0); MET];
        for row in self.near.row(i).chunks(MET) {
            let mut count = 0;
            for &j in row {
                let d = self.room.nearest(sub(x, self.x[j as usize]));
                let touch = radius + self.radius[j as usize];
                let square = dot(d, d);
                met[count] = (j, d, square);
                count += usize::from(square < touch * touch);
            }
            for &(j, d, square) in &met[..count] {
                let j = j as usize;
                let (touch, far) = (radius + self.radius[j], square.sqrt());
                let overlap = touch - far;
                let part = overlap / touch;
                round.sum += part;
                round.count += 1;
                round.largest = round.largest.max(part);
                let way = PUSH * self.weight[j] / (weight + self.weight[j]) * overlap;
                // Of two in one place each goes its way.
                let aside = if i < j { -way } else { way };
                push = add(push, if far > 0.0 { scale(way / far, d) } else { [aside, 0.0, 0.0] });
            }
        }
        push
    }

    /// How spheres overlap.
    fn measure(&self) -> Round {
        let some = |range: std::ops::Range<usize>| {
            let mut round = Round::default();
            range.for_each(|i| {
                self.push(i, &mut round);
            });
            round
        };
        par::reduce(self.x.len(), some, Round::join).unwrap_or_default()
    }

    /// How far spheres reach through walls at most.
    fn beyond(&self) -> f64 {
        let mut spare = vec![];
        let each = self.x.iter().zip(&self.radius).map(|(x, r)| self.room.beyond(*x, *r, &mut spare));
        each.fold(0.0, f64::max)
    }

    /// The factor for radii that leaves no overlap; a little below 1 for rounding.
    fn room_left(&self) -> f64 {
        let pairs = 1.0 - self.measure().largest;
        let mut spare = vec![];
        let walls =
            self.x.iter().zip(&self.radius).map(|(x, r)| 1.0 - self.room.beyond(*x, *r, &mut spare) / r);
        walls.fold(pairs, f64::min).max(0.0) * (1.0 - 1e-12)
    }

    fn shrink(&mut self, factor: f64) {
        self.radius.iter_mut().for_each(|r| *r *= factor);
    }
}

#[cfg(test)]
mod tests;
