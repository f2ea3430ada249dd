//! The two sheets that come closest where a stroke was stopped.

use glam::DVec3;
use isochore_field::Sheets;
use isochore_mesh::Aabb;

use super::crossings::Pair;
use crate::session::surface::Surface;

/// Triangles among which the sheets are searched. Larger takes longer; smaller may miss the other
/// sheet where triangles are small.
const SEARCHED: usize = 256;

/// Most doublings of the box in which the sheets are searched, so that the search ends if the mesh
/// is smaller than [`SEARCHED`].
const DOUBLINGS: usize = 40;

/// First size of the box, relative to the coordinates, if the nearest triangle is a point. Larger may
/// visit many triangles at once; smaller needs more doublings.
const TINY: f64 = 1e-9;

impl Surface {
    /// The place where a pair of triangles crosses.
    pub(super) fn place_of(&self, pair: Pair) -> Option<DVec3> {
        let [one, other] = pair.map(|triangle| self.corners_of(triangle));
        Some(Sheets::between(one?, other?).at)
    }

    /// The closest two sheets around a place.
    pub(super) fn closest_sheets(&self, place: DVec3) -> Option<Sheets> {
        let records = self.topology.triangles();
        let near = self.triangles_around_point(place).into_iter();
        let near: Vec<_> = near.map(|(triangle, corners)| (records[triangle as usize].vertices, corners)).collect();
        Sheets::closest(&near)
    }

    /// At least [`SEARCHED`] triangles around a point, if there are as many, in ascending order.
    fn triangles_around_point(&self, point: DVec3) -> Vec<(u32, [DVec3; 3])> {
        let corners = |triangle: u32| self.corners_of(triangle);
        let nearest = self.tree.closest_point(point, &corners).and_then(|hit| corners(hit.triangle));
        let size = nearest.map_or(0.0, |corners| Aabb::of(corners).size().length());
        let mut margin = if size > 0.0 { size } else { TINY * point.length() };
        let mut near = Vec::new();
        for _ in 0..DOUBLINGS {
            let bounds = Aabb::of([point]).expanded(margin);
            near.clear();
            self.tree.visit_box(bounds, |triangle| {
                near.extend(corners(triangle).filter(|&c| Aabb::of(c).overlaps(bounds)).map(|c| (triangle, c)));
            });
            if near.len() >= SEARCHED {
                break;
            }
            margin *= 2.0;
        }
        near.sort_unstable_by_key(|&(triangle, _)| triangle);
        near
    }
}
