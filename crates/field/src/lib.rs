//! Divergence-free velocity fields of moving tools, their flows, and the deformation of meshes by them.
