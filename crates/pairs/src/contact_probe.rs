//! What touching grains do to each other at a moment, by the rules of any granular pair style.

use super::granular::force::grains;
use super::granular::heating::conducts;
use super::granular::reach::{reaching, refuse_giants, touching};
use super::shared::{admit, built_at, find_frozen, near};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{Vec3, cross, dot, length, scale, sub};
use perigrain_contact::bodies::solids;
use perigrain_contact::driver::{Average, Grains, Rule, Rules, Sweep};
use perigrain_contact::{Advance, Geometry, Wrench};
use perigrain_neigh::list::{Pair, Reach, Wanted, difference};
use perigrain_styles::probe::{Close, Interaction, OWN, Probe, Request, Springs};
use perigrain_world::columns::TEMPERATURE;
use perigrain_world::contacts::{Contacts, Rolls};
use perigrain_world::index::Index;
use perigrain_world::{Allowed, Key, World};

/// Pairs evaluated at a time where they are not needed all together; fewer in test builds, so that small scenes have several
/// blocks.
const BLOCK: usize = if cfg!(debug_assertions) { 64 } else { 1 << 16 };

/// The numbers a granular style gives to each pair, in LAMMPS' order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Own {
    /// `granular`: tangential force and its size, rolling force and its size, twisting torque, x_i − x_j, and where contacts conduct heat
    /// what flows into the first.
    Granular,
    /// The same of plastic grains (`mdr`), and the mean area of contact of both sides before the heat.
    Mdr,
    /// `gran/…`: tangential force and its size, relative velocity along and across the line of centres.
    Gran,
}

/// An evaluation of contacts without advancing them.
fn still(w: &World) -> Advance {
    Advance { dt: w.clock.dt, history: false }
}

/// Evaluates the contacts of one pair style.
pub struct ContactProbe {
    /// Where contact history is kept in the world.
    key: Key<Contacts>,
    rules: Rules,
    wanted: Wanted,
    own: Own,
    sweep: Sweep,
    /// The list of a rebuild.
    listed: Option<(u64, Vec<Pair>)>,
}

impl ContactProbe {
    /// Of the pairs of types that `wanted` names, with the contacts kept in the world under the style's name.
    pub fn new(name: &'static str, rules: Rules, wanted: Wanted, own: Own) -> Self {
        Self { key: Key::new(name), rules, wanted, own, sweep: Sweep::default(), listed: None }
    }

    /// Pairs that may touch: those of the neighbour list, as it was when lists were last rebuilt.
    fn list(&self, w: &World) -> Result<Vec<Pair>> {
        self.within(w, built_at(w), w.settings.neighbor.skin)
    }

    /// Pairs within reach plus `skin` at the positions `x`.
    fn within(&self, w: &World, x: &[Vec3], skin: f64) -> Result<Vec<Pair>> {
        let wanted = reaching(&self.rules, &self.wanted, w);
        // With the lists of a restart file this check comes before lists are rebuilt.
        refuse_giants(w, &wanted, skin)?;
        Ok(near(w, x, &wanted, skin, &Allowed::felt(w)))
    }

    /// The list of the last rebuild, if it has been made and stands; pairs whose bonds have broken since come in.
    fn take_list(&mut self, w: &World) -> Option<Vec<Pair>> {
        let (made, mut list) = self.listed.take().filter(|_| w.clock.running)?;
        if made == w.rebuild.generation {
            return Some(list);
        }
        let (freed, wanted) = (w.rebuild.only_parted(made)?, reaching(&self.rules, &self.wanted, w));
        admit(w, freed, &wanted, &Allowed::felt(w), &mut list);
        Some(list)
    }

    /// Evaluates all contacts at the present places and velocities, with the memory they have, and reads the outcome.
    fn evaluated<T>(
        &mut self,
        w: &World,
        request: Request,
        read: impl FnOnce(&Grains, &Rules, &Sweep, &Contacts) -> T,
    ) -> Result<T> {
        let list = match self.take_list(w) {
            Some(list) => list,
            None => self.list(w)?,
        };
        let out = self.swept(w, &list, request, read);
        self.listed = Some((w.rebuild.generation, list));
        out
    }

    /// [`Self::evaluated`] of these pairs.
    fn swept<T>(
        &mut self,
        w: &World,
        list: &[Pair],
        request: Request,
        read: impl FnOnce(&Grains, &Rules, &Sweep, &Contacts) -> T,
    ) -> Result<T> {
        let asked = self.rules.needs_bodies();
        let body = match &*w.families {
            Some(families) if asked => solids(families, w.n()),
            _ => vec![],
        };
        let mut frozen = vec![];
        find_frozen(w, &mut frozen);
        let masses = w.contact_masses();
        let grains = Grains { mass: &masses, ..grains(w, w.periods(), &body, &frozen)? };
        let mut memory = w.contacts.get(self.key).cloned().unwrap_or_default();
        if request == (Request::Felt { setup: true }) && w.settings.lammps() && self.own != Own::Mdr {
            // There the setup has kept the springs it has shrunk, and not the radii it shrank them to.
            self.keep_shrunk(w, &mut memory);
        }
        let rules = match request {
            Request::Felt { setup } => &self.rules.again(setup),
            Request::Acting | Request::Idle => &self.rules,
        };
        self.sweep.run(list, &grains, rules, &mut memory, still(w));
        Ok(read(&grains, rules, &self.sweep, &memory))
    }

    /// Evaluates the contacts among these pairs, some at a time, so that they take little memory, and reads the outcome of each.
    fn swept_in_blocks(
        &mut self,
        w: &World,
        list: &[Pair],
        mut read: impl FnMut(&Grains, &Rules, &Sweep, &Contacts),
    ) -> Result<()> {
        let mut frozen = vec![];
        find_frozen(w, &mut frozen);
        let masses = w.contact_masses();
        let grains = Grains { mass: &masses, ..grains(w, w.periods(), &[], &frozen)? };
        let tags = |p: &Pair| [p.i, p.j].map(|i| w.particles.tag[i as usize]);
        let (none, mut rest) = (Contacts::default(), list);
        let all = w.contacts.get(self.key).unwrap_or(&none);
        while let Some(last) = rest.get(BLOCK.min(rest.len()).wrapping_sub(1)).map(tags) {
            // Pairs stand in the order of their tags, those that meet in several images beside each other.
            let some;
            (some, rest) = rest.split_at(rest.partition_point(|p| tags(p) <= last));
            let mut memory = all.between(tags(&some[0]), last);
            self.sweep.run(some, &grains, &self.rules, &mut memory, still(w));
            read(&grains, &self.rules, &self.sweep, &memory);
        }
        Ok(())
    }

    /// Contact history, with springs that shrink no more.
    fn keep_shrunk(&self, w: &World, memory: &mut Contacts) {
        let p = &w.particles;
        let (index, width) = (Index::new(&p.tag), memory.width.max(1));
        let kind = |tag: u32| index.find(tag, &p.tag).map(|i| p.kind[i]);
        for ([a, b], history) in memory.keys.iter().zip(memory.history.chunks_exact_mut(width)) {
            let rule = kind(*a).zip(kind(*b)).and_then(|(a, b)| self.rules.get(a, b));
            rule.into_iter().for_each(|rule| rule.law.keep_shrunk(history));
        }
    }

    /// Pairs of spheres closer than the largest of their types, or than the explicit cutoff.
    fn within_cutoffs(&self, w: &World) -> Vec<Pair> {
        let touching = touching(w);
        let mut wanted = Wanted::new(w.types);
        for a in 1..=w.types as u16 {
            for b in a..=w.types as u16 {
                match self.wanted.get(a, b) {
                    Some(Reach::Touch) => wanted.set(a, b, Reach::Fixed(touching(a, b))),
                    Some(fixed) => wanted.set(a, b, fixed),
                    None => {}
                }
            }
        }
        near(w, &w.particles.x, &wanted, 0.0, &Allowed::felt(w))
    }
}

impl Probe for ContactProbe {
    fn name(&self) -> &'static str {
        self.key.text()
    }

    fn rolls(&self) -> Vec<Rolls> {
        let own =
            |(types, rule): ([u16; 2], &Rule)| Some(Rolls { of: self.key, types, at: rule.law.rolls_at()? });
        self.rules.pairs().filter_map(own).collect()
    }

    fn own(&self) -> usize {
        match self.own {
            Own::Granular => 12 + usize::from(conducts(&self.rules)),
            Own::Mdr => 13 + usize::from(conducts(&self.rules)),
            Own::Gran => 10,
        }
    }

    fn cutoff(&self, w: &World) -> Option<f64> {
        // With what contacts that hold span beyond touch.
        let (spans, touching) = (reaching(&self.rules, &self.wanted, w), touching(w));
        let types = 1..=w.types as u16;
        let pairs = types.clone().flat_map(|a| types.clone().map(move |b| (a, b)));
        let reach = pairs.filter_map(|(a, b)| {
            let touch = touching(a, b);
            spans.get(a, b).map(|reach| match reach {
                Reach::Touch => touch,
                Reach::Beyond(gap) => touch + gap,
                Reach::Fixed(r) => r,
            })
        });
        reach.reduce(f64::max)
    }

    fn listed(&self, w: &World) -> Result<Vec<[u32; 2]>> {
        Ok(self.list(w)?.iter().map(|p| [p.i, p.j]).collect())
    }

    fn look(&mut self, w: &World, request: Request, closely: bool) -> Result<Vec<Interaction>> {
        let p = &w.particles;
        let own = self.own;
        let warm = conducts(&self.rules).then(|| w.columns.property(*TEMPERATURE)).flatten();
        let (warm, last) = (warm.and_then(|key| w.columns.get_scalar(key)), self.own() - 1);
        let acting = self.evaluated(w, request, |grains, _, sweep, memory| {
            let mut all: Vec<_> =
                sweep.contacts().map(|(pair, wrench)| interaction(grains, pair, wrench)).collect();
            if !closely {
                return all;
            }
            let mut near: Vec<_> = sweep
                .contacts()
                .zip(&all)
                .map(|((pair, wrench), a)| close(grains, pair, wrench, a.d, own))
                .collect();
            for (c, row) in near.iter_mut().zip(memory.history.chunks_exact(memory.width.max(1))) {
                c.history.iter_mut().zip(row).for_each(|(to, from)| *to = *from);
                if own == Own::Mdr {
                    // In the evaluation data of such contacts the area stands before the energy at the end.
                    c.own[12] = row.iter().rev().nth(1).copied().unwrap_or(0.0);
                }
            }
            if let Some(temperature) = warm {
                near.iter_mut().zip(sweep.heat(temperature)).for_each(|(c, heat)| c.own[last] = heat);
            }
            all.iter_mut().zip(near).for_each(|(a, c)| a.close = Some(Box::new(c)));
            all
        })?;
        if request != Request::Idle {
            return Ok(acting);
        }
        let mut acting = acting.into_iter().peekable();
        let mut all = vec![];
        for pair in self.within_cutoffs(w) {
            let key = |i: u32, j: u32| (p.tag[i as usize], p.tag[j as usize]);
            while let Some(a) = acting.next_if(|a| key(a.i, a.j) < key(pair.i, pair.j)) {
                all.push(a);
            }
            let d = difference(&p.x, &w.periods(), &pair);
            all.push(match acting.next_if(|a| (a.i, a.j) == (pair.i, pair.j) && a.d == d) {
                Some(a) => a,
                None => Interaction { i: pair.i, j: pair.j, d, ..Interaction::default() },
            });
        }
        all.extend(acting);
        Ok(all)
    }

    fn springs(&mut self, w: &World, take: &mut dyn FnMut(Springs)) -> Result<()> {
        // Only what touches has any: a list for that alone is shorter than one that holds until the next rebuild.
        let list = match self.take_list(w) {
            Some(list) => list,
            None => self.within(w, &w.particles.x, 0.0)?,
        };
        let mut read = |grains: &Grains, rules: &Rules, sweep: &Sweep, memory: &Contacts| {
            sweep.each(grains, rules, memory, |c| {
                let g = &c.geometry;
                let [stiffness, damping] = c.law.resistance(g, c.history).map(|all| all.map(|k| c.share * k));
                take(Springs {
                    ends: [c.pair.i, c.pair.j],
                    normal: g.normal,
                    stiffness,
                    damping,
                    arms: g.radii.map(|r| r - 0.5 * g.overlap),
                });
            });
        };
        // What contacts of solids share depends on all of them.
        if self.rules.needs_bodies() || self.rules.any(|r| r.average != Average::None) {
            return self.swept(w, &list, Request::Acting, &mut read);
        }
        self.swept_in_blocks(w, &list, read)
    }

    fn pressed(&self, [a, b]: [u16; 2], overlap: f64, curvature: f64) -> Option<[f64; 3]> {
        let law = self.rules.get(a, b)?.law;
        if law.normal.by_mass() {
            return None;
        }
        let radii = [2.0 * curvature; 2];
        let g = Geometry { normal: [1.0, 0.0, 0.0], overlap, radii, curvature, mass: 1.0 };
        let fresh = vec![0.0; law.memory()];
        let stored = law.stored(&g, &fresh);
        Some([stored.push, law.springs(&g)[1], stored.normal])
    }

    fn held(&mut self, w: &World) -> Result<[f64; 2]> {
        self.evaluated(w, Request::Felt { setup: false }, |grains, rules, sweep, memory| {
            let mut sum = [0.0; 2];
            sweep.each(grains, rules, memory, |c| {
                let stored = c.law.stored(&c.geometry, c.history);
                sum[0] += c.share * stored.normal;
                sum[1] += c.share * stored.across;
            });
            sum
        })
    }
}

fn interaction(grains: &Grains, pair: &Pair, wrench: &Wrench) -> Interaction {
    let d = difference(grains.x, &grains.period, pair);
    Interaction { i: pair.i, j: pair.j, d, force: wrench.force, ..Interaction::default() }
}

/// What a style says of a contact of grains `d` apart beyond its force and memory.
fn close(grains: &Grains, pair: &Pair, wrench: &Wrench, d: Vec3, own: Own) -> Close {
    let (i, j) = (pair.i as usize, pair.j as usize);
    let distance = length(d);
    let n = scale(1.0 / distance, d);
    let across = sub(wrench.force, scale(dot(wrench.force, n), n));
    let mut numbers = [0.0; OWN];
    numbers[..3].copy_from_slice(&across);
    numbers[3] = length(across);
    match own {
        Own::Granular | Own::Mdr => {
            // What the torque has beyond that of the tangential force, which acts in the middle of the overlap.
            let radii = [grains.radius[i], grains.radius[j]];
            let overlap = radii[0] + radii[1] - distance;
            let rest = sub(wrench.torque_i, scale(radii[0] - 0.5 * overlap, cross(across, n)));
            // Rounding of torques that cancel is no torque.
            let torque = length(wrench.torque_i);
            let rest = if length(rest) > 1e-12 * torque { rest } else { [0.0; 3] };
            // The rolling torque is R n × F with R = R_i R_j / (R_i + R_j).
            let rolling = scale((radii[0] + radii[1]) / (radii[0] * radii[1]), cross(rest, n));
            numbers[4..7].copy_from_slice(&rolling);
            numbers[7] = length(rolling);
            numbers[8] = dot(rest, n);
            numbers[9..12].copy_from_slice(&d);
        }
        Own::Gran => {
            let relative = sub(grains.v[i], grains.v[j]);
            let along = scale(dot(relative, n), n);
            numbers[4..7].copy_from_slice(&along);
            numbers[7..10].copy_from_slice(&sub(relative, along));
        }
    }
    Close { own: numbers, torque: wrench.torque_i, ..Close::default() }
}
