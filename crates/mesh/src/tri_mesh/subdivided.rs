//! Attributes of a finer tessellation, interpolated once from the original mesh.

use std::ops::{Add, Mul};

use glam::{DVec3, Vec2, Vec3};

use crate::{CornerAttributes, TriMesh, VertexAttributes};

/// A finer tessellation of a mesh, whose triangles are each inside one triangle of the original.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Subdivision {
    /// Positions of all vertices. The original ones come first, unchanged.
    pub positions: Vec<DVec3>,
    /// The triangles.
    pub triangles: Vec<SubTriangle>,
}

/// One triangle of a [`Subdivision`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubTriangle {
    /// Indices into the positions of the subdivision.
    pub vertices: [u32; 3],
    /// The original triangle that contains this one.
    pub parent: u32,
    /// Barycentric coordinates of the three corners in the parent.
    pub corners: [DVec3; 3],
}

impl TriMesh {
    /// The subdivided mesh, with the attributes of this mesh interpolated onto it.
    ///
    /// Every attribute is interpolated once, in the original triangle that contains the corner.
    /// Shading normals and skin weights are normalized, and no vertex gets more skin influences
    /// than the maximum of this mesh. Attributes of original vertices and materials are unchanged.
    /// Equal values on the two sides of an original edge stay equal, so no seam opens.
    ///
    /// # Panics
    /// If the subdivision refers to a parent that this mesh does not have, or to a vertex out of
    /// range.
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
            triangle_materials: if materials.is_empty() {
                Vec::new()
            } else {
                children.iter().map(|child| materials[child.parent as usize]).collect()
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
        // A new vertex gets its attributes from the first triangle that uses it. Others agree up to
        // rounding.
        let mut origins = vec![None; subdivision.positions.len().saturating_sub(original)];
        for child in &subdivision.triangles {
            for (&vertex, &weights) in child.vertices.iter().zip(&child.corners) {
                if let Some(new) = (vertex as usize).checked_sub(original) {
                    origins[new].get_or_insert((child.parent, weights));
                }
            }
        }
        for origin in origins {
            // A new vertex without triangles gets default attributes.
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

/// Barycentric combination. Corners of weight zero are skipped, so that a value on an edge depends
/// only on that edge and has the same bits in both of its triangles.
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

/// Interpolated texture coordinates, rounded once.
pub(super) fn interpolate_uv(corners: &[Vec2; 3], weights: DVec3) -> Vec2 {
    interpolate(&corners.map(|uv| uv.as_dvec2()), weights).as_vec2()
}

/// The interpolated unit normal, or that of the corner of largest weight if the sum vanishes.
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
