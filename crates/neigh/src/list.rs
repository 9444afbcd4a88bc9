//! Neighbour lists: each pair once, within reach plus skin, in an order that depends only on tags.

use super::grid::{Grid, extent};
use perigrain_base::math::periods::Periods;
use perigrain_base::par;

/// The interaction distance of two types of particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reach {
    /// R_i + R_j.
    Touch,
    /// R_i + R_j plus this distance (cohesion) [length].
    Beyond(f64),
    /// A distance [length].
    Fixed(f64),
}

/// The pairs of types (from 1) that are listed, and their reach; symmetric.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wanted {
    types: usize,
    reach: Vec<Option<Reach>>,
}

impl Wanted {
    /// Without any pairs.
    pub fn new(types: usize) -> Self {
        Self { types, reach: vec![None; types * types] }
    }

    /// Sets the reach of these types.
    pub fn set(&mut self, a: u16, b: u16, reach: Reach) {
        let (a, b) = (usize::from(a) - 1, usize::from(b) - 1);
        self.reach[a * self.types + b] = Some(reach);
        self.reach[b * self.types + a] = Some(reach);
    }

    /// The reach of these types, if they are listed.
    pub fn get(&self, a: u16, b: u16) -> Option<Reach> {
        self.reach[(usize::from(a) - 1) * self.types + usize::from(b) - 1]
    }

    fn any(&self, a: u16) -> bool {
        (1..=self.types as u16).any(|b| self.get(a, b).is_some())
    }
}

/// Particle data for a list: columns of equal length, and the box.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Positions, wrapped into the box along periodic directions [length].
    pub x: &'a [[f64; 3]],
    /// Ids.
    pub tag: &'a [u32],
    /// Types, from 1.
    pub kind: &'a [u16],
    /// Radii; may be empty if no pair uses them.
    pub radius: &'a [f64],
    /// Edges of the box; zero along directions that are not periodic.
    pub period: Periods,
}

impl View<'_> {
    fn radius(&self, i: usize) -> f64 {
        self.radius.get(i).copied().unwrap_or(0.0)
    }

    /// x_i − (x_j + `shift` times the edges).
    #[inline]
    pub fn difference(&self, p: &Pair) -> [f64; 3] {
        difference(self.x, &self.period, p)
    }
}

/// x_i − (x_j + `shift` times the edges) for a pair of the list.
#[inline]
pub fn difference(x: &[[f64; 3]], period: &Periods, p: &Pair) -> [f64; 3] {
    let (a, b) = (&x[p.i as usize], &x[p.j as usize]);
    // Most pairs do not cross the boundary.
    if p.shift == [0; 3] {
        return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    }
    let by = period.shift(p.shift.map(f64::from));
    std::array::from_fn(|d| a[d] - (b[d] + by[d]))
}

/// Two particles, the one with the smaller tag first, and the image of the second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pair {
    /// The particle with the smaller tag.
    pub i: u32,
    /// The other.
    pub j: u32,
    /// Number of periods by which j's image is shifted.
    pub shift: [i8; 3],
}

/// Particles of one type and of similar size: within a factor of two.
struct Class {
    kind: u16,
    octave: i32,
    members: Vec<u32>,
    largest: f64,
}

/// Every listed pair within reach plus `skin` for which `keep(i, j)`, once, sorted by the two tags.
///
/// The search runs by pairs of classes of type and size and looks up the smaller class in the larger one: the
/// cost of a few big particles among many small ones is their neighbours and one test per small one.
pub fn pairs(
    v: &View,
    wanted: &Wanted,
    skin: f64,
    keep: &(impl Fn(usize, usize) -> bool + Sync),
) -> Vec<Pair> {
    let key = |p: Pair| ([p.i, p.j].map(|k| v.tag[k as usize]), p);
    let mut out: Vec<_> = found(v, wanted, skin, 0.0, keep).into_iter().map(key).collect();
    // No two keys are equal, so that the order depends only on tags and images, not on the search.
    out.sort_unstable_by_key(|(tags, p)| (*tags, p.shift));
    out.into_iter().map(|(_, p)| p).collect()
}

/// Inserts those of the given pairs that are within reach plus skin into a list of [`pairs`], in order.
pub fn insert(v: &View, wanted: &Wanted, skin: f64, ends: &[[usize; 2]], list: &mut Vec<Pair>) {
    let key = |p: &Pair| (v.tag[p.i as usize], v.tag[p.j as usize], p.shift);
    for &[i, j] in ends {
        let Some(reach) = wanted.get(v.kind[i], v.kind[j]) else { continue };
        let cut = cutoff(reach, skin, v.radius(i), v.radius(j));
        for_images(images(cut, &v.period), |shift| {
            let by = v.period.shift(shift.map(f64::from));
            let d: [f64; 3] = std::array::from_fn(|k| v.x[i][k] - by[k] - v.x[j][k]);
            if d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < cut * cut {
                let pair = oriented(v.tag, i, j, shift);
                if let Err(at) = list.binary_search_by_key(&key(&pair), key) {
                    list.insert(at, pair);
                }
            }
        });
    }
}

/// Number of images of the box within `far`, along each axis.
fn images(far: f64, period: &Periods) -> [i32; 3] {
    // Along a tilted edge that is not periodic, particles may be further away in images along the others.
    let further = f64::from(u8::from(period.tilted() && period.length.contains(&0.0)));
    period.heights().map(|height| match height {
        l if l > 0.0 => ((far / l).ceil() + further).min(127.0) as i32,
        _ => 0,
    })
}

/// Size estimates of a search, before it runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Forecast {
    /// Approximate number of pairs for a uniform distribution.
    pub pairs: f64,
    /// The largest reach, including sizes and skin [length].
    pub reach: f64,
    /// Number of images of the box within reach along each axis, to one side.
    pub images: [f64; 3],
}

impl Forecast {
    /// The largest number of images to one side.
    pub const MOST_IMAGES: f64 = 127.0;

    /// Total number of images within reach.
    pub fn all_images(&self) -> f64 {
        self.images.map(|n| 2.0 * n + 1.0).into_iter().product()
    }
}

/// Estimates the number of pairs that [`pairs`] would find.
pub fn forecast(v: &View, wanted: &Wanted, skin: f64) -> Forecast {
    let classes = classes(v, wanted);
    let mean =
        |c: &Class| c.members.iter().map(|&m| v.radius(m as usize)).sum::<f64>() / c.members.len() as f64;
    let mut out = Forecast::default();
    for (k, a) in classes.iter().enumerate() {
        for b in &classes[k..] {
            let Some(reach) = wanted.get(a.kind, b.kind) else { continue };
            let far = cutoff(reach, skin, a.largest, b.largest);
            if far > out.reach {
                out.reach = far;
                out.images = v.period.heights().map(|l| if l > 0.0 { (far / l).ceil() } else { 0.0 });
            }
            let (lo, hi) = extent(v.x, a.members.iter().chain(&b.members).copied());
            let likely = cutoff(reach, skin, mean(a), mean(b));
            // The fraction of all pairs within reach, in a box with periodic images.
            let along = |d: usize| match v.period.length[d] {
                l if l > 0.0 => 2.0 * likely / l,
                _ if hi[d] - lo[d] > 2.0 * likely => 2.0 * likely / (hi[d] - lo[d]),
                _ => 1.0,
            };
            let share = SPHERE * along(0) * along(1) * along(2);
            let orders = if std::ptr::eq(a, b) { 0.5 } else { 1.0 };
            out.pairs += orders * a.members.len() as f64 * b.members.len() as f64 * share;
        }
    }
    out
}

/// The volume fraction of a sphere in its bounding cube, π/6.
const SPHERE: f64 = std::f64::consts::FRAC_PI_6;

/// The cutoff for two particles of these radii.
fn cutoff(reach: Reach, skin: f64, ri: f64, rj: f64) -> f64 {
    skin + match reach {
        Reach::Touch => ri + rj,
        Reach::Beyond(gap) => ri + rj + gap,
        Reach::Fixed(c) => c,
    }
}

/// Those of [`pairs`] in which at least one particle is not [`small`], in unspecified order.
pub fn pairs_of_large(
    v: &View,
    wanted: &Wanted,
    skin: f64,
    keep: &(impl Fn(usize, usize) -> bool + Sync),
) -> Vec<Pair> {
    found(v, wanted, skin, small(v.radius), keep)
}

/// The radius below which particles are small: two octaves from the smallest on.
pub fn small(radius: &[f64]) -> f64 {
    let least = par::best(radius, f64::INFINITY, |a, r| if r > 0.0 && r < a { r } else { a });
    // The power of two at or below it: the number without its mantissa.
    let octave = f64::from_bits(least.to_bits() >> 52 << 52);
    4.0 * octave
}

/// Pairs by classes, in which at least one radius is not below `small`.
fn found(
    v: &View,
    wanted: &Wanted,
    skin: f64,
    small: f64,
    keep: &(impl Fn(usize, usize) -> bool + Sync),
) -> Vec<Pair> {
    let classes = classes(v, wanted);
    let mut out = vec![];
    for (k, a) in classes.iter().enumerate() {
        for b in classes[k..].iter().filter(|b| a.largest >= small || b.largest >= small) {
            let Some(reach) = wanted.get(a.kind, b.kind) else { continue };
            let (few, many) = if b.members.len() < a.members.len() { (b, a) } else { (a, b) };
            out.append(&mut Search { v, few, many, reach, skin, keep }.run());
        }
    }
    out
}

fn classes(v: &View, wanted: &Wanted) -> Vec<Class> {
    let in_use: Vec<bool> = (1..=wanted.types as u16).map(|a| wanted.any(a)).collect();
    let mut list: Vec<Class> = vec![];
    let mut last = 0;
    for (i, &kind) in v.kind.iter().enumerate() {
        if !in_use[usize::from(kind) - 1] {
            continue;
        }
        let r = v.radius(i);
        // The exponent of a positive double; 0 for points.
        let octave = if r > 0.0 { (r.to_bits() >> 52) as i32 } else { 0 };
        let fits = |c: &Class| c.kind == kind && c.octave == octave;
        if !list.get(last).is_some_and(fits) {
            last = list.iter().position(fits).unwrap_or_else(|| {
                list.push(Class { kind, octave, members: vec![], largest: 0.0 });
                list.len() - 1
            });
        }
        list[last].members.push(i as u32);
        list[last].largest = list[last].largest.max(r);
    }
    list
}

/// The search of one class in another or in itself.
struct Search<'a, K> {
    v: &'a View<'a>,
    few: &'a Class,
    many: &'a Class,
    reach: Reach,
    skin: f64,
    keep: &'a K,
}

impl<K: Fn(usize, usize) -> bool + Sync> Search<'_, K> {
    fn run(&self) -> Vec<Pair> {
        let far = self.cutoff(self.few.largest, self.many.largest);
        let alone = std::ptr::eq(self.few, self.many);
        let nearby;
        let targets = if alone {
            &self.many.members
        } else {
            nearby = self.nearby(far);
            &nearby
        };
        let mut grid = Grid::default();
        grid.fill(self.v.x, targets, self.cutoff(self.many.largest, self.many.largest));
        let images = images(far, &self.v.period);
        let searchers = &self.few.members;
        let some = |range: std::ops::Range<usize>| {
            let mut found = vec![];
            for &i in &searchers[range] {
                self.around(i as usize, alone, &grid, images, &mut found);
            }
            found
        };
        let join = |mut a: Vec<Pair>, mut b: Vec<Pair>| {
            a.append(&mut b);
            a
        };
        par::reduce(searchers.len(), some, join).unwrap_or_default()
    }

    fn cutoff(&self, ri: f64, rj: f64) -> f64 {
        cutoff(self.reach, self.skin, ri, rj)
    }

    /// Members of the larger class within `far` of the smaller one's bounding box (in directions that are not
    /// periodic).
    fn nearby(&self, far: f64) -> Vec<u32> {
        let (lo, hi) = extent(self.v.x, self.few.members.iter().copied());
        // Images across a tilted edge are displaced along the other axes too.
        let free = |d: usize| self.v.period.length[d] > 0.0 || self.v.period.tilted();
        let near = |m: &&u32| {
            let p = &self.v.x[**m as usize];
            (0..3).all(|d| free(d) || (p[d] >= lo[d] - far && p[d] <= hi[d] + far))
        };
        self.many.members.iter().filter(near).copied().collect()
    }

    /// All partners of particle `i` among the points of `grid` and their images.
    fn around(&self, i: usize, alone: bool, grid: &Grid, images: [i32; 3], found: &mut Vec<Pair>) {
        let (v, x) = (self.v, self.v.x[i]);
        let ri = v.radius(i);
        let far = self.cutoff(ri, self.many.largest);
        for_images(images, |shift| {
            let by = v.period.shift(shift.map(f64::from));
            let at: [f64; 3] = std::array::from_fn(|d| x[d] - by[d]);
            let (lo, hi) = (at.map(|a| a - far), at.map(|a| a + far));
            // Within one class the search finds each pair in both orders: keep one.
            let forward = shift > [0; 3];
            if alone && shift < [0; 3] {
                return;
            }
            grid.near(&lo, &hi, |run| {
                for &j in run {
                    let j = j as usize;
                    if alone && !forward && v.tag[i] >= v.tag[j] {
                        continue;
                    }
                    let d: [f64; 3] = std::array::from_fn(|k| at[k] - v.x[j][k]);
                    let cut = self.cutoff(ri, v.radius(j));
                    if d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < cut * cut && (self.keep)(i, j) {
                        found.push(oriented(v.tag, i, j, shift));
                    }
                }
            });
        });
    }
}

fn for_images(images: [i32; 3], mut f: impl FnMut([i8; 3])) {
    for a in -images[0]..=images[0] {
        for b in -images[1]..=images[1] {
            for c in -images[2]..=images[2] {
                f([a as i8, b as i8, c as i8]);
            }
        }
    }
}

fn oriented(tag: &[u32], i: usize, j: usize, shift: [i8; 3]) -> Pair {
    if tag[i] <= tag[j] {
        return Pair { i: i as u32, j: j as u32, shift };
    }
    Pair { i: j as u32, j: i as u32, shift: shift.map(|s| -s) }
}

#[cfg(test)]
mod tests;
