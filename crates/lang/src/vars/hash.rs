//! Hashes of variables, by which a loop without progress is known.

use super::{Data, Variable};
use perigrain_base::math::scatter::mixed;
use std::hash::{Hash, Hasher};

impl Variable {
    /// Settles the hash, once everything else stands.
    pub fn named(mut self, name: &str) -> Self {
        let mut h = Words(0);
        (name, self.kind, self.unknown).hash(&mut h);
        match &self.data {
            Data::List { values, .. } => values.hash(&mut h),
            Data::Range { last, width, .. } => (last, width).hash(&mut h),
            Data::Text(t) | Data::Getenv(t) | Data::Python(t) => t.hash(&mut h),
            Data::Lines(l) => l.path().hash(&mut h),
            Data::Atoms(a) => a.path().hash(&mut h),
            Data::Format { name, format } => (name, format).hash(&mut h),
            Data::Formula(e) => e.text().hash(&mut h),
            Data::Number(v) => v.to_bits().hash(&mut h),
        }
        self.print = h.finish();
        self
    }

    /// The hash with the position in a list.
    pub fn state(&self) -> u64 {
        let at = match self.data {
            Data::List { at, .. } => at as u64,
            Data::Range { now, .. } => now as u64,
            _ => 0,
        };
        mixed(self.print ^ mixed(at))
    }
}

/// A quick hash of a definition.
struct Words(u64);

impl Hasher for Words {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, bytes: &[u8]) {
        for part in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..part.len()].copy_from_slice(part);
            self.0 = mixed(self.0 ^ u64::from_le_bytes(word) ^ (part.len() as u64) << 59);
        }
    }
}
