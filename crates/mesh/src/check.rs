//! Checks that triangles bound a body: closed, orientable, and without self-intersection.

use super::exact::{side2, side3};
use super::read::Surface;
use super::solid::inside;
use super::tree::Tree;
use super::{Triangle, area, bounds, seen_along, weld, widest};
use perigrain_base::math::cformat::general;
use perigrain_base::math::vec3::{Vec3, add, cross, dot, scale, sub};
use perigrain_base::par;

/// A triangle whose area over the square of its longest side is below this counts as degenerate.
const FLAT: f64 = 1e-12;

/// Reasons why triangles do not bound a body. Triangles are numbered from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// There are no triangles.
    Empty,
    /// A degenerate triangle.
    Flat(usize),
    /// Edges with a single triangle: their number, and the first one by triangle and corner where it begins.
    Open(usize, [usize; 2]),
    /// Edges with more than two triangles.
    Crowded(usize, [usize; 2]),
    /// A one-sided surface: where the two sides meet.
    OneSided([usize; 2]),
    /// Pairs of triangles that cross, touch or overlap: their number, and the first one.
    Crossing(usize, [usize; 2]),
}

impl Fault {
    /// The message, with positions and numbers as in the file.
    pub fn text(&self, surface: &Surface) -> String {
        let triangles = &surface.triangles;
        let point = |p: &Vec3| format!("({})", p.map(|x| general(x, 6)).join(" "));
        let corner = |k: usize, c: usize| triangles.get(k).map_or(String::new(), |t| point(&t[c % 3]));
        let edge = |[k, c]: [usize; 2]| {
            format!("from {} to {} at triangle {}", corner(k, c), corner(k, c + 1), surface.number(k))
        };
        match *self {
            Fault::Empty => "it holds no triangles".into(),
            Fault::Flat(k) => format!("triangle {} has no area", surface.number(k)),
            Fault::Open(1, at) => {
                format!("it is not closed: one edge borders one triangle only, {}", edge(at))
            }
            Fault::Open(n, at) => {
                format!("it is not closed: {n} edges border one triangle only, the first {}", edge(at))
            }
            Fault::Crowded(1, at) => format!("one edge borders more than two triangles, {}", edge(at)),
            Fault::Crowded(n, at) => {
                format!("{n} edges border more than two triangles, the first {}", edge(at))
            }
            Fault::OneSided(at) => format!("its surface has one side only: both meet {}", edge(at)),
            Fault::Crossing(n, [a, b]) => {
                let (pairs, first) = if n == 1 { ("one pair", "") } else { ("pairs", "the first ") };
                let count = if n == 1 { String::new() } else { format!("{n} ") };
                let near = corner(a, 0);
                format!(
                    "{count}{pairs} of its triangles cross or touch where they share no edge, {first}{} and {} near {near}",
                    surface.number(a),
                    surface.number(b)
                )
            }
        }
    }

    /// The remedy.
    pub fn help(&self) -> &'static str {
        match self {
            Fault::Empty => "faces are needed, not points and lines alone",
            Fault::Flat(_) => {
                "let the program that made the mesh repair it: merge corners and drop degenerate facets"
            }
            Fault::Open(..) => {
                "let the program that made the mesh close its holes and merge corners at the same place"
            }
            Fault::Crowded(..) => "leave out faces within the body, and those that stand there twice",
            Fault::OneSided(_) => "a body has an inside: let the program that made the mesh repair it",
            Fault::Crossing(..) => {
                "let the program that made the mesh unite its parts, or make a region of each and a `union` of them"
            }
        }
    }
}

/// Checks that no triangle is degenerate.
pub fn areas(triangles: &[Triangle]) -> Result<(), Fault> {
    if triangles.is_empty() {
        return Err(Fault::Empty);
    }
    match flat(triangles) {
        Some(k) => Err(Fault::Flat(k)),
        None => Ok(()),
    }
}

/// The first degenerate triangle, including those with corners that are not finite.
pub fn flat(triangles: &[Triangle]) -> Option<usize> {
    let longest = |t: &Triangle| {
        let square = |k: usize| {
            let side = sub(t[k], t[(k + 1) % 3]);
            dot(side, side)
        };
        square(0).max(square(1)).max(square(2))
    };
    triangles.iter().position(|t| area(t).is_nan() || area(t) <= FLAT * longest(t))
}

/// Every side of every triangle: its two corners, the smaller number first, and three times the triangle's
/// number plus the corner where it begins; sides of one edge are consecutive.
pub fn edges(corners: &[[u32; 3]]) -> Vec<([u32; 2], usize)> {
    let side = |(k, c): (usize, &[u32; 3])| {
        [0, 1, 2].map(|e| {
            let (a, b) = (c[e], c[(e + 1) % 3]);
            ([a.min(b), a.max(b)], 3 * k + e)
        })
    };
    let mut all: Vec<_> = corners.iter().enumerate().flat_map(side).collect();
    all.sort_unstable();
    all
}

/// The neighbour across each side, and whether it runs along the common edge in the same direction (which is
/// an inconsistent orientation).
pub struct Sides(Vec<[(u32, bool); 3]>);

/// Finds the neighbours across all sides of a closed surface.
pub fn closed(triangles: &[Triangle]) -> Result<Sides, Fault> {
    let corners = weld(triangles);
    let edges = edges(&corners);
    let mut sides = vec![[(0, false); 3]; triangles.len()];
    let (mut open, mut crowded) = ((0, usize::MAX), (0, usize::MAX));
    for edge in edges.chunk_by(|a, b| a.0 == b.0) {
        let [(_, a), (_, b)] = edge else {
            let worse = if edge.len() == 1 { &mut open } else { &mut crowded };
            *worse = (worse.0 + 1, worse.1.min(edge[0].1));
            continue;
        };
        let start = |s: usize| corners[s / 3][s % 3];
        let same = start(*a) == start(*b);
        sides[a / 3][a % 3] = ((b / 3) as u32, same);
        sides[b / 3][b % 3] = ((a / 3) as u32, same);
    }
    let place = |s: usize| [s / 3, s % 3];
    match (crowded, open) {
        ((0, _), (0, _)) => Ok(Sides(sides)),
        ((0, _), (n, first)) => Err(Fault::Open(n, place(first))),
        ((n, first), _) => Err(Fault::Crowded(n, place(first))),
    }
}

impl Sides {
    /// Flips triangles so that all are counterclockwise seen from outside; returns the number flipped.
    pub fn orient(&self, triangles: &mut [Triangle], tree: &Tree) -> Result<usize, Fault> {
        const NONE: u32 = u32::MAX;
        let n = triangles.len();
        let (mut part, mut turn) = (vec![NONE; n], vec![false; n]);
        let mut parts = 0;
        for seed in 0..n {
            if part[seed] != NONE {
                continue;
            }
            let mut members = vec![seed];
            part[seed] = parts;
            let mut at = 0;
            while let Some(&k) = members.get(at) {
                at += 1;
                for (e, (other, same)) in self.0[k].iter().enumerate() {
                    let (other, turned) = (*other as usize, turn[k] != *same);
                    if part[other] == NONE {
                        (part[other], turn[other]) = (parts, turned);
                        members.push(other);
                    } else if turn[other] != turned {
                        return Err(Fault::OneSided([k, e]));
                    }
                }
            }
            self.outward(&members, &mut turn, &part, triangles, tree);
            parts += 1;
        }
        for (t, turn) in triangles.iter_mut().zip(&turn) {
            if *turn {
                t.swap(1, 2);
            }
        }
        Ok(turn.iter().filter(|t| **t).count())
    }

    /// Flips a part as a whole, so that it encloses a positive volume or, within another part, is a hole.
    fn outward(
        &self,
        members: &[usize],
        turn: &mut [bool],
        part: &[u32],
        triangles: &[Triangle],
        tree: &Tree,
    ) {
        let (own, first) = (part[members[0]], &triangles[members[0]]);
        let middle = scale(1.0 / 3.0, add(add(first[0], first[1]), first[2]));
        let hole = inside(triangles, tree, middle, |k| part[k as usize] != own);
        let volume: f64 = members
            .iter()
            .map(|&k| {
                let [a, b, c] = triangles[k].map(|p| sub(p, first[0]));
                let wedge = dot(a, cross(b, c));
                if turn[k] { -wedge } else { wedge }
            })
            .sum();
        if (volume < 0.0) != hole {
            members.iter().for_each(|&k| turn[k] = !turn[k]);
        }
    }
}

/// Checks that triangles meet in common corners and edges only.
pub fn crossings(triangles: &[Triangle], tree: &Tree) -> Result<(), Fault> {
    let corners = weld(triangles);
    let chunk = |range: std::ops::Range<usize>| {
        let mut found = (0, [usize::MAX; 2]);
        for k in range {
            let (lo, hi) = bounds(&triangles[k]);
            tree.meet(lo, hi, |other| {
                let o = other as usize;
                if o > k && cross_each_other(&triangles[k], &corners[k], &triangles[o], &corners[o]) {
                    found = (found.0 + 1, found.1.min([k, o]));
                }
                true
            });
        }
        found
    };
    let (count, first) =
        par::reduce(triangles.len(), chunk, |a, b| (a.0 + b.0, a.1.min(b.1))).unwrap_or((0, [usize::MAX; 2]));
    if count == 0 { Ok(()) } else { Err(Fault::Crossing(count, first)) }
}

/// Whether two triangles meet elsewhere than in the corners with equal numbers.
fn cross_each_other(a: &Triangle, ca: &[u32; 3], b: &Triangle, cb: &[u32; 3]) -> bool {
    let (low, high) = (bounds(a), bounds(b));
    if (0..3).any(|d| low.0[d] > high.1[d] || low.1[d] < high.0[d]) {
        return false;
    }
    let lone = |c: &[u32; 3], other: &[u32; 3]| [0, 1, 2].map(|k| !other.contains(&c[k]));
    let (la, lb) = (lone(ca, cb), lone(cb, ca));
    match la.iter().filter(|l| **l).count() {
        3 => {
            let meets = |t: &Triangle, o: &Triangle| (0..3).any(|k| line_meets(&t[k], &t[(k + 1) % 3], o));
            meets(a, b) || meets(b, a)
        }
        // One common corner: tests the opposite sides.
        2 => {
            let meets = |t: &Triangle, l: [bool; 3], o: &Triangle| {
                (0..3).any(|k| l[k] && l[(k + 1) % 3] && line_meets(&t[k], &t[(k + 1) % 3], o))
            };
            meets(a, la, b) || meets(b, lb, a)
        }
        // A common edge: tests whether one is folded onto the other.
        1 => {
            let apex = |t: &Triangle, l: [bool; 3]| l.iter().position(|l| *l).map(|k| (k, t[k]));
            let (Some((k, p)), Some((_, q))) = (apex(a, la), apex(b, lb)) else { return true };
            let (u, v) = (a[(k + 1) % 3], a[(k + 2) % 3]);
            let axis = widest(a);
            let at = |x: &Vec3| seen_along(x, axis);
            side3(&u, &v, &p, &q) == 0 && side2(at(&u), at(&v), at(&p)) == side2(at(&u), at(&v), at(&q))
        }
        _ => true,
    }
}

/// Whether the segment between two points meets a triangle, including ends and edges.
fn line_meets(p: &Vec3, q: &Vec3, t: &Triangle) -> bool {
    let (sp, sq) = (side3(&t[0], &t[1], &t[2], p), side3(&t[0], &t[1], &t[2], q));
    if sp * sq > 0 {
        return false;
    }
    if sp == 0 && sq == 0 {
        let axis = widest(t);
        let (p, q, [a, b, c]) = (seen_along(p, axis), seen_along(q, axis), t.map(|x| seen_along(&x, axis)));
        let sides = [side2(a, b, p), side2(b, c, p), side2(c, a, p)];
        let starts_within = !(sides.contains(&1) && sides.contains(&-1));
        return starts_within || [(a, b), (b, c), (c, a)].into_iter().any(|(a, b)| lines_meet(p, q, a, b));
    }
    let sides = [side3(p, q, &t[0], &t[1]), side3(p, q, &t[1], &t[2]), side3(p, q, &t[2], &t[0])];
    !(sides.contains(&1) && sides.contains(&-1))
}

fn lines_meet(p: [f64; 2], q: [f64; 2], a: [f64; 2], b: [f64; 2]) -> bool {
    let apart = |d: usize| p[d].max(q[d]) < a[d].min(b[d]) || a[d].max(b[d]) < p[d].min(q[d]);
    let splits = |u: [f64; 2], v: [f64; 2], x: [f64; 2], y: [f64; 2]| side2(u, v, x) * side2(u, v, y) <= 0;
    !apart(0) && !apart(1) && splits(p, q, a, b) && splits(a, b, p, q)
}
