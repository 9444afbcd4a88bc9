//! How far types of grains reach for each other.

use crate::shared::find_frozen;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::cformat::general;
use perigrain_contact::driver::Rules;
use perigrain_neigh::list::{Reach, Wanted};
use perigrain_styles::near::room_for_pairs;
use perigrain_world::World;

/// In more images than this grains do not meet each other, and are not looked for.
const IMAGES: [f64; 2] = [1e4, 1e6];

/// Refuses grains so large for a box that repeats that they would touch each other across its faces thousands of times over.
///
/// # Errors
/// The diameter of the largest one.
pub fn refuse_giants(w: &World, wanted: &Wanted, skin: f64) -> Result<()> {
    let (largest, heights) = (largest(w), w.periods().heights());
    let types = 1..=w.types as u16;
    for (a, b) in types.clone().flat_map(|a| (a..=w.types as u16).map(move |b| (a, b))) {
        let [ra, rb] = [a, b].map(|k| largest[usize::from(k) - 1]);
        let gap = match wanted.get(a, b) {
            Some(Reach::Touch) => 0.0,
            Some(Reach::Beyond(gap)) => gap,
            Some(Reach::Fixed(_)) | None => continue,
        };
        if ra + rb == 0.0 {
            continue;
        }
        let images = |far: f64| -> f64 {
            let along = |height: f64| if height > 0.0 { 2.0 * (far / height).ceil() + 1.0 } else { 1.0 };
            heights.map(along).into_iter().product()
        };
        let far = ra + rb + gap;
        if images(far) > IMAGES[0] || images(far + skin) > IMAGES[1] {
            let text = format!(
                "grains of diameter {} with a skin of {} do not go with the periodic box: they reach into {} images of it",
                general(2.0 * ra.max(rb), 4),
                general(skin, 4),
                general(images(far + skin), 3)
            );
            return Err(Diagnostic::error(Code::CONFLICT, None, text)
                .help("make the grains or the skin (`neighbor`) smaller or the box larger, or let its faces not repeat (`boundary f f f`)")
                .into());
        }
    }
    room_for_pairs(w, wanted, skin)
}

/// The largest radius of each type (index type − 1).
fn largest(w: &World) -> Vec<f64> {
    largest_of(w, |_| true)
}

fn largest_of(w: &World, counts: impl Fn(usize) -> bool) -> Vec<f64> {
    let mut largest = vec![0.0_f64; w.types];
    let all = w.particles.kind.iter().zip(&w.particles.radius).enumerate();
    for (kind, r) in all.filter(|(i, _)| counts(*i)).map(|(_, own)| own) {
        let of_type = &mut largest[usize::from(*kind) - 1];
        *of_type = of_type.max(*r);
    }
    largest
}

/// How far apart grains of two types are at most as they touch. Frozen ones (`fix freeze`) do not meet each other, as in LAMMPS' cutoffs.
pub fn touching(w: &World) -> impl Fn(u16, u16) -> f64 {
    let mut frozen = vec![];
    find_frozen(w, &mut frozen);
    let rests = |i: usize| frozen.get(i) == Some(&true);
    let (resting, moving) = (largest_of(w, rests), largest_of(w, |i| !rests(i)));
    move |a, b| {
        let [a, b] = [a, b].map(|kind| usize::from(kind) - 1);
        let moved = moving[a] + moving[b];
        moved.max(resting[a] + moving[b]).max(moving[a] + resting[b])
    }
}

/// How far types reach for each other, with what contacts that hold span beyond touch.
pub fn reaching(rules: &Rules, wanted: &Wanted, w: &World) -> Wanted {
    let (mut out, largest) = (wanted.clone(), largest(w));
    let types = 1..=w.types as u16;
    for (a, b) in types.clone().flat_map(|a| types.clone().map(move |b| (a, b))) {
        let [ra, rb] = [a, b].map(|k| largest[usize::from(k) - 1]);
        let (Some(rule), Some(Reach::Touch)) = (rules.get(a, b), wanted.get(a, b)) else { continue };
        let gap = if ra + rb > 0.0 { rule.law.gap(ra * rb / (ra + rb)) } else { 0.0 };
        if gap > 0.0 {
            out.set(a, b, Reach::Beyond(gap));
        }
    }
    out
}
