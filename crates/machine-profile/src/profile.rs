//! A machine profile as values.

use machine_model::engines::{EngineInputs, ParametricTable};
use machine_model::{
    Chain, Description, EngineId, Interpolation, RigidBody, Singularity, TipControl, Traverse, Vector, Volume,
};
use toolpath::{Interpolator, RotaryChain, RotaryLink, TiltRule, TurningParameters};

use crate::field::MeasuredField;
use crate::tables::ErrorRows;
use crate::zeros::{Found, ZeroFound};

/// When, how warm and with what a machine was measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Calibrated {
    /// Year-month-day.
    pub date: Option<String>,
    /// Temperature, °C.
    pub temperature_c: Option<f64>,
    /// Instrument.
    pub instrument: Option<String>,
    /// Standard deviation of one reading, µm: how well the machine came back to a point while it was measured.
    pub repeatability_um: Option<f64>,
    /// Length that the difference of the machine from its profile keeps at 95 % of the places of the whole volume, frames taken
    /// off, µm; equation (51c).
    pub uncertainty_um: Option<f64>,
}

/// What happens to feed motion outside the calibrated volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    /// It is an error.
    Refuse,
    /// It takes the correction of the volume's nearest point.
    Clamp,
}

/// How programs are corrected unless the command line says otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrectionOptions {
    /// Engine; never a published variant.
    pub engine: EngineId,
    /// Largest distance of the real path from the programmed one, µm.
    pub tolerance_um: f64,
    /// What is written all the same where the tolerance cannot be held, µm; `None`: not said.
    pub accept_um: Option<f64>,
    /// Feed motion outside the calibrated volume.
    pub outside: Outside,
    /// No piece is made shorter than this, mm; 0 for no limit.
    pub minimum_segment_mm: f64,
    /// Largest angle of the tool from its direction: by rounded rotary words where a motion is split, in all where directions
    /// are corrected, µrad.
    pub orientation_urad: f64,
    /// The tool's direction is corrected too (`orientation = "full"`).
    pub directions: bool,
    /// Where it is not.
    pub singularity: Singularity,
}

/// What a length without a decimal point is, where a parameter of the control decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BareLengths {
    /// Least increments: `Z10` is ten of them.
    Increments,
    /// The unit in force: `Z10` is `Z10.`.
    Millimetres,
}

/// Where an axis stands behind a tool change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AfterChange {
    /// Anywhere.
    #[default]
    Unknown,
    /// Where it stood before.
    Stays,
    /// At this machine coordinate, mm.
    At(f64),
}

/// A program or function of the control, like `G65 P9810`, and the axes that may stand anywhere behind it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftAlone {
    /// `G` or `M`.
    pub letter: char,
    /// Tenths of the code: 650 of G65.
    pub tenths: u16,
    /// P, where the code calls programs by it.
    pub program: Option<u32>,
    /// X, Y, Z, A, B, C.
    pub unknown: [bool; 6],
}

/// How the machine's programs are to be read, where its control's dialect leaves that open.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProgramRules {
    /// How work offsets were found that do not say it themselves.
    pub zero: Found,
    /// Lengths without a point; `None`: not said.
    pub bare_lengths: Option<BareLengths>,
    /// X, Y, Z behind a tool change.
    pub tool_change: [AfterChange; 3],
    /// The edge that a tool change brings in where no D says one, 0 for none; `None`: not said.
    pub edge_at_change: Option<u32>,
    /// The length in force is that of the tool in the spindle, whatever H a G43 names.
    pub t_means_h: bool,
    /// Where A, B, C stand when a program begins, degrees.
    pub rotary_start_deg: [Option<f64>; 3],
    /// Numbers of M codes that move neither an axis nor the frame.
    pub harmless_m_codes: Vec<u16>,
    /// Programs and functions of the control that are left alone.
    pub calls: Vec<LeftAlone>,
    /// Largest difference of an arc's radii that the control takes, mm; `None`: the dialect's.
    pub arc_tolerance_mm: Option<f64>,
    /// X words of a lathe's programs are diameters; `None`: not said.
    pub diameters: Option<bool>,
    /// G-code system of a lathe's control; `None`: not said.
    pub g_code_system: Option<String>,
    /// What parameters of a lathe's control say of its cycles.
    pub turning: TurningParameters,
}

/// Tool centre point control: the tip runs straight from end to end of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Kinematics {
    /// Of A, B, C: a point of the axis as the control has it, machine frame with all axes at 0, mm; in a head: from the
    /// gauge point.
    pub centres_mm: [[f64; 3]; 3],
    /// How the control turns the tool to a tilted plane.
    pub tilt_rule: TiltRule,
    /// Between directions that are given as vectors the tool turns along a great circle, or each rotary axis runs evenly; `None`:
    /// not said.
    pub great_circle: Option<bool>,
    /// It is on when a program begins.
    pub at_start: bool,
    /// Numbers of the machine's M codes that switch it on.
    pub on: Vec<u16>,
    /// Those that switch it off.
    pub off: Vec<u16>,
}

/// An effect beyond the tables, as the profile names it; [`machine_model::effects::EffectTerm::from_entry`] reads it.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectEntry {
    /// Like `backlash.X`.
    pub id: String,
    /// Names with unit, and values; in the order of the alphabet.
    pub parameters: Vec<(String, f64)>,
}

/// The measuring frame against the machine frame: for `predict --include-setup` only.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeasuringFrame {
    /// Shift, mm.
    pub shift_mm: [f64; 3],
    /// Rotation, rad.
    pub rotation_rad: [f64; 3],
}

/// The nose of a turning tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nose {
    /// Its radius, mm.
    pub radius_mm: f64,
    /// Direction of the imaginary tip, 0 to 9, as the control numbers it.
    pub direction: Option<u8>,
    /// κ', angle of the minor cutting edge to the axis, rad.
    pub minor_edge_rad: Option<f64>,
}

/// What makes a machine a lathe.
#[derive(Clone, Debug, PartialEq)]
pub struct LatheParts {
    /// As it is written, S the spindle.
    pub chain: String,
    /// The spindle, with the tailstock where it bears the workpiece.
    pub spindle: turning::Spindle,
    /// How far the workpiece bends away from the tool.
    pub bending: turning::Bending,
    /// The bar in its clamping, where the profile says both.
    pub bar: Option<turning::Workpiece>,
    /// How the tool's holder stands.
    pub tip: turning::Tip,
    /// Stations of the turret that err.
    pub stations: Vec<turning::Station>,
    /// By H number.
    pub noses: Vec<(u32, Nose)>,
}

/// Everything a profile says, checked: values are finite, tables ordered, the chain complete.
#[derive(Clone, Debug)]
pub struct Profile {
    /// Name of the machine.
    pub name: String,
    /// The control's dialect.
    pub control: Option<String>,
    /// What the control adds to the path.
    pub interpolator: Interpolator,
    /// The bytes of the profile that say it.
    pub control_at: Option<std::ops::Range<u64>>,
    /// Calibration record.
    pub calibrated: Option<Calibrated>,
    /// Geometry for the rigid-body model: chain, tables, squareness, rotary axes.
    pub description: Description,
    /// Step of the output of X, Y, Z, mm.
    pub resolution_mm: [f64; 3],
    /// Step of the output of A, B, C, degrees.
    pub resolution_deg: [f64; 3],
    /// What lies between table nodes.
    pub interpolation: Interpolation,
    /// Tables of X, Y, Z as measured (`errors`), for the engines that work on rows.
    pub rows: [Option<ErrorRows>; 3],
    /// Tracker traverses of X, Y, Z.
    pub traverses: Option<[Traverse; 3]>,
    /// Error vectors measured in the volume.
    pub field: Option<MeasuredField>,
    /// Tool vector without G43, gauge point to tip, mm.
    pub default_tool_mm: [f64; 3],
    /// The length that the control would have of a tool that ends at the gauge point, mm, where the profile says it.
    pub gauge_point_mm: Option<f64>,
    /// H number and length vector, mm, ordered by number. The axis command is program + work offset +
    /// vector; the tool vector is minus the vector.
    pub tools: Vec<(u32, [f64; 3])>,
    /// Names of tools, and the H numbers of their lengths.
    pub tool_names: Vec<(String, u32)>,
    /// D number and radius of a mill's cutter, mm, above zero.
    pub cutter_radii_mm: Vec<(u32, f64)>,
    /// Name (`G54`) and machine coordinate of that program zero, mm, ordered by name.
    pub work_offsets: Vec<(String, [f64; 3])>,
    /// How they were found, where the profile says more than their place.
    pub zeros: Vec<(String, ZeroFound)>,
    /// Axis commands of the surface on which all tool lengths were touched off, the length not added, mm; `None`: they are true.
    pub lengths_touched_at_mm: Option<[f64; 3]>,
    /// How programs are corrected.
    pub correction: CorrectionOptions,
    /// How programs are read.
    pub program: ProgramRules,
    /// Tool centre point control; `None`: what the control computes with is not said.
    pub kinematics: Option<Kinematics>,
    /// Effects beyond the tables.
    pub effects: Vec<EffectEntry>,
    /// The measuring frame.
    pub setup: MeasuringFrame,
    /// Of a lathe; its Y, which it does not have, stands at 0 without errors.
    pub lathe: Option<LatheParts>,
    /// The model of `description`: made once, while loading.
    pub(crate) rigid_body: RigidBody,
}

impl Profile {
    /// The axes from workpiece to tool.
    #[must_use]
    pub fn chain(&self) -> &Chain {
        &self.description.chain
    }

    /// The rigid-body model of tables, squareness and rotary axes alone; [`Profile::machine`] is the whole.
    #[must_use]
    pub fn rigid_body_without_effects(&self) -> &RigidBody {
        &self.rigid_body
    }

    /// Where every table given covers its axis.
    #[must_use]
    pub fn volume(&self) -> Volume {
        machine_model::Engine::volume(&self.rigid_body)
    }

    /// Which of A, B, C the chain holds.
    #[must_use]
    pub fn has_rotary(&self) -> [bool; 3] {
        let mut has = [false; 3];
        for axis in self.chain().axes().filter(|axis| !axis.is_linear()) {
            has[axis.direction()] = true;
        }
        has
    }

    /// True where what the linear axes must be told depends on where the rotary axes stand: a rotary axis
    /// with errors, or one that turns the tool while linear axes have errors (the tool is their lever).
    #[must_use]
    pub fn rotary_matters(&self) -> bool {
        let linear_errors = self.description.squareness != machine_model::Squareness::default()
            || self.rows.iter().any(Option::is_some)
            || !self.effects.is_empty();
        let imperfect = self
            .chain()
            .axes()
            .filter(|axis| !axis.is_linear())
            .any(|axis| !self.description.rotary[axis.direction()].is_perfect());
        imperfect || (linear_errors && !self.chain().head().is_empty()) || self.kinematics.is_some()
    }

    /// True where the errors depend on how long the tool is: an axis turns what it carries.
    #[must_use]
    pub fn lever_matters(&self) -> bool {
        let angles = |rows: &ErrorRows| rows.rows.iter().any(|row| row[3..] != [0.0; 3]);
        let both_ways = |axis: &machine_model::LinearAxis| axis.errors_negative.is_some();
        let turns = self.chain().axes().any(|axis| !axis.is_linear());
        self.rows.iter().flatten().any(angles)
            || self.description.linear.iter().any(both_ways)
            || (turns && self.rotary_matters())
            || !self.effects.is_empty()
    }

    /// The rotary axes from the workpiece to the tool, as far as directions go.
    #[must_use]
    pub fn rotary_chain(&self) -> RotaryChain {
        let table = self.chain().table();
        let links = self.chain().axes().filter(|axis| !axis.is_linear()).map(|axis| {
            let rotary = &self.description.rotary[axis.direction()];
            let direction = rotary.direction.unwrap_or_else(|| Vector::ith(axis.direction(), 1.0));
            RotaryLink {
                axis: axis.direction(),
                direction: direction.into(),
                carries_workpiece: table.contains(&axis),
                travel_deg: [rotary.travel_rad.low, rotary.travel_rad.high].map(f64::to_degrees),
            }
        });
        RotaryChain(links.collect())
    }

    /// The machine under tool centre point control; `None` where nothing is said of that, or no path can be proven: lost
    /// motion of a linear axis, effects.
    #[must_use]
    pub fn tip_control(&self) -> Option<TipControl> {
        let centres_mm = self.kinematics.as_ref()?.centres_mm.map(Vector::from);
        TipControl::new(&self.rigid_body, centres_mm).filter(|_| self.effects.is_empty())
    }

    /// What [`machine_model::engines::build`] takes, effects not included; [`Profile::engine`] includes them.
    #[must_use]
    pub fn engine_inputs_without_effects(&self) -> EngineInputs {
        let table = |rows: &ErrorRows| ParametricTable::new(rows.positions.clone(), rows.rows.clone()).ok();
        let [x, y, z] = &self.rows;
        let tables = match (x, y, z) {
            (Some(x), Some(y), Some(z)) => match (table(x), table(y), table(z)) {
                (Some(x), Some(y), Some(z)) => Some([x, y, z]),
                _ => None,
            },
            _ => None,
        };
        EngineInputs {
            rigid: Some(Box::new(self.rigid_body.clone())),
            traverses: self.traverses.clone(),
            traverse_interpolation: self.interpolation,
            tables,
            field: self.field.as_ref().map(|measured| measured.field.clone()),
        }
    }

    /// The engine that the command line names, else the field where programs are corrected by it, else the rigid body: what
    /// says where the machine goes.
    #[must_use]
    pub fn forward_engine(&self, named: Option<EngineId>) -> EngineId {
        let own = self.correction.engine;
        named.unwrap_or(if own == EngineId::Field { own } else { EngineId::RigidBody })
    }
}
