//! Named per-particle columns beyond the core ones: they follow every reordering and deletion.

use super::acting::by_name;
use super::moving::Under;
use super::named::{Constant, Key, Named, Numbers, Vectors};
use std::borrow::Cow;

/// The property of fix property/atom that holds temperatures.
pub static TEMPERATURE: Constant<Vec<f64>> = Constant::new("temperature");
/// The property of fix property/atom that holds the heat flowing into particles, summed anew in each step.
pub static HEATFLOW: Constant<Vec<f64>> = Constant::new("heatflow");
/// What flow of materials has turned into heat that `fix heat/peri` has not taken yet [energy].
pub static PLASTIC_HEAT: Constant<Vec<f64>> = Constant::new("plastic heat");
/// The property that holds the volumes of particles joined by `bond_style bpm/peri`.
pub static VOLUME_PROPERTY: Constant<Vec<f64>> = Constant::new("d_vfrac");

/// How the names of the columns begin that keep forces and torques of levels of steps between steps.
pub const LEVEL: &str = "level/";

/// The role of the columns that keep how far particles have gone in a step of a level, and their mean spins.
pub static LEVEL_PATH: Constant<Vec<[f64; 3]>> = Constant::new("/level path");

/// The columns that keep what a level of steps has of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// Forces and torques.
    pub forces: [Vectors; 2],
    /// Heat flow.
    pub heat: Numbers,
    /// How far particles have gone in a step of it, over its length, and their mean spins; while the step is under way, how far
    /// they have gone so far.
    pub path: [Vectors; 2],
}

impl Level {
    /// Those of a level, from 0.
    pub fn new(level: usize) -> Self {
        let of = |what| format!("{LEVEL}{level}/{what}");
        let vectors = |words: [&'static str; 2]| words.map(|what| Key::new(&of(what)).moved(Under::Anew));
        Self {
            forces: vectors(["force", "torque"]),
            heat: Key::new(&of("heat")),
            path: vectors(["path", "spin"]).map(|key: Vectors| key.in_role(LEVEL_PATH.text())),
        }
    }
}

/// Named scalar and vector columns, kept in step with the particles.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Columns {
    scalars: Named<Vec<f64>>,
    vectors: Named<Vec<[f64; 3]>>,
    /// What particles that join have in a scalar column, where that is not 0; lines of a deck set it, files do not hold it.
    #[serde(skip)]
    starts: Vec<(Numbers, f64)>,
}

impl Columns {
    /// The scalar column of this name, made of zeros for `n` particles if it is new.
    pub fn scalar(&mut self, key: Numbers, n: usize) -> &mut Vec<f64> {
        self.scalars.get_or(key, || vec![0.0; n])
    }

    /// Gives the particles of a new scalar column this value, and those that join later; a column that is there keeps its numbers.
    pub fn start(&mut self, key: Numbers, n: usize, value: f64) {
        self.scalars.get_or(key, || vec![value; n]);
        self.starts.retain(|(other, _)| *other != key);
        self.starts.push((key, value));
    }

    /// The vector column of this name, made of zeros for `n` particles if it is new.
    ///
    /// # Panics
    ///
    /// Debug builds panic where the owner of the column has not registered what a motion of matter does to it.
    pub fn vector(&mut self, key: Vectors, n: usize) -> &mut Vec<[f64; 3]> {
        self.vectors.get_or(key, || {
            debug_assert!(
                key.under().is_some(),
                "the owner of `{key}` has not registered what a turn does to it"
            );
            vec![[0.0; 3]; n]
        })
    }

    /// The names of the vector columns.
    pub fn vector_keys(&self) -> impl Iterator<Item = Vectors> {
        self.vectors.keys()
    }

    /// The vector columns with their names, to be changed.
    pub fn vectors_mut(&mut self) -> impl Iterator<Item = (Vectors, &mut Vec<[f64; 3]>)> {
        self.vectors.iter_mut()
    }

    /// The column behind a deck's `i_NAME`, `d_NAME`, `i2_NAME[k]`, `d2_NAME[k]`, `temperature` or `heatflow` (fix
    /// property/atom).
    pub fn custom(&self, word: &str) -> Option<Numbers> {
        let name = match word.strip_suffix(']').and_then(|w| w.split_once('[')) {
            Some((head, k)) => Cow::Owned(format!("{head}/{k}")),
            None => Cow::Borrowed(word),
        };
        by_name(&name);
        self.scalars.keys().find(|key| key.role().is_some_and(|role| role.text() == name))
    }

    /// The column that is this property now, of whichever fix property/atom.
    pub fn property(&self, role: Numbers) -> Option<Numbers> {
        self.playing(role).next().map(|(key, _)| key)
    }

    /// The column that a column of fix property/atom means now: itself, or that of another fix which has the same property.
    pub fn present(&self, full: Numbers) -> Option<Numbers> {
        if self.scalars.contains(full) { Some(full) } else { self.property(full.role()?) }
    }

    /// The scalar columns in a role.
    pub fn playing(&self, role: Numbers) -> impl Iterator<Item = (Numbers, &Vec<f64>)> {
        self.scalars.playing(role)
    }

    /// The vector column of this name, if there is one.
    pub fn get_vector(&self, key: Vectors) -> Option<&[[f64; 3]]> {
        self.vectors.get(key).map(Vec::as_slice)
    }

    /// The handle of a vector column that is there; for lines of a deck and programs, not for steps.
    pub fn vector_named(&self, name: &str) -> Option<Vectors> {
        self.vectors.find(name)
    }

    /// The scalar column of this name, if there is one.
    pub fn get_scalar(&self, key: Numbers) -> Option<&[f64]> {
        self.scalars.get(key).map(Vec::as_slice)
    }

    /// Removes a column of either kind.
    pub fn remove<T>(&mut self, key: Key<T>) {
        self.scalars.remove(key.of());
        self.vectors.remove(key.of());
        self.starts.retain(|(other, _)| *other != key.of());
    }

    /// Lets two scalar columns change places, each made of zeros for `n` particles if it is new.
    pub fn swap_scalars(&mut self, a: Numbers, b: Numbers, n: usize) {
        let of_a = std::mem::take(self.scalar(a, n));
        let of_b = std::mem::replace(self.scalar(b, n), of_a);
        *self.scalar(a, n) = of_b;
    }

    /// Removes the forces, torques and heat flows of levels of steps.
    pub fn forget_levels(&mut self) {
        drop(self.split_off(|name| !name.starts_with(LEVEL)));
    }

    /// Takes out the columns whose names `keep` does not hold.
    pub fn split_off(&mut self, keep: impl Fn(&str) -> bool) -> Columns {
        let mut out = Columns::default();
        out.scalars.extend(self.scalars.split_off(|key| keep(key.text())));
        out.vectors.extend(self.vectors.split_off(|key| keep(key.text())));
        out
    }

    /// Puts columns in, in place of those of the same names.
    pub fn put(&mut self, mut more: Columns) {
        self.scalars.extend(more.scalars.split_off(|_| false));
        self.vectors.extend(more.vectors.split_off(|_| false));
    }

    /// The names of the columns that were read or written since the last call.
    #[cfg(debug_assertions)]
    pub(crate) fn take_touched(&self) -> impl Iterator<Item = Numbers> {
        self.scalars.take_touched().chain(self.vectors.take_touched())
    }

    /// All names.
    pub fn names(&self) -> Vec<&'static str> {
        let scalars = self.scalars.keys().map(Key::text);
        let mut names: Vec<&str> = scalars.chain(self.vectors.keys().map(Key::text)).collect();
        names.dedup();
        names
    }

    /// Whether every column has `n` entries.
    pub fn have(&self, n: usize) -> bool {
        self.scalars.values().all(|c| c.len() == n) && self.vectors.values().all(|c| c.len() == n)
    }

    /// Gives every column room for `n` particles: zeros for new ones, or what they [start](Self::start) with.
    pub fn resize(&mut self, n: usize) {
        let starts = &self.starts;
        for (key, column) in self.scalars.iter_mut().filter(|(_, column)| column.len() != n) {
            let start = starts.iter().find(|(other, _)| *other == key).map_or(0.0, |(_, value)| *value);
            column.resize(n, start);
        }
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
