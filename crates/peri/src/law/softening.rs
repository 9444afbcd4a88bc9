//! Microelastic bonds that soften beyond a peak: quasi-brittle materials (concrete, ceramics, rock).
//!
//! Along the envelope the force density of a bond is c g(s) per volume of either end, with the stretch s, the peak s₀ and the
//! stretch s_f at which nothing is left:
//!
//! ```text
//! g(s) = s                                    s ≤ s₀
//! g(s) = s₀ (s_f − s)/(s_f − s₀)              linear (bilinear in all: Zaccariotto et al. 2015)
//! g(s) = s₀ exp(−(s − s₀)/a)                  exponential, a = (s_f − s₀)/ln 1000 (Yang et al. 2018)
//! ```
//!
//! Below the largest stretch so far, s_m, a bond unloads to the origin: c (1 − d) s with the damage d = 1 − g(s_m)/s_m; in
//! compression c s, as cracks close. Its energy is ½ (1 − d) s², of compression ½ s², and what it has lost by then is
//! D = ∫₀^{s_m} g ds − ½ g(s_m) s_m, each over c w |xi| V. Whole families release πcδ⁵/5 ∫ g ds for each area of a crack
//! (Silling & Askari 2005, equation 21, where ∫ g ds = ½ s₀²).

use crate::law::formula::{Angles, BondLaw};
use crate::law::material::Moduli;
use crate::law::moment::{COLUMNS, Moment};
use crate::law::stretch::{Ends, Stretch};
use crate::law::style::{Bound, Curve, Losses, Number, Style};
use perigrain_base::math::real::Real;

/// The linear law of decks.
pub static LINEAR: Style = Style {
    curve: Some(Curve {
        // A triangle.
        beyond: |area, peak| 2.0 * area / peak - peak,
        twice_area: |peak, last| peak * last,
        scaled: |(_, last), factor| factor * last,
    }),
    ..Style { name: "softening/linear", number: 8, ..softening::<Softening<false>>() }
};

/// The exponential one.
pub static EXPONENTIAL: Style = Style {
    curve: Some(Curve {
        // a (1 − REST) times the peak.
        beyond: |area, peak| (area / peak - 0.5 * peak) / (1.0 - REST) * -REST.ln(),
        twice_area: |peak, last| peak * peak + 2.0 * peak * (last - peak) / -REST.ln() * (1.0 - REST),
        scaled: last_of_area,
    }),
    ..Style { name: "softening/exponential", number: 9, ..softening::<Softening<true>>() }
};

/// What both have.
const fn softening<W: BondLaw>() -> Style {
    Style {
        bond_based: true,
        losses: Losses::Damage,
        numbers: &[Number {
            keyword: "peak",
            what: ["the stretch at the peak"; 2],
            bound: Bound::Positive,
            of: |m| &mut m.peak,
        }],
        edge: Some(|m: &Moduli| m.peak),
        ..Style::of::<W>("", 0)
    }
}

/// What is left of the peak where an exponential bond breaks.
const REST: f64 = 1e-3;

/// The stretch at which nothing is left of an exponential bond whose curve has this peak and `factor` times the area of one that ends
/// at `last`.
fn last_of_area((peak, last): (f64, f64), factor: f64) -> f64 {
    let (rise, scale) = (0.5 * peak * peak, (last - peak) / -REST.ln());
    let beyond = peak * scale * (1.0 - REST);
    peak + (last - peak) * (factor * (rise + beyond) - rise) / beyond
}

/// The law. Columns: none; in the place of ω the peak. Memory: damage; of an exponential bond also the largest stretch so far.
pub struct Softening<const EXPONENTIAL: bool>;

/// A bond beyond its peak.
struct Grown<R> {
    /// d.
    damage: R,
    /// The largest stretch so far if that was beyond the peak, else 0; of a linear bond always 0.
    most: R,
}

impl<const EXPONENTIAL: bool> Softening<EXPONENTIAL> {
    /// The damage once a bond has been stretched by s, and the largest stretch.
    #[inline(always)]
    fn grown<R: Real>(bond: &Stretch<R>, peak: R, memory: &[R; 2]) -> Grown<R> {
        // Nothing is divided by zero where no bond lives and both stretches are; nor by the square of this.
        let tiny = peak.like(TINY);
        let one = peak.like(1.0);
        let room = (bond.limit - peak).most(tiny);
        if !EXPONENTIAL {
            let s = bond.s.most(peak).most(tiny);
            let share = peak * (bond.limit - s).most(peak.like(0.0)) / (room * s);
            return Grown { damage: memory[0].most(one - share), most: memory[1] };
        }
        let known = memory[1].most(peak).most(tiny);
        let grows = (bond.s - known).at_least(tiny);
        if !R::any(grows) {
            return Grown { damage: memory[0], most: memory[1] };
        }
        let s = bond.s.most(known);
        // Few bonds grow in a step: exponentials one by one, so that their bits do not depend on the width.
        let left = ((s - peak) * (peak.like(REST.ln()) / room)).each(f64::exp);
        let share = peak * left / s;
        Grown { damage: memory[0].most(one - share), most: memory[1].most(bond.s.keep(grows)) }
    }

    /// s times 1 − d in tension: half its product with s is the energy.
    #[inline(always)]
    fn tension<R: Real>(s: R, damage: R) -> R {
        s - damage * s.most(s.like(0.0))
    }

    /// Twice D.
    #[inline(always)]
    fn lost<R: Real>(limit: R, peak: R, memory: &[R; 2]) -> R {
        let intact = peak.like(1.0) - memory[0];
        if !EXPONENTIAL {
            // g = s₀ s_f (1 − d)/((1 − d)(s_f − s₀) + s₀), and a triangle of height s₀ − g over s_f.
            let below = (intact * (limit - peak) + peak).most(peak.like(TINY));
            let force = peak * limit * intact / below;
            return limit * (peak - force);
        }
        // The envelope's integral up to s_m: ½ s₀² + a (s₀ − g).
        let most = memory[1].most(peak);
        let force = intact * most;
        let scale = (limit - peak) * (-2.0 / REST.ln());
        peak * peak + scale * (peak - force) - force * most
    }
}

/// Far below any stretch.
const TINY: f64 = 1e-150;

impl<const EXPONENTIAL: bool> BondLaw for Softening<EXPONENTIAL> {
    const DILATED: bool = false;
    const COLUMNS: usize = 0;
    const MEMORY: usize = if EXPONENTIAL { 2 } else { 1 };
    const LIMITED: bool = true;
    const ALL_FORMS: bool = false;
    #[inline(always)]
    fn pull<R: Real>(bond: &Stretch<R>, peak: R, _: &Ends<R>, memory: &mut [R; 2], _: &Moment) -> (R, R) {
        let grown = Self::grown(bond, peak, memory);
        *memory = [grown.damage, grown.most];
        let pull = Self::tension(bond.s, grown.damage) * bond.inverse;
        (pull, pull)
    }
    #[inline(always)]
    fn squares<R: Real>(
        bond: &Stretch<R>,
        peak: R,
        _: &[Angles<R>; 2],
        memory: &[R; 2],
        moment: &Moment,
    ) -> (R, R) {
        if moment.lost {
            let lost = Self::lost(bond.limit, peak, memory);
            return (lost, lost);
        }
        let grown = Self::grown(bond, peak, memory);
        let square = Self::tension(bond.s, grown.damage) * bond.s;
        (square, square)
    }
    #[inline(always)]
    fn relaxing<R: Real>(end: &[R; COLUMNS], _: &Moment) -> R {
        end[0].like(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PEAK: f64 = 1e-3;
    const LIMIT: f64 = 9e-3;

    fn bond(s: f64) -> Stretch<f64> {
        let inverse = 1.0 / (1.0 + s);
        Stretch { s, share: s / (1.0 + s), inverse, before: s, limit: LIMIT }
    }

    /// One bond on its way, for a law of either curve.
    struct Way<const E: bool>([f64; 2]);

    impl<const E: bool> Way<E> {
        /// g of a stretch that is kept.
        fn to(&mut self, s: f64) -> f64 {
            let ends = [[0.0; COLUMNS]; 2];
            let (near, far) = Softening::<E>::pull(&bond(s), PEAK, &ends, &mut self.0, &Moment::default());
            assert_eq!(near, far);
            near * (1.0 + s)
        }
        /// Energy held and lost, over c w |xi| V.
        fn energies(&self, s: f64) -> [f64; 2] {
            [false, true].map(|lost| {
                let none = Angles { now: 0.0, unrelaxed: 0.0, relaxing: 0.0 };
                let moment = Moment { lost, ..Moment::default() };
                let squares = Softening::<E>::squares(&bond(s), PEAK, &[none; 2], &self.0, &moment);
                0.5 * squares.0
            })
        }
    }

    fn envelope(exponential: bool, s: f64) -> f64 {
        match exponential {
            _ if s <= PEAK => s,
            false => PEAK * (LIMIT - s).max(0.0) / (LIMIT - PEAK),
            true => PEAK * (REST.ln() * (s - PEAK) / (LIMIT - PEAK)).exp(),
        }
    }

    #[test]
    fn curves_of_other_horizons_have_their_share_of_the_area() {
        for exponential in [false, true] {
            let area = |last: f64| match exponential {
                false => 0.5 * PEAK * last,
                true => 0.5 * PEAK * PEAK + PEAK * (last - PEAK) / -REST.ln() * (1.0 - REST),
            };
            for factor in [0.6, 1.0, 2.5] {
                let style = if exponential { &EXPONENTIAL } else { &LINEAR };
                let last = (style.curve.as_ref().unwrap().scaled)((PEAK, LIMIT), factor);
                assert!((area(last) / area(LIMIT) - factor).abs() < 1e-14, "{exponential} {factor}");
            }
        }
    }

    fn follows_the_envelope<const E: bool>() {
        let mut way = Way::<E>([0.0; 2]);
        for k in 0..=1000 {
            let s = LIMIT * f64::from(k) / 1000.0;
            // Some roundings of 1e-16 of the peak.
            assert!((way.to(s) - envelope(E, s)).abs() < 2e-15 * PEAK, "{s}");
        }
    }

    #[test]
    fn forces_follow_the_envelope() {
        follows_the_envelope::<false>();
        follows_the_envelope::<true>();
    }

    fn goes_back_to_the_origin<const E: bool>() {
        let mut way = Way::<E>([0.0; 2]);
        let most = 3e-3;
        let top = way.to(most);
        for part in [0.9, 0.5, 0.0, 0.7, 1.0] {
            assert!((way.to(part * most) - part * top).abs() < 1e-15 * PEAK, "{part}");
        }
        // Cracks close: compression knows no damage.
        assert_eq!(way.to(-2e-3), -2e-3 / (1.0 - 2e-3) * (1.0 - 2e-3));
    }

    #[test]
    fn unloading_goes_to_the_origin_and_back() {
        goes_back_to_the_origin::<false>();
        goes_back_to_the_origin::<true>();
    }

    fn energy_is_the_integral_of_the_force<const E: bool>() {
        let mut way = Way::<E>([0.0; 2]);
        let (mut work, mut s, mut g) = (0.0, 0.0, 0.0);
        // Up, back, into compression, up beyond where it was, back, and up until nothing is left.
        for goal in [2e-3, 0.5e-3, -1e-3, 4e-3, 0.0, LIMIT] {
            let (start, steps) = (s, 20_000);
            for k in 1..=steps {
                let next = start + (goal - start) * f64::from(k) / f64::from(steps);
                let force = way.to(next);
                work += 0.5 * (g + force) * (next - s);
                (s, g) = (next, force);
            }
            let [held, lost] = way.energies(s);
            // The trapezoidal rule: h²/12 · g'' · path, and a kink of size 1 at the peak: h² of PEAK², h = 4e-7.
            assert!((held + lost - work).abs() < 1e-6 * PEAK * PEAK, "{goal}: {held} + {lost}, {work}");
        }
        let [held, lost] = way.energies(LIMIT);
        let whole = match E {
            false => 0.5 * PEAK * LIMIT,
            true => 0.5 * PEAK * PEAK - (LIMIT - PEAK) / REST.ln() * PEAK * (1.0 - REST),
        };
        assert!((held + lost - whole).abs() < 1e-14 * whole, "{held} {lost} {whole}");
    }

    #[test]
    fn work_is_held_or_lost() {
        energy_is_the_integral_of_the_force::<false>();
        energy_is_the_integral_of_the_force::<true>();
    }

    #[test]
    fn what_is_no_bond_gives_no_nonsense() {
        let dead = Stretch { limit: 0.0, ..bond(0.0) };
        let ends = [[0.0; COLUMNS]; 2];
        for before in [[0.0; 2], [0.3, 2e-3]] {
            let moment = Moment::default();
            let (linear, _) = Softening::<false>::pull(&dead, 0.0, &ends, &mut before.clone(), &moment);
            let (other, _) = Softening::<true>::pull(&dead, 0.0, &ends, &mut before.clone(), &moment);
            assert!(linear == 0.0 && other == 0.0);
        }
    }
}
