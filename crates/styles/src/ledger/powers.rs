//! Powers of the forces that fixes add, and of all forces on driven particles.

use super::{FORCES, TORQUES, scale, twice_kinetic};
use crate::matter::Masses;
use perigrain_base::math::vec3::{Vec3, dot};
use perigrain_base::par;
use perigrain_world::{Constant, World};

/// What forces do at a step, and how driven particles move.
#[derive(Clone, Copy, Debug, Default)]
pub struct Powers {
    /// Of the forces of each channel.
    pub channels: [f64; 3],
    /// Of all forces on driven particles.
    pub driven: f64,
    /// Twice the kinetic energies of driven particles, straight and turning.
    pub moving: [f64; 2],
}

impl Powers {
    /// At the present velocities; `free` are the bits of groups that equations of motion move.
    pub fn measure(w: &World, free: u32) -> Self {
        let (p, masses) = (&w.particles, Masses::of(w));
        let columns = |keys: &[Constant<Vec<Vec3>>; 3]| {
            [0, 1, 2].map(|k| w.columns.get_vector(*keys[k]).filter(|column| column.len() == p.len()))
        };
        let (forces, torques) = (columns(&FORCES), columns(&TORQUES));
        let turns =
            |torque: Option<&Vec3>, i: usize| torque.zip(p.omega.get(i)).map_or(0.0, |(q, o)| dot(*q, *o));
        let chunk = |range: std::ops::Range<usize>| {
            let mut sum = Self::default();
            for k in 0..3 {
                let Some(force) = forces[k] else { continue };
                let torque = torques[k];
                sum.channels[k] = range.clone().fold(0.0, |sum, i| {
                    sum + (scale(w, i) * dot(force[i], p.v[i]) + turns(torque.map(|t| &t[i]), i))
                });
            }
            for i in range.filter(|i| p.mask[*i] & free == 0) {
                sum.driven += scale(w, i) * dot(p.f[i], p.v[i]) + turns(p.torque.get(i), i);
                let [straight, turning] = twice_kinetic(w, &masses, i);
                sum.moving = [sum.moving[0] + straight, sum.moving[1] + turning];
            }
            sum
        };
        par::reduce(p.len(), chunk, Self::plus).unwrap_or_default()
    }

    fn plus(self, more: Self) -> Self {
        Self {
            channels: std::array::from_fn(|k| self.channels[k] + more.channels[k]),
            driven: self.driven + more.driven,
            moving: [self.moving[0] + more.moving[0], self.moving[1] + more.moving[1]],
        }
    }
}
