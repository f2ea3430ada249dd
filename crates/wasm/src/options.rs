//! Options, which JavaScript gives as plain objects.

use js_sys::{JSON, Object};
use serde::de::DeserializeOwned;
use wasm_bindgen::prelude::*;

use crate::error::thrown;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** What a mesh carries. */
export interface MeshAttributes {
  /** Sets of texture coordinates: u, v of the three corners of each triangle, so that seams do not open the surface. */
  uvs?: ArrayLike<number>[];
  /** Shading normals: x, y, z, of any length, of the three corners of each triangle. They turn with the surface. */
  normals?: ArrayLike<number>;
  /** Linear red, green, blue and alpha of each vertex, 0 to 1. */
  colors?: ArrayLike<number>;
  /** The same of the three corners of each triangle, where they differ across seams. */
  cornerColors?: ArrayLike<number>;
  /** Names of the materials; an empty one stands for triangles without a material. */
  materials?: string[];
  /** For each triangle which of the materials it has; these two need each other. */
  triangleMaterials?: ArrayLike<number>;
  /** As many joints for each vertex, row by row. */
  joints?: ArrayLike<number>;
  /** A weight for each of these, which is divided by the sum of its row; zero for places that are not used. */
  weights?: ArrayLike<number>;
}

/** How a session works. */
export interface SessionOptions {
  /** Travel of the fastest point of the tool's surface in one time step, as a share of the support or of half the tool's shortest
   * extent, whichever is less; at most 1. */
  step?: number;
  /** Bytes that undo and redo may hold; beyond, the oldest strokes are forgotten. */
  undoBytes?: number;
  /** How triangles are weighted in vertex normals: by area, unless said otherwise. */
  normals?: "area" | "angle";
  /** Whether each stroke ends with the volume of the mesh as opened, by a small displacement of what it has moved; true unless said
   * otherwise. */
  lock?: boolean;
  /** A number for each vertex of the mesh from 0, free, to 1, held: those that are held keep their bits. */
  weights?: ArrayLike<number>;
  /** What else a recipe says under `mask`. */
  mask?: { pins?: object[]; mirror?: object[]; fade?: number };
}

/** How one stroke works. */
export interface StrokeOptions {
  /** Whether edges in the tool's reach are split, collapsed and flipped; true unless said otherwise. */
  refine?: boolean;
  /** Edges longer than this are split, model units. */
  longestEdge?: number;
  /** No split goes beyond this number of triangles. */
  maxTriangles?: number;
  /** Balls in which the triangles stay: x, y, z and radius of each, model units. */
  keep?: ArrayLike<number>;
}

/** How a preview looks. */
export interface PreviewOptions {
  /** Points along the longest side of the support, 12 unless said otherwise and 64 at most. */
  perSide?: number;
  /** Turn where the move begins: axis x, y, z and angle in degrees, absolute. */
  startRotate?: ArrayLike<number>;
  /** The same where it ends. */
  endRotate?: ArrayLike<number>;
}
"#;

#[wasm_bindgen]
unsafe extern "C" {
    #[wasm_bindgen(extends = Object, typescript_type = "MeshAttributes")]
    pub type MeshAttributes;
    #[wasm_bindgen(method, getter)]
    pub fn uvs(this: &MeshAttributes) -> Option<Vec<JsValue>>;
    #[wasm_bindgen(method, getter)]
    pub fn normals(this: &MeshAttributes) -> Option<Vec<f64>>;
    #[wasm_bindgen(method, getter)]
    pub fn colors(this: &MeshAttributes) -> Option<Vec<f64>>;
    #[wasm_bindgen(method, getter, js_name = cornerColors)]
    pub fn corner_colors(this: &MeshAttributes) -> Option<Vec<f64>>;
    #[wasm_bindgen(method, getter)]
    pub fn materials(this: &MeshAttributes) -> Option<Vec<String>>;
    #[wasm_bindgen(method, getter, js_name = triangleMaterials)]
    pub fn triangle_materials(this: &MeshAttributes) -> Option<Vec<u32>>;
    #[wasm_bindgen(method, getter)]
    pub fn joints(this: &MeshAttributes) -> Option<Vec<u32>>;
    #[wasm_bindgen(method, getter)]
    pub fn weights(this: &MeshAttributes) -> Option<Vec<f64>>;

    #[wasm_bindgen(extends = Object, typescript_type = "SessionOptions")]
    pub type SessionOptions;
    #[wasm_bindgen(method, getter)]
    pub fn step(this: &SessionOptions) -> Option<f64>;
    #[wasm_bindgen(method, getter, js_name = undoBytes)]
    pub fn undo_bytes(this: &SessionOptions) -> Option<f64>;
    #[wasm_bindgen(method, getter)]
    pub fn normals(this: &SessionOptions) -> Option<String>;
    #[wasm_bindgen(method, getter)]
    pub fn lock(this: &SessionOptions) -> Option<bool>;
    #[wasm_bindgen(method, getter)]
    pub fn weights(this: &SessionOptions) -> Option<Vec<f64>>;
    #[wasm_bindgen(method, getter)]
    pub fn mask(this: &SessionOptions) -> Option<Object>;

    #[wasm_bindgen(extends = Object, typescript_type = "StrokeOptions")]
    pub type StrokeOptions;
    #[wasm_bindgen(method, getter)]
    pub fn refine(this: &StrokeOptions) -> Option<bool>;
    #[wasm_bindgen(method, getter, js_name = longestEdge)]
    pub fn longest_edge(this: &StrokeOptions) -> Option<f64>;
    #[wasm_bindgen(method, getter, js_name = maxTriangles)]
    pub fn max_triangles(this: &StrokeOptions) -> Option<f64>;
    #[wasm_bindgen(method, getter)]
    pub fn keep(this: &StrokeOptions) -> Option<Vec<f64>>;

    #[wasm_bindgen(extends = Object, typescript_type = "PreviewOptions")]
    pub type PreviewOptions;
    #[wasm_bindgen(method, getter, js_name = perSide)]
    pub fn per_side(this: &PreviewOptions) -> Option<f64>;
    #[wasm_bindgen(method, getter, js_name = startRotate)]
    pub fn start_rotate(this: &PreviewOptions) -> Option<Vec<f64>>;
    #[wasm_bindgen(method, getter, js_name = endRotate)]
    pub fn end_rotate(this: &PreviewOptions) -> Option<Vec<f64>>;
}

/// The options, given or not, which have no other keys than these.
pub(crate) fn options<T: JsCast>(given: Option<T>, known: &[&str]) -> Result<T, JsError> {
    let Some(given) = given else { return Ok(Object::new().unchecked_into()) };
    let unknown = |key: &JsValue| key.as_string().filter(|key| !known.contains(&key.as_str()));
    match Object::keys::<JsValue>(given.unchecked_ref()).iter().find_map(|key| unknown(&key)) {
        Some(key) => Err(thrown(format!("unknown option `{key}`; known here: {}", known.join(", ")))),
        None => Ok(given),
    }
}

/// What a recipe says under the key `place`, as an object.
pub(crate) fn keys<T: DeserializeOwned>(place: &str, data: &JsValue) -> Result<T, JsError> {
    let text = JSON::stringify(data).ok().and_then(|text| text.as_string()).unwrap_or_default();
    serde_json::from_str(&text).map_err(|error| thrown(format!("{place}: {error}")))
}

/// A number of things, or as many as `usual`.
pub(crate) fn count(name: &str, given: Option<f64>, usual: usize) -> Result<usize, JsError> {
    match given {
        None => Ok(usual),
        // What is more than memory has addresses for is as good as no limit.
        Some(count) if count >= 0.0 && count.fract() == 0.0 => Ok(count as usize),
        Some(other) => Err(thrown(format!("{name} is a whole number, 0 or more, not {other}"))),
    }
}

/// Just as many numbers as are wanted.
pub(crate) fn numbers<const N: usize>(values: &[f64]) -> Result<[f64; N], JsError> {
    values.try_into().map_err(|_| thrown(format!("{N} numbers are wanted, not {}", values.len())))
}
