//! Ops that act on each particle by itself, one after the other on each block of particles while that is in fast memory.

use perigrain_base::math::body::Quat;
use perigrain_base::math::vec3::Vec3;
use perigrain_base::par::{self, CHUNK, Split};
use perigrain_world::{AtomStyle, Lent, Tracked, World};
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
pub struct Act(Does);

enum Does {
    /// In a pass of its own, but for what a motion can take into its pass.
    Alone(Box<Alone>, Kind),
    /// Moves particles, with what stands beside it.
    Move(Box<Together>),
}

type Alone = dyn Fn(&mut ParticleBlock) -> BlockSums + Sync;
/// What came of a pull and a hold before, and of the motion itself.
type Together = dyn Fn(&mut ParticleBlock, &Beside) -> [BlockSums; 3] + Sync;

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
    fn of(kind: Kind, alone: impl Fn(&mut ParticleBlock) -> BlockSums + Sync + 'static) -> Self {
        Self(Does::Alone(Box::new(alone), kind))
    }

    /// An act of whatever kind.
    pub fn new(alone: impl Fn(&mut ParticleBlock) -> BlockSums + Sync + 'static) -> Self {
        Self::of(Kind::Other, alone)
    }

    /// One that adds forces m a.
    pub fn pull(pull: Pull, alone: impl Fn(&mut ParticleBlock) -> BlockSums + Sync + 'static) -> Self {
        Self::of(Kind::Pull(pull), alone)
    }

    /// One that sets forces and torques of a group to zero.
    pub fn hold(bit: u32, alone: impl Fn(&mut ParticleBlock) -> BlockSums + Sync + 'static) -> Self {
        Self::of(Kind::Hold(bit), alone)
    }

    /// One that sets all forces and torques to zero.
    pub fn clear() -> Self {
        Self::of(Kind::Clear, |s| {
            s.f.fill([0.0; 3]);
            s.torque.fill([0.0; 3]);
            BlockSums::default()
        })
    }

    /// One that moves particles, and in the same pass does what stands beside it, with the bits that this has alone.
    pub fn moving(act: impl Fn(&mut ParticleBlock, &Beside) -> [BlockSums; 3] + Sync + 'static) -> Self {
        Self(Does::Move(Box::new(act)))
    }

    /// What a motion has to know of it; nothing of a motion.
    fn kind(&self) -> &Kind {
        match &self.0 {
            Does::Alone(_, kind) => kind,
            Does::Move(_) => &Kind::Other,
        }
    }
}

/// One pass over a block.
enum Pass<'a> {
    /// An act alone, which is at this place.
    Alone(usize, &'a Alone),
    /// What moves particles with what stands beside it, and the places of pull, hold and motion.
    Together(&'a Together, Beside, [Option<usize>; 3]),
}

/// Acts in as few passes as can be: a motion takes a pull and then a hold right before it, and a clearing right behind.
fn passes(acts: &[Act]) -> Vec<Pass<'_>> {
    let mut passes = vec![];
    let mut at = 0;
    while let Some(act) = acts.get(at) {
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
                at = k + 1 + usize::from(beside.clears);
                passes.push(Pass::Together(&**together, beside, places));
            }
            (_, Does::Alone(alone, _)) => {
                passes.push(Pass::Alone(at, &**alone));
                at += 1;
            }
            (_, Does::Move(_)) => unreachable!("a motion begins its own pass"),
        }
    }
    passes
}

/// Lets ops act on all blocks in fused passes; what came of each of them. Every particle sees the same as if the ops acted one
/// after the other.
pub fn fuse(w: &mut World, acts: &[Act]) -> Vec<BlockSums> {
    acts.chunks(MOST).flat_map(|acts| some(w, acts).into_iter().take(acts.len())).collect()
}

fn some(w: &mut World, acts: &[Act]) -> [BlockSums; MOST] {
    let passes = passes(acts);
    let (all, columns) = columns(w);
    par::reduce_each(columns, |start, rows| chunk(&passes, all, start, rows), join).unwrap_or_default()
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

/// All passes over one block after the other.
fn chunk(passes: &[Pass<'_>], all: Known<'_>, mut start: usize, mut rest: Columns<'_>) -> [BlockSums; MOST] {
    let mut sums = [BlockSums::default(); MOST];
    while rest.rows() > 0 {
        let n = rest.rows().min(BLOCK);
        let ((x, v, f, turned), later) = rest.cut(n);
        let (omega, torque, quat) = turned.unwrap_or_else(|| (Lent::none(), Lent::none(), None));
        let quat = quat.unwrap_or_else(Lent::none);
        let mut block = ParticleBlock { start, x, v, f, omega, torque, quat, all };
        let mut came = [BlockSums::default(); MOST];
        for pass in passes {
            match pass {
                Pass::Alone(at, act) => came[*at] = act(&mut block),
                Pass::Together(act, beside, places) => {
                    let all = act(&mut block, beside);
                    places.iter().zip(all).for_each(|(at, sums)| at.iter().for_each(|at| came[*at] = sums));
                }
            }
        }
        (sums, start, rest) = (join(sums, came), start + n, later);
    }
    sums
}

fn join(a: [BlockSums; MOST], b: [BlockSums; MOST]) -> [BlockSums; MOST] {
    std::array::from_fn(|k| a[k].join(b[k]))
}

/// [`fuse`] by and by, as particles get all their forces.
pub struct FusedPass<'a> {
    acts: usize,
    passes: Vec<Pass<'a>>,
    /// Of each chunk, how many particles wait for forces.
    waiting: Vec<usize>,
    came: Vec<[BlockSums; MOST]>,
}

impl<'a> FusedPass<'a> {
    /// With `n` particles that wait for forces; `None` if there are too many ops for one pass.
    pub fn new(acts: &'a [Act], n: usize) -> Option<Self> {
        let waiting: Vec<usize> = (0..n).step_by(CHUNK).map(|start| CHUNK.min(n - start)).collect();
        let came = vec![[BlockSums::default(); MOST]; waiting.len()];
        (acts.len() <= MOST).then(|| Self { acts: acts.len(), passes: passes(acts), waiting, came })
    }

    /// These particles have all their forces; each is told once. Ops act on chunks in which nobody waits any more.
    pub fn ready(&mut self, w: &mut World, particles: Range<usize>) {
        let end = if particles.is_empty() { 0 } else { particles.end.div_ceil(CHUNK) };
        for k in particles.start / CHUNK..end {
            let rows = k * CHUNK..((k + 1) * CHUNK).min(w.n());
            self.waiting[k] -= particles.end.min(rows.end) - particles.start.max(rows.start);
            if self.waiting[k] == 0 {
                let (all, columns) = columns(w);
                let (_, from) = columns.cut(rows.start);
                let (own, _) = from.cut(rows.len());
                self.came[k] = chunk(&self.passes, all, rows.start, own);
            }
        }
    }

    /// What came of each op when all particles have been told.
    pub fn finish(self) -> Vec<BlockSums> {
        debug_assert!(self.waiting.iter().all(|n| *n == 0), "somebody waits for forces still");
        let all = par::along_tree(&self.came, join).unwrap_or_default();
        all.into_iter().take(self.acts).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Passes in a word each: the acts' places in a pass of a motion, `c` if it clears.
    fn told(acts: &[Act]) -> Vec<String> {
        let told = |pass: &Pass| match pass {
            Pass::Alone(at, _) => format!("{at}"),
            Pass::Together(_, beside, places) => {
                let at: String = places.iter().flatten().map(|k| format!("{k}+")).collect();
                at + if beside.clears { "c" } else { "" }
            }
        };
        passes(acts).iter().map(told).collect()
    }

    #[test]
    fn a_motion_takes_what_stands_right_beside_it_in_this_order() {
        let none = |_: &mut ParticleBlock<'_>| BlockSums::default();
        let pull = || Act::pull(Pull { bit: 1, a: [0.0; 3] }, none);
        let hold = || Act::hold(2, none);
        let moving = || Act::moving(|_, _| [BlockSums::default(); 3]);
        assert_eq!(told(&[pull(), hold(), moving(), Act::clear()]), ["0+1+2+c"]);
        assert_eq!(told(&[hold(), pull(), moving(), Act::clear()]), ["0", "1+2+c"]);
        assert_eq!(told(&[pull(), pull(), hold(), moving()]), ["0", "1+2+3+"]);
        assert_eq!(
            told(&[pull(), Act::new(none), moving(), hold(), Act::clear()]),
            ["0", "1", "2+", "3", "4"]
        );
        assert_eq!(told(&[pull(), hold(), Act::clear(), moving(), moving()]), ["0", "1", "2", "3+", "4+"]);
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
        let acts = [
            Act::new(|s| {
                s.v.iter_mut().zip(s.f.iter()).for_each(|(v, f)| v[0] += 0.3 * f[0]);
                BlockSums { sums: [s.v.iter().map(|v| v[0]).sum(), 0.0, 0.0], most: s.v[0][0] }
            }),
            Act::clear(),
        ];
        let (mut once, mut by_and_by) = (world(), world());
        let came = fuse(&mut once, &acts);
        let mut pass = FusedPass::new(&acts, n).unwrap();
        // In pieces that end anywhere, from the middle on, and with nobody.
        for piece in [5000..n, 5..5000, 7..7, 0..5] {
            let early = piece.start > 0;
            pass.ready(&mut by_and_by, piece);
            assert!(!early || by_and_by.particles.f[0] != [0.0; 3], "the first ones wait for forces");
        }
        assert_eq!(pass.finish(), came);
        assert_eq!(once.particles.v, by_and_by.particles.v);
        assert!(by_and_by.particles.f.iter().all(|f| *f == [0.0; 3]));
        let many: Vec<Act> = (0..=MOST).map(|_| Act::clear()).collect();
        assert!(FusedPass::new(&many, n).is_none());
    }
}
