//! The table of contact laws by types, for the fast loop.

use super::lists::Pairs;
use super::{AMPLE, NONE};
use crate::Granular;
use perigrain_base::math::lanes::place;

/// The table of laws.
#[derive(Clone, Debug)]
pub struct Laws {
    pub(super) distinct: Vec<Granular>,
    pub(super) types: usize,
    pub(super) which: Vec<u8>,
}

impl Laws {
    /// The table from `law(a, b)` for types from 1, symmetric; `None` if there are too many different laws.
    pub fn new(types: usize, law: impl Fn(u16, u16) -> Option<Granular>) -> Option<Self> {
        let mut t = Self { distinct: vec![], types, which: vec![] };
        for a in 1..=types as u16 {
            for b in 1..=types as u16 {
                let Some(law) = law(a, b) else {
                    t.which.push(NONE);
                    continue;
                };
                let at = t.distinct.iter().position(|l| *l == law).unwrap_or_else(|| {
                    t.distinct.push(law);
                    t.distinct.len() - 1
                });
                t.which.push(u8::try_from(at).ok().filter(|at| *at < NONE)?);
            }
        }
        Some(t)
    }

    /// The laws, each once.
    pub fn distinct(&self) -> &[Granular] {
        &self.distinct
    }

    /// The largest gap at which grains of up to this radius can stick together [length].
    pub fn span(&self, largest: f64) -> f64 {
        // Gaps grow with the effective radius, which is at most half of the larger one.
        let gaps = self.distinct.iter().map(|law| law.gap(0.5 * largest));
        AMPLE * gaps.fold(0.0, f64::max)
    }

    #[inline]
    pub(super) fn which(&self, a: u16, b: u16) -> u8 {
        self.which[(usize::from(a) - 1) * self.types + usize::from(b) - 1]
    }

    /// Groups pairs by law and keeps the order within each law: contacts of one law are evaluated together,
    /// and removing pairs from a list does not change the order of the others.
    pub(super) fn sort(&self, kind: &[u16], pairs: &mut Pairs) {
        if self.distinct.len() < 2 {
            return;
        }
        let which = |(i, w): (&u32, &u32)| self.which(kind[*i as usize], kind[place(*w)]);
        let numbers: Vec<u8> = pairs.i.iter().zip(&pairs.w).map(which).collect();
        if numbers.is_sorted() {
            return;
        }
        let mut order: Vec<u32> = (0..numbers.len() as u32).collect();
        order.sort_by_key(|k| numbers[*k as usize]);
        for list in [&mut pairs.i, &mut pairs.w] {
            *list = order.iter().map(|k| list[*k as usize]).collect();
        }
    }

    /// The largest history size.
    pub fn memory(&self) -> usize {
        self.distinct.iter().map(Granular::memory).max().unwrap_or(0)
    }
}
