//! A fast path for faces that are all triangles.

use ply_rs_bw::ply::{
    Addable, ElementDef, PropertyAccess, PropertyAccessResult, PropertyDef, PropertyType, ScalarType,
};

use super::face_list::is_indices;
use crate::io::element::is_triangle;

/// Names for the length and the first three values of a list. They cannot occur in a header,
/// because names there have no spaces.
const NAMES: [&str; 4] = ["list length", "list value 0", "list value 1", "list value 2"];

/// A face whose vertex list is read as four scalars: the length and three indices. The library
/// allocates memory for every list, which takes longer than reading it.
pub(super) struct PlainTriangle {
    length: i64,
    corners: [i64; 3],
}

impl PlainTriangle {
    /// The element definition with four scalars instead of the vertex list. `None` if the faces
    /// have other lists, or if the list is not of integers.
    pub(super) fn definition(faces: &ElementDef) -> Option<ElementDef> {
        let mut plain = ElementDef::new(faces.name.clone());
        for property in faces.properties.values() {
            match &property.data_type {
                PropertyType::Scalar(_) => plain.properties.add(property.clone()),
                PropertyType::List(length, value)
                    if is_indices(&property.name) && is_integer(length) && is_integer(value) =>
                {
                    for (name, kind) in NAMES.into_iter().zip([length, value, value, value]) {
                        plain.properties.add(PropertyDef::new(name.to_owned(), PropertyType::Scalar(kind.clone())));
                    }
                }
                PropertyType::List(..) => return None,
            }
        }
        // Two lists under different names would overwrite each other's values.
        let lists = faces.properties.len() + NAMES.len() - plain.properties.len();
        (lists == 1).then_some(plain)
    }

    /// The vertices, or `None` if the face is not a triangle of three vertices or an index is not below
    /// `vertices`.
    pub(super) fn corners(&self, vertices: usize) -> Option<[u32; 3]> {
        let is_vertex = |&corner: &i64| corner >= 0 && (corner as u64) < vertices as u64;
        let is_plain = self.length == 3 && is_triangle(&self.corners) && self.corners.iter().all(is_vertex);
        is_plain.then(|| self.corners.map(|corner| corner as u32))
    }

    fn set(&mut self, name: &str, value: impl Into<i64>) -> PropertyAccessResult {
        let [length, corners @ ..] = NAMES;
        if name == length {
            self.length = value.into();
        } else if let Some(corner) = corners.iter().position(|&corner| corner == name) {
            self.corners[corner] = value.into();
        }
        PropertyAccessResult::Set
    }
}

fn is_integer(kind: &ScalarType) -> bool {
    !matches!(kind, ScalarType::Float | ScalarType::Double)
}

impl PropertyAccess for PlainTriangle {
    fn new() -> Self {
        Self { length: 0, corners: [-1; 3] }
    }

    fn set_char(&mut self, name: &str, value: i8) -> PropertyAccessResult {
        self.set(name, value)
    }

    fn set_uchar(&mut self, name: &str, value: u8) -> PropertyAccessResult {
        self.set(name, value)
    }

    fn set_short(&mut self, name: &str, value: i16) -> PropertyAccessResult {
        self.set(name, value)
    }

    fn set_ushort(&mut self, name: &str, value: u16) -> PropertyAccessResult {
        self.set(name, value)
    }

    fn set_int(&mut self, name: &str, value: i32) -> PropertyAccessResult {
        self.set(name, value)
    }

    fn set_uint(&mut self, name: &str, value: u32) -> PropertyAccessResult {
        self.set(name, value)
    }
}
