//! Vertex attributes of glTF: the accessors of a primitive, and columns of values.

use std::collections::BTreeMap;

use ::gltf::json::mesh::{Primitive, Semantic};
use ::gltf::json::validation::Checked;

/// Values of an attribute; empty until an element has a value.
#[derive(Default)]
pub(super) struct Column<T>(pub(super) Vec<T>);

impl<T: Clone> Column<T> {
    /// Adds the values of the elements from `start` on. Earlier elements without a value get
    /// `missing`.
    pub(super) fn add(&mut self, start: usize, values: Vec<T>, missing: T) {
        if start == 0 {
            self.0 = values;
        } else {
            self.0.resize(start, missing);
            self.0.extend(values);
        }
    }

    /// One value for each of `count` elements, or an empty list if no element has a value.
    pub(super) fn complete(mut self, count: usize, missing: T) -> Vec<T> {
        if !self.0.is_empty() {
            self.0.resize(count, missing);
        }
        self.0
    }
}

/// The accessors of a primitive's attributes.
#[derive(Default, PartialEq)]
pub(super) struct Attributes {
    pub(super) positions: Option<usize>,
    pub(super) normals: Option<usize>,
    pub(super) colors: Option<usize>,
    /// Texture coordinates, by the numbers of their sets.
    pub(super) uvs: BTreeMap<u32, usize>,
    pub(super) joints: Vec<usize>,
    pub(super) weights: Vec<usize>,
}

impl Attributes {
    pub(super) fn of(primitive: &Primitive) -> Self {
        let mut attributes = Self::default();
        // The map is sorted by semantic, so the sets of each are pushed in ascending order.
        for (semantic, accessor) in &primitive.attributes {
            let accessor = accessor.value();
            match semantic {
                Checked::Valid(Semantic::Positions) => attributes.positions = Some(accessor),
                Checked::Valid(Semantic::Normals) => attributes.normals = Some(accessor),
                Checked::Valid(Semantic::Colors(0)) => attributes.colors = Some(accessor),
                Checked::Valid(Semantic::TexCoords(set)) => _ = attributes.uvs.insert(*set, accessor),
                Checked::Valid(Semantic::Joints(_)) => attributes.joints.push(accessor),
                Checked::Valid(Semantic::Weights(_)) => attributes.weights.push(accessor),
                _ => {}
            }
        }
        attributes
    }
}
