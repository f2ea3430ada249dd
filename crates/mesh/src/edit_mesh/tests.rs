use proptest::prelude::*;

use super::*;
use crate::TriMesh;
use crate::primitives::{box_mesh, icosphere};

/// A square of cells, which has a boundary.
fn square(cells: u32) -> TriMesh {
    let at = |x: u32, y: u32| glam::DVec3::new(f64::from(x), f64::from(y), 0.0);
    let index = |x: u32, y: u32| y * (cells + 1) + x;
    let positions = (0..=cells).flat_map(|y| (0..=cells).map(move |x| at(x, y))).collect();
    let cell = |x: u32, y: u32| {
        let [a, b, c, d] = [index(x, y), index(x + 1, y), index(x + 1, y + 1), index(x, y + 1)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..cells).flat_map(|y| (0..cells).flat_map(move |x| cell(x, y))).collect();
    TriMesh::new(positions, triangles)
}

fn edit_mesh(mesh: &TriMesh) -> EditMesh {
    EditMesh::new(&mesh.triangles, mesh.positions.len()).unwrap()
}

/// Checks the edited mesh against one constructed from its triangles.
fn assert_sound(mesh: &EditMesh) {
    let alive: Vec<[u32; 3]> = mesh.triangles().iter().filter(|t| t.is_alive()).map(|t| t.vertices).collect();
    assert_eq!(alive.len(), mesh.alive());
    let rebuilt = EditMesh::new(&alive, mesh.vertex_count()).expect("a manifold surface");
    for (half_edge, triangle) in mesh
        .triangles()
        .iter()
        .enumerate()
        .filter(|(_, t)| t.is_alive())
        .flat_map(|(i, t)| (0..3).map(move |s| (3 * i as u32 + s, t)))
    {
        let twin = triangle.twins[half_edge as usize % 3];
        if twin != NONE {
            assert_eq!((mesh.start(twin), mesh.end(twin)), (mesh.end(half_edge), mesh.start(half_edge)));
            assert_eq!(mesh.twin(twin), half_edge);
        }
    }
    for vertex in 0..mesh.vertex_count() as u32 {
        let ring = |mesh: &EditMesh| mesh.neighbors(vertex).collect::<Vec<_>>();
        let (mut edited, mut expected) = (ring(mesh), ring(&rebuilt));
        assert_eq!(mesh.is_boundary(vertex), rebuilt.is_boundary(vertex));
        edited.sort_unstable();
        expected.sort_unstable();
        assert_eq!(edited, expected, "around {vertex}");
        assert!(mesh.fan(vertex).all(|half_edge| mesh.start(half_edge) == vertex));
    }
}

/// The complete state that edits depend on.
#[derive(Debug, PartialEq)]
struct State {
    triangles: Vec<EditTriangle>,
    outgoing: Vec<u32>,
    alive: usize,
    free: [FreeSlots; 2],
}

impl State {
    fn of(mesh: &EditMesh) -> Self {
        Self {
            triangles: mesh.triangles().to_vec(),
            outgoing: mesh.outgoing.items().to_vec(),
            alive: mesh.alive(),
            free: [mesh.free_triangles.clone(), mesh.free_vertices.clone()],
        }
    }
}

/// Performs an edit chosen by two numbers, if allowed, and returns the change of the number of
/// triangles.
fn edit(mesh: &mut EditMesh, kind: u8, pick: u32) -> Option<isize> {
    let half_edge = pick % (3 * mesh.triangles().len() as u32);
    if !mesh.triangles()[half_edge as usize / 3].is_alive() {
        return None;
    }
    match kind % 3 {
        0 => Some(if mesh.split(half_edge).far.is_some() { 2 } else { 1 }),
        1 => mesh.can_flip(half_edge).then(|| {
            mesh.flip(half_edge);
            0
        }),
        _ => mesh.can_collapse(half_edge).then(|| {
            let count = mesh.collapse(half_edge).triangles.into_iter().filter(|&triangle| triangle != NONE).count();
            -(count as isize)
        }),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn edits_keep_a_manifold_surface_and_can_be_undone(
        closed in any::<bool>(),
        stretches in prop::collection::vec(prop::collection::vec((any::<u8>(), any::<u32>()), 1..60), 1..5),
    ) {
        let mesh = if closed { icosphere(1.0, 1) } else { square(4) };
        let mut edited = edit_mesh(&mesh);
        let mut states = vec![State::of(&edited)];
        let mut deltas = Vec::new();
        for edits in &stretches {
            let alive = edited.begin();
            let mut expected = alive as isize;
            for &(kind, pick) in edits {
                expected += edit(&mut edited, kind, pick).unwrap_or(0);
                prop_assert_eq!(edited.alive() as isize, expected);
            }
            deltas.push(edited.finish(alive));
            assert_sound(&edited);
            states.push(State::of(&edited));
        }
        for (delta, state) in deltas.iter_mut().zip(&states).rev() {
            edited.swap(delta);
            prop_assert_eq!(&State::of(&edited), state);
            assert_sound(&edited);
        }
        for (delta, state) in deltas.iter_mut().zip(&states[1..]) {
            edited.swap(delta);
            prop_assert_eq!(&State::of(&edited), state);
            assert_sound(&edited);
        }
    }
}

#[test]
fn split_orders_the_corners_as_documented() {
    let mut mesh = edit_mesh(&box_mesh(glam::DVec3::ONE, [1, 1, 1]));
    let (half_edge, twin) = (4, mesh.twin(4));
    let (start, end) = (mesh.start(half_edge), mesh.end(half_edge));
    let apexes = [half_edge, twin].map(|side| mesh.start(previous(side)));
    let split = mesh.split(half_edge);
    let corners = |triangle: u32| mesh.triangles()[triangle as usize].vertices;
    assert_eq!(corners(split.near[1]), [split.vertex, end, apexes[0]]);
    let far = split.far.unwrap();
    assert_eq!(corners(far[1]), [end, split.vertex, apexes[1]]);
    assert!(corners(split.near[0]).contains(&start) && corners(far[0]).contains(&start));
}

#[test]
fn slots_are_reused_after_the_recording_that_freed_them() {
    let mut mesh = edit_mesh(&icosphere(1.0, 1));
    let (vertices, triangles) = (mesh.vertex_count(), mesh.triangles().len());
    let record = |mesh: &mut EditMesh, edits: &dyn Fn(&mut EditMesh)| {
        let alive = mesh.begin();
        edits(mesh);
        mesh.finish(alive)
    };
    let collapse = |mesh: &mut EditMesh, vertex: u32| {
        let half_edge = mesh.fan(vertex).find(|&half_edge| mesh.can_collapse(half_edge)).unwrap();
        mesh.collapse(half_edge).triangles
    };
    // The slot of an original vertex is never reused, but those of its triangles are.
    record(&mut mesh, &|mesh| {
        let removed = collapse(mesh, 7);
        let split = mesh.split(mesh.outgoing(0));
        assert!(!removed.contains(&split.near[1]) && split.vertex as usize == vertices);
    });
    record(&mut mesh, &|mesh| assert_eq!(collapse(mesh, vertices as u32).len(), 2));
    let mut delta = record(&mut mesh, &|mesh| {
        let split = mesh.split(mesh.outgoing(0));
        assert_eq!(split.vertex as usize, vertices);
        assert!((split.near[1] as usize) < triangles && (split.far.unwrap()[1] as usize) < triangles);
    });
    assert_eq!((mesh.vertex_count(), mesh.triangles().len()), (vertices + 1, triangles + 2));
    // Undo frees the slots again, and they are the next to be used.
    mesh.swap(&mut delta);
    record(&mut mesh, &|mesh| assert_eq!(mesh.split(mesh.outgoing(5)).vertex as usize, vertices));
    assert_sound(&mesh);
}

#[test]
fn tetrahedron_allows_neither_collapse_nor_flip() {
    let mesh = EditMesh::new(&[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]], 4).unwrap();
    assert!((0..12).all(|half_edge| !mesh.can_collapse(half_edge) && !mesh.can_flip(half_edge)));
}

#[test]
fn collapse_of_a_boundary_edge_removes_one_triangle() {
    let mut mesh = edit_mesh(&square(2));
    // From the middle of the lower side to the right corner.
    let half_edge = mesh.half_edge(1, 2).unwrap();
    assert!(mesh.can_collapse(half_edge));
    assert_eq!(mesh.collapse(half_edge).triangles[1], NONE);
    assert_sound(&mesh);
    assert_eq!(mesh.alive(), 7);
    // An ear: the lower left corner has one triangle now, and two edges on the boundary.
    let ear = (0..9).find(|&vertex| mesh.is_boundary(vertex) && mesh.fan(vertex).count() == 1).unwrap();
    let half_edge = mesh.outgoing(ear);
    assert!(mesh.can_collapse(half_edge));
    mesh.collapse(half_edge);
    assert_sound(&mesh);
    // A vertex of the boundary is not merged into the interior, and a single triangle remains.
    let inward = (0..mesh.triangles().len() as u32 * 3)
        .filter(|&edge| mesh.triangles()[edge as usize / 3].is_alive() && mesh.twin(edge) != NONE);
    assert!(inward.filter(|&edge| mesh.is_boundary(mesh.start(edge))).all(|edge| !mesh.can_collapse(edge)));
    let island = EditMesh::new(&[[0, 1, 2]], 3).unwrap();
    assert!((0..3).all(|half_edge| !island.can_collapse(half_edge)));
}

#[test]
fn rejects_non_manifold_input() {
    let refused = |triangles: &[[u32; 3]], vertices| EditMesh::new(triangles, vertices).unwrap_err();
    assert_eq!(refused(&[[0, 1, 1]], 2), EditMeshError::RepeatedVertex { triangle: 0, vertex: 1 });
    assert_eq!(
        refused(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]], 5),
        EditMeshError::NonManifoldEdge { edge: [0, 1], triangles: 3 }
    );
    assert_eq!(refused(&[[0, 1, 2], [0, 1, 3]], 4), EditMeshError::Misoriented { edge: [0, 1], triangles: [0, 1] });
    assert_eq!(refused(&[[0, 1, 2], [0, 3, 4]], 5), EditMeshError::NonManifoldVertex { vertex: 0 });
}
