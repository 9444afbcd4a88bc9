//! Bonds kept as a list: constants and displacements gathered into records.

pub mod breaking;
pub mod energy;
pub mod kernel;
pub(crate) mod laws;
pub mod sweep;
pub(crate) mod tiles;

use crate::families::lattice::RowMotion;
use crate::families::list::{GROUP, ListBody, PairConstants};
use crate::families::shares::BodyShare;
use crate::families::{
    Cell, FamilyOptions, ForceUnit, Influence, Law, PeriView, PmbCoeff, PmbTable, VolumeRule,
};
use perigrain_base::par::{self, Shared};

/// Fills constants, types and volumes; bonds with types of their own have the coefficients of those.
pub fn refresh(
    body: &mut ListBody,
    view: &PeriView,
    table: &PmbTable,
    options: &FamilyOptions,
    (law, of_bonds): (&Law, &[PmbCoeff]),
    cell: &Cell,
) {
    let n = body.kinds.len();
    body.pairs.clear();
    body.pairs.extend(of_bonds.iter().map(|k| constants(k, f64::NEG_INFINITY, (options, law))));
    for pair in 0..if of_bonds.is_empty() { n * n } else { 0 } {
        let (a, b) = (body.kinds[pair / n], body.kinds[pair % n]);
        let own = table.get(a, b).map(|k| constants(k, law.yields(a, b), (options, law)));
        body.pairs.push(own.unwrap_or(PairConstants { s00: f64::INFINITY, ..Default::default() }));
    }
    for (r, &p) in body.particle.iter().enumerate() {
        if p != u32::MAX {
            let volume = view.volume[p as usize];
            body.record[r].volume = volume;
            body.record[r].share = if options.unit == ForceUnit::Density { 1.0 / volume } else { 1.0 };
        }
    }
    body.limits.least.clear();
    measure(body, law, cell);
}

/// Keeps the lengths of bonds, and what takes an exponential of them.
pub fn measure(body: &mut ListBody, law: &Law, cell: &Cell) {
    let places = body.partner.len();
    body.inverse.resize(places, 0.0);
    body.influence.resize(if law.shape() == Influence::Gaussian { places } else { 0 }, 0.0);
    for b in 0..places {
        let [i, j] = [body.owner[b / GROUP], body.partner[b]].map(|r| r as usize);
        // Fillers lead from a record to itself.
        let length = if i == j { 1.0 } else { body.z(false, i, j, cell).1 };
        body.inverse[b] = 1.0 / length;
        let horizon = body.constants(b).horizon;
        if let Some(influence) = body.influence.get_mut(b) {
            *influence = law.influence.of(length, horizon);
        }
    }
}

/// What bonds of these coefficients need.
fn constants(k: &PmbCoeff, yields: f64, (options, law): (&FamilyOptions, &Law)) -> PairConstants {
    let half = 0.5 * options.lattice_spacing;
    let weight = match options.volume {
        VolumeRule::None => [1.0, 0.0],
        _ => [1.0 + (k.horizon - half) / (2.0 * half), 1.0 / (2.0 * half)],
    };
    let shape = k.c * law.shape().shape(k.horizon, k.horizon) / law.shape().of(k.horizon, k.horizon);
    PairConstants { c: k.c, shape, s00: k.s00, alpha: k.alpha, horizon: k.horizon, yields, weight }
}

/// Gathers displacements from positions; returns their change since the last step that advanced. Where contact is `short_range`
/// even between undisplaced particles, nothing is at rest. Of several ranks each looks at its share, and takes what it does not follow for
/// moving.
pub fn gather(
    body: &mut ListBody,
    view: &PeriView,
    short_range: bool,
    share: Option<&BodyShare>,
) -> RowMotion {
    let (record, moving) = (Shared::new(&mut body.record), Shared::new(&mut body.moving));
    let (slab, particle, last) = (&body.slab, &body.particle, &body.last);
    let (tilted, edges) = (view.bounds.tilted(), view.bounds.periods());
    let follows = |slab: usize| share.is_none_or(|share| share.follows[slab]);
    par::for_rows(moving.len(), |s| {
        let range = slab[s] as usize..slab[s + 1] as usize;
        // SAFETY: slabs do not share records.
        let (record, moving) = unsafe { (record.get(range.clone()), &mut moving.get(s..s + 1)[0]) };
        *moving = short_range || !follows(s);
        if !follows(s) {
            return;
        }
        for (record, i) in record.iter_mut().zip(range) {
            let Some(x) = view.x.get(particle[i] as usize) else { continue };
            if tilted {
                let u: [f64; 3] = std::array::from_fn(|k| x[k] - record.reference[k]);
                let by = edges.shift(edges.turns(std::array::from_fn(|k| u[k] - last[i][k])));
                record.u = std::array::from_fn(|k| u[k] - by[k]);
                *moving |= record.u != [0.0; 3];
                continue;
            }
            for k in 0..3 {
                record.u[k] = x[k] - record.reference[k];
                if view.bounds.periodic[k] {
                    let length = view.bounds.hi[k] - view.bounds.lo[k];
                    record.u[k] -= length * ((record.u[k] - last[i][k]) / length).round();
                }
            }
            *moving |= record.u != [0.0; 3];
        }
    });
    let own = share.map_or(0..body.record.len(), |share| body.records_of(&share.mine));
    let changes = par::reduce(
        own.len(),
        |range| {
            let mut motion = RowMotion::NONE;
            for i in range.map(|k| own.start + k).filter(|&i| particle[i] != u32::MAX) {
                let change = [0, 1, 2].map(|k| body.record[i].u[k] - last[i][k]);
                motion = motion.with(&RowMotion { least: change, most: change, ..RowMotion::NONE });
            }
            motion
        },
        |a, b| a.with(&b),
    );
    changes.unwrap_or(RowMotion::NONE)
}

/// Makes this step's displacements those of the last step that advanced.
pub fn keep(body: &mut ListBody) {
    let record = &body.record;
    par::each(&mut body.last[..], |start, last| {
        for (last, record) in last.iter_mut().zip(&record[start..]) {
            *last = record.u;
        }
    });
}
