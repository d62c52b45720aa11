//! What the axis words of a block make the axes do.

use diagnostic::{Diagnostic, Text, both, refusal};
use nc_syntax::Span;
use smallvec::smallvec;
use toolpath::{Division, Feed, FeedRate, Motion, Mover, Shape};

use crate::circular::circular;
use crate::codes;
use crate::curves;
use crate::cycle;
use crate::direction;
use crate::environment::{Demand, Environment, Owner};
use crate::feed::feed_rate;
use crate::frame_state::settle;
use crate::frames;
use crate::modal::{Axes, Axis, Distance, Lost, Modal, MotionMode, Units, Why};
use crate::moved::Moved;
use crate::offset::{compensated, division};
use crate::position::{end, known_axes, require_frame, require_known, require_rotary};
use crate::refusals::motion as refusal;
use crate::tip;
use crate::tool_length;
use crate::turning;
use crate::words::{
    ARC_LETTERS, AXIS_LETTERS, LINEAR, LINEAR_LETTERS, Outcome, ROTARY, ROTARY_LETTERS, SECONDARY_LETTERS,
    Words,
};
use nc_syntax::Letters;

/// Executes the words of a block whose codes are already applied to `state`.
pub(crate) fn execute(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    demand: &Demand<'_>,
    before: &Modal,
    state: &mut Modal,
    moved: &mut Moved,
) -> Outcome<()> {
    match demand.owner {
        Owner::Motion => {
            moved.direction = direction::words_of(words, state);
            direction::check(env, words, state, moved.direction)?;
            known_axes(env, words)?;
            if words.has(AXIS_LETTERS.or(ARC_LETTERS)) {
                tool_length::edge_is_said(env, words, state)?;
            }
            by_mode(env, words, before, state, moved)?;
        }
        Owner::DwellP => {
            known_axes(env, words)?;
            dwell_beside(words, state)?;
            by_mode(env, words, before, state, moved)?;
        }
        Owner::Frame => moved.states_position = frames::execute(env, words, demand, before, state)?,
        Owner::Length => tool_length::from_words(env, words, demand, before, state)?,
        Owner::Dwell => dwell(env, words, demand)?,
        Owner::DwellBySetting => dwell_by_setting(words, demand)?,
        Owner::Arguments => {
            if let (Some(motion), true) = (demand.written_motion, words.has(AXIS_LETTERS.or(ARC_LETTERS))) {
                return Err(whose(words, demand, motion));
            }
        }
        Owner::Reference => {
            known_axes(env, words)?;
            no_cycle(words, state, demand)?;
            untransformed(words, state, demand, true)?;
            lose(env, words, state, Why::Reference);
            tip::lose(words, state, Why::Reference);
            moved.motions = smallvec![Motion::Uncorrected { end: state.axes.partial(), by: Mover::Other }];
        }
        Owner::Probe => {
            known_axes(env, words)?;
            no_cycle(words, state, demand)?;
            untransformed(words, state, demand, false)?;
            lose(env, words, state, Why::Probe);
            tip::lose(words, state, Why::Probe);
            moved.motions = smallvec![Motion::Uncorrected { end: state.axes.partial(), by: Mover::Other }];
        }
        Owner::MachineCoordinates => {
            known_axes(env, words)?;
            if !env.dialect.frames.machine_words_stand_alone {
                untransformed(words, state, demand, false)?;
            }
            if words.has(AXIS_LETTERS) {
                machine_coordinates(env, words, state, demand)?;
                tip::lose(words, state, Why::MachineWords);
                moved.motions =
                    smallvec![Motion::Uncorrected { end: state.axes.partial(), by: Mover::Other }];
            }
        }
    }
    Ok(())
}

/// G53, probing and returns while a rotation, scaling or mirror is in force: manuals forbid them, or differ
/// in what the words mean. A return of axes that it leaves alone is plain.
fn untransformed(
    words: &Words<'_, '_, '_>,
    state: &Modal,
    demand: &Demand<'_>,
    may_spare: bool,
) -> Outcome<()> {
    let touched = Letters::of_axes(state.transform.touches());
    let spared = may_spare && words.has(LINEAR_LETTERS) && !words.has(touched);
    match demand.owner_span {
        Some(span) if !state.transform.is_none() && !spared => {
            Err(words.refuse(refusal::move_under_transform(&words.text(span), &state.transform.name()), span))
        }
        _ => Ok(()),
    }
}

/// G4 P beside a motion (LinuxCNC): first the dwell, then the motion. P must be the dwell's alone.
fn dwell_beside(words: &Words<'_, '_, '_>, state: &Modal) -> Outcome<()> {
    let takes_p =
        state.cycle.is_some() || matches!(state.motion, MotionMode::Arc(..) | MotionMode::Curve(..));
    if takes_p && words.has(AXIS_LETTERS.or(ARC_LETTERS)) {
        let span = words.span(Letters::of(b"P").or(AXIS_LETTERS));
        return Err(words.refuse(refusal::DWELL_BESIDE_ARC_OR_CYCLE, span));
    }
    Ok(())
}

fn by_mode(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    before: &Modal,
    state: &mut Modal,
    moved: &mut Moved,
) -> Outcome<()> {
    if let Some(running) = state.cycle {
        moved.repeats = cycle::repeats(env, words)?;
        if cycle::makes_hole(words) {
            moved.motions = cycle::holes(env, words, state, running, moved.repeats)?;
        } else if words.has(Letters::of(b"Q")) {
            let span = words.span(Letters::of(b"Q"));
            return Err(words.refuse(refusal::Q_WITHOUT_HOLE, span));
        } else if words.has(Letters::of(b"IJ")) {
            return Err(stray(
                words,
                both!(
                    "no arc is in force, and nothing is drilled here",
                    "дуга не действует, и ничего здесь не сверлится"
                ),
            ));
        }
        return Ok(());
    }
    match state.motion {
        MotionMode::Rapid(_) | MotionMode::Line(_) => {
            let strays = if moved.direction.is_some() { Letters::of(b"R") } else { ARC_LETTERS };
            if words.has(strays) {
                return Err(stray(words, both!("this block is no arc", "этот кадр не дуга")));
            }
            if words.has(AXIS_LETTERS) || moved.direction.is_some() {
                let rapid = matches!(state.motion, MotionMode::Rapid(_));
                straight(env, words, before, state, rapid, moved)?;
            }
        }
        MotionMode::Curve(form, _) => curves::execute(env, words, before, state, form, moved)?,
        MotionMode::Thread(_) => {
            if words.has(ARC_LETTERS.without(turning::thread_lead(env))) {
                return Err(stray(words, both!("this block is no arc", "этот кадр не дуга")));
            }
            turning::require_lead(env, words)?;
            if words.has(AXIS_LETTERS) {
                straight(env, words, before, state, false, moved)?;
                for motion in &mut moved.motions {
                    if let Motion::Feed(feed) = motion {
                        // The control finds the angle of the spindle anew in each block.
                        (feed.rate, feed.division) = (FeedRate::PerRevolution, Division::One);
                    }
                }
            }
        }
        MotionMode::Arc(turn, _) => {
            if words.has(AXIS_LETTERS.or(ARC_LETTERS)) {
                moved.arc_by_radius = words.has(Letters::of(b"R"));
                circular(env, words, before, state, turn, &mut moved.motions)?;
            }
        }
        MotionMode::None if words.has(AXIS_LETTERS) => {
            return Err(words
                .refuse(refusal::without_motion_code(&words.names(AXIS_LETTERS)), words.span(AXIS_LETTERS)));
        }
        MotionMode::Undecided { line } if words.has(AXIS_LETTERS.or(ARC_LETTERS)) => {
            return Err(words.refuse(
                refusal::motion_code_behind_block_delete(line),
                words.span(AXIS_LETTERS.or(ARC_LETTERS)),
            ));
        }
        MotionMode::None | MotionMode::Undecided { .. } => {
            if words.has(ARC_LETTERS) {
                return Err(stray(
                    words,
                    both!("no arc and no cycle is in force", "не действует ни дуга, ни цикл"),
                ));
            }
        }
    }
    Ok(())
}

/// G0 and G1.
#[inline]
fn straight(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    before: &Modal,
    state: &mut Modal,
    rapid: bool,
    moved: &mut Moved,
) -> Outcome<()> {
    settle(words, state)?;
    let start = state.axes;
    let mut end = end(words, state, require_frame(env, words, state)?)?;
    if let Some(named) = moved.direction {
        end.rotary = direction::angles(env, words, state, named)?.map(Axis::At);
    }
    let motions = &mut moved.motions;
    state.axes = end;
    let turns = words.has(ROTARY_LETTERS) || moved.direction.is_some();
    // While a rotary axis feeds, the tool cuts: along its real path, which the linear axes have to follow.
    let cuts = !rapid && env.setup.rotary_matters && end.rotary != start.rotary;
    // A rapid that says the place again goes there, by what the new angles ask of it.
    let still = end.linear == start.linear && end.rotary != start.rotary;
    let alone = !words.has(LINEAR_LETTERS) || (still && !rapid);
    if turns && alone && !cuts {
        // Rotary axes position, or their place does not matter: the linear axes stay where they are.
        motions.push(Motion::Uncorrected { end: end.partial(), by: Mover::RotaryWords });
        return Ok(());
    }
    require_rotary(words, &end)?;
    if rapid {
        motions.push(Motion::Rapid { start: start.partial(), end: end.partial() });
        return Ok(());
    }
    let what = &Text::pair("the feed move", "рабочий ход");
    let from = require_known(words, &start, what)?;
    let to = require_known(words, &end, what)?;
    if cuts && compensated(before, state) {
        return Err(compensated_turn(words));
    }
    let rate = feed_rate(words, state)?;
    // Where the rotary axes do not matter, nobody knows where they stand: their words cannot be shared out.
    let shared = !cuts && from.rotary_deg != to.rotary_deg;
    let division = division(before, state, shared, [from, to].map(|place| place.linear_mm), None);
    motions.push(Motion::Feed(Feed { start: from, end: to, shape: Shape::Line, rate, division }));
    Ok(())
}

/// G4: X, U, P (and whatever F or S the control reads there) are a time.
fn dwell(env: &Environment<'_>, words: &Words<'_, '_, '_>, demand: &Demand<'_>) -> Outcome<()> {
    let own = env.dialect.dwell_time;
    let waits = |own: Letters| {
        (b'A'..=b'Z').any(|l| own.contains(l) && words.plain(l).is_some_and(|time| time > 0.0))
    };
    if let (Some(own), Some(span)) = (own.filter(|own| !waits(*own)), demand.owner_span) {
        return Err(words.refuse(
            refusal!(codes::REFUSED_CODE;
                "{} without a time", "{} без времени", words.text(span);
                "is no dwell on this control", "на этой стойке это не выдержка";
                "write its time as {}, or delete it",
                "напишите её время словом {} или удалите её", own.names()
            ),
            span,
        ));
    }
    let time = own.unwrap_or(Letters::of(b"XU"));
    let times = time.or(Letters::of(b"P"));
    let others = AXIS_LETTERS.or(ARC_LETTERS).or(SECONDARY_LETTERS).without(time);
    let unclear = words.has(others)
        || (words.has(time) && (demand.written_motion.is_some() || words.letters.and(times).count() > 1));
    if unclear {
        let span = words.span(others.or(time));
        return Err(words.refuse(refusal::DWELL_AND_MOTION_IN_ONE_BLOCK, span));
    }
    Ok(())
}

/// G4 whose time is set elsewhere: axis words are a motion's, and whether it comes before or after is not known.
fn dwell_by_setting(words: &Words<'_, '_, '_>, demand: &Demand<'_>) -> Outcome<()> {
    let others = AXIS_LETTERS.or(ARC_LETTERS).or(SECONDARY_LETTERS);
    if !words.has(others) && demand.written_motion.is_none() {
        return Ok(());
    }
    Err(words.refuse(refusal::DWELL_BESIDE_MOTION, words.span(others)))
}

/// G53 with axis words: they are axis commands, tool length included.
fn machine_coordinates(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    state: &mut Modal,
    demand: &Demand<'_>,
) -> Outcome<()> {
    if let Some(span) = demand.owner_span
        && (state.cycle.is_some() || matches!(state.motion, MotionMode::Arc(..)))
    {
        return Err(words.refuse_without("G0", refusal::MACHINE_COORDINATES_WITH_ARC_OR_CYCLE, span));
    }
    if words.has(ARC_LETTERS) {
        return Err(stray(words, both!("this block is no arc", "этот кадр не дуга")));
    }
    let lengths = if state.edge_unsaid {
        // It may be that of any tool, and one that no profile gives lies along Z.
        let any = |all: [bool; 3], mm: [f64; 3]| [0, 1, 2].map(|i| all[i] || mm[i] != 0.0);
        env.setup.tools.iter().map(|(_, mm)| *mm).fold([false, false, true], any)
    } else {
        state.tool_length.applied_mm().map(|mm| mm != 0.0)
    };
    let along = Letters::of_axes(lengths);
    if env.dialect.edge_in_d && words.has(along) {
        return Err(words.refuse(refusal::MACHINE_COORDINATES_WITH_TOOL_LENGTH, words.span(along)));
    }
    if state.distance == Distance::Incremental {
        // Some controls ignore G53 under G91, some refuse it, some obey: the end is not known.
        lose(env, words, state, Why::MachineCoordinates);
        return Ok(());
    }
    let unit_mm = state.units.mm();
    for i in 0..3 {
        if let Some(value) = words.coordinate(LINEAR[i], state.units == Units::Inch) {
            state.axes.linear[i] = Axis::At(value * unit_mm);
        }
        if let Some(value) = words.coordinate(ROTARY[i], false) {
            state.axes.rotary[i] = Axis::At(value);
        }
    }
    Ok(())
}

/// Forgets the axes that the block names; all that the machine has where it names none.
fn lose(env: &Environment<'_>, words: &Words<'_, '_, '_>, state: &mut Modal, why: Why) {
    let lost = Axis::Unknown(Lost { why, line: words.block.line });
    let all = !words.has(AXIS_LETTERS);
    let Axes { linear, rotary } = &mut state.axes;
    for i in 0..3 {
        if (all || words.has(Letters::of(&[LINEAR[i]]))) && env.moves_axis(i) {
            linear[i] = lost;
        }
        if (all && env.setup.has_rotary[i]) || words.has(Letters::of(&[ROTARY[i]])) {
            // Where it stands is not asked for where it does not matter: any value serves.
            rotary[i] = if env.setup.rotary_matters { lost } else { Axis::At(0.0) };
        }
    }
}

fn no_cycle(words: &Words<'_, '_, '_>, state: &Modal, demand: &Demand<'_>) -> Outcome<()> {
    match demand.owner_span {
        Some(span) if state.cycle.is_some() => {
            Err(words.refuse_without("G80", refusal::REFERENCE_OR_PROBE_IN_CYCLE, span))
        }
        _ => Ok(()),
    }
}

fn whose(words: &Words<'_, '_, '_>, demand: &Demand<'_>, motion: Span) -> Box<Diagnostic> {
    let owner = demand.owner_span.map_or_else(String::new, |span| words.text(span));
    words.refuse(
        refusal::both_take_axis_words(owner, &words.text(motion)),
        words.span(AXIS_LETTERS.or(ARC_LETTERS)),
    )
}

fn stray(words: &Words<'_, '_, '_>, why: Text) -> Box<Diagnostic> {
    let names = words.names(ARC_LETTERS);
    words.refuse(
        refusal!(codes::STRAY_ARC_WORD;
            "{names} has no meaning here", "{names} здесь ничего не значит";
            why;
            "write G2 or G3 for an arc, or remove the word; corner roundings must be posted as arcs",
            "для дуги напишите G2 или G3 или уберите слово; скругления углов выводите дугами"
        ),
        words.span(ARC_LETTERS),
    )
}

/// The control would offset a path that turns with the workpiece.
fn compensated_turn(words: &Words<'_, '_, '_>) -> Box<Diagnostic> {
    words.refuse(refusal::turn_under_compensation(&words.names(ROTARY_LETTERS)), words.span(ROTARY_LETTERS))
}
