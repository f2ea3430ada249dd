//! Errors as Python exceptions.
//!
//! Files that cannot be accessed raise `OSError`. Arguments of the wrong type or form raise
//! `TypeError` or `ValueError`. Everything else raises an exception of this package.

use std::{fmt::Display, io};

use isochore_mesh::{
    DistanceFieldError, MeshError, SelfIntersectionError,
    io::{ReadError, WriteError},
};
use isochore_sculpt::{
    BuildToolError, ReplayError, SceneError,
    files::LoadError,
    recipe::{self, Location},
};
use pyo3::{
    PyErr, Python, create_exception,
    exceptions::{PyException, PyValueError},
    types::PyAnyMethods,
};

create_exception!(
    isochore,
    Error,
    PyException,
    "Invalid input. The message names the offending element and the problem."
);
create_exception!(
    isochore,
    RecipeError,
    Error,
    "Invalid recipe. `key` is the dotted path of the offending key, `line` its line; None if unknown."
);
create_exception!(isochore, Cancelled, Error, "The `progress` callback returned False.");

/// Error that becomes a Python exception.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Existing Python exception.
    Raised(PyErr),
    /// A file cannot be read or written.
    File(io::ErrorKind, String),
    /// Argument of the wrong type, shape or range.
    Argument(String),
    /// Invalid input.
    Input(String),
    /// Invalid recipe.
    Recipe { message: String, key: Option<String>, line: Option<usize> },
    /// The caller cancelled the operation.
    Cancelled,
}

impl Failure {
    /// Invalid input.
    pub(crate) fn input(problem: impl Display) -> Self {
        Self::Input(problem.to_string())
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Raised(error) => error,
            Failure::File(kind, message) => io::Error::new(kind, message).into(),
            Failure::Argument(message) => PyValueError::new_err(message),
            Failure::Input(message) => Error::new_err(message),
            Failure::Recipe { message, key, line } => Python::attach(|py| {
                let error = RecipeError::new_err(message);
                let value = error.value(py);
                match value.setattr("key", key).and_then(|()| value.setattr("line", line)) {
                    Ok(()) => error,
                    Err(raised) => raised,
                }
            }),
            Failure::Cancelled => Cancelled::new_err("cancelled"),
        }
    }
}

impl From<PyErr> for Failure {
    fn from(error: PyErr) -> Self {
        Self::Raised(error)
    }
}

impl From<isochore_mesh::Cancelled> for Failure {
    fn from(_: isochore_mesh::Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        match &error {
            ReadError::Io { source, .. } => Self::File(source.kind(), error.to_string()),
            _ => Self::input(error),
        }
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        match &error {
            WriteError::Io { source, .. } => Self::File(source.kind(), error.to_string()),
            _ => Self::input(error),
        }
    }
}

impl From<MeshError> for Failure {
    fn from(error: MeshError) -> Self {
        Self::input(error)
    }
}

impl From<SelfIntersectionError> for Failure {
    fn from(error: SelfIntersectionError) -> Self {
        match error {
            SelfIntersectionError::Cancelled(_) => Self::Cancelled,
            error => Self::input(error),
        }
    }
}

impl From<DistanceFieldError> for Failure {
    fn from(error: DistanceFieldError) -> Self {
        match error {
            DistanceFieldError::Cancelled(_) => Self::Cancelled,
            error => Self::input(error),
        }
    }
}

impl<P: Display> From<recipe::RecipeError<P>> for Failure {
    fn from(error: recipe::RecipeError<P>) -> Self {
        let line = if let Location::Line(line) = error.location { Some(line) } else { None };
        Self::Recipe { message: error.to_string(), key: Some(error.key), line }
    }
}

impl From<ReplayError> for Failure {
    fn from(error: ReplayError) -> Self {
        match error {
            ReplayError::Cancelled(_) => Self::Cancelled,
            error => Self::Recipe { message: error.to_string(), key: error.key(), line: None },
        }
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        ReplayError::from(error).into()
    }
}

impl From<BuildToolError> for Failure {
    fn from(error: BuildToolError) -> Self {
        SceneError::from(error).into()
    }
}

impl From<LoadError> for Failure {
    fn from(error: LoadError) -> Self {
        match error.io_error() {
            Some(source) => Self::File(source.kind(), error.to_string()),
            None => Self::input(error),
        }
    }
}
