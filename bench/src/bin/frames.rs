//! Frames per second of double reflection on one core: one curve in double precision, and a batch
//! of sixteen curves in single precision. Compared with a plain implementation of the published
//! loop (W. Wang et al., 2008, table I).

use glam::DVec3;
use isochore_bench::{interleaved_medians, on_one_core, print_row};
use isochore_curve::{BATCH_SIZE, FrameMethod, Spine, SpineBatch, TrigonometricCurve, rotation_minimizing_frames};

/// Numbers of segments: one fits into the second-level cache, the other does not.
const SEGMENTS: [usize; 2] = [1_000, 100_000];

fn main() {
    on_one_core(|| {
        print_row(["segments", "plain M/s", "one curve M/s", "ratio", "batch of 16 M/s", "ratio"]);
        for segments in SEGMENTS {
            measure(segments);
        }
    });
}

fn measure(segments: usize) {
    let spine = Spine::sample(&TrigonometricCurve::torus_knot(), segments).expect("a regular curve");
    let points: Vec<[f64; 3]> = (0..=segments).map(|i| spine.point(i).to_array()).collect();
    let tangents: Vec<[f64; 3]> = (0..=segments).map(|i| spine.tangent(i).to_array()).collect();
    let mut plain_frames = vec![[[0.0; 3]; 3]; segments + 1];
    let batch = SpineBatch::new(&vec![spine.clone(); BATCH_SIZE]).expect("a valid batch");
    let mut references = batch.references();
    // About a million frames per round for every length.
    let repeats = 1_000_000 / segments;
    let seconds = interleaved_medians(&mut [
        &mut || {
            for _ in 0..repeats {
                plain(std::hint::black_box(&points), &tangents, [-1.0, 0.0, 0.0], &mut plain_frames);
                std::hint::black_box(&mut plain_frames);
            }
        },
        &mut || {
            for _ in 0..repeats {
                let frames = rotation_minimizing_frames(
                    std::hint::black_box(&spine),
                    -DVec3::X,
                    FrameMethod::DoubleReflection,
                    Default::default(),
                );
                std::hint::black_box(frames).expect("a regular curve");
            }
        },
        &mut || {
            for _ in 0..repeats {
                let starts = [-DVec3::X; BATCH_SIZE];
                std::hint::black_box(&batch).propagate(&starts, &mut references).expect("a normal vector");
                std::hint::black_box(&mut references);
            }
        },
    ]);
    let millions = 1e-6 * (repeats * segments) as f64;
    let [plain, one, many] = [millions / seconds[0], millions / seconds[1], 16.0 * millions / seconds[2]];
    print_row([
        &segments.to_string(),
        &format!("{plain:.1}"),
        &format!("{one:.1}"),
        &format!("{:.2}", one / plain),
        &format!("{many:.0}"),
        &format!("{:.1}", many / plain),
    ]);
}

/// Table I of the paper line by line, with frames (r, s, t).
fn plain(points: &[[f64; 3]], tangents: &[[f64; 3]], reference: [f64; 3], frames: &mut [[[f64; 3]; 3]]) {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let minus = |a: [f64; 3], factor: f64, b: [f64; 3]| std::array::from_fn(|k| a[k] - factor * b[k]);
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let mut r = reference;
    frames[0] = [r, cross(tangents[0], r), tangents[0]];
    for i in 0..points.len() - 1 {
        let v1: [f64; 3] = minus(points[i + 1], 1.0, points[i]);
        let c1 = dot(v1, v1);
        let rl: [f64; 3] = minus(r, 2.0 / c1 * dot(v1, r), v1);
        let tl: [f64; 3] = minus(tangents[i], 2.0 / c1 * dot(v1, tangents[i]), v1);
        let v2: [f64; 3] = minus(tangents[i + 1], 1.0, tl);
        let c2 = dot(v2, v2);
        r = minus(rl, 2.0 / c2 * dot(v2, rl), v2);
        frames[i + 1] = [r, cross(tangents[i + 1], r), tangents[i + 1]];
    }
}
