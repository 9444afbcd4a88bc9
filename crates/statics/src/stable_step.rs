//! The largest stable step of bonded particles under velocity Verlet: a bound from each particle's own bonds,
//! and the limit itself.
//!
//! Forces are evaluated at x and at the velocities of half a step before, so that a motion of frequency ω
//! with dashpots c on masses m is stable while dt² ω² + 2 dt c/m < 4; for a body, while dt² K + 2 dt C < 4 M.

use super::network::{Network, halves, row};
use super::six::{Matrix6, Six, full, largest};
use perigrain_base::math::lanczos::largest_eigenvalue;
use perigrain_base::math::vec3::scale;
use perigrain_base::par;

/// A body that vibrates.
pub struct Swinging {
    /// Its bonds.
    pub network: Network,
    /// The same bonds with dashpot coefficients as stiffnesses; `None` without dashpots.
    pub dashpots: Option<Network>,
    /// Mass [force time²/length] and moment of inertia [force length time²] of each particle; infinite for
    /// components that are fixed.
    pub inertia: Vec<[f64; 2]>,
}

/// Iterations for the limit with dashpots; each at least halves the error.
const ROUNDS: usize = 6;
/// Relative accuracy of these iterations.
const NEAR: f64 = 1e-4;

impl Swinging {
    /// A step that is certain to be stable, 70 to 100 % of the limit: a bond's energy is the square of a sum
    /// over its two ends, so that K ≤ 2 diag(K_ii), and the 6 × 6 blocks bound it [time]. `None` if nothing
    /// vibrates.
    pub fn bound(&self) -> Option<f64> {
        let stiff = self.network.blocks();
        let damp = self.dashpots.as_ref().map(Network::blocks);
        let step = |range: std::ops::Range<usize>| {
            let mut least = f64::INFINITY;
            for k in range {
                let roots = self.roots(k);
                let scaled = |block: &[f64; 21]| scaled(&full(block), &roots);
                let (a, b) = (scaled(&stiff[k]), damp.as_ref().map(|d| scaled(&d[k])));
                // Row sums are cheap, and rule out most particles.
                if limit(2.0 * rows(&a), 2.0 * b.as_ref().map_or(0.0, rows)) >= least {
                    continue;
                }
                least = least.min(limit(2.0 * largest(&a), 2.0 * b.as_ref().map_or(0.0, largest)));
            }
            least
        };
        par::reduce(self.inertia.len(), step, f64::min).filter(|dt| dt.is_finite())
    }

    /// The limit, with a relative accuracy of about 3e-4 [time]. `None` if nothing vibrates.
    pub fn limit(&self) -> Option<f64> {
        let stiff = self.largest(&self.network).unwrap_or(0.0);
        let Some(dashpots) = &self.dashpots else {
            return Some(limit(stiff, 0.0)).filter(|dt| dt.is_finite());
        };
        // Exact if the fastest motion is also the most damped one, below the limit otherwise.
        let mut dt = limit(stiff, self.largest(dashpots).unwrap_or(0.0));
        let mut both = self.network.clone();
        for _ in 0..ROUNDS {
            if !dt.is_finite() {
                return None;
            }
            for (k, (stiff, damp)) in both.k.iter_mut().zip(self.network.k.iter().zip(&dashpots.k)) {
                *k = stiff.plus(&damp.times(2.0 / dt));
            }
            let better = limit(self.largest(&both)?, 0.0);
            let rise = better - dt;
            dt = dt.max(better);
            if rise < NEAR * dt {
                break;
            }
        }
        Some(dt)
    }

    /// The largest eigenvalue of M⁻¹ K.
    fn largest(&self, network: &Network) -> Option<f64> {
        let n = self.inertia.len();
        let roots: Vec<[f64; 2]> = (0..n).map(|k| self.roots(k)).collect();
        let (mut u, mut f) = (vec![[0.0; 6]; n], vec![[0.0; 6]; n]);
        let weigh = |from: &Six, [straight, turning]: &[f64; 2]| {
            let (a, b) = halves(from);
            row(scale(*straight, a), scale(*turning, b))
        };
        largest_eigenvalue(n, 1e-12, |q| {
            u.iter_mut().zip(q.iter().zip(&roots)).for_each(|(u, (q, r))| *u = weigh(q, r));
            network.product(&u, &mut f);
            f.iter().zip(&roots).map(|(f, r)| weigh(f, r)).collect()
        })
    }

    /// 1/√m and 1/√I.
    fn roots(&self, k: usize) -> [f64; 2] {
        self.inertia[k].map(|m| if m > 0.0 { 1.0 / m.sqrt() } else { 0.0 })
    }
}

/// The step that satisfies dt² a + 2 dt b = 4: 2/√a without dashpots; infinite if both are zero.
fn limit(a: f64, b: f64) -> f64 {
    let (a, b) = (a.max(0.0), b.max(0.0));
    4.0 / (b + (b * b + 4.0 * a).sqrt())
}

/// M^−½ K M^−½ of one particle.
fn scaled(m: &Matrix6, roots: &[f64; 2]) -> Matrix6 {
    std::array::from_fn(|r| std::array::from_fn(|c| m[r][c] * roots[r / 3] * roots[c / 3]))
}

/// The largest sum of magnitudes of a row, an upper bound of the eigenvalues.
fn rows(m: &Matrix6) -> f64 {
    m.iter().map(|row| row.iter().map(|a| a.abs()).sum()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_bonded::stiffness::Stiffness;

    /// The standard bond of the documentation of bonded particles, along x, between spheres of 1 mm.
    fn pair(k: Stiffness, damping: Option<Stiffness>) -> Swinging {
        let network = |k| Network::new(2, &[[0, 1]], |_| ([1e-3, 0.0, 0.0], k));
        let inertia = vec![[1.0471975512e-6, 1.0471975512e-13]; 2];
        Swinging { network: network(k), dashpots: damping.map(network), inertia }
    }

    const STANDARD: Stiffness = Stiffness {
        normal: 502654.824574,
        shear: 209439.510239,
        twist: 0.0167551608191,
        bend: 0.020106192983,
    };

    fn near(a: Option<f64>, b: f64, tolerance: f64) {
        assert!(a.is_some_and(|a| (a / b - 1.0).abs() < tolerance), "{a:?} {b}");
    }

    #[test]
    fn the_frequencies_of_a_free_pair() {
        // Printed there with nine digits; twelve vectors span the space of two particles, so Lanczos' method
        // is exact.
        near(pair(STANDARD, None).limit(), 2.0 / 1183215.957, 1e-9);
        let only = |k: Stiffness, omega: f64| near(pair(k, None).limit(), 2.0 / omega, 1e-9);
        only(Stiffness { normal: STANDARD.normal, ..Stiffness::default() }, 979795.897);
        only(Stiffness { twist: STANDARD.twist, ..Stiffness::default() }, 565685.425);
        only(Stiffness { bend: STANDARD.bend, ..Stiffness::default() }, 619677.335);
        assert_eq!(pair(Stiffness::default(), None).limit(), None);
        assert_eq!(pair(Stiffness::default(), None).bound(), None);
    }

    #[test]
    fn the_bound_is_below_the_limit() {
        // An irregular body with three kinds of bonds.
        let places: Vec<[f64; 3]> = (0..40)
            .map(|k| {
                let (a, b, c) = (k % 4, k / 4 % 4, k / 16);
                [a, b, c].map(|x| f64::from(x) * 1e-3 + 1e-4 * f64::from((7 * k + 3 * x) % 5))
            })
            .collect();
        let mut ends = vec![];
        for i in 0..40u32 {
            for j in i + 1..40 {
                let d = [0, 1, 2].map(|d| places[j as usize][d] - places[i as usize][d]);
                if perigrain_base::math::vec3::length(d) < 1.6e-3 {
                    ends.push([i, j]);
                }
            }
        }
        let bond = |k: usize| {
            let [i, j] = ends[k].map(|e| places[e as usize]);
            ([0, 1, 2].map(|d| j[d] - i[d]), STANDARD.times(1.0 + (k % 3) as f64))
        };
        let network = Network::new(40, &ends, bond);
        let mut dashpots = network.clone();
        dashpots.k.iter_mut().for_each(|k| *k = k.times(4e-8));
        let inertia: Vec<[f64; 2]> = (0..40)
            .map(|k| if k == 7 { [f64::INFINITY; 2] } else { [1e-6 + 1e-8 * f64::from(k), 1e-13] })
            .collect();
        for dashpots in [None, Some(dashpots)] {
            let body = Swinging { network: network.clone(), dashpots, inertia: inertia.clone() };
            let (bound, limit) = (body.bound().unwrap(), body.limit().unwrap());
            assert!(bound < limit && bound > 0.65 * limit, "{bound} {limit}");
        }
    }

    #[test]
    fn dashpots_shorten_it() {
        // One motion: stretch at ω = √(2 k/m) with ξ = c/(m ω): dt = (2/ω)(√(1 + ξ²) − ξ).
        let k = Stiffness { normal: STANDARD.normal, ..Stiffness::default() };
        let c = Stiffness { normal: 0.1, ..Stiffness::default() };
        let omega = (2.0 * k.normal / 1.0471975512e-6f64).sqrt();
        let xi = 0.1 / (1.0471975512e-6 * omega);
        near(pair(k, Some(c)).limit(), 2.0 / omega * ((1.0 + xi * xi).sqrt() - xi), 1e-9);
        // Of two separate motions the stretch is faster, the other damped more: the sum of both would be too
        // short.
        let c = Stiffness { twist: 1e-8, ..Stiffness::default() };
        let both = Stiffness { twist: STANDARD.twist, ..k };
        let turning = (2.0 * STANDARD.twist / 1.0471975512e-13f64).sqrt();
        let xi = 1e-8 / (1.0471975512e-13 * turning);
        let slower = 2.0 / turning * ((1.0 + xi * xi).sqrt() - xi);
        near(pair(both, Some(c)).limit(), slower.min(2.0 / omega), 1e-3);
    }
}
