//! The text of a recipe as a tree whose every value knows where it was written.

use std::fmt;

use jsonc_parser::{ParseOptions, ast, common::Ranged, parse_to_ast};
use toml::de::{DeTable, DeValue};

use super::error::{Location, RecipeError, RecipeProblem};

/// A value with the place where it was written.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Node {
    pub(crate) location: Location,
    pub(crate) value: Value,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    Null,
    Boolean(bool),
    Integer(i64),
    Float(f64),
    String(String),
    Array(Vec<Node>),
    Table(Vec<Entry>),
}

/// A key of a table, where the key itself was written, and its value.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    pub(crate) key: String,
    pub(crate) location: Location,
    pub(crate) node: Node,
}

/// A setting that wins over the recipe: `tools.ball.support=0.2`.
///
/// The key is a dotted path in which an element of a list goes by its number, from zero: `stroke.0.keys.1.at`. The value is typed
/// as in TOML; quotes around a string may be left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Override {
    text: String,
    path: Vec<String>,
    value: Node,
}

impl Override {
    /// Reads `KEY=VALUE`.
    ///
    /// # Errors
    /// Where there is no `=`, the key is not a dotted path, or the value is not one.
    pub fn parse(text: &str) -> Result<Self, RecipeError> {
        let location = Location::Override(text.to_owned());
        let wrong = |message: &str| syntax(message, location.clone());
        let (key, value) = text.split_once('=').ok_or_else(|| wrong("has no `=`; write KEY=VALUE"))?;
        // The key is read as that of a line of TOML, which makes a table in a table of each of its steps.
        let line = format!("{} = 0", key.trim());
        let table = DeTable::parse(&line).map_err(|error| wrong(error.message()))?;
        let mut node = &Node::table_from_toml(table.get_ref(), &|_| location.clone())?;
        let mut path = Vec::new();
        while let Value::Table(entries) = &node.value
            && let [entry] = entries.as_slice()
        {
            path.push(entry.key.clone());
            node = &entry.node;
        }
        let value = match DeValue::parse(value.trim()) {
            Ok(value) => Node::value_from_toml(value.get_ref(), &|_| location.clone(), location.clone())?,
            // A word that is no value of any other type is a string whose quotes were left out.
            Err(error) if value.trim().is_empty() || value.contains(['"', '\'', '[', ']', '{', '}', '\n']) => {
                return Err(wrong(error.message()));
            }
            Err(_) => Node { value: Value::String(value.trim().to_owned()), location: location.clone() },
        };
        Ok(Self { text: text.to_owned(), path, value })
    }
}

impl fmt::Display for Override {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

fn syntax(message: &str, location: Location) -> RecipeError {
    RecipeError::new("", RecipeProblem::Syntax(message.lines().collect::<Vec<_>>().join(", "))).at(location)
}

/// Where the lines of a text begin, so that the line of a place is found without reading the text again.
struct Lines {
    starts: Vec<usize>,
}

impl Lines {
    fn of(text: &str) -> Self {
        let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        Self { starts: std::iter::once(0).chain(breaks.map(|(offset, _)| offset + 1)).collect() }
    }

    fn locate(&self, offset: usize) -> Location {
        Location::Line(self.starts.partition_point(|&start| start <= offset))
    }
}

impl Node {
    pub(crate) fn from_toml(text: &str) -> Result<Self, RecipeError> {
        let lines = Lines::of(text);
        let table = DeTable::parse(text).map_err(|error| {
            syntax(error.message(), error.span().map_or(Location::Unknown, |span| lines.locate(span.start)))
        })?;
        Self::table_from_toml(table.get_ref(), &|offset| lines.locate(offset))
    }

    pub(crate) fn from_json(text: &str) -> Result<Self, RecipeError> {
        let options = ParseOptions {
            allow_comments: false,
            allow_loose_object_property_names: false,
            allow_trailing_commas: false,
            allow_missing_commas: false,
            allow_single_quoted_strings: false,
            allow_hexadecimal_numbers: false,
            allow_unary_plus_numbers: false,
            allow_bare_decimal_point_numbers: false,
            allow_non_finite_numbers: false,
            allow_extended_string_escapes: false,
        };
        let lines = Lines::of(text);
        let parsed = parse_to_ast(text, &Default::default(), &options)
            .map_err(|error| syntax(&error.kind().to_string(), lines.locate(error.range().start)))?;
        match parsed.value {
            Some(value) => Self::value_from_json(&value, &lines),
            None => Err(syntax("the file holds no value", Location::Unknown)),
        }
    }

    fn table_from_toml(table: &DeTable<'_>, locate: &dyn Fn(usize) -> Location) -> Result<Self, RecipeError> {
        let entries = table.iter().map(|(key, value)| {
            let location = locate(key.span().start);
            let node = Self::value_from_toml(value.get_ref(), locate, locate(value.span().start))?;
            Ok(Entry { key: key.get_ref().to_string(), location, node })
        });
        Ok(Self { location: locate(0), value: Value::Table(entries.collect::<Result<_, RecipeError>>()?) })
    }

    fn value_from_toml(
        value: &DeValue<'_>,
        locate: &dyn Fn(usize) -> Location,
        location: Location,
    ) -> Result<Self, RecipeError> {
        let value = match value {
            DeValue::String(text) => Value::String(text.to_string()),
            DeValue::Boolean(value) => Value::Boolean(*value),
            DeValue::Integer(digits) => match i64::from_str_radix(digits.as_str(), digits.radix()) {
                Ok(integer) => Value::Integer(integer),
                Err(_) => return Err(syntax(&format!("the whole number {} is too large", digits.as_str()), location)),
            },
            DeValue::Float(digits) => match digits.as_str().parse() {
                Ok(float) => Value::Float(float),
                Err(_) => return Err(syntax(&format!("{} is not a number", digits.as_str()), location)),
            },
            DeValue::Datetime(_) => return Err(syntax("dates have no place in a recipe", location)),
            DeValue::Array(array) => Value::Array(
                array
                    .iter()
                    .map(|item| Self::value_from_toml(item.get_ref(), locate, locate(item.span().start)))
                    .collect::<Result<_, _>>()?,
            ),
            DeValue::Table(table) => Self::table_from_toml(table, locate)?.value,
        };
        Ok(Self { location, value })
    }

    fn value_from_json(value: &ast::Value<'_>, lines: &Lines) -> Result<Self, RecipeError> {
        let location = lines.locate(value.range().start);
        let value = match value {
            ast::Value::NullKeyword(_) => Value::Null,
            ast::Value::BooleanLit(literal) => Value::Boolean(literal.value),
            ast::Value::StringLit(literal) => Value::String(literal.value.to_string()),
            ast::Value::NumberLit(literal) => match (literal.value.parse(), literal.value.parse()) {
                (Ok(integer), _) => Value::Integer(integer),
                (_, Ok(float)) => Value::Float(float),
                _ => return Err(syntax(&format!("{} is not a number", literal.value), location)),
            },
            ast::Value::Array(array) => {
                let items = array.elements.iter().map(|item| Self::value_from_json(item, lines));
                Value::Array(items.collect::<Result<_, _>>()?)
            }
            ast::Value::Object(object) => {
                let mut entries: Vec<Entry> = Vec::with_capacity(object.properties.len());
                for property in &object.properties {
                    let key = property.name.as_str().to_owned();
                    let location = lines.locate(property.range().start);
                    if entries.iter().any(|entry| entry.key == key) {
                        return Err(syntax(&format!("the key `{key}` is given twice"), location));
                    }
                    entries.push(Entry { key, location, node: Self::value_from_json(&property.value, lines)? });
                }
                Value::Table(entries)
            }
        };
        Ok(Self { location, value })
    }

    /// Puts what the override says in the place of what the recipe says.
    pub(crate) fn apply(&mut self, setting: &Override) -> Result<(), RecipeError> {
        let location = &setting.value.location;
        let mut node = self;
        for (depth, step) in setting.path.iter().enumerate() {
            if !matches!(node.value, Value::Table(_) | Value::Array(_)) {
                node.value = Value::Table(Vec::new());
            }
            node = match &mut node.value {
                Value::Array(items) => {
                    let length = items.len();
                    match step.parse::<usize>().ok().and_then(|index| items.get_mut(index)) {
                        Some(item) => item,
                        None => {
                            let path = setting.path[..=depth].join(".");
                            let problem = RecipeProblem::NoSuchElement { length };
                            return Err(RecipeError::new(&path, problem).at(location.clone()));
                        }
                    }
                }
                Value::Table(entries) => {
                    let index = entries.iter().position(|entry| entry.key == *step).unwrap_or_else(|| {
                        let node = Self { location: location.clone(), value: Value::Null };
                        entries.push(Entry { key: step.clone(), location: location.clone(), node });
                        entries.len() - 1
                    });
                    entries[index].location = location.clone();
                    &mut entries[index].node
                }
                _ => unreachable!("made a table above"),
            };
        }
        *node = setting.value.clone();
        Ok(())
    }

    /// The place of the key `path` names, or of the nearest table above it that was written down.
    pub(crate) fn locate(&self, path: &str) -> Location {
        let mut node = self;
        let mut location = Location::Unknown;
        // A tool's name may itself hold dots, so a step takes whichever key the rest of the path begins with.
        let mut rest = path;
        while !rest.is_empty() {
            let next = match &node.value {
                Value::Table(entries) => entries.iter().find_map(|entry| {
                    let after = rest.strip_prefix(entry.key.as_str())?;
                    let after = if after.is_empty() { after } else { after.strip_prefix('.')? };
                    Some((&entry.node, &entry.location, after))
                }),
                Value::Array(items) => {
                    let (index, after) = rest.split_once('.').unwrap_or((rest, ""));
                    let item = index.parse::<usize>().ok().and_then(|index| items.get(index));
                    item.map(|item| (item, &item.location, after))
                }
                _ => None,
            };
            let Some((child, place, after)) = next else { break };
            (node, location, rest) = (child, place.clone(), after);
        }
        location
    }
}
