//! Stiffness tensor estimation: a closed formula per particle, without boundary conditions.
//!
//! K. Jarolin, M. Dosta, Comput. Part. Mech. 8 (2021), Eq. 12–35, with K in Eq. 15 and a single index for
//! each sum. φ of a particle is its fluctuation, S its Σ K; order k applies k sweeps φ ← S⁻¹ Σ K (ε d + φ of
//! the partner).

use super::network::Network;
use super::six::{Matrix6, PIVOT, Packed, at, full};
use super::tensor::VOIGT;
use perigrain_base::math::vec3::{Vec3, add, dot, scale, sub};
use perigrain_base::par;
use perigrain_base::stop;

/// A vector for each of the six load cases (fluctuations φ or forces): all x, all y, all z.
type Six3 = [f64; 18];

/// Results for all particles.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// Σ V C over all particles [energy].
    sum: Packed,
    /// Fluctuations that a particle uses for itself, and for its partners.
    own: Vec<Six3>,
    other: Vec<Six3>,
    /// Particles excluded because they lack three independent partners.
    out: Vec<bool>,
}

impl Estimate {
    /// Order 0: affine motion; 1 and 2: as in Jarolin and Dosta, with a particle's own fluctuation one sweep
    /// ahead of the partners'; from 3 on the same for both. Bonds are springs with normal and tangential
    /// stiffness: rotations are ignored.
    ///
    /// K is symmetric, and with T = Σ K ε d of a particle Σ V C = Σ_bonds (ε d) K (ε d) − ½ Σ_particles T (φ
    /// own + φ other): one pass over bonds in addition to the sweeps.
    pub fn new(network: &Network, order: usize) -> Self {
        let mut out =
            Self { sum: affine(network), own: vec![], other: vec![], out: vec![false; network.particles] };
        if order == 0 {
            return out;
        }
        let (inverse, without) = inverses(network);
        out.out = without;
        // The first sweep starts from affine motion.
        (out.own, out.other) = (vec![[0.0; 18]; network.particles], vec![[0.0; 18]; network.particles]);
        for _ in 0..order {
            if stop::cuts() {
                break;
            }
            std::mem::swap(&mut out.own, &mut out.other);
            sweep(network, &inverse, &out.other, &mut out.own);
        }
        if order > 2 {
            out.other.clone_from(&out.own);
        }
        out.sum = match out.without() {
            0 => add_packed(&out.sum, &relaxation(network, &out.own, &out.other)),
            _ => par_sum(&out.local(network)),
        };
        out
    }

    /// The number of excluded particles.
    pub fn without(&self) -> usize {
        self.out.iter().filter(|out| **out).count()
    }

    /// C of the whole body.
    pub fn whole(&self, volume: f64) -> Matrix6 {
        full(&self.sum.map(|a| a / volume))
    }

    /// V C of each particle, fully symmetric [energy].
    pub fn local(&self, network: &Network) -> Vec<Packed> {
        let still = [0.0; 18];
        let at = |field: &[Six3], k: usize| field.get(k).copied().unwrap_or(still);
        let mut local = vec![[0.0; 21]; network.particles];
        network.pairs.gather(&mut local, |bond, [i, j]| {
            let pull = Pull::new(network, bond);
            [
                pull.stiffness(&at(&self.own, i), &at(&self.other, j)),
                pull.stiffness(&at(&self.other, i), &at(&self.own, j)),
            ]
        });
        local.iter_mut().zip(&self.out).filter(|(_, out)| **out).for_each(|(local, _)| *local = [0.0; 21]);
        local
    }
}

fn add_packed(a: &Packed, b: &Packed) -> Packed {
    std::array::from_fn(|k| a[k] + b[k])
}

fn par_sum(all: &[Packed]) -> Packed {
    let chunk =
        |range: std::ops::Range<usize>| all[range].iter().fold([0.0; 21], |sum, a| add_packed(&sum, a));
    par::reduce(all.len(), chunk, |a, b| add_packed(&a, &b)).unwrap_or([0.0; 21])
}

/// Σ_bonds (ε_a d) K (ε_b d) = Σ k_s (ε_a d)·(ε_b d) + Σ (k_n − k_s)(n·ε_a d)(n·ε_b d).
fn affine(network: &Network) -> Packed {
    // k_s d d as xx yy zz yz xz xy, then the second sum.
    let bond = |sum: &mut [f64; 27], bond: usize| {
        let (n, l, k) = (network.n(bond), network.length(bond), &network.k[bond]);
        let nn = VOIGT.map(|(i, j)| l * n[i] * n[j]);
        (0..6).for_each(|a| sum[a] += k.shear * l * nn[a]);
        let scaled = nn.map(|a| (k.normal - k.shear) * a);
        let mut at = 6;
        for row in 0..6 {
            for column in 0..=row {
                sum[at] += scaled[row] * nn[column];
                at += 1;
            }
        }
    };
    let chunk = |range: std::ops::Range<usize>| {
        let mut sum = [0.0; 27];
        range.for_each(|k| bond(&mut sum, k));
        sum
    };
    let sum = par::reduce(network.bonds(), chunk, |a, b| std::array::from_fn(|k| a[k] + b[k]));
    let sum: [f64; 27] = sum.unwrap_or([0.0; 27]);
    let [xx, yy, zz, yz, xz, xy] = [sum[0], sum[1], sum[2], sum[3], sum[4], sum[5]];
    // (ε_a d)·(ε_b d), with shears of ½ in both places.
    let dots = [
        xx,
        0.0,
        yy,
        0.0,
        0.0,
        zz,
        0.0,
        0.5 * yz,
        0.5 * yz,
        0.25 * (yy + zz),
        0.5 * xz,
        0.0,
        0.5 * xz,
        0.25 * xy,
        0.25 * (xx + zz),
        0.5 * xy,
        0.5 * xy,
        0.0,
        0.25 * xz,
        0.25 * yz,
        0.25 * (xx + yy),
    ];
    std::array::from_fn(|k| dots[k] + sum[6 + k])
}

/// −½ Σ_particles T_a·(φ own + φ other)_b, symmetric; T = Σ K ε d is computed chunk by chunk and not stored.
fn relaxation(network: &Network, own: &[Six3], other: &[Six3]) -> Packed {
    let chunk = |range: std::ops::Range<usize>| {
        let mut sum = [[0.0; 6]; 6];
        let mut pulls = vec![[0.0; 18]; range.len()];
        network.pairs.gather_chunk(range.start, &mut pulls, &|bond, _| {
            let pull = Pull::new(network, bond);
            let f = pull.times_all(&pull.stretches_by_axis());
            [f, f.map(|f| -f)]
        });
        for (k, pulls) in range.zip(&pulls) {
            let phi: Six3 = std::array::from_fn(|c| own[k][c] + other[k][c]);
            for a in 0..6 {
                let [x, y, z] = vector(pulls, a).map(|f| 0.5 * f);
                for b in 0..6 {
                    sum[a][b] -= x * phi[b] + y * phi[6 + b] + z * phi[12 + b];
                }
            }
        }
        let mut out = [0.0; 21];
        for row in 0..6 {
            (0..=row).for_each(|column| out[at(row, column)] = 0.5 * (sum[row][column] + sum[column][row]));
        }
        out
    };
    par::reduce(own.len(), chunk, |a, b| add_packed(&a, &b)).unwrap_or([0.0; 21])
}

/// S⁻¹ of every particle, S = Σ K, six numbers; zero for particles with a displacement without resistance,
/// and a flag for these.
fn inverses(network: &Network) -> (Vec<[f64; 6]>, Vec<bool>) {
    let mut s = vec![[0.0; 6]; network.particles];
    network.pairs.gather(&mut s, |bond, _| {
        let Pull { n: [x, y, z], along, across, .. } = Pull::new(network, bond);
        let k = [x * x, y * x, y * y, z * x, z * y, z * z].map(|a| along * a);
        let k = [k[0] + across, k[1], k[2] + across, k[3], k[4], k[5] + across];
        [k, k]
    });
    let mut out = vec![false; network.particles];
    par::each((&mut s[..], &mut out[..]), |_, (s, out)| {
        for (s, out) in s.iter_mut().zip(out) {
            let found = inverse(s);
            (*out, *s) = (found.is_none(), found.unwrap_or_default());
        }
    });
    (s, out)
}

/// The inverse of a symmetric matrix 00, 10 11, 20 21 22; `None` if a pivot is missing.
fn inverse([xx, yx, yy, zx, zy, zz]: &[f64; 6]) -> Option<[f64; 6]> {
    let least = PIVOT * xx.max(*yy).max(*zz);
    let second = yy - yx * yx / xx;
    let across = zy - zx * yx / xx;
    let third = zz - zx * zx / xx - across * across / second;
    // NaN if an earlier pivot is missing.
    if !(*xx > least && second > least && third > least) {
        return None;
    }
    let det = xx * second * third;
    let of = |a: f64, b: f64, c: f64, d: f64| (a * b - c * d) / det;
    Some([
        of(*yy, *zz, *zy, *zy),
        of(*zx, *zy, *yx, *zz),
        of(*xx, *zz, *zx, *zx),
        of(*yx, *zy, *yy, *zx),
        of(*yx, *zx, *xx, *zy),
        of(*xx, *yy, *yx, *yx),
    ])
}

/// φ = S⁻¹ f.
fn solve(f: &mut [Six3], inverse: &[[f64; 6]]) {
    par::each((f, inverse), |_, (f, inverse): (&mut [Six3], &[[f64; 6]])| {
        for (f, s) in f.iter_mut().zip(inverse) {
            let before = *f;
            for r in 0..3 {
                let [a, b, c] = [0, 1, 2].map(|column| s[at(r, column)]);
                for case in 0..6 {
                    f[6 * r + case] = a * before[case] + b * before[6 + case] + c * before[12 + case];
                }
            }
        }
    });
}

/// φ = S⁻¹ Σ K (ε d + φ of the partner).
fn sweep(network: &Network, inverse: &[[f64; 6]], before: &[Six3], phi: &mut [Six3]) {
    par::each(&mut *phi, |_, rows: &mut [Six3]| rows.fill([0.0; 18]));
    network.pairs.gather(phi, |bond, [i, j]| {
        let pull = Pull::new(network, bond);
        let stretches = pull.stretches_by_axis();
        let (low, high) = (&before[j], &before[i]);
        [
            pull.times_all(&std::array::from_fn(|c| low[c] + stretches[c])),
            pull.times_all(&std::array::from_fn(|c| high[c] - stretches[c])),
        ]
    });
    solve(phi, inverse);
}

#[inline(always)]
fn vector(phi: &Six3, case: usize) -> Vec3 {
    [phi[case], phi[6 + case], phi[12 + case]]
}

/// A bond as a spring with normal and tangential stiffness.
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
        Self { d: network.d(bond), n: network.n(bond), across: k.shear, along: k.normal - k.shear }
    }

    /// K u = k_s u + (k_n − k_s) n (n·u).
    #[inline(always)]
    fn times(&self, u: Vec3) -> Vec3 {
        add(scale(self.across, u), scale(self.along * dot(self.n, u), self.n))
    }

    /// K of all six cases.
    #[inline(always)]
    fn times_all(&self, u: &Six3) -> Six3 {
        let [x, y, z] = self.n;
        let mut out = [0.0; 18];
        for case in 0..6 {
            let along = self.along * (x * u[case] + y * u[6 + case] + z * u[12 + case]);
            out[case] = self.across * u[case] + along * x;
            out[6 + case] = self.across * u[6 + case] + along * y;
            out[12 + case] = self.across * u[12 + case] + along * z;
        }
        out
    }

    /// ε d of all six strains.
    #[inline(always)]
    fn stretches(&self) -> [Vec3; 6] {
        let [x, y, z] = self.d;
        let [a, b, c] = self.d.map(|d| 0.5 * d);
        [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z], [0.0, c, b], [c, 0.0, a], [b, a, 0.0]]
    }

    /// The same, ordered all x, all y, all z.
    #[inline(always)]
    fn stretches_by_axis(&self) -> Six3 {
        let stretches = self.stretches();
        std::array::from_fn(|k| stretches[k % 6][k / 6])
    }

    /// ½ d ⊗ K (ε d − φ_low + φ_high) for all six strains, fully symmetric: a particle's half of the bond.
    fn stiffness(&self, low: &Six3, high: &Six3) -> Packed {
        let (mut c, stretches) = ([[0.0; 6]; 6], self.stretches());
        for case in 0..6 {
            let f = self.times(add(stretches[case], sub(vector(high, case), vector(low, case))));
            for (row, (i, j)) in VOIGT.into_iter().enumerate() {
                c[row][case] = 0.25 * (self.d[i] * f[j] + self.d[j] * f[i]);
            }
        }
        let mut out = [0.0; 21];
        for row in 0..6 {
            (0..=row).for_each(|column| out[at(row, column)] = 0.5 * (c[row][column] + c[column][row]));
        }
        out
    }
}

/// Slabs normal to an axis, each with its own tensor, in series.
#[derive(Clone, Debug)]
pub struct Layers {
    /// Stiffness of the whole [force/length].
    pub stiffness: f64,
    /// E A of each slab: its Young's modulus along the axis times ΣV divided by its height [force].
    pub slabs: Vec<f64>,
}

impl Layers {
    /// `count` slabs of equal height between `lo` and `hi` along the axis, for particles at `x` with these
    /// volume fractions and these V C ([`Estimate::local`]).
    pub fn new(
        local: &[Packed],
        x: &[f64],
        volume: &[f64],
        [lo, hi]: [f64; 2],
        count: usize,
        axis: usize,
    ) -> Self {
        let height = (hi - lo) / count as f64;
        let mut sums = vec![(0.0, [0.0; 21]); count];
        for ((x, volume), local) in x.iter().zip(volume).zip(local) {
            let slab = &mut sums[(((x - lo) / height).max(0.0) as usize).min(count - 1)];
            *slab = (slab.0 + volume, add_packed(&slab.1, local));
        }
        let one = |(volume, sum): &(f64, Packed)| {
            if *volume == 0.0 {
                return 0.0;
            }
            let c = full(&sum.map(|a| a / volume));
            super::tensor::Moduli::new(&c).map_or(f64::NAN, |m| m.young[axis] * volume / height)
        };
        let slabs: Vec<f64> = sums.iter().map(one).collect();
        let compliance: f64 = slabs.iter().map(|ea| height / ea).sum();
        Self { stiffness: 1.0 / compliance, slabs }
    }
}
