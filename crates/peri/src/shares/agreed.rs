//! What all ranks agree upon in a step: how far bodies have moved, what is squeezed, what breaks.

use crate::families::lattice::{LANES, LatticeBody, RowMotion};
use crate::families::shares::{BodyShare, Shares};
use crate::families::{Candidate, PeriView};
use crate::lattice::sweep::{MAY_BREAK, SQUEEZED};
use crate::shares::whole::slots_of;
use perigrain_base::comm;

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
fn to_all(bytes: &[u8]) -> Vec<(usize, Vec<u8>)> {
    let ranks = comm::present();
    let others = (0..ranks.size()).filter(|rank| *rank != ranks.rank());
    ranks.exchange(others.map(|rank| (rank, bytes.to_vec())).collect())
}

/// Numbers of a message.
fn words(bytes: &[u8]) -> impl Iterator<Item = u32> {
    bytes.as_chunks::<4>().0.iter().map(|word| u32::from_ne_bytes(*word))
}

/// Flags the chunks with squeezed bonds of other ranks too, where these reach this rank's particles, or `all` of them.
pub(crate) fn squeezed_everywhere(bodies: &mut [LatticeBody], shares: &Shares, all: bool) {
    let mut own = vec![];
    for (k, body) in bodies.iter().enumerate() {
        let squeezed = body.flagged.iter().enumerate().filter(|(_, flag)| **flag & SQUEEZED != 0);
        own.extend(squeezed.flat_map(|(chunk, _)| [k as u32, chunk as u32]).flat_map(u32::to_ne_bytes));
    }
    for (_, bytes) in to_all(&own) {
        let words: Vec<u32> = words(&bytes).collect();
        for &[body, chunk] in words.as_chunks::<2>().0 {
            let (k, chunk) = (body as usize, chunk as usize);
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
    let mut bytes = vec![0; counts.iter().sum()];
    let first: usize = counts[..me].iter().sum();
    let own = slots[me].iter().flat_map(|slot| rows[*slot]).flat_map(f64::to_ne_bytes);
    bytes[first..first + counts[me]].iter_mut().zip(own).for_each(|(to, byte)| *to = byte);
    comm::present().gather_all(&mut bytes, &counts);
    let mut numbers = bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_ne_bytes(*bytes));
    for slot in slots.into_iter().flatten() {
        rows[slot] = std::array::from_fn(|_| numbers.next().unwrap_or_default());
    }
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
        let words = [*body as u32, bond.ends[0], bond.ends[1], bond.bond];
        bytes.extend(words.into_iter().flat_map(u32::to_ne_bytes).chain(square.to_ne_bytes()));
    }
    for (_, bytes) in to_all(&bytes) {
        for bytes in bytes.as_chunks::<24>().0 {
            let mut words = words(bytes);
            let mut next = || words.next().unwrap_or_default();
            let (body, ends, bond) = (next() as usize, [next(), next()], next());
            let (stretch, s00, alpha) = (0.0, 0.0, 0.0);
            let bond = Candidate { ends, bond, stretch, s00, alpha };
            let [.., a, b, c, d, e, f, g, h] = *bytes;
            own.push(Broken { body, bond, square: f64::from_ne_bytes([a, b, c, d, e, f, g, h]) });
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
