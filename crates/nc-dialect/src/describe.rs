//! The code-by-code list of a dialect, for people.

use std::fmt::Write;

use nc_syntax::Dialect;
use nc_syntax::dialect::{Action, CycleCode, GCode, Macros};

use crate::action_name;

/// G65
const MACRO_CALL: GCode = GCode(650);
/// What becomes of a call where the dialect's flow is known.
const EXECUTED: &str = "called programs are executed in the call's place, see above";

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
            Self::Refused => "refused",
        }
    }
}

/// What becomes of a block whose code does this.
#[must_use]
pub const fn treatment(action: &Action) -> Treatment {
    match action {
        Action::Rapid
        | Action::Line
        | Action::ArcClockwise
        | Action::ArcCounterClockwise
        | Action::Cycle(_) => Treatment::Corrected,
        Action::Reference | Action::MachineCoordinates | Action::Probe => Treatment::NotCorrected,
        Action::Dwell | Action::DwellP | Action::Pass { .. } => Treatment::Passed,
        Action::Refuse { .. } => Treatment::Refused,
        _ => Treatment::Followed,
    }
}

/// Markdown: what is assumed, and every code with what becomes of it.
#[must_use]
pub fn describe(dialect: &Dialect) -> String {
    let mut out = format!("### `{}`: {}\n\nAssumed:\n\n", dialect.name, dialect.title);
    for assumption in &dialect.assumptions {
        line(&mut out, format_args!("- {assumption}"));
    }
    out.push_str("\n| code | group | what becomes of it | why, or how |\n|---|---|---|---|\n");
    for entry in &dialect.codes {
        if entry.code == MACRO_CALL && dialect.flow.macros == Macros::Fanuc {
            line(&mut out, format_args!("| {} | {} | executed | {EXECUTED} |", entry.code, entry.group));
            continue;
        }
        let name = treatment(&entry.action).name();
        line(
            &mut out,
            format_args!("| {} | {} | {name} | {} |", entry.code, entry.group, note(&entry.action)),
        );
    }
    out.push_str("\nAny other G code is refused: it could move an axis.\n\n");
    out.push_str("| M code | what becomes of it |\n|---|---|\n");
    for code in &dialect.m_codes {
        let mut what = Vec::new();
        if matches!(code.number, 98 | 99) && dialect.flow.macros != Macros::None {
            what.push(EXECUTED.to_owned());
        } else if let Some((reason, help)) = &code.refuse {
            what.push(format!("refused: {reason}; {help}"));
        }
        if code.after_motion {
            what.push("executed after the motion of its block".to_owned());
        }
        let lost: String =
            "XYZ".chars().zip(code.loses_position).filter(|(_, lost)| *lost).map(|(axis, _)| axis).collect();
        if !lost.is_empty() {
            what.push(format!("position of {lost} unknown afterwards"));
        }
        if code.ends_program {
            what.push("ends the program".to_owned());
        }
        if what.is_empty() {
            what.push("passed".to_owned());
        }
        line(&mut out, format_args!("| M{} | {} |", code.number, what.join("; ")));
    }
    out.push_str("\nAny other M code is passed.\n");
    if !dialect.commands.is_empty() {
        out.push_str("\n| command | what becomes of it |\n|---|---|\n");
        for command in &dialect.commands {
            let what = match &command.refuse {
                None => "passed".to_owned(),
                Some((reason, help)) => format!("refused: {reason}; {help}"),
            };
            line(&mut out, format_args!("| `{}` | {what} |", command.name));
        }
        out.push_str("\nAny other command is refused: it could move the frame.\n");
    }
    out
}

fn line(out: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = writeln!(out, "{text}");
}

fn note(action: &Action) -> String {
    match action {
        Action::Refuse { reason, help } => format!("{reason}; {help}"),
        Action::Rapid => "its end; never split".to_owned(),
        Action::Line => "split where the machine's error curves".to_owned(),
        Action::ArcClockwise | Action::ArcCounterClockwise => {
            "kept as arcs where one or a few hold the tolerance".to_owned()
        }
        Action::Cycle(CycleCode::Synchronised) => "hole by hole; never written as moves".to_owned(),
        Action::Cycle(_) => "hole by hole".to_owned(),
        Action::Dwell => "X, U and P are a time".to_owned(),
        Action::DwellP => "P is a time; axis words belong to the motion".to_owned(),
        Action::WorkOffsetNumbered => "the work offset that P numbers: `G54.1P1` in the profile".to_owned(),
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
        Action::LengthFromWords => "the tool length is in the words".to_owned(),
        Action::Pass { takes_words: true } => "its words are arguments, not positions".to_owned(),
        Action::Pass { takes_words: false } => String::new(),
        other => action_name(other).replace('-', " "),
    }
}
