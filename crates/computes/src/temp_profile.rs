//! compute temp/profile: temperature relative to the mean velocities of bins.

use super::temp_flow::Component;
use super::thermal::{Streams, Taken, Thermal, dimension};
use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::memory;
use perigrain_lang::Args;
use perigrain_styles::matter::{Masses, count};
use perigrain_styles::words::{At, Kind, Syntax, Value, Whole, Words, read};
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
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Temperature of the group without the mean velocity of each part of the box.",
            text: "As `compute temp`, of velocities from which components of the mean of their bin, weighted with mass, are taken \
                   away. Degrees of freedom: d N − s B − `extra/dof` of N particles, B bins and s components, `extra/dof` being d − s unless \
                   `compute_modify` says otherwise.\n\n\
                   The rows of `out bin` are those of the bins, x varying fastest; temperatures are of d n − s − `extra/dof` n/N degrees of freedom; 0 where these are not positive.",
            example: "compute t all temp/profile 1 1 1 z 2",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Whether the mean's component along x, y, z is taken away: 1, else 0.
    #[word(name = "x y z", what = "flag of a component")]
    components: [Component; 3],
    #[word(what = "axes of bins")]
    axes: At<Axes>,
    #[word(keyword)]
    out: Out,
}

/// Along which axes the box is cut into equal bins, and into how many.
#[derive(Clone, Copy, Words)]
enum Axes {
    /// Slabs along x.
    X { nx: Count },
    /// Slabs along y.
    Y { ny: Count },
    /// Slabs along z.
    Z { nz: Count },
    /// Columns across x and y.
    Xy { nx: Count, ny: Count },
    /// Columns across y and z.
    Yz { ny: Count, nz: Count },
    /// Columns across x and z.
    Xz { nx: Count, nz: Count },
    /// Boxes.
    Xyz { nx: Count, ny: Count, nz: Count },
}

/// The number of bins along an axis.
#[derive(Clone, Copy)]
struct Count(usize);

impl Value for Count {
    const KIND: Kind = Kind::Whole;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        <usize as Whole>::from(args, 1, "the number of bins").map(Self)
    }
}

/// What stands beside the scalar.
#[derive(Clone, Copy, Default, PartialEq, Words)]
#[word(what = "value of out")]
enum Out {
    /// The vector of compute temp.
    #[default]
    Tensor,
    /// A global array (intensive) with a row for each bin: how many particles it has and their temperature.
    Bin,
}

impl Axes {
    fn bins(self) -> [usize; 3] {
        match self {
            Axes::X { nx } => [nx.0, 1, 1],
            Axes::Y { ny } => [1, ny.0, 1],
            Axes::Z { nz } => [1, 1, nz.0],
            Axes::Xy { nx, ny } => [nx.0, ny.0, 1],
            Axes::Yz { ny, nz } => [1, ny.0, nz.0],
            Axes::Xz { nx, nz } => [nx.0, 1, nz.0],
            Axes::Xyz { nx, ny, nz } => [nx.0, ny.0, nz.0],
        }
    }

    fn along_z(self) -> bool {
        matches!(self, Axes::Z { .. } | Axes::Yz { .. } | Axes::Xz { .. } | Axes::Xyz { .. })
    }
}

impl ComputeStyle for TempProfile {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { components, axes: At { value: axes, span, .. }, out } = read(args, cx)?;
        let (streams, bins) = (components.map(Component::counts), axes.bins());
        let flat = cx.world.settings.two_dimensional;
        if streams[2] && flat {
            let text = "velocities along z do not count in a flat scene (`dimension 2`)";
            return fail(Code::CONFLICT, cx.span, text);
        }
        if axes.along_z() && flat {
            return fail(Code::CONFLICT, span, "a flat scene (`dimension 2`) has no bins along z");
        }
        if bins.iter().try_fold(1usize, |all, n| all.checked_mul(*n)).is_none_or(|all| all > MOST) {
            return fail(Code::BAD_VALUE, span, format!("more than {MOST} bins"));
        }
        let bytes = bins.iter().map(|n| *n as f64).product::<f64>() * BYTES_PER_BIN;
        if let Some(d) = memory::lacking(bytes, "so many bins") {
            return Err(d.at(span).into());
        }
        let by_bin = out == Out::Bin;
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
