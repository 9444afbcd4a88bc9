//! What a fix property/atom gives particles, as sections of data files have it.

use super::{Numbers, Particles};

/// The name of molecule IDs among properties.
pub const MOLECULE: &str = "mol";

/// The properties of one fix.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Properties {
    /// The fix's ID.
    pub fix: String,
    /// Their names in the order of the fix's line: `i_flag`, `d2_heat/1` for a column of several, `mol`, `temperature` …
    pub names: Vec<String>,
    /// Their columns; `None` for molecule IDs, which particles have by themselves.
    pub columns: Vec<Option<Numbers>>,
    /// Whether data files get them.
    pub written: bool,
}

impl Properties {
    /// The column of property `k`; `None` for molecule IDs.
    pub fn column(&self, k: usize) -> Option<Numbers> {
        self.columns.get(k).copied().flatten()
    }

    /// Whether property `k` is a whole number.
    pub fn whole(&self, k: usize) -> bool {
        self.names.get(k).is_some_and(|name| name == MOLECULE || name.starts_with('i'))
    }

    /// What stands behind the heading of a data file, as in LAMMPS: a name with several columns once, without its `2`.
    pub fn heading(&self) -> String {
        let first = |name: &&String| name.split_once('/').is_none_or(|(_, column)| column == "1");
        let head = |name: &String| name.split('/').next().unwrap_or(name).replacen("2_", "_", 1);
        self.names.iter().filter(first).map(head).collect::<Vec<_>>().join(" ")
    }

    /// Gives a particle its molecule, where it can have one.
    pub fn set_molecule(p: &mut Particles, i: usize, molecule: u32) {
        if let Some(own) = p.molecule.get_mut(i) {
            *own = molecule;
        }
    }
}
