//! `nonlinear`: microelastic bonds whose compression is cut off, without memory.

use crate::law::formula::{Angles, BondLaw};
use crate::law::moment::Moment;
use crate::law::stretch::{Ends, Stretch};
use crate::law::style::{Number, Style};
use perigrain_base::math::real::Real;

/// The law of decks.
pub static NONLINEAR: Style = Style {
    bond_based: true,
    numbers: &[Number::SYC],
    edge: Some(|m| m.syc),
    unloading: Some("nonlinear"),
    ..Style::of::<Flattened>("nonlinear", 5)
};

/// The equation of [`Yielding`](crate::law::plastic::Yielding) taken literally, as a function of the stretch.
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
