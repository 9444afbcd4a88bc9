//! How each field changes when particles are moved as one piece, and the functions that move them by that rule.
//!
//! [`field`](super::field) states for each field, the [`Registration`](super::Registration) of its owner for each vector column, what a
//! motion of matter does to it.
//! All code that moves particles as a whole follows these rules: [`World::carry`] where they are placed elsewhere between two
//! runs, [`Grip`] where something holds them while it moves, [`World::lay`] where they are created, [`World::shift_copies`] where
//! a scene is replicated. `docs/decisions/movers.md` has the table.

use super::columns::Columns;
use super::contacts::{Contacts, Rolls};
use super::named::Key;
use super::region::{Angle, turned};
use super::{AtomStyle, Named, Numbers, Particles, Vectors, World};
use perigrain_base::math::body::{Quat, UNTURNED, after, back, normalized, turn, turned as vector_turned};
use perigrain_base::math::vec3::{Vec3, add};
use perigrain_base::par;

/// What moving matter as one piece does to a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Under {
    /// Nothing: a number, a state of the whole scene, or a vector by axes that the particle itself carries.
    Nothing,
    /// Where a particle is: moved and turned.
    Place,
    /// How the matter of a particle lies in space: turned.
    Orientation,
    /// History of pairs that is a vector of space: turned where both particles are moved.
    Springs,
    /// How fast a particle moves and spins: whatever moves particles step by step sets it, and where they are put elsewhere between two
    /// runs it stays as the deck has it.
    Motion,
    /// Computed anew before anything reads it as that of the new place.
    Anew,
    /// Where something holds a particle or counts its way from: stays where particles are moved through space, and goes along where
    /// space with all in it is copied.
    Anchor,
    /// Values of one moment, kept as they were then.
    Record,
    /// History of pairs without direction, first that of one side, then that of the other, then what both have in common: nothing.
    Sides,
    /// Columns: see [`Key::under`].
    Columns,
}

/// A turn about an axis through a point.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    point: Vec3,
    axis: Vec3,
    angle: Angle,
    quat: Quat,
}

impl Turn {
    /// By an angle [rad] about an axis of unit length.
    pub fn new(point: Vec3, axis: Vec3, angle: f64) -> Self {
        Self { point, axis, angle: angle.into(), quat: turn(axis, angle) }
    }

    /// A place after it.
    pub fn place(&self, x: Vec3) -> Vec3 {
        turned(x, self.point, self.axis, self.angle)
    }

    /// A vector after it.
    pub fn vector(&self, v: Vec3) -> Vec3 {
        vector_turned(self.quat, v)
    }

    /// An orientation after it.
    pub fn orientation(&self, q: Quat) -> Quat {
        after(self.quat, q)
    }
}

impl World {
    /// Puts the particles for which `moved` holds elsewhere as one piece, with all that has a direction and belongs to their matter; how
    /// they move stays as it is. `rolls`: where contacts keep rolling displacements. LAMMPS leaves springs of contacts and dipole moments as
    /// they were, and so does `compat lammps`.
    pub fn carry(&mut self, turn: &Turn, rolls: &[Rolls], moved: impl Fn(usize) -> bool) {
        let members: Vec<usize> = (0..self.n()).filter(|&i| moved(i)).collect();
        let edges = self.edges();
        let turns = !self.settings.lammps();
        // Every part of a scene is named here, so that none can be added without a decision on how a turn changes it.
        let World {
            particles,
            columns,
            contacts,
            // `Under::Anchor`: walls stay where they are, and springs against them lie in walls.
            wall_contacts: _,
            // `Under::Nothing`: lengths, and vectors that the ends of bonds carry.
            bonds: _,
            // `Under::Nothing`: lengths and numbers; places at rest are compared with the present ones, whichever way these are turned.
            families: _,
            cracks: _,
            // `Under::Anew`.
            slots: _,
            tally: _,
            rebuild: _,
            travel: _,
            // Of no particle.
            clock: _,
            settings: _,
            domain: _,
            groups: _,
            lattice: _,
            regions: _,
            types: _,
            type_mass: _,
            memo: _,
            controls: _,
            templates: _,
            mixtures: _,
            materials: _,
            properties: _,
            folder: _,
            read_files: _,
            share: _,
            dealings: _,
            facts: _,
            changed: _,
            notes: _,
            outlines: _,
            promised: _,
            unseen: _,
            restored: _,
            resume: _,
        } = self;
        if turns {
            turn_springs(contacts, particles, turn, rolls, &members);
        }
        particles.carry(turn, &members, turns, |image| edges.shift(image.map(f64::from)));
        columns.carry(turn, &members);
    }

    /// Lets the particles from `first` on, which have just been made, lie as `q` turns them. Molecules of LAMMPS are made as if nothing had
    /// turned them, and so they are under `compat lammps`.
    pub fn lay(&mut self, first: usize, q: Quat) {
        if self.settings.lammps() || !self.particles.style.oriented {
            return;
        }
        for own in &mut self.particles.quat[first..] {
            *own = after(q, *own);
        }
    }

    /// Moves what the particles `of` are held to, or count their way from, by `shift`: they are copies of others that far away.
    pub fn shift_copies(&mut self, of: std::ops::Range<usize>, shift: Vec3) {
        let start = self.particles.x0.get_mut(of.clone()).into_iter().flatten();
        start.for_each(|x| *x = add(*x, shift));
        self.columns.shift(of, shift);
    }
}

impl Particles {
    /// Turns the members: see [`World::carry`]; `crossed` is how far away an image is, and `moments` turn along.
    fn carry(&mut self, turn: &Turn, members: &[usize], moments: bool, crossed: impl Fn([i32; 3]) -> Vec3) {
        // Every column is named, as above.
        let Particles {
            x,
            image,
            quat,
            mu,
            // `Under::Motion`.
            v: _,
            omega: _,
            // `Under::Anew`.
            f: _,
            torque: _,
            // `Under::Anchor`.
            x0: _,
            // `Under::Nothing`.
            style: _,
            tag: _,
            kind: _,
            mask: _,
            mass: _,
            radius: _,
            charge: _,
            volume: _,
            density: _,
            molecule: _,
            rank: _,
        } = self;
        for &i in members {
            x[i] = turn.place(add(x[i], crossed(image[i])));
            image.set(i, [0; 3]);
        }
        if !quat.is_empty() {
            members.iter().for_each(|&i| quat[i] = turn.orientation(quat[i]));
        }
        if moments && !mu.is_empty() {
            members.iter().for_each(|&i| mu[i] = turn.vector(mu[i]));
        }
    }
}

impl Columns {
    /// Turns what the members keep in columns: see [`World::carry`].
    fn carry(&mut self, turn: &Turn, members: &[usize]) {
        for (key, column) in self.vectors_mut() {
            match key.under() {
                Some(Under::Place) => members.iter().for_each(|&i| column[i] = turn.place(column[i])),
                Some(Under::Orientation | Under::Springs) => {
                    members.iter().for_each(|&i| column[i] = turn.vector(column[i]));
                }
                // The next run drops names from a restart file that no style registers.
                None
                | Some(
                    Under::Nothing
                    | Under::Motion
                    | Under::Anew
                    | Under::Anchor
                    | Under::Record
                    | Under::Sides
                    | Under::Columns,
                ) => {}
            }
        }
    }

    /// Whether a vector column turns with matter.
    fn turn_along(&self) -> bool {
        let along =
            |key: Vectors| matches!(key.under(), Some(Under::Place | Under::Orientation | Under::Springs));
        self.vector_keys().any(along)
    }

    /// Moves what belongs to a place in space: see [`World::shift_copies`].
    fn shift(&mut self, of: std::ops::Range<usize>, shift: Vec3) {
        let held = |key: Vectors| matches!(key.under(), Some(Under::Anchor | Under::Place));
        for (_, column) in self.vectors_mut().filter(|(key, _)| held(*key)) {
            column[of.clone()].iter_mut().for_each(|x| *x = add(*x, shift));
        }
    }
}

/// Turns the springs of contacts between two members, across the normal and against rolling.
fn turn_springs(
    contacts: &mut Named<Contacts>,
    particles: &Particles,
    turn: &Turn,
    rolls: &[Rolls],
    members: &[usize],
) {
    if contacts.values().all(Contacts::is_empty) {
        return;
    }
    let mut kinds: Vec<(u32, u16)> = members.iter().map(|&i| (particles.tag[i], particles.kind[i])).collect();
    kinds.sort_unstable();
    let kind = |tag: u32| kinds.binary_search_by_key(&tag, |(t, _)| *t).ok().map(|k| kinds[k].1);
    for (key, c) in contacts.iter_mut() {
        c.turn(key, rolls, |[a, b]| Some([kind(a)?, kind(b)?]), |v| turn.vector(v));
    }
}

/// How particles lie as seen from what holds them, in columns of one name: the real part of a quaternion and the others, and their dipole
/// moments. All four numbers are zero for those that nothing holds.
#[derive(Clone, Copy, Debug)]
pub struct Grip {
    real: Numbers,
    others: Vectors,
    moment: Vectors,
}

impl Grip {
    /// Under this name.
    pub fn new(name: &str) -> Self {
        let held = |name: &str| Key::new(name).moved(Under::Nothing);
        Self { real: Key::new(name), others: held(name), moment: held(&format!("{name}/moment")) }
    }

    /// The names of its columns.
    pub fn names(self) -> [&'static str; 2] {
        [self.real.text(), self.moment.text()]
    }

    /// Whether it holds particle `i`.
    pub fn holds(self, w: &World, i: usize) -> bool {
        self.of(&w.columns, i).is_some()
    }

    /// Takes hold of particle `i` as it lies now, `holder` being how that lies which holds it.
    pub fn take(self, w: &mut World, i: usize, holder: Quat) {
        let AtomStyle { oriented, dipole, .. } = w.particles.style;
        let lies = if oriented { w.particles.quat[i] } else { UNTURNED };
        let (n, [real, others @ ..]) = (w.n(), after(back(holder), lies));
        if dipole {
            let seen = vector_turned(back(holder), w.particles.mu[i]);
            w.columns.vector(self.moment, n)[i] = seen;
        }
        w.columns.scalar(self.real, n)[i] = real;
        w.columns.vector(self.others, n)[i] = others;
    }

    /// Lets go of everything.
    pub fn drop(self, w: &mut World) {
        w.columns.remove(self.real);
        w.columns.remove(self.others);
        w.columns.remove(self.moment);
    }

    /// Turns the particles that are held together with their holder, as `holder` defines for each: orientations, and dipole
    /// moments where these are `moments`.
    pub fn turn(
        self,
        particles: &mut Particles,
        columns: &Columns,
        moments: bool,
        holder: impl Fn(usize) -> Option<Quat> + Sync,
    ) {
        debug_assert!(!columns.turn_along(), "columns that turn with matter need a grip of their own");
        if let Some(seen) = columns.get_vector(self.moment).filter(|_| moments && particles.style.dipole) {
            par::each(&mut particles.mu[..], |first, mu: &mut [Vec3]| {
                for (k, mu) in mu.iter_mut().enumerate() {
                    if let (Some(_), Some(holder)) = (self.of(columns, first + k), holder(first + k)) {
                        *mu = vector_turned(holder, seen[first + k]);
                    }
                }
            });
        }
        if !particles.style.oriented {
            return;
        }
        par::each(&mut particles.quat[..], |first, quat: &mut [Quat]| {
            for (k, quat) in quat.iter_mut().enumerate() {
                if let Some((own, holder)) = self.of(columns, first + k).zip(holder(first + k)) {
                    *quat = normalized(after(holder, own));
                }
            }
        });
    }

    fn of(self, columns: &Columns, i: usize) -> Option<Quat> {
        let real = *columns.get_scalar(self.real)?.get(i)?;
        let [a, b, c] = *columns.get_vector(self.others)?.get(i)?;
        let own = [real, a, b, c];
        (own != [0.0; 4]).then_some(own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Registration;
    use std::f64::consts::FRAC_PI_2;

    static PLACES: Registration = Registration::moved("moving/place", "", Under::Place);
    static VECTORS: Registration = Registration::moved("moving/vector", "", Under::Orientation);
    static SPRINGS: Registration = Registration::moved("moving/spring", "", Under::Springs);
    static MOTIONS: Registration = Registration::moved("moving/motion", "", Under::Motion);
    static ANCHORS: Registration = Registration::moved("moving/anchor", "", Under::Anchor);
    static RECORDS: Registration = Registration::moved("moving/record", "", Under::Record);
    static OWN_AXES: Registration = Registration::moved("moving/own", "", Under::Nothing);
    static MADE_ANEW: Registration = Registration::moved("moving/anew", "", Under::Anew);

    /// A registration of each kind, with what a quarter turn about z through (1, 0, 0) and a copy 10 away in x make of (2, 3, 4).
    const KINDS: [(&Registration, &str, Vec3, Vec3); 8] = [
        (&PLACES, "moving/place", [-2.0, 1.0, 4.0], [12.0, 3.0, 4.0]),
        (&VECTORS, "moving/vector", [-3.0, 2.0, 4.0], [2.0, 3.0, 4.0]),
        (&SPRINGS, "moving/spring", [-3.0, 2.0, 4.0], [2.0, 3.0, 4.0]),
        (&MOTIONS, "moving/motion", [2.0, 3.0, 4.0], [2.0, 3.0, 4.0]),
        (&ANCHORS, "moving/anchor", [2.0, 3.0, 4.0], [12.0, 3.0, 4.0]),
        (&RECORDS, "moving/record", [2.0, 3.0, 4.0], [2.0, 3.0, 4.0]),
        (&OWN_AXES, "moving/own", [2.0, 3.0, 4.0], [2.0, 3.0, 4.0]),
        (&MADE_ANEW, "moving/anew", [2.0, 3.0, 4.0], [2.0, 3.0, 4.0]),
    ];

    fn scene() -> World {
        let mut w = World::default();
        (1..=2).for_each(|tag| w.particles.push(tag, 1, [2.0, 3.0, 4.0]));
        for (registration, name, ..) in KINDS {
            *w.columns.vector(registration.key(name), 2) = vec![[2.0, 3.0, 4.0]; 2];
        }
        w
    }

    fn near(a: Vec3, b: Vec3) -> bool {
        // Roundings of numbers up to 12.
        (0..3).all(|d| (a[d] - b[d]).abs() < 1e-14)
    }

    #[test]
    fn a_turn_does_to_each_column_what_is_registered() {
        let mut w = scene();
        w.carry(&Turn::new([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], FRAC_PI_2), &[], |i| i == 1);
        assert!(near(w.particles.x[1], KINDS[0].2));
        for (registration, name, moved, _) in KINDS {
            let column = w.columns.get_vector(registration.key(name)).unwrap();
            assert!(near(column[1], moved) && column[0] == [2.0, 3.0, 4.0], "{name}: {column:?}");
        }
    }

    #[test]
    fn a_copy_has_in_each_column_what_is_registered() {
        let mut w = scene();
        w.shift_copies(1..2, [10.0, 0.0, 0.0]);
        for (registration, name, _, copied) in KINDS {
            let column = w.columns.get_vector(registration.key(name)).unwrap();
            assert!(column == [[2.0, 3.0, 4.0], copied], "{name}: {column:?}");
        }
    }
}
