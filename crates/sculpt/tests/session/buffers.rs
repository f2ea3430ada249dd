use isochore_sculpt::session::{Changes, DirtyRange, NormalWeights};

use super::*;

/// A host's copy of the buffers, updated only by changes.
#[derive(Debug, Default, PartialEq)]
struct Copy {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<Vec<[f32; 2]>>,
    colors: Vec<[f32; 4]>,
    indices: Vec<[u32; 3]>,
}

fn apply<T: Clone + Default>(copy: &mut Vec<T>, buffer: &[T], ranges: &[DirtyRange]) {
    copy.resize(buffer.len(), T::default());
    for range in ranges {
        let range = range.start as usize..range.end as usize;
        copy[range.clone()].clone_from_slice(&buffer[range]);
    }
}

impl Copy {
    fn update(&mut self, session: &mut Session) -> Changes {
        let changes = session.take_changes();
        let buffers = session.buffers();
        assert_eq!(changes.generation, buffers.generation);
        apply(&mut self.positions, buffers.positions, &changes.positions);
        apply(&mut self.normals, buffers.normals, &changes.normals);
        self.uvs.resize(buffers.uvs.len(), Vec::new());
        for (copy, buffer) in self.uvs.iter_mut().zip(buffers.uvs) {
            apply(copy, buffer, &changes.attributes);
        }
        apply(&mut self.colors, buffers.colors, &changes.attributes);
        apply(&mut self.indices, buffers.indices, &changes.indices);
        changes
    }

    fn assert_equals(&self, session: &Session) {
        let buffers = session.buffers();
        let whole = Copy {
            positions: buffers.positions.to_vec(),
            normals: buffers.normals.to_vec(),
            uvs: buffers.uvs.to_vec(),
            colors: buffers.colors.to_vec(),
            indices: buffers.indices.to_vec(),
        };
        assert_eq!(*self, whole);
    }
}

#[test]
fn ranges_cover_all_changes() {
    let mut session = open(super::attributes::painted_ball());
    let mut copy = Copy::default();
    copy.update(&mut session);
    copy.assert_equals(&session);
    for round in 0..6 {
        session.begin_stroke(&brush(), refined(0.12)).unwrap();
        for pose in arc(0.8 * f64::from(round), 7) {
            session.move_to(&pose, 0.0).unwrap();
            copy.update(&mut session);
            copy.assert_equals(&session);
        }
        if round == 4 {
            session.cancel_stroke().unwrap();
        } else {
            session.end_stroke().unwrap();
        }
        copy.update(&mut session);
        copy.assert_equals(&session);
    }
    for step in [Session::undo, Session::undo, Session::redo, Session::undo, Session::redo, Session::redo] {
        step(&mut session).unwrap();
        copy.update(&mut session);
        copy.assert_equals(&session);
    }
    let nothing = copy.update(&mut session);
    assert_eq!(nothing, Changes { generation: nothing.generation, ..Changes::default() });
}

#[test]
fn ranges_are_few_and_small() {
    let mut session = open(icosphere(1.0, 6));
    session.take_changes();
    session.begin_stroke(&brush(), UNREFINED).unwrap();
    for pose in arc(0.0, 5) {
        let moved = session.move_to(&pose, 0.0).unwrap().moved_vertices;
        let changes = session.take_changes();
        let length =
            |ranges: &[DirtyRange]| ranges.iter().map(|range| (range.end - range.start) as usize).sum::<usize>();
        // Subdivision numbers the vertices of a patch in runs, level by level; near pages are
        // merged into one range.
        assert!(changes.positions.len() < 16, "{}", changes.positions.len());
        // Each page of a run contains some that move, and up to two pages between runs contain
        // none.
        assert!(length(&changes.positions) <= 6 * moved, "{moved}");
        assert_eq!(changes.indices, []);
    }
}

#[test]
fn addresses_change_only_with_the_generation() {
    let mut session = ball();
    let address = |session: &Session| (session.buffers().generation, session.buffers().positions.as_ptr() as usize);
    let (mut before, mut kept, mut moved) = (address(&session), 0, 0);
    for round in 0..40 {
        make(&mut session, &brush(), &refined(0.06), &arc(0.5 * f64::from(round), 4));
        let now = address(&session);
        if now.0 == before.0 {
            assert_eq!(now.1, before.1);
            kept += 1;
        } else {
            moved += 1;
        }
        before = now;
    }
    assert!(kept > 20 && moved > 0, "{kept} {moved}");
}

#[test]
fn normals_equal_those_of_the_exported_mesh() {
    let mut session =
        Session::open(icosphere(1.0, 3), SessionOptions { normals: NormalWeights::Angle, ..Default::default() })
            .unwrap();
    make(&mut session, &brush(), &refined(0.1), &arc(0.0, 9));
    let exported = session.export(true);
    let expected = exported.mesh.vertex_normals();
    for (index, &vertex) in exported.vertices.iter().enumerate() {
        // Without seams, a vertex and its render vertex have the same number.
        let normal = DVec3::from_array(session.buffers().normals[vertex as usize].map(f64::from));
        // Rounded to f32 once; angles are computed by another formula.
        assert!(normal.distance(expected[index]) < 1e-6, "vertex {vertex}");
    }
}
