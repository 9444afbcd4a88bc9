//! Weights of single bonds: of families with horizons of their own, and of families that are made whole in each direction.
//!
//! A particle at a surface lacks bonds, unlike many in unlike directions, and so does one between irregular neighbours. Of a whole
//! family Σ q n⊗n⊗n⊗n is the isotropic tensor, q being what a bond adds to its weight (`Law::weight`) and n its direction: then
//! any even strain has the energy that the material's moduli give it, and state-based families have the right dilatation.
//! The factors on q that make it so and differ least from 1 are a polynomial of n of degree four (least squares, as the weights
//! of Trask, You, Yu and Parks, Comput. Methods Appl. Mech. Eng. 343 (2019) 151, which integrate a whole ball; here it stands for
//! families at surfaces, too), times what keeps Σ q, the energy of an even growth, exact. A bond has the mean of what its ends ask for.

use crate::families::bond_weights::{Factors, Weighed};
use crate::families::list::{GROUP, ListBody};
use crate::families::{FamilyOptions, Law, PeriView};
use perigrain_base::math::vec3::{length, scale};
use perigrain_base::par::{self, Shared};

/// Moments of degree four in three directions.
const MOMENTS: usize = 15;
type Moments = [f64; MOMENTS];

/// What is asked for less where a family has hardly a bond in some direction, as a share of a whole one: of pulled bars of 6 to 10
/// particles across it left the least error under both laws (of 0.01, 0.02, 0.05, 0.1).
const RIDGE: f64 = 0.02;
/// Factors are no smaller and no larger.
const FACTORS: [f64; 2] = [0.2, 5.0];

/// Exponents of x, y, z.
const fn exponents() -> [[u32; 3]; MOMENTS] {
    let (mut all, mut k) = ([[0; 3]; MOMENTS], 0);
    let mut a = 0;
    while a <= 4 {
        let mut b = 0;
        while a + b <= 4 {
            all[k] = [a, b, 4 - a - b];
            k += 1;
            b += 1;
        }
        a += 1;
    }
    all
}
const EXPONENTS: [[u32; 3]; MOMENTS] = exponents();

/// The mean of x^a y^b z^c over the directions of space: (a − 1)!! (b − 1)!! (c − 1)!!/(a + b + c + 1)!!, or 0 where one is odd.
fn mean_over_directions(of: [u32; 3]) -> f64 {
    let odd = |n: u32| (1..=n).step_by(2).map(f64::from).product::<f64>();
    match of.iter().any(|n| n % 2 == 1) {
        true => 0.0,
        false => {
            of.iter().map(|n| odd(n.saturating_sub(1))).product::<f64>() / odd(of.iter().sum::<u32>() + 1)
        }
    }
}

/// The monomials of a direction.
fn monomials(n: [f64; 3]) -> Moments {
    let powers = n.map(|a| [1.0, a, a * a, a * a * a, a * a * a * a]);
    EXPONENTS.map(|e| (0..3).map(|k| powers[k][e[k] as usize]).product())
}

/// What an end needs of its bonds: factors `scale` (1 + Σ `by` φ) over the monomials φ of their directions.
#[derive(Clone, Copy)]
struct Asked {
    scale: f64,
    by: Moments,
}

impl Asked {
    const NOTHING: Self = Self { scale: 1.0, by: [0.0; MOMENTS] };

    fn of(&self, monomials: &Moments) -> f64 {
        self.scale * (1.0 + self.by.iter().zip(monomials).map(|(a, n)| a * n).sum::<f64>())
    }
}

/// What a list is weighed with.
struct Weighing<'a> {
    body: &'a ListBody,
    view: &'a PeriView<'a>,
    law: &'a Law,
    options: &'a FamilyOptions,
    /// Spacings of particles over that of the lattice, or nothing.
    spacing: &'a [f64],
}

/// Gives the bonds of a list their own weights.
pub fn weigh(
    body: &mut ListBody,
    view: &PeriView,
    (law, options): (&Law, &FamilyOptions),
    spacing: &[f64],
) -> Weighed {
    let w = Weighing { body, view, law, options, spacing };
    let mut own = vec![0.0; body.partner.len()];
    par::each(&mut own[..], |start, own| {
        own.iter_mut().enumerate().for_each(|(k, own)| *own = w.plain(start + k));
    });
    let [bonds, in_part, sum] =
        (0..own.len()).filter(|b| body.lives(*b)).fold([0.0; 3], |[n, part, sum], b| {
            let by_volume = w.by_volume(b);
            [n + 1.0, part + f64::from(u8::from(by_volume < 1.0)), sum + by_volume]
        });
    let corrected = options.weights.whole_families || options.weights.whole_energies;
    let factors = corrected.then(|| w.made_whole(&mut own));
    body.own_weight = own;
    Weighed { in_part: in_part / f64::max(bonds, 1.0), mean: sum / f64::max(bonds, 1.0), factors }
}

impl Weighing<'_> {
    fn ends(&self, b: usize) -> [usize; 2] {
        [self.body.owner[b / GROUP], self.body.partner[b]].map(|r| r as usize)
    }

    fn xi(&self, [i, j]: [usize; 2]) -> [f64; 3] {
        let [a, b] = [i, j].map(|r| self.body.record[r].reference);
        self.view.bounds.nearest(std::array::from_fn(|k| b[k] - a[k]))
    }

    /// The weight of a bond by partial volumes; with horizons of their own the mean of what it is in the families of both ends,
    /// of which it may be in one alone (dual horizons: Ren, Zhuang, Cai and Rabczuk, Int. J. Numer. Methods Eng. 108 (2016) 1451):
    /// of the micro-modulus, or of ω over the weighted volume of a whole ball, lest the longer horizon rules in both.
    fn plain(&self, b: usize) -> f64 {
        let (ends, pair) = (self.ends(b), self.body.constants(b));
        if ends[0] == ends[1] {
            return 0.0;
        }
        let length = length(self.xi(ends));
        let shape = |delta: f64| match self.law.kind.bond_based {
            true => self.law.shape().shape(length, delta) / delta.powi(4),
            false => self.law.influence.of(length, delta) / self.law.influence.whole(delta),
        };
        let half = |by: f64| match self.part(by, length, pair.horizon) {
            Some(part) if by != 1.0 => 0.5 * part * shape(by * pair.horizon) / shape(pair.horizon),
            part => 0.5 * part.unwrap_or(0.0),
        };
        half(self.by(ends[0])) + half(self.by(ends[1]))
    }

    /// The spacing of a record over that of the lattice.
    fn by(&self, record: usize) -> f64 {
        self.spacing.get(self.body.particle[record] as usize).copied().unwrap_or(1.0)
    }

    /// The weight by partial volumes of a bond in the family of an end of this spacing, if it is in it.
    fn part(&self, by: f64, length: f64, horizon: f64) -> Option<f64> {
        let (delta, dx, rule) = (by * horizon, by * self.options.lattice_spacing, self.options.volume);
        // Of a single horizon all bonds are within it, be it by rounding.
        let within = self.spacing.is_empty() || length <= rule.reach(delta, dx);
        within.then(|| rule.weight(length, delta, dx))
    }

    /// The mean weight of a bond by partial volumes in the families that it is in.
    fn by_volume(&self, b: usize) -> f64 {
        let (ends, horizon) = (self.ends(b), self.body.constants(b).horizon);
        let length = length(self.xi(ends));
        let both = ends.map(|end| self.part(self.by(end), length, horizon));
        both.iter().flatten().sum::<f64>() / both.iter().flatten().count().max(1) as f64
    }

    /// Multiplies weights by what makes families whole.
    fn made_whole(&self, own: &mut [f64]) -> Factors {
        let n = self.body.record.len();
        let mut asked = vec![Asked::NOTHING; n];
        let plain = &*own;
        let column = Shared::new(&mut asked);
        par::for_chunks(n, |range| {
            for i in range {
                // SAFETY: each record is one task's.
                unsafe { column.get(i..i + 1)[0] = self.asked(i, plain) };
            }
        });
        let factor = |b: usize| {
            let ends = self.ends(b);
            let n = monomials(unit(self.xi(ends)));
            0.5 * (asked[ends[0]].of(&n) + asked[ends[1]].of(&n))
        };
        let mut all = vec![0.0; own.len()];
        par::each(&mut all[..], |start, all| {
            for (k, all) in all.iter_mut().enumerate().filter(|(k, _)| self.body.lives(start + k)) {
                *all = factor(start + k);
            }
        });
        let mut factors = Factors { least: f64::INFINITY, ..Factors::default() };
        let mut count = 0.0;
        for (b, own) in own.iter_mut().enumerate().filter(|(b, _)| self.body.lives(*b)) {
            // A sum over a family has no small divisor.
            let factor = match self.options.weights.whole_families {
                true => all[b].clamp(FACTORS[0], FACTORS[1]),
                false => all[b],
            };
            *own *= factor;
            count += 1.0;
            factors.cut += f64::from(u8::from(factor != all[b]));
            factors.mean += factor;
            (factors.least, factors.most) = (factors.least.min(factor), factors.most.max(factor));
        }
        if count > 0.0 {
            factors.mean /= count;
            factors.cut /= count;
        }
        factors
    }

    /// The factors that make a family whole.
    fn asked(&self, i: usize, plain: &[f64]) -> Asked {
        let (mut squares, mut sums, mut all) = ([[0.0; MOMENTS]; MOMENTS], [0.0; MOMENTS], 0.0);
        self.body.around(i, |j, b| {
            let (xi, pair) = (self.xi([i, j]), self.body.constants(b));
            let length = length(xi);
            let q = self.law.weight(length, pair.horizon, plain[b]) * self.body.record[j].volume;
            // Of microelastic bonds a whole family's sum is known; a state-based one is weighed by its own.
            let q = match self.law.kind.bond_based {
                true => q / (std::f64::consts::PI * pair.horizon.powi(4)),
                false => q,
            };
            let n = monomials(unit(xi));
            all += q;
            for k in 0..MOMENTS {
                sums[k] += q * n[k];
                (0..=k).for_each(|m| squares[k][m] += q * n[k] * n[m]);
            }
        });
        let whole = if self.law.kind.bond_based { 1.0 } else { all };
        if all <= 0.0 {
            return Asked::NOTHING;
        }
        if !self.options.weights.whole_families {
            // The same factor in all directions.
            return Asked { scale: whole / all, ..Asked::NOTHING };
        }
        let mut lacking = [0.0; MOMENTS];
        for k in 0..MOMENTS {
            lacking[k] = whole * mean_over_directions(EXPONENTS[k]) - sums[k];
            for m in 0..=k {
                let both = std::array::from_fn(|d| EXPONENTS[k][d] + EXPONENTS[m][d]);
                squares[k][m] += RIDGE * whole * mean_over_directions(both);
            }
        }
        let by = solved(squares, lacking);
        let sum = all + by.iter().zip(&sums).map(|(a, s)| a * s).sum::<f64>();
        Asked { scale: if sum > 0.0 { whole / sum } else { 1.0 }, by }
    }
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    scale(1.0 / length(v), v)
}

/// The solution of a symmetric, positive definite system of which the lower half is given (Cholesky).
fn solved(mut a: [Moments; MOMENTS], mut b: Moments) -> Moments {
    for k in 0..MOMENTS {
        for m in 0..=k {
            let rest = (0..m).map(|l| a[k][l] * a[m][l]).sum::<f64>();
            a[k][m] = match m == k {
                true => (a[k][k] - rest).sqrt(),
                false => (a[k][m] - rest) / a[m][m],
            };
        }
        b[k] = (b[k] - (0..k).map(|l| a[k][l] * b[l]).sum::<f64>()) / a[k][k];
    }
    for k in (0..MOMENTS).rev() {
        b[k] = (b[k] - (k + 1..MOMENTS).map(|l| a[l][k] * b[l]).sum::<f64>()) / a[k][k];
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_over_directions() {
        // Closed forms.
        for (of, mean) in
            [([4, 0, 0], 0.2), ([2, 2, 0], 1.0 / 15.0), ([8, 0, 0], 1.0 / 9.0), ([4, 2, 2], 1.0 / 315.0)]
        {
            assert!((mean_over_directions(of) / mean - 1.0).abs() < 1e-15, "{of:?}");
        }
        assert_eq!(mean_over_directions([3, 1, 0]), 0.0);
    }

    #[test]
    fn systems_are_solved() {
        let a: [Moments; MOMENTS] = std::array::from_fn(|k| {
            std::array::from_fn(|m| if k == m { 20.0 } else { 1.0 / (1 + k + m) as f64 })
        });
        let x: Moments = std::array::from_fn(|k| k as f64 - 3.0);
        let b = std::array::from_fn(|k| (0..MOMENTS).map(|m| a[k][m] * x[m]).sum());
        let found = solved(a, b);
        assert!(found.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    }
}
