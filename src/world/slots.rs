//! Values that computes, fixes and variables have produced, ready for whoever reads them.

/// Which slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SlotId(pub usize);

/// One producer's latest values.
#[derive(Clone, Debug, Default)]
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
}

impl Slot {
    /// The per-particle value of particle `i`, column `c` (from 0).
    pub fn atom_value(&self, i: usize, c: usize) -> f64 {
        self.atom[i * self.cols + c]
    }
}

/// All slots; ids stay valid while their producer exists.
#[derive(Clone, Debug, Default)]
pub struct Slots {
    slots: Vec<Slot>,
}

impl Slots {
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
        let name = self.slots[id.0].name.clone();
        std::mem::replace(&mut self.slots[id.0], Slot { name, ..Slot::default() })
    }

    /// Gives a slot's content back, belonging to `step`.
    pub fn put(&mut self, id: SlotId, mut slot: Slot, step: i64) {
        slot.step = Some(step);
        self.slots[id.0] = slot;
    }

    /// Forgets which step every value belongs to (the scene has changed).
    pub fn invalidate(&mut self) {
        for s in &mut self.slots {
            s.step = None;
        }
    }
}
