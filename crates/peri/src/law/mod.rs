//! Laws of one bond in lanes: bond-based and ordinary state-based.
//!
//! With stretch s, dilatation θ, weighted volume m and influence ω an end's force density is t = ω |xi| (3Kθ/m + 15G/m ε),
//! ε being the deviatoric part of the stretch, s − θ/3, without what has relaxed or flowed (Silling et al. 2007;
//! Mitchell 2011). Both ends act along y/|y|; y = xi + eta and |y| = |xi| (1 + s), so that a law returns
//! (t_i + t_j)/(ω |y|).

pub mod freed;
pub mod polynomials;
pub mod series;
pub mod settle;
mod softening;
pub mod terms;
mod viscous;
pub mod weighing;

use crate::families::law::{COLUMNS, Held};
use crate::lanes::Lanes;
pub use softening::{REST, Softening, last_of_area};
pub use viscous::{Viscous, ViscousApart};

/// A bond's stretch s in the forms that laws need.
#[derive(Clone, Copy)]
pub struct Stretch<L> {
    /// s.
    pub s: L,
    /// s/(1 + s).
    pub share: L,
    /// 1/(1 + s).
    pub inverse: L,
    /// s at the last step that advanced; only for laws that look [`BondLaw::BACK`].
    pub before: L,
    /// The pair's critical stretch; only for laws that are [`BondLaw::LIMITED`].
    pub limit: L,
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
    /// The form in which viscous bonds have remembered.
    pub held: Held,
    /// The form in which they shall.
    pub hold: Held,
    /// Energies asked for are those that damage has taken.
    pub lost: bool,
    /// Flow under LAMMPS' laws is that of 2026.
    pub mended: bool,
}

impl Moment {
    /// Whether viscous bonds remember what this step needs and need not look back.
    pub fn steady(&self) -> bool {
        self.held == Held { decay: self.decay, fresh: self.fresh }
    }
}

/// Puts the law of a kind, with LAMMPS' numbers or without, in the place of a type; with a moment the form of the law that
/// is enough for it.
macro_rules! of_law {
    ($kind:expr, $compat:expr, $moment:expr, $W:ident => $e:expr) => {{
        use crate::law::{Viscous, of_law};
        use crate::families::LawKind;
        match ($kind, $compat) {
            (LawKind::Ves, false) if $moment.steady() => {
                type $W = Viscous<false>;
                $e
            }
            (LawKind::Ves, true) if $moment.steady() => {
                type $W = Viscous<false, true>;
                $e
            }
            (kind, compat) => of_law!(kind, compat, $W => $e),
        }
    }};
    ($kind:expr, $compat:expr, $W:ident => $e:expr) => {{
        use crate::law;
        use crate::families::LawKind;
        macro_rules! with {
            ($law:ty) => {{
                type $W = $law;
                $e
            }};
        }
        match ($kind, $compat) {
            (LawKind::Pmb, _) => with!(law::Pmb),
            (LawKind::Lps | LawKind::Shaped, _) => with!(law::Elastic),
            (LawKind::Yield, _) => with!(law::Yielding),
            (LawKind::NonlinearElastic, _) => with!(law::Flattened),
            (LawKind::Ves, false) => with!(law::Viscous),
            (LawKind::Ves, true) => with!(law::Viscous<true, true>),
            (LawKind::VesApart, false) => with!(law::ViscousApart),
            (LawKind::VesApart, true) => with!(law::ViscousApart<true>),
            (LawKind::Softening, _) => with!(law::Softening<false>),
            (LawKind::Decaying, _) => with!(law::Softening<true>),
            (LawKind::ElasticPlastic, false) => with!(law::Plastic),
            (LawKind::ElasticPlastic, true) => with!(law::PlasticLammps),
        }
    }};
}
pub(crate) use of_law;

/// What both ends of a bond have in columns.
pub type Ends<L> = [[L; COLUMNS]; 2];

/// A law of bonds with numbers at both ends.
pub trait BondLaw: Sync {
    /// Columns that it reads.
    const COLUMNS: usize;
    /// Numbers that a bond remembers, at most two.
    const MEMORY: usize;
    /// Whether forces need s itself, not only s/(1 + s) and 1/(1 + s).
    const STRETCHED: bool = true;
    /// Whether a pull is s/(1 + s) and nothing else: lattices then have the weight of a bond in its series.
    const PLAIN: bool = false;
    /// Whether energies depend on dilatations.
    const DILATED: bool = true;
    /// Whether it needs the stretch at the last step that advanced.
    const BACK: bool = false;
    /// Whether it is worth kernels for each size of stretches and for whole chunks: each law has a share of the time that
    /// this crate takes to compile.
    const ALL_FORMS: bool = true;
    /// Whether it needs the critical stretch of the pair.
    const LIMITED: bool = false;
    /// Whether what a bond remembers stays zero until one of its ends [`BondLaw::flows`].
    const LAZY: bool = false;
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
    /// The squares of both ends' elastic deviatoric stretch that the energy has, over ½ 15G/m ω w |xi|² V of each end;
    /// of bond-based laws over ½ c w |xi| V. `memory` is what the bond remembers: what has flowed, unless a law says otherwise.
    ///
    /// # Safety
    /// See [`Lanes`].
    #[inline(always)]
    unsafe fn squares<L: Lanes>(
        bond: &Stretch<L>,
        _limit: L,
        ends: &[Angles<L>; 2],
        memory: &[L; 2],
        _moment: &Moment,
    ) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe { deviatoric(bond.s, ends, memory) }
    }
    /// Share of an end's shear modulus that relaxes.
    ///
    /// # Safety
    /// See [`Lanes`].
    #[inline(always)]
    unsafe fn relaxing<L: Lanes>(_end: &[L; COLUMNS], moment: &Moment) -> L {
        // SAFETY: passed on to the caller.
        unsafe { L::splat(moment.lambda) }
    }
    /// Where an end flows in this evaluation, a mask.
    ///
    /// # Safety
    /// See [`Lanes`].
    #[inline(always)]
    unsafe fn flows<L: Lanes>(_: &Ends<L>) -> L {
        // SAFETY: passed on to the caller.
        unsafe { L::splat(0.0).ge(L::splat(0.0)) }
    }
}

/// The dilatation of a bond's end, and what of it is not yet relaxed.
#[derive(Clone, Copy)]
pub struct Angles<L> {
    /// θ.
    pub now: L,
    /// Its unrelaxed part; what has come since the last step that advanced is not relaxed at all.
    pub unrelaxed: L,
    /// Share of its shear modulus that relaxes.
    pub relaxing: L,
}

impl<L: Lanes> Angles<L> {
    /// No dilatation.
    ///
    /// # Safety
    /// See [`Lanes`].
    #[inline(always)]
    pub unsafe fn none() -> Self {
        // SAFETY: passed on to the caller.
        let zero = unsafe { L::splat(0.0) };
        Self { now: zero, unrelaxed: zero, relaxing: zero }
    }
}

/// (s − θ/3)² of both ends.
#[inline(always)]
unsafe fn deviatoric<L: Lanes>(s: L, ends: &[Angles<L>; 2], without: &[L; 2]) -> (L, L) {
    // SAFETY: passed on to the caller.
    unsafe {
        let third = L::splat(1.0 / 3.0);
        let (a, b) = (ends[0].now.fnma(third, s), ends[1].now.fnma(third, s));
        let (a, b) = (a.sub(without[0]), b.sub(without[1]));
        (a.mul(a), b.mul(b))
    }
}

/// Prototype microelastic: half of c w s V at each end.
pub struct Pmb;

impl BondLaw for Pmb {
    const COLUMNS: usize = 0;
    const MEMORY: usize = 0;
    const PLAIN: bool = true;
    const DILATED: bool = false;
    const STRETCHED: bool = false;
    #[inline(always)]
    unsafe fn pull<L: Lanes>(bond: &Stretch<L>, _: L, _: &Ends<L>, _: &mut [L; 2], _: &Moment) -> (L, L) {
        (bond.share, bond.share)
    }
    #[inline(always)]
    unsafe fn squares<L: Lanes>(
        bond: &Stretch<L>,
        _: L,
        _: &[Angles<L>; 2],
        _: &[L; 2],
        _: &Moment,
    ) -> (L, L) {
        // SAFETY: passed on to the caller.
        let square = unsafe { bond.s.mul(bond.s) };
        (square, square)
    }
}

/// Linear elastic. Columns: A = (3K − 5G)θ/m, B = 15G/m; of microelastic bonds A = 0 and B = ½ or more near a surface.
pub struct Elastic;

impl BondLaw for Elastic {
    const COLUMNS: usize = 2;
    const MEMORY: usize = 0;
    const STRETCHED: bool = false;
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

/// Elastic, perfectly plastic: each end has flowed by its own plastic stretch. Columns: 3Kθ/m, B, θ/3, and the share
/// 1 − σ of the elastic deviatoric stretch that flows, σ being the yield limit over the trial state's norm.
pub struct Plastic;

impl BondLaw for Plastic {
    const COLUMNS: usize = 4;
    const MEMORY: usize = 2;
    const LAZY: bool = true;
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
    #[inline(always)]
    unsafe fn flows<L: Lanes>([own, far]: &Ends<L>) -> L {
        // SAFETY: passed on to the caller.
        unsafe { own[3].max(far[3]).ge(L::splat(f64::MIN_POSITIVE)) }
    }
}

/// LAMMPS' forces and its flow, which forgets the plastic stretch of what is elastic again. Columns: 3Kθ/m, B, θ/3, the
/// scale σ of the trial state, and the step of the plastic multiplier (0 where elastic). A bond flows by the multiplier
/// times ω times its deviatoric pull, in 2026 by half of their product without ω: (1 + m_i/m_j)/2 of what would return it to
/// the yield surface.
pub struct PlasticLammps;

impl BondLaw for PlasticLammps {
    const COLUMNS: usize = 5;
    const MEMORY: usize = 2;
    const LAZY: bool = true;
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
            let gain = if moment.mended { L::splat(0.5) } else { omega };
            let (a, b) = (own[0].add(far[0]), own[1].add(far[1]));
            let mut pulls = [a, a];
            let mut end = 0;
            while end < 2 {
                let this = if end == 0 { own } else { far };
                let part = b.mul(bond.s.sub(this[2]).sub(memory[end])).mul(this[3]);
                pulls[end] = a.add(part).mul(bond.inverse);
                let elastic = this[3].ge(L::splat(1.0));
                let flowed = gain.mul(part).mul(this[4]).add(memory[end]);
                let flowed = flowed.sub(flowed.keep(elastic));
                memory[end] = flowed.sub(memory[end]).fma(flow, memory[end]);
                end += 1;
            }
            (pulls[0], pulls[1])
        }
    }
    #[inline(always)]
    unsafe fn flows<L: Lanes>([own, far]: &Ends<L>) -> L {
        // SAFETY: passed on to the caller.
        unsafe { own[4].max(far[4]).ge(L::splat(f64::MIN_POSITIVE)) }
    }
}

/// A microelastic bond that flows where its elastic stretch is below a limit, which stands in the place of ω; what has
/// flowed is remembered (Walayat et al. 2023, Eq. 6).
pub struct Yielding;

impl BondLaw for Yielding {
    const COLUMNS: usize = 0;
    const MEMORY: usize = 1;
    const DILATED: bool = false;
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
    #[inline(always)]
    unsafe fn squares<L: Lanes>(
        bond: &Stretch<L>,
        _: L,
        _: &[Angles<L>; 2],
        memory: &[L; 2],
        _: &Moment,
    ) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let elastic = bond.s.sub(memory[0]);
            (elastic.mul(elastic), elastic.mul(elastic))
        }
    }
}

/// The same equation taken literally, as a function of the stretch.
pub struct Flattened;

impl BondLaw for Flattened {
    const COLUMNS: usize = 0;
    const MEMORY: usize = 0;
    const DILATED: bool = false;
    const ALL_FORMS: bool = false;
    #[inline(always)]
    unsafe fn pull<L: Lanes>(bond: &Stretch<L>, limit: L, _: &Ends<L>, _: &mut [L; 2], _: &Moment) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let pull = bond.s.max(limit).mul(bond.inverse);
            (pull, pull)
        }
    }
    #[inline(always)]
    unsafe fn squares<L: Lanes>(
        bond: &Stretch<L>,
        limit: L,
        _: &[Angles<L>; 2],
        _: &[L; 2],
        _: &Moment,
    ) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            // s² down to the limit l, then the tangent there: l (2s − l).
            let held = bond.s.max(limit);
            let square = held.mul(bond.s.add(bond.s).sub(held));
            (square, square)
        }
    }
}

/// The stretch from z = |y|²/|xi|² − 1, its closed form, `before` as now.
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
        let s = z.mul(root).mul(inverse);
        Stretch { s, share: z.mul(inverse), inverse: more.mul(inverse), before: s, limit: s }
    }
}

#[cfg(test)]
mod tests;
