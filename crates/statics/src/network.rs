//! A body of bonded particles as columns, and its response to small motions of its particles.
//!
//! K. Jarolin, M. Dosta, Comput. Part. Mech. 8 (2021), Eq. 5–10, with rotations: the tangent of beams between
//! spheres at rest.

use super::pairs::{Pairs, Ties};
use super::six::{Matrix6, Packed, Six, packed, unit};
use perigrain_base::math::body::{Quat, turn_by};
use perigrain_base::math::forest;
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale, sub};
use perigrain_base::par;
use perigrain_bonded::beam::{Pulled, pulled};
use perigrain_bonded::law::Ends;
use perigrain_bonded::stiffness::{Modes, Stiffness};

/// Bonds between particles, which are indices from 0.
#[derive(Clone, Debug, Default)]
pub struct Network {
    /// Number of particles.
    pub particles: usize,
    /// The bonded pairs.
    pub pairs: Pairs,
    /// Vectors from the lower end to the upper one [length]. Directions and lengths are computed from them:
    /// there are millions of bonds, and memory access costs more than arithmetic.
    d: Vec<Vec3>,
    /// Stiffnesses.
    pub k: Vec<Stiffness>,
}

/// Resistance of a bond: −F and −M − C on the first end, F and M − C on the second are the resisting forces
/// and torques.
#[derive(Clone, Copy, Debug)]
pub struct Resisting {
    /// F = K_t g [force].
    pub force: Vec3,
    /// M = K_r φ [force length].
    pub moment: Vec3,
    /// C = ½ d × F [force length].
    pub couple: Vec3,
}

impl Resisting {
    /// Resisting forces and torques of both ends.
    #[inline(always)]
    pub fn rows(&self) -> [Six; 2] {
        let minus = |a: Vec3| a.map(|a| -a);
        [
            row(minus(self.force), minus(add(self.moment, self.couple))),
            row(self.force, sub(self.moment, self.couple)),
        ]
    }
}

/// Relative motions of a bond's ends.
#[derive(Clone, Copy, Debug)]
pub struct Moved {
    /// Δu = u_j − u_i [length].
    pub apart: Vec3,
    /// θ_i + θ_j [rad].
    pub together: Vec3,
    /// φ = θ_j − θ_i [rad].
    pub turned: Vec3,
}

impl Moved {
    /// From the motions of the ends.
    #[inline(always)]
    pub fn new(a: &Six, b: &Six) -> Self {
        let (ua, ta) = halves(a);
        let (ub, tb) = halves(b);
        Self { apart: sub(ub, ua), together: add(ta, tb), turned: sub(tb, ta) }
    }
}

/// Displacement and rotation.
#[inline(always)]
pub fn halves(a: &Six) -> (Vec3, Vec3) {
    ([a[0], a[1], a[2]], [a[3], a[4], a[5]])
}

/// A row of displacement and rotation, or of force and torque.
#[inline(always)]
pub fn row(u: Vec3, theta: Vec3) -> Six {
    [u[0], u[1], u[2], theta[0], theta[1], theta[2]]
}

impl Network {
    /// For bonds between these ends; `bond(k)` returns the vector from the first end to the second and the
    /// stiffnesses of the k-th.
    pub fn new(particles: usize, ends: &[[u32; 2]], bond: impl Fn(usize) -> (Vec3, Stiffness)) -> Self {
        let pairs = Pairs::new(particles, ends);
        let (d, k) = (Vec::with_capacity(ends.len()), Vec::with_capacity(ends.len()));
        let mut out = Self { particles, pairs, d, k };
        for &origin in &out.pairs.origin {
            let (d, k) = bond(origin as usize);
            let [a, b] = ends[origin as usize];
            out.d.push(scale(if a < b { 1.0 } else { -1.0 }, d));
            out.k.push(k);
        }
        out
    }

    /// The same bonds with other stiffnesses, one per bond.
    pub fn with(&self, k: Vec<Stiffness>) -> Self {
        Self { k, ..self.clone() }
    }

    /// Number of bonds.
    pub fn bonds(&self) -> usize {
        self.pairs.len()
    }

    /// The vector from the lower end of a bond to the upper one [length].
    #[inline(always)]
    pub fn d(&self, k: usize) -> Vec3 {
        self.d[k]
    }

    /// The distance of the ends of a bond [length].
    #[inline(always)]
    pub fn length(&self, k: usize) -> f64 {
        length(self.d[k])
    }

    /// The unit vector n from the lower end of a bond to the upper one.
    #[inline(always)]
    pub fn n(&self, k: usize) -> Vec3 {
        scale(1.0 / self.length(k), self.d[k])
    }

    /// g = Δu + ½ d × (θ_i + θ_j); F = K_t g with K_t = k_s 1 + (k_n − k_s) n nᵀ; M = K_r φ with K_r = k_b 1 + (k_t − k_b) n nᵀ.
    #[inline(always)]
    pub fn resist(&self, bond: usize, moved: &Moved) -> Resisting {
        let (d, k) = (self.d[bond], &self.k[bond]);
        let arm = scale(0.5, d);
        let g = add(moved.apart, cross(arm, moved.together));
        // n nᵀ is d dᵀ/d². The part of g from rotations is perpendicular to n.
        let over = 1.0 / dot(d, d);
        let along = over * (k.normal - k.shear) * dot(d, moved.apart);
        let twisted = over * (k.twist - k.bend) * dot(d, moved.turned);
        Resisting {
            force: add(scale(k.shear, g), scale(along, d)),
            moment: add(scale(k.bend, moved.turned), scale(twisted, d)),
            couple: scale(k.shear, cross(arm, g)),
        }
    }

    /// out = K u.
    ///
    /// # Panics
    /// If `out` does not have a row per particle.
    pub fn product(&self, u: &[Six], out: &mut [Six]) {
        self.gather(out, |_, [i, j]| Moved::new(&u[i], &u[j]));
    }

    /// The same bonds with the vectors they have in a field.
    pub fn moved_by(&self, u: &[Six]) -> Self {
        let d = |k: usize| {
            let [i, j] = self.pairs.ends[k].map(|i| halves(&u[i as usize]).0);
            add(self.d[k], sub(j, i))
        };
        Self { d: (0..self.bonds()).map(d).collect(), ..self.clone() }
    }

    /// out = the resisting forces and torques in a field of any size, with rotations as vectors; from the
    /// potential of [`perigrain_bonded::beam`].
    pub fn forces(&self, u: &[Six], out: &mut [Six]) {
        let turns = turns(u);
        par::each(&mut *out, |_, rows: &mut [Six]| rows.fill([0.0; 6]));
        self.pairs.gather(out, |k, [i, j]| {
            let Pulled { force, torque: [high, low], .. } =
                self.pulled(k, [&u[i], &u[j]], [turns[i], turns[j]]);
            let minus = |a: Vec3| a.map(|a| -a);
            [row(force, minus(low)), row(minus(force), minus(high))]
        });
    }

    /// Energies of all bonds in a field of any size, each multiplied by `times(bond, mode)`.
    pub fn energy_of_large(&self, u: &[Six], times: impl Fn(usize, usize) -> f64 + Sync) -> Modes {
        let turns = turns(u);
        self.sum(|k| {
            let [i, j] = self.pairs.ends[k].map(|i| i as usize);
            let energy = self.pulled(k, [&u[i], &u[j]], [turns[i], turns[j]]).energy;
            std::array::from_fn(|mode| times(k, mode) * energy[mode])
        })
    }

    /// Forces of a bond on its ends, the upper one first.
    #[inline(always)]
    fn pulled(&self, bond: usize, [a, b]: [&Six; 2], [low, high]: [Quat; 2]) -> Pulled {
        let d = self.d[bond];
        let length = length(d);
        let r = add(d, sub(halves(b).0, halves(a).0));
        let ends = Ends { r, length, axis: scale(1.0 / length, d), quat: [high, low] };
        pulled(&self.k[bond], &ends)
    }

    /// The effect of a uniform strain without any displacement: the resisting forces if all bonds change by ε
    /// d.
    pub fn product_of_strain(&self, strain: &[Vec3; 3], out: &mut [Six]) {
        self.gather(out, |k, _| {
            let d = self.d(k);
            Moved { apart: strain.map(|row| dot(row, d)), together: [0.0; 3], turned: [0.0; 3] }
        });
    }

    fn gather(&self, out: &mut [Six], moved: impl Fn(usize, [usize; 2]) -> Moved + Sync) {
        assert_eq!(out.len(), self.particles);
        par::each(&mut *out, |_, rows: &mut [Six]| rows.fill([0.0; 6]));
        self.pairs.gather(out, |k, ends| self.resist(k, &moved(k, ends)).rows());
    }

    /// The work of the resistance to one motion of a bond's ends on another motion; for equal motions, twice
    /// the energies: k_n (n·g)(n·g'), k_s g·g' across n, k_b φ·φ' across n, k_t (n·φ)(n·φ').
    #[inline(always)]
    pub fn work(&self, bond: usize, a: &Moved, b: &Moved) -> Modes {
        let (d, k) = (self.d[bond], &self.k[bond]);
        let (arm, over) = (scale(0.5, d), 1.0 / dot(d, d));
        // The component along n times the length of the bond, and the perpendicular part.
        let split = |m: &Moved| {
            let g = add(m.apart, cross(arm, m.together));
            let (along, twist) = (dot(d, g), dot(d, m.turned));
            (along, sub(g, scale(over * along, d)), sub(m.turned, scale(over * twist, d)), twist)
        };
        let ((along, across, bend, twist), other) = (split(a), split(b));
        [
            over * k.normal * along * other.0,
            k.shear * dot(across, other.1),
            k.bend * dot(bend, other.2),
            over * k.twist * twist * other.3,
        ]
    }

    /// Relative motions of the ends of a bond in a field, with an optional uniform strain.
    pub fn moved(&self, bond: usize, u: &[Six], strain: Option<&[Vec3; 3]>) -> Moved {
        let [i, j] = self.pairs.ends[bond];
        let mut moved = Moved::new(&u[i as usize], &u[j as usize]);
        if let Some(strain) = strain {
            let d = self.d(bond);
            moved.apart = add(moved.apart, strain.map(|row| dot(row, d)));
        }
        moved
    }

    /// Energies of all bonds in a field.
    pub fn energy(&self, u: &[Six]) -> Modes {
        self.sum(|k| {
            let moved = self.moved(k, u, None);
            self.work(k, &moved, &moved).map(|a| 0.5 * a)
        })
    }

    /// A sum over bonds.
    pub fn sum(&self, of: impl Fn(usize) -> Modes + Sync) -> Modes {
        let chunk = |range: std::ops::Range<usize>| range.fold([0.0; 4], |sum, k| plus(sum, of(k)));
        par::reduce(self.bonds(), chunk, plus).unwrap_or_default()
    }

    /// Loads of a bond in a field: tension (negative for compression) and shear force [force], bending and
    /// twisting moments at its middle [force length]; all but the first unsigned.
    #[inline(always)]
    pub fn borne(&self, bond: usize, u: &[Six]) -> Modes {
        let n = self.n(bond);
        let r = self.resist(bond, &self.moved(bond, u, None));
        let (tension, twist) = (dot(n, r.force), dot(n, r.moment));
        let across = |a: Vec3, along: f64| length(sub(a, scale(along, n)));
        [tension, across(r.force, tension), across(r.moment, twist), twist.abs()]
    }

    /// The 6 × 6 diagonal blocks of K: [[K_t, −K_t X], [−Xᵀ K_t, Xᵀ K_t X + K_r]] at the lower end of a bond
    /// with X = ½ [d]×, with the opposite sign of the off-diagonal parts at the upper one.
    pub fn blocks(&self) -> Vec<Packed> {
        let mut out = vec![[0.0; 21]; self.particles];
        self.blocks_into(&mut out, |_, block, row| *row = *block);
        out
    }

    /// Passes the block of each particle to `take` with its row of `out`, so that the blocks are not stored.
    pub fn blocks_into<T: Send>(&self, out: &mut [T], take: impl Fn(usize, &Packed, &mut T) + Sync) {
        self.pairs.gather_into(out, |k, _| [self.end(k, true), self.end(k, false)], take);
    }

    /// The block of one particle, given its bonds.
    pub fn block(&self, place: u32, bonds: &[u32]) -> Packed {
        bonds.iter().map(|k| *k as usize).fold([0.0; 21], |sum, k| {
            let more = self.end(k, self.pairs.ends[k][0] == place);
            std::array::from_fn(|c| sum[c] + more[c])
        })
    }

    /// The contribution of a bond's lower or upper end to the block of its particle.
    fn end(&self, bond: usize, lower: bool) -> Packed {
        let columns: Matrix6 = std::array::from_fn(|c| {
            let (moves, still) = (unit(c), [0.0; 6]);
            if lower {
                return self.resist(bond, &Moved::new(&moves, &still)).rows()[0];
            }
            self.resist(bond, &Moved::new(&still, &moves)).rows()[1]
        });
        packed(&columns)
    }

    /// For each particle the smallest index in its connected piece.
    pub fn pieces(&self) -> Vec<u32> {
        self.pieces_with([])
    }

    /// The same with additional connected pairs.
    pub fn pieces_with(&self, more: impl IntoIterator<Item = [u32; 2]>) -> Vec<u32> {
        let mut root: Vec<u32> = (0..self.particles as u32).collect();
        self.pairs.ends.iter().copied().chain(more).for_each(|[a, b]| forest::join(&mut root, a, b));
        (0..self.particles as u32).map(|k| forest::find(&mut root, k)).collect()
    }
}

impl Ties for Network {
    fn ends(&self) -> &[[u32; 2]] {
        &self.pairs.ends
    }

    fn vector(&self, k: usize) -> Vec3 {
        self.d(k)
    }

    fn bears(&self, k: usize) -> bool {
        self.k[k] != Stiffness::default()
    }

    fn resist(&self, k: usize, [a, b]: [&Six; 2]) -> [Six; 2] {
        Self::resist(self, k, &Moved::new(a, b)).rows()
    }
}

/// The rotations of all particles in a field.
fn turns(u: &[Six]) -> Vec<Quat> {
    let mut out = vec![[0.0; 4]; u.len()];
    par::each((&mut out[..], u), |_, (out, u)| {
        out.iter_mut().zip(u).for_each(|(q, u)| *q = turn_by(halves(u).1));
    });
    out
}

/// The sum of energies, mode by mode.
pub fn plus(a: Modes, b: Modes) -> Modes {
    std::array::from_fn(|k| a[k] + b[k])
}
