//! The parts of a file that a person reads.

/// A kind of file, by which its prose is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Source {
    /// Comments, documentation and string literals.
    Rust,
    /// Comments of `#` and everything in quotes, docstrings included.
    Python,
    /// Comments and string literals.
    C,
    /// Every line.
    Text,
}

/// One line of prose.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line<'a> {
    /// Counted from 1.
    pub(super) number: usize,
    pub(super) text: &'a str,
    pub(super) is_rust_comment: bool,
}

/// The checker's own files, which have to name the idioms.
const OWN_FILES: &str = "crates/xtask/src/prose";

impl Source {
    /// The kind of a file, or `None` if it holds no prose of the project.
    pub(super) fn of(path: &str) -> Option<Self> {
        if path.starts_with(OWN_FILES) || path.starts_with("LICENSE") || path.starts_with("bench/baselines") {
            return None;
        }
        match path.rsplit_once('.')?.1 {
            "rs" => Some(Self::Rust),
            "py" | "pyi" => Some(Self::Python),
            "c" | "h" | "js" | "mjs" | "ts" => Some(Self::C),
            "md" | "toml" | "html" => Some(Self::Text),
            "json" if path.starts_with("schema/") => Some(Self::Text),
            _ => None,
        }
    }
}

/// The lines of prose of a file.
pub(super) fn lines(source: Source, text: &str) -> Vec<Line<'_>> {
    let line = |(index, text)| {
        let number = index + 1;
        prose_of(source, text).into_iter().map(move |(text, is_comment)| Line {
            number,
            text,
            is_rust_comment: is_comment && source == Source::Rust,
        })
    };
    text.lines().enumerate().flat_map(line).collect()
}

/// The parts of one line that are prose, and whether each is a comment.
fn prose_of(source: Source, line: &str) -> Vec<(&str, bool)> {
    let mark = match source {
        Source::Text => return vec![(line, true)],
        // A docstring has no mark of its own on its inner lines; identifiers in between match no idiom.
        Source::Python => return vec![(line, true)],
        Source::Rust | Source::C => "//",
    };
    let trimmed = line.trim_start();
    if trimmed.starts_with(mark) || (source == Source::C && trimmed.starts_with(['*', '/'])) {
        return vec![(trimmed, true)];
    }
    let (code, comment) = split_at_comment(line, mark);
    let literals = code.split('"').skip(1).step_by(2).map(|literal| (literal, false));
    literals.chain(comment.map(|comment| (comment, true))).collect()
}

/// Splits a line of code at a comment that follows it; a mark inside quotes, as in an address, starts none.
fn split_at_comment<'a>(line: &'a str, mark: &str) -> (&'a str, Option<&'a str>) {
    let starts = line.match_indices(mark).map(|(start, _)| start);
    let outside_quotes = |&start: &usize| line[..start].matches('"').count().is_multiple_of(2);
    match starts.into_iter().find(outside_quotes) {
        Some(start) => (&line[..start], Some(&line[start..])),
        None => (line, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_comments_and_literals() {
        let found = prose_of(Source::Rust, r#"    say("a // b", x); // why"#);
        assert_eq!(found, [("a // b", false), ("// why", true)]);
        assert_eq!(prose_of(Source::Rust, "    let tells = 1;"), []);
        assert_eq!(prose_of(Source::C, " * Frees a mesh."), [("* Frees a mesh.", true)]);
    }

    #[test]
    fn knows_files_by_their_ending() {
        assert_eq!(Source::of("crates/mesh/src/lib.rs"), Some(Source::Rust));
        assert_eq!(Source::of("schema/recipe.json"), Some(Source::Text));
        assert_eq!(Source::of("bench/instructions.json"), None);
        assert_eq!(Source::of("data/bar.obj"), None);
    }
}
