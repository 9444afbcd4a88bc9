//! `dump_modify every/time`: snapshots at times, not at steps.

use super::State;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::ValueRef;
use perigrain_plan::Tick;
use perigrain_styles::Text;
use perigrain_world::World;

/// How far from a time a step may be and count as there, in steps.
const NEAR: f64 = 1e-6;

/// What gives the next time from the present one.
pub(super) enum Clock {
    /// Multiples of a time.
    Multiples(f64),
    /// A variable, which is asked when a run begins and after each snapshot.
    Named(Text, ValueRef),
}

impl Clock {
    /// Whether this step is the first one that reaches the next time; `first`: the first step of the first run is
    /// asked for.
    ///
    /// # Errors
    /// A variable that does not lead on.
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
                // Times closer than steps are passed over, where LAMMPS passes over them.
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

/// The time that the variable names now.
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
