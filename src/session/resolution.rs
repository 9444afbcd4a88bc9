//! Whether numbers can resolve the motion of one step: not in a box that lies too far from the origin.

use super::{Session, refuse};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::vec3::length;

/// Lengths of the box between it and the origin from which on a warning is given: of 16 digits, ten are left.
const FAR: f64 = 1e6;

impl Session {
    /// Warns of a box far from the origin.
    ///
    /// # Errors
    /// Particles have speeds, and none is fast enough to come to another number in a step.
    pub(super) fn check_resolution(&mut self, span: Span) -> Result<()> {
        let Some(domain) = &*self.world.domain else { return Ok(()) };
        let away = |d: usize| domain.lo[d].abs().max(domain.hi[d].abs());
        let d = (0..3).max_by(|&a, &b| away(a).total_cmp(&away(b))).unwrap_or(0);
        let far = away(d);
        // An infinite box has no place.
        if far <= FAR * domain.lengths().into_iter().fold(0.0, f64::max) || !far.is_finite() {
            return Ok(());
        }
        let (resolution, p) = (far.next_up() - far, &self.world.particles);
        let step = p.v.iter().map(|v| length(*v)).fold(0.0, f64::max) * self.world.clock.dt;
        let axis = ["x", "y", "z"][d];
        let text = format!(
            "the box lies at {axis} = {far:.3e}, where places are {resolution:.1e} apart; the fastest particle moves \
             by {step:.1e} in a step"
        );
        let help = "move the scene to the origin";
        let moves = |v: &[f64; 3], x: &[f64; 3]| (0..3).any(|d| x[d] + v[d] * self.world.clock.dt != x[d]);
        let stuck = step > 0.0 && !p.v.iter().zip(p.x.iter()).any(|(v, x)| moves(v, x));
        if stuck && !self.world.settings.lammps() {
            return refuse(Code::CONFLICT, span, format!("{text}: nothing would move"));
        }
        self.note_once(Diagnostic::warning(Code::SUSPICIOUS, span, text).help(help));
        Ok(())
    }
}
