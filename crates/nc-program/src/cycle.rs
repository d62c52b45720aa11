//! Drilling cycles: which blocks make a hole, and where.

use diagnostic::{Refusal, Text, both, refusal};
use nc_dialect::CycleLevels;
use nc_syntax::{GCode, Letters};
use smallvec::SmallVec;
use toolpath::{Cycle, CycleKind, Frame, Hole, Motion, Position};
use units::decimal::Decimal;

use crate::codes;
use crate::environment::Environment;
use crate::feed::{own_feed, rate};
use crate::frame_state::settle;
use crate::modal::{Axes, Axis, CycleState, Distance, FeedMode, Level, Modal, ReturnLevel, Units};
use crate::moved::Motions;
use crate::position::{end, increment_base, require_frame, require_known};
use crate::refusals::cycle as refusal;
use crate::words::{AXIS_LETTERS, CENTRE_LETTERS, LINEAR, Outcome, ROTARY_LETTERS, Words};

/// Levels that differ by less are the same.
const SAME_LEVEL_MM: f64 = 1e-6;
/// Corrected levels differ by no more from the posted ones, mm.
const CORRECTED_MM: f64 = 0.1;
/// More holes than a control repeats in one block.
const MOST_REPEATS: u32 = 9999;

/// Cycles that take no P on any control whose manual was read; their twins G82 and G89 differ in nothing else.
const WITHOUT_DWELL: [GCode; 2] = [GCode(810), GCode(850)];

const K: Letters = Letters::of(b"K");
const L: Letters = Letters::of(b"L");
const Q: Letters = Letters::of(b"Q");
const R: Letters = Letters::of(b"R");

/// True where the block makes a hole: an axis word or R. F, S, M, P alone make none.
pub(crate) fn makes_hole(words: &Words<'_, '_, '_>) -> bool {
    words.has(AXIS_LETTERS.or(R))
}

/// How often the block is repeated, by K or L; else once.
pub(crate) fn repeats(env: &Environment<'_>, words: &Words<'_, '_, '_>) -> Outcome<u32> {
    let (k, l) = (words.whole(b'K')?, words.whole(b'L')?);
    let both = K.or(L);
    for (letter, count) in [(b'K', k), (b'L', l)] {
        let counts = env.dialect.cycle_repeats.contains(&letter);
        // Once is once, whoever counts.
        if count.is_some_and(|count| count != 1) && !counts {
            let span = words.span(Letters::of(&[letter]));
            return Err(words.refuse_code(refusal::IN_DRILLING_CYCLE, span));
        }
    }
    if k.is_some() && l.is_some() {
        return Err(words.refuse(refusal::K_AND_L_BOTH_COUNT, words.span(both)));
    }
    let count = k.or(l).unwrap_or(1);
    if count == 0 && !env.dialect.zero_repeats_define {
        return Err(words.refuse(refusal::REPEATED_ZERO_TIMES, words.span(both)));
    }
    if k.is_some() && words.has(Letters::of(b"IJ")) {
        let span = words.span(Letters::of(b"IJK"));
        return Err(words.refuse(refusal::K_BESIDE_I_OR_J, span));
    }
    if count > MOST_REPEATS {
        return Err(words.refuse(refusal::too_many_repetitions(count, MOST_REPEATS), words.span(both)));
    }
    Ok(count)
}

/// The holes of a block while `state.cycle` is in force.
///
/// The levels: R absolute, or under G91 from the initial level; the bottom absolute, or under G91 from R.
/// With a count of zero the words are stored and nothing moves.
pub(crate) fn holes(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    state: &mut Modal,
    mut cycle: CycleState,
    count: u32,
) -> Outcome<Motions> {
    if state.feed_mode == FeedMode::InverseTime {
        let holes = words.span(AXIS_LETTERS);
        return Err(words.refuse_without("G94", refusal::DRILLING_CYCLE_UNDER_G93, holes));
    }
    own_feed(words, state)?;
    settle(words, state)?;
    let frame = require_frame(env, words, state)?.clone();
    let [first, second, normal] = state.plane.axes();
    no_scaling(words, state, normal, &cycle)?;
    let shift = frame.offset_mm();
    read_words(words, state, &mut cycle, normal, &shift)?;
    state.cycle = Some(cycle);
    if count == 0 {
        return Ok(Motions::new());
    }
    let ends = end(words, state, &frame)?;
    if words.has(ROTARY_LETTERS) && ends.rotary != state.axes.rotary {
        return Err(words.refuse(refusal::ROTARY_AXIS_TURNS_IN_CYCLE, words.span(ROTARY_LETTERS)));
    }
    let (r_mm, bottom_mm) = levels(env, words, state, &cycle, normal, &shift)?;
    if cycle.peck_mm.is_none() && cycle.kind.pecks() {
        return Err(incomplete(words, "Q"));
    }
    below_r(env, words, state, r_mm, bottom_mm)?;
    let mut at = require_known(words, &state.axes, &Text::pair("the drilling cycle", "цикл сверления"))?;
    // Nothing but a motion code makes an unknown axis known again, and that ends the cycle: where the
    // first hole finds the axis known, the start of the series did.
    let began_mm = cycle.initial.known().unwrap_or(at.linear_mm[normal]);
    // LinuxCNC ends a cycle at the level farther from the bottom.
    let initial_mm = if r_mm >= bottom_mm { began_mm.max(r_mm) } else { began_mm.min(r_mm) };
    if initial_mm - began_mm > CORRECTED_MM && state.return_level != ReturnLevel::R {
        begun_beyond_r(env, words)?;
    }
    let parameters = Cycle {
        kind: cycle.kind,
        peck_mm: cycle.peck_mm,
        dwell: own_dwell(&cycle),
        return_to_initial: returns_to_initial(words, state.return_level, [initial_mm, r_mm])?,
    };
    let mut motions: Motions = SmallVec::with_capacity(count as usize);
    for _ in 0..count {
        let mut at_r = at;
        at_r.linear_mm[normal] = r_mm;
        for axis in [first, second] {
            at_r.linear_mm[axis] = next(words, state, &frame, axis, at.linear_mm[axis], &ends);
        }
        let hole = Hole {
            plane: state.plane,
            start: at,
            at_r,
            bottom_mm,
            first: !cycle.drilled && motions.is_empty(),
            began_mm,
            initial_mm,
            cycle: parameters,
            rate: rate(state, 0.0),
        };
        at = hole.end();
        motions.push(Motion::Hole(hole));
    }
    state.axes = position(at);
    state.cycle = Some(CycleState { drilled: true, ..cycle });
    Ok(motions)
}

/// G98 is in force; that it is not said, or who may skip its block, is asked where the two differ.
fn returns_to_initial(
    words: &Words<'_, '_, '_>,
    level: ReturnLevel,
    [initial_mm, r_mm]: [f64; 2],
) -> Outcome<bool> {
    let (code, what, label) = match level {
        ReturnLevel::Initial => return Ok(true),
        ReturnLevel::R => return Ok(false),
        _ if initial_mm == r_mm => return Ok(true),
        ReturnLevel::Unsaid => (
            codes::CYCLE_INCOMPLETE,
            both!(
                "no G98 or G99 says to which level the tool returns",
                "ни G98, ни G99 не сказано, на какой уровень выходит инструмент"
            ),
            both!(
                "the control starts in G99, or in what the program before it has left",
                "стойка начинает с G99 или с того, что оставила предыдущая программа"
            ),
        ),
        ReturnLevel::Undecided { line } => (
            codes::BLOCK_DELETE,
            both!(
                "whether G98 or G99 is in force depends on the block delete switch",
                "действует G98 или G99 — зависит от переключателя пропуска кадров"
            ),
            both!(
                "line {line} and those behind it change it and may be skipped",
                "кадры со строки {line} его меняют и могут быть пропущены"
            ),
        ),
    };
    Err(words.refuse(
        refusal!(code; what; label; "write G98 or G99 in this block", "напишите G98 или G99 в этом кадре"),
        words.span(AXIS_LETTERS.or(R)),
    ))
}

/// The dwell of the cycle's own. P beside a cycle without one (G81, G85) is kept for the next, and P of another cycle
/// is not that of pecks: of those only Haas' know one.
fn own_dwell(cycle: &CycleState) -> Option<Decimal> {
    let (time, said_by) = cycle.dwell?;
    let pecks = cycle.kind.pecks();
    let own = if pecks { said_by == cycle.code } else { !WITHOUT_DWELL.contains(&cycle.code) };
    own.then_some(time)
}

/// Where an axis of the plane goes for the next hole: under G91 on from the last one.
fn next(
    words: &Words<'_, '_, '_>,
    state: &Modal,
    frame: &Frame,
    axis: usize,
    from_mm: f64,
    ends: &Axes,
) -> f64 {
    if state.distance == Distance::Absolute {
        return ends.linear[axis].known().unwrap_or(from_mm);
    }
    let inch = state.units == Units::Inch;
    let word = |i: usize| words.coordinate(LINEAR[i], inch).map(|value| value * state.units.mm());
    let [first, second, _] = state.plane.axes();
    let matrix = frame.matrix();
    match (frame.is_shift(), word(axis)) {
        (true, Some(value)) => from_mm + value,
        (true, None) => from_mm,
        (false, _) => {
            from_mm + [first, second].iter().map(|i| matrix[axis][*i] * word(*i).unwrap_or(0.0)).sum::<f64>()
        }
    }
}

/// A cycle under a transformation: rotated about its axis and mirrored beside it, it is the same cycle.
/// Scaled or mirrored along its depth, pecks and retreats are the control's affair.
fn no_scaling(words: &Words<'_, '_, '_>, state: &Modal, normal: usize, cycle: &CycleState) -> Outcome<()> {
    let shifts_aside = cycle.kind == CycleKind::Synchronised && words.has(Q.or(CENTRE_LETTERS));
    if !state.transform.touches()[normal] && (state.transform.is_none() || !shifts_aside) {
        return Ok(());
    }
    Err(words
        .refuse(refusal::cycle_under_frame(&state.transform.name()), words.span(AXIS_LETTERS.or(R).or(Q))))
}

fn position(at: Position) -> Axes {
    Axes { linear: at.linear_mm.map(Axis::At), rotary: at.rotary_deg.map(Axis::At) }
}

/// Takes R, the depth, Q and P into the cycle.
fn read_words(
    words: &Words<'_, '_, '_>,
    state: &Modal,
    cycle: &mut CycleState,
    normal: usize,
    shift_mm: &[f64; 3],
) -> Outcome<()> {
    let inch = state.units == Units::Inch;
    let unit_mm = state.units.mm();
    let incremental = state.distance == Distance::Incremental;
    if let Some(value) = words.coordinate(b'R', inch) {
        let word_mm = value * unit_mm;
        let level_mm = if incremental {
            increment_base(words, cycle.initial, normal)? + word_mm
        } else {
            word_mm + shift_mm[normal]
        };
        cycle.retract = Some(Level { word_mm, incremental, level_mm });
    }
    if let Some(value) = words.coordinate(LINEAR[normal], inch) {
        let word_mm = value * unit_mm;
        let level_mm = if incremental {
            let Some(retract) = cycle.retract else { return Err(incomplete(words, "R")) };
            retract.level_mm + word_mm
        } else {
            word_mm + shift_mm[normal]
        };
        cycle.bottom = Some(Level { word_mm, incremental, level_mm });
    }
    if let Some(value) = words.coordinate(b'Q', inch) {
        if value == 0.0 && cycle.kind.pecks() {
            return Err(words.refuse(refusal::PECK_DEPTH_ZERO, words.span(Q)));
        }
        cycle.peck_mm = Some((value * unit_mm).abs());
    }
    if let Some(value) = words.plain(b'P') {
        let time = words.number(b'P').map(|(number, _)| number.decimal);
        cycle.dwell = time.filter(|_| value > 0.0).map(|time| (time, cycle.code));
    }
    Ok(())
}

/// R level and bottom, axis commands in mm, as the dialect carries them on.
fn levels(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    state: &Modal,
    cycle: &CycleState,
    normal: usize,
    shift_mm: &[f64; 3],
) -> Outcome<(f64, f64)> {
    let Some(retract) = cycle.retract else { return Err(incomplete(words, "R")) };
    let Some(bottom) = cycle.bottom else {
        return Err(incomplete(words, &(LINEAR[normal] as char).to_string()));
    };
    let held = (retract.level_mm, bottom.level_mm);
    let reread = match state.distance {
        Distance::Absolute => (retract.word_mm + shift_mm[normal], bottom.word_mm + shift_mm[normal]),
        Distance::Incremental => {
            let r_mm = increment_base(words, cycle.initial, normal)? + retract.word_mm;
            (r_mm, r_mm + bottom.word_mm)
        }
    };
    let same = (held.0 - reread.0).abs() < SAME_LEVEL_MM && (held.1 - reread.1).abs() < SAME_LEVEL_MM;
    // A new R under G91 with the depth left out: does the bottom move with R? No manual says.
    let depth_may_follow = words.has(R) && !words.has(Letters::of(&[LINEAR[normal]])) && bottom.incremental;
    match env.dialect.cycle_levels {
        _ if same => Ok(held),
        CycleLevels::Reread => Ok(reread),
        CycleLevels::Held if !depth_may_follow => Ok(held),
        CycleLevels::Held | CycleLevels::Unstated => {
            let depth = LINEAR[normal] as char;
            Err(words.refuse(refusal::counted_from_unknown(depth), words.span(AXIS_LETTERS.or(R))))
        }
    }
}

/// A series of holes that begins between R and the bottom: G98 would lead back into the hole, or to R, as LinuxCNC
/// does.
fn begun_beyond_r(env: &Environment<'_>, words: &Words<'_, '_, '_>) -> Outcome<()> {
    if env.dialect.cycle_levels == CycleLevels::Reread {
        return Ok(());
    }
    Err(words.refuse(refusal::LEVEL_BELOW_R, words.span(AXIS_LETTERS.or(R))))
}

/// Some controls drill downwards only, and stop where the bottom would lie above R.
fn below_r(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    state: &Modal,
    r_mm: f64,
    bottom_mm: f64,
) -> Outcome<()> {
    if !env.dialect.bottom_lies_below_r || r_mm >= bottom_mm {
        return Ok(());
    }
    let above_mm = bottom_mm - r_mm;
    let message = both!(
        "the bottom of the hole lies {above_mm:.3} mm above R, and dialect {} stops there",
        "дно отверстия на {above_mm:.3} мм выше R; стойка диалекта {} здесь останавливается",
        env.dialect.name
    );
    let label = both!("R and the depth in force", "действующие R и глубина");
    let help = if state.distance == Distance::Incremental {
        both!(
            "under G91 this control counts R from the level before the cycle and the depth from R, also where an earlier block wrote them: write both again, or take the dialect that the program was posted for",
            "при G91 эта стойка отсчитывает R от уровня до цикла, а глубину от R, даже если их написал прежний кадр: напишите оба снова или возьмите диалект, для которого выведена программа"
        )
    } else {
        both!("correct R or the depth", "исправьте R или глубину")
    };
    let refusal = Refusal { code: codes::CYCLE_WORDS, message, label, help };
    Err(words.refuse(refusal, words.span(AXIS_LETTERS.or(R))))
}

fn incomplete(words: &Words<'_, '_, '_>, missing: &str) -> Box<diagnostic::Diagnostic> {
    words.refuse(refusal::cycle_without(missing), words.span(AXIS_LETTERS.or(R)))
}
