//! What the axis words of a block make the axes do.

use diagnostic::Diagnostic;
use nc_syntax::Span;
use smallvec::{SmallVec, smallvec};
use toolpath::{Arc, Feed, FeedRate, Motion, Shape};

use crate::arc::{self, Circle, Fault};
use crate::codes;
use crate::cycle;
use crate::frames::{self, settle};
use crate::modal::{
    ArcCentres, Axes, Axis, Compensation, Distance, FeedMode, Lost, Modal, MotionMode, ToolLength, Turn,
    Units, Why,
};
use crate::position::{end, known_axes, require_frame, require_known, require_rotary};
use crate::settings::{Demand, Environment, Owner};
use crate::words::{
    ARC_LETTERS, AXIS_LETTERS, CENTRE_LETTERS, LINEAR, LINEAR_LETTERS, Letters, Outcome, ROTARY,
    ROTARY_LETTERS, SECONDARY_LETTERS, Words,
};

/// Nearly always none or one.
pub(crate) type Motions = SmallVec<[Motion; 1]>;

/// What a block made of its words.
#[derive(Debug, Default)]
pub(crate) struct Moved {
    pub(crate) motions: Motions,
    pub(crate) arc_by_radius: bool,
    pub(crate) repeats: u32,
    pub(crate) states_position: bool,
}

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
            known_axes(env, words)?;
            by_mode(env, words, before, state, moved)?;
        }
        Owner::DwellP => {
            known_axes(env, words)?;
            dwell_beside(words, state)?;
            by_mode(env, words, before, state, moved)?;
        }
        Owner::Frame => moved.states_position = frames::execute(env, words, demand, before, state)?,
        Owner::Length => length_from_words(words, demand, before, state)?,
        Owner::Dwell => dwell(words, demand)?,
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
            moved.motions = smallvec![Motion::Uncorrected { end: state.axes.partial() }];
        }
        Owner::Probe => {
            known_axes(env, words)?;
            no_cycle(words, state, demand)?;
            untransformed(words, state, demand, false)?;
            lose(env, words, state, Why::Probe);
            moved.motions = smallvec![Motion::Uncorrected { end: state.axes.partial() }];
        }
        Owner::MachineCoordinates => {
            known_axes(env, words)?;
            untransformed(words, state, demand, false)?;
            if words.has(AXIS_LETTERS) {
                machine_coordinates(env, words, state, demand)?;
                moved.motions = smallvec![Motion::Uncorrected { end: state.axes.partial() }];
            }
        }
    }
    Ok(())
}

/// What F means for a motion; `value` is F where G93 is in force.
pub(crate) const fn rate(state: &Modal, value: f64) -> FeedRate {
    match state.feed_mode {
        FeedMode::InverseTime => FeedRate::InverseTime(value),
        FeedMode::PerMinute => FeedRate::PerMinute,
        FeedMode::PerRevolution => FeedRate::PerRevolution,
    }
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
            let message = format!("{} under {}", words.text(span), state.transform.name());
            Err(words
                .refuse(codes::FRAME, message, span, "controls forbid it, or differ in what it does")
                .help("cancel the rotation, scaling or mirror before it"))
        }
        _ => Ok(()),
    }
}

/// G4 P beside a motion (LinuxCNC): first the dwell, then the motion. P must be the dwell's alone.
fn dwell_beside(words: &Words<'_, '_, '_>, state: &Modal) -> Outcome<()> {
    let arc = matches!(state.motion, MotionMode::Arc(..)) && words.has(AXIS_LETTERS.or(ARC_LETTERS));
    if state.cycle.is_some() || arc {
        let span = words.span(Letters::of(b"P").or(AXIS_LETTERS));
        return Err(words
            .refuse(codes::WORDS_OF_TWO, "a dwell beside an arc or a cycle", span, "whose is P?")
            .help("write the dwell in a block of its own"));
    }
    Ok(())
}

/// G43.1: the words are the length; axes left out keep what they had.
fn length_from_words(
    words: &Words<'_, '_, '_>,
    demand: &Demand<'_>,
    before: &Modal,
    state: &mut Modal,
) -> Outcome<()> {
    let Some(span) = demand.owner_span else { return Ok(()) };
    let others = ARC_LETTERS.or(ROTARY_LETTERS).or(SECONDARY_LETTERS).or(Letters::of(b"H"));
    let message = if words.has(others) || !words.has(LINEAR_LETTERS) {
        format!("{} takes X, Y and Z", words.text(span))
    } else if demand.written_motion.is_some() || compensated(before, state) || state.cycle.is_some() {
        format!("{} beside a motion, a cycle or cutter compensation", words.text(span))
    } else {
        let mut applied_mm = state.tool_length.applied_mm();
        for i in 0..3 {
            if let Some(value) = words.coordinate(LINEAR[i], state.units == Units::Inch) {
                applied_mm[i] = value * state.units.mm();
            }
        }
        state.tool_length = ToolLength::Written { applied_mm };
        frames::refresh(state);
        return Ok(());
    };
    Err(words
        .refuse(codes::TOOL_LENGTH, message, span, "the length is in the words of this block")
        .help("write it in a block of its own with X, Y and Z alone"))
}

fn by_mode(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    before: &Modal,
    state: &mut Modal,
    moved: &mut Moved,
) -> Outcome<()> {
    if let Some(running) = state.cycle {
        moved.repeats = cycle::repeats(words)?;
        if cycle::makes_hole(words) {
            moved.motions = cycle::holes(env, words, state, running, moved.repeats)?;
        } else if words.has(Letters::of(b"Q")) {
            let span = words.span(Letters::of(b"Q"));
            return Err(words
                .refuse(
                    codes::CYCLE_WORDS,
                    "Q without a hole",
                    span,
                    "does it hold for the next one? controls differ",
                )
                .help("write Q in a block that drills"));
        }
        return Ok(());
    }
    match state.motion {
        MotionMode::Rapid(_) | MotionMode::Line(_) => {
            if words.has(ARC_LETTERS) {
                return Err(stray(words, "this block is no arc"));
            }
            if words.has(AXIS_LETTERS) {
                let rapid = matches!(state.motion, MotionMode::Rapid(_));
                straight(env, words, before, state, rapid, &mut moved.motions)?;
            }
        }
        MotionMode::Arc(turn, _) => {
            if words.has(AXIS_LETTERS.or(ARC_LETTERS)) {
                moved.arc_by_radius = words.has(Letters::of(b"R"));
                circular(env, words, before, state, turn, &mut moved.motions)?;
            }
        }
        MotionMode::None if words.has(AXIS_LETTERS) => {
            let message = format!("{} without a motion code", words.names(AXIS_LETTERS));
            return Err(words
                .refuse(
                    codes::NO_MOTION_CODE,
                    message,
                    words.span(AXIS_LETTERS),
                    "no G0, G1, G2, G3 or cycle is in force",
                )
                .help("write the motion code in this block"));
        }
        MotionMode::Undecided { line } if words.has(AXIS_LETTERS.or(ARC_LETTERS)) => {
            let message = "the motion code in force depends on the block delete switch";
            let label = format!("line {line} changes the motion code and may be skipped");
            return Err(words
                .refuse(codes::BLOCK_DELETE, message, words.span(AXIS_LETTERS.or(ARC_LETTERS)), label)
                .help("write the motion code in this block"));
        }
        MotionMode::None | MotionMode::Undecided { .. } => {
            if words.has(ARC_LETTERS) {
                return Err(stray(words, "no arc and no cycle is in force"));
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
    motions: &mut Motions,
) -> Outcome<()> {
    settle(words, state)?;
    let start = state.axes;
    let end = end(words, state, require_frame(env, words, state)?)?;
    state.axes = end;
    let turns = words.has(ROTARY_LETTERS);
    if turns && (!words.has(LINEAR_LETTERS) || (end.linear == start.linear && end.rotary != start.rotary)) {
        // Only rotary axes move: nothing to correct, and the linear axes stay where they are.
        motions.push(Motion::Uncorrected { end: end.partial() });
        return Ok(());
    }
    require_rotary(words, &end)?;
    if rapid {
        motions.push(Motion::Rapid { start: start.partial(), end: end.partial() });
        return Ok(());
    }
    let what = "the feed move";
    let from = require_known(words, &start, what)?;
    let to = require_known(words, &end, what)?;
    let turns = from.rotary_deg != to.rotary_deg;
    if turns && env.setup.rotary_matters {
        return Err(simultaneous(words));
    }
    let rate = feed_rate(words, state)?;
    // Pieces of a block that also turns would each need their share of the turn.
    let may_split = !compensated(before, state) && !turns;
    motions.push(Motion::Feed(Feed { start: from, end: to, shape: Shape::Line, rate, may_split }));
    Ok(())
}

/// G2 and G3.
fn circular(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    before: &Modal,
    state: &mut Modal,
    turn: Turn,
    motions: &mut Motions,
) -> Outcome<()> {
    settle(words, state)?;
    let frame = *require_frame(env, words, state)?;
    let start = state.axes;
    let end = end(words, state, &frame)?;
    let what = "the arc";
    let from = require_known(words, &start, what)?;
    let to = require_known(words, &end, what)?;
    let turning = from.rotary_deg != to.rotary_deg;
    if turning && env.setup.rotary_matters {
        return Err(simultaneous(words));
    }
    let turns = turns(env, words)?;
    let [first, second, _] = state.plane.axes();
    let plane = |point: &[f64; 3]| [point[first], point[second]];
    let Some(similarity) = frame.similarity(state.plane) else {
        return Err(words
            .refuse(
                codes::FRAME,
                format!("an arc under {}", state.transform.name()),
                words.span(AXIS_LETTERS.or(ARC_LETTERS)),
                "the frame makes it an ellipse or turns it out of its plane",
            )
            .help("let the CAM write the arc as lines, or scale all axes alike"));
    };
    // The words say the circle in program coordinates. A shifted frame has the same circle in axis
    // commands; a turned or mirrored one must be asked.
    let shift = frame.is_shift();
    let local = |point: &[f64; 3]| plane(&if shift { *point } else { frame.to_program(*point) });
    let (start_2d, end_2d) = (local(&from.linear_mm), local(&to.linear_mm));
    let origin = if shift { plane(&frame.offset_mm()) } else { [0.0; 2] };
    let tolerance_mm = env.dialect.output.arc_radius_tolerance_mm;
    let inch = state.units == Units::Inch;
    let circle = match words.coordinate(b'R', inch) {
        Some(_) if words.has(CENTRE_LETTERS) => {
            let span = words.span(ARC_LETTERS);
            return Err(words
                .refuse(codes::ARC_WORDS, "R and a centre in one arc", span, "which one?")
                .help(format!("remove R or {}", words.names(CENTRE_LETTERS))));
        }
        Some(radius) => arc::by_radius(start_2d, end_2d, radius * state.units.mm(), turn, tolerance_mm),
        None => {
            let centre = centre(words, state, start_2d, origin)?;
            arc::by_centre(start_2d, end_2d, centre, turn, tolerance_mm)
        }
    };
    let Circle { centre_mm, sweep_rad } =
        circle.map_err(|fault| no_circle(words, state, fault, tolerance_mm))?;
    let rate = feed_rate(words, state)?;
    state.axes = end;
    let centre_mm = if shift {
        centre_mm
    } else {
        let mut centre = frame.to_program(from.linear_mm);
        (centre[first], centre[second]) = (centre_mm[0], centre_mm[1]);
        plane(&frame.to_machine(centre))
    };
    let whole = f64::from(turns - 1) * std::f64::consts::TAU;
    let sweep_rad = sweep_rad + whole.copysign(sweep_rad);
    let sweep_rad = if similarity.mirrored { -sweep_rad } else { sweep_rad };
    let shape = Shape::Arc(Arc { plane: state.plane, centre_mm, sweep_rad });
    let may_split = !compensated(before, state) && !turning;
    motions.push(Motion::Feed(Feed { start: from, end: to, shape, rate, may_split }));
    Ok(())
}

/// P of an arc: its turns, where the dialect has that; the first need not be whole.
fn turns(env: &Environment<'_>, words: &Words<'_, '_, '_>) -> Outcome<u32> {
    const P: Letters = Letters::of(b"P");
    /// More than any thread has.
    const MOST: u32 = 1000;
    if env.dialect.frames.arc_turns {
        let turns = words.whole(b'P')?.unwrap_or(1);
        if (1..=MOST).contains(&turns) {
            return Ok(turns);
        }
        let message = format!("an arc of {turns} turns");
        return Err(words
            .refuse(codes::ARC_WORDS, message, words.span(P), format!("1 to {MOST} were expected"))
            .help("write P1, or no P, for an arc of at most one turn"));
    }
    match words.plain(b'P') {
        Some(turns) if (turns - 1.0).abs() > 1e-9 => Err(words
            .refuse(
                codes::ARC_WORDS,
                "P beside an arc",
                words.span(P),
                "turns on some controls, nothing on others",
            )
            .help("write one block for each turn")),
        _ => Ok(1),
    }
}

/// The centre by I J K, mm, where the program's zero is `shift_mm`.
fn centre(
    words: &Words<'_, '_, '_>,
    state: &Modal,
    start_mm: [f64; 2],
    shift_mm: [f64; 2],
) -> Outcome<[f64; 2]> {
    let letters = state.plane.centre_letters();
    let [one, two] = shown_letters(state);
    let in_plane = Letters::of(&letters);
    let across = CENTRE_LETTERS.without(in_plane);
    let inch = state.units == Units::Inch;
    if words.has(across) {
        let letter = across.first();
        // `K0` on a G17 arc is how some posts write nothing.
        if words.coordinate(letter, inch) != Some(0.0) {
            let message = format!("{} on an arc whose plane has {one} and {two}", letter as char);
            return Err(words
                .refuse(codes::ARC_WORDS, message, words.span(across), "not in this plane")
                .help("select the arc's plane with G17, G18 or G19, or remove the word"));
        }
    }
    if !words.has(in_plane) {
        return Err(without_centre(words, one, two));
    }
    let values = letters.map(|letter| words.coordinate(letter, inch).map(|value| value * state.units.mm()));
    match (state.arc_centres, values) {
        (ArcCentres::Incremental, [i, j]) => {
            Ok([start_mm[0] + i.unwrap_or(0.0), start_mm[1] + j.unwrap_or(0.0)])
        }
        (ArcCentres::Absolute, [Some(i), Some(j)]) => Ok([i + shift_mm[0], j + shift_mm[1]]),
        (ArcCentres::Absolute, _) => Err(words
            .refuse(
                codes::ARC_WORDS,
                "half a centre under absolute arc centres",
                words.span(in_plane),
                format!("{one} and {two} were expected"),
            )
            .help(format!("write both {one} and {two}, or G91.1 for centres from the start"))),
    }
}

fn without_centre(words: &Words<'_, '_, '_>, one: char, two: char) -> Box<Diagnostic> {
    words
        .refuse(
            codes::ARC_WITHOUT_CENTRE,
            "arc without centre",
            words.span(AXIS_LETTERS.or(ARC_LETTERS)),
            format!("neither {one}/{two} nor R in this block, and neither is modal"),
        )
        .help(format!(
            "post the program again so that each arc block has its {one} and {two} (some posts drop unchanged ones), or add R"
        ))
}

fn no_circle(words: &Words<'_, '_, '_>, state: &Modal, fault: Fault, tolerance_mm: f64) -> Box<Diagnostic> {
    let [one, two] = shown_letters(state);
    let (unit_mm, unit) = match state.units {
        Units::Millimetre => (1.0, "mm"),
        Units::Inch => (25.4, "inch"),
    };
    let show = |mm: f64| shortest(mm / unit_mm);
    let centre = words.span(ARC_LETTERS);
    match fault {
        Fault::NoRadius => words
            .refuse(codes::ARC_WORDS, "an arc about its own start", centre, format!("{one} and {two} are 0"))
            .help(format!("write the distance from the start to the centre as {one} and {two}")),
        Fault::RadiiDiffer { start_mm, end_mm } => {
            let message = "the ends of the arc lie at different distances from its centre";
            let label = format!(
                "radius {} at the start, {} {unit} at the end, {} allowed",
                show(start_mm),
                show(end_mm),
                show(tolerance_mm)
            );
            let mode = match state.arc_centres {
                ArcCentres::Incremental => "measured from the start (G91.1)",
                ArcCentres::Absolute => "absolute (G90.1)",
            };
            words
                .refuse(codes::RADII_DIFFER, message, centre, label)
                .help(format!("correct the end or the centre; {one} and {two} are read as {mode}"))
        }
        Fault::RadiusTooSmall { radius_mm, chord_mm } => {
            // Rounded up, so that the number can be typed as it stands.
            let least = (chord_mm / unit_mm / 2.0 * 1e4 - 1e-6).ceil() / 1e4;
            words
                .refuse(
                    codes::RADIUS_TOO_SMALL,
                    "arc radius is smaller than half the chord",
                    centre,
                    format!("R{} {unit}, chord is {} {unit}", show(radius_mm), show(chord_mm)),
                )
                .help(format!("use {one}/{two} centre form, or R of at least {}", shortest(least)))
        }
        Fault::FullCircleByRadius => words
            .refuse(
                codes::ARC_WORDS,
                "a full circle by R",
                centre,
                "start and end are the same point: R has no centre",
            )
            .help(format!("use {one}/{two} centre form")),
    }
}

/// The plane's centre letters in the order people write them.
fn shown_letters(state: &Modal) -> [char; 2] {
    let mut letters = state.plane.centre_letters().map(char::from);
    letters.sort_unstable();
    letters
}

/// A number for people: at most four decimals, no trailing zeros.
fn shortest(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// G41 and G42 are in force before or after the block: neither its start-up nor its end may be split.
fn compensated(before: &Modal, state: &Modal) -> bool {
    before.compensation == Compensation::On || state.compensation == Compensation::On
}

/// F of a feed motion: under G93 it must stand in the block itself.
fn feed_rate(words: &Words<'_, '_, '_>, state: &Modal) -> Outcome<FeedRate> {
    if state.feed_mode != FeedMode::InverseTime {
        return Ok(rate(state, 0.0));
    }
    const F: Letters = Letters::of(b"F");
    match words.plain(b'F') {
        Some(value) if value > 0.0 => Ok(rate(state, value)),
        Some(_) => Err(words
            .refuse(codes::INVERSE_TIME, "inverse time must be above zero", words.span(F), "1/F minutes")
            .help("write F as one over the minutes of this motion")),
        None => Err(words
            .refuse(
                codes::INVERSE_TIME,
                "a feed motion under G93 without F",
                words.span(AXIS_LETTERS),
                "F was expected in this block",
            )
            .help("G93 needs F on each feed block; or program G94")),
    }
}

/// G4: X, U, P (and whatever F or S the control reads there) are a time.
fn dwell(words: &Words<'_, '_, '_>, demand: &Demand<'_>) -> Outcome<()> {
    const TIME: Letters = Letters::of(b"XU");
    let times = TIME.or(Letters::of(b"P"));
    let others = AXIS_LETTERS.or(ARC_LETTERS).or(SECONDARY_LETTERS).without(TIME);
    let unclear = words.has(others)
        || (words.has(TIME) && (demand.written_motion.is_some() || words.letters.and(times).count() > 1));
    if unclear {
        let span = words.span(others.or(TIME));
        return Err(words
            .refuse(codes::WORDS_OF_TWO, "a dwell and a motion in one block", span, "time or coordinate?")
            .help("write the dwell in a block of its own"));
    }
    Ok(())
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
        return Err(words
            .refuse(
                codes::COMBINATION,
                "machine coordinates with an arc or a cycle",
                span,
                "moves straight on every control",
            )
            .help("write G0 in this block"));
    }
    if words.has(ARC_LETTERS) {
        return Err(stray(words, "this block is no arc"));
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
        if all || words.has(Letters::of(&[LINEAR[i]])) {
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
        Some(span) if state.cycle.is_some() => Err(words
            .refuse(
                codes::COMBINATION,
                "a reference return or probe move while a drilling cycle is in force",
                span,
                "a cycle is running here",
            )
            .help("cancel the cycle with G80 first")),
        _ => Ok(()),
    }
}

fn whose(words: &Words<'_, '_, '_>, demand: &Demand<'_>, motion: Span) -> Box<Diagnostic> {
    let owner = demand.owner_span.map_or_else(String::new, |span| words.text(span));
    let message = format!("{owner} and {} both take the axis words of this block", words.text(motion));
    words
        .refuse(codes::WORDS_OF_TWO, message, words.span(AXIS_LETTERS.or(ARC_LETTERS)), "whose are they?")
        .help("write the two codes in two blocks")
}

fn stray(words: &Words<'_, '_, '_>, why: &str) -> Box<Diagnostic> {
    let names = words.names(ARC_LETTERS);
    words
        .refuse(codes::STRAY_ARC_WORD, format!("{names} has no meaning here"), words.span(ARC_LETTERS), why)
        .help("write G2 or G3 for an arc, or remove the word; corner roundings must be posted as arcs")
}

fn simultaneous(words: &Words<'_, '_, '_>) -> Box<Diagnostic> {
    words
        .refuse(
            codes::SIMULTANEOUS,
            "rotary and linear axes move together at feed rate",
            words.span(AXIS_LETTERS),
            "the path between the ends cannot be corrected",
        )
        .help("turn the rotary axis in a block of its own, then feed")
}
