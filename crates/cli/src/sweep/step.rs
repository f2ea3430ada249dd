//! STEP files (ISO 10303-21) of exact surfaces, for CAD programs.

use std::path::Path;

use glam::DVec4;
use isochore_curve::RationalPatch;
use truck_geometry::{
    base::{Point3, Vector4},
    nurbs::{BSplineCurve, BSplineSurface, KnotVec, NurbsCurve, NurbsSurface},
};
use truck_stepio::out::{CompleteStepDisplay, StepHeaderDescriptor, StepModel};
use truck_topology::compress::{CompressedEdge, CompressedEdgeIndex, CompressedFace, CompressedShell};

use super::net::Net;

type Shell = CompressedShell<Point3, NurbsCurve<Vector4>, NurbsSurface<Vector4>>;

/// Encodes the surface as one open shell whose neighboring faces share edges.
///
/// STEP requires a unit of length, so model units become millimeters. Numbers below 0.01 are
/// written with eleven digits, larger ones exactly.
pub(super) fn to_step(net: &Net, path: &Path) -> String {
    let shell = shell(net);
    let header = StepHeaderDescriptor {
        file_name: path.file_name().unwrap_or_default().to_string_lossy().replace(['\'', '\\'], "_"),
        // A fixed time makes the file reproducible.
        time_stamp: "1970-01-01T00:00:00".to_owned(),
        organization_system: "isochore".to_owned(),
        ..StepHeaderDescriptor::default()
    };
    CompleteStepDisplay::new(StepModel::from(&shell), header).to_string()
}

fn shell(net: &Net) -> Shell {
    let (segments, sides) = (net.patches.len(), net.patches[0].len());
    let corners = if net.is_cross_section_closed { sides } else { sides + 1 };
    // Vertices form a grid: joints of the curve times corners of the cross-section.
    let vertex = |joint: usize, corner: usize| joint * corners + corner % corners;
    let across = |joint: usize, side: usize| joint * sides + side;
    let along = |segment: usize, corner: usize| (segments + 1) * sides + segment * corners + corner % corners;
    // The patch that starts at a joint or corner, or the one that ends there at the last.
    let patch = |segment: usize, side: usize| &net.patches[segment.min(segments - 1)][side.min(sides - 1)];
    let mut shell = Shell { vertices: Vec::new(), edges: Vec::new(), faces: Vec::new() };
    for joint in 0..=segments {
        for corner in 0..corners {
            let end = PatchCorner { patch: patch(joint, corner), u_end: corner == sides, v_end: joint == segments };
            shell.vertices.push(end.vertex());
        }
    }
    for joint in 0..=segments {
        for side in 0..sides {
            let edge = PatchCorner { patch: patch(joint, side), u_end: false, v_end: joint == segments };
            let vertices = (vertex(joint, side), vertex(joint, side + 1));
            shell.edges.push(CompressedEdge { vertices, curve: edge.across() });
        }
    }
    for segment in 0..segments {
        for corner in 0..corners {
            let edge = PatchCorner { patch: patch(segment, corner), u_end: corner == sides, v_end: false };
            let vertices = (vertex(segment, corner), vertex(segment + 1, corner));
            shell.edges.push(CompressedEdge { vertices, curve: edge.along() });
        }
    }
    for segment in 0..segments {
        for side in 0..sides {
            // Counter-clockwise in (u, v): out along u, up along v, back and down.
            let boundary = [
                (across(segment, side), true),
                (along(segment, side + 1), true),
                (across(segment + 1, side), false),
                (along(segment, side), false),
            ];
            shell.faces.push(CompressedFace {
                boundaries: vec![boundary.map(CompressedEdgeIndex::from).to_vec()],
                orientation: true,
                surface: surface(patch(segment, side)),
            });
        }
    }
    shell
}

/// A corner of a patch and the two edges that meet there.
#[derive(Debug, Clone, Copy)]
struct PatchCorner<'a> {
    patch: &'a RationalPatch,
    u_end: bool,
    v_end: bool,
}

impl PatchCorner<'_> {
    fn row(&self) -> &[DVec4] {
        let width = self.patch.spine_degree + 1;
        let row = if self.u_end { self.patch.cross_section_degree } else { 0 };
        &self.patch.control_points[row * width..(row + 1) * width]
    }

    fn column(&self) -> usize {
        if self.v_end { self.patch.spine_degree } else { 0 }
    }

    fn vertex(&self) -> Point3 {
        let corner = self.row()[self.column()];
        Point3::new(corner.x / corner.w, corner.y / corner.w, corner.z / corner.w)
    }

    fn along(&self) -> NurbsCurve<Vector4> {
        curve(self.row().iter().copied())
    }

    fn across(&self) -> NurbsCurve<Vector4> {
        let column = self.column();
        curve(self.patch.control_points.chunks(self.patch.spine_degree + 1).map(|row| row[column]))
    }
}

fn curve(points: impl Iterator<Item = DVec4>) -> NurbsCurve<Vector4> {
    let points: Vec<Vector4> = points.map(homogeneous).collect();
    NurbsCurve::new(BSplineCurve::new(KnotVec::bezier_knot(points.len() - 1), points))
}

fn surface(patch: &RationalPatch) -> NurbsSurface<Vector4> {
    let knots = (KnotVec::bezier_knot(patch.cross_section_degree), KnotVec::bezier_knot(patch.spine_degree));
    let points = patch
        .control_points
        .chunks(patch.spine_degree + 1)
        .map(|row| row.iter().copied().map(homogeneous).collect())
        .collect();
    NurbsSurface::new(BSplineSurface::new(knots, points))
}

fn homogeneous(point: DVec4) -> Vector4 {
    Vector4::new(point.x, point.y, point.z, point.w)
}
