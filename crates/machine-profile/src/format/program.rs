//! How programs are to be read, as a profile writes it.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use crate::number::{Finite, Spanned, Triple};
use crate::zeros::Found;

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Program {
    /// What a work offset is that does not say it itself: "touched" on this machine with correction off, or "true".
    pub(crate) zero: Option<Found>,
    /// A length without a point: "increments" (Z10 is ten steps) or "millimetres" (Z10 is Z10.; inches under G20).
    pub(crate) decimal: Option<DecimalName>,
    /// Where a tool change (M6) leaves X, Y and Z; anywhere where left out.
    pub(crate) tool_change: Option<Spanned<ToolChange>>,
    /// Edge of the tool that M6 brings in where the program writes no D (Sinumerik's MD20270): 1, or 0 for none.
    pub(crate) edge_at_change: Option<Spanned<u32>>,
    /// The length in force is that of the tool in the spindle, from its change on, whatever H a G43 names.
    pub(crate) t_means_h: Option<bool>,
    /// Where rotary axes stand when a program begins, degrees, like { A = 0 }; not known where left out.
    #[serde(default)]
    pub(crate) rotary_start: BTreeMap<String, Spanned<Finite>>,
    /// Largest difference of an arc's radii that the control takes, mm; the dialect's where left out.
    pub(crate) arc_tolerance_mm: Option<Spanned<Finite>>,
    /// X words of a lathe's programs: "diameter" or "radius".
    pub(crate) x: Option<XName>,
    /// G-code system of a lathe's control: "A", "B" or "C".
    pub(crate) g_code_system: Option<String>,
    /// Chamfer at the end of a lathe's threads, in leads: parameter 5130 counts tenths.
    pub(crate) thread_chamfer_leads: Option<Spanned<Finite>>,
    /// Angle of that chamfer to the axis, degrees (parameter 5131); 45 where left out.
    pub(crate) thread_chamfer_deg: Option<Spanned<Finite>>,
    /// By how much roughing (G71, G72) leaves the contour behind a pass, of the radius (parameter 5133).
    pub(crate) roughing_escape_mm: Option<Spanned<Finite>>,
    /// By how much pecks (G74, G75) go back (parameter 5139).
    pub(crate) groove_return_mm: Option<Spanned<Finite>>,
    /// Finishing passes of G76 in one block (parameter 5142), a whole number.
    #[schemars(with = "Option<u32>")]
    pub(crate) thread_finishing_passes: Option<Spanned<Finite>>,
    /// Its least infeed, radius (parameter 5140).
    pub(crate) thread_least_mm: Option<Spanned<Finite>>,
    /// Its finishing allowance, radius (parameter 5141).
    pub(crate) thread_allowance_mm: Option<Spanned<Finite>>,
    /// Which pass of a thread cut by one edge begins where the cycle starts: "start" (one without depth would),
    /// "first-pass" or "last-pass".
    pub(crate) thread_flank_from: Option<FlankName>,
    /// How far pecks of G83 go back: "full" (to R) or "chip" (by `drill_return_mm`); parameter 5101.2.
    pub(crate) drill_pecks: Option<PecksName>,
    /// By how much pecks of G83 go back, or stay off what is drilled (parameter 5114).
    pub(crate) drill_return_mm: Option<Spanned<Finite>>,
    /// What R of G83 and G85 is: "place" (in systems B and C under G90) or "way" from the start; parameter 5102.6.
    pub(crate) drill_r: Option<DrillRName>,
    /// Feed at which G85 leaves the hole, in per cent of F (parameter 5121).
    pub(crate) bore_return_percent: Option<Spanned<Finite>>,
    /// Where G41 and G42 between P and Q of G70 to G73 hold: "finishing" (G70 alone).
    pub(crate) contour_compensation: Option<ContourCompensation>,
    /// How corners and angles of a drawing are written: "comma" (,A ,C ,R) or "plain" (A C R of a line too); parameter 3405.4.
    pub(crate) drawing_words: Option<DrawingWords>,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum FlankName {
    Start,
    FirstPass,
    LastPass,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum DrillRName {
    Place,
    Way,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum PecksName {
    Full,
    Chip,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum DrawingWords {
    Comma,
    Plain,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum ContourCompensation {
    Finishing,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum XName {
    Diameter,
    Radius,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum DecimalName {
    Increments,
    Millimetres,
}

/// Machine coordinates [x, y, z] in mm, or by axis.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "expected { keeps = \"XYZ\" }, { keeps = \"XY\", position_mm = { Z = 350.0 } } or a position [x, y, z]"
)]
pub(crate) enum ToolChange {
    At(Triple),
    By(ChangeRules),
}

#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ChangeRules {
    /// Axes that stay where they were, like "XYZ".
    pub(crate) keeps: Option<String>,
    /// Machine coordinates where the others stand afterwards: [x, y, z], or { Z = 350.0 } for some of them.
    pub(crate) position_mm: Option<ChangePlace>,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected three numbers [x, y, z] in mm, or some of them like { Z = 350.0 }")]
pub(crate) enum ChangePlace {
    All(Triple),
    Some(ChangeAxes),
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case, reason = "the standard's letters")]
pub(crate) struct ChangeAxes {
    pub(crate) X: Option<Finite>,
    pub(crate) Y: Option<Finite>,
    pub(crate) Z: Option<Finite>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MCodes {
    /// Codes that move neither an axis nor the frame on this machine, like ["M777"].
    #[serde(default)]
    pub(crate) harmless: Vec<Spanned<String>>,
}

/// What a program or function of the control moves.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected { unknown = \"XYZ\" } or \"harmless\"")]
pub(crate) enum Moves {
    Nothing(Harmless),
    Some(Unknown),
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Harmless {
    Harmless,
}

#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Unknown {
    /// Axes that may stand anywhere behind it, like "XYZ".
    pub(crate) unknown: String,
}

/// What runs straight from one end of a block to the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum StraightName {
    Tip,
    Axes,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Kinematics {
    /// What runs straight from end to end of a block: "tip", or "axes".
    pub(crate) straight: Spanned<StraightName>,
    /// Axis → a point of it as the control has it, machine frame with all axes at 0; in a head: from the gauge point.
    pub(crate) centres_mm: BTreeMap<String, Spanned<Triple>>,
    /// Which of two ways brings the tool to a tilted plane (G53.1): the axis that stands above or below 0 then, like "A+".
    pub(crate) branch: Option<Spanned<String>>,
    /// Which of the angles that differ by whole turns: "shortest" from where the axis stands, or "principal", above -180 and
    /// up to 180 degrees.
    pub(crate) turn: Option<TurnName>,
    /// The rotary axis whose higher or lower angle `_DIR` of CYCLE800 takes, as the swivel data of the control have it, like "A".
    pub(crate) direction_reference: Option<Spanned<String>>,
    /// How the control turns the tool between directions that are given as vectors (G43.5; A3, B3, C3): "axes", each rotary axis
    /// running evenly, or "great-circle".
    pub(crate) vectors: Option<VectorsName>,
    /// It is on when a program begins.
    #[serde(default)]
    pub(crate) at_start: bool,
    /// M codes of the machine that switch it on, like ["M428"].
    #[serde(default)]
    pub(crate) on: Vec<Spanned<String>>,
    /// M codes that switch it off.
    #[serde(default)]
    pub(crate) off: Vec<Spanned<String>>,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum VectorsName {
    Axes,
    GreatCircle,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum TurnName {
    Shortest,
    Principal,
}
