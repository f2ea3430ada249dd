//! Checks that types cannot express: numbers in range, names that exist, possible motions.

mod keys;
mod mask;
mod number;
mod pose;
mod reference;
mod region;
mod strip;
mod target;
mod tool;

use super::{
    Integrate, Output, Rebase, Recipe, Refine, Stroke,
    error::RecipeError,
    problem::{InvalidRecipe, NumberProblem},
};
use number::{NumberCheck, all_finite, at_least, at_most, direction, finite, not_negative, positive};
use reference::{Tools, known_tool};

type Check = Result<(), RecipeError<InvalidRecipe>>;

impl Recipe {
    /// Checks everything that can be checked without the files that the recipe names.
    ///
    /// # Errors
    /// The first invalid value. Its line is not known: [`parse`](Self::parse) adds it.
    pub fn validate(&self) -> Result<(), RecipeError<InvalidRecipe>> {
        if self.recipe != 1 {
            return Err(RecipeError::new("recipe", InvalidRecipe::UnknownVersion(self.recipe)));
        }
        self.target.validate().map_err(|error| error.inside("target"))?;
        for (name, tool) in &self.tools {
            tool.validate().map_err(|error| error.inside(name).inside("tools"))?;
        }
        for (index, item) in self.strokes.iter().enumerate() {
            stroke(item, &self.tools).map_err(|error| error.inside(&index.to_string()).inside("stroke"))?;
        }
        self.integrate.validate().map_err(|error| error.inside("integrate"))?;
        self.mask.validate().map_err(|error| error.inside("mask"))?;
        self.refine.validate().map_err(|error| error.inside("refine"))?;
        if let Some(change) = self.promise.volume {
            not_negative("promise.volume", change)?;
        }
        Ok(self.output.validate().map_err(|error| error.inside("output"))?)
    }
}

impl Integrate {
    /// Keys of errors are relative to this table.
    pub(crate) fn validate(&self) -> NumberCheck {
        positive("step", self.step)?;
        at_most("step", self.step, 1.0)
    }
}

impl Refine {
    fn validate(&self) -> NumberCheck {
        if let Some(volume) = self.volume {
            positive("volume", volume)?;
        }
        positive("deviation", self.deviation)?;
        if let Some(length) = self.max_edge {
            positive("max_edge", length)?;
        }
        if let Rebase::Every(strokes) = self.rebase {
            at_least("rebase", strokes.into(), 1)?;
        }
        at_least("max_triangles", self.max_triangles as u64, 1)
    }
}

impl Output {
    fn validate(&self) -> NumberCheck {
        if let Some(view) = &self.view {
            direction("view", view)?;
        }
        match &self.frames {
            Some(frames) => at_least("frames.count", frames.count.into(), 2),
            None => Ok(()),
        }
    }
}

fn stroke(stroke: &Stroke, tools: &Tools) -> Check {
    match stroke {
        Stroke::Move(motion) => {
            known_tool(tools, &motion.tool)?;
            keys::motion(&motion.keys)
        }
        Stroke::Twist(twist) => Ok(axis("degrees_per_unit", &twist.origin, &twist.axis, twist.degrees_per_unit)?),
        Stroke::Bend(bend) => Ok(axis("degrees_per_unit2", &bend.origin, &bend.axis, bend.degrees_per_unit2)?),
        Stroke::Stamp(stamp) => {
            known_tool(tools, &stamp.tool)?;
            keys::motion(&stamp.keys)?;
            match stamp.relief {
                Some(length) => Ok(positive("relief", length)?),
                None => Ok(()),
            }
        }
        Stroke::Strip(strip) => {
            if let Some(name) = &strip.tool {
                known_tool(tools, name)?;
            }
            strip.validate()
        }
        Stroke::Ring(ring) => ring.validate(),
        Stroke::Pose(pose) => pose.validate(tools),
        Stroke::Region(region) => region.validate(tools),
    }
}

/// An axis through `origin`, with the rate of rotation under the key `rate_key`.
fn axis(rate_key: &str, origin: &[f64; 3], axis: &[f64; 3], rate: f64) -> Result<(), RecipeError<NumberProblem>> {
    all_finite("origin", origin)?;
    direction("axis", axis)?;
    finite(rate_key, rate)
}
