//! Values that computes, fixes and variables have produced, ready for their readers.

use super::Numbers;
use std::collections::BTreeMap;

/// Which slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SlotId(pub usize);

/// Which kinds of values a producer has; what else stands in its slot means nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Offers {
    /// A single number.
    pub scalar: bool,
    /// A global vector.
    pub vector: bool,
    /// A global array.
    pub array: bool,
    /// Values per particle.
    pub atom: bool,
    /// Local values.
    pub local: bool,
}

/// One producer's latest values.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Slot {
    /// What it belongs to: `c_dmg`, `f_ball`, `v_zc`.
    pub name: String,
    /// The step the values belong to; `None` before the first.
    pub step: Option<i64>,
    /// The single number, if it has one.
    pub scalar: f64,
    /// The global vector, if it has one.
    pub vector: Vec<f64>,
    /// Per-particle values, `cols` per particle, row by row; 0 outside the producer's group.
    pub atom: Vec<f64>,
    /// Columns of `atom` (1 for a per-atom vector, 0 for none).
    pub cols: usize,
    /// The global array, row by row; its number of rows may change from step to step, as may a vector's length.
    pub array: Vec<f64>,
    /// Columns of `array`.
    pub array_cols: usize,
    /// Local values (of pairs, bonds …), row by row, as many rows as there are such things now.
    pub local: Vec<f64>,
    /// Columns of `local` (1 for a local vector, 0 for none).
    pub local_cols: usize,
    /// What other styles need of it and decks cannot name.
    pub inner: Vec<f64>,
    /// What holds the number of the chunks of which there is a row each, where it may change.
    #[serde(skip)]
    pub chunks: Option<Numbers>,
    /// Which of all these the producer has; set when a plan is sealed.
    pub offers: Offers,
}

impl Slot {
    /// Drops the values and frees their memory.
    pub fn empty(&mut self) {
        *self = Self { name: std::mem::take(&mut self.name), ..Self::default() };
    }

    /// The per-particle value of particle `i`, column `c` (from 0); 0 for particles that came later.
    pub fn atom_value(&self, i: usize, c: usize) -> f64 {
        self.atom.get(i * self.cols + c).copied().unwrap_or(0.0)
    }

    /// Row `r`, column `c` (from 0) of the global array; `None` outside.
    pub fn cell(&self, r: usize, c: usize) -> Option<f64> {
        (c < self.array_cols).then(|| self.array.get(r * self.array_cols + c).copied()).flatten()
    }

    /// Column `c` (from 0) of the global array.
    pub fn array_column(&self, c: usize) -> Vec<f64> {
        column(&self.array, self.array_cols, c)
    }

    /// Column `c` (from 0) of the local values.
    pub fn local_column(&self, c: usize) -> Vec<f64> {
        column(&self.local, self.local_cols, c)
    }
}

fn column(rows: &[f64], cols: usize, c: usize) -> Vec<f64> {
    if c < cols { rows.iter().skip(c).step_by(cols).copied().collect() } else { vec![] }
}

/// All slots; ids stay valid while their producer exists.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
#[serde(from = "Kept")]
pub struct Slots {
    #[serde(serialize_with = "of_fixes")]
    slots: Vec<Slot>,
    #[serde(skip)]
    by_name: BTreeMap<String, usize>,
    /// Slots whose producers have gone, for the next ones.
    #[serde(skip)]
    free: Vec<usize>,
}

/// Slots as a restart file holds them.
#[derive(serde::Deserialize)]
#[serde(rename = "Slots")]
struct Kept {
    slots: Vec<Slot>,
}

impl From<Kept> for Slots {
    fn from(kept: Kept) -> Self {
        let names = kept.slots.iter().enumerate().rev();
        let by_name = names.map(|(k, s)| (s.name.clone(), k)).collect();
        Self { slots: kept.slots, by_name, free: vec![] }
    }
}

/// A restart file holds what fixes offer: they act within steps, all others are evaluated anew.
fn of_fixes<S: serde::Serializer>(slots: &[Slot], to: S) -> Result<S::Ok, S::Error> {
    let kept: Vec<&Slot> = slots.iter().filter(|s| s.name.starts_with("f_")).collect();
    to.collect_seq(kept)
}

impl Slots {
    /// Whether rows of values are whole.
    pub fn are_sound(&self) -> bool {
        let whole = |len: usize, cols: usize| if cols == 0 { len == 0 } else { len.is_multiple_of(cols) };
        self.slots.iter().all(|s| {
            whole(s.atom.len(), s.cols)
                && whole(s.array.len(), s.array_cols)
                && whole(s.local.len(), s.local_cols)
        })
    }

    /// The slot of this name, new if there is none.
    pub fn id(&mut self, name: &str) -> SlotId {
        if let Some(k) = self.by_name.get(name) {
            return SlotId(*k);
        }
        let k = self.free.pop().unwrap_or(self.slots.len());
        if k == self.slots.len() {
            self.slots.push(Slot::default());
        }
        self.slots[k].name = name.to_string();
        self.by_name.insert(name.to_string(), k);
        SlotId(k)
    }

    /// The slot of this name, if it exists.
    pub fn find(&self, name: &str) -> Option<SlotId> {
        self.by_name.get(name).copied().map(SlotId)
    }

    /// Gives the slots of a producer that has gone back, and those of what was evaluated for it (`NAME#PRODUCER …`).
    pub fn forget(&mut self, producer: &str) {
        let mut gone = vec![];
        self.by_name.retain(|name, k| {
            let (of, by) = name.split_once('#').unwrap_or((name, ""));
            let stays = of != producer && by.split(' ').next() != Some(producer);
            gone.extend((!stays).then_some(*k));
            stays
        });
        gone.iter().for_each(|k| self.slots[*k] = Slot::default());
        self.free.extend(gone);
    }

    /// How many there are, those that wait for a new producer included.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// Reads a slot.
    pub fn get(&self, id: SlotId) -> &Slot {
        &self.slots[id.0]
    }

    /// Writes a slot.
    pub fn get_mut(&mut self, id: SlotId) -> &mut Slot {
        &mut self.slots[id.0]
    }

    /// Takes a slot's content out to fill it while the world is read; give it back with `put`.
    pub fn take(&mut self, id: SlotId) -> Slot {
        std::mem::take(&mut self.slots[id.0])
    }

    /// Gives a slot's content back, belonging to `step`.
    pub fn put(&mut self, id: SlotId, mut slot: Slot, step: i64) {
        slot.step = Some(step);
        self.slots[id.0] = slot;
    }

    /// Keeps the values of particle `old[k]` at each new index `k`, of `n` particles before.
    pub fn gather(&mut self, old: &[usize], n: usize) {
        for s in self.slots.iter_mut().filter(|s| s.cols > 0 && s.atom.len() == n * s.cols) {
            s.atom = old.iter().flat_map(|&k| s.atom[k * s.cols..(k + 1) * s.cols].to_vec()).collect();
        }
    }

    /// Marks every value as out of date (the scene has changed).
    pub fn invalidate(&mut self) {
        for s in &mut self.slots {
            s.step = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_read_by_cell_and_by_column() {
        let s = Slot { array: vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0], array_cols: 2, ..Slot::default() };
        assert_eq!((s.cell(2, 1), s.cell(3, 0), s.cell(0, 2)), (Some(6.0), None, None));
        assert_eq!(s.array_column(1), [2.0, 4.0, 6.0]);
        assert!(s.array_column(2).is_empty() && s.local_column(0).is_empty());
    }

    #[test]
    fn slots_of_producers_that_have_gone_are_used_again() {
        let mut s = Slots::default();
        let stays = s.id("f_ball");
        for k in 0..100 {
            let (name, of) = (format!("c_c{k}"), format!("ke#c_c{k} Output 1"));
            let (own, read) = (s.id(&name), s.id(&of));
            s.get_mut(own).scalar = 7.0;
            assert_eq!((s.id(&name), s.find(&of)), (own, Some(read)));
            s.id(&format!("v_v{k}#3"));
            s.forget(&name);
            s.forget(&format!("v_v{k}"));
            assert_eq!((s.find(&name), s.find(&of), s.find("f_ball")), (None, None, Some(stays)));
        }
        let anew = s.id("c_c");
        assert_eq!((s.slots.len(), s.get(anew).scalar, &*s.get(anew).name), (4, 0.0, "c_c"));
        s.get_mut(stays).scalar = 3.0;
        let mut read: Slots = toml::from_str(&toml::to_string(&s).unwrap()).unwrap();
        let ball = read.id("f_ball");
        assert_eq!((read.slots.len(), read.get(ball).scalar), (1, 3.0));
    }
}
