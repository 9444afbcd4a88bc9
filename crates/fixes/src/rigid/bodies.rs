//! The state of rigid bodies: their particles, masses, positions and motion.

use super::Declared;
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_base::math::body::{Quat, apply, axes, from_axes, principal};
use perigrain_base::math::vec3::{Vec3, add, cross, scale, sub};
use perigrain_styles::matter::{Masses, unwrapped};
use perigrain_styles::rigid_bodies::Body;
use perigrain_styles::rigid_bodies::{WIDTH, bodies};
use perigrain_world::{GroupId, Numbers, World};
use std::collections::BTreeMap;

/// I / (m R²) of a solid sphere.
const SPHERE: f64 = 0.4;

/// What assigns particles to bodies.
#[derive(Clone)]
pub enum Split {
    /// The group.
    Single,
    /// The molecule ID.
    Molecule,
    /// A column of integers.
    Custom(Numbers),
    /// One of these groups.
    Groups(Vec<GroupId>),
}

impl Split {
    /// The name of the column that numbers the bodies, if one does.
    pub fn column(&self) -> Option<&'static str> {
        match self {
            Self::Custom(column) => Some(column.text()),
            Self::Single | Self::Molecule | Self::Groups(_) => None,
        }
    }
}

impl Declared {
    /// Loads the bodies from the world.
    pub fn load(&self, w: &World) -> Vec<Body> {
        bodies(w, self.keys.bodies)
    }

    /// Stores the bodies in the world.
    pub fn store(&self, w: &mut World, bodies: &[Body]) {
        let rows = w.memo.get_or(self.keys.bodies, Vec::new);
        rows.resize(WIDTH * bodies.len(), 0.0);
        rows.chunks_exact_mut(WIDTH).zip(bodies).for_each(|(row, body)| body.write(row));
    }

    /// The group number, molecule ID or column value that identifies the body of particle `i`; `None` if it
    /// belongs to no body.
    fn name_of(&self, w: &World, i: usize) -> std::result::Result<Option<f64>, u32> {
        let p = &w.particles;
        let is = |g: GroupId| p.mask[i] & g.bit() != 0;
        let value = match &self.split {
            Split::Single => 0.0,
            // Single spheres beside copies of templates.
            Split::Molecule if p.molecule[i] == 0 && !self.molds.is_empty() && !w.settings.lammps() => {
                return Ok(None);
            }
            Split::Molecule => f64::from(p.molecule[i]),
            Split::Custom(column) => {
                w.columns.get_scalar(*column).and_then(|c| c.get(i)).copied().unwrap_or(0.0)
            }
            Split::Groups(list) => {
                let mut mine = list.iter().enumerate().filter(|(_, g)| is(**g));
                let first = mine.next();
                if mine.next().is_some() {
                    return Err(p.tag[i]);
                }
                return Ok(first.map(|(k, _)| k as f64));
            }
        };
        Ok(is(self.group).then_some(value))
    }

    /// Particles without a body, by body identifier in ascending order.
    fn loose(&self, w: &World, body: &[f64], span: Span) -> Result<Vec<(f64, Vec<usize>)>> {
        let mut found: BTreeMap<i64, (f64, Vec<usize>)> = BTreeMap::new();
        for i in (0..w.n()).filter(|&i| body.get(i).copied().unwrap_or(0.0) == 0.0) {
            match self.name_of(w, i) {
                Ok(None) => {}
                // Identifiers are integers.
                Ok(Some(name)) => found.entry(name as i64).or_insert((name, vec![])).1.push(i),
                Err(tag) => {
                    return fail(Code::CONFLICT, span, format!("particle {tag} belongs to two rigid bodies"));
                }
            }
        }
        let list: Vec<(f64, Vec<usize>)> = found.into_values().collect();
        if let Some((name, members)) = list.iter().find(|(_, m)| m.len() < 2) {
            let tag = w.particles.tag[members[0]];
            let what = if matches!(self.split, Split::Molecule) {
                format!(" (molecule {name})")
            } else {
                String::new()
            };
            let text =
                format!("a rigid body needs two particles at least, but particle {tag}{what} is alone");
            return fail(Code::CONFLICT, span, text);
        }
        Ok(list)
    }

    /// Rebuilds all bodies from their particles.
    pub fn set_up(&self, w: &mut World, span: Span) -> Result<()> {
        let n = w.n();
        let before = (self.load(w), w.columns.get_scalar(self.keys.body).unwrap_or_default().to_vec());
        let list = self.loose(w, &[], span)?;
        if let Split::Groups(groups) = &self.split
            && list.len() < groups.len()
        {
            return fail(
                Code::CONFLICT,
                span,
                "a rigid body needs two particles at least: one of the groups is empty",
            );
        }
        if list.is_empty() && matches!(self.split, Split::Single) {
            return fail(
                Code::CONFLICT,
                span,
                "a rigid body needs two particles at least: the group is empty",
            );
        }
        w.columns.scalar(self.keys.body, n).fill(0.0);
        w.columns.vector(self.keys.place, n).fill([0.0; 3]);
        let all: Vec<usize> = (0..n).collect();
        self.weigh(w, &all, 0.0);
        self.store(w, &[]);
        // LAMMPS uses the template only for particles inserted during a run.
        let casts = self.casts() && !w.settings.lammps();
        self.enter(w, &list, casts, |i| {
            let number = before.1.get(i).copied().unwrap_or(0.0) as usize;
            number.checked_sub(1).and_then(|k| before.0.get(k)).map(|b| b.q)
        });
        Ok(())
    }

    /// Makes bodies of particles inserted since.
    pub fn adopt(&self, w: &mut World, span: Span) -> Result<()> {
        if matches!(self.split, Split::Single | Split::Groups(_)) {
            self.hold_members(w);
            return Ok(());
        }
        let body = w.columns.get_scalar(self.keys.body).unwrap_or_default();
        let list = self.loose(w, body, span)?;
        if !list.is_empty() {
            self.enter(w, &list, self.casts(), |_| None);
        }
        self.hold_members(w);
        Ok(())
    }

    /// Stores the orientation of members that have none yet: those of restart files without member
    /// orientations.
    fn hold_members(&self, w: &mut World) {
        if !w.particles.style.turns() {
            return;
        }
        let bodies = self.load(w);
        let number = w.columns.get_scalar(self.keys.body).unwrap_or_default();
        let body = |i: usize| bodies.get((number.get(i).copied().unwrap_or(0.0) as usize).wrapping_sub(1));
        let new = (0..w.n()).filter(|&i| !self.keys.turn.holds(w, i));
        let new: Vec<(usize, Quat)> = new.filter_map(|i| Some((i, body(i)?.q))).collect();
        new.into_iter().for_each(|(i, q)| self.keys.turn.take(w, i, q));
    }

    /// Makes bodies, with `casts` by their templates; `before` gives the previous orientation of a particle's body.
    fn enter(
        &self,
        w: &mut World,
        list: &[(f64, Vec<usize>)],
        casts: bool,
        before: impl Fn(usize) -> Option<Quat>,
    ) {
        let n = w.n();
        let mut bodies = self.load(w);
        for (name, members) in list {
            let sum = of_particles(w, members);
            let mut molds = self.molds.iter().filter(|mold| casts && mold.gives());
            let cast = molds.find_map(|mold| mold.cast(w, members, &sum, before(members[0])));
            let body = Body { name: *name, ..cast.unwrap_or(sum) };
            bodies.push(body);
            let number = bodies.len() as f64;
            members.iter().for_each(|&i| w.columns.scalar(self.keys.body, n)[i] = number);
            self.weigh(w, members, body.mass);
            self.place(w, &body, members);
        }
        self.store(w, &bodies);
    }

    /// Stores the body's mass for these particles; contact laws use it.
    pub fn weigh(&self, w: &mut World, members: &[usize], mass: f64) {
        let n = w.n();
        let column = w.columns.scalar(self.keys.mass, n);
        members.iter().for_each(|&i| column[i] = mass);
    }

    /// Stores the positions and orientations of particles in the body's frame.
    pub fn place(&self, w: &mut World, body: &Body, members: &[usize]) {
        let (n, axes) = (w.n(), axes(body.q));
        for &i in members {
            let d = sub(unwrapped(w, i), body.x);
            w.columns.vector(self.keys.place, n)[i] = apply(&axes, d);
            if w.particles.style.turns() {
                self.keys.turn.take(w, i, body.q);
            }
        }
    }

    /// Updates the image counts of the centres.
    pub fn wrap(&self, w: &mut World) {
        let mut bodies = self.load(w);
        if let Some(domain) = &*w.domain {
            for body in &mut bodies {
                let inside = domain.fractions(&body.x);
                body.image = [0, 1, 2].map(|d| match domain.boundary.periodic(d) {
                    true => inside[d].floor(),
                    false => 0.0,
                });
            }
        }
        self.store(w, &bodies);
    }
}

/// Mass, centre, axes and motion of a body with these particles.
fn of_particles(w: &World, members: &[usize]) -> Body {
    let (p, masses) = (&w.particles, Masses::of(w));
    let mut b = Body::default();
    for &i in members {
        let m = masses.get(i);
        b.mass += m;
        b.x = add(b.x, scale(m, unwrapped(w, i)));
        b.v = add(b.v, scale(m, p.v[i]));
    }
    b.x = b.x.map(|a| a / b.mass);
    b.v = b.v.map(|a| a / b.mass);
    let radius = |i: usize| p.radius.get(i).copied().unwrap_or(0.0);
    let centre = b.x;
    let spheres = members.iter().map(|&i| (masses.get(i), sub(unwrapped(w, i), centre), radius(i)));
    let inertia = tensor(spheres.clone());
    for (&i, (m, d, r)) in members.iter().zip(spheres) {
        b.momentum = add(b.momentum, scale(m, cross(d, p.v[i])));
        if let Some(omega) = p.omega.get(i).filter(|_| r > 0.0) {
            b.momentum = add(b.momentum, scale(SPHERE * m * r * r, *omega));
        }
    }
    orient(&mut b, inertia, w.settings.two_dimensional);
    b
}

/// Inertia tensor xx yy zz xy xz yz of solid spheres given by mass, position relative to the centre, and
/// radius.
pub fn tensor(spheres: impl Iterator<Item = (f64, Vec3, f64)>) -> [f64; 6] {
    let mut tensor = [0.0; 6];
    for (m, d, r) in spheres {
        let own = SPHERE * m * r * r;
        for (k, (a, c)) in [(1, 2), (0, 2), (0, 1)].into_iter().enumerate() {
            tensor[k] += m * (d[a] * d[a] + d[c] * d[c]) + own;
        }
        for (k, (a, c)) in [(0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
            tensor[3 + k] -= m * d[a] * d[c];
        }
    }
    tensor
}

/// Axes and principal moments from an inertia tensor xx yy zz xy xz yz. In flat scenes the last axis is z, so
/// that bodies rotate about one quaternion component alone: with z as another axis, the integration of nearly
/// straight bodies would turn rounding errors into out-of-plane motion.
pub fn orient(body: &mut Body, tensor: [f64; 6], flat: bool) {
    let (mut moments, mut frame) = principal(tensor);
    let along = |k: usize| frame[k][2].abs();
    if flat && along(1) > along(2) {
        moments.swap(1, 2);
        frame = [frame[0], frame[2], scale(-1.0, frame[1])];
    }
    body.moments = moments;
    body.q = from_axes(frame);
}
