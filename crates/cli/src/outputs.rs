//! Outputs of a recipe and their temporary files.

use std::path::PathBuf;

use isochore_mesh::io::{Format, WriteError};

use crate::{command_error::CommandError, staging::Staging};

/// Paths of the results.
#[derive(Debug, Default)]
pub(crate) struct Outputs {
    pub(crate) mesh: Option<PathBuf>,
    pub(crate) report: Option<PathBuf>,
    pub(crate) preview: Option<PathBuf>,
    /// Number and folder of the images of an animation.
    pub(crate) frames: Option<(u32, PathBuf)>,
}

/// Paths to write the outputs to until all of them are complete.
#[derive(Debug)]
pub(crate) struct Drafts {
    pub(crate) mesh: Option<Draft>,
    pub(crate) preview: Option<PathBuf>,
    pub(crate) frames: Vec<PathBuf>,
    pub(crate) report: Option<PathBuf>,
}

/// Temporary file of a mesh and its format.
#[derive(Debug)]
pub(crate) struct Draft {
    pub(crate) path: PathBuf,
    pub(crate) format: Format,
}

impl Drafts {
    /// Adds all outputs to `staging`.
    ///
    /// # Errors
    /// An output has an unknown extension, or [`Staging`] refuses its path.
    pub(crate) fn new(outputs: &Outputs, staging: &mut Staging) -> Result<Self, CommandError> {
        let mut mesh = None;
        if let Some(path) = &outputs.mesh {
            let format = Format::of_path(path).ok_or_else(|| WriteError::UnknownFormat { path: path.clone() })?;
            mesh = Some(Draft { path: staging.add_file(path)?, format });
        }
        let is_png = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "png");
        if let Some(path) = outputs.preview.as_ref().filter(|path| !is_png(path)) {
            return Err(CommandError::file(path, "a preview must end in .png"));
        }
        let mut add = |path: &Option<PathBuf>| path.as_ref().map(|path| staging.add_file(path)).transpose();
        let [preview, report] = [add(&outputs.preview)?, add(&outputs.report)?];
        let frames = add_frames(outputs, staging)?;
        Ok(Self { mesh, preview, frames, report })
    }
}

fn add_frames(outputs: &Outputs, staging: &mut Staging) -> Result<Vec<PathBuf>, CommandError> {
    let Some((count, folder)) = &outputs.frames else { return Ok(Vec::new()) };
    let extension = outputs.mesh.as_ref().and_then(|path| path.extension()).ok_or_else(|| {
        CommandError::file(folder, "output.frames uses the format of output.mesh; set output.mesh too")
    })?;
    staging.add_folder(folder)?;
    (0..*count)
        .map(|index| staging.add_file(&folder.join(format!("frame_{index:04}")).with_extension(extension)))
        .collect()
}
