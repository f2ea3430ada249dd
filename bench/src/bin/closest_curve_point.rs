//! Closest points on a spline on one core, for points near the spline (as in a strip field) and for
//! points anywhere. Compared with the nearest of a thousand samples, whose error is in the last
//! column.

use glam::DVec3;
use isochore_bench::{interleaved_medians, on_one_core, print_row};
use isochore_curve::{ClosestPoint, CubicSpline, Curve, EndCondition, Parametrization};

const QUERIES: usize = 20_000;
const SAMPLES: usize = 1_000;

fn main() {
    on_one_core(|| {
        print_row(["points", "queries", "M queries/s", "1000 samples M/s", "ratio", "error of samples"]);
        for count in [4, 16, 64] {
            // A knot-like curve.
            let points: Vec<DVec3> = (0..count)
                .map(|i| f64::from(i) / f64::from(count - 1))
                .map(|fraction| {
                    let angle = 2.0 + 9.0 * fraction;
                    DVec3::new(angle.cos() * (1.0 + fraction), angle.sin(), 0.5 * (5.0 * fraction).sin())
                })
                .collect();
            let spline =
                CubicSpline::open(&points, Parametrization::Centripetal, EndCondition::Natural).expect("valid points");
            measure(count, "near", &spline, 0.1);
            measure(count, "anywhere", &spline, 2.0);
        }
    });
}

fn measure(count: i32, name: &str, spline: &CubicSpline, spread: f64) {
    let (first, last) = spline.domain();
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let queries: Vec<DVec3> = (0..QUERIES)
        .map(|_| {
            let on_curve = spline.position(first + (last - first) * random());
            on_curve + (DVec3::new(random(), random(), random()) - 0.5) * (2.0 * spread)
        })
        .collect();
    let samples: Vec<DVec3> =
        (0..SAMPLES).map(|i| spline.position(first + (last - first) * i as f64 / (SAMPLES - 1) as f64)).collect();
    let nearest_sample =
        |query: DVec3| samples.iter().map(|sample| sample.distance_squared(query)).fold(f64::INFINITY, f64::min).sqrt();
    let search = ClosestPoint::new(spline);
    let error = queries.iter().map(|&query| nearest_sample(query) - search.closest(query).distance).fold(0.0, f64::max);
    let seconds = interleaved_medians(&mut [
        &mut || drop(std::hint::black_box(search.closest_many(std::hint::black_box(&queries)))),
        &mut || {
            let distances: Vec<f64> = queries.iter().map(|&query| nearest_sample(query)).collect();
            std::hint::black_box(distances);
        },
    ]);
    let millions = 1e-6 * QUERIES as f64;
    print_row([
        &count.to_string(),
        name,
        &format!("{:.2}", millions / seconds[0]),
        &format!("{:.2}", millions / seconds[1]),
        &format!("{:.1}", seconds[1] / seconds[0]),
        &format!("{error:.1e}"),
    ]);
}
