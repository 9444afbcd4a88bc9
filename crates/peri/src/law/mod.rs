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
use perigrain_base::math::real::Real;
pub use softening::{REST, Softening, last_of_area};
pub use viscous::{Viscous, ViscousApart};

/// A bond's stretch s in the forms that laws need.
#[derive(Clone, Copy)]
pub struct Stretch<R> {
    /// s.
    pub s: R,
    /// s/(1 + s).
    pub share: R,
    /// 1/(1 + s).
    pub inverse: R,
    /// s at the last step that advanced; only for laws that look [`BondLaw::BACK`].
    pub before: R,
    /// The pair's critical stretch; only for laws that are [`BondLaw::LIMITED`].
    pub limit: R,
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
pub type Ends<R> = [[R; COLUMNS]; 2];

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
    fn pull<R: Real>(
        bond: &Stretch<R>,
        omega: R,
        ends: &Ends<R>,
        memory: &mut [R; 2],
        moment: &Moment,
    ) -> (R, R);
    /// The squares of both ends' elastic deviatoric stretch that the energy has, over ½ 15G/m ω w |xi|² V of each end;
    /// of bond-based laws over ½ c w |xi| V. `memory` is what the bond remembers: what has flowed, unless a law says otherwise.
    #[inline(always)]
    fn squares<R: Real>(
        bond: &Stretch<R>,
        _limit: R,
        ends: &[Angles<R>; 2],
        memory: &[R; 2],
        _moment: &Moment,
    ) -> (R, R) {
        deviatoric(bond.s, ends, memory)
    }
    /// Share of an end's shear modulus that relaxes.
    #[inline(always)]
    fn relaxing<R: Real>(end: &[R; COLUMNS], moment: &Moment) -> R {
        end[0].like(moment.lambda)
    }
    /// Where an end flows in this evaluation.
    #[inline(always)]
    fn flows<R: Real>([own, _]: &Ends<R>) -> R::Mask {
        let zero = own[0].like(0.0);
        zero.at_least(zero)
    }
}

/// The dilatation of a bond's end, and what of it is not yet relaxed.
#[derive(Clone, Copy)]
pub struct Angles<R> {
    /// θ.
    pub now: R,
    /// Its unrelaxed part; what has come since the last step that advanced is not relaxed at all.
    pub unrelaxed: R,
    /// Share of its shear modulus that relaxes.
    pub relaxing: R,
}

impl<R: Real> Angles<R> {
    /// No dilatation.
    #[inline(always)]
    pub fn none(zero: R) -> Self {
        Self { now: zero, unrelaxed: zero, relaxing: zero }
    }
}

/// (s − θ/3)² of both ends.
#[inline(always)]
fn deviatoric<R: Real>(s: R, ends: &[Angles<R>; 2], without: &[R; 2]) -> (R, R) {
    let third = s.like(1.0 / 3.0);
    let a = ends[0].now.fnma(third, s) - without[0];
    let b = ends[1].now.fnma(third, s) - without[1];
    (a * a, b * b)
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
    fn pull<R: Real>(bond: &Stretch<R>, _: R, _: &Ends<R>, _: &mut [R; 2], _: &Moment) -> (R, R) {
        (bond.share, bond.share)
    }
    #[inline(always)]
    fn squares<R: Real>(bond: &Stretch<R>, _: R, _: &[Angles<R>; 2], _: &[R; 2], _: &Moment) -> (R, R) {
        (bond.s * bond.s, bond.s * bond.s)
    }
}

/// Linear elastic. Columns: A = (3K − 5G)θ/m, B = 15G/m; of microelastic bonds A = 0 and B = ½ or more near a surface.
pub struct Elastic;

impl BondLaw for Elastic {
    const COLUMNS: usize = 2;
    const MEMORY: usize = 0;
    const STRETCHED: bool = false;
    #[inline(always)]
    fn pull<R: Real>(bond: &Stretch<R>, _: R, [own, far]: &Ends<R>, _: &mut [R; 2], _: &Moment) -> (R, R) {
        // A/(1 + s) + B s/(1 + s) with 1/(1 + s) = 1 − s/(1 + s).
        let (a, b) = (own[0] + far[0], own[1] + far[1]);
        let pull = (b - a).fma(bond.share, a);
        (pull, pull)
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
    fn pull<R: Real>(
        bond: &Stretch<R>,
        _: R,
        ends: &Ends<R>,
        memory: &mut [R; 2],
        moment: &Moment,
    ) -> (R, R) {
        let mut pull = ends[0][0] + ends[1][0];
        for ([_, b, third, flowing, ..], flowed) in ends.iter().zip(memory) {
            let trial = bond.s - *third;
            *flowed = (*flowing * moment.flow).fma(trial - *flowed, *flowed);
            pull = b.fma(trial - *flowed, pull);
        }
        let pull = pull * bond.inverse;
        (pull, pull)
    }
    #[inline(always)]
    fn flows<R: Real>([own, far]: &Ends<R>) -> R::Mask {
        own[3].most(far[3]).at_least(own[3].like(f64::MIN_POSITIVE))
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
    fn pull<R: Real>(
        bond: &Stretch<R>,
        omega: R,
        ends: &Ends<R>,
        memory: &mut [R; 2],
        moment: &Moment,
    ) -> (R, R) {
        let gain = if moment.mended { omega.like(0.5) } else { omega };
        let (a, b) = (ends[0][0] + ends[1][0], ends[0][1] + ends[1][1]);
        let (one, zero, flow) = (omega.like(1.0), omega.like(0.0), omega.like(moment.flow));
        let mut pulls = [a, a];
        for (([_, _, third, scale, more, _], flowed), pull) in ends.iter().zip(memory).zip(&mut pulls) {
            let part = b * (bond.s - *third - *flowed) * *scale;
            *pull = (a + part) * bond.inverse;
            let next = R::choose(scale.at_least(one), zero, gain * part * *more + *flowed);
            *flowed = (next - *flowed).fma(flow, *flowed);
        }
        (pulls[0], pulls[1])
    }
    #[inline(always)]
    fn flows<R: Real>([own, far]: &Ends<R>) -> R::Mask {
        own[4].most(far[4]).at_least(own[4].like(f64::MIN_POSITIVE))
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
    fn pull<R: Real>(
        bond: &Stretch<R>,
        limit: R,
        _: &Ends<R>,
        [flowed, _]: &mut [R; 2],
        moment: &Moment,
    ) -> (R, R) {
        let excess = (bond.s - *flowed - limit).least(limit.like(0.0));
        *flowed = excess.fma(limit.like(moment.flow), *flowed);
        let pull = (bond.s - *flowed) * bond.inverse;
        (pull, pull)
    }
    #[inline(always)]
    fn squares<R: Real>(bond: &Stretch<R>, _: R, _: &[Angles<R>; 2], memory: &[R; 2], _: &Moment) -> (R, R) {
        let elastic = bond.s - memory[0];
        (elastic * elastic, elastic * elastic)
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
    fn pull<R: Real>(bond: &Stretch<R>, limit: R, _: &Ends<R>, _: &mut [R; 2], _: &Moment) -> (R, R) {
        let pull = bond.s.most(limit) * bond.inverse;
        (pull, pull)
    }
    #[inline(always)]
    fn squares<R: Real>(bond: &Stretch<R>, limit: R, _: &[Angles<R>; 2], _: &[R; 2], _: &Moment) -> (R, R) {
        // s² down to the limit l, then the tangent there: l (2s − l).
        let held = bond.s.most(limit);
        let square = held * (bond.s + bond.s - held);
        (square, square)
    }
}

/// The stretch from z = |y|²/|xi|² − 1, its closed form, `before` as now.
#[inline(always)]
pub fn closed<R: Real>(z: R) -> Stretch<R> {
    let one = z.like(1.0);
    let root = (one + z).sqrt();
    let more = one + root;
    let inverse = one / (root * more);
    let s = z * root * inverse;
    Stretch { s, share: z * inverse, inverse: more * inverse, before: s, limit: s }
}

#[cfg(test)]
mod tests;
