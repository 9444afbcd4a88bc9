//! Regions: volumes of space by shape, side and union, tested point by point; they may follow variables.

mod faces;
mod motion;
mod outline;
mod shape;
mod surface;

pub use motion::{Angle, Motion, Turn, Variable, turned};
pub use perigrain_mesh::Near as FacetNear;
pub use shape::{Shape, across};
pub use surface::{Look, Near};

use perigrain_base::diag::{Code, Result, fail};

/// What stands for an infinite face.
pub const INFINITE: f64 = 1.0e20;

/// A named volume.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Region {
    /// Its shape, where variables are numbers of it as they were last.
    pub shape: Shape,
    /// Whether the volume is what lies outside the shape (`side out`).
    pub outside: bool,
    /// Faces left open for walls, bit `k` for LAMMPS' face `k + 1`.
    pub open: u8,
    /// Numbers of the shape that variables give.
    pub given: Vec<Given>,
    /// How the shape moves.
    pub motion: Option<Motion>,
    /// It holds every point, as LAMMPS' regions with open faces do for all but walls.
    pub everywhere: bool,
}

/// A number of a shape that an equal-style variable gives anew whenever the region is used.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Given {
    /// Which number, in the order in which `region` reads them.
    pub number: usize,
    /// The variable.
    pub variable: Variable,
    /// Factor from the variable's value to box units.
    pub scale: f64,
}

/// Returns a variable's present value; `None` where it is not known (`perigrain check`).
pub type ReadVariable<'a> = dyn FnMut(&Variable) -> Result<Option<f64>> + 'a;

impl Region {
    /// The inside of a shape, all faces closed, at rest.
    pub fn inside(shape: Shape) -> Self {
        Self { shape, outside: false, open: 0, given: vec![], motion: None, everywhere: false }
    }

    /// Whether the point belongs to the region.
    #[inline]
    pub fn contains(&self, x: [f64; 3]) -> bool {
        if self.everywhere {
            return true;
        }
        let x = match &self.motion {
            Some(motion) => motion.undo(x),
            None => x,
        };
        self.shape.contains(x) != self.outside
    }

    /// Regions may be made of regions made of regions so many times: files are read, and shapes looked at, one within the other.
    pub const DEEPEST: usize = 100;

    /// The regions that it is made of.
    fn made_of(&self) -> &[Region] {
        match &self.shape {
            Shape::Union(parts) | Shape::Intersect(parts) => parts,
            _ => &[],
        }
    }

    /// Whether its directions are directions, and variables give numbers that it has.
    pub fn is_sound(&self) -> bool {
        let (axes, numbers) = self.shape.has();
        axes && self.given.iter().all(|g| g.number < numbers) && self.made_of().iter().all(Region::is_sound)
    }

    /// Lets open faces mean what they mean in LAMMPS, where a region that has some holds every point, or for walls alone.
    pub fn open_holds_all(&mut self, yes: bool) {
        self.everywhere = yes && self.open != 0;
        if let Shape::Union(parts) | Shape::Intersect(parts) = &mut self.shape {
            parts.iter_mut().for_each(|part| part.open_holds_all(yes));
        }
    }

    /// A box that holds the region, if a finite description gives one (`side out` and what follows variables do not).
    pub fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        if self.outside || self.motion.is_some() || !self.given.is_empty() {
            return None;
        }
        self.shape.bounds()
    }

    /// The variables that the region follows, those of its parts included.
    pub fn variables(&self) -> Vec<&Variable> {
        let mut list: Vec<&Variable> = self.given.iter().map(|g| &g.variable).collect();
        list.extend(self.motion.iter().flat_map(Motion::variables));
        if let Shape::Union(parts) | Shape::Intersect(parts) = &self.shape {
            list.extend(parts.iter().flat_map(Region::variables));
        }
        list
    }

    /// Whether place or size follow variables.
    pub fn follows(&self) -> bool {
        !self.variables().is_empty()
    }

    /// How many regions it is made of, itself included, and how deep they are nested.
    pub fn extent(&self) -> (usize, usize) {
        let (Shape::Union(parts) | Shape::Intersect(parts)) = &self.shape else { return (1, 1) };
        let all = parts.iter().map(Region::extent);
        let (count, depth) = all.fold((0, 0), |a, b| (a.0 + b.0, a.1.max(b.1)));
        (count + 1, depth + 1)
    }

    /// Puts the region where its variables place it.
    ///
    /// # Errors
    /// Variables that have no value, and values that make no shape.
    pub fn place(&mut self, read: &mut ReadVariable) -> Result<()> {
        for given in &self.given {
            if let Some(value) = read(&given.variable)? {
                self.shape.set(given.number, given.scale * value);
            }
        }
        if let (Some(first), Some(fault)) = (self.given.first(), self.shape.fault()) {
            return fail(
                Code::BAD_VALUE,
                first.variable.span,
                format!("with its variables' values, {fault}"),
            );
        }
        if let Some(motion) = &mut self.motion {
            motion.place(read)?;
        }
        if let Shape::Union(parts) | Shape::Intersect(parts) = &mut self.shape {
            parts.iter_mut().try_for_each(|part| part.place(read))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(x: f64, r: f64) -> Region {
        Region::inside(Shape::Sphere { center: [x, 0.0, 0.0], radius: r })
    }

    #[test]
    fn surfaces_belong_to_the_inside() {
        let b = Region::inside(Shape::Block { lo: [0.0; 3], hi: [1.0; 3] });
        assert!(b.contains([0.0, 1.0, 0.5]) && !b.contains([0.0, 1.0 + 1e-15, 0.5]));
        let out = Region { outside: true, ..b };
        assert!(!out.contains([0.0, 1.0, 0.5]) && out.contains([2.0, 0.0, 0.0]) && out.bounds().is_none());
        assert!(ball(0.0, 5.0).contains([3.0, 4.0, 0.0]));
    }

    #[test]
    fn cylinder_along_each_axis() {
        for axis in 0..3 {
            let shape = Shape::Cylinder { axis, center: [1.0, 2.0], radius: 0.5, lo: -1.0, hi: 3.0 };
            let c = Region::inside(shape);
            let [a, b] = across(axis);
            let mut x = [0.0; 3];
            (x[a], x[b], x[axis]) = (1.5, 2.0, 3.0);
            assert!(c.contains(x), "axis {axis}");
            let (lo, hi) = c.bounds().unwrap();
            assert_eq!((lo[a], hi[b], lo[axis], hi[axis]), (0.5, 2.5, -1.0, 3.0));
        }
    }

    #[test]
    fn unions_and_intersections_bound_themselves() {
        let (near, far) = (ball(0.0, 1.0), ball(1.5, 1.0));
        let both = Region::inside(Shape::Intersect(vec![near.clone(), far.clone()]));
        let any = Region::inside(Shape::Union(vec![near, far.clone()]));
        assert!(both.contains([0.75, 0.0, 0.0]) && !both.contains([0.0; 3]) && any.contains([0.0; 3]));
        assert_eq!(both.bounds().unwrap().0[0], 0.5);
        assert_eq!(any.bounds().unwrap().1[0], 2.5);
        let hole = Region { outside: true, ..far };
        let rest = Region::inside(Shape::Intersect(vec![ball(0.0, 1.0), hole.clone()]));
        assert_eq!(rest.bounds().unwrap().1[0], 1.0);
        assert!(Region::inside(Shape::Union(vec![ball(0.0, 1.0), hole])).bounds().is_none());
    }
}
