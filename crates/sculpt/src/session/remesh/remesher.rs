//! The surface during a remesh.

use isochore_field::Mask;
use isochore_mesh::{Cancelled, Monitor, NONE, SelfIntersections, TriMesh};

use super::{
    change::Change,
    lines::{Freedom, Lines},
    reference::Reference,
    samples::Samples,
};
use crate::session::surface::Surface;

/// A surface that is remeshed, and what its edits must respect.
pub(super) struct Remesher<'a> {
    pub(super) surface: &'a mut Surface,
    /// The surface before the remesh.
    pub(super) reference: Reference,
    /// Target lengths of edges by vertex of the reference.
    pub(super) reference_lengths: Vec<f64>,
    /// The same at the beginning.
    pub(super) first_lengths: Vec<f64>,
    /// Points of the reference.
    pub(super) samples: Samples,
    /// Target lengths of edges by vertex.
    pub(super) lengths: Vec<f64>,
    pub(super) freedoms: Vec<Freedom>,
    /// For each vertex, a bound on the distance of the edges of lines at it from the lines of the
    /// reference.
    pub(super) slack: Vec<f64>,
    pub(super) lines: Lines,
    /// For each triangle, a triangle of the reference near it, on the same side of all lines.
    pub(super) anchors: Vec<u32>,
    /// Square of the largest distance from the reference at the samples.
    pub(super) allowance2: f64,
    pub(super) max_triangles: usize,
    /// Triangles that the tree does not know yet, and edited ones.
    pub(super) edited: Vec<u32>,
    pub(super) tally: Tally,
}

/// Number of edits.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Tally {
    pub(super) splits: usize,
    pub(super) collapses: usize,
    pub(super) flips: usize,
    pub(super) is_limited: bool,
}

/// Part of the allowed deviation that edits may use at the points where it is measured. Larger: the
/// surfaces could be farther apart between these points. Smaller: fewer edits.
const MEASURED: f64 = 0.75;

impl<'a> Remesher<'a> {
    /// Prepares a remesh of the whole surface. `lengths_of` returns target lengths by vertex of the
    /// reference.
    pub(super) fn new(
        surface: &'a mut Surface,
        mask: Option<&Mask>,
        deviation: f64,
        max_triangles: usize,
        lengths_of: impl FnOnce(&Reference) -> Vec<f64>,
        monitor: &dyn Monitor,
    ) -> Result<Self, Cancelled> {
        let records = surface.topology.triangles();
        let region: Vec<u32> = (0..records.len() as u32).filter(|&t| records[t as usize].is_alive()).collect();
        let reference = Reference::new(surface, &region, deviation);
        let reference_lengths = lengths_of(&reference);
        let (triangles, vertices) = (records.len(), surface.positions.items().len());
        let mut lengths = vec![0.0; vertices];
        for (&vertex, &length) in reference.vertices.iter().zip(&reference_lengths) {
            lengths[vertex as usize] = length;
        }
        let mut lines = Lines(vec![0; triangles]);
        let mut anchors = vec![0; triangles];
        for (index, &triangle) in region.iter().enumerate() {
            lines.0[triangle as usize] = reference.lines.0[index];
            anchors[triangle as usize] = index as u32;
        }
        let homes = reference.samples(&reference_lengths, deviation);
        let (points, homes) = homes.into_iter().map(|(point, triangle)| (point, region[triangle as usize])).unzip();
        let samples = Samples::new(points, homes, triangles);
        let allowed = MEASURED * deviation;
        let mut remesher = Self {
            surface,
            reference,
            first_lengths: reference_lengths.clone(),
            reference_lengths,
            samples,
            lengths,
            freedoms: vec![Freedom::Free; vertices],
            slack: vec![0.0; vertices],
            lines,
            anchors,
            allowance2: allowed * allowed,
            max_triangles,
            edited: Vec::new(),
            tally: Tally::default(),
        };
        remesher.find_freedoms(mask, monitor)?;
        Ok(remesher)
    }

    fn find_freedoms(&mut self, mask: Option<&Mask>, monitor: &dyn Monitor) -> Result<(), Cancelled> {
        for (index, record) in self.reference.triangles.iter().enumerate() {
            for side in 0..3 {
                if self.reference.lines.is_line((3 * index + side) as u32) {
                    for end in [side, (side + 1) % 3] {
                        let vertex = self.reference.vertices[record.vertices[end] as usize];
                        self.freedoms[vertex as usize] = Freedom::OnLine;
                    }
                }
            }
        }
        for &vertex in &self.reference.vertices {
            if self.surface.is_frozen(vertex) {
                self.freedoms[vertex as usize] = Freedom::Frozen;
            } else if mask.is_some_and(|mask| mask.is_held(self.surface.position(vertex))) {
                self.freedoms[vertex as usize] = Freedom::Held;
            }
        }
        // Triangles that cross others already stay as they are. Otherwise their crossings would
        // count as new.
        for pair in self.crossings(monitor)? {
            for vertex in
                pair.into_iter().flat_map(|triangle| self.surface.topology.triangles()[triangle as usize].vertices)
            {
                self.freedoms[vertex as usize] = Freedom::Frozen;
            }
        }
        Ok(())
    }

    /// Pairs of triangles that cross.
    pub(super) fn crossings(&self, monitor: &dyn Monitor) -> Result<Vec<[u32; 2]>, Cancelled> {
        let alive = self.alive();
        if alive.is_empty() {
            return Ok(Vec::new());
        }
        let vertices = |&triangle: &u32| self.surface.topology.triangles()[triangle as usize].vertices;
        let mesh = TriMesh::new(self.surface.positions.items().to_vec(), alive.iter().map(vertices).collect());
        match SelfIntersections::of(&mesh, monitor) {
            Ok(found) => Ok(found.pairs().iter().map(|pair| pair.map(|index| alive[index as usize])).collect()),
            Err(isochore_mesh::SelfIntersectionError::Cancelled(cancelled)) => Err(cancelled),
            // All triangles of a session are valid.
            Err(isochore_mesh::SelfIntersectionError::Mesh(_)) => Ok(Vec::new()),
        }
    }

    /// All triangles.
    pub(super) fn alive(&self) -> Vec<u32> {
        let records = self.surface.topology.triangles();
        (0..records.len() as u32).filter(|&triangle| records[triangle as usize].is_alive()).collect()
    }

    /// The half-edge between two vertices, in either direction at the boundary.
    pub(super) fn half_edge(&self, [a, b]: [u32; 2]) -> Option<u32> {
        let topology = &self.surface.topology;
        if topology.outgoing(a) == NONE || topology.outgoing(b) == NONE {
            return None;
        }
        topology.half_edge(a, b).or_else(|| topology.half_edge(b, a))
    }

    /// Length of an edge relative to its target.
    pub(super) fn ratio(&self, half_edge: u32) -> f64 {
        let topology = &self.surface.topology;
        let [a, b] = [topology.start(half_edge), topology.end(half_edge)];
        let target = self.lengths[a as usize].min(self.lengths[b as usize]);
        self.surface.position(a).distance(self.surface.position(b)) / target
    }

    /// Notes a vertex that a split has inserted between two others.
    pub(super) fn add_vertex(&mut self, vertex: u32, ends: [u32; 2], freedom: Freedom) {
        let count = self.lengths.len().max(vertex as usize + 1);
        self.lengths.resize(count, 0.0);
        self.freedoms.resize(count, Freedom::Free);
        self.slack.resize(count, 0.0);
        let [one, other] = ends.map(|end| self.lengths[end as usize]);
        self.lengths[vertex as usize] = 0.5 * (one + other);
        let [one, other] = ends.map(|end| self.slack[end as usize]);
        self.slack[vertex as usize] = one.max(other);
        self.freedoms[vertex as usize] = freedom;
    }

    /// Brings the tree up to date.
    pub(super) fn update_tree(&mut self) {
        let edited = std::mem::take(&mut self.edited);
        let changed = self.surface.triangles_around(&[], &edited);
        self.surface.update_tree(&changed);
    }

    /// Whether a change in which the surface does not move makes no triangles cross.
    pub(super) fn allows_flat(&self, change: &mut Change) -> bool {
        self.assign_samples(change, f64::INFINITY) && !self.crosses(change)
    }
}

impl Surface {
    /// Makes a triangle that was edited or has moved visible to queries of the tree.
    pub(super) fn enlarge_tree(&mut self, triangle: u32) {
        let triangles = self.topology.triangles();
        let record = &triangles[triangle as usize];
        let positions = &self.positions;
        let bounds = |triangle: u32| {
            let record = &triangles[triangle as usize];
            let corners = record.is_alive().then(|| record.vertices.map(|vertex| positions.get(vertex)));
            isochore_mesh::Aabb::of(corners.into_iter().flatten())
        };
        if record.is_alive() {
            let near = record.twins.map(|twin| if twin == NONE { NONE } else { twin / 3 });
            self.tree.enlarge(triangle, &bounds, near);
        }
    }
}
