//! What the example programs share: scenes of recipes, swept bodies, a color scale, and files for a figure.

#![expect(clippy::print_stdout, reason = "examples tell where their files are")]

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

/// Points of a spine with their frames.
pub type Stations = Vec<(DVec3, Frame)>;

/// Writes `NAME.glb` and `NAME.png` into the folder that is the program's argument, `gallery` without one.
///
/// # Errors
/// Where the picture cannot be drawn or a file cannot be written.
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

/// Writes `NAME.png` into the same folder.
///
/// # Errors
/// Where the picture cannot be drawn or the file cannot be written.
pub fn save_picture(name: &str, panels: &[Panel], camera: &Camera, options: &Options) -> Result<(), Box<dyn Error>> {
    let path = folder()?.join(name).with_extension("png");
    fs::write(&path, render(panels, camera, options)?.to_png())?;
    println!("{}", path.display());
    Ok(())
}

/// The folder for figures, which is the program's argument, made where it does not exist.
///
/// # Errors
/// Where it cannot be made.
pub fn folder() -> Result<PathBuf, Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args_os().nth(1).unwrap_or_else(|| "gallery".into()));
    fs::create_dir_all(&folder)?;
    Ok(folder)
}

/// What the recipe `NAME.toml` of the folder `data/recipes` describes.
///
/// # Errors
/// Where a file cannot be read or the recipe cannot be followed.
pub fn scene(name: &str) -> Result<Scene, Box<dyn Error>> {
    let recipes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/recipes");
    let recipe = Recipe::parse(&fs::read_to_string(recipes.join(name).with_extension("toml"))?, Format::Toml, &[])?;
    let mut meshes = Meshes::new();
    for name in recipe.mesh_names() {
        meshes.insert(name.to_owned(), io::read(recipes.join(name))?.into());
    }
    Ok(Scene::build(&recipe, &meshes, &NoProgress)?)
}

/// The body that a closed `profile`, counter-clockwise, sweeps along `stations`: capped, or closed where `closes` says
/// that the last station is the first.
pub fn swept_body(stations: &[(DVec3, Frame)], profile: &[DVec2], closes: bool) -> TriMesh {
    let rows = if closes { &stations[..stations.len() - 1] } else { stations };
    let grid = sweep(rows, profile);
    let mesh = GridMesh { points: &grid.points, columns: grid.columns, rows_close: closes, columns_close: true };
    if closes { mesh.mesh() } else { mesh.capped_mesh(profile) }
}

/// The same with a profile of `columns` points that changes from station to station; the ends are closed by the outline
/// of the first.
pub fn varying_body(stations: &[(DVec3, Frame)], columns: usize, profile: impl Fn(usize, usize) -> DVec2) -> TriMesh {
    let grid = sweep_varying(stations, columns, &profile);
    let outline: Vec<DVec2> = (0..columns).map(|column| profile(0, column)).collect();
    GridMesh { points: &grid.points, columns, rows_close: false, columns_close: true }.capped_mesh(&outline)
}

/// A flat rectangular profile that shows how a frame turns: `width` along r, `height` along s.
pub fn strap(width: f64, height: f64) -> [DVec2; 4] {
    [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| DVec2::new(0.5 * width * x, 0.5 * height * y))
}

/// A regular polygon of `corners` corners, counter-clockwise.
pub fn round(radius: f64, corners: usize) -> Vec<DVec2> {
    (0..corners)
        .map(|i| libm::sincos(std::f64::consts::TAU * i as f64 / corners as f64))
        .map(|(sin, cos)| DVec2::new(cos, sin) * radius)
        .collect()
}

/// How far `frames` turn about their tangents from station to station, against the smallest rotation between those;
/// back and forth all counted, radians.
pub fn total_turning(frames: &[Frame]) -> f64 {
    frames
        .windows(2)
        .map(|pair| {
            let carried = rotate_minimally(pair[0].t, pair[1].t, pair[0].r).unwrap_or(pair[0].r);
            pair[1].angle_to(carried).abs()
        })
        .sum()
}

/// A small number in one digit, or plainly 0.
pub fn small(number: f64) -> String {
    if number == 0.0 { "0".to_owned() } else { format!("{number:.0e}") }
}

/// Two meshes as one.
pub fn joined(mut mesh: TriMesh, other: &TriMesh) -> TriMesh {
    let offset = mesh.positions.len() as u32;
    mesh.positions.extend(&other.positions);
    mesh.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + offset)));
    mesh
}

/// Linear RGB from dark blue through green to yellow for a share from 0 to 1.
pub fn scale_color(share: f64) -> DVec3 {
    const STOPS: [DVec3; 5] = [
        DVec3::new(0.06, 0.0, 0.09),
        DVec3::new(0.04, 0.08, 0.26),
        DVec3::new(0.015, 0.28, 0.26),
        DVec3::new(0.12, 0.60, 0.10),
        DVec3::new(0.98, 0.80, 0.02),
    ];
    let position = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let below = (position as usize).min(STOPS.len() - 2);
    STOPS[below].lerp(STOPS[below + 1], position - below as f64)
}
