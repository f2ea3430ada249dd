use glam::dvec3;
use proptest::prelude::*;

use super::*;
use crate::TriMesh;
use crate::primitives::{box_mesh, icosphere};

fn winding_number(mesh: &TriMesh) -> WindingNumber {
    WindingNumber::new(Arc::new(Bvh::new(&mesh.positions, &mesh.triangles).unwrap()))
}

#[test]
fn box_without_a_face_has_five_sixths_at_its_center() {
    let mut mesh = box_mesh(DVec3::ONE, [4, 4, 4]);
    mesh.triangles.retain(|t| !t.iter().all(|&v| mesh.positions[v as usize].z == 1.0));
    let number = winding_number(&mesh);
    // From the center each face covers a sixth of the sphere. Rounding of about 160 solid angles.
    assert!((number.at(DVec3::ZERO, 0.0) - 5.0 / 6.0).abs() < 1e-14);
    // From the midpoint of the missing face, the rest covers half of the sphere.
    assert!((number.at(DVec3::Z, 0.0) - 0.5).abs() < 1e-14);
    assert!(number.is_inside(DVec3::Z * 0.9) && !number.is_inside(DVec3::Z * 1.1));
}

#[test]
fn winding_numbers_of_nested_surfaces_add_up() {
    let inner = icosphere(0.5, 2);
    let outer = icosphere(1.0, 3);
    let count = outer.positions.len() as u32;
    let with = |inner: TriMesh| {
        let positions = outer.positions.iter().copied().chain(inner.positions).collect();
        let triangles =
            outer.triangles.iter().copied().chain(inner.triangles.iter().map(|t| t.map(|v| v + count))).collect();
        winding_number(&TriMesh::new(positions, triangles))
    };
    let (core, cavity) = (with(inner.clone()), with(inner.flipped()));
    for (x, in_core, in_cavity) in [(0.1, 2.0, 0.0), (0.7, 1.0, 1.0), (1.2, 0.0, 0.0)] {
        let point = dvec3(x, 0.01, 0.02);
        assert!((core.at(point, 0.0) - in_core).abs() < 1e-13);
        assert!((cavity.at(point, 0.0) - in_cavity).abs() < 1e-13);
        assert_eq!(cavity.is_inside(point), in_cavity == 1.0);
    }
}

proptest! {
    #[test]
    fn error_stays_below_the_tolerance(x in -2.0..2.0_f64, y in -2.0..2.0_f64, z in -2.0..2.0_f64, tolerance in 0.0..0.3_f64) {
        // An open, crumpled sheet, for which nothing cancels by symmetry.
        let mut mesh = icosphere(1.0, 4);
        for (i, p) in mesh.positions.iter_mut().enumerate() {
            *p += 0.05 * dvec3(i as f64 * 0.618_034, i as f64 * 0.414_214, i as f64 * 0.732_051).fract();
        }
        mesh.triangles.retain(|t| mesh.positions[t[0] as usize].z < 0.4);
        let point = dvec3(x, y, z);
        let exact: f64 = (0..mesh.triangles.len())
            .map(|t| solid_angle(mesh.corners(t).map(|corner| corner - point)))
            .sum::<f64>() / (4.0 * PI);
        let number = winding_number(&mesh);
        // 1e-12: rounding of 3,000 solid angles.
        prop_assert!((number.at(point, tolerance) - exact).abs() <= tolerance + 1e-12);
        prop_assert!((exact - 0.5).abs() < 1e-12 || number.is_inside(point) == (exact > 0.5));
        // The expansion also satisfies its own bound, not only the tolerance.
        for opening in OPENINGS {
            let (sum, error) = number.sum(number.bvh.frame().to_unit(point), opening);
            prop_assert!((sum - exact).abs() <= error + 1e-12, "{opening}: {sum} {exact} {error}");
        }
    }
}
