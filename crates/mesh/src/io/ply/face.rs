//! The faces of a PLY file.

use std::ops::Range;

use glam::{DVec2, DVec3, DVec4, Vec2, Vec3};
use ply_rs_bw::ply::{BeginList, ElementDef, PropertyAccess, PropertyAccessResult};

use super::body::Body;
use super::face_list::is_indices;
use super::plain_triangle::PlainTriangle;
use super::vertex::Vertices;
use crate::huge_pages::in_huge_pages;
use crate::io::ParseError;
use crate::io::by_corner::by_corner;
use crate::io::element::{Dropped, distinct_corners, has_repeated_corner, is_triangle};
use crate::io::polygon::triangulate;

/// The triangles read so far.
#[derive(Default)]
pub(super) struct Triangles {
    pub(super) vertices: Vec<[u32; 3]>,
    pub(super) uvs: Vec<[Vec2; 3]>,
    pub(super) normals: Vec<[Vec3; 3]>,
    pub(super) colors: Vec<[DVec4; 3]>,
    /// Buffers for the current face: its vertices, their positions, and the corners of its
    /// triangles.
    corners: Vec<u32>,
    polygon: Vec<DVec3>,
    split: Vec<[usize; 3]>,
    kept: Vec<usize>,
    pub(super) dropped: Dropped,
}

impl Triangles {
    pub(super) fn read(body: &mut Body<'_>, element: &ElementDef, vertices: &Vertices) -> Result<Self, ParseError> {
        // A corner takes at least one byte.
        let most = element.count.min(body.rest().len() / 3);
        let mut triangles = Self { vertices: in_huge_pages(Vec::with_capacity(most)), ..Self::default() };
        let mut plain = PlainTriangle::definition(element);
        for part in Body::parts(element) {
            if let Some(definition) = &plain {
                if triangles.push_plain(body, definition, part.clone(), vertices.positions.len()) {
                    continue;
                }
                // More polygons are likely to follow one, so this part is read again, and the rest,
                // as polygons.
                plain = None;
            }
            for (number, face) in part.clone().zip(body.read_part(element, part)?) {
                triangles.push(number, &face, vertices)?;
            }
        }
        triangles.complete(vertices);
        Ok(triangles)
    }

    /// Adds the triangles of strips, which an index of −1 separates.
    pub(super) fn read_strips(
        &mut self,
        body: &mut Body<'_>,
        element: &ElementDef,
        vertices: &Vertices,
    ) -> Result<(), ParseError> {
        body.read(element, |number, strip: Face| {
            let count = vertices.positions.len();
            let signed: Vec<i64> = strip.indices_of_file().collect();
            for strip in signed.split(|&index| index == -1) {
                if let Some(&index) = strip.iter().find(|&&index| index < 0 || index >= count as i64) {
                    return Err(ParseError::IndexOutOfRange { face: number, index, vertices: count });
                }
                for (at, corners) in strip.array_windows::<3>().enumerate() {
                    let [a, b, c] = corners.map(|index| index as u32);
                    let triangle = if at % 2 == 0 { [a, b, c] } else { [b, a, c] };
                    // Strips are joined by triangles that use a vertex twice.
                    self.vertices.extend(Some(triangle).filter(is_triangle));
                }
            }
            Ok(())
        })?;
        add_missing(&mut self.colors, &self.vertices, &vertices.colors, DVec4::ONE);
        add_missing(&mut self.uvs, &self.vertices, &vertices.uvs, Vec2::ZERO);
        add_missing(&mut self.normals, &self.vertices, &vertices.normals, Vec3::ZERO);
        self.complete(vertices);
        Ok(())
    }

    /// Takes attributes from the vertices that no face has as lists.
    fn complete(&mut self, vertices: &Vertices) {
        if self.uvs.is_empty() {
            self.uvs = by_corner(&self.vertices, &vertices.uvs);
        }
        if self.normals.is_empty() {
            self.normals = by_corner(&self.vertices, &vertices.normals);
        }
    }

    /// Adds the faces of a part if all are triangles. Otherwise leaves them unread and returns
    /// `false`.
    fn push_plain(&mut self, body: &mut Body<'_>, plain: &ElementDef, part: Range<usize>, vertices: usize) -> bool {
        let start = self.vertices.len();
        let mut ahead = body.copy();
        let Ok(faces) = ahead.read_part(plain, part) else { return false };
        for face in &faces {
            let face: &PlainTriangle = face;
            match face.corners(vertices) {
                Some(corners) => self.vertices.push(corners),
                None => {
                    self.vertices.truncate(start);
                    return false;
                }
            }
        }
        *body = ahead;
        true
    }

    /// Adds a polygon. Attributes come from the lists of the face if these are complete, otherwise
    /// from its vertices.
    fn push(&mut self, number: usize, face: &Face, vertices: &Vertices) -> Result<(), ParseError> {
        self.corners.clear();
        self.polygon.clear();
        for index in face.indices_of_file() {
            let position = usize::try_from(index).ok().and_then(|index| vertices.positions.get(index));
            let out_of_range = ParseError::IndexOutOfRange { face: number, index, vertices: vertices.positions.len() };
            self.polygon.push(*position.ok_or(out_of_range)?);
            self.corners.push(index as u32);
        }
        let corners = self.corners.len();
        self.split.clear();
        if has_repeated_corner(&self.corners) {
            if !distinct_corners(&self.corners, &mut self.kept) {
                self.dropped.faces += 1;
                return Ok(());
            }
            self.dropped.corners += 1;
            let polygon: Vec<DVec3> = self.kept.iter().map(|&corner| self.polygon[corner]).collect();
            triangulate(&polygon, |triangle| self.split.push(triangle.map(|corner| self.kept[corner])));
        } else {
            triangulate(&self.polygon, |triangle| self.split.push(triangle));
        }
        self.split.retain(|triangle| is_triangle(&triangle.map(|corner| self.corners[corner])));
        self.vertices.extend(self.split.iter().map(|triangle| triangle.map(|corner| self.corners[corner])));

        let uv = |list: &[f64]| <[f64; 2]>::try_from(list).ok().map(|uv| DVec2::from_array(uv).as_vec2());
        let normal = |list: &[f64]| <[f64; 3]>::try_from(list).ok().map(|normal| DVec3::from_array(normal).as_vec3());
        let color = |list: &[f64]| match *list {
            [r, g, b] => Some(DVec4::new(r, g, b, 1.0)),
            [r, g, b, alpha] => Some(DVec4::new(r, g, b, alpha)),
            _ => None,
        };
        let Self { vertices: all, split, .. } = self;
        let polygon = Polygon { triangles: all, split, corners };
        let of_vertex = |vertex| vertices.uvs.get(vertex).copied().unwrap_or_default();
        add_list(&mut self.uvs, &polygon, &face.uvs, uv, of_vertex);
        let of_vertex = |vertex| vertices.normals.get(vertex).copied().unwrap_or_default();
        add_list(&mut self.normals, &polygon, &face.normals, normal, of_vertex);
        let of_vertex = |vertex| vertices.colors.get(vertex).copied().unwrap_or(DVec4::ONE);
        add_list(&mut self.colors, &polygon, &face.colors, color, of_vertex);
        Ok(())
    }
}

/// Adds the values that the vertices of the last triangles have, or else `default`, if the other
/// triangles have some.
fn add_missing<T: Copy>(values: &mut Vec<[T; 3]>, triangles: &[[u32; 3]], of_vertices: &[T], default: T) {
    if !values.is_empty() {
        let of_vertex = |vertex: u32| of_vertices.get(vertex as usize).copied().unwrap_or(default);
        values.extend(triangles[values.len()..].iter().map(|triangle| triangle.map(of_vertex)));
    }
}

/// Adds the values of the last triangles, which `split` a face with the attribute `list`. Stores no
/// values until the first face with a list.
fn add_list<T>(
    values: &mut Vec<[T; 3]>,
    polygon: &Polygon<'_>,
    list: &[f64],
    make: impl Fn(&[f64]) -> Option<T>,
    of_vertex: impl Fn(usize) -> T,
) {
    let Polygon { triangles, split, corners } = *polygon;
    if list.is_empty() && values.is_empty() {
        return;
    }
    let earlier = triangles.len() - split.len();
    let without_list = |triangle: &[u32; 3]| triangle.map(|vertex| of_vertex(vertex as usize));
    values.extend(triangles[values.len()..earlier].iter().map(without_list));
    let components = list.len() / corners;
    for (vertices, triangle) in triangles[earlier..].iter().zip(split) {
        values.push(std::array::from_fn(|side| {
            let own = components * triangle[side]..components * (triangle[side] + 1);
            make(&list[own]).unwrap_or_else(|| of_vertex(vertices[side] as usize))
        }));
    }
}

/// The triangles of the last face.
struct Polygon<'a> {
    /// All triangles so far. Those of the face are the last ones.
    triangles: &'a [[u32; 3]],
    /// The triangles of the face as corners of the face.
    split: &'a [[usize; 3]],
    /// Number of corners of the face.
    corners: usize,
}

/// A face that the library fills property by property.
#[derive(Default)]
struct Face {
    indices: Vec<i32>,
    /// The indices of a file with unsigned ones.
    unsigned: Vec<u32>,
    uvs: Vec<f64>,
    normals: Vec<f64>,
    colors: Vec<f64>,
}

impl Face {
    /// The vertices, of whichever type.
    fn indices_of_file(&self) -> impl Iterator<Item = i64> {
        self.indices.iter().map(|&index| i64::from(index)).chain(self.unsigned.iter().map(|&index| i64::from(index)))
    }

    fn set_indices<T: Into<i32>>(&mut self, name: &str, list: Vec<T>) -> PropertyAccessResult {
        if !is_indices(name) {
            return PropertyAccessResult::Ignored;
        }
        self.indices = list.into_iter().map(Into::into).collect();
        PropertyAccessResult::Set
    }

    /// Sets the colors from integers whose full intensity is `full`.
    fn set_color<T: Into<f64>>(&mut self, list: Vec<T>, full: f64) -> PropertyAccessResult {
        self.colors = list.into_iter().map(|value| value.into() / full).collect();
        PropertyAccessResult::Set
    }

    fn numbers(&mut self, name: &str) -> Option<&mut Vec<f64>> {
        match name {
            "texcoord" => Some(&mut self.uvs),
            "normal" => Some(&mut self.normals),
            "color" => Some(&mut self.colors),
            _ => None,
        }
    }
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_list_char(&mut self, name: &str, list: Vec<i8>) -> PropertyAccessResult {
        self.set_indices(name, list)
    }

    fn set_list_uchar(&mut self, name: &str, list: Vec<u8>) -> PropertyAccessResult {
        if name == "color" { self.set_color(list, u8::MAX.into()) } else { self.set_indices(name, list) }
    }

    fn set_list_short(&mut self, name: &str, list: Vec<i16>) -> PropertyAccessResult {
        self.set_indices(name, list)
    }

    fn set_list_ushort(&mut self, name: &str, list: Vec<u16>) -> PropertyAccessResult {
        if name == "color" { self.set_color(list, u16::MAX.into()) } else { self.set_indices(name, list) }
    }

    fn begin_list_int(&mut self, name: &str, _: usize) -> BeginList<'_, i32> {
        if is_indices(name) { BeginList::Fill(&mut self.indices) } else { BeginList::UseSetter }
    }

    fn begin_list_uint(&mut self, name: &str, _: usize) -> BeginList<'_, u32> {
        if is_indices(name) { BeginList::Fill(&mut self.unsigned) } else { BeginList::UseSetter }
    }

    fn set_list_float(&mut self, name: &str, list: Vec<f32>) -> PropertyAccessResult {
        let Some(numbers) = self.numbers(name) else { return PropertyAccessResult::Ignored };
        *numbers = list.into_iter().map(f64::from).collect();
        PropertyAccessResult::Set
    }

    fn begin_list_double(&mut self, name: &str, _: usize) -> BeginList<'_, f64> {
        self.numbers(name).map_or(BeginList::UseSetter, BeginList::Fill)
    }
}
