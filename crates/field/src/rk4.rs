//! The classical Runge-Kutta method of order four, for a block of points.

use isochore_mesh::{LANES, PointBlock};

/// `points` after one step of length `time` along the stationary field that `velocity` evaluates.
///
/// `first` holds the velocities at `points`; the second argument of `velocity` receives those at the points of its first.
pub(crate) fn rk4_step(
    points: &PointBlock,
    first: &PointBlock,
    time: f64,
    mut velocity: impl FnMut(&PointBlock, &mut PointBlock),
) -> PointBlock {
    let mut stages = [*first, PointBlock::ZERO, PointBlock::ZERO, PointBlock::ZERO];
    for (stage, share) in [(1, 0.5 * time), (2, 0.5 * time), (3, time)] {
        let at = advanced(points, &stages[stage - 1], share);
        velocity(&at, &mut stages[stage]);
    }
    let [k1, k2, k3, k4] = &stages;
    let mut end = PointBlock::ZERO;
    for lane in 0..LANES {
        end.x[lane] = points.x[lane] + time / 6.0 * (k1.x[lane] + 2.0 * (k2.x[lane] + k3.x[lane]) + k4.x[lane]);
        end.y[lane] = points.y[lane] + time / 6.0 * (k1.y[lane] + 2.0 * (k2.y[lane] + k3.y[lane]) + k4.y[lane]);
        end.z[lane] = points.z[lane] + time / 6.0 * (k1.z[lane] + 2.0 * (k2.z[lane] + k3.z[lane]) + k4.z[lane]);
    }
    end
}

fn advanced(points: &PointBlock, velocity: &PointBlock, time: f64) -> PointBlock {
    let mut end = PointBlock::ZERO;
    for lane in 0..LANES {
        end.x[lane] = points.x[lane] + time * velocity.x[lane];
        end.y[lane] = points.y[lane] + time * velocity.y[lane];
        end.z[lane] = points.z[lane] + time * velocity.z[lane];
    }
    end
}
