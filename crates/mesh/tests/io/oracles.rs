//! Comparison with direct calls of the libraries for the same formats.

use std::io::Cursor;

use glam::{DVec2, DVec3};
use isochore_mesh::io::{self, Format};
use isochore_mesh::{TriMesh, primitives};

use crate::{seamed_box, written};

fn corner_positions(mesh: &TriMesh) -> Vec<[DVec3; 3]> {
    (0..mesh.triangles.len()).map(|triangle| mesh.corners(triangle)).collect()
}

#[test]
fn obj_agrees_with_tobj() {
    // The larger mesh is read as several objects.
    for mesh in [seamed_box(), primitives::icosphere(0.3, 5)] {
        let bytes = written(Format::Obj, &mesh);
        let no_materials = |_: &std::path::Path| Ok(Default::default());
        let options = tobj::LoadOptions::default();
        let (models, _) = tobj::load_obj_buf(&mut Cursor::new(&bytes), &options, no_materials).unwrap();
        let ours = io::read_bytes(Format::Obj, &bytes).unwrap();
        let (mut positions, mut uvs, mut normals) = (Vec::new(), Vec::new(), Vec::new());
        for tobj::Model { mesh: theirs, .. } in &models {
            let triple = |index: u32, values: &[f64]| DVec3::from_slice(&values[3 * index as usize..]);
            for corners in theirs.indices.chunks_exact(3) {
                positions.push([0, 1, 2].map(|corner| triple(corners[corner], &theirs.positions)));
            }
            for corners in theirs.normal_indices.chunks_exact(3) {
                normals.push([0, 1, 2].map(|corner| triple(corners[corner], &theirs.normals).as_vec3()));
            }
            for corners in theirs.texcoord_indices.chunks_exact(3) {
                let uv = |index: u32| DVec2::from_slice(&theirs.texcoords[2 * index as usize..]).as_vec2();
                uvs.push([0, 1, 2].map(|corner| uv(corners[corner])));
            }
        }
        assert_eq!(corner_positions(&ours), positions);
        assert_eq!(ours.corner.normals, normals);
        assert_eq!(ours.corner.uvs.concat(), uvs);
    }
}

#[test]
fn stl_agrees_with_stl_io() {
    let mesh = primitives::icosphere(0.3, 3);
    let binary = written(Format::Stl, &mesh);
    let mut text = String::from("solid ball\n");
    for corners in corner_positions(&Format::Stl.stored(&mesh)) {
        text.push_str("facet normal 0 0 0\nouter loop\n");
        corners.iter().for_each(|p| text.push_str(&format!("vertex {} {} {}\n", p.x, p.y, p.z)));
        text.push_str("endloop\nendfacet\n");
    }
    text.push_str("endsolid ball\n");
    for bytes in [binary, text.into_bytes()] {
        let theirs = stl_io::read_stl(&mut Cursor::new(&bytes)).unwrap();
        let position = |vertex: usize| DVec3::from_array(theirs.vertices[vertex].0.map(f64::from));
        let theirs: Vec<_> = theirs.faces.iter().map(|face| face.vertices.map(position)).collect();
        assert_eq!(corner_positions(&io::read_bytes(Format::Stl, &bytes).unwrap()), theirs);
    }
}

/// The library validates the whole document and reads the numbers independently.
#[test]
fn glb_agrees_with_gltf() {
    let mesh = seamed_box();
    let document = gltf::Gltf::from_slice(&written(Format::Glb, &mesh)).unwrap();
    let blob = document.blob.as_deref().unwrap();
    let primitives: Vec<_> = document.meshes().flat_map(|mesh| mesh.primitives()).collect();
    assert_eq!(primitives.len(), 2);
    let mut triangles = Vec::new();
    for primitive in primitives {
        let reader = primitive.reader(|_| Some(blob));
        let positions: Vec<_> = reader.read_positions().unwrap().collect();
        let uvs: Vec<_> = reader.read_tex_coords(0).unwrap().into_f32().collect();
        assert_eq!(positions.len(), uvs.len());
        assert_eq!(positions.len(), reader.read_normals().unwrap().count());
        let indices: Vec<_> = reader.read_indices().unwrap().into_u32().collect();
        let position = |index: u32| glam::Vec3::from_array(positions[index as usize]).as_dvec3();
        triangles.extend(indices.chunks_exact(3).map(|t| [position(t[0]), position(t[1]), position(t[2])]));
        let bounds = primitive.bounding_box();
        assert_eq!((bounds.min, bounds.max), ([-1.0, -2.0, -0.5], [1.0, 2.0, 0.5]));
    }
    assert_eq!(triangles, corner_positions(&mesh));
    let names: Vec<_> = document.materials().map(|material| material.name().unwrap().to_owned()).collect();
    assert_eq!(names, mesh.materials);
}
