use isochore_mesh::CompensatedSum;
use isochore_sculpt::recipe::{Mask, Pin};

use super::*;

/// Pseudorandom numbers (D. Lehmer's generator with the multiplier of L'Ecuyer's table, 1999).
pub(super) struct Numbers(u64);

impl Numbers {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(super) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(0xd134_2543_de82_ef95).wrapping_add(1);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(super) fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize
    }

    pub(super) fn direction(&mut self) -> DVec3 {
        DVec3::new(self.next() - 0.5, self.next() - 0.5, self.next() - 0.5).normalize_or(DVec3::X)
    }
}

/// A session with its expected state.
struct Checked {
    session: Session,
    options: SessionOptions,
    numbers: Numbers,
    tools: [Arc<SessionTool>; 2],
    /// Expected states after undo and redo.
    done: Vec<Snapshot>,
    undone: Vec<Snapshot>,
    now: Snapshot,
    pose: Pose,
    time: f64,
    strokes: usize,
    forgotten: usize,
    /// Maximum number of triangles during the stroke under way.
    most: usize,
    locked: usize,
    edits: [usize; 3],
}

impl Checked {
    fn call(&mut self) {
        let is_under_way = self.session.is_stroke_under_way();
        match self.numbers.below(40) {
            0..=30 if is_under_way => self.move_on(),
            31..=32 if is_under_way => {
                self.session.cancel_stroke().unwrap();
                assert_eq!(snapshot(&self.session), self.now);
            }
            33..=35 if is_under_way => self.end(),
            0..=20 => self.begin(),
            21..=28 => self.step(Session::undo, true),
            29..=32 => self.step(Session::redo, false),
            33 => drop(self.session.take_changes()),
            34 => {
                let direction = self.numbers.direction();
                assert!(self.session.pick(5.0 * direction, -direction).is_some());
            }
            35 => assert_eq!(self.session.log().strokes.len(), self.forgotten + self.done.len()),
            36 => {
                let count = self.session.vertex_count();
                let frozen: Vec<u32> = (0..self.numbers.below(3)).map(|_| self.numbers.below(count) as u32).collect();
                self.session.freeze_edges(&frozen).unwrap();
            }
            37 => drop(self.session.move_to(&Pose::at(DVec3::NAN), self.time).unwrap_err()),
            _ => assert!(self.session.closest_point(self.pose.translation).is_some()),
        }
        let history = self.session.history();
        assert!(history.bytes <= self.options.undo_bytes || history.undoable + history.redoable == 1, "{history:?}");
        assert_eq!((history.undoable, history.redoable), (self.done.len(), self.undone.len()));
    }

    fn begin(&mut self) {
        if self.session.is_stroke_under_way() {
            return;
        }
        let keep = match self.numbers.below(3) {
            0 => vec![(self.numbers.direction(), 0.3 * self.numbers.next())],
            _ => Vec::new(),
        };
        let refine = InteractiveRefinement {
            longest: Some(0.1 + 0.2 * self.numbers.next()),
            deviation: None,
            collapse: 0.4 * self.numbers.next(),
            flip: self.numbers.below(4) > 0,
            max_triangles: 1000 + self.numbers.below(5000),
            keep,
        };
        self.most = refine.max_triangles.max(self.session.triangle_count());
        let options = StrokeOptions { refine: (self.numbers.below(4) > 0).then_some(refine) };
        self.session.begin_stroke(&self.tools[self.strokes % 2], options).unwrap();
        self.strokes += 1;
        self.pose = Pose::at(self.numbers.direction() * (0.8 + 0.5 * self.numbers.next()));
        self.session.move_to(&self.pose, self.time).unwrap();
    }

    fn move_on(&mut self) {
        let turn = self.numbers.direction() * self.numbers.next();
        let shift = self.numbers.direction() * (0.2 * self.numbers.next());
        // Pull the tool back towards the surface.
        let pull = self.pose.translation.normalize_or_zero() - self.pose.translation;
        self.pose.translation += shift + 0.2 * pull;
        self.pose.rotation = rotation_from_vector(turn) * self.pose.rotation;
        self.time += self.numbers.next();
        self.session.move_to(&self.pose, self.time).unwrap();
        assert!(self.session.positions().iter().all(|position| position.is_finite()));
        // Untangling has a reserve.
        assert!(self.session.triangle_count() <= self.most + self.most / 10);
    }

    fn end(&mut self) {
        let before = self.session.volume();
        let receipt = self.session.end_stroke().unwrap();
        self.edits[0] += receipt.inserted_vertices;
        self.edits[1] += receipt.removed_vertices;
        self.edits[2] += receipt.flipped_edges;
        if receipt.moves == 0 {
            assert_eq!(snapshot(&self.session), self.now);
            return;
        }
        self.assert_sound();
        assert_eq!(before.is_some(), receipt.volume.is_some());
        if let (Some(before), Some(volume)) = (before, receipt.volume) {
            let after = self.session.export(false).mesh.volume();
            let mut expected = CompensatedSum::default();
            [before, volume.total()].into_iter().for_each(|part| expected.add(part));
            // Each stroke so far has added at most its bound on rounding, and the sum itself rounds
            // too.
            let tolerance = volume.rounding * (self.forgotten + self.done.len() + 1) as f64 + 1e-13;
            assert!((after - expected.value()).abs() < tolerance, "{volume:?}: {after} {}", expected.value());
            if receipt.lock_max_shift.is_some() {
                self.locked += 1;
                let shown = self.session.export(true).mesh.volume();
                assert!((shown - self.session.opened().volume()).abs() < tolerance, "{receipt:?}: {shown}");
            }
        }
        self.undone.clear();
        let now = snapshot(&self.session);
        self.done.push(std::mem::replace(&mut self.now, now));
        self.done.drain(..receipt.forgotten_strokes);
        self.forgotten += receipt.forgotten_strokes;
    }

    fn assert_sound(&self) {
        if self.session.volume().is_some() {
            return assert_sound(&self.session);
        }
        let check = self.session.export(false).mesh.check();
        assert!(!check.is_closed() && check.is_oriented() && check.is_manifold() && check.is_valid(), "{check:?}");
    }

    fn step(&mut self, step: fn(&mut Session) -> Result<bool, isochore_sculpt::session::SessionError>, is_undo: bool) {
        if self.session.is_stroke_under_way() {
            assert!(step(&mut self.session).is_err());
            return;
        }
        let (from, to) = if is_undo { (&mut self.done, &mut self.undone) } else { (&mut self.undone, &mut self.done) };
        let expected = from.pop();
        assert_eq!(step(&mut self.session).unwrap(), expected.is_some());
        if let Some(expected) = expected {
            to.push(std::mem::replace(&mut self.now, expected));
        }
        assert_eq!(snapshot(&self.session), self.now);
        self.assert_sound();
    }
}

#[test]
fn random_calls_keep_the_surface_sound() {
    let mut edits = [0; 3];
    let (mut forgotten, mut locked) = (0, 0);
    let mut cut = super::attributes::painted_ball();
    // Cut one hole.
    for index in (0..cut.triangles.len()).rev() {
        if cut.triangles[index].iter().all(|&vertex| cut.positions[vertex as usize].x > 0.8) {
            cut.triangles.remove(index);
            cut.triangle_materials.remove(index);
            cut.corner.normals.remove(index);
            cut.corner.uvs[0].remove(index);
        }
    }
    let pin = Pin { center: [0.0, 0.0, 1.0], radius: 0.2, support: 0.3 };
    let masked = Mask { pins: vec![pin], ..Mask::default() };
    let options = SessionOptions::default();
    let (plain, painted) = (|| icosphere(1.0, 2), super::attributes::painted_ball);
    let sessions = [
        (plain(), options.clone()),
        (painted(), options.clone()),
        (plain(), SessionOptions { undo_bytes: 300_000, ..options.clone() }),
        (painted(), SessionOptions { undo_bytes: 300_000, lock: false, ..options.clone() }),
        (plain(), SessionOptions { mask: masked, ..options.clone() }),
        (cut, options),
    ];
    for (seed, (mesh, options)) in (0..).zip(sessions) {
        let session = Session::open(mesh, options.clone()).unwrap();
        let mut checked = Checked {
            now: snapshot(&session),
            session,
            options,
            numbers: Numbers(seed + 1),
            tools: [brush(), rod()],
            done: Vec::new(),
            undone: Vec::new(),
            pose: Pose::IDENTITY,
            time: 0.0,
            strokes: 0,
            forgotten: 0,
            locked: 0,
            most: usize::MAX,
            edits: [0; 3],
        };
        for _ in 0..2000 {
            checked.call();
        }
        assert!(checked.strokes > 50);
        (0..3).for_each(|kind| edits[kind] += checked.edits[kind]);
        forgotten += checked.forgotten;
        locked += checked.locked;
    }
    assert!(forgotten > 10 && locked > 50, "{forgotten} {locked}");
    assert!(edits.iter().all(|&count| count > 20), "{edits:?}");
}
