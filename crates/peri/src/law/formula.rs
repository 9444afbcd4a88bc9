//! What a bond law is: a pull and an energy as functions of a bond's stretch and of what its ends have in columns, and where those columns
//! come from.
//!
//! With stretch s, dilatation θ, weighted volume m and influence ω an end's force density is t = ω |xi| (3Kθ/m + 15G/m ε),
//! ε being the deviatoric part of the stretch, s − θ/3, without what has relaxed or flowed (Silling et al. 2007;
//! Mitchell 2011). Both ends act along y/|y|; y = xi + eta and |y| = |xi| (1 + s), so that a law returns
//! (t_i + t_j)/(ω |y|).

use crate::law::moment::{COLUMNS, Held, Moment};
use crate::law::site::{Site, Unrelaxed};
use crate::law::stretch::{Ends, Stretch};
use crate::law::terms::Sum;
use perigrain_base::math::real::Real;

/// A law of bonds with numbers at both ends.
pub trait BondLaw: Sync + 'static {
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
    /// Whether columns are those of linear elastic sites, arithmetic alone where all are of one material.
    const LINEAR: bool = false;
    /// Whether sites remember a dilatation that relaxes.
    const RELAXES: bool = false;
    /// The norm that says how much flows, if any does.
    const NORM: Option<Sum> = None;
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
    /// By what stretch each end of a bond has flowed or relaxed, which is what breaking leaves at its site: of one with the stretch
    /// `s` and what it remembers.
    #[inline]
    fn slips(_s: f64, _memory: [f64; 2], _held: Held, _ends: [Unrelaxed; 2]) -> [f64; 2] {
        [0.0; 2]
    }
    /// θ of a site from the sum of its dilatation; what the site remembers of it is brought up to date.
    #[inline(always)]
    fn dilatation(site: &mut Site) -> f64 {
        site.dilatation()
    }
    /// The columns of a site whose dilatation is known, of laws with dilatations.
    #[inline(always)]
    fn columns(_site: &mut Site) -> [f64; COLUMNS] {
        [0.0; COLUMNS]
    }
    /// The columns of a site once its norm is known, of laws with a [`BondLaw::NORM`]: what flows is taken from the site.
    #[inline(always)]
    fn flow(_site: &mut Site) -> [f64; COLUMNS] {
        [0.0; COLUMNS]
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
pub(super) fn deviatoric<R: Real>(s: R, ends: &[Angles<R>; 2], without: &[R; 2]) -> (R, R) {
    let third = s.like(1.0 / 3.0);
    let a = ends[0].now.fnma(third, s) - without[0];
    let b = ends[1].now.fnma(third, s) - without[1];
    (a * a, b * b)
}
