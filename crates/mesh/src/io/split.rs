//! Vertices split at seams, for formats whose vertices carry all attributes.

use crate::TriMesh;

/// A vertex for every combination of corner attributes that it has.
#[derive(Debug, Clone)]
pub struct SplitVertices {
    /// The vertex of the mesh that each split one comes from. The first ones are the mesh's own, in their order.
    pub vertices: Vec<u32>,
    /// Triangles of split vertices.
    pub triangles: Vec<[u32; 3]>,
    /// A corner, as `3 t + k`, that uses each split vertex; none where no triangle does.
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
        // Variants of a vertex form a chain; `next` leads from each to the following one.
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

    /// Values of a corner attribute by split vertex; `unused` for those of no triangle.
    pub(super) fn values<'a, T: Copy + 'a>(&'a self, corners: &'a [[T; 3]], unused: T) -> impl Iterator<Item = T> + 'a {
        self.corners.iter().map(move |corner| match corner {
            Some(corner) => corners[*corner as usize / 3][*corner as usize % 3],
            None => unused,
        })
    }
}

/// True where two corners carry the same.
fn agree(mesh: &TriMesh, a: u32, b: u32) -> bool {
    fn same<T: PartialEq>(corners: &[[T; 3]], a: u32, b: u32) -> bool {
        let at = |corner: u32| &corners[corner as usize / 3][corner as usize % 3];
        corners.is_empty() || at(a) == at(b)
    }
    let corner = &mesh.corner;
    same(&corner.normals, a, b) && same(&corner.colors, a, b) && corner.uvs.iter().all(|set| same(set, a, b))
}
