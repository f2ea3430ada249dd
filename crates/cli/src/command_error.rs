//! Errors of a command.

use std::{
    error::Error,
    io::{self, Write},
    path::{Path, PathBuf},
};

use clap::error::{ContextKind, ErrorKind};
use isochore_mesh::{
    Cancelled,
    io::{PointStreamError, ReadError, WriteError},
};
use isochore_sculpt::{
    ReplayError, StreamProblem,
    files::{CsvError, FileProblem, LoadError},
    recipe::{Location, RecipeError},
};

/// Error that ends a command.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CommandError {
    #[error("{0}")]
    Usage(String),
    #[error("{}: {source}", path.display())]
    Recipe { path: PathBuf, source: RecipeError },
    #[error("{}: {source}", path.display())]
    Replay { path: PathBuf, source: ReplayError },
    #[error("{}: {source}", path.display())]
    Stream { path: PathBuf, source: RecipeError<StreamProblem> },
    #[error(transparent)]
    Load(#[from] LoadError),
    #[error(transparent)]
    Table(#[from] CsvError),
    #[error(transparent)]
    ReadMesh(#[from] ReadError),
    #[error(transparent)]
    WriteMesh(#[from] WriteError),
    #[error(transparent)]
    Points(#[from] PointStreamError),
    #[error("{}: {problem}", path.display())]
    File { path: PathBuf, problem: String },
    #[error("interrupted; nothing was written")]
    Interrupted,
}

impl From<Cancelled> for CommandError {
    fn from(_: Cancelled) -> Self {
        Self::Interrupted
    }
}

impl CommandError {
    pub(crate) fn file(path: &Path, problem: impl ToString) -> Self {
        Self::File { path: path.to_owned(), problem: problem.to_string() }
    }

    pub(crate) fn cannot(verb: &str, path: &Path, source: &io::Error) -> Self {
        Self::file(path, format!("cannot {verb}: {source}"))
    }

    /// Turns an error of clap into one line, without its lines about usage.
    pub(crate) fn usage(error: &clap::Error) -> Self {
        if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
            return Self::Usage("no command given; see `isochore --help`, or start with `isochore demo`".to_owned());
        }
        if let Some(text) = invalid_value(error) {
            return Self::Usage(text);
        }
        let text = error.to_string();
        let paragraphs = text
            .split("\n\n")
            .take_while(|paragraph| !["Usage:", "For more information"].iter().any(|end| paragraph.starts_with(end)));
        let words: Vec<&str> = paragraphs.flat_map(str::split_whitespace).collect();
        let text = words.join(" ");
        let text = text.strip_prefix("error: ").unwrap_or(&text);
        Self::Usage(text.to_owned())
    }

    /// Prints the line `error: …`, or a JSON object, on stderr.
    pub(crate) fn print(&self, is_json: bool) {
        let line = if is_json {
            self.to_json().to_string()
        } else {
            let text = self.to_string().lines().map(str::trim).collect::<Vec<_>>().join(" ");
            format!("error: {text}")
        };
        // A closed stderr leaves nowhere to report the failure.
        let _ = writeln!(io::stderr(), "{line}");
    }

    pub(crate) fn exit_code(&self) -> u8 {
        if matches!(self, Self::Interrupted) { 130 } else { 2 }
    }

    /// The message and, if known, the file, the line and the recipe key.
    fn to_json(&self) -> serde_json::Value {
        let mut json = serde_json::json!({ "error": self.to_string() });
        let file = match self {
            Self::Recipe { path, .. }
            | Self::Replay { path, .. }
            | Self::Stream { path, .. }
            | Self::File { path, .. } => Some(path.as_path()),
            Self::Load(error) => Some(load_error_file(error)),
            Self::Table(error) => Some(error.path()),
            Self::ReadMesh(
                ReadError::UnknownFormat { path } | ReadError::Io { path, .. } | ReadError::Parse { path, .. },
            ) => Some(path.as_path()),
            Self::WriteMesh(
                WriteError::UnknownFormat { path }
                | WriteError::Io { path, .. }
                | WriteError::Invalid { path, .. }
                | WriteError::TooLarge { path, .. },
            ) => Some(path.as_path()),
            Self::Points(error) => error.path().map(PathBuf::as_path),
            Self::Usage(_) | Self::Interrupted => None,
        };
        if let Some(file) = file {
            json["file"] = file.to_string_lossy().into();
        }
        let key = match self {
            Self::Recipe { source, .. } => Some(source.key.clone()),
            Self::Replay { source, .. } => source.key(),
            Self::Stream { source, .. } => Some(source.key.clone()),
            Self::Load(error) => Some(error.key.clone()),
            _ => None,
        };
        if let Some(key) = key {
            json["key"] = key.into();
        }
        let location = match self {
            Self::Recipe { source, .. } => Some(&source.location),
            Self::Load(error) if is_missing(error) => Some(&error.location),
            _ => None,
        };
        if let Some(Location::Line(line)) = location {
            json["line"] = (*line).into();
        }
        json
    }
}

/// The recipe if the file that it names does not exist, so that the line is one of this file;
/// otherwise the file.
fn load_error_file(error: &LoadError) -> &Path {
    error.recipe.as_deref().filter(|_| is_missing(error)).unwrap_or_else(|| error.path())
}

fn is_missing(error: &LoadError) -> bool {
    matches!(*error.problem, FileProblem::Missing { .. })
}

/// The option, its value and the problem, if one of the parsers in
/// [`arguments`](crate::arguments) rejected the value.
fn invalid_value(error: &clap::Error) -> Option<String> {
    if error.kind() != ErrorKind::ValueValidation {
        return None;
    }
    // The argument is followed by the name of its value: `--threads <N>`.
    let argument = error.get(ContextKind::InvalidArg)?.to_string();
    let option = argument.split_whitespace().next()?;
    let value = error.get(ContextKind::InvalidValue)?;
    let problem = error.source()?;
    Some(format!("{}: {problem}", format!("{option} {value}").trim_end()))
}
