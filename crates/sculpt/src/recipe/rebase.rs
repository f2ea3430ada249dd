//! When the result so far becomes the surface from which the next strokes start.

use std::fmt;

use schemars::JsonSchema;
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{Error, Unexpected, Visitor},
};

/// When the result so far becomes the surface from which the next strokes start: `"never"`, `"auto"`, or
/// after a number of strokes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Rebase {
    /// By a rule.
    Rule(RebaseRule),
    /// After this number of strokes.
    Every(#[schemars(range(min = 1))] u32),
}

/// A rule for rebases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RebaseRule {
    /// Every vertex follows all strokes from the target.
    Never,
    /// When the number of vertices, multiplied by the number of strokes, passes 100,000, and from then on
    /// after each stroke.
    Auto,
}

// Implemented by hand: serde's untagged enums do not say what was expected.
impl<'de> Deserialize<'de> for Rebase {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct RuleOrNumber;
        impl Visitor<'_> for RuleOrNumber {
            type Value = Rebase;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("\"never\", \"auto\" or a number of strokes")
            }

            fn visit_str<E: Error>(self, rule: &str) -> Result<Rebase, E> {
                match rule {
                    "never" => Ok(Rebase::Rule(RebaseRule::Never)),
                    "auto" => Ok(Rebase::Rule(RebaseRule::Auto)),
                    other => Err(E::unknown_variant(other, &["never", "auto"])),
                }
            }

            fn visit_i64<E: Error>(self, strokes: i64) -> Result<Rebase, E> {
                u32::try_from(strokes)
                    .map(Rebase::Every)
                    .map_err(|_| E::invalid_value(Unexpected::Signed(strokes), &self))
            }

            fn visit_u64<E: Error>(self, strokes: u64) -> Result<Rebase, E> {
                u32::try_from(strokes)
                    .map(Rebase::Every)
                    .map_err(|_| E::invalid_value(Unexpected::Unsigned(strokes), &self))
            }
        }
        deserializer.deserialize_any(RuleOrNumber)
    }
}
