//! Errors when loading the files of a recipe.

use std::{
    error::Error,
    fmt, io,
    path::{Path, PathBuf},
};

use isochore_mesh::io::{Format, ReadError};

use super::{CsvError, similar_name::similar_name};
use crate::{
    recipe::{self, Location, Recipe},
    report::Source,
};

/// A file that a recipe names cannot be used.
#[derive(Debug)]
pub struct LoadError {
    /// The file of the recipe, if [`in_recipe`](Self::in_recipe) has added it.
    pub recipe: Option<PathBuf>,
    /// Source location of the key, if [`in_recipe`](Self::in_recipe) has added it.
    pub location: Location,
    /// Dotted path of the key with the name.
    pub key: String,
    /// Name of the file in the recipe.
    pub name: String,
    /// The problem. It is boxed because errors are rare and results should stay small.
    pub problem: Box<FileProblem>,
}

/// Problems with a file.
#[derive(Debug, thiserror::Error)]
pub enum FileProblem {
    /// The name did not resolve.
    #[error("was not passed in")]
    NotGiven,
    /// A mesh was passed in for a table of numbers.
    #[error("is a mesh, but the recipe needs a table of numbers")]
    MeshForTable,
    /// The file does not exist.
    #[error("{}: {source}", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
        /// Name for the recipe of a file in the same folder, if one is similar enough to explain a
        /// slip.
        similar: Option<String>,
    },
    /// The mesh cannot be read.
    #[error(transparent)]
    Mesh(#[from] ReadError),
    /// The table cannot be read, or its numbers cannot be used.
    #[error(transparent)]
    Table(#[from] CsvError),
}

impl FileProblem {
    /// Turns the error of a reader that did not find the file `name` into [`FileProblem::Missing`].
    fn or_missing(self, name: &str) -> Self {
        let is_missing = |source: &io::Error| source.kind() == io::ErrorKind::NotFound;
        match self {
            Self::Mesh(ReadError::Io { path, source }) if is_missing(&source) => {
                let similar = similar_name(name, &path, |path| Format::of_path(path).is_some());
                Self::Missing { path, source, similar }
            }
            Self::Table(CsvError::Io { path, source }) if is_missing(&source) => {
                let similar = similar_name(name, &path, |path| path.extension().is_some_and(|end| end == "csv"));
                Self::Missing { path, source, similar }
            }
            problem => problem,
        }
    }
}

impl LoadError {
    /// The problem with the file `name` that the value of `key` names.
    pub fn new(key: &str, name: &str, problem: FileProblem) -> Self {
        let problem = Box::new(problem.or_missing(name));
        Self { recipe: None, location: Location::Unknown, key: key.to_owned(), name: name.to_owned(), problem }
    }

    /// Adds the file of the recipe and the source location of the key. `source` is the text from
    /// which the recipe was parsed.
    #[must_use]
    pub fn in_recipe(self, path: &Path, source: Source<'_>) -> Self {
        let location = Recipe::locate(source, recipe::Format::of_path(path), &self.key);
        Self { recipe: Some(path.to_owned()), location, ..self }
    }

    /// Path of the file, or its name in the recipe if it is not on disk.
    pub fn path(&self) -> &Path {
        match &*self.problem {
            FileProblem::NotGiven | FileProblem::MeshForTable => Path::new(&self.name),
            FileProblem::Missing { path, .. }
            | FileProblem::Mesh(
                ReadError::UnknownFormat { path } | ReadError::Io { path, .. } | ReadError::Parse { path, .. },
            ) => path,
            FileProblem::Table(error) => error.path(),
        }
    }

    /// The error of the system, if the file cannot be read.
    pub fn io_error(&self) -> Option<&io::Error> {
        match &*self.problem {
            FileProblem::Missing { source, .. }
            | FileProblem::Mesh(ReadError::Io { source, .. })
            | FileProblem::Table(CsvError::Io { source, .. }) => Some(source),
            _ => None,
        }
    }
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(recipe) = &self.recipe {
            write!(f, "{}: ", recipe.display())?;
        }
        write!(f, "{}{}: ", self.location.prefix(), self.key)?;
        match &*self.problem {
            problem @ (FileProblem::NotGiven | FileProblem::MeshForTable) => write!(f, "`{}` {problem}", self.name),
            problem @ FileProblem::Missing { similar, .. } => {
                write!(f, "{problem}")?;
                if self.recipe.is_some() && Path::new(&self.name).is_relative() {
                    write!(f, "; paths are relative to the recipe")?;
                }
                similar.iter().try_for_each(|similar| write!(f, "; did you mean `{similar}`?"))
            }
            // Messages of readers begin with the path of the file.
            problem => write!(f, "{problem}"),
        }
    }
}

impl Error for LoadError {}
