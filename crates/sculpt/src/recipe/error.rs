//! What can be wrong with a recipe.

use std::fmt;

/// Something in a recipe that cannot be used: where, which key, and what would mend it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub struct RecipeError {
    /// Where it was written.
    pub location: Location,
    /// Dotted path of the key, elements of lists by their number from zero (`stroke.0.keys.1.at`); empty for the recipe as a whole.
    pub key: String,
    /// What is wrong with it; boxed, because most results are no errors and should stay small.
    pub problem: Box<RecipeProblem>,
}

/// Where in its source a value was written.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Location {
    /// Nowhere that is known: the recipe was made by a program, or the key is missing.
    #[default]
    Unknown,
    /// A line of the recipe, the first being 1.
    Line(usize),
    /// An [`Override`](super::Override) with this text.
    Override(String),
}

/// What is wrong with a value of a recipe.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecipeProblem {
    /// The text is neither TOML nor JSON.
    #[error("{0}")]
    Syntax(String),
    /// A key that recipes do not have.
    #[error("unknown key{}", suggestion(.nearest, .known))]
    UnknownKey {
        /// The known key that is spelled most like it.
        nearest: Option<String>,
        /// All keys that can stand here.
        known: Vec<String>,
    },
    /// A word that is not one of the choices.
    #[error("unknown value `{found}`{}", suggestion(.nearest, .known))]
    UnknownValue {
        /// The word.
        found: String,
        /// The choice that is spelled most like it.
        nearest: Option<String>,
        /// All choices.
        known: Vec<String>,
    },
    /// A key that must be there is not.
    #[error("missing; add it")]
    Missing,
    /// A value of the wrong type.
    #[error("{found} stands where {expected} is expected")]
    WrongType {
        /// What was written.
        found: String,
        /// What should have been.
        expected: String,
    },
    /// A list of the wrong length.
    #[error("has {found} entries where {expected} are expected")]
    WrongLength {
        /// How many were written.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// An override of an element that the list does not have.
    #[error("no such element: the list has {length}, numbered from 0")]
    NoSuchElement {
        /// How many elements it has.
        length: usize,
    },
    /// The recipe is of a version that is not known here.
    #[error("version {0} is not known; this program reads version 1")]
    UnknownVersion(u32),
    /// NaN or infinity.
    #[error("is {0}; give a finite number")]
    NotFinite(f64),
    /// A number that must be above zero is not.
    #[error("is {0}; give a number above 0")]
    NotPositive(f64),
    /// A number that may not be negative is.
    #[error("is {0}; give 0 or more")]
    Negative(f64),
    /// A count below its minimum.
    #[error("is {found}; give at least {least}")]
    TooSmall {
        /// The count.
        found: u64,
        /// The smallest that makes sense.
        least: u64,
    },
    /// A number above its maximum.
    #[error("is {found}; give {most} or less")]
    AboveMost {
        /// The number.
        found: f64,
        /// The largest that makes sense.
        most: f64,
    },
    /// A request for more than fits.
    #[error("asks for {requested} {what}, more than the {most} allowed; choose a coarser one")]
    TooLarge {
        /// How many were asked for.
        requested: u64,
        /// The most there may be.
        most: u64,
        /// Of what.
        what: &'static str,
    },
    /// An axis without direction.
    #[error("has an axis of length zero; give it a direction, such as [0, 0, 1]")]
    ZeroAxis,
    /// A motion that goes from nowhere to nowhere.
    #[error("has {0} poses; a motion needs at least 2")]
    TooFewKeys(usize),
    /// Half a turn, which has no shorter way round.
    #[error(
        "turns the tool by exactly 180 degrees from the pose before, and both ways round are equally short; add a pose between"
    )]
    HalfTurn,
    /// Two things where one is wanted.
    #[error("names both a mesh and a shape; remove one of them")]
    MeshAndShape,
    /// Neither of the two things of which one is wanted.
    #[error("names neither a mesh nor a shape; add one of them")]
    NeitherMeshNorShape,
    /// A stroke with a tool that is not in the recipe.
    #[error("there is no tool `{name}`{}", suggestion(.nearest, .known))]
    UnknownTool {
        /// The name.
        name: String,
        /// The tool whose name is spelled most like it.
        nearest: Option<String>,
        /// All tools of the recipe.
        known: Vec<String>,
    },
    /// A name that no bone of the stroke has.
    #[error("there is no bone `{name}`{}", suggestion(.nearest, .known))]
    UnknownBone {
        /// The name.
        name: String,
        /// The bone whose name is spelled most like it.
        nearest: Option<String>,
        /// All bones of the stroke.
        known: Vec<String>,
    },
    /// Anything else that a reader of recipes has to say.
    #[error("{0}")]
    Other(String),
}

/// `; did you mean …?`, or the list of choices where none is near.
fn suggestion(nearest: &Option<String>, known: &[String]) -> String {
    match nearest {
        Some(nearest) => format!("; did you mean `{nearest}`?"),
        None if known.is_empty() => String::new(),
        None => format!("; known here: {}", known.join(", ")),
    }
}

impl fmt::Display for RecipeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = match &self.location {
            Location::Unknown => String::new(),
            Location::Line(line) => format!("line {line}: "),
            Location::Override(text) => format!("--set {text}: "),
        };
        let separator = if self.key.is_empty() { "" } else { ": " };
        let text = format!("{place}{}{separator}{}", self.key, self.problem);
        // Names come from the recipe and may hold anything, but an error is one line.
        text.chars()
            .try_for_each(|c| if c.is_control() { write!(f, "{}", c.escape_default()) } else { write!(f, "{c}") })
    }
}

impl RecipeError {
    pub(crate) fn new(key: &str, problem: RecipeProblem) -> Self {
        Self { location: Location::Unknown, key: key.to_owned(), problem: Box::new(problem) }
    }

    pub(crate) fn at(self, location: Location) -> Self {
        Self { location, ..self }
    }

    /// The same error seen from the table or list that holds it as `segment`.
    pub(crate) fn inside(mut self, segment: &str) -> Self {
        self.key = if self.key.is_empty() { segment.to_owned() } else { format!("{segment}.{}", self.key) };
        self
    }
}

/// The choice that is spelled most like `word`, if any is so near that a slip explains the difference.
pub(crate) fn nearest<'a>(word: &str, choices: impl IntoIterator<Item = &'a str>) -> Option<String> {
    // Below this likeness suggestions become random; above it two swapped letters in a short word find nothing.
    const LEAST_LIKENESS: f64 = 0.7;
    choices
        .into_iter()
        .map(|choice| (strsim::jaro_winkler(&word.to_lowercase(), &choice.to_lowercase()), choice))
        .filter(|(likeness, _)| *likeness >= LEAST_LIKENESS)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, choice)| choice.to_owned())
}
