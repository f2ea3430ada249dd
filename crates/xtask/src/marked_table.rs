//! Tables of figures in documents, which only the command that measures them writes.

use std::{fs, path::Path};

use crate::shell::TaskResult;

/// The marker lines around a table. `name` identifies the table, `command` is the task that writes it.
pub(crate) struct Markers {
    begin: String,
    end: String,
}

impl Markers {
    pub(crate) fn new(name: &str, command: &str) -> Self {
        Self { begin: format!("<!-- {name}: written by {command} -->\n"), end: format!("<!-- end of {name} -->\n") }
    }

    /// The document with the text between the markers replaced by `table`.
    ///
    /// # Errors
    /// A marker line is missing.
    pub(crate) fn replace(&self, document: &str, table: &str) -> TaskResult<String> {
        let (before, _, after) = self.parts(document)?;
        let Self { begin, end } = self;
        Ok(format!("{before}{begin}\n{table}\n{end}{after}"))
    }

    /// The text between the markers.
    ///
    /// # Errors
    /// A marker line is missing.
    pub(crate) fn content<'a>(&self, document: &'a str) -> TaskResult<&'a str> {
        self.parts(document).map(|(_, content, _)| content.trim_matches('\n'))
    }

    /// Replaces the table in a file.
    ///
    /// # Errors
    /// The file cannot be read or written, or lacks a marker line.
    pub(crate) fn write_into(&self, path: &Path, table: &str) -> TaskResult {
        let document = fs::read_to_string(path)?;
        let document = self.replace(&document, table).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(fs::write(path, document)?)
    }

    fn parts<'a>(&self, document: &'a str) -> TaskResult<(&'a str, &'a str, &'a str)> {
        let missing = |marker: &str| format!("the line `{}` is missing", marker.trim_end());
        let (before, rest) = document.split_once(&self.begin).ok_or_else(|| missing(&self.begin))?;
        let (content, after) = rest.split_once(&self.end).ok_or_else(|| missing(&self.end))?;
        Ok((before, content, after))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_only_the_text_between_the_markers() {
        let markers = Markers::new("speed", "cargo xtask bench");
        let empty = "a\n<!-- speed: written by cargo xtask bench -->\n<!-- end of speed -->\nb\n";
        let once = markers.replace(empty, "one").unwrap();
        assert_eq!(markers.content(&once).unwrap(), "one");
        assert_eq!(markers.replace(&once, "two").unwrap(), markers.replace(empty, "two").unwrap());
        assert!(once.starts_with("a\n") && once.ends_with("b\n"));
        assert!(markers.replace("no markers", "one").is_err());
    }
}
