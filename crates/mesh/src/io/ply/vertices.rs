//! The vertices of a PLY file.

use glam::{DVec2, DVec3, DVec4};

use super::body::Body;
use super::header::{Element, Scalar};
use crate::io::ParseError;

/// Vertices by attribute; an attribute that the file does not have is empty.
#[derive(Default)]
pub(super) struct Vertices {
    pub(super) positions: Vec<DVec3>,
    pub(super) normals: Vec<DVec3>,
    pub(super) uvs: Vec<DVec2>,
    pub(super) colors: Vec<DVec4>,
}

/// Where the attributes are among the properties.
struct Layout {
    position: [Scalar; 3],
    normal: Option<[Scalar; 3]>,
    uv: Option<[Scalar; 2]>,
    color: Option<[Scalar; 3]>,
    alpha: Option<Scalar>,
}

/// Names of the coordinates.
const POSITION: [&[&str]; 3] = [&["x"], &["y"], &["z"]];

/// Where the coordinates of the vertices are.
///
/// # Errors
/// [`ParseError::Malformed`] where one is missing.
pub(in crate::io) fn position_scalars(element: &Element) -> Result<[Scalar; 3], ParseError> {
    let missing = || ParseError::Malformed("the vertices need the properties x, y and z, each a number".into());
    element.scalars(POSITION).ok_or_else(missing)
}

impl Layout {
    fn of(element: &Element) -> Result<Self, ParseError> {
        Ok(Self {
            position: position_scalars(element)?,
            normal: element.scalars([&["nx"], &["ny"], &["nz"]]),
            uv: element.scalars([&["s", "u", "texture_u"], &["t", "v", "texture_v"]]),
            color: element.scalars([
                &["red", "r", "diffuse_red"],
                &["green", "g", "diffuse_green"],
                &["blue", "b", "diffuse_blue"],
            ]),
            alpha: element.scalar(&["alpha", "a", "diffuse_alpha"]),
        })
    }
}

impl Vertices {
    pub(super) fn read<'a>(body: &mut Body<'a>, element: &'a Element) -> Result<Self, ParseError> {
        let layout = Layout::of(element)?;
        let mut vertices = Self::default();
        if let Some((records, order)) = body.take_records(element)? {
            vertices.positions.reserve_exact(element.count);
            let size = element.size().unwrap_or(1).max(1);
            for record in records.chunks_exact(size) {
                vertices.push(&layout, |scalar| scalar.number.decode(&record[scalar.offset..], order));
            }
        } else {
            let mut numbers = vec![0.0; element.properties.len()];
            for vertex in 0..element.count {
                body.begin(element, vertex)?;
                for (property, number) in element.properties.iter().zip(&mut numbers) {
                    match property.length {
                        Some(_) => body.skip(property)?,
                        None => *number = body.number(property.number)?,
                    }
                }
                body.end();
                vertices.push(&layout, |scalar| numbers[scalar.index]);
            }
        }
        if vertices.normals.iter().all(|&normal| normal == DVec3::ZERO) {
            vertices.normals.clear();
        }
        Ok(vertices)
    }

    #[inline]
    fn push(&mut self, layout: &Layout, value: impl Fn(Scalar) -> f64) {
        self.positions.push(DVec3::from_array(layout.position.map(&value)));
        if let Some(normal) = layout.normal {
            self.normals.push(DVec3::from_array(normal.map(&value)));
        }
        if let Some(uv) = layout.uv {
            self.uvs.push(DVec2::from_array(uv.map(&value)));
        }
        if let Some(color) = layout.color {
            let share = |scalar: Scalar| value(scalar) / scalar.number.full_intensity();
            let [r, g, b] = color.map(share);
            self.colors.push(DVec4::new(r, g, b, layout.alpha.map_or(1.0, share)));
        }
    }
}
