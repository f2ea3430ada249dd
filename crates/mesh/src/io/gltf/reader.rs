//! Reading glTF.

use std::collections::BTreeMap;
use std::sync::Arc;

use ::gltf::json::mesh::{Mode, Primitive};
use ::gltf::json::validation::Checked;
use glam::{DMat3, DVec2, DVec3, DVec4, Vec2, Vec3};
use serde_json::Value;

use super::attributes::{Attributes, Column};
use super::document::{Document, malformed};
use super::scene::Instance;
use crate::io::by_corner::by_corner;
use crate::io::{ParseError, Resolve};
use crate::measure::triangle_normal;
use crate::{CornerAttributes, TriMesh, VertexAttributes};

/// Reads the scene of a document as one mesh; equal positions become one vertex. The flag is `true`
/// if all corner attributes are known to be finite.
pub(in crate::io) fn parse(bytes: &[u8], resolve: Resolve<'_>) -> Result<(TriMesh, bool), ParseError> {
    let document = Document::open(bytes, resolve)?;
    let instances = document.instances()?;
    let skin = common_skin(&instances);
    let mut soup = Soup::default();
    for instance in &instances {
        soup.add_instance(&document, instance, skin.is_some())?;
    }
    // Check the vertices, which are fewer than the corners. Normals computed from triangles must be
    // checked at the corners.
    let has_finite_corners = soup.has_finite_attributes() && !soup.lacks_normals();
    let uv_sets: Vec<u32> = soup.uvs.keys().copied().collect();
    let mut mesh = soup.into_mesh(&document.json).welded();
    mesh.assets.names = document.names(&instances);
    mesh.assets.gltf = document.carried_assets(skin, &uv_sets, resolve)?.map(Arc::new);
    Ok((mesh, has_finite_corners))
}

/// The skin that all instances have in common, if any.
fn common_skin(instances: &[Instance]) -> Option<usize> {
    let first = instances.first()?.skin;
    if instances.iter().all(|instance| instance.skin == first) { first } else { None }
}

/// Vertices with all their attributes, split at seams as in the file.
#[derive(Default)]
struct Soup {
    positions: Vec<DVec3>,
    /// Zero for vertices without a normal in the file.
    normals: Column<Vec3>,
    /// By the numbers of their sets.
    uvs: BTreeMap<u32, Column<Vec2>>,
    colors: Column<DVec4>,
    influences: Column<Vec<(u32, f64)>>,
    triangles: Vec<[u32; 3]>,
    materials: Column<Option<u32>>,
}

impl Soup {
    fn add_instance(
        &mut self,
        document: &Document<'_>,
        instance: &Instance,
        with_skin: bool,
    ) -> Result<(), ParseError> {
        let number = instance.mesh;
        let mesh = document.root.meshes.get(number);
        let mesh = mesh.ok_or_else(|| malformed(format!("mesh {number} does not exist")))?;
        // Primitives of several materials often share their vertices.
        let mut added: Vec<(Attributes, usize)> = Vec::new();
        for (index, primitive) in mesh.primitives.iter().enumerate() {
            let mode = match primitive.mode {
                Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
                Checked::Valid(_) => continue,
                Checked::Invalid => return Err(malformed(format!("mesh {number} has a primitive of unknown mode"))),
            };
            let attributes = Attributes::of(primitive);
            document.refuse_compressed(number, index, &attributes)?;
            let base = match added.iter().find(|(known, _)| *known == attributes) {
                Some(&(_, base)) => base,
                None => {
                    let base = self.positions.len();
                    self.add_vertices(document, &attributes, instance, with_skin)?;
                    added.push((attributes, base));
                    base
                }
            };
            let triangles = triangles(document, primitive, mode, self.positions.len() - base)?;
            self.add_triangles(triangles, base, primitive, instance)?;
        }
        Ok(())
    }

    fn add_vertices(
        &mut self,
        document: &Document<'_>,
        attributes: &Attributes,
        instance: &Instance,
        with_skin: bool,
    ) -> Result<(), ParseError> {
        let number = instance.mesh;
        let accessor = attributes.positions;
        let accessor = accessor.ok_or_else(|| malformed(format!("mesh {number} has a primitive without positions")))?;
        let to_world = instance.world_from_mesh;
        let is_in_place = to_world == glam::DMat4::IDENTITY;
        let positions: Vec<DVec3> = if is_in_place {
            // Adding zero removes negative zeros, as the transformation in the other branch does.
            document.vectors(accessor, |[x, y, z]| DVec3::new(x + 0.0, y + 0.0, z + 0.0))?
        } else {
            document.vectors(accessor, |position| to_world.transform_point3(position.into()))?
        };
        let base = self.positions.len();
        let count = positions.len();
        let expect = |found: usize| {
            if found == count {
                Ok(())
            } else {
                Err(malformed(format!("mesh {number} has {count} positions but {found} values of an attribute")))
            }
        };
        if base + count > u32::MAX as usize {
            return Err(malformed("the scene has more vertices than 32-bit indices can name"));
        }
        match base {
            0 => self.positions = positions,
            _ => self.positions.extend(positions),
        }
        if let Some(accessor) = attributes.normals {
            // Normals are covectors: they follow the inverse transpose, here up to a positive
            // factor.
            let linear = DMat3::from_mat4(to_world);
            let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
            let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * linear.determinant().signum();
            let turn = |normal| match DVec3::from_array(normal) {
                normal if is_in_place => normal.as_vec3(),
                normal => (cofactors * normal).normalize_or_zero().as_vec3(),
            };
            let normals = document.vectors(accessor, turn)?;
            expect(normals.len())?;
            self.normals.add(base, normals, Vec3::ZERO);
        }
        for (&set, &accessor) in &attributes.uvs {
            let uvs = document.vectors(accessor, |uv| DVec2::from_array(uv).as_vec2())?;
            expect(uvs.len())?;
            self.uvs.entry(set).or_default().add(base, uvs, Vec2::ZERO);
        }
        if let Some(accessor) = attributes.colors {
            let colors: Vec<DVec4> = match document.components(accessor)? {
                3 => document.vectors(accessor, |[r, g, b]| DVec4::new(r, g, b, 1.0))?,
                _ => document.vectors(accessor, DVec4::from_array)?,
            };
            expect(colors.len())?;
            self.colors.add(base, colors, DVec4::ONE);
        }
        if with_skin && !attributes.joints.is_empty() {
            let mut influences = vec![Vec::new(); count];
            for (&joints, &weights) in attributes.joints.iter().zip(&attributes.weights) {
                let joints: Vec<[f64; 4]> = document.vectors(joints, |joints| joints)?;
                let weights: Vec<[f64; 4]> = document.vectors(weights, |weights| weights)?;
                expect(joints.len())?;
                expect(weights.len())?;
                for ((influences, joints), weights) in influences.iter_mut().zip(joints).zip(weights) {
                    let used = joints.into_iter().zip(weights).filter(|&(_, weight)| weight > 0.0);
                    influences.extend(used.map(|(joint, weight)| (joint as u32, weight)));
                }
            }
            self.influences.add(base, influences, Vec::new());
        }
        Ok(())
    }

    fn add_triangles(
        &mut self,
        mut triangles: Vec<[u32; 3]>,
        base: usize,
        primitive: &Primitive,
        instance: &Instance,
    ) -> Result<(), ParseError> {
        let vertices = self.positions.len() - base;
        let corners = triangles.as_flattened();
        if corners.iter().fold(0, |largest, &index| index.max(largest)) as usize >= vertices
            && let Some(index) = corners.iter().find(|&&index| index as usize >= vertices)
        {
            let number = instance.mesh;
            return Err(malformed(format!("mesh {number} names vertex {index}, but the primitive has {vertices}")));
        }
        // Strips are joined by degenerate triangles that use a vertex twice.
        triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
        // A mirroring node reverses the orientation.
        if instance.world_from_mesh.determinant() < 0.0 {
            triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        let start = self.triangles.len();
        match start {
            0 => self.triangles = triangles,
            _ => self.triangles.extend(triangles),
        }
        if base > 0 {
            self.triangles[start..].as_flattened_mut().iter_mut().for_each(|vertex| *vertex += base as u32);
        }
        if let Some(material) = primitive.material {
            let count = self.triangles.len() - start;
            self.materials.add(start, vec![Some(material.value() as u32); count], None);
        }
        Ok(())
    }

    fn has_finite_attributes(&self) -> bool {
        self.normals.0.iter().all(|normal| normal.is_finite())
            && self.uvs.values().all(|set| set.0.iter().all(|uv| uv.is_finite()))
            && self.colors.0.iter().all(|color| color.is_finite())
    }

    /// Whether some vertices have a normal and others do not.
    fn lacks_normals(&self) -> bool {
        let Column(normals) = &self.normals;
        !normals.is_empty() && (normals.len() < self.positions.len() || normals.contains(&Vec3::ZERO))
    }

    fn into_mesh(self, json: &Value) -> TriMesh {
        let lacks_normals = self.lacks_normals();
        let Self { positions, triangles, .. } = self;
        let count = positions.len();
        let normals = self.normals.complete(count, Vec3::ZERO);
        let corner_normals = if lacks_normals {
            triangles.iter().map(|triangle| corner_normals(triangle, &positions, &normals)).collect()
        } else {
            by_corner(&triangles, &normals)
        };
        let sets = self.uvs.into_values();
        let uvs = sets.map(|set| by_corner(&triangles, &set.complete(count, Vec2::ZERO))).collect();
        let materials = self.materials.complete(triangles.len(), None);
        let (materials, triangle_materials) = name_materials(json, &materials);
        let mut skin = self.influences.complete(count, Vec::new());
        if skin.iter().all(Vec::is_empty) {
            skin.clear();
        }
        TriMesh {
            corner: CornerAttributes { uvs, normals: corner_normals, colors: Vec::new() },
            vertex: VertexAttributes { colors: self.colors.complete(count, DVec4::ONE), skin },
            positions,
            triangles,
            materials,
            triangle_materials,
            ..TriMesh::default()
        }
    }
}

/// Normals of the corners. A vertex without a normal gets that of the triangle, because the format
/// demands flat shading for meshes without normals.
fn corner_normals(triangle: &[u32; 3], positions: &[DVec3], normals: &[Vec3]) -> [Vec3; 3] {
    let flat = || triangle_normal(triangle.map(|vertex| positions[vertex as usize])).as_vec3();
    triangle.map(|vertex| match normals[vertex as usize] {
        Vec3::ZERO => flat(),
        normal => normal,
    })
}

/// The triangles of a primitive with `vertices` vertices, indexed from its first vertex.
fn triangles(
    document: &Document<'_>,
    primitive: &Primitive,
    mode: Mode,
    vertices: usize,
) -> Result<Vec<[u32; 3]>, ParseError> {
    let corners: Vec<[u32; 1]> = match primitive.indices {
        Some(accessor) if mode == Mode::Triangles => return document.indices(accessor.value()),
        Some(accessor) => document.indices(accessor.value())?,
        None => (0..vertices as u32).map(|vertex| [vertex]).collect(),
    };
    let corners = corners.as_flattened();
    Ok(match mode {
        Mode::TriangleStrip => {
            let turn = |(i, t): (usize, &[u32; 3])| if i % 2 == 0 { *t } else { [t[1], t[0], t[2]] };
            corners.array_windows().enumerate().map(turn).collect()
        }
        Mode::TriangleFan => corners.array_windows().skip(1).map(|&[b, c]| [corners[0], b, c]).collect(),
        _ => corners.as_chunks().0.to_vec(),
    })
}

/// The names of the document's materials and the material of each triangle. If some triangles have
/// none, an unnamed material is appended for them.
fn name_materials(json: &Value, materials: &[Option<u32>]) -> (Vec<String>, Vec<u32>) {
    let listed = json.get("materials").and_then(Value::as_array).map_or([].as_slice(), Vec::as_slice);
    let known = |material: &Option<u32>| material.filter(|&material| (material as usize) < listed.len());
    if !materials.iter().any(|material| known(material).is_some()) {
        return (Vec::new(), Vec::new());
    }
    let name = |(number, material): (usize, &Value)| match material.get("name").and_then(Value::as_str) {
        Some(name) if !name.is_empty() => name.to_owned(),
        _ => format!("material{number}"),
    };
    let mut names: Vec<String> = listed.iter().enumerate().map(name).collect();
    let none = names.len() as u32;
    let numbers: Vec<u32> = materials.iter().map(|material| known(material).unwrap_or(none)).collect();
    if numbers.contains(&none) {
        names.push(String::new());
    }
    (names, numbers)
}
