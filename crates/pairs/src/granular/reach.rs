//! How far types of grains reach for each other.

use perigrain_contact::ContactLaw;
use perigrain_contact::driver::Rules;
use perigrain_neigh::list::{Reach, Wanted};
use perigrain_world::World;

/// The largest radius of each type (index type − 1).
pub fn largest(w: &World) -> Vec<f64> {
    let mut largest = vec![0.0_f64; w.types];
    for (kind, r) in w.particles.kind.iter().zip(&w.particles.radius) {
        let of_type = &mut largest[usize::from(*kind) - 1];
        *of_type = of_type.max(*r);
    }
    largest
}

/// How far types reach for each other, with what contacts that hold span beyond touch.
pub fn reaching<L: ContactLaw>(rules: &Rules<L>, wanted: &Wanted, w: &World) -> Wanted {
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
