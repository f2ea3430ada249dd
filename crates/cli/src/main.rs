//! The `isochore` command.
fn main() {}
