//! `set … peri/strength` and `peri/stiffness`: factors of particles on what their bonds bear and on how stiff these are.

use super::change::Limit;
use super::value;
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::scatter::{Distribution, Field, gaussian};
use perigrain_base::par;
use perigrain_lang::{Args, Param};
use perigrain_styles::BuildCx;
use perigrain_styles::common::orthogonal;
use perigrain_styles::words::{At, Kind, Or, Value, Words};
use perigrain_world::{Numbers, World};

/// Where factors come from: a number, or one for each particle, or drawn at random.
pub type Factors = Or<Drawn, Given>;

/// A factor, or a variable that gives it.
pub struct Given(pub Param);

impl Value for Given {
    const KIND: Kind = Kind::Param;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let what = "the factor (a number, weibull or normal)";
        value(args, cx, what, Some(Limit::Positive)).map(Self)
    }
}

/// Random factors.
#[derive(Words)]
#[word(what = "distribution")]
pub enum Drawn {
    /// Numbers of a Weibull distribution of modulus M and mean 1.
    Weibull(Weibull),
    /// Numbers of a normal distribution of mean 1; what is farther off than three deviations is moved to there.
    Normal(Normal),
}

/// A Weibull distribution.
#[derive(Words)]
pub struct Weibull {
    #[word(name = "M", what = "the modulus of the distribution", positive)]
    modulus: f64,
    #[word(flatten)]
    field: Correlated,
}

/// A normal distribution.
#[derive(Words)]
pub struct Normal {
    #[word(name = "DEVIATION", what = "the standard deviation", positive)]
    deviation: At<f64>,
    #[word(flatten)]
    field: Correlated,
}

/// Where random numbers come from.
#[derive(Words)]
pub struct Correlated {
    #[word(name = "SEED", what = "the seed", from = 1)]
    seed: u64,
    #[word(keyword = "correlated", name = "L", what = "the correlation length", positive, placed, once)]
    length: Option<At<f64>>,
}

/// Refuses deviations that would make factors negative, and fields over boxes that lean.
///
/// # Errors
/// Those.
pub fn check(factors: &Factors, cx: &BuildCx) -> Result<()> {
    let Or::Word(drawn) = factors else { return Ok(()) };
    if let Drawn::Normal(Normal { deviation, .. }) = drawn
        && deviation.value >= 1.0 / 3.0
    {
        let text = "factors three standard deviations below 1 must be positive: a number below 1/3";
        return fail(Code::BAD_VALUE, deviation.span, text);
    }
    match drawn.parts().1.length {
        Some(length) if cx.world.domain.as_ref().is_some_and(|d| d.tilted()) => {
            Err(orthogonal("a correlated field of factors").at(length.span))
        }
        _ => Ok(()),
    }
}

impl Drawn {
    fn parts(&self) -> (Distribution, &Correlated) {
        match self {
            Self::Weibull(w) => (Distribution::Weibull(w.modulus), &w.field),
            Self::Normal(n) => (Distribution::Normal(n.deviation.value), &n.field),
        }
    }

    /// The factors of some particles.
    pub fn of(&self, w: &World, chosen: &[usize]) -> Vec<f64> {
        let p = &w.particles;
        let mut factors = vec![0.0; chosen.len()];
        let (distribution, Correlated { seed, length }) = self.parts();
        let field = length.map(|l| Field::new(*seed, l.value, w.periods().length.map(endless)));
        par::each(&mut factors[..], |start, factors| {
            for (factor, &i) in factors.iter_mut().zip(&chosen[start..]) {
                let normal = match &field {
                    Some(field) => field.at(p.x[i]),
                    None => gaussian(*seed, u64::from(p.tag[i])),
                };
                *factor = distribution.factor(normal);
            }
        });
        factors
    }
}

/// A period of the box, which is 0 where it is open.
fn endless(period: f64) -> f64 {
    if period > 0.0 { period } else { f64::INFINITY }
}

/// Sets the factors of the chosen particles; those of all others are 1 unless set before.
pub fn set(w: &mut World, chosen: &[usize], column: Numbers, factors: &[f64]) {
    let n = w.n();
    let values = w.columns.scalar(column, n);
    values.resize(n, 0.0);
    values.iter_mut().filter(|f| **f == 0.0).for_each(|f| *f = 1.0);
    chosen.iter().enumerate().for_each(|(k, &i)| values[i] = factors[k]);
}

#[cfg(test)]
mod tests {
    use crate::testing::{more, refused, scene};
    use perigrain_styles::peri_view::BOND_FACTORS;
    use perigrain_world::World;

    fn solid() -> World {
        let mut w = scene("units si\natom_style peri\nregion b block 0 8 0 8 0 8 units box\ncreate_box 2 b");
        more(&mut w, "lattice sc 1\ncreate_atoms 1 box");
        w
    }

    fn strength(w: &World) -> Vec<f64> {
        w.columns.get_scalar(*BOND_FACTORS[0]).unwrap().to_vec()
    }

    #[test]
    fn factors_belong_to_particles() {
        let mut w = solid();
        more(&mut w, "set atom 1*100 peri/strength weibull 5 4711");
        let first = strength(&w);
        assert!(first[..100].iter().all(|f| *f != 1.0) && first[100..].iter().all(|f| *f == 1.0));
        more(&mut w, "set atom 50*512 peri/strength weibull 5 4711 peri/strength weibull 5 4711");
        assert_eq!(first[..100], strength(&w)[..100]);
        more(&mut w, "set atom 7 peri/strength 0.5 peri/stiffness normal 0.1 3");
        assert_eq!(strength(&w)[6], 0.5);
    }

    /// Neighbours at 1/8 of the length differ by √(2 (1 − exp(−1/128))) = 0.12 deviations, others by √2: a tenth. Every eighth
    /// particle begins a row, and is farther from the one before.
    #[test]
    fn correlated_factors_are_a_field_over_places() {
        let mut w = solid();
        more(&mut w, "set group all peri/strength normal 0.1 5 correlated 8");
        let field = strength(&w);
        let mean = |f: &[f64]| f.windows(2).map(|f| (f[1] - f[0]).abs()).sum::<f64>() / 511.0;
        more(&mut w, "set group all peri/strength normal 0.1 5");
        assert!(mean(&field) < 0.35 * mean(&strength(&w)), "{}", mean(&field));
    }

    #[test]
    fn blames_the_right_word() {
        let w = solid();
        for (line, word) in [
            ("set group all peri/strength 0", "0"),
            ("set group all peri/strength weibull -3 1", "-3"),
            ("set group all peri/strength weibull 3 0", "0"),
            ("set group all peri/strength normal 0.4 1", "0.4"),
            ("set group all peri/stiffness normal 0.1 1 correlated 0", "0"),
            ("set group all peri/stiffness gauss", "gauss"),
            ("set group all peri/strength normal 0.1 1 correlated 8 correlated 2", "correlated"),
        ] {
            assert_eq!(refused(&w, line).0, word, "{line}");
        }
    }
}
