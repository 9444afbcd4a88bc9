//! Grains in the order of space: neighbours near each other in memory while a run lasts, and for how many rebuilds their
//! lists and this order last.

use perigrain_base::comm;
use perigrain_base::comm::numbers::{next, put, take};
use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::{add, length, sub};
use perigrain_base::par;
use perigrain_neigh::tiles::{Tiles, edges};
use perigrain_world::share::Tiling;
use perigrain_world::{Kept, World};
use std::ops::Range;

/// Fewer than these fit the fastest memory in any order.
const FEW: usize = 256;

/// Puts the grains of a scene in the order of cells; peridynamic bodies keep theirs. The order is a function of positions
/// and ids alone.
pub fn line_up(w: &mut World) {
    let Some(domain) = &*w.domain else { return };
    let tiles = tiles(w, &w.particles.x, (domain.lo, domain.periods()));
    stand(w, tiles);
}

/// The same from the positions that lists are made from: a run that continues one has the order that this one had.
pub fn line_up_again(w: &mut World) {
    let made = w.made();
    let tiles = if made.len() == w.n() { tiles(w, made, w.made_in()) } else { None };
    stand(w, tiles);
}

/// Puts particles in the order of these tiles, if they are to stand in any.
fn stand(w: &mut World, tiles: Option<Tiles>) {
    let Some(tiles) = tiles else { return };
    let order: Vec<usize> = tiles.order.iter().map(|&i| i as usize).collect();
    w.line_up(&order);
    let ends = (0..tiles.count()).map(|tile| tiles.members(tile).end as u32).collect();
    w.rebuild.tiling = Tiling::new(ends, &w.rebuild);
}

/// Whether the grains of a scene stand in the order of space, and with which edges of cells.
fn cells(w: &World) -> Option<[f64; 2]> {
    let p = &w.particles;
    if !p.style.sphere || p.style.peri || w.families.is_some() || p.len() < FEW {
        return None;
    }
    Some(edges(&p.radius, w.rebuild.kept.reach(w.settings.neighbor.skin)))
}

/// The tiles of particles at `x` in a box of this corner and these edges.
fn tiles(w: &World, x: &[[f64; 3]], (lo, period): ([f64; 3], Periods)) -> Option<Tiles> {
    let edges = cells(w).filter(|_| period.repeats_where_it_leans())?;
    let mut tiles = Tiles::default();
    tiles.sort(x, &w.particles.tag, edges, &lo, &period);
    Some(tiles)
}

/// How far grains have gone relative to each other since lists were made for them.
struct Drift {
    /// At most among those of a slab and the next [length].
    near: f64,
    /// At most among all, along the axis of slabs [length].
    far: f64,
    /// See [`Kept::turns`](perigrain_world::Kept::turns).
    turns: Vec<[i8; 3]>,
}

/// The part of the skin within which neighbours have to stay in one rebuild, so that lists that reach farther pay.
const CALM: f64 = 0.4;
/// So many rebuilds they have to outlast then.
const PAYS: u32 = 2;
/// Positions are added up with rounding errors.
const SURE: f64 = 0.999;

/// At a rebuild, when all have been wrapped into the box and `held` is not yet renewed: whether lists of grains, and the order
/// that they stand in, stay as they are.
///
/// Lists that reach two skins beyond touching last as long as no two grains have come closer by more than one of them, because
/// until the next rebuild they come closer by one at most. If they do not stay, this also settles how far the next ones reach.
pub fn stays(w: &mut World) -> bool {
    let skin = w.settings.neighbor.skin;
    let most = if w.rebuild.kept.ample { SURE } else { CALM };
    let Some(drift) = drift(w, most * skin) else {
        w.rebuild.kept = Kept::default();
        return false;
    };
    if w.rebuild.kept.ample && drift.near.max(drift.far) <= SURE * skin {
        if w.rebuild.kept.x.is_empty() {
            let rebuild = &mut w.rebuild;
            (rebuild.kept.corners, rebuild.kept.tilt) = (rebuild.corners.unwrap_or_default(), rebuild.tilt);
            w.rebuild.kept.x = w.held().to_vec();
        }
        let kept = &mut w.rebuild.kept;
        (kept.turns, kept.outlasted) = (drift.turns, kept.outlasted + 1);
        return true;
    }
    let kept = &mut w.rebuild.kept;
    let calm = drift.near.max(drift.far) <= CALM * skin;
    let ample = if kept.ample { kept.outlasted >= PAYS } else { calm };
    *kept = Kept { ample, ..Kept::default() };
    false
}

/// `None` where lists cannot stay, or it is not known; more than `enough` is not exact.
fn drift(w: &World, enough: f64) -> Option<Drift> {
    let (period, s) = (w.periods(), &w.settings.neighbor);
    let [edge, far] = cells(w)?;
    let (x, made, held) = (&w.particles.x, w.made(), w.held());
    let known = made.len() == w.n() && held.len() == w.n() && w.rebuild.corners.is_some();
    let (lo, then) = w.made_in();
    // Lists of two skins have to fit between a grain and its image, with room to spare.
    let most = far - w.rebuild.kept.reach(s.skin) + 2.0 * s.skin;
    let wide = |period: &Periods| period.heights().iter().all(|l| *l == 0.0 || *l > 4.0 * most);
    let same = follows(&period, &then) && wide(&period) && wide(&then);
    if !known || !same || edge != far || !s.check || w.rebuild.grown.is_some() {
        return None;
    }
    let tiles = Tiles::laid_out(made, [edge, far], &lo, &then);
    let [fast, middle, slow] = tiles.axes();
    if !stands_across(&then, slow) || !stands_across(&period, slow) {
        return None;
    }
    let moved = [fast, middle, slow].map(|d| sub(period.vectors()[d], then.vectors()[d]));
    let slabs = tiles.slabs();
    let of_layers = slabs.of_layers();
    let before = &w.rebuild.kept.turns;
    let gone = |range: Range<usize>| {
        let mut gone = Gone { ways: vec![STILL; slabs.count()], turned: vec![], beyond: false };
        for i in range {
            let mut turns = before.get(i).copied().unwrap_or_default();
            // A particle half around the box from its place at the last rebuild has been moved by a period.
            let around = period.turns(sub(x[i], held[i]));
            if around != [0.0; 3] {
                (0..3).for_each(|d| turns[d] = turns[d].saturating_add(around[d] as i8));
                gone.turned.push((i, turns));
            }
            let ways = &mut gone.ways[of_layers[tiles.layer_of(&made[i])]];
            let so_far = *ways;
            let [least, most] = ways;
            let away = if turns == [0; 3] { [0.0; 3] } else { period.shift(turns.map(f64::from)) };
            for d in 0..3 {
                let way = x[i][d] - away[d] - made[i][d];
                (least[d], most[d]) = (least[d].min(way), most[d].max(way));
            }
            // Those that come may go farther still. Where turns are known they have to be counted to the end.
            if before.is_empty() && *ways != so_far && across(*ways) > enough {
                gone.beyond = true;
                break;
            }
        }
        gone
    };
    let Gone { ways, turned, beyond } = by_all(w, slabs.count(), gone)?;
    if beyond {
        return Some(Drift { near: f64::INFINITY, far: 0.0, turns: vec![] });
    }
    let mut turns = before.clone();
    for (i, now) in turned {
        turns.resize(x.len(), [0; 3]);
        turns[i] = now;
        if now.iter().any(|n| n.unsigned_abs() > MOST_TURNS) {
            return None;
        }
    }
    // Across a face that repeats, the next slab is seen in an image that may have moved.
    let with_next = |k: usize| match slabs.next(k) {
        Some(next) if next > k => both(ways[k], ways[next]),
        Some(next) => both(ways[k], ways[next].map(|bound| add(bound, moved[2]))),
        None => ways[k],
    };
    let within = length(moved[0]) + length(moved[1]);
    let near = (0..ways.len()).map(|k| across(with_next(k))).fold(0.0, f64::max) + within;
    let [least, most] = ways.iter().copied().fold(STILL, both);
    let far = most[slow] - least[slow] + moved[2][slow].abs();
    Some(Drift { near, far, turns })
}

/// The motion of the grains of all rows, where `gone` returns that of some; where grains are distributed over ranks, each rank
/// covers its own.
fn by_all(w: &World, slabs: usize, gone: impl Fn(Range<usize>) -> Gone + Sync) -> Option<Gone> {
    let Some(share) = w.share.as_ref().filter(|_| w.grains_dealt().is_some()) else {
        return par::reduce(w.n(), gone, Gone::join);
    };
    let of = |rows: &Range<usize>| {
        par::reduce(rows.len(), |some| gone(some.start + rows.start..some.end + rows.start), Gone::join)
    };
    let own = share.own.iter().filter_map(of).reduce(Gone::join);
    let mut letter = vec![];
    own.iter().for_each(|own| own.write(&mut letter));
    let pieces = comm::present().pieces(letter);
    pieces.iter().filter_map(|piece| Gone::read(piece, slabs)).reduce(Gone::join)
}

/// More turns around the box are not counted.
const MOST_TURNS: u8 = 100;

/// The least and the most of some ways [length].
type Bounds = [[f64; 3]; 2];

/// The bounds of no particle.
const STILL: Bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

/// Bounds of two sets of ways together.
fn both(a: Bounds, b: Bounds) -> Bounds {
    [std::array::from_fn(|d| a[0][d].min(b[0][d])), std::array::from_fn(|d| a[1][d].max(b[1][d]))]
}

/// How far two of these ways are from each other at most.
fn across([least, most]: Bounds) -> f64 {
    (0..3).map(|d| (most[d] - least[d]).max(0.0).powi(2)).sum::<f64>().sqrt()
}

/// What some grains have done since lists were made.
struct Gone {
    /// Their ways, slab by slab.
    ways: Vec<Bounds>,
    /// Particles moved by periods since the last rebuild, and by how many since lists were made.
    turned: Vec<(usize, [i8; 3])>,
    /// Some have moved farther than is allowed, and not all were examined.
    beyond: bool,
}

impl Gone {
    fn join(mut self, other: Self) -> Self {
        self.ways.iter_mut().zip(other.ways).for_each(|(a, b)| *a = both(*a, b));
        self.turned.extend(other.turned);
        self.beyond |= other.beyond;
        self
    }

    /// As the message of a rank to others.
    fn write(&self, bytes: &mut Vec<u8>) {
        put(bytes, &[u8::from(self.beyond)]);
        self.ways.iter().for_each(|bounds| put(bytes, bounds.as_flattened()));
        for (row, turns) in &self.turned {
            put(bytes, &[*row as u32]);
            put(bytes, &turns.map(i8::cast_unsigned));
        }
    }

    /// From the message of a rank about so many slabs; none where it has no rows.
    fn read(mut bytes: &[u8], slabs: usize) -> Option<Self> {
        let [beyond] = next::<u8, 1>(&mut bytes)?;
        let mut ways = vec![STILL; slabs];
        ways.iter_mut().for_each(|bounds| take(&mut bytes, bounds.as_flattened_mut()));
        let mut turned = vec![];
        while let Some(([row], turns)) = next::<u32, 1>(&mut bytes).zip(next::<u8, 3>(&mut bytes)) {
            turned.push((row as usize, turns.map(u8::cast_signed)));
        }
        Some(Self { ways, turned, beyond: beyond == 1 })
    }
}

/// Whether a box is the one it was, perhaps deformed: not one that has been flipped, or repeats otherwise.
fn follows(now: &Periods, then: &Periods) -> bool {
    let repeats = |p: &Periods| p.length.map(|l| l > 0.0);
    // Of x in xy and in xz, of y in yz.
    let flipped = |k: usize| (now.tilt[k] - then.tilt[k]).abs() > 0.25 * then.length[[0, 0, 1][k]];
    let leans = now.repeats_where_it_leans() && then.repeats_where_it_leans();
    leans && repeats(now) == repeats(then) && (now.tilt == then.tilt || !(0..3).any(flipped))
}

/// Whether the faces that this edge leads across stand at right angles to its axis.
fn stands_across(period: &Periods, edge: usize) -> bool {
    let [xy, xz, yz] = period.tilt;
    [xy == 0.0 && xz == 0.0, yz == 0.0, true][edge]
}
