//! Values that computes, fixes and variables have produced, ready for whoever reads them.

use super::Numbers;

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
    /// Forgets the values and gives their memory back.
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
pub struct Slots {
    #[serde(serialize_with = "of_fixes")]
    slots: Vec<Slot>,
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
        if let Some(k) = self.slots.iter().position(|s| s.name == name) {
            return SlotId(k);
        }
        self.slots.push(Slot { name: name.to_string(), ..Slot::default() });
        SlotId(self.slots.len() - 1)
    }

    /// The slot of this name, if it exists.
    pub fn find(&self, name: &str) -> Option<SlotId> {
        self.slots.iter().position(|s| s.name == name).map(SlotId)
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

    /// Forgets which step every value belongs to (the scene has changed).
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
}
