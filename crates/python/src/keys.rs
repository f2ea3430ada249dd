//! Parts of recipes from Python data.

use isochore_sculpt::recipe::{Mask, VertexWeights};
use numpy::PyUntypedArrayMethods;
use pyo3::{prelude::*, types::PyMapping};
use serde::de::DeserializeOwned;

use crate::{
    arrays::{check_shape, contiguous, numbers},
    error::Failure,
};

/// Converts a mapping to the part of a recipe under the key `path`.
pub(crate) fn keys<T: DeserializeOwned>(path: &str, data: &Bound<'_, PyAny>) -> Result<T, Failure> {
    let text: String = data.py().import("isochore._json")?.call_method1("to_json", (data,))?.extract()?;
    serde_json::from_str(&text).map_err(|error| Failure::Recipe {
        message: format!("{path}: {error}"),
        key: Some(path.to_owned()),
        line: None,
    })
}

/// Converts the `mask` argument of a session: weights per vertex, or the `mask` table of a recipe,
/// whose `vertices` may be an array.
pub(crate) fn mask(value: &Bound<'_, PyAny>, vertices: usize) -> Result<Mask, Failure> {
    let weights = |array: &Bound<'_, PyAny>| {
        let array = contiguous::<f64>(array)?;
        check_shape("mask", array.shape(), &[Some(vertices)])?;
        Ok::<_, Failure>(VertexWeights::Values(numbers("mask", &array)?.to_vec()))
    };
    if value.cast::<PyMapping>().is_err() {
        return Ok(Mask { vertices: Some(weights(value)?), ..Mask::default() });
    }
    // Weights bypass JSON, which is slow for a million numbers.
    let rest = value.py().import("builtins")?.call_method1("dict", (value,))?;
    let painted = rest.call_method1("pop", ("vertices", value.py().None()))?;
    let mask: Mask = keys("mask", &rest)?;
    Ok(Mask { vertices: if painted.is_none() { None } else { Some(weights(&painted)?) }, ..mask })
}
