//! State that notes in debug builds whether it was read or written; in release builds it is nothing but the state.

use perigrain_base::par::Split;
use std::ops::{Deref, DerefMut};
#[cfg(debug_assertions)]
use std::sync::atomic::{AtomicU8, Ordering};

#[cfg(debug_assertions)]
const READ: u8 = 1;
#[cfg(debug_assertions)]
const WRITTEN: u8 = 2;

/// Whether an entry of a part was touched; nothing in release builds. A copy was not.
#[derive(Debug, Default)]
pub(crate) struct Mark {
    #[cfg(debug_assertions)]
    marks: AtomicU8,
}

impl Mark {
    /// The entry is read.
    #[inline(always)]
    pub fn read(&self) {
        #[cfg(debug_assertions)]
        mark(&self.marks, READ);
    }

    /// The entry is written.
    #[inline(always)]
    pub fn write(&self) {
        #[cfg(debug_assertions)]
        mark(&self.marks, WRITTEN);
    }

    /// Whether the entry was touched since the last call.
    #[cfg(debug_assertions)]
    pub fn take(&self) -> bool {
        self.marks.load(Ordering::Relaxed) != 0 && self.marks.swap(0, Ordering::Relaxed) != 0
    }
}

impl Clone for Mark {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// A part of the scene that records accesses to it. Its length may be read without a trace; so may all of it, by
/// [`Tracked::past`].
#[cfg_attr(not(debug_assertions), repr(transparent))]
pub struct Tracked<T> {
    value: T,
    #[cfg(debug_assertions)]
    marks: AtomicU8,
}

impl<T> Tracked<T> {
    /// State that counts as written.
    #[inline]
    pub const fn new(value: T) -> Self {
        Self {
            value,
            #[cfg(debug_assertions)]
            marks: AtomicU8::new(WRITTEN),
        }
    }

    /// The state, without a trace: for accounts of memory and the plan's own bookkeeping.
    #[inline(always)]
    pub fn past(&self) -> &T {
        &self.value
    }

    /// The state to be written, without a trace.
    #[inline(always)]
    pub fn past_mut(&mut self) -> &mut T {
        &mut self.value
    }

    /// The state alone.
    #[inline]
    pub fn into_inner(self) -> T {
        self.value
    }

    /// Whether it was read and written since the marks were cleared; they are clear then.
    #[cfg(debug_assertions)]
    pub fn take_marks(&self) -> (bool, bool) {
        // Between ops nothing else marks: a swap takes far longer than a load, and most have nothing to clear.
        let marks = self.marks.load(Ordering::Relaxed);
        if marks != 0 {
            self.marks.store(0, Ordering::Relaxed);
        }
        (marks & READ != 0, marks & WRITTEN != 0)
    }
}

impl<T> Tracked<Vec<T>> {
    /// Number of entries, without a trace.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.value.len()
    }

    /// Whether there are none, without a trace.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.value.is_empty()
    }
}

/// A column on loan, to be cut in pieces for many threads: an access to a piece leaves its mark on the column.
pub struct Lent<'a, T> {
    rows: &'a mut [T],
    #[cfg(debug_assertions)]
    marks: &'a AtomicU8,
}

impl<T> Tracked<Vec<T>> {
    /// The column on loan; that alone leaves no mark.
    #[inline]
    pub fn lend(&mut self) -> Lent<'_, T> {
        Lent {
            rows: &mut self.value,
            #[cfg(debug_assertions)]
            marks: &self.marks,
        }
    }
}

impl<'a, T> Lent<'a, T> {
    /// A column of no rows.
    #[inline]
    pub fn none() -> Self {
        #[cfg(debug_assertions)]
        static NO_MARKS: AtomicU8 = AtomicU8::new(0);
        Lent {
            rows: &mut [],
            #[cfg(debug_assertions)]
            marks: &NO_MARKS,
        }
    }

    /// Number of rows, without a trace.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there are none, without a trace.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The rows, without a trace: for loops that touch a column only for what may stand beside them.
    #[inline(always)]
    pub fn past_mut(&mut self) -> &mut [T] {
        self.rows
    }

    /// The rows for loops that only read them here, and write them for what stands beside them elsewhere: counts as read.
    #[inline(always)]
    pub fn read_mut(&mut self) -> &mut [T] {
        #[cfg(debug_assertions)]
        mark(self.marks, READ);
        self.rows
    }
}

impl<T: Send> Split for Lent<'_, T> {
    fn rows(&self) -> usize {
        self.rows.len()
    }
    fn cut(self, mid: usize) -> (Self, Self) {
        let (low, high) = self.rows.split_at_mut(mid);
        let with = |rows| Self {
            rows,
            #[cfg(debug_assertions)]
            marks: self.marks,
        };
        (with(low), with(high))
    }
}

impl<T> Deref for Lent<'_, T> {
    type Target = [T];
    #[inline(always)]
    fn deref(&self) -> &[T] {
        #[cfg(debug_assertions)]
        mark(self.marks, READ);
        self.rows
    }
}

impl<T> DerefMut for Lent<'_, T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [T] {
        #[cfg(debug_assertions)]
        mark(self.marks, WRITTEN);
        self.rows
    }
}

/// Many threads read at once, and all but the first find the mark there.
#[cfg(debug_assertions)]
#[inline]
fn mark(marks: &AtomicU8, what: u8) {
    if marks.load(Ordering::Relaxed) & what == 0 {
        marks.fetch_or(what, Ordering::Relaxed);
    }
}

impl<T> Deref for Tracked<T> {
    type Target = T;
    #[inline(always)]
    fn deref(&self) -> &T {
        #[cfg(debug_assertions)]
        mark(&self.marks, READ);
        &self.value
    }
}

impl<T> DerefMut for Tracked<T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut T {
        #[cfg(debug_assertions)]
        mark(&self.marks, WRITTEN);
        &mut self.value
    }
}

impl<T> From<T> for Tracked<T> {
    fn from(value: T) -> Self {
        Self::new(value)
    }
}

impl<A, T: FromIterator<A>> FromIterator<A> for Tracked<T> {
    fn from_iter<I: IntoIterator<Item = A>>(items: I) -> Self {
        Self::new(items.into_iter().collect())
    }
}

impl<T: Default> Default for Tracked<T> {
    fn default() -> Self {
        Self::new(T::default())
    }
}

impl<T: Clone> Clone for Tracked<T> {
    fn clone(&self) -> Self {
        Self::new(T::clone(self))
    }
}

impl<T: std::fmt::Debug> std::fmt::Debug for Tracked<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.value.fmt(f)
    }
}

impl<T: PartialEq<U>, U> PartialEq<U> for Tracked<T> {
    fn eq(&self, other: &U) -> bool {
        T::eq(self, other)
    }
}

impl<T: PartialEq<U>, U> PartialEq<Tracked<Vec<U>>> for Vec<T> {
    fn eq(&self, other: &Tracked<Vec<U>>) -> bool {
        self == other.past()
    }
}

impl<'a, T> IntoIterator for &'a Tracked<T>
where
    &'a T: IntoIterator,
{
    type Item = <&'a T as IntoIterator>::Item;
    type IntoIter = <&'a T as IntoIterator>::IntoIter;
    fn into_iter(self) -> Self::IntoIter {
        (&**self).into_iter()
    }
}

impl<'a, T> IntoIterator for &'a mut Tracked<T>
where
    &'a mut T: IntoIterator,
{
    type Item = <&'a mut T as IntoIterator>::Item;
    type IntoIter = <&'a mut T as IntoIterator>::IntoIter;
    fn into_iter(self) -> Self::IntoIter {
        (&mut **self).into_iter()
    }
}

impl<T: serde::Serialize> serde::Serialize for Tracked<T> {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        T::serialize(self, to)
    }
}

impl<'de, T: serde::Deserialize<'de>> serde::Deserialize<'de> for Tracked<T> {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        T::deserialize(from).map(Self::new)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(debug_assertions)]
    #[test]
    fn what_is_looked_at_is_marked_and_lengths_are_free() {
        let mut x = Tracked::new(vec![1.0, 2.0]);
        assert_eq!(x.take_marks(), (false, true), "a new value counts as written");
        assert_eq!((x.len(), x.past()[0], x.take_marks()), (2, 1.0, (false, false)));
        assert_eq!((x[1], x.take_marks()), (2.0, (true, false)));
        x[0] = 3.0;
        assert_eq!(x.take_marks(), (false, true));
        assert_eq!((x.clone(), x.take_marks()), (Tracked::new(vec![3.0, 2.0]), (true, false)));
    }

    #[cfg(not(debug_assertions))]
    #[test]
    fn in_release_it_takes_no_room() {
        assert_eq!(size_of::<Tracked<Vec<f64>>>(), size_of::<Vec<f64>>());
    }

    #[test]
    fn files_do_not_show_it() {
        let scene = |x: Tracked<Vec<f64>>| std::collections::BTreeMap::from([("x", x)]);
        let text = toml::to_string(&scene(vec![1.0, 2.5].into())).unwrap();
        assert_eq!(text, "x = [1.0, 2.5]\n");
        let back: std::collections::BTreeMap<String, Tracked<Vec<f64>>> = toml::from_str(&text).unwrap();
        assert_eq!(back["x"], [1.0, 2.5]);
    }
}
