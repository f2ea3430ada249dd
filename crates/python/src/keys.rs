//! Parts of recipes that come as plain data of Python.

use isochore_sculpt::recipe::{Mask, VertexWeights};
use numpy::PyUntypedArrayMethods;
use pyo3::{prelude::*, types::PyMapping};
use serde::de::DeserializeOwned;

use crate::{
    arrays::{check_shape, contiguous, numbers},
    error::Failure,
};

/// What a recipe says under the key `place`, as a mapping of Python's or the like.
pub(crate) fn keys<T: DeserializeOwned>(place: &str, data: &Bound<'_, PyAny>) -> Result<T, Failure> {
    let text: String = data.py().import("isochore._json")?.call_method1("to_json", (data,))?.extract()?;
    serde_json::from_str(&text).map_err(|error| Failure::Recipe {
        message: format!("{place}: {error}"),
        key: Some(place.to_owned()),
        line: None,
    })
}

/// The mask of a session on a mesh: weights by vertex, or the keys of a recipe's `[mask]`, whose `vertices` may be an array too.
pub(crate) fn mask(given: &Bound<'_, PyAny>, vertices: usize) -> Result<Mask, Failure> {
    let weights = |array: &Bound<'_, PyAny>| {
        let array = contiguous::<f64>(array)?;
        check_shape("mask", array.shape(), &[Some(vertices)])?;
        Ok::<_, Failure>(VertexWeights::Values(numbers("mask", &array)?.to_vec()))
    };
    if given.cast::<PyMapping>().is_err() {
        return Ok(Mask { vertices: Some(weights(given)?), ..Mask::default() });
    }
    // Apart from the rest: as text, a million numbers are slow.
    let rest = given.py().import("builtins")?.call_method1("dict", (given,))?;
    let painted = rest.call_method1("pop", ("vertices", given.py().None()))?;
    let mask: Mask = keys("mask", &rest)?;
    Ok(Mask { vertices: if painted.is_none() { None } else { Some(weights(&painted)?) }, ..mask })
}
