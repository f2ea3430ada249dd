//! The files and tools that a recipe names.

use std::collections::BTreeSet;

use super::{InnerRegion, Recipe, SpinePoints, Stroke, ToolShape};

impl Recipe {
    /// Mesh files of the target and of the tools in use, without repetition, in order of name.
    pub fn mesh_names(&self) -> Vec<&str> {
        let used = self.used_tools();
        let tools = self.tools.iter().filter(|(name, _)| used.contains(name.as_str()));
        let tools = tools.filter_map(|(_, tool)| match &tool.shape {
            ToolShape::Mesh(shape) => Some(shape.mesh.as_str()),
            _ => None,
        });
        let mut names: Vec<&str> = self.target.mesh.as_deref().into_iter().chain(tools).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Curve files that the strokes name, without repetition, in order of name.
    pub fn curve_names(&self) -> Vec<&str> {
        let spines = self.strokes.iter().flat_map(Stroke::spines);
        let mut names: Vec<&str> = spines.filter_map(SpinePoints::file).collect();
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
