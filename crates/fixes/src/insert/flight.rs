//! Grains of a stream on their way to the face: they fly straight, free of all forces, and are let go where they pass it.

use super::Inserting;
use super::clumps::launch;
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{Vec3, add, dot, length, scale, sub};
use perigrain_plan::{
    About, Acts, BlockSums, Needs, Op, ParticleBlock, Room, Span as Rows, Stage, Tick, Way, fuse,
};
use perigrain_world::field::{BOX, COLUMNS, F, LISTS, MEMO, OMEGA, RIGID, TAG, TORQUE, TRAVEL, V, X};
use perigrain_world::{Numbers, World};
use std::ops::Range;
use std::sync::Arc;

/// A grain on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Its id.
    pub tag: u32,
    /// Where it passes the face.
    pub foot: Vec3,
    /// How far that is [length].
    pub left: f64,
    /// Its velocity from then on.
    pub v: Vec3,
    /// Its angular velocity from then on.
    pub omega: Vec3,
}

/// Numbers of a grain in the world's memory.
const NUMBERS: usize = 11;

impl Held {
    fn of(row: &[f64]) -> Self {
        let three = |k: usize| [row[k], row[k + 1], row[k + 2]];
        Self { tag: row[0] as u32, foot: three(1), left: row[4], v: three(5), omega: three(8) }
    }

    fn row(self) -> [f64; NUMBERS] {
        let ([x, y, z], [u, v, w], [a, b, c]) = (self.foot, self.v, self.omega);
        [f64::from(self.tag), x, y, z, self.left, u, v, w, a, b, c]
    }

    /// Adds grains to those on their way; their ids begin with `first`, which a grain that is gone may have had.
    pub fn add(w: &mut World, key: Numbers, first: u32, more: impl Iterator<Item = Held>) {
        let rows = w.memo.get_or(key, Vec::new);
        let before = rows.chunks_exact(NUMBERS).take_while(|row| (row[0] as u32) < first).count();
        rows.truncate(before * NUMBERS);
        more.for_each(|held| rows.extend(held.row()));
    }
}

/// Which of its two ops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    /// After the drift: places.
    Flies,
    /// After forces: takes them, and lets grains go.
    Holds,
}

/// An op that moves or holds the grains on their way.
pub struct Flight {
    name: String,
    part: Part,
    key: Numbers,
    normal: Vec3,
    speed: f64,
    /// Keys of the bodies of grains of several spheres, and of the column with the number of each particle's body.
    movers: Vec<(Numbers, Numbers)>,
    /// Places of the grains in storage, in the order of the memory.
    rows: Vec<Option<usize>>,
    /// The same places in ascending order.
    ascending: Arc<[u32]>,
    /// For which particles in which places that is.
    stands: Option<[u64; 2]>,
}

/// Grains that are let go: place in storage, velocity, angular velocity.
type Going = Vec<(usize, Vec3, Vec3)>;

impl Flight {
    /// The ops of a stream that flies along `normal`.
    pub fn ops(fix: &Inserting, normal: Vec3, speed: f64, movers: &[(Numbers, Numbers)]) -> Vec<Box<dyn Op>> {
        let key: Numbers = fix.key().with("/held");
        let op = |part, what: &str| -> Box<dyn Op> {
            let name = format!("fix {} insert: {what}", fix.id);
            Box::new(Self {
                name,
                part,
                key,
                normal,
                speed,
                movers: movers.to_vec(),
                rows: vec![],
                ascending: Arc::new([]),
                stands: None,
            })
        };
        vec![op(Part::Flies, "flight"), op(Part::Holds, "hold")]
    }

    /// Whether no grain is on its way.
    fn is_empty(&self, w: &World) -> bool {
        w.memo.get(self.key).is_none_or(Vec::is_empty)
    }

    /// Finds the grains in storage, where particles have come, gone or changed places; those that are gone are forgotten, and when a run
    /// begins also those that have been put elsewhere or have other ids now.
    fn find(&mut self, w: &mut World, t: &Tick) {
        let now = [w.rebuild.roster, w.rebuild.places];
        let Some(held) = w.memo.get(self.key) else { return };
        if self.stands == Some(now) && self.rows.len() * NUMBERS == held.len() {
            return;
        }
        let mut held = held.clone();
        let tags: Vec<u32> = held.chunks_exact(NUMBERS).map(|row| row[0] as u32).collect();
        self.rows = vec![None; tags.len()];
        let (first, last) = (tags.first().copied(), tags.last().copied());
        for (i, tag) in w.particles.tag.iter().enumerate() {
            if Some(*tag) < first || Some(*tag) > last {
                continue;
            }
            if let Ok(k) = tags.binary_search(tag) {
                self.rows[k] = Some(i);
            }
        }
        if t.setup {
            let stands = |row: &[f64], i: usize| {
                let grain = Held::of(row);
                let off = sub(self.place(&grain), w.particles.x[i]);
                let off = w.domain.as_ref().map_or(off, |domain| domain.minimum_image(off));
                length(off) <= 2.0 * self.speed * t.dt
            };
            let places = held.chunks_exact(NUMBERS).zip(&self.rows);
            self.rows = places.map(|(row, place)| place.filter(|i| stands(row, *i))).collect();
        }
        if self.rows.contains(&None) {
            let kept = held.chunks_exact(NUMBERS).zip(&self.rows).filter(|(_, row)| row.is_some());
            held = kept.flat_map(|(held, _)| held.iter().copied()).collect();
            self.rows.retain(Option::is_some);
            w.memo.insert(self.key, held);
        }
        self.stands = Some(now);
        self.line_up();
    }

    /// Keeps the places in ascending order as well.
    fn line_up(&mut self) {
        let mut ascending: Vec<u32> = self.rows.iter().flatten().map(|i| *i as u32).collect();
        ascending.sort_unstable();
        self.ascending = ascending.into();
    }

    /// Where a grain is by its way.
    fn place(&self, grain: &Held) -> Vec3 {
        add(grain.foot, scale(-grain.left, self.normal))
    }

    /// Brings each grain to its place at the end of this step.
    fn fly(&self, w: &mut World, t: &Tick) {
        let way = self.speed * t.dt;
        let narrow = w.is_narrow();
        let own: Vec<Range<usize>> = if narrow { w.moved_in(0..w.n()).collect() } else { vec![] };
        let World { memo, particles, domain, travel, .. } = w;
        let Some(held) = memo.get_mut(self.key) else { return };
        let mut farthest = if narrow { 4.0 * way * way } else { 0.0_f64 };
        for (row, i) in held.chunks_exact_mut(NUMBERS).zip(&self.rows) {
            row[4] -= way;
            let Some(i) = i.filter(|i| !narrow || own.iter().any(|rows| rows.contains(i))) else { continue };
            let place = self.place(&Held::of(row));
            let x = &mut particles.x[i];
            let off = sub(place, *x);
            let square = dot(off, off);
            if square <= 4.0 * way * way {
                *x = place;
                farthest = farthest.max(square);
                continue;
            }
            // Where it has been wrapped since, it flies as that image.
            let near = domain.as_ref().map_or(off, |domain| domain.minimum_image(off));
            *x = add(*x, near);
            farthest = farthest.max(dot(near, near));
        }
        travel.went(farthest.sqrt());
    }

    /// The grains that pass the face in the next step.
    fn going(&self, w: &World, t: &Tick) -> Going {
        let held = w.memo.get(self.key).map_or(&[][..], Vec::as_slice).chunks_exact(NUMBERS);
        let goes = held.zip(&self.rows).filter(|(row, _)| row[4] < self.speed * t.dt);
        goes.filter_map(|(row, i)| i.map(|i| (i, Held::of(row)))).map(|(i, h)| (i, h.v, h.omega)).collect()
    }

    /// Forgets the grains that pass the face in the next step.
    fn let_go(&mut self, w: &mut World, t: &Tick) {
        let Some(held) = w.memo.get_mut(self.key) else { return };
        let least = self.speed * t.dt;
        if held.chunks_exact(NUMBERS).all(|row| row[4] >= least) {
            return;
        }
        if !self.movers.is_empty() {
            let go = held.chunks_exact(NUMBERS).zip(&self.rows).filter(|(row, _)| row[4] < least);
            let go: Vec<(Held, usize)> = go.filter_map(|(row, i)| i.map(|i| (Held::of(row), i))).collect();
            for (grain, i) in go {
                launch(w, &self.movers, i, self.place(&grain), grain.v, grain.omega);
            }
        }
        let Some(held) = w.memo.get_mut(self.key) else { return };
        let stays: Vec<bool> = held.chunks_exact(NUMBERS).map(|row| row[4] >= least).collect();
        let kept = held.chunks_exact(NUMBERS).zip(&stays).filter(|(_, stays)| **stays);
        let kept: Vec<f64> = kept.flat_map(|(row, _)| row.iter().copied()).collect();
        *held = kept;
        let mut stays = stays.into_iter();
        self.rows.retain(|_| stays.next().unwrap_or(false));
        self.line_up();
    }

    /// Takes the forces from the grains in a run's setup, in which none is let go.
    fn hold(&self, w: &mut World) {
        let flies = scale(self.speed, self.normal);
        let p = &mut w.particles;
        for i in self.rows.iter().flatten().copied() {
            (p.f[i], p.torque[i]) = ([0.0; 3], [0.0; 3]);
            (p.v[i], p.omega[i]) = (flies, [0.0; 3]);
        }
    }
}

/// Takes the forces from grains at these places, and gives those that are let go their own velocities.
fn act(block: &mut ParticleBlock<'_>, ascending: &[u32], going: &Going) {
    let rows = block.start..block.start + block.x.len();
    let first = ascending.partition_point(|i| (*i as usize) < rows.start);
    for i in ascending[first..].iter().map(|i| *i as usize).take_while(|i| *i < rows.end) {
        let k = i - rows.start;
        (block.f[k], block.torque[k]) = ([0.0; 3], [0.0; 3]);
    }
    for (i, v, omega) in going.iter().filter(|(i, ..)| rows.contains(i)) {
        (block.v[i - rows.start], block.omega[i - rows.start]) = (*v, *omega);
    }
}

impl Op for Flight {
    fn about(&self) -> About {
        let mut needs = Needs::new().read(TAG | BOX | LISTS).keep(MEMO).only(&[self.key.text()]);
        if self.part == Part::Holds && !self.movers.is_empty() {
            let names: Vec<&'static str> =
                self.movers.iter().flat_map(|(a, b)| [a.text(), b.text()]).collect();
            needs = needs.read(COLUMNS).keep(RIGID).only(&names);
        }
        match self.part {
            Part::Flies => About {
                reports_travel: true,
                ..About::new(&self.name, Stage::PostIntegrate, needs.write(X).keep(TRAVEL))
            },
            Part::Holds => About {
                fuses: true,
                ..About::new(&self.name, Stage::PostForce, needs.read(X).write(V | F | TORQUE | OMEGA))
            },
        }
    }
    fn span(&mut self, _: &mut World, _: &Tick) -> Rows {
        Rows::Own
    }
    fn way(&mut self, w: &mut World, t: &Tick, room: &mut Room) -> Way {
        if t.unchanged || self.is_empty(w) {
            return Way::Rests;
        }
        if self.part == Part::Flies {
            return Way::Alone;
        }
        self.find(w, t);
        let (ascending, going) = (self.ascending.clone(), self.going(w, t));
        room.act(move |block: &mut ParticleBlock<'_>| {
            act(block, &ascending, &going);
            BlockSums::default()
        });
        Way::Blocks
    }
    fn fused(&mut self, w: &mut World, t: &Tick, _: BlockSums) {
        self.let_go(w, t);
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if t.unchanged || self.is_empty(w) {
            return Ok(());
        }
        self.find(w, t);
        match self.part {
            Part::Flies => self.fly(w, t),
            Part::Holds if t.setup => self.hold(w),
            Part::Holds => {
                let mut room = Room::default();
                if self.way(w, t, &mut room) == Way::Blocks {
                    fuse(w, Acts::new(std::slice::from_ref(&room), &[0]), &mut vec![]);
                    self.let_go(w, t);
                }
            }
        }
        Ok(())
    }
}
