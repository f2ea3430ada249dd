//! Tests of `frames` and `sweep`.

use std::f64::consts::TAU;

use isochore_curve::{Curve, Spine, TrigonometricCurve, exact_frames, uniform_parameters};
use isochore_mesh::{ClosedMesh, io};

use crate::folder::Folder;

/// Rows of the torus knot, optionally with tangents.
fn knot(rows: usize, with_tangents: bool) -> String {
    let spine = Spine::sample(&TrigonometricCurve::torus_knot(), rows).unwrap();
    let mut text = String::from(if with_tangents { "x,y,z,tx,ty,tz\n" } else { "" });
    for (point, tangent) in spine.points().iter().zip(spine.tangents()) {
        text += &format!("{},{},{}", point.x, point.y, point.z);
        if with_tangents {
            text += &format!(",{},{},{}", tangent.x, tangent.y, tangent.z);
        }
        text += "\n";
    }
    text
}

/// A helix of one turn, without tangents.
fn helix(rows: usize) -> String {
    let helix = TrigonometricCurve::helix(1.0, 0.2, (0.0, TAU));
    let row = |u| helix.position(u);
    uniform_parameters(&helix, rows - 1).into_iter().map(row).map(|p| format!("{},{},{}\n", p.x, p.y, p.z)).collect()
}

fn square(side: f64) -> String {
    [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
        .map(|(x, y)| format!("{},{}\n", 0.5 * side * x, 0.5 * side * y))
        .concat()
}

fn table(bytes: &[u8]) -> (String, Vec<Vec<f64>>) {
    let text = std::str::from_utf8(bytes).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    (header.to_owned(), rows.lines().map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect()).collect())
}

#[test]
fn frames_of_the_torus_knot_match_golden_values() {
    let folder = Folder::with(&[("knot.csv", &knot(64, true))]);
    let arguments = ["frames", "knot.csv", "--closed", "--output", "frames.csv", "--r0=-1,0,0", "--json"];
    let run = folder.run(&arguments).expect(0);
    let (header, rows) = table(&folder.read("frames.csv"));
    assert_eq!(header, "x,y,z,rx,ry,rz,sx,sy,sz,tx,ty,tz");
    assert_eq!((rows.len(), rows[0].len()), (64, 12), "one row per sample");
    // Golden frame from 40-digit arithmetic; the values pass through two files with 17 digits.
    for (cell, golden) in rows[32][3..6].iter().zip([-0.13002211171695367, 0.9533616616881365, 0.2723890461966104]) {
        assert!((cell - golden).abs() < 1e-13);
    }
    let facts: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert!((facts["closing_angle"].as_f64().unwrap() + 2.880810092192165).abs() < 1e-12);
    assert!((facts["length"].as_f64().unwrap() - 15.097598937443747).abs() < 1e-12);
    assert!((facts["total_curvature"].as_f64().unwrap() - 41.830757001105745).abs() < 1e-12);
}

#[test]
fn every_method_approximates_the_exact_frame() {
    let folder = Folder::with(&[("helix.csv", &helix(65))]);
    let curve = TrigonometricCurve::helix(1.0, 0.2, (0.0, TAU));
    let exact = exact_frames(&curve, &[0.0, TAU], glam::DVec3::Z).unwrap()[1];
    // Errors of second and fourth order at 64 steps of 0.1 radians.
    for (method, bound) in [
        ("double-reflection", 1e-4),
        ("tangents-only", 1e-4),
        ("ph", 1e-4),
        ("mobius", 1e-4),
        ("projection", 1e-2),
        ("rotation", 1e-2),
    ] {
        let arguments = ["frames", "helix.csv", "--method", method, "--r0", "0,0,1", "-o", "out.csv"];
        folder.run(&arguments).expect(0);
        let (_, rows) = table(&folder.read("out.csv"));
        assert_eq!(rows.len(), 65);
        let r = glam::DVec3::from_slice(&rows[64][3..6]);
        assert!(r.distance(exact.r) < bound, "{method}: {:e}", r.distance(exact.r));
    }
    let arguments = ["frames", "helix.csv", "--method", "ph", "--samples-per-segment", "3", "-o", "fine.csv"];
    folder.run(&arguments).expect(0);
    assert_eq!(table(&folder.read("fine.csv")).1.len(), 64 * 3 + 1);
}

#[test]
fn twist_closes_and_turns_frames() {
    let folder = Folder::with(&[("knot.csv", &knot(128, false)), ("helix.csv", &helix(33))]);
    for law in ["arc", "curvature"] {
        for (twist, half) in [("minimal", -1.0), ("1", 1.0), ("-2", -1.0)] {
            let twist = format!("--twist={twist}");
            let arguments = ["frames", "knot.csv", "--closed", "--law", law, &twist, "--r0=-1,0,0", "-o", "closed.csv"];
            folder.run(&arguments).expect(0);
            let (_, rows) = table(&folder.read("closed.csv"));
            // Follows from the symmetry of the knot, which the estimated tangents preserve.
            assert!((rows[64][3] - half).abs() < 1e-12, "{law} {twist}: {}", rows[64][3]);
        }
    }
    let frames = |twist: &str| {
        folder.run(&["frames", "helix.csv", "--twist", twist, "-o", "open.csv"]).expect(0);
        table(&folder.read("open.csv")).1
    };
    let (plain, turned) = (frames("none"), frames("1"));
    for k in 3..9 {
        assert!((plain[32][k] - turned[32][k]).abs() < 1e-13, "a full turn ends at its start");
    }
    assert!((plain[16][3] - turned[16][3]).abs() > 0.1);
}

#[test]
fn swept_meshes_are_closed_on_request() {
    let folder =
        Folder::with(&[("knot.csv", &knot(200, false)), ("helix.csv", &helix(100)), ("square.csv", &square(0.1))]);
    let sweep = |extra: &[&str]| {
        let arguments = [&["sweep"], extra, &["--profile", "square.csv", "--output", "out.ply"]].concat();
        folder.run(&arguments).expect(0);
        io::read(folder.path("out.ply")).unwrap()
    };
    let knot = sweep(&["knot.csv", "--closed", "--profile-closed"]);
    assert_eq!(knot.positions.len(), 800);
    // Area of the cross-section times length. The polygon is slightly shorter than the curve.
    let volume = ClosedMesh::new(&knot).unwrap().volume();
    assert!((volume / (0.01 * 15.37) - 1.0).abs() < 0.01, "{volume}");
    let capped = sweep(&["helix.csv", "--profile-closed", "--caps"]);
    assert!(ClosedMesh::new(&capped).unwrap().volume() > 0.0, "the normals point outward");
    assert!(ClosedMesh::new(&sweep(&["helix.csv", "--profile-closed"])).is_err(), "no caps");
    assert!(ClosedMesh::new(&sweep(&["knot.csv", "--closed", "--twist", "none", "--profile-closed"])).is_err());
}

#[test]
fn nets_are_exact_patches_of_degree_nine() {
    let section = "-0.08,0.016\n-0.04,0.096\n0.04,0.08\n0.096,-0.024\n";
    let folder = Folder::with(&[("helix.csv", &helix(9)), ("section.csv", section), ("square.csv", &square(0.2))]);
    let arguments = ["sweep", "helix.csv", "--bezier", "--profile", "section.csv", "--output", "net.json"];
    folder.run(&arguments).expect(0);
    let net = folder.json("net.json");
    assert_eq!((net["degree_u"].as_u64(), net["degree_v"].as_u64()), (Some(3), Some(9)));
    let patches = net["patches"].as_array().unwrap();
    assert_eq!(patches.len(), 8);
    let corner = |patch: usize, u: usize, v: usize| -> Vec<f64> {
        let point = patches[patch]["control_points"][u][v].as_array().unwrap();
        point[..3].iter().map(|x| x.as_f64().unwrap()).collect()
    };
    for patch in 0..7 {
        for u in [0, 3] {
            for (a, b) in corner(patch, u, 9).iter().zip(corner(patch + 1, u, 0)) {
                assert!((a - b).abs() < 1e-12, "corners of neighboring patches coincide");
            }
        }
    }
    let arguments = ["sweep", "helix.csv", "--profile-closed", "--profile", "square.csv", "-o", "square.json"];
    folder.run(&arguments).expect(0);
    let net = folder.json("square.json");
    assert_eq!((net["degree_u"].as_u64(), net["patches"].as_array().unwrap().len()), (Some(1), 32));
}

#[test]
fn writes_exact_surfaces_as_step() {
    let folder = Folder::with(&[("helix.csv", &helix(5)), ("square.csv", &square(0.2))]);
    let arguments = ["sweep", "helix.csv", "--profile-closed", "--profile", "square.csv", "--output", "a.step"];
    folder.run(&arguments).expect(0);
    let text = String::from_utf8(folder.read("a.step")).unwrap();
    assert!(text.starts_with("ISO-10303-21;\n") && text.trim_end().ends_with("END-ISO-10303-21;"));
    // Four segments with four sides: faces; edges across five joints and along four corners;
    // vertices.
    for (entity, count) in [("RATIONAL_B_SPLINE_SURFACE", 16), ("EDGE_CURVE", 5 * 4 + 4 * 4), ("VERTEX_POINT", 5 * 4)] {
        assert_eq!(text.matches(&format!("{entity}(")).count(), count, "{entity}");
    }
    assert_eq!(text.matches("B_SPLINE_SURFACE(1, 9,").count(), 16, "degrees of cross-section and curve");
    folder.run(&arguments).expect(0);
    assert_eq!(folder.read("a.step"), text.as_bytes(), "the file is reproducible");
}

#[test]
fn errors_name_the_rows_of_invalid_curves() {
    let rows = |text: &str| text.replace(' ', "\n");
    for (curve, arguments, parts) in [
        ("0,0,0", &[][..], &["curve.csv", "at least 2 points, not 1"][..]),
        ("0,0,0 1,0,0 1,0,0 2,0,1", &[], &["rows 2 and 3", "coincide"]),
        ("0,0,0 1,nan,0 2,0,0", &[], &["row 2, column 2", "NaN"]),
        ("0,0 1,0", &[], &["row 1 has 2 columns; expected 3 or 6"]),
        ("0,0,0,1,0,0 1,0,0,-1,0,0 2,0,0,1,0,0", &[], &["rows 1 and 2", "reversed"]),
        ("0,0,0,1,0,0 1,0,0,0,0,0", &[], &["row 2", "the tangent is zero"]),
        ("0,0,0 1,0,0 0,0,0", &["--tangents", "circle"], &["row 2", "cusp"]),
        ("0,0,0 1,0,0 2,0,0 3,0,0 4,0,0 5,0,0 6,0,0", &["--closed"], &["--closed", "first row is 6", "open"]),
        ("0,0,0 1,0,0 1,1,0 0,0,0", &["--closed"], &["row 4", "repeats the first point", "remove it"]),
        ("0,0,0 1,0,0", &["--tangents", "given"], &["no tangents", "tx,ty,tz"]),
        ("0,0,0 1,0,0", &["--r0", "1,0,0"], &["--r0", "parallel to the first tangent"]),
        ("0,0,0 1,0,0", &["--r0", "1,0"], &["--r0", "0,0,1"]),
        ("0,0,0 1,0,0", &["--twist", "minimal"], &["--twist minimal", "--closed"]),
        ("0,0,0 1,0,0", &["--twist", "often"], &["--twist", "whole number"]),
        ("0,0,0 1,0,0", &["--samples-per-segment", "2"], &["--samples-per-segment", "ph or mobius"]),
        ("0,0,0,1,0,0 1,1,0,1,0,0", &["--method", "ph"], &["rows 1 and 2", "inflection", "more rows"]),
    ] {
        let folder = Folder::with(&[("curve.csv", &rows(curve)), ("out.csv", "old output")]);
        let before = folder.contents();
        let arguments = [&["frames", "curve.csv", "-o", "out.csv"], arguments].concat();
        folder.run(&arguments).expect_error(2, parts);
        assert_eq!(folder.contents(), before);
    }
}

#[test]
fn rejects_invalid_sweeps() {
    let files = [
        ("curve.csv", "0,0,0\n1,0,0\n2,1,0\n3,1,1\n4,0,1\n"),
        ("section.csv", "0,0\n1,0\n0,1\n"),
        ("one.csv", "0,0\n"),
    ];
    for (arguments, parts) in [
        (&["--profile", "one.csv", "-o", "a.obj"][..], &["one.csv", "at least 2 rows"][..]),
        (&["--profile", "curve.csv", "-o", "a.obj"], &["curve.csv", "row 1 has 3 columns; expected 2"]),
        (&["--profile", "section.csv", "-o", "a.iges"], &["a.iges", "supported are"]),
        (&["--profile", "section.csv", "-o", "a.obj", "--caps"], &["--caps", "--profile-closed"]),
        (
            &["--profile", "section.csv", "-o", "a.obj", "--bezier", "--profile-closed"],
            &["--profile-closed", "--bezier"],
        ),
        (&["--profile", "section.csv", "-o", "a.json", "--method", "rotation"], &["--method ph"]),
        (&["--profile", "section.csv", "-o", "a.json", "--twist", "1"], &["--twist", "write a mesh"]),
        (&["--profile", "none.csv", "-o", "a.obj"], &["none.csv", "No such file"]),
    ] {
        let folder = Folder::with(&files);
        let before = folder.contents();
        folder.run(&[&["sweep", "curve.csv"], arguments].concat()).expect_error(2, parts);
        assert_eq!(folder.contents(), before);
    }
}
