//! Masks of strokes.

use std::sync::Arc;

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::{Aabb, TriMesh};

use super::{
    SceneError,
    problem::{MaskProblem, SceneProblem},
};
use crate::recipe::{Mask, Recipe, RecipeError, VertexWeights};

/// The masked strokes of `recipe`. `bounds` contains the target or the points; the weights of
/// vertices refer to `target`.
pub(super) fn masked(
    strokes: Vec<field::Stroke>,
    recipe: &Recipe,
    target: Option<&TriMesh>,
    bounds: Aabb,
) -> Result<Vec<field::Stroke>, SceneError> {
    let mask = Arc::new(mask(&recipe.mask, target).map_err(RecipeError::widen::<SceneProblem>)?);
    let masked = |(index, stroke): (usize, &field::Stroke)| {
        let stroke = stroke.masked(&mask, bounds, recipe.integrate.step);
        stroke.map_err(|source| SceneError::Stroke { index, source: source.into() })
    };
    strokes.iter().enumerate().map(masked).collect()
}

/// Builds a mask. The weights of vertices are ignored without a `target`.
pub(crate) fn mask(mask: &Mask, target: Option<&TriMesh>) -> Result<field::Mask, RecipeError<MaskProblem>> {
    let wrong = |key: String| move |error: field::MaskError| RecipeError::new(&key, error);
    let pins = mask.pins.iter().enumerate().map(|(index, pin)| {
        field::Pin::new(DVec3::from_array(pin.center), pin.radius, pin.support)
            .map_err(wrong(format!("mask.pins.{index}")))
    });
    let mirrors = mask.mirror.iter().enumerate().map(|(index, plane)| {
        let [point, normal] = [plane.point, plane.normal].map(DVec3::from_array);
        field::MirrorPlane::new(point, normal).map_err(wrong(format!("mask.mirror.{index}")))
    });
    let (pins, mirrors) = (pins.collect::<Result<_, _>>()?, mirrors.collect::<Result<_, _>>()?);
    let vertices = match (&mask.vertices, target) {
        (None, _) | (_, None) => None,
        (Some(VertexWeights::Values(weights)), Some(target)) => {
            let vertices = field::VertexMask::new(target, weights, mask.fade);
            Some(vertices.map_err(|error| match error {
                field::MaskError::Fade(_) | field::MaskError::NoEdges | field::MaskError::TooManySamples { .. } => {
                    wrong("mask.fade".to_owned())(error)
                }
                error => wrong("mask.vertices".to_owned())(error),
            })?)
        }
        (Some(VertexWeights::File(name)), _) => {
            return Err(RecipeError::new("mask.vertices", MaskProblem::WeightsNotLoaded(name.clone())));
        }
    };
    field::Mask::new(pins, vertices, mirrors).map_err(wrong("mask.mirror".to_owned()))
}
