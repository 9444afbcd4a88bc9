//! Forces of bonds kept as a list: displacements gathered into records, slabs swept, forces handed back.

use super::lattice::{MAY_BREAK, Mode, SQUEEZED, least_critical};
use super::list_kernel::{RowKernels, RowTask, dead};
use crate::families::lattice::RowMotion;
use crate::families::list::{ListBody, PairConstants, Record};
use crate::families::{FamilyOptions, ForceUnit, Law, PeriView, PmbCoeff, PmbTable, VolumeRule, Window};
use perigrain_base::par::{self, Shared};
use std::ops::Range;

/// Fills constants, types and volumes; bonds with types of their own have the coefficients of those.
pub fn refresh(
    body: &mut ListBody,
    view: &PeriView,
    table: &PmbTable,
    options: &FamilyOptions,
    (law, of_bonds): (&Law, &[PmbCoeff]),
) {
    let n = body.kinds.len();
    body.pairs.clear();
    body.pairs.extend(of_bonds.iter().map(|k| constants(k, f64::NEG_INFINITY, options)));
    for pair in 0..if of_bonds.is_empty() { n * n } else { 0 } {
        let (a, b) = (body.kinds[pair / n], body.kinds[pair % n]);
        let own = table.get(a, b).map(|k| constants(k, law.yields(a, b), options));
        body.pairs.push(own.unwrap_or(PairConstants { s00: f64::INFINITY, ..Default::default() }));
    }
    for (r, &p) in body.particle.iter().enumerate() {
        if p != u32::MAX {
            let volume = view.volume[p as usize];
            body.record[r].volume = volume;
            body.record[r].share = if options.unit == ForceUnit::Density { 1.0 / volume } else { 1.0 };
        }
    }
}

/// What bonds of these coefficients need.
fn constants(k: &PmbCoeff, yields: f64, options: &FamilyOptions) -> PairConstants {
    let half = 0.5 * options.lattice_spacing;
    let weight = match options.volume {
        VolumeRule::None => [1.0, 0.0],
        _ => [1.0 + (k.horizon - half) / (2.0 * half), 1.0 / (2.0 * half)],
    };
    PairConstants { c: k.c, s00: k.s00, alpha: k.alpha, horizon: k.horizon, yields, weight }
}

/// Gathers displacements from positions; returns their change since the last step that advanced. A body that `presses` even
/// where nobody is displaced is nowhere at rest.
pub fn gather(body: &mut ListBody, view: &PeriView, presses: bool) -> RowMotion {
    let (record, moving) = (Shared::new(&mut body.record), Shared::new(&mut body.moving));
    let (slab, particle, last) = (&body.slab, &body.particle, &body.last);
    par::for_rows(moving.len(), |s| {
        let range = slab[s] as usize..slab[s + 1] as usize;
        // SAFETY: slabs do not share records.
        let (record, moving) = unsafe { (record.get(range.clone()), &mut moving.get(s..s + 1)[0]) };
        *moving = presses;
        for (record, i) in record.iter_mut().zip(range) {
            let Some(x) = view.x.get(particle[i] as usize) else { continue };
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
    let changes = par::reduce(
        body.record.len(),
        |range| {
            let mut motion = RowMotion::NONE;
            for i in range.filter(|&i| particle[i] != u32::MAX) {
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

/// The records of a slab, and those of the slab that its bonds reach.
pub fn reach_of(body: &ListBody, slab: usize) -> (Range<usize>, Range<usize>) {
    let own = body.slab[slab] as usize..body.slab[slab + 1] as usize;
    let next = if slab + 1 < body.slabs() {
        own.end..body.slab[slab + 2] as usize
    } else if body.ring {
        0..body.slab[1] as usize
    } else {
        0..0
    };
    (own, next)
}

/// Zero forces for so many records of a window.
pub fn clear(window: &mut Window, records: usize) {
    let length = 4 * records;
    if window.force.len() < length {
        window.force.resize(length, 0.0);
    }
    window.force[..length].fill(0.0);
}

/// Adds what a window has gathered for `records`, in their order, to the particles' forces.
pub fn hand_back(
    body: &ListBody,
    records: impl Iterator<Item = usize>,
    window: &Window,
    f: &Shared<[f64; 3]>,
) {
    for (k, i) in records.enumerate() {
        let p = body.particle[i] as usize;
        if p < f.len() {
            // SAFETY: in bounds; slabs that reach a particle run one after the other.
            let f = unsafe { &mut *f.as_ptr().add(p) };
            let w = &window.force[4 * k..4 * k + 3];
            let share = body.record[i].share;
            *f = [f[0] + share * w[0], f[1] + share * w[1], f[2] + share * w[2]];
        }
    }
}

/// What the bonds of a record are watched for: breaking, and contact in spite of the bond.
pub struct Watch {
    /// The smallest s00 and the largest alpha of all pairs of types.
    limit: (f64, f64),
    /// See [`ListBody::contact`].
    contact: f64,
    mode: Mode,
}

impl Watch {
    /// For the bonds of a body.
    pub fn new(body: &ListBody, mode: Mode) -> Self {
        let limit =
            body.pairs.iter().fold((f64::INFINITY, 0.0f64), |l, p| (l.0.min(p.s00), l.1.max(p.alpha)));
        Self { limit, contact: body.contact, mode }
    }

    /// Notes the largest z and −z among a record's bonds.
    #[inline]
    pub fn note(&self, [high, low]: [f64; 2], tension: &mut f32, flagged: &mut u8) {
        let floor = least_critical(self.limit, f64::from(*tension));
        if self.mode.armed && self.mode.advance && high >= floor {
            *flagged |= MAY_BREAK;
        }
        if low >= -self.contact {
            *flagged |= SQUEEZED;
        }
        if self.mode.advance {
            *tension = (high * (1.0 + 1e-6)) as f32;
        }
    }
}

/// The list during one force evaluation, with the columns that its slabs write.
pub struct Sweep<'a> {
    /// The bonds.
    pub body: &'a ListBody,
    /// See [`ListBody::tension`].
    pub tension: Shared<'a, f32>,
    /// See [`ListBody::flagged`].
    pub flagged: Shared<'a, u8>,
    /// How bonds are treated.
    pub mode: Mode,
    /// Rules.
    pub options: FamilyOptions,
    /// Periods of the box; infinite where it is open.
    pub period: [f64; 3],
}

impl Sweep<'_> {
    /// Adds the forces of the bonds of one slab's records to `f`: written are the particles of this slab and
    /// of the next.
    pub fn slab<K: RowKernels>(&self, slab: usize, window: &mut Window, f: &Shared<[f64; 3]>) {
        let body = self.body;
        let slabs = body.slabs();
        let (own, next) = reach_of(body, slab);
        // SAFETY: records belong to one slab.
        let (tension, flagged) = unsafe { (self.tension.get(own.clone()), self.flagged.get(own.clone())) };
        flagged.fill(0);
        let after = if slab + 1 < slabs { slab + 1 } else { 0 };
        let rest = !body.moving[slab] && (next.is_empty() || !body.moving[after]);
        if rest && self.mode.advance {
            tension.fill(0.0);
        }
        if rest && self.mode.skip {
            return;
        }
        clear(window, own.len() + next.len());
        let periodic = self.period.iter().any(|p| p.is_finite());
        let watch = Watch::new(body, self.mode);
        let closes = body.ring && slab + 1 == slabs;
        let dead = dead(&self.options);
        let force = window.force.as_mut_ptr().wrapping_sub(4 * own.start);
        for (k, i) in own.clone().enumerate() {
            let task = RowTask { body, i, force, first: own.start, period: self.period, dead };
            // SAFETY: bonds lead to this slab or the next, which the window covers in this order.
            let (high, low) = unsafe {
                match (periodic, closes) {
                    (false, _) => K::row::<false, false>(&task),
                    (true, false) => K::row::<true, false>(&task),
                    (true, true) => K::row::<true, true>(&task),
                }
            };
            watch.note([high, low], &mut tension[k], &mut flagged[k]);
        }
        hand_back(body, own.chain(next), window, f);
    }
}

const _: () = assert!(size_of::<Record>() == 64);
