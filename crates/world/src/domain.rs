//! The simulation box: faces, periodicity, wrapping, shrink-wrapping.

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

/// An orthogonal box.
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
    /// How the box grows, where particles that cross a face take part (`fix deform … remap v`).
    #[serde(default)]
    pub flow: Option<Flow>,
}

/// A growing box whose faces carry particles along.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Flow {
    /// How fast each length grows [length/time].
    pub rate: [f64; 3],
    /// Whose velocities change.
    pub group: super::GroupId,
}

impl Domain {
    /// A box between two corners with these faces.
    pub fn new(lo: [f64; 3], hi: [f64; 3], boundary: Boundary) -> Self {
        let small = [0, 1, 2].map(|d| 1e-4 * (hi[d] - lo[d]));
        Self { lo, hi, boundary, small, min_lo: lo, min_hi: hi, flat: false, flow: None }
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
        for d in 0..3 {
            if !self.boundary.periodic(d) {
                continue;
            }
            let l = self.hi[d] - self.lo[d];
            if x[d] < self.lo[d] {
                x[d] += l;
                image[d] = image[d].saturating_sub(1);
                x[d] = x[d].max(self.lo[d]);
                if x[d] < self.lo[d] || x[d] - self.lo[d] > l {
                    let k = ((x[d] - self.lo[d]) / l).floor();
                    x[d] -= k * l;
                    image[d] = image[d].saturating_add(k as i32);
                }
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

    /// Shortest difference under periodic boundaries (minimum image).
    pub fn minimum_image(&self, mut d: [f64; 3]) -> [f64; 3] {
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

    /// Moves shrink-wrapped faces to the extent of the particles, which lie between these corners, as LAMMPS does at every
    /// reneighbouring.
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

    /// Whether a point is inside the box, lower faces inclusive.
    pub fn holds(&self, x: &[f64; 3]) -> bool {
        (0..3).all(|d| x[d] >= self.lo[d] && x[d] < self.hi[d])
    }

    /// Whether a point is inside all fixed faces (upper faces exclusive, as LAMMPS loses particles).
    pub fn keeps(&self, x: &[f64; 3]) -> bool {
        (0..3).all(|d| self.keeps_along(d, x))
    }

    /// Whether a point is inside the fixed faces across one axis.
    pub fn keeps_along(&self, d: usize, x: &[f64; 3]) -> bool {
        let [low, high] = self.boundary.0[d];
        (low != Face::Fixed || x[d] >= self.lo[d]) && (high != Face::Fixed || x[d] < self.hi[d])
    }
}
