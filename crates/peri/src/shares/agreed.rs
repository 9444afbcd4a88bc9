//! What all ranks agree upon in a step: how far bodies have moved, what is squeezed, what breaks.

use std::ops::Range;

use crate::families::bond::{Broken, Candidate};
use crate::families::lattice::{LANES, LatticeBody, MAY_BREAK, RowMotion, SQUEEZED};
use crate::families::list::ListBody;
use crate::families::shares::{BodyShare, Shares};
use crate::families::view::PeriView;
use perigrain_base::comm;
use perigrain_base::comm::numbers::{next, put, take};

/// What has moved in each body on a lattice and in the list, on all ranks together.
pub(crate) fn agreed_motion(bodies: &[LatticeBody], list: &RowMotion, shares: &Shares) -> Vec<RowMotion> {
    let mut ends = vec![];
    let lattices = bodies.iter().zip(&shares.bodies).map(|(body, share)| {
        let rows = body.motion.iter().zip(&share.own).filter(|(_, own)| **own);
        rows.fold(RowMotion::NONE, |m, (row, _)| m.with(row))
    });
    for motion in lattices.chain([*list]) {
        ends.extend(motion.least.map(|least| -least));
        ends.extend(motion.most);
    }
    comm::present().most(&mut ends);
    let (ends, _) = ends.as_chunks::<6>();
    ends.iter()
        .map(|&[x, y, z, most @ ..]| RowMotion { least: [-x, -y, -z], most, ..RowMotion::NONE })
        .collect()
}

/// Forgets the flags of other ranks' chunks, which are of an evaluation that was not shared out.
pub(crate) fn forget_flags(bodies: &mut [LatticeBody], shares: &Shares) {
    for (body, share) in bodies.iter_mut().zip(&shares.bodies) {
        for (row, _) in body.rows.iter().zip(&share.own).filter(|(_, own)| !**own) {
            body.flagged[row.chunks()].fill(0);
        }
    }
}

/// What all ranks have agreed upon after a sweep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Agreed {
    /// Bonds of lattices may break.
    pub(crate) breaks: bool,
    /// Some are squeezed.
    pub(crate) squeezed: bool,
    /// Bonds of the list may break.
    pub(crate) strained: bool,
    /// The largest z of these.
    pub(crate) top: f64,
    /// The smallest one.
    pub(crate) lowest: f32,
}

/// Agrees upon what ranks have found of their chunks and slabs.
pub(crate) fn agree(bodies: &[LatticeBody], list: &ListBody) -> Agreed {
    let any = |flag: u8| bodies.iter().any(|body| body.flagged.iter().any(|own| own & flag != 0));
    let strained = list.is_strained();
    let flags = [any(MAY_BREAK), any(SQUEEZED), strained].map(|flag| f64::from(u8::from(flag)));
    let top = list.limits.strained.iter().map(|(_, top)| *top).fold(0.0, f64::max);
    let lowest = list.lowest.iter().fold(0.0f32, |least, low| least.min(*low));
    let mut all = [flags[0], flags[1], flags[2], top, -f64::from(lowest)];
    comm::present().most(&mut all);
    let [breaks, squeezed, strained, top, lowest] = all;
    Agreed {
        breaks: breaks > 0.0,
        squeezed: squeezed > 0.0,
        strained: strained > 0.0,
        top,
        lowest: -lowest as f32,
    }
}

/// Whether something holds on all ranks.
pub(crate) fn agreed(own: bool) -> bool {
    let mut fails = [f64::from(u8::from(!own))];
    comm::present().most(&mut fails);
    fails == [0.0]
}

/// Hands bytes to all other ranks; what these have handed out.
pub(super) fn to_all(bytes: &[u8]) -> Vec<(usize, Vec<u8>)> {
    let ranks = comm::present();
    let others = (0..ranks.size()).filter(|rank| *rank != ranks.rank());
    ranks.exchange(others.map(|rank| (rank, bytes.to_vec())).collect())
}

/// Flags the chunks with squeezed bonds of other ranks too, where these reach this rank's particles, or `all` of them.
pub(crate) fn squeezed_everywhere(bodies: &mut [LatticeBody], shares: &Shares, all: bool) {
    let mut own = vec![];
    for (k, body) in bodies.iter().enumerate() {
        let squeezed = body.flagged.iter().enumerate().filter(|(_, flag)| **flag & SQUEEZED != 0);
        squeezed.for_each(|(chunk, _)| put(&mut own, &[k as u32, chunk as u32]));
    }
    for (_, bytes) in to_all(&own) {
        let mut bytes = &bytes[..];
        while let Some([k, chunk]) = next(&mut bytes).map(|words| words.map(|word: u32| word as usize)) {
            if all || shares.bodies[k].follows[bodies[k].slot_of(chunk * LANES)] {
                bodies[k].flagged[chunk] |= SQUEEZED;
            }
        }
    }
}

/// The pieces of all ranks, of so many bytes each, one after the other; `own` appends that of this one.
pub(super) fn pieces_of_all(counts: &[usize], me: usize, own: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut bytes = vec![0; counts[..me].iter().sum()];
    own(&mut bytes);
    bytes.resize(counts.iter().sum(), 0);
    comm::present().gather_all(&mut bytes, counts);
    bytes
}

/// Has what ranks have found of their rows, a few numbers each, on all of them.
pub(crate) fn rows_everywhere<const N: usize>(
    body: &LatticeBody,
    (share, me): (&BodyShare, usize),
    rows: &mut [[f64; N]],
) {
    let slots: Vec<Vec<usize>> = share.tiles.iter().map(|tiles| slots_of(body, tiles)).collect();
    let counts: Vec<usize> = slots.iter().map(|slots| slots.len() * N * size_of::<f64>()).collect();
    let bytes =
        pieces_of_all(&counts, me, |bytes| slots[me].iter().for_each(|slot| put(bytes, &rows[*slot])));
    let mut bytes = &bytes[..];
    slots.into_iter().flatten().for_each(|slot| take(&mut bytes, &mut rows[slot]));
}

/// The list, in the place of the number of a body on a lattice.
pub(crate) const LIST: usize = u32::MAX as usize;

/// Bonds of all ranks that break, in the order in which one process finds them: by bodies and chunks.
pub(crate) fn broken_everywhere(mut own: Vec<Broken>) -> Vec<Broken> {
    let mut bytes = vec![];
    for Broken { body, bond, square } in &own {
        put(&mut bytes, &[*body as u32, bond.ends[0], bond.ends[1], bond.bond]);
        put(&mut bytes, &[*square]);
    }
    for (_, bytes) in to_all(&bytes) {
        let mut bytes = &bytes[..];
        while let (Some([body, i, j, bond]), Some([square])) = (next(&mut bytes), next(&mut bytes)) {
            let bond = Candidate { ends: [i, j], bond, stretch: 0.0, s00: 0.0, alpha: 0.0 };
            let body: u32 = body;
            own.push(Broken { body: body as usize, bond, square });
        }
    }
    // A chunk is one rank's, so that its own order stays; those of the list come in the order of their places.
    own.sort_by_key(|broken| match broken.body {
        LIST => (LIST, broken.bond.bond as usize),
        body => (body, broken.bond.ends[0] as usize / LANES),
    });
    own
}

/// The square of a bond's length now.
pub(crate) fn square(view: &PeriView, [i, j]: [u32; 2]) -> f64 {
    crate::setup::detect::distance(view, i, j).0
}

/// The row slots of some tiles.
pub(super) fn slots_of(body: &LatticeBody, tiles: &Range<usize>) -> Vec<usize> {
    let tiles = body.tiles.all[tiles.clone()].iter();
    tiles
        .flat_map(|tile| {
            let slots = |plane: usize| body.slot(plane, tile.rows.start)..body.slot(plane, tile.rows.end);
            tile.planes.clone().flat_map(slots)
        })
        .collect()
}
