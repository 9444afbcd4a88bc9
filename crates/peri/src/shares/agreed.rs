//! What all ranks agree upon in a step: how far bodies have moved, what is squeezed, what breaks.

use crate::families::lattice::{LANES, LatticeBody, RowMotion};
use crate::families::shares::{BodyShare, Shares};
use crate::families::{Candidate, PeriView};
use crate::lattice::sweep::{MAY_BREAK, SQUEEZED};
use crate::shares::whole::slots_of;
use perigrain_base::comm;
use perigrain_base::comm::numbers::{next, put, take};

/// What has moved in each body, on all ranks together.
pub(crate) fn agreed_motion(bodies: &[LatticeBody], shares: &Shares) -> Vec<RowMotion> {
    let mut ends = vec![];
    for (body, share) in bodies.iter().zip(&shares.bodies) {
        let rows = body.motion.iter().zip(&share.own).filter(|(_, own)| **own);
        let motion = rows.fold(RowMotion::NONE, |m, (row, _)| m.with(row));
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

/// Whether some chunk of any rank has bonds that may break, and whether some has squeezed ones.
pub(crate) fn flagged_anywhere(bodies: &[LatticeBody]) -> [bool; 2] {
    let mut any = [MAY_BREAK, SQUEEZED].map(|flag| {
        f64::from(u8::from(bodies.iter().any(|body| body.flagged.iter().any(|own| own & flag != 0))))
    });
    comm::present().most(&mut any);
    any.map(|any| any > 0.0)
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

/// Has what ranks have found of their rows, a few numbers each, on all of them.
pub(crate) fn rows_everywhere<const N: usize>(
    body: &LatticeBody,
    (share, me): (&BodyShare, usize),
    rows: &mut [[f64; N]],
) {
    let slots: Vec<Vec<usize>> = share.tiles.iter().map(|tiles| slots_of(body, tiles)).collect();
    let counts: Vec<usize> = slots.iter().map(|slots| slots.len() * N * size_of::<f64>()).collect();
    let mut bytes = vec![0; counts[..me].iter().sum()];
    slots[me].iter().for_each(|slot| put(&mut bytes, &rows[*slot]));
    bytes.resize(counts.iter().sum(), 0);
    comm::present().gather_all(&mut bytes, &counts);
    let mut bytes = &bytes[..];
    slots.into_iter().flatten().for_each(|slot| take(&mut bytes, &mut rows[slot]));
}

/// A bond that breaks, with the body that has it and the square of its length.
pub(crate) struct Broken {
    pub(crate) body: usize,
    pub(crate) bond: Candidate,
    pub(crate) square: f64,
}

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
    // A chunk is one rank's, so that its own order stays.
    own.sort_by_key(|broken| (broken.body, broken.bond.ends[0] as usize / LANES));
    own
}

/// The square of a bond's length now.
pub(crate) fn square(view: &PeriView, [i, j]: [u32; 2]) -> f64 {
    crate::build::detect::distance(view, i, j).0
}
