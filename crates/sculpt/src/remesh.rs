//! Remeshing a mesh without a session of its own.

use std::sync::Arc;

use isochore_mesh::{Cancelled, Monitor, TriMesh};

use crate::session::{OpenError, RemeshOptions, RemeshReceipt, Session, SessionError, SessionOptions};

/// Result of [`remesh`].
#[derive(Debug, Clone)]
pub struct Remeshed {
    /// The mesh, with all attributes.
    pub mesh: TriMesh,
    /// What was edited.
    pub receipt: RemeshReceipt,
}

/// Errors of [`remesh`].
#[derive(Debug, thiserror::Error)]
pub enum RemeshError {
    /// The mesh cannot be edited. The error names an edge or vertex.
    #[error(transparent)]
    Mesh(#[from] OpenError),
    /// A length or fraction is out of range.
    #[error(transparent)]
    Options(SessionError),
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Replaces the triangles of `mesh` by even ones on the same surface:
/// [`Session::remesh`](Session::remesh) for a mesh outside a session.
///
/// If every triangle has the same shading normal at its three corners, the mesh is flat-shaded. Such
/// normals do not mark edges to keep, and the result is flat-shaded as well.
///
/// # Errors
/// [`RemeshError`]. The mesh must be an oriented manifold surface, closed or open.
///
/// ```
/// use isochore_mesh::{NoProgress, primitives::icosphere};
/// use isochore_sculpt::{remesh, session::RemeshOptions};
///
/// let ball = icosphere(1.0, 4);
/// let options = RemeshOptions { edge_length: Some(0.15), ..RemeshOptions::default() };
/// let remeshed = remesh(ball.clone(), &options, &NoProgress)?;
/// assert!(remeshed.mesh.triangles.len() < ball.triangles.len());
/// assert!((remeshed.mesh.volume() / ball.volume() - 1.0).abs() < 1e-12);
/// # Ok::<(), isochore_sculpt::RemeshError>(())
/// ```
pub fn remesh(
    mesh: impl Into<Arc<TriMesh>>,
    options: &RemeshOptions,
    monitor: &dyn Monitor,
) -> Result<Remeshed, RemeshError> {
    let mut mesh: Arc<TriMesh> = mesh.into();
    let is_flat_shaded = is_flat_shaded(&mesh);
    if is_flat_shaded {
        Arc::make_mut(&mut mesh).corner.normals.clear();
    }
    let mut session = Session::open(mesh, SessionOptions::default())?;
    let receipt = session.remesh(options, monitor).map_err(|error| match error {
        SessionError::Cancelled(cancelled) => RemeshError::Cancelled(cancelled),
        error => RemeshError::Options(error),
    })?;
    let mut mesh = session.export(true).mesh;
    if is_flat_shaded {
        let normal = |triangle: usize| {
            let [a, b, c] = mesh.corners(triangle);
            [(b - a).cross(c - a).normalize_or_zero().as_vec3(); 3]
        };
        mesh.corner.normals = (0..mesh.triangles.len()).map(normal).collect();
    }
    Ok(Remeshed { mesh, receipt })
}

fn is_flat_shaded(mesh: &TriMesh) -> bool {
    let normals = &mesh.corner.normals;
    !normals.is_empty() && normals.iter().all(|[a, b, c]| a == b && b == c)
}
