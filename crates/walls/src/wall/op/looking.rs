//! The contacts of a wall after a step, for `compute wall/local`: nothing in the world changes.

use super::{Common, Part, Surface, Warmth};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{scale, sub};
use perigrain_contact::walls::{Meeting, Spheres};
use perigrain_contact::{Advance, Heat};
use perigrain_styles::SealCx;
use perigrain_styles::probe::{HISTORY, OnWall, WallProbe};
use perigrain_world::World;

/// A wall that is looked at.
pub struct Looking {
    bit: u32,
    surface: Box<dyn Surface>,
    parts: Vec<Part>,
    warmth: Option<Warmth>,
}

impl Looking {
    /// A wall during a run.
    ///
    /// # Errors
    /// Anything that a wall with a temperature lacks.
    pub fn new(
        common: &Common,
        surface: Box<dyn Surface>,
        kinds: &[u16],
        cx: &mut dyn SealCx,
    ) -> Result<Self> {
        let parts = Part::all(common, kinds, cx.world())?;
        let conducts = parts.iter().any(|part| part.law.heat != Heat::None);
        Ok(Self { bit: common.group.bit(), surface, parts, warmth: Warmth::new(common, conducts, cx)? })
    }
}

impl WallProbe for Looking {
    fn look(&mut self, w: &World, dt: f64) -> Vec<OnWall> {
        self.surface.follow(w);
        let (p, mut out) = (&w.particles, vec![]);
        let masses = w.contact_masses();
        let grains =
            Spheres { x: &p.x, v: &p.v, omega: &p.omega, radius: &p.radius, mass: &masses, tag: &p.tag };
        let all = 0..w.n();
        let Self { bit, surface, parts, warmth } = self;
        for Part { law, kinds, on, key, sweep, .. } in parts {
            let kinds = kinds.as_deref().map(|some| (&p.kind[..], some));
            let which = Meeting { mask: &p.mask, group: *bit, rows: std::slice::from_ref(&all), kinds };
            let mut memory = w.wall_contacts.get(*key).cloned().unwrap_or_default();
            surface.show(w, *on, &mut |wall| {
                sweep.list(wall, &grains, &which, law, 0.0);
                sweep.meet(wall, &grains, law, &mut memory);
            });
            sweep.act(&grains, law, &mut memory.clone(), Advance { dt, history: false });
            if let Some(warmth) = warmth {
                let temperature = w.columns.get_scalar(warmth.temperature).unwrap_or_default();
                let flow = &mut vec![0.0; w.n()];
                sweep.conduct(&grains, law, warmth.wall.get(w), temperature, flow);
            }
            for (k, (touch, wrench)) in sweep.contacts().enumerate() {
                let (i, near) = (touch.grain as usize, touch.near);
                let mut history = [0.0; HISTORY];
                let own = memory.history.get(k * memory.width..).unwrap_or_default();
                history.iter_mut().zip(own.iter().take(memory.width)).for_each(|(to, from)| *to = *from);
                let [surface, triangle] = surface.piece(near.part);
                out.push(OnWall {
                    surface,
                    triangle,
                    grain: touch.grain,
                    foot: sub(p.x[i], scale(near.distance, near.normal)),
                    normal: near.normal,
                    distance: near.distance,
                    velocity: near.velocity,
                    force: wrench.force,
                    torque: wrench.torque_i,
                    heat: sweep.heat(k),
                    history,
                });
            }
        }
        out.sort_by_key(|one| (one.surface, one.triangle, p.tag[one.grain as usize]));
        out
    }
}
