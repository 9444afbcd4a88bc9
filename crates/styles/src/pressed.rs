//! The step that contacts stand as they are pressed now, with each other and with walls.

use crate::critical::{add_walls, solid, true_mass};
use crate::probe::Probe;
use perigrain_base::diag::Result;
use perigrain_base::math::lanczos::largest_eigenvalue;
use perigrain_base::math::vec3::{Vec3, add, cross, dot, scale, sub};
use perigrain_world::World;

/// Displacement and rotation, or force and torque.
type Six = [f64; 6];

/// How close the limit of damped motions is found, and in how many rounds at most.
const CLOSE: f64 = 1e-3;
const ROUNDS: usize = 12;

/// A contact as a spring.
#[derive(Clone, Copy, Debug)]
struct Contact {
    first: usize,
    /// `None`: a wall.
    second: Option<usize>,
    normal: Vec3,
    /// Stiffness and damping along the normal, across it, against rolling and twisting.
    resistance: [[f64; 4]; 2],
    arms: [f64; 2],
}

impl Contact {
    /// What a step of this length makes of springs and dashpots together: Δt² k + 2 Δt c, since dashpots see velocities half a step
    /// before.
    fn over(&self, dt: f64) -> [f64; 4] {
        let [stiffness, damping] = &self.resistance;
        std::array::from_fn(|k| dt * (dt * stiffness[k] + 2.0 * damping[k]))
    }
}

/// What touches, as springs between bodies.
pub struct Pressed {
    contacts: Vec<Contact>,
    /// 1/√m and 1/√I, zero of what does not move or turn.
    roots: Vec<[f64; 2]>,
}

impl Pressed {
    /// The present contacts. Walls are those that have told of themselves at this step; `moves` tells whether a particle goes and turns as
    /// forces want.
    ///
    /// # Errors
    /// What is missing in the scene.
    pub fn of(w: &World, probes: &mut [Box<dyn Probe>], moves: impl Fn(usize) -> [bool; 2]) -> Result<Self> {
        let mut contacts = vec![];
        for probe in probes {
            let springs = probe.springs(w)?.into_iter();
            contacts.extend(springs.map(|s| Contact {
                first: s.ends[0] as usize,
                second: Some(s.ends[1] as usize),
                normal: s.normal,
                resistance: [s.stiffness, s.damping],
                arms: s.arms,
            }));
        }
        let now = w.clock.step;
        add_walls(
            w,
            |step| step == now,
            |i, s| {
                let (normal, resistance, arms) = (s.normal, [s.stiffness, s.damping], [s.arm, 0.0]);
                contacts.push(Contact { first: i, second: None, normal, resistance, arms });
            },
        );
        let (masses, ftm2v, radius) =
            (w.contact_masses(), w.settings.units.constants().ftm2v, &w.particles.radius);
        let root = |free: bool, inertia: f64| if free { (ftm2v / inertia).sqrt() } else { 0.0 };
        let mut roots = vec![[0.0; 2]; w.n()];
        for i in contacts.iter().flat_map(|c| [Some(c.first), c.second]).flatten() {
            let ([goes, turns], mass) = (moves(i), true_mass(w, &masses, i));
            // Particles of solids do not turn.
            let turns = turns && solid(w, i).is_none();
            roots[i] = [root(goes, mass), root(turns, 0.4 * mass * radius[i] * radius[i])];
        }
        Ok(Self { contacts, roots })
    }

    /// The longest stable step, if `dt` is longer: 2/ω with the largest ω of all motions, less where dashpots resist them.
    pub fn exceeded_by(&self, dt: f64) -> Option<f64> {
        if self.bound(dt) <= 4.0 {
            return None;
        }
        let most = |dt: f64| largest_eigenvalue(self.roots.len(), 1e-12, |q| self.product(q, dt));
        let (mut limit, mut now) = (dt, most(dt).filter(|now| *now > 4.0)?);
        // Exact at once without dashpots; with them half of the error at least goes in each round.
        for _ in 0..ROUNDS {
            let before = limit;
            limit *= 2.0 / now.sqrt();
            if !self.contacts.iter().any(|c| c.resistance[1].iter().any(|c| *c > 0.0)) {
                break;
            }
            now = most(limit).filter(|now| *now > 0.0)?;
            if (limit / before - 1.0).abs() < CLOSE {
                break;
            }
        }
        Some(limit)
    }

    /// No motion has a larger Δt² ω² + 4 ζ ω Δt: a contact's energy is a square of the sum of what its two ends do, so that
    /// K ≤ 2 diag(K_ii), where walls do nothing.
    fn bound(&self, dt: f64) -> f64 {
        let mut sums = vec![0.0; self.roots.len()];
        for c in &self.contacts {
            let ends = if c.second.is_some() { 2.0 } else { 1.0 };
            let [along, across, rolling, twisting] = c.over(dt);
            for (i, arm) in [(Some(c.first), c.arms[0]), (c.second, c.arms[1])] {
                let Some(i) = i else { continue };
                let [straight, turning] = self.roots[i].map(|r| r * r);
                let sliding = across * (straight + arm * arm * turning);
                sums[i] += ends * ((along * straight).max(sliding) + rolling.max(twisting) * turning);
            }
        }
        sums.into_iter().fold(0.0, f64::max)
    }

    /// M^−½ (Δt² K + 2 Δt C) M^−½ q.
    fn product(&self, q: &[Six], dt: f64) -> Vec<Six> {
        let mut out = vec![[0.0; 6]; q.len()];
        let halves = |q: &Six| ([q[0], q[1], q[2]], [q[3], q[4], q[5]]);
        // How an end moves, and by how much it turns.
        let motion = |i: usize| {
            let ((u, theta), [straight, turning]) = (halves(&q[i]), self.roots[i]);
            (scale(straight, u), scale(turning, theta))
        };
        for c in &self.contacts {
            let ((ui, ti), (uj, tj)) = (motion(c.first), c.second.map_or_else(Default::default, motion));
            let [stiff, slides, rolling, twisting] = c.over(dt);
            let (n, apart) = (c.normal, sub(ui, uj));
            let along = dot(apart, n);
            // As laws have it: v_t − (R_i ω_i + R_j ω_j) × n.
            let spin = add(scale(c.arms[0], ti), scale(c.arms[1], tj));
            let slip = sub(sub(apart, scale(along, n)), cross(spin, n));
            let across = scale(slides, slip);
            let force = add(scale(stiff * along, n), across);
            let lever = cross(n, across);
            // What resists the difference of spins.
            let apart = sub(ti, tj);
            let about = dot(apart, n);
            let couple = add(scale(rolling, sub(apart, scale(about, n))), scale(twisting * about, n));
            let mut give = |i: usize, arm: f64, sign: f64| {
                let [straight, turning] = self.roots[i];
                for d in 0..3 {
                    out[i][d] += sign * straight * force[d];
                    out[i][3 + d] += turning * (sign * couple[d] - arm * lever[d]);
                }
            };
            give(c.first, c.arms[0], 1.0);
            if let Some(j) = c.second {
                give(j, c.arms[1], -1.0);
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two grains of mass 1 and radius ½ (1/I = 10), or one on a wall.
    fn pressed(second: Option<usize>, [along, across]: [f64; 2]) -> Pressed {
        let (normal, arms) = ([0.6, 0.0, 0.8], [0.5, if second.is_some() { 0.5 } else { 0.0 }]);
        let resistance = [[along, across, 0.0, 0.0], [0.0; 4]];
        let contact = Contact { first: 0, second, normal, resistance, arms };
        Pressed { contacts: vec![contact], roots: vec![[1.0, 10f64.sqrt()]; 2] }
    }

    /// ω² of the fastest motion, from the limit.
    fn square(p: &Pressed) -> f64 {
        (2.0 / p.exceeded_by(1e9).unwrap()).powi(2)
    }

    #[test]
    fn frequencies_of_closed_forms() {
        let near = |found: f64, square: f64| assert!((found / square - 1.0).abs() < 1e-9, "{found} {square}");
        // k/m̄ of a free pair, k/m on a wall.
        near(square(&pressed(Some(1), [3.0, 0.0])), 6.0);
        near(square(&pressed(None, [3.0, 0.0])), 3.0);
        // Sliding while turning: k_t (1/m + R²/I) of each end, 7/2 k_t/m for a sphere.
        near(square(&pressed(None, [0.0, 3.0])), 10.5);
        near(square(&pressed(Some(1), [0.0, 3.0])), 21.0);
        // Nobody moves.
        let still = Pressed { roots: vec![[0.0; 2]; 2], ..pressed(Some(1), [3.0, 1.0]) };
        assert_eq!(still.exceeded_by(1e9), None);
        // Exact on both sides: ω = √6.
        let pair = pressed(Some(1), [3.0, 0.0]);
        let limit = 2.0 / 6f64.sqrt();
        assert_eq!(pair.exceeded_by(0.999 * limit), None);
        assert!((pair.exceeded_by(1.001 * limit).unwrap() / limit - 1.0).abs() < 1e-9);
    }

    #[test]
    fn dashpots_and_rolling_shorten_the_step() {
        // Δt² ω² + 4 ζ ω Δt = 4, ω² = 6 and 2 ζ ω = 2 c of a free pair.
        for c in [0.1, 1.0, 10.0] {
            let mut pair = pressed(Some(1), [3.0, 0.0]);
            pair.contacts[0].resistance[1][0] = c;
            let limit = 4.0 / (2.0 * c + (4.0 * c * c + 24.0_f64).sqrt());
            assert_eq!(pair.exceeded_by(0.999 * limit), None);
            let found = pair.exceeded_by(3.0 * limit).unwrap();
            assert!((found / limit - 1.0).abs() < CLOSE, "{c}: {found} {limit}");
        }
        // Rolling and twisting of two free grains: ω² = 2 k/I, 1/I = 10.
        for part in [2, 3] {
            let mut pair = pressed(Some(1), [0.0; 2]);
            pair.contacts[0].resistance[0][part] = 3.0;
            let limit = 2.0 / 60f64.sqrt();
            assert!((pair.exceeded_by(1.0).unwrap() / limit - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn the_bound_is_above_a_chain_between_walls() {
        // n equal springs in a row between two walls: ω² = 4 k/m sin²(n π/(2 (n + 1))).
        let n = 9;
        let one = |first, second: Option<usize>, sign: f64| Contact {
            first,
            second,
            normal: [sign, 0.0, 0.0],
            resistance: [[1.0, 0.0, 0.0, 0.0], [0.0; 4]],
            arms: [0.5; 2],
        };
        let mut contacts: Vec<_> = (1..n).map(|i| one(i - 1, Some(i), -1.0)).collect();
        contacts.extend([one(0, None, 1.0), one(n - 1, None, -1.0)]);
        let chain = Pressed { contacts, roots: vec![[1.0, 0.0]; n] };
        let exact = 4.0 * (n as f64 * std::f64::consts::FRAC_PI_2 / (n as f64 + 1.0)).sin().powi(2);
        assert!((square(&chain) / exact - 1.0).abs() < 1e-9, "{} {exact}", square(&chain));
        assert!(chain.bound(1.0) >= exact, "{}", chain.bound(1.0));
    }
}
