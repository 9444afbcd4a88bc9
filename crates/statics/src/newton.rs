//! Bonds, contacts and walls together: Newton's method with conjugate gradients inside.
//!
//! K u + h(u) = 0 for the free components. The tangent is exact except for the coupling of tangential contact
//! forces to the overlap; with a history, the change of existing forces is omitted as well. (With the full
//! tangent, which is not symmetric, and GMRES instead of conjugate gradients, a slipping agglomerate took as
//! many steps and more time.)

use super::coarse::{Coarse, Parts, Sizes};
use super::contacts::{Contacts, Past, Touching};
use super::dsm::MOST;
use super::network::Network;
use super::pcg::{Preconditioner, solve};
use super::precond::Blocks;
use super::six::Six;
use super::walls::Walls;
use perigrain_base::par;

/// A body with its contacts.
#[derive(Clone, Copy)]
pub struct Body<'a> {
    /// Its bonds.
    pub network: &'a Network,
    /// Contacts between its particles.
    pub contacts: &'a Contacts,
    /// Contacts with planes at its ends.
    pub walls: &'a Walls,
    /// Contact history: directions follow the field, and surfaces slip. `None`: displacements are small.
    pub past: Option<&'a Past>,
    /// Held components, one bit each.
    pub held: &'a [u8],
    /// Length by which torques are divided when they are compared with forces [length].
    pub arm: f64,
}

/// Termination criterion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// Relative accuracy of the force between the ends.
    Part(f64),
    /// |r|₂ of the linear system and of the nonlinear one [force].
    Residuals([f64; 2]),
}

/// A solution.
#[derive(Clone, Debug)]
pub struct Found {
    /// Displacements and rotations.
    pub field: Vec<Six>,
    /// K u + h(u): the reactions at the held components.
    pub forces: Vec<Six>,
    /// |r|₂ of the free components, before the first step and after each [force].
    pub residuals: Vec<f64>,
    /// Steps of conjugate gradients.
    pub iterations: usize,
    /// Number of components without resistance, at the last field.
    pub loose: usize,
    /// Whether it has converged.
    pub done: bool,
}

/// Largest number of Newton steps.
const STEPS: usize = 100;
/// Largest fraction of the residual that a linear solution may leave.
const FORCING: f64 = 0.1;
/// Largest number of halvings of a step.
const HALVES: usize = 30;

impl Body<'_> {
    fn forces(&self, u: &[Six], out: &mut [Six]) {
        match self.past {
            None => self.network.product(u, out),
            Some(_) => self.network.forces(u, out),
        }
        self.contacts.add_forces(u, self.past, out);
        self.walls.add_forces(u, out);
    }

    /// |r|₂ of the free components.
    fn norm(&self, r: &[Six]) -> f64 {
        let square = |k: usize| {
            let free = |c: usize| if self.held[k] >> c & 1 == 0 { r[k][c] } else { 0.0 };
            (0..3).map(|c| free(c).powi(2) + (free(c + 3) / self.arm).powi(2)).sum::<f64>()
        };
        par::sum(r.len(), square).sqrt()
    }

    /// Work of the forces that keep `delta` between the ends: the scale of the residual.
    fn work(&self, u: &[Six]) -> f64 {
        let bonds = match self.past {
            None => self.network.energy(u),
            Some(_) => self.network.energy_of_large(u, |_, _| 1.0),
        };
        2.0 * (bonds.iter().sum::<f64>()
            + self.contacts.energy(u, self.past).abs()
            + self.walls.energy(u).abs())
    }

    /// The body in its initial state, in equilibrium.
    pub fn still(&self) -> Found {
        Found { done: true, ..self.begin(vec![[0.0; 6]; self.network.particles]) }
    }

    fn begin(&self, start: Vec<Six>) -> Found {
        let mut forces = vec![[0.0; 6]; start.len()];
        self.forces(&start, &mut forces);
        Found {
            residuals: vec![self.norm(&forces)],
            field: start,
            forces,
            iterations: 0,
            loose: 0,
            done: false,
        }
    }

    /// Balances the free components, starting from a field.
    pub fn relax(&self, start: Vec<Six>, end: End) -> Found {
        let mut out = self.begin(start);
        let (mut forcing, mut coarse) = (FORCING, None);
        while out.residuals.len() <= STEPS && !perigrain_base::stop::cuts() {
            let before = out.residuals.last().copied().unwrap_or(0.0);
            if let End::Residuals([_, least]) = end
                && before < least
            {
                out.done = true;
                break;
            }
            let (step, decrement) = self.step(
                &mut out,
                &mut coarse,
                if let End::Residuals([linear, _]) = end { Err(linear) } else { Ok(forcing) },
            );
            let work = self.work(&out.field);
            if !self.search(&mut out, &step, before) {
                // Rounding level: no step reduces it.
                out.done = decrement <= 1e-18 * work;
                break;
            }
            let now = out.residuals.last().copied().unwrap_or(0.0);
            // With an approximate tangent a step leaves at least a twentieth of the residual, however
            // accurate its solution.
            if self.past.is_none() {
                forcing = FORCING.min((now / before).powi(2)).max(1e-12);
            }
            // The decrement is quadratic in the error of the field, and so is the error after the step.
            if let End::Part(tol) = end
                && decrement <= (0.1 * tol * tol).max(1e-24) * work
            {
                out.done = true;
                break;
            }
        }
        out
    }

    /// The step of a linear system, and −r·step; `coarse` holds levels made at an earlier field, and is kept
    /// for the next one.
    fn step(&self, out: &mut Found, coarse: &mut Option<Coarse>, limit: Result<f64, f64>) -> (Vec<Six>, f64) {
        let springs = self.contacts.tangent(&out.field, self.past);
        let walls = self.walls.tangent(&out.field);
        let moved = self.past.map(|_| self.network.moved_by(&out.field));
        let network = moved.as_ref().unwrap_or(self.network);
        let mut blocks = network.blocks();
        self.contacts.add_blocks(&springs, &mut blocks);
        for (particle, k) in &walls {
            blocks[*particle as usize][super::six::at(self.walls.axis, self.walls.axis)] += k;
        }
        let blocks = Blocks::new(&blocks, self.held);
        out.loose = blocks.loose;
        let load: Vec<Six> = out.forces.iter().map(|f| f.map(|a| -a)).collect();
        let product = |p: &[Six], q: &mut [Six]| {
            network.product(p, q);
            self.contacts.add_product(&springs, p, q);
            for (particle, k) in &walls {
                let particle = *particle as usize;
                q[particle][self.walls.axis] += k * p[particle][self.walls.axis];
            }
        };
        let grounds: Vec<_> = walls.iter().map(|(particle, k)| (*particle, self.walls.axis, *k)).collect();
        let touching = Touching { contacts: self.contacts, springs: &springs };
        let make =
            || Coarse::new(&Parts { ties: &[network, &touching], grounds: &grounds }, &blocks, Sizes::NEXT);
        let mut by = match limit {
            // As in the paper.
            Err(_) => Preconditioner::plain(&blocks),
            Ok(_) => Preconditioner::again(&blocks, &make, coarse.take()),
        };
        let mut step = vec![[0.0; 6]; load.len()];
        let mut first = None;
        let solved = solve(product, &mut by, Some(&load), &mut step, 0.0, MOST, |now| {
            let first = *first.get_or_insert(now.residual);
            now.residual <= limit.map_or_else(|least| least, |part| part * first)
        });
        out.iterations += solved.iterations;
        *coarse = by.kept(&solved);
        let decrement = par::sum(step.len(), |k| (0..6).map(|c| load[k][c] * step[k][c]).sum());
        (step, decrement)
    }

    /// Takes the step, halved until the residual decreases; returns whether it did.
    fn search(&self, out: &mut Found, step: &[Six], before: f64) -> bool {
        let mut part = 1.0;
        for _ in 0..HALVES {
            let field: Vec<Six> = (out.field.iter().zip(step))
                .map(|(u, s)| std::array::from_fn(|c| u[c] + part * s[c]))
                .collect();
            let mut forces = vec![[0.0; 6]; field.len()];
            self.forces(&field, &mut forces);
            let now = self.norm(&forces);
            if now < before {
                (out.field, out.forces) = (field, forces);
                out.residuals.push(now);
                return true;
            }
            part *= 0.5;
        }
        false
    }
}
