//! Bodies for tests: lattices and random networks of beams.

use super::network::Network;
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::{Vec3, length, sub};
use perigrain_bonded::stiffness::{Beam, Shear, Stiffness};

/// Centres, and bonds with vectors from the first end to the second.
#[derive(Clone, Default)]
pub struct Body {
    pub x: Vec<Vec3>,
    pub bonds: Vec<([u32; 2], Vec3)>,
}

/// The beam of the documentation: E = 1 GPa, ν = 0.2, r = 0.4 mm.
pub fn standard(length: f64) -> Stiffness {
    Beam { young: 1e9, poisson: 0.2, radius: 0.4e-3, length }.stiffness(Shear::Paper)
}

impl Body {
    /// Sites with bonds between all pairs closer than `reach`, across periodic faces where the box length is
    /// not 0.
    pub fn new(x: Vec<Vec3>, reach: f64, period: Vec3) -> Self {
        let mut bonds = vec![];
        for i in 0..x.len() {
            for j in i + 1..x.len() {
                let d = sub(x[j], x[i]);
                let d: Vec3 = std::array::from_fn(|k| {
                    if period[k] > 0.0 { d[k] - period[k] * (d[k] / period[k]).round() } else { d[k] }
                });
                if length(d) < reach {
                    bonds.push(([i as u32, j as u32], d));
                }
            }
        }
        Self { x, bonds }
    }

    /// Its network of beams.
    pub fn network(&self, beam: impl Fn(usize, f64) -> Stiffness) -> Network {
        let ends: Vec<[u32; 2]> = self.bonds.iter().map(|b| b.0).collect();
        Network::new(self.x.len(), &ends, |k| (self.bonds[k].1, beam(k, length(self.bonds[k].1))))
    }

    /// The radii of all spheres, this one.
    pub fn radii(&self, radius: f64) -> Vec<f64> {
        vec![radius; self.x.len()]
    }
}

/// `cells` cells of a lattice with nearest distance 1 mm and these sites in its cubic cell of edge `a`; in a
/// periodic box, or free with both outermost planes.
pub fn lattice(sites: &[[f64; 3]], a: f64, cells: usize, periodic: bool) -> Body {
    let mut x = vec![];
    for c in 0..cells.pow(3) {
        let cell = [c % cells, c / cells % cells, c / cells / cells];
        x.extend(sites.iter().map(|s| std::array::from_fn(|d| a * (cell[d] as f64 + s[d]))));
    }
    Body::new(x, 1.05e-3, if periodic { [a * cells as f64; 3] } else { [0.0; 3] })
}

/// The sites of a face-centred cell with nearest distance 1 mm, and its edge.
pub const FCC: ([[f64; 3]; 4], f64) =
    ([[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]], 1e-3 * std::f64::consts::SQRT_2);
/// Body-centred cubic.
pub const BCC: ([[f64; 3]; 2], f64) = ([[0.0, 0.0, 0.0], [0.5, 0.5, 0.5]], 1e-3 * 1.154_700_538_379_251_5);
/// Simple cubic.
pub const SC: ([[f64; 3]; 1], f64) = ([[0.0, 0.0, 0.0]], 1e-3);

/// The 256 particles of 4 × 4 × 4 fcc cells; with `holes`, without the sites with (7p + 11q + 13r) mod 9 = 4,
/// except in both planes normal to z.
pub fn block(holes: bool) -> Body {
    let whole = lattice(&FCC.0, FCC.1, 4, false);
    let twice = |a: f64| (2.0 * a / FCC.1).round() as usize;
    let stays = |x: &&Vec3| {
        let [p, q, r] = x.map(twice);
        !holes || r == 0 || r == 7 || (7 * p + 11 * q + 13 * r) % 9 != 4
    };
    Body::new(whole.x.iter().filter(stays).copied().collect(), 1.05e-3, [0.0; 3])
}

/// Random points in a box, bonded up to a distance that gives each about a dozen partners; some dangle by
/// chance.
pub fn random(seed: u32, n: usize, keep: f64) -> Body {
    let mut rng = ParkMiller::new(seed);
    let edge = 1e-3 * (n as f64 / 1.5).cbrt();
    let x: Vec<Vec3> = (0..n).map(|_| [0, 1, 2].map(|_| edge * rng.uniform())).collect();
    let mut body = Body::new(x, 1.3e-3, [0.0; 3]);
    body.bonds.retain(|(_, d)| length(*d) > 0.2e-3 && rng.uniform() < keep);
    body
}
