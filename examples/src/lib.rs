//! Helpers of the example programs: input, swept bodies, a color scale and output of figures.

#![expect(clippy::print_stdout, reason = "examples print the paths of their files")]

use std::{
    error::Error,
    fs,
    path::{Path, PathBuf},
};

use glam::{DVec2, DVec3};
use isochore_curve::{Frame, rotate_minimally, sweep, sweep_varying};
use isochore_mesh::{GridMesh, NoProgress, TriMesh, io};
use isochore_picture::{Camera, Options, Panel, render};
use isochore_sculpt::{Meshes, Recipe, Scene, recipe::Format};

/// Points and frames along a spine.
pub type Stations = Vec<(DVec3, Frame)>;

/// Writes `NAME.glb` and `NAME.png` into the [`folder`].
///
/// # Errors
/// The picture cannot be drawn, or a file cannot be written.
pub fn save_figure(
    name: &str,
    mesh: &TriMesh,
    panels: &[Panel],
    camera: &Camera,
    options: &Options,
) -> Result<(), Box<dyn Error>> {
    let mesh_path = folder()?.join(name).with_extension("glb");
    io::write(&mesh_path, mesh)?;
    println!("{}", mesh_path.display());
    save_picture(name, panels, camera, options)
}

/// Writes `NAME.obj` into the [`folder`].
///
/// # Errors
/// The file cannot be written.
pub fn save_mesh(name: &str, mesh: &TriMesh) -> Result<(), Box<dyn Error>> {
    let path = folder()?.join(name).with_extension("obj");
    io::write(&path, mesh)?;
    println!("{}", path.display());
    Ok(())
}

/// Writes `NAME.png` into the [`folder`].
///
/// # Errors
/// The picture cannot be drawn, or the file cannot be written.
pub fn save_picture(name: &str, panels: &[Panel], camera: &Camera, options: &Options) -> Result<(), Box<dyn Error>> {
    let path = folder()?.join(name).with_extension("png");
    fs::write(&path, render(panels, camera, options)?.to_png())?;
    println!("{}", path.display());
    Ok(())
}

/// The output folder: the first argument of the program, or `gallery`. Creates it if it is missing.
///
/// # Errors
/// The folder cannot be created.
pub fn folder() -> Result<PathBuf, Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args_os().nth(1).unwrap_or_else(|| "gallery".into()));
    fs::create_dir_all(&folder)?;
    Ok(folder)
}

/// Reads the mesh `NAME.obj` of the folder `data`.
///
/// # Errors
/// The file cannot be read.
pub fn data_mesh(name: &str) -> Result<TriMesh, Box<dyn Error>> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    Ok(io::read(data.join(name).with_extension("obj"))?)
}

/// Builds the scene of the recipe `NAME.toml` of the folder `data/recipes`.
///
/// # Errors
/// A file cannot be read, or the recipe is invalid.
pub fn scene(name: &str) -> Result<Scene, Box<dyn Error>> {
    let recipes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/recipes");
    let recipe = Recipe::parse(&fs::read_to_string(recipes.join(name).with_extension("toml"))?, Format::Toml, &[])?;
    let mut meshes = Meshes::new();
    for name in recipe.mesh_names() {
        meshes.insert(name.to_owned(), io::read(recipes.join(name))?.into());
    }
    Ok(Scene::build(&recipe, &meshes, &NoProgress)?)
}

/// Sweeps a closed, counter-clockwise `outline` along `stations`. The ends are capped, or connected
/// if `closes`; then the last station repeats the first.
pub fn swept_body(stations: &[(DVec3, Frame)], outline: &[DVec2], closes: bool) -> TriMesh {
    let rows = if closes { &stations[..stations.len() - 1] } else { stations };
    let grid = sweep(rows, outline);
    let mesh = GridMesh { points: &grid.points, columns: grid.columns, rows_close: closes, columns_close: true };
    if closes { mesh.mesh() } else { mesh.capped_mesh(outline) }
}

/// Sweeps an outline of `columns` points that depends on the station and caps the ends. The
/// callback receives the row and the column; both caps use the triangulation of the first row.
pub fn varying_body(stations: &[(DVec3, Frame)], columns: usize, outline: impl Fn(usize, usize) -> DVec2) -> TriMesh {
    let grid = sweep_varying(stations, columns, &outline);
    let first: Vec<DVec2> = (0..columns).map(|column| outline(0, column)).collect();
    GridMesh { points: &grid.points, columns, rows_close: false, columns_close: true }.capped_mesh(&first)
}

/// A flat rectangular outline that makes the rotation of a frame visible: `width` along r, `height`
/// along s.
pub fn strap(width: f64, height: f64) -> [DVec2; 4] {
    [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| DVec2::new(0.5 * width * x, 0.5 * height * y))
}

/// A regular polygon, counter-clockwise.
pub fn round(radius: f64, corners: usize) -> Vec<DVec2> {
    (0..corners)
        .map(|i| libm::sincos(std::f64::consts::TAU * i as f64 / corners as f64))
        .map(|(sin, cos)| DVec2::new(cos, sin) * radius)
        .collect()
}

/// Total absolute rotation of `frames` about their tangents, relative to the minimal rotation
/// between neighboring stations, radians.
pub fn total_turning(frames: &[Frame]) -> f64 {
    frames
        .windows(2)
        .map(|pair| {
            let transported = rotate_minimally(pair[0].t, pair[1].t, pair[0].r).unwrap_or(pair[0].r);
            pair[1].angle_to(transported).abs()
        })
        .sum()
}

/// Net flux of a field through a sphere as a fraction of the absolute flux, by the midpoint rule in
/// height and longitude. Zero for a divergence-free field, except for the error of the rule.
pub fn relative_flux(velocity: impl Fn(DVec3) -> DVec3, center: DVec3, radius: f64) -> f64 {
    const CELLS: u32 = 256;
    let midpoint = |cell: u32| (f64::from(cell) + 0.5) / f64::from(CELLS);
    let flux = |index: u32| {
        // Equal cells in height and longitude have equal areas on the sphere.
        let z = 2.0 * midpoint(index / CELLS) - 1.0;
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * midpoint(index % CELLS));
        let normal = (1.0 - z * z).sqrt() * DVec3::new(cos, sin, 0.0) + z * DVec3::Z;
        velocity(center + radius * normal).dot(normal)
    };
    let (net, absolute) =
        (0..CELLS * CELLS).map(flux).fold((0.0, 0.0), |(net, absolute), flux| (net + flux, absolute + flux.abs()));
    net.abs() / absolute
}

/// Formats a small number with one digit, or as 0.
pub fn small(number: f64) -> String {
    if number == 0.0 { "0".to_owned() } else { format!("{number:.0e}") }
}

/// Appends a mesh to another.
pub fn joined(mut mesh: TriMesh, other: &TriMesh) -> TriMesh {
    let offset = mesh.positions.len() as u32;
    mesh.positions.extend(&other.positions);
    mesh.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + offset)));
    mesh
}

/// Linear RGB from dark blue through green to yellow, for a fraction between 0 and 1.
pub fn scale_color(fraction: f64) -> DVec3 {
    const STOPS: [DVec3; 5] = [
        DVec3::new(0.06, 0.0, 0.09),
        DVec3::new(0.04, 0.08, 0.26),
        DVec3::new(0.015, 0.28, 0.26),
        DVec3::new(0.12, 0.60, 0.10),
        DVec3::new(0.98, 0.80, 0.02),
    ];
    let position = fraction.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let below = (position as usize).min(STOPS.len() - 2);
    STOPS[below].lerp(STOPS[below + 1], position - below as f64)
}
