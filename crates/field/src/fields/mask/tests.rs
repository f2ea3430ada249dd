use std::sync::Arc;

use isochore_mesh::{TriMesh, primitives};

use super::*;
use crate::fields::field::finite_differences::scattered_points;

pub(crate) fn pin(center: [f64; 3], radius: f64, support: f64) -> Pin {
    Pin::new(center.into(), radius, support).unwrap()
}

pub(crate) fn plane(point: [f64; 3], normal: [f64; 3]) -> MirrorPlane {
    MirrorPlane::new(point.into(), normal.into()).unwrap()
}

pub(crate) fn pinned(pins: Vec<Pin>) -> Arc<Mask> {
    Arc::new(Mask::new(pins, None, Vec::new()).unwrap())
}

pub(crate) fn mirrored(mirrors: Vec<MirrorPlane>) -> Arc<Mask> {
    Arc::new(Mask::new(Vec::new(), None, mirrors).unwrap())
}

/// One for vertices above this height, zero for the others.
fn cap_weights(mesh: &TriMesh, height: f64) -> Vec<f64> {
    mesh.positions.iter().map(|position| if position.z > height { 1.0 } else { 0.0 }).collect()
}

pub(crate) fn painted(fade: f64) -> Arc<Mask> {
    let sphere = primitives::icosphere(1.0, 3);
    let vertices = VertexMask::new(&sphere, &cap_weights(&sphere, 0.6), Some(fade)).unwrap();
    Arc::new(Mask::new(Vec::new(), Some(vertices), Vec::new()).unwrap())
}

#[test]
fn a_mask_is_zero_where_it_holds_and_one_far_away() {
    let sphere = primitives::icosphere(1.0, 4);
    let weights = cap_weights(&sphere, 0.6);
    let mask = VertexMask::new(&sphere, &weights, None).unwrap();
    let edge = sphere.edge_lengths().unwrap().mean;
    for (position, weight) in sphere.positions.iter().zip(&weights) {
        let factor = mask.factor(*position);
        if *weight == 1.0 {
            assert_eq!((factor.value, factor.gradient), (0.0, DVec3::ZERO));
        } else if libm::acos(position.z) - libm::acos(0.6) > 5.6 * edge {
            // The weights grow by 1.75 radii of two edges, and the kernel adds one radius; arcs are
            // slightly longer than chords.
            assert_eq!(factor.value, 1.0);
        }
    }
    for corners in &sphere.triangles {
        if corners.iter().all(|&vertex| weights[vertex as usize] == 1.0) {
            let middle = corners.iter().map(|&vertex| sphere.positions[vertex as usize]).sum::<DVec3>() / 3.0;
            assert_eq!((mask.factor(middle).value, mask.factor(middle).gradient), (0.0, DVec3::ZERO));
        }
    }
    assert_eq!(mask.factor(DVec3::Z * (1.0 + 2.1 * edge)).value, 1.0);
    let half = VertexMask::new(&sphere, &vec![0.5; sphere.positions.len()], None).unwrap();
    // The average of equal weights, up to rounding.
    assert!((half.factor(sphere.positions[7]).value - 0.5).abs() < 1e-15);
}

#[test]
fn large_triangles_hold_between_their_vertices() {
    let cube = primitives::box_mesh(DVec3::ONE, [1, 1, 1]);
    let weights: Vec<f64> = cube.positions.iter().map(|position| if position.z > 0.0 { 1.0 } else { 0.0 }).collect();
    let mask = VertexMask::new(&cube, &weights, Some(0.2)).unwrap();
    for point in scattered_points(200, 1.0) {
        let top = DVec3::new(point.x, point.y, 1.0);
        assert_eq!((mask.factor(top).value, mask.factor(top).gradient), (0.0, DVec3::ZERO), "{top}");
        // On the walls the mask fades towards the floor. It reaches as far as the weights have
        // grown plus one radius.
        let floor = DVec3::new(0.7 * point.x, 0.7 * point.y, -1.0);
        assert_eq!(mask.factor(floor).value, 1.0);
        let wall = mask.factor(DVec3::new(1.0, 0.7 * point.y, 0.5 * point.z)).value;
        assert!((wall - (0.5 - 0.25 * point.z)).abs() < 0.5 * 0.275, "{wall} {point}");
    }
}

#[test]
fn rejects_invalid_masks() {
    let slanted = vec![plane([0.0; 3], [1.0, 0.0, 0.0]), plane([0.0; 3], [1.0, 1.0, 0.0])];
    let error = Mask::new(Vec::new(), None, slanted).unwrap_err();
    assert_eq!(error, MaskError::NotPerpendicular { first: 0, second: 1 });
    assert_eq!(Pin::new(DVec3::ZERO, -1.0, 1.0), Err(MaskError::Radius(-1.0)));
    assert_eq!(Pin::new(DVec3::ZERO, 0.0, 0.0), Err(MaskError::Support(0.0)));
    assert!(Pin::new(DVec3::NAN, 0.0, 1.0).is_err());
    assert_eq!(MirrorPlane::new(DVec3::ZERO, DVec3::ZERO), Err(MaskError::ZeroNormal));
    assert!(MirrorPlane::new(DVec3::ZERO, DVec3::X * 1e-300).is_ok());
    let sphere = primitives::icosphere(1.0, 0);
    let refused = |weights: &[f64], fade| VertexMask::new(&sphere, weights, fade).unwrap_err();
    assert_eq!(refused(&[1.0; 11], None), MaskError::WeightCount { found: 11, expected: 12 });
    let mut weights = [0.0; 12];
    weights[7] = 1.5;
    assert_eq!(refused(&weights, None), MaskError::Weight { vertex: 7, weight: 1.5 });
    assert_eq!(refused(&[1.0; 12], Some(0.0)), MaskError::Fade(0.0));
    assert!(matches!(refused(&[1.0; 12], Some(1e-9)), MaskError::TooManySamples { .. }));
    let points = TriMesh::new(vec![DVec3::ZERO], Vec::new());
    assert_eq!(VertexMask::new(&points, &[1.0], None).unwrap_err(), MaskError::NoEdges);
    assert!(VertexMask::new(&points, &[1.0], Some(0.1)).is_ok());
}
