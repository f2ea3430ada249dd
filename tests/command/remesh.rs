//! `isochore remesh`.

use isochore_mesh::{TriMesh, io, primitives::icosphere};

use crate::folder::{Folder, TETRAHEDRON};

fn ball(folder: &Folder, name: &str) -> TriMesh {
    let mesh = icosphere(1.0, 4);
    io::write(folder.path(name), &mesh).unwrap();
    mesh
}

#[test]
fn writes_beside_the_input_by_default() {
    let folder = Folder::with(&[]);
    let before = ball(&folder, "ball.ply");
    let run = folder.run(&["remesh", "ball.ply"]).expect(0);
    assert_eq!(run.stdout, "");
    for text in ["ball-remeshed.ply: ", "instead of 5120", "angles below 20°: 0.000 %", "self-intersections: 0"] {
        assert!(run.stderr.contains(text), "{}", run.stderr);
    }
    let after = io::read(folder.path("ball-remeshed.ply")).unwrap();
    assert!(after.triangles.len() < before.triangles.len());
    assert!((after.volume() / before.volume() - 1.0).abs() < 1e-12);
}

#[test]
fn reports_in_json() {
    let folder = Folder::with(&[]);
    ball(&folder, "ball.ply");
    let arguments = ["remesh", "ball.ply", "out.stl", "--edge-length", "0.2", "--report", "report.json", "--json"];
    let run = folder.run(&arguments).expect(0);
    let report = folder.json("report.json");
    assert_eq!(serde_json::from_str::<serde_json::Value>(&run.stdout).unwrap(), report);
    assert_eq!(report["before"]["triangles"], 5120);
    let after = io::read(folder.path("out.stl")).unwrap();
    assert_eq!(report["after"]["triangles"], after.triangles.len());
    assert!((report["allowance"].as_f64().unwrap() - 0.02).abs() < 1e-12);
    for key in ["volume_change", "volume_change_before_lock"] {
        assert!(report[key].as_f64().unwrap().abs() < 1e-4, "{key}");
    }
}

#[test]
fn rejects_bad_numbers_and_meshes() {
    let fins = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 1 2 4\nf 2 1 5\n";
    let folder = Folder::with(&[("solid.obj", TETRAHEDRON), ("fins.obj", fins)]);
    for option in ["--edge-length", "--deviation"] {
        for number in ["0", "-1", "nan", "inf", "wide"] {
            let run = folder.run(&["remesh", "solid.obj", option, number]).expect(2);
            assert!(run.stderr.contains("give a finite number above 0"), "{}", run.stderr);
        }
    }
    assert!(folder.run(&["remesh", "fins.obj"]).expect(2).stderr.contains("fins.obj: "));
    folder.run(&["remesh", "missing.obj"]).expect(2);
    folder.run(&["remesh", "solid.obj", "out.xyz"]).expect(2);
    assert_eq!(folder.contents().len(), 2);
}
