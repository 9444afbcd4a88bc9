//! Where `create_atoms` puts particles: lattice sites, one place, random places, triangles of a surface.

use super::mesh::Mesh;
use super::molecules::Copies;
use super::pack::Pack;
use super::subset::Subset;
use perigrain_base::diag::Result;
use perigrain_base::math::body::Quat;
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::stop;
use perigrain_lang::ValueRef;
use perigrain_styles::ActCx;
use perigrain_world::{Domain, Region, World};
use std::ops::ControlFlow;

/// Where particles are made.
pub enum Place {
    /// On lattice sites, in a region where one is given.
    Lattice {
        /// Where.
        region: Option<Region>,
        /// Only some of the sites.
        subset: Option<Subset>,
    },
    /// At one place.
    Single {
        /// Where.
        x: [f64; 3],
        /// Wrapped into a periodic box.
        remap: bool,
    },
    /// At random places.
    Random {
        /// How many.
        count: i64,
        /// Of the random stream.
        seed: u32,
        /// Where.
        region: Option<Region>,
        /// Distance kept from all others; 0 for none.
        overlap: f64,
        /// Attempts for each.
        tries: i64,
    },
    /// On the triangles of a surface.
    Mesh(Mesh),
    /// Packed densely.
    Pack(Box<Pack>),
}

/// A particle to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct New {
    /// Its type.
    pub kind: u16,
    /// Where.
    pub x: [f64; 3],
    /// Its radius, where the way it is made gives one.
    pub radius: Option<f64>,
    /// How it is turned, if it is a molecule that has been turned already.
    pub turn: Option<Quat>,
}

impl New {
    /// Of this type, with this radius if it has one by the way it is made.
    pub fn at(x: [f64; 3], kind: u16, radius: Option<f64>) -> Self {
        Self { kind, x, radius, turn: None }
    }
}

/// The keywords `var` and `set`: a formula that decides about each place.
pub struct Test {
    /// The equal-style variable: not zero where a particle may be.
    pub variable: ValueRef,
    /// The internal-style variables that take x, y, z before.
    pub sets: [Option<ValueRef>; 3],
}

impl Test {
    fn holds(&self, cx: &mut ActCx, x: [f64; 3]) -> Result<bool> {
        let sets: Vec<(&ValueRef, f64)> =
            self.sets.iter().zip(x).filter_map(|(v, x)| v.as_ref().map(|v| (v, x))).collect();
        Ok(cx.values.with_internal(cx.world, &self.variable, &sets)? != 0.0)
    }
}

/// What decides about each new particle.
pub struct Maker<'a> {
    /// The box.
    pub domain: &'a Domain,
    /// The type of particles that have none of their own.
    pub kind: u16,
    /// The type of each point of the unit cell.
    pub basis: &'a [u16],
    /// `var` and `set`.
    pub test: Option<&'a Test>,
    /// The molecule of which copies are made.
    pub mol: Option<&'a Copies>,
}

impl Place {
    /// The new particles in LAMMPS' order.
    pub fn find(&self, cx: &mut ActCx, m: &Maker) -> Result<Vec<New>> {
        match self {
            Place::Lattice { region, subset } => {
                let mut places = on_sites(cx.world, m, region.as_ref());
                if m.test.is_some() {
                    places = tested(cx, m, places)?;
                }
                match subset {
                    Some(subset) => subset.of(places),
                    None => Ok(places),
                }
            }
            Place::Single { x, remap } => Ok(single(m, *x, *remap)),
            Place::Random { count, seed, region, overlap, tries } => {
                let bounds = bounds(m.domain, region.as_ref());
                let random = Random { bounds, region: region.as_ref(), overlap: *overlap, tries: *tries };
                random.places(cx, m, *count, *seed)
            }
            Place::Mesh(mesh) => Ok(mesh.places(m)),
            Place::Pack(pack) => pack.places(cx, m.domain, m.kind),
        }
    }

    /// About how many particles will be made: lattice cells times the share of sample points inside the region.
    pub fn expected(&self, world: &World, domain: &Domain) -> f64 {
        const SAMPLES: usize = 16;
        let region = match self {
            Place::Single { .. } => return 1.0,
            Place::Mesh(mesh) => return mesh.expected(),
            Place::Random { count, .. } => return *count as f64,
            Place::Pack(pack) => return pack.expected(domain),
            Place::Lattice { region, .. } => region.as_ref(),
        };
        let (lo, hi) = bounds(domain, region);
        let at = |k: usize, d: usize| lo[d] + (hi[d] - lo[d]) * (k as f64 + 0.5) / SAMPLES as f64;
        let inside = (0..SAMPLES.pow(3))
            .map(|k| [at(k % SAMPLES, 0), at(k / SAMPLES % SAMPLES, 1), at(k / SAMPLES / SAMPLES, 2)])
            .filter(|x| region.is_none_or(|r| r.contains(*x)))
            .count();
        world.lattice.expected(lo, hi) * inside as f64 / SAMPLES.pow(3) as f64
    }
}

fn tested(cx: &mut ActCx, m: &Maker, places: Vec<New>) -> Result<Vec<New>> {
    let Some(test) = m.test else { return Ok(places) };
    let mut kept = vec![];
    for (k, new) in places.into_iter().enumerate() {
        if stop::cuts_at(k) {
            break;
        }
        if test.holds(cx, new.x)? {
            kept.push(new);
        }
    }
    Ok(kept)
}

/// Sites of the lattice inside box and region.
fn on_sites(world: &World, m: &Maker, region: Option<&Region>) -> Vec<New> {
    let domain = m.domain;
    let (bounds, tilted) = (domain.bounds(), domain.tilted());
    let (mut lo, mut hi) = (bounds.map(|b| b[0]), bounds.map(|b| b[1]));
    for d in (0..3).filter(|&d| domain.boundary.periodic(d)) {
        let epsilon = 1e-6 * (domain.hi[d] - domain.lo[d]);
        // What is around a leaning box reaches beyond its own upper faces.
        (lo[d], hi[d]) = (lo[d] - epsilon, if tilted { hi[d] + epsilon } else { hi[d] - 2.0 * epsilon });
    }
    let (first, last) = match region.and_then(Region::bounds) {
        Some((a, b)) => ([0, 1, 2].map(|d| lo[d].max(a[d])), [0, 1, 2].map(|d| hi[d].min(b[d]))),
        None => (lo, hi),
    };
    let mut places = vec![];
    if (0..3).any(|d| first[d] > last[d]) {
        return places;
    }
    let mut seen = 0;
    let _ = world.lattice.sites(first, last, |k, x| {
        seen += 1;
        if stop::cuts_at(seen) {
            return ControlFlow::Break(());
        }
        let inside = match tilted {
            true => within_fractions(domain, x),
            false => (0..3).all(|d| x[d] >= lo[d] && x[d] < hi[d]),
        };
        if inside && region.is_none_or(|r| r.contains(x)) {
            places.push(New::at(x, m.basis[k], None));
        }
        ControlFlow::Continue(())
    });
    places
}

/// Whether a site lies in a leaning box, by the margins that sites on its faces need.
fn within_fractions(domain: &Domain, x: [f64; 3]) -> bool {
    const EPSILON: f64 = 1e-6;
    let f = domain.fractions(&x);
    (0..3).all(|d| match domain.boundary.periodic(d) {
        true => f[d] >= -EPSILON && f[d] < 1.0 - 2.0 * EPSILON,
        false => f[d] >= 0.0 && f[d] < 1.0,
    })
}

fn single(m: &Maker, mut x: [f64; 3], remap: bool) -> Vec<New> {
    if remap {
        m.domain.wrap(&mut x, &mut [0; 3]);
    }
    if m.domain.holds(&x) { vec![New::at(x, m.kind, None)] } else { vec![] }
}

/// The part of the box that a region leaves.
pub fn bounds(domain: &Domain, region: Option<&Region>) -> ([f64; 3], [f64; 3]) {
    let faces = domain.bounds();
    let (lo, hi) = (faces.map(|f| f[0]), faces.map(|f| f[1]));
    match region.and_then(Region::bounds) {
        Some((a, b)) => ([0, 1, 2].map(|d| lo[d].max(a[d])), [0, 1, 2].map(|d| hi[d].min(b[d]))),
        None => (lo, hi),
    }
}

struct Random<'a> {
    bounds: ([f64; 3], [f64; 3]),
    region: Option<&'a Region>,
    overlap: f64,
    tries: i64,
}

impl Random<'_> {
    /// Draws places one by one; what finds none within the attempts is left out.
    fn places(&self, cx: &mut ActCx, m: &Maker, count: i64, seed: u32) -> Result<Vec<New>> {
        let mut stream = ParkMiller::new(seed);
        stream.skip(30);
        let mut places = vec![];
        if (0..3).any(|d| self.bounds.0[d] > self.bounds.1[d]) {
            return Ok(places);
        }
        // Molecules that must keep their distance are turned before they are looked at.
        let mut turns = m.mol.filter(|_| self.overlap > 0.0).map(|mol| (mol, mol.stream()));
        let (mut taken, mut parts) = (vec![], vec![]);
        let mut tried = 0;
        for _ in 0..count {
            for _ in 0..self.tries {
                tried += 1;
                if self.overlap > 0.0 || tried % stop::MANY == 0 {
                    stop::check()?;
                }
                let x = self.draw(&mut stream, m.domain.flat);
                if !self.allows(cx, m, x)? {
                    continue;
                }
                let turn = turns.as_mut().map(|(mol, stream)| mol.turn(stream, m.domain.flat));
                parts.clear();
                match turn.zip(m.mol) {
                    Some((q, mol)) => parts.extend(mol.at(x, q)),
                    None => parts.push(x),
                }
                if self.overlap == 0.0 || self.keeps_away(cx, m, &taken, &parts) {
                    taken.append(&mut parts);
                    places.push(New { kind: m.kind, x, radius: None, turn });
                    break;
                }
            }
        }
        Ok(places)
    }

    fn draw(&self, stream: &mut ParkMiller, flat: bool) -> [f64; 3] {
        let (lo, hi) = self.bounds;
        let x = [0, 1, 2].map(|d| lo[d] + stream.uniform() * (hi[d] - lo[d]));
        if flat { [x[0], x[1], 0.0] } else { x }
    }

    /// Whether region and variable let something be here.
    fn allows(&self, cx: &mut ActCx, m: &Maker, x: [f64; 3]) -> Result<bool> {
        if !self.region.is_none_or(|r| r.contains(x)) || (m.domain.tilted() && !m.domain.holds(&x)) {
            return Ok(false);
        }
        m.test.map_or(Ok(true), |test| test.holds(cx, x))
    }

    /// Whether all these parts are far enough from all others.
    fn keeps_away(&self, cx: &ActCx, m: &Maker, taken: &[[f64; 3]], parts: &[[f64; 3]]) -> bool {
        cx.world.particles.x.iter().chain(taken).all(|y| {
            parts.iter().all(|x| {
                let d = m.domain.minimum_image([x[0] - y[0], x[1] - y[1], x[2] - y[2]]);
                d[0] * d[0] + d[1] * d[1] + d[2] * d[2] >= self.overlap * self.overlap
            })
        })
    }
}
