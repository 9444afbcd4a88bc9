//! The space that spheres are packed in: a part of the box, open where it repeats, with walls and pores.

use super::pores::Pores;
use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::{Vec3, add, cross, scale, sub};
use perigrain_base::par;
use perigrain_world::region::{INFINITE, Look, Near, Shape};
use perigrain_world::{Domain, Region};
use std::f64::consts::PI;

/// How often a sphere is pushed from all walls in turn, until it stays.
const SWEEPS: usize = 4;
/// Sample points along each edge where a volume has no formula.
const SAMPLES: usize = 100;

/// A room for spheres.
#[derive(Clone, Debug)]
pub struct Room {
    /// Lower corner [length].
    pub lo: Vec3,
    /// Upper corner [length].
    pub hi: Vec3,
    /// Edge lengths where it repeats, else 0 [length]; 0 in a room that leans.
    pub period: Vec3,
    /// Whether its sides across each axis are walls.
    closed: [bool; 3],
    lean: Option<Lean>,
    walls: Vec<Wall>,
    pores: Option<Pores>,
}

/// A box that leans and is the room as a whole.
#[derive(Clone, Debug)]
struct Lean {
    /// Its lower corner.
    lo: Vec3,
    /// Its edges.
    edges: Periods,
    /// Those along which it repeats, of length 0 elsewhere.
    periods: Periods,
}

/// A surface that spheres stay on one side of.
#[derive(Clone, Debug)]
struct Wall {
    /// The side of spheres.
    region: Region,
    /// The other side.
    beyond: Region,
    /// The middle of a hole in a room that repeats: its nearest image counts.
    middle: Option<Vec3>,
}

impl Room {
    /// The part of the box that a region leaves; without walls along periodic edges that the region spans.
    ///
    /// # Errors
    /// What the region is that no sphere can keep inside of.
    pub fn new(domain: &Domain, region: &Region) -> Result<Self, &'static str> {
        let mut shapes = vec![];
        flatten(region, false, &mut shapes)?;
        let bounds = domain.bounds();
        let mut room = Self {
            lo: bounds.map(|b| b[0]),
            hi: bounds.map(|b| b[1]),
            period: [0.0; 3],
            closed: [true; 3],
            lean: None,
            walls: vec![],
            pores: None,
        };
        let mut open = domain.periodic();
        for shape in &shapes {
            for d in 0..3 {
                open[d] &= passes(shape, d, domain);
            }
            if let Some((lo, hi)) = shape.shape.bounds().filter(|_| !shape.outside) {
                room.lo = std::array::from_fn(|d| room.lo[d].max(lo[d]));
                room.hi = std::array::from_fn(|d| room.hi[d].min(hi[d]));
            }
        }
        if domain.tilted() {
            room.lean_as(domain, shapes);
            return Ok(room);
        }
        let edges = domain.lengths();
        room.period = std::array::from_fn(|d| if open[d] { edges[d] } else { 0.0 });
        room.closed = open.map(|open| !open);
        // The faces of the room are those of its blocks.
        shapes.retain(|s| s.outside || !matches!(s.shape, Shape::Block { .. }));
        room.walls = shapes.into_iter().map(|s| Wall::new(s, &room.period)).collect();
        Ok(room)
    }

    /// Gives the room the walls that a leaning box and these shapes in it have. It repeats only where it is the whole box: a part of
    /// one has walls all round.
    fn lean_as(&mut self, domain: &Domain, mut shapes: Vec<Region>) {
        let whole = shapes.iter().all(|shape| is_box(shape, domain));
        let closed = domain.periodic().map(|periodic| !periodic || !whole);
        let sides = (0..3).filter(|d| closed[*d]).flat_map(|d| faces(domain, d));
        if whole {
            (self.lo, self.hi) = (domain.bounds().map(|b| b[0]), domain.bounds().map(|b| b[1]));
            self.closed = [false; 3];
            self.lean = Some(Lean { lo: domain.lo, edges: domain.edges(), periods: domain.periods() });
            shapes.clear();
        }
        shapes.retain(|s| s.outside || !matches!(s.shape, Shape::Block { .. }));
        self.walls = shapes.into_iter().chain(sides).map(|s| Wall::new(s, &[0.0; 3])).collect();
    }

    /// How far it goes along each axis before it repeats, 0 where it does not; in a room that leans from face to face.
    pub fn repeats(&self) -> Vec3 {
        self.lean.as_ref().map_or(self.period, |lean| lean.periods.heights())
    }

    /// How far away its images are, itself among them, up to one period along each axis.
    pub fn images(&self) -> Vec<Vec3> {
        let periods = self.lean.as_ref().map_or(Periods::upright(self.period), |lean| lean.periods);
        let some = periods.length.map(|l| if l > 0.0 { -1..=1 } else { 0..=0 });
        let mut images = vec![];
        for a in some[0].clone() {
            for b in some[1].clone() {
                images.extend(some[2].clone().map(|c| periods.shift([a, b, c].map(f64::from))));
            }
        }
        images
    }

    /// The room without these pores.
    pub fn with_pores(self, pores: Pores) -> Self {
        Self { pores: Some(pores), ..self }
    }

    /// Whether a point is inside.
    pub fn contains(&self, x: Vec3) -> bool {
        (0..3).all(|d| x[d] >= self.lo[d] && x[d] <= self.hi[d])
            && self.lean.as_ref().is_none_or(|lean| lean.turns(x) == [0.0; 3])
            && self.walls.iter().all(|w| w.region.contains(w.image(x, &self.period)))
            && self.pores.as_ref().is_none_or(|p| p.distance(x) >= 0.0)
    }

    /// Its volume: by formula where there is one, else by sample points [length³].
    pub fn volume(&self) -> f64 {
        let edges: Vec3 = std::array::from_fn(|d| self.hi[d] - self.lo[d]);
        if edges.iter().any(|l| *l <= 0.0) {
            return 0.0;
        }
        if let Some(lean) = &self.lean {
            return lean.edges.length.iter().product();
        }
        match (&self.walls[..], &self.pores) {
            ([], None) => return edges.iter().product(),
            ([one], None) if !one.region.outside => {
                if let Some(volume) = self.by_formula(&one.region.shape, edges) {
                    return volume;
                }
            }
            _ => {}
        }
        let at = |k: usize, d: usize| self.lo[d] + edges[d] * (k as f64 + 0.5) / SAMPLES as f64;
        let inside = |k: usize| {
            let x = [at(k % SAMPLES, 0), at(k / SAMPLES % SAMPLES, 1), at(k / SAMPLES / SAMPLES, 2)];
            f64::from(u8::from(self.contains(x)))
        };
        let points = SAMPLES.pow(3);
        edges.iter().product::<f64>() * par::sum(points, inside) / points as f64
    }

    /// The volume of a round shape that only its ends may cut.
    fn by_formula(&self, shape: &Shape, edges: Vec3) -> Option<f64> {
        // Uncut where the room is as large as the shape's own bounds.
        let (lo, hi) = shape.bounds()?;
        let whole = |d: usize| self.lo[d] <= lo[d] && self.hi[d] >= hi[d];
        match shape {
            Shape::Cylinder { axis, radius, .. } if (0..3).all(|d| d == *axis || whole(d)) => {
                Some(PI * radius * radius * edges[*axis])
            }
            Shape::Sphere { radius, .. } if (0..3).all(whole) => Some(4.0 / 3.0 * PI * radius.powi(3)),
            _ => None,
        }
    }

    /// The shorter way between two images.
    #[inline]
    pub fn nearest(&self, mut d: Vec3) -> Vec3 {
        if let Some(lean) = &self.lean {
            return lean.periods.nearest(d);
        }
        for k in 0..3 {
            let l = self.period[k];
            if d[k] > 0.5 * l {
                d[k] -= l;
            } else if d[k] < -0.5 * l {
                d[k] += l;
            }
        }
        d
    }

    /// Puts a point back into the period.
    pub fn wrap(&self, x: &mut Vec3) {
        if let Some(lean) = &self.lean {
            *x = sub(*x, lean.edges.shift(lean.turns(*x)));
            return;
        }
        for d in (0..3).filter(|&d| self.period[d] > 0.0) {
            x[d] -= self.period[d] * ((x[d] - self.lo[d]) / self.period[d]).floor();
            // Rounding may have led to the upper face itself.
            if x[d] >= self.hi[d] {
                x[d] = self.lo[d];
            }
        }
    }

    /// Whether a wall is nearer than `reach` to a point inside.
    pub fn close(&self, x: Vec3, reach: f64, spare: &mut Vec<Near>) -> bool {
        self.beyond(x, reach, spare) > 0.0
    }

    /// By how much a sphere reaches through the walls [length].
    pub fn beyond(&self, x: Vec3, radius: f64, spare: &mut Vec<Near>) -> f64 {
        let mut most: f64 = 0.0;
        for d in (0..3).filter(|&d| self.closed[d]) {
            most = most.max(radius - (x[d] - self.lo[d])).max(radius - (self.hi[d] - x[d]));
        }
        for wall in &self.walls {
            wall.pushes(x, radius, &self.period, spare);
            most = spare.iter().map(|n| radius - n.distance).fold(most, f64::max);
        }
        self.pores.as_ref().map_or(most, |p| most.max(radius - p.distance(x)))
    }

    /// Pushes a sphere back from all walls that it reaches through.
    pub fn keep(&self, x: &mut Vec3, radius: f64, spare: &mut Vec<Near>) {
        for _ in 0..SWEEPS {
            let before = *x;
            for d in (0..3).filter(|&d| self.closed[d]) {
                let (low, high) = (self.lo[d] + radius, self.hi[d] - radius);
                x[d] = if low <= high { x[d].clamp(low, high) } else { 0.5 * (low + high) };
            }
            for wall in &self.walls {
                wall.pushes(*x, radius, &self.period, spare);
                for near in spare.iter() {
                    *x = add(*x, scale(radius - near.distance, near.normal));
                }
            }
            if let Some(pores) = &self.pores {
                pores.keep(x, radius);
            }
            if *x == before {
                return;
            }
        }
    }
}

impl Lean {
    /// How many edges away from the box a place is, along those that repeat.
    fn turns(&self, x: Vec3) -> Vec3 {
        let at = self.edges.fractions(sub(x, self.lo));
        std::array::from_fn(|d| if self.periods.length[d] > 0.0 { at[d].floor() } else { 0.0 })
    }
}

/// Whether a shape is all of a box that leans.
fn is_box(region: &Region, domain: &Domain) -> bool {
    let near = |a: f64, b: f64, d: usize| (a - b).abs() <= 1e-12 * domain.lengths()[d];
    !region.outside
        && match &region.shape {
            Shape::Block { lo, hi } => {
                (0..3).all(|d| lo[d] <= domain.bounds()[d][0] && hi[d] >= domain.bounds()[d][1])
            }
            Shape::Prism { lo, hi, tilt } => (0..3).all(|d| {
                near(lo[d], domain.lo[d], d)
                    && near(hi[d], domain.hi[d], d)
                    && near(tilt[d], domain.edges().tilt[d], d / 2)
            }),
            _ => false,
        }
}

/// The two faces of a leaning box across its edge `d` as walls.
fn faces(domain: &Domain, d: usize) -> [Region; 2] {
    let edges = domain.edges().vectors();
    let normal = cross(edges[(d + 1) % 3], edges[(d + 2) % 3]);
    let wall = |point: Vec3, normal: Vec3| Region::inside(Shape::Plane { point, normal });
    [wall(domain.lo, normal), wall(domain.at([1.0; 3]), scale(-1.0, normal))]
}

impl Wall {
    fn new(mut region: Region, period: &Vec3) -> Self {
        // What passes through a face that repeats has no end there.
        for d in (0..3).filter(|&d| period[d] > 0.0) {
            match &mut region.shape {
                Shape::Cylinder { axis, lo, hi, .. } if *axis == d && !region.outside => {
                    (*lo, *hi) = (-INFINITE, INFINITE);
                }
                _ => {}
            }
        }
        let repeats = period.iter().any(|l| *l > 0.0);
        let middle = region.shape.bounds().filter(|_| region.outside && repeats);
        let middle = middle.map(|(lo, hi)| std::array::from_fn(|d| 0.5 * (lo[d] + hi[d])));
        let beyond = Region { outside: !region.outside, ..region.clone() };
        Self { region, beyond, middle }
    }

    /// The image of a point that is nearest to a hole.
    fn image(&self, x: Vec3, period: &Vec3) -> Vec3 {
        let Some(middle) = self.middle else { return x };
        std::array::from_fn(|d| match period[d] {
            l if l > 0.0 => x[d] - l * ((x[d] - middle[d]) / l).round(),
            _ => x[d],
        })
    }

    /// The places nearer than the radius, seen from the side of spheres; distances are negative beyond the wall.
    fn pushes(&self, x: Vec3, radius: f64, period: &Vec3, out: &mut Vec<Near>) {
        out.clear();
        let x = self.image(x, period);
        let look = Look { before: None, lammps: false };
        if self.region.contains(x) {
            return self.region.near(x, radius, &look, out);
        }
        self.beyond.near(x, f64::INFINITY, &look, out);
        out.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        out.truncate(1);
        for near in out {
            (near.normal, near.distance) = (scale(-1.0, near.normal), -near.distance);
        }
    }
}

/// The shapes a sphere must keep to at once; a sphere fits into the region if it fits into each.
fn flatten(region: &Region, flip: bool, out: &mut Vec<Region>) -> Result<(), &'static str> {
    if region.open != 0 {
        return Err("has open faces");
    }
    if region.motion.is_some() || region.follows() {
        return Err("moves or follows variables");
    }
    let outside = region.outside != flip;
    match (&region.shape, outside) {
        (Shape::Union(parts), true) | (Shape::Intersect(parts), false) => {
            parts.iter().try_for_each(|part| flatten(part, outside, out))
        }
        (Shape::Union(_), false) => Err("is a union"),
        (Shape::Intersect(_), true) => Err("is the outside of an intersection"),
        _ => {
            out.push(Region { outside, ..region.clone() });
            Ok(())
        }
    }
}

/// Whether a shape looks the same on both sides of the faces across `d`, so that the room may continue there.
fn passes(region: &Region, d: usize, domain: &Domain) -> bool {
    let spans = |lo: f64, hi: f64| lo <= domain.lo[d] && hi >= domain.hi[d];
    match &region.shape {
        Shape::Block { lo, hi } if spans(lo[d], hi[d]) => true,
        Shape::Cylinder { axis, lo, hi, .. } if *axis == d && spans(*lo, *hi) => true,
        Shape::Plane { normal, .. } => normal[d] == 0.0,
        // A hole that the box holds.
        shape if region.outside => {
            shape.bounds().is_some_and(|(lo, hi)| lo[d] >= domain.lo[d] && hi[d] <= domain.hi[d])
        }
        _ => false,
    }
}
