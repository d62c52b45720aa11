//! Codes that move the frame: G10, G52, G92 and their like, G68, G51, G51.1.
//!
//! All of them end in [`toolpath::Frame`]: axis = T(word) + zero + shifts + tool length, T being the
//! rotation, scaling or mirror in force. What a manual leaves open is refused.

use diagnostic::{Text, both};
use nc_syntax::dialect::{Action, FramePart, GCode, OffsetL20};
use nc_syntax::{Dialect, Span};
use toolpath::{Frame, Kinematics};

use crate::codes;
use crate::modal::{Compensation, Distance, Modal, Units, WorkOffset};
use crate::position::{increment_base, require_frame};
use crate::settings::{BASE_FRAME, Demand, Environment};
use crate::tool_length;
use crate::transform::Transform;
use crate::words::{
    ARC_LETTERS, AXIS_LETTERS, CENTRE_LETTERS, LINEAR, LINEAR_LETTERS, Outcome, ROTARY_LETTERS, Refusal,
    SECONDARY_LETTERS, Words,
};
use crate::{swivel, tilted};
use nc_syntax::Letters;

const P: Letters = Letters::of(b"P");
const R: Letters = Letters::of(b"R");
const L: Letters = Letters::of(b"L");

/// Makes the frame of the settings, where they give one.
pub(crate) fn refresh(state: &mut Modal) {
    let applied = state.tool_length.applied_mm();
    state.frame = state.work_offset.zero_mm.and_then(|zero| {
        let shifts = state.shifts;
        let shift = |i: usize| zero[i] + applied[i] + (shifts.local_mm[i] + shifts.preset_mm[i]);
        if let Kinematics::Plane(_) = state.kinematics {
            // Where the plane lies in the workpiece is part of it.
            return Some(Frame::shift(applied));
        }
        state.transform.frame([0, 1, 2].map(shift))
    });
}

/// The name of a numbered work offset.
pub(crate) fn numbered(number: u32) -> String {
    format!("G54.1P{number}")
}

/// The name of a work offset that H numbers.
pub(crate) fn by_h(code: GCode, number: u32) -> String {
    format!("{code}H{number}")
}

/// Executes a code whose words move the frame; says whether they state where the axes stand.
pub(crate) fn execute(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    demand: &Demand<'_>,
    before: &Modal,
    state: &mut Modal,
) -> Outcome<bool> {
    let (Some(action), Some(span)) = (demand.frame, demand.owner_span) else { return Ok(false) };
    if let Some(motion) = demand.written_motion {
        let message =
            both!("{} and {} in one block", "{} и {} в одном кадре", words.text(span), words.text(motion));
        return Err(words
            .refuse(
                codes::FRAME,
                message,
                span,
                both!(
                    "moves the frame: before or after the motion?",
                    "смещает систему координат: до движения или после?"
                ),
            )
            .help(both!("write the two codes in two blocks", "напишите эти две функции двумя кадрами")));
    }
    if words.has(ROTARY_LETTERS.or(SECONDARY_LETTERS)) {
        let letters = ROTARY_LETTERS.or(SECONDARY_LETTERS);
        let message = both!(
            "{} shifts an axis that is not X, Y or Z",
            "{} смещает ось, которая не X, не Y и не Z",
            words.text(span)
        );
        return Err(words
            .refuse(
                codes::FRAME,
                message,
                words.span(letters),
                both!("no offset of such an axis is known", "смещения такой оси неизвестны"),
            )
            .help(both!(
                "remove the word where it is zero; else set the offset on the control",
                "уберите слово, если оно нулевое; иначе задайте смещение на стойке"
            )));
    }
    if [before, state].iter().any(|state| state.compensation != Compensation::Off) {
        return Err(refuse(
            words,
            span,
            &both!("under cutter compensation", "при коррекции на радиус"),
            both!("the compensated path jumps with it", "эквидистанта скачком сместилась бы вместе с ней"),
        )
        .help(both!(
            "cancel the compensation with G40 before it",
            "отмените перед ней коррекцию функцией G40"
        )));
    }
    if state.cycle.is_some() {
        return Err(refuse(
            words,
            span,
            &both!("while a drilling cycle is in force", "во время цикла сверления"),
            both!("a cycle is running here", "здесь действует цикл"),
        )
        .help(both!(
            "cancel the cycle with G80 before, and write it again with R and Z afterwards",
            "отмените цикл до этого функцией G80, а после напишите его снова, с R и Z"
        )));
    }
    if before.work_offset != state.work_offset || before.tool_length != state.tool_length {
        return Err(refuse(
            words,
            span,
            &both!("beside another offset", "рядом с другим смещением"),
            both!("in which order? controls differ", "в каком порядке? у стоек по-разному"),
        )
        .help(both!("write the two codes in two blocks", "напишите эти две функции двумя кадрами")));
    }
    let turns = matches!(
        action,
        Action::RotationOn
            | Action::ScalingOn
            | Action::MirrorOn
            | Action::MirrorOff
            | Action::ProgramFrame { .. }
    );
    if !turns && !state.transform.is_none() {
        let under = both!("under {}", "при действующем преобразовании ({:#})", state.transform.name());
        return Err(refuse(
            words,
            span,
            &under,
            both!(
                "its words may be turned, scaled or not",
                "её слова могут быть повёрнуты и масштабированы, а могут и нет"
            ),
        )
        .help(both!(
            "cancel the rotation, scaling or mirror before it",
            "отмените перед этим поворот, масштабирование или зеркальное отображение"
        )));
    }
    let mut states_position = false;
    match action {
        Action::LocalShift => local_shift(env, words, span, state)?,
        Action::Preset => {
            states_position = true;
            preset(env, words, span, state)?;
        }
        Action::PresetCancel => cancel_preset(env, words, span, state)?,
        Action::PresetSuspend | Action::PresetRestore => {
            no_words(words, span)?;
            if *action == Action::PresetSuspend {
                state.shifts.kept_mm = Some(state.shifts.preset_mm);
                state.shifts.preset_mm = [0.0; 3];
            } else {
                let Some(kept) = state.shifts.kept_mm else {
                    return Err(refuse(
                        words,
                        span,
                        &both!("without a shift of this program", "без сдвига в этой программе"),
                        both!(
                            "brings back what an earlier program left",
                            "возвращает то, что осталось от прежней программы"
                        ),
                    )
                    .help(both!(
                        "write the shift with G92 or G52, or use a work offset",
                        "задайте сдвиг функцией G92 или G52 или возьмите смещение нуля"
                    )));
                };
                state.shifts.preset_mm = kept;
            }
        }
        Action::WriteOffset => states_position = write_offset(env, words, span, state)?,
        Action::RotationOn | Action::ScalingOn | Action::MirrorOn => {
            let transform = transform(env, words, span, action, state)?;
            unsettle(state, transform);
        }
        Action::MirrorOff => mirror_off(words, span, state)?,
        Action::ProgramFrame { part, adds } => program_frame(words, span, *part, *adds, state)?,
        Action::TiltedPlane => tilted::define(env, words, span, state)?,
        Action::DynamicOffset => tilted::follow(env, words, span, state)?,
        Action::AlignTool => tilted::align(env, words, span, state)?,
        Action::Swivel => swivel::execute(env, words, span, state)?,
        _ => {}
    }
    refresh(state);
    Ok(states_position)
}

/// Puts a transformation in force; the axes it touches, or touched, must be said anew.
pub(crate) fn unsettle(state: &mut Modal, transform: Transform) {
    let (was, is) = (state.transform.touches(), transform.touches());
    (0..3).for_each(|i| state.unsettled[i] |= was[i] || is[i]);
    state.transform = transform;
}

/// The first motion after a change of rotation, scaling or mirror says where it goes in all axes that
/// were touched, in G90: what a left-out axis or an increment starts from differs between controls.
pub(crate) fn settle(words: &Words<'_, '_, '_>, state: &mut Modal) -> Outcome<()> {
    if state.unsettled == [false; 3] {
        return Ok(());
    }
    let open = Letters::of_axes(state.unsettled);
    // An increment beside them is refused too: its start would have to be said.
    if !words.has(open) && (state.distance == Distance::Absolute || !words.has(AXIS_LETTERS)) {
        return Ok(());
    }
    if state.distance == Distance::Absolute && words.letters.and(open) == open {
        state.unsettled = [false; 3];
        return Ok(());
    }
    let names = open.names();
    let message = both!(
        "the first motion after a rotation, scaling or mirror was switched must be absolute and whole",
        "первое движение после смены поворота, масштаба или зеркального отображения должно быть абсолютным и полным"
    );
    let label = both!(
        "{names} were expected, in G90: controls differ in where they start otherwise",
        "ожидались {names} при G90: откуда иначе начинать, у стоек по-разному"
    );
    Err(words
        .refuse(codes::FRAME, message, words.span(AXIS_LETTERS), label)
        .help(both!("write {names} in this block, in G90", "напишите {names} в этом кадре, при G90")))
}

fn refuse(words: &Words<'_, '_, '_>, span: Span, what: &Text, label: Text) -> Refusal {
    words.refuse(codes::FRAME, both!("{} {what}", "{} {what:#}", words.text(span)), span, label)
}

fn no_words(words: &Words<'_, '_, '_>, span: Span) -> Outcome<()> {
    let letters = AXIS_LETTERS.or(ARC_LETTERS);
    if words.has(letters) {
        let message = both!("{} takes no words", "{} не принимает слов", words.text(span));
        return Err(words
            .refuse(codes::FRAME, message, words.span(letters), both!("whose are they?", "чьи они?"))
            .help(both!("write them in a block of their own", "напишите их отдельным кадром")));
    }
    Ok(())
}

/// Words of X, Y, Z in mm; at least one.
fn shift_words(words: &Words<'_, '_, '_>, span: Span, state: &Modal) -> Outcome<[Option<f64>; 3]> {
    if words.has(ARC_LETTERS) {
        let message =
            both!("{} takes no {}", "{} не принимает {}", words.text(span), words.names(ARC_LETTERS));
        return Err(words
            .refuse(
                codes::FRAME,
                message,
                words.span(ARC_LETTERS),
                both!("X, Y and Z were expected", "ожидались X, Y и Z"),
            )
            .help(both!("remove the word", "уберите слово")));
    }
    if !words.has(LINEAR_LETTERS) {
        return Err(refuse(
            words,
            span,
            &both!("without X, Y or Z", "без X, Y и Z"),
            both!("shifts what, by how much?", "смещает что и насколько?"),
        )
        .help(both!(
            "write the axes and their values, or remove the code",
            "напишите оси и их значения или уберите функцию"
        )));
    }
    let inch = state.units == Units::Inch;
    Ok(LINEAR.map(|letter| words.coordinate(letter, inch).map(|value| value * state.units.mm())))
}

pub(crate) fn absolute(words: &Words<'_, '_, '_>, span: Span, state: &Modal) -> Outcome<()> {
    if state.distance == Distance::Incremental {
        return Err(refuse(
            words,
            span,
            &both!("under G91", "при G91"),
            both!("added or set? controls differ", "прибавить или установить? у стоек по-разному"),
        )
        .help(both!("write G90 before it", "напишите перед ней G90")));
    }
    Ok(())
}

/// G52: the words are the shift; LinuxCNC keeps it where it keeps G92's.
fn local_shift(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    state: &mut Modal,
) -> Outcome<()> {
    absolute(words, span, state)?;
    let shift = shift_words(words, span, state)?;
    let one = env.dialect.frames.local_is_preset;
    if !one && state.shifts.preset_mm != [0.0; 3] {
        return Err(refuse(
            words,
            span,
            &both!("after G92", "после G92"),
            both!(
                "whether the two shifts add up depends on the control",
                "складываются ли два сдвига, зависит от стойки"
            ),
        )
        .help(both!("use one of the two", "обойдитесь одним из двух")));
    }
    let target = if one { &mut state.shifts.preset_mm } else { &mut state.shifts.local_mm };
    for i in 0..3 {
        target[i] = shift[i].unwrap_or(target[i]);
    }
    if one {
        state.shifts.kept_mm = Some(state.shifts.preset_mm);
    }
    Ok(())
}

/// Program coordinate of an axis whose position must be known, mm; no transformation is in force.
fn stands_at(env: &Environment<'_>, words: &Words<'_, '_, '_>, state: &Modal, axis: usize) -> Outcome<f64> {
    let frame = require_frame(env, words, state)?;
    Ok(increment_base(words, state.axes.linear[axis], axis)? - frame.offset_mm()[axis])
}

/// G92: the frame moves so that the axes stand at the words.
fn preset(env: &Environment<'_>, words: &Words<'_, '_, '_>, span: Span, state: &mut Modal) -> Outcome<()> {
    let wanted = shift_words(words, span, state)?;
    let rules = &env.dialect.frames;
    if !rules.local_is_preset && state.shifts.local_mm != [0.0; 3] {
        return Err(refuse(
            words,
            span,
            &both!("after G52", "после G52"),
            both!(
                "whether the two shifts add up depends on the control",
                "складываются ли два сдвига, зависит от стойки"
            ),
        )
        .help(both!("use one of the two", "обойдитесь одним из двух")));
    }
    if !rules.local_is_preset && state.tool_length.applied_mm() != [0.0; 3] {
        return Err(refuse(
            words,
            span,
            &both!("with a tool length in force", "при действующей коррекции на длину"),
            both!(
                "with or without the length? a parameter decides",
                "с учётом длины или без него? решает параметр"
            ),
        )
        .help(both!(
            "write G49 before it, or use a work offset",
            "напишите перед ней G49 или возьмите смещение нуля"
        )));
    }
    let mut preset = state.shifts.preset_mm;
    for i in 0..3 {
        if let Some(value) = wanted[i] {
            preset[i] += stands_at(env, words, state, i)? - value;
        }
    }
    state.shifts.preset_mm = preset;
    state.shifts.kept_mm = Some(preset);
    Ok(())
}

/// A shift below this is none, mm: where G92 says that the axes stand where they do, the last bits may differ.
const NO_SHIFT_MM: f64 = 1e-9;

/// G92.1: with words on Fanuc, where it also ends G52; without on LinuxCNC.
fn cancel_preset(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    state: &mut Modal,
) -> Outcome<()> {
    if env.dialect.frames.local_is_preset {
        no_words(words, span)?;
        state.shifts.preset_mm = [0.0; 3];
        state.shifts.kept_mm = Some([0.0; 3]);
        return Ok(());
    }
    let shifts = [state.shifts.preset_mm, state.shifts.local_mm];
    let shifted = shifts.iter().flatten().any(|shift| shift.abs() > NO_SHIFT_MM);
    if !words.has(LINEAR_LETTERS) && shifted {
        return Err(refuse(
            words,
            span,
            &both!("without axes", "без осей"),
            both!("which axes lose their shift?", "у каких осей снимается сдвиг?"),
        )
        .help(both!("write X0 Y0 Z0 beside it", "напишите рядом X0 Y0 Z0")));
    }
    for (i, letter) in LINEAR.into_iter().enumerate() {
        if words.has(Letters::of(&[letter])) {
            state.shifts.preset_mm[i] = 0.0;
            state.shifts.local_mm[i] = 0.0;
        }
    }
    Ok(())
}

/// G10 L2 and L20; true where its words state where the axes stand.
fn write_offset(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    state: &mut Modal,
) -> Outcome<bool> {
    let l = words.whole(b'L')?;
    if let (Some(l @ 10..=13), true) = (l, env.dialect.writes_lengths) {
        tool_length::write(words, span, l, state)?;
        return Ok(false);
    }
    if !matches!(l, Some(2 | 20)) {
        let at = if words.has(L) { words.span(L) } else { span };
        return Err(words
            .refuse(codes::FRAME, both!("{} that writes no work offset", "{} записывает не смещение нуля", words.text(span)), at, both!("L2 or L20 was expected", "ожидалось L2 или L20"))
            .help(both!("tool tables and parameters: set them on the control, give lengths with --tool, and delete the block", "таблицы инструментов и параметры задайте на стойке, длины дайте ключом --tool, а кадр удалите")));
    }
    if words.has(R) {
        return Err(words
            .refuse(
                codes::FRAME,
                both!("a work offset with a rotation", "смещение нуля с поворотом"),
                words.span(R),
                both!("turns the frame", "поворачивает систему координат"),
            )
            .help(both!(
                "rotate in the CAM, or align the workpiece, and remove R",
                "поверните в CAM или выставьте деталь и уберите R"
            )));
    }
    let Some(p) = words.whole(b'P')? else {
        return Err(refuse(
            words,
            span,
            &both!("without P", "без P"),
            both!("which work offset?", "какое смещение нуля?"),
        )
        .help(both!("write P1 for G54, P2 for G55", "напишите P1 для G54, P2 для G55")));
    };
    let values = shift_words(words, span, state)?;
    let rules = &env.dialect.frames;
    let by_position = l == Some(20) && rules.l20 == OffsetL20::Position;
    let name = match (l, p) {
        (Some(20), _) if !by_position => numbered(p),
        (_, 0) if rules.l20 == OffsetL20::Position => match name_of(env.dialect, &state.work_offset) {
            Some(name) => name,
            None => {
                return Err(refuse(
                    words,
                    span,
                    &both!("without a work offset in force", "без действующего смещения нуля"),
                    both!("P0 is the one in force", "P0 — то, которое действует"),
                )
                .help(both!("write P1 for G54, or G54 before it", "напишите P1 для G54 или G54 перед ней")));
            }
        },
        (_, 0) => {
            return Err(words
                .refuse(
                    codes::FRAME,
                    both!("writes the external work offset", "записывает внешнее смещение нуля"),
                    words.span(P),
                    both!("shifts all work offsets", "смещает все смещения нуля"),
                )
                .help(both!(
                    "add it to the work offsets, which P1 to P6 write",
                    "прибавьте его к смещениям нуля, которые записывают P1–P6"
                )));
        }
        (_, p) => match offset_of_number(env, p) {
            Some(name) => name,
            None => {
                let message = both!("there is no work offset P{p}", "смещения нуля P{p} нет");
                return Err(words
                    .refuse(
                        codes::FRAME,
                        message,
                        words.span(P),
                        both!("P1 is G54, P2 is G55 and so on", "P1 — это G54, P2 — G55 и так далее"),
                    )
                    .help(both!(
                        "write the number of a work offset of this control",
                        "напишите номер смещения нуля этой стойки"
                    )));
            }
        },
    };
    let old = offset(env, state, &name);
    let active = name_of(env.dialect, &state.work_offset).as_deref() == Some(name.as_str());
    let mut zero = [0.0; 3];
    for i in 0..3 {
        // Fanuc adds under G91; LinuxCNC never does.
        let adds = state.distance == Distance::Incremental && rules.l20 == OffsetL20::Numbered;
        zero[i] = match (values[i], old) {
            (Some(value), _) if by_position => {
                let tool = state.tool_length.applied_mm()[i];
                increment_base(words, state.axes.linear[i], i)? - tool - state.shifts.preset_mm[i] - value
            }
            (Some(value), Some(old)) if adds => old[i] + value,
            (Some(value), _) if !adds => value,
            (None, Some(old)) => old[i],
            _ => {
                let message = both!(
                    "work offset {name} is written in part, and the rest is not given",
                    "смещение нуля {name} записано частично, а остальное не задано"
                );
                return Err(words
                    .refuse(
                        codes::WORK_OFFSET,
                        message,
                        span,
                        both!(
                            "the axes left out keep what nobody said",
                            "у опущенных осей остаётся то, чего никто не сказал"
                        ),
                    )
                    .help(both!(
                        "write X, Y and Z here, or give it with `--work-offset {name}=X,Y,Z`",
                        "напишите здесь X, Y и Z или задайте его ключом `--work-offset {name}=X,Y,Z`"
                    )));
            }
        };
    }
    match state.written.iter_mut().find(|(known, _)| *known == name) {
        Some(entry) => entry.1 = zero,
        None => state.written.push((name, zero)),
    }
    if active {
        // LinuxCNC takes it at once. Where that is not certain, no motion until the offset is chosen again.
        state.work_offset.zero_mm = (rules.l20 == OffsetL20::Position).then_some(zero);
        state.work_offset.rewritten = rules.l20 != OffsetL20::Position;
    }
    Ok(by_position)
}

/// The zero of a work offset: what the program wrote, else what was given.
pub(crate) fn offset(env: &Environment<'_>, state: &Modal, name: &str) -> Option<[f64; 3]> {
    let written = state.written.iter().find(|(known, _)| known == name).map(|(_, zero)| *zero);
    written.or_else(|| env.setup.work_offset(name))
}

/// The name of a work offset as profiles have it: `G54`, `G54.1 P3`.
#[must_use]
pub fn name_of(dialect: &Dialect, offset: &WorkOffset) -> Option<String> {
    let WorkOffset { code, number, .. } = *offset;
    match (number, dialect.code(code?).map(|entry| &entry.action)) {
        (Some(number), Some(Action::WorkOffsetByH)) => Some(by_h(code?, number)),
        (Some(number), _) => Some(numbered(number)),
        (None, Some(Action::WorkOffset(name))) => Some(name.clone()),
        (None, Some(Action::BaseFrame)) => Some(BASE_FRAME.to_owned()),
        _ => None,
    }
}

/// TRANS, ROT, MIRROR and their additive forms (840D Programming Manual Fundamentals, chapter Coordinate
/// transformations): place = work offset + shift + T·words, the shift along the work offset's axes.
///
/// One that does not add takes the place of all that were in force; an additive one works in the frame that they make.
fn program_frame(
    words: &Words<'_, '_, '_>,
    span: Span,
    part: FramePart,
    adds: bool,
    state: &mut Modal,
) -> Outcome<()> {
    let allowed = match part {
        FramePart::Rotation => AXIS_LETTERS.or(L),
        FramePart::Shift | FramePart::Mirror => LINEAR_LETTERS,
    };
    let others = words.letters.without(allowed).without(Letters::of(b"NO"));
    if words.has(others) || !words.codes.is_empty() || !words.m_codes.is_empty() {
        let at = if words.has(others) { words.span(others) } else { span };
        return Err(words
            .refuse(
                codes::FRAME,
                both!("{} beside something else", "{} рядом с чем-то ещё", words.text(span)),
                at,
                both!("a block of its own was expected", "ожидался отдельный кадр"),
            )
            .help(both!("write it in a block of its own", "напишите её отдельным кадром")));
    }
    let none = !words.has(allowed);
    if none && adds {
        return Err(refuse(
            words,
            span,
            &both!("without words", "без слов"),
            both!("adds what to the frame?", "что прибавить к системе координат?"),
        )
        .help(both!(
            "write the axes and their values, or remove it",
            "напишите оси и их значения или уберите её"
        )));
    }
    let (mut shift, mut transform) =
        if adds { (state.shifts.local_mm, state.transform) } else { ([0.0; 3], Transform::None) };
    match part {
        _ if none => {}
        FramePart::Shift => {
            let by = shift_words(words, span, state)?.map(|mm| mm.unwrap_or(0.0));
            // Along the axes that the frame in force has.
            let turned =
                transform.frame([0.0; 3]).map(|frame| (frame.to_machine(by), frame.to_machine([0.0; 3])));
            let Some((end, start)) = turned else {
                return Err(refuse(
                    words,
                    span,
                    &both!("in a frame without inverse", "в необратимой системе координат"),
                    both!("leads nowhere", "никуда не ведёт"),
                )
                .help(both!(
                    "cancel the frame with TRANS alone before it",
                    "отмените перед этим систему координат: TRANS отдельным кадром"
                )));
            };
            (0..3).for_each(|i| shift[i] += end[i] - start[i]);
        }
        FramePart::Rotation => {
            let angle = rotation_words(words, span, state)?;
            let before = match transform {
                Transform::None => 0.0,
                Transform::Rotation { plane, angle_deg, .. } if plane == state.plane => angle_deg,
                _ => return Err(in_which_order(words, span, &transform)),
            };
            let angle_deg = before + angle;
            transform = Transform::Rotation { plane: state.plane, centre_mm: [0.0; 2], angle_deg };
        }
        FramePart::Mirror => {
            let mut about = match transform {
                Transform::None => [None; 3],
                Transform::Mirror(about) => about,
                _ => return Err(in_which_order(words, span, &transform)),
            };
            for i in 0..3 {
                let Some(value) = words.coordinate(LINEAR[i], false) else { continue };
                if value != 0.0 {
                    let at = words.span(Letters::of(&[LINEAR[i]]));
                    return Err(words
                        .refuse(
                            codes::FRAME,
                            both!(
                                "a mirror about a place that is not zero",
                                "зеркальное отображение не относительно нуля"
                            ),
                            at,
                            both!("0 was expected", "ожидался 0"),
                        )
                        .help(both!(
                            "shift the zero with ATRANS before it, and write 0",
                            "сместите перед ним нуль командой ATRANS и напишите 0"
                        )));
                }
                // Twice is none.
                about[i] = if about[i].is_some() { None } else { Some(0.0) };
            }
            transform = if about == [None; 3] { Transform::None } else { Transform::Mirror(about) };
        }
    }
    state.shifts.local_mm = shift;
    if transform != state.transform {
        unsettle(state, transform);
    }
    Ok(())
}

fn in_which_order(
    words: &Words<'_, '_, '_>,
    span: Span,
    transform: &Transform,
) -> Box<diagnostic::Diagnostic> {
    let under = both!("under {}", "при действующем преобразовании ({:#})", transform.name());
    refuse(words, span, &under, both!("the two together are neither", "вместе они ни то, ни другое"))
        .help(both!("write one of the two in the CAM", "выполните одно из двух в CAM"))
}

/// The angle of ROT in the plane, degrees: `RPL=`, or the word of the axis that stands upright on the plane.
fn rotation_words(words: &Words<'_, '_, '_>, span: Span, state: &Modal) -> Outcome<f64> {
    let normal = LINEAR[state.plane.axes()[2]];
    let out = words.letters.and(AXIS_LETTERS).without(Letters::of(&[normal]));
    if !out.is_empty() {
        return Err(words
            .refuse(
                codes::FRAME,
                both!("a rotation out of the plane", "поворот из плоскости"),
                words.span(out),
                both!("tilts the frame", "наклоняет систему координат"),
            )
            .help(both!("post without tilted planes", "выводите программу без наклонных плоскостей")));
    }
    // RPL= is a word of L.
    match (words.coordinate(b'L', false), words.coordinate(normal, false)) {
        (Some(angle), None) | (None, Some(angle)) => Ok(angle),
        _ => Err(refuse(
            words,
            span,
            &both!("by two angles", "с двумя углами"),
            both!("RPL= or the plane's normal was expected", "ожидалось RPL= или нормаль плоскости"),
        )
        .help(both!("write RPL= alone", "напишите одно RPL="))),
    }
}

/// G10's P: the work offset codes of the table in order, G54 being the first.
fn offset_of_number(env: &Environment<'_>, p: u32) -> Option<String> {
    let mut names = env.dialect.codes.iter().filter_map(|entry| match &entry.action {
        Action::WorkOffset(name) => Some(name),
        _ => None,
    });
    names.nth(usize::try_from(p).ok()?.checked_sub(1)?).cloned()
}

/// G68, G51, G51.1.
fn transform(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    action: &Action,
    state: &Modal,
) -> Outcome<Transform> {
    absolute(words, span, state)?;
    let again = matches!((action, state.transform), (Action::MirrorOn, Transform::Mirror(_)));
    if !state.transform.is_none() && !again {
        let under = both!("under {}", "при действующем преобразовании ({:#})", state.transform.name());
        return Err(refuse(
            words,
            span,
            &under,
            both!(
                "in which order? controls and parameters differ",
                "в каком порядке? зависит от стойки и её параметров"
            ),
        )
        .help(both!(
            "cancel the one before it, or do one of the two in the CAM",
            "отмените перед ней прежнюю или выполните одно из двух в CAM"
        )));
    }
    let inch = state.units == Units::Inch;
    let unit_mm = state.units.mm();
    let at = |letter: u8| words.coordinate(letter, inch).map(|value| value * unit_mm);
    match action {
        Action::RotationOn => {
            let [u, v, n] = state.plane.axes();
            let across = CENTRE_LETTERS.or(Letters::of(&[LINEAR[n]]));
            if words.has(across) {
                return Err(words
                    .refuse(
                        codes::FRAME,
                        both!("a rotation out of the plane", "поворот из плоскости"),
                        words.span(across),
                        both!("tilts the frame", "наклоняет систему координат"),
                    )
                    .help(both!("select the plane with G17, G18 or G19; post tilted planes as plain axes", "выберите плоскость функцией G17, G18 или G19; наклонные плоскости выводите обычными осями")));
            }
            let (Some(first), Some(second)) = (at(LINEAR[u]), at(LINEAR[v])) else {
                let names = Letters::of(&[LINEAR[u], LINEAR[v]]).names();
                let message = both!("a rotation without {names}", "поворот без {names}");
                return Err(words
                    .refuse(codes::FRAME, message, span, both!("about which point?", "вокруг какой точки?"))
                    .help(both!("write {names} of the centre, and R", "напишите {names} центра и R")));
            };
            let Some(angle_deg) = words.coordinate(b'R', false) else {
                return Err(words
                    .refuse(
                        codes::FRAME,
                        both!("a rotation without R", "поворот без R"),
                        span,
                        both!("by a parameter's angle", "на угол из параметра"),
                    )
                    .help(both!("write the angle as R", "напишите угол словом R")));
            };
            Ok(Transform::Rotation { plane: state.plane, centre_mm: [first, second], angle_deg })
        }
        Action::ScalingOn => {
            let (Some(x), Some(y), Some(z)) = (at(b'X'), at(b'Y'), at(b'Z')) else {
                return Err(words
                    .refuse(
                        codes::FRAME,
                        both!("a scaling without X, Y and Z", "масштабирование без X, Y и Z"),
                        span,
                        both!("about which point?", "вокруг какой точки?"),
                    )
                    .help(both!("write X, Y and Z of the centre", "напишите X, Y и Z центра")));
            };
            let factor = |letter: u8| {
                let (number, _) = words.number(letter)?;
                let step = if number.has_point { 1.0 } else { env.dialect.frames.scaling_step };
                Some(number.decimal.to_f64() * step)
            };
            let factors = match (factor(b'P'), [b'I', b'J', b'K'].map(factor)) {
                (Some(p), [None, None, None]) if p > 0.0 => [p; 3],
                (None, [Some(i), Some(j), Some(k)]) if i * j * k != 0.0 => [i, j, k],
                _ => {
                    return Err(words
                        .refuse(
                            codes::FRAME,
                            both!("a scaling without its factor", "масштабирование без коэффициента"),
                            span,
                            both!("P above zero, or I, J and K, were expected", "ожидалось P больше нуля или I, J и K"),
                        )
                        .help(both!("write P2. to double; negative factors are mirrors: G51.1", "напишите P2., чтобы удвоить; отрицательный коэффициент — это зеркальное отображение: G51.1")));
                }
            };
            Ok(Transform::Scaling { centre_mm: [x, y, z], factors })
        }
        _ => {
            let about = shift_words(words, span, state)?;
            let mut all = if let Transform::Mirror(all) = state.transform { all } else { [None; 3] };
            for i in 0..3 {
                if about[i].is_some() && all[i].is_some() {
                    let message = both!("{} is mirrored already", "{} уже отражена", LINEAR[i] as char);
                    return Err(words
                        .refuse(
                            codes::FRAME,
                            message,
                            span,
                            both!("twice, or anew? controls differ", "дважды или заново? у стоек по-разному"),
                        )
                        .help(both!(
                            "cancel the mirror with G50.1 before it",
                            "отмените перед этим зеркальное отображение функцией G50.1"
                        )));
                }
                all[i] = about[i].or(all[i]);
            }
            Ok(Transform::Mirror(all))
        }
    }
}

/// G50.1: the axes named are no longer mirrored.
fn mirror_off(words: &Words<'_, '_, '_>, span: Span, state: &mut Modal) -> Outcome<()> {
    let Transform::Mirror(mut about) = state.transform else { return Ok(()) };
    if !words.has(LINEAR_LETTERS) {
        return Err(refuse(
            words,
            span,
            &both!("without axes", "без осей"),
            both!("which axes are no longer mirrored?", "какие оси больше не отражать?"),
        )
        .help(both!(
            "write the mirrored axes beside it, as in G50.1 X0 Y0",
            "напишите рядом отражённые оси, например G50.1 X0 Y0"
        )));
    }
    for i in 0..3 {
        if words.has(Letters::of(&[LINEAR[i]])) {
            about[i] = None;
        }
    }
    let rest = if about == [None; 3] { Transform::None } else { Transform::Mirror(about) };
    unsettle(state, rest);
    Ok(())
}
