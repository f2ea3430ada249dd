//! What the types alone cannot tell: numbers in range, names that exist, motions that are motions.

use glam::{DQuat, DVec3};

use super::{
    Integrate, Key, Mask, Recipe, Target, TargetShape, Tool, ToolShape, Transform, VertexWeights,
    error::{RecipeError, RecipeProblem, nearest},
    rotation::quaternion,
    stroke::Stroke,
};

/// Most triangles of a shape that a recipe makes. Each takes some hundred bytes in all that follows, so that much larger ones
/// exhaust the memory of an ordinary machine; a smaller limit would refuse what such a machine can do.
const MAX_SHAPE_TRIANGLES: u64 = 20_000_000;

/// Coarsest distance grid of a tool mesh, in cells along its longest side: with fewer there is no cell whose spline sees both
/// the inside and the outside.
const MIN_RESOLUTION: u64 = 4;

/// Finest distance grid of a tool mesh, in cells along its longest side: the samples of a cube take 4 GiB at most, padding not
/// counted.
const MAX_RESOLUTION: u64 = 1024;

/// How near to half a turn, in radians, both ways round count as equally short. Larger, and motions that are clear are refused;
/// smaller, and rounding in the angle decides which way the tool turns.
const HALF_TURN_TOLERANCE: f64 = 1e-9;

pub(super) type Check = Result<(), RecipeError>;

impl Recipe {
    /// Checks everything that can be checked without the meshes.
    ///
    /// # Errors
    /// The first key found whose value cannot be used.
    pub fn validate(&self) -> Check {
        if self.recipe != 1 {
            return fail("recipe", RecipeProblem::UnknownVersion(self.recipe));
        }
        self.target.validate().map_err(|error| error.inside("target"))?;
        for (name, item) in &self.tools {
            item.validate().map_err(|error| error.inside(name).inside("tools"))?;
        }
        for (index, item) in self.strokes.iter().enumerate() {
            self.stroke(item).map_err(|error| error.inside(&index.to_string()).inside("stroke"))?;
        }
        self.integrate.validate().map_err(|error| error.inside("integrate"))?;
        self.mask.validate().map_err(|error| error.inside("mask"))?;
        positive("refine.volume", self.refine.volume)?;
        positive("refine.deviation", self.refine.deviation)?;
        self.refine.max_edge.map_or(Ok(()), |length| positive("refine.max_edge", length))?;
        at_least("refine.max_triangles", self.refine.max_triangles as u64, 1)?;
        self.promise.volume.map_or(Ok(()), |change| not_negative("promise.volume", change))?;
        self.output.view.map_or(Ok(()), |view| direction("output.view", &view))?;
        self.output.frames.as_ref().map_or(Ok(()), |frames| at_least("output.frames.count", frames.count.into(), 2))
    }

    fn stroke(&self, stroke: &Stroke) -> Check {
        match stroke {
            Stroke::Move(motion) => {
                self.tool(&motion.tool)?;
                keys(&motion.keys)
            }
            Stroke::Twist(twist) => {
                all_finite("origin", &twist.origin)?;
                direction("axis", &twist.axis)?;
                finite("degrees_per_unit", twist.degrees_per_unit)
            }
            Stroke::Bend(bend) => {
                all_finite("origin", &bend.origin)?;
                direction("axis", &bend.axis)?;
                finite("degrees_per_unit2", bend.degrees_per_unit2)
            }
            Stroke::Stamp(stamp) => {
                self.tool(&stamp.tool)?;
                keys(&stamp.keys)?;
                stamp.relief.map_or(Ok(()), |length| positive("relief", length))
            }
            Stroke::Strip(strip) => {
                strip.tool.as_ref().map_or(Ok(()), |name| self.tool(name))?;
                super::strip::validate(strip)
            }
            Stroke::Ring(ring) => super::ring::validate(ring),
            Stroke::Pose(pose) => pose.validate(self),
            Stroke::Region(region) => region.validate(self),
        }
    }

    /// Whether the stroke's tool is one of the recipe's.
    pub(super) fn tool(&self, name: &str) -> Check {
        if self.tools.contains_key(name) {
            return Ok(());
        }
        let known = self.tools.keys();
        let nearest = nearest(name, known.clone().map(String::as_str));
        let problem = RecipeProblem::UnknownTool { name: name.to_owned(), nearest, known: known.cloned().collect() };
        fail("tool", problem)
    }
}

fn keys(keys: &[Key]) -> Check {
    if keys.len() < 2 {
        return fail("keys", RecipeProblem::TooFewKeys(keys.len()));
    }
    let mut before: Option<DQuat> = None;
    for (index, key) in keys.iter().enumerate() {
        key.validate().map_err(|error| error.inside(&index.to_string()).inside("keys"))?;
        let rotation = quaternion(key.rotate);
        if before.is_some_and(|before| is_half_turn(before, rotation)) {
            return fail(&format!("keys.{index}.rotate"), RecipeProblem::HalfTurn);
        }
        before = Some(rotation);
    }
    Ok(())
}

impl Mask {
    /// Checks everything that can be checked without the target. Keys of errors are relative to the mask.
    pub(crate) fn validate(&self) -> Check {
        for (index, pin) in self.pins.iter().enumerate() {
            let path = |name: &str| format!("pins.{index}.{name}");
            all_finite(&path("center"), &pin.center)?;
            not_negative(&path("radius"), pin.radius)?;
            positive(&path("support"), pin.support)?;
        }
        for (index, plane) in self.mirror.iter().enumerate() {
            let path = |name: &str| format!("mirror.{index}.{name}");
            all_finite(&path("point"), &plane.point)?;
            direction(&path("normal"), &plane.normal)?;
        }
        if let Some(VertexWeights::Values(weights)) = &self.vertices {
            for (index, &weight) in weights.iter().enumerate() {
                let key = format!("vertices.{index}");
                not_negative(&key, weight)?;
                at_most(&key, weight, 1.0)?;
            }
        }
        if self.fade.is_some() && self.vertices.is_none() {
            let text = "is how the hold of `vertices` fades; add them, or remove this".to_owned();
            return fail("fade", RecipeProblem::Other(text));
        }
        self.fade.map_or(Ok(()), |fade| positive("fade", fade))
    }
}

impl Integrate {
    /// Checks the time step. Keys of errors are relative to this table.
    pub(crate) fn validate(&self) -> Check {
        positive("step", self.step)?;
        at_most("step", self.step, 1.0)
    }
}

impl Key {
    /// Checks that the numbers are finite and the axis is nonzero.
    pub(crate) fn validate(&self) -> Check {
        all_finite("at", &self.at)?;
        rotation("rotate", &self.rotate)
    }
}

impl Tool {
    /// Checks everything that can be checked without the mesh. Keys of errors are relative to the tool.
    pub(crate) fn validate(&self) -> Check {
        tool_shape(&self.shape).map_err(|error| error.inside("shape"))?;
        positive("support", self.support)?;
        not_negative("free_form", self.free_form)?;
        at_most("free_form", self.free_form, 1.0)
    }
}

/// Whether two rotations differ by half a turn.
pub(super) fn is_half_turn(before: DQuat, after: DQuat) -> bool {
    // The scalar part of the relative rotation is the cosine of half its angle, and near half a turn its sine is that small.
    before.dot(after).abs() <= 0.5 * HALF_TURN_TOLERANCE
}

impl Target {
    /// Checks everything that can be checked without the mesh. Keys of errors are relative to the target.
    pub(crate) fn validate(&self) -> Check {
        match (&self.mesh, &self.shape) {
            (Some(_), Some(_)) => return fail("", RecipeProblem::MeshAndShape),
            (None, None) => return fail("", RecipeProblem::NeitherMeshNorShape),
            (Some(_), None) => {}
            (None, Some(shape)) => target_shape(shape).map_err(|error| error.inside("shape"))?,
        }
        transform(&self.transform).map_err(|error| error.inside("transform"))
    }
}

fn target_shape(shape: &TargetShape) -> Check {
    let (triangles, key) = match shape {
        TargetShape::Icosphere(shape) => {
            positive("radius", shape.radius)?;
            (20_u64.saturating_mul(4_u64.saturating_pow(shape.subdivisions)), "subdivisions")
        }
        TargetShape::Box(shape) => {
            all_positive("half_extents", &shape.half_extents)?;
            all_at_least("segments", &shape.segments, &[1, 1, 1])?;
            let [x, y, z] = shape.segments.map(u64::from);
            let cells = x.saturating_mul(y).saturating_add(y.saturating_mul(z)).saturating_add(z.saturating_mul(x));
            (cells.saturating_mul(4), "segments")
        }
        TargetShape::Sphere(shape) => {
            positive("radius", shape.radius)?;
            all_at_least("segments", &shape.segments, &[3, 2])?;
            let [around, across] = shape.segments.map(u64::from);
            (around.saturating_mul(across - 1).saturating_mul(2), "segments")
        }
    };
    if triangles > MAX_SHAPE_TRIANGLES {
        let problem = RecipeProblem::TooLarge { requested: triangles, most: MAX_SHAPE_TRIANGLES, what: "triangles" };
        return fail(key, problem);
    }
    Ok(())
}

fn tool_shape(shape: &ToolShape) -> Check {
    match shape {
        ToolShape::Sphere(shape) => positive("radius", shape.radius),
        ToolShape::Capsule(shape) => {
            positive("radius", shape.radius)?;
            not_negative("half_length", shape.half_length)
        }
        ToolShape::Box(shape) => {
            all_positive("half_extents", &shape.half_extents)?;
            not_negative("rounding", shape.rounding)?;
            let most = shape.half_extents.into_iter().fold(f64::INFINITY, f64::min);
            if shape.rounding > most {
                let text =
                    format!("is {}, more than the smallest of half_extents; give {most} or less", shape.rounding);
                return fail("rounding", RecipeProblem::Other(text));
            }
            Ok(())
        }
        ToolShape::Torus(shape) => {
            positive("major", shape.major)?;
            positive("minor", shape.minor)?;
            if shape.minor >= shape.major {
                let text = format!("is {}, not below major, so that the ring has no hole; give less", shape.minor);
                return fail("minor", RecipeProblem::Other(text));
            }
            Ok(())
        }
        ToolShape::Ellipsoid(shape) => all_positive("radii", &shape.radii),
        ToolShape::Host(_) => Ok(()),
        ToolShape::Mesh(shape) => {
            at_least("resolution", shape.resolution.into(), MIN_RESOLUTION)?;
            if u64::from(shape.resolution) > MAX_RESOLUTION {
                let requested = shape.resolution.into();
                let problem =
                    RecipeProblem::TooLarge { requested, most: MAX_RESOLUTION, what: "cells on the longest side" };
                return fail("resolution", problem);
            }
            transform(&shape.transform).map_err(|error| error.inside("transform"))
        }
    }
}

fn transform(transform: &Transform) -> Check {
    positive("scale", transform.scale)?;
    rotation("rotate", &transform.rotate)?;
    all_finite("translate", &transform.translate)
}

pub(super) fn rotation(key: &str, rotate: &[f64; 4]) -> Check {
    let [x, y, z, degrees] = *rotate;
    direction(key, &[x, y, z])?;
    finite(key, degrees)
}

pub(super) fn direction(key: &str, axis: &[f64; 3]) -> Check {
    all_finite(key, axis)?;
    // The same test as the one that later makes a unit vector of it, so that no axis passes here and fails there.
    match DVec3::from_array(*axis).try_normalize() {
        Some(_) => Ok(()),
        None => fail(key, RecipeProblem::ZeroAxis),
    }
}

pub(super) fn finite(key: &str, value: f64) -> Check {
    if value.is_finite() { Ok(()) } else { fail(key, RecipeProblem::NotFinite(value)) }
}

pub(super) fn all_finite(key: &str, values: &[f64]) -> Check {
    values.iter().try_for_each(|&value| finite(key, value))
}

pub(super) fn positive(key: &str, value: f64) -> Check {
    finite(key, value)?;
    if value > 0.0 { Ok(()) } else { fail(key, RecipeProblem::NotPositive(value)) }
}

fn all_positive(key: &str, values: &[f64]) -> Check {
    values.iter().try_for_each(|&value| positive(key, value))
}

fn not_negative(key: &str, value: f64) -> Check {
    finite(key, value)?;
    if value >= 0.0 { Ok(()) } else { fail(key, RecipeProblem::Negative(value)) }
}

fn at_most(key: &str, value: f64, most: f64) -> Check {
    if value <= most { Ok(()) } else { fail(key, RecipeProblem::AboveMost { found: value, most }) }
}

fn at_least(key: &str, found: u64, least: u64) -> Check {
    if found >= least { Ok(()) } else { fail(key, RecipeProblem::TooSmall { found, least }) }
}

fn all_at_least(key: &str, found: &[u32], least: &[u64]) -> Check {
    found.iter().zip(least).try_for_each(|(&found, &least)| at_least(key, found.into(), least))
}

pub(super) fn fail(key: &str, problem: RecipeProblem) -> Check {
    Err(RecipeError::new(key, problem))
}
