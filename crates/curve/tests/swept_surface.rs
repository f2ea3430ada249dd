//! Swept surfaces: comparison of the exact rational patch with direct evaluation, golden values
//! and the checks of the paper.

#![allow(clippy::excessive_precision, reason = "golden values keep all computed digits")]

use glam::{DVec2, DVec3};
use isochore_curve::{
    CrossSectionJet, Curve, Frame, PhCubic, RationalCrossSection, RationalPatch, RationalRotation, TrigonometricCurve,
    exact_frames, regularity, safe_cross_section_radius, sweep, swept_surface_curvature,
};

fn example_a() -> PhCubic {
    PhCubic::hermite(DVec3::ZERO, DVec3::new(1.0, 0.2, 0.1), DVec3::new(1.0, 0.5, 0.0), DVec3::new(1.0, -0.3, 0.4))
        .unwrap()
}

fn cross_section() -> RationalCrossSection {
    RationalCrossSection::polynomial(
        &[(-0.08, 0.016), (-0.04, 0.096), (0.04, 0.08), (0.096, -0.024)].map(|(x, y)| DVec2::new(x, y)),
    )
}

/// A straight cross-section that avoids the spine: on a line through the spine, the check is
/// trivial.
fn line() -> RationalCrossSection {
    RationalCrossSection::polynomial(&[DVec2::new(-0.1, 0.05), DVec2::new(0.1, 0.09)])
}

/// The grid of the golden maxima.
fn grid() -> impl Iterator<Item = (f64, f64)> {
    (0..=40).flat_map(|i| (0..=40).map(move |j| (f64::from(i) / 40.0, f64::from(j) / 40.0)))
}

fn largest_orthogonality(patch: &RationalPatch) -> f64 {
    grid().map(|(u, v)| patch.jet(u, v).orthogonality().abs()).fold(0.0, f64::max)
}

fn rational(cubic: &PhCubic, cross_section: &RationalCrossSection) -> RationalPatch {
    RationalPatch::sweep(cubic, &RationalRotation::symmetric(cubic), cross_section, 0.0)
}

fn frenet(cubic: &PhCubic, cross_section: &RationalCrossSection) -> RationalPatch {
    RationalPatch::sweep(cubic, &RationalRotation::FRENET, cross_section, 0.0)
}

#[test]
fn the_net_is_the_sweep_of_the_approximate_frame() {
    let cubic = example_a();
    let rotation = RationalRotation::symmetric(&cubic);
    let patch = rational(&cubic, &cross_section());
    assert_eq!((patch.cross_section_degree, patch.spine_degree, patch.control_points.len()), (3, 9, 40));
    for (u, v) in grid() {
        let frame = cubic.frenet_frame(v).turned(rotation.angle(v) - rotation.initial_angle);
        let mut c = cross_section().control_points;
        while c.len() > 1 {
            c = c.windows(2).map(|pair| pair[0].lerp(pair[1], u)).collect();
        }
        let direct = cubic.position(v) + frame.offset(c[0].truncate());
        // About 24 roundings of numbers of size one.
        assert!(patch.jet(u, v).position.distance(direct) < 4e-15);
    }
    let golden = DVec3::new(0.7138169990060661, 0.24944257344284454, -0.03432336026672978);
    // λ is determined to 1e-9, and its effect on the point is 1e-5 times that.
    assert!(patch.jet(0.3, 0.6).position.distance(golden) < 1e-13, "{}", patch.jet(0.3, 0.6).position);
}

#[test]
fn parameter_lines_are_orthogonal() {
    let cubic = example_a();
    let half = cubic.split(0.5).0;
    // The golden values have five and three digits.
    for (cubic, expected, expected_frenet) in [(cubic, 2.0512e-5, 0.1342), (half, 1.6103e-7, 0.0466)] {
        let (found, found_frenet) = (
            largest_orthogonality(&rational(&cubic, &cross_section())),
            largest_orthogonality(&frenet(&cubic, &cross_section())),
        );
        assert!((found / expected - 1.0).abs() < 3e-5, "{found:e}, expected {expected:e}");
        assert!((found_frenet / expected_frenet - 1.0).abs() < 7e-4, "{found_frenet}");
    }
}

#[test]
fn a_straight_cross_section_sweeps_a_developable_surface() {
    let half = example_a().split(0.5).0;
    let curvatures = |patch: &RationalPatch| -> Vec<f64> {
        grid().map(|(u, v)| patch.jet(u, v).gaussian_curvature().unwrap()).collect()
    };
    let range = |patch: &RationalPatch| {
        let all = curvatures(patch);
        all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), &k| (least.min(k), most.max(k)))
    };
    // K of a ruled surface is minus the squared error of the angular velocity. For lines at this
    // distance from the spine, its golden minimum is −5.5e-12. With the Frenet frame, the golden
    // range of K is −0.47 to −0.044.
    let (least, most) = range(&rational(&half, &line()));
    assert!((least + 5.5e-12).abs() < 2e-13 && most <= 1e-25, "{least:e} to {most:e}");
    let (least, most) = range(&frenet(&half, &line()));
    assert!((least + 0.48).abs() < 0.02 && (most + 0.044).abs() < 1e-3, "{least} to {most}");
}

#[test]
fn error_relative_to_the_exact_frame_is_golden() {
    let cubic = example_a();
    let patch = rational(&cubic, &cross_section());
    let worst = grid()
        .map(|(u, v)| {
            let mut c = cross_section().control_points;
            while c.len() > 1 {
                c = c.windows(2).map(|pair| pair[0].lerp(pair[1], u)).collect();
            }
            let frame = cubic.frenet_frame(v).turned(cubic.rotation_to(v));
            patch.jet(u, v).position.distance(cubic.position(v) + frame.offset(c[0].truncate()))
        })
        .fold(0.0, f64::max);
    assert!((worst / 2.533e-6 - 1.0).abs() < 1e-3, "{worst:e}");
}

#[test]
fn curvature_formula_matches_the_patch() {
    let cubic = example_a().split(0.5).0;
    let patch = rational(&cubic, &cross_section());
    for (u, v) in [(0.2, 0.3), (0.5, 0.5), (0.8, 0.9)] {
        let points: Vec<DVec2> = cross_section().control_points.iter().map(|p| p.truncate()).collect();
        let d: Vec<DVec2> = points.windows(2).map(|pair| 3.0 * (pair[1] - pair[0])).collect();
        let dd: Vec<DVec2> = d.windows(2).map(|pair| 2.0 * (pair[1] - pair[0])).collect();
        let evaluate = |mut c: Vec<DVec2>| {
            while c.len() > 1 {
                c = c.windows(2).map(|pair| pair[0].lerp(pair[1], u)).collect();
            }
            c[0]
        };
        let jet = CrossSectionJet { position: evaluate(points), first: evaluate(d), second: evaluate(dd) };
        let frame = cubic.frenet_frame(v).turned(cubic.rotation_to(v));
        let formula = swept_surface_curvature(&cubic.jet(v), &frame, &jet).unwrap();
        let patch = patch.jet(u, v).gaussian_curvature().unwrap();
        // The error of the angular velocity of the patch is 1e-5.
        assert!((formula / patch - 1.0).abs() < 1e-3, "{formula}, patch {patch}");
        assert!(formula * patch > 0.0);
    }
}

#[test]
fn torus_has_its_known_curvature_and_singular_radius() {
    let (major, minor) = (2.0, 0.5);
    let circle = TrigonometricCurve::helix(major, 0.0, (0.0, std::f64::consts::TAU));
    let jet = circle.jet(0.4);
    let frame = Frame::new(jet.normal().unwrap(), jet.tangent());
    for angle in [0.0, 1.0, 2.5, std::f64::consts::PI] {
        let (sin, cos) = libm::sincos(angle);
        let cross_section = CrossSectionJet {
            position: DVec2::new(minor * cos, minor * sin),
            first: DVec2::new(-minor * sin, minor * cos),
            second: DVec2::new(-minor * cos, -minor * sin),
        };
        // r points to the center. The inner equator is at angle 0 and has negative K.
        let exact = -cos / (minor * (major - minor * cos));
        let found = swept_surface_curvature(&jet, &frame, &cross_section).unwrap();
        assert!((found - exact).abs() < 1e-14, "{found}, exact {exact}");
        assert!((regularity(&jet, &frame, cross_section.position) - (1.0 - minor * cos / major)).abs() < 1e-15);
    }
    assert!((safe_cross_section_radius(&[jet]) - major).abs() < 1e-14);
    let at_center = CrossSectionJet { position: DVec2::new(2.0, 0.0), first: DVec2::Y, second: DVec2::ZERO };
    let margin = regularity(&jet, &frame, at_center.position);
    assert!(margin.abs() < 1e-15, "the swept point does not move at the center of curvature");
}

#[test]
fn grids_keep_the_order_of_stations_and_points() {
    let helix = TrigonometricCurve::helix(1.0, 0.4, (0.0, 2.0));
    let parameters = [0.0, 1.0, 2.0];
    let frames = exact_frames(&helix, &parameters, DVec3::Z).unwrap();
    let stations: Vec<(DVec3, Frame)> = parameters.iter().map(|&u| helix.position(u)).zip(frames).collect();
    let grid = sweep(&stations, &[DVec2::X, DVec2::new(0.0, 0.5)]);
    assert_eq!((grid.rows, grid.columns, grid.points.len()), (3, 2, 6));
    assert_eq!(grid.point(1, 1), stations[1].0 + stations[1].1.s * 0.5);
    assert_eq!(grid.row(2)[0], stations[2].0 + stations[2].1.r);
}

#[test]
fn straight_spines_sweep_a_prism() {
    let line = PhCubic::hermite(DVec3::ZERO, DVec3::Z * 2.0, DVec3::Z, DVec3::Z).unwrap();
    let patch = RationalPatch::sweep(&line, &RationalRotation::symmetric(&line), &cross_section(), 0.0);
    for (u, v) in grid() {
        let jet = patch.jet(u, v);
        assert!((jet.position.z - 2.0 * v).abs() < 1e-14 && jet.orthogonality().abs() < 1e-14);
        assert!(jet.position.truncate().distance(patch.jet(u, 0.0).position.truncate()) < 1e-15);
    }
}
