//! Contact history by pair of tags: what grains remember while they touch.

/// Contacts of the last step in the order of their tags, with what each remembers.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Contacts<H> {
    /// Tags of both grains, the smaller one first; sorted.
    pub keys: Vec<[u32; 2]>,
    /// What each contact remembers, of the first grain against the second.
    pub history: Vec<H>,
}

impl<H: Copy + Default> Contacts<H> {
    /// Replaces the contacts by those of `keys` (sorted): those that were there keep their history, new ones
    /// start with none, others are forgotten. `spare` is room that is used again.
    pub fn carry(&mut self, keys: &[[u32; 2]], spare: &mut Vec<H>) {
        spare.clear();
        let mut at = 0;
        for key in keys {
            while self.keys.get(at).is_some_and(|k| k < key) {
                at += 1;
            }
            let old = self.keys.get(at) == Some(key);
            spare.push(if old { self.history[at] } else { H::default() });
            at += usize::from(old);
        }
        std::mem::swap(&mut self.history, spare);
        self.keys.clear();
        self.keys.extend_from_slice(keys);
    }

    /// Number of contacts.
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Whether nothing touches.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// Renames grains (LAMMPS gives new ids when some are deleted); `new(tag)` is `None` for those gone.
    pub fn rename(&mut self, new: impl Fn(u32) -> Option<u32>, turned: impl Fn(H) -> H) {
        let mut list: Vec<([u32; 2], H)> = vec![];
        for (key, h) in self.keys.iter().zip(&self.history) {
            let (Some(a), Some(b)) = (new(key[0]), new(key[1])) else { continue };
            list.push(if a <= b { ([a, b], *h) } else { ([b, a], turned(*h)) });
        }
        list.sort_by_key(|(key, _)| *key);
        self.keys = list.iter().map(|(key, _)| *key).collect();
        self.history = list.iter().map(|(_, h)| *h).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contacts_keep_their_history_while_they_last() {
        let mut c = Contacts::default();
        let mut spare = vec![];
        c.carry(&[[1, 2], [1, 5], [3, 4]], &mut spare);
        c.history = vec![12, 15, 34];
        c.carry(&[[1, 3], [1, 5], [2, 9], [3, 4]], &mut spare);
        assert_eq!(c.history, [0, 15, 0, 34]);
        c.carry(&[], &mut spare);
        c.carry(&[[1, 5]], &mut spare);
        // Touching again after a separation starts anew.
        assert_eq!((c.history.as_slice(), c.len()), (&[0][..], 1));
    }

    #[test]
    fn renaming_turns_what_is_seen_from_the_other_side() {
        let mut c = Contacts { keys: vec![[1, 2], [1, 3], [2, 3]], history: vec![12, 13, 23] };
        c.rename(|t| [None, Some(3), Some(2), Some(1)][t as usize], |h| -h);
        assert_eq!(c, Contacts { keys: vec![[1, 2], [1, 3], [2, 3]], history: vec![-23, -13, -12] });
    }
}
