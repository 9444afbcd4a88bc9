//! Named sets of particles, one bit each.

/// Index of a group; its bit in every particle's mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GroupId(pub u8);

impl GroupId {
    /// Everyone.
    pub const ALL: GroupId = GroupId(0);

    /// The mask bit.
    pub fn bit(self) -> u32 {
        1 << self.0
    }
}

/// The names of the groups in use (at most 32, as LAMMPS).
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Groups {
    names: [Option<String>; 32],
}

impl Default for Groups {
    fn default() -> Self {
        let mut names = [const { None }; 32];
        names[0] = Some("all".to_string());
        Self { names }
    }
}

impl Groups {
    /// The group of this name.
    pub fn find(&self, name: &str) -> Option<GroupId> {
        self.names.iter().position(|n| n.as_deref() == Some(name)).map(|k| GroupId(k as u8))
    }

    /// The group of this name, new if there is none; `None` when all 32 are taken.
    pub fn find_or_add(&mut self, name: &str) -> Option<GroupId> {
        if let Some(g) = self.find(name) {
            return Some(g);
        }
        let k = self.names.iter().position(Option::is_none)?;
        self.names[k] = Some(name.to_string());
        Some(GroupId(k as u8))
    }

    /// Forgets a group (its bit must be cleared in the masks by the caller).
    pub fn remove(&mut self, id: GroupId) {
        self.names[id.0 as usize] = None;
    }

    /// The group's name.
    pub fn name(&self, id: GroupId) -> &str {
        self.names[id.0 as usize].as_deref().unwrap_or("?")
    }

    /// All names in use, in order of definition.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().flatten().map(String::as_str)
    }
}
