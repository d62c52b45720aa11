//! The code-by-code list of a dialect, for people.

use crate::control::{Action, CurveCode, CycleBack, Dialect, FramePart, LengthAfter, MCode};
use nc_syntax::{GCode, Macros};

use crate::action_name;
use toolpath::CycleKind;

/// G65
const MACRO_CALL: GCode = GCode(650);

/// What becomes of a block with a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Treatment {
    /// Its motion is corrected.
    Corrected,
    /// It changes how later motion is read, and is followed.
    Followed,
    /// It moves axes by rules of the control: left alone, position known afterwards only where the code says.
    NotCorrected,
    /// It is text.
    Passed,
    /// Called programs are executed in the call's place, before anything is corrected.
    Executed,
    /// The program is refused.
    Refused,
}

impl Treatment {
    /// The word in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Corrected => "corrected",
            Self::Followed => "followed",
            Self::NotCorrected => "left alone",
            Self::Passed => "passed",
            Self::Executed => "executed",
            Self::Refused => "refused",
        }
    }
}

/// One row of the list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// `G54.1`, `M98`, `TRANS`.
    pub code: String,
    /// Modal group; 0 for G codes of one block, and for M codes and commands.
    pub group: u8,
    /// What becomes of a block with it.
    pub treatment: Treatment,
    /// Why, or how.
    pub note: String,
}

/// Every code of a dialect's table: G codes, M codes, commands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rows {
    /// Every other one is refused.
    pub g_codes: Vec<Row>,
    /// Every other one is passed.
    pub m_codes: Vec<Row>,
    /// Every other one is refused.
    pub commands: Vec<Row>,
}

/// What becomes of a block whose code does this.
#[must_use]
pub const fn treatment(action: &Action) -> Treatment {
    match action {
        Action::Rapid
        | Action::Line
        | Action::ArcClockwise
        | Action::ArcCounterClockwise
        | Action::Thread
        | Action::Curve(_)
        | Action::Cycle(_) => Treatment::Corrected,
        Action::Reference | Action::MachineCoordinates | Action::Probe => Treatment::NotCorrected,
        Action::Dwell
        | Action::DwellBySetting
        | Action::DwellP
        | Action::Pass { .. }
        | Action::PassWithP
        | Action::ContourTolerance => Treatment::Passed,
        Action::Refuse { .. } => Treatment::Refused,
        Action::PolarOn | Action::PolarOff | Action::Turning(_) | Action::Called(_) => Treatment::Executed,
        _ => Treatment::Followed,
    }
}

/// What a dialect's table says of each of its codes.
#[must_use]
pub fn rows(dialect: &Dialect) -> Rows {
    let executed = || "called programs are executed in the call's place, see above".to_owned();
    let g_codes = dialect.codes.iter().map(|entry| {
        let calls = entry.code == MACRO_CALL && dialect.flow.macros == Macros::Fanuc;
        let (treatment, note) = if calls {
            (Treatment::Executed, executed())
        } else {
            let unstated =
                entry.action == Action::LengthOff && dialect.length_under_g49 == LengthAfter::Unstated;
            let note = if unstated {
                "refused while a tool length is in force, or with H or D beside it".to_owned()
            } else {
                note(&entry.action)
            };
            let written_out = dialect.flow.written_cycles.is_some_and(|rule| match entry.action {
                Action::Cycle(_) | Action::CycleCancel => true,
                Action::ReturnInitial | Action::ReturnR => rule.back == CycleBack::ByG,
                _ => false,
            });
            if written_out {
                (Treatment::Executed, "written out as moves".to_owned())
            } else {
                (treatment(&entry.action), note)
            }
        };
        Row { code: entry.code.to_string(), group: entry.group, treatment, note }
    });
    let m_codes = dialect.m_codes.iter().map(|entry| {
        let (treatment, note) = if dialect.flow.calls(i64::from(entry.number)) {
            (Treatment::Executed, executed())
        } else {
            of_m_code(entry)
        };
        Row { code: format!("M{}", entry.number), group: 0, treatment, note }
    });
    let commands = dialect.commands.iter().map(|entry| {
        let (treatment, note) = match &entry.refuse {
            None => match &entry.action {
                Some(action) => (treatment(action), note(action)),
                None => (Treatment::Passed, String::new()),
            },
            Some((reason, help)) => {
                let most = entry.passes_with.map(|most| format!("with more than {most} argument(s): "));
                (Treatment::Refused, format!("{}{reason}; {help}", most.unwrap_or_default()))
            }
        };
        Row { code: entry.name.clone(), group: 0, treatment, note }
    });
    Rows { g_codes: g_codes.collect(), m_codes: m_codes.collect(), commands: commands.collect() }
}

fn of_m_code(entry: &MCode) -> (Treatment, String) {
    if let Some((reason, help)) = &entry.refuse {
        return (Treatment::Refused, format!("{reason}; {help}"));
    }
    if let Some(what) = &entry.switches {
        return (
            Treatment::Refused,
            format!("{what}; passes where the profile has it under `[m_codes] harmless`"),
        );
    }
    let mut what = Vec::new();
    if entry.slash_arguments {
        what.push("its arguments stand behind slashes".to_owned());
    }
    if entry.after_motion {
        what.push("executed after the motion of its block".to_owned());
    }
    let lost: String =
        "XYZ".chars().zip(entry.loses_position).filter(|(_, lost)| *lost).map(|(axis, _)| axis).collect();
    if !lost.is_empty() {
        let unless = if entry.changes_tool { ", unless the profile's `tool_change` says" } else { "" };
        what.push(format!("position of {lost} unknown afterwards{unless}"));
    }
    if entry.ends_program {
        what.push("ends the program".to_owned());
    }
    let followed = entry.ends_program || !lost.is_empty();
    (if followed { Treatment::Followed } else { Treatment::Passed }, what.join("; "))
}

fn note(action: &Action) -> String {
    match action {
        Action::Refuse { reason, help } => format!("{reason}; {help}"),
        Action::Rapid => "its end; never split".to_owned(),
        Action::Line => "split where the machine's error curves".to_owned(),
        Action::ArcClockwise | Action::ArcCounterClockwise => {
            "kept as arcs where one or a few hold the tolerance".to_owned()
        }
        Action::Thread => "one block in step with the spindle; never split".to_owned(),
        Action::Curve(form) => match form {
            CurveCode::Cubic => "I J and P Q are the control points; written as lines",
            CurveCode::Quadratic => "I J is the control point; written as lines",
            CurveCode::Points => "a control point with its weight P, order L; cut by G5.3",
            CurveCode::End => "the control points before are cut: written as lines",
            CurveCode::PlaneKnots => {
                "a control point in the plane with its weight R, a knot K, order P, Q; written as lines"
            }
            CurveCode::Knots => "a control point with its weight R, a knot K, order P; written as lines",
        }
        .to_owned(),
        Action::Turning(_) | Action::Called(_) => "written out as moves".to_owned(),
        Action::ProgramFrame { part, adds } => {
            let what = match part {
                FramePart::Shift => "shifts by the words",
                FramePart::Rotation => "rotates in the plane",
                FramePart::Mirror => "mirrors the axes named",
            };
            let which = if *adds { "on top of the program's frame" } else { "in place of the program's frame" };
            format!("{what}, {which}")
        }
        Action::Swivel => "a tilted plane by angles axis by axis, to which the rotary axes turn by `_DIR`; without \
             arguments it ends; refused while a frame of the program is in force"
            .to_owned(),
        Action::BaseFrame => "`G500` in the profile; without it nothing may move in it".to_owned(),
        Action::Tip(_) => String::new(),
        Action::Cycle(CycleKind::Synchronised) => "hole by hole; never written as moves".to_owned(),
        Action::Cycle(_) => "hole by hole".to_owned(),
        Action::Dwell => "X, U, P, F and S are a time".to_owned(),
        Action::DwellBySetting => "no word is a time, none beside it may be a position".to_owned(),
        Action::DwellP => "P is a time; axis words belong to the motion".to_owned(),
        Action::WorkOffsetNumbered => "the work offset that P numbers: `G54.1P1` in the profile".to_owned(),
        Action::WorkOffsetByH => "the work offset that H numbers: `G15H1` in the profile".to_owned(),
        Action::WriteOffset => {
            "L2 and L20: the program's value holds from here on; every other L and R refused".to_owned()
        }
        Action::LocalShift => "shifts every work offset by the words".to_owned(),
        Action::Preset => "shifts every work offset so that the axes stand at the words".to_owned(),
        Action::PresetCancel => "no shift".to_owned(),
        Action::PresetSuspend => "no shift; kept for G92.3".to_owned(),
        Action::PresetRestore => "the shift that this program set; refused where it set none".to_owned(),
        Action::RotationOn => "in the plane, by R about both words of the plane; arcs stay arcs".to_owned(),
        Action::ScalingOn => "about X, Y and Z by P, or by I, J and K without arcs; no cycles".to_owned(),
        Action::MirrorOn => "about the words; G2 and G3 change places".to_owned(),
        Action::PolarOn => {
            "radius and angle are written out as the plane's words: in G90, about the program's zero"
                .to_owned()
        }
        Action::PolarOff => "ends G16".to_owned(),
        Action::LengthFromWords => "the tool length is in the words".to_owned(),
        Action::TiltedPlane => {
            "by Euler angles, roll, pitch and yaw, three points or two vectors (P0 to P3); needs `[kinematics]`"
                .to_owned()
        }
        Action::AlignTool => {
            "the angles by the profile's `branch` and `turn`; X, Y and Z unknown afterwards".to_owned()
        }
        Action::Pass { takes_words: true } => "its words are arguments, not positions".to_owned(),
        Action::DynamicOffset => {
            "as a tilted plane along the machine's axes where the table stands; needs `[kinematics]`".to_owned()
        }
        Action::DynamicOffsetOff => "ends G254; X, Y and Z unknown afterwards".to_owned(),
        Action::Call => "a program of the control, left alone: what it may move is unknown behind it".to_owned(),
        Action::Alarm => "ends the program with an alarm".to_owned(),
        Action::ContourTolerance => "refused where its second argument may switch TRAORI".to_owned(),
        Action::PassWithP => "its P is its own".to_owned(),
        Action::Pass { takes_words: false } => String::new(),
        other => action_name(other).replace('-', " "),
    }
}
