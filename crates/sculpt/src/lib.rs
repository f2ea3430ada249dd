//! The stroke log, which is the recipe, and its replay on meshes and points.
