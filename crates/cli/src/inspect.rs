//! `isochore inspect`: mesh statistics.

use isochore_mesh::{ClosedMesh, SelfIntersectionError, SelfIntersections, TriMesh};
use isochore_sculpt::Bounds;
use serde::Serialize;

use crate::{
    arguments::InspectArguments, command_error::CommandError, console::Console, mesh_file::read_mesh, outcome::Outcome,
};

/// Statistics of a mesh.
#[derive(Debug, Clone, Serialize)]
struct Statistics {
    vertices: usize,
    triangles: usize,
    components: usize,
    closed: bool,
    oriented: bool,
    /// Signed, in cubic model units; `None` unless the mesh is a closed, oriented manifold.
    volume: Option<f64>,
    area: f64,
    bounds: Bounds,
    boundary_edges: usize,
    degenerate_triangles: usize,
    self_intersecting_triangles: usize,
}

pub(crate) fn inspect(arguments: &InspectArguments, console: &Console) -> Result<Outcome, CommandError> {
    let mesh = read_mesh(&arguments.mesh, console)?;
    let statistics = Statistics::of(&mesh, console).map_err(|error| match error {
        SelfIntersectionError::Cancelled(cancelled) => cancelled.into(),
        error => CommandError::file(&arguments.mesh, error),
    })?;
    if console.is_json() {
        console.print_json(&statistics);
    } else {
        console.print(statistics);
    }
    Ok(Outcome::Done)
}

impl Statistics {
    fn of(mesh: &TriMesh, console: &Console) -> Result<Self, SelfIntersectionError> {
        let check = mesh.check();
        let bounds = mesh.bounds();
        Ok(Self {
            vertices: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            components: mesh.components().count,
            closed: check.is_closed(),
            oriented: check.is_oriented(),
            volume: ClosedMesh::new(mesh).ok().map(|mesh| mesh.volume()),
            area: mesh.area(),
            bounds: Bounds { min: bounds.min.to_array(), max: bounds.max.to_array() },
            boundary_edges: check.boundary_edges.len(),
            degenerate_triangles: check.degenerate_triangles.len(),
            self_intersecting_triangles: SelfIntersections::of(mesh, console)?.triangles().len(),
        })
    }
}

impl std::fmt::Display for Statistics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let yes_or_no = |is_true| if is_true { "yes" } else { "no" }.to_owned();
        let Bounds { min, max } = &self.bounds;
        let lines = [
            ("vertices", self.vertices.to_string()),
            ("triangles", self.triangles.to_string()),
            ("components", self.components.to_string()),
            ("closed", yes_or_no(self.closed)),
            ("oriented", yes_or_no(self.oriented)),
            (
                "volume",
                self.volume.map_or("none (the mesh is not a closed, oriented manifold)".to_owned(), |volume| {
                    volume.to_string()
                }),
            ),
            ("area", self.area.to_string()),
            ("bounds", format!("{min:?} to {max:?}")),
            ("boundary edges", self.boundary_edges.to_string()),
            ("degenerate triangles", self.degenerate_triangles.to_string()),
            ("self-intersecting triangles", self.self_intersecting_triangles.to_string()),
        ];
        let lines: Vec<String> = lines.iter().map(|(name, value)| format!("{name:<29}{value}")).collect();
        f.write_str(&lines.join("\n"))
    }
}
