//! `set … quat`, `quat/random` and `dipole/random`: orientations.

use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::body::{Quat, normalized, turn};
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::{Vec3, length, scale};
use perigrain_world::World;
use std::f64::consts::PI;

/// Refuses an axis of no length, and one that would turn particles out of a flat scene.
pub fn check_axis(axis: Vec3, w: &World) -> Result<()> {
    if w.settings.two_dimensional && (axis[0] != 0.0 || axis[1] != 0.0) {
        return fail(Code::BAD_VALUE, None, "particles of a flat scene turn about z alone: write `0 0 1`");
    }
    if length(axis) > 0.0 { Ok(()) } else { fail(Code::BAD_VALUE, None, "an axis needs a length") }
}

/// The turn by an angle [degrees] about an axis of any length. LAMMPS makes the quaternion one of unit length, not the axis, so that a
/// longer one turns farther.
pub fn about(axis: Vec3, degrees: f64, lammps: bool) -> Quat {
    let angle = degrees.to_radians();
    if lammps { normalized(turn(axis, angle)) } else { turn(scale(1.0 / length(axis), axis), angle) }
}

/// Orientations that are equally likely, each by a random number that belongs to its place (Shoemake, Graphics Gems III, 1992).
pub fn any(w: &mut World, chosen: &[usize], seed: u32) {
    let (flat, mut stream) = (w.settings.two_dimensional, ParkMiller::new(seed));
    let p = &mut w.particles;
    for &i in chosen {
        stream.reset_at(seed, p.x[i]);
        p.quat[i] = if flat {
            let half = PI * stream.uniform();
            [half.cos(), 0.0, 0.0, half.sin()]
        } else {
            let s = stream.uniform();
            let (a, b) = ((1.0 - s).sqrt(), s.sqrt());
            let (first, second) = (2.0 * PI * stream.uniform(), 2.0 * PI * stream.uniform());
            [second.cos() * b, first.sin() * a, first.cos() * a, second.sin() * b]
        };
    }
}

/// Dipole moments of a size, as LAMMPS draws them: a point of a cube about the origin by random numbers that belong to the particle's
/// place gives the direction.
pub fn any_moment(w: &mut World, chosen: &[usize], seed: u32, size: f64) {
    let (flat, mut stream) = (w.settings.two_dimensional, ParkMiller::new(seed));
    let p = &mut w.particles;
    for &i in chosen {
        stream.reset_at(seed, p.x[i]);
        let mut within = || stream.uniform() - 0.5;
        let point = [within(), within(), if flat { 0.0 } else { within() }];
        p.mu[i] = scale(size / length(point), point);
    }
}
