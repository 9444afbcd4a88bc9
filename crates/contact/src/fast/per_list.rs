//! Contacts list by list on one thread: grains that no later list touches can be moved while they are in fast memory.
//!
//! Columns of 32,000 grains do not fit the second cache. Who moves all of them after all contacts has them brought from the third one
//! twice in a step, and a pass over the columns takes twice as long from there.

use super::{Fast, Sums};
use crate::Advance;
use crate::driver::Grains;
use perigrain_base::math::vec3::Vec3;
use perigrain_base::par;
use std::ops::Range;

/// An evaluation of all contacts that is under way.
pub struct PerList {
    /// Lists, in the order of one thread.
    order: Vec<usize>,
    /// How many lists that touch grains of each slab are still to come.
    to_come: Vec<u8>,
    done: usize,
    step: Advance,
    store: bool,
    deep: Option<([u32; 2], f64)>,
}

impl Fast {
    /// Whether an evaluation can go list by list: not where several threads share the lists, or grains of a slab do not stand beside
    /// each other. Those of a chunk are moved together anyway, and contacts of several lists go faster together.
    pub fn is_per_list(&self) -> bool {
        par::threads() == 1
            && self.len() > par::CHUNK
            && self.validity.stand_in_order()
            && self.validity_of_large.lists() == 0
    }

    /// Begins an evaluation as [`Fast::run`] does it without the virial, and with the same bits, for [`Fast::go_on`].
    pub fn begin_per_list(&mut self, grains: &Grains, step: Advance, store: bool) -> PerList {
        self.begin(grains);
        let lists = self.validity.lists();
        let (mut order, mut to_come) = std::mem::take(&mut self.spare_per_list);
        order.clear();
        order.extend_from_slice(&self.order);
        to_come.clear();
        to_come.resize(lists, 1);
        (0..lists).filter_map(|k| self.validity.next(k)).for_each(|next| to_come[next] += 1);
        PerList { order, to_come, done: 0, step, store, deep: None }
    }

    /// Adds forces and torques of one list more to `f` and `torque`; which grains have all of theirs now. `None` when all have.
    pub fn go_on(
        &mut self,
        p: &mut PerList,
        grains: &Grains,
        wrench: [&mut [Vec3]; 2],
    ) -> Option<[Range<usize>; 2]> {
        let Some(&k) = p.order.get(p.done) else {
            self.now += if p.store { 1.0 } else { 0.0 };
            self.deep = self.deep.or(p.deep);
            self.spare_per_list = (std::mem::take(&mut p.order), std::mem::take(&mut p.to_come));
            return None;
        };
        p.done += 1;
        let [force, torque] = wrench;
        self.sweep(
            grains,
            Sums { force, torque, heat: None, deeds: None },
            p.step,
            (p.store, false),
            Some(k),
        );
        if self.deep.is_none() && self.lists[k].deep {
            let found = self.find_deep(grains, &self.lists[k..k + 1]);
            p.deep = p.deep.into_iter().chain(found).min_by_key(|(ids, _)| *ids);
        }
        let mut ready = |slab: Option<usize>| {
            let Some(slab) = slab else { return 0..0 };
            p.to_come[slab] -= 1;
            if p.to_come[slab] == 0 { self.validity.members(slab) } else { 0..0 }
        };
        Some([ready(Some(k)), ready(self.validity.next(k))])
    }
}
