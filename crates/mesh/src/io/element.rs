//! Elements that a file could do without: one rule for all formats.
//!
//! A reader refuses a file only for positions that are not finite and for indices out of range.
//! It leaves out faces without area by their indices, and attributes that are not finite, counts
//! them, and notes the counts.

use glam::{DVec4, Vec2};

use crate::TriMesh;
use crate::measure::triangle_normal;

/// Collects the corners of a face that differ from the previous one, as positions in `corners`.
/// Returns `false` if fewer than three remain, so that the face must be left out.
pub(super) fn distinct_corners(corners: &[u32], kept: &mut Vec<usize>) -> bool {
    kept.clear();
    for (at, corner) in corners.iter().enumerate() {
        if kept.last().is_none_or(|&last| corners[last] != *corner) {
            kept.push(at);
        }
    }
    while kept.len() > 1 && corners[kept[0]] == corners[kept[kept.len() - 1]] {
        kept.pop();
    }
    kept.len() >= 3
}

/// Whether [`distinct_corners`] would change anything.
pub(super) fn has_repeated_corner(corners: &[u32]) -> bool {
    corners.len() < 3 || corners.first() == corners.last() || corners.array_windows().any(|[a, b]| a == b)
}

/// Whether a triangle has three vertices. A polygon that visits a vertex twice may be split into
/// triangles that do not.
pub(super) fn is_triangle<T: PartialEq>([a, b, c]: &[T; 3]) -> bool {
    a != b && b != c && c != a
}

/// Faces that were left out or changed.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Dropped {
    /// Faces with fewer than three distinct corners.
    pub(super) faces: usize,
    /// Faces that lost a repeated corner.
    pub(super) corners: usize,
}

impl Dropped {
    pub(super) fn note(self, mesh: &mut TriMesh) {
        note(mesh, self.faces, "with fewer than three distinct corners left out", ["face", "faces"]);
        note(mesh, self.corners, "with a repeated corner, which was left out", ["face", "faces"]);
    }
}

fn note(mesh: &mut TriMesh, count: usize, what: &str, [one, several]: [&str; 2]) {
    if count > 0 {
        mesh.assets.notes.push(format!("{count} {} {what}", if count == 1 { one } else { several }));
    }
}

/// Replaces attributes that are not finite and notes how many: normals by those of their triangles,
/// texture coordinates by zero, colors by white. Skin weights that are not finite are left out.
///
/// `has_finite_corners` skips the corners, which the reader has checked.
pub(super) fn mend_attributes(mesh: &mut TriMesh, has_finite_corners: bool) {
    if !has_finite_corners {
        mend_corners(mesh);
    }
    let colors = replace(&mut mesh.vertex.colors, |color| color.is_finite(), |_| DVec4::ONE);
    note(mesh, colors, "replaced by white", ["non-finite color", "non-finite colors"]);
    let mut weights = 0;
    for skin in &mut mesh.vertex.skin {
        let before = skin.len();
        skin.retain(|(_, weight)| weight.is_finite());
        weights += before - skin.len();
    }
    note(mesh, weights, "left out", ["non-finite skin weight", "non-finite skin weights"]);
}

fn mend_corners(mesh: &mut TriMesh) {
    let uvs: usize = mesh
        .corner
        .uvs
        .iter_mut()
        .map(|set| replace(set.as_flattened_mut(), |uv| uv.is_finite(), |_| Vec2::ZERO))
        .sum();
    note(mesh, uvs, "of corners replaced by zero", ["non-finite texture coordinate", "non-finite texture coordinates"]);
    let colors = replace(mesh.corner.colors.as_flattened_mut(), |color| color.is_finite(), |_| DVec4::ONE);
    note(mesh, colors, "of corners replaced by white", ["non-finite color", "non-finite colors"]);
    let (positions, triangles) = (&mesh.positions, &mesh.triangles);
    let facet = |corner: usize| {
        let normal = triangle_normal(triangles[corner / 3].map(|vertex| positions[vertex as usize])).as_vec3();
        if normal.is_finite() { normal } else { glam::Vec3::ZERO }
    };
    let normals = replace(mesh.corner.normals.as_flattened_mut(), |normal| normal.is_finite(), facet);
    let what = "of corners replaced by those of their triangles";
    note(mesh, normals, what, ["non-finite normal", "non-finite normals"]);
}

/// Replaces values that are not fine and returns their number.
fn replace<T>(values: &mut [T], is_fine: impl Fn(&T) -> bool, new: impl Fn(usize) -> T) -> usize {
    let mut count = 0;
    for (at, value) in values.iter_mut().enumerate() {
        if !is_fine(value) {
            *value = new(at);
            count += 1;
        }
    }
    count
}
