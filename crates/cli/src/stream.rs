//! `isochore run --stream`: deforms the points of a file that need not fit into memory.

use std::{
    fs::File,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    time::Instant,
};

use isochore_mesh::{
    Aabb, Monitor,
    io::{PointStream, PointStreamError, ReadError},
};
use isochore_sculpt::{PointFlow, StreamReport, files::LoadError};

use crate::{
    command_error::CommandError,
    console::{Console, to_json},
    job::Job,
    outcome::Outcome,
    staging::Staging,
};

/// Number of points in memory. Larger needs more memory; smaller leaves each thread too little
/// work.
const CHUNK: usize = 1 << 16;

pub(crate) fn stream(mut job: Job, console: &Console) -> Result<Outcome, CommandError> {
    let start = Instant::now();
    let input = input(&job)?;
    let mut staging = Staging::new(console.interrupt());
    let draft = job.outputs.mesh.as_ref().map(|path| staging.add_file(path)).transpose()?;
    let report_draft = job.outputs.report.as_ref().map(|path| staging.add_file(path)).transpose()?;

    let meshes = job.read_tools()?;
    let needs_bounds = PointFlow::needs_bounds(&job.recipe);
    let bounds = if needs_bounds { bounds(&input, &job, console)? } else { Aabb::EMPTY };
    let flow = PointFlow::new(&job.recipe, &meshes, bounds, console).map_err(|error| job.replay_error(error.into()))?;
    let mut report = StreamReport::new(&job.recipe, job.source(), flow.warnings.clone());
    report.seconds.prepare = start.elapsed().as_secs_f64();

    let pass = Pass { input: &input, job: &job, flow: &flow, console };
    match draft {
        Some(draft) => pass.write_file(&draft, &mut report)?,
        None => pass.copy(&mut io::sink(), &mut report)?,
    }
    if let Some(draft) = &report_draft {
        staging.write(draft, format!("{}\n", to_json(&report)).as_bytes())?;
    }
    staging.commit()?;
    conclude(&report, &job, console);
    Ok(Outcome::Done)
}

/// Path of the points to stream.
///
/// # Errors
/// The recipe needs a whole mesh, or the extension of the output differs from that of the input.
fn input(job: &Job) -> Result<PathBuf, CommandError> {
    let source = |source| CommandError::Stream { path: job.path.clone(), source };
    let input = job.beside(PointFlow::streamed_file(&job.recipe).map_err(source)?);
    let extension = |path: &PathBuf| path.extension().map(|extension| extension.to_ascii_lowercase());
    match &job.outputs.mesh {
        Some(output) if extension(output) != extension(&input) => Err(CommandError::file(
            output,
            "a stream keeps the format of its input; give the output the same extension",
        )),
        _ => Ok(input),
    }
}

/// Opens the points to stream.
fn open(input: &Path, job: &Job) -> Result<PointStream, CommandError> {
    PointStream::open(input).map_err(|error| match error {
        PointStreamError::Read { path, source } => {
            let name = job.recipe.target.mesh.as_deref().unwrap_or_default();
            job.load_error(LoadError::new("target.mesh", name, ReadError::Io { path, source }.into()))
        }
        error => error.into(),
    })
}

/// Bounding box of all points of a file in world space.
fn bounds(input: &Path, job: &Job, console: &Console) -> Result<Aabb, CommandError> {
    let mut stream = open(input, job)?;
    stream.copy_before(&mut io::sink())?;
    let (mut bounds, mut points, mut done) = (Aabb::EMPTY, Vec::new(), 0);
    while stream.read_chunk(CHUNK, &mut points)? {
        done += points.len();
        points = PointFlow::place(&job.recipe, points);
        bounds = bounds.union(Aabb::of(points.iter().copied()));
        console.check("bounds", done as f64 / stream.count() as f64)?;
    }
    Ok(bounds)
}

/// One pass over the file of points.
struct Pass<'a> {
    input: &'a Path,
    job: &'a Job,
    flow: &'a PointFlow,
    console: &'a Console,
}

impl Pass<'_> {
    fn write_file(&self, draft: &Path, report: &mut StreamReport) -> Result<(), CommandError> {
        let write_error = |error| self.error(PointStreamError::Write(error));
        let file = File::create(draft).map_err(write_error)?;
        let mut writer = BufWriter::with_capacity(1 << 20, file);
        self.copy(&mut writer, report)?;
        let synced = writer.into_inner().map_err(io::Error::from).and_then(|file| file.sync_all());
        synced.map_err(write_error)
    }

    /// Copies the file chunk by chunk and advects its points.
    fn copy(&self, writer: &mut dyn Write, report: &mut StreamReport) -> Result<(), CommandError> {
        let error = |error| self.error(error);
        let mut stream = open(self.input, self.job)?;
        stream.copy_before(writer).map_err(error)?;
        let mut points = Vec::new();
        loop {
            let read_start = Instant::now();
            if !stream.read_chunk(CHUNK, &mut points).map_err(error)? {
                break;
            }
            let advect_start = Instant::now();
            points = PointFlow::place(&self.job.recipe, points);
            let advected = self.flow.advect(&points, &ChunkMonitor(self.console))?;
            report.add(&points, &advected);
            let write_start = Instant::now();
            stream.write_chunk(&advected, writer).map_err(error)?;
            report.seconds.read += (advect_start - read_start).as_secs_f64();
            report.seconds.advect += (write_start - advect_start).as_secs_f64();
            report.seconds.write += write_start.elapsed().as_secs_f64();
            self.console.check("stream", report.points as f64 / stream.count() as f64)?;
        }
        stream.copy_after(writer).map_err(error)
    }

    /// Adds the path of the output to an error of writing, which happens in a temporary file.
    fn error(&self, error: PointStreamError) -> CommandError {
        match (error, &self.job.outputs.mesh) {
            (PointStreamError::Write(error), Some(target)) => CommandError::cannot("write", target, &error),
            (error, _) => error.into(),
        }
    }
}

/// Forwards interrupts during a chunk. Ignores its progress, which would restart at zero with every
/// chunk.
struct ChunkMonitor<'a>(&'a Console);

impl Monitor for ChunkMonitor<'_> {
    fn is_cancelled(&self) -> bool {
        self.0.is_cancelled()
    }
}

fn conclude(report: &StreamReport, job: &Job, console: &Console) {
    console.finish();
    for warning in &report.warnings {
        console.warn("warning", warning);
    }
    if console.is_json() {
        return console.print_json(report);
    }
    let name = job.outputs.mesh.as_ref().map_or("result".to_owned(), |path| path.display().to_string());
    let StreamReport { points, moved_points, max_displacement, .. } = report;
    console.say(format_args!("{name}: {points} points, {moved_points} moved, by at most {max_displacement:.3e}"));
}
