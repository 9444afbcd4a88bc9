//! `plastic`: microelastic bonds that flow in compression and remember what has flowed.

use crate::law::formula::{Angles, BondLaw};
use crate::law::moment::Moment;
use crate::law::stretch::{Ends, Stretch};
use crate::law::style::{Losses, Number, Style};
use perigrain_base::math::real::Real;

/// The law of decks.
pub static PLASTIC: Style = Style {
    bond_based: true,
    losses: Losses::Flow,
    numbers: &[Number::SYC],
    edge: Some(|m| m.syc),
    unloading: Some("plastic"),
    ..Style::of::<Yielding>("plastic", 4)
};

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
