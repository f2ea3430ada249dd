use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::*;

#[test]
fn rejects_bad_input() {
    let mesh = icosphere(1.0, 1);
    let with =
        |mesh: &TriMesh, options: DistanceFieldOptions| DistanceField::new(mesh, &options, &NoProgress).unwrap_err();
    let options = DistanceFieldOptions::default();
    assert_eq!(with(&TriMesh::default(), options), DistanceFieldError::Mesh(BvhError::Empty));
    assert_eq!(
        with(&mesh, DistanceFieldOptions { resolution: 1, ..options }),
        DistanceFieldError::Resolution { resolution: 1, least: 4 }
    );
    for length in [-1.0, f64::INFINITY] {
        let padding = Padding::Reach(length);
        assert_eq!(with(&mesh, DistanceFieldOptions { padding, ..options }), DistanceFieldError::Padding { length });
    }
    assert_eq!(with(&mesh, DistanceFieldOptions { band: 0.0, ..options }), DistanceFieldError::Band { width: 0.0 });
    for resolution in [1_000, 1_000_000, usize::MAX] {
        let error = with(&mesh, DistanceFieldOptions { resolution, ..options });
        assert!(matches!(error, DistanceFieldError::Memory { limit, .. } if limit == 4 << 30), "{error}");
    }
    let error = with(&mesh, DistanceFieldOptions { padding: Padding::Reach(1e30), ..options });
    assert!(matches!(error, DistanceFieldError::Memory { .. }), "{error}");
    assert!(matches!(with(&mesh.clone().flipped(), options), DistanceFieldError::InsideOut { volume } if volume < 0.0));
    let point = transformed(&mesh, |_| DVec3::ONE);
    assert_eq!(with(&point, options), DistanceFieldError::Extent { extent: 0.0 });
    let mut infinite = mesh.clone();
    infinite.positions[3].y = f64::INFINITY;
    assert_eq!(with(&infinite, options), DistanceFieldError::Mesh(BvhError::NotFinite { vertex: 3 }));
    let mut out_of_range = mesh;
    out_of_range.triangles[5][1] = 4711;
    let expected = BvhError::IndexOutOfRange { triangle: 5, vertex: 4711, vertices: 42 };
    assert_eq!(with(&out_of_range, options), DistanceFieldError::Mesh(expected));
}

#[test]
fn stops_in_every_stage_when_cancelled() {
    #[derive(Default)]
    struct StopAfter {
        limit: usize,
        asked: AtomicUsize,
        stage: Mutex<&'static str>,
    }
    impl Monitor for StopAfter {
        fn update(&self, stage: &'static str, done: f64) {
            assert!((0.0..=1.0).contains(&done));
            *self.stage.lock().unwrap() = stage;
        }

        fn is_cancelled(&self) -> bool {
            self.asked.fetch_add(1, Ordering::Relaxed) >= self.limit
        }
    }
    let options = DistanceFieldOptions { resolution: 8, ..Default::default() };
    let stopping = |limit: usize| {
        let monitor = StopAfter { limit, ..Default::default() };
        let result = DistanceField::new(&icosphere(1.0, 1), &options, &monitor).map(|_| ());
        (result, monitor.asked.into_inner(), monitor.stage.into_inner().unwrap())
    };
    let (result, asked, last) = stopping(usize::MAX);
    assert_eq!((result, last), (Ok(()), "spline"));
    let mut stages = Vec::new();
    for limit in 0..asked {
        let (result, _, stage) = stopping(limit);
        assert_eq!(result, Err(DistanceFieldError::Cancelled(Cancelled)), "after {limit}");
        stages.push(stage);
    }
    stages.dedup();
    assert_eq!(stages, ["hierarchy", "distance", "signs", "spline"]);
}
