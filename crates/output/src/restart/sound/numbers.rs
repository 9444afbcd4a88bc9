//! The numbers that stand for themselves: times, lengths, counts of types.

use super::{Outcome, must};
use perigrain_world::{GroupId, RunStyle, World, memory};

/// Whether a group is one of the 32 there can be.
pub fn known(group: GroupId) -> bool {
    group.0 < 32
}

/// Whether all are finite and none is negative.
fn lengths(all: &[f64]) -> bool {
    all.iter().all(|x| x.is_finite() && *x >= 0.0)
}

pub fn clock(w: &World) -> Outcome {
    let c = w.clock.past();
    must(c.dt.is_finite() && c.dt >= 0.0, "the time step is no time")?;
    must(c.time_base.is_finite(), "the time is none")?;
    let steps = [c.step, c.time_step, c.first, c.last, c.start, c.stop];
    must(steps.iter().all(|s| *s >= 0), "a step is negative")
}

pub fn settings(w: &World) -> Outcome {
    let near = &w.settings.neighbor;
    must(lengths(&[near.skin]), "the skin is no length")?;
    must(near.every >= 1 && near.delay >= 0, "lists are to be rebuilt at no step")?;
    match &w.settings.run_style {
        RunStyle::Verlet => Ok(()),
        RunStyle::Staggered { ratio, twice, .. } => {
            must(ratio.is_none_or(|r| (1..=1 << 32).contains(&r)), "the ratio of its steps is none")?;
            must(twice.is_none_or(known), "a group of its run style is none")
        }
        RunStyle::Respa(r) => {
            let steps = r.loops.iter().try_fold(1i64, |product, n| product.checked_mul(*n));
            must(
                r.loops.iter().all(|n| *n >= 1) && steps.is_some_and(|s| s <= 1 << 32),
                "its levels have no loops",
            )?;
            let levels = [r.bond, r.pair].into_iter().chain(r.subs.iter().flatten().copied());
            must(levels.into_iter().all(|l| l <= r.loops.len()), "a level of its run style is none")
        }
    }
}

pub fn domain(w: &World) -> Outcome {
    let Some(d) = w.domain.past() else {
        return must(w.n() == 0, "there are particles without a box");
    };
    let numbers = [d.lo, d.hi, d.min_lo, d.min_hi, d.small];
    must(numbers.as_flattened().iter().all(|x| x.is_finite()), "a face of it is nowhere")?;
    must(
        (0..3).all(|k| d.lo[k] < d.hi[k] && (d.hi[k] - d.lo[k]).is_finite()),
        "its lower faces are not the lower ones",
    )?;
    must((0..3).map(|k| d.hi[k] - d.lo[k]).product::<f64>().is_normal(), "it has no volume to compute with")?;
    must(d.tilt.iter().flatten().all(|x| x.is_finite()), "it leans beyond all numbers")?;
    must(
        d.flip.is_none_or(|f| d.tilt.is_some() && f.tilt.iter().all(|x| x.is_finite())),
        "what it will be flipped to is no box",
    )?;
    must(lengths(&d.small), "the room at its faces is no length")?;
    must(
        d.flow.is_none_or(|f| known(f.group) && f.rate.iter().chain(&f.tilt).all(|r| r.is_finite())),
        "what flows through it is no group",
    )?;
    let faces = d.boundary.0.iter();
    must(faces.clone().all(|[a, b]| (*a == FACE) == (*b == FACE)), "one of two opposite faces is periodic")
}

/// The face that needs another one opposite.
const FACE: perigrain_world::Face = perigrain_world::Face::Periodic;

pub fn types(w: &World) -> Outcome {
    must(w.types <= usize::from(u16::MAX), "there are more types than can be")?;
    must(w.type_mass.len() == w.types, "types and their masses differ in number")?;
    memory::lacking_for_types(w.types).map_or(Ok(()), |d| Err(d.message))
}
