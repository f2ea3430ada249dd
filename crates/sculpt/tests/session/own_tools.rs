use isochore_field::{Profile, Tool};
use isochore_mesh::{Aabb, Distance, DistanceBlock, HalfSpace, LANES, PointBlock};
use isochore_sculpt::{
    Recipe, ReplayError, recipe,
    recipe::Format,
    session::{HostToolError, SessionReplayError, Supplies},
};

use super::*;

/// The distance that a function computes, one point at a time.
struct OwnDistance<F>(F);

impl<F> std::fmt::Debug for OwnDistance<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("OwnDistance")
    }
}

impl<F: Fn(DVec3) -> (f64, DVec3) + Send + Sync> Distance for OwnDistance<F> {
    fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        for lane in 0..LANES {
            let (value, gradient) = (self.0)(points.get(lane));
            out.value[lane] = value;
            out.gradient.set(lane, gradient);
        }
    }

    fn bounds(&self) -> Aabb {
        Aabb { min: DVec3::splat(-0.2), max: DVec3::splat(0.2) }
    }

    fn centroid(&self) -> DVec3 {
        DVec3::ZERO
    }
}

/// A ball of radius 0.2 that no recipe describes.
fn own_tool() -> Arc<Tool> {
    let distance = OwnDistance(|point: DVec3| (point.length() - 0.2, point.normalize_or_zero()));
    Arc::new(Tool::new(Arc::new(distance), 0.25, Profile::Contact).unwrap())
}

#[test]
fn a_tool_of_the_host_sculpts_and_undo_restores_the_bits() {
    let mut session = ball();
    let tool = Arc::new(SessionTool::from_tool("own", own_tool()).unwrap());
    let opened = snapshot(&session);
    make(&mut session, &tool, &refined(0.08), &arc(0.0, 9));
    assert_sound(&session);
    let sculpted = snapshot(&session);
    assert_ne!(sculpted, opened);
    assert!(session.undo().unwrap());
    assert_eq!(snapshot(&session), opened);
    assert!(session.redo().unwrap());
    assert_eq!(snapshot(&session), sculpted);
    let mut reached = Vec::new();
    session.vertices_in_reach(&tool, &arc(0.0, 1)[0], &mut reached);
    assert!(!reached.is_empty());
}

#[test]
fn a_tool_of_the_host_moves_vertices_to_the_bits_of_the_same_tool_of_a_recipe() {
    let shape = ToolShape::Sphere(Sphere { radius: 0.2 });
    let described = recipe::Tool { shape, support: 0.25, profile: recipe::Profile::Contact, free_form: 0.0 };
    let described = SessionTool::new("ball", described, &Meshes::new(), &NoProgress).unwrap();
    let own = SessionTool::from_tool("ball", Arc::clone(described.tool())).unwrap();
    let [described, own] = [described, own].map(|tool| {
        let mut session = ball();
        make(&mut session, &Arc::new(tool), &refined(0.1), &arc(0.0, 9));
        snapshot(&session)
    });
    assert_eq!(described, own);
}

#[test]
fn the_log_names_a_tool_of_the_host_and_replays_once_it_is_supplied() {
    let mut session = ball();
    let (tool, other) = (own_tool(), own_tool());
    let named = |tool: &Arc<Tool>| Arc::new(SessionTool::from_tool("own", Arc::clone(tool)).unwrap());
    for tool in [named(&tool), named(&other), named(&tool), brush()] {
        make(&mut session, &tool, &UNREFINED, &arc(0.3, 6));
    }
    let log = session.log();
    // Two tools of the same name get two entries. One tool that was named twice gets one.
    assert_eq!(log.tools.keys().collect::<Vec<_>>(), ["brush", "own", "own 2"]);
    assert_eq!((log.tools["own"].support, log.tools["own"].profile), (0.25, recipe::Profile::Contact));
    for (text, format) in [(log.to_toml(), Format::Toml), (log.to_json(), Format::Json)] {
        assert_eq!(Recipe::parse(&text, format, &[]).unwrap(), log);
    }

    // A session replays the log only if all tools are supplied.
    let mut supplies = Supplies::default();
    supplies.tools.insert("own".to_owned(), tool);
    let error = ball().replay(&log, &supplies, &UNREFINED, &NoProgress).unwrap_err();
    assert!(matches!(&error, SessionReplayError::MissingTool { name } if name == "own 2"), "{error}");
    assert!(error.to_string().starts_with("tools.own 2.shape: "), "{error}");
    supplies.tools.insert("own 2".to_owned(), other);
    let mut again = ball();
    again.replay(&log, &supplies, &UNREFINED, &NoProgress).unwrap();
    assert_eq!(snapshot(&again), snapshot(&session));
    assert_eq!(again.log(), log);
}

#[test]
fn a_recipe_alone_does_not_build_a_tool_of_the_host() {
    let mut session = ball();
    make(&mut session, &Arc::new(SessionTool::from_tool("own", own_tool()).unwrap()), &UNREFINED, &arc(0.0, 5));
    let log = session.log();
    let meshes = Meshes::from([("target".to_owned(), Arc::new(icosphere(1.0, 3)))]);
    let error: ReplayError = isochore_sculpt::replay(&log, &meshes, &NoProgress).unwrap_err();
    assert_eq!(error.key().as_deref(), Some("tools.own.shape"));
    let error = SessionTool::new("own", log.tools["own"].clone(), &Meshes::new(), &NoProgress).unwrap_err();
    assert!(error.to_string().contains("supplies the tool"), "{error}");
}

#[test]
fn rejects_a_tool_of_the_host_without_finite_bounds() {
    let half_space = HalfSpace::new(DVec3::ZERO, DVec3::Z).unwrap();
    let unbounded = Arc::new(Tool::new(Arc::new(half_space), 0.25, Profile::Contact).unwrap());
    let error = SessionTool::from_tool("own", Arc::clone(&unbounded)).unwrap_err();
    assert_eq!(error, HostToolError::Unbounded { name: "own".to_owned() });
    let message = error.to_string();
    assert!(
        message.starts_with("tools.own.shape: ") && message.contains("intersect the shape with a box"),
        "{message}"
    );

    // A replay rejects it as well.
    let mut session = ball();
    make(&mut session, &Arc::new(SessionTool::from_tool("own", own_tool()).unwrap()), &UNREFINED, &arc(0.0, 5));
    let mut supplies = Supplies::default();
    supplies.tools.insert("own".to_owned(), unbounded);
    let error = ball().replay(&session.log(), &supplies, &UNREFINED, &NoProgress).unwrap_err();
    assert!(
        matches!(&error, SessionReplayError::HostTool(HostToolError::Unbounded { name }) if name == "own"),
        "{error}"
    );
}
