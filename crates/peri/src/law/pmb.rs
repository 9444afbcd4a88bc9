//! `pmb`, prototype microelastic brittle bonds: c s (Silling and Askari 2005).

use crate::law::formula::{Angles, BondLaw};
use crate::law::moment::Moment;
use crate::law::stretch::{Ends, Stretch};
use crate::law::style::Style;
use perigrain_base::math::real::Real;

/// The law of decks.
pub static PMB: Style = Style { bond_based: true, of_bonds: true, ..Style::of::<Pmb>("pmb", 0) };

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
