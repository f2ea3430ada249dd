//! Twists and bends that refinement could not follow.

use glam::DVec3;
use isochore_mesh::Aabb;

use crate::recipe::{Recipe, RecipeError, RecipeProblem, Stroke};

/// Most that a twist or a bend may shear the target, as the way that planes or spheres slide over each other against their
/// distance. An edge is drawn out to about as many times its length, so that triangles grow in number as much: larger fills the
/// limit on triangles with what is wound up finer than they are; smaller refuses what can be followed.
const MAX_SHEAR: f64 = 100.0;

/// Refuses a rate that shears what is in `bounds` beyond what refinement can follow.
pub(super) fn check(recipe: &Recipe, bounds: Aabb) -> Result<(), RecipeError> {
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
            let text = format!(
                "is {degrees}, which winds the target up finer than refinement can follow; give {most:.0} or less, or set \
                 refine.enabled = false"
            );
            return Err(RecipeError::new(&format!("stroke.{index}.{key}"), RecipeProblem::Other(text)));
        }
    }
    Ok(())
}
