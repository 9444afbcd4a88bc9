//! Binary numbers: types and byte orders.

/// A number type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Signed, 8 bits.
    I8,
    /// Unsigned, 8 bits.
    U8,
    /// Signed, 16 bits.
    I16,
    /// Unsigned, 16 bits.
    U16,
    /// Signed, 32 bits.
    I32,
    /// Unsigned, 32 bits.
    U32,
    /// Signed, 64 bits.
    I64,
    /// Unsigned, 64 bits.
    U64,
    /// Floating-point, 32 bits.
    F32,
    /// Floating-point, 64 bits.
    F64,
}

impl Kind {
    /// Its size in bytes.
    pub fn size(self) -> usize {
        match self {
            Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::I64 | Kind::U64 | Kind::F64 => 8,
        }
    }

    /// The unsigned integer in these bytes, which must have the size of the type.
    pub fn whole(self, bytes: &[u8], big_endian: bool) -> u64 {
        let mut b = [0u8; 8];
        let size = self.size();
        for (k, byte) in bytes.iter().take(size).enumerate() {
            b[if big_endian { size - 1 - k } else { k }] = *byte;
        }
        u64::from_le_bytes(b)
    }

    /// The number in these bytes, which must have the size of the type.
    pub fn read(self, bytes: &[u8], big_endian: bool) -> f64 {
        let low = self.whole(bytes, big_endian);
        match self {
            Kind::I8 => f64::from(low as u8 as i8),
            Kind::U8 => f64::from(low as u8),
            Kind::I16 => f64::from(low as u16 as i16),
            Kind::U16 => f64::from(low as u16),
            Kind::I32 => f64::from(low as u32 as i32),
            Kind::U32 => f64::from(low as u32),
            Kind::I64 => low as i64 as f64,
            Kind::U64 => low as f64,
            Kind::F32 => f64::from(f32::from_bits(low as u32)),
            Kind::F64 => f64::from_bits(low),
        }
    }

    /// All numbers in these bytes.
    pub fn read_all(self, bytes: &[u8], big_endian: bool) -> Vec<f64> {
        let mut all = vec![];
        self.read_into(bytes, big_endian, &mut all);
        all
    }

    /// Replaces the contents of `all` by all numbers in these bytes.
    pub fn read_into(self, bytes: &[u8], big_endian: bool, all: &mut Vec<f64>) {
        all.clear();
        match self {
            // Most images have this type, and they are large.
            Kind::U8 => all.extend(bytes.iter().map(|b| f64::from(*b))),
            _ => all.extend(bytes.chunks_exact(self.size()).map(|b| self.read(b, big_endian))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_byte_orders() {
        assert_eq!(Kind::I16.read(&[0xff, 0xfe], true), -2.0);
        assert_eq!(Kind::I16.read(&[0xfe, 0xff], false), -2.0);
        assert_eq!(Kind::F64.read(&1.5f64.to_be_bytes(), true), 1.5);
        assert_eq!(Kind::F32.read(&(-0.25f32).to_le_bytes(), false), -0.25);
        assert_eq!(Kind::U64.read(&7u64.to_be_bytes(), true), 7.0);
        assert_eq!(Kind::U8.read_all(&[1, 200], true), [1.0, 200.0]);
        assert_eq!(Kind::I8.read_all(&[200], true), [-56.0]);
    }
}
