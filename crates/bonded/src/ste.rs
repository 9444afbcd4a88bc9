//! Stiffness tensor estimation: a closed formula per particle, without boundary conditions.
//!
//! K. Jarolin, M. Dosta, Comput. Part. Mech. 8 (2021), Eq. 12–35, with K in Eq. 15 and one index for each sum. φ of a particle is its
//! fluctuation, S its Σ K; order k takes k sweeps φ ← S⁻¹ Σ K (ε d + φ of the partner).

use super::network::Network;
use super::six::{Matrix6, Packed, at, full, invert};
use super::tensor::{VOIGT, strain};
use perigrain_base::math::vec3::{Vec3, add, dot, scale, sub};
use perigrain_base::par;

/// The fluctuation of a particle for each of the six load cases.
type Phi = [f64; 18];

/// What came of all particles.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// V C of each particle, symmetric in all ways [energy].
    pub local: Vec<Packed>,
    /// How many particles are left out for want of three independent partners.
    pub without: usize,
}

impl Estimate {
    /// Of order 0: all follow the strain; 1, 2: as Jarolin and Dosta take them, one's own fluctuation a sweep ahead of the partners';
    /// from 3 on the same for both. Bonds are springs along and across their direction: rotations are left out.
    pub fn new(network: &Network, order: usize) -> Self {
        let n = network.particles;
        let inverse = if order == 0 { vec![] } else { inverses(network) };
        let without = inverse.iter().filter(|s| s.is_none()).count();
        let (mut own, mut other) = (vec![[0.0; 18]; n], vec![[0.0; 18]; n]);
        for _ in 0..order {
            other = sweep(network, &inverse, &own);
            std::mem::swap(&mut own, &mut other);
        }
        if order > 2 {
            other.clone_from(&own);
        }
        let mut local = vec![[0.0; 21]; n];
        network.pairs.gather(&mut local, |bond, [i, j]| {
            let pull = Pull::new(network, bond);
            [pull.stiffness(&own[i], &other[j]), pull.stiffness(&other[i], &own[j])]
        });
        for (local, _) in local.iter_mut().zip(&inverse).filter(|(_, inverse)| inverse.is_none()) {
            *local = [0.0; 21];
        }
        Self { local, without }
    }

    /// C of some particles of this volume.
    pub fn tensor(&self, members: impl Iterator<Item = usize>, volume: f64) -> Matrix6 {
        let mut sum = [0.0; 21];
        for k in members {
            sum.iter_mut().zip(&self.local[k]).for_each(|(sum, a)| *sum += a);
        }
        full(&sum.map(|a| a / volume))
    }

    /// C of all.
    pub fn whole(&self, volume: f64) -> Matrix6 {
        let add = |a: Packed, b: &Packed| std::array::from_fn(|k| a[k] + b[k]);
        let sum = par::reduce(
            self.local.len(),
            |range| self.local[range].iter().fold([0.0; 21], add),
            |a, b| add(a, &b),
        );
        full(&sum.unwrap_or([0.0; 21]).map(|a| a / volume))
    }
}

/// S⁻¹ of every particle, six numbers; `None` where some displacement meets no resistance.
fn inverses(network: &Network) -> Vec<Option<[f64; 6]>> {
    let mut s = vec![[0.0; 6]; network.particles];
    network.pairs.gather(&mut s, |bond, _| {
        let pull = Pull::new(network, bond);
        let mut k = [0.0; 6];
        for c in 0..3 {
            let mut unit = [0.0; 3];
            unit[c] = 1.0;
            let column = pull.times(unit);
            (c..3).for_each(|r| k[at(r, c)] = column[r]);
        }
        [k, k]
    });
    s.into_iter()
        .map(|s| {
            let whole: Matrix6 = std::array::from_fn(|r| {
                std::array::from_fn(|c| if r < 3 && c < 3 { s[at(r, c)] } else { 0.0 })
            });
            let found = invert(&whole, 0b111000);
            (found.without == 0).then(|| std::array::from_fn(|k| found.inverse[k]))
        })
        .collect()
}

/// φ = S⁻¹ Σ K (ε d + φ of the partner).
fn sweep(network: &Network, inverse: &[Option<[f64; 6]>], before: &[Phi]) -> Vec<Phi> {
    let mut phi = vec![[0.0; 18]; network.particles];
    network.pairs.gather(&mut phi, |bond, [i, j]| {
        let pull = Pull::new(network, bond);
        let mut out = [[0.0; 18]; 2];
        for case in 0..6 {
            // Seen from the upper end d is the other way.
            let stretch = pull.stretch(case);
            put(&mut out[0], case, pull.times(add(vector(&before[j], case), stretch)));
            put(&mut out[1], case, pull.times(sub(vector(&before[i], case), stretch)));
        }
        out
    });
    par::each((&mut phi[..], inverse), |_, (phi, inverse)| {
        for (phi, s) in phi.iter_mut().zip(inverse) {
            for case in 0..6 {
                let v = vector(phi, case);
                let moved = s.map_or([0.0; 3], |s| {
                    std::array::from_fn(|r| s[at(r, 0)] * v[0] + s[at(r, 1)] * v[1] + s[at(r, 2)] * v[2])
                });
                put(phi, case, moved);
            }
        }
    });
    phi
}

#[inline(always)]
fn vector(phi: &Phi, case: usize) -> Vec3 {
    [phi[3 * case], phi[3 * case + 1], phi[3 * case + 2]]
}

#[inline(always)]
fn put(phi: &mut Phi, case: usize, v: Vec3) {
    phi[3 * case..3 * case + 3].copy_from_slice(&v);
}

/// A bond as a spring along and across its direction.
struct Pull {
    d: Vec3,
    n: Vec3,
    across: f64,
    along: f64,
}

impl Pull {
    #[inline(always)]
    fn new(network: &Network, bond: usize) -> Self {
        let k = &network.k[bond];
        Self { d: network.d(bond), n: network.n[bond], across: k.shear, along: k.normal - k.shear }
    }

    /// K u = k_s u + (k_n − k_s) n (n·u).
    #[inline(always)]
    fn times(&self, u: Vec3) -> Vec3 {
        add(scale(self.across, u), scale(self.along * dot(self.n, u), self.n))
    }

    /// ε d.
    #[inline(always)]
    fn stretch(&self, case: usize) -> Vec3 {
        strain(case).map(|row| dot(row, self.d))
    }

    /// ½ d ⊗ K (ε d − φ_low + φ_high) for all six strains, symmetric in all ways: a particle's half of the bond.
    #[inline(always)]
    fn stiffness(&self, low: &Phi, high: &Phi) -> Packed {
        let mut c = [[0.0; 6]; 6];
        for case in 0..6 {
            let f = self.times(add(self.stretch(case), sub(vector(high, case), vector(low, case))));
            for (row, (i, j)) in VOIGT.into_iter().enumerate() {
                c[row][case] = 0.25 * (self.d[i] * f[j] + self.d[j] * f[i]);
            }
        }
        let mut out = [0.0; 21];
        for row in 0..6 {
            for column in 0..=row {
                out[at(row, column)] = 0.5 * (c[row][column] + c[column][row]);
            }
        }
        out
    }
}

/// Slabs across an axis, each of its own tensor, one behind the other.
#[derive(Clone, Debug)]
pub struct Layers {
    /// K of the whole [force/length].
    pub stiffness: f64,
    /// E A of each slab: its Young's modulus along the axis times ΣV over its height [force].
    pub slabs: Vec<f64>,
}

impl Layers {
    /// `count` slabs of equal height between `lo` and `hi` along the axis of particles at `x` with these shares of the volume.
    pub fn new(
        estimate: &Estimate,
        x: &[f64],
        volume: &[f64],
        [lo, hi]: [f64; 2],
        count: usize,
        axis: usize,
    ) -> Self {
        let height = (hi - lo) / count as f64;
        let mut members = vec![vec![]; count];
        for (k, x) in x.iter().enumerate() {
            members[(((x - lo) / height).max(0.0) as usize).min(count - 1)].push(k);
        }
        let slabs: Vec<f64> = members
            .iter()
            .map(|members| {
                let volume: f64 = members.iter().map(|k| volume[*k]).sum();
                if volume == 0.0 {
                    return 0.0;
                }
                let c = estimate.tensor(members.iter().copied(), volume);
                super::tensor::Moduli::new(&c).map_or(f64::NAN, |m| m.young[axis] * volume / height)
            })
            .collect();
        let compliance: f64 = slabs.iter().map(|ea| height / ea).sum();
        Self { stiffness: 1.0 / compliance, slabs }
    }
}
