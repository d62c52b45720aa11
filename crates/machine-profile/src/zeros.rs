//! Work offsets, and how they came to be: a touched zero has the machine's error at the place of touching in it.

use std::collections::BTreeMap;

use machine_model::Way;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::number::{Finite, Length, Triple};

/// How a work offset came to be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Found {
    /// Touched on this machine with correction off.
    #[default]
    Touched,
    /// Through a compensation, or by an outside instrument: a place in the measuring frame.
    True,
}

/// Where a coordinate of a zero was touched; what is left out nobody said.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TouchPlace {
    /// Axis commands, mm: one place, or two between which the coordinate lies; none: the program's zero.
    pub at_mm: Vec<[f64; 3]>,
    /// The tool that touched.
    pub tool: Option<TouchedBy>,
    /// Where the rotary axes stood, degrees.
    pub rotary_deg: [f64; 3],
    /// From which side the axis came: -1, 1, or 0.
    pub direction: i8,
}

/// A tool that touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TouchedBy {
    /// That of an H number.
    Length(u32),
    /// From the gauge point to its tip, mm.
    Vector([f64; 3]),
}

/// What a profile says of one work offset besides its place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ZeroFound {
    /// `None`: as [`crate::ProgramRules::zero`] says.
    pub found: Option<Found>,
    /// Of X, Y, Z; `None`: at the program's zero.
    pub touched_at: Option<[TouchPlace; 3]>,
    /// The way that the workpiece was dialled parallel to; `None`: it lies as the measuring frame does.
    pub aligned: Option<Way>,
}

/// A place alone, or how it was found as well.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "expected three numbers [x, y, z] in mm, or { at = [x, y, z], zero = \"touched\" or \"true\", touched_at = { at = [x, y, z], tool = \"H1\", rotary_deg = { A = 0 }, direction = 1 }, aligned = { along = \"X\", from = 100, to = 300 } } with X, Y, Z in touched_at where they were touched at places of their own"
)]
pub(crate) enum WorkOffset {
    Place(Triple),
    Found(Box<FoundOffset>),
}

#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct FoundOffset {
    /// Machine coordinate of the program's zero.
    pub(crate) at: Triple,
    /// "touched" on this machine with correction off, or "true".
    pub(crate) zero: Option<Found>,
    /// Where it was touched; the program's zero where left out.
    pub(crate) touched_at: Option<TouchedAt>,
    /// Dialled parallel to the real way of an axis; as the measuring frame lies where left out.
    pub(crate) aligned: Option<AlignedTo>,
}

#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct AlignedTo {
    /// The axis that ran while the dial stood still: "X", "Y" or "Z".
    pub(crate) along: String,
    /// From which command on.
    pub(crate) from: End,
    /// To which command.
    pub(crate) to: End,
    /// The faces that the dial ran on, by the axes across them; "Y" for X, "X" for Y, "XY" for Z where left out.
    pub(crate) faces: Option<String>,
}

/// A command of the axis that ran, the others as at the program's zero, or commands of all three.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum End {
    Axis(Finite),
    Axes(Triple),
}

/// One place for all, or one for each of X, Y, Z.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case, reason = "the standard's letters")]
pub(crate) struct TouchedAt {
    /// Axis commands.
    pub(crate) at: Option<Places>,
    /// "H1", a length, or a vector from the gauge point to the tip.
    pub(crate) tool: Option<ToolThatTouched>,
    /// Rotary axes by letter.
    #[serde(default)]
    pub(crate) rotary_deg: BTreeMap<String, Finite>,
    /// From which side the axis came: 1 or -1.
    pub(crate) direction: Option<i8>,
    pub(crate) X: Option<OnePlace>,
    pub(crate) Y: Option<OnePlace>,
    pub(crate) Z: Option<OnePlace>,
}

#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct OnePlace {
    /// Axis commands.
    pub(crate) at: Option<Places>,
    /// "H1", a length, or a vector from the gauge point to the tip.
    pub(crate) tool: Option<ToolThatTouched>,
    /// Rotary axes by letter.
    #[serde(default)]
    pub(crate) rotary_deg: BTreeMap<String, Finite>,
    /// From which side the axis came: 1 or -1.
    pub(crate) direction: Option<i8>,
}

/// One place, or the two between which the coordinate lies, like the walls of a bore.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Places {
    One(Triple),
    Two([Triple; 2]),
}

#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum ToolThatTouched {
    Name(String),
    Length(Length),
}

impl TouchedAt {
    /// What holds for every axis, and of each axis its own.
    pub(crate) fn parts(&self) -> (OnePlace, [Option<&OnePlace>; 3]) {
        let Self { at, tool, rotary_deg, direction, X, Y, Z } = self;
        let (tool, rotary_deg) = (tool.clone(), rotary_deg.clone());
        let all = OnePlace { at: *at, tool, rotary_deg, direction: *direction };
        (all, [X.as_ref(), Y.as_ref(), Z.as_ref()])
    }
}
