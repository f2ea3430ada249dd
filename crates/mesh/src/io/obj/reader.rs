//! Reading OBJ.

use glam::DVec2;

use super::contents::Contents;
use crate::TriMesh;
use crate::io::ParseError;
use crate::io::polygon::triangulate;
use crate::measure::triangle_normal;

/// Reads OBJ: `v` with optional color, `vt`, `vn`, `f`, `usemtl` and `mtllib`; other statements are passed over.
///
/// Faces may refer to vertices that come later. Vertices keep their order, used or not, except that those which the file
/// splits along seams are welded.
pub(in crate::io) fn parse(bytes: &[u8]) -> Result<TriMesh, ParseError> {
    Ok(into_mesh(Contents::of(bytes)?).welded_at_boundary())
}

fn into_mesh(contents: Contents) -> TriMesh {
    let Contents { positions, uvs, normals, runs, corner_vertices, corner_uvs, corner_normals, .. } = contents;
    // Without a `usemtl` there is only the unnamed material that faces before one get.
    let has_materials = contents.materials.iter().any(|name| !name.is_empty());
    let has_uvs = runs.iter().any(|(kind, _)| kind.has_uvs);
    let has_normals = runs.iter().any(|(kind, _)| kind.has_normals);
    let triangles = runs.iter().map(|(kind, faces)| faces * (kind.size - 2)).sum();

    let mut mesh = TriMesh { triangles: Vec::with_capacity(triangles), ..TriMesh::default() };
    let mut mesh_uvs = Vec::with_capacity(if has_uvs { triangles } else { 0 });
    mesh.corner.normals.reserve_exact(if has_normals { triangles } else { 0 });
    let mut polygon = Vec::new();
    let (mut vertices, mut face_uvs, mut face_normals) = (&corner_vertices[..], &corner_uvs[..], &corner_normals[..]);
    for &(kind, faces) in &runs {
        for _ in 0..faces {
            let face = take(&mut vertices, kind.size);
            let face_uvs = take(&mut face_uvs, if kind.has_uvs { kind.size } else { 0 });
            let face_normals = take(&mut face_normals, if kind.has_normals { kind.size } else { 0 });
            let mut push = |triangle: [usize; 3]| {
                let corners = triangle.map(|corner| face[corner]);
                mesh.triangles.push(corners);
                if has_materials {
                    mesh.triangle_materials.push(kind.material);
                }
                if has_uvs {
                    let uv = |corner: usize| face_uvs.get(corner).map_or(DVec2::ZERO, |&uv| uvs[uv as usize]);
                    mesh_uvs.push(triangle.map(uv));
                }
                if has_normals {
                    mesh.corner.normals.push(match kind.has_normals {
                        true => triangle.map(|corner| normals[face_normals[corner] as usize]),
                        false => [triangle_normal(corners.map(|vertex| positions[vertex as usize])); 3],
                    });
                }
            };
            if kind.size == 3 {
                push([0, 1, 2]);
            } else {
                polygon.clear();
                polygon.extend(face.iter().map(|&vertex| positions[vertex as usize]));
                triangulate(&polygon, push);
            }
        }
    }
    if has_uvs {
        mesh.corner.uvs.push(mesh_uvs);
    }
    if has_materials {
        mesh.materials = contents.materials;
    }
    mesh.positions = positions;
    mesh.vertex.colors = contents.colors;
    mesh.assets.material_libraries = contents.libraries;
    mesh
}

/// The first `count` numbers, which are left out of the rest.
fn take<'a>(numbers: &mut &'a [u32], count: usize) -> &'a [u32] {
    let (taken, rest) = numbers.split_at(count);
    *numbers = rest;
    taken
}
