//! Particles of a block as the loops of a pass access them.

use super::Part;
use perigrain_base::math::body::Quat;
use perigrain_base::math::vec3::Vec3;
use perigrain_plan::{Beside, ParticleBlock};
use std::ops::Range;

/// A block of particles. Spins and torques are empty where there are none.
pub(super) struct Chunk<'a> {
    pub(super) x: &'a mut [Vec3],
    pub(super) v: &'a mut [Vec3],
    pub(super) f: &'a mut [Vec3],
    pub(super) mask: &'a [u32],
    pub(super) omega: &'a mut [Vec3],
    pub(super) torque: &'a mut [Vec3],
    pub(super) radius: &'a [f64],
    /// Empty where no orientations are integrated.
    pub(super) quat: &'a mut [Quat],
}

/// A chunk in fours.
pub(super) struct Fours<'a> {
    pub(super) x: &'a mut [[Vec3; 4]],
    pub(super) v: &'a mut [[Vec3; 4]],
    pub(super) f: &'a mut [[Vec3; 4]],
    pub(super) omega: &'a mut [[Vec3; 4]],
    pub(super) torque: &'a mut [[Vec3; 4]],
    pub(super) radius: &'a [[f64; 4]],
    pub(super) quat: &'a mut [[Quat; 4]],
}

impl Fours<'_> {
    /// Group `k` of four, for the loop over single particles.
    #[inline(always)]
    pub(super) fn one<'a>(&'a mut self, k: usize, mask: &'a [u32; 4]) -> Chunk<'a> {
        Chunk {
            x: &mut self.x[k],
            v: &mut self.v[k],
            f: &mut self.f[k],
            mask,
            omega: self.omega.get_mut(k).map_or(&mut [][..], |four| &mut four[..]),
            torque: self.torque.get_mut(k).map_or(&mut [][..], |four| &mut four[..]),
            radius: self.radius.get(k).map_or(&[][..], |four| &four[..]),
            quat: self.quat.get_mut(k).map_or(&mut [][..], |four| &mut four[..]),
        }
    }
}

/// Particles of a block as the loops access them. Columns that this pass does not change are handed over as
/// well, without access marks.
pub(super) fn chunk<'a>(
    s: &'a mut ParticleBlock<'_>,
    own: Range<usize>,
    (spins, oriented, part): (bool, bool, Part),
    beside: &Beside,
) -> Chunk<'a> {
    let rows = s.start + own.start..s.start + own.end;
    let mask = &s.mask()[own.clone()];
    let (omega, torque, radius) = match s.omega.is_empty() {
        true => (&mut [][..], &mut [][..], &[][..]),
        false => {
            let zeroes = beside.held != 0 || beside.flat != 0 || beside.clears;
            let omega = if spins { &mut s.omega[..] } else { s.omega.past_mut() };
            let torque = match (zeroes, spins) {
                (true, _) => &mut s.torque[..],
                (false, true) => s.torque.read_mut(),
                (false, false) => s.torque.past_mut(),
            };
            let radius = if spins { &s.all.radius[..] } else { s.all.radius.past() };
            (&mut omega[own.clone()], &mut torque[own.clone()], &radius[rows])
        }
    };
    let quat = match oriented && part != Part::Second && !s.quat.is_empty() {
        true => &mut s.quat[own.clone()],
        false => &mut [],
    };
    let x = match (part, beside.pull) {
        (Part::Second, None) => s.x.past_mut(),
        (Part::Second, Some(_)) => s.x.read_mut(),
        _ => &mut s.x[..],
    };
    let f = if *beside == Beside::default() { s.f.read_mut() } else { &mut s.f[..] };
    let (x, v, f) = (&mut x[own.clone()], &mut s.v[own.clone()], &mut f[own]);
    Chunk { x, v, f, mask, omega, torque, radius, quat }
}
