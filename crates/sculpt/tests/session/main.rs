//! Tests of the sculpting session.

mod attributes;
mod buffers;
mod crossings;
mod keys;
mod locking;
mod own_tools;
mod queries;
mod random_calls;
mod refinement;
mod replay;
mod reuse;
mod undo;

use std::sync::Arc;

use glam::{DQuat, DVec3};
use isochore_field::{Pose, rotation_from_vector};
use isochore_mesh::{NoProgress, Origin, TriMesh, primitives::icosphere};
use isochore_sculpt::{
    Meshes,
    recipe::{Capsule, Profile, Sphere, Tool, ToolShape},
    session::{InteractiveRefinement, Session, SessionOptions, SessionTool, StrokeOptions},
};

/// A brush of radius 0.2 and support 0.25.
fn brush() -> Arc<SessionTool> {
    let shape = ToolShape::Sphere(Sphere { radius: 0.2 });
    let tool = Tool { shape, support: 0.25, profile: Profile::Quintic, free_form: 0.0 };
    Arc::new(SessionTool::new("brush", tool, &Meshes::new(), &NoProgress).unwrap())
}

/// A longer tool with another profile.
fn rod() -> Arc<SessionTool> {
    let shape = ToolShape::Capsule(Capsule { radius: 0.1, half_length: 0.3 });
    let tool = Tool { shape, support: 0.3, profile: Profile::Contact, free_form: 0.0 };
    Arc::new(SessionTool::new("rod", tool, &Meshes::new(), &NoProgress).unwrap())
}

fn open(mesh: TriMesh) -> Session {
    Session::open(mesh, SessionOptions::default()).unwrap()
}

fn ball() -> Session {
    open(icosphere(1.0, 3))
}

/// Splits edges longer than `longest`, up to a limit on triangles: strokes that fold the surface
/// repeatedly would make it grow without end.
fn refined(longest: f64) -> StrokeOptions {
    let refine =
        InteractiveRefinement { longest: Some(longest), max_triangles: 60_000, ..InteractiveRefinement::default() };
    StrokeOptions { refine: Some(refine) }
}

const UNREFINED: StrokeOptions = StrokeOptions { refine: None };

/// Poses along an arc over the unit sphere, in and out of it, with increasing rotation.
fn arc(start: f64, count: usize) -> Vec<Pose> {
    let pose = |index: usize| {
        let angle = start + 0.06 * index as f64;
        let radius = 1.15 - 0.02 * index as f64;
        let at = DVec3::new(libm::cos(angle), libm::sin(angle), 0.3 * libm::sin(3.0 * start)) * radius;
        Pose { rotation: rotation_from_vector(DVec3::new(0.1, 0.2, 0.05) * index as f64), translation: at }
    };
    (0..count).map(pose).collect()
}

fn make(session: &mut Session, tool: &Arc<SessionTool>, options: &StrokeOptions, poses: &[Pose]) {
    session.begin_stroke(tool, options.clone()).unwrap();
    for (index, pose) in poses.iter().enumerate() {
        session.move_to(pose, index as f64).unwrap();
    }
    session.end_stroke().unwrap();
}

/// Everything that a host can see, bit for bit.
#[derive(Debug, Clone, PartialEq)]
struct Snapshot {
    positions: Vec<[u64; 3]>,
    offsets: Vec<[u64; 3]>,
    /// For each vertex of the mesh as opened, the vertex that represents it.
    vertex_map: Vec<u32>,
    /// For each render vertex, its vertex and origin.
    render: Vec<(u32, Option<Origin>)>,
    triangles: Vec<Option<[u32; 3]>>,
    render_positions: Vec<[u32; 3]>,
    normals: Vec<[u32; 3]>,
    uvs: Vec<Vec<[f32; 2]>>,
    colors: Vec<[f32; 4]>,
    indices: Vec<[u32; 3]>,
    volume: Option<u64>,
}

fn snapshot(session: &Session) -> Snapshot {
    let buffers = session.buffers();
    let wide = |values: &[DVec3]| values.iter().map(|value| value.to_array().map(f64::to_bits)).collect();
    let origins = |render: u32| (session.vertex_of(render), session.origin_of(render));
    let bits = |values: &[[f32; 3]]| values.iter().map(|value| value.map(f32::to_bits)).collect();
    Snapshot {
        positions: wide(session.positions()),
        offsets: wide(session.offsets()),
        vertex_map: session.vertex_map(),
        render: (0..buffers.positions.len() as u32).map(origins).collect(),
        triangles: (0..buffers.indices.len() as u32).map(|triangle| session.triangle(triangle)).collect(),
        render_positions: bits(buffers.positions),
        normals: bits(buffers.normals),
        uvs: buffers.uvs.to_vec(),
        colors: buffers.colors.to_vec(),
        indices: buffers.indices.to_vec(),
        volume: session.volume().map(f64::to_bits),
    }
}

/// The surface must be closed, oriented, manifold and finite.
fn assert_sound(session: &Session) {
    let check = session.export(false).mesh.check();
    assert!(check.is_closed() && check.is_oriented() && check.is_manifold() && check.is_valid(), "{check:?}");
    assert!(check.duplicate_triangles.is_empty(), "{check:?}");
}

#[test]
fn a_session_is_send() {
    fn is_send<T: Send>() {}
    is_send::<Session>();
}
