//! The profile as it is written: TOML, `format = 1`. Nothing here knows what the values mean.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

use crate::number::{Finite, Length, Triple};
use crate::zeros::{Found, WorkOffset};

/// A machine profile of vpost.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Document {
    /// Version of this format: 1.
    #[schemars(with = "i64")]
    pub(crate) format: Spanned<i64>,
    /// Name of the machine.
    pub(crate) name: String,
    /// The control's dialect: a file in grammars/; or that and what the control adds to the path.
    #[schemars(with = "Option<Control>")]
    pub(crate) control: Option<Spanned<Control>>,
    /// Axes from workpiece to tool, like "[w X Y b Z t]"; of a lathe, S its spindle, like "[w S b Z X t]".
    #[schemars(with = "String")]
    pub(crate) chain: Spanned<String>,
    /// Between table nodes: "linear" (default) or "monotone" (shape-preserving cubic).
    #[serde(default)]
    pub(crate) interpolation: InterpolationName,
    /// When, how warm and with what it was measured.
    pub(crate) calibrated: Option<Calibrated>,
    /// The linear axes.
    #[serde(default)]
    pub(crate) axis: Axes,
    /// Squareness errors, ISO 230-1 signs.
    #[serde(default)]
    pub(crate) squareness: Squareness,
    /// Laser-tracker traverses, one per axis.
    pub(crate) tracker: Option<Tracker>,
    /// Error vectors measured in the volume.
    #[schemars(with = "Option<Field>")]
    pub(crate) field: Option<Spanned<Field>>,
    /// The rotary axes.
    #[serde(default)]
    pub(crate) rotary: Rotary,
    /// A lathe's spindle.
    #[schemars(with = "Option<Spindle>")]
    pub(crate) spindle: Option<Spanned<Spindle>>,
    /// A lathe's headstock.
    #[schemars(with = "Option<Headstock>")]
    pub(crate) headstock: Option<Spanned<Headstock>>,
    /// A lathe's tailstock.
    #[schemars(with = "Option<Tailstock>")]
    pub(crate) tailstock: Option<Spanned<Tailstock>>,
    /// What a lathe turns, and how it is held.
    #[schemars(with = "Option<Workpiece>")]
    pub(crate) workpiece: Option<Spanned<Workpiece>>,
    /// Tool vectors.
    #[serde(default)]
    pub(crate) tool: Tool,
    /// Machine coordinate of each program zero, mm, and how it was found.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, WorkOffset>")]
    pub(crate) work_offsets_mm: BTreeMap<String, Spanned<WorkOffset>>,
    /// How programs are corrected.
    #[serde(default)]
    pub(crate) correction: Correction,
    /// How the machine's programs are to be read, where its control's dialect leaves that open.
    #[serde(default)]
    pub(crate) program: Program,
    /// M codes of this machine.
    #[serde(default)]
    pub(crate) m_codes: MCodes,
    /// Programs and functions of the control that are left alone, like "G65 P9810", and what they move.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, Moves>")]
    pub(crate) calls: BTreeMap<String, Spanned<Moves>>,
    /// What the control computes with under tool centre point control.
    #[schemars(with = "Option<Kinematics>")]
    pub(crate) kinematics: Option<Spanned<Kinematics>>,
    /// Effects beyond the tables: `id` and numeric parameters.
    #[serde(default)]
    #[schemars(with = "Vec<BTreeMap<String, serde_json::Value>>")]
    pub(crate) effect: Vec<Spanned<BTreeMap<String, Spanned<toml::Value>>>>,
    /// The measuring frame against the machine frame.
    #[serde(default)]
    pub(crate) setup: Setup,
}

#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "expected a dialect like \"fanuc\", or { dialect = \"fanuc\", blending = { mode = \"tolerance\", tolerance_mm = 0.005 } } with the mode \"exact-stop\", \"tolerance\" or \"unlimited\""
)]
pub(crate) enum Control {
    Dialect(String),
    More(ControlRules),
}

#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ControlRules {
    /// The control's dialect: a file in grammars/.
    pub(crate) dialect: Option<String>,
    /// What the control does at corners where the program does not say how near it keeps to the path.
    pub(crate) blending: Option<Blending>,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Blending {
    pub(crate) mode: BlendingMode,
    /// Largest distance from the path under "tolerance", mm.
    pub(crate) tolerance_mm: Option<Finite>,
}

/// It stops at each, or keeps within a tolerance, or nobody knows.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum BlendingMode {
    ExactStop,
    Tolerance,
    Unlimited,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum InterpolationName {
    #[default]
    Linear,
    Monotone,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Calibrated {
    /// Year-month-day.
    #[schemars(with = "Option<String>")]
    pub(crate) date: Option<Spanned<String>>,
    pub(crate) temperature_c: Option<Finite>,
    pub(crate) instrument: Option<String>,
    /// Standard deviation of one reading.
    #[schemars(with = "Option<f64>")]
    pub(crate) repeatability_um: Option<Spanned<Finite>>,
    /// Half width of the 95 % interval of the deviation at the far corner.
    #[schemars(with = "Option<f64>")]
    pub(crate) uncertainty_um: Option<Spanned<Finite>>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case, reason = "the standard's letters")]
pub(crate) struct Axes {
    #[schemars(with = "Option<LinearAxis>")]
    pub(crate) X: Option<Spanned<LinearAxis>>,
    #[schemars(with = "Option<LinearAxis>")]
    pub(crate) Y: Option<Spanned<LinearAxis>>,
    #[schemars(with = "Option<LinearAxis>")]
    pub(crate) Z: Option<Spanned<LinearAxis>>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LinearAxis {
    /// Lower and upper end of the commands, mm; may be left out where `errors` is given.
    #[schemars(with = "Option<[f64; 2]>")]
    pub(crate) travel_mm: Option<Spanned<[Finite; 2]>>,
    /// Step of the output, mm; 0.001 where left out.
    #[schemars(with = "Option<f64>")]
    pub(crate) resolution_mm: Option<Spanned<Finite>>,
    /// CSV file of error functions: position_mm, EXX_um, … ECX_urad.
    #[schemars(with = "Option<String>")]
    pub(crate) errors: Option<Spanned<String>>,
    /// The same for motion in the negative direction; `errors` is then the positive one.
    #[schemars(with = "Option<String>")]
    pub(crate) errors_negative: Option<Spanned<String>>,
    /// The line the tables were measured along.
    #[schemars(with = "Option<MeasuredAt>")]
    pub(crate) measured_at_mm: Option<Spanned<MeasuredAt>>,
    /// Full reversal value; `errors` is then the mean of both directions.
    #[schemars(with = "Option<f64>")]
    pub(crate) backlash_um: Option<Spanned<Finite>>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case, reason = "the standard's letters")]
pub(crate) struct MeasuredAt {
    pub(crate) X: Option<Finite>,
    pub(crate) Y: Option<Finite>,
    pub(crate) Z: Option<Finite>,
    pub(crate) tool: Option<Triple>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case, reason = "the standard's symbols")]
pub(crate) struct Squareness {
    /// Y to X; positive: angle between +X and +Y above 90°.
    #[schemars(with = "Option<f64>")]
    pub(crate) EC0Y_urad: Option<Spanned<Finite>>,
    /// Z to X; positive: angle between +X and +Z below 90°.
    #[schemars(with = "Option<f64>")]
    pub(crate) EB0Z_urad: Option<Spanned<Finite>>,
    /// Z to Y; positive: angle between +Y and +Z above 90°.
    #[schemars(with = "Option<f64>")]
    pub(crate) EA0Z_urad: Option<Spanned<Finite>>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Tracker {
    #[schemars(with = "String")]
    pub(crate) x: Spanned<String>,
    #[schemars(with = "String")]
    pub(crate) y: Spanned<String>,
    #[schemars(with = "String")]
    pub(crate) z: Spanned<String>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Field {
    /// CSV file of error vectors on a lattice or anywhere: x_mm, y_mm, z_mm, dx_um, dy_um, dz_um and further columns of
    /// measurements.
    #[schemars(with = "String")]
    pub(crate) file: Spanned<String>,
    /// Standard uncertainty of a component of the vectors that have none in the file; 0: they are met exactly.
    #[schemars(with = "Option<f64>")]
    pub(crate) noise_um: Option<Spanned<Finite>>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case, reason = "the standard's letters")]
pub(crate) struct Rotary {
    #[schemars(with = "Option<RotaryA>")]
    pub(crate) A: Option<Spanned<RotaryA>>,
    #[schemars(with = "Option<RotaryB>")]
    pub(crate) B: Option<Spanned<RotaryB>>,
    #[schemars(with = "Option<RotaryC>")]
    pub(crate) C: Option<Spanned<RotaryC>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum TiltName {
    Body,
    Axis,
}

/// What the three rotary axes have in common, with the location errors by direction.
pub(crate) struct RotaryAxis<'d> {
    pub(crate) centre_mm: Option<Triple>,
    pub(crate) travel_deg: Option<&'d Spanned<[Finite; 2]>>,
    pub(crate) direction: Option<&'d Spanned<Triple>>,
    pub(crate) tilt: Option<TiltName>,
    pub(crate) resolution_deg: Option<&'d Spanned<Finite>>,
    pub(crate) errors: Option<&'d Spanned<String>>,
    pub(crate) errors_negative: Option<&'d Spanned<String>>,
    pub(crate) backlash_urad: Option<&'d Spanned<Finite>>,
    pub(crate) shift_um: [Option<Finite>; 3],
    pub(crate) tilt_urad: [Option<Finite>; 3],
}

macro_rules! rotary {
    ($name:ident, $shifts:ident $tilts:ident, $($shift:ident $at:literal)*, $($tilt:ident $around:literal)*) => {
        #[derive(Debug, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        #[allow(non_snake_case, reason = "the standard's symbols")]
        pub(crate) struct $name {
            /// A point of the ideal axis, machine frame with all axes at 0; in a head: from the gauge point.
            centre_mm: Option<Triple>,
            /// Lower and upper end of the commands; no limit where left out.
            #[schemars(with = "Option<[f64; 2]>")]
            travel_deg: Option<Spanned<[Finite; 2]>>,
            /// Direction of the axis, machine frame; that of its letter where left out. Of any length.
            #[schemars(with = "Option<[f64; 3]>")]
            direction: Option<Spanned<Triple>>,
            /// What its location tilt means: "body" leans with the axis, "axis" turns about the leaning line. Needed beside a
            /// tilt that is not 0.
            tilt: Option<TiltName>,
            /// Step of the output words; 0.001 where left out.
            #[schemars(with = "Option<f64>")]
            resolution_deg: Option<Spanned<Finite>>,
            /// CSV file of error functions over position_deg.
            #[schemars(with = "Option<String>")]
            errors: Option<Spanned<String>>,
            /// The same for motion in the negative direction; `errors` is then the positive one.
            #[schemars(with = "Option<String>")]
            errors_negative: Option<Spanned<String>>,
            /// Full reversal value; `errors` is then the mean of both directions.
            #[schemars(with = "Option<f64>")]
            backlash_urad: Option<Spanned<Finite>>,
            $($shift: Option<Finite>,)*
            $($tilt: Option<Finite>,)*
        }
        impl $name {
            pub(crate) fn parts(&self) -> RotaryAxis<'_> {
                let mut $shifts = [None; 3];
                $($shifts[$at] = self.$shift;)*
                let mut $tilts = [None; 3];
                $($tilts[$around] = self.$tilt;)*
                RotaryAxis {
                    centre_mm: self.centre_mm,
                    travel_deg: self.travel_deg.as_ref(),
                    direction: self.direction.as_ref(),
                    tilt: self.tilt,
                    resolution_deg: self.resolution_deg.as_ref(),
                    errors: self.errors.as_ref(),
                    errors_negative: self.errors_negative.as_ref(),
                    backlash_urad: self.backlash_urad.as_ref(),
                    shift_um: $shifts,
                    tilt_urad: $tilts,
                }
            }
        }
    };
}
rotary!(RotaryA, shifts tilts, EY0A_um 1 EZ0A_um 2, EB0A_urad 1 EC0A_urad 2);
rotary!(RotaryB, shifts tilts, EX0B_um 0 EZ0B_um 2, EA0B_urad 0 EC0B_urad 2);
rotary!(RotaryC, shifts tilts, EX0C_um 0 EY0C_um 1, EA0C_urad 0 EB0C_urad 1);

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Tool {
    /// Without G43: from the point the tables were measured at to the tip.
    pub(crate) default_mm: Option<Triple>,
    /// Where tools are touched off: the length that the control would have of a tool that ends at the gauge point (with
    /// tables measured from the spindle nose: of the bare nose). Not given: 0, and no length below 0 is taken.
    #[schemars(with = "Option<Finite>")]
    pub(crate) gauge_point_mm: Option<Spanned<Finite>>,
    /// Where lengths are touched off on the part or on a setter: axis commands of that surface, the length not added.
    pub(crate) touched_at_mm: Option<Triple>,
    /// H number → length along Z, or vector.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, Length>")]
    pub(crate) lengths_mm: BTreeMap<String, Spanned<Length>>,
    /// Names that programs call tools by (T="MILL 12"), and the number of the length that each has: 1 for H1.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, u32>")]
    pub(crate) names: BTreeMap<String, Spanned<u32>>,
    /// D number → radius of a mill's cutter, as the control has it: how long the pieces of a block under G41 and G42 must be.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, Finite>")]
    pub(crate) radii_mm: BTreeMap<String, Spanned<Finite>>,
    /// H number → nose of a turning tool.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, Nose>")]
    pub(crate) noses: BTreeMap<String, Spanned<Nose>>,
    /// H number → by how much its station of the turret stands off where lengths_mm has the tip: X (of the radius) and Z, µm.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, [Finite; 2]>")]
    pub(crate) turret_um: BTreeMap<String, Spanned<[Finite; 2]>>,
    /// A turning tool's holder, turned about Z against where it was measured: γ.
    pub(crate) gamma_urad: Option<Finite>,
    /// About Y: ω.
    pub(crate) omega_urad: Option<Finite>,
}

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
    #[schemars(with = "f64")]
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
    #[schemars(with = "Vec<[f64; 2]>")]
    pub(crate) diameters_mm: Option<Spanned<Vec<[Finite; 2]>>>,
    /// Young's modulus.
    #[schemars(with = "Option<f64>")]
    pub(crate) e_gpa: Option<Spanned<Finite>>,
    pub(crate) clamping: Option<ClampingName>,
    /// A steady rest, from the chuck's face.
    pub(crate) steady_mm: Option<Finite>,
    /// Radial cutting force.
    #[schemars(with = "Option<f64>")]
    pub(crate) radial_force_n: Option<Spanned<Finite>>,
    /// Radial force per area of the chip, with `depth_mm` and `feed_mm`.
    pub(crate) specific_force_n_mm2: Option<Finite>,
    /// Depth of cut on the radius.
    pub(crate) depth_mm: Option<Finite>,
    /// Feed a turn.
    pub(crate) feed_mm: Option<Finite>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Correction {
    /// Engine; "rigid-body" where left out.
    #[schemars(with = "Option<String>")]
    pub(crate) engine: Option<Spanned<String>>,
    /// Largest distance of the real path from the programmed one; 1 where left out.
    #[schemars(with = "Option<f64>")]
    pub(crate) tolerance_um: Option<Spanned<Finite>>,
    /// Largest path deviation that is written, and said, where the tolerance cannot be held, um; 15 tolerances where left out.
    #[schemars(with = "Option<f64>")]
    pub(crate) accept_um: Option<Spanned<Finite>>,
    /// Feed motion outside the calibrated volume: "refuse" (default) or "clamp".
    #[serde(default)]
    pub(crate) outside: OutsideName,
    /// No piece is made shorter than this; 0 for no limit.
    #[schemars(with = "Option<f64>")]
    pub(crate) minimum_segment_mm: Option<Spanned<Finite>>,
    /// Largest angle of the tool from its direction: by rounded rotary words where a motion is split, in all where directions
    /// are corrected; 50 where left out.
    #[schemars(with = "Option<f64>")]
    pub(crate) orientation_urad: Option<Spanned<Finite>>,
    /// What is corrected on five axes: the tip alone, "xyz" (default), or the tool's direction too, "full".
    #[serde(default)]
    pub(crate) orientation: OrientationName,
    /// Under "full": no direction is corrected where the sine of the tool's tilt is below this; 0.02 where left out.
    #[schemars(with = "Option<f64>")]
    pub(crate) singular_sin: Option<Spanned<Finite>>,
    /// No rotary axis is corrected by more, degrees; 0.5 where left out.
    #[schemars(with = "Option<f64>")]
    pub(crate) singular_turn_deg: Option<Spanned<Finite>>,
    /// What a rotary axis is corrected by changes by no more than this share of what the rotary axes turn; 0.1 where left out.
    #[schemars(with = "Option<f64>")]
    pub(crate) singular_share: Option<Spanned<Finite>>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum OrientationName {
    #[default]
    Xyz,
    Full,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Program {
    /// What a work offset is that does not say it itself: "touched" on this machine with correction off, or "true".
    pub(crate) zero: Option<Found>,
    /// A length without a point: "increments" (Z10 is ten steps) or "millimetres" (Z10 is Z10.; inches under G20).
    pub(crate) decimal: Option<DecimalName>,
    /// Where a tool change (M6) leaves X, Y and Z; anywhere where left out.
    #[schemars(with = "Option<ToolChange>")]
    pub(crate) tool_change: Option<Spanned<ToolChange>>,
    /// Edge of the tool that M6 brings in where the program writes no D (Sinumerik's MD20270): 1, or 0 for none.
    #[schemars(with = "Option<u32>")]
    pub(crate) edge_at_change: Option<Spanned<u32>>,
    /// The length in force is that of the tool in the spindle, from its change on, whatever H a G43 names.
    pub(crate) t_means_h: Option<bool>,
    /// Where rotary axes stand when a program begins, degrees, like { A = 0 }; not known where left out.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, f64>")]
    pub(crate) rotary_start: BTreeMap<String, Spanned<Finite>>,
    /// Largest difference of an arc's radii that the control takes, mm; the dialect's where left out.
    #[schemars(with = "Option<f64>")]
    pub(crate) arc_tolerance_mm: Option<Spanned<Finite>>,
    /// X words of a lathe's programs: "diameter" or "radius".
    pub(crate) x: Option<XName>,
    /// G-code system of a lathe's control: "A", "B" or "C".
    pub(crate) g_code_system: Option<String>,
    /// Chamfer at the end of a lathe's threads, in leads: parameter 5130 counts tenths.
    #[schemars(with = "Option<f64>")]
    pub(crate) thread_chamfer_leads: Option<Spanned<Finite>>,
    /// Angle of that chamfer to the axis, degrees (parameter 5131); 45 where left out.
    #[schemars(with = "Option<f64>")]
    pub(crate) thread_chamfer_deg: Option<Spanned<Finite>>,
    /// By how much roughing (G71, G72) leaves the contour behind a pass, of the radius (parameter 5133).
    #[schemars(with = "Option<f64>")]
    pub(crate) roughing_escape_mm: Option<Spanned<Finite>>,
    /// By how much pecks (G74, G75) go back (parameter 5139).
    #[schemars(with = "Option<f64>")]
    pub(crate) groove_return_mm: Option<Spanned<Finite>>,
    /// Finishing passes of G76 in one block (parameter 5142), a whole number.
    #[schemars(with = "Option<u32>")]
    pub(crate) thread_finishing_passes: Option<Spanned<Finite>>,
    /// Its least infeed, radius (parameter 5140).
    #[schemars(with = "Option<f64>")]
    pub(crate) thread_least_mm: Option<Spanned<Finite>>,
    /// Its finishing allowance, radius (parameter 5141).
    #[schemars(with = "Option<f64>")]
    pub(crate) thread_allowance_mm: Option<Spanned<Finite>>,
    /// Which pass of a thread cut by one edge begins where the cycle starts: "start" (one without depth would),
    /// "first-pass" or "last-pass".
    pub(crate) thread_flank_from: Option<FlankName>,
    /// How far pecks of G83 go back: "full" (to R) or "chip" (by `drill_return_mm`); parameter 5101.2.
    pub(crate) drill_pecks: Option<PecksName>,
    /// By how much pecks of G83 go back, or stay off what is drilled (parameter 5114).
    #[schemars(with = "Option<f64>")]
    pub(crate) drill_return_mm: Option<Spanned<Finite>>,
    /// What R of G83 and G85 is: "place" (in systems B and C under G90) or "way" from the start; parameter 5102.6.
    pub(crate) drill_r: Option<DrillRName>,
    /// Feed at which G85 leaves the hole, in per cent of F (parameter 5121).
    #[schemars(with = "Option<f64>")]
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
    #[schemars(with = "Vec<String>")]
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
    #[schemars(with = "StraightName")]
    pub(crate) straight: Spanned<StraightName>,
    /// Axis → a point of it as the control has it, machine frame with all axes at 0; in a head: from the gauge point.
    #[schemars(with = "BTreeMap<String, Triple>")]
    pub(crate) centres_mm: BTreeMap<String, Spanned<Triple>>,
    /// Which of two ways brings the tool to a tilted plane (G53.1): the axis that stands above or below 0 then, like "A+".
    #[schemars(with = "Option<String>")]
    pub(crate) branch: Option<Spanned<String>>,
    /// Which of the angles that differ by whole turns: "shortest" from where the axis stands, or "principal", above -180 and
    /// up to 180 degrees.
    pub(crate) turn: Option<TurnName>,
    /// The rotary axis whose higher or lower angle `_DIR` of CYCLE800 takes, as the swivel data of the control have it, like "A".
    #[schemars(with = "Option<String>")]
    pub(crate) direction_reference: Option<Spanned<String>>,
    /// How the control turns the tool between directions that are given as vectors (G43.5; A3, B3, C3): "axes", each rotary axis
    /// running evenly, or "great-circle".
    pub(crate) vectors: Option<VectorsName>,
    /// It is on when a program begins.
    #[serde(default)]
    pub(crate) at_start: bool,
    /// M codes of the machine that switch it on, like ["M428"].
    #[serde(default)]
    #[schemars(with = "Vec<String>")]
    pub(crate) on: Vec<Spanned<String>>,
    /// M codes that switch it off.
    #[serde(default)]
    #[schemars(with = "Vec<String>")]
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

#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum OutsideName {
    #[default]
    Refuse,
    Clamp,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Setup {
    /// Shift of the measuring frame.
    pub(crate) shift_mm: Option<Triple>,
    /// Rotation of the measuring frame.
    pub(crate) rotation_urad: Option<Triple>,
}
