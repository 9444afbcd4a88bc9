//! Hertz contacts between spheres, and with planes at the ends of a sample. Contacts are detected for every
//! field. Without a [`Past`], displacements are small, directions are fixed and nothing slips; with it,
//! directions follow the field and surfaces slip.
//!
//! K. Jarolin, M. Dosta, Comput. Part. Mech. 8 (2021), section 2.2; normal forces of Hertz, tangential
//! stiffness of Mindlin.

use super::contact::{Contact, Spring, State};
use super::network::halves;
use super::pairs::{Pairs, Ties};
use super::six::{Packed, Six, at, unit};
use perigrain_base::math::vec3::{Vec3, dot, length, scale, sub};
use perigrain_base::par;

/// Contacts and possible contacts.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// The pairs of particles.
    pub pairs: Pairs,
    /// The contacts, in the order of the pairs.
    list: Vec<Contact>,
}

/// History of contacts for a load applied in parts.
#[derive(Clone, Debug)]
pub struct Past {
    /// Friction coefficient: the limit of tangential over normal force; infinite if nothing slips.
    pub friction: f64,
    /// Field at the end of the last part.
    pub field: Vec<Six>,
    /// Tangential displacement of each contact at that time [length].
    pub sheared: Vec<Vec3>,
}

impl Contacts {
    /// For these pairs, with the order of ends of `contact(k)`.
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

    /// Whether some transmit tangential forces.
    pub fn rough(&self) -> bool {
        self.list.iter().any(|c| c.tangential > 0.0)
    }

    /// A history without displacement.
    pub fn unsheared(&self, friction: f64, field: Vec<Six>) -> Past {
        Past { friction, field, sheared: vec![[0.0; 3]; self.list.len()] }
    }

    /// Updates the history at the end of a part of the load.
    pub fn pass(&self, u: &[Six], past: &mut Past) {
        let sheared = self.each(u, Some(past), |s| if s.overlap > 0.0 { s.sheared } else { [0.0; 3] });
        *past = Past { friction: past.friction, field: u.to_vec(), sheared };
    }

    /// The state of a contact in a field, given a history.
    #[inline(always)]
    fn state(&self, k: usize, ends: [usize; 2], u: &[Six], past: Option<&Past>) -> State {
        let (c, now) = (&self.list[k], ends.map(|i| &u[i]));
        past.map_or_else(
            || c.near(now),
            |p| c.after(now, ends.map(|i| &p.field[i]), p.sheared[k], p.friction),
        )
    }

    /// A function of the state of each contact.
    fn each<T: Copy + Default + Send + Sync>(
        &self,
        u: &[Six],
        past: Option<&Past>,
        of: impl Fn(&State) -> T + Sync,
    ) -> Vec<T> {
        let mut out = vec![T::default(); self.list.len()];
        par::each(&mut out[..], |start, out: &mut [T]| {
            for (k, out) in (start..).zip(out) {
                let ends = self.pairs.ends[k].map(|i| i as usize);
                *out = of(&self.state(k, ends, u, past));
            }
        });
        out
    }

    /// Pairs in contact for a field.
    pub fn touching_pairs(&self, u: &[Six]) -> impl Iterator<Item = [u32; 2]> {
        self.touch(u, None)
    }

    fn touch(&self, u: &[Six], past: Option<&Past>) -> impl Iterator<Item = [u32; 2]> {
        let touch = self.each(u, past, |s| s.k[0] > 0.0);
        self.pairs.ends.iter().zip(touch).filter(|(_, touch)| *touch).map(|(ends, _)| *ends)
    }

    /// The number of contacts for a field, and how many of them slip.
    pub fn touching(&self, u: &[Six], past: Option<&Past>) -> [usize; 2] {
        let of =
            self.each(u, past, |s| [usize::from(s.k[0] > 0.0), usize::from(s.k[0] > 0.0 && s.stuck < 1.0)]);
        of.iter().fold([0; 2], |sum, a| [sum[0] + a[0], sum[1] + a[1]])
    }

    /// Contacts under a uniform strain, as springs: ends, vectors from the first to the second, normal and
    /// tangential stiffness for small motions from there; with friction, the secant over the whole path.
    pub fn springs(&self, strain: &[Vec3; 3], friction: Option<f64>) -> Vec<([u32; 2], Vec3, [f64; 2])> {
        let spring = |(ends, c): (&[u32; 2], &Contact)| {
            let d = scale(c.arms[0] + c.arms[1] - c.overlap, c.n);
            let apart = strain.map(|row| dot(row, d));
            let k = c.strained(apart, friction);
            (k[0] > 0.0).then_some((*ends, d, k))
        };
        self.pairs.ends.iter().zip(&self.list).filter_map(spring).collect()
    }

    /// out += h(u), the resisting forces.
    pub fn add_forces(&self, u: &[Six], past: Option<&Past>, out: &mut [Six]) {
        self.pairs.gather(out, |k, ends| {
            let c = &self.list[k];
            let s = self.state(k, ends, u, past);
            c.rows(s.n, -s.push, scale(s.k[1], s.sheared), inside(&s, past))
        });
    }

    /// The tangent of all contacts at a field. The unsymmetric part is omitted: the change of a tangential
    /// force with the overlap.
    pub fn tangent(&self, u: &[Six], past: Option<&Past>) -> Vec<Spring> {
        self.each(u, past, |s| {
            let slips = s.stuck < 1.0;
            let l = length(s.sheared);
            let across = if slips { s.stuck * s.k[1] } else { s.k[1] };
            let slips = if slips && l > 0.0 { scale(1.0 / l, s.sheared) } else { [0.0; 3] };
            Spring { n: s.n, k: [s.k[0], across], slips, less: inside(s, past) }
        })
    }

    /// out += K p with these springs.
    pub fn add_product(&self, springs: &[Spring], p: &[Six], out: &mut [Six]) {
        self.pairs.gather(out, |at, [i, j]| self.resist(at, &springs[at], &p[i], &p[j]));
    }

    #[inline(always)]
    fn resist(&self, at: usize, s: &Spring, a: &Six, b: &Six) -> [Six; 2] {
        let c = &self.list[at];
        let apart = dot(s.n, sub(halves(b).0, halves(a).0));
        let slid = c.slid(s.n, a, b, s.less);
        let slid = sub(slid, scale(dot(s.slips, slid), s.slips));
        c.rows(s.n, s.k[0] * apart, scale(s.k[1], slid), s.less)
    }

    /// Adds their parts of the diagonal blocks.
    pub fn add_blocks(&self, springs: &[Spring], out: &mut [Packed]) {
        self.pairs.gather(out, |bond, _| {
            let mut blocks = [[0.0; 21]; 2];
            for column in 0..6 {
                let (moves, still) = (unit(column), [0.0; 6]);
                let low = self.resist(bond, &springs[bond], &moves, &still)[0];
                let high = self.resist(bond, &springs[bond], &still, &moves)[1];
                for row in column..6 {
                    blocks[0][at(row, column)] = low[row];
                    blocks[1][at(row, column)] = high[row];
                }
            }
            blocks
        });
    }

    /// ∫ F dδ + ½ k_t ξ² of all [energy].
    pub fn energy(&self, u: &[Six], past: Option<&Past>) -> f64 {
        par::sum(self.list.len(), |k| {
            let c = &self.list[k];
            let s = self.state(k, self.pairs.ends[k].map(|i| i as usize), u, past);
            let held = |overlap: f64| 0.4 * c.normal * overlap.max(0.0).powf(2.5);
            let relief = if c.relaxed { c.hertz(c.overlap.max(0.0)) * (c.overlap - s.overlap) } else { 0.0 };
            held(s.overlap) - held(c.overlap) + relief + 0.5 * s.k[1] * dot(s.sheared, s.sheared)
        })
    }
}

/// Depth of the contact point below the surfaces: half the overlap; 0 for small displacements.
fn inside(s: &State, past: Option<&Past>) -> f64 {
    if past.is_some() { 0.5 * s.overlap.max(0.0) } else { 0.0 }
}

/// Contacts with their resistance at a given field.
pub struct Touching<'a> {
    /// All of them.
    pub contacts: &'a Contacts,
    /// Their springs from [`Contacts::tangent`].
    pub springs: &'a [Spring],
}

impl Ties for Touching<'_> {
    fn ends(&self) -> &[[u32; 2]] {
        &self.contacts.pairs.ends
    }

    fn vector(&self, k: usize) -> Vec3 {
        let c = &self.contacts.list[k];
        scale(c.arms[0] + c.arms[1] - c.overlap, c.n)
    }

    fn bears(&self, k: usize) -> bool {
        self.springs[k].k != [0.0; 2]
    }

    fn resist(&self, k: usize, [a, b]: [&Six; 2]) -> [Six; 2] {
        self.contacts.resist(k, &self.springs[k], a, b)
    }
}
