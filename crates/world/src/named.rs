//! State by name: a name becomes a handle once, outside of steps, and the handle finds its entry by number.

pub use super::acting::Acting;
use super::acting::by_name;
use super::moving::Under;
use super::tracked::Mark;
use serde::de::Deserialize;
use serde::ser::SerializeMap;
use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;
use std::sync::{Mutex, OnceLock, PoisonError};

/// A registered name and its number. Names are as few as the words of decks: they stay.
struct Name {
    number: usize,
    text: &'static str,
    /// What entries of several owners are to all others: `temperature` of `property/atom/ID/temperature`. The owner registers it.
    role: OnceLock<&'static Name>,
    /// What a motion of matter does to the entry, as the owner registers it.
    under: OnceLock<Under>,
}

static NAMES: Mutex<BTreeMap<&'static str, &'static Name>> = Mutex::new(BTreeMap::new());

/// The handle of what stands under a name in a [`Named`] of values `T`. It holds for every scene, copies and scenes read from a
/// file included, whether there is such an entry now or not.
pub struct Key<T> {
    name: &'static Name,
    of: PhantomData<fn() -> T>,
}

/// The handle of a list of numbers, one for each particle in columns.
pub type Numbers = Key<Vec<f64>>;

/// The handle of a column of vectors.
pub type Vectors = Key<Vec<[f64; 3]>>;

impl<T> Key<T> {
    /// The handle of a name; to be made while a style is declared or its ops are, never inside a step.
    #[track_caller]
    pub fn new(text: &str) -> Self {
        by_name(text);
        Self::known(text)
    }

    fn known(text: &str) -> Self {
        if let Some(name) = NAMES.lock().unwrap_or_else(PoisonError::into_inner).get(text) {
            return Self { name, of: PhantomData };
        }
        let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
        let number = names.len();
        let new = |text: &&'static str| -> &'static Name {
            Box::leak(Box::new(Name { number, text, role: OnceLock::new(), under: OnceLock::new() }))
        };
        // Another thread may have been faster.
        let name = *names.entry(text.to_string().leak()).or_insert_with_key(new);
        Self { name, of: PhantomData }
    }

    /// Registers the role of this name. A name has one role: later registrations have to agree.
    pub(crate) fn in_role(self, role: &str) -> Self {
        let role = Self::known(role).name;
        let first = self.name.role.get_or_init(|| role);
        debug_assert_eq!(first.number, role.number, "`{self}` has two roles");
        self
    }

    /// Registers what a motion of matter does to the entry of this name.
    pub(crate) fn moved(self, under: Under) -> Self {
        let first = self.name.under.get_or_init(|| under);
        debug_assert_eq!(*first, under, "motions of matter change `{self}` in two ways");
        self
    }

    /// The handle of this name with `tail` behind it, for values of any kind.
    pub fn with<U>(self, tail: &str) -> Key<U> {
        Key::new(&format!("{self}{tail}"))
    }

    /// The same name for values of another kind.
    pub fn of<U>(self) -> Key<U> {
        Key { name: self.name, of: PhantomData }
    }

    /// Whether it is known to others as this.
    pub fn plays(self, role: Self) -> bool {
        self.name.role.get().is_some_and(|own| own.number == role.name.number)
    }

    /// What it is known as to others, if it is.
    pub fn role(self) -> Option<Self> {
        self.name.role.get().map(|name| Self { name, of: PhantomData })
    }

    /// What a motion of matter does to its entry, if its owner has registered that.
    pub fn under(self) -> Option<Under> {
        self.name.under.get().copied()
    }

    /// The name.
    pub fn text(self) -> &'static str {
        self.name.text
    }
}

/// The handle of a name that the program itself has, for a constant; made when it is first used.
pub struct Constant<T> {
    text: &'static str,
    role: Option<&'static str>,
    under: Option<Under>,
    key: OnceLock<Key<T>>,
}

impl<T> Constant<T> {
    /// That of this name.
    pub const fn new(text: &'static str) -> Self {
        Self { text, role: None, under: None, key: OnceLock::new() }
    }

    /// That of this name, which has a role.
    pub const fn in_role(text: &'static str, role: &'static str) -> Self {
        Self { text, role: Some(role), under: None, key: OnceLock::new() }
    }

    /// That of this name, whose entry a motion of matter changes as `under` states.
    pub const fn moved(text: &'static str, under: Under) -> Self {
        Self { text, role: None, under: Some(under), key: OnceLock::new() }
    }
}

impl<T> std::ops::Deref for Constant<T> {
    type Target = Key<T>;
    #[inline]
    fn deref(&self) -> &Key<T> {
        self.key.get_or_init(|| {
            let key = Key::known(self.text);
            let key = self.role.map_or(key, |role| key.in_role(role));
            self.under.map_or(key, |under| key.moved(under))
        })
    }
}

impl<T> Clone for Key<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Key<T> {}

impl<T> PartialEq for Key<T> {
    fn eq(&self, other: &Self) -> bool {
        self.name.number == other.name.number
    }
}

impl<T> Eq for Key<T> {}

impl<T> fmt::Display for Key<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.text())
    }
}

impl<T> fmt::Debug for Key<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text().fmt(f)
    }
}

/// Values by name. In files and for the eye a map in the order of names.
#[derive(Clone)]
pub struct Named<T> {
    /// By the number of a name: one more than the place of its entry, 0 for none.
    places: Vec<u32>,
    /// In the order of names. What was taken away leaves its place until another name comes.
    entries: Vec<(Key<T>, Option<T>, Mark)>,
}

impl<T> Default for Named<T> {
    fn default() -> Self {
        Self { places: vec![], entries: vec![] }
    }
}

impl<T> Named<T> {
    #[inline]
    fn place(&self, key: Key<T>) -> Option<usize> {
        (*self.places.get(key.name.number)? as usize).checked_sub(1)
    }

    /// The entry of a name, made if it is new.
    fn slot(&mut self, key: Key<T>) -> &mut Option<T> {
        if self.place(key).is_none() {
            self.drop_gone();
            let at = self.entries.partition_point(|(k, ..)| k.text() < key.text());
            self.entries.insert(at, (key, None, Mark::default()));
            self.find_places(at);
        }
        let at = self.place(key).expect("it is there now");
        let (_, value, mark) = &mut self.entries[at];
        mark.write();
        value
    }

    /// Makes room where values were taken away.
    fn drop_gone(&mut self) {
        let Some(first) = self.entries.iter().position(|(_, value, _)| value.is_none()) else { return };
        for (key, ..) in self.entries.iter().filter(|(_, value, _)| value.is_none()) {
            self.places[key.name.number] = 0;
        }
        self.entries.retain(|(_, value, _)| value.is_some());
        self.find_places(first);
    }

    /// After entries from `first` on have moved.
    fn find_places(&mut self, first: usize) {
        for (at, (key, ..)) in self.entries.iter().enumerate().skip(first) {
            let number = key.name.number;
            if number >= self.places.len() {
                self.places.resize(number + 1, 0);
            }
            self.places[number] = at as u32 + 1;
        }
    }

    /// The value, if there is one.
    #[inline]
    pub fn get(&self, key: Key<T>) -> Option<&T> {
        let (_, value, mark) = &self.entries[self.place(key)?];
        mark.read();
        value.as_ref()
    }

    /// The value, if there is one.
    pub fn get_mut(&mut self, key: Key<T>) -> Option<&mut T> {
        let at = self.place(key)?;
        let (_, value, mark) = &mut self.entries[at];
        mark.write();
        value.as_mut()
    }

    /// The value, made if there is none.
    pub fn get_or(&mut self, key: Key<T>, new: impl FnOnce() -> T) -> &mut T {
        self.slot(key).get_or_insert_with(new)
    }

    /// Whether there is a value.
    pub fn contains(&self, key: Key<T>) -> bool {
        self.place(key).is_some_and(|at| self.entries[at].1.is_some())
    }

    /// The handle of a name that has a value, for names that come from a text.
    #[track_caller]
    pub fn find(&self, text: &str) -> Option<Key<T>> {
        by_name(text);
        let at = self.entries.binary_search_by(|(key, ..)| key.text().cmp(text)).ok()?;
        let (key, value, _) = &self.entries[at];
        value.as_ref().map(|_| *key)
    }

    /// The value of a name that comes from a text.
    #[track_caller]
    pub fn look_up(&self, text: &str) -> Option<&T> {
        self.get(self.find(text)?)
    }

    /// Puts a value in; the one before.
    pub fn insert(&mut self, key: Key<T>, value: T) -> Option<T> {
        self.slot(key).replace(value)
    }

    /// Takes a value out.
    pub fn remove(&mut self, key: Key<T>) -> Option<T> {
        let at = self.place(key)?;
        let (_, value, mark) = &mut self.entries[at];
        mark.write();
        value.take()
    }

    /// Takes all values out.
    pub fn clear(&mut self) {
        self.entries.iter_mut().for_each(|(_, value, _)| *value = None);
    }

    /// Keeps those that `keep` holds.
    pub fn retain(&mut self, keep: impl Fn(Key<T>) -> bool) {
        self.entries.iter_mut().filter(|(key, ..)| !keep(*key)).for_each(|(_, value, _)| *value = None);
    }

    /// Takes out those that `keep` does not hold.
    pub fn split_off(&mut self, keep: impl Fn(Key<T>) -> bool) -> Vec<(Key<T>, T)> {
        let gone = self.entries.iter_mut().filter(|(key, ..)| !keep(*key));
        gone.filter_map(|(key, value, _)| Some((*key, value.take()?))).collect()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.keys().count()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All in the order of names.
    pub fn iter(&self) -> impl Iterator<Item = (Key<T>, &T)> {
        self.chosen(|_| true)
    }

    /// Those in a role, in the order of names.
    pub fn playing(&self, role: Key<T>) -> impl Iterator<Item = (Key<T>, &T)> {
        self.chosen(move |key| key.plays(role))
    }

    fn chosen(&self, which: impl Fn(Key<T>) -> bool) -> impl Iterator<Item = (Key<T>, &T)> {
        let chosen = self.entries.iter().filter(move |(key, ..)| which(*key));
        chosen.filter_map(|(key, value, mark)| {
            mark.read();
            Some((*key, value.as_ref()?))
        })
    }

    /// The names in their order.
    pub fn keys(&self) -> impl Iterator<Item = Key<T>> {
        self.entries.iter().filter_map(|(key, value, _)| value.is_some().then_some(*key))
    }

    /// The values in the order of names.
    pub fn values(&self) -> impl Iterator<Item = &T> {
        self.iter().map(|(_, value)| value)
    }

    /// All in the order of names, to be changed.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (Key<T>, &mut T)> {
        self.entries.iter_mut().filter_map(|(key, value, mark)| {
            mark.write();
            Some((*key, value.as_mut()?))
        })
    }

    /// The names of the entries that were read or written since the last call.
    #[cfg(debug_assertions)]
    pub(crate) fn take_touched(&self) -> impl Iterator<Item = Numbers> {
        self.entries.iter().filter(|(.., mark)| mark.take()).map(|(key, ..)| key.of())
    }

    /// The values in the order of names, to be changed.
    pub fn values_mut(&mut self) -> impl Iterator<Item = &mut T> {
        self.iter_mut().map(|(_, value)| value)
    }
}

impl Named<Vec<f64>> {
    /// Puts numbers in, in the room of those before.
    pub fn put(&mut self, key: Key<Vec<f64>>, numbers: impl IntoIterator<Item = f64>) {
        let place = self.get_or(key, Vec::new);
        place.clear();
        place.extend(numbers);
    }
}

impl<T> std::ops::Index<&str> for Named<T> {
    type Output = T;
    /// The value of a name that is there, for tests.
    fn index(&self, text: &str) -> &T {
        self.look_up(text).unwrap_or_else(|| panic!("no `{text}` here"))
    }
}

impl<T> Extend<(Key<T>, T)> for Named<T> {
    fn extend<I: IntoIterator<Item = (Key<T>, T)>>(&mut self, more: I) {
        more.into_iter().for_each(|(key, value)| drop(self.insert(key, value)));
    }
}

impl<T: fmt::Debug> fmt::Debug for Named<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.iter()).finish()
    }
}

impl<T: PartialEq> PartialEq for Named<T> {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

impl<T: serde::Serialize> serde::Serialize for Named<T> {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut map = to.serialize_map(Some(self.len()))?;
        self.iter().try_for_each(|(key, value)| map.serialize_entry(key.text(), value))?;
        map.end()
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Named<T> {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let map = BTreeMap::<String, T>::deserialize(from)?;
        let entries = map.into_iter().map(|(name, value)| (Key::known(&name), Some(value), Mark::default()));
        let mut all = Self { entries: entries.collect(), places: vec![] };
        all.find_places(0);
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_handle_outlives_what_it_finds() {
        let (a, b) = (Key::new("test/a"), Key::new("test/b"));
        let mut all: Named<f64> = Named::default();
        assert_eq!((all.insert(b, 2.0), all.insert(a, 1.0)), (None, None));
        let before = all.clone();
        assert_eq!((all.remove(a), all.get(a)), (Some(1.0), None));
        assert_eq!((all.find("test/a"), all.len()), (None, 1));
        // Another name comes, and the first once more.
        all.insert(Key::new("test/0"), 0.0);
        assert_eq!(*all.get_or(a, || 3.0), 3.0);
        assert_eq!(format!("{all:?}"), r#"{"test/0": 0.0, "test/a": 3.0, "test/b": 2.0}"#);
        assert_eq!((before.get(a), before.get(b), all["test/b"]), (Some(&1.0), Some(&2.0), 2.0));
        assert_eq!(all.find("test/a"), Some(a));
        all.retain(|key| key.text() < "test/a");
        assert!(!all.contains(a) && !all.contains(b) && !all.is_empty());
        all.clear();
        assert!(all.is_empty() && all == Named::default());
        let [one, two] = [("test/f/d_b", "d_b"), ("test/g/d2_c/1", "d2_c/1")]
            .map(|(text, role)| Key::new(text).in_role(role));
        all.extend([(two, 2.0), (one, 1.0), (b, 0.0)]);
        assert!(all.playing(Key::new("d2_c/1")).eq([(two, &2.0)]) && one.role() == Some(Key::new("d_b")));
        assert_eq!((b.role(), all.playing(Key::new("test/b")).count()), (None, 0));
        assert_eq!(a.of::<u8>().with::<f64>("/x"), Key::new("test/a/x"));
    }

    #[test]
    fn files_hold_a_map() {
        let text = "\"test/a\" = 1.0\n\"test/b\" = 2.0\n";
        let all: Named<f64> = toml::from_str(text).unwrap();
        assert_eq!((all.get(Key::new("test/b")), toml::to_string(&all).unwrap()), (Some(&2.0), text.into()));
    }

    #[cfg(debug_assertions)]
    #[test]
    #[should_panic(expected = "`test/late` inside a step")]
    fn inside_a_step_no_name_is_looked_up() {
        let _step = Acting::op();
        {
            let _formula = Acting::text();
            Key::<f64>::new("test/formula");
        }
        Key::<f64>::new("test/late");
    }
}
