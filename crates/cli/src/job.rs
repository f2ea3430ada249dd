//! A recipe with its files: read, carried out, and its outputs put in place.

use std::{
    fs,
    path::{Path, PathBuf},
    time::Instant,
};

use isochore_mesh::{
    SelfIntersectionError, TriMesh,
    io::{self, Format as MeshFormat, WriteError},
};
use isochore_picture::Camera;
use isochore_sculpt::{
    Meshes, Recipe, Replay, ReplayError, Report, Source,
    recipe::{Format, Override, VertexWeights},
    replay,
};

use crate::{command_error::CommandError, console::Console, csv_table::CsvTable, preview, staging::Staging};

/// A recipe and the places of its outputs.
#[derive(Debug)]
pub(crate) struct Job {
    /// The recipe's file, by which errors name it.
    pub(crate) path: PathBuf,
    pub(crate) text: Vec<u8>,
    pub(crate) settings: Vec<String>,
    pub(crate) recipe: Recipe,
    pub(crate) outputs: Outputs,
}

/// Where the results go.
#[derive(Debug, Default)]
pub(crate) struct Outputs {
    pub(crate) mesh: Option<PathBuf>,
    pub(crate) report: Option<PathBuf>,
    pub(crate) preview: Option<PathBuf>,
    pub(crate) frames: Option<(u32, PathBuf)>,
}

impl Job {
    /// Reads the recipe at `path` and lets `settings` win over it.
    pub(crate) fn read(path: &Path, settings: &[String]) -> Result<Self, CommandError> {
        let text = fs::read(path).map_err(|error| CommandError::cannot("read", path, &error))?;
        Self::parse(path, text, settings)
    }

    /// The same with the recipe's text at hand.
    pub(crate) fn parse(path: &Path, bytes: Vec<u8>, settings: &[String]) -> Result<Self, CommandError> {
        let wrong = |source| CommandError::Recipe { path: path.to_owned(), source };
        let overrides: Vec<Override> =
            settings.iter().map(|text| Override::parse(text)).collect::<Result<_, _>>().map_err(wrong)?;
        let text = std::str::from_utf8(&bytes)
            .map_err(|error| CommandError::file(path, format!("is not text in UTF-8: byte {}", error.valid_up_to())))?;
        let is_json = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
        let format = if is_json { Format::Json } else { Format::Toml };
        let recipe = Recipe::parse(text, format, &overrides).map_err(wrong)?;
        let place = |name: &Option<String>| name.as_ref().map(|name| beside(path, name));
        let outputs = Outputs {
            mesh: place(&recipe.output.mesh),
            report: place(&recipe.output.report),
            preview: place(&recipe.output.preview),
            frames: recipe.output.frames.as_ref().map(|frames| (frames.count, beside(path, &frames.directory))),
        };
        Ok(Self { path: path.to_owned(), text: bytes, settings: settings.to_vec(), recipe, outputs })
    }

    /// Reads the meshes that the recipe names, and puts the points of its spines and the weights of its mask in the place of
    /// their files' names.
    pub(crate) fn read_meshes(&mut self) -> Result<Meshes, CommandError> {
        self.read_curves()?;
        let names = self.recipe.mesh_names().into_iter();
        let meshes: Meshes = names
            .map(|name| Ok((name.to_owned(), io::read(self.beside(name))?.into())))
            .collect::<Result<_, CommandError>>()?;
        if let Some(VertexWeights::File(name)) = &self.recipe.mask.vertices {
            let target = self.recipe.target.mesh.as_ref().and_then(|name| meshes.get(name));
            let weights = read_weights(&self.beside(name), target.map(|mesh| mesh.positions.len()))?;
            self.recipe.mask.vertices = Some(VertexWeights::Values(weights));
        }
        Ok(meshes)
    }

    /// Reads the meshes of tools alone, and the points of spines, for a target that is not read whole.
    pub(crate) fn read_tools(&mut self) -> Result<Meshes, CommandError> {
        self.read_curves()?;
        let target = self.recipe.target.mesh.take();
        let meshes =
            self.recipe.mesh_names().into_iter().map(|name| Ok((name.to_owned(), io::read(self.beside(name))?.into())));
        let meshes = meshes.collect();
        self.recipe.target.mesh = target;
        meshes
    }

    /// The file that the recipe calls `name`.
    pub(crate) fn beside(&self, name: &str) -> PathBuf {
        beside(&self.path, name)
    }

    /// The error of a recipe that could not be followed.
    pub(crate) fn failed(&self, source: ReplayError) -> CommandError {
        match source {
            ReplayError::Cancelled(_) => CommandError::Interrupted,
            source => CommandError::Replay { path: self.path.clone(), source },
        }
    }

    fn read_curves(&mut self) -> Result<(), CommandError> {
        let names: Vec<String> = self.recipe.curve_names().into_iter().map(str::to_owned).collect();
        for name in names {
            // Files of spines may have tangents, which a spline makes itself.
            let table = CsvTable::read(&self.beside(&name), &[3, 6])?;
            let points: Vec<[f64; 3]> = table.rows.iter().map(|row| [row[0], row[1], row[2]]).collect();
            self.recipe.inline_curve(&name, &points);
        }
        Ok(())
    }

    /// Deforms the target and puts all outputs in place, together with what `staging` already holds.
    pub(crate) fn carry_out(
        &self,
        meshes: Meshes,
        read_seconds: f64,
        mut staging: Staging,
        console: &Console,
    ) -> Result<Report, CommandError> {
        let failed = |source| self.failed(source);
        // All places are taken first: whoever lacks a folder should not learn it after the work.
        let drafts = Drafts::new(&self.outputs, &mut staging)?;
        let replay = replay(&self.recipe, &meshes, console).map_err(failed)?;
        // The scene has its own target; a second one would take memory while the meshes are measured.
        drop(meshes);

        let start = Instant::now();
        let mut written = None;
        if let Some(Draft { path, format }) = &drafts.mesh {
            write_mesh(&staging, path, &replay.deformed.mesh)?;
            written = format.is_single_precision().then(|| format.stored(&replay.deformed.mesh));
        }
        if let Some(draft) = &drafts.preview {
            let camera =
                self.recipe.output.view.map_or_else(Camera::default, |view| Camera::from_direction(view.into()));
            let picture = preview::before_and_after(&replay.scene.target, &replay.deformed.mesh, &camera)
                .map_err(|error| CommandError::file(staging.target_of(draft), error))?;
            staging.write(draft, &picture)?;
        }
        self.write_frames(&drafts.frames, &replay, &staging, console).map_err(|error| match error {
            FrameError::Replay(error) => failed(error),
            FrameError::Write(error) => error,
        })?;
        let write_seconds = start.elapsed().as_secs_f64();

        let source = Source { text: &self.text, overrides: &self.settings };
        let measured = written.as_ref().unwrap_or(&replay.deformed.mesh);
        let mut report =
            Report::new(&self.recipe, source, &replay, measured, console).map_err(|error| match error {
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

    fn write_frames(
        &self,
        drafts: &[PathBuf],
        replay: &Replay,
        staging: &Staging,
        console: &Console,
    ) -> Result<(), FrameError> {
        let count = drafts.len() as u32;
        for (index, draft) in (0..).zip(drafts) {
            let mesh = replay.frame(index, count, console).map_err(FrameError::Replay)?;
            write_mesh(staging, draft, &mesh).map_err(FrameError::Write)?;
        }
        Ok(())
    }
}

enum FrameError {
    Replay(ReplayError),
    Write(CommandError),
}

/// The places to write the outputs at, until all are put where they belong.
#[derive(Debug)]
struct Drafts {
    mesh: Option<Draft>,
    preview: Option<PathBuf>,
    frames: Vec<PathBuf>,
    report: Option<PathBuf>,
}

#[derive(Debug)]
struct Draft {
    path: PathBuf,
    format: MeshFormat,
}

impl Drafts {
    fn new(outputs: &Outputs, staging: &mut Staging) -> Result<Self, CommandError> {
        let mut mesh = None;
        if let Some(path) = &outputs.mesh {
            let format = MeshFormat::of_path(path).ok_or_else(|| WriteError::UnknownFormat { path: path.clone() })?;
            mesh = Some(Draft { path: staging.add_file(path)?, format });
        }
        if let Some(path) =
            outputs.preview.as_ref().filter(|path| path.extension().is_none_or(|ending| ending != "png"))
        {
            return Err(CommandError::file(path, "a preview must end in .png"));
        }
        let mut optional = |path: &Option<PathBuf>| path.as_ref().map(|path| staging.add_file(path)).transpose();
        let [preview, report] = [optional(&outputs.preview)?, optional(&outputs.report)?];
        let mut frames = Vec::new();
        if let Some((count, folder)) = &outputs.frames {
            let extension = outputs.mesh.as_ref().and_then(|path| path.extension()).ok_or_else(|| {
                CommandError::file(folder, "frames have the format of the output mesh; set output.mesh too")
            })?;
            staging.add_folder(folder)?;
            for index in 0..*count {
                let name = folder.join(format!("frame_{index:04}")).with_extension(extension);
                frames.push(staging.add_file(&name)?);
            }
        }
        Ok(Self { mesh, preview, frames, report })
    }
}

/// Writes a mesh where `draft` was promised; errors name the target.
pub(crate) fn write_mesh(staging: &Staging, draft: &Path, mesh: &TriMesh) -> Result<(), CommandError> {
    io::write(draft, mesh).map_err(|error| {
        let target = staging.target_of(draft).to_owned();
        match error {
            WriteError::Io { source, .. } => WriteError::Io { path: target, source },
            WriteError::Invalid { source, .. } => WriteError::Invalid { path: target, source },
            WriteError::TooLarge { vertex, .. } => WriteError::TooLarge { path: target, vertex },
            error @ WriteError::UnknownFormat { .. } => error,
        }
        .into()
    })
}

/// The weights of a mask, one a row, for a target of this many vertices where it is known yet.
fn read_weights(path: &Path, vertices: Option<usize>) -> Result<Vec<f64>, CommandError> {
    let table = CsvTable::read(path, &[1])?;
    let weights: Vec<f64> = table.rows.iter().map(|row| row[0]).collect();
    if let Some(vertices) = vertices.filter(|&vertices| vertices != weights.len()) {
        let end = if weights.len() > vertices { "comes after the last vertex" } else { "is the last" };
        let problem = format!("this weight {end}: {} weights for the {vertices} vertices of the target", weights.len());
        return Err(table.error(weights.len().min(vertices), problem));
    }
    match weights.iter().position(|weight| !(0.0..=1.0).contains(weight)) {
        Some(row) => Err(table.error(row, format_args!("{} is not a weight from 0, free, to 1, held", weights[row]))),
        None => Ok(weights),
    }
}

/// The file that a recipe at `recipe` calls `name`.
fn beside(recipe: &Path, name: &str) -> PathBuf {
    recipe.parent().unwrap_or(Path::new("")).join(name)
}
