//! A recipe with its files: reads the inputs, deforms the target and writes all outputs.

use std::{
    fs,
    path::{Path, PathBuf},
    time::Instant,
};

use isochore_mesh::SelfIntersectionError;
use isochore_picture::Camera;
use isochore_sculpt::{
    Meshes, Recipe, Replay, ReplayError, Report, Source,
    files::{self, LoadError, NamedFile, TargetMesh},
    recipe::{Format, Override, RecipeError},
    replay,
};

use crate::{
    command_error::CommandError,
    console::Console,
    outputs::{Draft, Drafts, Outputs},
    preview,
    staging::Staging,
};

/// A recipe and the paths of its outputs.
#[derive(Debug)]
pub(crate) struct Job {
    /// Path of the recipe, which errors name.
    pub(crate) path: PathBuf,
    pub(crate) text: Vec<u8>,
    pub(crate) settings: Vec<String>,
    pub(crate) recipe: Recipe,
    pub(crate) outputs: Outputs,
}

impl Job {
    /// Reads the recipe at `path` and overrides keys by `settings`.
    pub(crate) fn read(path: &Path, settings: &[String]) -> Result<Self, CommandError> {
        let text = fs::read(path).map_err(|error| CommandError::cannot("read", path, &error))?;
        Self::parse(path, text, settings)
    }

    /// Parses a recipe that is already in memory and overrides keys by `settings`.
    pub(crate) fn parse(path: &Path, bytes: Vec<u8>, settings: &[String]) -> Result<Self, CommandError> {
        let invalid = |source| invalid_recipe(path, source);
        let overrides: Vec<Override> = settings
            .iter()
            .map(|text| Override::parse(text))
            .collect::<Result<_, _>>()
            .map_err(|error| invalid(RecipeError::from(error)))?;
        let text = std::str::from_utf8(&bytes).map_err(|error| {
            CommandError::file(path, format!("the recipe is not valid UTF-8 at byte {}", error.valid_up_to()))
        })?;
        let recipe = Recipe::parse(text, Format::of_path(path), &overrides).map_err(invalid)?;
        let resolve = |name: &Option<String>| name.as_ref().map(|name| files::beside(path, name));
        let outputs = Outputs {
            mesh: resolve(&recipe.output.mesh),
            report: resolve(&recipe.output.report),
            preview: resolve(&recipe.output.preview),
            frames: recipe.output.frames.as_ref().map(|frames| (frames.count, files::beside(path, &frames.directory))),
        };
        Ok(Self { path: path.to_owned(), text: bytes, settings: settings.to_vec(), recipe, outputs })
    }

    /// Reads the meshes of the recipe. Replaces the file names of spines and of the mask by the
    /// contents of the files.
    pub(crate) fn read_meshes(&mut self) -> Result<Meshes, CommandError> {
        self.load(TargetMesh::Required)
    }

    /// Reads spines and the meshes of tools, but not the target, which is streamed.
    pub(crate) fn read_tools(&mut self) -> Result<Meshes, CommandError> {
        self.load(TargetMesh::Skipped)
    }

    fn load(&mut self, target: TargetMesh) -> Result<Meshes, CommandError> {
        let resolve = |name: &str| Some(NamedFile::Path(files::beside(&self.path, name)));
        files::load(&mut self.recipe, target, &resolve).map_err(|error| self.load_error(error))
    }

    /// Text of the recipe, with the settings that override it.
    pub(crate) fn source(&self) -> Source<'_> {
        Source { text: &self.text, overrides: &self.settings }
    }

    /// Adds the recipe and the line of the key to an error of a file that the recipe names.
    pub(crate) fn load_error(&self, error: LoadError) -> CommandError {
        error.in_recipe(&self.path, self.source()).into()
    }

    /// Path of a file that the recipe calls `name`.
    pub(crate) fn beside(&self, name: &str) -> PathBuf {
        files::beside(&self.path, name)
    }

    /// Adds the path of the recipe to an error of its replay.
    pub(crate) fn replay_error(&self, source: ReplayError) -> CommandError {
        match source {
            ReplayError::Cancelled(_) => CommandError::Interrupted,
            source => CommandError::Replay { path: self.path.clone(), source },
        }
    }

    /// Deforms the target and writes all outputs, together with the files that `staging` already
    /// holds.
    pub(crate) fn execute(
        &self,
        meshes: Meshes,
        read_seconds: f64,
        mut staging: Staging,
        console: &Console,
    ) -> Result<Report, CommandError> {
        // Drafts come first, so that a missing folder is reported before the long computation.
        let drafts = Drafts::new(&self.outputs, &mut staging)?;
        let replay = replay(&self.recipe, &meshes, console).map_err(|error| self.replay_error(error))?;
        // The scene owns a copy of the target. Dropping the input saves memory while the meshes are
        // measured.
        drop(meshes);

        let start = Instant::now();
        let mut written = None;
        if let Some(Draft { path, format }) = &drafts.mesh {
            staging.write_mesh(path, &replay.deformed.mesh)?;
            written = format.is_single_precision().then(|| format.stored(&replay.deformed.mesh));
        }
        if let Some(draft) = &drafts.preview {
            self.write_preview(draft, &replay, &staging)?;
        }
        self.write_frames(&drafts.frames, &replay, &staging, console)?;
        let write_seconds = start.elapsed().as_secs_f64();

        // The report describes the mesh as stored, which a format of single precision rounds.
        let measured = written.as_ref().unwrap_or(&replay.deformed.mesh);
        let mut report =
            Report::new(&self.recipe, self.source(), &replay, measured, console).map_err(|error| match error {
                SelfIntersectionError::Cancelled(cancelled) => cancelled.into(),
                error => CommandError::file(&self.path, error),
            })?;
        report.seconds.read = read_seconds;
        report.seconds.write = write_seconds;
        if let Some(draft) = &drafts.report {
            staging.write(draft, format!("{}\n", crate::console::to_json(&report)).as_bytes())?;
        }
        staging.commit()?;
        Ok(report)
    }

    fn write_preview(&self, draft: &Path, replay: &Replay, staging: &Staging) -> Result<(), CommandError> {
        let camera = self.recipe.output.view.map_or_else(Camera::default, |view| Camera::from_direction(view.into()));
        let picture = preview::before_and_after(&replay.scene.target, &replay.deformed.mesh, &camera)
            .map_err(|error| CommandError::file(staging.target_of(draft), error))?;
        staging.write(draft, &picture)
    }

    fn write_frames(
        &self,
        drafts: &[PathBuf],
        replay: &Replay,
        staging: &Staging,
        console: &Console,
    ) -> Result<(), CommandError> {
        let count = drafts.len() as u32;
        for (index, draft) in (0..).zip(drafts) {
            let mesh = replay.frame(index, count, console).map_err(|error| self.replay_error(error))?;
            staging.write_mesh(draft, &mesh)?;
        }
        Ok(())
    }
}

fn invalid_recipe(path: &Path, source: RecipeError) -> CommandError {
    CommandError::Recipe { path: path.to_owned(), source }
}
