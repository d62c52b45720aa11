//! G2 and G3: the words of an arc, and what they say of its circle.

use diagnostic::{Diagnostic, Text, both};
use toolpath::{Arc, Feed, Motion, Shape};

use crate::arc::{self, Circle, Fault, Tolerance};
use crate::environment::Environment;
use crate::feed::feed_rate;
use crate::frame_state::settle;
use crate::modal::{ArcCentres, Modal, Turn, Units};
use crate::moved::Motions;
use crate::offset::division;
use crate::position::{end, require_frame, require_known};
use crate::refusals::circular as refusal;
use crate::words::{ARC_LETTERS, AXIS_LETTERS, CENTRE_LETTERS, Outcome, Words};
use nc_syntax::Letters;

/// G2 and G3.
pub(crate) fn circular(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    before: &Modal,
    state: &mut Modal,
    turn: Turn,
    motions: &mut Motions,
) -> Outcome<()> {
    settle(words, state)?;
    let frame = require_frame(env, words, state)?.clone();
    let start = state.axes;
    let end = end(words, state, &frame)?;
    let what = &Text::pair("the arc", "дуга");
    let from = require_known(words, &start, what)?;
    let to = require_known(words, &end, what)?;
    let turning = from.rotary_deg != to.rotary_deg;
    if turning && env.setup.rotary_matters {
        return Err(words.refuse(refusal::ROTARY_AXIS_TURNS_ALONG_ARC, words.span(AXIS_LETTERS)));
    }
    let turns = turns(env, words)?;
    let [first, second, _] = state.plane.axes();
    let plane = |point: &[f64; 3]| [point[first], point[second]];
    let Some(similarity) = frame.similarity(state.plane) else {
        return Err(words.refuse(
            refusal::arc_under_frame(&state.transform.name()),
            words.span(AXIS_LETTERS.or(ARC_LETTERS)),
        ));
    };
    // The words say the circle in program coordinates. A shifted frame has the same circle in axis
    // commands; a turned or mirrored one must be asked.
    let shift = frame.is_shift();
    let local = |point: &[f64; 3]| plane(&if shift { *point } else { frame.to_program(*point) });
    let (start_2d, end_2d) = (local(&from.linear_mm), local(&to.linear_mm));
    let origin = if shift { plane(&frame.offset_mm()) } else { [0.0; 2] };
    let output = &env.dialect.output;
    let absolute_mm = output.arc_tolerance_mm(state.units.mm());
    let tolerance = Tolerance { absolute_mm, share: output.arc_radius_tolerance_share };
    let inch = state.units == Units::Inch;
    let circle = match words.coordinate(b'R', inch) {
        Some(_) if words.has(CENTRE_LETTERS) => {
            let span = words.span(ARC_LETTERS);
            return Err(words.refuse(refusal::r_and_centre_in_one_arc(&words.names(CENTRE_LETTERS)), span));
        }
        Some(radius) => {
            arc::by_radius(start_2d, end_2d, radius * state.units.mm(), turn, tolerance.absolute_mm)
        }
        None => {
            let centre = centre(words, state, start_2d, origin)?;
            arc::by_centre(start_2d, end_2d, centre, turn, tolerance)
        }
    };
    let Circle { centre_mm, sweep_rad } = circle.map_err(|fault| no_circle(words, state, fault))?;
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
    let radius_mm =
        units::math::hypot(from.linear_mm[first] - centre_mm[0], from.linear_mm[second] - centre_mm[1]);
    let ends_mm = [from.linear_mm, to.linear_mm];
    let division = division(before, state, turning, ends_mm, Some((radius_mm, sweep_rad > 0.0)));
    motions.push(Motion::Feed(Feed { start: from, end: to, shape, rate, division }));
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
        return Err(words.refuse(refusal::arc_of_turns(turns, MOST), words.span(P)));
    }
    match words.plain(b'P') {
        Some(turns) if (turns - 1.0).abs() > 1e-9 => Err(words.refuse(refusal::P_BESIDE_ARC, words.span(P))),
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
    let shown = shown_letters(state);
    let in_plane = Letters::of(&letters);
    let across = CENTRE_LETTERS.without(in_plane);
    let inch = state.units == Units::Inch;
    if words.has(across) {
        let letter = across.first();
        // `K0` on a G17 arc is how some posts write nothing.
        if words.coordinate(letter, inch) != Some(0.0) {
            return Err(
                words.refuse(refusal::centre_of_another_plane(letter as char, shown), words.span(across))
            );
        }
    }
    if !words.has(in_plane) {
        return Err(without_centre(words, shown));
    }
    let values = letters.map(|letter| words.coordinate(letter, inch).map(|value| value * state.units.mm()));
    match (state.arc_centres, values) {
        (ArcCentres::Incremental, [i, j]) => {
            Ok([start_mm[0] + i.unwrap_or(0.0), start_mm[1] + j.unwrap_or(0.0)])
        }
        (ArcCentres::Absolute, [Some(i), Some(j)]) => Ok([i + shift_mm[0], j + shift_mm[1]]),
        (ArcCentres::Absolute, _) => {
            Err(words.refuse(refusal::half_an_absolute_centre(shown), words.span(in_plane)))
        }
    }
}

fn without_centre(words: &Words<'_, '_, '_>, letters: [char; 2]) -> Box<Diagnostic> {
    words.refuse(refusal::arc_without_centre(letters), words.span(AXIS_LETTERS.or(ARC_LETTERS)))
}

fn no_circle(words: &Words<'_, '_, '_>, state: &Modal, fault: Fault) -> Box<Diagnostic> {
    let letters = shown_letters(state);
    let (unit_mm, unit) = match state.units {
        Units::Millimetre => (1.0, Text::pair("mm", "мм")),
        Units::Inch => (25.4, Text::pair("inch", "дюйма")),
    };
    let show = |mm: f64| shortest(mm / unit_mm);
    let centre = words.span(ARC_LETTERS);
    match fault {
        Fault::NoRadius => words.refuse(refusal::end_in_the_centre(letters), centre),
        Fault::RadiiDiffer { start_mm, end_mm, allowed_mm } => {
            let mode = match state.arc_centres {
                ArcCentres::Incremental => {
                    both!("measured from the start (G91.1)", "отсчитанные от начала (G91.1)")
                }
                ArcCentres::Absolute => both!("absolute (G90.1)", "абсолютные (G90.1)"),
            };
            let found = [start_mm, end_mm, allowed_mm].map(show);
            words.refuse(refusal::radii_differ(found, &unit, letters, &mode), centre)
        }
        Fault::RadiusTooSmall { radius_mm, chord_mm } => {
            // Rounded up, so that the number can be typed as it stands.
            let least = (chord_mm / unit_mm / 2.0 * 1e4 - 1e-6).ceil() / 1e4;
            let found = [radius_mm, chord_mm].map(show);
            let least = shortest(least);
            let radius = format!("R{least}");
            words.refuse_in_place_of(radius, refusal::radius_too_small(found, &unit, letters, least), centre)
        }
        Fault::FullCircleByRadius => words.refuse(refusal::full_circle_by_r(letters), centre),
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
