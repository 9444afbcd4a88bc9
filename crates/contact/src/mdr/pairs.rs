//! Contacts among the grains of a powder: depths on both sides, forces, what they mean for the grains.

use super::side::{PLASTIC, Side, WIDTH};
use super::state::Grain;
use super::{Manner, Material, PAIR, State, TOLD, screen};
use perigrain_base::math::vec3::{SIX, Vec3};
use perigrain_base::par;
use perigrain_neigh::list::Pair;
use perigrain_world::contacts::Contacts;

/// The contacts of one step.
#[derive(Clone, Debug, Default)]
pub struct Meetings {
    /// Geometry by contact.
    seen: Vec<Seen>,
    deeds: Vec<[Deed; 2]>,
    lines: Vec<screen::Line>,
    screen: screen::Screen,
    open: Vec<f64>,
    grains: Vec<Grain>,
    sums: Vec<Sum>,
    spare: Vec<f64>,
}

/// Geometry of a contact.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    pair: Pair,
    normal: Vec3,
    overlap: f64,
    /// The part of the force that other grains in between leave.
    open: f64,
}

/// What one side of a contact means for its grain.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deed {
    /// Added to the mean volumetric strain.
    pub strain: f64,
    /// Volume that the plane cuts off.
    pub cap: f64,
    /// Area of contact.
    pub area: f64,
    /// What the plane changes of the surface.
    pub surface: f64,
    /// Volume that flow displaces, negative.
    pub displaced: f64,
    /// What the plane takes off the surface that rises.
    pub covered: f64,
    /// −F b/V, b the distance of the plane from the centre.
    pub stress: f64,
    /// What the plane gets back if it goes, where somebody keeps a ledger [energy].
    pub energy: f64,
}

/// What all contacts of a grain mean for it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sum {
    /// Of all that is the same in every direction; its `stress` is not used.
    deed: Deed,
    /// xx yy zz xy xz yz of −F b/V.
    stress: [f64; 6],
}

impl Sum {
    /// Adds what one contact with this normal means.
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

    /// Adds it to grain `k`.
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

/// Presses one side of grain `g` with a plane at depth `depth`, of which other grains leave the part `open`: the force
/// with the bulk's part, the radius of contact for damping, what it means for the grain.
pub fn side(
    m: &Material,
    g: &Grain,
    radius: f64,
    depth: f64,
    side: &mut Side,
    open: f64,
    manner: Manner,
) -> (f64, f64, Deed) {
    use std::f64::consts::PI;
    let before = *side;
    side.go(depth, radius, g.first, g.mean);
    let pressed = side.press(m, radius, manner);
    let bulk = if side.squeezing > 0.0 {
        m.bulk() * side.squeezing * g.area_before / g.left_volume * side.area
    } else {
        0.0
    };
    let force = open * (pressed.force + bulk);
    let covered = open * 2.0 * PI * radius;
    side.area *= open;
    let stress = -force * (g.first - side.first_depth) / g.volume;
    side.strain = stress / (3.0 * m.bulk());
    // The bulk answers to all planes of the grain: of its force as much as a spring of its own would hold.
    let held = || open * (side.energy(m, radius) + 0.5 * bulk * side.squeezing);
    let mut deed = Deed {
        energy: if manner.booked { held() } else { 0.0 },
        strain: side.strain,
        cap: PI * depth * depth * (3.0 * radius - depth) / 3.0,
        area: side.area,
        surface: side.area - covered * (side.deepest + side.squeezing),
        stress,
        ..Deed::default()
    };
    if side.yielded && pressed.flows {
        let cap = open * PI * (2.0 * radius * depth - depth * depth);
        let first = 4.0 / 3.0 * PI * g.first * g.first * g.first;
        let grown = first * (side.strain - before.strain);
        deed.displaced = -grown - cap * (side.first_depth - before.first_depth);
        deed.covered = covered * depth;
    }
    (force, pressed.radius, deed)
}

impl Meetings {
    /// Brings `memory` to the contacts `keys` of `pairs`, and gathers how much nearer their planes come.
    /// `distance(k)`: vector from j to i.
    pub fn meet(
        &mut self,
        pairs: &[Pair],
        keys: &[[u32; 2]],
        radius: &[f64],
        s: &mut State,
        memory: &mut Contacts,
        distance: impl Fn(&Pair) -> Vec3,
        lammps: bool,
    ) {
        memory.carry(keys, PAIR, &mut self.spare);
        self.seen.clear();
        self.lines.clear();
        for (pair, history) in pairs.iter().zip(memory.history.chunks_exact_mut(PAIR)) {
            let d = distance(pair);
            let length = perigrain_base::math::vec3::length(d);
            let (i, j) = (pair.i as usize, pair.j as usize);
            let overlap = radius[i] + radius[j] - length;
            let normal = perigrain_base::math::vec3::scale(1.0 / length, d);
            self.seen.push(Seen { pair: *pair, normal, overlap, open: 1.0 });
            self.lines.push(screen::Line { ends: [pair.i, pair.j], normal, length });
            // LAMMPS forgets contacts that only this step's growth has kept.
            if lammps && overlap <= s.grown[i] + s.grown[j] {
                history.fill(0.0);
            }
            let depths = split(overlap, [radius[i], radius[j]], history);
            for (k, (depth, side)) in [i, j].into_iter().zip(depths.into_iter().zip(history.chunks(WIDTH))) {
                let side = Side::read(side);
                if s.area_before[k] > 0.0 {
                    s.mean[k] += side.area * (depth - side.depth) / s.area_before[k];
                }
            }
        }
        self.screen.open(&self.lines, radius.len(), &mut self.open);
        self.seen.iter_mut().zip(&self.open).for_each(|(c, open)| c.open = *open);
    }

    /// Presses all contacts; `told` gets what the rest of the law must know, [`TOLD`] numbers at the end of each of its
    /// rows of `width`.
    pub fn press(
        &mut self,
        m: &Material,
        radius: &[f64],
        s: &mut State,
        memory: &mut Contacts,
        told: (&mut [f64], usize),
        manner: Manner,
    ) {
        self.deeds.clear();
        self.deeds.resize(self.seen.len(), Default::default());
        let (rows, width) = told;
        self.grains.clear();
        self.grains.extend((0..radius.len()).map(|k| s.grain(m, k)));
        let grains = &self.grains[..];
        let columns = (
            &mut self.deeds[..],
            par::Rows { data: &mut memory.history[..], width: PAIR },
            par::Rows { data: rows, width },
            &self.seen[..],
        );
        par::each(columns, |_, (deeds, memory, told, seen)| {
            for (k, (deeds, seen)) in deeds.iter_mut().zip(seen).enumerate() {
                let memory = &mut memory.data[k * PAIR..][..PAIR];
                let told = &mut told.data[(k + 1) * width - TOLD..][..TOLD];
                press(m, grains, radius, seen, memory, told, deeds, manner);
            }
        });
        self.sums.clear();
        self.sums.resize(radius.len(), Sum::default());
        for (seen, [a, b]) in self.seen.iter().zip(&self.deeds) {
            self.sums[seen.pair.i as usize].add(a, seen.normal);
            self.sums[seen.pair.j as usize].add(b, seen.normal);
        }
        self.sums.iter().enumerate().for_each(|(k, sum)| sum.give(s, k));
    }
}

fn press(
    m: &Material,
    grains: &[Grain],
    radius: &[f64],
    seen: &Seen,
    memory: &mut [f64],
    told: &mut [f64],
    deeds: &mut [Deed; 2],
    manner: Manner,
) {
    let ends = [seen.pair.i as usize, seen.pair.j as usize];
    let radii = ends.map(|k| radius[k]);
    let depths = split(seen.overlap, radii, memory);
    let (mut force, mut contact, mut area) = (0.0, 0.0, 0.0);
    for (n, deed) in deeds.iter_mut().enumerate() {
        let own = &mut memory[n * WIDTH..][..WIDTH];
        let mut one = Side::read(own);
        let (f, a, d) = side(m, &grains[ends[n]], radii[n], depths[n], &mut one, seen.open, manner);
        one.write(own);
        *deed = d;
        force += 0.5 * f;
        contact += a;
        area += 0.5 * one.area;
    }
    let largest = &mut memory[PAIR - 1];
    *largest = largest.max(seen.overlap);
    let damped = manner.damped(told[1], 2.0 * m.plane() * contact);
    let energy = if manner.booked { given_back(radii, memory, deeds) } else { 0.0 };
    told.copy_from_slice(&[force, damped, area, energy]);
}

/// The work of the mean force of both sides on the way on which they unload, where each goes its part of the overlap.
fn given_back(radii: [f64; 2], memory: &[f64], deeds: &[Deed; 2]) -> f64 {
    let largest = memory[PAIR - 1];
    let plastic = [memory[PLASTIC], memory[WIDTH + PLASTIC]];
    let (most, way) = (cut(largest, radii), largest - plastic[0] - plastic[1]);
    let part = |k: usize| {
        let own = most[k] - plastic[k];
        if own > 0.0 { deeds[k].energy * way / own } else { 0.0 }
    };
    0.5 * (part(0) + part(1))
}

/// The depths of the plane through the circle in which the spheres cut each other.
fn cut(overlap: f64, radii: [f64; 2]) -> [f64; 2] {
    let one = overlap * (2.0 * radii[1] - overlap) / (2.0 * (radii[0] + radii[1] - overlap));
    [one, overlap - one]
}

/// The depth of the plane on each side: through the circle in which the spheres cut each other while the overlap grows;
/// on the way back each side gives in proportion to what is elastic of it.
fn split(overlap: f64, radii: [f64; 2], memory: &[f64]) -> [f64; 2] {
    let largest = memory[PAIR - 1];
    if overlap >= largest {
        return cut(overlap, radii);
    }
    let plastic = [memory[PLASTIC], memory[WIDTH + PLASTIC]];
    let rest = plastic[0] + plastic[1];
    let part = (overlap - rest) / (largest - rest);
    let most = cut(largest, radii);
    std::array::from_fn(|k| plastic[k] + (most[k] - plastic[k]) * part)
}
