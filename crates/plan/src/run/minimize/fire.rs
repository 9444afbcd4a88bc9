//! FIRE: damped motion that speeds up downhill and stops uphill (Bitzek et al., PRL 97, 170201; Guénolé et al., Comput.
//! Mater. Sci. 175, 109584).

use super::{Search, Stop, drift, kick, product, shortened};
use perigrain_base::diag::Result;
use perigrain_world::World;
use perigrain_world::minimizer::{Fire, FireIntegrator};

/// The least mixing whose bias is corrected.
const LEAST_MIXING: f64 = 1e-10;

/// Squared forces below this have no direction, in LAMMPS: a number with a unit.
const NO_FORCE: f64 = 1e-20;

/// The state of the damping.
struct Damping {
    set: Fire,
    /// The time step now, and its bounds.
    dt: f64,
    longest: f64,
    shortest: f64,
    /// The time step after no particle may go further than `dmax`.
    limited: f64,
    /// How much of the velocity is turned into the force's direction.
    alpha: f64,
    /// The iteration that last went uphill.
    uphill: i64,
    /// Uphill iterations in a row.
    uphills: i64,
    /// Downhill iterations since the last start.
    downhills: i32,
    /// Factors of velocity and force in this iteration; `None` uphill.
    mix: Option<(f64, f64)>,
}

/// Moves until a criterion stops the search. Velocities and time step are those of the last iteration then.
///
/// # Errors
/// As the ops of the plan.
pub fn relax(s: &mut Search) -> Result<Stop> {
    let (set, dt) = (s.w.settings.minimizer.fire, s.w.clock.dt);
    let mut d = Damping {
        set,
        dt,
        longest: set.tmax * dt,
        shortest: set.tmin * dt,
        limited: dt,
        alpha: set.alpha0,
        uphill: s.w.clock.step,
        uphills: 0,
        downhills: 0,
        mix: None,
    };
    iterate(s, &mut d)
}

fn iterate(s: &mut Search, d: &mut Damping) -> Result<Stop> {
    if d.set.integrator == FireIntegrator::Leapfrog {
        s.evaluate()?;
        let half = -0.5 * d.dt;
        kick(s.w, half, None);
    }
    loop {
        if let Some(stop) = s.next() {
            return Ok(stop);
        }
        let downhill = product(&s.w.particles.v, &s.w.particles.f) > 0.0;
        if downhill {
            speed_up(s.w, d);
        } else if !slow_down(s, d)? {
            return Ok(Stop::Stuck);
        }
        limit(s, d);
        if !downhill {
            s.w.particles.v.fill([0.0; 3]);
        }
        s.previous = s.energy;
        step(s, d)?;
        if s.goal.etol > 0.0 && s.w.clock.step - d.uphill > d.set.delay && s.energy_settled() {
            return Ok(Stop::Energy);
        }
        if s.force_settled() {
            return Ok(Stop::Force);
        }
        s.output()?;
    }
}

/// Downhill: the velocity is turned towards the force, and after a while the time step grows.
fn speed_up(w: &mut World, d: &mut Damping) {
    let p = &w.particles;
    let (vv, ff) = (product(&p.v, &p.v), product(&p.f, &p.f));
    let none = if w.settings.lammps() { NO_FORCE } else { 0.0 };
    let along = if ff <= none { 0.0 } else { d.alpha * (vv / ff).sqrt() };
    d.mix = Some((1.0 - d.alpha, along));
    if d.set.unbiased {
        d.downhills += 1;
        d.alpha = d.alpha.max(LEAST_MIXING);
        let bias = 1.0 / (1.0 - (1.0 - d.alpha).powi(d.downhills));
        d.mix = Some(((1.0 - d.alpha) * bias, along * bias));
    }
    d.uphills = 0;
    if w.clock.step - d.uphill > d.set.delay {
        d.dt = (d.dt * d.set.grow).min(d.longest);
        w.clock.dt = d.dt;
        d.alpha *= d.set.alpha_shrink;
    }
}

/// Uphill: a shorter time step, half a step back, and a fresh start along the forces, whose speed after one step is left in the
/// velocities for `limit`; the unbiased variant continues with the forces it has. `false` if this has happened too often.
fn slow_down(s: &mut Search, d: &mut Damping) -> Result<bool> {
    let step = s.w.clock.step;
    (d.mix, d.uphill, d.downhills) = (None, step, 0);
    let starting = d.set.initial_delay && step - s.first < d.set.delay;
    if !starting {
        d.alpha = d.set.alpha0;
        if d.dt * d.set.shrink >= d.shortest {
            d.dt *= d.set.shrink;
            s.w.clock.dt = d.dt;
        }
    }
    d.uphills += 1;
    if d.set.uphill_most > 0 && d.uphills > d.set.uphill_most {
        return Ok(false);
    }
    if d.set.half_step_back {
        drift(s.w, -0.5 * d.dt);
    }
    s.w.particles.v.fill([0.0; 3]);
    if !d.set.unbiased {
        s.evaluate()?;
        kick(s.w, d.dt, None);
    }
    Ok(true)
}

/// Shortens this step so that no particle moves further than `dmax`.
fn limit(s: &Search, d: &mut Damping) {
    // The unbiased way limits speeds instead.
    d.limited = if d.set.unbiased { d.dt } else { shortened(s.w, d.dt, s.farthest) };
}

/// One step of motion with its evaluation.
fn step(s: &mut Search, d: &Damping) -> Result<()> {
    let dt = d.limited;
    let dmax = s.farthest;
    let drift = |w: &mut World, dt: f64| {
        if d.set.unbiased {
            let most = dmax / dt;
            w.particles.v.iter_mut().flatten().for_each(|v| *v = v.clamp(-most, most));
        }
        drift(w, dt);
    };
    match d.set.integrator {
        FireIntegrator::EulerImplicit | FireIntegrator::Leapfrog => {
            kick(s.w, dt, d.mix);
            drift(s.w, dt);
            s.evaluate()
        }
        FireIntegrator::Verlet => {
            kick(s.w, 0.5 * dt, d.mix);
            drift(s.w, dt);
            s.evaluate()?;
            kick(s.w, 0.5 * dt, None);
            Ok(())
        }
        FireIntegrator::EulerExplicit => {
            kick(s.w, 0.0, d.mix);
            drift(s.w, dt);
            kick(s.w, dt, None);
            s.evaluate()
        }
    }
}
