//! Numbers as bytes of messages between ranks, all of which run on the same kind of processor.

/// A number of fixed size.
pub trait Number: Copy + Default {
    /// Size in bytes.
    const BYTES: usize = size_of::<Self>();
    /// Writes numbers to a buffer of matching size.
    fn write(numbers: &[Self], to: &mut [u8]);
    /// Reads numbers from a buffer of matching size.
    fn read(numbers: &mut [Self], from: &[u8]);
}

macro_rules! numbers {
    ($($name:ty)*) => {$(
        impl Number for $name {
            #[inline]
            fn write(numbers: &[Self], to: &mut [u8]) {
                let to = to.as_chunks_mut::<{ size_of::<$name>() }>().0;
                to.iter_mut().zip(numbers).for_each(|(to, number)| *to = number.to_ne_bytes());
            }
            #[inline]
            fn read(numbers: &mut [Self], from: &[u8]) {
                let from = from.as_chunks::<{ size_of::<$name>() }>().0;
                numbers.iter_mut().zip(from).for_each(|(number, from)| *number = Self::from_ne_bytes(*from));
            }
        }
    )*};
}

numbers! { f64 f32 u32 i32 u8 }

/// Appends numbers to a message.
#[inline]
pub fn put<T: Number>(bytes: &mut Vec<u8>, numbers: &[T]) {
    let at = bytes.len();
    bytes.resize(at + size_of_val(numbers), 0);
    T::write(numbers, &mut bytes[at..]);
}

/// Removes numbers from the front of a message, which must contain them.
#[inline]
pub fn take<T: Number>(bytes: &mut &[u8], numbers: &mut [T]) {
    let (own, rest) = bytes.split_at(size_of_val(numbers));
    T::read(numbers, own);
    *bytes = rest;
}

/// Removes `N` numbers from the front of a message; `None` at its end.
#[inline]
pub fn next<T: Number, const N: usize>(bytes: &mut &[u8]) -> Option<[T; N]> {
    let mut numbers = [T::default(); N];
    (bytes.len() >= size_of_val(&numbers)).then(|| {
        take(bytes, &mut numbers);
        numbers
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_with_the_same_bits() {
        let mut bytes = vec![];
        put(&mut bytes, &[1.5, -0.0, f64::INFINITY]);
        put(&mut bytes, &[u32::MAX, 7]);
        put(&mut bytes, &[0.1f32]);
        put::<u8>(&mut bytes, &[]);
        let mut rest = &bytes[..];
        let mut first = [0.0; 2];
        take(&mut rest, &mut first);
        assert_eq!(first.map(f64::to_bits), [1.5f64, -0.0].map(f64::to_bits));
        assert_eq!(next(&mut rest), Some([f64::INFINITY]));
        assert_eq!(next(&mut rest), Some([u32::MAX, 7]));
        assert_eq!(next::<f64, 1>(&mut rest), None, "four bytes are left");
        assert_eq!(next(&mut rest), Some([0.1f32]));
        assert!(rest.is_empty());
    }
}
