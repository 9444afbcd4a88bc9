//! The coarse-graining kernel: a Gaussian with cutoff, shifted to zero there and normalized.

use perigrain_base::math::vec3::{Vec3, dot};
use std::f64::consts::PI;

/// W(r) = a (exp(−r²/2w²) − exp(−c²/2w²)) within the cutoff c, 0 beyond it, with ∫ W = 1 over the dimensions of the bins.
#[derive(Clone, Copy, Debug)]
pub struct Kernel {
    /// c [length].
    pub cutoff: f64,
    /// w [length].
    width: f64,
    /// a [1/length^dimensions].
    scale: f64,
}

/// Widths beyond which exp(−x²/2) is 0 in double precision.
const FAR: f64 = 39.0;

/// Nodes above the middle of (−1, 1) and weights of Gauss' rule of six points.
const GAUSS: [(f64, f64); 3] = [
    (0.238_619_186_083_196_9, 0.467_913_934_572_691),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152_1, 0.171_324_492_379_170_4),
];

/// ∫ f from `lo` to `hi` by Gauss' rule on panels no longer than `panel`.
fn integral(lo: f64, hi: f64, panel: f64, f: impl Fn(f64) -> f64) -> f64 {
    let n = ((hi - lo) / panel).ceil().max(1.0);
    let half = 0.5 * (hi - lo) / n;
    let one = |k: usize| {
        let middle = lo + (2 * k + 1) as f64 * half;
        let pair = |(x, weight): (f64, f64)| weight * (f(middle - half * x) + f(middle + half * x));
        GAUSS.map(pair).iter().sum::<f64>()
    };
    half * (0..n as usize).map(one).sum::<f64>()
}

impl Kernel {
    /// The kernel in 1, 2 or 3 dimensions; `None` if its numbers exceed double precision.
    ///
    /// By parts, ∫ W = S/d ∫ r^d (−dW/dr) dr with the surface S of the unit sphere: a sum of positive terms,
    /// accurate even where the two exponentials of W nearly cancel.
    pub fn new(dimensions: usize, cutoff: f64, width: f64) -> Option<Self> {
        let d = dimensions as i32;
        let surface = [2.0, 2.0 * PI, 4.0 * PI][dimensions - 1];
        let far = (cutoff / width).min(FAR);
        let moment = integral(0.0, far, 0.5, |x| x.powi(d + 1) * (-0.5 * x * x).exp());
        let scale = f64::from(d) / (surface * width.powi(d) * moment);
        (scale.is_finite() && scale > 0.0).then_some(Self { cutoff, width, scale })
    }

    /// W for a squared distance.
    pub fn at(&self, r2: f64) -> f64 {
        let c2 = self.cutoff * self.cutoff;
        if r2 >= c2 {
            return 0.0;
        }
        let twice = 2.0 * self.width * self.width;
        let (here, edge) = (r2 / twice, c2 / twice);
        let shifted =
            if edge < 1.0 { (-edge).exp() * (edge - here).exp_m1() } else { (-here).exp() - (-edge).exp() };
        self.scale * shifted
    }

    /// ∫₀¹ W(|start + s along|) ds.
    ///
    /// On panels of at most one width, the error of Gauss' six-point rule is below (6!)⁴/(13 (12!)³)
    /// max|d¹²/dx¹² exp(−x²/2)| = 2·10⁻¹² of W(0).
    pub fn along(&self, start: Vec3, along: Vec3) -> f64 {
        let e2 = dot(along, along);
        let at = |s: f64| std::array::from_fn::<f64, 3, _>(|k| start[k] + s * along[k]);
        let square = |a: Vec3| dot(a, a);
        if e2 <= 1e-24 * self.width * self.width {
            return self.at(square(at(0.5)));
        }
        let near = -dot(start, along) / e2;
        let h2 = square(at(near));
        let reach = self.cutoff.min(FAR * self.width);
        let half = ((reach * reach - h2).max(0.0) / e2).sqrt();
        let (lo, hi) = ((near - half).max(0.0), (near + half).min(1.0));
        if lo >= hi {
            return 0.0;
        }
        integral(lo, hi, self.width / e2.sqrt(), |s| self.at(h2 + (s - near) * (s - near) * e2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Midpoint sums of W over a mesh of `n` points per cutoff.
    fn sum(dimensions: usize, cutoff: f64, width: f64, n: i32) -> f64 {
        let k = Kernel::new(dimensions, cutoff, width).unwrap();
        let h = cutoff / f64::from(n);
        let side = |d: usize| if d < dimensions { -n..n } else { 0..1 };
        let place = |d: usize, i: i32| if d < dimensions { (f64::from(i) + 0.5) * h } else { 0.0 };
        let mut sum = 0.0;
        for (x, y, z) in side(0)
            .flat_map(|x| side(1).map(move |y| (x, y)))
            .flat_map(|(x, y)| side(2).map(move |z| (x, y, z)))
        {
            let r = [place(0, x), place(1, y), place(2, z)];
            sum += k.at(dot(r, r));
        }
        sum * h.powi(dimensions as i32)
    }

    #[test]
    fn its_integral_is_one() {
        // The sum's own error comes from the kink at the cutoff: h² times the slope there.
        for (d, n, tolerance) in [(1, 2000, 1e-6), (2, 150, 1e-4), (3, 30, 2e-3)] {
            for (cutoff, width) in [(4.0, 2.0), (1.0, 0.3), (2.0, 1.0), (1.0, 1e4)] {
                let sum = sum(d, cutoff, width, n);
                assert!((sum - 1.0).abs() < tolerance, "{d} dimensions, {cutoff} {width}: {sum}");
            }
        }
        // Without a cutoff it is a plain Gaussian.
        let k = Kernel::new(1, 100.0, 1.0).unwrap();
        assert!((k.at(0.0) * (2.0 * PI).sqrt() - 1.0).abs() < 1e-12);
        assert!(Kernel::new(3, 1e-200, 1.0).is_none());
    }

    #[test]
    fn lines_are_integrated_to_ten_digits() {
        let k = Kernel::new(3, 1.0, 0.3).unwrap();
        let fine = |start: Vec3, along: Vec3| {
            let n = 200_000;
            let at = |s: f64| {
                let r: Vec3 = std::array::from_fn(|a| start[a] + s * along[a]);
                k.at(dot(r, r))
            };
            (0..n).map(|i| at((f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() / f64::from(n)
        };
        for (start, along) in [
            ([0.1, -0.2, 0.3], [0.2, 0.1, -0.4]),
            ([-3.0, 0.2, 0.1], [7.0, 0.1, 0.0]),
            ([0.5, 0.5, 0.0], [0.6, 0.9, 0.1]),
            ([0.1, 0.0, 0.0], [1e-14, 0.0, 0.0]),
        ] {
            let (got, wanted) = (k.along(start, along), fine(start, along));
            // Apart from the kink, the error of the fine sum is its step squared.
            assert!((got - wanted).abs() < 1e-9 * k.at(0.0), "{start:?}: {got} {wanted}");
        }
        assert_eq!(k.along([2.0, 0.0, 0.0], [0.0, 1.0, 0.0]), 0.0);
    }
}
