//! One step of rigid bodies and of their particles.

use super::follow::{Came, Follow, Holds};
use super::gravity::Weight;
use super::pass::{POSE, Part, Pass};
use super::ranks::Own;
use super::{COLUMNS, Declared, Keys};
use perigrain_base::math::body::{apply_transposed, matrix};
use perigrain_base::math::real::largest;
use perigrain_base::math::vec3::sub;
use perigrain_base::par;
use perigrain_plan::Tick;
use perigrain_styles::matter::Masses;
use perigrain_styles::rigid_bodies::{Body, WIDTH};
use perigrain_world::{Offers, SlotId, World};

/// Working data of a step: the members of each body, and the positions of the bodies.
pub struct Crew {
    /// List generation and number of particles for which the members are valid.
    seen: Option<(u64, usize)>,
    /// Index in `members` of each body's first member.
    pub first: Vec<usize>,
    /// Particle indices, body by body, in storage order.
    pub members: Vec<usize>,
    /// Poses of the bodies.
    poses: Vec<[f64; POSE]>,
    keys: Keys,
    /// The bodies of this rank, where it moves only its own.
    pub own: Own,
    /// Gravity on bodies as a whole.
    pub weight: Weight,
}

/// Half the virial of the constraint forces.
struct Held {
    total: [f64; 6],
    /// Per-particle parts, if requested.
    atoms: Vec<[f64; 6]>,
}

impl Crew {
    /// Without members.
    pub fn of(fix: &Declared) -> Self {
        Self {
            seen: None,
            first: vec![],
            members: vec![],
            poses: vec![],
            keys: fix.keys,
            own: Own::default(),
            weight: Weight::default(),
        }
    }

    /// The particles of body `k`.
    pub fn members(&self, k: usize) -> &[usize] {
        &self.members[self.first[k]..self.first[k + 1]]
    }

    /// Sorts the particles by body if their order may have changed; returns whether it may have.
    pub fn muster(&mut self, w: &World, bodies: usize) -> bool {
        let now = Some((w.rebuild.generation, w.n()));
        if self.seen == now && self.first.len() == bodies + 1 {
            return false;
        }
        self.seen = now;
        let number = w.columns.get_scalar(self.keys.body).unwrap_or_default();
        let mine = || {
            let body = |(i, k): (usize, &f64)| (i, *k as usize);
            number.iter().enumerate().map(body).filter(|(_, k)| (1..=bodies).contains(k))
        };
        self.first.clear();
        self.first.resize(bodies + 1, 0);
        mine().for_each(|(_, k)| self.first[k] += 1);
        for k in 0..bodies {
            self.first[k + 1] += self.first[k];
        }
        let mut next = self.first.clone();
        self.members.resize(self.first[bodies], 0);
        for (i, k) in mine() {
            self.members[next[k - 1]] = i;
            next[k - 1] += 1;
        }
        true
    }
}

impl Declared {
    /// First half kick, drift and rotation; the particles follow.
    pub fn advance(&self, w: &mut World, t: &Tick, crew: &mut Crew) {
        self.move_bodies(w, t, crew, Part::First);
        let tally = t.virial && self.virial;
        let held = self.follow(w, t, crew, true, tally);
        if tally {
            w.memo.insert(crew.keys.virial, held.total.to_vec());
        }
        if !held.atoms.is_empty() {
            for (d, key) in crew.keys.virials.into_iter().enumerate() {
                let own = held.atoms.iter().map(|v| [v[3 * d], v[3 * d + 1], v[3 * d + 2]]);
                *w.columns.vector(key, held.atoms.len()) = own.collect();
            }
        }
    }

    /// New forces on the bodies and the second half kick; in the setup of a run only the forces. The
    /// particles follow. Values for decks go to the slot.
    pub fn finish_step(&self, w: &mut World, t: &Tick, slot: SlotId, crew: &mut Crew) {
        self.move_bodies(w, t, crew, if t.setup { Part::Forces } else { Part::Second });
        let tally = t.virial && self.virial;
        let held = self.follow(w, t, crew, false, tally);
        if tally {
            let before = w.memo.remove(crew.keys.virial).filter(|_| !t.setup);
            for (k, total) in w.tally.fixes.iter_mut().enumerate() {
                // In the setup the other half of the step is assumed to be equal.
                *total += held.total[k] + before.as_ref().map_or(held.total[k], |v| v[k]);
            }
        }
        if !held.atoms.is_empty() {
            let [diagonal, others] =
                crew.keys.virials.map(|key| w.columns.get_vector(key).filter(|_| !t.setup));
            let before = |i: usize| {
                let rows = diagonal.and_then(|c| c.get(i)).zip(others.and_then(|c| c.get(i)));
                rows.map_or(held.atoms[i], |([a, b, c], [d, e, f])| [*a, *b, *c, *d, *e, *f])
            };
            for (i, (own, now)) in w.tally.atom_fixes.iter_mut().zip(&held.atoms).enumerate() {
                let before = before(i);
                (0..6).for_each(|k| own[k] += now[k] + before[k]);
            }
            crew.keys.virials.into_iter().for_each(|key| w.columns.remove(key));
        }
        if w.is_narrow() {
            return keep_quiet(w, t, slot);
        }
        let bodies = self.load(w);
        self.publish(w, t, slot, &bodies);
        self.book_in_ledger(w, crew, &bodies);
    }

    /// The end of a step and the beginning of the next one, when no virial is requested and nothing reads the
    /// velocities in between.
    pub fn begin_next(&self, w: &mut World, t: &Tick, slot: SlotId, crew: &mut Crew) {
        if w.is_narrow() || w.slots.get(slot).offers == Offers::default() {
            self.move_bodies(w, t, crew, Part::Both);
        } else {
            // Some op reads the values within the step.
            self.move_bodies(w, t, crew, Part::Second);
            self.publish(w, t, slot, &self.load(w));
            self.move_bodies(w, t, crew, Part::First);
        }
        self.follow(w, t, crew, true, false);
    }

    /// A part of a step for the bodies alone.
    fn move_bodies(&self, w: &mut World, t: &Tick, crew: &mut Crew, part: Part) {
        let Some(mut kept) = w.memo.get_mut(crew.keys.bodies).map(std::mem::take) else { return };
        let (rows, _) = kept.as_chunks_mut::<WIDTH>();
        if part.gathers() {
            crew.muster(w, rows.len());
        }
        crew.poses.resize(rows.len(), [0.0; POSE]);
        let own = w.is_narrow().then_some(&mut crew.own.room);
        let pass = Pass {
            fix: self,
            part,
            half: half(w, t),
            dt: t.dt,
            flat: w.settings.two_dimensional,
            lammps: w.settings.lammps(),
            edges: w.edges(),
            p: &w.particles,
            masses: Masses::of(w),
            pulls: crew.weight.accelerations(w),
            first: &crew.first,
            members: &crew.members,
            which: own.is_some().then_some(&crew.own.bodies[..]),
        };
        let all = (rows, &mut crew.poses[..]);
        match own {
            Some(room) => {
                room.move_some(&crew.own.bodies, all, |start, rows, poses| pass.bodies(start, rows, poses));
            }
            None => par::each(all, |start, (rows, poses)| pass.bodies(start, rows, poses)),
        }
        w.memo.insert(crew.keys.bodies, kept);
    }

    /// Sets velocities and spins of the particles from those of their bodies, and with `moving` positions and
    /// orientations too; if requested, sums half the virial of the constraint forces.
    fn follow(&self, w: &mut World, t: &Tick, crew: &Crew, moving: bool, tally: bool) -> Held {
        let half = half(w, t);
        let edges = w.edges();
        let p = &mut w.particles;
        let masses = Masses::new(p.style, &p.mass, &p.kind, &w.type_mass);
        let number = w.columns.get_scalar(crew.keys.body).unwrap_or_default();
        let place = w.columns.get_vector(crew.keys.place).unwrap_or_default();
        let n = number.len().min(place.len());
        let (share, all) = (w.share.as_ref().filter(|share| share.narrow), 0..n);
        let own = share.map_or(std::slice::from_ref(&all), |share| &share.own);
        let holds = tally.then_some(Holds { masses, f: &p.f, half });
        let follow = Follow { poses: &crew.poses, image: &p.image, edges, moving, holds };
        let mut atoms = vec![[0.0; 6]; if tally && t.atom_virial { n } else { 0 }];
        let both = |a: Came, b: Came| (par::add(a.0, b.0), largest(a.1, b.1));
        let mut came: Option<Came> = None;
        for rows in own.iter().map(|rows| rows.start..rows.end.min(n)).filter(|rows| !rows.is_empty()) {
            let some = || rows.clone();
            // Points do not turn.
            let turning = p.style.sphere.then(|| (&mut p.omega[some()], &p.radius[some()]));
            let virials = (!atoms.is_empty()).then(|| &mut atoms[some()]);
            let (x, v) = (&mut p.x[some()], &mut p.v[some()]);
            let columns = (x, v, turning, &number[some()], &place[some()], virials);
            let here =
                par::reduce_each(columns, |start, columns| follow.chunk(rows.start + start, columns), both);
            came = came.zip(here).map(|(a, b)| both(a, b)).or(came).or(here);
        }
        let (total, mut farthest) = came.unwrap_or_default();
        if moving {
            share.iter().for_each(|share| share.agree(std::iter::once(&mut farthest)));
            w.travel.went(farthest.sqrt());
            self.turn_members(w, crew);
        }
        Held { total, atoms }
    }

    /// Sets orientations and dipole moments of the particles from those of their bodies.
    fn turn_members(&self, w: &mut World, crew: &Crew) {
        if !w.particles.style.turns() {
            return;
        }
        let (rows, _) = w.memo.get(crew.keys.bodies).map_or(&[][..], Vec::as_slice).as_chunks::<WIDTH>();
        let number = w.columns.get_scalar(crew.keys.body).unwrap_or_default();
        let own = w.share.as_ref().filter(|share| share.narrow).map(|share| &share.own);
        let is_own = |i: usize| own.is_none_or(|own| own.iter().any(|rows| rows.contains(&i)));
        let body = |i: usize| {
            let row = rows.get((*number.get(i).filter(|_| is_own(i))? as usize).wrapping_sub(1))?;
            Some(Body::of(row).q)
        };
        crew.keys.turn.turn(&mut w.particles, &w.columns, true, body);
    }

    /// Sets velocities and spins of the particles from those of their bodies, outside of a run.
    pub fn carry(&self, w: &mut World) {
        let t = Tick::between_runs(&w.clock);
        let mut crew = Crew::of(self);
        self.move_bodies(w, &t, &mut crew, Part::Stand);
        self.follow(w, &t, &crew, false, false);
    }

    /// Publishes the values that decks can read.
    fn publish(&self, w: &mut World, t: &Tick, slot: SlotId, bodies: &[Body]) {
        let (flat, lammps) = (w.settings.two_dimensional, w.settings.lammps());
        let units = w.settings.units.constants();
        let edges = w.edges();
        let (mut moving, mut turning, mut freedom) = (0.0, 0.0, 0.0);
        for (k, b) in bodies.iter().enumerate() {
            // Disabled components count neither as motion nor as degrees of freedom; in the plane there is
            // one axis.
            let [moves, turns] = self.allowed(k, flat);
            let inner = apply_transposed(&matrix(b.q), b.omega);
            moving += (0..3).map(|d| moves[d] * b.mass * b.v[d] * b.v[d]).sum::<f64>();
            turning += (0..3)
                .map(|d| turns[if flat { 2 } else { d }] * b.moments[d] * inner[d] * inner[d])
                .sum::<f64>();
            let linear = !flat && b.moments.contains(&0.0);
            let all = if lammps && !self.whole { 6.0 } else { moves.iter().chain(&turns).sum() };
            freedom += f64::max(all - f64::from(u8::from(linear)), 0.0);
        }
        let temperature = match (moving + turning) * units.mvv2e / (freedom * units.boltz) {
            // LAMMPS' value is not a temperature.
            _ if lammps && self.style == "rigid/nve/small" => (moving + 0.5 * turning) * units.mvv2e,
            _ if freedom == 0.0 => 0.0,
            t => t,
        };
        let out = w.slots.get_mut(slot);
        out.step = Some(t.step);
        out.scalar = temperature;
        if !self.whole {
            return;
        }
        out.array.clear();
        out.array_cols = COLUMNS;
        for b in bodies {
            let x = sub(b.x, edges.shift(b.image));
            for part in [x, b.v, b.force, b.torque, b.image] {
                out.array.extend(part);
            }
        }
    }
}

/// Replaces `publish` where nothing reads the values: a rank knows only its own bodies.
fn keep_quiet(w: &mut World, t: &Tick, slot: SlotId) {
    let out = w.slots.get_mut(slot);
    (out.step, out.scalar) = (Some(t.step), f64::NAN);
}

/// Half a step in units that turn force/mass into velocity.
fn half(w: &World, t: &Tick) -> f64 {
    0.5 * t.dt * w.settings.units.constants().ftm2v
}
