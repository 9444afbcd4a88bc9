//! Contacts among plastic grains: depths on both sides, forces, effects on the grains.

use super::deeds::{Deed, Sum};
use super::press::{Contact, Press};
use super::side::{AREA, DEPTH, PLASTIC, WIDTH};
use super::state::Grain;
use super::{Manner, Material, PAIR, State, screen};
use crate::Geometry;
use perigrain_base::math::form::Form;
use perigrain_base::math::real::Real;
use perigrain_base::par;
use perigrain_neigh::list::Pair;
use perigrain_world::contacts::Contacts;

/// The contacts of one step.
#[derive(Clone, Debug, Default)]
pub struct Meetings {
    /// Geometry by contact.
    seen: Vec<Contact>,
    deeds: Vec<[Deed; 2]>,
    lines: Vec<screen::Line>,
    screen: screen::Screen,
    open: Vec<f64>,
    grains: Vec<Grain>,
    sums: Vec<Sum>,
    spare: Vec<f64>,
}

impl Meetings {
    /// Prepares `memory` for the contacts `keys` of `pairs` with this geometry and these distances of
    /// centres; collects the approach of their planes.
    pub fn meet(
        &mut self,
        (pairs, keys): (&[Pair], &[[u32; 2]]),
        (geometry, distances): (&[Geometry], &[f64]),
        radius: &[f64],
        s: &mut State,
        memory: &mut Contacts,
        lammps: bool,
    ) {
        memory.carry(keys, PAIR, &mut self.spare);
        self.seen.clear();
        self.lines.clear();
        let contacts = pairs.iter().zip(geometry).zip(distances);
        for (((pair, g), length), history) in contacts.zip(memory.history.chunks_exact_mut(PAIR)) {
            let (i, j) = (pair.i as usize, pair.j as usize);
            let (ends, Geometry { normal, overlap, .. }) = ([pair.i, pair.j], *g);
            self.lines.push(screen::Line { ends, normal, length: *length });
            // LAMMPS drops contacts that only this step's growth has preserved.
            if lammps && overlap <= s.grown[i] + s.grown[j] {
                history.fill(0.0);
            }
            let plastic = [history[PLASTIC], history[WIDTH + PLASTIC]];
            let depths = split(overlap, g.radii, history[PAIR - 1], plastic);
            for ((k, depth), side) in [i, j].into_iter().zip(depths).zip(history.chunks(WIDTH)) {
                if s.area_before[k] > 0.0 {
                    s.mean[k] += side[AREA] * (depth - side[DEPTH]) / s.area_before[k];
                }
            }
            self.seen.push(Contact { ends, normal, overlap, depths, open: 1.0 });
        }
        self.screen.open(&self.lines, radius.len(), &mut self.open);
        self.seen.iter_mut().zip(&self.open).for_each(|(c, open)| c.open = *open);
    }

    /// Evaluates all contacts; `precomputed` receives the results that the rest of the law needs: [`super::PRECOMPUTED`] numbers
    /// at the end of each row of `width`.
    pub fn press(
        &mut self,
        m: &Material,
        radius: &[f64],
        s: &mut State,
        memory: &mut Contacts,
        precomputed: (&mut [f64], usize),
        manner: Manner,
    ) {
        // Every element is written.
        self.deeds.resize(self.seen.len(), Default::default());
        let (rows, width) = precomputed;
        self.grains.clear();
        self.grains.extend(radius.iter().enumerate().map(|(k, r)| s.grain(m, k, *r)));
        let (grains, form) = (&self.grains[..], Form::here());
        let columns = (
            &mut self.deeds[..],
            par::Rows { data: &mut memory.history[..], width: PAIR },
            par::Rows { data: rows, width },
            &self.seen[..],
        );
        par::each(columns, |_, (deeds, memory, precomputed, seen)| {
            let press = Press { m, manner, grains, seen, memory: memory.data, precomputed, deeds };
            // SAFETY: the processor supports this form, and the columns are as long as `Press` requires.
            unsafe { form.run(press) };
        });
        self.sums.clear();
        self.sums.resize(radius.len(), Sum::default());
        for (seen, [a, b]) in self.seen.iter().zip(&self.deeds) {
            self.sums[seen.ends[0] as usize].add(a, seen.normal);
            self.sums[seen.ends[1] as usize].add(b, seen.normal);
        }
        self.sums.iter().enumerate().for_each(|(k, sum)| sum.give(s, k));
    }
}

/// Depths of the plane through the circle in which the spheres intersect.
#[inline(always)]
pub(super) fn cut<R: Real>(overlap: R, radii: [R; 2]) -> [R; 2] {
    let one = overlap * (radii[1] * 2.0 - overlap) / ((radii[0] + radii[1] - overlap) * 2.0);
    [one, overlap - one]
}

/// Depth of the plane on each side. While the overlap exceeds the `largest` one so far, the plane goes
/// through the circle in which the spheres intersect; during unloading each side recedes in proportion to its
/// elastic part.
#[inline(always)]
fn split<R: Real>(overlap: R, radii: [R; 2], largest: R, plastic: [R; 2]) -> [R; 2] {
    let (unloads, most) = (largest.above(overlap), cut(largest.most(overlap), radii));
    let rest = plastic[0] + plastic[1];
    let part = (overlap - rest) / (largest - rest);
    let one = R::choose(unloads, plastic[0] + (most[0] - plastic[0]) * part, most[0]);
    [one, R::choose(unloads, plastic[1] + (most[1] - plastic[1]) * part, most[1])]
}
