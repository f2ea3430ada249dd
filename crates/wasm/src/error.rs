//! Errors as JavaScript exceptions.

use std::fmt::Display;

use wasm_bindgen::JsError;

/// Converts an error to a JavaScript `Error` with the same message.
pub(crate) fn thrown(error: impl Display) -> JsError {
    JsError::new(&error.to_string())
}
