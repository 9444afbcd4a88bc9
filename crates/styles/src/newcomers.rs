//! Particles that fixes create in the middle of a run: how they join, and the state such a fix keeps between runs.

use crate::words::Words;
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::rng::ParkMiller;
use perigrain_world::{GroupId, Numbers, World};
use std::f64::consts::PI;

/// A particle that joins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Newcomer {
    /// Its type.
    pub kind: u16,
    /// Where.
    pub x: [f64; 3],
    /// Its velocity.
    pub v: [f64; 3],
    /// Radius and density, where they are not LAMMPS' defaults of its atom style.
    pub size: Option<[f64; 2]>,
}

/// Puts newcomers behind the present particles, in `all` and a group, with ids from `tag` on; lists are rebuilt.
///
/// # Errors
/// More particles than there are ids.
pub fn admit(w: &mut World, group: GroupId, tag: u32, list: &[Newcomer]) -> Result<()> {
    if u32::try_from(list.len()).ok().and_then(|n| tag.checked_add(n)).is_none() {
        return fail(Code::TOO_LARGE, None, "more particles than there are ids");
    }
    if !list.is_empty() {
        w.fall_back();
    }
    for (tag, new) in (tag..).zip(list) {
        let p = &mut w.particles;
        p.push(tag, new.kind, new.x);
        let i = p.len() - 1;
        p.v[i] = new.v;
        p.mask[i] |= group.bit();
        if let (Some([radius, density]), true) = (new.size, p.style.sphere) {
            p.radius[i] = radius;
            p.density[i] = density;
            p.mass[i] = 4.0 * PI / 3.0 * radius * radius * radius * density;
        }
    }
    if !list.is_empty() {
        settle(w);
    }
    Ok(())
}

/// Whatever belongs to particles has them all, after some have joined.
pub fn settle(w: &mut World) {
    w.columns.resize(w.particles.len());
    w.spread_type_masses();
    w.slots.invalidate();
    w.rebuild.roster += 1;
}

/// Which ids newcomers get.
#[derive(Clone, Copy, Debug, Default, PartialEq, Words)]
#[word(what = "value of id")]
pub enum Ids {
    /// New ids continue from the largest one in use.
    #[default]
    Max,
    /// New ids continue from the last one that the fix gave (under `compat lammps` some twice where `create_atoms` makes particles in
    /// between, as in LAMMPS).
    Next,
}

impl Ids {
    /// The particle and the molecule ID before those of the next newcomer.
    pub fn before(self, w: &World, account: &Account) -> [u32; 2] {
        match self {
            Self::Max => [w.particles.last_tag(), w.particles.last_molecule()],
            Self::Next => account.last,
        }
    }
}

/// The state that a fix which creates or removes particles keeps from step to step.
#[derive(Clone, Debug, PartialEq)]
pub struct Account {
    /// How many particles so far.
    pub done: u64,
    /// The step it acts at next; none before its first run.
    pub next: Option<i64>,
    /// The step at which its region began to move.
    pub start: i64,
    /// The largest particle and molecule IDs when it was declared, then the last ones it gave away.
    pub last: [u32; 2],
    /// Its random stream.
    pub stream: ParkMiller,
}

/// How many random numbers LAMMPS' fixes that make or take particles throw away first.
const WARM_UP: usize = 30;

impl Account {
    /// That of a fix that begins.
    pub fn maker(w: &World, seed: u32) -> Self {
        let mut stream = ParkMiller::new(seed);
        stream.skip(WARM_UP);
        Self::new(w, stream)
    }

    /// A new one.
    pub fn new(w: &World, stream: ParkMiller) -> Self {
        let last = [w.particles.last_tag(), w.particles.last_molecule()];
        Self { done: 0, next: None, start: w.clock.step + 1, last, stream }
    }

    /// Reads it from the world.
    pub fn load(w: &World, key: Numbers) -> Option<Self> {
        let &[done, next, start, tag, molecule, state, spare] = w.memo.get(key)?.as_slice() else {
            return None;
        };
        Some(Self {
            done: done as u64,
            next: (!next.is_nan()).then_some(next as i64),
            start: start as i64,
            last: [tag as u32, molecule as u32],
            stream: ParkMiller::resumed([state, spare]),
        })
    }

    /// Keeps it in the world.
    pub fn store(&self, w: &mut World, key: Numbers) {
        let [state, spare] = self.stream.stand();
        let next = self.next.map_or(f64::NAN, |n| n as f64);
        let [tag, molecule] = self.last.map(f64::from);
        let list = vec![self.done as f64, next, self.start as f64, tag, molecule, state, spare];
        w.memo.insert(key, list);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_world::{AtomStyle, Key};

    #[test]
    fn what_is_kept_comes_back() {
        let mut w = World::default();
        let mut account = Account::new(&w, ParkMiller::new(4711));
        account.stream.gaussian();
        (account.done, account.last) = (3, [17, 2]);
        account.store(&mut w, Key::new("pour/ins"));
        assert_eq!(Account::load(&w, Key::new("pour/ins")), Some(account.clone()));
        account.next = Some(12);
        account.stream.gaussian();
        account.store(&mut w, Key::new("pour/ins"));
        assert_eq!(Account::load(&w, Key::new("pour/ins")), Some(account));
        assert_eq!(Account::load(&w, Key::new("pour/other")), None);
    }

    #[test]
    fn newcomers_have_their_columns() {
        let mut w = World::default();
        w.particles.style = AtomStyle { sphere: true, sphere_mass: true, ..AtomStyle::default() };
        w.columns.scalar(Key::new("own"), 0);
        let new = Newcomer { kind: 1, x: [1.0; 3], v: [0.0, 0.0, -1.0], size: Some([1.0, 3.0]) };
        admit(&mut w, GroupId(2), 8, &[new, Newcomer { size: None, ..new }]).unwrap();
        let p = &w.particles;
        assert_eq!((p.tag.as_slice(), p.mask[1], p.v[1][2]), (&[8, 9][..], 5, -1.0));
        // 4/3 π ρ, and LAMMPS' default sphere of diameter 1 and density 1.
        assert!((p.mass[0] - 4.0 * PI).abs() < 1e-14 && (p.mass[1] - PI / 6.0).abs() < 1e-15);
        assert!(w.columns.have(2) && w.rebuild.roster == 1);
        assert!(admit(&mut w, GroupId(2), u32::MAX, &[new]).is_err());
    }
}
