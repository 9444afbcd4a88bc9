//! Motion of the rigid bodies themselves: forces, kicks, drift and rotation, as many bodies at a time as the
//! processor has lanes.

use super::Declared;
use super::gravity::{Pulls, member};
use perigrain_base::math::body::{Quat, matrix, no_squish, richardson, spin};
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::lanes::{Lanes, load_rows, store_rows};
use perigrain_base::math::periods::Periods;
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, add, cross, scale, sub};
use perigrain_styles::matter::Masses;
use perigrain_styles::rigid_bodies::WIDTH;
use perigrain_world::Particles;

/// Numbers of a body's pose: columns of its matrix, centre, velocity, angular velocity, each in a row of four
/// with one unused.
pub const POSE: usize = 24;

/// Numbers of a body that its motion uses: whole rows of four, up to the first image count.
const MOVING: usize = 28;

/// If the smallest moment of inertia is below this fraction of the largest one, the body is nearly straight.
const SLENDER: f64 = 1e-3;

/// The part of a step that a pass computes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Part {
    /// Poses only.
    Stand,
    /// First half kick, drift, rotation.
    First,
    /// New forces only.
    Forces,
    /// New forces and the second half kick.
    Second,
    /// The second half kick of a step, and the first half of the next one.
    Both,
}

impl Part {
    /// Whether new forces are summed.
    pub fn gathers(self) -> bool {
        matches!(self, Part::Forces | Part::Second | Part::Both)
    }

    /// Whether bodies drift and rotate.
    fn moves(self) -> bool {
        matches!(self, Part::First | Part::Both)
    }
}

/// A pass over bodies.
pub struct Pass<'a> {
    /// The fix of the bodies.
    pub fix: &'a Declared,
    /// The part of the step.
    pub part: Part,
    /// Δt/2 in units that turn force/mass into velocity.
    pub half: f64,
    /// Δt.
    pub dt: f64,
    /// Two-dimensional scene.
    pub flat: bool,
    /// LAMMPS' integration.
    pub lammps: bool,
    /// Edges of the box.
    pub edges: Periods,
    /// The particles.
    pub p: &'a Particles,
    /// Their masses.
    pub masses: Masses<'a>,
    /// Gravity on bodies as a whole.
    pub pulls: Pulls,
    /// Index of each body's first member.
    pub first: &'a [usize],
    /// Particles by body.
    pub members: &'a [usize],
    /// The bodies that are moved, if not all.
    pub which: Option<&'a [u32]>,
}

/// A body, or lanes of bodies, in motion.
struct Moving<R> {
    name: R,
    mass: R,
    x: Vec3<R>,
    v: Vec3<R>,
    momentum: Vec3<R>,
    q: Quat<R>,
    moments: Vec3<R>,
    force: Vec3<R>,
    torque: Vec3<R>,
    omega: Vec3<R>,
    image: R,
}

impl<R: Real> Moving<R> {
    /// From the storage order of [`Body`](super::bodies::Body).
    #[inline(always)]
    fn of(a: &[R; MOVING]) -> Self {
        let three = |k: usize| [a[k], a[k + 1], a[k + 2]];
        Self {
            name: a[0],
            mass: a[1],
            x: three(2),
            v: three(5),
            momentum: three(8),
            q: [a[11], a[12], a[13], a[14]],
            moments: three(15),
            force: three(18),
            torque: three(21),
            omega: three(24),
            image: a[27],
        }
    }

    #[inline(always)]
    fn numbers(&self) -> [R; MOVING] {
        let Self { name, mass, x, v, momentum: l, q, moments: i, force: f, torque: t, omega: o, image } =
            self;
        [
            *name, *mass, x[0], x[1], x[2], v[0], v[1], v[2], l[0], l[1], l[2], q[0], q[1], q[2], q[3], i[0],
            i[1], i[2], f[0], f[1], f[2], t[0], t[1], t[2], o[0], o[1], o[2], *image,
        ]
    }

    /// A half kick.
    #[inline(always)]
    fn kick(&mut self, half: f64, on: &[Vec3<R>; 2]) {
        let by = self.mass.like(half) / self.mass;
        for d in 0..3 {
            self.v[d] = self.v[d] + by * self.force[d] * on[0][d];
            self.momentum[d] = self.momentum[d] + self.torque[d] * half * on[1][d];
        }
    }

    /// The columns of the matrix, the centre, the velocity, the angular velocity.
    #[inline(always)]
    fn pose(&self) -> [R; POSE] {
        let ([a, b, c], x, v, o) = (matrix(self.q), self.x, self.v, self.omega);
        let none = x[0].like(0.0);
        [
            a[0], b[0], c[0], none, a[1], b[1], c[1], none, a[2], b[2], c[2], none, x[0], x[1], x[2], none,
            v[0], v[1], v[2], none, o[0], o[1], o[2], none,
        ]
    }
}

impl Pass<'_> {
    /// The number of the `k`-th body that is moved.
    #[inline(always)]
    fn number(&self, k: usize) -> usize {
        self.which.map_or(k, |which| which[k] as usize)
    }

    /// Moves the bodies from `start` on.
    pub fn bodies(&self, start: usize, rows: &mut [[f64; WIDTH]], poses: &mut [[f64; POSE]]) {
        if self.part.gathers() {
            rows.iter_mut().enumerate().for_each(|(k, row)| self.gather(self.number(start + k), row));
        }
        let done = match self.fix.exact() {
            true => 0,
            // SAFETY: the processor supports its form, and the loop has no other requirement.
            false => unsafe { Form::here().run(Groups { pass: self, start, rows, poses }) },
        };
        let rest = rows[done..].iter_mut().zip(&mut poses[done..]);
        rest.enumerate().for_each(|(k, (row, pose))| self.one(start + done + k, row, pose));
    }

    /// Moves the `k`-th body.
    fn one(&self, k: usize, row: &mut [f64; WIDTH], pose: &mut [f64; POSE]) {
        // A body has more numbers than those of its motion: see `columns`.
        let (own, _) = row.split_first_chunk_mut::<MOVING>().unwrap_or_else(|| unreachable!());
        let mut b = Moving::of(own);
        let exact = self.fix.exact() || self.slender(&b.moments);
        self.go(&mut b, &self.fix.allowed(self.number(k), self.flat), |b| {
            exact.then(|| no_squish(b.q, b.momentum, b.moments, self.dt))
        });
        (*own, *pose) = (b.numbers(), b.pose());
    }

    /// Whether a body is so straight that Richardson's method makes it tumble: its error of (ω Δt)² exceeds
    /// the moment that stabilizes the axis of the largest moment, which is as small as the smallest moment.
    /// In flat scenes, where z is exactly an axis, nothing tumbles.
    fn slender(&self, moments: &Vec3) -> bool {
        !self.flat && !self.lammps && moments[0] > 0.0 && moments[0] < SLENDER * moments[2]
    }

    /// One body per lane; `all` holds the switched components of forces and torques, if they are the same for
    /// all bodies.
    ///
    /// # Safety
    /// The processor must support the form.
    #[inline(always)]
    unsafe fn group<const N: usize, V: Lanes<N>>(
        &self,
        first: usize,
        all: Option<[Vec3; 2]>,
        rows: &mut [[f64; WIDTH]; N],
        poses: &mut [[f64; POSE]; N],
    ) {
        // With closures the compiler would not inline these operations.
        let mut on = [[[0.0; N]; 3]; 2];
        for l in 0..N {
            let own = match all {
                Some(all) => all,
                None => self.fix.allowed(self.number(first + l), self.flat),
            };
            for (s, d) in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)] {
                on[s][d][l] = own[s][d];
            }
        }
        let [[fx, fy, fz], [tx, ty, tz]] = on;
        // SAFETY: the caller's guarantee.
        unsafe {
            let on = [[V::of(fx), V::of(fy), V::of(fz)], [V::of(tx), V::of(ty), V::of(tz)]];
            let mut b = Moving::of(&columns::<N, V, WIDTH, MOVING>(rows));
            self.go(&mut b, &on, |_| None);
            put::<N, V, WIDTH, MOVING>(rows, &b.numbers());
            put::<N, V, POSE, POSE>(poses, &b.pose());
        }
    }

    /// The pass for a body, or lanes of bodies; `exactly` computes the orientation after a step where
    /// Richardson's method is not used.
    #[inline(always)]
    fn go<R: Real>(
        &self,
        b: &mut Moving<R>,
        on: &[Vec3<R>; 2],
        exactly: impl Fn(&Moving<R>) -> Option<Quat<R>>,
    ) {
        if matches!(self.part, Part::Second | Part::Both) {
            b.kick(self.half, on);
        }
        if !self.part.moves() {
            if self.part != Part::Stand {
                b.omega = spin(b.momentum, b.q, b.moments);
            }
            return;
        }
        b.kick(self.half, on);
        b.x = add(b.x, scale(b.mass.like(self.dt), b.v));
        if let Some(q) = exactly(b) {
            b.q = q;
            b.omega = spin(b.momentum, b.q, b.moments);
            return;
        }
        let omega = spin(b.momentum, b.q, b.moments);
        (b.q, b.omega) = richardson(b.q, b.momentum, omega, b.moments, 0.5 * self.dt);
    }

    /// Sums forces and torques of body `k` in storage order.
    fn gather(&self, k: usize, row: &mut [f64; WIDTH]) {
        let (mut force, mut torque, centre) = ([0.0; 3], [0.0; 3], [row[2], row[3], row[4]]);
        let p = self.p;
        let members = &self.members[self.first[k]..self.first[k + 1]];
        let away = |i: usize| sub(add(p.x[i], self.edges.shift_of(p.image[i])), centre);
        for &i in members {
            force = add(force, p.f[i]);
            torque = add(torque, cross(away(i), p.f[i]));
            if let Some(own) = p.torque.get(i) {
                torque = add(torque, *own);
            }
        }
        if !self.pulls.is_none() {
            // Where forces have been taken from all particles, no weight is among them that the body's could replace.
            let free = members.iter().all(|&i| p.f[i] == [0.0; 3]);
            let all = members.iter().filter(|_| !free).map(|&i| member(&self.masses, &p.mask, i, away(i)));
            let [weight, turning] = self.pulls.on(row[1], all);
            (force, torque) = (add(force, weight), add(torque, turning));
        }
        row[18..21].copy_from_slice(&force);
        row[21..24].copy_from_slice(&torque);
    }
}

/// The loop over groups of bodies; returns the number of bodies processed.
struct Groups<'a, 'b> {
    pass: &'a Pass<'b>,
    start: usize,
    rows: &'a mut [[f64; WIDTH]],
    poses: &'a mut [[f64; POSE]],
}

impl InLanes for Groups<'_, '_> {
    type Out = usize;

    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) -> usize {
        let Self { pass, start, rows, poses } = self;
        let (rows, poses) = (rows.as_chunks_mut::<N>().0, poses.as_chunks_mut::<N>().0);
        let all = if pass.fix.switches.is_empty() { Some(pass.fix.allowed(start, pass.flat)) } else { None };
        for (k, (rows, poses)) in rows.iter_mut().zip(poses).enumerate() {
            if rows.iter().any(|row| pass.slender(&[row[15], row[16], row[17]])) {
                (0..N).for_each(|l| pass.one(start + N * k + l, &mut rows[l], &mut poses[l]));
                continue;
            }
            // SAFETY: the caller's guarantee.
            unsafe { pass.group::<N, V>(start + N * k, all, rows, poses) };
        }
        N * rows.len()
    }
}

/// The first `M` numbers of several rows as lanes; `M` is a multiple of four.
///
/// # Safety
/// The processor must support the form.
#[inline(always)]
unsafe fn columns<const N: usize, V: Lanes<N>, const W: usize, const M: usize>(
    rows: &mut [[f64; W]; N],
) -> [V; M] {
    const { assert!(M <= W && M.is_multiple_of(4)) };
    let at = starts(rows);
    // SAFETY: the caller's guarantee; within the rows by the assertion.
    unsafe {
        let mut out = [V::all(0.0); M];
        for (k, four) in out.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            *four = load_rows::<V, N>(&at, 4 * k);
        }
        out
    }
}

/// The inverse of [`columns`].
///
/// # Safety
/// The processor must support the form.
#[inline(always)]
unsafe fn put<const N: usize, V: Lanes<N>, const W: usize, const M: usize>(
    rows: &mut [[f64; W]; N],
    lanes: &[V; M],
) {
    const { assert!(M <= W && M.is_multiple_of(4)) };
    let at = starts(rows);
    for (k, four) in lanes.as_chunks::<4>().0.iter().enumerate() {
        // SAFETY: within the rows by the assertion.
        unsafe { store_rows::<V, N>(&at, 4 * k, *four) };
    }
}

/// Pointers to the rows.
#[inline(always)]
fn starts<const N: usize, const W: usize>(rows: &mut [[f64; W]; N]) -> [*mut f64; N] {
    let mut at = [std::ptr::null_mut(); N];
    for (at, row) in at.iter_mut().zip(rows) {
        *at = row.as_mut_ptr();
    }
    at
}
