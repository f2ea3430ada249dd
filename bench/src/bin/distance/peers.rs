use glam::DVec3;
use isochore_mesh::TriMesh;
use parry3d::math::Vector as Vector32;
use parry3d::query::PointQuery as _;
use parry3d::shape::{TriMesh as Parry32, TriMeshFlags as Flags32};
use parry3d_f64::math::Vector as Vector64;
use parry3d_f64::query::PointQuery as _;
use parry3d_f64::shape::{TriMesh as Parry64, TriMeshFlags as Flags64};

/// A library that answers one signed distance at a time.
pub(crate) struct Peer {
    pub(crate) name: &'static str,
    /// Prepares the mesh.
    pub(crate) build: fn(&TriMesh) -> Query,
}

/// The signed distance to a prepared mesh.
pub(crate) type Query = Box<dyn Fn(DVec3) -> f64>;

/// All of them: exact, with signs, from pseudonormals, which is their fastest way.
pub(crate) const PEERS: [Peer; 2] =
    [Peer { name: "parry3d f32", build: parry32 }, Peer { name: "parry3d f64", build: parry64 }];

fn parry32(mesh: &TriMesh) -> Query {
    let vector = |p: DVec3| Vector32::new(p.x as f32, p.y as f32, p.z as f32);
    let points = mesh.positions.iter().map(|&p| vector(p)).collect();
    let peer = Parry32::with_flags(points, mesh.triangles.clone(), Flags32::ORIENTED).expect("a sound mesh");
    Box::new(move |point| {
        let point = vector(point);
        let projection = peer.project_local_point(point, false);
        let distance = f64::from((projection.point - point).length());
        if projection.is_inside { -distance } else { distance }
    })
}

fn parry64(mesh: &TriMesh) -> Query {
    let vector = |p: DVec3| Vector64::new(p.x, p.y, p.z);
    let points = mesh.positions.iter().map(|&p| vector(p)).collect();
    let peer = Parry64::with_flags(points, mesh.triangles.clone(), Flags64::ORIENTED).expect("a sound mesh");
    Box::new(move |point| {
        let point = vector(point);
        let projection = peer.project_local_point(point, false);
        let distance = (projection.point - point).length();
        if projection.is_inside { -distance } else { distance }
    })
}
