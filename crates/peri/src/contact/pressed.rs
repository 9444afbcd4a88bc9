//! Bonded particles that are squeezed so far that they repel each other besides: found by their bonds, several pairs evaluated at a time.

use crate::contact::hits::{Push, Rules};
use crate::contact::memory::{Close, Pressed};
use crate::contact::{Repulsion, add};
use crate::families::lattice::{LANES, SQUEEZED};
use crate::families::list::{CLOSE, GROUP, ListBody};
use crate::families::{Families, FamilyOptions, PeriView};
use perigrain_base::math::form::Form;
use perigrain_base::par::{self, Shared};

/// Chunks of a lattice, or records of a list, in a part that threads share.
const CHUNKS: usize = 16;
const RECORDS: usize = 128;
/// Parts whose pairs are kept at a time.
const KEPT: usize = 32;

impl Close {
    /// Finds them, unless they are known.
    fn find(&mut self, list: &ListBody, view: &PeriView, options: &FamilyOptions) {
        if self.ends.len() == list.close.len() {
            return;
        }
        self.clear();
        for &(_, b) in &list.close {
            let ends = [list.owner[b as usize / GROUP], list.partner[b as usize]];
            let [p, q] = ends.map(|record| list.particle[record as usize]);
            self.ends.push([p.min(q), p.max(q)]);
            let there = p.max(q) != u32::MAX;
            self.contact.push(if there { options.contact_range(view, p, q) } else { 0.0 });
        }
    }
}

impl Pressed {
    /// Takes a pair in hand if it touches: the distance at which it does is asked for where the two are near enough for any to.
    #[inline]
    fn consider(&mut self, rules: &Rules, reach: f64, ends: [u32; 2], contact: impl FnOnce() -> f64) {
        let (view, [i, j]) = (rules.view, ends);
        let (x, y) = (&view.x[i as usize], &view.x[j as usize]);
        let mut d = [x[0] - y[0], x[1] - y[1], x[2] - y[2]];
        if view.bounds.periodic != [false; 3] {
            d = view.bounds.nearest(d);
        }
        let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if square >= reach * reach {
            return;
        }
        let contact = contact();
        if square < contact * contact
            && let Some(stiff) = rules.stiff(i, j)
        {
            self.ends.push(ends);
            self.hits.add([d[0], d[1], d[2], square, contact, stiff]);
        }
    }

    /// The same of a pair whose distance of contact is not known yet.
    fn look_at(&mut self, rules: &Rules, options: &FamilyOptions, p: u32, q: u32) {
        let ends = [p.min(q), p.max(q)];
        let contact = || options.contact_range(rules.view, ends[0], ends[1]);
        self.consider(rules, 1.35 * options.lattice_spacing, ends, contact);
    }
}

/// Adds the pushes of all bonded pairs that touch, in the order of their bonds.
pub fn squeezed(
    families: &Families,
    rules: &Rules,
    (close, pressed): (&mut Close, &mut Vec<Pressed>),
    repulsion: &mut Repulsion,
) {
    let form = families.form();
    for body in &families.lattices {
        let flagged = body.flagged.iter().enumerate().filter(|(_, flag)| **flag & SQUEEZED != 0);
        let chunks: Vec<usize> = flagged.map(|(chunk, _)| chunk).collect();
        in_turn(form, chunks.len().div_ceil(CHUNKS), (rules, pressed), repulsion, |part, pressed| {
            for &chunk in chunks[part * CHUNKS..].iter().take(CHUNKS) {
                let alive = &body.alive[chunk * body.stencil.len()..][..body.stencil.len()];
                for lead in body.leads_of(body.slot_of(chunk * LANES)) {
                    let mut bits = alive[lead.e as usize];
                    while bits != 0 {
                        let cell = chunk * LANES + bits.trailing_zeros() as usize;
                        bits &= bits - 1;
                        let to = cell.wrapping_add_signed(lead.to as isize);
                        pressed.look_at(rules, &families.options, body.particle[cell], body.particle[to]);
                    }
                }
            }
        });
    }
    let list = &families.list;
    if !list.may_touch(list.lowest.iter().fold(0.0, |least, low| low.min(least))) {
        return;
    }
    close.find(list, rules.view, &families.options);
    let close: &Close = close;
    in_turn(form, list.lowest.len().div_ceil(RECORDS), (rules, pressed), repulsion, |part, pressed| {
        for (i, &low) in list.lowest.iter().enumerate().skip(part * RECORDS).take(RECORDS) {
            if low < CLOSE {
                for b in list.own(i).filter(|b| list.lives(*b)) {
                    let [p, q] = [i, list.partner[b] as usize].map(|record| list.particle[record]);
                    pressed.look_at(rules, &families.options, p, q);
                }
                continue;
            }
            let all = list.close_start[i] as usize..list.close_start[i + 1] as usize;
            for (k, &(z, b)) in all.clone().zip(&list.close[all]) {
                if z < low {
                    break;
                }
                if list.lives(b as usize) {
                    pressed.consider(rules, f64::INFINITY, close.ends[k], || close.contact[k]);
                }
            }
        }
    });
}

/// Finds the pairs of so many parts, and adds their pushes in the order of parts.
fn in_turn(
    form: Form,
    parts: usize,
    (rules, pressed): (&Rules, &mut Vec<Pressed>),
    repulsion: &mut Repulsion,
    find: impl Fn(usize, &mut Pressed) + Sync,
) {
    pressed.resize_with(KEPT.min(parts).max(pressed.len()), Pressed::default);
    for first in (0..parts).step_by(KEPT) {
        let some = &mut pressed[..KEPT.min(parts - first)];
        let shared = Shared::new(some);
        par::for_rows(shared.len(), |k| {
            // SAFETY: each part has its own.
            let pressed = unsafe { &mut shared.get(k..k + 1)[0] };
            pressed.hits.count = 0;
            pressed.ends.clear();
            find(first + k, pressed);
            // SAFETY: the caller has chosen kernels that the processor has.
            unsafe { form.run(Push(&mut pressed.hits)) };
        });
        some.iter().for_each(|pressed| hand_back(pressed, rules, repulsion));
    }
}

fn hand_back(pressed: &Pressed, rules: &Rules, repulsion: &mut Repulsion) {
    let (view, hits) = (rules.view, &pressed.hits);
    for (at, &ends) in pressed.ends.iter().enumerate() {
        let [i, j] = ends.map(|p| p as usize);
        let (vi, vj) = (view.volume[i], view.volume[j]);
        let (own, far) = (rules.volume(vi, vj, true), rules.volume(vj, vi, false));
        let (d, pull) = (hits.vector(at), hits.pull[at]);
        for k in 0..3 {
            repulsion.f[i][k] += d[k] * pull * own;
            repulsion.f[j][k] -= d[k] * pull * far;
        }
        if let Some(t) = repulsion.tally.as_deref_mut() {
            let e = hits.energy(at);
            add(t, (i, e * own), (j, e * far), pull * vi * vj, d);
        }
    }
}
