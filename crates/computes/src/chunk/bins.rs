//! Spatial bins: layers along an axis, shells around a point or an axis.

use super::words::Discard;
use perigrain_world::Domain;

/// Origin of the layers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// The lower bound.
    Lower,
    /// The middle of the bounds.
    Center,
    /// The upper bound.
    Upper,
    /// A coordinate.
    At(f64),
}

/// Layers along an axis, in units of the deck or in fractions of the box.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// The axis.
    pub dim: usize,
    /// Origin of the layers.
    pub origin: Origin,
    /// Their thickness.
    pub delta: f64,
    /// Bounds of the layers, if they do not fill the box.
    pub bound: [Option<f64>; 2],
}

/// Layers of the current box.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Layers {
    /// Lower face of the first.
    pub lo: f64,
    /// Their number.
    pub count: usize,
}

impl Axis {
    /// Converts lattice spacings to lengths.
    pub fn scale(&mut self, by: [f64; 3], bound: [[Option<f64>; 2]; 3]) {
        let s = by[self.dim];
        self.delta *= s;
        self.bound = bound[self.dim].map(|b| b.map(|b| b * s));
        if let Origin::At(x) = &mut self.origin {
            *x *= s;
        }
    }

    /// The layers that cover the box or the bounds, counted as in LAMMPS so that rounding is the same.
    pub fn layers(&self, d: &Domain, reduced: bool) -> Option<Layers> {
        let (box_lo, box_hi) = if reduced { (0.0, 1.0) } else { (d.lo[self.dim], d.hi[self.dim]) };
        let (low, high) = (self.bound[0].unwrap_or(box_lo), self.bound[1].unwrap_or(box_hi));
        let origin = match self.origin {
            Origin::Lower => low,
            Origin::Center => 0.5 * (low + high),
            Origin::Upper => high,
            Origin::At(x) => x,
        };
        let (delta, inverse) = (self.delta, 1.0 / self.delta);
        let whole = |length: f64| (length * inverse).trunc();
        let lo = if origin < low {
            origin + whole(low - origin) * delta
        } else {
            let lo = origin - whole(origin - low) * delta;
            if lo > low { lo - delta } else { lo }
        };
        let hi = if origin < high {
            let hi = origin + whole(high - origin) * delta;
            if hi < high { hi + delta } else { hi }
        } else {
            origin - whole(origin - high) * delta
        };
        let count = (hi - lo) * inverse + 0.5;
        (lo <= hi && count < 1e9).then_some(Layers { lo, count: count as usize })
    }

    /// The layer of a position, counted from 0; `None` if it is in no layer. LAMMPS 22Jul2025 with `mixed`
    /// also drops positions above a last layer that ends at the box.
    pub fn layer(&self, l: &Layers, x: f64, discard: Discard, lammps: bool) -> Option<usize> {
        let inverse = 1.0 / self.delta;
        let mut k = ((x - l.lo) * inverse).trunc();
        if x < l.lo {
            k -= 1.0;
        }
        let last = l.count as f64 - 1.0;
        let keep = |end: usize| match discard {
            Discard::Yes => false,
            Discard::No => true,
            Discard::Mixed => self.bound[end].is_none() && !(lammps && end == 1),
        };
        if (k < 0.0 && !keep(0)) || (k > last && !keep(1)) || l.count == 0 {
            return None;
        }
        Some(k.clamp(0.0, last) as usize)
    }
}

/// Shells around a point, or rings around an axis.
#[derive(Clone, Copy, Debug)]
pub struct Shells {
    /// The point; its coordinate along a cylinder's axis is ignored.
    pub center: [f64; 3],
    /// Innermost radius.
    pub lo: f64,
    /// Outermost radius.
    pub hi: f64,
    /// How many.
    pub count: usize,
    /// Rings: the last of `dims` is the axis.
    pub flat: bool,
    /// The directions in order.
    pub dims: [usize; 3],
}

impl Shells {
    /// Converts lattice spacings to lengths; radii use the spacing of the first direction across.
    pub fn scale(&mut self, by: [f64; 3]) {
        (0..3).for_each(|d| self.center[d] *= by[d]);
        let s = by[self.dims[0]];
        (self.lo, self.hi) = (self.lo * s, self.hi * s);
    }

    /// The shells in lengths, if they were given in fractions of the box.
    pub fn in_box(&self, d: &Domain, reduced: bool) -> Self {
        if !reduced {
            return *self;
        }
        let mut s = *self;
        let l = d.lengths();
        (0..3).for_each(|k| s.center[k] = self.center[k] * l[k] + d.lo[k]);
        let first = l[self.dims[0]];
        (s.lo, s.hi) = (self.lo * first, self.hi * first);
        s
    }

    /// Thickness of a shell.
    pub fn delta(&self) -> f64 {
        (self.hi - self.lo) / self.count as f64
    }

    /// The shell of a position, counted from 0; `None` if it is in no shell.
    pub fn shell(&self, d: &Domain, x: [f64; 3], pbc: bool, discard: Discard) -> Option<usize> {
        let mut r2 = 0.0;
        for &k in &self.dims[..if self.flat { 2 } else { 3 }] {
            let mut a = x[k] - self.center[k];
            let length = d.hi[k] - d.lo[k];
            if pbc && d.boundary.periodic(k) && a.abs() > 0.5 * length {
                a += if a < 0.0 { length } else { -length };
            }
            r2 += a * a;
        }
        let r: f64 = f64::sqrt(r2);
        let inverse = self.count as f64 / (self.hi - self.lo);
        let mut k = ((r - self.lo) * inverse).trunc();
        if r < self.lo {
            k -= 1.0;
        }
        let last = self.count as f64 - 1.0;
        if discard == Discard::Yes && !(0.0..=last).contains(&k) {
            return None;
        }
        Some(k.clamp(0.0, last) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_world::Boundary;

    // Oracle: LAMMPS 22Jul2025 prints the centres of the first and last bin in a box from 0 to 7.3.
    #[test]
    fn layers_cover_the_box_from_any_origin() {
        let d = Domain::new([0.0; 3], [7.3; 3], Boundary::default());
        let first_and_last = |origin, delta, bound| {
            let a = Axis { dim: 1, origin, delta, bound };
            let l = a.layers(&d, false).unwrap();
            [l.lo + 0.5 * delta, l.lo + (l.count as f64 - 0.5) * delta].map(|c| (c * 1e6).round() / 1e6)
        };
        let free = [None; 2];
        assert_eq!(first_and_last(Origin::At(2.0), 1.5, free), [-0.25, 7.25]);
        assert_eq!(first_and_last(Origin::At(9.0), 1.5, free), [0.75, 6.75]);
        assert_eq!(first_and_last(Origin::At(-1.1), 1.5, free), [-0.35, 7.15]);
        assert_eq!(first_and_last(Origin::Center, 1.5, free), [-0.1, 7.4]);
        let bound = [Some(1.7), Some(5.2)];
        assert_eq!(first_and_last(Origin::Upper, 1.5, bound), [1.45, 4.45]);
        assert_eq!(first_and_last(Origin::Lower, 1.5, bound), [2.45, 5.45]);
        assert_eq!(first_and_last(Origin::At(3.3), 0.7, bound), [1.55, 5.05]);
    }

    #[test]
    fn particles_outside_go_where_discard_puts_them() {
        let a = Axis { dim: 0, origin: Origin::Lower, delta: 1.0, bound: [Some(0.0), None] };
        let l = Layers { lo: 0.0, count: 3 };
        let of = |discard| [-0.5, 0.5, 2.999, 3.0].map(|x| a.layer(&l, x, discard, false));
        assert_eq!(of(Discard::Yes), [None, Some(0), Some(2), None]);
        assert_eq!(of(Discard::No), [Some(0), Some(0), Some(2), Some(2)]);
        assert_eq!(of(Discard::Mixed), [None, Some(0), Some(2), Some(2)]);
        assert_eq!(a.layer(&l, 3.0, Discard::Mixed, true), None);
    }
}
