//! What a host asks of a session. Arrays that answers hold are copies, which stay.

use glam::DVec3;
use isochore_mesh::NONE;
use isochore_sculpt::session::{self, Hit as SurfaceHit};
use wasm_bindgen::prelude::*;

use super::{Session, pose};
use crate::{
    error::thrown,
    options::{PreviewOptions, count, numbers, options},
    tool::Tool,
};

/// Points along the longest side of a preview unless the host says otherwise.
const PER_SIDE: usize = 12;

/// A point of the surface that a query found.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Hit {
    hit: SurfaceHit,
}

/// Points around a tool and where a move would shift them: arrows to draw.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Preview {
    arrows: Vec<session::Arrow>,
}

/// Where render vertices come from.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Origins {
    vertices: Vec<u32>,
    triangles: Vec<u32>,
    weights: Vec<f64>,
}

/// Volume that the stroke under way has moved through the surface.
#[wasm_bindgen]
#[derive(Debug)]
pub struct MovedVolume {
    /// Swept by parts of the surface that moved outward, cubic model units.
    #[wasm_bindgen(readonly)]
    pub outward: f64,
    /// Swept by parts of the surface that moved inward, cubic model units.
    #[wasm_bindgen(readonly)]
    pub inward: f64,
}

#[wasm_bindgen]
impl Session {
    /// The first point of the surface on a ray.
    pub fn pick(&self, origin: &[f64], direction: &[f64]) -> Result<Option<Hit>, JsError> {
        let [origin, direction] = [DVec3::from(numbers(origin)?), DVec3::from(numbers(direction)?)];
        Ok(self.session.pick(origin, direction).map(|hit| Hit { hit }))
    }

    /// The point of the surface nearest to a point.
    #[wasm_bindgen(js_name = closestPoint)]
    pub fn closest_point(&self, point: &[f64]) -> Result<Option<Hit>, JsError> {
        Ok(self.session.closest_point(DVec3::from(numbers(point)?)).map(|hit| Hit { hit }))
    }

    /// Numbers of the vertices that a stroke of the tool would move at a pose, given as to `moveTo`, masks apart, in ascending order.
    /// They count as reached where the flow has left them, without what the lock has added.
    #[wasm_bindgen(js_name = verticesInReach)]
    pub fn vertices_in_reach(&self, tool: &Tool, at: &[f64], rotate: Option<Vec<f64>>) -> Result<Vec<u32>, JsError> {
        let mut vertices = Vec::new();
        self.session.vertices_in_reach(&tool.tool, &pose(at, rotate)?, &mut vertices);
        Ok(vertices)
    }

    /// Where a move of a tool from one place to another would shift a lattice of points around it, masks included.
    pub fn preview(
        &self,
        tool: &Tool,
        start: &[f64],
        end: &[f64],
        options: Option<PreviewOptions>,
    ) -> Result<Preview, JsError> {
        let options = self::options(options, &["perSide", "startRotate", "endRotate"])?;
        let (start, end) = (pose(start, options.start_rotate())?, pose(end, options.end_rotate())?);
        let per_side = count("perSide", options.per_side(), PER_SIDE)?;
        let arrows = self.session.preview(&tool.tool, &start, &end, per_side).map_err(thrown)?;
        Ok(Preview { arrows })
    }

    /// Volume that the stroke under way has moved so far; zero where there is none.
    #[wasm_bindgen(getter, js_name = movedVolume)]
    pub fn moved_volume(&self) -> MovedVolume {
        let moved = self.session.moved_volume();
        MovedVolume { outward: moved.outward, inward: moved.inward }
    }

    /// Where render vertices come from: those from `start` to before `end`, or all. After a move, the ranges of `attributes` in its
    /// changes tell which are new.
    pub fn origins(&self, start: Option<u32>, end: Option<u32>) -> Result<Origins, JsError> {
        let count = self.session.buffers().positions.len() as u32;
        let (start, end) = (start.unwrap_or(0), end.unwrap_or(count));
        if start > end || end > count {
            return Err(thrown(format!("{start} to {end} are none of the {count} render vertices")));
        }
        let (mut triangles, mut weights) = (Vec::new(), Vec::new());
        for render in start..end {
            let origin = self.session.origin_of(render);
            triangles.push(origin.map_or(NONE, |origin| origin.triangle));
            weights.extend(origin.map_or([0.0; 3], |origin| origin.weights.to_array()));
        }
        let vertices = (start..end).map(|render| self.session.vertex_of(render)).collect();
        Ok(Origins { vertices, triangles, weights })
    }

    /// Volume inside the surface without the stroke under way; undefined where it is open.
    #[wasm_bindgen(getter)]
    pub fn volume(&self) -> Option<f64> {
        self.session.volume()
    }
}

#[wasm_bindgen]
impl Hit {
    /// The triangle, a row of the indices.
    #[wasm_bindgen(getter)]
    pub fn triangle(&self) -> u32 {
        self.hit.triangle
    }

    /// Numbers of its vertices.
    #[wasm_bindgen(getter)]
    pub fn vertices(&self) -> Vec<u32> {
        self.hit.vertices.to_vec()
    }

    /// x, y, z, model units.
    #[wasm_bindgen(getter)]
    pub fn point(&self) -> Vec<f64> {
        self.hit.point.to_array().to_vec()
    }

    /// Its barycentric coordinates in the triangle: how much each of the vertices counts for it.
    #[wasm_bindgen(getter)]
    pub fn weights(&self) -> Vec<f64> {
        self.hit.weights.to_array().to_vec()
    }

    /// Unit normal of the triangle.
    #[wasm_bindgen(getter)]
    pub fn normal(&self) -> Vec<f64> {
        self.hit.normal.to_array().to_vec()
    }

    /// Along a ray in lengths of its direction; else in model units.
    #[wasm_bindgen(getter)]
    pub fn distance(&self) -> f64 {
        self.hit.distance
    }
}

#[wasm_bindgen]
impl Preview {
    /// x, y, z of each point, model units.
    #[wasm_bindgen(getter)]
    pub fn points(&self) -> Vec<f64> {
        self.arrows.iter().flat_map(|arrow| arrow.point.to_array()).collect()
    }

    /// x, y, z of by how much the move carries each point, model units.
    #[wasm_bindgen(getter)]
    pub fn shifts(&self) -> Vec<f64> {
        self.arrows.iter().flat_map(|arrow| arrow.shift.to_array()).collect()
    }
}

#[wasm_bindgen]
impl Origins {
    /// The vertex that each shows; 2³² − 1 where that was removed. The first ones are those of the mesh as opened; inserted ones
    /// follow, and may take the numbers of others that an earlier stroke has removed.
    #[wasm_bindgen(getter)]
    pub fn vertices(&self) -> Vec<u32> {
        self.vertices.clone()
    }

    /// The triangle of the mesh as opened that each takes its attributes from; 2³² − 1 for one without triangles.
    #[wasm_bindgen(getter)]
    pub fn triangles(&self) -> Vec<u32> {
        self.triangles.clone()
    }

    /// Three barycentric coordinates in that triangle for each; zero for one without triangles.
    #[wasm_bindgen(getter)]
    pub fn weights(&self) -> Vec<f64> {
        self.weights.clone()
    }
}
