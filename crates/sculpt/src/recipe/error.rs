//! An invalid value in a recipe, with its key and its line.

use std::{error::Error, fmt};

use super::problem::{
    CombinationProblem, GeometryProblem, InvalidRecipe, NoSuchElement, NumberProblem, RecipeProblem, ReferenceProblem,
    SkeletonProblem, StructureProblem, SyntaxProblem,
};

/// An invalid value in a recipe: its location, its key, and the problem with a remedy.
///
/// `P` is the set of problems that a function can find, such as [`NumberProblem`] in
/// [`Key::pose`](super::Key::pose). All of them convert into the default, [`RecipeProblem`].
#[derive(Debug, Clone, PartialEq)]
pub struct RecipeError<P = RecipeProblem> {
    /// Source location of the value.
    pub location: Location,
    /// Dotted path of the key; elements of lists go by their index (`stroke.0.keys.1.at`). Empty
    /// for the recipe as a whole.
    pub key: String,
    /// The problem. It is boxed because errors are rare and results should stay small.
    pub problem: Box<P>,
}

/// Source location of a value.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Location {
    /// Not known: the recipe was built in code, or the key is missing.
    #[default]
    Unknown,
    /// A line of the recipe, counted from 1.
    Line(usize),
    /// An [`Override`](super::Override) with this text.
    Override(String),
}

impl Location {
    /// Beginning of a message about the value; empty if the location is unknown.
    pub(crate) fn prefix(&self) -> String {
        match self {
            Self::Unknown => String::new(),
            Self::Line(line) => format!("line {line}: "),
            Self::Override(text) => format!("--set {text}: "),
        }
    }
}

impl<P: fmt::Display> fmt::Display for RecipeError<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let separator = if self.key.is_empty() { "" } else { ": " };
        let text = format!("{}{}{separator}{}", self.location.prefix(), self.key, self.problem);
        // Names come from the recipe and may contain any character, but an error is one line.
        text.chars()
            .try_for_each(|c| if c.is_control() { write!(f, "{}", c.escape_default()) } else { write!(f, "{c}") })
    }
}

impl<P: fmt::Debug + fmt::Display> Error for RecipeError<P> {}

impl<P> RecipeError<P> {
    pub(crate) fn new(key: &str, problem: impl Into<P>) -> Self {
        Self { location: Location::Unknown, key: key.to_owned(), problem: Box::new(problem.into()) }
    }

    pub(crate) fn at(self, location: Location) -> Self {
        Self { location, ..self }
    }

    /// The same error seen from the table or list that contains the value under the key `segment`.
    pub(crate) fn inside(mut self, segment: &str) -> Self {
        self.key = if self.key.is_empty() { segment.to_owned() } else { format!("{segment}.{}", self.key) };
        self
    }

    /// The same error with a wider set of problems.
    pub(crate) fn widen<Q: From<P>>(self) -> RecipeError<Q> {
        RecipeError { location: self.location, key: self.key, problem: Box::new((*self.problem).into()) }
    }
}

/// Lets `?` widen an error. A blanket implementation would overlap with `From<T> for T`.
macro_rules! widens {
    ($($narrow:ty => $($wide:ty),+;)+) => {
        $($(impl From<RecipeError<$narrow>> for RecipeError<$wide> {
            fn from(error: RecipeError<$narrow>) -> Self {
                error.widen()
            }
        })+)+
    };
}

widens! {
    SyntaxProblem => RecipeProblem;
    StructureProblem => RecipeProblem;
    NoSuchElement => RecipeProblem;
    InvalidRecipe => RecipeProblem;
    NumberProblem => InvalidRecipe, RecipeProblem;
    ReferenceProblem => InvalidRecipe;
    CombinationProblem => InvalidRecipe;
    GeometryProblem => InvalidRecipe;
    SkeletonProblem => InvalidRecipe;
}
