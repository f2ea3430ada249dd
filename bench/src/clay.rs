//! A corpus of random strokes on arbitrary meshes, for the promises about crossings, triangles and
//! volume.
//!
//! A work is a recipe that depends only on the mesh and a number, so one that fails can be repeated
//! by the command.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};
use isochore_mesh::{Bvh, TriMesh};

/// Name of the target in the recipes of the corpus.
pub const TARGET: &str = "target.obj";

/// Kinds of strokes in the corpus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ClayStroke {
    /// A ball is pushed two to six radii into the surface.
    Push,
    /// A ball follows the surface.
    Follow,
    /// The whole mesh is twisted by up to half a turn.
    Twist,
    /// A strip along the surface carries material along it or is pushed across it.
    Strip,
}

impl ClayStroke {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Push, Self::Follow, Self::Twist, Self::Strip];

    /// The kind in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Push => "a ball pushed 2 to 6 radii deep",
            Self::Follow => "a ball that follows the surface",
            Self::Twist => "a twist by 20 to 180 degrees",
            Self::Strip => "a strip along or across",
        }
    }
}

/// A recipe with one random stroke of a kind on `mesh`, with the default options.
///
/// # Panics
/// If the mesh has no triangles.
pub fn clay_recipe(mesh: &TriMesh, kind: ClayStroke, number: u64) -> String {
    recipe_with(&[stroke(mesh, kind, &mut Numbers::new(number), 0)])
}

/// A recipe with `count` pushes on `mesh`.
///
/// # Panics
/// If the mesh has no triangles.
pub fn many_pushes(mesh: &TriMesh, count: usize, number: u64) -> String {
    let mut numbers = Numbers::new(number);
    let strokes: Vec<String> = (0..count)
        .map(|index| push(&Place::random(mesh, &mut numbers), size(mesh), [0.3, 1.2], &mut numbers, index))
        .collect();
    recipe_with(&strokes)
}

fn recipe_with(strokes: &[String]) -> String {
    format!("recipe = 1\n[target]\nmesh = \"{TARGET}\"\n{}", strokes.concat())
}

fn stroke(mesh: &TriMesh, kind: ClayStroke, numbers: &mut Numbers, index: usize) -> String {
    let size = size(mesh);
    match kind {
        ClayStroke::Push => push(&Place::random(mesh, numbers), size, [2.0, 6.0], numbers, index),
        ClayStroke::Follow => follow(mesh, size, numbers, index),
        ClayStroke::Twist => twist(mesh, numbers),
        ClayStroke::Strip => strip(mesh, size, numbers),
    }
}

/// The longest side of the bounds.
fn size(mesh: &TriMesh) -> f64 {
    mesh.bounds().size().max_element()
}

/// A ball is pushed into the surface, by a depth in radii between two limits.
fn push(place: &Place, size: f64, depth: [f64; 2], numbers: &mut Numbers, index: usize) -> String {
    let radius = size * numbers.between(0.03, 0.12);
    let support = radius * numbers.between(0.4, 1.2);
    let tilt = numbers.between(0.0, 0.7);
    let direction = place.turned(numbers.between(0.0, TAU)) * libm::sin(tilt) - place.normal * libm::cos(tilt);
    let start = place.point + place.normal * (radius + 0.6 * support);
    let end = start + direction * radius * numbers.between(depth[0], depth[1]);
    ball(radius, support, &[start, end], index)
}

/// A ball follows the surface, a little less than its radius above it.
fn follow(mesh: &TriMesh, size: f64, numbers: &mut Numbers, index: usize) -> String {
    let radius = size * numbers.between(0.03, 0.1);
    let support = radius * numbers.between(0.6, 1.2);
    let hierarchy = Bvh::new(&mesh.positions, &mesh.triangles).expect("the mesh has triangles");
    let mut place = Place::random(mesh, numbers);
    let mut direction = place.turned(numbers.between(0.0, TAU));
    let mut keys = Vec::new();
    for _ in 0..9 {
        keys.push(place.point + 0.9 * radius * place.normal);
        let closest = hierarchy.closest_point(place.point + 0.6 * radius * direction);
        place = Place { point: closest.point, normal: normal(mesh, closest.triangle as usize) };
        direction = direction.reject_from_normalized(place.normal).try_normalize().unwrap_or(place.turned(0.0));
    }
    ball(radius, support, &keys, index)
}

/// The whole mesh is twisted about an axis through its middle.
fn twist(mesh: &TriMesh, numbers: &mut Numbers) -> String {
    let (origin, axis) = (mesh.bounds().center(), numbers.direction());
    let degrees = numbers.between(20.0, 180.0) / size(mesh);
    format!(
        "[[stroke]]\nkind = \"twist\"\norigin = {}\naxis = {}\ndegrees_per_unit = {degrees}\n",
        list(origin),
        list(axis)
    )
}

/// A strip over the surface, along or across.
fn strip(mesh: &TriMesh, size: f64, numbers: &mut Numbers) -> String {
    let place = Place::random(mesh, numbers);
    let radius = size * numbers.between(0.03, 0.08);
    let support = radius * numbers.between(0.6, 1.2);
    let direction = place.turned(numbers.between(0.0, TAU));
    let middle = place.point + place.normal * radius * numbers.between(-0.5, 1.2);
    let bow = place.normal * size * numbers.between(0.0, 0.05);
    let point = |along: f64| middle + along * size * 0.12 * direction - along * along * bow;
    let spine: Vec<String> = [-1.5, -0.5, 0.5, 1.5].into_iter().map(|along| list(point(along))).collect();
    let distance = radius * numbers.between(0.5, 2.5);
    let across = list(-place.normal);
    let mode = if numbers.between(0.0, 1.0) < 0.5 {
        "mode = \"along\"".to_owned()
    } else {
        format!("mode = \"across\"\ndirection = {across}")
    };
    format!(
        "[[stroke]]\nkind = \"strip\"\n{mode}\nspine = [{}]\nradius = {radius}\nsupport = {support}\ndistance = {distance}\n",
        spine.join(", ")
    )
}

fn ball(radius: f64, support: f64, positions: &[DVec3], index: usize) -> String {
    let keys: Vec<String> = positions.iter().map(|&at| format!("{{ at = {} }}", list(at))).collect();
    format!(
        "[tools.ball{index}]\nshape = {{ kind = \"sphere\", radius = {radius} }}\nsupport = {support}\n\
         [[stroke]]\nkind = \"move\"\ntool = \"ball{index}\"\nkeys = [{}]\n",
        keys.join(", ")
    )
}

fn list(vector: DVec3) -> String {
    format!("[{}, {}, {}]", vector.x, vector.y, vector.z)
}

/// A point of the surface with its normal.
#[derive(Debug, Clone, Copy)]
struct Place {
    point: DVec3,
    normal: DVec3,
}

impl Place {
    /// The middle of a random triangle with area.
    fn random(mesh: &TriMesh, numbers: &mut Numbers) -> Self {
        loop {
            let triangle = numbers.below(mesh.triangles.len());
            let normal = normal(mesh, triangle);
            if normal != DVec3::ZERO {
                let [a, b, c] = mesh.corners(triangle);
                return Self { point: (a + b + c) / 3.0, normal };
            }
        }
    }

    /// A tangent, turned by an angle.
    fn turned(&self, angle: f64) -> DVec3 {
        let (one, other) = self.normal.any_orthonormal_pair();
        one * libm::cos(angle) + other * libm::sin(angle)
    }
}

fn normal(mesh: &TriMesh, triangle: usize) -> DVec3 {
    let [a, b, c] = mesh.corners(triangle);
    (b - a).cross(c - a).normalize_or_zero()
}

/// A sequence of numbers without structure.
///
/// Source: G. Steele, D. Lea, C. Flood, *Fast splittable pseudorandom number generators*, 2014
/// (SplitMix64).
#[derive(Debug, Clone)]
struct Numbers(u64);

impl Numbers {
    fn new(number: u64) -> Self {
        Self(number)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    fn direction(&mut self) -> DVec3 {
        let (height, angle) = (self.between(-1.0, 1.0), self.between(0.0, TAU));
        DQuat::from_rotation_z(angle) * DVec3::new((1.0 - height * height).sqrt(), 0.0, height)
    }
}
