//! `lps`, the linear peridynamic solid: ordinary state-based and elastic (Silling et al. 2007).

use crate::law::formula::BondLaw;
use crate::law::moment::{COLUMNS, Moment};
use crate::law::site::Site;
use crate::law::stretch::{Ends, Stretch};
use crate::law::style::Style;
use perigrain_base::math::real::Real;

/// The law of decks.
pub static LPS: Style = Style { of_bonds: true, ..Style::of::<Elastic>("lps", 1) };

/// Linear elastic. Columns: A = (3K − 5G)θ/m, B = 15G/m; of microelastic bonds A = 0 and B = ½ or more near a surface.
pub struct Elastic;

impl BondLaw for Elastic {
    const COLUMNS: usize = 2;
    const MEMORY: usize = 0;
    const STRETCHED: bool = false;
    const LINEAR: bool = true;
    #[inline(always)]
    fn pull<R: Real>(bond: &Stretch<R>, _: R, [own, far]: &Ends<R>, _: &mut [R; 2], _: &Moment) -> (R, R) {
        // A/(1 + s) + B s/(1 + s) with 1/(1 + s) = 1 − s/(1 + s).
        let (a, b) = (own[0] + far[0], own[1] + far[1]);
        let pull = (b - a).fma(bond.share, a);
        (pull, pull)
    }
    #[inline(always)]
    fn columns(site: &mut Site) -> [f64; COLUMNS] {
        let (own, by_m) = (site.own, 1.0 / site.weighted);
        [(own.bulk - own.shear / 3.0) * site.theta * by_m, own.shear * by_m, 0.0, 0.0, 0.0, 0.0]
    }
}
