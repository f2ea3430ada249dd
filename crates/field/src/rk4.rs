//! The classical Runge-Kutta method of order four, for a block of points.

use isochore_mesh::{LANES, PointBlock};
use multiversion::multiversion;

/// `points` after one step of length `time` along a field.
///
/// `stages` are what the field is at the four places where it is asked, of which `velocity` is what counts here. The first, at
/// `points`, must be filled in; `evaluate` fills in the others.
pub(crate) fn rk4_step<S>(
    points: &PointBlock,
    stages: &mut [S; 4],
    time: f64,
    velocity: impl Fn(&S) -> &PointBlock,
    mut evaluate: impl FnMut(&PointBlock, &mut S),
) -> PointBlock {
    let mut place = PointBlock::ZERO;
    for (stage, share) in [(1, 0.5 * time), (2, 0.5 * time), (3, time)] {
        advance(points, velocity(&stages[stage - 1]), share, &mut place);
        evaluate(&place, &mut stages[stage]);
    }
    combine(points, stages.each_ref().map(velocity), time, &mut place);
    place
}

/// Where `points` are after moving straight on for `time`.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "aarch64+neon"))]
fn advance(points: &PointBlock, velocity: &PointBlock, time: f64, end: &mut PointBlock) {
    for lane in 0..LANES {
        end.x[lane] = points.x[lane] + time * velocity.x[lane];
        end.y[lane] = points.y[lane] + time * velocity.y[lane];
        end.z[lane] = points.z[lane] + time * velocity.z[lane];
    }
}

/// The step's end from its four velocities.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "aarch64+neon"))]
fn combine(points: &PointBlock, [k1, k2, k3, k4]: [&PointBlock; 4], time: f64, end: &mut PointBlock) {
    let share = time / 6.0;
    for lane in 0..LANES {
        end.x[lane] = points.x[lane] + share * (k1.x[lane] + 2.0 * (k2.x[lane] + k3.x[lane]) + k4.x[lane]);
        end.y[lane] = points.y[lane] + share * (k1.y[lane] + 2.0 * (k2.y[lane] + k3.y[lane]) + k4.y[lane]);
        end.z[lane] = points.z[lane] + share * (k1.z[lane] + 2.0 * (k2.z[lane] + k3.z[lane]) + k4.z[lane]);
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
        let mut stages = [PointBlock::splat(bend(point)); 4];
        let evaluate = |points: &PointBlock, out: &mut PointBlock| *out = PointBlock::splat(bend(points.get(0)));
        rk4_step(&PointBlock::splat(point), &mut stages, time, |velocity| velocity, evaluate).get(0)
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
    fn orders_are_one_two_and_four() {
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
