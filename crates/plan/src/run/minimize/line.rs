//! Line searches: how far to go along a direction. Constants and criteria are LAMMPS', so that paths agree.

use super::{Search, Stop, largest, product};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::par;
use perigrain_world::World;
use perigrain_world::minimizer::LineSearch;

/// The longest step, in units of the direction.
const LONGEST: f64 = 1.0;
/// Factor from one trial to the next shorter one.
const SHORTER: f64 = 0.5;
/// The required share of the expected fall of energy.
const ENOUGH: f64 = 0.4;
/// How far from quadratic the energy may be for the secant step.
const QUADRATIC: f64 = 0.1;
/// Energies closer than this are equal, in LAMMPS: a number with a unit, which stops every search of a small scene in SI units.
const SAME_IN_LAMMPS: f64 = 1e-8;
/// Forces along the line below this are none, in LAMMPS as they stand, else beside the force at its start.
const NOTHING: f64 = 1e-28;
/// Falls of energy below this part of the first one looked for are rounding: some forty halvings.
const ROUNDING: f64 = 1e-14;

/// A direction and where it starts.
pub struct Line {
    /// The direction.
    direction: Vec<[f64; 3]>,
    /// Positions and periodic images at its start.
    start: Vec<[f64; 3]>,
    images: Vec<[i32; 3]>,
    /// The rebuild these belong to.
    generation: u64,
}

impl Line {
    /// Along the present forces.
    pub fn new(w: &World) -> Self {
        Self { direction: w.particles.f.to_vec(), start: vec![], images: vec![], generation: 0 }
    }

    /// Turns to `force + beta · direction`, or to `force` where that leads uphill.
    pub fn turn(&mut self, force: &[[f64; 3]], beta: f64) {
        for (h, f) in self.direction.iter_mut().zip(force) {
            *h = [0, 1, 2].map(|d| f[d] + beta * h[d]);
        }
        if product(force, &self.direction) <= 0.0 {
            self.direction.copy_from_slice(force);
        }
    }

    fn hold(&mut self, w: &World) {
        self.start.clone_from(&w.particles.x);
        self.images = (0..w.n()).map(|i| w.particles.image[i]).collect();
        self.generation = w.rebuild.generation;
    }

    /// Follows particles that were wrapped into the periodic box since `hold`.
    fn follow(&mut self, w: &World) {
        let Some(domain) = w.domain.as_ref().filter(|_| w.rebuild.generation != self.generation) else {
            return;
        };
        self.generation = w.rebuild.generation;
        let edges = domain.edges();
        for (i, (x, held)) in self.start.iter_mut().zip(&mut self.images).enumerate() {
            let now = w.particles.image[i];
            let by = edges.shift([0, 1, 2].map(|d| f64::from(held[d].wrapping_sub(now[d]))));
            (0..3).for_each(|d| x[d] += by[d]);
            *held = now;
        }
    }

    /// Puts the particles `alpha` along the direction.
    fn put(&mut self, w: &mut World, alpha: f64, farthest: f64) -> Result<()> {
        if w.n() != self.start.len() {
            let text = "particles were lost through a fixed face while the energy was minimized";
            return Err(Diagnostic::error(Code::LOST, None, text)
                .help(format!("let the box follow them with `boundary s s s`, or lower `min_modify dmax`, which is {farthest:.3e} here"))
                .into());
        }
        self.follow(w);
        let (start, direction) = (&self.start, &self.direction);
        par::each(&mut w.particles.x[..], |first, x| {
            for (k, x) in x.iter_mut().enumerate() {
                let (from, h) = (start[first + k], direction[first + k]);
                *x = [0, 1, 2].map(|d| from[d] + alpha * h[d]);
            }
        });
        Ok(())
    }
}

/// Goes along the line until the energy has fallen enough; the reason if it cannot.
///
/// # Errors
/// As the ops of the plan, and lost particles.
pub fn search(s: &mut Search, line: &mut Line) -> Result<Option<Stop>> {
    let slope = product(&s.w.particles.f, &line.direction) / s.per;
    if slope <= 0.0 {
        return Ok(Some(Stop::Uphill));
    }
    let steepest = largest(&line.direction);
    if steepest == 0.0 {
        return Ok(Some(Stop::ZeroForce));
    }
    let lammps = s.w.settings.lammps();
    let quadratic = s.w.settings.minimizer.line == LineSearch::Quadratic;
    let longest = LONGEST.min(s.farthest / steepest);
    let from = s.energy;
    let (same, nothing) = match lammps {
        true => (SAME_IN_LAMMPS, NOTHING),
        false => (4.0 * f64::EPSILON * from.abs() + ROUNDING * longest * slope, NOTHING * slope),
    };
    line.hold(s.w);
    // The trial before: step, force along the line, energy.
    let mut before = (0.0, slope, from);
    let mut alpha = longest;
    loop {
        go(s, line, alpha)?;
        if quadratic {
            let along = product(&s.w.particles.f, &line.direction) / s.per;
            let change = along - before.1;
            if along.abs() < nothing || change.abs() < nothing {
                return give_up(s, line, (alpha, from), Stop::ZeroCurvature);
            }
            let expected = 0.5 * (alpha - before.0) * (along + before.1) + s.energy;
            let zero = alpha - (alpha - before.0) * along / change;
            let near = (1.0 - expected / before.2).abs() <= QUADRATIC;
            if near && zero > 0.0 && zero < longest {
                go(s, line, zero)?;
                if s.energy - from < same {
                    // LAMMPS reports the trial, not the zero.
                    s.alpha = alpha;
                    return Ok(None);
                }
            }
            // As in LAMMPS, what follows sees the energy of the latest evaluation, whichever trial that was.
            before = (alpha, along, s.energy);
        }
        let ideal = -ENOUGH * alpha * slope;
        if s.energy - from <= ideal {
            s.alpha = alpha;
            return Ok(None);
        }
        alpha *= SHORTER;
        if alpha <= 0.0 || ideal >= -same {
            return give_up(s, line, (alpha, from), Stop::ZeroStep);
        }
    }
}

fn go(s: &mut Search, line: &mut Line, alpha: f64) -> Result<()> {
    line.put(s.w, alpha, s.farthest)?;
    s.attempt()
}

/// Back to the start of the line, whose forces the last output finds; LAMMPS counts that evaluation, and reports the
/// step it has come down to.
fn give_up(
    s: &mut Search,
    line: &mut Line,
    (shortest, energy): (f64, f64),
    why: Stop,
) -> Result<Option<Stop>> {
    line.put(s.w, 0.0, s.farthest)?;
    s.energy = energy;
    s.evaluations += 1;
    s.alpha = shortest;
    Ok(Some(why))
}
