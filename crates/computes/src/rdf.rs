//! compute rdf: radial distribution functions and coordination numbers.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::vec3::length;
use perigrain_lang::Args;
use perigrain_neigh::list::{Reach, difference};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::near::{one_image, within};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Syntax, Types, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BONDS, BOX, FAMILIES, KIND, MASK, MOLECULE, RADIUS, TAG, X};
use perigrain_world::{GroupId, SlotId, World};
use std::f64::consts::PI;

/// The style.
pub struct Rdf;

impl Style for Rdf {
    fn name(&self) -> &'static str {
        "rdf"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Radial distribution functions g(r) and coordination numbers.",
            text: "Global array (intensive) of Nbin rows and 1 + 2 columns for each pair of types: the middle of the shell, in distance units; g(r), how many particles of jtype there are in the shell \
                   around one of itype beside how many there would be if they were spread evenly over the box; and how many \
                   there are up to this shell's end. Both ends belong to the group; pairs that exclusions and bonds take away do not count. In two \
                   dimensions shells are rings.\n\n\
                   Without a cutoff of its own shells reach up to that of forces: of granular styles twice the largest radius as \
                   the run begins (grains of `fix freeze` do not count beside each other), of peridynamic ones the largest horizon.",
            example: "compute g all rdf 20 cutoff 1.5",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The number of bins, shells of equal width.
    #[word(name = "Nbin", with = bins, kind = Kind::Whole)]
    bins: usize,
    /// The types of the particle in the middle and of those around it, or ranges such as `2*3`; all types if none is given.
    #[word(name = "itype jtype")]
    pairs: Vec<[Types; 2]>,
    /// Shells reach up to this distance, up to half a periodic length, longer than in LAMMPS; a deck without pair style needs it
    /// [distance].
    #[word(keyword, name = "R", what = "the cutoff", positive)]
    cutoff: Option<f64>,
}

fn bins(args: &mut Args, _: &BuildCx) -> Result<usize> {
    args.count("the number of bins", BYTES_PER_BIN)
}

impl ComputeStyle for Rdf {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { bins, pairs, cutoff } = read(args, cx)?;
        if bins > MOST {
            return fail(Code::BAD_VALUE, cx.span, format!("more than {MOST} bins"));
        }
        let ends = |Types(first, last)| (first, last);
        let mut pairs: Vec<_> = pairs.into_iter().map(|pair| pair.map(ends)).collect();
        if pairs.is_empty() {
            pairs.push([(1, u16::MAX); 2]);
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, bins, pairs, cutoff }))
    }
}

/// Bytes per bin and pair of types: counts and output rows.
const BYTES_PER_BIN: f64 = 80.0;

/// A larger number of bins is refused.
const MOST: usize = 10_000_000;

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    bins: usize,
    /// Types of the central particle and of those around it, both ends included.
    pairs: Vec<[(u16, u16); 2]>,
    cutoff: Option<f64>,
}

/// The neighbour distance: as given, or the force cutoff.
///
/// # Errors
/// Neither is there, or the cutoff is too long for a periodic box.
pub(super) fn reach(id: &str, given: Option<f64>, at: Span, cx: &mut dyn SealCx) -> Result<f64> {
    let Some(cutoff) = given.or_else(|| cx.cutoff()).filter(|c| *c > 0.0) else {
        let text = format!("compute {id}: this scene has no pair style with a cutoff");
        return Err(Diagnostic::error(Code::INCOMPLETE, at, text)
            .help("`pair_style zero R` with `pair_coeff * *` gives it one without forces")
            .into());
    };
    one_image(cx.world(), cutoff, at)?;
    Ok(cutoff)
}

impl Declared {
    /// Number of pairs by bin, one row per pair of types.
    fn counted(&self, w: &World, cutoff: f64) -> Vec<f64> {
        let (p, period) = (&w.particles, w.periods());
        let of = |i: usize| p.mask[i] & self.group.bit() != 0;
        let mut counts = vec![0.0; self.bins * self.pairs.len()];
        for pair in within(w, Reach::Fixed(cutoff), &|i, j| of(i) && of(j)) {
            let bin = (length(difference(&p.x, &period, &pair)) / (cutoff / self.bins as f64)) as usize;
            if bin >= self.bins {
                continue;
            }
            let kinds = [pair.i, pair.j].map(|i| p.kind[i as usize]);
            for (k, [middle, around]) in self.pairs.iter().enumerate() {
                for [a, b] in [kinds, [kinds[1], kinds[0]]] {
                    if is(*middle, a) && is(*around, b) {
                        counts[k * self.bins + bin] += 1.0;
                    }
                }
            }
        }
        counts
    }

    /// Number of central particles, of surrounding ones, and of particles that are both.
    fn numbers(&self, w: &World, [middle, around]: [(u16, u16); 2]) -> [f64; 3] {
        let (p, mut n) = (&w.particles, [0.0; 3]);
        for i in (0..w.n()).filter(|&i| p.mask[i] & self.group.bit() != 0) {
            let (a, b) = (is(middle, p.kind[i]), is(around, p.kind[i]));
            for (n, yes) in n.iter_mut().zip([a, b, a && b]) {
                *n += if yes { 1.0 } else { 0.0 };
            }
        }
        n
    }

    fn rows(&self, w: &World, cutoff: f64) -> Result<Vec<f64>> {
        let (flat, [lx, ly, lz]) = (w.settings.two_dimensional, w.domain()?.lengths());
        let width = cutoff / self.bins as f64;
        let share = |k: usize| {
            let [lower, upper] = [k, k + 1].map(|k| k as f64 * width);
            match flat {
                true => PI / (lx * ly) * (upper * upper - lower * lower),
                false => 4.0 * PI / (3.0 * lx * ly * lz) * (upper * upper * upper - lower * lower * lower),
            }
        };
        let (counts, columns) = (self.counted(w, cutoff), 1 + 2 * self.pairs.len());
        let mut rows = vec![0.0; self.bins * columns];
        (0..self.bins).for_each(|k| rows[k * columns] = (k as f64 + 0.5) * width);
        for (m, pair) in self.pairs.iter().enumerate() {
            let [middle, around, both] = self.numbers(w, *pair);
            // A particle is not its own neighbour.
            let others = if middle > 0.0 { around - both / middle } else { 0.0 };
            let mut nearer = 0.0;
            for k in 0..self.bins {
                let even = share(k) * others;
                let g = if even * middle != 0.0 { counts[m * self.bins + k] / (even * middle) } else { 0.0 };
                nearer += g * even;
                rows[k * columns + 1 + 2 * m] = g;
                rows[k * columns + 2 + 2 * m] = nearer;
            }
        }
        Ok(rows)
    }
}

fn is((lo, hi): (u16, u16), kind: u16) -> bool {
    (lo..=hi).contains(&kind)
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { array: 1 + 2 * self.pairs.len(), array_rows: self.bins, ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (me, at) = (self.clone(), cx.span());
        let cutoff = reach(&self.id, self.cutoff, at, cx)?;
        Ok(fill(
            &self.id,
            &Wanted { slot, stage, when },
            X | KIND | MASK | BOX | BONDS | FAMILIES | TAG | MOLECULE | RADIUS,
            move |w, _, out| {
                (out.array, out.array_cols) = (me.rows(w, cutoff)?, 1 + 2 * me.pairs.len());
                Ok(())
            },
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn two_neighbours() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        b.world.types = 2;
        b.world.particles.kind[2] = 2;
        let c = b.compute(&Rdf, "2 1 2 * * cutoff 1.6").unwrap();
        let rows = b.evaluate(&*c).unwrap().array.clone();
        // The second shell, 0.8 to 1.6: there are two of type 1; for one the particle of type 2 is at 1.0,
        // for the other at √2.
        let even = 4.0 / 3.0 * PI * (1.6f64.powi(3) - 0.8f64.powi(3)) / 8000.0;
        assert!((rows[0] - 0.4).abs() < 1e-15 && (rows[5] - 1.2).abs() < 1e-15 && rows[1] == 0.0);
        assert!((rows[6] - 1.0 / even).abs() < 1e-9 / even && (rows[7] - 1.0).abs() < 1e-12);
        assert!((rows[9] - 2.0).abs() < 1e-12);
        for words in ["", "0", "5 1", "5 1 3", "5 cutoff", "5 cutoff 0", "5 cutoff 1 1 1", "5 cutoff 11"] {
            let c = b.compute(&Rdf, words);
            assert!(c.is_err() || b.evaluate(&*c.unwrap()).is_err(), "{words}");
        }
        // No pair style.
        let c = b.compute(&Rdf, "5").unwrap();
        assert!(b.evaluate(&*c).is_err());
    }
}
