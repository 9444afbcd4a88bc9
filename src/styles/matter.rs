//! What many styles ask of the particles: who belongs to a group, what it weighs, where it is unwrapped.

use crate::diag::{Code, Diagnostic, Result, Span};
use crate::par;
use crate::world::{AtomStyle, GroupId, World};

/// The mass of each particle: its own where the atom style has one, else its type's.
#[derive(Clone, Copy)]
pub enum Masses<'a> {
    /// Each its own.
    Own(&'a [f64]),
    /// By type (from 1).
    ByType(&'a [u16], &'a [Option<f64>]),
}

impl<'a> Masses<'a> {
    /// The masses of a world's particles.
    pub fn of(w: &'a World) -> Self {
        let p = &w.particles;
        Self::new(p.style, &p.mass, &p.kind, &w.type_mass)
    }

    /// As `of`, where the world is borrowed in parts.
    pub fn new(style: AtomStyle, own: &'a [f64], kind: &'a [u16], by_type: &'a [Option<f64>]) -> Self {
        if style.own_mass() { Self::Own(own) } else { Self::ByType(kind, by_type) }
    }

    /// The mass of particle `i`; NaN where its type has none, which [`check_masses`] rules out.
    #[inline]
    pub fn get(&self, i: usize) -> f64 {
        match self {
            Self::Own(mass) => mass[i],
            Self::ByType(kind, table) => {
                table.get(usize::from(kind[i]) - 1).copied().flatten().unwrap_or(f64::NAN)
            }
        }
    }
}

/// Checks that every particle has a mass.
///
/// # Errors
/// A type in use without `mass`.
pub fn check_masses(w: &World, span: Span) -> Result<()> {
    if w.particles.style.own_mass() {
        return Ok(());
    }
    let without = |k: &&u16| w.type_mass.get(usize::from(**k).wrapping_sub(1)).copied().flatten().is_none();
    match w.particles.kind.iter().find(without) {
        None => Ok(()),
        Some(k) => Err(Diagnostic::error(Code::INCOMPLETE, span, format!("atom type {k} has no mass"))
            .help(format!("write `mass {k} …` before the run"))
            .into()),
    }
}

/// How many particles belong to a group.
pub fn count(w: &World, group: GroupId) -> usize {
    let (mask, bit) = (&w.particles.mask, group.bit());
    par::reduce(mask.len(), |r| r.filter(|&i| mask[i] & bit != 0).count(), |a, b| a + b).unwrap_or(0)
}

/// Adds up `term(i)` over the particles of a group: the same bits for any number of threads.
pub fn sum<const N: usize>(
    mask: &[u32],
    group: GroupId,
    term: impl Fn(usize) -> [f64; N] + Sync,
) -> [f64; N] {
    let bit = group.bit();
    let chunk = |range: std::ops::Range<usize>| {
        let mut total = [0.0; N];
        for i in range.filter(|&i| mask[i] & bit != 0) {
            let t = term(i);
            (0..N).for_each(|k| total[k] += t[k]);
        }
        total
    };
    par::reduce(mask.len(), chunk, add).unwrap_or([0.0; N])
}

/// Element by element a + b.
pub fn add<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| a[k] + b[k])
}

/// Where particle `i` would be had it never been wrapped into a periodic box.
pub fn unwrapped(w: &World, i: usize) -> [f64; 3] {
    let lengths = w.domain.as_ref().map_or([0.0; 3], |d| d.lengths());
    let (x, image) = (w.particles.x[i], w.particles.image[i]);
    std::array::from_fn(|k| x[k] + f64::from(image[k]) * lengths[k])
}
