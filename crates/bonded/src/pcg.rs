//! Preconditioned conjugate gradients, which know by how much each step lowers the energy.

use super::coarse::Coarse;
use super::precond::Blocks;
use super::six::Six;
use perigrain_base::par;

/// How a solution stands.
pub struct Progress<'a> {
    /// Steps done.
    pub iterations: usize,
    /// Energy at the present field: what was given less what the steps have taken [energy].
    pub energy: f64,
    /// What the last [`WINDOW`] steps have taken, if there were as many [energy].
    pub fallen: Option<f64>,
    /// |r|₂ over forces alone [force].
    pub residual: f64,
    /// The present field.
    pub field: &'a [Six],
    /// The residual, zero where the field is held.
    pub r: &'a [Six],
}

/// Over how many steps the fall of the energy is watched.
pub const WINDOW: usize = 5;

/// What of the energy is left to take once the steps have taken `fallen`, as far as the tail of a solution tells: an estimate and no
/// bound. On random packings about twice `fallen` was left; on bodies with slow modes (inverse opals) up to six times.
pub const MARGIN: f64 = 3.0;

/// How a solution ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    /// Steps done.
    pub iterations: usize,
    /// Energy at the field by what the steps have taken [energy].
    pub energy: f64,
    /// What may be left of the energy to take, three times the fall of the last steps [energy].
    pub open: f64,
    /// Whether it ended because `stop` said so or nothing was left to do.
    pub done: bool,
}

/// What steps are preconditioned by ([`solve`]): blocks, and coarse levels where steps turn out to be many.
pub struct Preconditioner<'a> {
    blocks: &'a Blocks,
    make: Option<&'a dyn Fn() -> Coarse>,
    /// Coarse levels, once they are made; those of another matrix that is much the same do as well.
    coarse: Option<Coarse>,
}

impl<'a> Preconditioner<'a> {
    /// Blocks alone.
    pub fn plain(blocks: &'a Blocks) -> Self {
        Self { blocks, make: None, coarse: None }
    }

    /// Blocks, and after [`PATIENCE`] steps what `make` makes.
    pub fn deep(blocks: &'a Blocks, make: &'a dyn Fn() -> Coarse) -> Self {
        Self::again(blocks, make, None)
    }

    /// Blocks, and coarse levels that were made for a matrix before this one, if they were.
    pub fn again(blocks: &'a Blocks, make: &'a dyn Fn() -> Coarse, coarse: Option<Coarse>) -> Self {
        Self { blocks, make: Some(make), coarse }
    }

    /// Coarse levels for the next matrix, unless a solution by them shows that they are too old.
    pub fn kept(self, solved: &Solved) -> Option<Coarse> {
        self.coarse.filter(|_| solved.iterations <= OLD)
    }

    /// Adds what coarse levels do, if there are some, to z = M⁻¹ r, where r·z is `rz`; r·z of what comes out.
    fn deepen(&self, rz: f64, r: &[Six], z: &mut [Six]) -> f64 {
        let Some(coarse) = &self.coarse else { return rz };
        coarse.add_to(z, r, self.blocks);
        par::sum(r.len(), |k| inner(&r[k], &z[k]))
    }
}

/// After so many steps coarse levels are made, which takes as long as some ten steps. Packings that follow the load evenly are solved to
/// 1 % before or soon after; in others what the first thirty steps say of the error is wrong (30 % for 9 % in an inverse opal).
pub const PATIENCE: usize = 15;

/// Coarse levels with which a solution takes more steps are made anew for the next one.
const OLD: usize = 4 * PATIENCE;

/// Below this part of the energy the next step would change nothing of it.
const NOTHING: f64 = 1e-26;

/// Lowers ½ uᵀK u − fᵀu over the components of `field` that are not held, from the field as it is, until `stop` says so, the energy
/// cannot change any more, or `most` steps are done.
///
/// `product(u, out)` gives out = K u for a positive semidefinite K; `energy` is what is counted from, at the field as it is. The
/// load `f` balances, as that of a strained body does, or K is definite over what is free.
pub fn solve(
    product: impl Fn(&[Six], &mut [Six]),
    by: &mut Preconditioner,
    load: Option<&[Six]>,
    field: &mut [Six],
    energy: f64,
    most: usize,
    mut stop: impl FnMut(&Progress) -> bool,
) -> Solved {
    let (n, blocks) = (field.len(), by.blocks);
    let mut r = vec![[0.0; 6]; n];
    let mut p = vec![[0.0; 6]; n];
    let mut q = vec![[0.0; 6]; n];
    product(field, &mut q);
    // r = f − K u, z = M⁻¹ r in the place of q, p = z.
    let first = par::reduce_each(
        (&mut r[..], &mut q[..]),
        |start, (r, q)| {
            let mut sums = [0.0; 2];
            for k in 0..r.len() {
                let f = load.map_or([0.0; 6], |f| f[start + k]);
                r[k] = blocks.free(start + k, &std::array::from_fn(|c| f[c] - q[k][c]));
                q[k] = blocks.apply(start + k, &r[k]);
                tally(&mut sums, &r[k], &q[k]);
            }
            sums
        },
        both,
    );
    let [mut rz, mut rr] = first.unwrap_or_default();
    rz = by.deepen(rz, &r, &mut q);
    p.copy_from_slice(&q);
    let mut out = Solved { iterations: 0, energy, open: f64::NAN, done: true };
    let mut taken: Vec<f64> = vec![];
    let mut most_energy = energy.abs();
    loop {
        let fallen = (taken.len() >= WINDOW).then(|| taken[taken.len() - WINDOW..].iter().sum::<f64>());
        out.open = fallen.map_or(f64::NAN, |fallen| MARGIN * fallen);
        most_energy = most_energy.max(out.energy.abs());
        if rz < 0.0 {
            // No preconditioner of springs: some stiffness is negative.
            out.done = false;
            return out;
        }
        if rz <= NOTHING * most_energy {
            out.open = out.open.min(MARGIN * NOTHING * most_energy);
            return out;
        }
        let progress = Progress {
            iterations: out.iterations,
            energy: out.energy,
            fallen,
            residual: rr.sqrt(),
            field,
            r: &r,
        };
        if stop(&progress) {
            return out;
        }
        if out.iterations >= most || perigrain_base::stop::cuts() {
            out.done = false;
            return out;
        }
        if let (PATIENCE, None, Some(make)) = (out.iterations, &by.coarse, by.make) {
            // z of the last step still stands in q. Directions begin anew, and so does what they tell of the energy.
            by.coarse = Some(make());
            rz = by.deepen(rz, &r, &mut q);
            p.copy_from_slice(&q);
            taken.clear();
        }
        product(&p, &mut q);
        let pq = par::sum(n, |k| inner(&p[k], &blocks.free(k, &q[k])));
        if pq.is_nan() || pq <= 0.0 {
            // Rounding has eaten the direction, or the stiffnesses are not those of springs.
            out.done = pq == 0.0;
            return out;
        }
        let alpha = rz / pq;
        let next = par::reduce_each(
            (&mut *field, &mut r[..], &p[..], &mut q[..]),
            |start, (u, r, p, q)| {
                let mut sums = [0.0; 2];
                for k in 0..r.len() {
                    let kp = blocks.free(start + k, &q[k]);
                    for c in 0..6 {
                        u[k][c] += alpha * p[k][c];
                        r[k][c] -= alpha * kp[c];
                    }
                    q[k] = blocks.apply(start + k, &r[k]);
                    tally(&mut sums, &r[k], &q[k]);
                }
                sums
            },
            both,
        );
        let before = rz;
        [rz, rr] = next.unwrap_or_default();
        rz = by.deepen(rz, &r, &mut q);
        let beta = rz / before;
        par::each((&mut p[..], &q[..]), |_, (p, z)| {
            for (p, z) in p.iter_mut().zip(z) {
                *p = std::array::from_fn(|c| z[c] + beta * p[c]);
            }
        });
        taken.push(0.5 * alpha * before);
        out.energy -= 0.5 * alpha * before;
        out.iterations += 1;
    }
}

fn inner(a: &Six, b: &Six) -> f64 {
    (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) + (a[3] * b[3] + a[4] * b[4] + a[5] * b[5])
}

/// r·z, and r·r over forces.
fn tally(sums: &mut [f64; 2], r: &Six, z: &Six) {
    sums[0] += inner(r, z);
    sums[1] += r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
}

fn both(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}
