//! One merge of a vertex into a neighbor, and what it would change.

use glam::DVec3;
use isochore_mesh::nearest_on_triangle;

use crate::deform::{curved_triangle::edge_lengths, tessellation::Piece};

/// Least cosine between the normals of a part of an input triangle before and after. A larger value keeps flat triangles on
/// curved parts; a smaller value may fold small bumps.
const LEAST_TURN: f64 = 0.8;

/// A merge must not make a triangle of less than this quality (4√3 area / sum of squared edges) unless the
/// triangles before were no better. A larger value keeps more triangles; a smaller value makes slivers.
const QUALITY: f64 = 0.3;

/// A merge never makes a triangle of less than this quality: an angle of 0.2°. A larger value leaves slivers
/// beside those that cannot be merged; a smaller value lets rounding decide to which side a triangle faces.
const LEAST_QUALITY: f64 = 0.007;

/// Rounding of sums of barycentric areas.
const ROUNDING: f64 = 1e-9;

/// A merge of a vertex into a neighbor.
#[derive(Debug, Clone)]
pub(super) struct Collapse {
    pub(super) removed: u32,
    /// The pieces at the removed vertex, by index.
    pub(super) ring: Vec<u32>,
    /// The pieces that replace them.
    pub(super) pieces: Vec<Piece>,
    /// Bound of the distance between the surfaces before and after, model units.
    pub(super) deviation: f64,
    /// Change of the enclosed volume.
    pub(super) volume: f64,
}

/// The conditions of a merge.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Model units.
    pub(super) deviation: f64,
    /// Model units.
    pub(super) max_edge: f64,
}

/// The merge of `removed` that leaves the best triangles, or `None` if none is within the limits. `ring` holds
/// the pieces at the vertex, and `worn` is the distance that earlier merges have moved the surface there.
pub(super) fn best_collapse(
    removed: u32,
    ring: &[(u32, Piece)],
    image: &[DVec3],
    worn: f64,
    limits: &Limits,
) -> Option<Collapse> {
    let corners = |piece: &Piece| piece.vertices.map(|vertex| image[vertex as usize]);
    let worst = |pieces: &[Piece]| pieces.iter().map(|piece| quality(&corners(piece))).fold(f64::INFINITY, f64::min);
    let mut best: Option<(f64, Collapse)> = None;
    for kept in closed_fan(removed, ring)? {
        let Some(pieces) = merged(removed, kept, ring) else { continue };
        let quality = worst(&pieces);
        if best.as_ref().is_some_and(|(best, _)| quality <= *best) || !is_sound(&pieces, ring, image, limits) {
            continue;
        }
        let deviation = worn + distance_between(removed, kept, &pieces, ring, image);
        if deviation <= limits.deviation {
            let origin = image[removed as usize];
            // The pieces at the removed vertex have no volume with it.
            let volume = pieces.iter().map(|piece| volume_from(origin, corners(piece))).sum();
            let ring = ring.iter().map(|(index, _)| *index).collect();
            best = Some((quality, Collapse { removed, ring, pieces, deviation, volume }));
        }
    }
    best.map(|(_, collapse)| collapse)
}

/// The neighbors of a vertex if each is in two pieces of its ring, as inside a manifold surface.
fn closed_fan(vertex: u32, ring: &[(u32, Piece)]) -> Option<Vec<u32>> {
    let mut around: Vec<u32> =
        ring.iter().flat_map(|(_, piece)| piece.vertices).filter(|&other| other != vertex).collect();
    around.sort_unstable();
    let mut neighbors = around.clone();
    neighbors.dedup();
    let is_twice = |pair: &[u32]| pair.len() == 2 && pair[0] == pair[1];
    (neighbors.len() == ring.len() && around.chunks(2).all(is_twice)).then_some(neighbors)
}

/// The pieces after the merge, or `None` if they would not cover the same part of each input triangle.
fn merged(removed: u32, kept: u32, ring: &[(u32, Piece)]) -> Option<Vec<Piece>> {
    let mut pieces = Vec::with_capacity(ring.len());
    for (_, piece) in ring.iter().filter(|(_, piece)| !piece.vertices.contains(&kept)) {
        let weights = weights_of(kept, piece.parent, ring)?;
        let side = piece.vertices.iter().position(|&vertex| vertex == removed)?;
        let mut piece = *piece;
        piece.vertices[side] = kept;
        piece.corners[side] = weights;
        pieces.push(piece);
    }
    let is_covered = |parent: u32| {
        let of_parent = |piece: &&Piece| piece.parent == parent;
        let before: f64 = ring.iter().map(|(_, piece)| piece).filter(of_parent).map(share).sum();
        let after: f64 = pieces.iter().filter(of_parent).map(share).sum();
        (after - before).abs() <= ROUNDING * before
    };
    let is_positive = pieces.iter().all(|piece| share(piece) > 0.0);
    (is_positive && ring.iter().all(|(_, piece)| is_covered(piece.parent))).then_some(pieces)
}

/// Barycentric coordinates of a vertex in an input triangle, from the pieces at hand.
fn weights_of(vertex: u32, parent: u32, ring: &[(u32, Piece)]) -> Option<DVec3> {
    ring.iter()
        .filter(|(_, piece)| piece.parent == parent)
        .find_map(|(_, piece)| piece.vertices.iter().position(|&other| other == vertex).map(|side| piece.corners[side]))
}

/// The signed fraction of the input triangle that a piece covers.
fn share(piece: &Piece) -> f64 {
    let [a, b, c] = piece.corners;
    a.dot(b.cross(c))
}

/// Whether the new pieces are not folded, not too long, and not worse than those before.
fn is_sound(pieces: &[Piece], ring: &[(u32, Piece)], image: &[DVec3], limits: &Limits) -> bool {
    let corners = |piece: &Piece| piece.vertices.map(|vertex| image[vertex as usize]);
    let quality_before = ring.iter().map(|(_, piece)| quality(&corners(piece))).fold(f64::INFINITY, f64::min);
    let normals: Vec<(u32, DVec3)> = ring.iter().map(|(_, piece)| (piece.parent, normal(&corners(piece)))).collect();
    pieces.iter().all(|piece| {
        let corners = corners(piece);
        let normal = normal(&corners);
        let longest = edge_lengths(&corners).into_iter().fold(0.0, f64::max);
        longest <= limits.max_edge
            && quality(&corners) >= QUALITY.min(quality_before).max(LEAST_QUALITY)
            && normals.iter().all(|&(parent, before)| {
                parent != piece.parent || before == DVec3::ZERO || before.dot(normal) >= LEAST_TURN
            })
    })
}

/// The largest distance between the surfaces before and after, at the removed vertex and at the middles of
/// the new edges.
fn distance_between(removed: u32, kept: u32, pieces: &[Piece], ring: &[(u32, Piece)], image: &[DVec3]) -> f64 {
    let corners = |piece: &Piece| piece.vertices.map(|vertex| image[vertex as usize]);
    let from = |point: DVec3, triangles: &mut dyn Iterator<Item = [DVec3; 3]>| {
        triangles.map(|triangle| nearest_on_triangle(point, &triangle).1).fold(f64::INFINITY, f64::min).sqrt()
    };
    let mut farthest = from(image[removed as usize], &mut pieces.iter().map(corners));
    for piece in pieces {
        for &other in piece.vertices.iter().filter(|&&other| other != kept) {
            let middle = 0.5 * (image[kept as usize] + image[other as usize]);
            farthest = farthest.max(from(middle, &mut ring.iter().map(|(_, piece)| corners(piece))));
        }
    }
    farthest
}

fn normal([a, b, c]: &[DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

/// 4√3 area / sum of squared edges: one for equal edges.
fn quality(corners: &[DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let squares: f64 = edge_lengths(corners).map(|length| length * length).iter().sum();
    if squares == 0.0 { 0.0 } else { 2.0 * 3.0_f64.sqrt() * (b - a).cross(c - a).length() / squares }
}

/// Signed volume of the tetrahedron of a triangle and a point.
fn volume_from(origin: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    (a - origin).dot((b - origin).cross(c - origin)) / 6.0
}
