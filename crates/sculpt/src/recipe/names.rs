//! The files and tools that a recipe names.

use std::collections::BTreeSet;

use super::{InnerRegion, Recipe, SpinePoints, Stroke, ToolShape, VertexWeights};

impl Recipe {
    /// Key of the target's mesh.
    #[cfg(feature = "io")]
    pub(crate) const TARGET_MESH: &str = "target.mesh";

    /// Mesh files of the target and of the tools in use, without repetition, in order of name.
    pub fn mesh_names(&self) -> Vec<&str> {
        let tools = self.mesh_tools().map(|(_, name)| name);
        let mut names: Vec<&str> = self.target.mesh.as_deref().into_iter().chain(tools).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Keys and values that name the meshes of the target and of the tools in use.
    #[cfg(feature = "io")]
    pub(crate) fn mesh_keys(&self) -> Vec<(String, &str)> {
        let target = self.target.mesh.as_deref().map(|name| (Self::TARGET_MESH.to_owned(), name));
        let tools = self.mesh_tools().map(|(tool, name)| (format!("tools.{tool}.shape.mesh"), name));
        target.into_iter().chain(tools).collect()
    }

    /// Tools in use with their mesh files.
    fn mesh_tools(&self) -> impl Iterator<Item = (&str, &str)> {
        let used = self.used_tools();
        self.tools.iter().filter(move |(name, _)| used.contains(name.as_str())).filter_map(|(name, tool)| {
            match &tool.shape {
                ToolShape::Mesh(shape) => Some((name.as_str(), shape.mesh.as_str())),
                _ => None,
            }
        })
    }

    /// The first key that names this curve file.
    #[cfg(feature = "io")]
    pub(crate) fn curve_key(&self, name: &str) -> String {
        for (index, stroke) in self.strokes.iter().enumerate() {
            if let Stroke::Strip(strip) = stroke {
                if strip.spine.file() == Some(name) {
                    return format!("stroke.{index}.spine");
                }
                if strip.spine_end.as_ref().and_then(SpinePoints::file) == Some(name) {
                    return format!("stroke.{index}.spine_end");
                }
            }
        }
        "stroke".to_owned()
    }

    /// Curve files that the strokes name, without repetition, in order of name.
    pub fn curve_names(&self) -> Vec<&str> {
        let spines = self.strokes.iter().flat_map(Stroke::spines);
        let mut names: Vec<&str> = spines.filter_map(SpinePoints::file).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// All files that the recipe needs: meshes, curves and weights, without repetition, in order of
    /// name.
    pub fn file_names(&self) -> Vec<&str> {
        let mut names = self.mesh_names();
        names.extend(self.curve_names());
        if let Some(VertexWeights::File(name)) = &self.mask.vertices {
            names.push(name);
        }
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Replaces every mention of the curve file `name` by its points.
    pub fn inline_curve(&mut self, name: &str, points: &[[f64; 3]]) {
        let spines = self.strokes.iter_mut().flat_map(Stroke::spines_mut);
        for spine in spines.filter(|spine| spine.file() == Some(name)) {
            *spine = SpinePoints::Points(points.to_vec());
        }
    }

    /// Tools that strokes name. The others are neither read nor built.
    pub(crate) fn used_tools(&self) -> BTreeSet<&str> {
        self.strokes.iter().flat_map(Stroke::tools).collect()
    }

    /// Tools whose fields strokes use. Inner regions use only the shape of a tool.
    pub(crate) fn moving_tools(&self) -> BTreeSet<&str> {
        self.strokes.iter().filter(|stroke| !matches!(stroke, Stroke::Region(_))).flat_map(Stroke::tools).collect()
    }
}

impl Stroke {
    fn tools(&self) -> Vec<&str> {
        match self {
            Self::Move(motion) => vec![motion.tool.as_str()],
            Self::Stamp(stamp) => vec![stamp.tool.as_str()],
            Self::Pose(pose) => pose.bones.iter().map(|bone| bone.tool.as_str()).collect(),
            Self::Region(region) => match &region.inner {
                InnerRegion::Tool(inner) => vec![inner.tool.as_str()],
                _ => Vec::new(),
            },
            Self::Strip(strip) => strip.tool.as_deref().into_iter().collect(),
            Self::Twist(_) | Self::Bend(_) | Self::Ring(_) => Vec::new(),
        }
    }

    fn spines(&self) -> impl Iterator<Item = &SpinePoints> {
        let strip = if let Self::Strip(strip) = self { Some(strip) } else { None };
        strip.into_iter().flat_map(|strip| [Some(&strip.spine), strip.spine_end.as_ref()]).flatten()
    }

    fn spines_mut(&mut self) -> impl Iterator<Item = &mut SpinePoints> {
        let strip = if let Self::Strip(strip) = self { Some(strip) } else { None };
        strip.into_iter().flat_map(|strip| [Some(&mut strip.spine), strip.spine_end.as_mut()]).flatten()
    }
}
