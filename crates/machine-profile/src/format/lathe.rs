//! What makes a machine a lathe, as a profile writes it.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::number::{Finite, Spanned, Triple};

/// The nose of a turning tool.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Nose {
    pub(crate) radius_mm: Finite,
    /// 0 to 9, as the control numbers the directions of the imaginary tip.
    pub(crate) direction: Option<u8>,
    /// Tip above the spindle's axis.
    pub(crate) height_um: Option<Finite>,
    /// κ', angle of the minor cutting edge to the axis.
    pub(crate) minor_edge_deg: Option<Finite>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[allow(non_snake_case, reason = "the standard's symbols")]
pub(crate) struct Spindle {
    /// Machine X and Y of its axis; [0, 0] where left out.
    pub(crate) centre_mm: Option<[Finite; 2]>,
    /// Machine Z of the chuck's face, from which Z of workpiece and tailstock counts; 0 where left out.
    pub(crate) face_mm: Option<Finite>,
    /// Real minus nominal axis, at machine Z 0.
    pub(crate) EX0S_um: Option<Finite>,
    pub(crate) EY0S_um: Option<Finite>,
    /// Tilt, signs as those of the axis Z.
    pub(crate) EA0S_urad: Option<Finite>,
    pub(crate) EB0S_urad: Option<Finite>,
    /// Growth of the spindle: X, Y, Z.
    pub(crate) growth_um: Option<Triple>,
    /// Error motion that repeats each turn: cosines and sines of the harmonics 1, 2, … of the spindle's angle.
    pub(crate) EXS_cos_um: Vec<Finite>,
    pub(crate) EXS_sin_um: Vec<Finite>,
    pub(crate) EYS_cos_um: Vec<Finite>,
    pub(crate) EYS_sin_um: Vec<Finite>,
    pub(crate) EZS_cos_um: Vec<Finite>,
    pub(crate) EZS_sin_um: Vec<Finite>,
    pub(crate) EAS_cos_urad: Vec<Finite>,
    pub(crate) EAS_sin_urad: Vec<Finite>,
    pub(crate) EBS_cos_urad: Vec<Finite>,
    pub(crate) EBS_sin_urad: Vec<Finite>,
    /// Width of the error motion that does not repeat.
    pub(crate) asynchronous_um: Option<Finite>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Headstock {
    /// X and Y, positive: the radius at the chuck grows.
    pub(crate) offset_um: [Finite; 2],
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Tailstock {
    /// From the chuck's face.
    pub(crate) at_mm: Spanned<Finite>,
    /// X and Y, positive: the radius there grows.
    pub(crate) offset_um: Option<[Finite; 2]>,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum ClampingName {
    Chuck,
    ChuckTailstock,
    Centres,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Workpiece {
    /// Z from the chuck's face and diameter there; even between rows, two rows at one Z are a step.
    pub(crate) diameters_mm: Option<Spanned<Vec<[Finite; 2]>>>,
    /// Young's modulus.
    pub(crate) e_gpa: Option<Spanned<Finite>>,
    pub(crate) clamping: Option<ClampingName>,
    /// A steady rest, from the chuck's face.
    pub(crate) steady_mm: Option<Finite>,
    /// Radial cutting force.
    pub(crate) radial_force_n: Option<Spanned<Finite>>,
    /// Radial force per area of the chip, with `depth_mm` and `feed_mm`.
    pub(crate) specific_force_n_mm2: Option<Finite>,
    /// Depth of cut on the radius.
    pub(crate) depth_mm: Option<Finite>,
    /// Feed a turn.
    pub(crate) feed_mm: Option<Finite>,
}
