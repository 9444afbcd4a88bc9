//! Contacts of spheres with walls: finding them, their histories, and their forces.

mod booking;
mod shapes;

use super::together::{Met, Together};
use super::{Advance, Geometry, Granular, Motion, Wrench};
use perigrain_base::math::vec3::{Vec3, add, cross, sub};
use perigrain_base::par;
use perigrain_world::contacts::Contacts;
pub use perigrain_world::region::{FacetNear, Near};
pub use shapes::{Cylinder, Planes, Shifted, Tube};
use std::ops::Range;

/// Selects the spheres that interact with a wall.
#[derive(Clone, Copy)]
pub struct Meeting<'a> {
    /// Group masks.
    pub mask: &'a [u32],
    /// Spheres with a bit of these groups are selected.
    pub group: u32,
    /// Row ranges, ascending.
    pub rows: &'a [Range<usize>],
    /// Types of the spheres, and whether each type (from 1) is selected; all are where nothing stands.
    pub kinds: Option<(&'a [u16], &'a [bool])>,
}

impl Meeting<'_> {
    /// Whether a sphere is selected.
    fn has(&self, i: usize) -> bool {
        self.mask[i] & self.group != 0 && self.kinds.is_none_or(|(kind, some)| some[usize::from(kind[i]) - 1])
    }
}

/// A wall for spheres.
pub trait Wall: Sync {
    /// Whether a sphere at `x` may be within `reach` of the wall, on any side; `true` where this is expensive
    /// to decide. `spare` is a buffer.
    fn close(&self, x: Vec3, reach: f64, spare: &mut Vec<Near>) -> bool;

    /// Finds the contact points within `reach` of `x`, at most one per part of the wall.
    fn near(&self, x: Vec3, reach: f64, out: &mut Vec<Near>);

    /// Appends the indices of the wall's pieces within `reach` of `x` to `out`; `false` if the wall has no
    /// pieces.
    fn pieces(&self, _x: Vec3, _reach: f64, _out: &mut Vec<u32>) -> bool {
        false
    }

    /// The result of [`Wall::near`], given that no other pieces are within reach. `spare` is a buffer.
    fn near_pieces(
        &self,
        _pieces: &[u32],
        x: Vec3,
        reach: f64,
        _spare: &mut Vec<FacetNear>,
        out: &mut Vec<Near>,
    ) {
        self.near(x, reach, out);
    }

    /// The wall as planes, if it consists of nothing else: a loop over planes is faster than calls per
    /// sphere.
    fn planes(&self) -> Option<&Planes> {
        None
    }

    /// Whether a cohesive sphere that touched this point remains in contact until it is torn off.
    fn holds(&self, _near: &Near) -> bool {
        true
    }

    /// Whether a contact may inherit the springs of another one.
    fn passes_some(&self) -> bool {
        false
    }

    /// Whether a contact with part `to` may inherit the springs of one with part `from` that ends.
    fn passes(&self, _from: u32, _to: u32) -> bool {
        false
    }
}

/// Particles as walls access them: columns of equal length.
#[derive(Clone, Copy)]
pub struct Spheres<'a> {
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
    /// Ids.
    pub tag: &'a [u32],
}

/// A sphere that touches a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Particle index.
    pub grain: u32,
    /// Contact point.
    pub near: Near,
}

/// A particle that may come near a wall.
#[derive(Clone, Copy, Debug)]
struct Listed {
    grain: u32,
    /// Range of the listed pieces it may come near; empty if the wall has no pieces.
    pieces: [u32; 2],
}

/// Spheres that touch a wall.
struct Touches<'a>(&'a [Touch]);

impl Met for Touches<'_> {
    #[inline(always)]
    fn own(&self, k: usize) -> u32 {
        self.0[k].grain
    }

    fn other(&self, k: usize) -> Motion {
        Motion { velocity: self.0[k].near.velocity, spin: [0.0; 3] }
    }

    #[inline(always)]
    fn others<const N: usize>(&self, _: [usize; N]) -> Option<[u32; N]> {
        None
    }
}

/// One evaluation of all contacts with a wall; keeps its buffers from step to step.
#[derive(Clone, Debug, Default)]
pub struct WallSweep {
    /// Particles that may come near the wall, ordered by tag.
    list: Vec<Listed>,
    /// Pieces of the wall that they may come near, particle by particle.
    pieces: Vec<u32>,
    touching: Vec<Touch>,
    keys: Vec<[u32; 2]>,
    /// Geometry of the contacts.
    geometry: Vec<Geometry>,
    wrenches: Vec<Wrench>,
    /// Heat flow into the particles, by contact.
    heat: Vec<f64>,
    spare: Vec<f64>,
    near: Vec<Near>,
}

impl WallSweep {
    /// Lists the selected particles that may come within `skin` of the wall.
    pub fn list(&mut self, wall: &dyn Wall, grains: &Spheres, which: &Meeting, law: &Granular, skin: f64) {
        match wall.planes() {
            Some(planes) => self.list_near(planes, grains, which, law, skin),
            None => self.list_near(wall, grains, which, law, skin),
        }
    }

    fn list_near<W: Wall + ?Sized>(
        &mut self,
        wall: &W,
        grains: &Spheres,
        which: &Meeting,
        law: &Granular,
        skin: f64,
    ) {
        let some = |range: Range<usize>| {
            let (mut list, mut pieces, mut spare) = (vec![], vec![], vec![]);
            let first = which.rows.partition_point(|rows| rows.end <= range.start);
            let within = which.rows[first..].iter().take_while(|rows| rows.start < range.end);
            for i in within.flat_map(|rows| rows.start.max(range.start)..rows.end.min(range.end)) {
                if !which.has(i) {
                    continue;
                }
                let (x, radius) = (grains.x[i], grains.radius[i]);
                let (from, reach) = (pieces.len() as u32, radius + law.gap(radius) + skin);
                let near = match wall.pieces(x, reach, &mut pieces) {
                    true => pieces.len() as u32 > from,
                    false => wall.close(x, reach, &mut spare),
                };
                if near {
                    list.push(Listed { grain: i as u32, pieces: [from, pieces.len() as u32] });
                }
            }
            (list, pieces)
        };
        (self.list, self.pieces) = par::reduce(grains.x.len(), some, listed_both).unwrap_or_default();
        self.list.sort_unstable_by_key(|l| grains.tag[l.grain as usize]);
    }

    /// Evaluates the contacts among the listed particles, and updates `memory`: contacts that ended are
    /// removed.
    pub fn run(
        &mut self,
        wall: &dyn Wall,
        grains: &Spheres,
        law: &Granular,
        memory: &mut Contacts,
        step: Advance,
    ) {
        self.meet(wall, grains, law, memory);
        self.act(grains, law, memory, step);
    }

    /// Finds the contacts among the listed particles: the first half of [`WallSweep::run`].
    pub fn meet(&mut self, wall: &dyn Wall, grains: &Spheres, law: &Granular, memory: &mut Contacts) {
        match wall.planes() {
            Some(planes) => self.find(planes, grains, law, memory),
            None => self.find(wall, grains, law, memory),
        }
        let width = law.memory();
        self.keys.clear();
        self.keys.extend(self.touching.iter().map(|t| [grains.tag[t.grain as usize], t.near.part]));
        self.hand_over(wall, memory);
        memory.carry(&self.keys, width, &mut self.spare);
    }

    /// Like [`WallSweep::meet`] with no listed particle, for any wall.
    pub fn leave(&mut self, law: &Granular, memory: &mut Contacts) {
        self.touching.clear();
        self.keys.clear();
        memory.carry(&self.keys, law.memory(), &mut self.spare);
    }

    /// Evaluates the contacts found: the second half.
    pub fn act(&mut self, grains: &Spheres, law: &Granular, memory: &mut Contacts, step: Advance) {
        let width = law.memory();
        if self.touching.is_empty() {
            return self.wrenches.clear();
        }
        // Every element is written.
        self.wrenches.resize(self.touching.len(), Wrench::default());
        self.geometry.clear();
        let spheres = self.touching.iter().map(|t| (t, t.grain as usize));
        self.geometry.extend(spheres.map(|(t, i)| geometry(&t.near, grains.radius[i], grains.mass[i])));
        let law = &law.on_wall();
        let history = par::Rows { data: &mut memory.history[..], width };
        let columns = (&mut self.wrenches[..], history, &self.touching[..], &self.geometry[..]);
        par::each(columns, |_, (wrenches, history, touching, geometry)| {
            let (v, omega, history) = (grains.v, grains.omega, history.data);
            let met = Touches(touching);
            Together { law, geometry, met, v, omega, history, width, wrenches, step }.evaluate();
        });
    }

    fn find<W: Wall + ?Sized>(&mut self, wall: &W, grains: &Spheres, law: &Granular, memory: &Contacts) {
        let (list, all) = (&self.list[..], &self.pieces[..]);
        let find = |range: Range<usize>, touching: &mut Vec<Touch>, near: &mut Vec<Near>| {
            let mut spare = vec![];
            for &Listed { grain, pieces: [from, to] } in &list[range] {
                let i = grain as usize;
                let radius = grains.radius[i];
                near.clear();
                // Concave walls have larger effective radii, so that cohesion may reach farther than on flat
                // ones.
                let reach = radius + 2.0 * law.gap(radius);
                match from < to {
                    true => wall.near_pieces(
                        &all[from as usize..to as usize],
                        grains.x[i],
                        reach,
                        &mut spare,
                        near,
                    ),
                    false => wall.near(grains.x[i], reach, near),
                }
                if near.is_empty() {
                    continue;
                }
                if near.len() > 1 {
                    near.sort_by_key(|n| n.part);
                }
                let touches = |n: &&Near| {
                    n.distance < radius
                        || (wall.holds(n)
                            && n.distance < radius + law.gap(effective(radius, n.radius))
                            && memory.get([grains.tag[i], n.part]).is_some())
                };
                touching.extend(near.iter().filter(touches).map(|n| Touch { grain, near: *n }));
            }
        };
        self.touching.clear();
        if list.len() <= par::CHUNK {
            return find(0..list.len(), &mut self.touching, &mut self.near);
        }
        let some = |range| {
            let mut touching = vec![];
            find(range, &mut touching, &mut vec![]);
            touching
        };
        self.touching = par::reduce(list.len(), some, join).unwrap_or_default();
    }

    /// Passes the springs of ending contacts to new contacts of the same particle, where the wall allows it.
    fn hand_over(&self, wall: &dyn Wall, memory: &mut Contacts) {
        if !wall.passes_some() || memory.keys == self.keys {
            return;
        }
        for key in &self.keys {
            let [tag, part] = *key;
            if memory.keys.binary_search(key).is_ok() {
                continue;
            }
            let from = memory.keys.partition_point(|k| k[0] < tag);
            let to = memory.keys.partition_point(|k| k[0] <= tag);
            let ends = |old: &[u32; 2]| self.keys.binary_search(old).is_err() && wall.passes(old[1], part);
            let Some(at) = memory.keys[from..to].iter().position(ends).map(|k| from + k) else { continue };
            memory.keys[at][1] = part;
            // Moves it to its place among the particle's contacts.
            let mut at = at;
            while at > from && memory.keys[at - 1] > memory.keys[at] {
                swap(memory, at - 1);
                at -= 1;
            }
            while at + 1 < to && memory.keys[at] > memory.keys[at + 1] {
                swap(memory, at);
                at += 1;
            }
        }
    }

    /// Adds forces and torques to the particles; returns the load on the wall: force, and torque about
    /// `center`.
    pub fn scatter(&self, f: &mut [Vec3], torque: &mut [Vec3], x: &[Vec3], center: Vec3) -> [f64; 6] {
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        for (t, w) in self.contacts() {
            let i = t.grain as usize;
            f[i] = add(f[i], w.force);
            torque[i] = add(torque[i], w.torque_i);
            force = sub(force, w.force);
            moment = sub(moment, add(w.torque_i, cross(sub(x[i], center), w.force)));
        }
        [force[0], force[1], force[2], moment[0], moment[1], moment[2]]
    }

    /// Adds to `flow` the heat flow from a wall of this temperature to the particles; returns the wall's
    /// total loss.
    pub fn conduct(
        &mut self,
        grains: &Spheres,
        law: &Granular,
        wall: f64,
        temperature: &[f64],
        flow: &mut [f64],
    ) -> f64 {
        self.heat.clear();
        let law = &law.on_wall();
        for t in &self.touching {
            let i = t.grain as usize;
            let conductance = law.conductance(&geometry(&t.near, grains.radius[i], grains.mass[i]));
            let into = conductance * (wall - temperature[i]);
            flow[i] += into;
            self.heat.push(into);
        }
        self.heat.iter().sum()
    }

    /// Heat flow into the particle of contact `k` in the last evaluation.
    pub fn heat(&self, k: usize) -> f64 {
        self.heat.get(k).copied().unwrap_or(0.0)
    }

    /// The contacts of the last evaluation with their forces and torques.
    pub fn contacts(&self) -> impl Iterator<Item = (&Touch, &Wrench)> {
        self.touching.iter().zip(&self.wrenches)
    }

    /// The contacts that were found, and their keys.
    pub fn touching(&self) -> (&[Touch], &[[u32; 2]]) {
        (&self.touching, &self.keys)
    }

    /// How far the listed particles can move before one of them touches the wall [length], at most `most`.
    pub fn room(&mut self, wall: &dyn Wall, grains: &Spheres, law: &Granular, most: f64) -> f64 {
        let (mut room, near) = (most, &mut self.near);
        for &Listed { grain, .. } in &self.list {
            let (x, radius) = (grains.x[grain as usize], grains.radius[grain as usize]);
            let reach = radius + 2.0 * law.gap(radius);
            near.clear();
            wall.near(x, reach + room, near);
            room = near.iter().fold(room, |room, n| room.min(n.distance - reach));
        }
        room
    }

    /// The number of particles tested in each step.
    pub fn listed(&self) -> usize {
        self.list.len()
    }
}

/// Swaps contact `at` and the next one.
fn swap(memory: &mut Contacts, at: usize) {
    memory.keys.swap(at, at + 1);
    let width = memory.width;
    let (first, second) = memory.history[at * width..][..2 * width].split_at_mut(width);
    first.swap_with_slice(second);
}

/// Concatenates two parts of a list, with their pieces.
fn listed_both(a: (Vec<Listed>, Vec<u32>), b: (Vec<Listed>, Vec<u32>)) -> (Vec<Listed>, Vec<u32>) {
    let before = a.1.len() as u32;
    let shifted = b.0.into_iter().map(|l| Listed { pieces: l.pieces.map(|k| k + before), ..l });
    (join(a.0, shifted.collect()), join(a.1, b.1))
}

fn join<T>(mut a: Vec<T>, mut b: Vec<T>) -> Vec<T> {
    a.append(&mut b);
    a
}

/// R̄ of a sphere on a wall of this radius of curvature: R if the wall is flat or too concave for the sphere.
fn effective(radius: f64, wall: f64) -> f64 {
    if wall == 0.0 {
        return radius;
    }
    let curvature = radius * wall / (radius + wall);
    if curvature > 0.0 && curvature.is_finite() { curvature } else { radius }
}

/// The contact geometry for the laws: the wall is a sphere of radius 0 and infinite mass.
fn geometry(near: &Near, radius: f64, mass: f64) -> Geometry {
    Geometry {
        normal: near.normal,
        overlap: radius - near.distance,
        radii: [radius, 0.0],
        curvature: effective(radius, near.radius),
        mass,
    }
}

#[cfg(test)]
mod tests;
