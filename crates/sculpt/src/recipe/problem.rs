//! Problems with the values of a recipe, one enum per concern.

use super::suggestion::Suggestion;

/// Any problem of [`Recipe::parse`](super::Recipe::parse).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RecipeProblem {
    /// The text is neither TOML nor JSON.
    #[error(transparent)]
    Syntax(#[from] SyntaxProblem),
    /// The keys or the types of their values are not those of a recipe.
    #[error(transparent)]
    Structure(#[from] StructureProblem),
    /// An override names an element beyond the end of a list.
    #[error(transparent)]
    Override(#[from] NoSuchElement),
    /// A value is out of range, or values contradict each other.
    #[error(transparent)]
    Invalid(#[from] InvalidRecipe),
}

impl From<NumberProblem> for RecipeProblem {
    fn from(problem: NumberProblem) -> Self {
        Self::Invalid(problem.into())
    }
}

/// Problems of [`Override::parse`](super::Override::parse), and of the text of a recipe.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SyntaxProblem {
    /// Message of the TOML or JSON parser.
    #[error("{0}")]
    Malformed(String),
    /// An integer that does not fit into 64 bits.
    #[error("the integer {0} does not fit into 64 bits")]
    IntegerTooLarge(String),
    /// Digits that do not form a number.
    #[error("{0} is not a number")]
    NotANumber(String),
    /// A date or a time.
    #[error("a recipe cannot contain dates; put quotes around a string")]
    Date,
    /// A key that occurs twice in a table.
    #[error("the key `{0}` is given twice; remove one of them")]
    DuplicateKey(String),
    /// An override without an equals sign.
    #[error("has no `=`; write KEY=VALUE")]
    NoEqualsSign,
}

/// Problems when matching keys and types.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StructureProblem {
    /// A key that recipes do not have.
    #[error("unknown key{0}")]
    UnknownKey(Suggestion),
    /// A word that is not one of the choices.
    #[error("unknown value `{found}`{suggestion}")]
    UnknownValue {
        /// The word.
        found: String,
        /// The choices.
        suggestion: Suggestion,
    },
    /// A required key is missing.
    #[error("missing; add it")]
    Missing,
    /// A value of the wrong type.
    #[error("expected {expected}, found {found}")]
    WrongType {
        /// Type or value in the recipe.
        found: String,
        /// Expected type.
        expected: String,
    },
    /// A list of the wrong length.
    #[error("expected {expected} entries, found {found}")]
    WrongLength {
        /// Entries in the recipe.
        found: usize,
        /// Expected entries.
        expected: usize,
    },
    /// Message of the deserializer.
    #[error("{0}")]
    Other(String),
}

/// An override of a list element that does not exist.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no such element: the list has {length}, numbered from 0")]
pub struct NoSuchElement {
    /// Elements of the list.
    pub length: usize,
}

/// Problems of [`Recipe::validate`](super::Recipe::validate).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum InvalidRecipe {
    /// A version that this program cannot read.
    #[error("unknown version {0}; this program reads version 1")]
    UnknownVersion(u32),
    /// A number or a vector is out of range.
    #[error(transparent)]
    Number(#[from] NumberProblem),
    /// A name does not exist.
    #[error(transparent)]
    Reference(#[from] ReferenceProblem),
    /// Keys are missing or exclude each other.
    #[error(transparent)]
    Combination(#[from] CombinationProblem),
    /// Values in range describe an impossible shape or motion.
    #[error(transparent)]
    Geometry(#[from] GeometryProblem),
    /// The bones of a jointed tool do not form a tree.
    #[error(transparent)]
    Skeleton(#[from] SkeletonProblem),
}

/// Numbers, vectors and counts out of range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NumberProblem {
    /// NaN or infinity.
    #[error("is {0}; give a finite number")]
    NotFinite(f64),
    /// Zero or negative.
    #[error("is {0}; give a number above 0")]
    NotPositive(f64),
    /// Negative.
    #[error("is {0}; give 0 or more")]
    Negative(f64),
    /// A number above its maximum.
    #[error("is {found}; give {most} or less")]
    AboveMost {
        /// The number.
        found: f64,
        /// The maximum.
        most: f64,
    },
    /// A count below its minimum.
    #[error("is {found}; give at least {least}")]
    TooSmall {
        /// The count.
        found: u64,
        /// The minimum.
        least: u64,
    },
    /// A list with too few entries.
    #[error("has {found} entries; give at least {least}")]
    TooFew {
        /// Entries in the recipe.
        found: usize,
        /// Fewest entries.
        least: usize,
    },
    /// A resolution that asks for too many elements.
    #[error("asks for {requested} {what}, more than the {most} allowed; choose a coarser one")]
    TooMany {
        /// Number of elements that the value asks for.
        requested: u64,
        /// The maximum.
        most: u64,
        /// Kind of the elements.
        what: &'static str,
    },
    /// A vector of length zero that gives a direction.
    #[error("has length zero; give it a direction, such as [0, 0, 1]")]
    ZeroAxis,
}

/// Names that do not exist.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ReferenceProblem {
    /// The recipe has no tool with this name.
    #[error("unknown tool `{name}`{suggestion}")]
    UnknownTool {
        /// The name.
        name: String,
        /// The tools of the recipe.
        suggestion: Suggestion,
    },
    /// The stroke has no bone with this name.
    #[error("unknown bone `{name}`{suggestion}")]
    UnknownBone {
        /// The name.
        name: String,
        /// The bones of the stroke.
        suggestion: Suggestion,
    },
}

/// Keys that are missing because of another key, or exclude each other.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CombinationProblem {
    /// A key that another key makes necessary is missing.
    #[error("missing; add it")]
    Missing,
    /// A target with a mesh and a shape.
    #[error("names both a mesh and a shape; remove one of them")]
    MeshAndShape,
    /// A target without a mesh or a shape.
    #[error("names neither a mesh nor a shape; add one of them")]
    NeitherMeshNorShape,
    /// The length of a fade without weights.
    #[error("sets how the weights of `vertices` fade, but there are none; add them, or remove this")]
    FadeWithoutWeights,
    /// A strip without a cross-section.
    #[error("has no cross-section; add one of radius, section and tool")]
    NoCrossSection,
    /// A strip with several cross-sections.
    #[error("has more than one of radius, section and tool; keep one of them")]
    SeveralCrossSections,
    /// A key that the tool of a strip determines.
    #[error("is determined by the tool; remove it")]
    SetByTool,
    /// A reference direction for a cross-section that has none.
    #[error("applies only to strips with a section; remove it")]
    OnlyWithSection,
    /// A direction for a strip that moves along its spine.
    #[error("applies only to mode = \"across\"; remove it")]
    OnlyAcross,
    /// Spines with different numbers of points.
    #[error("has {found} points, but `spine` has {expected}; give as many")]
    SpinesDiffer {
        /// Points of this spine.
        found: usize,
        /// Points of the spine at the beginning.
        expected: usize,
    },
    /// A region that both moves and rotates.
    #[error("names both a translation and a rotation; split it into two strokes")]
    TranslationAndRotation,
    /// A region that does nothing.
    #[error("names neither `translate` nor `rotate`; add one of them")]
    NoMotion,
}

/// Impossible shapes and motions.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GeometryProblem {
    /// A box with edges rounder than the box is thick.
    #[error("is {found}, more than the smallest of half_extents; give {most} or less")]
    RoundingTooLarge {
        /// The radius of the edges.
        found: f64,
        /// Half the thickness of the box.
        most: f64,
    },
    /// A torus without a hole.
    #[error("is {0}, not below major, so the ring has no hole; give less")]
    NoHole(f64),
    /// A segment with equal ends.
    #[error("is equal to `from`; choose another point, or use a sphere")]
    EmptySegment,
    /// A motion with fewer than two keys.
    #[error("has {0} poses; a motion needs at least 2")]
    TooFewKeys(usize),
    /// A rotation by 180°, whose direction is ambiguous.
    #[error(
        "rotates by exactly 180 degrees from the previous key, so the direction of rotation is ambiguous; add a key between"
    )]
    HalfTurn,
    /// A profile with a kink in a field that needs a smooth one.
    #[error("`thesis` has a kink at the surface, which this stroke does not allow; choose another profile")]
    KinkedProfile,
}

/// Bones that do not form a tree.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SkeletonProblem {
    /// A bone with the name of the whole tool.
    #[error("`{0}` names the whole tool in the keys; give the bone another name")]
    ReservedName(&'static str),
    /// Two bones with one name.
    #[error("there is already a bone `{0}`; give each bone its own name")]
    DuplicateName(String),
    /// Bones with different profiles.
    #[error("its profile {found} differs from {expected}, that of the first bone; one stroke has one profile")]
    ProfilesDiffer {
        /// Profile of the bone.
        found: String,
        /// Profile of the first bone.
        expected: String,
    },
    /// A second bone without a parent.
    #[error("has no parent, like `{0}`; only one bone can be the root")]
    SecondRoot(String),
    /// Bones that are their own ancestors.
    #[error("leads to a cycle: {0}; change a parent")]
    Cycle(String),
    /// A stroke without a root bone.
    #[error("has no bone without a parent; add one")]
    NoRoot,
    /// A position in the key of a bone.
    #[error("only `{0}` has a position; a bone rotates about its joint")]
    PositionOfBone(&'static str),
}
