//! The profile as it is written: TOML, `format = 1`. Nothing here knows what the values mean.

mod lathe;
mod program;

pub(crate) use lathe::{ClampingName, Headstock, Nose, Spindle, Tailstock, Workpiece};
pub(crate) use program::{
    ChangeAxes, ChangePlace, ContourCompensation, DecimalName, DrawingWords, DrillRName, FlankName,
    Kinematics, MCodes, Moves, PecksName, Program, StraightName, ToolChange, TurnName, VectorsName, XName,
};

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use crate::number::{Each, Finite, Length, Spanned, Triple};
use crate::zeros::WorkOffset;

/// A machine profile of vpost.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Document {
    /// Version of this format: 1.
    pub(crate) format: Spanned<i64>,
    /// Name of the machine.
    pub(crate) name: String,
    /// The control's dialect: a file in grammars/; or that and what the control adds to the path.
    pub(crate) control: Option<Spanned<Control>>,
    /// Axes from workpiece to tool, like "[w X Y b Z t]"; of a lathe, S its spindle, like "[w S b Z X t]".
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
    pub(crate) field: Option<Spanned<Field>>,
    /// The rotary axes.
    #[serde(default)]
    pub(crate) rotary: Rotary,
    /// A lathe's spindle.
    pub(crate) spindle: Option<Spanned<Spindle>>,
    /// A lathe's headstock.
    pub(crate) headstock: Option<Spanned<Headstock>>,
    /// A lathe's tailstock.
    pub(crate) tailstock: Option<Spanned<Tailstock>>,
    /// What a lathe turns, and how it is held.
    pub(crate) workpiece: Option<Spanned<Workpiece>>,
    /// Tool vectors.
    #[serde(default)]
    pub(crate) tool: Tool,
    /// Machine coordinate of each program zero, mm, and how it was found.
    #[serde(default)]
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
    pub(crate) calls: BTreeMap<String, Spanned<Moves>>,
    /// What the control computes with under tool centre point control.
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
    expecting = "expected a dialect like \"fanuc\", or { dialect = \"fanuc\", blending = { mode = \"tolerance\", tolerance_mm = 0.005 } } with the mode \"exact-stop\", \"tolerance\" or \"unlimited\"; arcs = { chord_mm = 1.0 } or { tolerance_mm = 0.002 }, acceleration_mm_s2 = 2000 and following = { gain_1_s = 50 } may stand beside it"
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
    /// How it cuts arcs into chords, where it does not follow them.
    pub(crate) arcs: Option<Arcs>,
    /// Along the path, mm/s²: what stops at corners cost.
    pub(crate) acceleration_mm_s2: Option<Finite>,
    /// How far the axes lag behind their commands.
    pub(crate) following: Option<FollowingRules>,
}

/// The position loops of the linear axes.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct FollowingRules {
    /// 1/s, of all or of X, Y, Z: 1 m/min per mm of lag is 16.67.
    pub(crate) gain_1_s: Each,
    /// Share of the speed that is fed forward, 0 (default) to 1.
    pub(crate) feed_forward: Option<Each>,
    /// At an exact stop the control waits until they lag by no more, mm.
    pub(crate) in_position_mm: Option<Finite>,
}

/// One of both.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Arcs {
    /// Length of a chord, mm (Klipper, `resolution` of `[gcode_arcs]`).
    pub(crate) chord_mm: Option<Finite>,
    /// How far chords are meant to lie beside the arc, mm (Grbl, `$12`).
    pub(crate) tolerance_mm: Option<Finite>,
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
    pub(crate) date: Option<Spanned<String>>,
    pub(crate) temperature_c: Option<Finite>,
    pub(crate) instrument: Option<String>,
    /// Standard deviation of one reading.
    pub(crate) repeatability_um: Option<Spanned<Finite>>,
    /// Half width of the 95 % interval of the deviation at the far corner.
    pub(crate) uncertainty_um: Option<Spanned<Finite>>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case, reason = "the standard's letters")]
pub(crate) struct Axes {
    pub(crate) X: Option<Spanned<LinearAxis>>,
    pub(crate) Y: Option<Spanned<LinearAxis>>,
    pub(crate) Z: Option<Spanned<LinearAxis>>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LinearAxis {
    /// Lower and upper end of the commands, mm; may be left out where `errors` is given.
    pub(crate) travel_mm: Option<Spanned<[Finite; 2]>>,
    /// Step of the output, mm; 0.001 where left out.
    pub(crate) resolution_mm: Option<Spanned<Finite>>,
    /// CSV file of error functions: position_mm, EXX_um, … ECX_urad.
    pub(crate) errors: Option<Spanned<String>>,
    /// The same for motion in the negative direction; `errors` is then the positive one.
    pub(crate) errors_negative: Option<Spanned<String>>,
    /// The line the tables were measured along.
    pub(crate) measured_at_mm: Option<Spanned<MeasuredAt>>,
    /// Full reversal value; `errors` is then the mean of both directions.
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
    pub(crate) EC0Y_urad: Option<Spanned<Finite>>,
    /// Z to X; positive: angle between +X and +Z below 90°.
    pub(crate) EB0Z_urad: Option<Spanned<Finite>>,
    /// Z to Y; positive: angle between +Y and +Z above 90°.
    pub(crate) EA0Z_urad: Option<Spanned<Finite>>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Tracker {
    pub(crate) x: Spanned<String>,
    pub(crate) y: Spanned<String>,
    pub(crate) z: Spanned<String>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Field {
    /// CSV file of error vectors on a lattice or anywhere: x_mm, y_mm, z_mm, dx_um, dy_um, dz_um and further columns of
    /// measurements.
    pub(crate) file: Spanned<String>,
    /// Standard uncertainty of a component of the vectors that have none in the file; 0: they are met exactly.
    pub(crate) noise_um: Option<Spanned<Finite>>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case, reason = "the standard's letters")]
pub(crate) struct Rotary {
    pub(crate) A: Option<Spanned<RotaryA>>,
    pub(crate) B: Option<Spanned<RotaryB>>,
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
            travel_deg: Option<Spanned<[Finite; 2]>>,
            /// Direction of the axis, machine frame; that of its letter where left out. Of any length.
            direction: Option<Spanned<Triple>>,
            /// What its location tilt means: "body" leans with the axis, "axis" turns about the leaning line. Needed beside a
            /// tilt that is not 0.
            tilt: Option<TiltName>,
            /// Step of the output words; 0.001 where left out.
            resolution_deg: Option<Spanned<Finite>>,
            /// CSV file of error functions over position_deg.
            errors: Option<Spanned<String>>,
            /// The same for motion in the negative direction; `errors` is then the positive one.
            errors_negative: Option<Spanned<String>>,
            /// Full reversal value; `errors` is then the mean of both directions.
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
    pub(crate) gauge_point_mm: Option<Spanned<Finite>>,
    /// Where lengths are touched off on the part or on a setter: axis commands of that surface, the length not added.
    pub(crate) touched_at_mm: Option<Triple>,
    /// H number → length along Z, or vector.
    #[serde(default)]
    pub(crate) lengths_mm: BTreeMap<String, Spanned<Length>>,
    /// Names that programs call tools by (T="MILL 12"), and the number of the length that each has: 1 for H1.
    #[serde(default)]
    pub(crate) names: BTreeMap<String, Spanned<u32>>,
    /// D number → radius of a mill's cutter, as the control has it: how long the pieces of a block under G41 and G42 must be.
    #[serde(default)]
    pub(crate) radii_mm: BTreeMap<String, Spanned<Finite>>,
    /// H number → nose of a turning tool.
    #[serde(default)]
    pub(crate) noses: BTreeMap<String, Spanned<Nose>>,
    /// H number → by how much its station of the turret stands off where lengths_mm has the tip: X (of the radius) and Z, µm.
    #[serde(default)]
    pub(crate) turret_um: BTreeMap<String, Spanned<[Finite; 2]>>,
    /// A turning tool's holder, turned about Z against where it was measured: γ.
    pub(crate) gamma_urad: Option<Finite>,
    /// About Y: ω.
    pub(crate) omega_urad: Option<Finite>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Correction {
    /// Engine; "rigid-body" where left out.
    pub(crate) engine: Option<Spanned<String>>,
    /// Largest distance of the real path from the programmed one; 1 where left out.
    pub(crate) tolerance_um: Option<Spanned<Finite>>,
    /// Largest path deviation that is written, and said, where the tolerance cannot be held, um; 15 tolerances where left out.
    pub(crate) accept_um: Option<Spanned<Finite>>,
    /// Feed motion outside the calibrated volume: "refuse" (default) or "clamp".
    #[serde(default)]
    pub(crate) outside: OutsideName,
    /// No piece is made shorter than this; 0 for no limit.
    pub(crate) minimum_segment_mm: Option<Spanned<Finite>>,
    /// Largest angle of the tool from its direction: by rounded rotary words where a motion is split, in all where directions
    /// are corrected; 50 where left out.
    pub(crate) orientation_urad: Option<Spanned<Finite>>,
    /// What is corrected on five axes: the tip alone, "xyz" (default), or the tool's direction too, "full".
    #[serde(default)]
    pub(crate) orientation: OrientationName,
    /// Under "full": no direction is corrected where the sine of the tool's tilt is below this; 0.02 where left out.
    pub(crate) singular_sin: Option<Spanned<Finite>>,
    /// No rotary axis is corrected by more, degrees; 0.5 where left out.
    pub(crate) singular_turn_deg: Option<Spanned<Finite>>,
    /// What a rotary axis is corrected by changes by no more than this share of what the rotary axes turn; 0.1 where left out.
    pub(crate) singular_share: Option<Spanned<Finite>>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum OrientationName {
    #[default]
    Xyz,
    Full,
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
