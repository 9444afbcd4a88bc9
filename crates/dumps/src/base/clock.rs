//! `dump_modify every/time`: snapshots at given times instead of steps.

use super::State;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::ValueRef;
use perigrain_plan::Tick;
use perigrain_styles::Text;
use perigrain_world::World;

/// Tolerance for reaching an output time, in steps.
const NEAR: f64 = 1e-6;

/// Source of the next output time.
pub(super) enum Clock {
    /// Multiples of a time.
    Multiples(f64),
    /// A variable, which is asked when a run begins and after each snapshot.
    Named(Text, ValueRef),
}

impl Clock {
    /// Whether this step is the first one at or after the next output time; `first`: the first step of the
    /// first run is requested.
    ///
    /// # Errors
    /// A variable that does not increase.
    pub fn strikes(&mut self, state: &mut State, w: &mut World, t: &Tick, first: bool) -> Result<bool> {
        let now = w.clock.time();
        let near = NEAR * t.dt;
        if t.setup {
            let multiple = match self {
                Clock::Multiples(every) => (now - (now / *every).round() * *every).abs() <= near,
                Clock::Named(..) => false,
            };
            state.next_time = Some(match self {
                Clock::Multiples(every) => ((now / *every).floor() + 1.0) * *every,
                Clock::Named(text, r) => later(text, r, w)?,
            });
            let unwritten = if multiple { state.last != Some(t.step) } else { state.last.is_none() };
            return Ok(unwritten && (multiple || first));
        }
        let next = state.next_time.unwrap_or(0.0);
        if now < next - near {
            return Ok(false);
        }
        state.next_time = Some(match self {
            Clock::Multiples(every) => {
                let next = next + *every;
                // Times closer together than steps are skipped under the same condition as in LAMMPS.
                if (next - now - near) / t.dt <= -1.0 {
                    next + (((now + t.dt - next) / *every).trunc() + 1.0) * *every
                } else {
                    next
                }
            }
            Clock::Named(text, r) => later(text, r, w)?,
        });
        Ok(true)
    }
}

/// The current value of the time variable.
fn later(text: &mut Text, r: &ValueRef, w: &mut World) -> Result<f64> {
    let now = w.clock.time();
    let named = text(w)?;
    match named.parse::<f64>() {
        Ok(next) if next > now => Ok(next),
        _ => {
            let text = format!("`{r}` names time {named} at time {now}: it must name a later one");
            let d = Diagnostic::error(Code::BAD_VALUE, r.span, text);
            Err(d.help("use a formula that leads on, as `time+0.1`, `1.5*(time+dt)` or `next(file)`").into())
        }
    }
}
