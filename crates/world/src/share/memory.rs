//! Contact history on ranks: gathered where all of it is needed.

use super::{Share, Traffic};
use crate::World;
use crate::contacts::Contacts;
use perigrain_base::comm::Comm;
use perigrain_base::comm::numbers::{next, put, take};

impl Contacts {
    /// Appends these to a message.
    pub fn write(&self, bytes: &mut Vec<u8>) {
        put(bytes, &[self.keys.len() as u32, self.width as u32]);
        put(bytes, self.keys.as_flattened());
        put(bytes, &self.history);
    }

    /// These alone as a message.
    pub fn letter(&self) -> Vec<u8> {
        let mut bytes = vec![];
        self.write(&mut bytes);
        bytes
    }

    /// Takes those at the front of a message.
    pub fn read(bytes: &mut &[u8]) -> Option<Self> {
        let [count, width] = next::<u32, 2>(bytes)?.map(|n| n as usize);
        let mut contacts = Self { keys: vec![[0; 2]; count], width, history: vec![0.0; count * width] };
        take(bytes, contacts.keys.as_flattened_mut());
        take(bytes, &mut contacts.history);
        Some(contacts)
    }

    /// All of these together, each once.
    pub fn joined(all: &[Self]) -> Self {
        let rows = all
            .iter()
            .enumerate()
            .flat_map(|(from, c)| c.keys.iter().zip(0..).map(move |(k, at)| (*k, from, at)));
        let mut rows: Vec<([u32; 2], usize, usize)> = rows.collect();
        rows.sort_unstable();
        rows.dedup_by_key(|row| row.0);
        let width = all.iter().map(|c| c.width).max().unwrap_or(0);
        let mut joined = Self { keys: Vec::with_capacity(rows.len()), width, history: vec![] };
        joined.history.reserve_exact(rows.len() * width);
        for (key, from, at) in rows {
            let own = all[from].width;
            joined.keys.push(key);
            joined.history.extend_from_slice(&all[from].history[at * own..][..own]);
            joined.history.resize(joined.keys.len() * width, 0.0);
        }
        joined
    }
}

/// What all ranks have, joined.
pub fn joined_of_all(comm: &dyn Comm, own: &Contacts) -> Contacts {
    let pieces = comm.pieces(own.letter());
    let all: Vec<Contacts> = pieces.iter().filter_map(|piece| Contacts::read(&mut &piece[..])).collect();
    Contacts::joined(&all)
}

impl World {
    /// Contacts with walls of all ranks' rows.
    pub(super) fn gather_wall_contacts(&mut self, share: &mut Share) {
        let walls = self.wall_contacts.past_mut();
        let comm = &*share.comm;
        let mut own = vec![];
        walls.values().for_each(|contacts| contacts.write(&mut own));
        let pieces = comm.pieces(own);
        share.traffic += Traffic { gathers: 1, sent: pieces[comm.rank()].len() as u64 };
        let mut rest: Vec<&[u8]> = pieces.iter().map(|piece| &piece[..]).collect();
        for contacts in walls.values_mut() {
            let all: Vec<Contacts> = rest.iter_mut().filter_map(Contacts::read).collect();
            *contacts = Contacts::joined(&all);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contacts(keys: &[[u32; 2]], width: usize) -> Contacts {
        let history =
            keys.iter().flat_map(|[a, b]| (0..width).map(move |k| f64::from(10 * a + b) + k as f64 / 8.0));
        Contacts { keys: keys.to_vec(), width, history: history.collect() }
    }

    #[test]
    fn what_ranks_remember_is_joined_in_the_order_of_keys() {
        let [a, b] = [contacts(&[[1, 2], [4, 0]], 2), contacts(&[[1, 0], [1, 2], [7, 8]], 2)];
        let joined = Contacts::joined(&[a, b, Contacts::default()]);
        assert_eq!(joined, contacts(&[[1, 0], [1, 2], [4, 0], [7, 8]], 2));
        assert!(joined.sound());
        assert_eq!(Contacts::joined(&[]), Contacts::default());
    }

    #[test]
    fn messages_bring_the_same_bits() {
        let own = contacts(&[[3, 9], [5, 6]], 3);
        let mut bytes = vec![];
        own.write(&mut bytes);
        Contacts::default().write(&mut bytes);
        let mut rest = &bytes[..];
        assert_eq!(Contacts::read(&mut rest), Some(own));
        assert_eq!(Contacts::read(&mut rest), Some(Contacts::default()));
        assert_eq!(Contacts::read(&mut rest), None);
    }
}
