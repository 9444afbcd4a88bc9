//! Sets particles of rigid bodies to the motion of their bodies, several at a time.

use super::pass::POSE;
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::four::Four;
use perigrain_base::math::lanes::{Lanes, load_rows};
use perigrain_base::math::periods::Periods;
use perigrain_base::math::real::largest;
use perigrain_base::math::vec3::{SIX, Vec3, add, cross, dot, sub};
use perigrain_styles::matter::Masses;
use perigrain_world::Images;

/// Positions, velocities, spins, radii, body numbers, positions in the body, and the destination of each
/// particle's virial, if requested.
pub type Columns<'a> = (
    &'a mut [Vec3],
    &'a mut [Vec3],
    Option<(&'a mut [Vec3], &'a [f64])>,
    &'a [f64],
    &'a [Vec3],
    Option<&'a mut [[f64; 6]]>,
);

/// Half the virial of the constraint forces, and the square of the largest displacement.
pub type Came = ([f64; 6], f64);

/// Data for the constraint forces: the factor from force/mass to the velocity change of half a step, and the
/// forces and masses.
pub struct Holds<'a> {
    pub masses: Masses<'a>,
    pub f: &'a [Vec3],
    pub half: f64,
}

/// Moves particles with their bodies.
pub struct Follow<'a> {
    /// Positions and motions of the bodies.
    pub poses: &'a [[f64; POSE]],
    pub image: &'a Images,
    /// Edges of the box.
    pub edges: Periods,
    /// Whether positions change too.
    pub moving: bool,
    /// Present if the virial is requested.
    pub holds: Option<Holds<'a>>,
}

impl Follow<'_> {
    /// The particles from `start` on.
    pub fn chunk(&self, start: usize, columns: Columns) -> Came {
        // SAFETY: the processor supports its form, and the loop has no other requirement.
        unsafe { Form::here().run(Chunk { follow: self, start, columns }) }
    }

    /// Half of x F of one particle along [`SIX`], F being the constraint force; `old`: previous position and
    /// velocity.
    fn held(&self, holds: &Holds, i: usize, old: &[Vec3; 2], v: Vec3) -> [f64; 6] {
        let (m, x) = (holds.masses.get(i), add(old[0], self.edges.shift_of(self.image[i])));
        let hold: Vec3 = std::array::from_fn(|d| m * (v[d] - old[1][d]) / holds.half - holds.f[i][d]);
        SIX.map(|(a, c)| 0.5 * x[a] * hold[c])
    }
}

/// The loop of [`Follow::chunk`].
struct Chunk<'a> {
    follow: &'a Follow<'a>,
    start: usize,
    columns: Columns<'a>,
}

impl InLanes for Chunk<'_> {
    type Out = Came;

    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(mut self) -> Came {
        let n = self.columns.0.len();
        let mut came = ([0.0; 6], 0.0);
        // SAFETY (all below): the caller's guarantee; the rows are there.
        let (mut farthest, mut wrong) = unsafe { (V::all(0.0), V::all(0.0)) };
        for from in (0..n).step_by(N) {
            if let Some(poses) = self.plain::<N>(from) {
                let square = unsafe { self.group::<N, V>(from, &poses) };
                farthest = farthest.most(square);
                // Zero times infinity or NaN is NaN, and stays NaN in a sum.
                wrong = wrong + square * 0.0;
                continue;
            }
            for k in from..n.min(from + N) {
                unsafe { self.one::<V::Row>(k, &mut came) };
            }
        }
        came.1 = (farthest + wrong).numbers().into_iter().fold(came.1, largest);
        came
    }
}

impl Chunk<'_> {
    /// Poses for `N` particles, if all have a body and spin, have crossed no face, and no virial is
    /// requested.
    #[inline(always)]
    fn plain<const N: usize>(&self, from: usize) -> Option<[*mut f64; N]> {
        let Self { follow, start, columns: (_, _, turning, number, ..) } = self;
        let number = number[from..].first_chunk::<N>().filter(|_| follow.holds.is_none())?;
        let mut at = [std::ptr::null_mut(); N];
        for l in 0..N {
            let pose = follow.poses.get((number[l] as usize).wrapping_sub(1))?;
            let spins = turning.as_ref().is_none_or(|(_, radius)| radius[from + l] > 0.0);
            if !spins || follow.image[start + from + l] != [0; 3] {
                return None;
            }
            at[l] = pose.as_ptr().cast_mut();
        }
        Some(at)
    }

    /// `N` particles whose bodies are known: the squares of their displacements.
    ///
    /// # Safety
    /// The processor must support the form.
    #[inline(always)]
    unsafe fn group<const N: usize, V: Lanes<N>>(&mut self, from: usize, poses: &[*mut f64; N]) -> V {
        let (x, v, turning, _, place, _) = &mut self.columns;
        let rows = from..from + N;
        let (x, v, place) = (&mut x[rows.clone()], &mut v[rows.clone()], &place[rows.clone()]);
        let mut at = [0; N];
        for l in 0..N {
            at[l] = l as u32;
        }
        // SAFETY: by the caller's guarantee; poses are rows of four numbers, and `N` vectors are there.
        unsafe {
            let [ax, ay, az, _] = load_rows::<V, N>(poses, 0);
            let [bx, by, bz, _] = load_rows::<V, N>(poses, 4);
            let [cx, cy, cz, _] = load_rows::<V, N>(poses, 8);
            let [vx, vy, vz, _] = load_rows::<V, N>(poses, 16);
            let [ox, oy, oz, _] = load_rows::<V, N>(poses, 20);
            let [p, q, r] = V::vectors(place.as_ptr(), at.as_ptr());
            let away = [ax * p + bx * q + cx * r, ay * p + by * q + cy * r, az * p + bz * q + cz * r];
            let omega = [ox, oy, oz];
            put(v, add(cross(omega, away), [vx, vy, vz]));
            if let Some((spin, _)) = turning {
                put(&mut spin[rows], omega);
            }
            if !self.follow.moving {
                return V::all(0.0);
            }
            let [x0, y0, z0, _] = load_rows::<V, N>(poses, 12);
            let (before, now) = (V::vectors(x.as_ptr(), at.as_ptr()), add(away, [x0, y0, z0]));
            put(x, now);
            let way = sub(now, before);
            dot(way, way)
        }
    }

    /// One particle, if it has a body.
    ///
    /// # Safety
    /// As [`Chunk::group`].
    #[inline(always)]
    unsafe fn one<F: Four>(&mut self, k: usize, (total, farthest): &mut Came) {
        let Self { follow, start, columns: (x, v, turning, number, place, virials) } = self;
        let Some(pose) = follow.poses.get((number[k] as usize).wrapping_sub(1)) else { return };
        let old = [x[k], v[k]];
        // SAFETY: the caller's guarantee.
        let [away, velocity, centre] = unsafe { carried::<F>(pose, &place[k]) };
        v[k] = three(velocity);
        if let Some((spin, radius)) = turning
            && radius[k] > 0.0
        {
            spin[k] = [pose[20], pose[21], pose[22]];
        }
        if follow.moving {
            x[k] = sub(three(away + centre), follow.edges.shift_of(follow.image[*start + k]));
            let way = sub(x[k], old[0]);
            *farthest = largest(*farthest, dot(way, way));
        }
        if let Some(holds) = &follow.holds {
            let own = follow.held(holds, *start + k, &old, v[k]);
            (0..6).for_each(|c| total[c] += own[c]);
            if let Some(virials) = virials {
                virials[k] = own;
            }
        }
    }
}

/// Writes one vector per lane.
///
/// # Safety
/// The processor must support the form.
#[inline(always)]
unsafe fn put<const N: usize, V: Lanes<N>>(to: &mut [Vec3], [x, y, z]: Vec3<V>) {
    let (rows, to) = (V::to_rows([x, y, z, z]), &mut to[..N]);
    for l in 0..N - 1 {
        // SAFETY: within the list; the fourth number overwrites the start of the next row, which is written
        // later.
        unsafe { rows[l].store(to.as_mut_ptr().add(l).cast()) };
    }
    to[N - 1] = three(rows[N - 1]);
}

/// Position of a particle relative to the centre of its body, its velocity, and the centre: A p, ω × A p + v,
/// x.
///
/// # Safety
/// The processor must support the form.
#[inline(always)]
unsafe fn carried<F: Four>(pose: &[f64; POSE], place: &Vec3) -> [F; 3] {
    let at = pose.as_ptr();
    // SAFETY: within the pose.
    let [a, b, c, x, v, omega] = unsafe {
        [
            F::load(at),
            F::load(at.add(4)),
            F::load(at.add(8)),
            F::load(at.add(12)),
            F::load(at.add(16)),
            F::load(at.add(20)),
        ]
    };
    let away = a * place[0] + b * place[1] + c * place[2];
    let (yzx, zxy) = ([1, 2, 0, 3], [2, 0, 1, 3]);
    let turn = omega.at(yzx) * away.at(zxy) - omega.at(zxy) * away.at(yzx);
    [away, turn + v, x]
}

/// The first three lanes.
#[inline(always)]
fn three<F: Four>(lanes: F) -> Vec3 {
    let [x, y, z, _] = lanes.numbers();
    [x, y, z]
}
