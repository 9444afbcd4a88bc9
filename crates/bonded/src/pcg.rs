//! Preconditioned conjugate gradients, which know by how much each step lowers the energy.

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

/// Below this part of the energy the next step would change nothing of it.
const NOTHING: f64 = 1e-26;

/// Lowers ½ uᵀK u − fᵀu over the components of `field` that are not held, from the field as it is, until `stop` says so, the energy
/// cannot change any more, or `most` steps are done.
///
/// `product(u, out)` gives out = K u for a positive semidefinite K; `energy` is what is counted from, at the field as it is. The
/// load `f` balances, as that of a strained body does, or K is definite over what is free.
pub fn solve(
    product: impl Fn(&[Six], &mut [Six]),
    blocks: &Blocks,
    load: Option<&[Six]>,
    field: &mut [Six],
    energy: f64,
    most: usize,
    mut stop: impl FnMut(&Progress) -> bool,
) -> Solved {
    let n = field.len();
    let mut r = vec![[0.0; 6]; n];
    let mut p = vec![[0.0; 6]; n];
    let mut q = vec![[0.0; 6]; n];
    product(field, &mut q);
    // r = f − K u, z = M⁻¹ r in the place of q, p = z.
    let first = par::reduce_each(
        (&mut r[..], &mut q[..], &mut p[..]),
        |start, (r, q, p)| {
            let mut sums = [0.0; 2];
            for k in 0..r.len() {
                let f = load.map_or([0.0; 6], |f| f[start + k]);
                r[k] = blocks.free(start + k, &std::array::from_fn(|c| f[c] - q[k][c]));
                q[k] = blocks.apply(start + k, &r[k]);
                p[k] = q[k];
                tally(&mut sums, &r[k], &q[k]);
            }
            sums
        },
        both,
    );
    let [mut rz, mut rr] = first.unwrap_or_default();
    let mut out = Solved { iterations: 0, energy, open: f64::NAN, done: true };
    let mut taken: Vec<f64> = vec![];
    let mut most_energy = energy.abs();
    loop {
        let fallen = (taken.len() >= WINDOW).then(|| taken[taken.len() - WINDOW..].iter().sum::<f64>());
        out.open = fallen.map_or(f64::NAN, |fallen| MARGIN * fallen);
        most_energy = most_energy.max(out.energy.abs());
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
        if out.iterations >= most {
            out.done = false;
            return out;
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
