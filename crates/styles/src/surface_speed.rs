//! How fast the surfaces of walls move, for fixes that judge the time step.

use perigrain_world::{Constant, World};

/// The fastest point of each surface that moves, or whose points have velocities, by the fix's ID [velocity].
static SPEEDS: Constant<Vec<(String, f64)>> = Constant::new("speeds of surfaces");

/// Notes how fast the surface of a fix moves at most [velocity]; 0 for one at rest or a fix that is gone.
pub fn note(w: &mut World, id: &str, speed: f64) {
    let all = w.facts.get_or_default(*SPEEDS);
    all.retain(|(other, _)| other != id);
    if speed > 0.0 {
        all.push((id.to_string(), speed));
    }
}

/// The fastest point of all surfaces [velocity].
pub fn fastest(w: &World) -> f64 {
    let all = w.facts.get(*SPEEDS).map_or(&[][..], Vec::as_slice);
    all.iter().map(|(_, speed)| *speed).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fastest_counts() {
        let mut w = World::default();
        assert_eq!(fastest(&w), 0.0);
        note(&mut w, "belt", 3.0);
        note(&mut w, "drum", 2.0);
        assert_eq!(fastest(&w), 3.0);
        note(&mut w, "belt", 0.0);
        assert_eq!(fastest(&w), 2.0);
    }
}
