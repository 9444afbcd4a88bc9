//! Particles as the contact loop accesses them: contact tests and geometry.

use super::rules::{Curvature, Rule, Rules};
use crate::together::Met;
use crate::{Arm, Ends as Sides, Geometry, Motion};
use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::{Vec3, add, length};
use perigrain_neigh::list::{Pair, difference};
use perigrain_world::Travel;
use perigrain_world::domain::Flow;

/// Particles as the contact loop accesses them: columns of equal length.
#[derive(Clone, Copy)]
pub struct Grains<'a> {
    /// Positions [length].
    pub x: &'a [Vec3],
    /// Velocities [length/time].
    pub v: &'a [Vec3],
    /// Angular velocities [1/time].
    pub omega: &'a [Vec3],
    /// Radii [length].
    pub radius: &'a [f64],
    /// Masses.
    pub mass: &'a [f64],
    /// Types, from 1.
    pub kind: &'a [u16],
    /// Ids.
    pub tag: &'a [u32],
    /// Edges of the box; zero along directions that are not periodic.
    pub period: Periods,
    /// Velocity gradient of the box, and group masks, if images move with it.
    pub flow: Option<(Flow, &'a [u32])>,
    /// The solid of each particle, `NO_BODY` for grains; may be empty if no rule needs it.
    pub body: &'a [u32],
    /// Particles that are held in place, with infinite mass for others; may be empty.
    pub frozen: &'a [bool],
    /// How far they may have moved.
    pub travel: Travel,
}

/// The body of a particle that belongs to no solid.
pub const NO_BODY: u32 = u32::MAX;

impl Grains<'_> {
    fn body(&self, i: u32) -> u32 {
        self.body.get(i as usize).copied().unwrap_or(NO_BODY)
    }

    /// A unique number for the body of particle `i`: solids first, then grains.
    pub(super) fn body_name(&self, i: u32) -> u64 {
        match self.body(i) {
            NO_BODY => (1 << 32) + u64::from(i),
            solid => u64::from(solid),
        }
    }

    #[inline]
    fn motion(&self, i: u32) -> Motion {
        Motion { velocity: self.v[i as usize], spin: self.omega[i as usize] }
    }

    /// The motion of the second particle's image, which moves with a deforming box.
    #[inline]
    fn image_motion(&self, p: &Pair) -> Motion {
        let mut motion = self.motion(p.j);
        if let Some((flow, mask)) = &self.flow
            && mask[p.j as usize] & flow.group.bit() != 0
        {
            motion.velocity = add(motion.velocity, flow.velocity(p.shift.map(f64::from)));
        }
        motion
    }

    /// Whether the two touch, or would still stick together had they touched (`gaps`: some law allows this).
    #[inline]
    pub(super) fn meeting(&self, p: &Pair, rules: &Rules, gaps: bool) -> Meeting {
        let d = difference(self.x, &self.period, p);
        let [ri, rj] = [p.i, p.j].map(|k| self.radius[k as usize]);
        let (square, sum) = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2], ri + rj);
        let deep = sum - DEEP * ri.min(rj);
        // Without branches on unpredictable conditions.
        let [touches, deep] = [square < sum * sum, square < deep * deep];
        let meeting =
            [Meeting::Apart, Meeting::Touch, Meeting::Deep][usize::from(touches) + usize::from(deep)];
        if !gaps || touches {
            return meeting;
        }
        let rule = self.rule(p, rules);
        let far = sum + rule.map_or(0.0, |r| r.law.gap(ri * rj / sum));
        if square < far * far { Meeting::Near } else { Meeting::Apart }
    }

    /// Geometry of a contact that exists or still sticks, and the distance of the centres.
    #[inline]
    pub(super) fn geometry(&self, p: &Pair, rule: &Rule) -> (Geometry, f64) {
        let (i, j) = (p.i as usize, p.j as usize);
        let d = difference(self.x, &self.period, p);
        let distance = length(d);
        let (radii, masses) = ([self.radius[i], self.radius[j]], [self.mass[i], self.mass[j]]);
        let mut g = Geometry::between(d, distance, radii, masses);
        // Of two frozen grains the one with the smaller tag counts.
        g.mass = match [i, j].map(|k| self.frozen.get(k) == Some(&true)) {
            [false, false] => g.mass,
            [true, true] => masses[usize::from(self.tag[i] > self.tag[j])],
            [_, of_j] => masses[usize::from(!of_j)],
        };
        if rule.curvature == Curvature::Impactor {
            g = match [p.i, p.j].map(|k| self.body(k) == NO_BODY) {
                [true, false] => g.with_curvature(g.radii[0]),
                [false, true] => g.with_curvature(g.radii[1]),
                _ => g,
            };
        }
        if rule.law.arm == Arm::Point {
            // The laws use radii as lever arms of slip and torque.
            g.radii = match [p.i, p.j].map(|k| self.body(k) == NO_BODY) {
                [true, false] => [distance, 0.0],
                [false, true] => [0.0, distance],
                _ => g.radii.map(|r| r - 0.5 * g.overlap),
            };
        }
        (g, distance)
    }

    /// The rule for two particles.
    pub(super) fn rule<'r>(&self, p: &Pair, rules: &'r Rules) -> Option<&'r Rule> {
        rules.get(self.kind[p.i as usize], self.kind[p.j as usize])
    }
}

/// How close two grains are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Meeting {
    #[default]
    Apart,
    /// Not touching, but within the reach of an existing contact.
    Near,
    Touch,
    /// Overlapping by more than `DEEP` of the smaller radius.
    Deep,
}

/// Overlap as a fraction of the smaller radius above which contact laws lose their meaning.
pub const DEEP: f64 = 0.1;

/// The grains of touching pairs.
pub(super) struct Ends<'a> {
    pub pairs: &'a [Pair],
    pub grains: &'a Grains<'a>,
}

impl Met for Ends<'_> {
    #[inline(always)]
    fn own(&self, k: usize) -> u32 {
        self.pairs[k].i
    }

    fn other(&self, k: usize) -> Motion {
        self.grains.image_motion(&self.pairs[k])
    }

    #[inline(always)]
    fn others<const N: usize>(&self, k: [usize; N]) -> Option<[u32; N]> {
        if self.grains.flow.is_some() {
            return None;
        }
        let mut others = [0; N];
        for lane in 0..N {
            others[lane] = self.pairs[k[lane]].j;
        }
        Some(others)
    }

    fn ends(&self, g: &Geometry, k: usize) -> Sides {
        let (grains, p) = (self.grains, &self.pairs[k]);
        let mass = |i: u32| match grains.frozen.get(i as usize) {
            Some(true) => f64::INFINITY,
            _ => grains.mass[i as usize],
        };
        Sides::of_spheres(g.radii, [mass(p.i), mass(p.j)])
    }
}
