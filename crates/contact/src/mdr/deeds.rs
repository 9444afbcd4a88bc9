//! Effects of contacts on their grains.

use super::state::Grain;
use super::{Manner, Material, Side, State};
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{SIX, Vec3};
use std::f64::consts::PI;

/// The effect of one side of a contact on its grain.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct Deed<R = f64> {
    /// Contribution to the mean volumetric strain.
    pub strain: R,
    /// Volume cut off by the plane.
    pub cap: R,
    /// Contact area.
    pub area: R,
    /// Change of the surface area by the plane.
    pub surface: R,
    /// Volume displaced by plastic flow, negative.
    pub displaced: R,
    /// Surface that the plane covers, and that therefore does not rise.
    pub covered: R,
    /// −F b/V, b being the distance of the plane from the centre.
    pub stress: R,
    /// Energy returned to the plane on unloading, if an energy ledger is kept [energy].
    pub energy: R,
}

impl<R: Copy> Deed<R> {
    /// Its numbers, in memory order.
    #[inline(always)]
    pub fn numbers(&self) -> [R; 8] {
        let Self { strain, cap, area, surface, displaced, covered, stress, energy } = *self;
        [strain, cap, area, surface, displaced, covered, stress, energy]
    }
}

/// The effect of all contacts of a grain.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sum {
    /// The isotropic parts; its `stress` is not used.
    deed: Deed,
    /// xx yy zz xy xz yz of −F b/V.
    stress: [f64; 6],
}

impl Sum {
    /// Adds the effect of one contact with this normal.
    pub fn add(&mut self, deed: &Deed, n: Vec3) {
        let own = &mut self.deed;
        own.strain += deed.strain;
        own.cap += deed.cap;
        own.area += deed.area;
        own.surface += deed.surface;
        own.displaced += deed.displaced;
        own.covered += deed.covered;
        for (c, (a, b)) in self.stress.iter_mut().zip(SIX) {
            *c += deed.stress * n[a] * n[b];
        }
    }

    /// Adds the sum to grain `k`.
    pub fn give(&self, s: &mut State, k: usize) {
        s.strain[k] += self.deed.strain;
        s.caps[k] += self.deed.cap;
        s.area[k] += self.deed.area;
        s.surface_change[k] += self.deed.surface;
        s.displaced[k] += self.deed.displaced;
        s.covered[k] += self.deed.covered;
        s.stress.iter_mut().zip(self.stress).for_each(|(c, stress)| c[k] += stress);
    }
}

/// Presses one side of grain `g` with a plane at depth `depth`; `open` is the fraction that other grains do
/// not shield. Returns the force including the bulk's part, the contact radius for damping, and the effect on
/// the grain.
#[inline(always)]
pub fn side<R: Real>(
    m: &Material,
    g: &Grain<R>,
    depth: R,
    side: &mut Side<R>,
    open: R,
    manner: Manner,
) -> (R, R, Deed<R>) {
    let (before, radius, zero) = (*side, g.radius, depth.like(0.0));
    side.go(depth, radius, g.first, g.mean);
    let pressed = side.press(m, radius, manner);
    let bulk = side.squeezing * m.bulk() * g.area_before / g.left_volume * side.area;
    let bulk = R::choose(side.squeezing.above(zero), bulk, zero);
    let force = open * (pressed.force + bulk);
    let covered = open * (2.0 * PI) * radius;
    side.area = side.area * open;
    let stress = -force * (g.first - side.first_depth) / g.volume;
    side.strain = stress / (3.0 * m.bulk());
    let flows = R::both(side.has_yielded(), pressed.flows.above(zero));
    let cap = open * PI * (radius * 2.0 * depth - depth * depth);
    let grown = g.first * (4.0 / 3.0 * PI) * g.first * g.first * (side.strain - before.strain);
    let displaced = -grown - cap * (side.first_depth - before.first_depth);
    let mut deed = Deed {
        strain: side.strain,
        cap: depth * PI * depth * (radius * 3.0 - depth) / 3.0,
        area: side.area,
        surface: side.area - covered * (side.deepest + side.squeezing),
        displaced: R::choose(flows, displaced, zero),
        covered: R::choose(flows, covered * depth, zero),
        stress,
        energy: zero,
    };
    if manner.booked {
        // The bulk responds to all planes of the grain together: of its force, as much counts as a spring of
        // its own would store.
        deed.energy = open * (side.energy(m, radius) + bulk * 0.5 * side.squeezing);
    }
    (force, pressed.radius, deed)
}
