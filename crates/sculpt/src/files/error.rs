//! Errors when loading the files of a recipe.

use std::path::Path;

use isochore_mesh::io::ReadError;

use super::CsvError;

/// A file that a recipe names cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{key}: {}", described(.name, .problem))]
pub struct LoadError {
    /// Dotted path of the key with the name.
    pub key: String,
    /// Name of the file in the recipe.
    pub name: String,
    /// The problem.
    pub problem: FileProblem,
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
    /// The mesh cannot be read.
    #[error(transparent)]
    Mesh(#[from] ReadError),
    /// The table cannot be read, or its numbers cannot be used.
    #[error(transparent)]
    Table(#[from] CsvError),
}

/// Messages of readers begin with the path of the file; the others need its name.
fn described(name: &str, problem: &FileProblem) -> String {
    match problem {
        FileProblem::NotGiven | FileProblem::MeshForTable => format!("`{name}` {problem}"),
        FileProblem::Mesh(_) | FileProblem::Table(_) => problem.to_string(),
    }
}

impl LoadError {
    pub(super) fn new(key: String, name: &str, problem: FileProblem) -> Self {
        Self { key, name: name.to_owned(), problem }
    }

    /// Path of the file, or its name in the recipe if it is not on disk.
    pub fn path(&self) -> &Path {
        match &self.problem {
            FileProblem::NotGiven | FileProblem::MeshForTable => Path::new(&self.name),
            FileProblem::Mesh(
                ReadError::UnknownFormat { path } | ReadError::Io { path, .. } | ReadError::Parse { path, .. },
            ) => path,
            FileProblem::Table(error) => error.path(),
        }
    }

    /// The error of the system, if the file cannot be read.
    pub fn io_error(&self) -> Option<&std::io::Error> {
        match &self.problem {
            FileProblem::Mesh(ReadError::Io { source, .. }) | FileProblem::Table(CsvError::Io { source, .. }) => {
                Some(source)
            }
            _ => None,
        }
    }
}
