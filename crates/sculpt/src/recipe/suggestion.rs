//! Suggestions for misspelled words.

/// A misspelled word with the choices that its place allows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Suggestion {
    /// The choice with the most similar spelling, if one is similar enough to explain a slip.
    pub nearest: Option<String>,
    /// All choices.
    pub known: Vec<String>,
}

impl Suggestion {
    pub(super) fn new<'a>(word: &str, choices: impl IntoIterator<Item = &'a str>) -> Self {
        let known: Vec<String> = choices.into_iter().map(str::to_owned).collect();
        Self { nearest: nearest(word, &known), known }
    }
}

/// `; did you mean …?`, or the list of choices if none is near.
impl std::fmt::Display for Suggestion {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.nearest {
            Some(nearest) => write!(f, "; did you mean `{nearest}`?"),
            None if self.known.is_empty() => Ok(()),
            None => write!(f, "; valid choices: {}", self.known.join(", ")),
        }
    }
}

/// Least similarity of a suggestion, from 0 to 1. A smaller value suggests unrelated words; a
/// larger value misses two swapped letters in a short word.
const LEAST_SIMILARITY: f64 = 0.7;

/// Similarity of two spellings, from 0 to 1. Returns `None` if it is too low to explain a slip.
pub(crate) fn similarity(word: &str, choice: &str) -> Option<f64> {
    let similarity = strsim::jaro_winkler(&word.to_lowercase(), &choice.to_lowercase());
    (similarity >= LEAST_SIMILARITY).then_some(similarity)
}

fn nearest(word: &str, choices: &[String]) -> Option<String> {
    choices
        .iter()
        .filter_map(|choice| Some((similarity(word, choice)?, choice)))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, choice)| choice.clone())
}
