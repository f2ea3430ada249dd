//! `cargo xtask data`: generates the meshes of the folder `data` and its README.

mod chess;
mod coin;
mod disc;
mod figure;
mod flips;
mod foot;
mod hand;
mod hare;
mod planet;
mod rocker_arm;
mod solid;
mod surface;

use std::{fmt::Write, fs, path::PathBuf};

use glam::DVec3;
use isochore_mesh::{
    Aabb, TriMesh,
    io::{Format, WriteError, write_to},
};
use sha2::{Digest, Sha256};

use crate::shell::{TaskResult, workspace};

/// Coordinates are rounded to multiples of this, in model units: a hundredth of the shortest edges, and short in text.
const QUANTUM: f64 = 1e-4;

/// A file of the folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct DataFile {
    pub(crate) name: String,
    pub(crate) bytes: Vec<u8>,
}

/// A mesh of the folder.
struct Model {
    name: &'static str,
    shows: &'static str,
    source: Source,
}

enum Source {
    Mesh(fn() -> TriMesh),
    Solid { distance: fn(DVec3) -> f64, bounds: Aabb, cell: f64 },
}

/// A box from its extreme coordinates.
const fn bounds(min: [f64; 3], max: [f64; 3]) -> Aabb {
    Aabb { min: DVec3::from_array(min), max: DVec3::from_array(max) }
}

const CHESS: Aabb = bounds([-0.7, -0.7, -0.05], [0.9, 0.7, 2.1]);

/// All meshes. Cells are chosen for about 12,000 triangles, which keeps each file below 600 kB.
const MODELS: [Model; 13] = [
    Model {
        name: "planet",
        shows: "A planet of radius one with continents and craters",
        source: Source::Mesh(|| planet::planet(5)),
    },
    Model {
        name: "slab",
        shows: "A slab of clay, edges rounded",
        source: Source::Solid {
            distance: |point| solid::rounded_box(point, DVec3::ZERO, DVec3::new(1.2, 1.2, 0.35), 0.12),
            bounds: bounds([-1.2, -1.2, -0.35], [1.2, 1.2, 0.35]),
            cell: 0.0475,
        },
    },
    Model {
        name: "coin",
        shows: "A coin: rim and star on the front, a ring on the back",
        source: Source::Solid {
            distance: coin::coin,
            // Both levels of the relief lie halfway between planes of the grid, where cells are never ambiguous.
            bounds: bounds([-1.0, -1.0, -0.1875], [1.0, 1.0, 0.1875]),
            cell: 0.035,
        },
    },
    Model {
        name: "pawn",
        shows: "A chess pawn, turned",
        source: Source::Solid { distance: chess::pawn, bounds: CHESS, cell: 0.035 },
    },
    Model {
        name: "rook",
        shows: "A chess rook, turned, with battlements",
        source: Source::Solid { distance: chess::rook, bounds: CHESS, cell: 0.035 },
    },
    Model {
        name: "knight",
        shows: "A chess knight: the head of a horse on a turned base",
        source: Source::Solid { distance: chess::knight, bounds: CHESS, cell: 0.035 },
    },
    Model {
        name: "hand",
        shows: "An open right hand",
        source: Source::Solid {
            distance: hand::hand,
            bounds: bounds([-1.1, -1.1, -0.4], [0.8, 1.6, 0.4]),
            cell: 0.035,
        },
    },
    Model {
        name: "foot",
        shows: "A right foot with a piece of its leg; the sole faces −z",
        source: Source::Solid {
            distance: foot::foot,
            // The sole lies halfway between planes of the grid, where cells are never ambiguous.
            bounds: bounds([-0.7, -1.3, -0.025], [0.75, 1.25, 0.9]),
            cell: 0.03,
        },
    },
    Model {
        name: "rocker_arm",
        shows: "A rocker arm: two bores, ribs, fillets",
        source: Source::Solid {
            distance: rocker_arm::rocker_arm,
            bounds: bounds([-1.4, -0.5, -0.4], [1.3, 0.6, 0.4]),
            cell: 0.035,
        },
    },
    Model {
        name: "figure",
        shows: "A standing figure",
        source: Source::Solid {
            distance: figure::figure,
            bounds: bounds([-0.8, -0.35, -0.05], [0.8, 0.35, 2.3]),
            cell: 0.032,
        },
    },
    Model {
        name: "hare",
        shows: "A sitting hare with long ears",
        source: Source::Solid {
            distance: hare::hare,
            bounds: bounds([-1.0, -0.6, -0.05], [1.05, 0.6, 2.15]),
            cell: 0.04,
        },
    },
    Model { name: "disc", shows: "A disc, light and dark, to be swirled", source: Source::Mesh(disc::disc) },
    Model {
        name: "bar",
        shows: "A bar of square section, edges rounded",
        source: Source::Solid {
            distance: |point| solid::rounded_box(point, DVec3::ZERO, DVec3::new(0.3, 0.3, 1.2), 0.06),
            bounds: bounds([-0.3, -0.3, -1.2], [0.3, 0.3, 1.2]),
            cell: 0.035,
        },
    },
];

impl Model {
    fn mesh(&self) -> TriMesh {
        let mut mesh = match self.source {
            Source::Mesh(make) => make(),
            Source::Solid { distance, bounds, cell } => surface::surface(&distance, bounds, cell),
        };
        for position in &mut mesh.positions {
            *position = DVec3::from_array(position.to_array().map(|value| {
                // Adding zero turns a negative zero, which would be written with its sign, into a plain one.
                (value / QUANTUM).round() / (1.0 / QUANTUM) + 0.0
            }));
        }
        mesh
    }
}

/// Makes all files of the folder, in memory.
///
/// # Errors
/// If a mesh cannot be written as OBJ.
pub(crate) fn files() -> Result<Vec<DataFile>, WriteError> {
    let mut files = Vec::new();
    let mut table = String::new();
    for model in &MODELS {
        let mesh = model.mesh();
        let mut bytes = Vec::new();
        write_to(Format::Obj, &mesh, &mut bytes)?;
        let hash = Sha256::digest(&bytes).iter().fold(String::new(), |hash, byte| hash + &format!("{byte:02x}"));
        let name = format!("{}.obj", model.name);
        let triangles = mesh.triangles.len();
        writeln!(table, "| `{name}` | {} | {triangles} | {:.6} | `{hash}` |", model.shows, mesh.volume())
            .expect("text takes all that is written into it");
        files.push(DataFile { name, bytes });
    }
    let readme = include_str!("data/README.template.md").replace("{table}\n", &table);
    files.push(DataFile { name: "README.md".to_owned(), bytes: readme.into_bytes() });
    Ok(files)
}

/// Writes all files of the folder.
pub(crate) fn write_all() -> TaskResult {
    for file in files()? {
        fs::write(folder().join(&file.name), &file.bytes)?;
    }
    Ok(())
}

fn folder() -> PathBuf {
    workspace().join("data")
}

#[cfg(test)]
mod tests {
    use isochore_mesh::{NoProgress, SelfIntersections};

    use super::*;

    #[test]
    fn committed_files_are_made_anew_byte_for_byte() {
        for file in files().unwrap() {
            let committed = fs::read(folder().join(&file.name)).unwrap();
            assert!(committed == file.bytes, "{} differs: run `cargo xtask data`", file.name);
        }
    }

    #[test]
    fn meshes_are_sound_and_their_triangles_well_shaped() {
        for model in &MODELS {
            let (name, mesh) = (model.name, model.mesh());
            let check = mesh.check();
            assert!(check.is_valid() && check.is_closed() && check.is_oriented() && check.is_manifold(), "{name}");
            assert!(check.degenerate_triangles.is_empty() && check.duplicate_triangles.is_empty(), "{name}");
            assert!(mesh.volume() > 0.0, "{name} is turned inside out");
            assert_eq!(mesh.components().count, 1, "{name}");
            assert!(SelfIntersections::of(&mesh, &NoProgress).unwrap().triangles().is_empty(), "{name}");
            assert!((8_000..25_000).contains(&mesh.triangles.len()), "{name}");

            let sharpest =
                |triangle| mesh.triangle_angles(triangle).into_iter().fold(f64::INFINITY, f64::min).to_degrees();
            let angles: Vec<f64> = (0..mesh.triangles.len()).map(sharpest).collect();
            let below = |limit: f64| angles.iter().filter(|&&angle| angle < limit).count();
            // Targets bend well if they have no slivers and few thin triangles.
            assert_eq!(below(15.0), 0, "{name}");
            assert!(1000 * below(30.0) <= angles.len(), "{name}");
        }
    }

    #[test]
    fn files_are_small() {
        let sizes: Vec<usize> = files().unwrap().iter().map(|file| file.bytes.len()).collect();
        assert!(sizes.iter().all(|&size| size <= 600_000));
        assert!(sizes.iter().sum::<usize>() <= 6_000_000);
    }
}
