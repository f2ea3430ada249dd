//! Counts the idioms that make technical prose hard to read, per file, and fails above a limit.
//!
//! Rust comments are judged by a rate, because a rare use can be right. Everything else that a person reads outside the
//! source (documents, help, messages, schemas, stubs, headers) must be free of them.

mod text;

use std::{collections::BTreeMap, fs};

use regex::Regex;

use self::text::{Line, Source, lines};
use crate::shell::{TaskResult, project_files, workspace};

/// An idiom, and how many of them a thousand comment lines of Rust may hold.
struct Idiom {
    name: &'static str,
    pattern: &'static str,
    per_thousand_comments: f64,
}

const IDIOMS: [Idiom; 9] = [
    Idiom { name: "What … (first word)", pattern: r"^\W*What\b[^?]*$", per_thousand_comments: 0.0 },
    Idiom { name: "is no, are no", pattern: r"(?i)\b(is|are) no\b", per_thousand_comments: 1.0 },
    Idiom {
        name: "share (noun)",
        pattern: r"(?i)\b(a|the|its|their|this|that|which|each|every|equal|small|large) shares?\b|\bshares? of\b",
        per_thousand_comments: 1.0,
    },
    Idiom { name: "tell, tells, told", pattern: r"(?i)\b(tells?|told)\b", per_thousand_comments: 0.0 },
    Idiom { name: "none where, of, for", pattern: r"(?i)\bnone (where|of|for)\b", per_thousand_comments: 0.0 },
    Idiom { name: "by the clock", pattern: r"(?i)\bby the clock\b", per_thousand_comments: 0.0 },
    Idiom {
        name: "became of, came of",
        pattern: r"(?i)\bwhat (became|came|becomes|comes) of\b",
        per_thousand_comments: 0.0,
    },
    Idiom { name: "of whose", pattern: r"(?i)\bof whose\b", per_thousand_comments: 0.0 },
    Idiom {
        name: "way (path, motion)",
        pattern: r"(?i)\b(the|its|their|data's|tool's|whole|long) way\b( of\b|[,.;:]|$)",
        per_thousand_comments: 1.0,
    },
];

/// Counts the idioms in all files of the repository, prints those found, and fails above the limits.
pub(crate) fn check() -> TaskResult {
    let mut report = Report::default();
    for path in project_files(&[])? {
        let Some(source) = Source::of(&path) else { continue };
        let text = fs::read_to_string(workspace().join(&path))?;
        report.add(&path, &lines(source, &text));
    }
    report.print();
    let failures = report.failures();
    if failures.is_empty() { Ok(()) } else { Err(failures.join("; ").into()) }
}

/// Counts by idiom.
struct Report {
    patterns: Vec<Regex>,
    rust_comments: usize,
    in_rust_comments: [usize; IDIOMS.len()],
    elsewhere: [usize; IDIOMS.len()],
    by_file: BTreeMap<String, Vec<String>>,
}

impl Default for Report {
    fn default() -> Self {
        let pattern = |idiom: &Idiom| Regex::new(idiom.pattern).expect("the patterns of the table are valid");
        Self {
            patterns: IDIOMS.iter().map(pattern).collect(),
            rust_comments: 0,
            in_rust_comments: [0; IDIOMS.len()],
            elsewhere: [0; IDIOMS.len()],
            by_file: BTreeMap::new(),
        }
    }
}

impl Report {
    fn add(&mut self, path: &str, lines: &[Line<'_>]) {
        for line in lines {
            self.rust_comments += usize::from(line.is_rust_comment);
            for (idiom, pattern) in self.patterns.iter().enumerate() {
                let count = pattern.find_iter(line.text).count();
                if count == 0 {
                    continue;
                }
                let counts = if line.is_rust_comment { &mut self.in_rust_comments } else { &mut self.elsewhere };
                counts[idiom] += count;
                let found = format!("  {}: {}: {}", line.number, IDIOMS[idiom].name, line.text.trim());
                self.by_file.entry(path.to_owned()).or_default().push(found);
            }
        }
    }

    fn print(&self) {
        for (path, found) in &self.by_file {
            eprintln!("{path}: {}", found.len());
            found.iter().for_each(|line| eprintln!("{line}"));
        }
        eprintln!("{:<24} {:>24} {:>10}", "idiom", "per 1000 Rust comments", "elsewhere");
        for (index, idiom) in IDIOMS.iter().enumerate() {
            eprintln!("{:<24} {:>24.2} {:>10}", idiom.name, self.rate(index), self.elsewhere[index]);
        }
    }

    fn rate(&self, idiom: usize) -> f64 {
        1000.0 * self.in_rust_comments[idiom] as f64 / self.rust_comments.max(1) as f64
    }

    fn failures(&self) -> Vec<String> {
        let mut failures = Vec::new();
        for (index, idiom) in IDIOMS.iter().enumerate() {
            if self.rate(index) > idiom.per_thousand_comments {
                let limit = idiom.per_thousand_comments;
                failures.push(format!("`{}`: {:.2} per 1000 comments, limit {limit}", idiom.name, self.rate(index)));
            }
            if self.elsewhere[index] > 0 {
                failures.push(format!("`{}`: {} outside Rust comments, limit 0", idiom.name, self.elsewhere[index]));
            }
        }
        failures
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn failures_of(path: &str, text: &str) -> usize {
        let mut report = Report::default();
        report.add(path, &lines(Source::of(path).unwrap(), text));
        report.failures().len()
    }

    #[test]
    fn finds_idioms_in_comments_messages_and_documents() {
        assert_eq!(failures_of("a.rs", "/// What became of the target.\n"), 2);
        assert_eq!(failures_of("a.rs", "    #[error(\"{0} is no number\")]\n"), 1);
        assert_eq!(failures_of("a.md", "The report tells the share of it.\n"), 2);
        assert_eq!(failures_of("a.pyi", "    \"\"\"None where it is open; none of them.\"\"\"\n"), 1);
    }

    #[test]
    fn accepts_plain_sentences_and_code() {
        assert_eq!(failures_of("a.rs", "/// Result of a replay.\nlet share = 1.0; // Shared by both.\n"), 0);
        assert_eq!(failures_of("a.md", "What is a spine? The two sides share an edge in the same way.\n"), 0);
    }
}
