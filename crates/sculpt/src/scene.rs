//! The objects that a recipe's plain data describe.

pub(crate) mod mask;
mod pose;
mod rates;
mod region;
mod strip;
mod tool;

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use glam::{DQuat, DVec3};
use isochore_field as field;
use isochore_mesh::{
    self as mesh, Aabb, ClosedMesh, Distance, DistanceField, DistanceFieldError, DistanceFieldOptions, Monitor,
    Padding, TriMesh, primitives,
};
use web_time::Instant;

use crate::{
    recipe::{
        InnerRegion, Key, Mask, Profile, Recipe, RecipeError, RecipeProblem, Stroke, Target, TargetShape, Tool,
        ToolShape, Transform,
    },
    replay::{Meshes, ReplayError},
};

/// A recipe's target and strokes, ready to be put together.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The target where it stands in the world.
    pub target: Arc<TriMesh>,
    /// The strokes, in order.
    pub strokes: Vec<field::Stroke>,
    /// How they are to be applied.
    pub options: field::DeformOptions,
    /// What the user should know about how the recipe was understood.
    pub warnings: Vec<String>,
    /// Time that the distance grids of tool meshes took.
    pub distance_seconds: f64,
}

impl Scene {
    /// Makes the objects of `recipe`, whose mesh files are in `meshes`.
    ///
    /// # Errors
    /// [`ReplayError`], naming the key of the recipe that cannot be followed.
    pub fn build(recipe: &Recipe, meshes: &Meshes, monitor: &dyn Monitor) -> Result<Self, ReplayError> {
        recipe.validate()?;
        let target = target(&recipe.target, meshes)?;
        rates::check(recipe, target.bounds())?;
        if recipe.promise.volume.is_some() {
            let defect = match ClosedMesh::new(&target) {
                Ok(closed) => (closed.volume() == 0.0).then(|| "it is zero".to_owned()),
                Err(defect) => Some(defect.to_string()),
            };
            if let Some(defect) = defect {
                let text = format!("the target encloses no volume ({defect}); close it, or remove this promise");
                return Err(RecipeError::new("promise.volume", RecipeProblem::Other(text)).into());
            }
        }
        let mut workshop = Workshop { recipe, meshes, monitor, bounds: target.bounds(), warnings: Vec::new() };
        let start = Instant::now();
        let mut strokes = workshop.strokes()?;
        if recipe.mask != Mask::default() {
            strokes = mask::masked(strokes, recipe, Some(&target), target.bounds())?;
        }
        let refine = field::RefineOptions {
            volume: recipe.refine.volume,
            deviation: recipe.refine.deviation,
            max_edge: recipe.refine.max_edge,
            max_triangles: recipe.refine.max_triangles,
        };
        Ok(Self {
            target,
            strokes,
            options: field::DeformOptions { refine: recipe.refine.enabled.then_some(refine), lock: recipe.volume.lock },
            warnings: workshop.warnings,
            distance_seconds: start.elapsed().as_secs_f64(),
        })
    }

    /// Makes the strokes of `recipe` alone, for points in `bounds` that are no mesh, and what the user should know about them.
    ///
    /// Weights of vertices belong to the target, so with those its mesh must be there too.
    ///
    /// # Errors
    /// [`ReplayError`], naming the key of the recipe that cannot be followed.
    pub fn strokes(
        recipe: &Recipe,
        meshes: &Meshes,
        bounds: Aabb,
        monitor: &dyn Monitor,
    ) -> Result<(Vec<field::Stroke>, Vec<String>), ReplayError> {
        recipe.validate()?;
        let target = target(&recipe.target, meshes);
        // With the bounds of the mesh, points take the very steps of its vertices.
        let bounds = target.as_ref().map_or(bounds, |target| target.bounds());
        let mut workshop = Workshop { recipe, meshes, monitor, bounds, warnings: Vec::new() };
        let mut strokes = workshop.strokes()?;
        if recipe.mask != Mask::default() {
            let target = if recipe.mask.vertices.is_some() { Some(target?) } else { None };
            strokes = mask::masked(strokes, recipe, target.as_deref(), bounds)?;
        }
        Ok((strokes, workshop.warnings))
    }
}

struct Workshop<'a> {
    recipe: &'a Recipe,
    meshes: &'a Meshes,
    monitor: &'a dyn Monitor,
    /// Box that holds what is deformed.
    bounds: Aabb,
    warnings: Vec<String>,
}

impl Workshop<'_> {
    fn strokes(&mut self) -> Result<Vec<field::Stroke>, ReplayError> {
        if let Some(name) = self.recipe.curve_names().first() {
            return Err(ReplayError::MissingCurve { name: (*name).to_owned() });
        }
        let mut tools = BTreeMap::new();
        for name in used_tools(self.recipe) {
            tools.insert(name, Arc::new(self.tool(name, &self.recipe.tools[name])?));
        }
        let strokes = self.recipe.strokes.iter().enumerate();
        strokes.map(|(index, stroke)| self.stroke(index, stroke, &tools)).collect()
    }

    fn stroke(
        &self,
        index: usize,
        stroke: &Stroke,
        tools: &BTreeMap<&str, Arc<field::Tool>>,
    ) -> Result<field::Stroke, ReplayError> {
        let stroke = match stroke {
            Stroke::Move(motion) => {
                let tool = Arc::clone(&tools[motion.tool.as_str()]);
                let keys = motion.keys.iter().map(Key::pose).collect::<Result<_, _>>()?;
                field::Move::new(tool, keys, self.recipe.integrate.step).map(field::Stroke::Move)
            }
            Stroke::Twist(twist) => {
                let [origin, axis] = [twist.origin, twist.axis].map(DVec3::from_array);
                field::Twist::new(origin, axis, twist.degrees_per_unit.to_radians()).map(field::Stroke::Twist)
            }
            Stroke::Bend(bend) => {
                let [origin, axis] = [bend.origin, bend.axis].map(DVec3::from_array);
                field::Bend::new(origin, axis, bend.degrees_per_unit2.to_radians()).map(field::Stroke::Bend)
            }
            Stroke::Stamp(stamp) => {
                let tool = Arc::clone(&tools[stamp.tool.as_str()]);
                let keys = stamp.keys.iter().map(Key::pose).collect::<Result<_, _>>()?;
                let step = self.recipe.integrate.step;
                field::Stamp::new(tool, keys, step, stamp.relief).map(field::Stroke::Stamp)
            }
            Stroke::Strip(strip) => {
                strip::strip(strip, tools).map_err(field::StrokeError::from).and_then(|strip| self.field_stroke(strip))
            }
            Stroke::Ring(ring) => {
                strip::ring(ring).map_err(field::StrokeError::from).and_then(|ring| self.field_stroke(ring))
            }
            Stroke::Region(region) => region::stroke(region, tools, self.recipe.integrate.step, self.bounds)
                .map_err(|error| error.inside(&index.to_string()).inside("stroke"))?,
            Stroke::Pose(pose) => pose::stroke(pose, tools, self.recipe.integrate.step).map_err(|error| {
                RecipeError::new(&format!("stroke.{index}"), RecipeProblem::Other(error.to_string()))
            })?,
        };
        stroke.map_err(|source| ReplayError::Stroke { index, source })
    }

    fn field_stroke(&self, field: impl field::MovingField + 'static) -> Result<field::Stroke, field::StrokeError> {
        field::FieldStroke::new(vec![Arc::new(field)], self.recipe.integrate.step).map(field::Stroke::Field)
    }

    fn tool(&mut self, name: &str, tool: &Tool) -> Result<field::Tool, ReplayError> {
        let distance = self.distance(name, tool)?;
        field::Tool::new(distance, tool.support, profile(tool.profile))
            .and_then(|made| made.with_free_form(tool.free_form))
            .map_err(|source| ReplayError::Tool { name: name.to_owned(), source })
    }

    fn distance(&mut self, name: &str, tool: &Tool) -> Result<Arc<dyn Distance>, ReplayError> {
        match &tool.shape {
            ToolShape::Mesh(shape) => {
                let placed = transformed(find(self.meshes, &shape.mesh)?, &shape.transform);
                let reach = self.reach(name, tool)?;
                Ok(Arc::new(self.distance_field(name, &placed, shape.resolution, tool.support, reach)?))
            }
            shape => analytic_distance(shape)
                .map_err(|problem| RecipeError::new(&format!("tools.{name}.shape"), problem).into()),
        }
    }

    /// How far around the shape of a tool its distance must be known: to the end of the support, and as a bone farther.
    fn reach(&self, name: &str, tool: &Tool) -> Result<f64, ReplayError> {
        let mut reach = tool.support;
        for stroke in &self.recipe.strokes {
            if let Stroke::Region(region) = stroke
                && matches!(&region.inner, InnerRegion::Tool(inner) if inner.tool == name)
            {
                reach = reach.max(region.outer_distance);
            }
            if let Stroke::Pose(pose) = stroke
                && pose.bones.iter().any(|bone| bone.tool == name)
            {
                let extent = |name: &str| self.extent(&self.recipe.tools[name]);
                reach = reach.max(pose::least_reach(pose, extent)?);
            }
        }
        Ok(reach)
    }

    /// Bounds of a tool's shape, in tool coordinates, and the support.
    fn extent(&self, tool: &Tool) -> Result<(Aabb, f64), ReplayError> {
        let bounds = match &tool.shape {
            ToolShape::Mesh(shape) => transformed(find(self.meshes, &shape.mesh)?, &shape.transform).bounds(),
            shape => analytic_distance(shape).map_err(|problem| RecipeError::new("tools", problem))?.bounds(),
        };
        Ok((bounds, tool.support))
    }

    fn distance_field(
        &mut self,
        name: &str,
        mesh: &TriMesh,
        resolution: u32,
        support: f64,
        reach: f64,
    ) -> Result<DistanceField, ReplayError> {
        let least = least_resolution(mesh, support);
        if f64::from(resolution) < least {
            self.warnings.push(format!(
                "tools.{name}.shape.resolution: raised from {resolution} to {least}, so that six cells fit into the support"
            ));
        }
        // A cast to integer saturates; the memory limit sees to the rest.
        let resolution = least.max(resolution.into()) as usize;
        let options = DistanceFieldOptions { resolution, padding: Padding::Reach(reach), ..Default::default() };
        let field = DistanceField::new(mesh, &options, self.monitor).map_err(|error| match error {
            DistanceFieldError::Cancelled(cancelled) => ReplayError::Cancelled(cancelled),
            source => ReplayError::DistanceField { name: name.to_owned(), source },
        })?;
        if !field.is_closed() {
            self.warnings.push(format!(
                "tools.{name}.shape.mesh: the mesh is open; its inside is taken to be where its winding number is above one half"
            ));
        }
        Ok(field)
    }
}

/// Cells that fit into the support at least: with fewer, the kinks of the interpolant show in the field.
const CELLS_PER_SUPPORT: f64 = 6.0;

/// The fewest cells along the longest side of `mesh` that resolve a support of this width; a whole number.
fn least_resolution(mesh: &TriMesh, support: f64) -> f64 {
    (CELLS_PER_SUPPORT * mesh.bounds().size().max_element() / support).ceil()
}

/// Distance in closed form of every shape but a mesh.
pub(crate) fn analytic_distance(shape: &ToolShape) -> Result<Arc<dyn Distance>, RecipeProblem> {
    let vector = DVec3::from_array;
    let distance: Result<Arc<dyn Distance>, mesh::ShapeError> = match shape {
        ToolShape::Sphere(shape) => mesh::Sphere::new(shape.radius).map(|distance| Arc::new(distance) as _),
        ToolShape::Capsule(shape) => {
            mesh::Capsule::new(shape.radius, shape.half_length).map(|distance| Arc::new(distance) as _)
        }
        ToolShape::Box(shape) => {
            mesh::RoundedBox::new(vector(shape.half_extents), shape.rounding).map(|distance| Arc::new(distance) as _)
        }
        ToolShape::Torus(shape) => mesh::Torus::new(shape.major, shape.minor).map(|distance| Arc::new(distance) as _),
        ToolShape::Ellipsoid(shape) => {
            mesh::Ellipsoid::new(vector(shape.radii)).map(|distance| Arc::new(distance) as _)
        }
        ToolShape::Mesh(_) => return Err(RecipeProblem::Other("a mesh has no distance in closed form".to_owned())),
    };
    distance.map_err(|error| RecipeProblem::Other(error.to_string()))
}

fn target(target: &Target, meshes: &Meshes) -> Result<Arc<TriMesh>, ReplayError> {
    let mesh = match (&target.mesh, &target.shape) {
        (Some(name), _) => Arc::clone(find(meshes, name)?),
        (None, Some(shape)) => Arc::new(target_mesh(shape)),
        (None, None) => return Err(RecipeError::new("target", RecipeProblem::NeitherMeshNorShape).into()),
    };
    // The identity would round too: the bits of a mesh that is not placed must be those of its file.
    Ok(if target.transform == Transform::default() { mesh } else { Arc::new(transformed(&mesh, &target.transform)) })
}

fn target_mesh(shape: &TargetShape) -> TriMesh {
    match shape {
        TargetShape::Icosphere(shape) => primitives::icosphere(shape.radius, shape.subdivisions),
        TargetShape::Box(shape) => {
            primitives::box_mesh(DVec3::from_array(shape.half_extents), shape.segments.map(|count| count as usize))
        }
        TargetShape::Sphere(shape) => {
            let [longitude, latitude] = shape.segments.map(|count| count as usize);
            primitives::latitude_longitude_sphere(shape.radius, longitude, latitude)
        }
    }
}

fn find<'a>(meshes: &'a Meshes, name: &str) -> Result<&'a Arc<TriMesh>, ReplayError> {
    meshes.get(name).ok_or_else(|| ReplayError::MissingMesh { name: name.to_owned() })
}

/// `points` placed in the world as the target of the recipe is.
pub(crate) fn place(target: &Target, points: Vec<DVec3>) -> Vec<DVec3> {
    if target.transform == Transform::default() {
        return points;
    }
    transformed(&TriMesh::new(points, Vec::new()), &target.transform).positions
}

fn transformed(mesh: &TriMesh, transform: &Transform) -> TriMesh {
    mesh.transformed(transform.scale, rotation(transform.rotate), DVec3::from_array(transform.translate))
}

fn profile(profile: Profile) -> field::Profile {
    match profile {
        Profile::Quintic => field::Profile::Quintic,
        Profile::Septic => field::Profile::Septic,
        Profile::Quartic => field::Profile::Quartic,
        Profile::Contact => field::Profile::Contact,
        Profile::Thesis => field::Profile::Thesis,
    }
}

/// The rotation by an angle in degrees about an axis of any length, `[x, y, z, degrees]`.
pub(crate) fn rotation(rotate: [f64; 4]) -> DQuat {
    let [x, y, z, degrees] = rotate;
    let half = 0.5 * degrees.to_radians();
    let axis = DVec3::new(x, y, z).normalize_or_zero() * libm::sin(half);
    DQuat::from_xyzw(axis.x, axis.y, axis.z, libm::cos(half))
}

/// The tools that strokes name; the others need not even be read.
pub(crate) fn used_tools(recipe: &Recipe) -> BTreeSet<&str> {
    let tools = recipe.strokes.iter().flat_map(|stroke| match stroke {
        Stroke::Move(motion) => vec![motion.tool.as_str()],
        Stroke::Stamp(stamp) => vec![stamp.tool.as_str()],
        Stroke::Pose(pose) => pose.bones.iter().map(|bone| bone.tool.as_str()).collect(),
        Stroke::Region(region) => match &region.inner {
            InnerRegion::Tool(inner) => vec![inner.tool.as_str()],
            _ => Vec::new(),
        },
        Stroke::Strip(strip) => strip.tool.as_deref().into_iter().collect(),
        Stroke::Twist(_) | Stroke::Bend(_) | Stroke::Ring(_) => Vec::new(),
    });
    tools.collect()
}
