//! What ops do to blocks of particles, where each action is stored between steps, and which passes run them.

use perigrain_base::math::body::Quat;
use perigrain_base::math::vec3::Vec3;
use perigrain_world::{AtomStyle, Lent, Tracked};
use std::any::Any;

/// A block of particles as ops see it: columns they may write, cut to the block, and whole columns to read.
pub struct ParticleBlock<'a> {
    /// The first particle.
    pub start: usize,
    /// Positions.
    pub x: Lent<'a, Vec3>,
    /// Velocities.
    pub v: Lent<'a, Vec3>,
    /// Forces.
    pub f: Lent<'a, Vec3>,
    /// Angular velocities; empty where nothing spins.
    pub omega: Lent<'a, Vec3>,
    /// Torques; empty where nothing spins.
    pub torque: Lent<'a, Vec3>,
    /// Orientations; empty where particles have none.
    pub quat: Lent<'a, Quat>,
    /// What is read, of all particles.
    pub all: Known<'a>,
}

impl<'a> ParticleBlock<'a> {
    /// Group bits.
    #[inline]
    pub fn mask(&self) -> &'a [u32] {
        &self.all.mask[self.start..self.start + self.x.len()]
    }
}

/// What ops on blocks can read of all particles.
#[derive(Clone, Copy)]
pub struct Known<'a> {
    /// What particles have.
    pub style: AtomStyle,
    /// Group bits.
    pub mask: &'a Tracked<Vec<u32>>,
    /// Types.
    pub kind: &'a Tracked<Vec<u16>>,
    /// Radii.
    pub radius: &'a Tracked<Vec<f64>>,
    /// Masses, where each has its own.
    pub mass: &'a Tracked<Vec<f64>>,
    /// Masses by type.
    pub type_mass: &'a Tracked<Vec<Option<f64>>>,
}

/// The result of one block: sums, and a largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BlockSums {
    /// Sums over particles.
    pub sums: [f64; 3],
    /// The largest of something.
    pub most: f64,
}

impl BlockSums {
    pub(super) fn join(self, other: Self) -> Self {
        Self { sums: std::array::from_fn(|k| self.sums[k] + other.sums[k]), most: self.most.max(other.most) }
    }
}

/// What an op does to one block.
struct Act(Does);

enum Does {
    /// Runs in a pass of its own, unless a motion can take it into its pass.
    Alone(Box<dyn Alone>, Kind),
    /// Moves particles, together with the actions beside it.
    Move(Box<dyn Together>),
}

/// Acts on a block by itself.
pub(super) trait Alone: Any + Send + Sync {
    fn act(&self, block: &mut ParticleBlock) -> BlockSums;
}

impl<F: Fn(&mut ParticleBlock) -> BlockSums + Send + Sync + 'static> Alone for F {
    fn act(&self, block: &mut ParticleBlock) -> BlockSums {
        self(block)
    }
}

/// Moves the particles of a block. Returns the results of the pull, the hold and the motion itself.
pub(super) trait Together: Any + Send + Sync {
    fn act(&self, block: &mut ParticleBlock, beside: &Beside) -> [BlockSums; 3];
}

impl<F: Fn(&mut ParticleBlock, &Beside) -> [BlockSums; 3] + Send + Sync + 'static> Together for F {
    fn act(&self, block: &mut ParticleBlock, beside: &Beside) -> [BlockSums; 3] {
        self(block, beside)
    }
}

/// What a motion needs to know about an action to take it into its pass.
enum Kind {
    /// Nothing: the action runs alone.
    Other,
    /// Adds forces m a.
    Pull(Pull),
    /// Sets forces and torques of particles with this group bit to zero.
    Hold(u32),
    /// Takes from particles with this group bit what would move them out of the plane.
    Flatten(u32),
    /// Sets all forces and torques to zero.
    Clear,
}

/// An acceleration that particles of a group share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// Bit of the group.
    pub bit: u32,
    /// The acceleration [force/mass].
    pub a: Vec3,
}

/// What acts on particles right before and right after they are moved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Beside {
    /// First a pull.
    pub pull: Option<Pull>,
    /// Then forces and torques of particles with one of these group bits are set to zero.
    pub held: u32,
    /// Then velocities and forces along z, spins and torques across it, of particles with one of these group bits become zero.
    pub flat: u32,
    /// At last all forces and torques are set to zero.
    pub clears: bool,
}

impl Act {
    /// What a motion needs to know about this action; `Other` for a motion.
    fn kind(&self) -> &Kind {
        match &self.0 {
            Does::Alone(_, kind) => kind,
            Does::Move(_) => &Kind::Other,
        }
    }
}

/// Storage for an op's action between steps: the next action of the same kind reuses it, so no memory is allocated.
#[derive(Default)]
pub struct Room(Option<Act>);

impl Room {
    /// Stores an action of any kind.
    pub fn act(&mut self, alone: impl Fn(&mut ParticleBlock) -> BlockSums + Send + Sync + 'static) {
        self.alone(Kind::Other, alone);
    }

    /// Stores an action that adds forces m a.
    pub fn pull(
        &mut self,
        pull: Pull,
        alone: impl Fn(&mut ParticleBlock) -> BlockSums + Send + Sync + 'static,
    ) {
        self.alone(Kind::Pull(pull), alone);
    }

    /// Stores an action that sets forces and torques of a group to zero.
    pub fn hold(
        &mut self,
        bit: u32,
        alone: impl Fn(&mut ParticleBlock) -> BlockSums + Send + Sync + 'static,
    ) {
        self.alone(Kind::Hold(bit), alone);
    }

    /// Stores an action that keeps a group in the plane: no velocities and forces along z, no spins and torques across it.
    pub fn flatten(
        &mut self,
        bit: u32,
        alone: impl Fn(&mut ParticleBlock) -> BlockSums + Send + Sync + 'static,
    ) {
        self.alone(Kind::Flatten(bit), alone);
    }

    /// Stores an action that sets all forces and torques to zero.
    pub fn clear(&mut self) {
        self.alone(Kind::Clear, |s: &mut ParticleBlock<'_>| {
            s.f.fill([0.0; 3]);
            s.torque.fill([0.0; 3]);
            BlockSums::default()
        });
    }

    /// Stores a motion that performs the actions beside it in the same pass. The bits are the same as in passes of their own.
    pub fn moving<A>(&mut self, act: A)
    where
        A: Fn(&mut ParticleBlock, &Beside) -> [BlockSums; 3] + Send + Sync + 'static,
    {
        if let Some(Act(Does::Move(old))) = &mut self.0
            && let Some(old) = (&mut **old as &mut dyn Any).downcast_mut::<A>()
        {
            *old = act;
            return;
        }
        self.0 = Some(Act(Does::Move(Box::new(act))));
    }

    fn alone<A: Alone>(&mut self, kind: Kind, act: A) {
        if let Some(Act(Does::Alone(old, old_kind))) = &mut self.0
            && let Some(old) = (&mut **old as &mut dyn Any).downcast_mut::<A>()
        {
            (*old, *old_kind) = (act, kind);
            return;
        }
        self.0 = Some(Act(Does::Alone(Box::new(act), kind)));
    }
}

/// Actions in order, by the rooms they are stored in.
#[derive(Clone, Copy)]
pub struct Acts<'a> {
    pub(super) rooms: &'a [Room],
    pub(super) which: &'a [usize],
}

impl<'a> Acts<'a> {
    /// The actions stored in these rooms, which must not be empty.
    pub fn new(rooms: &'a [Room], which: &'a [usize]) -> Self {
        Self { rooms, which }
    }

    /// How many there are.
    pub fn len(self) -> usize {
        self.which.len()
    }

    /// Whether there are none.
    pub fn is_empty(self) -> bool {
        self.which.is_empty()
    }

    fn get(self, at: usize) -> Option<&'a Act> {
        self.rooms.get(*self.which.get(at)?)?.0.as_ref()
    }
}

/// One pass over a block.
pub(super) enum Pass<'a> {
    /// A single action and its place.
    Alone(usize, &'a dyn Alone),
    /// A motion with the actions beside it, and the places of pull, hold and motion.
    Together(&'a dyn Together, Beside, [Option<usize>; 3]),
}

/// Actions in as few passes as possible: a motion takes in a pull, a hold and a flattening right before it, in this order, and a
/// clearing right behind it.
pub(super) struct Passes<'a> {
    acts: Acts<'a>,
    at: usize,
}

pub(super) fn passes(acts: Acts<'_>) -> Passes<'_> {
    Passes { acts, at: 0 }
}

impl<'a> Iterator for Passes<'a> {
    type Item = Pass<'a>;

    fn next(&mut self) -> Option<Pass<'a>> {
        let (acts, at) = (self.acts, self.at);
        let act = acts.get(at)?;
        let (mut beside, mut places, mut k) = (Beside::default(), [None; 3], at);
        if let Kind::Pull(pull) = act.kind() {
            (beside.pull, places[0]) = (Some(*pull), Some(k));
            k += 1;
        }
        if let Some(Kind::Hold(bit)) = acts.get(k).map(Act::kind) {
            (beside.held, places[1]) = (*bit, Some(k));
            k += 1;
        }
        if let Some(Kind::Flatten(bit)) = acts.get(k).map(Act::kind) {
            // A flattening has no result.
            beside.flat = *bit;
            k += 1;
        }
        match (acts.get(k).map(|act| &act.0), &act.0) {
            (Some(Does::Move(together)), _) => {
                places[2] = Some(k);
                beside.clears = matches!(acts.get(k + 1).map(Act::kind), Some(Kind::Clear));
                self.at = k + 1 + usize::from(beside.clears);
                Some(Pass::Together(&**together, beside, places))
            }
            (_, Does::Alone(alone, _)) => {
                self.at += 1;
                Some(Pass::Alone(at, &**alone))
            }
            (_, Does::Move(_)) => unreachable!("a motion begins its own pass"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuse;
    use perigrain_world::World;

    #[test]
    fn an_act_takes_the_place_of_one_of_its_kind() {
        let place = |rooms: &[Room]| match &rooms[0].0.as_ref().unwrap().0 {
            Does::Alone(act, _) => std::ptr::from_ref(&**act).cast::<u8>(),
            Does::Move(act) => std::ptr::from_ref(&**act).cast::<u8>(),
        };
        let mut w = World::default();
        (w.particles.f, *w.particles.mask) = (vec![[0.0; 3]].into(), vec![1]);
        (w.particles.x, w.particles.v) = (w.particles.f.clone(), w.particles.f.clone());
        let (mut rooms, mut came) = ([Room::default()], vec![]);
        let push = |room: &mut Room, by: f64| {
            room.act(move |s: &mut ParticleBlock<'_>| {
                s.f[0][0] += by;
                BlockSums { most: by, ..BlockSums::default() }
            });
        };
        push(&mut rooms[0], 1.0);
        let at = place(&rooms);
        push(&mut rooms[0], 2.0);
        assert_eq!(place(&rooms), at);
        fuse(&mut w, Acts::new(&rooms, &[0]), &mut came);
        assert_eq!((w.particles.f[0][0], came[0].most), (2.0, 2.0));
        // An action of another kind has a place of its own.
        let other = [3.0; 4];
        rooms[0].moving(move |_, _| [BlockSums { most: other[3], ..BlockSums::default() }; 3]);
        fuse(&mut w, Acts::new(&rooms, &[0]), &mut came);
        assert_eq!(came[0].most, 3.0);
    }
}
