//! Tilts of a deforming box: their course through a run, and flips to an equivalent box of the same lattice.

use super::pressure::{Aim, Pressed, Steering};
use super::{Declared, variable};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::ValueRef;
use perigrain_plan::{Stage, Tick, When};
use perigrain_styles::words::Words;
use perigrain_styles::{Reading, SealCx};
use perigrain_world::World;
use perigrain_world::domain::{Domain, Flip};
use std::f64::consts::TAU;

/// The words for the tilts.
pub const NAMES: [&str; 3] = ["xy", "xz", "yz"];

/// Axis along which each tilt shifts the edge: one edge length along it is a flip.
const ALONG: [usize; 3] = [0, 0, 1];

/// The edge that each tilt shifts.
pub const ACROSS: [usize; 3] = [1, 2, 2];

/// Motion of a tilt.
#[derive(Clone, Debug, Words)]
#[word(what = "style of a tilt")]
pub enum Motion {
    /// This tilt at the end of the run; linear in time.
    Final(#[word(name = "tilt", what = "the tilt")] f64),
    /// The tilt changed by this much at the end of the run; linear in time.
    Delta(#[word(name = "change", what = "the change of the tilt")] f64),
    /// The tilt grows by V per time.
    #[word("vel")]
    Velocity(#[word(name = "V", what = "the velocity")] f64),
    /// The tilt grows by R times the first length of y (`xy`) or z (`xz`, `yz`) per time.
    #[word("erate")]
    Rate(#[word(name = "R", what = "the shear rate")] f64),
    /// The tilt grows as exp(R t).
    #[word("trate")]
    TrueRate(#[word(name = "R", what = "the true shear rate")] f64),
    /// Tilt + A sin(2π t/T).
    Wiggle(
        #[word(name = "A", what = "the amplitude")] f64,
        #[word(name = "T", what = "the period", positive)] f64,
    ),
    /// The change of the tilt and its rate in time, both equal-style, in the units of the box.
    Variable(
        #[word(name = "v_change", with = variable, kind = Kind::Reference)] ValueRef,
        #[word(name = "v_rate", with = variable, kind = Kind::Reference)] ValueRef,
    ),
    #[word(skip)]
    Pressed(Pressed),
}

/// The course of one tilt through a run.
#[derive(Clone, Debug)]
pub struct Lean {
    start: f64,
    way: Way,
}

#[derive(Clone, Debug)]
enum Way {
    /// Not changed by this fix.
    Still,
    /// Linear to this final tilt.
    Linear(f64),
    /// Grows as exp(rate · t).
    Exponential(f64),
    /// Oscillates.
    Wiggle(f64, f64),
    /// Change of the tilt, and its rate.
    Variable(Reading, Reading),
    /// Controlled by a pressure.
    Steered(Steering),
}

impl Lean {
    /// Whether this tilt changes.
    pub fn moves(&self) -> bool {
        !matches!(self.way, Way::Still)
    }
}

/// The motions of a run that begins now, from the current tilts and lengths of the box.
///
/// # Errors
/// Missing variables, and a tilt yz that would flip while xy changes.
pub fn leans(
    fix: &Declared,
    cx: &mut dyn SealCx,
    when: &When,
    (start, lengths): ([f64; 3], [f64; 3]),
) -> Result<[Lean; 3]> {
    let clock = cx.world().clock.clone();
    let time = (clock.stop - clock.start) as f64 * clock.dt;
    let mut leans = start.map(|start| Lean { start, way: Way::Still });
    for (k, motion) in fix.leans.iter().enumerate() {
        let Some(motion) = motion else { continue };
        let (from, s) = (start[k], fix.scales[ALONG[k]]);
        leans[k].way = match motion {
            Motion::Final(to) => Way::Linear(to * s),
            Motion::Delta(by) => Way::Linear(from + by * s),
            Motion::Velocity(v) => Way::Linear(from + time * v * s),
            Motion::Rate(r) => Way::Linear(from + time * r * lengths[ACROSS[k]]),
            Motion::TrueRate(r) => Way::Exponential(*r),
            Motion::Wiggle(a, period) => Way::Wiggle(a * s, *period),
            Motion::Pressed(pressed) => Way::Steered(fix.steering(pressed, Aim::Tilt(k), cx, when)?),
            Motion::Variable(change, rate) => Way::Variable(
                cx.value(change, Stage::EndOfStep, when)?,
                cx.value(rate, Stage::EndOfStep, when)?,
            ),
        };
    }
    if fix.flips {
        one_at_a_time(&leans, time, lengths[1], cx.span())?;
    }
    Ok(leans)
}

/// Refuses a yz that will flip while xy changes: the flip would change xz by an xy that is no longer the
/// same.
fn one_at_a_time([xy, _, yz]: &[Lean; 3], time: f64, length: f64, span: Span) -> Result<()> {
    if !xy.moves() || !yz.moves() {
        return Ok(());
    }
    let far = match yz.way {
        Way::Still => 0.0,
        Way::Linear(to) => to.abs(),
        Way::Exponential(r) => (yz.start * (r * time).exp()).abs(),
        Way::Wiggle(a, _) => yz.start.abs() + a.abs(),
        Way::Variable(..) | Way::Steered(_) => f64::INFINITY,
    };
    if far <= 0.5 * length {
        return Ok(());
    }
    let text = "yz may lean so far that the box is flipped, while xy changes too";
    let d = Diagnostic::error(Code::CONFLICT, span, text);
    Err(d.help("let yz stay within half of ly, or use `flip no`").into())
}

/// The tilts at a step, in a box with these lengths, and their rates. Of all equivalent tilts it returns the
/// one nearest to the current tilt.
///
/// # Errors
/// Tilts that overflow.
pub fn tilts(leans: &[Lean; 3], w: &World, t: &Tick, lengths: [f64; 3]) -> Result<([f64; 3], [f64; 3])> {
    let (clock, domain) = (&w.clock, w.domain()?);
    let (elapsed, all) = ((t.step - clock.start) as f64, (clock.stop - clock.start) as f64);
    let (time, share) = (elapsed * clock.dt, if all > 0.0 { elapsed / all } else { 1.0 });
    let now = domain.tilt.unwrap_or_default();
    let (mut tilts, mut rates) = (now, [0.0; 3]);
    for (k, lean) in leans.iter().enumerate() {
        let (target, rate) = match &lean.way {
            Way::Still => continue,
            Way::Linear(to) => {
                let way = to - lean.start;
                (lean.start + share * way, if all > 0.0 { way / (all * clock.dt) } else { 0.0 })
            }
            Way::Exponential(r) => (lean.start * (r * time).exp(), r * now[k]),
            Way::Wiggle(a, period) => {
                let phase = TAU * time / period;
                (lean.start + a * phase.sin(), a * TAU / period * phase.cos())
            }
            Way::Variable(change, speed) => (lean.start + change.get(w), speed.get(w)),
            Way::Steered(steering) => {
                let rate = domain.lengths()[ACROSS[k]] * steering.rate(w, t)?;
                (now[k] + rate * steering.span(w, t), rate)
            }
        };
        let (edge, leans) = (lengths[ALONG[k]], now[k] / domain.lengths()[ALONG[k]]);
        let over = target / edge - leans;
        tilts[k] = if w.settings.lammps() && over.abs() < FAR {
            one_by_one(target, edge, leans)
        } else {
            let edges = (over - 0.5).ceil();
            if edges == 0.0 { target } else { target - edges * edge }
        };
        rates[k] = rate;
        if !tilts[k].is_finite() {
            let text = format!("the box would lean by {} = {target} at step {}", NAMES[k], t.step);
            return fail(Code::BAD_VALUE, None, text);
        }
    }
    Ok((tilts, rates))
}

/// Above this number of edges, counting one by one is too slow.
const FAR: f64 = 1000.0;

/// The tilt equivalent to `target` that is nearest to a box which currently leans by `leans` edges, in
/// LAMMPS' arithmetic: edges are subtracted and added one by one. Its rounding moves the corners, and
/// neighbour lists depend on these.
fn one_by_one(mut target: f64, edge: f64, leans: f64) -> f64 {
    while target / edge - leans > 0.0 {
        target -= edge;
    }
    while target / edge - leans < 0.0 {
        target += edge;
    }
    let before = (target / edge - 1.0 - leans).abs() < (target / edge - leans).abs();
    if before { target - edge } else { target }
}

/// Rates of the tilts for compute temp/deform: see [`super::track::streaming`].
pub fn streaming(leans: &[Lean; 3], w: &World, rates: [f64; 3], first: bool) -> [f64; 3] {
    let unknown = |k: usize| first && w.settings.lammps() && !matches!(leans[k].way, Way::Linear(_));
    std::array::from_fn(|k| if unknown(k) { 0.0 } else { rates[k] })
}

/// The equivalent box that leans by half an edge at most, if this one leans farther across periodic faces.
pub fn flip(domain: &Domain) -> Option<Flip> {
    let ([lx, ly, _], [xy, xz, yz]) = (domain.lengths(), domain.tilt?);
    let mut flip = Flip { tilt: [xy, xz, yz], turns: [0; 3] };
    let turn = |tilt: f64, edge: f64| match tilt / edge {
        r if r < -0.5 => 1,
        r if r > 0.5 => -1,
        _ => 0,
    };
    // First yz, because it changes xz.
    if domain.boundary.periodic(1) {
        flip.turns[2] = turn(yz, ly);
        flip.tilt[2] += f64::from(flip.turns[2]) * ly;
        flip.tilt[1] += f64::from(flip.turns[2]) * xy;
    }
    if domain.boundary.periodic(0) {
        for k in [1, 0] {
            flip.turns[k] = turn(flip.tilt[k], lx);
            flip.tilt[k] += f64::from(flip.turns[k]) * lx;
        }
    }
    (flip.turns != [0; 3]).then_some(flip)
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_world::{Boundary, Face};

    #[test]
    fn edges_counted_one_by_one_end_where_a_division_does() {
        for (target, leans, nearest) in
            [(0.7, 0.2, 0.7), (9.1, 0.2, 1.1), (-9.1, 0.2, 0.9), (2.2, 0.1, 0.2), (0.2, 0.1, 0.2)]
        {
            // A few additions of numbers below ten.
            assert!((one_by_one(target, 2.0, leans) - nearest).abs() < 1e-14, "{target}");
        }
    }

    #[test]
    fn a_flip_leads_to_the_box_that_leans_less() {
        let boundary = Boundary([[Face::Periodic; 2]; 3]);
        let domain = |tilt| Domain { tilt: Some(tilt), ..Domain::new([0.0; 3], [4.0, 3.0, 2.0], boundary) };
        assert_eq!(flip(&domain([2.0, -2.0, 1.5])), None);
        assert_eq!(flip(&domain([2.5, 0.0, 0.0])), Some(Flip { tilt: [-1.5, 0.0, 0.0], turns: [-1, 0, 0] }));
        // Edge c less b is -1.5 - 1 in xz, one edge a too far.
        let both = flip(&domain([1.0, -1.5, 2.0])).unwrap();
        assert_eq!(both, Flip { tilt: [1.0, 1.5, -1.0], turns: [0, 1, -1] });
        let open = Boundary([[Face::Fixed; 2], [Face::Periodic; 2], [Face::Periodic; 2]]);
        assert_eq!(flip(&Domain { boundary: open, ..domain([2.5, 0.0, 0.0]) }), None);
    }
}
