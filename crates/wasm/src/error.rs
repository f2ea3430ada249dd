//! Errors as JavaScript knows them.

use std::fmt::Display;

use wasm_bindgen::JsError;

/// An `Error` with the words of this one.
pub(crate) fn thrown(error: impl Display) -> JsError {
    JsError::new(&error.to_string())
}
