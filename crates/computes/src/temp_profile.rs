//! compute temp/profile: temperature relative to the mean velocities of bins.

use super::thermal::{Streams, Taken, Thermal, dimension};
use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::memory;
use perigrain_lang::Args;
use perigrain_styles::matter::{Masses, count};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::{GroupId, World};

/// The style.
pub struct TempProfile;

impl Style for TempProfile {
    fn name(&self) -> &'static str {
        "temp/profile"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "compute ID group temp/profile 0|1 0|1 0|1 x|y|z|xy|yz|xz|xyz N … [out tensor|bin]",
            summary: "Temperature of the group without the mean velocity of each part of the box.",
            text: "As `compute temp`, of velocities from which the components x, y, z that are given as 1 of the mean of their bin, \
                   weighted with mass, are taken away. The box is cut into N equal bins along each of the axes that are named. Degrees of \
                   freedom: d N − s B − `extra/dof` of N particles, B bins and s components, `extra/dof` being d − s unless \
                   `compute_modify` says otherwise.\n\n\
                   `out bin` gives, instead of the vector of the tensor, a global array (intensive) with a row for each bin, x varying fastest: \
                   how many particles it has and their temperature, of d n − s − `extra/dof` n/N degrees of freedom; 0 where these are not positive.",
            example: "compute t all temp/profile 1 1 1 z 2",
        }
    }
}

impl ComputeStyle for TempProfile {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let mut one = || -> Result<bool> { Ok(args.choice("flag of a component", &["0", "1"])? == "1") };
        let streams = [one()?, one()?, one()?];
        let flat = cx.world.settings.two_dimensional;
        if streams[2] && flat {
            let text = "velocities along z do not count in a flat scene (`dimension 2`)";
            return fail(Code::CONFLICT, cx.span, text);
        }
        let span = args.here();
        let axes = args.choice("axes of bins", &["x", "y", "z", "xy", "yz", "xz", "xyz"])?;
        if axes.contains('z') && flat {
            return fail(Code::CONFLICT, span, "a flat scene (`dimension 2`) has no bins along z");
        }
        let mut bins = [1; 3];
        for axis in axes.bytes() {
            bins[usize::from(axis - b'x')] = args.integer_from(1, "the number of bins")? as usize;
        }
        if bins.iter().try_fold(1usize, |all, n| all.checked_mul(*n)).is_none_or(|all| all > MOST) {
            return fail(Code::BAD_VALUE, span, format!("more than {MOST} bins"));
        }
        let bytes = bins.iter().map(|n| *n as f64).product::<f64>() * BYTES_PER_BIN;
        if let Some(d) = memory::lacking(bytes, "so many bins") {
            return Err(d.at(span).into());
        }
        let mut by_bin = false;
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "out" => by_bin = args.choice("value of out", &["tensor", "bin"])? == "bin",
                _ => return Err(args.unknown(word, &["out"])),
            }
        }
        Ok(Box::new(Thermal::new(Profile { streams, bins, by_bin }, cx)))
    }
}

/// Bytes per bin: sums, means and an output row.
const BYTES_PER_BIN: f64 = 64.0;

/// A larger number of bins is refused.
const MOST: usize = 100_000_000;

/// Mean velocities of bins.
#[derive(Clone)]
struct Profile {
    /// Components that are subtracted.
    streams: [bool; 3],
    /// Bins along each axis.
    bins: [usize; 3],
    /// `out bin`.
    by_bin: bool,
}

impl Profile {
    fn all_bins(&self) -> usize {
        self.bins.iter().product()
    }

    fn components(&self) -> f64 {
        self.streams.iter().filter(|s| **s).count() as f64
    }
}

impl Streams for Profile {
    fn by_sums(&self) -> bool {
        false
    }

    fn taken<'a>(&'a self, w: &'a World, group: GroupId) -> Taken<'a> {
        let (p, masses) = (&w.particles, Masses::of(w));
        let mut means = vec![[0.0; 4]; self.all_bins()];
        for i in (0..w.n()).filter(|&i| p.mask[i] & group.bit() != 0) {
            let (m, mean) = (masses.get(i), &mut means[self.bin(w, i)]);
            (0..3).for_each(|d| mean[d] += m * p.v[i][d]);
            mean[3] += m;
        }
        for mean in means.iter_mut().filter(|mean| mean[3] > 0.0) {
            (0..3).for_each(|d| mean[d] /= mean[3]);
        }
        Box::new(move |i| {
            let mean = means[self.bin(w, i)];
            std::array::from_fn(|d| if self.streams[d] { mean[d] } else { 0.0 })
        })
    }

    fn freedom(&self, w: &World, group: GroupId, extra: Option<f64>) -> f64 {
        let extra = extra.unwrap_or(dimension(w) - self.components());
        dimension(w) * count(w, group) as f64 - extra - self.components() * self.all_bins() as f64
    }

    fn bins(&self) -> usize {
        if self.by_bin { self.all_bins() } else { 0 }
    }

    fn bin(&self, w: &World, i: usize) -> usize {
        let Some(domain) = &*w.domain else { return 0 };
        let (lengths, mut bin) = (domain.lengths(), 0);
        let at = domain.upright(&w.particles.x[i]);
        for d in [2, 1, 0] {
            let (mut x, bins) = (at[d], self.bins[d]);
            if domain.boundary.periodic(d) {
                x += if x < domain.lo[d] { lengths[d] } else { 0.0 };
                x -= if x >= domain.hi[d] { lengths[d] } else { 0.0 };
            }
            // Positions beyond the faces belong to the outermost bins.
            let place = ((x - domain.lo[d]) / lengths[d] * bins as f64).clamp(0.0, bins as f64 - 1.0);
            bin = bin * bins + place as usize;
        }
        bin
    }

    fn freedom_of_bin(&self, w: &World, n: f64, all: f64, extra: Option<f64>) -> f64 {
        let extra = extra.unwrap_or(dimension(w) - self.components());
        dimension(w) * n - self.components() - if all > 0.0 { extra * n / all } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn two_streams() {
        // The box reaches from -10 to 10.
        let x = [[-1.0, 0.0, 0.0], [-2.0, 0.0, 0.0], [2.0, 0.0, 0.0], [12.0, 0.0, 0.0], [3.0, 0.0, 0.0]];
        let mut b = Bench::new(AtomStyle::default(), &x);
        b.world.particles.v =
            vec![[1.0, 2.0, 0.0], [3.0, 0.0, 0.0], [5.0, 5.0, 0.0], [7.0, 5.0, 0.0], [6.0, 2.0, 0.0]].into();
        let c = b.compute(&TempProfile, "1 0 0 x 2").unwrap();
        // By hand, m = 2; the fourth is at -8: means 11/3 and 11/2.
        let (left, right) = (64.0 / 9.0 + 4.0 / 9.0 + 100.0 / 9.0 + 29.0, 0.5 + 29.0);
        let flow = c.flow(&b.world).unwrap();
        assert!((flow.taken[0][0] - 11.0 / 3.0).abs() < 1e-14 && flow.taken[0][1] == 0.0);
        assert_eq!(flow.taken[2], [5.5, 0.0, 0.0]);
        // 15 − 1 · 2 − 2 degrees of freedom.
        assert!((b.evaluate(&*c).unwrap().scalar - 2.0 * (left + right) / 11.0).abs() < 1e-13);
        let c = b.compute(&TempProfile, "1 0 0 x 2 out bin").unwrap();
        let shape = c.shape();
        assert_eq!((shape.vector, shape.array, shape.array_rows), (0, 2, 2));
        let rows = b.evaluate(&*c).unwrap().array.clone();
        // 3 n − 1 − 2 n/5.
        assert_eq!((rows[0], rows[2]), (3.0, 2.0));
        assert!((rows[1] - 2.0 * left / 6.8).abs() < 1e-13 && (rows[3] - 2.0 * right / 4.2).abs() < 1e-13);
        for words in [
            "",
            "1 1 1",
            "1 1 1 x",
            "1 1 1 x 0",
            "1 1 1 zx 1 1",
            "1 1 1 x 2 out all",
            "1 1 1 xyz 9999 9999 9999",
        ] {
            assert!(b.compute(&TempProfile, words).is_err(), "{words}");
        }
    }
}
