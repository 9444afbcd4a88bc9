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
/// Neighbours up to this far give the lattice and the directions in which rows may run: beyond those in body-centred cubic,
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

/// The lattice that the samples span, roughly, and how many of its directions they give.
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
    // Twice with all: the first time corrects what the smaller part did not give.
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
        // Ahead in x, or else in y, or else in z.
        let ahead = v.iter().find(|x| x.abs() > 1e-6 * length(*v)).is_some_and(|x| *x > 0.0);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families::Bounds;
    use perigrain_base::math::vec3::cross;

    /// What carries points.
    fn carrier_of(x: &[Vec3]) -> Carrier {
        let bounds = Bounds { lo: [-1e3; 3], hi: [1e3; 3], periodic: [false; 3], tilt: [0.0; 3] };
        let (kind, volume) = (vec![1; x.len()], vec![1.0; x.len()]);
        let view = PeriView { x, x0: x, kind: &kind, volume: &volume, bounds, excluded: None };
        let members: Vec<u32> = (0..x.len() as u32).collect();
        let apart =
            |p: &Vec3| x.iter().map(|q| length(sub(*p, *q))).filter(|d| *d > 0.0).fold(f64::MAX, f64::min);
        carrier(&view, &members, x.iter().map(apart).fold(f64::MAX, f64::min))
    }

    /// A turned ball or disc of the points of a cell that repeats.
    fn ball(sites: &[Vec3], edges: Vec3, shift: Vec3) -> Vec<Vec3> {
        let mut x = vec![];
        for cell in (0..17 * 17 * 17).map(|k| [k % 17 - 8, k / 17 % 17 - 8, k / 289 - 8].map(f64::from)) {
            for site in sites {
                let at = [0, 1, 2].map(|k| (cell[k] + site[k]) * edges[k]);
                if dot(at, at) < 20.0 && (edges[2] > 0.0 || cell[2] == 0.0) {
                    x.push([0.6 * at[0] - 0.8 * at[1], 0.8 * at[0] + 0.6 * at[1], at[2]]);
                }
            }
        }
        x.iter().map(|x| [0, 1, 2].map(|k| x[k] + shift[k])).collect()
    }

    const FACES: [Vec3; 4] = [[0.0; 3], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];

    #[test]
    fn lattices_are_found_wherever_they_are() {
        let h = 3f64.sqrt();
        let packed = [[0.0; 3], [0.5, 0.5, 0.0], [0.5, 5.0 / 6.0, 0.5], [0.0, 1.0 / 3.0, 0.5]];
        let hexagonal = [[0.0; 3], [0.5, 0.5, 0.0]];
        // The volume of a cell of the lattice: all sites of Bravais lattices are taken, a third of those of hcp.
        let cases: [(&[Vec3], Vec3, f64); 5] = [
            (&FACES, [1.0; 3], 0.25),
            (&[[0.0; 3], [0.5; 3]], [1.0; 3], 0.5),
            (&packed, [1.0, h, 1.7], 1.7 * h / 4.0 / 3.0),
            (&hexagonal, [1.0, h, 0.0], h / 2.0),
            (&[[0.0; 3]], [1.0, 1.0, 0.0], 1.0),
        ];
        for (sites, edges, volume) in cases {
            let x = ball(sites, edges, [10.3, -200.0, 0.1]);
            let Carrier::Lattice(found) = carrier_of(&x) else { panic!("{edges:?}") };
            let [a, b, c] = found.basis;
            let cell = dot(a, cross(b, c)).abs();
            let flat = edges[2] == 0.0;
            assert!(
                (cell / if flat { volume * length(c) } else { volume } - 1.0).abs() < 1e-9,
                "{edges:?} {cell}"
            );
            for (p, at) in x.iter().zip(&found.at) {
                let d = sub(sub(*p, x[0]), sub(point(&found.basis, *at), point(&found.basis, found.at[0])));
                // Places of 200 are known to 3e-14.
                assert!(length(d) < 1e-12);
            }
            assert!(
                found.directions.iter().all(|n| divisor(*n) == 1)
                    && found.directions.len() >= 3 - usize::from(flat)
            );
        }
    }

    #[test]
    fn what_is_off_its_sites_is_measured() {
        let moved = |by: f64| {
            let mut x = ball(&FACES, [1.0; 3], [0.0; 3]);
            x[17][1] += by * 0.5f64.sqrt();
            x
        };
        assert!(matches!(carrier_of(&moved(1e-11)), Carrier::Lattice(_)));
        // One of many moves the fit by a hundredth of its way.
        for by in [1e-9, 1e-5, 9e-4] {
            assert!(
                matches!(carrier_of(&moved(by)), Carrier::Almost(off) if (off / by - 1.0).abs() < 0.02),
                "{by}"
            );
        }
        assert!(matches!(carrier_of(&moved(2e-3)), Carrier::Nothing));
        assert!(matches!(carrier_of(&moved(0.4)), Carrier::Nothing));
    }

    #[test]
    fn heaps_and_patchworks_are_on_none() {
        let mut seed = 9u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let heap: Vec<Vec3> = (0..400).map(|_| [0; 3].map(|_| 8.0 * next())).collect();
        assert!(matches!(carrier_of(&heap), Carrier::Nothing));
        let jitter: Vec<Vec3> =
            ball(&FACES, [1.0; 3], [0.0; 3]).iter().map(|x| x.map(|x| x + 0.1 * next())).collect();
        assert!(matches!(carrier_of(&jitter), Carrier::Nothing));
        // Two halves of one lattice, the one pushed along by a third of a spacing.
        let halves: Vec<Vec3> = ball(&FACES, [1.0; 3], [0.0; 3])
            .iter()
            .map(|x| if x[2] > 0.1 { [x[0] + 0.3, x[1], x[2]] } else { *x })
            .collect();
        assert!(matches!(carrier_of(&halves), Carrier::Nothing));
        // A few points are on some lattice by chance.
        assert!(matches!(carrier_of(&heap[..4]), Carrier::Nothing));
    }

    /// A bar along a diagonal of the cells, far longer than thick: coordinates rise together.
    #[test]
    fn long_thin_bodies_are_found() {
        let mut x = vec![];
        for cell in (0..60 * 60 * 60).map(|k| [k % 60, k / 60 % 60, k / 3600].map(f64::from)) {
            let along = (cell[0] + cell[1] + cell[2]) / 3.0;
            let off = cell.map(|c| c - along);
            if dot(off, off) < 3.0 {
                x.extend(FACES.map(|s| [0, 1, 2].map(|k| 0.1 * (cell[k] + s[k]) + 3.0)));
            }
        }
        assert!(matches!(carrier_of(&x), Carrier::Lattice(_)));
    }
}
