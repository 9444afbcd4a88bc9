//! Named per-particle columns beyond the core ones: they follow every reordering and deletion.

use std::borrow::Cow;
use std::collections::BTreeMap;

/// The property of fix property/atom that holds temperatures.
pub const TEMPERATURE: &str = "temperature";
/// The property of fix property/atom that holds the heat flowing into particles, summed anew in each step.
pub const HEATFLOW: &str = "heatflow";
/// The property that holds the volumes of particles joined by `bond_style bpm/peri`.
pub const VOLUME_PROPERTY: &str = "d_vfrac";

/// How the names of columns of plastic grains begin (normal model `mdr`): decks read them as those of fix property/atom.
pub const PLASTIC_COLUMNS: &str = "property/atom/mdr/";
/// Under this name the last step that plastic grains have begun is kept.
pub const PLASTIC_BEGUN: &str = "mdr/begun";

/// How the names of the columns begin that keep forces and torques of levels of steps between steps.
pub const LEVEL: &str = "level/";

/// The vector columns that keep forces and torques of a level of steps.
pub fn of_level(level: usize) -> [String; 2] {
    ["force", "torque"].map(|what| format!("{LEVEL}{level}/{what}"))
}

/// The scalar column that keeps the heat flow of a level of steps.
pub fn heat_of_level(level: usize) -> String {
    format!("{LEVEL}{level}/heat")
}

/// Named scalar and vector columns, kept in step with the particles.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Columns {
    scalars: BTreeMap<String, Vec<f64>>,
    vectors: BTreeMap<String, Vec<[f64; 3]>>,
}

/// The column of this name; the name is copied only for a new one.
fn of<'a, T>(columns: &'a mut BTreeMap<String, T>, name: &str, new: impl FnOnce() -> T) -> &'a mut T {
    if !columns.contains_key(name) {
        columns.insert(name.to_string(), new());
    }
    columns.get_mut(name).expect("it is there now")
}

impl Columns {
    /// The scalar column of this name, made of zeros for `n` particles if it is new.
    pub fn scalar(&mut self, name: &str, n: usize) -> &mut Vec<f64> {
        of(&mut self.scalars, name, || vec![0.0; n])
    }

    /// The vector column of this name, made of zeros for `n` particles if it is new.
    pub fn vector(&mut self, name: &str, n: usize) -> &mut Vec<[f64; 3]> {
        of(&mut self.vectors, name, || vec![[0.0; 3]; n])
    }

    /// The full name of the column behind a deck's `i_NAME`, `d_NAME`, `i2_NAME[k]`, `d2_NAME[k]`, `temperature` or
    /// `heatflow` (fix property/atom).
    pub fn custom(&self, word: &str) -> Option<String> {
        let name = match word.strip_suffix(']').and_then(|w| w.split_once('[')) {
            Some((head, k)) => Cow::Owned(format!("{head}/{k}")),
            None => Cow::Borrowed(word),
        };
        let own = |full: &&String| {
            full.strip_prefix("property/atom/")
                .and_then(|r| r.split_once('/'))
                .is_some_and(|(_, n)| n == name)
        };
        self.scalars.keys().find(own).cloned()
    }

    /// The column that a full name of fix property/atom means now: itself, or that of another fix which has the same property.
    pub fn present(&self, full: &str) -> Option<String> {
        if self.scalars.contains_key(full) {
            return Some(full.to_string());
        }
        self.custom(full.splitn(4, '/').nth(3)?)
    }

    /// The vector column of this name, if there is one.
    pub fn get_vector(&self, name: &str) -> Option<&[[f64; 3]]> {
        self.vectors.get(name).map(Vec::as_slice)
    }

    /// The scalar column of this name, if there is one.
    pub fn get_scalar(&self, name: &str) -> Option<&[f64]> {
        self.scalars.get(name).map(Vec::as_slice)
    }

    /// The scalar columns whose names end like this.
    pub fn ending<'a>(&'a self, tail: &'a str) -> impl Iterator<Item = &'a [f64]> {
        self.scalars.iter().filter(move |(name, _)| name.ends_with(tail)).map(|(_, c)| c.as_slice())
    }

    /// Forgets a column of either kind.
    pub fn remove(&mut self, name: &str) {
        self.scalars.remove(name);
        self.vectors.remove(name);
    }

    /// Lets two scalar columns change places, each made of zeros for `n` particles if it is new.
    pub fn swap_scalars(&mut self, a: &str, b: &str, n: usize) {
        let of_a = std::mem::take(self.scalar(a, n));
        let of_b = std::mem::replace(self.scalar(b, n), of_a);
        *self.scalar(a, n) = of_b;
    }

    /// Forgets the forces, torques and heat flows of levels of steps.
    pub fn forget_levels(&mut self) {
        self.scalars.retain(|name, _| !name.starts_with(LEVEL));
        self.vectors.retain(|name, _| !name.starts_with(LEVEL));
    }

    /// Takes out the columns whose names `keep` does not hold.
    pub fn split_off(&mut self, keep: impl Fn(&str) -> bool) -> Columns {
        let mut out = Columns::default();
        for name in self.names().into_iter().filter(|n| !keep(n)) {
            out.scalars.extend(self.scalars.remove_entry(&name));
            out.vectors.extend(self.vectors.remove_entry(&name));
        }
        out
    }

    /// Puts columns in, in place of those of the same names.
    pub fn put(&mut self, more: Columns) {
        self.scalars.extend(more.scalars);
        self.vectors.extend(more.vectors);
    }

    /// All names.
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = self.scalars.keys().chain(self.vectors.keys()).cloned().collect();
        names.dedup();
        names
    }

    /// Whether every column has `n` entries.
    pub fn have(&self, n: usize) -> bool {
        self.scalars.values().all(|c| c.len() == n) && self.vectors.values().all(|c| c.len() == n)
    }

    /// Gives every column room for `n` particles, zeros for new ones.
    pub fn resize(&mut self, n: usize) {
        self.scalars.values_mut().for_each(|c| c.resize(n, 0.0));
        self.vectors.values_mut().for_each(|c| c.resize(n, [0.0; 3]));
    }

    /// Keeps `old[new_index]` at each new index.
    pub fn gather(&mut self, old: &[usize]) {
        for c in self.scalars.values_mut() {
            *c = old.iter().map(|&k| c[k]).collect();
        }
        for c in self.vectors.values_mut() {
            *c = old.iter().map(|&k| c[k]).collect();
        }
    }
}
