//! The text of a recipe as a tree of values with their source locations.

use std::fmt;

use jsonc_parser::{ParseOptions, ast, common::Ranged, parse_to_ast};
use toml::de::{DeTable, DeValue};

use super::{
    Format,
    error::{Location, RecipeError},
    problem::{NoSuchElement, SyntaxProblem},
};

/// A value with its source location.
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

/// A key of a table, its source location, and its value.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    pub(crate) key: String,
    pub(crate) location: Location,
    pub(crate) node: Node,
}

/// A setting that replaces a value of a recipe: `tools.ball.support=0.2`.
///
/// The key is a dotted path; elements of lists go by their index: `stroke.0.keys.1.at`. The value
/// has the syntax of TOML, except that a string needs no quotes.
///
/// ```
/// use isochore_sculpt::recipe::{Format, Override, Recipe};
///
/// let text = "recipe = 1\ntarget = { mesh = 'column.obj' }";
/// let setting = Override::parse("refine.max_triangles=5000")?;
/// let recipe = Recipe::parse(text, Format::Toml, &[setting])?;
/// assert_eq!(recipe.refine.max_triangles, 5000);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Override {
    text: String,
    path: Vec<String>,
    value: Node,
}

impl Override {
    /// Parses `KEY=VALUE`.
    ///
    /// # Errors
    /// The `=` is missing, or the key or the value is malformed.
    pub fn parse(text: &str) -> Result<Self, RecipeError<SyntaxProblem>> {
        let location = Location::Override(text.to_owned());
        let wrong = |message: &str| malformed(message, location.clone());
        let (key, value) = text.split_once('=').ok_or_else(|| syntax(SyntaxProblem::NoEqualsSign, location.clone()))?;
        // A TOML parser turns each step of the key into a table inside the previous one.
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
            // A word that is not a value of another type is a string without quotes.
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

type SyntaxError = RecipeError<SyntaxProblem>;

fn syntax(problem: SyntaxProblem, location: Location) -> SyntaxError {
    RecipeError::new("", problem).at(location)
}

/// The error of a parser, whose messages may have several lines.
fn malformed(message: &str, location: Location) -> SyntaxError {
    syntax(SyntaxProblem::Malformed(message.lines().collect::<Vec<_>>().join(", ")), location)
}

/// Offsets at which the lines of a text begin, for finding the line of an offset by bisection.
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
    /// Parses the text of a recipe and applies `overrides`.
    pub(crate) fn parse(text: &str, format: Format, overrides: &[Override]) -> Result<Self, RecipeError> {
        let mut tree = match format {
            Format::Toml => Self::from_toml(text)?,
            Format::Json => Self::from_json(text)?,
        };
        for setting in overrides {
            tree.apply(setting)?;
        }
        Ok(tree)
    }

    fn from_toml(text: &str) -> Result<Self, SyntaxError> {
        let lines = Lines::of(text);
        let table = DeTable::parse(text).map_err(|error| {
            malformed(error.message(), error.span().map_or(Location::Unknown, |span| lines.locate(span.start)))
        })?;
        Self::table_from_toml(table.get_ref(), &|offset| lines.locate(offset))
    }

    fn from_json(text: &str) -> Result<Self, SyntaxError> {
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
            .map_err(|error| malformed(&error.kind().to_string(), lines.locate(error.range().start)))?;
        match parsed.value {
            Some(value) => Self::value_from_json(&value, &lines),
            None => Err(malformed("the file holds no value", Location::Unknown)),
        }
    }

    fn table_from_toml(table: &DeTable<'_>, locate: &dyn Fn(usize) -> Location) -> Result<Self, SyntaxError> {
        let entries = table.iter().map(|(key, value)| {
            let location = locate(key.span().start);
            let node = Self::value_from_toml(value.get_ref(), locate, locate(value.span().start))?;
            Ok(Entry { key: key.get_ref().to_string(), location, node })
        });
        Ok(Self { location: locate(0), value: Value::Table(entries.collect::<Result<_, SyntaxError>>()?) })
    }

    fn value_from_toml(
        value: &DeValue<'_>,
        locate: &dyn Fn(usize) -> Location,
        location: Location,
    ) -> Result<Self, SyntaxError> {
        let value = match value {
            DeValue::String(text) => Value::String(text.to_string()),
            DeValue::Boolean(value) => Value::Boolean(*value),
            DeValue::Integer(digits) => match i64::from_str_radix(digits.as_str(), digits.radix()) {
                Ok(integer) => Value::Integer(integer),
                Err(_) => return Err(syntax(SyntaxProblem::IntegerTooLarge(digits.to_string()), location)),
            },
            DeValue::Float(digits) => match digits.as_str().parse() {
                Ok(float) => Value::Float(float),
                Err(_) => return Err(syntax(SyntaxProblem::NotANumber(digits.to_string()), location)),
            },
            DeValue::Datetime(_) => return Err(syntax(SyntaxProblem::Date, location)),
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

    fn value_from_json(value: &ast::Value<'_>, lines: &Lines) -> Result<Self, SyntaxError> {
        let location = lines.locate(value.range().start);
        let value = match value {
            ast::Value::NullKeyword(_) => Value::Null,
            ast::Value::BooleanLit(literal) => Value::Boolean(literal.value),
            ast::Value::StringLit(literal) => Value::String(literal.value.to_string()),
            ast::Value::NumberLit(literal) => match (literal.value.parse(), literal.value.parse()) {
                (Ok(integer), _) => Value::Integer(integer),
                (_, Ok(float)) => Value::Float(float),
                _ => return Err(syntax(SyntaxProblem::NotANumber(literal.value.to_string()), location)),
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
                        return Err(syntax(SyntaxProblem::DuplicateKey(key), location));
                    }
                    entries.push(Entry { key, location, node: Self::value_from_json(&property.value, lines)? });
                }
                Value::Table(entries)
            }
        };
        Ok(Self { location, value })
    }

    /// Replaces the value that the override names.
    fn apply(&mut self, setting: &Override) -> Result<(), RecipeError<NoSuchElement>> {
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
                            return Err(RecipeError::new(&path, NoSuchElement { length }).at(location.clone()));
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

    /// `error` with the location of its key.
    pub(crate) fn located<P>(&self, error: RecipeError<P>) -> RecipeError<P> {
        let location = self.locate(&error.key);
        error.at(location)
    }

    /// Location of the key `path`, or of the innermost table above it that the text contains.
    pub(crate) fn locate(&self, path: &str) -> Location {
        let mut node = self;
        let mut location = Location::Unknown;
        // Names of tools may contain dots, so each step takes the key with which the rest of the
        // path begins.
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
            let Some((child, child_location, after)) = next else { break };
            (node, location, rest) = (child, child_location.clone(), after);
        }
        location
    }
}
