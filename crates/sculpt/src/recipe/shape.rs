//! Shapes of targets and tools.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{tagged::tagged, transform::Transform};

/// Generated target, centered on the origin.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum TargetShape {
    /// Icosahedron subdivided towards a sphere, with triangles of nearly equal size.
    Icosphere(Icosphere),
    /// Box with a regular grid on every face.
    Box(BoxMesh),
    /// Sphere with poles on the z axis, divided along meridians and parallels.
    Sphere(SphereMesh),
}

tagged!(TargetShape { "icosphere" => Icosphere(Icosphere), "box" => Box(BoxMesh), "sphere" => Sphere(SphereMesh) });

/// See [`TargetShape::Icosphere`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Icosphere {
    /// Distance of the vertices from the origin, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// Number n of times that each triangle is split into four; 20 · 4ⁿ triangles.
    pub subdivisions: u32,
}

/// See [`TargetShape::Box`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxMesh {
    /// Half the edge lengths along x, y and z, model units.
    pub half_extents: [f64; 3],
    /// Cells along x, y and z.
    pub segments: [u32; 3],
}

/// See [`TargetShape::Sphere`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereMesh {
    /// Distance of the vertices from the origin, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// Cells around the equator, and from pole to pole.
    pub segments: [u32; 2],
}

/// Solid that a tool's field surrounds, in tool coordinates.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ToolShape {
    /// Ball around the origin.
    Sphere(Sphere),
    /// All points near a segment of the z axis.
    Capsule(Capsule),
    /// Box around the origin, with optional rounded edges.
    Box(RoundedBox),
    /// Torus around the z axis.
    Torus(Torus),
    /// Ellipsoid around the origin.
    Ellipsoid(Ellipsoid),
    /// Inside of a mesh.
    Mesh(MeshTool),
    /// A shape of the program that made the recipe. A recipe cannot describe it; the program supplies the tool to replay it.
    Host(HostShape),
}

tagged!(ToolShape {
    "sphere" => Sphere(Sphere),
    "capsule" => Capsule(Capsule),
    "box" => Box(RoundedBox),
    "torus" => Torus(Torus),
    "ellipsoid" => Ellipsoid(Ellipsoid),
    "mesh" => Mesh(MeshTool),
    "host" => Host(HostShape),
});

/// See [`ToolShape::Sphere`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    /// Radius, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
}

/// See [`ToolShape::Capsule`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Capsule {
    /// Distance of the surface from the segment, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// The segment runs from `-half_length` to `half_length`, model units.
    pub half_length: f64,
}

/// See [`ToolShape::Box`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RoundedBox {
    /// Half the edge lengths including the rounding, model units.
    pub half_extents: [f64; 3],
    /// Radius of the edges, model units.
    #[serde(default, skip_serializing_if = "super::defaults::is_default")]
    pub rounding: f64,
}

/// See [`ToolShape::Torus`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Torus {
    /// Radius of the ring's center line, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub major: f64,
    /// Distance of the surface from that line, model units.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub minor: f64,
}

/// See [`ToolShape::Ellipsoid`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ellipsoid {
    /// Half axes along x, y and z, model units.
    pub radii: [f64; 3],
}

/// See [`ToolShape::Mesh`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshTool {
    /// Mesh file, relative to the recipe.
    pub mesh: String,
    /// Cells of the distance grid along the longest side of the mesh, without padding. The grid is
    /// finer if a cell would be longer than a tenth of the support.
    #[schemars(range(min = 4, max = 1024))]
    pub resolution: u32,
    /// Placement of the mesh in tool coordinates.
    #[serde(default, skip_serializing_if = "super::defaults::is_default")]
    pub transform: Transform,
}

/// See [`ToolShape::Host`]. The tool that the program supplies decides the field; the other keys of this entry are information only.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HostShape {}
