//! T, H, G43, G44, G49 and G43.1: which tool length is in force.

use diagnostic::{Entry, Text, both, refusal};
use nc_dialect::{LengthAfter, LengthAtChange, TWord, Turning};
use nc_syntax::{Letters, Span};

use crate::codes;
use crate::environment::{Demand, Environment};
use crate::frame_state::refresh;
use crate::modal::{Distance, Modal, MotionMode, ToolLength, Units, WrittenLength};
use crate::offset::compensated;
use crate::refusals::tool_length as refusal;
use crate::words::{
    ARC_LETTERS, AXIS_LETTERS, LINEAR, LINEAR_LETTERS, Outcome, ROTARY_LETTERS, SECONDARY_LETTERS, Words,
};

/// How the tool length is asked to change.
#[derive(Clone, Copy)]
pub(crate) enum Length {
    Off,
    On { negative: bool },
}

/// T, and the M6 that brings it into the spindle. A T that is no whole number selects nothing known.
pub(crate) fn tool(env: &Environment<'_>, words: &Words<'_, '_, '_>, state: &mut Modal) -> Outcome<()> {
    const T: Letters = Letters::of(b"T");
    if words.has(T) && env.dialect.turning.as_ref().is_some_and(|turning| turning.offset_in_t) {
        return turret(env, words, state);
    }
    if env.dialect.turning.as_ref().is_some_and(|turning| turning.offset_in_d) {
        return edge(env, words, state);
    }
    if env.dialect.edge_in_d {
        return edge_of_loaded(env, words, state);
    }
    if words.has(T) {
        if env.dialect.t_word == TWord::MayChange {
            return Err(words.refuse_code(refusal::MAY_CHANGE_TOOL_AT_ONCE, words.span(T)));
        }
        state.tool_selected = words.whole(b'T').ok().flatten();
    }
    if let Some((_, span)) = env.tool_change(words) {
        state.tool_loaded = state.tool_selected;
        let at_change = env.dialect.length_at_change;
        match (env.setup.t_means_h || at_change == LengthAtChange::LoadedTool, state.tool_loaded) {
            (true, Some(tool)) => return take(env, words, span, tool, state),
            (true, None) if at_change == LengthAtChange::LoadedTool => return Err(no_tool(words, span)),
            _ => state.edge_unsaid |= at_change == LengthAtChange::Unsaid,
        }
    }
    Ok(())
}

/// The tool that comes in has no number.
fn no_tool(words: &Words<'_, '_, '_>, span: Span) -> Box<diagnostic::Diagnostic> {
    words.refuse(refusal::NO_TOOL_CALLED, span)
}

/// T of a turret: tool and offset in one number, `T0101`; offset 00 is none.
fn turret(env: &Environment<'_>, words: &Words<'_, '_, '_>, state: &mut Modal) -> Outcome<()> {
    const T: Letters = Letters::of(b"T");
    let span = words.span(T);
    let Some((number, digits)) = words
        .whole(b'T')?
        .zip(words.number(b'T'))
        .map(|(number, (_, span))| (number, words.text(span).bytes().filter(u8::is_ascii_digit).count()))
    else {
        return Ok(());
    };
    if !(3..=4).contains(&digits) {
        return Err(words.refuse_code(refusal::NOT_A_TOOL_AND_ITS_OFFSET, span));
    }
    state.tool_selected = Some(number / 100);
    state.tool_loaded = state.tool_selected;
    take(env, words, span, number % 100, state)
}

/// T and D of Sinumerik: T brings in its tool with the first edge, D1 is that edge, D0 none.
fn edge(env: &Environment<'_>, words: &Words<'_, '_, '_>, state: &mut Modal) -> Outcome<()> {
    const T: Letters = Letters::of(b"T");
    const D: Letters = Letters::of(b"D");
    if !words.has(T.or(D)) {
        return Ok(());
    }
    if let Some(tool) = words.whole(b'T')? {
        state.tool_selected = Some(tool);
        state.tool_loaded = Some(tool);
    }
    let span = words.span(T.or(D));
    match (words.whole(b'D')?, state.tool_loaded) {
        (Some(0), _) | (None, Some(0)) => take(env, words, span, 0, state),
        (None | Some(1), Some(tool)) => take(env, words, span, tool, state),
        (_, None) => Err(words.refuse(refusal::OFFSET_OF_TOOL_NOT_CALLED, span)),
        (Some(edge), Some(_)) => Err(further_edge(words, edge, span)),
    }
}

/// T, M6 and D of a mill's Sinumerik: T selects, M6 brings in, D1 is the offset of the tool that is in, D0 none.
///
/// Which edge M6 brings in where no D stands behind it is the control's affair (MD20270); until one is said, or the
/// setup says it, nothing moves in program coordinates ([`edge_is_said`]).
fn edge_of_loaded(env: &Environment<'_>, words: &Words<'_, '_, '_>, state: &mut Modal) -> Outcome<()> {
    const T: Letters = Letters::of(b"T");
    const D: Letters = Letters::of(b"D");
    if words.has(T) {
        state.tool_selected = match words.quoted(b'T') {
            Some(name) => Some(named(env, words, words.span(T), &name)?),
            None => words.whole(b'T')?,
        };
        // Before the first M6 it may be that T changes the tool itself (MD22550 is 0).
        state.edge_unsaid |= state.tool_loaded.is_none();
    }
    let changed = env.tool_change(words).map(|(_, span)| span);
    if let Some(span) = changed {
        if state.tool_selected.is_none() {
            return Err(no_tool(words, span));
        }
        state.tool_loaded = state.tool_selected;
        state.edge_unsaid = true;
    }
    let edge = match (words.whole(b'D')?, changed, env.setup.edge_at_change) {
        // Whose edge is it that stands beside a tool which is not in yet?
        (Some(1..), None, _) if words.has(T) || state.tool_loaded.is_none() => {
            state.edge_unsaid = true;
            return Ok(());
        }
        (Some(edge), ..) | (None, Some(_), Some(edge)) => edge,
        _ => return Ok(()),
    };
    state.edge_unsaid = false;
    let span = changed.unwrap_or_else(|| words.span(D));
    match (edge, state.tool_loaded) {
        (0, _) | (_, Some(0)) => take(env, words, span, 0, state),
        (1, Some(tool)) => take(env, words, span, tool, state),
        (edge, _) => Err(further_edge(words, edge, span)),
    }
}

fn further_edge(words: &Words<'_, '_, '_>, edge: u32, span: Span) -> Box<diagnostic::Diagnostic> {
    words.refuse(refusal::further_edge(edge), span)
}

/// The number of a tool that the program calls by its name.
fn named(env: &Environment<'_>, words: &Words<'_, '_, '_>, span: Span, name: &str) -> Outcome<u32> {
    let known = env.setup.tool_names.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
    known.map(|(_, number)| *number).ok_or_else(|| words.refuse(refusal::tool_not_given(name), span))
}

/// Refuses a motion in program coordinates while nobody has said which edge of the tool counts.
#[inline]
pub(crate) fn edge_is_said(env: &Environment<'_>, words: &Words<'_, '_, '_>, state: &Modal) -> Outcome<()> {
    if !state.edge_unsaid {
        return Ok(());
    }
    if !env.dialect.edge_in_d {
        return length_is_said(words, state);
    }
    Err(words.refuse(refusal::TOOL_NOT_SAID, words.span(AXIS_LETTERS.or(ARC_LETTERS))))
}

/// The same where a code says whether the length of the tool that came in holds: a rapid beside its axis needs none.
fn length_is_said(words: &Words<'_, '_, '_>, state: &Modal) -> Outcome<()> {
    let along = Letters::of(&[LINEAR[state.plane.axes()[2]]]);
    if matches!(state.motion, MotionMode::Rapid(_)) && state.cycle.is_none() && !words.has(along) {
        return Ok(());
    }
    Err(words.refuse(refusal::LENGTH_NOT_SAID, words.span(AXIS_LETTERS.or(ARC_LETTERS))))
}

/// Brings in the offset of a number; 0 is none.
fn take(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    offset: u32,
    state: &mut Modal,
) -> Outcome<()> {
    if offset == 0 {
        state.tool_length = ToolLength::Off;
        return Ok(());
    }
    let Some(applied_mm) = env.setup.tool(offset) else {
        let turning = env.dialect.turning.as_ref();
        let refused = words.refuse(refusal::tool_offset_not_given(offset, turning), span);
        return Err(Box::new(refused.settled_by(length_entry(offset, turning))));
    };
    let length = ToolLength::On { number: offset, negative: false, applied_mm };
    bring_in(env, words, span, &both!("tool offset {offset:02}", "корректор {offset:02}"), length, state)
}

/// Brings a length into force, unless by it the tip would be at the gauge point or above it, where nobody has said from
/// where lengths count: it was touched off, and errors of angle act along the tool.
fn bring_in(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    name: &Text,
    length: ToolLength,
    state: &mut Modal,
) -> Outcome<()> {
    let asked =
        env.setup.gauge_point_mm.is_none() && env.setup.lever_matters && env.dialect.turning.is_none();
    if let Some([x, y, z]) = length.ends_mm().filter(|_| asked)
        && (z < 0.0 || [x, y, z] == [0.0; 3])
    {
        return Err(words.refuse(refusal::shifts_by_a_length(name, z), span));
    }
    state.tool_length = length;
    Ok(())
}

/// The entry of the profile that gives a length.
fn length_entry(number: u32, turning: Option<&Turning>) -> Entry {
    let value = if turning.is_some() { "[X, 0, Z]" } else { "120.0" };
    Entry::new("tool", Some("lengths_mm"), format!("H{number}"), value)
}

/// The code that ends cutter compensation, where it may end a tool length too.
pub(crate) fn under_compensation_off(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    state: &mut Modal,
) -> Outcome<()> {
    if state.tool_length.is_none() {
        return Ok(());
    }
    match env.dialect.length_under_g40 {
        LengthAfter::Stays => Ok(()),
        LengthAfter::Ends => {
            state.tool_length = ToolLength::Off;
            Ok(())
        }
        LengthAfter::Unstated => Err(words.refuse_code(refusal::WHILE_TOOL_LENGTH_IN_FORCE, span)),
    }
}

/// G43, G44, G49 and H.
///
/// H alone changes the length while G43 or G44 is in force and means nothing otherwise; G43 without H
/// takes the loaded tool where the dialect says so (there H0 does too), else the H already in force.
pub(crate) fn length(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    state: &mut Modal,
    wanted: Option<(Length, Span)>,
) -> Outcome<()> {
    const H: Letters = Letters::of(b"H");
    let (negative, span) = match (wanted, state.tool_length) {
        (Some((Length::Off, span)), in_force)
            if env.dialect.length_under_g49 == LengthAfter::Unstated
                && (!in_force.is_none() || words.has(H.or(Letters::of(b"D")))) =>
        {
            return Err(words.refuse_code(refusal::WITH_TOOL_LENGTH, span));
        }
        (Some((Length::Off, _)), _) => {
            state.tool_length = ToolLength::Off;
            return Ok(());
        }
        (Some((Length::On { negative }, span)), _) => (negative, span),
        (None, ToolLength::On { negative, .. }) if words.has(H) => (negative, words.span(H)),
        (None, _) => return Ok(()),
    };
    let (loaded, written_number) = (env.dialect.length_of_loaded_tool, words.whole(b'H')?);
    let of_tool = state.tool_loaded.filter(|_| env.setup.t_means_h && written_number != Some(0));
    let written_number = of_tool.or(written_number);
    let number = match (written_number.filter(|number| *number != 0 || !loaded), state.tool_length) {
        (Some(number), _) => number,
        (None, _) if loaded => match state.tool_loaded {
            Some(number) => number,
            None => {
                return Err(words.refuse(refusal::NO_TOOL_LOADED, span));
            }
        },
        (_, ToolLength::On { number, .. }) => number,
        (_, ToolLength::Off | ToolLength::Written { .. }) => {
            return Err(words.refuse(refusal::TOOL_LENGTH_WITHOUT_H, span));
        }
    };
    let Some(vector) = written(words, span, number, state)?.or_else(|| env.setup.tool(number)) else {
        let at = if words.has(H) { words.span(H) } else { span };
        let refused = words.refuse(refusal::tool_length_h_not_given(number), at);
        return Err(Box::new(refused.settled_by(length_entry(number, None))));
    };
    let applied_mm = if negative { vector.map(|v| -v) } else { vector };
    let length = ToolLength::On { number, negative, applied_mm };
    bring_in(env, words, span, &Text::same(format!("H{number}")), length, state)
}

/// The length that the program wrote of an H number, mm; `None` where it wrote none.
fn written(words: &Words<'_, '_, '_>, span: Span, number: u32, state: &Modal) -> Outcome<Option<[f64; 3]>> {
    let Some(written) = state.written_lengths.iter().find(|written| written.number == number) else {
        return Ok(None);
    };
    match written.parts_mm {
        [Some(geometry), Some(wear)] => Ok(Some([0.0, 0.0, geometry + wear])),
        [geometry, _] => {
            let (has, lacks) = if geometry.is_some() { ("L10", "L11") } else { ("L11", "L10") };
            Err(words.refuse(refusal!(codes::TOOL_LENGTH;
                "the program writes H{number} by {has} alone", "программа записывает H{number} одним {has}";
                "the other part keeps what nobody said", "во второй части остаётся то, чего никто не сказал";
                "write G10 {lacks} P{number} R0 too where there is no other part",
                "напишите и G10 {lacks} P{number} R0, если другой части нет"
            ), span))
        }
    }
}

/// G10 L10 to L13: a length's geometry or wear; those of a radius (L12, L13) concern no length.
pub(crate) fn write(words: &Words<'_, '_, '_>, span: Span, l: u32, state: &mut Modal) -> Outcome<()> {
    let unit_mm = state.units.mm();
    let value = words.coordinate(b'R', state.units == Units::Inch).map(|value| value * unit_mm);
    let (Some(number @ 1..), Some(value_mm)) = (words.whole(b'P')?, value) else {
        return Err(words.refuse(refusal::l_without_p_and_r(&words.text(span), l), span));
    };
    if state.distance == Distance::Incremental {
        return Err(words.refuse(refusal::l_under_g91(&words.text(span), l), span));
    }
    if matches!(state.tool_length, ToolLength::On { number: in_force, .. } if in_force == number) && l <= 11 {
        return Err(words.refuse(refusal::rewritten_in_force(number), span));
    }
    let part = match l {
        10 => 0,
        11 => 1,
        _ => return Ok(()),
    };
    match state.written_lengths.iter_mut().find(|written| written.number == number) {
        Some(written) => written.parts_mm[part] = Some(value_mm),
        None => {
            let mut parts_mm = [None; 2];
            parts_mm[part] = Some(value_mm);
            state.written_lengths.push(WrittenLength { number, parts_mm });
        }
    }
    Ok(())
}

/// G43.1: the words are the length; axes left out keep what they had.
pub(crate) fn from_words(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    demand: &Demand<'_>,
    before: &Modal,
    state: &mut Modal,
) -> Outcome<()> {
    let Some(span) = demand.owner_span else { return Ok(()) };
    let others = ARC_LETTERS.or(ROTARY_LETTERS).or(SECONDARY_LETTERS).or(Letters::of(b"H"));
    let message = if words.has(others) || !words.has(LINEAR_LETTERS) {
        both!("{} takes X, Y and Z", "{} принимает X, Y и Z", words.text(span))
    } else if demand.written_motion.is_some() || compensated(before, state) || state.cycle.is_some() {
        both!(
            "{} beside a motion, a cycle or cutter compensation",
            "{} рядом с движением, циклом или коррекцией на радиус",
            words.text(span)
        )
    } else {
        let mut applied_mm = state.tool_length.applied_mm();
        for i in 0..3 {
            if let Some(value) = words.coordinate(LINEAR[i], state.units == Units::Inch) {
                applied_mm[i] = value * state.units.mm();
            }
        }
        bring_in(
            env,
            words,
            span,
            &both!("this length", "эта длина"),
            ToolLength::Written { applied_mm },
            state,
        )?;
        refresh(state);
        return Ok(());
    };
    Err(words.refuse(
        refusal!(codes::TOOL_LENGTH; message;
            "the length is in the words of this block", "длина стоит в словах этого кадра";
            "write it in a block of its own with X, Y and Z alone",
            "напишите её отдельным кадром, только с X, Y и Z"
        ),
        span,
    ))
}
