//! One step of rigid bodies and of the particles that follow them.

use super::bodies::Body;
use super::{COLUMNS, Declared};
use crate::math::body::{apply, apply_transposed, matrix, no_squish, richardson, spin};
use crate::math::vec3::{Vec3, add, cross, dot, scale, sub};
use crate::par;
use crate::plan::Tick;
use crate::styles::matter::{self, Masses, unwrapped};
use crate::world::{SlotId, World};

impl Declared {
    /// First half kick, drift, turn; particles follow.
    pub fn advance(&self, w: &mut World, t: &Tick) {
        let mut bodies = self.load(w);
        let half = 0.5 * t.dt * w.settings.units.constants().ftm2v;
        let flat = w.settings.two_dimensional;
        for (k, b) in bodies.iter_mut().enumerate() {
            self.kick(k, b, half, flat);
            b.x = add(b.x, scale(t.dt, b.v));
            if self.exact() {
                (b.q, b.momentum) = no_squish(b.q, b.momentum, b.moments, t.dt);
                b.omega = spin(b.momentum, b.q, b.moments);
                continue;
            }
            let omega = spin(b.momentum, b.q, b.moments);
            (b.q, b.omega) = richardson(b.q, b.momentum, omega, b.moments, 0.5 * t.dt);
        }
        let virial = self.follow(w, &bodies, half, true, t.virial && self.virial);
        if t.virial && self.virial {
            w.memo.insert(self.key("virial"), virial.to_vec());
        }
        self.store(w, &bodies);
    }

    fn kick(&self, k: usize, b: &mut Body, half: f64, flat: bool) {
        let [force, torque] = self.allowed(k, flat);
        for d in 0..3 {
            b.v[d] += half / b.mass * b.force[d] * force[d];
            b.momentum[d] += half * b.torque[d] * torque[d];
        }
    }

    /// New forces on the bodies and the second half kick; in the setup of a run the forces alone. Particles follow. What decks
    /// can read goes to the slot.
    pub fn finish_step(&self, w: &mut World, t: &Tick, slot: SlotId) {
        let mut bodies = self.load(w);
        let half = 0.5 * t.dt * w.settings.units.constants().ftm2v;
        let flat = w.settings.two_dimensional;
        self.gather_forces(w, &mut bodies);
        for (k, b) in bodies.iter_mut().enumerate() {
            if !t.setup {
                self.kick(k, b, half, flat);
            }
            b.omega = spin(b.momentum, b.q, b.moments);
        }
        let virial = self.follow(w, &bodies, half, false, t.virial && self.virial);
        if t.virial && self.virial {
            let before = w.memo.remove(&self.key("virial")).filter(|_| !t.setup);
            for (k, total) in w.tally.fixes.iter_mut().enumerate() {
                // In setup the other half of the step is taken to be alike.
                *total += virial[k] + before.as_ref().map_or(virial[k], |v| v[k]);
            }
        }
        self.store(w, &bodies);
        self.publish(w, t, slot, &bodies);
    }

    /// Sums of forces and torques, in the order of storage.
    fn gather_forces(&self, w: &World, bodies: &mut [Body]) {
        for b in bodies.iter_mut() {
            (b.force, b.torque) = ([0.0; 3], [0.0; 3]);
        }
        let p = &w.particles;
        let number = w.columns.get_scalar(&self.key("body")).unwrap_or_default();
        for (i, k) in number.iter().enumerate().filter(|(_, k)| **k > 0.0) {
            let Some(b) = bodies.get_mut(*k as usize - 1) else { continue };
            b.force = add(b.force, p.f[i]);
            b.torque = add(b.torque, cross(sub(unwrapped(w, i), b.x), p.f[i]));
            if let Some(own) = p.torque.get(i) {
                b.torque = add(b.torque, *own);
            }
        }
    }

    /// Velocities and spins of the particles from those of their bodies, places too where they `move`; where it is
    /// asked for, half the virial of the forces that hold the bodies together.
    fn follow(&self, w: &mut World, bodies: &[Body], half: f64, moving: bool, tally: bool) -> [f64; 6] {
        let turned: Vec<_> = bodies.iter().map(|b| matrix(b.q)).collect();
        let lengths = w.domain.as_ref().map_or([0.0; 3], |d| d.lengths());
        let mut x = std::mem::take(&mut w.particles.x);
        let mut v = std::mem::take(&mut w.particles.v);
        let mut omega = std::mem::take(&mut w.particles.omega);
        let (p, masses) = (
            &w.particles,
            Masses::new(w.particles.style, &w.particles.mass, &w.particles.kind, &w.type_mass),
        );
        let number = w.columns.get_scalar(&self.key("body")).unwrap_or_default();
        let place = w.columns.get_vector(&self.key("place")).unwrap_or_default();
        let follow = |start: usize, (x, v, number, place): (&mut [Vec3], &mut [Vec3], &[f64], &[Vec3])| {
            let mut total = [0.0; 6];
            for (k, ((x, v), (number, place))) in
                x.iter_mut().zip(v).zip(number.iter().zip(place)).enumerate()
            {
                if *number == 0.0 {
                    continue;
                }
                let (i, b) = (start + k, *number as usize - 1);
                let Some(body) = bodies.get(b) else { continue };
                let away = apply(&turned[b], *place);
                let shift: Vec3 = std::array::from_fn(|d| f64::from(p.image[i][d]) * lengths[d]);
                let old = (add(*x, shift), *v);
                *v = add(cross(body.omega, away), body.v);
                if moving {
                    *x = sub(add(away, body.x), shift);
                }
                if !tally {
                    continue;
                }
                let m = masses.get(i);
                let hold: Vec3 = std::array::from_fn(|d| m * (v[d] - old.1[d]) / half - p.f[i][d]);
                for (s, (a, c)) in total.iter_mut().zip([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]) {
                    *s += 0.5 * old.0[a] * hold[c];
                }
            }
            total
        };
        let n = x.len();
        let columns = (&mut x[..], &mut v[..], &number[..n.min(number.len())], &place[..n.min(place.len())]);
        let virial = par::reduce_each(columns, follow, matter::add).unwrap_or([0.0; 6]);
        for (i, omega) in omega.iter_mut().enumerate().filter(|(i, _)| p.radius[*i] > 0.0) {
            let k = number.get(i).copied().unwrap_or(0.0);
            if let Some(body) = bodies.get((k as usize).wrapping_sub(1)) {
                *omega = body.omega;
            }
        }
        (w.particles.x, w.particles.v, w.particles.omega) = (x, v, omega);
        virial
    }

    /// Velocities and spins of the particles as their bodies have them now, outside of a run.
    pub fn carry(&self, w: &mut World, bodies: &[Body]) {
        self.follow(w, bodies, 1.0, false, false);
    }

    /// The values that decks can read.
    fn publish(&self, w: &mut World, t: &Tick, slot: SlotId, bodies: &[Body]) {
        let flat = w.settings.two_dimensional;
        let units = w.settings.units.constants();
        let lengths = w.domain.as_ref().map_or([0.0; 3], |d| d.lengths());
        let (mut sum, mut freedom) = (0.0, 0.0);
        for b in bodies {
            let inner = apply_transposed(&matrix(b.q), b.omega);
            sum += b.mass * dot(b.v, b.v);
            sum += (0..3).map(|d| b.moments[d] * inner[d] * inner[d]).sum::<f64>();
            let linear = b.moments.contains(&0.0);
            freedom += if flat { 3.0 } else { 6.0 - f64::from(u8::from(linear)) };
        }
        let out = w.slots.get_mut(slot);
        out.step = Some(t.step);
        out.scalar = if freedom > 0.0 { sum * units.mvv2e / (freedom * units.boltz) } else { 0.0 };
        if !self.whole {
            return;
        }
        out.array.clear();
        out.array_cols = COLUMNS;
        for b in bodies {
            let x: Vec3 = std::array::from_fn(|d| b.x[d] - b.image[d] * lengths[d]);
            for part in [x, b.v, b.force, b.torque, b.image] {
                out.array.extend(part);
            }
        }
    }
}
