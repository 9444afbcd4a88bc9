//! Preconditioned conjugate gradients that monitor the decrease of the energy.

use super::coarse::Coarse;
use super::precond::Blocks;
use super::six::Six;
use perigrain_base::par;

/// State of a solution.
pub struct Progress<'a> {
    /// Steps done.
    pub iterations: usize,
    /// Energy of the current field: the initial energy minus the decrease by the steps [energy].
    pub energy: f64,
    /// Decrease by the last [`WINDOW`] steps, if there were as many [energy].
    pub fallen: Option<f64>,
    /// |r|₂ over forces alone [force].
    pub residual: f64,
    /// The current field.
    pub field: &'a [Six],
    /// The residual, zero for held components.
    pub r: &'a [Six],
}

/// Number of steps over which the decrease of the energy is observed.
pub const WINDOW: usize = 5;

/// Factor from the recent decrease to the energy still to be gained, as far as the tail of a solution shows
/// it: an estimate, not a bound. On random packings about twice the recent decrease remained; on bodies with
/// slow modes (inverse opals) up to six times.
pub const MARGIN: f64 = 3.0;

/// Result of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    /// Steps done.
    pub iterations: usize,
    /// Energy of the field, by the decrease of the steps [energy].
    pub energy: f64,
    /// Estimate of the remaining decrease, three times that of the last steps [energy].
    pub open: f64,
    /// Whether it ended by `stop`, or because it was exact.
    pub done: bool,
}

/// Preconditioner of [`solve`]: blocks, and coarse levels if there are many steps.
pub struct Preconditioner<'a> {
    pub(crate) blocks: &'a Blocks,
    make: Option<&'a dyn Fn() -> Coarse>,
    /// Coarse levels, once they are made; those of a similar matrix work as well.
    coarse: Option<Coarse>,
}

impl<'a> Preconditioner<'a> {
    /// Blocks only.
    pub fn plain(blocks: &'a Blocks) -> Self {
        Self { blocks, make: None, coarse: None }
    }

    /// Blocks, and after [`PATIENCE`] steps the levels from `make`.
    pub fn deep(blocks: &'a Blocks, make: &'a dyn Fn() -> Coarse) -> Self {
        Self::again(blocks, make, None)
    }

    /// Blocks, and coarse levels made for an earlier matrix, if any.
    pub fn again(blocks: &'a Blocks, make: &'a dyn Fn() -> Coarse, coarse: Option<Coarse>) -> Self {
        Self { blocks, make: Some(make), coarse }
    }

    /// Coarse levels for the next matrix, unless this solution shows that they are outdated.
    pub fn kept(self, solved: &Solved) -> Option<Coarse> {
        self.coarse.filter(|_| solved.iterations <= OLD)
    }

    /// z = M⁻¹ r of the free components.
    pub(crate) fn apply(&self, r: &[Six], z: &mut [Six]) {
        let blocks = self.blocks;
        par::each(&mut z[..], |start, rows: &mut [Six]| {
            rows.iter_mut().enumerate().for_each(|(k, row)| *row = blocks.apply(start + k, &r[start + k]));
        });
        if let Some(coarse) = &self.coarse {
            coarse.add_to(z, r, blocks);
        }
    }

    /// The coarse levels, if there are none yet.
    pub(crate) fn make(&mut self) {
        if let (None, Some(make)) = (&self.coarse, self.make) {
            self.coarse = Some(make());
        }
    }

    /// Adds the correction of the coarse levels, if any, to z = M⁻¹ r, with r·z = `rz`; returns the new r·z.
    fn deepen(&self, rz: f64, r: &[Six], z: &mut [Six]) -> f64 {
        let Some(coarse) = &self.coarse else { return rz };
        coarse.add_to(z, r, self.blocks);
        par::sum(r.len(), |k| inner(&r[k], &z[k]))
    }
}

/// Number of steps after which coarse levels are made, which costs about ten steps. Packings with nearly
/// affine deformation are solved to 1 % before or soon after; in others the error estimate of the first
/// thirty steps is wrong (30 % instead of 9 % in an inverse opal).
pub const PATIENCE: usize = 15;

/// Coarse levels are remade for the next solution if one takes more steps than this.
const OLD: usize = 4 * PATIENCE;

/// Relative decrease below which a step no longer changes the energy.
const NOTHING: f64 = 1e-26;

/// Minimizes ½ uᵀK u − fᵀu over the free components of `field`, starting from its values, until `stop`
/// returns true, the energy cannot change any more, or `most` steps are done.
///
/// `product(u, out)` gives out = K u for a positive semidefinite K; `energy` is the energy of the initial
/// field. The load `f` is in equilibrium, as for a strained body, or K is definite on the free components.
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
    // r = f − K u, z = M⁻¹ r stored in q, p = z.
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
            // Not a preconditioner of springs: some stiffness is negative.
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
            // z of the last step is still in q. Search directions restart, and so does the observation of the
            // energy.
            by.coarse = Some(make());
            rz = by.deepen(rz, &r, &mut q);
            p.copy_from_slice(&q);
            taken.clear();
        }
        product(&p, &mut q);
        let pq = par::sum(n, |k| inner(&p[k], &blocks.free(k, &q[k])));
        if pq.is_nan() || pq <= 0.0 {
            // Rounding has destroyed the direction, or the stiffnesses are invalid.
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

pub(crate) fn inner(a: &Six, b: &Six) -> f64 {
    (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) + (a[3] * b[3] + a[4] * b[4] + a[5] * b[5])
}

/// r·z, and r·r over force components.
fn tally(sums: &mut [f64; 2], r: &Six, z: &Six) {
    sums[0] += inner(r, z);
    sums[1] += r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
}

fn both(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}
