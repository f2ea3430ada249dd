//! isochore for Python: the module `isochore._native`, which the package `isochore` presents.

mod arrays;
mod attributes;
mod distance;
mod error;
mod keys;
mod mesh;
mod pickled;
mod replay;
mod session;
mod tool;
mod watch;

use pyo3::prelude::*;

/// What of isochore is not written in Python.
#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::{
        distance::DistanceField,
        error::{Cancelled, Error, RecipeError},
        mesh::Mesh,
        replay::LoadedRecipe,
        session::Session,
        tool::Tool,
    };
}
