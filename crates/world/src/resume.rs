//! What passes from one run of the program to the next: declarations, and state that waits for its fix.

use super::{Lattice, Tracked, World};
use perigrain_base::diag::Result;

/// The scene as a restart file describes it: as long as all of it still holds, its forces are valid.
#[derive(Clone, Debug, Default)]
pub struct Resume {
    /// All lines that decide about forces.
    pub declared: Vec<String>,
    /// A checksum of the scene.
    pub fingerprint: u32,
    /// The bits of the groups it had.
    pub bits: u32,
    /// The names of its regions, materials and stored state.
    pub names: Vec<String>,
}

/// A line of a deck and the lattice in force at that line: its distances may be in spacings.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename = "Said")]
pub struct DeclaredLine {
    /// The words, the first being the command.
    pub words: Vec<String>,
    /// The lattice.
    pub lattice: Lattice,
}

impl World {
    /// The scene as a restart file holds it, with what is known of it while a deck is only checked.
    pub fn stored(&self) -> World {
        World {
            facts: Tracked::default(),
            changed: Tracked::default(),
            notes: Tracked::default(),
            outlines: Tracked::default(),
            promised: Tracked::default(),
            restored: Tracked::default(),
            resume: None,
            ..self.clone()
        }
    }

    /// Calls `declare`, which makes the state that belongs to `key` (a fix as `STYLE/ID`, a compute as `compute ID`, both perhaps followed by a name), and puts back what
    /// a restart file had under this key.
    ///
    /// # Errors
    /// Those of `declare`.
    pub fn inherit(&mut self, key: &str, declare: impl FnOnce(&mut World) -> Result<()>) -> Result<()> {
        let belongs =
            |name: &str| name.strip_prefix(key).is_some_and(|r| r.is_empty() || r.starts_with(['/', ' ']));
        let before = self.restored.len();
        self.restored.retain(|name| !belongs(name));
        if self.restored.len() == before {
            return declare(self);
        }
        let columns = self.columns.split_off(|name| !belongs(name));
        let memo = self.memo.split_off(|key| !belongs(key.text()));
        // What a fix offered then it offers still: `declare` shows it the present.
        let offered = key.rsplit('/').next().and_then(|id| self.slots.find(&format!("f_{id}")));
        let offered = offered.map(|id| (id, self.slots.get(id).clone()));
        let outcome = declare(self);
        if let Some((id, slot)) = offered {
            *self.slots.get_mut(id) = slot;
        }
        self.columns.put(columns);
        self.memo.extend(memo);
        outcome
    }
}
