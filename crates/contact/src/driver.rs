//! The loop over contacts: finds touching pairs, updates their history, evaluates the law, and sums in a
//! fixed order.

mod booking;
mod grains;
mod rules;

pub use grains::{DEEP, Grains, NO_BODY};
pub use rules::{Average, Curvature, Rule, Rules};

use super::together::Together;
use super::{Advance, Geometry, Granular, Wrench};
use grains::{Ends, Meeting};
use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::{SIX, Vec3, add, length, sub};
use perigrain_base::par;
use perigrain_neigh::list::{Pair, difference};
use perigrain_world::contacts::Contacts;

/// One contact of an evaluation.
pub struct Seen<'a> {
    /// The touching particles.
    pub pair: &'a Pair,
    /// Their contact law.
    pub law: &'a Granular,
    /// The geometry.
    pub geometry: Geometry,
    /// Its history.
    pub history: &'a [f64],
    /// Force and torques, with the sharing factor applied.
    pub wrench: &'a Wrench,
    /// The sharing factor: the fraction of the law's force that counts.
    pub share: f64,
}

/// One evaluation of all contacts; keeps its buffers from step to step.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    flags: Vec<Meeting>,
    /// Indices of the listed pairs that touch, with space for all pairs.
    places: Vec<u32>,
    touching: Vec<Pair>,
    keys: Vec<[u32; 2]>,
    /// Geometry of the contacts.
    geometry: Vec<Geometry>,
    /// Distances of the centres [length].
    distances: Vec<f64>,
    shares: Vec<f64>,
    counts: Vec<u32>,
    names: Vec<[u64; 2]>,
    wrenches: Vec<Wrench>,
    /// Heat flow through each contact per temperature difference.
    conductances: Vec<f64>,
    deep: Option<Pair>,
    spare: Vec<f64>,
}

impl Sweep {
    /// Evaluates the contacts among the pairs of `list`, and updates `memory`: contacts that ended are
    /// removed.
    pub fn run(
        &mut self,
        list: &[Pair],
        grains: &Grains,
        rules: &Rules,
        memory: &mut Contacts,
        step: Advance,
    ) {
        self.meet(list, grains, rules, memory);
        self.act(grains, rules, memory, step);
    }

    /// Finds the contacts among the pairs of `list`: the first half of [`Sweep::run`].
    pub fn meet(&mut self, list: &[Pair], grains: &Grains, rules: &Rules, memory: &mut Contacts) {
        self.find(list, grains, rules, memory);
        memory.carry(&self.keys, rules.memory(), &mut self.spare);
        // Every element is written.
        self.geometry.resize(self.touching.len(), Geometry::default());
        self.distances.resize(self.touching.len(), 0.0);
        let columns = (&mut self.geometry[..], &mut self.distances[..], &self.touching[..]);
        par::each(columns, |_, (geometry, distances, pairs)| {
            for ((g, distance), p) in geometry.iter_mut().zip(distances).zip(pairs) {
                (*g, *distance) =
                    grains.rule(p, rules).map_or_else(Default::default, |rule| grains.geometry(p, rule));
            }
        });
    }

    /// Evaluates the contacts found: the second half.
    pub fn act(&mut self, grains: &Grains, rules: &Rules, memory: &mut Contacts, step: Advance) {
        let width = rules.memory();
        self.share(grains, rules);
        // Every element is written.
        self.wrenches.resize(self.touching.len(), Wrench::default());
        self.conductances.resize(self.touching.len(), 0.0);
        let history = par::Rows { data: &mut memory.history[..], width };
        let done = (&mut self.wrenches[..], &mut self.conductances[..]);
        let columns = (done, history, &self.touching[..], &self.geometry[..], &self.shares[..]);
        par::each(columns, |_, ((wrenches, conductances), history, pairs, geometry, shares)| {
            let mut first = 0;
            while first < pairs.len() {
                let rule = grains.rule(&pairs[first], rules);
                let next = |p: &&Pair| match (grains.rule(p, rules), rule) {
                    (Some(own), Some(rule)) => std::ptr::eq(own, rule),
                    (own, rule) => own.is_none() && rule.is_none(),
                };
                let alike = first..first + pairs[first..].iter().take_while(next).count();
                first = alike.end;
                let (wrenches, conductances) =
                    (&mut wrenches[alike.clone()], &mut conductances[alike.clone()]);
                let Some(rule) = rule else {
                    wrenches.fill(Wrench::default());
                    conductances.fill(0.0);
                    continue;
                };
                let geometry = &geometry[alike.clone()];
                for (conductance, g) in conductances.iter_mut().zip(geometry) {
                    *conductance = rule.law.conductance(g);
                }
                let together = Together {
                    law: &rule.law,
                    geometry,
                    met: Ends { pairs: &pairs[alike.clone()], grains },
                    v: grains.v,
                    omega: grains.omega,
                    history: &mut history.data[alike.start * width..alike.end * width],
                    width,
                    wrenches: &mut *wrenches,
                    step,
                };
                together.evaluate();
                for (w, share) in wrenches.iter_mut().zip(&shares[alike]).filter(|(_, share)| **share != 1.0)
                {
                    *w = w.scaled(*share);
                }
            }
        });
    }

    /// Geometry of the contacts found, and the distances of their centres [length].
    pub fn geometry(&self) -> (&[Geometry], &[f64]) {
        (&self.geometry, &self.distances)
    }

    /// Number of contacts of the last evaluation.
    pub fn len(&self) -> usize {
        self.touching.len()
    }

    /// The first pair of the last evaluation that overlaps by more than [`DEEP`] of the smaller radius: its
    /// ids, and the overlap as a fraction of that radius.
    pub fn deep(&self, grains: &Grains) -> Option<([u32; 2], f64)> {
        let p = self.deep?;
        let [ri, rj] = [p.i, p.j].map(|k| grains.radius[k as usize]);
        let d = difference(grains.x, &grains.period, &p);
        let part = (ri + rj - length(d)) / ri.min(rj);
        Some(([p.i, p.j].map(|k| grains.tag[k as usize]), part))
    }

    /// Whether there were no contacts.
    pub fn is_empty(&self) -> bool {
        self.touching.is_empty()
    }

    /// The touching pairs, and the tags of each.
    pub fn touching(&self) -> (&[Pair], &[[u32; 2]]) {
        (&self.touching, &self.keys)
    }

    /// The contacts of the last evaluation with their forces and torques.
    pub fn contacts(&self) -> impl Iterator<Item = (&Pair, &Wrench)> {
        self.touching.iter().zip(&self.wrenches)
    }

    /// The same with geometry, law and history; `memory` must be from the last evaluation.
    pub fn each(&self, grains: &Grains, rules: &Rules, memory: &Contacts, mut act: impl FnMut(Seen<'_>)) {
        for (k, (pair, wrench)) in self.contacts().enumerate() {
            let Some(rule) = grains.rule(pair, rules) else { continue };
            let (g, _) = grains.geometry(pair, rule);
            let history = memory.history.get(k * memory.width..(k + 1) * memory.width).unwrap_or(&[]);
            act(Seen { pair, law: &rule.law, geometry: g, history, wrench, share: self.shares[k] });
        }
    }

    /// Adds forces and torques to the particles, in list order.
    pub fn scatter(&self, f: &mut [Vec3], torque: &mut [Vec3]) {
        for (p, w) in self.touching.iter().zip(&self.wrenches) {
            let (i, j) = (p.i as usize, p.j as usize);
            f[i] = add(f[i], w.force);
            f[j] = sub(f[j], w.force);
            torque[i] = add(torque[i], w.torque_i);
            torque[j] = add(torque[j], w.torque_j);
        }
    }

    /// Adds the heat flow through the contacts to `flow`, from the temperatures of all particles.
    pub fn conduct(&self, temperature: &[f64], flow: &mut [f64]) {
        for (p, into) in self.touching.iter().zip(self.heat(temperature)) {
            flow[p.i as usize] += into;
            flow[p.j as usize] -= into;
        }
    }

    /// Heat flow through each contact into its first particle [energy/time], from the temperatures of all
    /// particles.
    pub fn heat<'a>(&'a self, temperature: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let at = |i: u32| temperature[i as usize];
        self.touching.iter().zip(&self.conductances).map(move |(p, k)| k * (at(p.j) - at(p.i)))
    }

    /// Virial Σ d ⊗ F over contacts: xx yy zz xy xz yz.
    pub fn virial(&self, x: &[Vec3], period: &Periods) -> [f64; 6] {
        let mut sum = [0.0; 6];
        for (p, w) in self.touching.iter().zip(&self.wrenches) {
            let (d, f) = (difference(x, period, p), w.force);
            for (s, (a, b)) in sum.iter_mut().zip(SIX) {
                *s += d[a] * f[b];
            }
        }
        sum
    }

    fn find(&mut self, list: &[Pair], grains: &Grains, rules: &Rules, memory: &Contacts) {
        let gaps = rules.any(|r| r.law.gap(1.0) > 0.0);
        // Every element is written.
        self.flags.resize(list.len(), Meeting::Apart);
        par::each((&mut self.flags[..], list), |_, (flags, list)| {
            for (flag, p) in flags.iter_mut().zip(list) {
                *flag = grains.meeting(p, rules, gaps);
            }
        });
        let tags = |p: &Pair| [grains.tag[p.i as usize], grains.tag[p.j as usize]];
        if gaps {
            for (p, meeting) in list.iter().zip(&mut self.flags) {
                if *meeting == Meeting::Near && memory.get(tags(p)).is_none() {
                    *meeting = Meeting::Apart;
                }
            }
        }
        // Which pairs touch is unpredictable: each index is written unconditionally, and kept if the pair
        // touches.
        self.places.resize(list.len(), 0);
        let mut count = 0;
        for (k, meeting) in self.flags.iter().enumerate() {
            self.places[count] = k as u32;
            count += usize::from(*meeting != Meeting::Apart);
        }
        let places = &self.places[..count];
        self.touching.clear();
        self.touching.extend(places.iter().map(|k| list[*k as usize]));
        self.keys.clear();
        self.keys.extend(self.touching.iter().map(tags));
        let deep = places.iter().find(|k| self.flags[**k as usize] == Meeting::Deep);
        self.deep = deep.map(|k| list[*k as usize]);
    }

    /// 1/N for every contact.
    fn share(&mut self, grains: &Grains, rules: &Rules) {
        self.shares.clear();
        self.shares.resize(self.touching.len(), 1.0);
        let average = |p: &Pair| grains.rule(p, rules).map_or(Average::None, |r| r.average);
        if rules.any(|r| r.average == Average::Particle) {
            self.counts.clear();
            self.counts.resize(grains.x.len(), 0);
            for p in &self.touching {
                self.counts[p.i as usize] += 1;
                self.counts[p.j as usize] += 1;
            }
            for (s, p) in self.shares.iter_mut().zip(&self.touching) {
                if average(p) == Average::Particle {
                    *s = 1.0 / f64::from(self.counts[p.i as usize].max(self.counts[p.j as usize]));
                }
            }
        }
        if rules.any(|r| r.average == Average::Body) {
            let name = |p: &Pair| {
                let (a, b) = (grains.body_name(p.i), grains.body_name(p.j));
                [a.min(b), a.max(b)]
            };
            self.names.clear();
            self.names.extend(self.touching.iter().map(name));
            self.names.sort_unstable();
            for (s, p) in self.shares.iter_mut().zip(&self.touching) {
                if average(p) == Average::Body {
                    let key = name(p);
                    let first = self.names.partition_point(|n| *n < key);
                    let past = self.names.partition_point(|n| *n <= key);
                    *s = 1.0 / (past - first) as f64;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
