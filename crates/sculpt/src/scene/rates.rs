//! Limits of twists and bends.

use glam::DVec3;
use isochore_mesh::Aabb;

use super::problem::SceneProblem;
use crate::recipe::{Recipe, RecipeError, Stroke};

/// Largest shear of the target by a twist or a bend: the displacement of neighboring planes or
/// spheres relative to each other, divided by their distance. Edges are stretched by about this
/// factor, and the number of triangles grows with it. A larger value exhausts the limit on
/// triangles before they resolve the flow; a smaller one refuses flows that refinement can follow.
const MAX_SHEAR: f64 = 100.0;

/// Refuses a rate that shears a target in `bounds` more than refinement can follow.
pub(super) fn check(recipe: &Recipe, bounds: Aabb) -> Result<(), RecipeError<SceneProblem>> {
    let strokes = recipe.strokes.iter().enumerate().filter(|_| recipe.refine.enabled);
    for (index, stroke) in strokes {
        let (origin, key, degrees) = match stroke {
            Stroke::Twist(twist) => (twist.origin, "degrees_per_unit", twist.degrees_per_unit),
            Stroke::Bend(bend) => (bend.origin, "degrees_per_unit2", bend.degrees_per_unit2),
            _ => continue,
        };
        let arms = bounds.corners().map(|corner| corner - DVec3::from_array(origin));
        let per_degree = arms.map(|arm| match stroke {
            Stroke::Twist(twist) => arm.reject_from(DVec3::from_array(twist.axis).normalize_or(DVec3::Z)).length(),
            // The angle grows with the square of the distance, so the shear is twice that square.
            _ => 2.0 * arm.length_squared(),
        });
        let per_degree = per_degree.into_iter().fold(0.0, f64::max).to_radians();
        if degrees.abs() * per_degree > MAX_SHEAR {
            let most = MAX_SHEAR / per_degree;
            let problem = SceneProblem::Shear { found: degrees, most };
            return Err(RecipeError::new(&format!("stroke.{index}.{key}"), problem));
        }
    }
    Ok(())
}
