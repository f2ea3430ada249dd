//! The shared suite that every field joins: no net flux through closed surfaces that cut its support.

use std::f64::consts::TAU;

use glam::DVec3;

/// Gauss-Legendre nodes and weights on [0, 1], exact to degree five.
const NODES: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Cells along height and longitude before any is divided.
const CELLS: usize = 32;

/// Halvings of a cell that a kink crosses, where the velocity may jump. Each makes what a jump leaves three times less, and
/// costs twice the evaluations.
const DEPTH: u32 = 7;

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
    fn flow(&self, outflow: &impl Fn(DVec3) -> f64) -> Flow {
        let mut flow = Flow::default();
        for (u, u_weight) in NODES {
            let height = self.height + u * self.size[0];
            let ring = (1.0 - height * height).sqrt();
            for (v, v_weight) in NODES {
                let longitude = self.longitude + v * self.size[1];
                let normal = DVec3::new(ring * libm::cos(longitude), ring * libm::sin(longitude), height);
                let value = u_weight * v_weight * self.size[0] * self.size[1] * outflow(normal);
                flow.net += value;
                flow.absolute += value.abs();
            }
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

    /// Whether a surface that is nowhere closer to the middle than `distance` may cross the cell.
    fn may_be_crossed(&self, distance: impl Fn(DVec3) -> f64) -> bool {
        let middle = Self { height: self.height + 0.5 * self.size[0], longitude: self.longitude + 0.5 * self.size[1], ..*self };
        // Towards a pole a cell of equal area grows as long as the root of its height.
        let extent = (2.0 * self.size[0]).sqrt().min(self.size[0] / (1.0 - middle.height * middle.height).sqrt());
        distance(middle.corner()) < 0.5 * (extent + self.size[1])
    }

    /// The point of the unit sphere where height and longitude are least.
    fn corner(&self) -> DVec3 {
        let ring = (1.0 - self.height * self.height).sqrt();
        DVec3::new(ring * libm::cos(self.longitude), ring * libm::sin(self.longitude), self.height)
    }

    fn adaptive_flow(&self, depth: u32, outflow: &impl Fn(DVec3) -> f64, kink: &impl Fn(DVec3) -> f64) -> Flow {
        if depth == 0 || !self.may_be_crossed(kink) {
            return self.flow(outflow);
        }
        self.children().iter().map(|child| child.adaptive_flow(depth - 1, outflow, kink)).sum()
    }
}

/// |∮ V·n| / ½∮ |V·n| over a sphere: the share of what flows in that does not flow out. `kink` is the distance to the nearest
/// surface where the velocity may have a kink or a jump.
pub(crate) fn relative_flux(
    velocity: impl Fn(DVec3) -> DVec3,
    kink: impl Fn(DVec3) -> f64,
    center: DVec3,
    radius: f64,
) -> f64 {
    let outflow = |normal: DVec3| velocity(center + radius * normal).dot(normal);
    let kink = |normal: DVec3| kink(center + radius * normal) / radius;
    let size = [2.0 / CELLS as f64, TAU / CELLS as f64];
    let cells = (0..CELLS * CELLS).map(|index| Cell {
        height: -1.0 + (index / CELLS) as f64 * size[0],
        longitude: (index % CELLS) as f64 * size[1],
        size,
    });
    let flow: Flow = cells.map(|cell| cell.adaptive_flow(DEPTH, &outflow, &kink)).sum();
    if flow.absolute == 0.0 { 0.0 } else { flow.net.abs() / (0.5 * flow.absolute) }
}

/// Largest [`relative_flux`] over spheres that cut the surface and the support of a shape about the origin of this `size`.
pub(crate) fn worst_flux(velocity: impl Fn(DVec3) -> DVec3, kink: impl Fn(DVec3) -> f64, size: f64) -> f64 {
    let centers = [DVec3::new(0.9, 0.1, 0.2), DVec3::new(-0.2, 1.0, 0.5), DVec3::new(0.3, -0.4, -1.1)];
    let spheres = centers.into_iter().flat_map(|center| [0.45, 0.8].map(|radius| (size * center, size * radius)));
    spheres.map(|(center, radius)| relative_flux(&velocity, &kink, center, radius)).fold(0.0, f64::max)
}

/// What adaptive quadrature may leave of the flux of a divergence-free field, jumps of its tangential velocity included. A
/// field whose gradient is not that of its distance shows ten times as much and more.
pub(crate) const QUADRATURE_NOISE: f64 = 1e-4;

#[test]
fn the_suite_sees_a_source() {
    let velocity = |point: DVec3| DVec3::X + 1e-3 * point;
    let nowhere = |_| f64::INFINITY;
    assert!(worst_flux(velocity, nowhere, 1.0) > 5e-4);
    assert!(worst_flux(|_| DVec3::X, nowhere, 1.0) < 1e-6);
}
