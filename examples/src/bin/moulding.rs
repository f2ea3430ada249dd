//! Exact rational sweeps along a Pythagorean-hodograph cubic: a moulding and a developable surface,
//! beside the same sweeps with Frenet frames (figures 1 and 7 of Mäurer and Jüttler 1999).

use std::error::Error;

use glam::{DVec2, DVec3};
use isochore_curve::{Curve, PhCubic, RationalCrossSection, RationalPatch, RationalRotation};
use isochore_examples::{joined, save_figure};
use isochore_mesh::{GridMesh, TriMesh};
use isochore_picture::{Body, Camera, Options, Panel};

/// Number of cells along the cross-section and along the spine.
const CELLS: (usize, usize) = (24, 120);

fn main() -> Result<(), Box<dyn Error>> {
    let cubic = PhCubic::hermite(
        DVec3::ZERO,
        DVec3::new(1.0, 0.2, 0.1),
        DVec3::new(1.0, 0.5, 0.0),
        DVec3::new(1.0, -0.3, 0.4),
    )?;
    let curved = RationalCrossSection::polynomial(
        &[(-0.08, 0.016), (-0.04, 0.096), (0.04, 0.08), (0.096, -0.024)].map(|(x, y)| DVec2::new(2.5 * x, 2.5 * y)),
    );
    // Offset from the spine: through it, the parameter lines of every frame would be orthogonal.
    let line = RationalCrossSection::polynomial(&[DVec2::new(-0.25, 0.1), DVec2::new(0.25, 0.2)]);
    let minimizing = RationalRotation::symmetric(&cubic);
    let mut sheets: Vec<(String, TriMesh)> = Vec::new();
    for (cross_section, is_line) in [(&curved, false), (&line, true)] {
        for (name, rotation) in [("rational, rotation-minimizing", &minimizing), ("Frenet", &RationalRotation::FRENET)]
        {
            let patch = RationalPatch::sweep(&cubic, rotation, cross_section, 0.0);
            let measured = if is_line { curvature(&patch) } else { orthogonality(&patch) };
            sheets.push((format!("{name}\n{measured}"), sheet(&patch)));
        }
    }
    let spine: Vec<DVec3> = (0..=100).map(|i| cubic.position(f64::from(i) / 100.0)).collect();
    let panels: Vec<Panel> = sheets
        .iter()
        .map(|(caption, mesh)| {
            Panel::new(caption.clone()).with(Body::new(mesh)).with(Body::polyline(&spine, 0.006, DVec3::splat(0.02)))
        })
        .collect();
    let camera = Camera::from_direction(DVec3::new(0.15, -0.6, 1.2));
    let options = Options { width: 2400, height: 430, ..Options::default() };
    let all = sheets.iter().fold(TriMesh::default(), |all, (_, mesh)| joined(all, mesh));
    save_figure("moulding", &all, &panels, &camera, &options)
}

fn cells() -> impl Iterator<Item = (f64, f64)> {
    let (across, along) = CELLS;
    (0..=along).flat_map(move |j| (0..=across).map(move |i| (i as f64 / across as f64, j as f64 / along as f64)))
}

fn orthogonality(patch: &RationalPatch) -> String {
    let largest = cells().map(|(u, v)| patch.jet(u, v).orthogonality().abs()).fold(0.0, f64::max);
    format!("cosine between parameter lines at most {largest:.1e}")
}

fn curvature(patch: &RationalPatch) -> String {
    let values: Vec<f64> = cells().filter_map(|(u, v)| patch.jet(u, v).gaussian_curvature()).collect();
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &k| (low.min(k), high.max(k)));
    format!("Gaussian curvature {low:.1e} to {high:.1e}")
}

/// The patch as an open sheet.
fn sheet(patch: &RationalPatch) -> TriMesh {
    let points: Vec<DVec3> = cells().map(|(u, v)| patch.jet(u, v).position).collect();
    GridMesh { points: &points, columns: CELLS.0 + 1, rows_close: false, columns_close: false }.mesh()
}
