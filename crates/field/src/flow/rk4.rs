//! The classical Runge-Kutta method of order four, for blocks of points.

use isochore_mesh::{LANES, PointBlock};
use multiversion::multiversion;

/// A block of points during one step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rk4Block<S> {
    pub(crate) start: PointBlock,
    /// The field at the four stages. The caller fills the first, which is at `start`.
    pub(crate) stages: [S; 4],
    /// Positions after the step.
    pub(crate) end: PointBlock,
}

impl<S: Copy> Rk4Block<S> {
    /// Points at the origin, with `stage` for the field.
    pub(crate) fn new(stage: S) -> Self {
        Self { start: PointBlock::ZERO, stages: [stage; 4], end: PointBlock::ZERO }
    }
}

/// Takes one step of length `time`.
///
/// `velocity` selects the velocity of a stage. `evaluate` receives the index of a stage, from 1 to 3, and
/// positions, and fills the stage. All blocks take a stage before any takes the next, so the processor
/// can work on one block while it waits for the results of another.
pub(crate) fn rk4_step<S>(
    blocks: &mut [Rk4Block<S>],
    time: f64,
    velocity: impl Fn(&S) -> &PointBlock,
    evaluate: impl Fn(usize, &PointBlock, &mut S),
) {
    for (stage, stage_time) in [(1, 0.5 * time), (2, 0.5 * time), (3, time)] {
        for Rk4Block { start, stages, end } in &mut *blocks {
            advance(start, velocity(&stages[stage - 1]), stage_time, end);
            evaluate(stage, end, &mut stages[stage]);
        }
    }
    for Rk4Block { start, stages, end } in blocks {
        combine(start, stages.each_ref().map(&velocity), time, end);
    }
}

/// The positions of `points` after a straight motion for `time`.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "aarch64+neon"))]
fn advance(points: &PointBlock, velocity: &PointBlock, time: f64, end: &mut PointBlock) {
    for lane in 0..LANES {
        end.x[lane] = points.x[lane] + time * velocity.x[lane];
        end.y[lane] = points.y[lane] + time * velocity.y[lane];
        end.z[lane] = points.z[lane] + time * velocity.z[lane];
    }
}

/// The end of the step from its four velocities.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "aarch64+neon"))]
fn combine(points: &PointBlock, [k1, k2, k3, k4]: [&PointBlock; 4], time: f64, end: &mut PointBlock) {
    let weight = time / 6.0;
    for lane in 0..LANES {
        end.x[lane] = points.x[lane] + weight * (k1.x[lane] + 2.0 * (k2.x[lane] + k3.x[lane]) + k4.x[lane]);
        end.y[lane] = points.y[lane] + weight * (k1.y[lane] + 2.0 * (k2.y[lane] + k3.y[lane]) + k4.y[lane]);
        end.z[lane] = points.z[lane] + weight * (k1.z[lane] + 2.0 * (k2.z[lane] + k3.z[lane]) + k4.z[lane]);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    const AXIS: DVec3 = DVec3::new(1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0);
    const START: DVec3 = DVec3::new(0.3, -0.4, 0.5);
    const TIME: f64 = 0.5;

    /// Equation 12.6 as printed, whose flow is a rotation by −5|x|² a unit of time.
    fn bend(point: DVec3) -> DVec3 {
        -5.0 * point.length_squared() * AXIS.cross(point)
    }

    fn runge_kutta(point: DVec3, time: f64) -> DVec3 {
        let mut block = Rk4Block::new(PointBlock::splat(bend(point)));
        block.start = PointBlock::splat(point);
        let evaluate = |_, points: &PointBlock, out: &mut PointBlock| *out = PointBlock::splat(bend(points.get(0)));
        rk4_step(std::slice::from_mut(&mut block), time, |velocity| velocity, evaluate);
        block.end.get(0)
    }

    fn euler(point: DVec3, time: f64) -> DVec3 {
        point + time * bend(point)
    }

    fn midpoint(point: DVec3, time: f64) -> DVec3 {
        point + time * bend(point + 0.5 * time * bend(point))
    }

    /// Errors at the end after 8, 16, 32 and 64 steps.
    fn errors(step: impl Fn(DVec3, f64) -> DVec3) -> [f64; 4] {
        let exact = DVec3::new(-0.436756416361175, -0.081686472536101, 0.550064680716689);
        [8, 16, 32, 64].map(|steps: i32| {
            let end = (0..steps).fold(START, |point, _| step(point, TIME / f64::from(steps)));
            end.distance(exact)
        })
    }

    #[test]
    fn methods_have_orders_one_two_and_four() {
        let cases: [(&str, [f64; 4], [f64; 4], f64); 3] = [
            ("Euler", errors(euler), [1.137e-1, 5.466e-2, 2.666e-2, 1.316e-2], 1.0),
            ("midpoint", errors(midpoint), [9.317e-3, 2.224e-3, 5.422e-4, 1.338e-4], 2.0),
            ("Runge-Kutta", errors(runge_kutta), [5.136e-5, 3.255e-6, 2.043e-7, 1.278e-8], 4.0),
        ];
        for (name, errors, golden, order) in cases {
            for (error, golden) in errors.into_iter().zip(golden) {
                // The golden errors have four digits.
                assert!((error / golden - 1.0).abs() < 5e-4, "{name}: {error:e} against {golden:e}");
            }
            let measured = libm::log2(errors[2] / errors[3]);
            assert!((measured - order).abs() < 0.03, "{name}: order {measured}");
        }
    }
}
