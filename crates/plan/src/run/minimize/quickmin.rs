//! Quick-min: damped motion that keeps of its velocity only what points along the forces (Sheppard, Terrell & Henkelman,
//! J. Chem. Phys. 128, 134106).

use super::{Search, Stop, drift, kick, product, shortened};
use perigrain_base::diag::Result;

/// Downhill iterations before the energy tolerance counts, as in LAMMPS.
const DELAY: i64 = 5;

/// Moves until a criterion stops the search. Velocities are those of the last iteration then.
///
/// # Errors
/// As the ops of the plan.
pub fn relax(s: &mut Search) -> Result<Stop> {
    let mut uphill = s.w.clock.step;
    loop {
        if let Some(stop) = s.next() {
            return Ok(stop);
        }
        let p = &mut s.w.particles;
        let along = product(&p.v, &p.f);
        if along < 0.0 {
            uphill = s.w.clock.step;
            p.v.fill([0.0; 3]);
        } else {
            let square = product(&p.f, &p.f);
            let scale = if square == 0.0 { 0.0 } else { along / square };
            for (v, f) in p.v.iter_mut().zip(&p.f) {
                *v = f.map(|f| scale * f);
            }
        }
        let step = shortened(s.w, s.w.clock.dt, s.farthest);
        s.previous = s.energy;
        drift(s.w, step);
        kick(s.w, step, None);
        s.evaluate()?;
        if s.goal.etol > 0.0 && s.w.clock.step - uphill > DELAY && s.energy_settled() {
            return Ok(Stop::Energy);
        }
        if s.force_settled() {
            return Ok(Stop::Force);
        }
        s.output()?;
    }
}
