//! Conversion of a mesh with attributes at corners to a surface with render vertices.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use isochore_mesh::{EditMesh, NONE, Origin, SurfaceTree, TriMesh, next_half_edge};

use super::{
    NormalWeights, OpenError,
    surface::{Patch, RenderVertex, Surface},
};

impl Surface {
    /// Builds the surface of `mesh`.
    pub(super) fn open(mesh: Arc<TriMesh>, weights: NormalWeights) -> Result<Self, OpenError> {
        mesh.check_valid()?;
        check_attributes(&mesh)?;
        let topology = EditMesh::new(&mesh.triangles, mesh.positions.len())?;
        let tree = SurfaceTree::new(&mesh.positions, &mesh.triangles)?;
        let (corners, render) = render_vertices(&mesh);
        let patches = (0..mesh.triangles.len() as u32)
            .map(|parent| Patch { parent, hard: hard_edges(&mesh, &topology, parent) })
            .collect();
        Ok(Self::new(mesh, topology, corners, patches, render, tree, weights))
    }
}

fn check_attributes(mesh: &TriMesh) -> Result<(), OpenError> {
    let (triangles, vertices) = (mesh.triangles.len(), mesh.positions.len());
    let uvs = mesh.corner.uvs.iter().map(|set| ("texture coordinates", set.len(), triangles, false));
    let others = [
        ("corner normals", mesh.corner.normals.len(), triangles, true),
        ("corner colors", mesh.corner.colors.len(), triangles, true),
        ("vertex colors", mesh.vertex.colors.len(), vertices, true),
        ("skin influences", mesh.vertex.skin.len(), vertices, true),
        ("triangle materials", mesh.triangle_materials.len(), triangles, true),
    ];
    for (attribute, found, expected, is_optional) in uvs.chain(others) {
        if found != expected && !(is_optional && found == 0) {
            return Err(OpenError::AttributeCount { attribute, found, expected });
        }
    }
    Ok(())
}

/// Cosine of the angle up to which two shading normals count as equal, a fortieth of a degree. A
/// larger angle smooths creases that were set by hand; a smaller angle breaks the shading of files
/// that round their normals, to four digits or the last bit.
const SAME_NORMAL: f64 = 1.0 - 1e-7;

fn is_same_normal(one: Vec3, other: Vec3) -> bool {
    let (a, b) = (one.as_dvec3(), other.as_dvec3());
    one == other || a.dot(b) > SAME_NORMAL * a.length() * b.length()
}

/// Whether two corners of the mesh, given as triangle and side, have the same attributes: normals
/// up to rounding, others bit for bit.
pub(super) fn is_same_corner(mesh: &TriMesh, [one, other]: [(u32, usize); 2]) -> bool {
    let [(a, i), (b, j)] = [one, other].map(|(triangle, side)| (triangle as usize, side));
    let corner = &mesh.corner;
    corner.uvs.iter().all(|set| set[a][i].to_array().map(f32::to_bits) == set[b][j].to_array().map(f32::to_bits))
        && (corner.normals.is_empty() || is_same_normal(corner.normals[a][i], corner.normals[b][j]))
        && (corner.colors.is_empty()
            || corner.colors[a][i].to_array().map(f64::to_bits) == corner.colors[b][j].to_array().map(f64::to_bits))
}

/// One render vertex for each distinct corner at a vertex. The first one of a vertex has the number
/// of the vertex; the others follow.
fn render_vertices(mesh: &TriMesh) -> (Vec<[u32; 3]>, Vec<RenderVertex>) {
    let mut render: Vec<RenderVertex> =
        (0..mesh.positions.len() as u32).map(|vertex| RenderVertex { vertex, origin: None }).collect();
    // Linked lists: for each render vertex, the next one of the same vertex.
    let mut following = vec![NONE; render.len()];
    let mut corner = |triangle: u32, side: usize| {
        let vertex = mesh.triangles[triangle as usize][side];
        let weights = [DVec3::X, DVec3::Y, DVec3::Z][side];
        let origin = Origin { triangle, weights };
        let mut index = vertex;
        loop {
            match render[index as usize].origin {
                None => {
                    render[index as usize].origin = Some(origin);
                    return index;
                }
                Some(known)
                    if is_same_corner(mesh, [(known.triangle, known.weights.max_position()), (triangle, side)]) =>
                {
                    return index;
                }
                Some(_) if following[index as usize] == NONE => {
                    let added = render.len() as u32;
                    following[index as usize] = added;
                    following.push(NONE);
                    render.push(RenderVertex { vertex, origin: Some(origin) });
                    return added;
                }
                Some(_) => index = following[index as usize],
            }
        }
    };
    let corners =
        (0..mesh.triangles.len() as u32).map(|triangle| [0, 1, 2].map(|side| corner(triangle, side))).collect();
    (corners, render)
}

/// The edges of a triangle across which the shading normals of the mesh are discontinuous, as bits.
fn hard_edges(mesh: &TriMesh, topology: &EditMesh, triangle: u32) -> u8 {
    let normals = &mesh.corner.normals;
    if normals.is_empty() {
        return 0;
    }
    let normal = |half_edge: u32| normals[half_edge as usize / 3][half_edge as usize % 3];
    let is_hard = |side: &u32| {
        let half_edge = 3 * triangle + side;
        let twin = topology.twin(half_edge);
        let ahead = |half_edge: u32| normal(next_half_edge(half_edge));
        let is_same = |[one, other]: [Vec3; 2]| is_same_normal(one, other);
        twin != NONE && ![[normal(half_edge), ahead(twin)], [ahead(half_edge), normal(twin)]].into_iter().all(is_same)
    };
    (0..3).filter(is_hard).fold(0, |bits, side| bits | 1 << side)
}
