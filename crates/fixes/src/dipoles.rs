//! Dipole moments that follow the spin of their spheres (`fix nve/sphere … update dipole`).

use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale};
use perigrain_base::par;
use perigrain_plan::{Needs, Op, Stage, Tick};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::Words;
use perigrain_world::field::{MASK, MU, OMEGA};
use perigrain_world::{GroupId, World};

/// Integration scheme of the moments.
#[derive(Clone, Copy, Debug, PartialEq, Words)]
#[word(what = "way to turn dipoles")]
pub enum Update {
    /// Dipole moments follow the spin, μ += Δt ω × μ, at their length.
    #[word("dipole")]
    Plain,
    /// Dipole moments are turned by rotations about x y z y x of the body, half of Δt each (Dullweber, Leimkuhler, McLachlan,
    /// J. Chem. Phys. 107, 1997), which is of second order.
    #[word("dipole/dlm")]
    Rotations,
}

/// The op that rotates the moments of a group after the first half kick of a step.
pub fn op(name: String, group: GroupId, update: Update) -> Box<dyn Op> {
    let needs = Needs::new().read(MASK).write(MU | OMEGA);
    let op = StepOp::new(name, Stage::InitialIntegrate, needs, move |w: &mut World, t: &Tick| {
        // With several time step levels, the shortest step rotates.
        if t.phase.level > 0 {
            return Ok(());
        }
        let (bit, dt, p) = (group.bit(), t.dt, &mut w.particles);
        let columns = (&mut p.mu[..], &mut p.omega[..], &p.mask[..]);
        par::each(columns, |_, (mu, omega, mask): (&mut [Vec3], &mut [Vec3], &[u32])| {
            for ((mu, omega), _) in mu.iter_mut().zip(omega).zip(mask).filter(|(_, m)| **m & bit != 0) {
                let size = length(*mu);
                if size > 0.0 {
                    match update {
                        Update::Plain => *mu = plain(*mu, *omega, size, dt),
                        Update::Rotations => (*mu, *omega) = rotated(*mu, *omega, size, dt),
                    }
                }
            }
        });
        Ok(())
    });
    op.in_every_level().boxed()
}

/// μ + Δt ω × μ at the size that μ has.
fn plain(mu: Vec3, omega: Vec3, size: f64, dt: f64) -> Vec3 {
    let turned = add(mu, scale(dt, cross(omega, mu)));
    scale(size / length(turned), turned)
}

/// Rotation about axis `k` by `angle`, with LAMMPS' cosine (1 − a²/4)/(1 + a²/4) and sine a/(1 + a²/4).
fn about(k: usize, angle: f64, v: Vec3) -> Vec3 {
    let quarter = 0.25 * angle * angle;
    let (c, s) = ((1.0 - quarter) / (1.0 + quarter), angle / (1.0 + quarter));
    let (a, b) = ((k + 1) % 3, (k + 2) % 3);
    let mut turned = v;
    (turned[a], turned[b]) = (c * v[a] - s * v[b], s * v[a] + c * v[b]);
    turned
}

/// Moment and spin by the rotations of Dullweber, Leimkuhler and McLachlan (J. Chem. Phys. 107, 1997). The
/// body's z axis lies along the moment; spins are rotated by R, and the rows of Q (the body's axes in space)
/// by its inverse.
fn rotated(mu: Vec3, omega: Vec3, size: f64, dt: f64) -> (Vec3, Vec3) {
    let a = scale(1.0 / size, mu);
    let aside = a[0] * a[0] + a[1] * a[1];
    let mut q: [Vec3; 3] = if aside > 0.0 {
        let k = (1.0 - a[2]) / aside;
        [
            [1.0 - k * a[0] * a[0], -k * a[0] * a[1], -a[0]],
            [-k * a[0] * a[1], 1.0 - k * a[1] * a[1], -a[1]],
            [a[0], a[1], 1.0 - k * aside],
        ]
    } else {
        [0, 1, 2].map(|row| [0, 1, 2].map(|column| if row == column { 1.0 / a[2] } else { 0.0 }))
    };
    let mut w = q.map(|row| dot(row, omega));
    for (k, part) in [(0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)] {
        let angle = part * dt * w[k];
        w = about(k, angle, w);
        // The columns of Q are rotated by R transposed.
        for column in 0..3 {
            let turned = about(k, -angle, [q[0][column], q[1][column], q[2][column]]);
            (0..3).for_each(|row| q[row][column] = turned[row]);
        }
    }
    let spin = [0, 1, 2].map(|column| (0..3).map(|row| q[row][column] * w[row]).sum());
    (scale(size, q[2]), spin)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A moment perpendicular to its spin rotates by ω Δt per step.
    #[test]
    fn moments_turn_at_the_rate_of_the_spin() {
        let (rate, dt, steps) = (2.0, 1e-3, 500);
        let (mut plainly, mut by_rotations, mut spin) = ([0.7, 0.0, 0.0], [0.7, 0.0, 0.0], [0.0, 0.0, rate]);
        for _ in 0..steps {
            plainly = plain(plainly, [0.0, 0.0, rate], 0.7, dt);
            (by_rotations, spin) = rotated(by_rotations, spin, 0.7, dt);
        }
        let angle = rate * dt * f64::from(steps);
        let exact = [0.7 * angle.cos(), 0.7 * angle.sin(), 0.0];
        // Both are second order for a fixed axis: ω³ Δt² t is about 2e-6 or less.
        for found in [plainly, by_rotations] {
            assert!((0..3).all(|d| (found[d] - exact[d]).abs() < 3e-6), "{found:?} {exact:?}");
            assert!((length(found) - 0.7).abs() < 1e-13);
        }
        // Rounding errors of Q add up to 9e-12 in these steps.
        assert!((length(spin) - rate).abs() < 1e-10 && spin[2] > 0.999 * rate);
    }
}
