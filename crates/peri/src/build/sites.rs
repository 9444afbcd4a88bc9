//! The lattice that carries a body, found from the places of its particles alone.

use crate::families::PeriView;
use perigrain_base::math::cell::{Basis, Span, coordinates, point, reciprocal};
use perigrain_base::math::vec3::{Vec3, dot, length, scale, sub};

/// Particles may be this far from their sites, in distances of nearest neighbours.
const EXACT: f64 = 1e-10;
/// What is no farther off was meant to be a lattice.
pub const ALMOST: f64 = 1e-3;
/// Vectors between neighbours may be this far from the lattice while that is looked for.
const ROUGH: f64 = 0.02;
/// Fits that leave a particle farther from its site are none.
const FARTHEST: f64 = 0.1;
/// Sites are no closer to each other than this: in hexagonal close packing, where a third of them is taken, 0.58.
const CLOSEST: f64 = 0.4;
/// Neighbours up to this far tell the lattice and the directions in which rows may run: beyond those in body-centred cubic,
/// diamond and hexagonal lattices that repeat a layer.
const NEIGHBOURS: f64 = 1.8;
/// Particles whose neighbours are looked at.
const SAMPLES: usize = 12;
/// So many directions are tried.
const DIRECTIONS: usize = 16;
/// Fewer particles are on some lattice by chance.
const FEWEST: usize = 32;

/// A lattice that carries a body; it may have sites of which whole rows are vacant.
#[derive(Debug)]
pub struct Sites {
    /// Distance of nearest neighbours.
    pub nearest: f64,
    /// The lattice's vectors.
    pub basis: Basis,
    /// Coordinates of the body's particles.
    pub at: Vec<[i32; 3]>,
    /// Directions in which rows may run, as coordinates of the next site.
    pub directions: Vec<[i32; 3]>,
}

/// What carries a body.
#[derive(Debug)]
pub enum Carrier {
    /// A lattice.
    Lattice(Sites),
    /// Nearly one: the particle farthest from its site is this far off, in distances of nearest neighbours.
    Almost(f64),
    /// No lattice.
    Nothing,
}

/// The lattice that carries a body whose nearest particles are `nearest` apart.
pub fn carrier(view: &PeriView, members: &[u32], nearest: f64) -> Carrier {
    if nearest.is_nan() || nearest <= 0.0 {
        return Carrier::Nothing;
    }
    if let Some(sites) = cubic(view, members, nearest) {
        return Carrier::Lattice(sites);
    }
    if members.len() < FEWEST {
        return Carrier::Nothing;
    }
    let samples = samples(view, members, nearest);
    let Some((start, rank)) = spanned(&samples, nearest) else { return Carrier::Nothing };
    let Some(fit) = fitted(view, members, (samples.start, start), rank, nearest) else {
        return Carrier::Nothing;
    };
    match fit.off / nearest {
        off if off <= EXACT => {
            let directions = directions(&samples, &fit.basis);
            Carrier::Lattice(Sites { nearest, basis: fit.basis, at: fit.at, directions })
        }
        off if off <= ALMOST => Carrier::Almost(off),
        _ => Carrier::Nothing,
    }
}

/// The sites of a body on a simple cubic lattice along the axes whose spacing is `nearest`.
fn cubic(view: &PeriView, members: &[u32], nearest: f64) -> Option<Sites> {
    let (lo, hi) = corners(view, members);
    // The longest extent gives the spacing with the fewest digits lost.
    let longest = [0, 1, 2].map(|k| hi[k] - lo[k]).into_iter().fold(0.0, f64::max);
    let steps = (longest / nearest).round();
    if !(1.0..1e6).contains(&steps) {
        return None;
    }
    let spacing = longest / steps;
    let mut at = Vec::with_capacity(members.len());
    for &i in members {
        let c = [0, 1, 2].map(|k| (view.x[i as usize][k] - lo[k]) / spacing);
        if c.iter().any(|c| (c - c.round()).abs() > EXACT) {
            return None;
        }
        at.push(c.map(|c| c.round() as i32));
    }
    let directions = vec![[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    let basis = [[spacing, 0.0, 0.0], [0.0, spacing, 0.0], [0.0, 0.0, spacing]];
    Some(Sites { nearest: spacing, basis, at, directions })
}

fn corners(view: &PeriView, members: &[u32]) -> (Vec3, Vec3) {
    let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for &i in members {
        for k in 0..3 {
            lo[k] = lo[k].min(view.x[i as usize][k]);
            hi[k] = hi[k].max(view.x[i as usize][k]);
        }
    }
    (lo, hi)
}

/// Neighbours of some particles.
struct Samples {
    /// Where the first of them is.
    start: Vec3,
    /// Vectors from each of them to its neighbours, the shorter ones first.
    vectors: Vec<Vec3>,
}

/// Vectors among neighbours in the middle of the body.
fn samples(view: &PeriView, members: &[u32], nearest: f64) -> Samples {
    let (lo, hi) = corners(view, members);
    let middle = scale(0.5, [0, 1, 2].map(|k| lo[k] + hi[k]));
    let x = |p: &u32| view.x[*p as usize];
    let apart = |a: Vec3, b: Vec3| {
        let d = sub(a, b);
        dot(d, d)
    };
    let near = |a: Vec3, reach: f64| {
        let mut near: Vec<u32> =
            members.iter().copied().filter(|p| apart(x(p), a) <= reach * reach).collect();
        near.sort_by(|p, q| apart(x(p), a).total_cmp(&apart(x(q), a)).then(p.cmp(q)));
        near
    };
    let first = members.iter().min_by(|p, q| apart(x(p), middle).total_cmp(&apart(x(q), middle)));
    let start = first.map_or(middle, x);
    // A pair of neighbours can be anywhere within reach of both.
    let around = near(start, (1.0 + NEIGHBOURS) * NEIGHBOURS * nearest);
    let mut vectors = vec![];
    for p in around.iter().take(SAMPLES) {
        let reach = (NEIGHBOURS * nearest).powi(2);
        let own = around.iter().map(|q| sub(x(q), x(p)));
        vectors.extend(own.filter(|d| (1e-12 * reach..=reach).contains(&dot(*d, *d))));
    }
    vectors.sort_by(|a, b| dot(*a, *a).total_cmp(&dot(*b, *b)));
    Samples { start, vectors }
}

/// The lattice that the samples span, roughly, and how many of its directions they tell.
fn spanned(samples: &Samples, nearest: f64) -> Option<(Basis, usize)> {
    let mut span = Span::new(ROUGH * nearest, CLOSEST * nearest);
    if !samples.vectors.iter().all(|v| span.add(*v)) {
        return None;
    }
    Some((span.basis()?, span.rank()))
}

/// A lattice fitted to a body.
struct Fit {
    basis: Basis,
    at: Vec<[i32; 3]>,
    /// The distance of the particle that is farthest from its site.
    off: f64,
}

/// Fits a lattice to more and more of the body around a particle, then to all of it, by least squares of distances.
fn fitted(
    view: &PeriView,
    members: &[u32],
    (start, basis): (Vec3, Basis),
    rank: usize,
    nearest: f64,
) -> Option<Fit> {
    let (lo, hi) = corners(view, members);
    let longest = length(sub(hi, lo));
    let (mut basis, mut origin) = (basis, start);
    let mut reach = 4.0 * nearest;
    // Twice with all: the first time corrects what the smaller part did not tell.
    let mut whole = 0;
    while whole < 2 {
        whole += usize::from(reach >= longest);
        let some = members.iter().map(|p| view.x[*p as usize]).filter(|x| {
            let d = sub(*x, start);
            dot(d, d) <= reach * reach
        });
        (basis, origin) = corrected(some, &basis, origin, (rank, FARTHEST * nearest))?;
        reach *= 3.0;
    }
    let across = reciprocal(&basis)?;
    let (mut at, mut off) = (Vec::with_capacity(members.len()), 0.0f64);
    for p in members {
        let (n, rest) = site(view.x[*p as usize], origin, &basis, &across)?;
        off = off.max(length(rest));
        at.push(n);
    }
    Some(Fit { basis, at, off })
}

/// The nearest site of a place, and the way from there.
fn site(x: Vec3, origin: Vec3, basis: &Basis, across: &Basis) -> Option<([i32; 3], Vec3)> {
    let d = sub(x, origin);
    let at = coordinates(across, d).map(f64::round);
    if at.iter().any(|n| n.is_nan() || n.abs() > 1e6) {
        return None;
    }
    let at = at.map(|n| n as i32);
    Some((at, sub(d, point(basis, at))))
}

/// A basis and an origin that are nearer to places in the sense of least squares; `None` if one is farther from its site
/// than `farthest`. Directions from `rank` on stay as they are.
fn corrected(
    places: impl Iterator<Item = Vec3>,
    basis: &Basis,
    origin: Vec3,
    (rank, farthest): (usize, f64),
) -> Option<(Basis, Vec3)> {
    let across = reciprocal(basis)?;
    let (mut squares, mut products) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
    let (mut sum, mut rest_sum, mut count) = ([0.0; 3], [0.0; 3], 0.0);
    for x in places {
        let (at, rest) = site(x, origin, basis, &across)?;
        if dot(rest, rest) > farthest * farthest {
            return None;
        }
        let at = at.map(f64::from);
        count += 1.0;
        for j in 0..3 {
            sum[j] += at[j];
            rest_sum[j] += rest[j];
            for k in 0..3 {
                squares[j][k] += at[j] * at[k];
                products[j][k] += at[j] * rest[k];
            }
        }
    }
    for j in 0..3 {
        for k in 0..3 {
            squares[j][k] -= sum[j] * sum[k] / count;
            products[j][k] -= sum[j] * rest_sum[k] / count;
        }
    }
    for k in rank..3 {
        (0..3).for_each(|j| (squares[j][k], squares[k][j]) = (0.0, 0.0));
        squares[k][k] = 1.0;
        products[k] = [0.0; 3];
    }
    let inverse = reciprocal(&squares)?;
    // What is missing is (squares)⁻¹ products; the reciprocal vectors of a symmetric matrix are the rows of its inverse.
    let mut new = *basis;
    let mut start = [0, 1, 2].map(|k| origin[k] + rest_sum[k] / count);
    for j in 0..3 {
        for k in 0..3 {
            let more: f64 = (0..3).map(|m| inverse[j][m] * products[m][k]).sum();
            new[j][k] += more;
            start[k] -= more * sum[j] / count;
        }
    }
    Some((new, start))
}

/// Coordinates of the shortest vectors to neighbours, one of each pair of opposite ones, without multiples.
fn directions(samples: &Samples, basis: &Basis) -> Vec<[i32; 3]> {
    let Some(across) = reciprocal(basis) else { return vec![] };
    let mut found: Vec<[i32; 3]> = vec![];
    for v in &samples.vectors {
        let n = coordinates(&across, *v).map(|n| n.round() as i32);
        let ahead = n.iter().find(|n| **n != 0).is_some_and(|n| *n > 0);
        let n = if ahead { n } else { n.map(|n| -n) };
        if divisor(n) == 1 && !found.contains(&n) {
            found.push(n);
        }
        if found.len() == DIRECTIONS {
            break;
        }
    }
    found
}

/// The greatest common divisor.
fn divisor(n: [i32; 3]) -> i32 {
    n.into_iter().fold(0, |a, b| {
        let (mut a, mut b) = (a, b.abs());
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a
    })
}
