//! Bonds, contacts and walls together: Newton's method with conjugate gradients inside.
//!
//! K u + h(u) = 0 on what is free. The tangent is exact but for what couples the force across a contact to its overlap; where contacts have
//! a past, that of forces already borne is left out as well. (With all of it, which is not symmetric, and generalised minimal residuals in
//! the place of conjugate gradients, a slipping agglomerate took as many steps and more time.)

use super::coarse::{Coarse, Parts};
use super::contacts::{Contacts, Past, Touching};
use super::dsm::MOST;
use super::network::Network;
use super::pcg::{Preconditioner, solve};
use super::precond::Blocks;
use super::six::Six;
use super::walls::Walls;
use perigrain_base::par;

/// A body with what touches it.
#[derive(Clone, Copy)]
pub struct Body<'a> {
    /// Its bonds.
    pub network: &'a Network,
    /// Contacts between its particles.
    pub contacts: &'a Contacts,
    /// Contacts with planes at its ends.
    pub walls: &'a Walls,
    /// What contacts have gone through: directions follow the field, and surfaces slip. `None`: displacements are small.
    pub past: Option<&'a Past>,
    /// What is held, a bit for each component.
    pub held: &'a [u8],
    /// By what torques are divided where they are compared with forces [length].
    pub arm: f64,
}

/// When the method ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// The force between the ends is known to this part of it.
    Part(f64),
    /// |r|₂ of a linear system and of the nonlinear one are below these [force].
    Residuals([f64; 2]),
}

/// A solution.
#[derive(Clone, Debug)]
pub struct Found {
    /// Displacements and rotations.
    pub field: Vec<Six>,
    /// K u + h(u): what holds the held components.
    pub forces: Vec<Six>,
    /// |r|₂ of what is free, before the first step and after each [force].
    pub residuals: Vec<f64>,
    /// Steps of conjugate gradients.
    pub iterations: usize,
    /// Components that nothing resists, at the last field.
    pub loose: usize,
    /// Whether it ended well.
    pub done: bool,
}

/// More steps than this are none of Newton's method.
const STEPS: usize = 100;
/// How much of the residual a linear solution may leave, at most.
const FORCING: f64 = 0.1;
/// How often a step is halved.
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

    /// |r|₂ over what is free.
    fn norm(&self, r: &[Six]) -> f64 {
        let square = |k: usize| {
            let free = |c: usize| if self.held[k] >> c & 1 == 0 { r[k][c] } else { 0.0 };
            (0..3).map(|c| free(c).powi(2) + (free(c + 3) / self.arm).powi(2)).sum::<f64>()
        };
        par::sum(r.len(), square).sqrt()
    }

    /// The forces of a field that keep `delta` between the ends do this much work on it: what a residual is compared with.
    fn work(&self, u: &[Six]) -> f64 {
        let bonds = match self.past {
            None => self.network.energy(u),
            Some(_) => self.network.energy_of_large(u, |_, _| 1.0),
        };
        2.0 * (bonds.iter().sum::<f64>()
            + self.contacts.energy(u, self.past).abs()
            + self.walls.energy(u).abs())
    }

    /// The body as it stands, in balance.
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

    /// Balances what is free, from a field.
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
                // Rounding: no step makes it less.
                out.done = decrement <= 1e-18 * work;
                break;
            }
            let now = out.residuals.last().copied().unwrap_or(0.0);
            // Without all of the tangent a step leaves a twentieth and more of the residual, however well its system is solved.
            if self.past.is_none() {
                forcing = FORCING.min((now / before).powi(2)).max(1e-12);
            }
            // What a step takes away squares with the error of the field, and so does what is left after it.
            if let End::Part(tol) = end
                && decrement <= (0.1 * tol * tol).max(1e-24) * work
            {
                out.done = true;
                break;
            }
        }
        out
    }

    /// The step of a linear system, and −r·step; `coarse` are levels made at an earlier field, and are left for the next one.
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
        let make = || Coarse::new(&Parts { ties: &[network, &touching], grounds: &grounds }, &blocks);
        let mut by = match limit {
            // What the paper does.
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

    /// Takes the step, halved until the residual falls; whether it did.
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
