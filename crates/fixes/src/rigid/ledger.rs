//! Energy ledger of bodies whose masses are not the sums over their particles.

use super::Declared;
use super::motion::Crew;
use perigrain_base::math::vec3::{dot, sub};
use perigrain_styles::ledger;
use perigrain_styles::matter::{Masses, unwrapped};
use perigrain_styles::rigid_bodies::Body;
use perigrain_world::World;

impl Declared {
    /// Records twice the kinetic energies of translation and rotation, and the power of gravity, in excess of
    /// those of the particles, which the ledger counts itself.
    pub fn book_in_ledger(&self, w: &mut World, crew: &Crew, bodies: &[Body]) {
        if !ledger::is_open(w) || (!self.gives() && crew.weight.is_none()) {
            return;
        }
        let (p, masses, pulls) = (&w.particles, Masses::of(w), crew.weight.accelerations(w));
        let mut beyond = [0.0; 3];
        for (k, b) in bodies.iter().enumerate() {
            beyond[0] += b.mass * dot(b.v, b.v);
            beyond[1] += dot(b.omega, b.momentum);
            for &i in crew.members(k) {
                let (m, r) = (masses.get(i), p.radius.get(i).copied().unwrap_or(0.0));
                beyond[0] -= m * dot(p.v[i], p.v[i]);
                beyond[1] -= p.omega.get(i).map_or(0.0, |o| 0.4 * m * r * r * dot(*o, *o));
            }
            let free = crew.members(k).iter().all(|&i| p.f[i] == [0.0; 3]);
            let all = crew.members(k).iter().filter(|_| !free);
            let all = all.map(|&i| (masses.get(i), sub(unwrapped(w, i), b.x), p.mask[i]));
            let [force, torque] = pulls.on(b.mass, all);
            beyond[2] += dot(force, b.v) + dot(torque, b.omega);
        }
        w.memo.insert(self.keys.energy, beyond.to_vec());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_base::math::vec3::{add, cross, scale};

    // The power of M g at the centre is that on the particles, Σ m g (V + ω × d), plus that of the added
    // force.
    #[test]
    fn powers_of_weights_add_up() {
        let (a, v, omega) = ([0.1, -0.2, -2.0], [0.3, 0.4, -0.5], [1.0, -0.7, 0.2]);
        let members = [(1.0, [0.5, 0.1, 0.0], 1), (0.7, [-0.2, 0.3, 0.4], 1)];
        let [force, torque] = super::super::gravity::Pulls::of_particles(1, a).on(1.3, members.into_iter());
        let on_particles: f64 = members.iter().map(|(m, d, _)| m * dot(a, add(v, cross(omega, *d)))).sum();
        let sum = on_particles + dot(force, v) + dot(torque, omega);
        // A few roundings of numbers about 2.
        assert!((sum - dot(scale(1.3, a), v)).abs() < 1e-14);
    }
}
