//! Contact history by pair: the state of grains that touch each other or a wall.

use super::moving::Under;
use super::named::Key;
use perigrain_base::math::vec3::Vec3;

/// Contacts of the last step in the order of their keys, with the history of each.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Contacts {
    /// Tags of both grains, the smaller one first; of a wall's contacts the grain's tag and the part of the wall.
    /// Sorted.
    pub keys: Vec<[u32; 2]>,
    /// How many numbers the history of a contact has.
    pub width: usize,
    /// The history of each contact, of the first grain against the second: `width` numbers each.
    pub history: Vec<f64>,
}

/// Turns a contact's history around, from one grain's view to the other's: displacements across the normal, the first three
/// numbers, change sign; rolling displacements and angles of twisting are the same.
pub fn mirror(history: &mut [f64]) {
    history.iter_mut().take(3).for_each(|a| *a = -*a);
}

/// Turns a contact's history of two sides ([`Under::Sides`]) around, from one grain's view to the other's.
pub fn swap_sides(history: &mut [f64]) {
    let half = history.len() / 2;
    (0..half).for_each(|k| history.swap(k, half + k));
}

/// Where contacts between particles of two types, kept under this name, keep their rolling displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rolls {
    /// The name.
    pub of: Key<Contacts>,
    /// The types, the lower one first.
    pub types: [u16; 2],
    /// The first of its three numbers.
    pub at: usize,
}

impl Contacts {
    /// Those whose keys lie between these two, both included.
    #[must_use]
    pub fn between(&self, first: [u32; 2], last: [u32; 2]) -> Self {
        let from = self.keys.partition_point(|key| *key < first);
        let end = self.keys.partition_point(|key| *key <= last);
        let history = self.history[from * self.width..end * self.width].to_vec();
        Self { keys: self.keys[from..end].to_vec(), width: self.width, history }
    }

    /// Rotates the vectors of space in the history: the displacement (or force) across the normal, the first three numbers, and
    /// the rolling displacement. `types` are those of both particles, if both are turned.
    pub fn turn(
        &mut self,
        own: Key<Contacts>,
        rolls: &[Rolls],
        types: impl Fn([u32; 2]) -> Option<[u16; 2]>,
        turn: impl Fn(Vec3) -> Vec3,
    ) {
        if own.under() == Some(Under::Sides) || self.width < 3 {
            return;
        }
        for (key, row) in self.keys.iter().zip(self.history.chunks_exact_mut(self.width)) {
            let Some([a, b]) = types(*key) else { continue };
            let pair = [a.min(b), a.max(b)];
            let rolling = rolls.iter().find(|r| r.of == own && r.types == pair).map(|r| r.at);
            for at in [Some(0), rolling].into_iter().flatten() {
                if let Some(spring) = row.get_mut(at..at + 3).and_then(|three| three.first_chunk_mut::<3>()) {
                    *spring = turn(*spring);
                }
            }
        }
    }

    /// Replaces the contacts by those of `keys` (sorted), `width` numbers each: existing ones keep their history, new ones start
    /// with zeros, others are dropped. `spare` is a buffer that is used again.
    pub fn carry(&mut self, keys: &[[u32; 2]], width: usize, spare: &mut Vec<f64>) {
        if self.width == width && self.keys == keys {
            return;
        }
        // All of it is written.
        spare.resize(keys.len() * width, 0.0);
        let kept = width.min(self.width);
        let mut at = 0;
        for (new, key) in keys.iter().enumerate() {
            while self.keys.get(at).is_some_and(|k| k < key) {
                at += 1;
            }
            let (row, mut filled) = (&mut spare[new * width..][..width], 0);
            if self.keys.get(at) == Some(key) {
                row[..kept].copy_from_slice(&self.history[at * self.width..][..kept]);
                (at, filled) = (at + 1, kept);
            }
            row[filled..].fill(0.0);
        }
        std::mem::swap(&mut self.history, spare);
        self.width = width;
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

    /// The history of the contact with this key, if there is one.
    pub fn get(&self, key: [u32; 2]) -> Option<&[f64]> {
        let at = self.keys.binary_search(&key).ok()?;
        Some(&self.history[at * self.width..][..self.width])
    }

    /// Whether keys and history fit together.
    pub fn sound(&self) -> bool {
        self.keys.len().checked_mul(self.width) == Some(self.history.len())
    }

    /// Renames grains (LAMMPS gives new ids when some are deleted); `new(key)` is the new key, `None` for those gone, and whether
    /// the contact is now seen from the other side: `turn` converts its history then.
    pub fn rename(&mut self, new: impl Fn([u32; 2]) -> Option<([u32; 2], bool)>, turn: impl Fn(&mut [f64])) {
        let mut list: Vec<([u32; 2], Vec<f64>)> = vec![];
        for (k, key) in self.keys.iter().enumerate() {
            let Some((key, turned)) = new(*key) else { continue };
            let mut history = self.history[k * self.width..][..self.width].to_vec();
            if turned {
                turn(&mut history);
            }
            list.push((key, history));
        }
        list.sort_by_key(|(key, _)| *key);
        self.keys = list.iter().map(|(key, _)| *key).collect();
        self.history = list.into_iter().flat_map(|(_, h)| h).collect();
    }
}

/// A particle's contact with a wall, as the ledger of energy books it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WallTouch {
    /// Which particle.
    pub grain: u32,
    /// Unit vector from the wall to its centre.
    pub normal: [f64; 3],
    /// How the wall moves there [length/time].
    pub velocity: [f64; 3],
    /// Force on the particle [force].
    pub force: [f64; 3],
    /// Torque on it.
    pub torque: [f64; 3],
    /// Elastic and cohesive force along the normal, without damping [force].
    pub push: f64,
    /// Energy of the overlap and of the tangential spring [energy].
    pub stored: [f64; 2],
    /// Whether what the push takes besides is flow.
    pub flows: bool,
}

/// What the contacts of a pair style did at a step beside the elastic forces of overlaps, as the ledger of energy books it: sums by
/// particle, since power is force times velocity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PairWork {
    /// When.
    pub step: i64,
    /// Damping along the normals [force].
    pub damping: Vec<[f64; 3]>,
    /// What acts across them [force].
    pub across: Vec<[f64; 3]>,
    /// Torques.
    pub torque: Vec<[f64; 3]>,
    /// The elastic and cohesive forces of laws that flow; empty where none does [force].
    pub pressing: Vec<[f64; 3]>,
    /// What overlaps of laws that flow hold [energy].
    pub held: f64,
}

impl PairWork {
    /// Nothing yet, of `n` particles; whether a law `flows`.
    pub fn begin(&mut self, n: usize, step: i64, flows: bool) {
        (self.step, self.held) = (step, 0.0);
        for sums in [&mut self.damping, &mut self.across, &mut self.torque, &mut self.pressing] {
            sums.clear();
        }
        for sums in [&mut self.damping, &mut self.across, &mut self.torque] {
            sums.resize(n, [0.0; 3]);
        }
        self.pressing.resize(if flows { n } else { 0 }, [0.0; 3]);
    }
}

/// The springs of a particle's contact with a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallSpring {
    /// The particle's tag.
    pub tag: u32,
    /// Unit vector from the wall to its centre.
    pub normal: [f64; 3],
    /// Stiffness along it and across it [force/length], and against rolling and twisting [torque].
    pub stiffness: [f64; 4],
    /// Damping of the same.
    pub damping: [f64; 4],
    /// How far from its centre they touch [length].
    pub arm: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_of_them_by_their_keys() {
        let keys = vec![[1, 2], [1, 5], [1, 5], [3, 4]];
        let all = Contacts { keys, width: 2, history: (0..8).map(f64::from).collect() };
        let some = all.between([1, 3], [1, 5]);
        assert_eq!((some.keys, some.width, some.history), (vec![[1, 5]; 2], 2, vec![2.0, 3.0, 4.0, 5.0]));
        assert!(
            all.between([1, 6], [3, 3]).keys.is_empty()
                && Contacts::default().between([0, 0], [9, 9]).is_empty()
        );
    }

    #[test]
    fn contacts_keep_their_history_while_they_last() {
        let mut c = Contacts::default();
        let mut spare = vec![];
        c.carry(&[[1, 2], [1, 5], [3, 4]], 2, &mut spare);
        c.history = vec![12.0, 0.5, 15.0, 1.5, 34.0, 2.5];
        c.carry(&[[1, 3], [1, 5], [2, 9], [3, 4]], 2, &mut spare);
        assert_eq!(c.history, [0.0, 0.0, 15.0, 1.5, 0.0, 0.0, 34.0, 2.5]);
        assert_eq!(c.get([3, 4]), Some(&[34.0, 2.5][..]));
        // A law with a longer history continues from the numbers there are.
        c.carry(&[[1, 5]], 3, &mut spare);
        assert_eq!(c.history, [15.0, 1.5, 0.0]);
        c.carry(&[], 3, &mut spare);
        c.carry(&[[1, 5]], 3, &mut spare);
        // Touching again after a separation starts anew.
        assert_eq!((c.history.as_slice(), c.len()), (&[0.0; 3][..], 1));
    }

    #[test]
    fn renaming_turns_what_is_seen_from_the_other_side() {
        let mut c =
            Contacts { keys: vec![[1, 2], [1, 3], [2, 3]], width: 1, history: vec![12.0, 13.0, 23.0] };
        // Tags 2 and 3 change places.
        let tag = |t: u32| [0, 1, 3, 2][t as usize];
        let new = |[a, b]: [u32; 2]| {
            let (a, b) = (tag(a), tag(b));
            Some(([a.min(b), a.max(b)], a > b))
        };
        c.rename(new, mirror);
        let expected =
            Contacts { keys: vec![[1, 2], [1, 3], [2, 3]], width: 1, history: vec![13.0, 12.0, -23.0] };
        assert_eq!(c, expected);
    }
}
