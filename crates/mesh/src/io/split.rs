//! Vertices split at seams, for formats that store all attributes by vertex.

use crate::TriMesh;

/// A mesh with one vertex for every combination of attributes that the corners at a vertex have.
///
/// ```
/// use glam::Vec2;
/// use isochore_mesh::{io::SplitVertices, primitives};
///
/// let mut mesh = primitives::icosphere(1.0, 0);
/// assert_eq!(SplitVertices::of(&mesh).vertices.len(), 12);
/// // Texture coordinates that differ at every corner split all vertices.
/// let uv = |corner: usize| Vec2::new(corner as f32, 0.0);
/// mesh.corner.uvs = vec![(0..20).map(|triangle| [0, 1, 2].map(|k| uv(3 * triangle + k))).collect()];
/// assert_eq!(SplitVertices::of(&mesh).vertices.len(), 60);
/// ```
#[derive(Debug, Clone)]
pub struct SplitVertices {
    /// The original vertex of each split vertex. The first ones are the original vertices in their
    /// order.
    pub vertices: Vec<u32>,
    /// Triangles of split vertices.
    pub triangles: Vec<[u32; 3]>,
    /// A corner `3 t + k` at each split vertex. `None` for a vertex without triangles.
    corners: Vec<Option<u32>>,
}

impl SplitVertices {
    /// Splits the vertices of `mesh` where the corners at them carry different attributes.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn of(mesh: &TriMesh) -> Self {
        let count = mesh.positions.len();
        let mut split = Self {
            vertices: (0..count as u32).collect(),
            triangles: mesh.triangles.clone(),
            corners: vec![None; count],
        };
        // The variants of a vertex form a linked list.
        let mut next: Vec<Option<u32>> = vec![None; count];
        for corner in 0..3 * mesh.triangles.len() as u32 {
            let (triangle, side) = (corner as usize / 3, corner as usize % 3);
            let mut variant = mesh.triangles[triangle][side];
            loop {
                match split.corners[variant as usize] {
                    None => {
                        split.corners[variant as usize] = Some(corner);
                        break;
                    }
                    Some(other) if agree(mesh, corner, other) => break,
                    Some(_) => {}
                }
                variant = match next[variant as usize] {
                    Some(following) => following,
                    None => {
                        let new = split.vertices.len() as u32;
                        next[variant as usize] = Some(new);
                        next.push(None);
                        split.vertices.push(mesh.triangles[triangle][side]);
                        split.corners.push(None);
                        new
                    }
                };
            }
            split.triangles[triangle][side] = variant;
        }
        split
    }

    /// Values of a corner attribute by split vertex; `unused` for a vertex without triangles.
    pub(super) fn values<'a, T: Copy + 'a>(&'a self, corners: &'a [[T; 3]], unused: T) -> impl Iterator<Item = T> + 'a {
        self.corners.iter().map(move |corner| match corner {
            Some(corner) => corners[*corner as usize / 3][*corner as usize % 3],
            None => unused,
        })
    }
}

/// Whether two corners have the same attributes.
fn agree(mesh: &TriMesh, a: u32, b: u32) -> bool {
    fn same<T: PartialEq>(corners: &[[T; 3]], a: u32, b: u32) -> bool {
        let at = |corner: u32| &corners[corner as usize / 3][corner as usize % 3];
        corners.is_empty() || at(a) == at(b)
    }
    let corner = &mesh.corner;
    same(&corner.normals, a, b) && same(&corner.colors, a, b) && corner.uvs.iter().all(|set| same(set, a, b))
}
