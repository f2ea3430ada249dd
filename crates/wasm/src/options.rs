//! Options, which JavaScript passes as plain objects.

use js_sys::{JSON, Object};
use serde::de::DeserializeOwned;
use wasm_bindgen::prelude::*;

use crate::error::thrown;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** Attributes of a mesh with V vertices and T triangles. */
export interface MeshAttributes {
  /** Sets of texture coordinates per corner, 6 T numbers each: u, v of the three corners of each triangle. Seams do not open
   * the surface. */
  uvs?: ArrayLike<number>[];
  /** Shading normals per corner, 9 T numbers: x, y, z of any nonzero length. They rotate with the surface. */
  normals?: ArrayLike<number>;
  /** Vertex colors, 4 V numbers: linear red, green, blue and alpha, 0 to 1. */
  colors?: ArrayLike<number>;
  /** Corner colors, 12 T numbers: linear red, green, blue and alpha, 0 to 1. They may differ across seams. */
  cornerColors?: ArrayLike<number>;
  /** Names of the materials. An empty name means no material. Requires `triangleMaterials`. */
  materials?: string[];
  /** Material index of each triangle. Requires `materials`. */
  triangleMaterials?: ArrayLike<number>;
  /** Joint indices of each vertex, in V rows of the same length. Requires `weights`. */
  joints?: ArrayLike<number>;
  /** Weight of each entry of `joints`. Each row is normalized. Weight 0 marks an unused entry. */
  weights?: ArrayLike<number>;
}

/** Options of a session. */
export interface SessionOptions {
  /** Time step, given as the distance that the fastest point of the tool surface travels in one step. It is a fraction, at
   * most 1, of the support or of half the shortest extent of the tool, whichever is smaller. */
  step?: number;
  /** Memory budget of undo and redo, in bytes. Beyond it, the oldest strokes are removed from the history. */
  undoBytes?: number;
  /** Weighting of triangles in vertex normals. Default: "area". */
  normals?: "area" | "angle";
  /** Whether each stroke ends with the volume lock, a small displacement of the moved vertices that restores the volume of
   * the opened mesh. Default: true. */
  lock?: boolean;
  /** Mask weight of each vertex, from 0 (free) to 1 (masked). Vertices of weight 1 keep their exact positions. */
  weights?: ArrayLike<number>;
  /** Other keys of the `mask` table of a recipe. */
  mask?: { pins?: object[]; mirror?: object[]; fade?: number };
}

/** Options of a stroke. */
export interface StrokeOptions {
  /** Whether edges in reach of the tool are split, some are collapsed or flipped, and crossings of the surface with itself are prevented. Default: true. */
  refine?: boolean;
  /** Edges longer than this are split, model units. */
  longestEdge?: number;
  /** Edges are split where the curved surface deviates from them by more than this, model units. */
  deviation?: number;
  /** Splits stop at this number of triangles. */
  maxTriangles?: number;
  /** Balls in which triangles are not refined: x, y, z and radius of each, model units. */
  keep?: ArrayLike<number>;
}

/** Options of a preview. */
export interface PreviewOptions {
  /** Number of points along the longest side of the support, at most 64. Default: 12. */
  perSide?: number;
  /** Rotation at the start of the move: axis x, y, z and angle in degrees, relative to the unrotated tool. */
  startRotate?: ArrayLike<number>;
  /** Rotation at the end of the move, in the same form. */
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
    #[wasm_bindgen(method, getter)]
    pub fn deviation(this: &StrokeOptions) -> Option<f64>;
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

/// Returns the options, or an empty object if there are none. Rejects unknown keys.
pub(crate) fn options<T: JsCast>(options: Option<T>, known: &[&str]) -> Result<T, JsError> {
    let Some(options) = options else { return Ok(Object::new().unchecked_into()) };
    let unknown = |key: &JsValue| key.as_string().filter(|key| !known.contains(&key.as_str()));
    match Object::keys::<JsValue>(options.unchecked_ref()).iter().find_map(|key| unknown(&key)) {
        Some(key) => Err(thrown(format!("unknown option `{key}`; known options: {}", known.join(", ")))),
        None => Ok(options),
    }
}

/// Converts an object to the part of a recipe under the key `path`.
pub(crate) fn keys<T: DeserializeOwned>(path: &str, data: &JsValue) -> Result<T, JsError> {
    let text = JSON::stringify(data).ok().and_then(|text| text.as_string()).unwrap_or_default();
    serde_json::from_str(&text).map_err(|error| thrown(format!("{path}: {error}")))
}

/// Converts an optional number to a count.
pub(crate) fn count(name: &str, number: Option<f64>, default: usize) -> Result<usize, JsError> {
    match number {
        None => Ok(default),
        // The conversion saturates. A count beyond the address space does not limit anything.
        Some(count) if count >= 0.0 && count.fract() == 0.0 => Ok(count as usize),
        Some(other) => Err(thrown(format!("{name} must be a nonnegative integer, not {other}"))),
    }
}

/// Exactly `N` numbers.
pub(crate) fn numbers<const N: usize>(values: &[f64]) -> Result<[f64; N], JsError> {
    values.try_into().map_err(|_| thrown(format!("expected {N} numbers, not {}", values.len())))
}
