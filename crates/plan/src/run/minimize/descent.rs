//! Conjugate gradients (Polak and Ribière, restarted) and steepest descent: directions and line searches along them.

use super::line::{self, Line};
use super::{Search, Stop, product};
use perigrain_base::diag::Result;
use perigrain_world::minimizer::MinStyle;

/// Searches along one direction after the other until a criterion stops it.
///
/// # Errors
/// As the ops of the plan.
pub fn descend(s: &mut Search) -> Result<Stop> {
    let conjugate = s.w.settings.minimizer.style == MinStyle::Cg;
    // Directions lose their conjugacy after as many steps as there are coordinates.
    let restart = 3 * s.w.n().max(1) as i64;
    let mut line = Line::new(s.w);
    let mut gradient = s.w.particles.f.clone();
    let mut square = product(&gradient, &gradient);
    loop {
        if let Some(stop) = s.next() {
            return Ok(stop);
        }
        s.previous = s.energy;
        if let Some(stop) = line::search(s, &mut line)? {
            return Ok(stop);
        }
        if s.tries {
            // What breaks or flows does so here.
            s.evaluate()?;
        }
        if s.evaluations >= s.goal.evaluations {
            return Ok(Stop::Evaluations);
        }
        if s.energy_settled() {
            return Ok(Stop::Energy);
        }
        if s.force_settled() {
            return Ok(Stop::Force);
        }
        let f = &s.w.particles.f;
        if conjugate {
            let (now, mixed) = (product(f, f), product(f, &gradient));
            let again = (s.w.clock.step - s.first + 1) % restart == 0;
            let beta = if again { 0.0 } else { ((now - mixed) / square).max(0.0) };
            square = now;
            gradient.clone_from(f);
            line.turn(&gradient, beta);
        } else {
            line.turn(f, 0.0);
        }
        s.output()?;
    }
}
