//! Ops that act on each particle by itself, one after the other on each block of particles while that is in fast memory.

use perigrain_base::math::body::Quat;
use perigrain_base::math::vec3::Vec3;
use perigrain_base::par::{self, CHUNK, Split};
use perigrain_world::{AtomStyle, Lent, Tracked, World};
use std::any::Any;
use std::ops::Range;

/// Most ops of one fused pass.
const MOST: usize = 6;
/// Particles of a block: what ops read and write of them fits the fastest memory.
const BLOCK: usize = 256;

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

/// What came of a block: sums, and a largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BlockSums {
    /// Sums over particles.
    pub sums: [f64; 3],
    /// The largest of something.
    pub most: f64,
}

impl BlockSums {
    fn join(self, other: Self) -> Self {
        Self { sums: std::array::from_fn(|k| self.sums[k] + other.sums[k]), most: self.most.max(other.most) }
    }
}

/// What an op does to one block.
struct Act(Does);

enum Does {
    /// In a pass of its own, but for what a motion can take into its pass.
    Alone(Box<dyn Alone>, Kind),
    /// Moves particles, with what stands beside it.
    Move(Box<dyn Together>),
}

/// Acts on a block by itself.
trait Alone: Any + Send + Sync {
    fn act(&self, block: &mut ParticleBlock) -> BlockSums;
}

impl<F: Fn(&mut ParticleBlock) -> BlockSums + Send + Sync + 'static> Alone for F {
    fn act(&self, block: &mut ParticleBlock) -> BlockSums {
        self(block)
    }
}

/// Moves the particles of a block: what came of a pull and a hold before, and of the motion itself.
trait Together: Any + Send + Sync {
    fn act(&self, block: &mut ParticleBlock, beside: &Beside) -> [BlockSums; 3];
}

impl<F: Fn(&mut ParticleBlock, &Beside) -> [BlockSums; 3] + Send + Sync + 'static> Together for F {
    fn act(&self, block: &mut ParticleBlock, beside: &Beside) -> [BlockSums; 3] {
        self(block, beside)
    }
}

/// What a motion has to know of an act to take it into its pass.
enum Kind {
    /// Nothing: it stays alone.
    Other,
    /// Adds forces m a.
    Pull(Pull),
    /// Sets forces and torques of particles with this group bit to zero.
    Hold(u32),
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
    /// At last all forces and torques are set to zero.
    pub clears: bool,
}

impl Act {
    /// What a motion has to know of it; nothing of a motion.
    fn kind(&self) -> &Kind {
        match &self.0 {
            Does::Alone(_, kind) => kind,
            Does::Move(_) => &Kind::Other,
        }
    }
}

/// Where an op's act stands from step to step: the next one of its kind takes its place, and no memory is asked for.
#[derive(Default)]
pub struct Room(Option<Act>);

impl Room {
    /// An act of whatever kind.
    pub fn act(&mut self, alone: impl Fn(&mut ParticleBlock) -> BlockSums + Send + Sync + 'static) {
        self.alone(Kind::Other, alone);
    }

    /// One that adds forces m a.
    pub fn pull(
        &mut self,
        pull: Pull,
        alone: impl Fn(&mut ParticleBlock) -> BlockSums + Send + Sync + 'static,
    ) {
        self.alone(Kind::Pull(pull), alone);
    }

    /// One that sets forces and torques of a group to zero.
    pub fn hold(
        &mut self,
        bit: u32,
        alone: impl Fn(&mut ParticleBlock) -> BlockSums + Send + Sync + 'static,
    ) {
        self.alone(Kind::Hold(bit), alone);
    }

    /// One that sets all forces and torques to zero.
    pub fn clear(&mut self) {
        self.alone(Kind::Clear, |s: &mut ParticleBlock<'_>| {
            s.f.fill([0.0; 3]);
            s.torque.fill([0.0; 3]);
            BlockSums::default()
        });
    }

    /// One that moves particles, and in the same pass does what stands beside it, with the bits that this has alone.
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

/// Acts one after the other, in the rooms where they stand.
#[derive(Clone, Copy)]
pub struct Acts<'a> {
    rooms: &'a [Room],
    which: &'a [usize],
}

impl<'a> Acts<'a> {
    /// Those in these rooms, which must not be empty.
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
enum Pass<'a> {
    /// An act alone, which is at this place.
    Alone(usize, &'a dyn Alone),
    /// What moves particles with what stands beside it, and the places of pull, hold and motion.
    Together(&'a dyn Together, Beside, [Option<usize>; 3]),
}

/// Acts in as few passes as can be: a motion takes a pull and then a hold right before it, and a clearing right behind.
struct Passes<'a> {
    acts: Acts<'a>,
    at: usize,
}

fn passes(acts: Acts<'_>) -> Passes<'_> {
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

/// Lets ops act on all blocks in fused passes; `came` becomes what came of each of them. Every particle sees the same as if the ops
/// acted one after the other.
pub fn fuse(w: &mut World, acts: Acts, came: &mut Vec<BlockSums>) {
    came.clear();
    for which in acts.which.chunks(MOST) {
        let (all, columns) = columns(w);
        let acts = Acts { which, ..acts };
        let whole = |start, rows| {
            let mut sums = [BlockSums::default(); MOST];
            chunk(acts, all, start, rows, &mut sums);
            sums
        };
        let sums = match columns.rows() {
            // Not through the hands of those who share out.
            n if n <= CHUNK => whole(0, columns),
            _ => par::reduce_each(columns, whole, join).unwrap_or_default(),
        };
        came.extend_from_slice(&sums[..which.len()]);
    }
}

type Columns<'a> = (Lent<'a, Vec3>, Lent<'a, Vec3>, Lent<'a, Vec3>, Turning<'a>);
/// Angular velocities and torques, where there are any, and orientations.
type Turning<'a> = Option<(Lent<'a, Vec3>, Lent<'a, Vec3>, Option<Lent<'a, Quat>>)>;

/// What ops read of all particles, and the columns that are cut.
fn columns(w: &mut World) -> (Known<'_>, Columns<'_>) {
    let p = &mut w.particles;
    let all = Known {
        style: p.style,
        mask: &p.mask,
        kind: &p.kind,
        radius: &p.radius,
        mass: &p.mass,
        type_mass: &w.type_mass,
    };
    let spins = p.omega.len() == p.x.len() && p.torque.len() == p.x.len();
    let oriented = p.quat.len() == p.x.len();
    let quat = oriented.then_some(p.quat.lend());
    let turned = spins.then_some((p.omega.lend(), p.torque.lend(), quat));
    (all, (p.x.lend(), p.v.lend(), p.f.lend(), turned))
}

/// All passes over one block after the other; what comes of each act is added.
fn chunk(acts: Acts, all: Known<'_>, mut start: usize, mut rest: Columns<'_>, sums: &mut [BlockSums; MOST]) {
    while rest.rows() > 0 {
        let n = rest.rows().min(BLOCK);
        let ((x, v, f, turned), later) = rest.cut(n);
        let (omega, torque, quat) = turned.unwrap_or_else(|| (Lent::none(), Lent::none(), None));
        let quat = quat.unwrap_or_else(Lent::none);
        let mut block = ParticleBlock { start, x, v, f, omega, torque, quat, all };
        for pass in passes(acts) {
            match pass {
                Pass::Alone(at, act) => sums[at] = sums[at].join(act.act(&mut block)),
                Pass::Together(act, beside, places) => {
                    let came = act.act(&mut block, &beside);
                    for (at, came) in places.into_iter().zip(came) {
                        let Some(at) = at else { continue };
                        sums[at] = sums[at].join(came);
                    }
                }
            }
        }
        (start, rest) = (start + n, later);
    }
}

fn join(a: [BlockSums; MOST], b: [BlockSums; MOST]) -> [BlockSums; MOST] {
    std::array::from_fn(|k| a[k].join(b[k]))
}

/// Room for who waits for forces, used again from step to step.
#[derive(Default)]
pub struct Waiting {
    /// Of each chunk, how many particles wait for forces.
    left: Vec<usize>,
    came: Vec<[BlockSums; MOST]>,
}

/// [`fuse`] by and by, as particles get all their forces.
pub struct FusedPass<'a> {
    acts: Acts<'a>,
    waiting: &'a mut Waiting,
}

impl<'a> FusedPass<'a> {
    /// With `n` particles that wait for forces; `None` if there are too many ops for one pass.
    pub fn new(acts: Acts<'a>, n: usize, waiting: &'a mut Waiting) -> Option<Self> {
        if acts.len() > MOST {
            return None;
        }
        waiting.left.clear();
        waiting.left.extend((0..n).step_by(CHUNK).map(|start| CHUNK.min(n - start)));
        waiting.came.clear();
        waiting.came.resize(waiting.left.len(), Default::default());
        Some(Self { acts, waiting })
    }

    /// These particles have all their forces; each is told once. Ops act on chunks in which nobody waits any more.
    pub fn ready(&mut self, w: &mut World, particles: Range<usize>) {
        let end = if particles.is_empty() { 0 } else { particles.end.div_ceil(CHUNK) };
        for k in particles.start / CHUNK..end {
            let rows = k * CHUNK..((k + 1) * CHUNK).min(w.n());
            self.waiting.left[k] -= particles.end.min(rows.end) - particles.start.max(rows.start);
            if self.waiting.left[k] == 0 {
                let (all, columns) = columns(w);
                let (_, from) = columns.cut(rows.start);
                let (own, _) = from.cut(rows.len());
                chunk(self.acts, all, rows.start, own, &mut self.waiting.came[k]);
            }
        }
    }

    /// When all particles have been told, `came` becomes what came of each op.
    pub fn finish(self, came: &mut Vec<BlockSums>) {
        debug_assert!(self.waiting.left.iter().all(|n| *n == 0), "somebody waits for forces still");
        let all = par::along_tree(&self.waiting.came, join).unwrap_or_default();
        came.clear();
        came.extend_from_slice(&all[..self.acts.len()]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Acts in rooms of their own.
    fn rooms(fill: &[&dyn Fn(&mut Room)]) -> Vec<Room> {
        let room = |fill: &&dyn Fn(&mut Room)| {
            let mut room = Room::default();
            fill(&mut room);
            room
        };
        fill.iter().map(room).collect()
    }

    /// Passes in a word each: the acts' places in a pass of a motion, `c` if it clears.
    fn told(fill: &[&dyn Fn(&mut Room)]) -> Vec<String> {
        let told = |pass: Pass| match pass {
            Pass::Alone(at, _) => format!("{at}"),
            Pass::Together(_, beside, places) => {
                let at: String = places.iter().flatten().map(|k| format!("{k}+")).collect();
                at + if beside.clears { "c" } else { "" }
            }
        };
        passes(Acts::new(&rooms(fill), &[0, 1, 2, 3, 4][..fill.len()])).map(told).collect()
    }

    #[test]
    fn a_motion_takes_what_stands_right_beside_it_in_this_order() {
        let none = |_: &mut ParticleBlock<'_>| BlockSums::default();
        let pull: &dyn Fn(&mut Room) = &|room| room.pull(Pull { bit: 1, a: [0.0; 3] }, none);
        let hold: &dyn Fn(&mut Room) = &|room| room.hold(2, none);
        let moving: &dyn Fn(&mut Room) = &|room| room.moving(|_, _| [BlockSums::default(); 3]);
        let other: &dyn Fn(&mut Room) = &|room| room.act(none);
        let clear: &dyn Fn(&mut Room) = &Room::clear;
        assert_eq!(told(&[pull, hold, moving, clear]), ["0+1+2+c"]);
        assert_eq!(told(&[hold, pull, moving, clear]), ["0", "1+2+c"]);
        assert_eq!(told(&[pull, pull, hold, moving]), ["0", "1+2+3+"]);
        assert_eq!(told(&[pull, other, moving, hold, clear]), ["0", "1", "2+", "3", "4"]);
        assert_eq!(told(&[pull, hold, clear, moving, moving]), ["0", "1", "2", "3+", "4+"]);
    }

    #[test]
    fn by_and_by_all_is_as_at_once() {
        let n = 3 * CHUNK + 77;
        let world = || {
            let mut w = World::default();
            let p = &mut w.particles;
            p.x = (0..n).map(|i| [1.0 / (i as f64 + 1.0), 0.5, -3.0]).collect();
            (p.v, p.f, *p.mask, p.tag) = (p.x.clone(), p.x.clone(), vec![1; n], (0..n as u32).collect());
            w
        };
        let push: &dyn Fn(&mut Room) = &|room| {
            room.act(|s: &mut ParticleBlock<'_>| {
                s.v.iter_mut().zip(s.f.iter()).for_each(|(v, f)| v[0] += 0.3 * f[0]);
                BlockSums { sums: [s.v.iter().map(|v| v[0]).sum(), 0.0, 0.0], most: s.v[0][0] }
            });
        };
        let rooms = rooms(&[push, &Room::clear]);
        let acts = Acts::new(&rooms, &[0, 1]);
        let (mut once, mut by_and_by) = (world(), world());
        let (mut came, mut later, mut waiting) = (vec![], vec![], Waiting::default());
        fuse(&mut once, acts, &mut came);
        let mut pass = FusedPass::new(acts, n, &mut waiting).unwrap();
        // In pieces that end anywhere, from the middle on, and with nobody.
        for piece in [5000..n, 5..5000, 7..7, 0..5] {
            let early = piece.start > 0;
            pass.ready(&mut by_and_by, piece);
            assert!(!early || by_and_by.particles.f[0] != [0.0; 3], "the first ones wait for forces");
        }
        pass.finish(&mut later);
        assert_eq!(later, came);
        assert_eq!(once.particles.v, by_and_by.particles.v);
        assert!(by_and_by.particles.f.iter().all(|f| *f == [0.0; 3]));
        assert!(FusedPass::new(Acts::new(&rooms, &[1; MOST + 1]), n, &mut waiting).is_none());
    }

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
        // One of another kind has a place of its own.
        let other = [3.0; 4];
        rooms[0].moving(move |_, _| [BlockSums { most: other[3], ..BlockSums::default() }; 3]);
        fuse(&mut w, Acts::new(&rooms, &[0]), &mut came);
        assert_eq!(came[0].most, 3.0);
    }
}
