//! Attributes of a finer tessellation, interpolated once from the original mesh.

use std::ops::{Add, Mul};

use glam::{DVec3, Vec2, Vec3};

use crate::{CornerAttributes, TriMesh, VertexAttributes};

/// A finer tessellation of a mesh: its triangles, each inside one triangle of the original.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Subdivision {
    /// Positions of all vertices; those of the original come first, unchanged.
    pub positions: Vec<DVec3>,
    /// The triangles.
    pub triangles: Vec<SubTriangle>,
}

/// One triangle of a [`Subdivision`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubTriangle {
    /// Indices into the positions of the subdivision.
    pub vertices: [u32; 3],
    /// The original triangle that holds this one.
    pub parent: u32,
    /// Barycentric coordinates of the three corners in the parent.
    pub corners: [DVec3; 3],
}

impl TriMesh {
    /// This mesh with the positions and triangles of `subdivision`, and its own attributes interpolated onto them.
    ///
    /// Every attribute is interpolated once, in the original triangle that holds the corner. Shading normals and skin
    /// weights are made unit again, and no vertex gets more skin influences than the vertex of this mesh that has most.
    /// Attributes of original vertices and materials are kept as they are. Equal values on the two sides of an original
    /// edge stay equal, so no seam opens.
    ///
    /// # Panics
    /// If the subdivision names a parent that this mesh does not have, or a vertex that it does not have itself.
    pub fn subdivided(&self, subdivision: &Subdivision) -> TriMesh {
        let children = &subdivision.triangles;
        let materials = &self.triangle_materials;
        TriMesh {
            positions: subdivision.positions.clone(),
            triangles: children.iter().map(|child| child.vertices).collect(),
            corner: CornerAttributes {
                uvs: self.corner.uvs.iter().map(|set| interpolate_corners(set, children, interpolate_uv)).collect(),
                normals: interpolate_corners(&self.corner.normals, children, interpolate_normal),
                colors: interpolate_corners(&self.corner.colors, children, interpolate),
            },
            vertex: self.subdivided_vertices(subdivision),
            triangle_materials: match materials.is_empty() {
                true => Vec::new(),
                false => children.iter().map(|child| materials[child.parent as usize]).collect(),
            },
            materials: self.materials.clone(),
            assets: self.assets.clone(),
        }
    }

    fn subdivided_vertices(&self, subdivision: &Subdivision) -> VertexAttributes {
        let VertexAttributes { mut colors, mut skin } = self.vertex.clone();
        let original = self.positions.len();
        if colors.is_empty() && skin.is_empty() {
            return VertexAttributes { colors, skin };
        }
        let most_influences = skin.iter().map(Vec::len).max().unwrap_or(0);
        // A new vertex takes its attributes from the first triangle that uses it; the others would agree up to rounding.
        let mut origins = vec![None; subdivision.positions.len().saturating_sub(original)];
        for child in &subdivision.triangles {
            for (&vertex, &weights) in child.vertices.iter().zip(&child.corners) {
                if let Some(new) = (vertex as usize).checked_sub(original) {
                    origins[new].get_or_insert((child.parent, weights));
                }
            }
        }
        for origin in origins {
            // A new vertex that no triangle uses has nothing to take attributes from.
            let parent = origin.map(|(parent, weights)| (self.triangles[parent as usize].map(|v| v as usize), weights));
            if !colors.is_empty() {
                let color = parent.map(|(corners, weights)| interpolate(&corners.map(|v| colors[v]), weights));
                colors.push(color.unwrap_or_default());
            }
            if !skin.is_empty() {
                let influences = parent.map(|(corners, weights)| {
                    interpolate_influences(corners.map(|v| skin[v].as_slice()), weights, most_influences)
                });
                skin.push(influences.unwrap_or_default());
            }
        }
        VertexAttributes { colors, skin }
    }
}

/// Barycentric combination. Corners of weight zero are left out, so that a value on an edge depends on that edge alone
/// and has the same bits seen from both of its triangles.
pub(super) fn interpolate<T>(corners: &[T; 3], weights: DVec3) -> T
where
    T: Copy + Default + PartialEq + Add<Output = T> + Mul<f64, Output = T>,
{
    let mut sum = None;
    for (&corner, weight) in corners.iter().zip(weights.to_array()) {
        if weight == 1.0 {
            return corner;
        }
        if weight != 0.0 {
            sum = Some(sum.map_or(corner * weight, |sum| sum + corner * weight));
        }
    }
    sum.unwrap_or_default()
}

fn interpolate_corners<T>(
    values: &[[T; 3]],
    children: &[SubTriangle],
    interpolate: impl Fn(&[T; 3], DVec3) -> T,
) -> Vec<[T; 3]> {
    if values.is_empty() {
        return Vec::new();
    }
    let at = |child: &SubTriangle| child.corners.map(|weights| interpolate(&values[child.parent as usize], weights));
    children.iter().map(at).collect()
}

/// Texture coordinates between three, rounded once.
pub(super) fn interpolate_uv(corners: &[Vec2; 3], weights: DVec3) -> Vec2 {
    interpolate(&corners.map(|uv| uv.as_dvec2()), weights).as_vec2()
}

/// The unit normal between three; where they cancel, that of the heaviest corner, which is as good as any.
pub(super) fn interpolate_normal(corners: &[Vec3; 3], weights: DVec3) -> Vec3 {
    if let Some(kept) = weights.to_array().iter().position(|&weight| weight == 1.0) {
        return corners[kept];
    }
    let between = interpolate(&corners.map(|normal| normal.as_dvec3()), weights).try_normalize();
    between.map_or(corners[weights.max_position()], |normal| normal.as_vec3())
}

pub(super) fn interpolate_influences(corners: [&[(u32, f64)]; 3], weights: DVec3, most: usize) -> Vec<(u32, f64)> {
    let mut influences: Vec<(u32, f64)> = Vec::with_capacity(3 * most);
    for (corner, weight) in corners.into_iter().zip(weights.to_array()) {
        for &(joint, influence) in corner {
            match influences.iter_mut().find(|(known, _)| *known == joint) {
                Some((_, sum)) => *sum += weight * influence,
                None => influences.push((joint, weight * influence)),
            }
        }
    }
    influences.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    influences.truncate(most);
    let total: f64 = influences.iter().map(|(_, weight)| weight).sum();
    if total > 0.0 {
        influences.iter_mut().for_each(|(_, weight)| *weight /= total);
    }
    influences
}
