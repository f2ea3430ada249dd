//! Collapses of short edges.

use glam::DVec3;
use isochore_mesh::{NONE, next_half_edge, previous_half_edge};

use super::{
    change::{Change, Replacement},
    lines::Freedom,
    passes::Action,
    remesher::Remesher,
    shape::direction,
    splits::LONG,
};

/// An edge is collapsed if it is shorter than this multiple of its target length; see
/// [`LONG`](super::splits::LONG). Larger: edges are collapsed that splits make again. Smaller: finer
/// than the target.
pub(super) const SHORT: f64 = 4.0 / 5.0;

/// Number of times that a pass examines edges whose surroundings have changed. Larger: dense scans
/// are coarsened in one pass, before any other edit improves their triangles. Smaller: more passes.
const MOST_SWEEPS: usize = 6;

/// Largest number of edges at a vertex after a collapse. Larger: thin triangles. Smaller: collapses
/// are refused that flips would put right.
const MOST_EDGES: usize = 10;

/// Cosine of the angle by which a line may turn at a removed vertex, 60°. Larger: curved lines are not
/// coarsened. Smaller: lines lose corners that are small compared with the allowed deviation.
const STRAIGHT: f64 = 0.5;

impl Remesher<'_> {
    /// Collapses edges of `triangles` that are too short, the shortest relative to its target first.
    pub(super) fn collapse(&mut self, mut triangles: Vec<u32>) {
        for _ in 0..MOST_SWEEPS {
            let short = self.ranked_edges(&triangles, |edge| Some(-self.ratio(edge)).filter(|&ratio| ratio > -SHORT));
            triangles = self.edit(&short, |remesher, ends, change| remesher.plan_collapse(ends, change));
            if triangles.is_empty() {
                break;
            }
        }
    }

    fn plan_collapse(&self, ends: [u32; 2], change: &mut Change) -> Option<(u32, Action)> {
        let half_edge = self.half_edge(ends).filter(|&edge| self.ratio(edge) < SHORT)?;
        if ends.map(|end| self.freedoms[end as usize]).contains(&Freedom::Frozen) {
            return None;
        }
        let topology = &self.surface.topology;
        let mut directions = [half_edge, topology.twin(half_edge)];
        // Inserted vertices, which have larger numbers, are removed first.
        let removed = |edge: u32| if edge == NONE { NONE } else { topology.start(edge) };
        if removed(directions[0]) < removed(directions[1]) && directions[1] != NONE {
            directions.swap(0, 1);
        }
        let positions = ends.map(|end| self.surface.position(end));
        if ends.map(|end| self.freedoms[end as usize]) == [Freedom::Free; 2] {
            let anchor = self.anchors[half_edge as usize / 3];
            let target = self.reference.foot(anchor, 0.5 * (positions[0] + positions[1])).point;
            if self.allows_collapse(directions[0], target, change) {
                return Some((directions[0], Action::Collapse { target, line: None }));
            }
        }
        directions.into_iter().filter(|&edge| edge != NONE).find_map(|edge| {
            let line = match self.freedoms[topology.start(edge) as usize] {
                Freedom::Free => None,
                Freedom::OnLine => Some(self.slack_without(edge)?),
                Freedom::Held | Freedom::Frozen => return None,
            };
            let target = self.surface.position(topology.end(edge));
            self.allows_collapse(edge, target, change).then_some((edge, Action::Collapse { target, line }))
        })
    }

    /// Whether the start of a half-edge may be merged into its end and that moved to `target`.
    fn allows_collapse(&self, half_edge: u32, target: DVec3, change: &mut Change) -> bool {
        self.list_collapse(half_edge, target, change)
            && self.surface.topology.can_collapse(half_edge)
            && self.allows(change)
    }

    pub(super) fn perform_collapse(&mut self, half_edge: u32, target: DVec3, line: Option<(u32, f64)>) {
        let topology = &self.surface.topology;
        let [removed, kept] = [topology.start(half_edge), topology.end(half_edge)];
        let sides = [half_edge, topology.twin(half_edge)].into_iter().filter(|&edge| edge != NONE);
        let outer: Vec<[(u32, bool); 2]> = sides
            .map(|edge| {
                [next_half_edge(edge), previous_half_edge(edge)]
                    .map(|side| (topology.twin(side), self.lines.is_line(side)))
            })
            .collect();
        self.surface.collapse(half_edge);
        self.lines.follow_collapse(&outer);
        if target != self.surface.position(kept) {
            self.surface.positions.set(kept, target);
        }
        if let Some((beyond, slack)) = line {
            self.slack[beyond as usize] = slack;
            self.slack[kept as usize] = slack;
        }
        let [one, other] = [removed, kept].map(|vertex| self.lengths[vertex as usize]);
        self.lengths[kept as usize] = one.min(other);
        self.tally.collapses += 1;
    }

    /// The neighbor on the other side of the start of a half-edge, along a line, and a bound on the
    /// distance between the line and its edge between the two if the start is removed. `None` if
    /// the start must stay.
    fn slack_without(&self, half_edge: u32) -> Option<(u32, f64)> {
        let (surface, topology) = (&*self.surface, &self.surface.topology);
        let [removed, kept] = [topology.start(half_edge), topology.end(half_edge)];
        let twin = topology.twin(half_edge);
        if !self.lines.is_line(half_edge) {
            return None;
        }
        // The other edges of lines, each as a half-edge in either direction.
        let mut others = topology.fan(removed).filter(|&edge| edge != half_edge && self.lines.is_line(edge));
        let last = topology.fan(removed).last().map(previous_half_edge).filter(|&edge| topology.twin(edge) == NONE);
        let other = others.next();
        let other = match (other, last, others.next()) {
            (Some(edge), None, None) | (None, Some(edge), None) => edge,
            _ => return None,
        };
        let beyond = if topology.start(other) == removed { topology.end(other) } else { topology.start(other) };
        let apexes =
            [half_edge, twin].map(|edge| if edge == NONE { NONE } else { topology.start(previous_half_edge(edge)) });
        // The render vertices of both ends on each side.
        let sides = |edge: u32| {
            let twin = topology.twin(edge);
            let near = [edge, next_half_edge(edge)].map(|half_edge| surface.corner(half_edge));
            [
                near,
                if twin == NONE {
                    near
                } else {
                    [next_half_edge(twin), twin].map(|half_edge| surface.corner(half_edge))
                },
            ]
        };
        let is_seam = |edge: u32| sides(edge)[0] != sides(edge)[1];
        let [near, far] = sides(half_edge);
        let mut corners = topology.fan(removed).map(|edge| surface.corner(edge));
        if apexes.contains(&beyond)
            || is_seam(half_edge) != is_seam(other)
            || (near[0] == far[0]) == is_seam(half_edge)
            || surface.is_hard(half_edge) != surface.is_hard(other)
            || !corners.all(|corner| corner == near[0] || corner == far[0])
        {
            return None;
        }
        let [from, middle, to] = [beyond, removed, kept].map(|vertex| surface.position(vertex));
        let (across, along) = (to - from, middle - from);
        let fraction = (along.dot(across) / across.length_squared()).clamp(0.0, 1.0);
        let distance = middle.distance(from.lerp(to, fraction));
        let [one, two, three] = [beyond, removed, kept].map(|vertex| self.slack[vertex as usize]);
        let slack = one.max(two).max(three) + distance;
        let is_straight = along.dot(to - middle) > STRAIGHT * along.length() * (to - middle).length();
        (is_straight && slack * slack <= self.allowance2).then_some((beyond, slack))
    }

    /// Lists the changes by a collapse. Returns whether the edges that it makes are not too long or
    /// too many.
    fn list_collapse(&self, half_edge: u32, target: DVec3, change: &mut Change) -> bool {
        let topology = &self.surface.topology;
        let [removed, kept] = [topology.start(half_edge), topology.end(half_edge)];
        let twin = topology.twin(half_edge);
        let removed_triangles = [half_edge, if twin == NONE { half_edge } else { twin }].map(|edge| edge / 3);
        let moves = target != self.surface.position(kept);
        let length = LONG * self.lengths[removed as usize].min(self.lengths[kept as usize]);
        let longest2 = length * length;
        change.clear();
        change.old.extend(removed_triangles);
        change.old.dedup();
        let mut edges = 0;
        for vertex in [removed, kept] {
            for outgoing in topology.fan(vertex) {
                let triangle = outgoing / 3;
                if removed_triangles.contains(&triangle) {
                    continue;
                }
                edges += 1;
                if vertex == kept && !moves {
                    continue;
                }
                let [ahead, behind] = [next_half_edge(outgoing), previous_half_edge(outgoing)]
                    .map(|edge| self.surface.position(topology.start(edge)));
                let corner = self.surface.position(vertex);
                let grows = |end: DVec3| target.distance_squared(end) > longest2.max(corner.distance_squared(end));
                let is_last = topology.twin(previous_half_edge(outgoing)) == NONE;
                if grows(ahead) || (is_last && grows(behind)) {
                    return false;
                }
                let mut corners = [target; 3];
                corners[(outgoing as usize + 1) % 3] = ahead;
                corners[(outgoing as usize + 2) % 3] = behind;
                let anchor = self.anchors[triangle as usize];
                change.old.push(triangle);
                let before = direction(&[corner, ahead, behind]);
                change.new.push(Replacement { triangle, corners, before, anchor });
                change.edges.push(([target, ahead], anchor));
                if is_last {
                    change.edges.push(([target, behind], anchor));
                }
            }
        }
        edges <= MOST_EDGES
    }
}
