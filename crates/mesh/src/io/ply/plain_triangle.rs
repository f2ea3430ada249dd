//! Faces that are nothing but triangles, as most are.

use ply_rs_bw::ply::{
    Addable, ElementDef, PropertyAccess, PropertyAccessResult, PropertyDef, PropertyType, ScalarType,
};

use super::face::is_indices;

/// Names of a list's length and its first three values. No header has such ones, for want of quotes around spaces.
const NAMES: [&str; 4] = ["list length", "list value 0", "list value 1", "list value 2"];

/// A face whose list of vertices is read as the four numbers that it is if they are three. The library allocates memory for
/// every list, which takes longer than to read it.
pub(super) struct PlainTriangle {
    length: i64,
    corners: [i64; 3],
}

impl PlainTriangle {
    /// Faces with such numbers in place of their list; none where they have other lists or no whole numbers.
    pub(super) fn definition(faces: &ElementDef) -> Option<ElementDef> {
        let mut plain = ElementDef::new(faces.name.clone());
        for property in faces.properties.values() {
            match &property.data_type {
                PropertyType::Scalar(_) => plain.properties.add(property.clone()),
                PropertyType::List(length, value)
                    if is_indices(&property.name) && is_whole(length) && is_whole(value) =>
                {
                    for (name, kind) in NAMES.into_iter().zip([length, value, value, value]) {
                        plain.properties.add(PropertyDef::new(name.to_owned(), PropertyType::Scalar(kind.clone())));
                    }
                }
                PropertyType::List(..) => return None,
            }
        }
        // Two lists under different names would be taken for one.
        let lists = faces.properties.len() + NAMES.len() - plain.properties.len();
        (lists == 1).then_some(plain)
    }

    /// The vertices, each below `vertices`; none where it is no triangle of them.
    pub(super) fn corners(&self, vertices: usize) -> Option<[u32; 3]> {
        let is_vertex = |&corner: &i64| corner >= 0 && (corner as u64) < vertices as u64;
        (self.length == 3 && self.corners.iter().all(is_vertex)).then(|| self.corners.map(|corner| corner as u32))
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

fn is_whole(kind: &ScalarType) -> bool {
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
