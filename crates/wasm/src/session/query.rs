//! Queries on a session. Arrays in results are copies.

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

/// Default number of points along the longest side of a preview.
const PER_SIDE: usize = 12;

/// A point of the surface found by a query.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Hit {
    hit: SurfaceHit,
}

/// Points around a tool and their displacements by a move, for display as arrows.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Preview {
    arrows: Vec<session::Arrow>,
}

/// Sources of render vertices.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Origins {
    vertices: Vec<u32>,
    triangles: Vec<u32>,
    weights: Vec<f64>,
}

/// Volumes that the stroke in progress has moved through the surface.
#[wasm_bindgen]
#[derive(Debug)]
pub struct MovedVolume {
    /// Volume moved outward, cubic model units.
    #[wasm_bindgen(readonly)]
    pub outward: f64,
    /// Volume moved inward, cubic model units.
    #[wasm_bindgen(readonly)]
    pub inward: f64,
}

#[wasm_bindgen]
impl Session {
    /// Finds the first point of the surface along a ray. Returns undefined if the ray misses the
    /// surface.
    pub fn pick(&self, origin: &[f64], direction: &[f64]) -> Result<Option<Hit>, JsError> {
        let [origin, direction] = [DVec3::from(numbers(origin)?), DVec3::from(numbers(direction)?)];
        Ok(self.session.pick(origin, direction).map(|hit| Hit { hit }))
    }

    /// Finds the closest point of the surface. Returns undefined if the mesh has no triangles.
    #[wasm_bindgen(js_name = closestPoint)]
    pub fn closest_point(&self, point: &[f64]) -> Result<Option<Hit>, JsError> {
        Ok(self.session.closest_point(DVec3::from(numbers(point)?)).map(|hit| Hit { hit }))
    }

    /// Returns the vertices that a stroke of the tool would move at a pose, in ascending order. The
    /// pose has the form described at `moveTo`. The test ignores masks and uses positions without
    /// the displacements of the volume lock.
    #[wasm_bindgen(js_name = verticesInReach)]
    pub fn vertices_in_reach(&self, tool: &Tool, at: &[f64], rotate: Option<Vec<f64>>) -> Result<Vec<u32>, JsError> {
        let mut vertices = Vec::new();
        self.session.vertices_in_reach(&tool.tool, &pose(at, rotate)?, &mut vertices);
        Ok(vertices)
    }

    /// Computes the displacements of a lattice of points around a tool if it moved from `start` to
    /// `end`. Masks apply.
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

    /// Volumes that the stroke in progress has moved; 0 if no stroke is in progress.
    #[wasm_bindgen(getter, js_name = movedVolume)]
    pub fn moved_volume(&self) -> MovedVolume {
        let moved = self.session.moved_volume();
        MovedVolume { outward: moved.outward, inward: moved.inward }
    }

    /// Returns the sources of the render vertices from `start` to `end` (exclusive), by default of
    /// all. After a move, the `attributes` of its changes are the rows that have changed. Throws if
    /// the range is out of bounds.
    pub fn origins(&self, start: Option<u32>, end: Option<u32>) -> Result<Origins, JsError> {
        let count = self.session.buffers().positions.len() as u32;
        let (start, end) = (start.unwrap_or(0), end.unwrap_or(count));
        if start > end || end > count {
            return Err(thrown(format!("{start} to {end} is out of range: there are {count} render vertices")));
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

    /// Volume enclosed by the surface before any volume lock, without the stroke in progress, cubic
    /// model units. Undefined if the surface is open.
    #[wasm_bindgen(getter)]
    pub fn volume(&self) -> Option<f64> {
        self.session.volume()
    }
}

#[wasm_bindgen]
impl Hit {
    /// Triangle that contains the point: a row of `indices`.
    #[wasm_bindgen(getter)]
    pub fn triangle(&self) -> u32 {
        self.hit.triangle
    }

    /// Vertices of the triangle.
    #[wasm_bindgen(getter)]
    pub fn vertices(&self) -> Vec<u32> {
        self.hit.vertices.to_vec()
    }

    /// x, y, z, model units.
    #[wasm_bindgen(getter)]
    pub fn point(&self) -> Vec<f64> {
        self.hit.point.to_array().to_vec()
    }

    /// Barycentric coordinates of the point in the triangle.
    #[wasm_bindgen(getter)]
    pub fn weights(&self) -> Vec<f64> {
        self.hit.weights.to_array().to_vec()
    }

    /// Unit normal of the triangle.
    #[wasm_bindgen(getter)]
    pub fn normal(&self) -> Vec<f64> {
        self.hit.normal.to_array().to_vec()
    }

    /// Distance from the query point in model units. For a ray, the distance divided by the length
    /// of its direction.
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

    /// x, y, z of the displacement of each point, model units.
    #[wasm_bindgen(getter)]
    pub fn shifts(&self) -> Vec<f64> {
        self.arrows.iter().flat_map(|arrow| arrow.shift.to_array()).collect()
    }
}

#[wasm_bindgen]
impl Origins {
    /// Vertex of each render vertex, or 2³² − 1 if it has been removed. The vertices of the opened
    /// mesh come first. Inserted vertices follow and may reuse the numbers of vertices that an
    /// earlier stroke removed.
    #[wasm_bindgen(getter)]
    pub fn vertices(&self) -> Vec<u32> {
        self.vertices.clone()
    }

    /// Triangle of the opened mesh that provides the attributes of each render vertex, or 2³² − 1
    /// for a vertex without triangles.
    #[wasm_bindgen(getter)]
    pub fn triangles(&self) -> Vec<u32> {
        self.triangles.clone()
    }

    /// Three barycentric coordinates in that triangle for each render vertex; zeros for a vertex
    /// without triangles.
    #[wasm_bindgen(getter)]
    pub fn weights(&self) -> Vec<f64> {
        self.weights.clone()
    }
}
