use diagnostic::{Text, both};
use toolpath::{AXIS_NAMES, RotaryChain, TiltRule};

use crate::modal::ToolLength;

/// Where a linear axis stands behind a tool change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AfterChange {
    /// Anywhere.
    #[default]
    Unknown,
    /// Where it stood before.
    Stays,
    /// At this axis command, mm.
    At(f64),
}

/// What is known of tool centre point control; without it the codes that switch it are refused.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TipControl {
    /// With which centres the control computes is not said.
    #[default]
    Undeclared,
    /// It is said, and no path can be proven: lost motion, effects, an engine without rotary axes.
    Unproven,
    /// It is said.
    Declared,
}

impl TipControl {
    /// Why what the control computes cannot be followed, and the way out; `None` where it can.
    ///
    /// * `path` – what cannot be proven: "no path under it"
    /// * `without` – what to post without
    pub(crate) fn unknown(self, path: &Text, without: &Text) -> Option<(Text, Text)> {
        match self {
            Self::Undeclared => Some((
                both!(
                    "with which centres the control computes is not said",
                    "не сказано, с какими центрами поворота считает стойка"
                ),
                both!(
                    "declare what the control computes with as `[kinematics]` in the profile, or post without {without}",
                    "скажите, с чем считает стойка, в разделе `[kinematics]` профиля или выводите программу без {without:#}"
                ),
            )),
            Self::Unproven => Some((
                both!(
                    "with lost motion of linear axes, with `[[effect]]`, and with engines other than `rigid-body`, {path} can be proven",
                    "при люфте линейных осей, при `[[effect]]` и для методов, кроме `rigid-body`, путь {path:#} не доказать"
                ),
                both!("post without {without}", "выводите программу без {without:#}"),
            )),
            Self::Declared => None,
        }
    }
}

/// How a control turns the tool between two directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BetweenVectors {
    /// Each rotary axis runs evenly from its angle to the next.
    Axes,
    /// The tool turns in the plane of both, evenly.
    GreatCircle,
}

/// What the program cannot say of itself: the profile's and the command line's part, plain numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Setup {
    /// Name (`G54`) and machine coordinate of that program zero, mm.
    pub work_offsets: Vec<(String, [f64; 3])>,
    /// H number and length vector, mm: the axis command is program + work offset + vector, and the tool
    /// vector (gauge point to tip) is minus the vector. `H1 = 120` is `(1, [0, 0, 120])`.
    pub tools: Vec<(u32, [f64; 3])>,
    /// Name of a tool and the H number of its length.
    pub tool_names: Vec<(String, u32)>,
    /// The edge that a tool change brings in where no D says one: 0 for none; `None`: not said (MD20270).
    pub edge_at_change: Option<u32>,
    /// The length in force is that of the tool in the spindle, from its change on, whatever H a G43 names.
    pub t_means_h: bool,
    /// H number and radius of the nose of a turning tool, mm, above zero.
    pub noses_mm: Vec<(u32, f64)>,
    /// D number and radius of a mill's cutter, mm, above zero: how long pieces must be that the control offsets.
    pub radii_mm: Vec<(u32, f64)>,
    /// Tool vector without G43: from the gauge point to the tip, mm.
    pub default_tool_mm: [f64; 3],
    /// The length that the control would have of a tool that ends at the gauge point, mm; `None`: not said, and taken as 0.
    pub gauge_point_mm: Option<f64>,
    /// What the axes must be told depends on how long the tool is.
    pub lever_matters: bool,
    /// Which of A, B, C the machine has.
    pub has_rotary: [bool; 3],
    /// What the linear axes must be told depends on where the rotary axes stand. Where it does not, their
    /// position need not be known, and they may turn while linear axes feed.
    pub rotary_matters: bool,
    /// Commands of the linear axes at the start of the program, mm (`--start-at`); `None`: unknown.
    pub start_mm: [Option<f64>; 3],
    /// Where the rotary axes stand at the start of the program, degrees; `None`: unknown.
    pub start_deg: [Option<f64>; 3],
    /// X, Y, Z behind a tool change.
    pub tool_change: [AfterChange; 3],
    /// What is known of tool centre point control.
    pub tip_control: TipControl,
    /// Which way rotary axes turn the tool.
    pub rotary_chain: RotaryChain,
    /// By which rule the control turns the tool to a tilted plane.
    pub tilt_rule: TiltRule,
    /// How the control turns the tool between two directions that are given as vectors; `None`: not said.
    pub vectors: Option<BetweenVectors>,
    /// Tool centre point control is on when the program begins.
    pub tip_at_start: bool,
    /// X words of a lathe's program are diameters, or radii; `None`: not said.
    pub diameters: Option<bool>,
    /// What a length without a point is was said by profile or command line: the dialect's numbers are not open.
    pub lengths_settled: bool,
}

impl Setup {
    /// The machine coordinate of the work offset's zero, where it is given.
    pub(crate) fn work_offset(&self, name: &str) -> Option<[f64; 3]> {
        self.work_offsets.iter().find(|(known, _)| known == name).map(|(_, zero)| *zero)
    }

    /// The length vector of an H number; H0 is no length and needs no entry.
    pub(crate) fn tool(&self, number: u32) -> Option<[f64; 3]> {
        if number == 0 {
            return Some([0.0; 3]);
        }
        self.tools.iter().find(|(known, _)| *known == number).map(|(_, vector)| *vector)
    }

    /// From the gauge point to the tip, mm, where this length shifts the axes.
    /// Where G44 subtracts it, the tool points the other way.
    #[must_use]
    pub fn tool_vector(&self, length: &ToolLength) -> [f64; 3] {
        let Some([x, y, z]) = length.ends_mm() else { return self.default_tool_mm };
        [0.0 - x, 0.0 - y, self.gauge_point_mm.unwrap_or(0.0) - z]
    }

    /// The rotary axes as text: `A, C`, or `none`.
    pub(crate) fn rotary_names(&self) -> Text {
        let names: Vec<String> =
            (0..3).filter(|&i| self.has_rotary[i]).map(|i| AXIS_NAMES[3 + i].to_string()).collect();
        if names.is_empty() { both!("none", "нет") } else { Text::same(names.join(", ")) }
    }
}
