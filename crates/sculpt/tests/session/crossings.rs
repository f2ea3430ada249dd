//! No stroke leaves triangles that cross and did not cross in the mesh as opened.

use std::path::Path;

use glam::dvec3;
use isochore_mesh::{Bvh, SelfIntersections, io, primitives::box_mesh, triangles_intersect};
use isochore_sculpt::{replay_points, session::StrokeReceipt};

use super::{random_calls::Numbers, *};

/// A session whose surface is checked after each stroke.
struct Certified {
    session: Session,
    /// Search structure over the mesh as opened.
    opened: Bvh,
    numbers: Numbers,
    size: f64,
    receipts: Vec<StrokeReceipt>,
}

/// A path of the tool.
#[derive(Debug, Clone, Copy)]
enum Motion {
    /// Straight into the surface.
    Press,
    /// Along the surface, at the height of the tool.
    Drag,
    /// Along the same line as the last drag, a little beside it.
    DragAgain,
}

impl Certified {
    fn new(mesh: TriMesh, seed: u64) -> Self {
        let opened = Bvh::new(&mesh.positions, &mesh.triangles).unwrap();
        let size = mesh.bounds().size().max_element();
        Self { session: open(mesh), opened, numbers: Numbers::new(seed), size, receipts: Vec::new() }
    }

    /// A ball of random size, at most a tenth of the model.
    fn tool(&mut self) -> Arc<SessionTool> {
        let radius = self.size * (0.03 + 0.07 * self.numbers.next());
        let shape = ToolShape::Sphere(Sphere { radius });
        let profile = if self.numbers.below(2) == 0 { Profile::Quintic } else { Profile::Contact };
        let tool = Tool { shape, support: radius * (0.5 + self.numbers.next()), profile, free_form: 0.0 };
        Arc::new(SessionTool::new("ball", tool, &Meshes::new(), &NoProgress).unwrap())
    }

    fn stroke(&mut self, motion: Motion, start: DVec3, along: DVec3) {
        let tool = self.tool();
        let radius = tool.tool().distance().bounds().max.x;
        let before = snapshot(&self.session);
        let center = self.session.opened().bounds().center();
        let Some(hit) = self.session.pick(center + 2.0 * self.size * start, -start) else { return };
        let mut at = hit.point + 1.2 * radius * hit.normal;
        self.session.begin_stroke(&tool, StrokeOptions::default()).unwrap();
        for step in 0..10 {
            self.session.move_to(&Pose::at(at), f64::from(step)).unwrap();
            at = match motion {
                Motion::Press => at - 0.3 * radius * hit.normal,
                Motion::Drag | Motion::DragAgain => {
                    let ahead = at + 0.4 * radius * along;
                    let near = self.session.closest_point(ahead).unwrap();
                    near.point + 0.9 * radius * (ahead - near.point).normalize_or(near.normal)
                }
            };
        }
        let receipt = self.session.end_stroke().unwrap();
        self.assert_certified(&receipt);
        let after = snapshot(&self.session);
        if receipt.stopped_at != Some(0.0) {
            assert!(self.session.undo().unwrap());
            assert_eq!(snapshot(&self.session), before);
            assert!(self.session.redo().unwrap());
        } else {
            assert_eq!(after, before);
        }
        assert_eq!(snapshot(&self.session), after);
        self.receipts.push(receipt);
    }

    fn assert_certified(&self, receipt: &StrokeReceipt) {
        assert_eq!(receipt.crossings, 0);
        assert!(receipt.stopped_at.is_none_or(|fraction| (0.0..1.0).contains(&fraction)), "{receipt:?}");
        assert!(receipt.stopped_at.is_some() || receipt.sheets.is_none());
        for is_locked in [false, true] {
            let mesh = self.session.export(is_locked).mesh;
            let check = mesh.check();
            assert!(check.is_closed() && check.is_oriented() && check.is_manifold() && check.is_valid(), "{check:?}");
            let found = SelfIntersections::of(&mesh, &NoProgress).unwrap();
            let new = found.pairs().iter().filter(|pair| self.is_new(**pair)).count();
            assert_eq!(new, 0, "with lock: {is_locked}, {receipt:?}");
        }
        // The points of the log end where the session has moved them.
        let opened = self.session.opened();
        let meshes = Meshes::from([("target".to_owned(), opened.clone().into())]);
        let points = replay_points(&self.session.log(), &meshes, &opened.positions, &NoProgress).unwrap().points;
        let alive = (0..opened.positions.len()).filter(|&vertex| self.session.is_alive(vertex as u32));
        assert!(alive.clone().count() > opened.positions.len() / 2);
        alive.for_each(|vertex| assert_eq!(points[vertex], self.session.positions()[vertex]));
    }

    /// Whether the opened triangles that contain two triangles of the export do not cross.
    fn is_new(&self, pair: [u32; 2]) -> bool {
        let parents = pair.map(|exported| {
            let mut alive =
                (0..self.session.buffers().indices.len() as u32).filter(|&t| self.session.triangle(t).is_some());
            let triangle = alive.nth(exported as usize).unwrap();
            let corners = self.session.buffers().indices[triangle as usize];
            let points = corners.map(|render| self.session.opened().point_at(&self.session.origin_of(render).unwrap()));
            self.opened.closest_point((points[0] + points[1] + points[2]) / 3.0).triangle
        });
        let [one, other] = parents.map(|parent| self.session.opened().corners(parent as usize));
        parents[0] == parents[1] || !triangles_intersect(one, other)
    }

    /// Makes random strokes.
    fn run(mesh: TriMesh, seed: u64, strokes: usize) -> Vec<StrokeReceipt> {
        let mut certified = Self::new(mesh, seed);
        let (mut start, mut along) = (DVec3::Z, DVec3::X);
        for _ in 0..strokes {
            let motion = [Motion::Press, Motion::Drag, Motion::DragAgain][certified.numbers.below(3)];
            if let Motion::DragAgain = motion {
                start = (start + 0.02 * certified.numbers.direction()).normalize();
            } else {
                start = certified.numbers.direction();
                along = start.cross(certified.numbers.direction()).normalize_or(start.any_orthonormal_vector());
            }
            certified.stroke(motion, start, along);
        }
        certified.receipts
    }
}

/// A plate whose sides are close to each other.
fn plate() -> TriMesh {
    box_mesh(dvec3(1.0, 1.0, 0.01), [16, 16, 1])
}

/// A ball with a spike that leaves it at the opposite side.
fn pierced() -> TriMesh {
    let mut mesh = icosphere(1.0, 3);
    mesh.positions.iter_mut().filter(|point| point.z > 0.95).for_each(|point| point.z -= 2.3);
    assert!(!SelfIntersections::of(&mesh, &NoProgress).unwrap().is_empty());
    mesh
}

/// A cube with a vertex on an edge, in a triangle without area.
fn with_degenerate_triangle() -> TriMesh {
    let mut mesh = box_mesh(DVec3::ONE, [4, 4, 4]);
    let [a, b, c] = mesh.triangles[0];
    let middle = mesh.positions.len() as u32;
    mesh.positions.push(0.5 * (mesh.positions[a as usize] + mesh.positions[b as usize]));
    mesh.triangles[0] = [a, middle, c];
    mesh.triangles.extend([[middle, b, c], [a, b, middle]]);
    mesh
}

/// A cube with two vertices that are nearly in the same place.
fn with_needle() -> TriMesh {
    let mut mesh = box_mesh(DVec3::ONE, [4, 4, 4]);
    let [a, b, c] = mesh.triangles[0];
    let twin = mesh.positions.len() as u32;
    let nearly = mesh.positions[a as usize].lerp(mesh.positions[b as usize], 1e-12);
    mesh.positions.push(nearly);
    mesh.triangles[0] = [a, twin, c];
    mesh.triangles.extend([[twin, b, c], [a, b, twin]]);
    mesh
}

fn read(name: &str) -> TriMesh {
    io::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name)).unwrap()
}

fn generated() -> Vec<TriMesh> {
    let balls = [1, 2, 3, 4].map(|level| icosphere(1.0, level));
    balls.into_iter().chain([plate(), pierced(), with_degenerate_triangle(), with_needle()]).collect()
}

#[test]
fn random_strokes_leave_no_new_crossings() {
    let mut receipts = Vec::new();
    for (seed, mesh) in (1..).zip(generated()) {
        receipts.extend(Certified::run(mesh, seed, 3));
    }
    let untangled = receipts.iter().filter(|receipt| receipt.certificate_seconds > 0.0).count();
    assert!(receipts.len() > 18 && untangled > 18, "{} {untangled}", receipts.len());
}

#[test]
#[ignore = "takes minutes"]
fn many_random_strokes_leave_no_new_crossings() {
    let scans = ["pawn.obj", "hare.obj", "hand.obj", "rocker_arm.obj", "coin.obj", "knight.obj"].map(read);
    let (mut count, mut stopped) = (0, 0);
    for (seed, mesh) in (100..).zip(generated().into_iter().chain(scans)) {
        let receipts = Certified::run(mesh, seed, 20);
        count += receipts.len();
        stopped += receipts.iter().filter(|receipt| receipt.stopped_at.is_some()).count();
    }
    assert!(20 * stopped <= count, "{stopped} of {count}");
}
