//! The simulation box: faces, periodicity, wrapping, shrink-wrapping.

use perigrain_base::math::cformat::general;
use perigrain_base::math::periods::Periods;

/// What a face of the box does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub enum Face {
    /// `p`: periodic.
    #[default]
    Periodic,
    /// `f`: fixed; a particle beyond it is lost.
    Fixed,
    /// `s`: follows the outermost particle.
    Shrink,
    /// `m`: as `s`, but never inside the bound given at creation.
    ShrinkMin,
}

/// The two faces (lo, hi) of each dimension, as the `boundary` command gives them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub struct Boundary(pub [[Face; 2]; 3]);

impl Boundary {
    /// Whether a dimension is periodic.
    pub fn periodic(&self, d: usize) -> bool {
        self.0[d][0] == Face::Periodic
    }

    /// LAMMPS' letters, as `pp ff ss`.
    pub fn letters(&self) -> String {
        let letter = |f: Face| match f {
            Face::Periodic => 'p',
            Face::Fixed => 'f',
            Face::Shrink => 's',
            Face::ShrinkMin => 'm',
        };
        self.0.iter().map(|[a, b]| format!("{}{}", letter(*a), letter(*b))).collect::<Vec<_>>().join(" ")
    }
}

/// A box between six faces, of which all but the lowest edges may lean: a restricted triclinic box in LAMMPS' words.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Domain {
    /// Lower corner [length].
    pub lo: [f64; 3],
    /// Upper corner [length].
    pub hi: [f64; 3],
    /// What the faces do.
    pub boundary: Boundary,
    /// Extra room beyond the outermost particle of a shrink-wrapped face: 1e-4 of the first box.
    pub small: [f64; 3],
    /// Bounds that `m` faces never go inside of.
    pub min_lo: [f64; 3],
    /// See `min_lo`.
    pub min_hi: [f64; 3],
    /// Whether the scene lies in the plane z = 0: particles see no images along z.
    pub flat: bool,
    /// How the edges lean, xy, xz and yz [length]; none where the box is orthogonal by declaration.
    #[serde(default)]
    pub tilt: Option<[f64; 3]>,
    /// The box of the same lattice that the next rebuild of lists puts in its place (`fix deform`).
    #[serde(default)]
    pub flip: Option<Flip>,
    /// How the box grows, where particles that cross a face take part (`fix deform … remap v`).
    #[serde(default)]
    pub flow: Option<Flow>,
}

/// A box of the same lattice that leans less.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Flip {
    /// Its tilts [length].
    pub tilt: [f64; 3],
    /// How many edges they are away from the present ones: of x in xy and in xz, of y in yz.
    pub turns: [i32; 3],
}

impl Flip {
    /// The image counts that a place has in the new box, before it is wrapped into that.
    pub fn recount(&self, [x, y, z]: [i32; 3]) -> [i32; 3] {
        let [xy, xz, yz] = self.turns;
        let y = y.saturating_sub(yz.saturating_mul(z));
        [x.saturating_sub(xy.saturating_mul(y)).saturating_sub(xz.saturating_mul(z)), y, z]
    }
}

/// A growing box whose faces carry particles along.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Flow {
    /// How fast each length grows [length/time].
    pub rate: [f64; 3],
    /// How fast each tilt grows [length/time].
    #[serde(default)]
    pub tilt: [f64; 3],
    /// Whose velocities change.
    pub group: super::GroupId,
}

impl Flow {
    /// How much faster the image is that lies so many edges off.
    #[inline]
    pub fn velocity(&self, n: [f64; 3]) -> [f64; 3] {
        let ([x, y, z], [xy, xz, yz]) = (self.rate, self.tilt);
        [n[0] * x + n[1] * xy + n[2] * xz, n[1] * y + n[2] * yz, n[2] * z]
    }
}

impl Domain {
    /// A box between two corners with these faces.
    pub fn new(lo: [f64; 3], hi: [f64; 3], boundary: Boundary) -> Self {
        let small = [0, 1, 2].map(|d| 1e-4 * (hi[d] - lo[d]));
        Self {
            lo,
            hi,
            boundary,
            small,
            min_lo: lo,
            min_hi: hi,
            flat: false,
            tilt: None,
            flip: None,
            flow: None,
        }
    }

    /// Moves shrink-wrapped faces a little outside, so that particles on the faces as given are inside (LAMMPS).
    pub fn open_shrinking_faces(&mut self) {
        for d in 0..3 {
            if self.boundary.0[d][0] == Face::Shrink {
                self.lo[d] -= self.small[d];
            }
            if self.boundary.0[d][1] == Face::Shrink {
                self.hi[d] += self.small[d];
            }
        }
    }

    /// Edge lengths [length].
    pub fn lengths(&self) -> [f64; 3] {
        [0, 1, 2].map(|d| self.hi[d] - self.lo[d])
    }

    /// The edges, whether the box repeats along them or not.
    pub fn edges(&self) -> Periods {
        Periods { length: self.lengths(), tilt: self.tilt.unwrap_or_default() }
    }

    /// The edges along which particles see images of each other, of length zero elsewhere; these may lean too.
    pub fn periods(&self) -> Periods {
        let (lengths, periodic) = (self.lengths(), self.periodic());
        let length = std::array::from_fn(|k| if periodic[k] { lengths[k] } else { 0.0 });
        Periods { length, tilt: self.tilt.unwrap_or_default() }
    }

    /// Whether some edge leans now.
    #[inline]
    pub fn tilted(&self) -> bool {
        self.tilt.is_some_and(|tilt| tilt != [0.0; 3])
    }

    /// Where a place would be were the box upright: along each axis between the same faces `lo` and `hi`.
    #[inline]
    pub fn upright(&self, x: &[f64; 3]) -> [f64; 3] {
        self.edges().straightened(*x, self.lo)
    }

    /// Where in the box a place is along each edge, 0 at the lower face and 1 at the upper one.
    pub fn fractions(&self, x: &[f64; 3]) -> [f64; 3] {
        self.edges().fractions([0, 1, 2].map(|d| x[d] - self.lo[d]))
    }

    /// The place at these fractions of the edges.
    pub fn at(&self, fractions: [f64; 3]) -> [f64; 3] {
        let by = self.edges().shift(fractions);
        [0, 1, 2].map(|d| self.lo[d] + by[d])
    }

    /// The corners of the upright box around this one: where `xlo_bound` … are in LAMMPS' dumps.
    pub fn bounds(&self) -> [[f64; 2]; 3] {
        let [xy, xz, yz] = self.tilt.unwrap_or_default();
        let least = |a: [f64; 4]| a.into_iter().fold(0.0, f64::min);
        let most = |a: [f64; 4]| a.into_iter().fold(0.0, f64::max);
        let (x, y) = ([0.0, xy, xz, xy + xz], [0.0, yz, 0.0, 0.0]);
        [
            [self.lo[0] + least(x), self.hi[0] + most(x)],
            [self.lo[1] + least(y), self.hi[1] + most(y)],
            [self.lo[2], self.hi[2]],
        ]
    }

    /// The eight corners of the box.
    pub fn corners(&self) -> [[f64; 3]; 8] {
        std::array::from_fn(|k| self.at([k & 1, k >> 1 & 1, k >> 2 & 1].map(|n| n as f64)))
    }

    /// A place unwrapped: moved by as many edges as its image counts.
    pub fn unwrapped(&self, x: &[f64; 3], image: &[i32; 3]) -> [f64; 3] {
        let by = self.edges().shift(image.map(f64::from));
        [0, 1, 2].map(|d| x[d] + by[d])
    }

    /// This box with these corners, as LAMMPS prints it.
    pub fn describe(&self, lo: [f64; 3], hi: [f64; 3]) -> String {
        let text = |x: [f64; 3]| x.map(|x| general(x, 8)).join(" ");
        match self.tilt {
            None => format!("orthogonal box = ({}) to ({})", text(lo), text(hi)),
            Some(tilt) => {
                format!("triclinic box = ({}) to ({}) with tilt ({})", text(lo), text(hi), text(tilt))
            }
        }
    }

    /// Volume [length³] (area in two dimensions is the caller's business).
    pub fn volume(&self) -> f64 {
        let l = self.lengths();
        l[0] * l[1] * l[2]
    }

    /// Along which dimensions particles see images of each other: the periodic ones, without z in a flat scene.
    pub fn periodic(&self) -> [bool; 3] {
        [0, 1, 2].map(|d| self.boundary.periodic(d) && !(self.flat && d == 2))
    }

    /// Wraps a position into the box along periodic dimensions and counts the crossings in `image`.
    pub fn wrap(&self, x: &mut [f64; 3], image: &mut [i32; 3]) {
        if self.tilted() {
            return self.wrap_tilted(x, image);
        }
        for d in 0..3 {
            if !self.boundary.periodic(d) {
                continue;
            }
            let l = self.hi[d] - self.lo[d];
            if x[d] < self.lo[d] {
                x[d] += l;
                image[d] = image[d].saturating_sub(1);
                if x[d] < self.lo[d] {
                    let k = ((x[d] - self.lo[d]) / l).floor();
                    x[d] -= k * l;
                    image[d] = image[d].saturating_add(k as i32);
                }
                // By rounding, at most.
                x[d] = x[d].max(self.lo[d]);
            }
            if x[d] >= self.hi[d] {
                x[d] -= l;
                image[d] = image[d].saturating_add(1);
                if x[d] >= self.hi[d] {
                    let k = ((x[d] - self.lo[d]) / l).floor();
                    x[d] -= k * l;
                    image[d] = image[d].saturating_add(k as i32);
                }
                x[d] = x[d].max(self.lo[d]);
            }
        }
    }

    fn wrap_tilted(&self, x: &mut [f64; 3], image: &mut [i32; 3]) {
        let edges = self.edges();
        // Crossing a face of z shifts y and x, and one of y shifts x.
        for d in [2, 1, 0] {
            if !self.boundary.periodic(d) {
                continue;
            }
            // A particle just below the lower face may by rounding arrive at the upper one, and goes back.
            for _ in 0..2 {
                let turns = self.fractions(x)[d].floor();
                if turns == 0.0 || !turns.is_finite() {
                    break;
                }
                let mut n = [0.0; 3];
                n[d] = turns;
                let by = edges.shift(n);
                (0..3).for_each(|k| x[k] -= by[k]);
                image[d] = image[d].saturating_add(turns as i32);
            }
        }
    }

    /// Shortest difference under periodic boundaries (minimum image).
    #[inline]
    pub fn minimum_image(&self, mut d: [f64; 3]) -> [f64; 3] {
        if self.tilted() {
            return self.every_period().nearest(d);
        }
        for k in 0..3 {
            if self.boundary.periodic(k) {
                let l = self.hi[k] - self.lo[k];
                if d[k].abs() > 0.5 * l {
                    d[k] -= l * (d[k] / l).round();
                }
            }
        }
        d
    }

    /// The edges along which the box is periodic, z in a flat scene too.
    fn every_period(&self) -> Periods {
        Self { flat: false, ..self.clone() }.periods()
    }

    /// Moves shrink-wrapped faces to the extent of the particles, which lie between these corners, as LAMMPS does at every
    /// reneighbouring; in a tilted box these are corners of [`Domain::upright`] places.
    pub fn shrink(&mut self, [lo, hi]: [[f64; 3]; 2]) {
        for d in 0..3 {
            match self.boundary.0[d][0] {
                Face::Shrink => self.lo[d] = lo[d] - self.small[d],
                Face::ShrinkMin => self.lo[d] = (lo[d] - self.small[d]).min(self.min_lo[d]),
                _ => {}
            }
            match self.boundary.0[d][1] {
                Face::Shrink => self.hi[d] = hi[d] + self.small[d],
                Face::ShrinkMin => self.hi[d] = (hi[d] + self.small[d]).max(self.min_hi[d]),
                _ => {}
            }
        }
    }

    /// Whether some face goes with the particles.
    pub fn shrinks(&self) -> bool {
        self.boundary.0.iter().flatten().any(|face| matches!(face, Face::Shrink | Face::ShrinkMin))
    }

    /// Whether a point is inside the box, lower faces inclusive.
    pub fn holds(&self, x: &[f64; 3]) -> bool {
        let x = self.upright(x);
        (0..3).all(|d| x[d] >= self.lo[d] && x[d] < self.hi[d])
    }

    /// Whether a point is inside all fixed faces (upper faces exclusive, as LAMMPS loses particles).
    pub fn keeps(&self, x: &[f64; 3]) -> bool {
        (0..3).all(|d| self.keeps_along(d, x))
    }

    /// Whether a point is inside the fixed faces across one axis.
    pub fn keeps_along(&self, d: usize, x: &[f64; 3]) -> bool {
        self.keeps_upright_along(d, &self.upright(x))
    }

    /// Whether an [`Domain::upright`] place is inside all fixed faces.
    pub fn keeps_upright(&self, x: &[f64; 3]) -> bool {
        (0..3).all(|d| self.keeps_upright_along(d, x))
    }

    fn keeps_upright_along(&self, d: usize, x: &[f64; 3]) -> bool {
        let [low, high] = self.boundary.0[d];
        (low != Face::Fixed || x[d] >= self.lo[d]) && (high != Face::Fixed || x[d] < self.hi[d])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_base::math::rng::ParkMiller;

    fn leaning(tilt: [f64; 3], faces: [Face; 3]) -> Domain {
        let boundary = Boundary(faces.map(|f| [f; 2]));
        Domain { tilt: Some(tilt), ..Domain::new([1.0, -2.0, 0.5], [4.0, 0.0, 3.0], boundary) }
    }

    #[test]
    fn what_is_wrapped_lies_inside_and_unwraps_to_where_it_was() {
        let mut random = ParkMiller::new(5);
        let tilts = [[1.5, 0.0, 0.0], [-1.5, 1.2, 0.9], [0.0, 0.0, -1.0], [1e-300, 0.0, 0.0]];
        for tilt in tilts.map(Some).into_iter().chain([None]) {
            let domain = Domain { tilt, ..leaning([0.0; 3], [Face::Periodic; 3]) };
            for _ in 0..300 {
                let start = [0, 1, 2].map(|_| 20.0 * random.uniform() - 10.0);
                let (mut x, mut image) = (start, [0; 3]);
                domain.wrap(&mut x, &mut image);
                let inside = domain.fractions(&x);
                assert!(inside.iter().all(|f| (-1e-15..1.0 + 1e-15).contains(f)), "{inside:?}");
                let back = domain.unwrapped(&x, &image);
                assert!((0..3).all(|d| (back[d] - start[d]).abs() < 1e-13), "{start:?} {back:?}");
                let again = (x, image);
                domain.wrap(&mut x, &mut image);
                assert_eq!((x, image), again);
            }
        }
    }

    #[test]
    fn no_particle_is_wrapped_across_fixed_faces() {
        let domain = leaning([1.0, 0.0, 0.0], [Face::Shrink, Face::Periodic, Face::Fixed]);
        let (mut x, mut image) = ([9.0, 0.5, 7.0], [0; 3]);
        domain.wrap(&mut x, &mut image);
        assert_eq!((x, image), ([8.0, -1.5, 7.0], [0, 1, 0]));
        assert!(!domain.keeps(&x) && domain.keeps(&[99.0, 0.0, 1.0]));
        assert_eq!(domain.periods(), Periods { length: [0.0, 2.0, 0.0], tilt: [1.0, 0.0, 0.0] });
    }

    #[test]
    fn a_flip_leaves_all_particles_in_place() {
        let mut domain = leaning([1.6, -0.5, 1.2], [Face::Periodic; 3]);
        let flip = Flip { tilt: [1.6 - 3.0, -0.5 + 3.0 - 1.6, 1.2 - 2.0], turns: [-1, 1, -1] };
        let (mut x, mut image) = ([4.5, -0.5, 2.5], [2, -3, 5]);
        let before = domain.unwrapped(&x, &image);
        domain.tilt = Some(flip.tilt);
        image = flip.recount(image);
        domain.wrap(&mut x, &mut image);
        let after = domain.unwrapped(&x, &image);
        assert!((0..3).all(|d| (before[d] - after[d]).abs() < 1e-12), "{before:?} {after:?}");
    }

    #[test]
    fn bounds_and_corners_of_a_leaning_box() {
        let domain = leaning([1.5, -0.5, 1.0], [Face::Periodic; 3]);
        assert_eq!(domain.bounds(), [[0.5, 5.5], [-2.0, 1.0], [0.5, 3.0]]);
        let corners = domain.corners();
        assert_eq!((corners[0], corners[7]), ([1.0, -2.0, 0.5], [5.0, 1.0, 3.0]));
        let upright = Domain { tilt: None, ..domain };
        assert_eq!(upright.bounds(), [[1.0, 4.0], [-2.0, 0.0], [0.5, 3.0]]);
        assert_eq!(upright.upright(&[1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
    }
}
