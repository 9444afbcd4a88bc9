//! Ops that act on each particle by itself, one after the other on each stretch of particles while that is in fast memory.

use crate::math::vec3::Vec3;
use crate::par;
use crate::world::{AtomStyle, World};

/// Most ops that take turns.
const MOST: usize = 6;

/// A stretch of particles as ops see it: columns they may write, cut to the stretch, and whole columns to read.
pub struct Stretch<'a> {
    /// The first particle.
    pub start: usize,
    /// Positions.
    pub x: &'a mut [Vec3],
    /// Velocities.
    pub v: &'a mut [Vec3],
    /// Forces.
    pub f: &'a mut [Vec3],
    /// Angular velocities; empty where nothing spins.
    pub omega: &'a mut [Vec3],
    /// Torques; empty where nothing spins.
    pub torque: &'a mut [Vec3],
    /// Group bits.
    pub mask: &'a [u32],
    /// What is read, of all particles.
    pub all: Known<'a>,
}

/// What ops on stretches can read of all particles.
#[derive(Clone, Copy)]
pub struct Known<'a> {
    /// What particles have.
    pub style: AtomStyle,
    /// Types.
    pub kind: &'a [u16],
    /// Radii.
    pub radius: &'a [f64],
    /// Masses, where each has its own.
    pub mass: &'a [f64],
    /// Masses by type.
    pub type_mass: &'a [Option<f64>],
}

/// What came of a stretch: sums, and a largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gist {
    /// Sums over particles.
    pub sums: [f64; 3],
    /// The largest of something.
    pub most: f64,
}

impl Gist {
    fn join(self, other: Self) -> Self {
        Self { sums: std::array::from_fn(|k| self.sums[k] + other.sums[k]), most: self.most.max(other.most) }
    }
}

/// What an op does to one stretch.
pub type Act = Box<dyn Fn(&mut Stretch) -> Gist + Sync>;

/// Lets ops take turns on all stretches; what came of each of them. Every particle sees the same as if the ops acted one
/// after the other.
pub fn take_turns(w: &mut World, acts: &[Act]) -> Vec<Gist> {
    acts.chunks(MOST).flat_map(|acts| some(w, acts).into_iter().take(acts.len())).collect()
}

fn some(w: &mut World, acts: &[Act]) -> [Gist; MOST] {
    let p = &mut w.particles;
    let all =
        Known { style: p.style, kind: &p.kind, radius: &p.radius, mass: &p.mass, type_mass: &w.type_mass };
    let spins = p.omega.len() == p.x.len() && p.torque.len() == p.x.len();
    let turned = spins.then_some((&mut p.omega[..], &mut p.torque[..]));
    let columns = (&mut p.x[..], &mut p.v[..], &mut p.f[..], &p.mask[..], turned);
    type Columns<'a> =
        (&'a mut [Vec3], &'a mut [Vec3], &'a mut [Vec3], &'a [u32], Option<(&'a mut [Vec3], &'a mut [Vec3])>);
    let stretch = |start: usize, (x, v, f, mask, turned): Columns<'_>| {
        let (omega, torque) = turned.unwrap_or_default();
        let mut stretch = Stretch { start, x, v, f, omega, torque, mask, all };
        let mut gists = [Gist::default(); MOST];
        for (gist, act) in gists.iter_mut().zip(acts) {
            *gist = act(&mut stretch);
        }
        gists
    };
    let join = |a: [Gist; MOST], b: [Gist; MOST]| std::array::from_fn(|k| a[k].join(b[k]));
    par::reduce_each(columns, stretch, join).unwrap_or_default()
}
