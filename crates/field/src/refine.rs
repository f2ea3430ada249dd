//! Refinement: splits the base of the flow until its flat triangles stand for the curved image well enough.
//!
//! Three things split an edge: the image of its midpoint lies far from the middle of its ends; its image is long; or its
//! triangle holds so much of the volume between flat and curved that the whole would miss the volume asked for.

use isochore_mesh::{Aabb, Cancelled, Monitor};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::{
    Stroke,
    facet_error::edge_lengths,
    tessellation::{ChosenEdges, Tessellation},
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
        let longest_of = |index: usize| edge_lengths(&mesh.image_of(index)).into_iter().fold(0.0, f64::max);
        let longest = || (0..mesh.triangles.len()).into_par_iter().map(longest_of).reduce(|| 0.0, f64::max);
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

    /// Splits the chosen edges, and the longest ones of the triangles at them, unless there is nothing to split or that would
    /// pass the limit on triangles. Returns the triangles that it made.
    fn split(
        &mut self,
        mesh: &mut Tessellation,
        strokes: &[Stroke],
        mut chosen: ChosenEdges,
        criteria: &Criteria,
        monitor: &dyn Monitor,
    ) -> Result<Option<Vec<u32>>, Cancelled> {
        if chosen.half_edges().is_empty() {
            return Ok(None);
        }
        add_longest_edges(mesh, &mut chosen);
        self.evaluations += mesh.advect_followed(strokes, monitor)?;
        self.is_limited = mesh.triangles.len() + chosen.added() > criteria.max_triangles;
        if self.is_limited {
            return Ok(None);
        }
        self.inserted += chosen.half_edges().len();
        Ok(Some(mesh.split(&chosen)))
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
    let reach = stroke.reach();
    let near = mesh.triangles_in(reach);
    split_long_edges(mesh, near, past, criteria, monitor, |mesh, triangles| {
        let long_edges = |&index: &u32| {
            let corners = mesh.image_of(index as usize);
            if !Aabb::of(corners).overlaps(reach) {
                return [None; 3];
            }
            let center = (corners[0] + corners[1] + corners[2]) / 3.0;
            let radius = corners.iter().map(|corner| corner.distance(center)).fold(0.0, f64::max);
            let allowed = stroke.feature_size_near(center, radius);
            let is_long = edge_lengths(&corners).map(|length| length > allowed);
            let is_met = is_long.contains(&true) && stroke.may_touch(center, radius);
            std::array::from_fn(|side| (is_met && is_long[side]).then_some(3 * index + side as u32))
        };
        triangles.par_iter().flat_map_iter(long_edges).flatten_iter().collect()
    })
}

/// Splits `triangles` until none has an edge that `long_edges` finds too long. It is asked for them, then for those that each
/// round has made, and answers with half-edges.
pub(crate) fn split_long_edges(
    mesh: &mut Tessellation,
    mut triangles: Vec<u32>,
    strokes: &[Stroke],
    criteria: &Criteria,
    monitor: &dyn Monitor,
    mut long_edges: impl FnMut(&Tessellation, &[u32]) -> Vec<u32>,
) -> Result<Refinement, Cancelled> {
    let mut refinement = Refinement::default();
    for _ in 0..MAX_ROUNDS {
        monitor.check("refine", 0.0)?;
        let mut chosen = ChosenEdges::default();
        long_edges(mesh, &triangles).into_iter().for_each(|half_edge| chosen.choose(mesh, half_edge));
        match refinement.split(mesh, strokes, chosen, criteria, monitor)? {
            Some(made) => triangles = made,
            None => break,
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
        let changed = mesh.take_changed();
        for &index in &changed {
            if mesh.has_moved(index as usize) {
                mesh.follow_edges_of(index);
            }
        }
        refinement.evaluations += mesh.advect_followed(strokes, monitor)?;
        // With the neighbors across the edges that are newly followed.
        mesh.put_back(&changed);
        let changed = mesh.take_changed();
        mesh.update_gains(&changed);
        refinement.facet_error = mesh.facet_error();
        let Some(criteria) = criteria else { break };

        let chosen = edges_to_split(mesh, criteria, &changed, refinement.facet_error);
        if refinement.split(mesh, strokes, chosen, criteria, monitor)?.is_none() {
            if refinement.is_limited {
                mesh.put_back(&changed);
            }
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
        let crossing = mesh.new_crossings(&mesh.image, monitor)?;
        let area = mesh.image_area(&crossing);
        // Compared over two rounds: the first split of a sliver may only turn its fold over.
        if crossing.is_empty() || area > WORTHWHILE * areas[0] {
            break;
        }
        areas = [areas[1], area];
        // With all that is as coarse in the same triangles as read: at the end of a split row of slivers the next one folds.
        let mut coarsest: FxHashMap<u32, f64> = FxHashMap::default();
        for &index in &crossing {
            let length = coarsest.entry(mesh.parent(index as usize)).or_insert(0.0);
            *length = length.max(mesh.longest_base_edge(index as usize));
        }
        let is_wanted = |index: usize| {
            let coarsest = coarsest.get(&mesh.parent(index));
            coarsest.is_some_and(|&length| mesh.longest_base_edge(index) > AS_COARSE * length)
        };
        let wanted: Vec<usize> = (0..mesh.triangles.len()).filter(|&index| is_wanted(index)).collect();
        let mut chosen = ChosenEdges::default();
        for half_edge in wanted.into_iter().flat_map(|index| 3 * index as u32..3 * index as u32 + 3) {
            chosen.choose(mesh, half_edge);
        }
        let limit = Criteria { max_triangles: criteria.max_triangles.min(most), ..*criteria };
        if refinement.split(mesh, strokes, chosen, &limit, monitor)?.is_none() {
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
fn add_longest_edges(mesh: &mut Tessellation, chosen: &mut ChosenEdges) {
    let mut place = 0;
    while let Some(&first) = chosen.half_edges().get(place) {
        let mut half_edge = first;
        loop {
            let triangle = half_edge as usize / 3;
            let lengths = if mesh.is_sliver_in_base(triangle) {
                edge_lengths(&mesh.base_of(triangle))
            } else {
                edge_lengths(&mesh.image_of(triangle))
            };
            let longest = (0..3).fold(0, |longest, edge| if lengths[edge] > lengths[longest] { edge } else { longest });
            chosen.choose(mesh, (3 * triangle + longest) as u32);
            half_edge = mesh.next_around(half_edge);
            if half_edge == first {
                break;
            }
        }
        place += 1;
    }
}

/// Of the triangles that have `changed` the edges that deviate or are too long, and of all the edges of those that hold too much
/// of the facet error.
fn edges_to_split(mesh: &mut Tessellation, criteria: &Criteria, changed: &[u32], facet_error: f64) -> ChosenEdges {
    let mut chosen = ChosenEdges::default();
    for &index in changed {
        let Some(curved) = mesh.curved(index as usize) else { continue };
        let (deviations, lengths) = (curved.deviations(), curved.lengths());
        let base_lengths = edge_lengths(&mesh.base_of(index as usize));
        for edge in 0..3 {
            let is_wanted = deviations[edge].length() > criteria.deviation || lengths[edge] > criteria.max_edge;
            if is_wanted && base_lengths[edge] > criteria.shortest {
                chosen.choose(mesh, 3 * index + edge as u32);
            }
        }
    }
    for index in triangles_to_split(mesh.gains(), facet_error, criteria.volume) {
        let Some(curved) = mesh.curved(index) else { continue };
        let normal = curved.normal();
        let heights = curved.deviations().map(|deviation| deviation.dot(normal).abs());
        let least = SIGNIFICANT * heights.into_iter().fold(0.0, f64::max);
        for edge in (0..3).filter(|&edge| heights[edge] >= least) {
            chosen.choose(mesh, (3 * index + edge) as u32);
        }
    }
    chosen
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
