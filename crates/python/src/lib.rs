//! Python interface: the module `isochore._native`, which the package `isochore` re-exports.

mod arrays;
mod attributes;
mod distance;
mod error;
mod keys;
mod mesh;
mod pickled;
mod remesh;
mod replay;
mod session;
mod tool;
mod watch;

use pyo3::prelude::*;

/// Native part of the package.
#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::{
        distance::DistanceField,
        error::{Cancelled, Error, RecipeError},
        mesh::Mesh,
        remesh::remesh,
        replay::LoadedRecipe,
        session::Session,
        tool::Tool,
    };
}
