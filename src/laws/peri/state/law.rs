//! Ordinary state-based laws of one bond, in lanes.
//!
//! With stretch s, dilatation θ, weighted volume m and influence ω an end's force density is t = ω |xi| (3Kθ/m + 15G/m ε),
//! ε being the deviatoric part of the stretch, s − θ/3, without what has relaxed or flowed (Silling et al. 2007;
//! Mitchell 2011). Both ends act along y/|y|; y = xi + eta and |y| = |xi| (1 + s), so that a law returns
//! (t_i + t_j)/(ω |y|).

use super::super::lanes::Lanes;
use crate::world::families::law::COLUMNS;

/// A bond's stretch s in the forms that laws need.
#[derive(Clone, Copy)]
pub struct Stretch<L> {
    /// s; not there where series are used.
    pub s: L,
    /// s/(1 + s).
    pub share: L,
    /// 1/(1 + s).
    pub inverse: L,
}

/// What is the same for all bonds during one evaluation.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moment {
    /// Share of a Maxwell element's stretch that is left after the step.
    pub decay: f64,
    /// Share of this step's stretch that the element still has at its end.
    pub fresh: f64,
    /// Share of the shear modulus that relaxes.
    pub lambda: f64,
    /// 1 if plastic flow happens, 0 if the state only is looked at.
    pub flow: f64,
}

/// What both ends of a bond have in columns.
pub type Ends<L> = [[L; COLUMNS]; 2];

/// A law of bonds with numbers at both ends.
pub trait BondLaw: Sync {
    /// Columns that it reads.
    const COLUMNS: usize;
    /// Numbers that a bond remembers, at most two.
    const MEMORY: usize;
    /// Whether s/(1 + s) is all it needs of the stretch: there are series for that.
    const SERIES: bool = false;
    /// The pull on the first end and on the second, over ω w V; `memory` is brought up to date.
    ///
    /// # Safety
    /// See [`Lanes`].
    unsafe fn pull<L: Lanes>(
        bond: &Stretch<L>,
        omega: L,
        ends: &Ends<L>,
        memory: &mut [L; 2],
        moment: &Moment,
    ) -> (L, L);
}

/// What a sweep adds up at both ends before there are forces.
pub trait Term: Sync {
    /// Columns that it reads.
    const COLUMNS: usize;
    /// Numbers that a bond remembers.
    const MEMORY: usize;
    /// Whether it is the stretch itself, for which there are series.
    const STRETCH: bool;
    /// The terms at both ends, over ω w |xi|² V.
    ///
    /// # Safety
    /// See [`Lanes`].
    unsafe fn terms<L: Lanes>(bond: &Stretch<L>, omega: L, ends: &Ends<L>, memory: &[L; 2]) -> (L, L);
}

/// Linear elastic. Columns: A = (3K − 5G)θ/m, B = 15G/m.
pub struct Elastic;

impl BondLaw for Elastic {
    const COLUMNS: usize = 2;
    const MEMORY: usize = 0;
    const SERIES: bool = true;
    #[inline(always)]
    unsafe fn pull<L: Lanes>(
        bond: &Stretch<L>,
        _: L,
        [own, far]: &Ends<L>,
        _: &mut [L; 2],
        _: &Moment,
    ) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let (a, b) = (own[0].add(far[0]), own[1].add(far[1]));
            let pull = b.sub(a).fma(bond.share, a);
            (pull, pull)
        }
    }
}

/// A Maxwell element beside a spring: the stretch and the element's part of it are remembered. Columns: A = (3Kθ − 5GY)/m
/// with Y = (1 − λ)θ + λ times the unrelaxed dilatation, B = 15G/m.
pub struct Viscous;

/// The effective stretch (1 − λ)s + λD; brings (s, D) up to date.
#[inline(always)]
unsafe fn relaxed<L: Lanes>(s: L, memory: &mut [L; 2], moment: &Moment) -> L {
    // SAFETY: passed on to the caller.
    unsafe {
        let change = s.sub(memory[0]).mul(L::splat(moment.fresh));
        let element = memory[1].fma(L::splat(moment.decay), change);
        *memory = [s, element];
        s.mul(L::splat(1.0 - moment.lambda)).add(element.mul(L::splat(moment.lambda)))
    }
}

impl BondLaw for Viscous {
    const COLUMNS: usize = 2;
    const MEMORY: usize = 2;
    #[inline(always)]
    unsafe fn pull<L: Lanes>(
        bond: &Stretch<L>,
        _: L,
        [own, far]: &Ends<L>,
        memory: &mut [L; 2],
        moment: &Moment,
    ) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let (a, b) = (own[0].add(far[0]), own[1].add(far[1]));
            let pull = b.mul(relaxed(bond.s, memory, moment)).add(a).mul(bond.inverse);
            (pull, pull)
        }
    }
}

/// The same with LAMMPS' forces: each end takes its own dilatation for that of both, so that ends pull unequally.
/// Columns: 3Kθ/m, B, Y/3.
pub struct ViscousLammps;

impl BondLaw for ViscousLammps {
    const COLUMNS: usize = 3;
    const MEMORY: usize = 2;
    #[inline(always)]
    unsafe fn pull<L: Lanes>(
        bond: &Stretch<L>,
        _: L,
        [own, far]: &Ends<L>,
        memory: &mut [L; 2],
        moment: &Moment,
    ) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let (a, b) = (own[0].add(far[0]), own[1].add(far[1]));
            let s = relaxed(bond.s, memory, moment);
            let pull = |third: L| b.mul(s.sub(third)).add(a).mul(bond.inverse);
            (pull(own[2]), pull(far[2]))
        }
    }
}

/// Elastic, perfectly plastic: each end has flowed by its own plastic stretch. Columns: 3Kθ/m, B, θ/3, and the share
/// 1 − σ of the elastic deviatoric stretch that flows, σ being the yield limit over the trial state's norm.
pub struct Plastic;

impl BondLaw for Plastic {
    const COLUMNS: usize = 4;
    const MEMORY: usize = 2;
    #[inline(always)]
    unsafe fn pull<L: Lanes>(
        bond: &Stretch<L>,
        _: L,
        [own, far]: &Ends<L>,
        memory: &mut [L; 2],
        moment: &Moment,
    ) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let flow = L::splat(moment.flow);
            let mut pull = own[0].add(far[0]);
            let mut end = 0;
            while end < 2 {
                let this = if end == 0 { own } else { far };
                let trial = bond.s.sub(this[2]);
                memory[end] = this[3].mul(flow).fma(trial.sub(memory[end]), memory[end]);
                pull = this[1].fma(trial.sub(memory[end]), pull);
                end += 1;
            }
            let pull = pull.mul(bond.inverse);
            (pull, pull)
        }
    }
}

/// LAMMPS' forces and its flow, which forgets the plastic stretch of what is elastic again. Columns: 3Kθ/m, B, θ/3, the
/// scale σ of the trial state, and the step of the plastic multiplier (0 where elastic).
pub struct PlasticLammps;

impl BondLaw for PlasticLammps {
    const COLUMNS: usize = 5;
    const MEMORY: usize = 2;
    #[inline(always)]
    unsafe fn pull<L: Lanes>(
        bond: &Stretch<L>,
        omega: L,
        [own, far]: &Ends<L>,
        memory: &mut [L; 2],
        moment: &Moment,
    ) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let flow = L::splat(moment.flow);
            let (a, b) = (own[0].add(far[0]), own[1].add(far[1]));
            let mut pulls = [a, a];
            let mut end = 0;
            while end < 2 {
                let this = if end == 0 { own } else { far };
                let part = b.mul(bond.s.sub(this[2]).sub(memory[end])).mul(this[3]);
                pulls[end] = a.add(part).mul(bond.inverse);
                let elastic = this[3].ge(L::splat(1.0));
                let flowed = omega.mul(part).mul(this[4]).add(memory[end]);
                let flowed = flowed.sub(flowed.keep(elastic));
                memory[end] = flowed.sub(memory[end]).fma(flow, memory[end]);
                end += 1;
            }
            (pulls[0], pulls[1])
        }
    }
}

/// A microelastic bond that flows where its elastic stretch is below a limit, which stands in the place of ω; what has
/// flowed is remembered (Walayat et al. 2023, Eq. 6).
pub struct Yielding;

impl BondLaw for Yielding {
    const COLUMNS: usize = 0;
    const MEMORY: usize = 1;
    #[inline(always)]
    unsafe fn pull<L: Lanes>(
        bond: &Stretch<L>,
        limit: L,
        _: &Ends<L>,
        memory: &mut [L; 2],
        moment: &Moment,
    ) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let excess = bond.s.sub(memory[0]).sub(limit).min(L::splat(0.0));
            memory[0] = excess.fma(L::splat(moment.flow), memory[0]);
            let pull = bond.s.sub(memory[0]).mul(bond.inverse);
            (pull, pull)
        }
    }
}

/// The same equation taken literally, as a function of the stretch.
pub struct Flattened;

impl BondLaw for Flattened {
    const COLUMNS: usize = 0;
    const MEMORY: usize = 0;
    #[inline(always)]
    unsafe fn pull<L: Lanes>(bond: &Stretch<L>, limit: L, _: &Ends<L>, _: &mut [L; 2], _: &Moment) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let pull = bond.s.max(limit).mul(bond.inverse);
            (pull, pull)
        }
    }
}

/// The dilatation: Σ ω w |xi|² s V = mθ/3.
pub struct Dilatation;

impl Term for Dilatation {
    const COLUMNS: usize = 0;
    const MEMORY: usize = 0;
    const STRETCH: bool = true;
    #[inline(always)]
    unsafe fn terms<L: Lanes>(bond: &Stretch<L>, _: L, _: &Ends<L>, _: &[L; 2]) -> (L, L) {
        (bond.s, bond.s)
    }
}

/// The squared norm of the trial state over (15G/m)²: Σ ω² w |xi|² (s − θ/3 − e_p)² V. Columns as [`Plastic`].
pub struct Norm;

impl Term for Norm {
    const COLUMNS: usize = 3;
    const MEMORY: usize = 2;
    const STRETCH: bool = false;
    #[inline(always)]
    unsafe fn terms<L: Lanes>(bond: &Stretch<L>, omega: L, [own, far]: &Ends<L>, memory: &[L; 2]) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let (a, b) = (bond.s.sub(own[2]).sub(memory[0]), bond.s.sub(far[2]).sub(memory[1]));
            (a.mul(a).mul(omega), b.mul(b).mul(omega))
        }
    }
}

/// What LAMMPS takes for the norm, over (15G)²: with (θ_i/m_i + θ_j/m_j) in place of 1/m. Column 0 is θ/m here.
pub struct NormLammps;

impl Term for NormLammps {
    const COLUMNS: usize = 3;
    const MEMORY: usize = 2;
    const STRETCH: bool = false;
    #[inline(always)]
    unsafe fn terms<L: Lanes>(bond: &Stretch<L>, omega: L, [own, far]: &Ends<L>, memory: &[L; 2]) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let both = own[0].add(far[0]);
            let (a, b) = (bond.s.sub(own[2]).sub(memory[0]), bond.s.sub(far[2]).sub(memory[1]));
            let (a, b) = (a.mul(both), b.mul(both));
            (a.mul(a).mul(omega), b.mul(b).mul(omega))
        }
    }
}

/// The stretch from z = |y|²/|xi|² − 1, its closed form.
///
/// # Safety
/// See [`Lanes`].
#[inline(always)]
pub unsafe fn closed<L: Lanes>(z: L) -> Stretch<L> {
    // SAFETY: passed on to the caller.
    unsafe {
        let one = L::splat(1.0);
        let root = one.add(z).sqrt();
        let more = one.add(root);
        let inverse = one.div(root.mul(more));
        Stretch { s: z.mul(root).mul(inverse), share: z.mul(inverse), inverse: more.mul(inverse) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::single::Single;
    use super::*;

    fn bond(s: f64) -> Stretch<Single> {
        // SAFETY: plain arithmetic.
        unsafe { closed(Single(s * (2.0 + s))) }
    }

    fn end(values: [f64; COLUMNS]) -> [Single; COLUMNS] {
        values.map(Single)
    }

    const NOW: Moment = Moment { decay: 0.8, fresh: 0.9, lambda: 0.4, flow: 1.0 };

    #[test]
    fn forms_of_the_stretch() {
        for s in [-0.4, -1e-9, 0.0, 1e-5, 0.3, 2.0] {
            let b = bond(s);
            let near = |a: f64, b: f64| (a - b).abs() <= 4e-16 * (1.0 + b.abs());
            assert!(near(b.s.0, s) && near(b.share.0, s / (1.0 + s)) && near(b.inverse.0, 1.0 / (1.0 + s)));
        }
    }

    #[test]
    fn laws_agree_where_nothing_relaxes_or_flows() {
        // 3K = 7, 15G/m = 3 and 2, theta/3 = 0.01 and -0.02 with m = 1: A = 3K theta/m - B theta/3.
        let (k, g, third) = (7.0, [3.0, 2.0], [0.01, -0.02]);
        let a = [0, 1].map(|i| k * 3.0 * third[i]);
        let b = bond(0.05);
        let lps = [0, 1].map(|i| end([a[i] - g[i] * third[i], g[i], 0.0, 0.0, 0.0]));
        let eps = [0, 1].map(|i| end([a[i], g[i], third[i], 0.0, 0.0]));
        let mut none = [Single(0.0); 2];
        // SAFETY: plain arithmetic.
        unsafe {
            let one = Single(1.0);
            let (x, y) = Elastic::pull(&b, one, &lps, &mut none, &NOW);
            let (p, _) = Plastic::pull(&b, one, &eps, &mut none, &NOW);
            let mut memory = [Single(0.0); 2];
            let still = Moment { lambda: 0.0, ..NOW };
            let (v, _) = Viscous::pull(&b, one, &lps, &mut memory, &still);
            assert!(x.0 == y.0 && (x.0 - p.0).abs() < 1e-15 && (x.0 - v.0).abs() < 1e-15);
        }
    }

    #[test]
    fn a_maxwell_element_relaxes_to_the_spring() {
        let ends = [end([0.0, 1.0, 0.0, 0.0, 0.0]); 2];
        let mut memory = [Single(0.0); 2];
        let b = bond(0.1);
        let mut pulls = vec![];
        for _ in 0..200 {
            // SAFETY: plain arithmetic.
            pulls.push(unsafe { Viscous::pull(&b, Single(1.0), &ends, &mut memory, &NOW) }.0.0 * 1.1 / 2.0);
        }
        // First 0.6 s + 0.4 * 0.9 s, at last 0.6 s.
        assert!((pulls[0] - 0.096).abs() < 1e-15 && (pulls[199] - 0.06).abs() < 1e-15);
        let kept = memory;
        let look = Moment { decay: 1.0, fresh: 1.0, ..NOW };
        // SAFETY: plain arithmetic.
        unsafe { Viscous::pull(&b, Single(1.0), &ends, &mut memory, &look) };
        assert_eq!(kept.map(|m| m.0), memory.map(|m| m.0));
    }

    #[test]
    fn a_cycle_of_a_bond_that_yields() {
        // Walayat et al. 2023, Eq. 6: a plateau in compression; after unloading the bond is left shorter.
        let (limit, ends) = (Single(-0.02), [end([0.0; COLUMNS]); 2]);
        let mut memory = [Single(0.0); 2];
        for (s, plastic, flat) in [
            (0.01, 0.01, 0.01),
            (-0.01, -0.01, -0.01),
            (-0.05, -0.02, -0.02),
            (-0.03, 0.0, -0.02),
            (0.0, 0.03, 0.0),
        ] {
            // SAFETY: plain arithmetic.
            unsafe {
                let (p, _) = Yielding::pull(&bond(s), limit, &ends, &mut memory, &NOW);
                let (f, _) = Flattened::pull(&bond(s), limit, &ends, &mut [Single(0.0); 2], &NOW);
                assert!(
                    (p.0 * (1.0 + s) - plastic).abs() < 1e-16 && (f.0 * (1.0 + s) - flat).abs() < 1e-16,
                    "{s}"
                );
            }
        }
    }

    #[test]
    fn flow_returns_to_the_limit_and_stays() {
        // Trial 0.1, limit 0.04: 60 % flow.
        let ends = [end([0.0, 1.0, 0.0, 0.6, 0.0]); 2];
        let mut memory = [Single(0.0); 2];
        // SAFETY: plain arithmetic.
        unsafe {
            let (p, _) = Plastic::pull(&bond(0.1), Single(1.0), &ends, &mut memory, &NOW);
            assert!((p.0 * 1.1 - 0.08).abs() < 1e-15 && (memory[0].0 - 0.06).abs() < 1e-15);
            let look = Moment { flow: 0.0, ..NOW };
            let (q, _) = Plastic::pull(&bond(0.1), Single(1.0), &ends, &mut memory, &look);
            assert_eq!(p.0, q.0);
        }
    }
}
