//! Positions of the faces of a deforming box at a step, and the rates of its lengths.

use super::pressure::{Aim, Steering};
use super::{Declared, Motion};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_plan::{Stage, Tick, When};
use perigrain_styles::{Reading, SealCx};
use perigrain_world::World;
use std::f64::consts::TAU;

/// The motion of one dimension through a run.
#[derive(Clone, Debug)]
pub struct Track {
    /// Faces at the start.
    start: [f64; 2],
    way: Way,
}

#[derive(Clone, Debug)]
enum Way {
    /// Not changed by this fix.
    Still,
    /// Linear to these final faces.
    Linear([f64; 2]),
    /// The length grows as exp(rate · t).
    Exponential(f64),
    /// The length oscillates.
    Wiggle(f64, f64),
    /// Change of length, and its rate.
    Variable(Reading, Reading),
    /// Controlled by a pressure.
    Steered(Steering),
    /// Keeps the volume constant. `shared`: two dimensions follow one.
    Volume { shared: bool },
}

impl Track {
    /// Whether this dimension changes.
    pub fn moves(&self) -> bool {
        !matches!(self.way, Way::Still)
    }

    fn length(&self) -> f64 {
        self.start[1] - self.start[0]
    }

    /// Faces at distance `length`, centred at the middle of the initial faces.
    fn around(&self, length: f64) -> [f64; 2] {
        let middle = 0.5 * (self.start[0] + self.start[1]);
        [middle - 0.5 * length, middle + 0.5 * length]
    }
}

/// For runs that share a ramp, the state when the line was read: lower faces, upper faces, tilts.
fn stored_start<'a>(fix: &Declared, w: &'a World) -> Option<&'a Vec<f64>> {
    w.memo.get(fix.key()).filter(|m| w.clock.first != w.clock.start && m.len() >= 6)
}

/// Tilts and lengths of the box at the start.
///
/// # Errors
/// There is no box.
pub fn start(fix: &Declared, w: &World) -> Result<([f64; 3], [f64; 3])> {
    let (domain, stored) = (w.domain()?, stored_start(fix, w));
    let at = |k: usize, now: f64| stored.and_then(|m| m.get(k)).copied().unwrap_or(now);
    let (now, tilt) = (domain.lengths(), domain.tilt.unwrap_or_default());
    let length = |d: usize| stored.map_or(now[d], |m| m[d + 3] - m[d]);
    Ok(([0, 1, 2].map(|k| at(k + 6, tilt[k])), [0, 1, 2].map(length)))
}

/// The motions of a run that begins now.
///
/// # Errors
/// Missing variables.
pub fn tracks(fix: &Declared, cx: &mut dyn SealCx, when: &When) -> Result<[Track; 3]> {
    let w = cx.world();
    let (clock, domain) = (w.clock.clone(), w.domain()?.clone());
    let stored = stored_start(fix, w);
    let face = |k: usize, now: f64| stored.map_or(now, |m| m[k]);
    let start = [0, 1, 2].map(|d| [face(d, domain.lo[d]), face(d + 3, domain.hi[d])]);
    let time = (clock.stop - clock.start) as f64 * clock.dt;
    let followers = fix.motions.iter().flatten().filter(|m| matches!(m, Motion::Volume)).count();
    let mut ways = [const { Way::Still }; 3];
    for (d, motion) in fix.motions.iter().enumerate() {
        let Some(motion) = motion else { continue };
        let ([lo, hi], s) = (start[d], fix.scales[d]);
        let grown = |by: f64| Way::Linear([lo - 0.5 * by, hi + 0.5 * by]);
        ways[d] = match motion {
            Motion::Final(a, b) => Way::Linear([a * s, b * s]),
            Motion::Delta(a, b) => Way::Linear([lo + a * s, hi + b * s]),
            Motion::Scale(f) => {
                let (middle, half) = (0.5 * (lo + hi), 0.5 * f * (hi - lo));
                Way::Linear([middle - half, middle + half])
            }
            Motion::Velocity(v) => grown(time * v * s),
            Motion::Rate(r) => grown(time * r * (hi - lo)),
            Motion::TrueRate(r) => Way::Exponential(*r),
            Motion::Wiggle(a, period) => Way::Wiggle(a * s, *period),
            Motion::Pressed(pressed) => Way::Steered(fix.steering(pressed, Aim::Length(d), cx, when)?),
            Motion::Volume => Way::Volume { shared: followers == 2 },
            Motion::Variable(change, rate) => Way::Variable(
                cx.value(change, Stage::EndOfStep, when)?,
                cx.value(rate, Stage::EndOfStep, when)?,
            ),
        };
    }
    let mut ways = ways.into_iter();
    Ok(start.map(|start| Track { start, way: ways.next().unwrap_or(Way::Still) }))
}

/// Rates of the lengths and lower faces for compute temp/deform. Under `compat lammps/2025` a length that
/// keeps the volume counts with its rate over itself; under any `compat lammps`, before the first change of a
/// run (`first`), only lengths that grow linearly count.
/// grow evenly.
pub fn streaming(
    tracks: &[Track; 3],
    w: &World,
    (rate, lengths): ([f64; 3], [f64; 3]),
    first: bool,
) -> [[f64; 3]; 2] {
    let lammps = w.settings.lammps();
    let rate: [f64; 3] = std::array::from_fn(|d| match tracks[d].way {
        Way::Volume { .. } if w.settings.lammps_of_2025() => rate[d] / lengths[d],
        _ => rate[d],
    });
    let clock = &w.clock;
    let time = (clock.stop - clock.start) as f64 * clock.dt;
    // All motions except those to given faces keep the middle fixed.
    let low = std::array::from_fn(|d| match &tracks[d].way {
        Way::Linear([lo, _]) if time > 0.0 => (lo - tracks[d].start[0]) / time,
        _ => -0.5 * rate[d],
    });
    let known = |d: usize| match tracks[d].way {
        Way::Linear(_) => true,
        _ => !(first && lammps),
    };
    [rate, low].map(|v| std::array::from_fn(|d| if known(d) { v[d] } else { 0.0 }))
}

/// Lower faces, upper faces and rates of the lengths at a step.
///
/// # Errors
/// A box without volume.
pub fn faces(tracks: &[Track; 3], w: &World, t: &Tick) -> Result<([f64; 3], [f64; 3], [f64; 3])> {
    let (clock, domain) = (&w.clock, w.domain()?);
    let (elapsed, all) = ((t.step - clock.start) as f64, (clock.stop - clock.start) as f64);
    let (time, share) = (elapsed * clock.dt, if all > 0.0 { elapsed / all } else { 1.0 });
    let mut at = [0, 1, 2].map(|d| [domain.lo[d], domain.hi[d]]);
    let mut rate = [0.0; 3];
    for (d, track) in tracks.iter().enumerate() {
        let [lo, hi] = track.start;
        match &track.way {
            Way::Still | Way::Volume { .. } => {}
            Way::Linear([a, b]) => {
                at[d] = [lo + share * (a - lo), hi + share * (b - hi)];
                let way = (b - a) - (hi - lo);
                rate[d] = if all > 0.0 { way / (all * clock.dt) } else { 0.0 };
            }
            Way::Exponential(r) => {
                let length = track.length() * (r * time).exp();
                (at[d], rate[d]) = (track.around(length), r * length);
            }
            Way::Wiggle(a, period) => {
                let (phase, half) = (TAU * time / period, 0.5 * a);
                at[d] = [lo - half * phase.sin(), hi + half * phase.sin()];
                rate[d] = a * TAU / period * phase.cos();
            }
            Way::Variable(change, speed) => {
                let half = 0.5 * change.get(w);
                (at[d], rate[d]) = ([lo - half, hi + half], speed.get(w));
            }
            Way::Steered(steering) => {
                let [lo, hi] = at[d];
                let grows = steering.rate(w, t)?;
                let half = 0.5 * (hi - lo) * grows * steering.span(w, t);
                // Until 2026, LAMMPS takes the strain rate for the rate of the length.
                let over = if w.settings.lammps_of_2025() { 1.0 } else { hi - lo };
                (at[d], rate[d]) = ([lo - half, hi + half], over * grows);
            }
        }
    }
    follow(tracks, &mut at, &mut rate);
    for (d, track) in tracks.iter().enumerate().filter(|_| w.settings.lammps()) {
        // LAMMPS uses the old length of the box instead of the new one.
        if let Way::Exponential(r) = track.way {
            rate[d] = r * (domain.hi[d] - domain.lo[d]);
        }
    }
    for (d, [lo, hi]) in at.iter().enumerate() {
        if tracks[d].moves() && !(hi > lo && (hi - lo).is_finite()) {
            let text = format!(
                "the box would reach from {lo} to {hi} along {} at step {}",
                ["x", "y", "z"][d],
                t.step
            );
            return Err(Diagnostic::error(Code::BAD_VALUE, None, text).into());
        }
    }
    Ok((at.map(|f| f[0]), at.map(|f| f[1]), rate))
}

/// Sets the dimensions that keep the volume.
fn follow(tracks: &[Track; 3], at: &mut [[f64; 2]; 3], rate: &mut [f64; 3]) {
    let volume: f64 = tracks.iter().map(Track::length).product();
    let led = (*at, *rate);
    for (d, track) in tracks.iter().enumerate() {
        let Way::Volume { shared } = track.way else { continue };
        let others = [(d + 1) % 3, (d + 2) % 3];
        let follows = |k: usize| matches!(tracks[k].way, Way::Volume { .. });
        // A dimension that does not move counts with its initial length.
        let length =
            |k: usize| if tracks[k].moves() { led.0[k][1] - led.0[k][0] } else { tracks[k].length() };
        let relative = |k: usize| if tracks[k].moves() { led.1[k] / length(k) } else { 0.0 };
        let own = if shared {
            let (leader, twin) =
                if follows(others[0]) { (others[1], others[0]) } else { (others[0], others[1]) };
            let own = (volume / length(leader) / tracks[twin].length() * track.length()).sqrt();
            rate[d] = -0.5 * own * relative(leader);
            own
        } else {
            let own = volume / length(others[0]) / length(others[1]);
            rate[d] = -own * (relative(others[0]) + relative(others[1]));
            own
        };
        at[d] = track.around(own);
    }
}
