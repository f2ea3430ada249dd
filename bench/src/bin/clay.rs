//! Random strokes on many meshes: crossings, strokes that ended early, triangles, volume, angles and
//! seconds.
//!
//! `clay [COUNT] [MESH]…` runs COUNT numbers of each kind of stroke on each mesh, by default one number
//! on the meshes of the folder `data` and some generated ones. `clay recipe MESH KIND NUMBER` prints
//! the recipe of a work, and `clay pushes MESH COUNT NUMBER` one with many pushes.
//!
//! libigl counts the crossing triangles of each result with exact arithmetic; without it, isochore does.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "benchmarks print their results")]

use std::{env, error::Error, fs, path::PathBuf, time::Instant};

use isochore_bench::{
    ClayStroke, PythonPeer, ROWS_VARIABLE, TARGET, clay_recipe, load_mesh, many_pushes, print_row, scratch,
};
use isochore_mesh::{NoProgress, SelfIntersections, TriMesh, io, primitives};
use isochore_sculpt::{Measures, Meshes, Recipe, recipe::Format, replay};
use serde_json::json;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    if let [command, mesh, kind, number] = &arguments[..]
        && command == "recipe"
    {
        let kind = ClayStroke::ALL.into_iter().find(|other| format!("{other:?}") == *kind).ok_or("no such kind")?;
        print!("{}", clay_recipe(&io::read(mesh)?, kind, number.parse()?));
        return Ok(());
    }
    if let [command, mesh, count, number] = &arguments[..]
        && command == "pushes"
    {
        print!("{}", many_pushes(&io::read(mesh)?, count.parse()?, number.parse()?));
        return Ok(());
    }
    let count = arguments.first().map_or(Ok(1), |count| count.parse::<u64>())?;
    let meshes = if arguments.len() > 1 { files(&arguments[1..])? } else { own_meshes()? };
    print_row([
        "mesh",
        "stroke",
        "triangles",
        "after",
        "crossing",
        "stopped at",
        "bare volume",
        "locked",
        "below 5°",
        "s",
    ]);
    let mut judge = Judge::start();
    let mut totals: Vec<Total> = ClayStroke::ALL.into_iter().map(Total::new).collect();
    for (name, mesh) in &meshes {
        for total in &mut totals {
            for number in 0..count {
                total.add(&Work::run(name, mesh, total.kind, number, &mut judge)?);
            }
        }
    }
    let table = table(&totals, meshes.len(), &judge);
    println!("\n{table}");
    if let Some(rows) = env::var_os(ROWS_VARIABLE) {
        fs::write(PathBuf::from(rows).with_extension("md"), table)?;
    }
    Ok(())
}

/// The measures of all kinds in Markdown.
fn table(totals: &[Total], meshes: usize, judge: &Judge) -> String {
    let works: usize = totals.iter().map(|total| total.works).sum();
    let mut table = format!(
        "{works} random strokes on {meshes} meshes, with default options; crossing triangles are counted by {}.\n\n\
         | stroke | works | with new crossings | ended early | triangles, mean | bare volume, mean | at most | \
         locked, at most | angles below 5° | seconds |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
        judge.name(),
    );
    totals.iter().for_each(|total| table.push_str(&total.row()));
    table
}

/// Counts crossing triangles.
struct Judge(Option<PythonPeer>);

impl Judge {
    fn start() -> Self {
        let peer = PythonPeer::start("surface", &[]);
        Self(peer.map_err(|error| eprintln!("libigl is missing: {error}")).ok())
    }

    fn name(&self) -> &'static str {
        if self.0.is_some() { "libigl" } else { "isochore" }
    }

    /// Number of triangles of `mesh` that cross others; `ours` is the number that isochore found.
    fn count(&mut self, mesh: &TriMesh, ours: usize) -> usize {
        let Some(peer) = &mut self.0 else { return ours };
        let output = scratch().join("clay-intersections.raw");
        let asked = load_mesh(peer, mesh)
            .and_then(|()| peer.seconds(&json!({ "job": "libigl_intersections", "output": output })));
        match asked {
            Ok(_) => fs::read(&output).map_or(ours, |found| found.iter().filter(|&&crosses| crosses > 0).count()),
            Err(error) => {
                eprintln!("libigl stopped: {error}");
                self.0 = None;
                ours
            }
        }
    }
}

/// The meshes of the folder `data`, and some generated ones.
fn own_meshes() -> Result<Vec<(String, TriMesh)>, Box<dyn Error>> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../data");
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "obj") {
            paths.push(path.to_string_lossy().into_owned());
        }
    }
    paths.sort();
    let mut meshes = files(&paths)?;
    meshes.push(("icosphere".to_owned(), primitives::icosphere(1.0, 5)));
    meshes.push(("cube".to_owned(), primitives::box_mesh(glam::DVec3::ONE, [30, 30, 30])));
    meshes.push(("plate".to_owned(), primitives::box_mesh(glam::DVec3::new(1.0, 1.0, 0.03), [40, 40, 2])));
    Ok(meshes)
}

fn files(paths: &[String]) -> Result<Vec<(String, TriMesh)>, Box<dyn Error>> {
    let read = |path: &String| {
        let name = PathBuf::from(path).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok((name, io::read(path)?))
    };
    paths.iter().map(read).collect()
}

/// Measures of one work.
struct Work {
    before: usize,
    after: Measures,
    /// New crossings that the receipt reports.
    new_crossings: usize,
    /// Triangles that cross, less those of the mesh before.
    added: usize,
    stopped_at: Option<f64>,
    bare: f64,
    locked: f64,
    seconds: f64,
}

impl Work {
    fn run(
        name: &str,
        mesh: &TriMesh,
        kind: ClayStroke,
        number: u64,
        judge: &mut Judge,
    ) -> Result<Self, Box<dyn Error>> {
        let recipe = Recipe::parse(&clay_recipe(mesh, kind, number), Format::Toml, &[])?;
        let meshes = Meshes::from([(TARGET.to_owned(), mesh.clone().into())]);
        let begin = Instant::now();
        let deformed = replay(&recipe, &meshes, &NoProgress)?.deformed;
        let seconds = begin.elapsed().as_secs_f64();
        let after = Measures::of(&deformed.mesh, &NoProgress)?;
        let crossing_before = SelfIntersections::of(mesh, &NoProgress)?.triangles().len();
        let crossing_before = judge.count(mesh, crossing_before);
        let crossing = judge.count(&deformed.mesh, after.self_intersecting_triangles);
        let receipt = &deformed.receipt;
        let relative =
            |volume: Option<f64>| volume.zip(receipt.volume_before).map_or(0.0, |(after, before)| after / before - 1.0);
        let work = Self {
            before: mesh.triangles.len(),
            new_crossings: receipt.new_crossings,
            added: crossing.saturating_sub(crossing_before),
            stopped_at: receipt.strokes[0].stopped_at,
            bare: relative(receipt.volume_before_lock),
            locked: relative(receipt.volume_after),
            seconds,
            after,
        };
        print_row([
            name,
            &format!("{kind:?} {number}"),
            &work.before.to_string(),
            &work.after.triangles.to_string(),
            &format!("{} ({})", work.added, work.new_crossings),
            &work.stopped_at.map_or(String::new(), |at| format!("{at:.2}")),
            &format!("{:+.1e}", work.bare),
            &format!("{:+.1e}", work.locked),
            &format!("{:.3}", work.after.angle_below_5_degrees),
            &format!("{seconds:.2}"),
        ]);
        Ok(work)
    }
}

/// Measures of all works of one kind.
struct Total {
    kind: ClayStroke,
    works: usize,
    crossing: usize,
    stopped: usize,
    growth: f64,
    bare: f64,
    largest_bare: f64,
    largest_locked: f64,
    slivers: f64,
    seconds: f64,
}

impl Total {
    fn new(kind: ClayStroke) -> Self {
        let zero = 0.0;
        Self {
            kind,
            works: 0,
            crossing: 0,
            stopped: 0,
            growth: zero,
            bare: zero,
            largest_bare: zero,
            largest_locked: zero,
            slivers: zero,
            seconds: zero,
        }
    }

    fn add(&mut self, work: &Work) {
        self.works += 1;
        self.crossing += usize::from(work.added > 0 || work.new_crossings > 0);
        self.stopped += usize::from(work.stopped_at.is_some());
        self.growth += work.after.triangles as f64 / work.before as f64;
        self.bare += work.bare.abs();
        self.largest_bare = self.largest_bare.max(work.bare.abs());
        self.largest_locked = self.largest_locked.max(work.locked.abs());
        self.slivers += work.after.angle_below_5_degrees;
        self.seconds += work.seconds;
    }

    /// The row of the table.
    fn row(&self) -> String {
        let works = self.works as f64;
        format!(
            "| {} | {} | {} | {:.1} % | ×{:.2} | {:.1e} | {:.1e} | {:.1e} | {:.1} % | {:.0} |\n",
            self.kind.name(),
            self.works,
            self.crossing,
            100.0 * self.stopped as f64 / works,
            self.growth / works,
            self.bare / works,
            self.largest_bare,
            self.largest_locked,
            100.0 * self.slivers / works,
            self.seconds,
        )
    }
}
