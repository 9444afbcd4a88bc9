//! What walls look like, for pictures: triangles, and how they have moved.

use super::World;
use super::region::turned;
use perigrain_base::math::vec3::{Vec3, add};
use std::fmt;
use std::sync::Arc;

/// Three corners.
pub type Triangle = [Vec3; 3];

/// The triangles of a wall where it stood when it was declared.
pub type Form = dyn Fn(&World) -> Vec<Triangle> + Send + Sync;

/// How a wall has moved: first turned, then shifted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// The turn: a point of the axis, its direction, and the angle [radians].
    pub turn: Option<(Vec3, Vec3, f64)>,
    /// The shift [length].
    pub shift: Vec3,
}

/// What a wall looks like.
#[derive(Clone)]
pub struct Outline {
    form: Arc<Form>,
    /// Where it is now.
    pub pose: Pose,
}

impl fmt::Debug for Outline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Outline").field("pose", &self.pose).finish_non_exhaustive()
    }
}

impl Outline {
    /// A wall at rest.
    pub fn new(form: impl Fn(&World) -> Vec<Triangle> + Send + Sync + 'static) -> Self {
        Self { form: Arc::new(form), pose: Pose::default() }
    }

    /// Its triangles where it is now.
    pub fn triangles(&self, w: &World) -> Vec<Triangle> {
        let mut all = (self.form)(w);
        if self.pose != Pose::default() {
            all.as_flattened_mut().iter_mut().for_each(|p| *p = self.pose.at(*p));
        }
        all
    }
}

impl Pose {
    /// Where a point of the wall is.
    fn at(&self, x: Vec3) -> Vec3 {
        let x = self.turn.map_or(x, |(point, axis, angle)| turned(x, point, axis, angle.into()));
        add(x, self.shift)
    }
}

/// The triangles of all walls, in the order of their names.
pub fn walls(w: &World) -> Vec<Triangle> {
    w.outlines.values().flat_map(|outline| outline.triangles(w)).collect()
}
