//! Where a block's axis words lead, and what is said where that cannot be known.

use diagnostic::{Diagnostic, Entry, Refusal, Text, both, refusal};
use nc_dialect::Action;
use nc_syntax::{Letters, Span};
use toolpath::{AXIS_NAMES, Frame, Position};

use crate::codes;
use crate::environment::{BASE_FRAME, Environment};
use crate::modal::{Axes, Axis, Distance, Lost, Modal, MotionMode, Naming, Units, Why};
use crate::refusals::position as refusal;
use crate::words::{AXIS_LETTERS, LINEAR, Outcome, ROTARY, ROTARY_LETTERS, Words};
use crate::work_offset::{missing_offset, name_of};

/// From program coordinates to axis commands, mm: refused where the work offset in force is not given.
#[inline]
pub(crate) fn require_frame<'s>(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    state: &'s Modal,
) -> Outcome<&'s Frame> {
    match &state.frame {
        Some(frame) => Ok(frame),
        None => Err(no_frame(env, words, state)),
    }
}

#[cold]
fn no_frame(env: &Environment<'_>, words: &Words<'_, '_, '_>, state: &Modal) -> Box<Diagnostic> {
    let span = words.span(AXIS_LETTERS);
    if state.work_offset.rewritten {
        let name = name_of(env.dialect, &state.work_offset).unwrap_or_default();
        return words.refuse(refusal::work_offset_rewritten(name), span);
    }
    match state.work_offset.code.and_then(|code| env.dialect.code(code)).map(|entry| &entry.action) {
        Some(Action::WorkOffset(name)) => missing_offset(words, name, span),
        Some(Action::BaseFrame) => missing_offset(words, BASE_FRAME, span),
        _ => words.refuse(refusal::NO_WORK_OFFSET_IN_FORCE, span),
    }
}

/// Refuses words for rotary axes that the machine does not have, and U V W.
#[inline]
pub(crate) fn known_axes(env: &Environment<'_>, words: &Words<'_, '_, '_>) -> Outcome<()> {
    if words.has(crate::words::SECONDARY_LETTERS) && !words.names_direction() {
        let letters = crate::words::SECONDARY_LETTERS;
        return Err(words.refuse(refusal::cannot_be_resolved(&words.names(letters)), words.span(letters)));
    }
    if words.has(ROTARY_LETTERS) {
        for (i, letter) in ROTARY.iter().enumerate() {
            let bit = Letters::of(&[*letter]);
            if words.has(bit) && !env.setup.has_rotary[i] {
                let name = *letter as char;
                return Err(
                    words.refuse(refusal::no_such_axis(name, &env.setup.rotary_names()), words.span(bit))
                );
            }
        }
    }
    Ok(())
}

/// The axes after the words of the block, program coordinates, G90 or G91.
///
/// # Errors
/// An increment from an unknown position.
#[inline]
pub(crate) fn end(words: &Words<'_, '_, '_>, state: &Modal, frame: &Frame) -> Outcome<Axes> {
    let mut end = state.axes;
    let inch = state.units == Units::Inch;
    let unit_mm = state.units.mm();
    let shift_mm = frame.offset_mm();
    if !frame.is_shift() {
        end.linear = turned_end(words, state, frame)?;
    }
    for i in 0..if frame.is_shift() { 3 } else { 0 } {
        if let Some(value) = words.coordinate(LINEAR[i], inch) {
            let value_mm = value * unit_mm;
            let incremental = words.by_increment[i] || state.distance == Distance::Incremental;
            end.linear[i] = Axis::At(if incremental {
                linear_base(words, state, i)? + value_mm
            } else {
                value_mm + shift_mm[i]
            });
        }
    }
    if words.has(ROTARY_LETTERS) {
        for (i, letter) in ROTARY.into_iter().enumerate() {
            if let Some(value) = words.coordinate(letter, false) {
                let span = words.span(Letters::of(&[letter]));
                end.rotary[i] = Axis::At(match state.distance {
                    _ if words.block.text(span).ends_with(b")") => direct(words, span, value, i, state)?,
                    Distance::Absolute => value,
                    Distance::Incremental => increment_base(words, state.axes.rotary[i], 3 + i)? + value,
                });
            }
        }
    }
    Ok(end)
}

/// How far ACP and ACN turn at least, degrees: behind an angle that was corrected a shorter way could be a whole turn.
const LEAST_WAY_DEG: f64 = 2.0;

/// Where `C=DC(90)`, `C=ACP(90)`, `C=ACN(90)` lead, degrees: by the shortest way, upwards, downwards, in the turn from
/// 0 to 360 that a control shows; `C=AC(90)`: as without a name under G90.
///
/// Across 0 nobody could write the angle without a name so that it is the same; from where nobody knows only a rapid
/// goes, whose way does not matter.
fn direct(words: &Words<'_, '_, '_>, span: Span, value_deg: f64, axis: usize, state: &Modal) -> Outcome<f64> {
    let text = words.block.text(span).to_ascii_uppercase();
    let names = |name: &[u8]| text.windows(name.len()).any(|part| part == name);
    let (up, down) = (names(b"ACP"), names(b"ACN"));
    if names(b"AC") && !up && !down {
        return Ok(value_deg);
    }
    let in_turn = |deg: f64| (0.0..360.0).contains(&deg);
    let stays_in_turn = match state.axes.rotary[axis] {
        Axis::At(stands_deg) => {
            let way_deg = value_deg - stands_deg;
            in_turn(stands_deg)
                && match (up, down) {
                    (true, _) => way_deg >= LEAST_WAY_DEG,
                    (_, true) => way_deg <= -LEAST_WAY_DEG,
                    _ => way_deg.abs() < 180.0,
                }
        }
        Axis::Unknown(_) => matches!(state.motion, MotionMode::Rapid(_)),
    };
    if in_turn(value_deg) && stays_in_turn {
        return Ok(value_deg);
    }
    let message = both!(
        "{} does not stay between 0 and 360 degrees on its way",
        "{} по пути не остаётся между 0 и 360 градусами",
        words.text(span)
    );
    let label = match state.axes.rotary[axis] {
        Axis::At(stands_deg) => both!("the axis comes from {stands_deg}", "ось идёт от {stands_deg}"),
        Axis::Unknown(_) => {
            both!("where the axis comes from is not known", "откуда идёт ось, неизвестно")
        }
    };
    Err(words.refuse(refusal!(codes::BAD_NUMBER; message; label;
        "write the angle without a name, counted on over whole turns, or turn the axis by a rapid of its own before",
        "напишите угол без имени, со счётом полных оборотов, или поверните ось раньше отдельным быстрым ходом"
    ), span))
}

/// The linear axes after the words of the block where a rotation, scaling or mirror is in force.
///
/// An axis that no word reaches through the matrix stays; one that is reached needs every program
/// coordinate that reaches it: named, or known from where the axes stand.
fn turned_end(words: &Words<'_, '_, '_>, state: &Modal, frame: &Frame) -> Outcome<[Axis; 3]> {
    let inch = state.units == Units::Inch;
    let unit_mm = state.units.mm();
    let value = LINEAR.map(|letter| words.coordinate(letter, inch).map(|value| value * unit_mm));
    let matrix = frame.matrix();
    let reaches = |axis: usize, program: usize| matrix[axis][program] != 0.0;
    let mut end = state.axes.linear;
    if state.distance == Distance::Incremental {
        for axis in 0..3 {
            if (0..3).any(|i| value[i].is_some() && reaches(axis, i)) {
                let step: f64 = (0..3).map(|i| matrix[axis][i] * value[i].unwrap_or(0.0)).sum();
                end[axis] = Axis::At(linear_base(words, state, axis)? + step);
            }
        }
        return Ok(end);
    }
    let standing = state.axes.linear.map(|axis| axis.known().unwrap_or(0.0));
    let current = frame.to_program(standing);
    let target = frame.to_machine([0, 1, 2].map(|i| value[i].unwrap_or(current[i])));
    for axis in 0..3 {
        if !(0..3).any(|i| value[i].is_some() && reaches(axis, i)) {
            continue;
        }
        for i in (0..3).filter(|i| value[*i].is_none() && reaches(axis, *i)) {
            // The coordinate that was left out must follow from where the axes stand.
            for j in (0..3).filter(|j| frame.inverse()[i][*j] != 0.0) {
                increment_base(words, state.axes.linear[j], j)?;
            }
        }
        end[axis] = Axis::At(target[axis]);
    }
    Ok(end)
}

/// Where an increment of X, Y or Z starts.
fn linear_base(words: &Words<'_, '_, '_>, state: &Modal, axis: usize) -> Outcome<f64> {
    match state.named[axis] {
        Naming::Since(lost) if lost.why == Why::Frame && words.dialect.frames.increments_carry_shift => {
            let what = both!(
                "an increment behind a change of the zero: a setting of the control says whether it travels the change too",
                "приращение после смены нуля: проходит ли оно и эту смену, решает настройка стойки"
            );
            let name = AXIS_NAMES[axis];
            Err(unknown(words, what, words.span(Letters::of(&[name as u8])), &[(name, lost)]))
        }
        _ => increment_base(words, state.axes.linear[axis], axis),
    }
}

/// Where an increment starts.
pub(crate) fn increment_base(words: &Words<'_, '_, '_>, axis: Axis, index: usize) -> Outcome<f64> {
    match axis {
        Axis::At(value) => Ok(value),
        Axis::Unknown(lost) => {
            let name = AXIS_NAMES[index];
            let span = words.span(Letters::of(&[name as u8]));
            Err(unknown(
                words,
                both!("an increment from an unknown position", "приращение из неизвестного положения"),
                span,
                &[(name, lost)],
            ))
        }
    }
}

/// The position of all axes, refused where one is unknown.
///
/// `what` names the motion: `the feed move`.
#[inline]
pub(crate) fn require_known(words: &Words<'_, '_, '_>, axes: &Axes, what: &Text) -> Outcome<Position> {
    let [x, y, z] = axes.linear;
    let [a, b, c] = axes.rotary;
    if let (Axis::At(x), Axis::At(y), Axis::At(z), Axis::At(a), Axis::At(b), Axis::At(c)) = (x, y, z, a, b, c)
    {
        return Ok(Position { linear_mm: [x, y, z], rotary_deg: [a, b, c] });
    }
    Err(not_known(words, axes, what))
}

#[cold]
fn not_known(words: &Words<'_, '_, '_>, axes: &Axes, what: &Text) -> Box<Diagnostic> {
    let [x, y, z] = axes.linear;
    let [a, b, c] = axes.rotary;
    let lost: Vec<(char, Lost)> = [x, y, z, a, b, c]
        .into_iter()
        .zip(AXIS_NAMES)
        .filter_map(|(axis, name)| match axis {
            Axis::At(_) => None,
            Axis::Unknown(lost) => Some((name, lost)),
        })
        .collect();
    let message =
        both!("{what} starts from an unknown position", "{what:#} начинается из неизвестного положения");
    unknown(words, message, words.span(AXIS_LETTERS), &lost)
}

/// Refuses unknown rotary axes: what a linear axis must be told depends on them.
#[inline]
pub(crate) fn require_rotary(words: &Words<'_, '_, '_>, axes: &Axes) -> Outcome<()> {
    if axes.rotary.iter().all(|axis| axis.known().is_some()) {
        return Ok(());
    }
    let lost: Vec<(char, Lost)> = (0..3)
        .filter_map(|i| match axes.rotary[i] {
            Axis::At(_) => None,
            Axis::Unknown(lost) => Some((AXIS_NAMES[3 + i], lost)),
        })
        .collect();
    let message = both!(
        "a motion of linear axes while a rotary axis is unknown",
        "движение линейных осей, а положение поворотной неизвестно"
    );
    Err(unknown(words, message, words.span(AXIS_LETTERS), &lost))
}

fn unknown(words: &Words<'_, '_, '_>, message: Text, span: Span, lost: &[(char, Lost)]) -> Box<Diagnostic> {
    let names: Vec<String> = lost.iter().map(|(name, _)| format!("{name}…")).collect();
    let where_any = |why: &dyn Fn(&Why) -> bool, also: Text| {
        if lost.iter().any(|(_, lost)| why(&lost.why)) { also } else { Text::EMPTY }
    };
    let changed = |why: &Why| matches!(why, Why::Miscellaneous { changes_tool: true, .. });
    let tool_change = where_any(
        &changed,
        Text::pair(
            ", or say where a tool change leaves the axes: `tool_change = { keeps = \"XYZ\" }` or a position, under `[program]` in the profile",
            "; или скажите, где оставляет оси смена инструмента: `tool_change = { keeps = \"XYZ\" }` или положение, в разделе `[program]` профиля",
        ),
    );
    let length = where_any(
        &|why| *why == Why::ToolLength,
        Text::pair(
            ", or in the block of the tool length; or, where the control's manual says that the length alone moves nothing, say so as tool_length.alone in a copy of the grammar",
            " или в кадре с коррекцией на длину; а если по руководству стойки сама коррекция оси не перемещает, укажите это как tool_length.alone в копии таблицы диалекта",
        ),
    );
    let rotary_from_start = |(name, lost): &(char, Lost)| lost.why == Why::Start && "ABC".contains(*name);
    let start = if lost.iter().all(rotary_from_start) {
        let places: Vec<String> = lost.iter().map(|(name, _)| format!("{name}=0")).collect();
        both!(
            ", or say where it stands then, as in `--start-at {}`; for all programs `rotary_start = {{ {} }}` under `[program]` in the profile",
            "; или скажите, где она тогда стоит, например `--start-at {}`; для всех программ — `rotary_start = {{ {} }}` в разделе `[program]` профиля",
            places.join(","),
            places.join(", ").replace('=', " = ")
        )
    } else {
        Text::EMPTY
    };
    let help = both!(
        "program a rapid `G90 G0 {}` before this block{length}{tool_change}{start}",
        "запрограммируйте перед этим кадром быстрый ход `G90 G0 {}`{length:#}{tool_change:#}{start:#}",
        names.join(" ")
    );
    let refusal = Refusal { code: codes::POSITION_UNKNOWN, message, label: reasons(lost), help };
    let refused = words.refuse(refusal, span);
    if lost.iter().all(|(_, lost)| changed(&lost.why)) {
        let entry = Entry::new("program", None, "tool_change", "{ keeps = \"XYZ\" }");
        return Box::new(refused.settled_by(entry));
    }
    refused
}

/// `X, Y not known since the start of the program; Z not known since the reference return in line 12`.
fn reasons(lost: &[(char, Lost)]) -> Text {
    let mut parts: Vec<(Lost, String)> = Vec::new();
    for (name, lost) in lost {
        match parts.iter_mut().find(|(known, _)| known == lost) {
            Some((_, names)) => {
                names.push_str(", ");
                names.push(*name);
            }
            None => parts.push((*lost, name.to_string())),
        }
    }
    let parts: Vec<Text> = parts
        .iter()
        .map(|(lost, names)| {
            both!("{names} not known since {}", "положение {names} неизвестно {:#}", lost.since())
        })
        .collect();
    Text::join(&parts, "; ")
}

impl Lost {
    /// What happened, to follow upon `not known since`.
    #[must_use]
    pub fn since(self) -> Text {
        let line = self.line;
        match self.why {
            Why::Start => both!("the start of the program", "с начала программы"),
            Why::Reference => both!(
                "the reference return in line {line}",
                "после выхода в исходное положение в строке {line}"
            ),
            Why::MachineCoordinates => both!(
                "G53 under G91 in line {line}, which some controls ignore",
                "после G53 при G91 в строке {line}, которую некоторые стойки не исполняют"
            ),
            Why::Probe => both!("the probe move in line {line}", "после движения щупа в строке {line}"),
            Why::Miscellaneous { code, changes_tool: true } => {
                both!(
                    "the tool change M{code} in line {line}",
                    "после смены инструмента M{code} в строке {line}"
                )
            }
            Why::Miscellaneous { code, changes_tool: false } => {
                both!("M{code} in line {line}", "после M{code} в строке {line}")
            }
            Why::Call => both!("the call in line {line}", "после вызова в строке {line}"),
            Why::BlockDelete => {
                both!(
                    "line {line}, which moves or not, depending on the block delete switch",
                    "со строки {line}: движется ли она, зависит от переключателя пропуска кадров"
                )
            }
            Why::ToolLength => {
                both!(
                    "the tool length changed in line {line}, for which some controls move the axis at once",
                    "с тех пор как в строке {line} сменилась коррекция на длину: некоторые стойки тут же перемещают ось"
                )
            }
            Why::ToolOffset => {
                both!("D chose a tool offset in line {line}", "после корректора D в строке {line}")
            }
            Why::MachineWords => both!("G53 in line {line}", "после G53 в строке {line}"),
            Why::Frame => {
                both!("the frame changed in line {line}", "после смены системы координат в строке {line}")
            }
            Why::Kinematics => both!(
                "tool centre point control was switched in line {line}",
                "после переключения управления по вершине инструмента в строке {line}"
            ),
            Why::TiltedPlane => {
                both!("the tilted plane in line {line}", "после наклонной плоскости в строке {line}")
            }
            Why::Units => both!("the unit changed in line {line}", "после смены единицы в строке {line}"),
        }
    }
}
