//! `isochore run --stream`: deforms the points of a file that need not fit into memory.

use std::{
    fs::File,
    io::{self, BufWriter, Write},
    path::PathBuf,
    time::Instant,
};

use glam::DVec3;
use isochore_mesh::{
    Aabb, Monitor,
    io::{PointStream, PointStreamError},
};
use isochore_sculpt::{PointFlow, Recipe, Source, StreamReport};

use crate::{
    Outcome,
    command_error::CommandError,
    console::{Console, to_json},
    job::Job,
    staging::Staging,
};

/// Points that are in memory at once. Larger takes more memory; smaller hands each thread too little at a time.
const CHUNK: usize = 1 << 16;

pub(crate) fn stream(mut job: Job, console: &Console) -> Result<Outcome, CommandError> {
    let start = Instant::now();
    let input = input(&job)?;
    let mut staging = Staging::new(console.interrupt());
    let draft = job.outputs.mesh.as_ref().map(|path| staging.add_file(path)).transpose()?;
    let report_draft = job.outputs.report.as_ref().map(|path| staging.add_file(path)).transpose()?;

    let meshes = job.read_tools()?;
    let needs_bounds = PointFlow::needs_bounds(&job.recipe);
    let bounds = if needs_bounds { bounds(&input, &job.recipe, console)? } else { Aabb::EMPTY };
    let flow = PointFlow::new(&job.recipe, &meshes, bounds, console).map_err(|error| job.failed(error.into()))?;
    let source = Source { text: &job.text, overrides: &job.settings };
    let mut report = StreamReport::new(&job.recipe, source, flow.warnings.clone());
    report.seconds.prepare = start.elapsed().as_secs_f64();

    let name = |error| match (error, &job.outputs.mesh) {
        (PointStreamError::Write(error), Some(target)) => CommandError::cannot("write", target, &error),
        (error, _) => error.into(),
    };
    match draft {
        Some(draft) => {
            let file = File::create(draft).map_err(PointStreamError::Write).map_err(name)?;
            let mut writer = BufWriter::with_capacity(1 << 20, file);
            carry(&input, &job, &flow, &mut writer, &mut report, console, name)?;
            let synced = writer.into_inner().map_err(io::Error::from).and_then(|file| file.sync_all());
            synced.map_err(PointStreamError::Write).map_err(name)?;
        }
        None => carry(&input, &job, &flow, &mut io::sink(), &mut report, console, name)?,
    }
    if let Some(draft) = &report_draft {
        staging.write(draft, format!("{}\n", to_json(&report)).as_bytes())?;
    }
    staging.commit()?;
    conclude(&report, &job, console);
    Ok(Outcome::Done)
}

/// The file of points, if the recipe asks for nothing that they alone cannot give.
fn input(job: &Job) -> Result<PathBuf, CommandError> {
    let source = |source| CommandError::Recipe { path: job.path.clone(), source };
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

/// The box of all points of a file, placed in the world.
fn bounds(input: &PathBuf, recipe: &Recipe, console: &Console) -> Result<Aabb, CommandError> {
    let mut stream = PointStream::open(input)?;
    stream.copy_before(&mut io::sink())?;
    let (mut bounds, mut points, mut done) = (Aabb::EMPTY, Vec::new(), 0);
    while stream.read_chunk(CHUNK, &mut points)? {
        done += points.len();
        points = PointFlow::place(recipe, points);
        bounds = bounds.union(Aabb::of(points.iter().copied()));
        console.check("bounds", done as f64 / stream.count() as f64)?;
    }
    Ok(bounds)
}

/// Copies the file of points with these carried along the strokes.
fn carry(
    input: &PathBuf,
    job: &Job,
    flow: &PointFlow,
    writer: &mut dyn Write,
    report: &mut StreamReport,
    console: &Console,
    name: impl Fn(PointStreamError) -> CommandError,
) -> Result<(), CommandError> {
    let mut stream = PointStream::open(input).map_err(&name)?;
    stream.copy_before(writer).map_err(&name)?;
    let mut points: Vec<DVec3> = Vec::new();
    loop {
        let read_start = Instant::now();
        if !stream.read_chunk(CHUNK, &mut points).map_err(&name)? {
            break;
        }
        let advect_start = Instant::now();
        points = PointFlow::place(&job.recipe, points);
        let carried = flow.advect(&points, &OfOneChunk(console))?;
        report.add(&points, &carried);
        let write_start = Instant::now();
        stream.write_chunk(&carried, writer).map_err(&name)?;
        report.seconds.read += (advect_start - read_start).as_secs_f64();
        report.seconds.advect += (write_start - advect_start).as_secs_f64();
        report.seconds.write += write_start.elapsed().as_secs_f64();
        console.check("stream", report.points as f64 / stream.count() as f64)?;
    }
    stream.copy_after(writer).map_err(name)
}

/// Hears of an interrupt amid a chunk, but tells of no progress, which would begin anew with each chunk.
struct OfOneChunk<'a>(&'a Console);

impl Monitor for OfOneChunk<'_> {
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
    console.say(format_args!("{name}: {points} points, {moved_points} moved by up to {max_displacement:.3e}"));
}
