//! Random strokes leave no new crossings and keep the volume. `cargo xtask bench clay` measures more of
//! them.

use glam::DVec3;
use isochore_bench::{ClayStroke, TARGET, clay_recipe};
use isochore_mesh::{ClosedMesh, NoProgress, SelfIntersections, TriMesh, primitives};
use isochore_sculpt::{Meshes, Recipe, recipe::Format, replay};

/// Works of each kind on each mesh.
const COUNT: u64 = 1;

fn meshes() -> [(&'static str, TriMesh); 4] {
    let mut ellipsoid = primitives::icosphere(1.0, 4);
    ellipsoid.positions.iter_mut().for_each(|position| *position *= DVec3::new(30.0, 12.0, 20.0));
    [
        ("sphere", primitives::icosphere(1.0, 4)),
        ("ellipsoid", ellipsoid),
        ("cube", primitives::box_mesh(DVec3::splat(0.001), [12, 12, 12])),
        ("plate", primitives::box_mesh(DVec3::new(1.0, 1.0, 0.05), [24, 24, 2])),
    ]
}

#[test]
fn random_strokes_are_certified() {
    let mut stopped = 0;
    for (name, mesh) in meshes() {
        for kind in ClayStroke::ALL {
            for number in 0..COUNT {
                let what = format!("{kind:?} {number} on the {name}");
                let recipe = Recipe::parse(&clay_recipe(&mesh, kind, number), Format::Toml, &[]).unwrap();
                let meshes = Meshes::from([(TARGET.to_owned(), mesh.clone().into())]);
                let deformed = replay(&recipe, &meshes, &NoProgress).unwrap().deformed;
                let receipt = deformed.receipt;
                assert_eq!(receipt.new_crossings, 0, "{what}");
                assert!(SelfIntersections::of(&deformed.mesh, &NoProgress).unwrap().is_empty(), "{what}");
                assert!(ClosedMesh::new(&deformed.mesh).is_ok(), "{what}");
                let [before, bare, locked] =
                    [receipt.volume_before, receipt.volume_before_lock, receipt.volume_after].map(Option::unwrap);
                assert!((bare / before - 1.0).abs() < 1e-3, "{what}: bare volume {:e}", bare / before - 1.0);
                assert!(
                    receipt.lock_max_shift.is_none() || (locked / before - 1.0).abs() < 1e-12,
                    "{what}: {:e}",
                    locked / before - 1.0
                );
                stopped += usize::from(receipt.strokes[0].stopped_at.is_some());
            }
        }
    }
    assert!(stopped <= 2, "{stopped} strokes ended early");
}
