//! The law compared with LAMMPS, closed forms and conservation laws, using a plain velocity-Verlet integrator
//! for two spheres.

mod closed_forms;
mod liggghts;
pub(crate) mod new_law;
mod oblique;
mod plastic;

use super::*;
use perigrain_base::math::vec3::{add, cross, length, scale};
use perigrain_world::Compat;

/// A sphere; or, with infinite mass and radius 0, a wall.
#[derive(Clone, Copy, Debug)]
struct Ball {
    x: Vec3,
    motion: Motion,
    radius: f64,
    mass: f64,
    force: Vec3,
    torque: Vec3,
}

impl Ball {
    fn new(x: Vec3, velocity: Vec3, spin: Vec3, radius: f64, density: f64) -> Self {
        let mass = density * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
        Self { x, motion: Motion { velocity, spin }, radius, mass, force: [0.0; 3], torque: [0.0; 3] }
    }

    fn inertia(&self) -> f64 {
        0.4 * self.mass * self.radius * self.radius
    }

    fn kick(&mut self, dt: f64) {
        self.motion.velocity = add(self.motion.velocity, scale(0.5 * dt / self.mass, self.force));
        if self.radius > 0.0 {
            self.motion.spin = add(self.motion.spin, scale(0.5 * dt / self.inertia(), self.torque));
        }
    }
}

/// Two balls and one law, with LAMMPS' step: forces between the half kicks, from half-step velocities.
struct Duel {
    balls: [Ball; 2],
    law: Granular,
    history: Vec<f64>,
    curvature: Option<f64>,
    dt: f64,
    touching: bool,
}

impl Duel {
    fn new(balls: [Ball; 2], law: Granular, dt: f64) -> Self {
        Self { balls, law, history: vec![0.0; law.memory()], curvature: None, dt, touching: false }
    }

    fn forces(&mut self, history: bool) {
        let [a, b] = self.balls;
        let mut w = Wrench::default();
        let gap = if self.touching { self.law.gap(a.radius * b.radius / (a.radius + b.radius)) } else { 0.0 };
        let g = Geometry::of_spheres(sub(a.x, b.x), [a.radius, b.radius], [a.mass, b.mass], gap);
        self.touching = g.is_some();
        match g {
            Some(g) => {
                let g = self.curvature.map_or(g, |r| g.with_curvature(r));
                let step = Advance { dt: self.dt, history };
                w = self.law.contact(&g, &a.motion, &b.motion, &mut self.history, step);
            }
            None => self.history.fill(0.0),
        }
        self.balls[0].force = w.force;
        self.balls[1].force = scale(-1.0, w.force);
        self.balls[0].torque = w.torque_i;
        self.balls[1].torque = w.torque_j;
    }

    fn step(&mut self) {
        assert!(self.overlap().is_finite());
        for b in &mut self.balls {
            b.kick(self.dt);
            b.x = add(b.x, scale(self.dt, b.motion.velocity));
        }
        self.forces(true);
        for b in &mut self.balls {
            b.kick(self.dt);
        }
    }

    fn momentum(&self) -> Vec3 {
        let p = |b: &Ball| scale(b.mass, b.motion.velocity);
        add(p(&self.balls[0]), p(&self.balls[1]))
    }

    fn angular_momentum(&self) -> Vec3 {
        let l =
            |b: &Ball| add(scale(b.inertia(), b.motion.spin), cross(b.x, scale(b.mass, b.motion.velocity)));
        add(l(&self.balls[0]), l(&self.balls[1]))
    }

    fn overlap(&self) -> f64 {
        let [a, b] = &self.balls;
        a.radius + b.radius - length(sub(a.x, b.x))
    }
}

fn material(young: f64, eta: f64, poisson: f64) -> Normal {
    Normal::new(&normal::HERTZ_MATERIAL, &[young, eta, poisson])
}

fn mindlin(x_gamma: f64, mu: f64) -> Tangential {
    Tangential::new(Friction::Mindlin, None, x_gamma, mu)
}

fn model(normal: Normal, damping: Damping, tangential: Tangential) -> Model {
    Model::new(normal, damping, tangential)
}
