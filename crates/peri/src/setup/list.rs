//! Laying out bonds as a list: records by slabs, half of the bonds with each.

use crate::families::list::{CLOSE, GROUP, ListBody, PART, Record};
use crate::families::{FamilyOptions, PeriView, PmbTable};
use crate::setup::detect::{bonds, distance, reach};

/// The list layout of the bonds among `members`, whose spacings may be their own, and the sums of initial partners' volumes and numbers.
pub fn lay_out(
    view: &PeriView,
    members: &[u32],
    wraps: bool,
    (table, options, spacing): (&PmbTable, &FamilyOptions, &[f64]),
    family_volume: &mut [f64],
    family_size: &mut [u16],
) -> ListBody {
    if members.is_empty() {
        return ListBody { start: vec![0], back_start: vec![0], slab: vec![0], ..Default::default() };
    }
    let mut contact = f64::NEG_INFINITY;
    let found = |each: &mut dyn FnMut(u32, u32, Option<u8>)| {
        bonds(view, members.iter().copied(), (table, options, spacing), |p, q, rsq, _| {
            // Two at one place: a bond without a length has no stretch and no direction.
            if rsq == 0.0 {
                return;
            }
            let range = options.contact_range(view, p, q);
            contact = contact.max(range * range / rsq - 1.0);
            each(p, q, None);
        });
    };
    let mut body =
        gathered(view, members, (wraps, reach(table, options, spacing)), (family_volume, family_size), found);
    body.contact = contact;
    find_close(&mut body, view, options);
    body
}

/// Finds the bonds whose ends touch first when they are pressed together.
fn find_close(body: &mut ListBody, view: &PeriView, options: &FamilyOptions) {
    body.close_start.push(0);
    for i in 0..body.record.len() {
        let from = body.close.len();
        for b in body.own(i) {
            if !body.lives(b) {
                continue;
            }
            let (p, q) = (body.particle[i], body.particle[body.partner[b] as usize]);
            let (range, (rsq, _)) = (options.contact_range(view, p, q), distance(view, p, q));
            // Rounded up.
            let z = (range * range / rsq - 1.0) as f32 + 1e-6;
            if z >= CLOSE {
                body.close.push((z, b as u32));
            }
        }
        body.close[from..].sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        body.close_start.push(body.close.len() as u32);
    }
}

/// The same of bonds that are known, by their ends and their type from 0, of which the longest is `far`.
pub fn lay_out_links(
    view: &PeriView,
    links: &[([u32; 2], u8)],
    far: f64,
    family_volume: &mut [f64],
    family_size: &mut [u16],
) -> ListBody {
    if links.is_empty() {
        return ListBody { start: vec![0], back_start: vec![0], slab: vec![0], ..Default::default() };
    }
    let mut members: Vec<u32> = links.iter().flat_map(|l| l.0).collect();
    members.sort_unstable();
    members.dedup();
    let wraps = links.iter().any(|(ends, _)| distance(view, ends[0], ends[1]).1);
    let found = |each: &mut dyn FnMut(u32, u32, Option<u8>)| {
        links.iter().for_each(|&([p, q], kind)| each(p, q, Some(kind)));
    };
    let mut body = gathered(view, &members, (wraps, far), (family_volume, family_size), found);
    body.contact = f64::NEG_INFINITY;
    body.close_start = vec![0; body.record.len() + 1];
    body
}

/// The length of the longest of some bonds.
pub fn longest(view: &PeriView, links: &[([u32; 2], u8)]) -> f64 {
    links.iter().map(|(ends, _)| distance(view, ends[0], ends[1]).0).fold(0.0, f64::max).sqrt()
}

/// The list of the bonds that `found` goes through, with a type of their own or that of their ends.
fn gathered(
    view: &PeriView,
    members: &[u32],
    (wraps, far): (bool, f64),
    (family_volume, family_size): (&mut [f64], &mut [u16]),
    found: impl FnOnce(&mut dyn FnMut(u32, u32, Option<u8>)),
) -> ListBody {
    let (mut body, axis) = order(view, members, wraps, far);
    let n = body.particle.len();
    let mut record_of = vec![u32::MAX; view.x.len()];
    for (r, &p) in body.particle.iter().enumerate() {
        record_of[p as usize] = r as u32;
    }
    let mut kinds: Vec<u16> = members.iter().map(|&p| view.kind[p as usize]).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let local = |p: u32| kinds.iter().position(|&k| k == view.kind[p as usize]).unwrap_or(0) as u8;
    body.kind = body.particle.iter().map(|&p| local(p)).collect();
    let mut slab_of = vec![0u32; n];
    for s in 0..body.slabs() {
        slab_of[body.slab[s] as usize..body.slab[s + 1] as usize].fill(s as u32);
    }
    let along =
        |p: u32| if wraps { view.bounds.upright(view.x[p as usize])[axis] } else { view.x[p as usize][axis] };
    let half = 0.5 * (view.bounds.hi[axis] - view.bounds.lo[axis]);
    let (mut pairs, mut typed): (Vec<(u32, u8, u32)>, bool) = (vec![], false);
    found(&mut |p, q, own| {
        family_volume[p as usize] += view.volume[q as usize];
        family_volume[q as usize] += view.volume[p as usize];
        family_size[p as usize] += 1;
        family_size[q as usize] += 1;
        let (a, b) = (record_of[p as usize], record_of[q as usize]);
        let (low, high) = (a.min(b), a.max(b));
        let apart = || along(body.particle[high as usize]) - along(body.particle[low as usize]) > half;
        let across = body.ring && slab_of[low as usize] != slab_of[high as usize] && apart();
        let (i, j) = if across { (high, low) } else { (low, high) };
        typed |= own.is_some();
        pairs.push((i, own.unwrap_or(body.kind[j as usize]), j));
    });
    pairs.sort_unstable();
    fill(&mut body, &pairs);
    body.kinds = kinds;
    if typed {
        // Constants go by the bonds' types alone.
        body.kind.fill(0);
        body.kinds.truncate(1);
    }
    body.record = body
        .particle
        .iter()
        .map(|&p| Record {
            reference: view.x[p as usize],
            volume: view.volume[p as usize],
            ..Default::default()
        })
        .collect();
    body.last = vec![[0.0; 3]; n];
    body.moving = vec![false; body.slabs()];
    body.lowest = vec![0.0; n];
    body
}

/// Slabs that keep threads equally busy.
const ENOUGH: usize = 64;
/// Slabs in the reach of a family at most: what bonds give to each of these is handed over. One thread takes as long with one as with four
/// (measured: jittered bodies of 13,824 and 97,336 particles).
const THIN: f64 = 4.0;
/// Records of a slab at least.
const FEW: usize = 64;

/// How many slabs are made of so many records in a body so many reaches of families long.
fn slabs(records: usize, reaches: f64) -> usize {
    let many = (reaches as usize).max(ENOUGH.min((THIN * reaches) as usize));
    many.min(records / FEW).clamp(1, 1 << 16)
}

/// Records in slabs of as many as any other, and the axis across these; within a slab, neighbours near each other.
fn order(view: &PeriView, members: &[u32], wraps: bool, far: f64) -> (ListBody, usize) {
    let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    // Rings close in the upright box.
    let place = |p: u32| if wraps { view.bounds.upright(view.x[p as usize]) } else { view.x[p as usize] };
    let far =
        if wraps { view.bounds.wider().into_iter().fold(far, |most, w| most.max(far * w)) } else { far };
    for &p in members {
        let x = place(p);
        for k in 0..3 {
            lo[k] = lo[k].min(x[k]);
            hi[k] = hi[k].max(x[k]);
        }
    }
    let closed = [0, 1, 2].map(|k| wraps && view.bounds.periodic[k]);
    for k in (0..3).filter(|&k| closed[k]) {
        (lo[k], hi[k]) = (view.bounds.lo[k], view.bounds.hi[k]);
    }
    let length = [0, 1, 2].map(|k| hi[k] - lo[k]);
    // Along an open direction if there is one, else along a ring.
    let axis = (0..3).fold(0, |best, k| {
        let better = (closed[best] && !closed[k]) || (closed[best] == closed[k] && length[k] > length[best]);
        if better { k } else { best }
    });
    let slabs = slabs(members.len(), length[axis] / far);
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    let (b, c) = if length[b] > length[c] { (b, c) } else { (c, b) };
    let fine = far / 3.0;
    let mut particle = members.to_vec();
    particle.sort_by(|p, q| place(*p)[axis].total_cmp(&place(*q)[axis]).then(p.cmp(q)));
    // Each part of records whose energies are added up together is one slab's.
    let end = |s: usize| match s == slabs {
        true => particle.len(),
        false => s * particle.len() / slabs / PART * PART,
    };
    let slab: Vec<u32> = (0..=slabs).map(|s| end(s) as u32).collect();
    for ends in slab.windows(2) {
        particle[ends[0] as usize..ends[1] as usize].sort_by_cached_key(|&p| {
            let x = place(p);
            let layer = |k: usize| ((x[k] - lo[k]) / fine).round() as i64;
            (layer(c), layer(axis), layer(b), p)
        });
    }
    (ListBody { particle, slab, ring: closed[axis] && slabs > 1, ..Default::default() }, axis)
}

/// Groups of bonds from (owner, partner's local type, partner) in order.
fn fill(body: &mut ListBody, pairs: &[(u32, u8, u32)]) {
    let n = body.particle.len();
    body.start = vec![0];
    body.back_start = vec![0; n + 1];
    let mut rest = pairs;
    for i in 0..n as u32 {
        while let Some(&(owner, kind, _)) = rest.first()
            && owner == i
        {
            let same = |p: &&(u32, u8, u32)| p.0 == i && p.1 == kind;
            let count = rest.iter().take(GROUP).take_while(same).count();
            for k in 0..GROUP {
                body.partner.push(if k < count { rest[k].2 } else { i });
                if k < count {
                    body.back_start[rest[k].2 as usize + 1] += 1;
                }
            }
            body.alive.push((0xffu16 >> (GROUP - count)) as u8);
            body.group_kind.push(kind);
            body.owner.push(i);
            rest = &rest[count..];
        }
        body.start.push(body.owner.len() as u32);
    }
    for i in 0..n {
        body.back_start[i + 1] += body.back_start[i];
    }
    let mut place = body.back_start.clone();
    body.back = vec![0; pairs.len()];
    for (b, &j) in body.partner.iter().enumerate() {
        if body.lives(b) {
            body.back[place[j as usize] as usize] = b as u32;
            place[j as usize] += 1;
        }
    }
}
