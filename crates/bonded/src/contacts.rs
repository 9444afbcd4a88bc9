//! Hertz contacts between spheres, and with planes at the ends of a sample, for small displacements: directions stay, whether two touch
//! is asked anew for every field, nothing slips.
//!
//! K. Jarolin, M. Dosta, Comput. Part. Mech. 8 (2021), section 2.2; forces of Hertz, tangential stiffness of Mindlin.

use super::network::halves;
use super::pairs::Pairs;
use super::six::{Packed, Six, at};
use perigrain_base::math::vec3::{Vec3, add, cross, dot, scale, sub};
use perigrain_base::par;

/// Contacts, touching or not yet.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// Who may touch whom.
    pub pairs: Pairs,
    /// As columns, in the order of the pairs.
    list: Vec<Contact>,
}

/// A contact of two spheres.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Unit vector from the lower end to the upper one.
    pub n: Vec3,
    /// R_i + R_j − l before anything moves, negative for a gap [length].
    pub overlap: f64,
    /// F/δ^3/2 = 4/3 E* √R* [force/length^3/2].
    pub normal: f64,
    /// k_t/√δ = 8 G* √R* [force/length^3/2].
    pub tangential: f64,
    /// Radii of the lower end and of the upper one [length].
    pub arms: [f64; 2],
    /// Whether the force it has before anything moves is taken away.
    pub relaxed: bool,
}

/// What a contact is like at some field.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    /// Force along the normal, positive apart [force].
    push: f64,
    /// dF/dδ and k_t [force/length].
    k: [f64; 2],
}

impl Contact {
    /// The same with its ends exchanged.
    fn turned(self) -> Self {
        Self { n: self.n.map(|a| -a), arms: [self.arms[1], self.arms[0]], ..self }
    }

    /// F_n = κ δ^3/2, k_n = 3/2 κ √δ, k_t = κ_t √δ at δ = δ₀ − n·(u_j − u_i).
    #[inline(always)]
    fn state(&self, a: &Six, b: &Six) -> State {
        let along = dot(self.n, sub(halves(b).0, halves(a).0));
        let hertz = |overlap: f64| self.normal * overlap * overlap.sqrt();
        let (overlap, before) = ((self.overlap - along).max(0.0), self.overlap.max(0.0));
        let root = overlap.sqrt();
        let relief = if self.relaxed { hertz(before) } else { 0.0 };
        State { push: hertz(overlap) - relief, k: [1.5 * self.normal * root, self.tangential * root] }
    }

    /// ξ = P (u_j − u_i) + n × (R_i θ_i + R_j θ_j).
    #[inline(always)]
    fn slip(&self, a: &Six, b: &Six) -> Vec3 {
        let ((ua, ta), (ub, tb)) = (halves(a), halves(b));
        let apart = sub(ub, ua);
        let across = sub(apart, scale(dot(self.n, apart), self.n));
        add(across, cross(self.n, add(scale(self.arms[0], ta), scale(self.arms[1], tb))))
    }

    /// Resisting forces and torques of both ends for a force along n and one across it on the upper end.
    #[inline(always)]
    fn rows(&self, along: f64, across: Vec3) -> [Six; 2] {
        let f = add(scale(along, self.n), across);
        let turn = cross(across, self.n);
        let (a, b) = (scale(self.arms[0], turn), scale(self.arms[1], turn));
        [[-f[0], -f[1], -f[2], a[0], a[1], a[2]], [f[0], f[1], f[2], b[0], b[1], b[2]]]
    }
}

impl Contacts {
    /// Between these ends, the first and the second as `contact(k)` sees them.
    pub fn new(particles: usize, ends: &[[u32; 2]], contact: impl Fn(usize) -> Contact) -> Self {
        let pairs = Pairs::new(particles, ends);
        let list = pairs.origin.iter().map(|k| *k as usize).map(|k| {
            let [a, b] = ends[k];
            if a < b { contact(k) } else { contact(k).turned() }
        });
        Self { list: list.collect(), pairs }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Who touch in a field.
    pub fn touching_pairs(&self, u: &[Six]) -> impl Iterator<Item = [u32; 2]> {
        let touch =
            |ends: &[u32; 2], c: &Contact| c.state(&u[ends[0] as usize], &u[ends[1] as usize]).k[0] > 0.0;
        self.pairs.ends.iter().zip(&self.list).filter(move |(ends, c)| touch(ends, c)).map(|(ends, _)| *ends)
    }

    /// How many touch in a field.
    pub fn touching(&self, u: &[Six]) -> usize {
        self.touching_pairs(u).count()
    }

    /// Those that touch under a strain that all follow, as springs: ends, vectors from the first to the second, stiffnesses along and
    /// across.
    pub fn springs(&self, strain: &[Vec3; 3]) -> Vec<([u32; 2], Vec3, [f64; 2])> {
        let spring = |(ends, c): (&[u32; 2], &Contact)| {
            let d = scale(c.arms[0] + c.arms[1] - c.overlap, c.n);
            let u = strain.map(|row| dot(row, d));
            let k = c.state(&[0.0; 6], &[u[0], u[1], u[2], 0.0, 0.0, 0.0]).k;
            (k[0] > 0.0).then_some((*ends, d, k))
        };
        self.pairs.ends.iter().zip(&self.list).filter_map(spring).collect()
    }

    /// out += h(u), the resisting forces.
    pub fn add_forces(&self, u: &[Six], out: &mut [Six]) {
        self.pairs.gather(out, |k, [i, j]| {
            let (c, a, b) = (&self.list[k], &u[i], &u[j]);
            let state = c.state(a, b);
            c.rows(-state.push, scale(state.k[1], c.slip(a, b)))
        });
    }

    /// Stiffnesses of all contacts at a field; that of F_t over δ is left out, which would make them unsymmetric.
    pub fn tangent(&self, u: &[Six]) -> Vec<[f64; 2]> {
        let mut out = vec![[0.0; 2]; self.list.len()];
        par::each((&mut out[..], &self.list[..], &self.pairs.ends[..]), |_, (out, list, ends)| {
            for ((out, c), [i, j]) in out.iter_mut().zip(list).zip(ends) {
                *out = c.state(&u[*i as usize], &u[*j as usize]).k;
            }
        });
        out
    }

    /// out += K p with these stiffnesses.
    pub fn add_product(&self, k: &[[f64; 2]], p: &[Six], out: &mut [Six]) {
        self.pairs.gather(out, |at, [i, j]| self.resist(at, k[at], &p[i], &p[j]));
    }

    #[inline(always)]
    fn resist(&self, at: usize, [along, across]: [f64; 2], a: &Six, b: &Six) -> [Six; 2] {
        let c = &self.list[at];
        let apart = dot(c.n, sub(halves(b).0, halves(a).0));
        c.rows(along * apart, scale(across, c.slip(a, b)))
    }

    /// Adds their parts of the blocks on the diagonal.
    pub fn add_blocks(&self, k: &[[f64; 2]], out: &mut [Packed]) {
        self.pairs.gather(out, |bond, _| {
            let mut blocks = [[0.0; 21]; 2];
            for column in 0..6 {
                let (mut unit, still) = ([0.0; 6], [0.0; 6]);
                unit[column] = 1.0;
                let low = self.resist(bond, k[bond], &unit, &still)[0];
                let high = self.resist(bond, k[bond], &still, &unit)[1];
                for row in column..6 {
                    blocks[0][at(row, column)] = low[row];
                    blocks[1][at(row, column)] = high[row];
                }
            }
            blocks
        });
    }

    /// ∫ F dδ + ½ k_t ξ² of all [energy].
    pub fn energy(&self, u: &[Six]) -> f64 {
        par::sum(self.list.len(), |k| {
            let [i, j] = self.pairs.ends[k].map(|i| i as usize);
            let (c, a, b) = (&self.list[k], &u[i], &u[j]);
            let along = dot(c.n, sub(halves(b).0, halves(a).0));
            let held = |overlap: f64| 0.4 * c.normal * overlap.max(0.0).powf(2.5);
            let before = c.overlap.max(0.0);
            let relief = if c.relaxed { c.normal * before.powf(1.5) * along } else { 0.0 };
            let slip = c.slip(a, b);
            held(c.overlap - along) - held(c.overlap) + relief + 0.5 * c.state(a, b).k[1] * dot(slip, slip)
        })
    }
}

/// Contacts of particles with the planes at both ends of a sample, which push along the axis alone. The low plane stands still.
#[derive(Clone, Debug, Default)]
pub struct Walls {
    /// Direction of the axis.
    pub axis: usize,
    /// How far the high plane moves along it [length].
    pub delta: f64,
    /// For each end who may touch: place, overlap before anything moves, 4/3 E* √R.
    pub near: [Vec<(u32, f64, f64)>; 2],
}

impl Walls {
    /// Force and stiffness of a contact at an end.
    fn state(&self, end: usize, u: &[Six], (particle, overlap, normal): (u32, f64, f64)) -> [f64; 2] {
        let moved = u[particle as usize][self.axis];
        let overlap = (overlap + if end == 0 { -moved } else { moved - self.delta }).max(0.0);
        [normal * overlap * overlap.sqrt(), 1.5 * normal * overlap.sqrt()]
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.near.iter().all(Vec::is_empty)
    }

    /// How many touch at each end.
    pub fn touching(&self, u: &[Six]) -> [usize; 2] {
        [0, 1].map(|end| self.near[end].iter().filter(|c| self.state(end, u, **c)[0] > 0.0).count())
    }

    /// By how much both planes come closer to the body between them to push with a force [length].
    pub fn yielding(&self, force: f64) -> f64 {
        (0..2).map(|end| self.depth(end, force)).sum()
    }

    /// Σ κ (δ − gap)^3/2 = F for the depth δ of one plane, by halving what brackets it.
    fn depth(&self, end: usize, force: f64) -> f64 {
        let near = &self.near[end];
        if near.is_empty() || force <= 0.0 {
            return 0.0;
        }
        let push = |depth: f64| near.iter().map(|c| c.2 * (c.1 + depth).max(0.0).powf(1.5)).sum::<f64>();
        let (mut low, mut high) = (0.0, 1e-12 * (force / near[0].2).cbrt().powi(2));
        while push(high) < force {
            high *= 2.0;
        }
        while high - low > 1e-15 * high {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if push(middle) < force { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// With which force each plane pushes [force].
    pub fn push(&self, u: &[Six]) -> [f64; 2] {
        [0, 1].map(|end| self.near[end].iter().map(|c| self.state(end, u, *c)[0]).sum())
    }

    /// out += h(u).
    pub fn add_forces(&self, u: &[Six], out: &mut [Six]) {
        for (end, sign) in [(0, -1.0), (1, 1.0)] {
            for c in &self.near[end] {
                out[c.0 as usize][self.axis] += sign * self.state(end, u, *c)[0];
            }
        }
    }

    /// Stiffnesses along the axis by particle, those of both planes together.
    pub fn tangent(&self, u: &[Six]) -> Vec<(u32, f64)> {
        let of = |end: usize| self.near[end].iter().map(move |c| (c.0, self.state(end, u, *c)[1]));
        of(0).chain(of(1)).filter(|(_, k)| *k > 0.0).collect()
    }

    /// ∫ F dδ of all [energy].
    pub fn energy(&self, u: &[Six]) -> f64 {
        let before = |c: &(u32, f64, f64)| 0.4 * c.2 * c.1.max(0.0).powf(2.5);
        let now = |end: usize, c: &(u32, f64, f64)| {
            let force = self.state(end, u, *c)[0];
            0.4 * force * (force / c.2).cbrt().powi(2)
        };
        (0..2).flat_map(|end| self.near[end].iter().map(move |c| now(end, c) - before(c))).sum()
    }
}
