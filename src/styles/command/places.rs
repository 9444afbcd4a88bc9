//! Where `create_atoms` puts particles: lattice sites, one place, random places.

use crate::math::rng::ParkMiller;
use crate::world::{Domain, Region, World};
use std::ops::ControlFlow;

/// Where particles are made.
pub enum Place {
    /// On all lattice sites, in a region where one is given.
    Lattice(Option<Region>),
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
}

/// Type and place of a new particle.
pub type New = (u16, [f64; 3]);

impl Place {
    /// The new particles in LAMMPS' order; `basis` holds the type of each point of the unit cell.
    pub fn find(&self, world: &World, domain: &Domain, kind: u16, basis: &[u16]) -> Vec<New> {
        match self {
            Place::Lattice(region) => on_sites(world, domain, region.as_ref(), basis),
            Place::Single { x, remap } => single(domain, *x, *remap, kind),
            Place::Random { count, seed, region, overlap, tries } => {
                let bounds = bounds(domain, region.as_ref());
                let random = Random { bounds, region: region.as_ref(), overlap: *overlap, tries: *tries };
                random.places(world, domain, *count, *seed, kind)
            }
        }
    }

    /// About how many particles will be made: lattice cells times the share of sample points inside the region.
    pub fn expected(&self, world: &World, domain: &Domain) -> f64 {
        const SAMPLES: usize = 16;
        let region = match self {
            Place::Single { .. } => return 1.0,
            Place::Random { count, .. } => return *count as f64,
            Place::Lattice(region) => region.as_ref(),
        };
        let (lo, hi) = bounds(domain, region);
        let at = |k: usize, d: usize| lo[d] + (hi[d] - lo[d]) * (k as f64 + 0.5) / SAMPLES as f64;
        let inside = (0..SAMPLES.pow(3))
            .map(|k| [at(k % SAMPLES, 0), at(k / SAMPLES % SAMPLES, 1), at(k / SAMPLES / SAMPLES, 2)])
            .filter(|x| region.is_none_or(|r| r.contains(*x)))
            .count();
        world.lattice.site_bound(lo, hi) * inside as f64 / SAMPLES.pow(3) as f64
    }
}

/// Sites of the lattice inside box and region.
fn on_sites(world: &World, domain: &Domain, region: Option<&Region>, basis: &[u16]) -> Vec<New> {
    let (mut lo, mut hi) = (domain.lo, domain.hi);
    for d in (0..3).filter(|&d| domain.boundary.periodic(d)) {
        let epsilon = 1e-6 * (domain.hi[d] - domain.lo[d]);
        (lo[d], hi[d]) = (lo[d] - epsilon, hi[d] - 2.0 * epsilon);
    }
    let (first, last) = match region.and_then(Region::bounds) {
        Some((a, b)) => ([0, 1, 2].map(|d| lo[d].max(a[d])), [0, 1, 2].map(|d| hi[d].min(b[d]))),
        None => (lo, hi),
    };
    let mut places = vec![];
    if (0..3).any(|d| first[d] > last[d]) {
        return places;
    }
    let _ = world.lattice.sites(first, last, |m, x| {
        let inside = (0..3).all(|d| x[d] >= lo[d] && x[d] < hi[d]);
        if inside && region.is_none_or(|r| r.contains(x)) {
            places.push((basis[m], x));
        }
        ControlFlow::<()>::Continue(())
    });
    places
}

fn single(domain: &Domain, mut x: [f64; 3], remap: bool, kind: u16) -> Vec<New> {
    if remap {
        domain.wrap(&mut x, &mut [0; 3]);
    }
    let inside = (0..3).all(|d| x[d] >= domain.lo[d] && x[d] < domain.hi[d]);
    if inside { vec![(kind, x)] } else { vec![] }
}

/// The part of the box that a region leaves.
fn bounds(domain: &Domain, region: Option<&Region>) -> ([f64; 3], [f64; 3]) {
    match region.and_then(Region::bounds) {
        Some((a, b)) => {
            ([0, 1, 2].map(|d| domain.lo[d].max(a[d])), [0, 1, 2].map(|d| domain.hi[d].min(b[d])))
        }
        None => (domain.lo, domain.hi),
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
    fn places(&self, world: &World, domain: &Domain, count: i64, seed: u32, kind: u16) -> Vec<New> {
        let mut stream = ParkMiller::new(seed);
        stream.skip(30);
        let mut places = vec![];
        if (0..3).any(|d| self.bounds.0[d] > self.bounds.1[d]) {
            return places;
        }
        for _ in 0..count {
            let found = (0..self.tries).find_map(|_| {
                let x = self.draw(&mut stream);
                let free =
                    self.region.is_none_or(|r| r.contains(x)) && self.is_free(world, domain, &places, x);
                free.then_some((kind, x))
            });
            places.extend(found);
        }
        places
    }

    fn draw(&self, stream: &mut ParkMiller) -> [f64; 3] {
        let (lo, hi) = self.bounds;
        [0, 1, 2].map(|d| lo[d] + stream.uniform() * (hi[d] - lo[d]))
    }

    fn is_free(&self, world: &World, domain: &Domain, new: &[New], x: [f64; 3]) -> bool {
        let old = world.particles.x.iter();
        self.overlap == 0.0
            || old.chain(new.iter().map(|(_, y)| y)).all(|y| {
                let d = domain.minimum_image([x[0] - y[0], x[1] - y[1], x[2] - y[2]]);
                d[0] * d[0] + d[1] * d[1] + d[2] * d[2] >= self.overlap * self.overlap
            })
    }
}
