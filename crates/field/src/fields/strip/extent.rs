//! Distance that the solid of a tool extends from a spine, by branch and bound over an octree.

use isochore_mesh::Aabb;

use super::spine_instant::SpineInstant;
use crate::fields::Tool;

/// Half diagonal below which cells are not divided further, relative to that of the whole box. The
/// result may be too large by about this. Larger: rejects strips that just fit. Smaller: slower.
const RESOLUTION: f64 = 1.0 / 64.0;

/// Upper bound on the distance from the spine of all points closer to the tool than `threshold`.
pub(super) fn farthest(tool: &Tool, threshold: f64, spine: &SpineInstant) -> f64 {
    let distance = tool.distance();
    let whole = distance.bounds_within(threshold);
    let finest = RESOLUTION * half_diagonal(whole);
    let mut best: f64 = 0.0;
    let mut cells = vec![whole];
    while let Some(cell) = cells.pop() {
        let (center, radius) = (cell.center(), half_diagonal(cell));
        let bound = spine.distance(center) + radius;
        if bound <= best {
            continue;
        }
        let (value, _) = distance.sample(center);
        // Where the samples of a grid end, part of the cell may still be inside.
        if value.is_finite() && value - distance.lipschitz() * radius >= threshold {
            continue;
        }
        if value < threshold {
            best = best.max(bound - radius);
        }
        if radius <= finest {
            best = best.max(bound);
        } else {
            cells.extend(octants(cell));
        }
    }
    best
}

fn half_diagonal(cell: Aabb) -> f64 {
    0.5 * cell.size().length()
}

fn octants(cell: Aabb) -> impl Iterator<Item = Aabb> {
    let center = cell.center();
    cell.corners().into_iter().map(move |corner| Aabb::of([corner, center]))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec3;
    use isochore_curve::Bezier;
    use isochore_mesh::RoundedBox;

    use super::*;
    use crate::fields::{Profile, strip::spine_curve::SpineCurve};

    #[test]
    fn a_box_extends_to_its_edges() {
        let shape = RoundedBox::new(DVec3::new(0.2, 0.3, 1.0), 0.0).unwrap();
        let tool = Tool::new(Arc::new(shape), 0.25, Profile::Quintic).unwrap();
        let line = Bezier::new(vec![DVec3::Z * -2.0, DVec3::Z * 2.0]);
        let spine = SpineInstant::new(SpineCurve::Other(Arc::new(line)), None);
        for threshold in [0.0, 0.25] {
            let exact = 0.13_f64.sqrt() + threshold;
            let bound = farthest(&tool, threshold, &spine);
            let slack = 2.0 * RESOLUTION * half_diagonal(tool.distance().bounds_within(threshold));
            assert!(bound >= exact && bound <= exact + slack, "{threshold}: {exact} {bound}");
        }
    }
}
