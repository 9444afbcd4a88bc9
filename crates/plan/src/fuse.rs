//! Ops that act on each particle separately, run one after the other on each block of particles while it is in the cache.

use super::acts::{Acts, BlockSums, Known, ParticleBlock, Pass, passes};
use perigrain_base::math::body::Quat;
use perigrain_base::math::real::largest;
use perigrain_base::math::vec3::Vec3;
use perigrain_base::par::{self, CHUNK, Split};
use perigrain_world::{Lent, World};
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Most ops of one fused pass.
const MOST: usize = 6;
/// Particles of a block: what ops read and write of them fits the fastest cache.
const BLOCK: usize = 256;

/// Runs the ops on all blocks in fused passes; `came` receives the result of each op. Every particle sees the same as if the ops
/// acted one after the other.
pub fn fuse(w: &mut World, acts: Acts, came: &mut Vec<BlockSums>) {
    came.clear();
    if w.share.as_ref().is_some_and(|share| share.narrow) {
        return fuse_own(w, acts, came);
    }
    for which in acts.which.chunks(MOST) {
        let (all, columns) = columns(w);
        let acts = Acts { which, ..acts };
        let n = columns.rows();
        if n <= CHUNK {
            // A few particles need neither threads nor cutting into chunks.
            let mut sums = [BlockSums::default(); MOST];
            match n {
                0 => {}
                n if n <= BLOCK => block(acts, all, 0, columns, &mut sums),
                _ => chunk(acts, all, 0, columns, &mut sums),
            }
            came.extend_from_slice(&sums[..which.len()]);
            continue;
        }
        let whole = |start, rows| {
            let mut sums = [BlockSums::default(); MOST];
            chunk(acts, all, start, rows, &mut sums);
            sums
        };
        let sums = par::reduce_each(columns, whole, join).unwrap_or_default();
        came.extend_from_slice(&sums[..which.len()]);
    }
}

/// [`fuse`] on the rows of this rank, where other ranks have the rest. The result is the largest value of all ranks; no op reads
/// sums then.
fn fuse_own(w: &mut World, acts: Acts, came: &mut Vec<BlockSums>) {
    let Some(share) = w.share.take() else { return };
    for which in acts.which.chunks(MOST) {
        let (all, mut rest) = columns(w);
        let acts = Acts { which, ..acts };
        let (mut pieces, mut at) = (vec![], 0);
        for rows in &share.own {
            for start in rows.clone().step_by(CHUNK) {
                let end = rows.end.min(start + CHUNK);
                let (_, from) = rest.cut(start - at);
                let (own, later) = from.cut(end - start);
                pieces.push(Mutex::new(Some((start, own))));
                (rest, at) = (later, end);
            }
        }
        let most = Mutex::new([0.0f64; MOST]);
        par::for_rows(pieces.len(), |k| {
            let piece = pieces[k].lock().unwrap_or_else(PoisonError::into_inner).take();
            let Some((start, rows)) = piece else { return };
            let mut sums = [BlockSums::default(); MOST];
            chunk(acts, all, start, rows, &mut sums);
            let mut most = most.lock().unwrap_or_else(PoisonError::into_inner);
            most.iter_mut().zip(sums).for_each(|(most, own)| *most = largest(*most, own.most));
        });
        let most = most.into_inner().unwrap_or_else(PoisonError::into_inner);
        came.extend(which.iter().zip(most).map(|(_, most)| BlockSums { sums: [f64::NAN; 3], most }));
    }
    share.agree(came.iter_mut().map(|came| &mut came.most));
    w.share = Some(share);
}

type Columns<'a> = (Lent<'a, Vec3>, Lent<'a, Vec3>, Lent<'a, Vec3>, Turning<'a>);
/// Angular velocities and torques, where there are any, and orientations.
type Turning<'a> = Option<(Lent<'a, Vec3>, Lent<'a, Vec3>, Option<Lent<'a, Quat>>)>;

/// What ops read of all particles, and the columns that are cut.
#[inline]
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

/// Runs all passes over one block after the other and adds the results of each action.
fn chunk(acts: Acts, all: Known<'_>, mut start: usize, mut rest: Columns<'_>, sums: &mut [BlockSums; MOST]) {
    while rest.rows() > 0 {
        let n = rest.rows().min(BLOCK);
        let (own, later) = rest.cut(n);
        block(acts, all, start, own, sums);
        (start, rest) = (start + n, later);
    }
}

/// Runs all passes over a block and adds the results of each action.
#[inline(always)]
fn block(
    acts: Acts,
    all: Known<'_>,
    start: usize,
    (x, v, f, turned): Columns<'_>,
    sums: &mut [BlockSums; MOST],
) {
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
}

fn join(a: [BlockSums; MOST], b: [BlockSums; MOST]) -> [BlockSums; MOST] {
    std::array::from_fn(|k| a[k].join(b[k]))
}

/// The rows of a chunk that lie in this range.
fn chunk_of(k: usize, own: &Range<usize>) -> Range<usize> {
    let start = own.start.max(k * CHUNK);
    start..own.end.min((k + 1) * CHUNK).max(start)
}

/// Room for the particles that wait for forces, used again from step to step.
#[derive(Default)]
pub struct Waiting {
    /// How many particles of each chunk wait for forces.
    left: Vec<usize>,
    came: Vec<[BlockSums; MOST]>,
}

/// [`fuse`] piece by piece, as particles get all their forces.
pub struct FusedPass<'a> {
    acts: Acts<'a>,
    /// Rows that wait for forces: all, or those of this rank.
    own: Range<usize>,
    waiting: &'a mut Waiting,
}

impl<'a> FusedPass<'a> {
    /// Begins with the particles of these rows waiting for forces; `None` if there are too many ops for one pass.
    pub fn new(acts: Acts<'a>, own: Range<usize>, waiting: &'a mut Waiting) -> Option<Self> {
        if acts.len() > MOST {
            return None;
        }
        waiting.left.clear();
        waiting.left.extend((0..own.end.div_ceil(CHUNK)).map(|k| chunk_of(k, &own).len()));
        waiting.came.clear();
        waiting.came.resize(waiting.left.len(), Default::default());
        Some(Self { acts, own, waiting })
    }

    /// Marks particles that have all their forces, each once. Ops act on chunks in which no particle waits any more.
    pub fn ready(&mut self, w: &mut World, particles: Range<usize>) {
        let particles = particles.start.max(self.own.start)..particles.end.min(self.own.end);
        let end = if particles.is_empty() { 0 } else { particles.end.div_ceil(CHUNK) };
        for k in particles.start / CHUNK..end {
            let rows = chunk_of(k, &self.own);
            self.waiting.left[k] -= particles.end.min(rows.end) - particles.start.max(rows.start);
            if self.waiting.left[k] == 0 {
                let (all, columns) = columns(w);
                let (_, from) = columns.cut(rows.start);
                let (own, _) = from.cut(rows.len());
                chunk(self.acts, all, rows.start, own, &mut self.waiting.came[k]);
            }
        }
    }

    /// Once all particles are ready, puts the result of each op into `came`, as [`fuse`] does.
    pub fn finish(self, w: &World, came: &mut Vec<BlockSums>) {
        debug_assert!(self.waiting.left.iter().all(|n| *n == 0), "particles still wait for forces");
        let all = par::along_tree(&self.waiting.came, join).unwrap_or_default();
        came.clear();
        came.extend_from_slice(&all[..self.acts.len()]);
        if let Some(share) = w.narrow_share() {
            came.iter_mut().for_each(|came| came.sums = [f64::NAN; 3]);
            share.agree(came.iter_mut().map(|came| &mut came.most));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::acts::{Pull, Room};

    /// Acts in rooms of their own.
    fn rooms(fill: &[&dyn Fn(&mut Room)]) -> Vec<Room> {
        let room = |fill: &&dyn Fn(&mut Room)| {
            let mut room = Room::default();
            fill(&mut room);
            room
        };
        fill.iter().map(room).collect()
    }

    /// One word per pass: the places of the actions in a pass of a motion, `c` if it clears.
    fn pass_words(fill: &[&dyn Fn(&mut Room)]) -> Vec<String> {
        let word = |pass: Pass| match pass {
            Pass::Alone(at, _) => format!("{at}"),
            Pass::Together(_, beside, places) => {
                let at: String = places.iter().flatten().map(|k| format!("{k}+")).collect();
                at + if beside.clears { "c" } else { "" }
            }
        };
        passes(Acts::new(&rooms(fill), &[0, 1, 2, 3, 4][..fill.len()])).map(word).collect()
    }

    #[test]
    fn a_motion_takes_what_stands_right_beside_it_in_this_order() {
        let none = |_: &mut ParticleBlock<'_>| BlockSums::default();
        let pull: &dyn Fn(&mut Room) = &|room| room.pull(Pull { bit: 1, a: [0.0; 3] }, none);
        let hold: &dyn Fn(&mut Room) = &|room| room.hold(2, none);
        let flat: &dyn Fn(&mut Room) = &|room| room.flatten(4, none);
        let moving: &dyn Fn(&mut Room) = &|room| room.moving(|_, _| [BlockSums::default(); 3]);
        let other: &dyn Fn(&mut Room) = &|room| room.act(none);
        let clear: &dyn Fn(&mut Room) = &Room::clear;
        assert_eq!(pass_words(&[pull, hold, moving, clear]), ["0+1+2+c"]);
        assert_eq!(pass_words(&[hold, pull, moving, clear]), ["0", "1+2+c"]);
        // A flattening has no sum of its own.
        assert_eq!(pass_words(&[pull, hold, flat, moving, clear]), ["0+1+3+c"]);
        assert_eq!(pass_words(&[flat, moving, clear]), ["1+c"]);
        assert_eq!(pass_words(&[flat, hold, moving]), ["0", "1+2+"]);
        assert_eq!(pass_words(&[pull, pull, hold, moving]), ["0", "1+2+3+"]);
        assert_eq!(pass_words(&[pull, other, moving, hold, clear]), ["0", "1", "2+", "3", "4"]);
        assert_eq!(pass_words(&[pull, hold, clear, moving, moving]), ["0", "1", "2", "3+", "4+"]);
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
        let mut pass = FusedPass::new(acts, 0..n, &mut waiting).unwrap();
        // In pieces that end anywhere, from the middle on, one of them empty.
        for piece in [5000..n, 5..5000, 7..7, 0..5] {
            let early = piece.start > 0;
            pass.ready(&mut by_and_by, piece);
            assert!(!early || by_and_by.particles.f[0] != [0.0; 3], "the first ones wait for forces");
        }
        pass.finish(&by_and_by, &mut later);
        assert_eq!(later, came);
        assert_eq!(once.particles.v, by_and_by.particles.v);
        assert!(by_and_by.particles.f.iter().all(|f| *f == [0.0; 3]));
        assert!(FusedPass::new(Acts::new(&rooms, &[1; MOST + 1]), 0..n, &mut waiting).is_none());
        // Rows of other ranks stay as they were.
        let (mut some, own) = (world(), CHUNK + 9..2 * CHUNK + 5);
        let mut pass = FusedPass::new(acts, own.clone(), &mut waiting).unwrap();
        [0..CHUNK + 20, 2 * CHUNK..n, CHUNK + 20..2 * CHUNK]
            .into_iter()
            .for_each(|piece| pass.ready(&mut some, piece));
        pass.finish(&some, &mut later);
        let as_it_was = world();
        for row in 0..n {
            let of = if own.contains(&row) { &once } else { &as_it_was };
            assert_eq!(
                (some.particles.v[row], some.particles.f[row]),
                (of.particles.v[row], of.particles.f[row])
            );
        }
    }
}
