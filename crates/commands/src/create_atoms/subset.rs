//! A random choice of lattice sites, exact in number, by LAMMPS' stream.

use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_base::math::rng::Marsaglia;

/// The keywords `ratio` and `subset`.
pub struct Subset {
    /// How many.
    pub amount: Amount,
    /// Of the random stream.
    pub seed: u32,
    /// The keyword's place.
    pub span: Span,
}

/// How many sites are taken.
#[derive(Clone, Copy)]
pub enum Amount {
    /// A fraction of all.
    Ratio(f64),
    /// So many.
    Count(i64),
}

impl Subset {
    /// The chosen ones, in their order.
    ///
    /// # Errors
    /// More are wanted than there are.
    pub fn of<T>(&self, all: Vec<T>) -> Result<Vec<T>> {
        let wanted = match self.amount {
            Amount::Ratio(r) => (r * all.len() as f64) as usize,
            Amount::Count(n) => n.try_into().unwrap_or(usize::MAX),
        };
        if wanted > all.len() {
            let text = format!("{wanted} sites are wanted, but there are only {}", all.len());
            return fail(Code::BAD_VALUE, self.span, text);
        }
        let mut stream = Marsaglia::new(self.seed);
        let chosen = choose(wanted, all.len(), || stream.uniform());
        Ok(all.into_iter().zip(chosen).filter_map(|(site, chosen)| chosen.then_some(site)).collect())
    }
}

/// Marks exactly `wanted` of `n` things: sweeps mark each with the probability that is missing (at least 0.01), or take
/// marks away where there are too many; each sweep goes through those that the one before has left or marked.
pub fn choose(wanted: usize, n: usize, mut uniform: impl FnMut() -> f64) -> Vec<bool> {
    let mut marked = vec![false; n];
    let mut count = 0;
    // Those the last sweep went through, by their marks.
    let mut active: [Vec<usize>; 2] = [(0..n).collect(), vec![]];
    while count != wanted {
        let add = wanted > count;
        let sweep = std::mem::take(&mut active[usize::from(!add)]);
        active = [vec![], vec![]];
        let threshold = (wanted.abs_diff(count) as f64 / sweep.len() as f64).max(0.01);
        for k in sweep {
            if uniform() < threshold {
                marked[k] = add;
                count = if add { count + 1 } else { count - 1 };
            }
            active[usize::from(marked[k])].push(k);
        }
    }
    marked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_exactly_as_many_as_wanted() {
        for (wanted, n) in [(0, 5), (5, 5), (3, 10), (250, 1000), (999, 1000), (1, 1000)] {
            let mut stream = Marsaglia::new(77);
            let marked = choose(wanted, n, || stream.uniform());
            assert_eq!(marked.iter().filter(|m| **m).count(), wanted);
        }
    }
}
