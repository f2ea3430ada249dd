//! isochore for browsers: what JavaScript sees of it, on `wasm32-unknown-unknown`.
//!
//! Typed arrays that a handle gives are views of the module's memory. They hold until the module's memory grows, which any call may
//! do: ask for them again after each call, and copy what must stay.

#![allow(unsafe_code, reason = "views of memory are for JavaScript to use with care")]
#![allow(missing_docs, reason = "what wasm_bindgen makes has none")]

mod error;
mod mesh;
mod options;
mod replay;
mod session;
mod tool;
