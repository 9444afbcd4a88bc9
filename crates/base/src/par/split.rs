//! Splitting several columns at the same rows, so that chunks can be processed concurrently.

use std::marker::PhantomData;
use std::ops::Range;

use super::CHUNK;
use super::pool::{enter, join};

/// Columns that can be split in two: slices, and tuples of up to six of them.
pub trait Split: Sized + Send {
    /// The number of rows.
    fn rows(&self) -> usize;
    /// The first `mid` rows and the rest.
    fn cut(self, mid: usize) -> (Self, Self);
}

impl<T: Sync> Split for &[T] {
    fn rows(&self) -> usize {
        self.len()
    }
    fn cut(self, mid: usize) -> (Self, Self) {
        self.split_at(mid)
    }
}

impl<T: Send> Split for &mut [T] {
    fn rows(&self) -> usize {
        self.len()
    }
    fn cut(self, mid: usize) -> (Self, Self) {
        self.split_at_mut(mid)
    }
}

/// Optional columns.
impl<S: Split> Split for Option<S> {
    fn rows(&self) -> usize {
        self.as_ref().map_or(0, S::rows)
    }
    fn cut(self, mid: usize) -> (Self, Self) {
        self.map(|s| s.cut(mid)).unzip()
    }
}

/// A column with several numbers per row.
pub struct Rows<'a, T> {
    /// All rows, one after the other.
    pub data: &'a mut [T],
    /// Numbers per row, possibly zero.
    pub width: usize,
}

impl<T: Send> Split for Rows<'_, T> {
    fn rows(&self) -> usize {
        self.data.len().checked_div(self.width).unwrap_or(0)
    }
    fn cut(self, mid: usize) -> (Self, Self) {
        let (low, high) = self.data.split_at_mut(mid * self.width);
        (Self { data: low, width: self.width }, Self { data: high, width: self.width })
    }
}

macro_rules! split_tuples {
    ($(($first:ident $($name:ident)*))*) => {$(
        impl<$first: Split, $($name: Split),*> Split for ($first, $($name,)*) {
            fn rows(&self) -> usize {
                self.0.rows()
            }
            #[allow(non_snake_case)]
            fn cut(self, mid: usize) -> (Self, Self) {
                let ($first, $($name,)*) = self;
                let $first = $first.cut(mid);
                $(let $name = $name.cut(mid);)*
                (($first.0, $($name.0,)*), ($first.1, $($name.1,)*))
            }
        }
    )*};
}

split_tuples! { (A) (A B) (A B C) (A B C D) (A B C D E) (A B C D E G) }

/// Calls `f(first row, chunk)` for every chunk of [`CHUNK`] rows of columns of equal length.
///
/// ```
/// let (mut x, v) = (vec![0.0; 5000], vec![2.0; 5000]);
/// perigrain_base::par::each((&mut x[..], &v[..]), |_, (x, v)| {
///     for (x, v) in x.iter_mut().zip(v) {
///         *x += v;
///     }
/// });
/// assert!(x.iter().all(|&x| x == 2.0));
/// ```
pub fn each<S: Split>(columns: S, f: impl Fn(usize, S) + Sync) {
    fn halve<S: Split>(start: usize, columns: S, threaded: bool, f: &(impl Fn(usize, S) + Sync)) {
        let n = columns.rows();
        if n <= CHUNK {
            return f(start, columns);
        }
        let mid = n.div_ceil(CHUNK).div_ceil(2) * CHUNK;
        let (low, high) = columns.cut(mid);
        if threaded {
            join(|| halve(start, low, true, f), || halve(start + mid, high, true, f));
        } else {
            halve(start, low, false, f);
            halve(start + mid, high, false, f);
        }
    }
    enter(columns.rows().div_ceil(CHUNK), |threaded| halve(0, columns, threaded, &f));
}

/// Calls `f` for every chunk of [`CHUNK`] indices below `n`; chunks must not write data that others access.
pub fn for_chunks(n: usize, f: impl Fn(Range<usize>) + Sync) {
    super::for_rows(n.div_ceil(CHUNK), |k| f(k * CHUNK..n.min((k + 1) * CHUNK)));
}

/// A column that several parts write concurrently, each at its own rows.
pub struct Shared<'a, T> {
    start: *mut T,
    len: usize,
    life: PhantomData<&'a mut [T]>,
}

// SAFETY: access goes through `get`, whose callers guarantee that no two threads access one element at a
// time.
unsafe impl<T: Send> Sync for Shared<'_, T> {}

impl<'a, T> Shared<'a, T> {
    /// Wraps a column.
    pub fn new(column: &'a mut [T]) -> Self {
        Self { start: column.as_mut_ptr(), len: column.len(), life: PhantomData }
    }

    /// The number of elements.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no elements.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Elements `range`, mutable.
    ///
    /// # Safety
    /// No other thread may access these elements until the returned borrow ends.
    ///
    /// # Panics
    /// If the range is out of bounds.
    #[allow(clippy::mut_from_ref)]
    pub unsafe fn get(&self, range: Range<usize>) -> &mut [T] {
        assert!(range.start <= range.end && range.end <= self.len);
        // SAFETY: in bounds by the assertion; exclusive by the caller's guarantee.
        unsafe { std::slice::from_raw_parts_mut(self.start.add(range.start), range.len()) }
    }

    /// The start of the column, for kernels that check bounds once for many accesses.
    #[inline(always)]
    pub fn as_ptr(&self) -> *mut T {
        self.start
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_cover_every_row_once() {
        for n in [0, 1, CHUNK - 1, CHUNK, CHUNK + 1, 5 * CHUNK + 3] {
            let mut hits = vec![0; n];
            let index: Vec<usize> = (0..n).collect();
            each((&mut hits[..], &index[..]), |start, (hits, index)| {
                assert!(start % CHUNK == 0 && hits.len() <= CHUNK);
                for (h, i) in hits.iter_mut().zip(index) {
                    *h += i + 1;
                }
            });
            assert!(hits.iter().enumerate().all(|(i, &h)| h == i + 1));
        }
    }
}
