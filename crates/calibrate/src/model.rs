//! What a fit solves again and again, with the slopes of its numbers over stiffnesses of bonds.

use super::Line;
use super::cell::{cell, moduli, solve_cell};
use super::dsm::numbers;
use super::found::NUMBERS;
use super::messages::warn_sticking;
use super::scene::Scene;
use super::setup::{Response, Setup};
use super::softer::warn_softer;
use super::ste::{Estimated, Estimator};
use super::strength::{self, Tested, broken};
use super::touch::Hertz;
use super::words::{Quantity, Solver, Words};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_bonded::stiffness::Modes;
use perigrain_statics::coarse::Coarse;
use perigrain_statics::dsm::MOST;
use perigrain_statics::ends::slope;
use perigrain_statics::energy_shares::change;
use perigrain_statics::pcg::{Preconditioner, solve};
use perigrain_statics::periodic::Cell;
use perigrain_statics::six::{Matrix6, Six};
use perigrain_styles::{ActCx, BondForce};
use perigrain_world::World;

/// A body with its latest solution.
pub struct Model {
    kind: Kind,
    /// That of an estimate.
    order: usize,
    /// By which all stiffnesses are larger than in the latest solution.
    factor: f64,
    iterations: usize,
    tensor: Option<Matrix6>,
    /// Whether all solutions have converged.
    pub done: bool,
}

enum Kind {
    Dsm { setup: Box<Setup>, solved: Option<Box<Response>>, adjoint: Option<Vec<Six>>, strength: f64 },
    Periodic { volume: f64, cell: Option<Cell> },
    Ste { body: Box<Estimator>, found: Option<Box<Estimated>> },
}

/// The part of the tolerance of a fit that its solutions have.
const PART: f64 = 0.2;
/// Relative step of differences of moduli over a tensor, and of estimates over stiffnesses.
const STEP: f64 = 1e-5;

impl Model {
    /// Of a scene by the words of a line.
    ///
    /// # Errors
    /// What the solvers refuse.
    pub fn new(w: &World, line: &Line, scene: &Scene, hertz: Option<&Hertz>, span: Span) -> Result<Self> {
        let (words, group) = (&line.words, line.group);
        let kind = match words.solver {
            Solver::Dsm => {
                let setup = Box::new(Setup::new(w, scene, group, words, hertz, span)?);
                if words.aims(Quantity::Strength) {
                    strength::refuse_walls(words)?;
                    refuse_contacts(&setup, "strength", span)?;
                }
                if words.aims(Quantity::Poisson) {
                    refuse_contacts(&setup, "nu", span)?;
                }
                Kind::Dsm { setup, solved: None, adjoint: None, strength: f64::NAN }
            }
            _ if words.aims(Quantity::Strength) => {
                let text = "`target strength` needs a body between ends";
                let d = Diagnostic::error(Code::CONFLICT, span, text);
                return Err(d.help("take `method dsm`, the default of a fit").into());
            }
            Solver::Periodic => Kind::Periodic { volume: cell(w, scene, span)?, cell: None },
            Solver::Ste => {
                let body = Box::new(Estimator::new(w, scene, group, words, hertz, span)?);
                Kind::Ste { body, found: None }
            }
        };
        Ok(Self { kind, order: words.order, factor: 1.0, iterations: 0, tensor: None, done: true })
    }

    /// Whether all numbers but ν are proportional to the stiffness of bonds.
    pub fn linear(&self) -> bool {
        match &self.kind {
            Kind::Dsm { setup, .. } => setup.linear(),
            Kind::Periodic { .. } => true,
            Kind::Ste { body, .. } => body.linear(),
        }
    }

    /// Warns of contacts with high loads that cannot slip, and of an estimate where none holds.
    pub fn warn(&self, cx: &ActCx, line: &Line, scene: &Scene, hertz: Option<&Hertz>) {
        match &self.kind {
            Kind::Dsm { setup, solved: Some(r), .. } => warn_sticking(cx, &line.words, setup, r),
            Kind::Ste { found: Some(e), .. } => warn_softer(cx, line, scene, hertz, e),
            _ => {}
        }
    }

    /// Solves at the present stiffnesses of the bonds, from the latest field. The former strength is dropped.
    ///
    /// # Errors
    /// What the solvers refuse.
    pub fn solve(&mut self, scene: &Scene, words: &Words, span: Span) -> Result<()> {
        let tol = tolerance(words);
        match &mut self.kind {
            Kind::Dsm { setup, solved, adjoint, strength } => {
                let from = solved.take().map(|s| s.field);
                let found = setup.solve(scene, words, tol, from);
                self.iterations += found.iterations;
                self.done &= found.done;
                (*solved, *adjoint, *strength) = (Some(Box::new(found)), None, f64::NAN);
            }
            Kind::Periodic { volume, cell } => {
                let (found, _) = solve_cell(scene, words, tol, cell.take());
                self.iterations += found.iterations.iter().sum::<usize>();
                self.done &= found.done;
                self.tensor = Some(found.tensor(&scene.network, *volume));
                *cell = Some(found);
            }
            Kind::Ste { body, found } => {
                let e = body.estimate(scene, words, span)?;
                self.tensor = Some(e.tensor);
                *found = Some(Box::new(e));
            }
        }
        if let Some(c) = &self.tensor {
            moduli(c, span)?;
        }
        Ok(())
    }

    /// Breaks the body as it was solved, with the present strengths of the bonds; how many have broken.
    ///
    /// # Errors
    /// What the solvers refuse.
    pub fn crumble(
        &mut self,
        scene: &Scene,
        words: &Words,
        style: &dyn BondForce,
        span: Span,
    ) -> Result<usize> {
        let Kind::Dsm { setup, solved: Some(found), strength, .. } = &mut self.kind else { return Ok(0) };
        let path = broken(setup, scene, words, style, found.field.clone(), span)?;
        self.iterations += path.iterations;
        self.done &= path.done;
        *strength = Tested::new(setup, &path).stress();
        Ok(path.breaks.iter().map(|b| b.bonds.len()).sum())
    }

    /// Makes the strengths of all bonds larger by a factor: they break one after another as before.
    pub fn strengthen(&mut self, factor: f64) {
        if let Kind::Dsm { strength, .. } = &mut self.kind {
            *strength *= factor;
        }
    }

    /// Makes all stiffnesses larger by a factor: the field stays, and ν with it.
    pub fn scale(&mut self, factor: f64) {
        self.factor *= factor;
        self.tensor = self.tensor.map(|c| c.map(|row| row.map(|a| a * factor)));
    }

    /// A number of the latest solution; not a number where the body has not been broken yet.
    pub fn value(&self, quantity: Quantity) -> f64 {
        let [k, young, poisson, ..] = self.numbers();
        match quantity {
            Quantity::Stiffness => k,
            Quantity::Young => young,
            Quantity::Poisson => poisson,
            Quantity::Strength => match &self.kind {
                Kind::Dsm { strength, .. } => *strength,
                _ => f64::NAN,
            },
        }
    }

    /// The tensor, where there is one.
    pub fn tensor(&self) -> Option<&Matrix6> {
        self.tensor.as_ref()
    }

    /// What `calibrate` leaves behind.
    pub fn numbers(&self) -> [f64; NUMBERS] {
        let (nan, iterations, f) = (f64::NAN, self.iterations as f64, self.factor);
        // Stiffness, modulus and force follow a factor.
        let scaled = |mut all: [f64; NUMBERS]| {
            [0, 1, 3, 4, 5].into_iter().for_each(|k| all[k] *= f);
            all
        };
        match &self.kind {
            Kind::Dsm { setup, solved: Some(r), .. } => {
                let mut all = scaled(numbers(setup, r));
                all[7] = iterations;
                all
            }
            Kind::Periodic { volume, .. } => {
                let [bulk, young, poisson, shear] = self.tensor.as_ref().map_or([nan; 4], of_cell);
                [bulk, young, poisson, nan, nan, shear, *volume, iterations, 0.0, 0.0]
            }
            Kind::Ste { found: Some(e), .. } => scaled(e.numbers(self.order)),
            _ => [nan; NUMBERS],
        }
    }

    /// ∂ln K/∂ln p, ∂ln E/∂ln p or ∂ν/∂ln p, where `changes` holds ∂ln k/∂ln p of each bond.
    ///
    /// # Errors
    /// What the solvers refuse.
    pub fn slope(
        &mut self,
        scene: &mut Scene,
        words: &Words,
        quantity: Quantity,
        changes: &[Modes],
        span: Span,
    ) -> Result<f64> {
        let network = &scene.network;
        match &mut self.kind {
            Kind::Dsm { setup, solved: Some(s), adjoint, .. } => {
                let u = &s.field;
                if quantity != Quantity::Poisson && setup.large {
                    let twice = network.energy_of_large(u, |k, mode| 2.0 * changes[k][mode]);
                    return Ok(twice.iter().sum::<f64>() / (s.stiffness * setup.delta.powi(2)));
                }
                if quantity != Quantity::Poisson {
                    let moved = |k: usize| [network.moved(k, u, None); 2];
                    // 2U where there are bonds alone; with contacts the work of the force at the ends.
                    let work = s.stiffness * setup.delta.powi(2);
                    return Ok(change(network, moved, |k| changes[k]) / work);
                }
                let lambda = &*adjoint.get_or_insert_with(|| poisson_adjoint(scene, setup, words));
                let moved = |k: usize| [network.moved(k, lambda, None), network.moved(k, u, None)];
                Ok(-change(network, moved, |k| changes[k]))
            }
            Kind::Periodic { volume, cell: Some(cell) } => {
                let mut slope = [[0.0; 6]; 6];
                for (a, b) in (0..6).flat_map(|a| (a..6).map(move |b| (a, b))) {
                    let moved = |k: usize| cell.moved(network, k, [a, b]);
                    slope[a][b] = change(network, moved, |k| changes[k]) / *volume;
                    slope[b][a] = slope[a][b];
                }
                let c = self.tensor.unwrap_or_default();
                let at = |h: f64| {
                    let row = |a: usize| std::array::from_fn(|b| c[a][b] + h * slope[a][b]);
                    pick(quantity, &of_cell(&std::array::from_fn(row)))
                };
                Ok((at(STEP) - at(-STEP)) / (2.0 * STEP))
            }
            Kind::Ste { body, .. } => {
                let before = scene.network.k.clone();
                let mut at = |h: f64| {
                    for ((k, before), change) in scene.network.k.iter_mut().zip(&before).zip(changes) {
                        k.normal = before.normal * (h * change[0]).exp();
                        k.shear = before.shear * (h * change[1]).exp();
                    }
                    let e = body.estimate(scene, words, span);
                    scene.network.k.clone_from(&before);
                    e.map(|e| pick(quantity, &e.numbers(words.order)))
                };
                Ok((at(STEP)? - at(-STEP)?) / (2.0 * STEP))
            }
            // Nothing has been solved.
            _ => Ok(f64::NAN),
        }
    }
}

/// What contacts do is not proportional to the load, nor are displacements of any size.
fn refuse_contacts(setup: &Setup, target: &str, span: Span) -> Result<()> {
    if setup.linear() {
        return Ok(());
    }
    if setup.large {
        let text = format!("`target {target}` is for small displacements of bonds alone");
        let d = Diagnostic::error(Code::NOT_SUPPORTED, span, text);
        return Err(d.help("leave `large` and `mu` out, or give K or E as the target").into());
    }
    let text = format!("`target {target}` is for bonds alone, and contacts act here");
    let d = Diagnostic::error(Code::NOT_SUPPORTED, span, text);
    Err(d.help("use `contacts no`, or give K or E as the target").into())
}

/// To which part of the energy a solution is to be known: an error of the field is the root of that of the energy, and Poisson's ratio is of
/// the field.
fn tolerance(words: &Words) -> f64 {
    let field = words.aims(Quantity::Poisson) || words.aims(Quantity::Strength);
    (PART * if field { words.tol.powi(2) } else { words.tol }).max(1e-14)
}

/// K, E, ν and G of a cell.
fn of_cell(c: &Matrix6) -> [f64; 4] {
    perigrain_statics::tensor::Moduli::new(c)
        .map_or([f64::NAN; 4], |m| [m.bulk, m.mean_young(), m.mean_poisson(), m.shear])
}

/// ln K, ln E or ν.
fn pick(quantity: Quantity, values: &[f64]) -> f64 {
    match quantity {
        Quantity::Stiffness => values[0].ln(),
        Quantity::Young => values[1].ln(),
        Quantity::Poisson => values[2],
        Quantity::Strength => f64::NAN,
    }
}

/// ν = c·u and K u = 0 where u is free: ∂ν/∂p = −λᵀ ∂K/∂p u with K λ = c.
fn poisson_adjoint(scene: &Scene, setup: &Setup, words: &Words) -> Vec<Six> {
    let sample = scene.sample(words.axis);
    let weights = slope(&sample, &setup.held.out);
    let sides: Vec<usize> = (0..2).filter(|side| scene.period[sample.across()[*side]] == 0.0).collect();
    let load: Vec<Six> = weights
        .iter()
        .map(|w| {
            let mut row = [0.0; 6];
            sides.iter().for_each(|s| row[sample.across()[*s]] = -w[*s] / words.strain / sides.len() as f64);
            row
        })
        .collect();
    let mut lambda = vec![[0.0; 6]; load.len()];
    let product = |u: &[Six], out: &mut [Six]| scene.network.product(u, out);
    let tol = tolerance(words);
    let blocks = setup.blocks(scene);
    let make = || Coarse::of_network(&scene.network, &blocks);
    solve(product, &mut Preconditioner::deep(&blocks, &make), Some(&load), &mut lambda, 0.0, MOST, |now| {
        now.fallen.is_some_and(|fallen| fallen <= tol * now.energy.abs())
    });
    lambda
}
