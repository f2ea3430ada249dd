//! The page of the guide that lists every key of a recipe, generated from the schema.

use std::{fmt::Write as _, fs, path::PathBuf};

use serde_json::{Map, Value};

use crate::shell::{TaskResult, workspace};

const HEADER: &str = "# Recipe reference\n\n\
    <!-- Generated from schema/recipe.json by `cargo xtask reference`. Do not edit. -->\n\n\
    Every key of a recipe, in TOML or JSON. Lengths are in model units and angles in degrees. An unknown key is an error that\n\
    names the nearest known key.\n";

/// Fails if the page is out of date.
pub(super) fn check() -> TaskResult {
    let page = page_path();
    if fs::read_to_string(&page)? == render(&schema()?)? {
        Ok(())
    } else {
        Err(format!("{} is out of date; run: cargo xtask reference", page.display()).into())
    }
}

/// Writes the page.
pub(super) fn write() -> TaskResult {
    Ok(fs::write(page_path(), render(&schema()?)?)?)
}

fn page_path() -> PathBuf {
    workspace().join("docs/src/recipe-reference.md")
}

fn schema() -> TaskResult<Value> {
    Ok(serde_json::from_slice(&fs::read(workspace().join("schema/recipe.json"))?)?)
}

/// The page in Markdown: the recipe itself, then every type that its keys have.
fn render(schema: &Value) -> TaskResult<String> {
    let mut page = String::from(HEADER);
    section(&mut page, "Recipe", schema)?;
    let types = schema["$defs"].as_object().ok_or("the schema has no types")?;
    for (name, definition) in types {
        section(&mut page, name, definition)?;
    }
    Ok(page)
}

/// A heading, the description, and the keys or alternatives of a type.
fn section(page: &mut String, name: &str, definition: &Value) -> TaskResult {
    write!(page, "\n## {name}\n\n{}\n", description(definition))?;
    if let Some(alternatives) = alternatives(definition) {
        return variants(page, alternatives);
    }
    keys(page, definition)
}

fn alternatives(definition: &Value) -> Option<&Vec<Value>> {
    definition["oneOf"].as_array().or_else(|| definition["anyOf"].as_array())
}

/// The alternatives of a type: a list of values, or a table of keys for each kind.
fn variants(page: &mut String, variants: &[Value]) -> TaskResult {
    for variant in variants {
        if let Some(value) = variant["const"].as_str() {
            write!(page, "\n- `\"{value}\"`: {}", description(variant))?;
        } else if let Some(kind) = variant["properties"]["kind"]["const"].as_str() {
            write!(page, "\n### `kind = \"{kind}\"`\n\n{}\n", description(variant))?;
            keys(page, variant)?;
        } else {
            write!(page, "\n- {}: {}", type_of(variant), description(variant))?;
        }
    }
    if !page.ends_with('\n') {
        page.push('\n');
    }
    Ok(())
}

/// A table of the keys of an object, `kind` left out because its heading names it.
fn keys(page: &mut String, object: &Value) -> TaskResult {
    let Some(properties) = object["properties"].as_object() else { return Ok(()) };
    let listed: Map<String, Value> = properties.iter().filter(|(key, _)| *key != "kind").map(clone_pair).collect();
    if listed.is_empty() {
        return Ok(());
    }
    page.push_str("\n| key | type | default | description |\n|---|---|---|---|\n");
    for (key, property) in &listed {
        let is_required =
            object["required"].as_array().is_some_and(|required| required.contains(&Value::from(key.as_str())));
        let default = match property.get("default") {
            _ if is_required => "required".to_owned(),
            Some(Value::Null) | None => "–".to_owned(),
            Some(value) => format!("`{value}`"),
        };
        writeln!(page, "| `{key}` | {} | {default} | {} |", type_of(property), description(property))?;
    }
    Ok(())
}

fn clone_pair((key, value): (&String, &Value)) -> (String, Value) {
    (key.clone(), value.clone())
}

fn description(definition: &Value) -> String {
    let text = definition["description"].as_str().unwrap_or_default();
    text.replace('\n', " ").replace('|', "\\|")
}

/// The type of a value in words, with a link where it has a section of its own.
fn type_of(definition: &Value) -> String {
    if let Some(name) = definition["$ref"].as_str().and_then(|path| path.rsplit('/').next()) {
        return format!("[{name}](#{})", name.to_lowercase());
    }
    if let Some(alternatives) = alternatives(definition) {
        let words: Vec<String> = alternatives.iter().filter(|&one| one["type"] != "null").map(type_of).collect();
        return words.join(" or ");
    }
    let word = match &definition["type"] {
        Value::Array(types) => types.iter().find_map(|word| word.as_str().filter(|&word| word != "null")),
        word => word.as_str(),
    };
    match word {
        Some("array") => list_type(definition),
        Some("object") if definition["additionalProperties"].is_object() => {
            format!("table of {}", type_of(&definition["additionalProperties"]))
        }
        Some(word) => word.to_owned(),
        None => "value".to_owned(),
    }
}

/// The type of a list: of numbers by their count, of others by their item.
fn list_type(definition: &Value) -> String {
    let item = type_of(&definition["items"]);
    match (&definition["minItems"], &definition["maxItems"]) {
        (Value::Number(least), Value::Number(most)) if least == most => format!("{least} {item}s"),
        _ => format!("list of {item}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_have_their_type_default_and_description() {
        let schema = serde_json::json!({
            "description": "A job.",
            "properties": {
                "at": { "description": "Position | place.", "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 },
                "shape": { "description": "Shape.", "$ref": "#/$defs/Shape" },
                "count": { "description": "Number.", "type": ["integer", "null"], "default": 2 },
            },
            "required": ["at"],
            "$defs": { "Shape": { "description": "A shape.", "oneOf": [
                { "description": "A ball.", "properties": { "kind": { "const": "ball" }, "radius": { "type": "number", "description": "Radius." } } },
                { "description": "Round.", "const": "round" },
            ] } },
        });
        let page = render(&schema).unwrap();
        assert!(page.contains("| `at` | 3 numbers | required | Position \\| place. |"), "{page}");
        assert!(page.contains("| `shape` | [Shape](#shape) | – | Shape. |"), "{page}");
        assert!(page.contains("| `count` | integer | `2` | Number. |"), "{page}");
        assert!(page.contains("### `kind = \"ball\"`\n\nA ball.\n"), "{page}");
        assert!(page.contains("- `\"round\"`: Round.\n"), "{page}");
    }
}
