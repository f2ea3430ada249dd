//! Refinement: splits the base of the flow until its flat triangles stand for the curved image well enough.
//!
//! Three things split an edge: the image of its midpoint lies far from the middle of its ends; its image is long; or its
//! triangle holds so much of the volume between flat and curved that the whole would miss the volume asked for.

use isochore_mesh::{Aabb, Cancelled, Monitor, sum_terms};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::{
    Stroke,
    facet_error::{SHARE_SEEN, edge_lengths},
    tessellation::Tessellation,
};

/// When to split.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RefineOptions {
    /// Share of the mesh's volume at which the estimated facet error may stand. Open meshes have no volume and ignore it.
    pub volume: f64,
    /// Distance from an edge's image to the image of its midpoint that splits it, as a share of the longest side of the mesh's
    /// bounding box.
    pub deviation: f64,
    /// Length of an edge's image, in model units, that splits it; by default one and a half times the longest edge at rest.
    pub max_edge: Option<f64>,
    /// No split goes beyond this number of triangles.
    pub max_triangles: usize,
}

impl Default for RefineOptions {
    fn default() -> Self {
        Self { volume: 1e-4, deviation: 1e-3, max_edge: None, max_triangles: 2_000_000 }
    }
}

/// The criteria in model units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Criteria {
    volume: f64,
    deviation: f64,
    max_edge: f64,
    /// Length in the base of edges that are not split any more.
    shortest: f64,
    max_triangles: usize,
}

/// What the passes over one stroke have done.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Refinement {
    /// Vertices inserted.
    pub(crate) inserted: usize,
    /// Evaluations of the fields.
    pub(crate) evaluations: u64,
    /// Estimated signed volume between the flat triangles that are left and the curved image: what the flat ones lack.
    pub(crate) facet_error: f64,
    /// Whether the limit on triangles ended it.
    pub(crate) is_limited: bool,
}

/// A round divides what it splits by two, so this many divide any edge of a representable mesh down to rounding; it only ends
/// what a defect would keep going.
const MAX_ROUNDS: usize = 40;

/// An edge of the base of this share of the deviation allowed, whose image still deviates, is torn by a jump of the velocity: on
/// the medial axis of a concave tool, or of a thin one whose profile acts inside. Larger stops before strong but smooth
/// stretching is followed; smaller spends ever more triangles along the tear.
const TORN: f64 = 0.25;

/// A round aims at this share of the volume error allowed, so that what it leaves, being re-estimated on finer triangles, does
/// not call for one more round that splits a handful. Larger takes more rounds; smaller splits more than asked.
const AIM: f64 = 0.5;

/// No round tries to leave less than this share of the error it found: splitting everything leaves a quarter of it, and the
/// last triangles before that bring next to nothing.
const LEAST_LEFT: f64 = 1.0 / 3.0;

/// Edges of a triangle that is split for its volume, whose midpoint lies this share of the largest off its plane, are split.
/// Larger splits one edge a triangle and makes slivers; smaller splits flat directions of cylinders.
const SIGNIFICANT: f64 = 0.5;

/// Rounds of splitting triangles that cross: each halves the edges there, so this many divide them by four thousand. It only
/// ends what the other limits would keep going.
const MAX_UNTANGLING_ROUNDS: usize = 12;

/// Splitting triangles that cross may add this share of the triangles there are. Larger spends most of the mesh on sheets that
/// a profile without a rigid core squeezes ever thinner; smaller gives up on long creases.
const UNTANGLING_GROWTH: f64 = 1.0;

/// Triangles as long as this share of one that crosses, within the same triangle as read, are split with it. Larger lets folds
/// wander along rows of slivers; smaller splits what is fine already.
const AS_COARSE: f64 = 0.75;

/// Splitting goes on while two rounds leave at most this share of the area that crosses. Nearer to one it chases the error of the
/// time step; smaller gives up on sheets that take several rounds.
const WORTHWHILE: f64 = 0.9;

impl Criteria {
    /// The facet error at which refinement ends, cubic model units.
    pub(crate) fn volume(&self) -> f64 {
        self.volume
    }

    /// The same criteria with another facet error allowed.
    pub(crate) fn with_volume(self, volume: f64) -> Self {
        Self { volume, ..self }
    }

    /// No split goes beyond this number of triangles.
    pub(crate) fn max_triangles(&self) -> usize {
        self.max_triangles
    }

    /// The criteria for a mesh with the `image` it now has; `volume` is that of the closed mesh at rest, none of an open one.
    pub(crate) fn new(options: &RefineOptions, mesh: &Tessellation, volume: Option<f64>) -> Self {
        let deviation = options.deviation * Aabb::of(mesh.rest.iter().copied()).size().max_element();
        let longest =
            || (0..mesh.triangles.len()).flat_map(|index| edge_lengths(&mesh.image_of(index))).fold(0.0, f64::max);
        Self {
            volume: volume.map_or(f64::INFINITY, |volume| options.volume * volume.abs()),
            deviation,
            shortest: TORN * deviation,
            max_edge: options.max_edge.unwrap_or_else(|| 1.5 * longest()),
            max_triangles: options.max_triangles,
        }
    }
}

impl Refinement {
    /// Adds up what was spent.
    pub(crate) fn add(&mut self, other: &Self) {
        self.inserted += other.inserted;
        self.evaluations += other.evaluations;
        self.is_limited |= other.is_limited;
    }

    /// Splits the chosen edges, unless that would pass the limit on triangles; returns whether it did.
    fn split(&mut self, mesh: &mut Tessellation, is_split: &[bool], criteria: &Criteria) -> bool {
        self.is_limited = mesh.triangles_after(is_split) > criteria.max_triangles;
        if !self.is_limited {
            self.inserted += mesh.split(is_split);
        }
        !self.is_limited
    }
}

/// Splits triangles in the way of `stroke`, before it acts, until its field cannot slip through between their vertices.
pub(crate) fn resolve_field(
    mesh: &mut Tessellation,
    past: &[Stroke],
    stroke: &Stroke,
    criteria: &Criteria,
    monitor: &dyn Monitor,
) -> Result<Refinement, Cancelled> {
    split_long_edges(mesh, past, criteria, monitor, |mesh| {
        let long_edges = |index| {
            let corners = mesh.image_of(index);
            let center = (corners[0] + corners[1] + corners[2]) / 3.0;
            let radius = corners.iter().map(|corner| corner.distance(center)).fold(0.0, f64::max);
            let allowed = stroke.feature_size_near(center, radius);
            let is_long = edge_lengths(&corners).map(|length| length > allowed);
            if is_long.contains(&true) && stroke.may_touch(center, radius) { is_long } else { [false; 3] }
        };
        (0..mesh.triangles.len()).into_par_iter().map(long_edges).collect()
    })
}

/// Splits triangles until none has an edge that `long_edges` finds too long. It is asked again after every round, and answers
/// for the edges 01, 12 and 20 of every triangle.
pub(crate) fn split_long_edges(
    mesh: &mut Tessellation,
    strokes: &[Stroke],
    criteria: &Criteria,
    monitor: &dyn Monitor,
    mut long_edges: impl FnMut(&Tessellation) -> Vec<[bool; 3]>,
) -> Result<Refinement, Cancelled> {
    let mut refinement = Refinement::default();
    for _ in 0..MAX_ROUNDS {
        monitor.check("refine", 0.0)?;
        let is_long = long_edges(mesh);
        if is_long.iter().all(|edges| *edges == [false; 3]) {
            break;
        }
        refinement.evaluations += mesh.track(strokes, |_, index| is_long[index] != [false; 3], monitor)?;
        let mut is_split = vec![false; mesh.midpoint_count()];
        for (index, is_long) in is_long.into_iter().enumerate().filter(|(_, edges)| *edges != [false; 3]) {
            let Some(midpoints) = mesh.midpoints_of(index) else { continue };
            for (midpoint, is_long) in midpoints.into_iter().zip(is_long) {
                is_split[midpoint as usize] |= is_long;
            }
        }
        refinement.evaluations += add_longest_edges(mesh, strokes, &mut is_split, monitor)?;
        if !refinement.split(mesh, &is_split, criteria) {
            break;
        }
    }
    Ok(refinement)
}

/// Splits until the image under `strokes`, the last of which has just acted, meets the criteria; without criteria only
/// estimates the facet error.
pub(crate) fn refine(
    mesh: &mut Tessellation,
    strokes: &[Stroke],
    criteria: Option<&Criteria>,
    monitor: &dyn Monitor,
) -> Result<Refinement, Cancelled> {
    let mut refinement = Refinement::default();
    for round in 0..MAX_ROUNDS {
        monitor.check("refine", round as f64 / MAX_ROUNDS as f64)?;
        refinement.evaluations += mesh.track(strokes, has_moved, monitor)?;
        let gains: Vec<f64> = (0..mesh.triangles.len())
            .into_par_iter()
            .map(|index| mesh.curved(index).map_or(0.0, |curved| curved.volume_gain()))
            .collect();
        refinement.facet_error = sum_terms(gains.len(), |index| [gains[index]])[0] / SHARE_SEEN;
        let Some(criteria) = criteria else { break };

        let mut is_split = edges_to_split(mesh, criteria, &gains, refinement.facet_error);
        if !is_split.contains(&true) {
            break;
        }
        refinement.evaluations += add_longest_edges(mesh, strokes, &mut is_split, monitor)?;
        if !refinement.split(mesh, &is_split, criteria) {
            break;
        }
    }
    Ok(refinement)
}

/// Splits triangles whose images cross although those in the base do not, as long as that helps.
///
/// The exact image of a surface that does not cross itself does not either, so what crosses are flat triangles that cut
/// through a neighboring sheet, or the error of the time step, which splitting does not mend.
pub(crate) fn untangle(
    mesh: &mut Tessellation,
    strokes: &[Stroke],
    criteria: &Criteria,
    monitor: &dyn Monitor,
) -> Result<Refinement, Cancelled> {
    let mut refinement = Refinement::default();
    let mut areas = [f64::INFINITY; 2];
    let most = mesh.triangles.len() + (UNTANGLING_GROWTH * mesh.triangles.len() as f64) as usize;
    for round in 0..MAX_UNTANGLING_ROUNDS {
        monitor.check("untangle", round as f64 / MAX_UNTANGLING_ROUNDS as f64)?;
        let crossing = mesh.new_crossings(monitor)?;
        let area = mesh.image_area(&crossing);
        // Compared over two rounds: the first split of a sliver may only turn its fold over.
        if crossing.is_empty() || area > WORTHWHILE * areas[0] {
            break;
        }
        areas = [areas[1], area];
        // With all that is as coarse in the same triangles as read: at the end of a split row of slivers the next one folds.
        let mut coarsest: FxHashMap<u32, f64> = FxHashMap::default();
        for &index in &crossing {
            let length = coarsest.entry(mesh.triangles[index as usize].parent).or_insert(0.0);
            *length = length.max(mesh.longest_base_edge(index as usize));
        }
        let is_wanted = |mesh: &Tessellation, index: usize| {
            let coarsest = coarsest.get(&mesh.triangles[index].parent);
            coarsest.is_some_and(|&length| mesh.longest_base_edge(index) > AS_COARSE * length)
        };
        refinement.evaluations += mesh.track(strokes, is_wanted, monitor)?;
        let mut is_split = vec![false; mesh.midpoint_count()];
        for index in (0..mesh.triangles.len()).filter(|&index| is_wanted(mesh, index)) {
            for midpoint in mesh.midpoints_of(index).into_iter().flatten() {
                is_split[midpoint as usize] = true;
            }
        }
        refinement.evaluations += add_longest_edges(mesh, strokes, &mut is_split, monitor)?;
        if mesh.triangles_after(&is_split) > most {
            break;
        }
        if !refinement.split(mesh, &is_split, criteria) {
            break;
        }
    }
    Ok(refinement)
}

/// Wherever a triangle is split, has the longest edge of its image split too, and so on through the neighbors: a bisection at
/// least, as M.-C. Rivara, *Algorithms for refining triangular grids suitable for adaptive and multigrid techniques*, 1984.
///
/// Without this a triangle can lose its two shorter edges again and again, its longest always just within the criteria, and
/// shrink to a sliver along it, to no end. Where the image is so stretched that this happens in the base all the same, the
/// longest edge there is split.
fn add_longest_edges(
    mesh: &mut Tessellation,
    strokes: &[Stroke],
    is_split: &mut Vec<bool>,
    monitor: &dyn Monitor,
) -> Result<u64, Cancelled> {
    let mut evaluations = 0;
    loop {
        let known = mesh.midpoint_count();
        evaluations += mesh.track(strokes, |mesh, index| mesh.is_triangle_split(index, is_split), monitor)?;
        is_split.resize(mesh.midpoint_count(), false);
        let mut has_changed = mesh.midpoint_count() > known;
        for index in 0..mesh.triangles.len() {
            if !mesh.is_triangle_split(index, is_split) {
                continue;
            }
            let Some(midpoints) = mesh.midpoints_of(index) else { continue };
            let lengths = if mesh.is_sliver_in_base(index) {
                edge_lengths(&mesh.base_of(index))
            } else {
                edge_lengths(&mesh.image_of(index))
            };
            let longest = (0..3).fold(0, |longest, edge| if lengths[edge] > lengths[longest] { edge } else { longest });
            let chosen = &mut is_split[midpoints[longest] as usize];
            has_changed |= !*chosen;
            *chosen = true;
        }
        if !has_changed {
            return Ok(evaluations);
        }
    }
}

fn has_moved(mesh: &Tessellation, triangle: usize) -> bool {
    mesh.triangles[triangle].vertices.iter().any(|&vertex| mesh.image[vertex as usize] != mesh.base[vertex as usize])
}

/// By number of midpoint, whether its edge is to be split.
fn edges_to_split(mesh: &Tessellation, criteria: &Criteria, gains: &[f64], facet_error: f64) -> Vec<bool> {
    let mut is_split = vec![false; mesh.midpoint_count()];
    for index in 0..mesh.triangles.len() {
        let (Some(curved), Some(midpoints)) = (mesh.curved(index), mesh.midpoints_of(index)) else { continue };
        let (deviations, lengths) = (curved.deviations(), curved.lengths());
        let base_lengths = edge_lengths(&mesh.base_of(index));
        for edge in 0..3 {
            let is_wanted = deviations[edge].length() > criteria.deviation || lengths[edge] > criteria.max_edge;
            is_split[midpoints[edge] as usize] |= is_wanted && base_lengths[edge] > criteria.shortest;
        }
    }
    for index in triangles_to_split(gains, facet_error, criteria.volume) {
        let (Some(curved), Some(midpoints)) = (mesh.curved(index), mesh.midpoints_of(index)) else { continue };
        let normal = curved.normal();
        let heights = curved.deviations().map(|deviation| deviation.dot(normal).abs());
        let least = SIGNIFICANT * heights.into_iter().fold(0.0, f64::max);
        for edge in 0..3 {
            is_split[midpoints[edge] as usize] |= heights[edge] >= least;
        }
    }
    is_split
}

/// The fewest triangles, by their share of the facet error, whose split should bring it well below what is `allowed`.
fn triangles_to_split(gains: &[f64], facet_error: f64, allowed: f64) -> Vec<usize> {
    if facet_error.abs() <= allowed {
        return Vec::new();
    }
    let goal = (AIM * allowed).max(LEAST_LEFT * facet_error.abs());
    let mut order: Vec<usize> = (0..gains.len()).filter(|&index| gains[index] != 0.0).collect();
    order.par_sort_unstable_by(|&a, &b| gains[b].abs().total_cmp(&gains[a].abs()).then(a.cmp(&b)));
    let mut left = facet_error;
    let enough = order.iter().position(|&index| {
        left -= gains[index];
        left.abs() <= goal
    });
    order.truncate(enough.map_or(order.len(), |last| last + 1));
    order
}
