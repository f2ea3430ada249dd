//! Test suite for every field: the net flux through closed surfaces that cut its support is zero.
//!
//! The flux through a sphere is integrated by Gauss-Legendre quadrature over cells of equal area,
//! refined where the velocity has kinks or jumps.

use std::f64::consts::TAU;

use glam::DVec3;
use isochore_mesh::PointBlock;

use crate::fields::{Field, FieldBlock};

/// Gauss-Legendre nodes and weights on [0, 1], exact to degree five.
const NODES: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Number of cells along height and along longitude before refinement.
const CELLS: usize = 32;

/// Largest number of halvings of a cell that a kink crosses, where the velocity may jump. Each
/// halving divides the error of a jump by about three and doubles the evaluations.
const DEPTH: u32 = 6;

/// A cell without a kink is divided while that changes its flow by more than this, relative to a
/// unit velocity on the unit sphere. Larger: the error of smooth fields shows. Smaller: more
/// evaluations.
const CELL_TOLERANCE: f64 = 1e-9;

/// Net and absolute flow through a part of the unit sphere.
#[derive(Clone, Copy, Default)]
struct Flow {
    net: f64,
    absolute: f64,
}

impl std::iter::Sum for Flow {
    fn sum<I: Iterator<Item = Self>>(flows: I) -> Self {
        flows.fold(Self::default(), |a, b| Self { net: a.net + b.net, absolute: a.absolute + b.absolute })
    }
}

/// A patch of the unit sphere; height and longitude map equal areas to equal areas.
#[derive(Clone, Copy)]
struct Cell {
    height: f64,
    longitude: f64,
    size: [f64; 2],
}

impl Cell {
    fn flow(&self, velocity: &impl Fn(&[DVec3]) -> PointBlock) -> Flow {
        let nodes = NODES.map(|u| NODES.map(|v| (u, v))).into_iter().flatten();
        let normals: Vec<DVec3> = nodes
            .clone()
            .map(|((u, _), (v, _))| normal(self.height + u * self.size[0], self.longitude + v * self.size[1]))
            .collect();
        let velocities = velocity(&normals);
        let mut flow = Flow::default();
        for (lane, ((_, u_weight), (_, v_weight))) in nodes.enumerate() {
            let value = u_weight * v_weight * self.size[0] * self.size[1] * velocities.get(lane).dot(normals[lane]);
            flow.net += value;
            flow.absolute += value.abs();
        }
        flow
    }

    fn children(&self) -> [Self; 4] {
        let size = self.size.map(|side| 0.5 * side);
        std::array::from_fn(|index| Self {
            height: self.height + (index / 2) as f64 * size[0],
            longitude: self.longitude + (index % 2) as f64 * size[1],
            size,
        })
    }

    /// Whether a surface may cross the cell; `distance` is the distance of points of the sphere
    /// from that surface.
    fn may_be_crossed(&self, distance: impl Fn(DVec3) -> f64) -> bool {
        let height = self.height + 0.5 * self.size[0];
        // Near a pole the length of a cell of equal area grows like the root of its height.
        let extent = (2.0 * self.size[0]).sqrt().min(self.size[0] / (1.0 - height * height).sqrt());
        distance(normal(height, self.longitude + 0.5 * self.size[1])) < 0.5 * (extent + self.size[1])
    }

    fn adaptive_flow(
        &self,
        whole: Flow,
        depth: u32,
        velocity: &impl Fn(&[DVec3]) -> PointBlock,
        kink: &impl Fn(DVec3) -> f64,
    ) -> Flow {
        let children = self.children().map(|child| (child, child.flow(velocity)));
        let sum: Flow = children.iter().map(|(_, flow)| *flow).sum();
        let is_settled = (sum.net - whole.net).abs() < CELL_TOLERANCE && !self.may_be_crossed(kink);
        if depth == 0 || is_settled {
            return sum;
        }
        children.iter().map(|(child, flow)| child.adaptive_flow(*flow, depth - 1, velocity, kink)).sum()
    }
}

/// The point of the unit sphere at a height and longitude.
fn normal(height: f64, longitude: f64) -> DVec3 {
    let ring = (1.0 - height * height).sqrt();
    DVec3::new(ring * libm::cos(longitude), ring * libm::sin(longitude), height)
}

/// |∮ V·n| / ½∮ |V·n| over a sphere: the net flux as a fraction of the inflow. `kink` is the
/// distance from the nearest surface where the velocity may have a kink or a jump.
fn relative_flux(
    velocity: &impl Fn(&PointBlock) -> PointBlock,
    kink: &impl Fn(DVec3) -> f64,
    center: DVec3,
    radius: f64,
) -> f64 {
    let on_sphere = |normal: &DVec3| center + radius * normal;
    let velocity =
        |normals: &[DVec3]| velocity(&PointBlock::gather(&normals.iter().map(on_sphere).collect::<Vec<_>>()));
    let kink = |normal: DVec3| kink(on_sphere(&normal)) / radius;
    let size = [2.0 / CELLS as f64, TAU / CELLS as f64];
    let cells = (0..CELLS * CELLS).map(|index| Cell {
        height: -1.0 + (index / CELLS) as f64 * size[0],
        longitude: (index % CELLS) as f64 * size[1],
        size,
    });
    let flow: Flow = cells.map(|cell| cell.adaptive_flow(cell.flow(&velocity), DEPTH, &velocity, &kink)).sum();
    if flow.absolute == 0.0 { 0.0 } else { flow.net.abs() / (0.5 * flow.absolute) }
}

/// Largest relative flux over spheres that cut the surface and the support of a shape of this
/// `size` around the origin.
pub(crate) fn worst_flux(velocity: impl Fn(&PointBlock) -> PointBlock, kink: impl Fn(DVec3) -> f64, size: f64) -> f64 {
    let centers = [DVec3::new(0.9, 0.1, 0.2), DVec3::new(-0.2, 1.0, 0.5), DVec3::new(0.3, -0.4, -1.1)];
    let spheres = centers.into_iter().flat_map(|center| [0.45, 0.8].map(|radius| (size * center, size * radius)));
    spheres.map(|(center, radius)| relative_flux(&velocity, &kink, center, radius)).fold(0.0, f64::max)
}

/// [`worst_flux`] of a field.
pub(crate) fn worst_field_flux(field: &dyn Field, kink: impl Fn(DVec3) -> f64, size: f64) -> f64 {
    let velocity = |points: &PointBlock| {
        let mut block = FieldBlock::ZERO;
        field.evaluate_into(points, &mut block);
        block.velocity
    };
    worst_flux(velocity, kink, size)
}

/// Bound on the quadrature error of the relative flux of a divergence-free field, including jumps
/// of its tangential velocity. A field whose gradient is not that of its distance exceeds this at
/// least tenfold.
pub(crate) const QUADRATURE_NOISE: f64 = 1e-4;

#[test]
fn detects_a_source() {
    let with_source = |strength: f64| {
        let velocity = move |points: &PointBlock| {
            let points: Vec<DVec3> =
                (0..isochore_mesh::LANES).map(|lane| DVec3::X + strength * points.get(lane)).collect();
            PointBlock::gather(&points)
        };
        worst_flux(velocity, |_| f64::INFINITY, 1.0)
    };
    assert!(with_source(1e-3) > 5.0 * QUADRATURE_NOISE);
    assert!(with_source(0.0) < 1e-6);
}
