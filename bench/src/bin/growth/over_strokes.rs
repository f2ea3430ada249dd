use glam::{DVec3, dvec3};
use isochore_bench::scan_of_cube;
use isochore_field::{Stroke, advect_points, deform};
use isochore_mesh::NoProgress;

use crate::{
    Extent, SEGMENTS,
    over_triangles::{PLAIN, press, refinement},
    series::Series,
};

/// Reach of each stroke. 64 strokes cover the surface about twice.
const REACH: f64 = 0.35;

/// Deforms one mesh by increasing numbers of evenly distributed strokes. Returns the series by
/// number of strokes and by total number of moved vertices.
pub(crate) fn measure(extent: Extent) -> [Vec<Series>; 2] {
    let mesh = scan_of_cube(SEGMENTS);
    let mut over_number = ["deform, no refinement", "deform, refinement", "advection of points"].map(Series::new);
    let mut over_moved = over_number.clone();
    for count in [1, 2, 4, 8, 16, 32, 64] {
        let strokes: Vec<Stroke> = (0..count)
            .map(|index| {
                let direction = spread(index, count);
                let nearest = mesh.positions.iter().max_by(|a, b| {
                    let along = |point: &DVec3| point.normalize().dot(direction);
                    along(a).total_cmp(&along(b))
                });
                press(*nearest.expect("a vertex"), REACH)
            })
            .collect();
        let [plain, refined, advection] = &mut over_number;
        let deformed = |options| deform(&mesh, &strokes, options, &NoProgress).expect("a valid mesh");
        let refinement = refinement();
        plain.measure(count, extent.seconds, || deformed(&PLAIN));
        refined.measure(count, extent.seconds, || deformed(&refinement));
        advection.measure(count, extent.seconds, || {
            advect_points(&mesh.positions, &strokes, &NoProgress).expect("strokes without stamps")
        });
        for (options, indices) in [(&PLAIN, vec![0, 2]), (&refinement, vec![1])] {
            let moved = deformed(options).receipt.strokes.iter().map(|stroke| stroke.moved).sum();
            for index in indices {
                over_moved[index].repeat_last(moved, &over_number[index], count);
            }
        }
    }
    [over_number.into(), over_moved.into()]
}

/// Evenly distributed directions: steps of the golden angle on slices of the sphere of equal area.
fn spread(index: usize, count: usize) -> DVec3 {
    let height = 1.0 - (2.0 * index as f64 + 1.0) / count as f64;
    let angle = std::f64::consts::PI * (3.0 - 5_f64.sqrt()) * index as f64;
    let radius = (1.0 - height * height).sqrt();
    dvec3(radius * libm::cos(angle), radius * libm::sin(angle), height)
}
