//! The page of the guide that lists every error message, generated from the error types of the crates.

use std::{fmt::Write as _, fs, path::PathBuf};

use crate::shell::{TaskResult, project_files, workspace};

/// The hand-written part of the page, and the line that the index replaces.
const TEMPLATE: &str = include_str!("errors.template.md");
const INDEX_LINE: &str = "{index}\n";

/// Crates whose errors a person sees, with the headings of their sections.
const SECTIONS: [(&str, &str); 5] = [
    ("crates/sculpt/src", "Recipes and sessions"),
    ("crates/cli/src", "The command"),
    ("crates/mesh/src", "Meshes and files"),
    ("crates/field/src", "Tools, fields and strokes"),
    ("crates/curve/src", "Curves and frames"),
];

/// A message of an error type, with the documentation of its variant.
#[derive(Debug, PartialEq)]
struct Entry {
    message: String,
    meaning: String,
}

/// Fails if the page is out of date, or if its hand-written part quotes a warning that no crate prints.
pub(super) fn check() -> TaskResult {
    check_warnings()?;
    if fs::read_to_string(page_path())? == render()? {
        Ok(())
    } else {
        Err(format!("{} is out of date; run: cargo xtask reference", page_path().display()).into())
    }
}

/// Writes the page.
pub(super) fn write() -> TaskResult {
    check_warnings()?;
    Ok(fs::write(page_path(), render()?)?)
}

fn page_path() -> PathBuf {
    workspace().join("docs/src/errors.md")
}

fn render() -> TaskResult<String> {
    let mut index = String::new();
    for (folder, heading) in SECTIONS {
        let mut entries = Vec::new();
        for (_, text) in sources(folder)? {
            entries.extend(entries_of(&text));
        }
        entries.sort_by(|a, b| a.message.cmp(&b.message));
        entries.dedup_by(|a, b| a.message == b.message);
        write!(index, "\n### {heading}\n\n| message | meaning |\n|---|---|\n")?;
        for Entry { message, meaning } in entries {
            writeln!(index, "| {} | {} |", code_span(&message), plain_links(&meaning).replace('|', "\\|"))?;
        }
    }
    Ok(TEMPLATE.replace(INDEX_LINE, &index))
}

/// A message as code in a table, also if it holds back quotes.
fn code_span(message: &str) -> String {
    let message = message.replace('|', "\\|");
    if message.contains('`') { format!("`` {message} ``") } else { format!("`{message}`") }
}

/// Documentation whose links to items are replaced by their text.
fn plain_links(text: &str) -> String {
    let mut pieces = text.split('[');
    let mut plain = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        match piece.split_once(']') {
            Some((name, rest)) if name.starts_with('`') => {
                plain.push_str(name);
                let address = rest.strip_prefix('(').and_then(|rest| rest.split_once(')'));
                plain.push_str(address.map_or(rest, |(_, after)| after));
            }
            _ => {
                plain.push('[');
                plain.push_str(piece);
            }
        }
    }
    plain
}

/// Every warning that the template quotes in the first column of its table must be part of a source file.
fn check_warnings() -> TaskResult {
    let texts: Vec<String> = sources("crates")?.into_iter().map(|(_, text)| joined_literals(&text)).collect();
    let quoted =
        TEMPLATE.lines().filter_map(|line| line.strip_prefix("| `")?.split_once("` |").map(|(quoted, _)| quoted));
    match quoted.into_iter().find(|quoted| !texts.iter().any(|text| text.contains(*quoted))) {
        Some(missing) => Err(format!("errors.template.md quotes `{missing}`, which no crate prints").into()),
        None => Ok(()),
    }
}

/// Rust files below a folder and their texts, in the order of their paths.
fn sources(folder: &str) -> TaskResult<Vec<(String, String)>> {
    let paths = project_files(&[&format!(":(glob){folder}/**/*.rs")])?;
    let read = |path: String| Ok((path.clone(), fs::read_to_string(workspace().join(path))?));
    paths.into_iter().map(read).collect()
}

/// A text in which literals that a backslash continues on the next line are joined.
fn joined_literals(text: &str) -> String {
    let mut lines = text.split("\\\n");
    let first = lines.next().unwrap_or_default().to_owned();
    lines.fold(first, |joined, line| joined + line.trim_start())
}

/// The messages of all `#[error("…")]` attributes of a file.
fn entries_of(text: &str) -> Vec<Entry> {
    let text = joined_literals(text);
    let attributes = text.match_indices("#[error(").map(|(start, mark)| (start, start + mark.len()));
    let entry = |(start, after): (usize, usize)| {
        let message = first_literal(&text[after..])?;
        Some(Entry { message, meaning: documentation_before(&text[..start]) })
    };
    attributes.filter_map(entry).filter(|entry| entry.message.contains(' ')).collect()
}

/// The string literal that an attribute begins with, or `None` if it begins otherwise, such as `transparent`.
fn first_literal(text: &str) -> Option<String> {
    let text = text.trim_start().strip_prefix('"')?;
    let mut literal = String::new();
    let mut letters = text.chars();
    while let Some(letter) = letters.next() {
        match letter {
            '"' => return Some(literal),
            '\\' => literal.extend(letters.next()),
            letter => literal.push(letter),
        }
    }
    None
}

/// The documentation comment that ends a text.
fn documentation_before(text: &str) -> String {
    let lines = text.trim_end().lines().rev();
    let mut documentation: Vec<&str> = lines.map_while(|line| line.trim().strip_prefix("///")).map(str::trim).collect();
    documentation.reverse();
    documentation.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn back_quotes_and_links_survive_the_table() {
        assert_eq!(code_span("a | b"), "`a \\| b`");
        assert_eq!(code_span("no `x`"), "`` no `x` ``");
        assert_eq!(plain_links("See [`a`](crate::A::a) and [`b`], as in [1]."), "See `a` and `b`, as in [1].");
    }

    #[test]
    fn messages_are_found_with_their_documentation() {
        let text = "/// Errors of tools.\nenum ToolError {\n    /// The support is not positive.\n    /// Or NaN.\n    \
            #[error(\"the support must be \\\n        positive, not {0}\")]\n    Support(f64),\n    #[error(transparent)]\n    Other(E),\n}";
        let expected = Entry {
            message: "the support must be positive, not {0}".to_owned(),
            meaning: "The support is not positive. Or NaN.".to_owned(),
        };
        assert_eq!(entries_of(text), [expected]);
    }
}
