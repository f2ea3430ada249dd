//! Reading OBJ.

use std::fmt::Write;
use std::io::Read;
use std::path::Path;

use glam::{DVec2, DVec3};

use super::fault::check_lines;
use super::statements::{FaceRun, Statements};
use crate::TriMesh;
use crate::io::ParseError;
use crate::io::polygon::triangulate;
use crate::measure::triangle_normal;

/// Reads OBJ: `v` with optional color, `vt`, `vn`, `f`, `usemtl` and `mtllib`; other statements are passed over.
///
/// Faces may refer to vertices that come later. Vertices keep their order, used or not, except that those which the file
/// splits along seams are welded.
pub(in crate::io) fn parse(bytes: &[u8]) -> Result<TriMesh, ParseError> {
    let statements = Statements::of(bytes);
    if statements.is_suspect {
        check_lines(bytes, statements.counts)?;
    }
    let problem = match load(&statements) {
        Ok(faces) if is_sound(&faces, &statements) => return Ok(into_mesh(&faces, statements).welded_at_boundary()),
        Ok(_) => "a face or a number is broken".into(),
        Err(error) => error.to_string(),
    };
    check_lines(bytes, statements.counts)?;
    Err(ParseError::Malformed(problem))
}

/// All faces as one mesh of the library's, after a first face of all vertices.
fn load(statements: &Statements) -> Result<tobj::Mesh, tobj::LoadError> {
    // The library numbers vertices in the order of their use: after this face, in that of the file.
    let mut all_vertices = String::with_capacity(8 * statements.counts[0]);
    all_vertices.push('f');
    for vertex in 1..=statements.counts[0] {
        write!(all_vertices, " {vertex}").expect("a string takes all that is written");
    }
    all_vertices.push('\n');
    let mut lines = all_vertices.as_bytes().chain(&statements.lines[..]);
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut lines, &tobj::LoadOptions::default(), no_materials)?;
    models.into_iter().next().map(|model| model.mesh).ok_or(tobj::LoadError::GenericFailure)
}

/// False where the library lets pass what the format forbids.
fn is_sound(faces: &tobj::Mesh, statements: &Statements) -> bool {
    let [_, uvs, normals] = statements.counts;
    let has_attributes = |run: &FaceRun| (!run.has_uvs || uvs > 0) && (!run.has_normals || normals > 0);
    let numbers = [&faces.positions, &faces.texcoords, &faces.normals];
    faces.face_arities.iter().skip(1).all(|&arity| arity >= 3)
        && statements.runs.iter().all(has_attributes)
        && numbers.into_iter().flatten().all(|number| number.is_finite())
}

fn into_mesh(faces: &tobj::Mesh, statements: Statements) -> TriMesh {
    let Statements { colors, runs, materials, libraries, .. } = statements;
    let positions: Vec<DVec3> = faces.positions.chunks_exact(3).map(DVec3::from_slice).collect();
    let uv = |corner: usize| DVec2::from_slice(&faces.texcoords[2 * faces.texcoord_indices[corner] as usize..]);
    let normal = |corner: usize| DVec3::from_slice(&faces.normals[3 * faces.normal_indices[corner] as usize..]);
    // Without a `usemtl` there is only the unnamed material that faces before one get.
    let has_materials = materials.iter().any(|name| !name.is_empty());
    let has_uvs = runs.iter().any(|run| run.has_uvs);
    let has_normals = runs.iter().any(|run| run.has_normals);

    let mut mesh = TriMesh::default();
    let mut uvs = Vec::new();
    let mut polygon = Vec::new();
    // No arities stand for nothing but triangles; the first ones are those of the face of all vertices.
    let mut arities = faces.face_arities.iter().skip(1);
    let mut start = positions.len();
    mesh.triangles.reserve((faces.indices.len() - start) / 3);
    for run in &runs {
        for _ in 0..run.faces {
            let corners = start..start + arities.next().map_or(3, |&arity| arity as usize);
            start = corners.end;
            let vertices = &faces.indices[corners.clone()];
            polygon.clear();
            polygon.extend(vertices.iter().map(|&vertex| positions[vertex as usize]));
            triangulate(&polygon, |triangle| {
                mesh.triangles.push(triangle.map(|corner| vertices[corner]));
                if has_materials {
                    mesh.triangle_materials.push(run.material);
                }
                if has_uvs {
                    let uv = |corner| if run.has_uvs { uv(corners.start + corner) } else { DVec2::ZERO };
                    uvs.push(triangle.map(uv));
                }
                if has_normals {
                    mesh.corner.normals.push(match run.has_normals {
                        true => triangle.map(|corner| normal(corners.start + corner)),
                        false => [triangle_normal(triangle.map(|corner| polygon[corner])); 3],
                    });
                }
            });
        }
    }
    if has_uvs {
        mesh.corner.uvs.push(uvs);
    }
    if has_materials {
        mesh.materials = materials;
    }
    mesh.positions = positions;
    mesh.vertex.colors = colors;
    mesh.assets.material_libraries = libraries;
    mesh
}
