//! Bonds follow their particles, which a run sorts into spatial order again and again.

use super::{Columns, GROUP, Key};
use perigrain_base::math::body::UNTURNED;
use perigrain_base::par::{self, Shared};

impl<const C: usize> Columns<C> {
    /// The same bonds after a reordering of particles: `moved[k]` is the new index of particle `k`. The bonds
    /// of each particle are in the order of [`Columns::fill`] with the intact bonds; the rows stay in place
    /// until they are sorted, which takes several times as long and does not affect sums by particle. Columns
    /// with broken bonds are sorted.
    ///
    /// # Panics
    /// If `moved` does not have a new index for each particle.
    pub fn follow(&mut self, moved: &[u32]) {
        for places in &mut self.ends {
            par::each(&mut places[..], |_, places: &mut [u32]| {
                places.iter_mut().for_each(|place| *place = moved[*place as usize]);
            });
        }
        self.in_order = false;
        if self.fewer {
            return self.put_in_order();
        }
        let reach = |places: &Vec<u32>| places.iter().copied().max().map_or(0, |place| place as usize + 1);
        self.reach = self.ends.iter().map(reach).max().unwrap_or(0);
        let mut from = vec![0; moved.len()];
        moved.iter().enumerate().for_each(|(k, to)| from[*to as usize] = k);
        let old = &self.holders;
        let mut starts = vec![0; moved.len() + 1];
        for (k, from) in from.iter().enumerate() {
            starts[k + 1] = starts[k] + old.of(*from).len() as u32;
        }
        let mut entries = vec![0; old.entries.len()];
        let all = Shared::new(&mut entries);
        par::for_chunks(moved.len(), |chunk| {
            for place in chunk {
                let range = starts[place] as usize..starts[place + 1] as usize;
                // SAFETY: the ranges of different particles are disjoint.
                let own = unsafe { all.get(range) };
                own.copy_from_slice(old.of(from[place]));
                let partner = |entry: &u32| {
                    let (bond, end) = (*entry as usize / 2, *entry as usize & 1);
                    (self.kind(bond), self.ends[1 - end][bond], *entry)
                };
                // Few, and nearly sorted.
                own.sort_unstable_by_key(partner);
            }
        });
        (self.holders.starts, self.holders.entries) = (starts, entries);
    }

    /// Whether bonds are in spatial order.
    pub fn in_order(&self) -> bool {
        self.in_order
    }

    /// Sorts the intact bonds into spatial order, as [`Columns::fill`] would.
    pub fn put_in_order(&mut self) {
        let particles = self.particles();
        let living: Vec<u32> = self.living().map(|row| row as u32).collect();
        let mut keys = vec![Key { kind: 0, ends: [0; 2] }; living.len()];
        par::each((&mut keys[..], &living[..]), |_, (keys, living)| {
            for (key, row) in keys.iter_mut().zip(living) {
                let ends = self.pair(*row as usize).map(|place| place as u32);
                *key = Key { kind: self.kinds[*row as usize / GROUP], ends };
            }
        });
        let mut rows = self.arrange(&keys);
        rows.iter_mut().for_each(|row| *row = living[*row as usize]);
        let mut room = Vec::with_capacity(rows.len());
        let Self { ends, alive, length, axis, turned, own, holders, .. } = self;
        par::both(
            rows.len(),
            || holders.enter(ends, alive, particles),
            || {
                // Column by column: bond by bond, all columns would be reallocated at once.
                let numbers = own.iter_mut().chain(axis).chain([length]);
                numbers.for_each(|column| rearrange(column, &rows, &mut room));
                rearrange(turned, &rows, &mut vec![]);
                if turned.iter().all(|turned| *turned == UNTURNED) {
                    turned.clear();
                }
            },
        );
    }
}

/// Reorders the numbers of a column; `room` is swapped with the column.
fn rearrange<T: Copy + Send + Sync>(column: &mut Vec<T>, rows: &[u32], room: &mut Vec<T>) {
    let Some(any) = column.first() else { return };
    // Every element is written.
    room.resize(rows.len(), *any);
    par::each((&mut room[..], rows), |_, (room, rows)| {
        room.iter_mut().zip(rows).for_each(|(to, row)| *to = column[*row as usize]);
    });
    std::mem::swap(column, room);
}
