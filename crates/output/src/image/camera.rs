//! Where a picture is taken from, and what of the scene fits into it.

/// A direction of view in LAMMPS' angles and how the scene is framed.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Angle from the z axis in degrees.
    pub theta: f64,
    /// Azimuth from the x axis in degrees.
    pub phi: f64,
    /// What is up in the picture.
    pub up: [f64; 3],
    /// Enlarges (above 1) or shrinks what the frame would show.
    pub zoom: f64,
    /// The point in the middle; `None`: the middle of the scene.
    pub centre: Option<[f64; 3]>,
    /// Opening angle from top to bottom in degrees; 0 is an orthographic view.
    pub perspective: f64,
}

impl Default for Camera {
    fn default() -> Self {
        Self { theta: 60.0, phi: 30.0, up: [0.0, 0.0, 1.0], zoom: 1.0, centre: None, perspective: 0.0 }
    }
}

/// A camera that has found its place: three directions at right angles, a centre and a scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Direction from left to right.
    pub right: [f64; 3],
    /// Direction from bottom to top.
    pub up: [f64; 3],
    /// Direction towards the viewer.
    pub toward: [f64; 3],
    /// The point in the middle of the picture.
    pub centre: [f64; 3],
    /// Width and height of what has to fit, in the plane of the centre.
    pub span: [f64; 2],
    /// Depth of the scene along the view.
    pub depth: f64,
    /// Distance of the eye from the centre; infinite for an orthographic view.
    pub distance: f64,
}

impl Camera {
    /// Frames a box given by its faces.
    pub fn frame_box(&self, bounds: [[f64; 2]; 3]) -> View {
        let corner = |k: usize| [bounds[0][k & 1], bounds[1][k >> 1 & 1], bounds[2][k >> 2 & 1]];
        self.frame((0..8).map(|k| (corner(k), 0.0)))
    }

    /// Frames spheres given by centre and radius, with a small margin.
    pub fn frame(&self, spheres: impl Iterator<Item = ([f64; 3], f64)>) -> View {
        let (right, up, toward) = self.axes();
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for (x, r) in spheres.filter(|(x, r)| x.iter().all(|c| c.is_finite()) && r.is_finite()) {
            for (range, axis) in range.iter_mut().zip([right, up, toward]) {
                let c = dot(x, axis);
                *range = [range[0].min(c - r), range[1].max(c + r)];
            }
        }
        if range[0][0] > range[0][1] {
            range = [[-1.0, 1.0]; 3];
        }
        let middle = range.map(|[lo, hi]| 0.5 * (lo + hi));
        let centre = self.centre.unwrap_or_else(|| {
            std::array::from_fn(|k| middle[0] * right[k] + middle[1] * up[k] + middle[2] * toward[k])
        });
        let zoom = if self.zoom > 0.0 { self.zoom } else { 1.0 };
        let size = range.map(|[lo, hi]| hi - lo);
        let least = 1e-9 * size.iter().fold(f64::MIN_POSITIVE, |a, &b| a.max(b));
        let span = [0, 1].map(|k| 1.06 * size[k].max(least) / zoom);
        let distance = if self.perspective > 0.0 {
            // Far enough that the front of the scene fits as well.
            0.5 * span[1].max(span[0]) / (0.5 * self.perspective.to_radians()).tan() + 0.5 * size[2]
        } else {
            f64::INFINITY
        };
        View { right, up, toward, centre, span, depth: size[2].max(least), distance }
    }

    /// Right, up and toward the viewer.
    fn axes(&self) -> ([f64; 3], [f64; 3], [f64; 3]) {
        let (theta, phi) = (self.theta.to_radians(), self.phi.to_radians());
        let toward = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
        let right = cross(self.up, toward);
        // Looking along `up`: LAMMPS takes y, or x when that is no better.
        let choices = [right, cross([0.0, 1.0, 0.0], toward), cross([1.0, 0.0, 0.0], toward)];
        let right = choices.into_iter().find(|r| dot(*r, *r) > 1e-12).unwrap_or([1.0, 0.0, 0.0]);
        let length = dot(right, right).sqrt();
        let right = right.map(|c| c / length);
        (right, cross(toward, right), toward)
    }
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// From scene to supersampled pixels: x to the right, y down, z towards the viewer, all in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projection {
    view: View,
    scale: f64,
    centre: [f32; 2],
}

impl Projection {
    pub(super) fn new(view: &View, centre: [f32; 2], room: [f32; 2]) -> Self {
        let scale = (f64::from(room[0]) / view.span[0]).min(f64::from(room[1]) / view.span[1]);
        Self { view: *view, scale, centre }
    }

    /// Pixel position, depth and pixels per length there; `None` behind the eye.
    pub(super) fn point(&self, x: [f64; 3]) -> Option<([f32; 2], f32, f32)> {
        let v = &self.view;
        let d = [x[0] - v.centre[0], x[1] - v.centre[1], x[2] - v.centre[2]];
        let (right, up, toward) = (dot(d, v.right), dot(d, v.up), dot(d, v.toward));
        let mut scale = self.scale;
        if v.distance.is_finite() {
            let rest = v.distance - toward;
            if rest < 1e-3 * v.distance {
                return None;
            }
            scale *= v.distance / rest;
        }
        let p = [self.centre[0] + (scale * right) as f32, self.centre[1] - (scale * up) as f32];
        p.iter().all(|c| c.is_finite()).then_some((p, (self.scale * toward) as f32, scale as f32))
    }

    /// Pixels per length, where it is the same all over the picture.
    pub(super) fn scale(&self) -> Option<f64> {
        (self.view.distance.is_infinite() && self.scale.is_finite() && self.scale > 0.0).then_some(self.scale)
    }

    /// How a direction of the scene points towards the viewer, from -1 to 1.
    pub(super) fn facing(&self, normal: [f64; 3]) -> f64 {
        dot(normal, self.view.toward)
    }

    /// Depth of the scene in pixels.
    pub(super) fn depth(&self) -> f32 {
        (self.view.depth * self.scale) as f32
    }
}
