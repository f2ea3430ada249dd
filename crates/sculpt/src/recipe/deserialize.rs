//! Deserializes recipes from a tree. Errors have the path of the key.

use serde::de::{
    self, DeserializeSeed, Deserializer, Error, Expected, IntoDeserializer, MapAccess, SeqAccess, Unexpected, Visitor,
};

use super::{
    error::RecipeError,
    problem::StructureProblem,
    suggestion::Suggestion,
    tagged::KIND,
    tree::{Entry, Node, Value},
};

type StructureError = RecipeError<StructureProblem>;

impl de::Error for StructureError {
    fn custom<T: std::fmt::Display>(message: T) -> Self {
        Self::new("", StructureProblem::Other(message.to_string()))
    }

    fn invalid_type(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        let expected = match expected.to_string().as_str() {
            "f64" => "a number".to_owned(),
            "u32" | "u64" | "usize" => "a whole number".to_owned(),
            name if name.starts_with("struct ") || name == "a map" => "a table".to_owned(),
            name => name.to_owned(),
        };
        let found = match found {
            Unexpected::Map => "a table".to_owned(),
            Unexpected::Seq => "a list".to_owned(),
            Unexpected::Unit => "null".to_owned(),
            Unexpected::Str(text) => format!("the text \"{text}\""),
            Unexpected::Float(number) => format!("{number}"),
            Unexpected::Signed(number) => format!("{number}"),
            other => other.to_string(),
        };
        Self::new("", StructureProblem::WrongType { found, expected })
    }

    fn invalid_value(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::invalid_type(found, expected)
    }

    fn unknown_field(field: &str, known: &'static [&'static str]) -> Self {
        Self::new(field, StructureProblem::UnknownKey(Suggestion::new(field, known.iter().copied())))
    }

    fn unknown_variant(variant: &str, known: &'static [&'static str]) -> Self {
        let suggestion = Suggestion::new(variant, known.iter().copied());
        Self::new("", StructureProblem::UnknownValue { found: variant.to_owned(), suggestion })
    }

    fn missing_field(field: &'static str) -> Self {
        Self::new(field, StructureProblem::Missing)
    }
}

impl<'de> Deserializer<'de> for &'de Node {
    type Error = StructureError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, StructureError> {
        match &self.value {
            Value::Null => visitor.visit_unit(),
            Value::Boolean(value) => visitor.visit_bool(*value),
            Value::Integer(value) => visitor.visit_i64(*value),
            Value::Float(value) => visitor.visit_f64(*value),
            Value::String(value) => visitor.visit_borrowed_str(value),
            Value::Array(items) => visitor.visit_seq(Elements { items, next: 0 }),
            Value::Table(entries) => {
                // The tag goes first, because it gives the type of the other keys.
                let (tag, rest): (Vec<_>, Vec<_>) = entries.iter().partition(|entry| entry.key == KIND);
                visitor.visit_map(Entries { entries: tag.into_iter().chain(rest), value: None })
            }
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, StructureError> {
        match self.value {
            Value::Null => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, StructureError> {
        match &self.value {
            Value::String(value) => visitor.visit_enum(value.as_str().into_deserializer()),
            _ => self.deserialize_any(visitor),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, StructureError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, expected: usize, visitor: V) -> Result<V::Value, StructureError> {
        match &self.value {
            Value::Array(items) if items.len() != expected => {
                Err(RecipeError::new("", StructureProblem::WrongLength { found: items.len(), expected }))
            }
            _ => self.deserialize_any(visitor),
        }
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq
        tuple_struct map struct identifier ignored_any
    }
}

struct Elements<'de> {
    items: &'de [Node],
    next: usize,
}

impl<'de> SeqAccess<'de> for Elements<'de> {
    type Error = StructureError;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, StructureError> {
        let Some(item) = self.items.get(self.next) else { return Ok(None) };
        let index = self.next;
        self.next += 1;
        seed.deserialize(item).map(Some).map_err(|error| error.inside(&index.to_string()))
    }
}

struct Entries<'de, I> {
    entries: I,
    value: Option<&'de Entry>,
}

impl<'de, I: Iterator<Item = &'de Entry>> MapAccess<'de> for Entries<'de, I> {
    type Error = StructureError;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, StructureError> {
        self.value = self.entries.next();
        self.value.map(|entry| seed.deserialize(entry.key.as_str().into_deserializer())).transpose()
    }

    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, StructureError> {
        let entry = self.value.take().ok_or_else(|| StructureError::custom("a value was asked for before its key"))?;
        seed.deserialize(&entry.node).map_err(|error| error.inside(&entry.key))
    }
}
