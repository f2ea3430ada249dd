//! Enums whose key `kind` gives the variant.
//!
//! Serde reads internally tagged enums through a buffer, which loses the key at fault. This module
//! reads the variant directly from the map if `kind` is the first key, as the reader and the
//! serializers of recipes ensure. Otherwise it uses a buffer.

use std::{fmt, marker::PhantomData};

use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, Visitor, value::MapDeserializer};

/// The key that gives the variant.
pub(crate) const KIND: &str = "kind";

/// An enum whose variants are named by `kind`.
pub(crate) trait Tagged: Sized {
    /// Names of the variants.
    const KINDS: &'static [&'static str];

    /// Reads the variant `kind`, one of [`KINDS`](Self::KINDS), from the other keys.
    fn from_map<'de, M: MapAccess<'de>>(kind: &'static str, map: M) -> Result<Self, M::Error>;
}

/// Implements [`Tagged`] and `Deserialize` for an enum of newtype variants.
macro_rules! tagged {
    ($type:ident { $($kind:literal => $variant:ident($body:ty)),+ $(,)? }) => {
        impl $crate::recipe::tagged::Tagged for $type {
            const KINDS: &'static [&'static str] = &[$($kind),+];

            fn from_map<'de, M: serde::de::MapAccess<'de>>(kind: &'static str, map: M) -> Result<Self, M::Error> {
                let body = serde::de::value::MapAccessDeserializer::new(map);
                match kind {
                    $($kind => <$body as serde::Deserialize>::deserialize(body).map(Self::$variant),)+
                    _ => Err(serde::de::Error::unknown_variant(kind, Self::KINDS)),
                }
            }
        }

        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                $crate::recipe::tagged::deserialize(deserializer)
            }
        }
    };
}
pub(crate) use tagged;

pub(crate) fn deserialize<'de, T: Tagged, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    deserializer.deserialize_map(TaggedVisitor(PhantomData))
}

struct TaggedVisitor<T>(PhantomData<T>);

impl<'de, T: Tagged> Visitor<'de> for TaggedVisitor<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table with a `kind`")
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<T, M::Error> {
        let mut kind = None;
        let mut others: Vec<(String, serde_json::Value)> = Vec::new();
        while let Some(key) = map.next_key::<String>()? {
            if key != KIND {
                others.push((key, map.next_value()?));
                continue;
            }
            let found = map.next_value_seed(KindOf::<T>(PhantomData))?;
            if others.is_empty() {
                return T::from_map(found, map);
            }
            kind = Some(found);
        }
        let kind = kind.ok_or_else(|| M::Error::missing_field(KIND))?;
        let others: MapDeserializer<'_, _, serde_json::Error> = MapDeserializer::new(others.into_iter());
        T::from_map(kind, others).map_err(M::Error::custom)
    }
}

/// Reads the value of `kind`, so that a misspelling is reported at that key.
struct KindOf<T>(PhantomData<T>);

impl<'de, T: Tagged> DeserializeSeed<'de> for KindOf<T> {
    type Value = &'static str;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<&'static str, D::Error> {
        let found: String = serde::Deserialize::deserialize(deserializer)?;
        let known = T::KINDS.iter().find(|kind| **kind == found);
        known.copied().ok_or_else(|| D::Error::unknown_variant(&found, T::KINDS))
    }
}
