//! A fingerprint of the shapes of stored types: names of fields and variants, kinds of values, in order.
//!
//! The stored form has no names in it, so a file is readable only by a program whose types have the same shape. The fingerprint
//! is made by deserializing from a reader that records each request.

use serde::de::IntoDeserializer;
use serde::de::value::U32Deserializer;
use serde::de::{
    Deserialize, DeserializeSeed, Deserializer, EnumAccess, Error as _, MapAccess, SeqAccess, VariantAccess,
    Visitor, value::Error,
};

/// Nothing stored here is nested deeper, except regions made of regions.
const DEEPEST: usize = 40;
/// Nothing stored here has more variants.
const VARIANTS: u32 = 32;

/// The fingerprint of a type.
pub fn fingerprint<T: for<'de> Deserialize<'de>>() -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    for variant in 0..VARIANTS {
        let mut recorder = Recorder { text: String::new(), variant, depth: 0 };
        let outcome = T::deserialize(&mut recorder);
        hasher.update(recorder.text.as_bytes());
        hasher.update(&[u8::from(outcome.is_ok())]);
    }
    hasher.finalize()
}

/// Records each request and answers with zeros, one element per list, and one variant of each enum.
struct Recorder {
    text: String,
    variant: u32,
    depth: usize,
}

impl Recorder {
    fn note(&mut self, what: &str) {
        self.text.push_str(what);
        self.text.push(' ');
    }

    fn deeper<T>(&mut self, f: impl FnOnce(&mut Self) -> Result<T, Error>) -> Result<T, Error> {
        self.depth += 1;
        let outcome = f(self);
        self.depth -= 1;
        outcome
    }

    /// Elements of a list: none where types hold themselves.
    fn some(&self) -> usize {
        usize::from(self.depth < DEEPEST)
    }
}

macro_rules! plain {
    ($($method:ident $visit:ident $value:expr;)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
            self.note(stringify!($visit));
            visitor.$visit($value)
        })*
    };
}

impl<'de> Deserializer<'de> for &mut Recorder {
    type Error = Error;

    plain! {
        deserialize_bool visit_bool false;
        deserialize_i8 visit_i8 0;
        deserialize_i16 visit_i16 0;
        deserialize_i32 visit_i32 0;
        deserialize_i64 visit_i64 0;
        deserialize_u8 visit_u8 0;
        deserialize_u16 visit_u16 0;
        deserialize_u32 visit_u32 0;
        deserialize_u64 visit_u64 0;
        deserialize_f32 visit_f32 0.0;
        deserialize_f64 visit_f64 0.0;
        deserialize_char visit_char 'a';
        deserialize_str visit_str "";
        deserialize_string visit_str "";
        deserialize_bytes visit_bytes &[];
        deserialize_byte_buf visit_bytes &[];
    }

    fn deserialize_unit<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        self.note("unit");
        visitor.visit_unit()
    }

    fn deserialize_any<V: Visitor<'de>>(self, _visitor: V) -> Result<V::Value, Error> {
        Err(Error::custom("stored types describe themselves"))
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        self.deserialize_any(visitor)
    }

    fn deserialize_identifier<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        self.deserialize_any(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        self.note("option");
        if self.some() == 0 {
            return visitor.visit_none();
        }
        self.deeper(|me| visitor.visit_some(me))
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.note(name);
        visitor.visit_unit()
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.note(name);
        self.deeper(|me| visitor.visit_newtype_struct(me))
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        self.note("list");
        let left = self.some();
        self.deeper(|me| visitor.visit_seq(Elements { recorder: me, left }))
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, Error> {
        self.note(&format!("tuple {len}"));
        self.deeper(|me| visitor.visit_seq(Elements { recorder: me, left: len }))
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        len: usize,
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.note(name);
        self.deserialize_tuple(len, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        self.note("map");
        let left = self.some();
        self.deeper(|me| visitor.visit_map(Elements { recorder: me, left }))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.note(&format!("{name} {}", fields.join(" ")));
        self.deserialize_tuple(fields.len(), visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.note(&format!("{name} {}", variants.join(" ")));
        let last = (variants.len() as u32).saturating_sub(1);
        let index = if self.depth < DEEPEST { self.variant.min(last) } else { 0 };
        self.deeper(|me| visitor.visit_enum(Chosen { recorder: me, index }))
    }

    fn is_human_readable(&self) -> bool {
        false
    }
}

/// The elements of a list, tuple or map.
struct Elements<'a> {
    recorder: &'a mut Recorder,
    left: usize,
}

impl<'de> SeqAccess<'de> for Elements<'_> {
    type Error = Error;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Error> {
        if self.left == 0 {
            return Ok(None);
        }
        self.left -= 1;
        seed.deserialize(&mut *self.recorder).map(Some)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.left)
    }
}

impl<'de> MapAccess<'de> for Elements<'_> {
    type Error = Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Error> {
        self.next_element_seed(seed)
    }

    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, Error> {
        seed.deserialize(&mut *self.recorder)
    }
}

/// One variant of an enum.
struct Chosen<'a> {
    recorder: &'a mut Recorder,
    index: u32,
}

impl<'de> EnumAccess<'de> for Chosen<'_> {
    type Error = Error;
    type Variant = Self;

    fn variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<(T::Value, Self), Error> {
        let index: U32Deserializer<Error> = self.index.into_deserializer();
        Ok((seed.deserialize(index)?, self))
    }
}

impl<'de> VariantAccess<'de> for Chosen<'_> {
    type Error = Error;

    fn unit_variant(self) -> Result<(), Error> {
        self.recorder.note("nothing");
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Error> {
        seed.deserialize(self.recorder)
    }

    fn tuple_variant<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, Error> {
        self.recorder.deserialize_tuple(len, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.recorder.deserialize_struct("variant", fields, visitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(serde::Deserialize, serde::Serialize)]
    enum Shape {
        Point,
        Ball { radius: f64 },
        Both(Vec<Shape>),
    }

    mod other {
        #[derive(serde::Deserialize, serde::Serialize)]
        pub enum Shape {
            Point,
            Ball { radius: f32 },
            Both(Vec<Shape>),
        }
    }

    #[test]
    fn other_shapes_have_other_fingerprints() {
        assert_eq!(fingerprint::<Shape>(), fingerprint::<Shape>());
        assert_ne!(fingerprint::<Shape>(), fingerprint::<other::Shape>());
        assert_ne!(fingerprint::<(u32, f64)>(), fingerprint::<(f64, u32)>());
        assert_ne!(fingerprint::<Vec<[f64; 3]>>(), fingerprint::<Vec<[f64; 2]>>());
        assert_ne!(fingerprint::<Option<u8>>(), fingerprint::<u8>());
    }
}
