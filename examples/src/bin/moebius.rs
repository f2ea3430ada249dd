//! Rational curves of degree six with rational rotation-minimizing frames, fitted to example 1 of
//! Bartoň et al. 2009, and the strips that the frames sweep (figure 3 of the paper).

use std::error::Error;

use glam::{DVec2, DVec3};
use isochore_curve::{ClosestPoint, Curve, MoebiusSpline, Tilt, TrigonometricCurve, exact_frames};
use isochore_examples::{save_figure, swept_body};
use isochore_mesh::TriMesh;
use isochore_picture::{Body, Camera, Options, Panel};

/// Number of samples per segment.
const SAMPLES: usize = 40;

fn main() -> Result<(), Box<dyn Error>> {
    let curve = TrigonometricCurve::barton_example();
    let (first, last) = curve.domain();
    let normal = curve.jet(first).normal().ok_or("the curve is straight at its start")?;
    let exact = exact_frames(&curve, &[first, last], normal)?[1];
    let search = ClosestPoint::new(&curve);
    let mut strips: Vec<(String, TriMesh)> = Vec::new();
    for segments in [8, 16, 32] {
        let spline = MoebiusSpline::interpolate(&curve, segments, Tilt::WhenNeeded)?;
        let stations = spline.frames(normal, SAMPLES)?;
        let distance = stations.iter().map(|(point, _)| search.closest(*point).distance).fold(0.0, f64::max);
        let end = stations[stations.len() - 1].1.r.distance(exact.r);
        // As in the paper, the strip extends from the curve along r.
        let strip = [(0.2, 0.006), (0.0, 0.006), (0.0, -0.006), (0.2, -0.006)].map(|(r, s)| DVec2::new(r, s));
        strips.push((
            format!("{segments} segments: distance at most {distance:.1e}\nerror of the last frame {end:.1e}"),
            swept_body(&stations, &strip, false),
        ));
    }
    let dashes: Vec<(DVec3, DVec3)> = (0..90)
        .map(|i| {
            let at = |offset: f64| curve.position(first + (last - first) * (f64::from(i) + offset) / 90.0);
            (at(0.0), at(0.55))
        })
        .collect();
    let panels: Vec<Panel> = strips
        .iter()
        .map(|(caption, mesh)| {
            dashes.iter().fold(Panel::new(caption.clone()).with(Body::new(mesh)), |panel, &(a, b)| {
                panel.with(Body::polyline(&[a, b], 0.008, DVec3::new(0.02, 0.05, 0.3)))
            })
        })
        .collect();
    let camera = Camera::from_direction(DVec3::new(0.6, -0.8, 1.0));
    let options = Options { width: 2000, height: 760, ..Options::default() };
    save_figure("moebius", &strips[2].1, &panels, &camera, &options)
}
