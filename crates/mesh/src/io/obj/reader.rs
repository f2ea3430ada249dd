//! Reading OBJ.

use std::io::{BufRead, Read};
use std::iter::repeat_n;
use std::path::Path;

use glam::{DVec2, DVec3, DVec4, Vec2};

use super::fault::check_lines;
use super::lines::{Kept, Lines, split_vertex};
use super::statement::Statements;
use crate::TriMesh;
use crate::huge_pages::in_huge_pages;
use crate::io::ParseError;
use crate::io::element::{Dropped, is_triangle};
use crate::io::polygon::triangulate;
use crate::io::text::{decode, push_index};
use crate::measure::triangle_normal;

/// Faces per object for the library. Its tables for much larger objects exceed the cache; with much
/// smaller ones, vertices are repeated in many objects.
const OBJECT_SIZE: usize = 1 << 13;

/// Reads OBJ: `v` with optional color, `vt`, `vn`, `f`, `usemtl` and `mtllib`. Other statements are
/// ignored.
///
/// Faces may refer to later vertices. Vertices keep their order, used or not, except that vertices
/// split along seams are welded.
pub(in crate::io) fn parse(bytes: &[u8]) -> Result<TriMesh, ParseError> {
    let text = decode(bytes)?;
    let bytes = &text[..];
    // References to later elements can be resolved only if the whole file is read as one object.
    let read = read_objects(bytes, OBJECT_SIZE, false);
    let read = read.or_else(|_| read_objects(bytes, usize::MAX, false));
    // Only then are the numbers looked at one by one, which takes longer.
    match read.or_else(|_| read_objects(bytes, usize::MAX, true)) {
        Ok((mesh, dropped)) => {
            let mut mesh = mesh.welded_at_boundary();
            dropped.note(&mut mesh);
            Ok(mesh)
        }
        Err(problem) => {
            check_lines(bytes)?;
            Err(ParseError::Malformed(problem.to_string()))
        }
    }
}

fn read_objects(bytes: &[u8], object_size: usize, is_tolerant: bool) -> Result<(TriMesh, Dropped), tobj::LoadError> {
    let mut lines = Lines::new(bytes, object_size, is_tolerant);
    let objects = load(&mut lines)?;
    let mut kept = lines.kept;
    if !kept.colors.is_empty() {
        kept.colors.resize(kept.counts[0], DVec4::ONE);
    }
    let positions = positions(bytes, &objects, &kept)?;
    if !is_sound(&objects, &positions) || (kept.has_uneven_faces && check_lines(bytes).is_err()) {
        return Err(tobj::LoadError::GenericFailure);
    }
    let dropped = kept.dropped;
    let mesh = into_mesh(positions, &objects, kept).ok_or(tobj::LoadError::GenericFailure)?;
    Ok((mesh, dropped))
}

fn load(lines: &mut impl BufRead) -> Result<Vec<tobj::Mesh>, tobj::LoadError> {
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(lines, &tobj::LoadOptions::default(), no_materials)?;
    Ok(models.into_iter().map(|model| model.mesh).collect())
}

/// All positions in the order of the file.
fn positions(bytes: &[u8], objects: &[tobj::Mesh], kept: &Kept) -> Result<Vec<DVec3>, tobj::LoadError> {
    let count = kept.counts[0];
    let mut positions = in_huge_pages(Vec::with_capacity(count));
    positions.resize(count, DVec3::NAN);
    let mut corners = kept.corners.iter();
    for object in objects {
        let known = object.positions.as_chunks().0;
        for (&index, &vertex) in object.indices.iter().zip(&mut corners) {
            let position = positions.get_mut(vertex as usize).ok_or(tobj::LoadError::FaceVertexOutOfBounds)?;
            *position = DVec3::from_array(known[index as usize]);
        }
    }
    let is_missing = |&vertex: &u32| positions[vertex as usize].is_nan();
    let missing: Vec<u32> = (0..count as u32).filter(is_missing).collect();
    if !missing.is_empty() {
        let found = positions_of(&missing, bytes)?;
        missing.iter().zip(found).for_each(|(&vertex, position)| positions[vertex as usize] = position);
    }
    Ok(positions)
}

/// The positions of vertices that no face uses, which the library drops. One artificial face of all
/// of them makes the library parse them.
fn positions_of(vertices: &[u32], bytes: &[u8]) -> Result<Vec<DVec3>, tobj::LoadError> {
    let (mut lines, mut face) = (Vec::new(), b"f".to_vec());
    let mut unused = vertices.iter().zip(1..).peekable();
    let statements = Statements::of(bytes).filter(|statement| statement.keyword() == b"v");
    for (statement, vertex) in statements.zip(0..) {
        if let Some((_, index)) = unused.next_if(|&(&unused, _)| unused == vertex) {
            let plain = statement.plain();
            let (position, _) = split_vertex(&plain).map_err(|_| tobj::LoadError::PositionParseError)?;
            lines.extend_from_slice(position);
            lines.push(b'\n');
            face.push(b' ');
            push_index(&mut face, index);
        }
    }
    let objects = load(&mut (&lines[..]).chain(&face[..]))?;
    let positions = objects.iter().flat_map(|object| object.positions.as_chunks().0);
    Ok(positions.copied().map(DVec3::from_array).collect())
}

/// Checks what the library accepts although the format forbids it.
fn is_sound(objects: &[tobj::Mesh], positions: &[DVec3]) -> bool {
    let is_polygon = |object: &tobj::Mesh| object.face_arities.iter().all(|&arity| arity >= 3);
    positions.iter().all(|position| position.is_finite()) && objects.iter().all(is_polygon)
}

/// Assembles the mesh. `None` if an object lacks attributes that its faces name, because they come
/// later or are missing.
fn into_mesh(positions: Vec<DVec3>, objects: &[tobj::Mesh], kept: Kept) -> Option<TriMesh> {
    // Without a `usemtl` the only material is the unnamed one of faces before a `usemtl`.
    let has_materials = kept.materials.iter().any(|name| !name.is_empty());
    let has_uvs = kept.runs.iter().any(|(kind, _)| kind.has_uvs);
    let has_normals = kept.runs.iter().any(|(kind, _)| kind.has_normals);
    let triangles = objects.iter().flat_map(sizes).map(|size| size - 2).sum();

    let mut mesh = TriMesh::new(Vec::new(), in_huge_pages(Vec::with_capacity(triangles)));
    let mut uvs = in_huge_pages(Vec::with_capacity(if has_uvs { triangles } else { 0 }));
    mesh.corner.normals = in_huge_pages(Vec::with_capacity(if has_normals { triangles } else { 0 }));
    let mut polygon = Vec::new();
    let mut kinds = kept.runs.iter().flat_map(|&(kind, faces)| repeat_n(kind, faces));
    let mut vertices = &kept.corners[..];
    for object in objects {
        let uv = |corner: usize| {
            DVec2::from_slice(&object.texcoords[2 * object.texcoord_indices[corner] as usize..]).as_vec2()
        };
        let normal =
            |corner: usize| DVec3::from_slice(&object.normals[3 * object.normal_indices[corner] as usize..]).as_vec3();
        let mut start = 0;
        for (size, kind) in sizes(object).zip(&mut kinds) {
            let lacks_uvs = kind.has_uvs && object.texcoord_indices.is_empty();
            if lacks_uvs || (kind.has_normals && object.normal_indices.is_empty()) {
                return None;
            }
            let (corners, others) = vertices.split_at_checked(size)?;
            vertices = others;
            let mut push = |triangle: [usize; 3]| {
                let vertices = triangle.map(|corner| corners[corner]);
                if !is_triangle(&vertices) {
                    return;
                }
                mesh.triangles.push(vertices);
                if has_materials {
                    mesh.triangle_materials.push(kind.material);
                }
                if has_uvs {
                    uvs.push(triangle.map(|corner| if kind.has_uvs { uv(start + corner) } else { Vec2::ZERO }));
                }
                if has_normals {
                    mesh.corner.normals.push(if kind.has_normals {
                        triangle.map(|corner| normal(start + corner))
                    } else {
                        [triangle_normal(vertices.map(|vertex| positions[vertex as usize])).as_vec3(); 3]
                    });
                }
            };
            if size == 3 {
                push([0, 1, 2]);
            } else {
                polygon.clear();
                polygon.extend(corners.iter().map(|&vertex| positions[vertex as usize]));
                triangulate(&polygon, push);
            }
            start += size;
        }
    }
    if has_uvs {
        mesh.corner.uvs.push(uvs);
    }
    if has_materials {
        mesh.materials = kept.materials;
    }
    mesh.positions = positions;
    mesh.vertex.colors = kept.colors;
    mesh.assets.material_libraries = kept.libraries;
    mesh.assets.raw_names = kept.names.0;
    Some(mesh)
}

/// The number of corners of each face of an object.
fn sizes(object: &tobj::Mesh) -> impl Iterator<Item = usize> {
    // The library leaves the list empty if all faces are triangles.
    let triangles = if object.face_arities.is_empty() { object.indices.len() / 3 } else { 0 };
    object.face_arities.iter().map(|&size| size as usize).chain(repeat_n(3, triangles))
}
