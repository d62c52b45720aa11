//! G2 and G3: the words of an arc, and what they say of its circle.

use diagnostic::{Diagnostic, Text, both};
use toolpath::{Arc, Feed, Motion, Shape};

use crate::arc::{self, Circle, Fault, Tolerance};
use crate::codes;
use crate::frames::settle;
use crate::modal::{ArcCentres, Modal, Turn, Units};
use crate::motion::{Motions, arc_while_turning, division, feed_rate};
use crate::position::{end, require_frame, require_known};
use crate::settings::Environment;
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
        return Err(arc_while_turning(words));
    }
    let turns = turns(env, words)?;
    let [first, second, _] = state.plane.axes();
    let plane = |point: &[f64; 3]| [point[first], point[second]];
    let Some(similarity) = frame.similarity(state.plane) else {
        return Err(words
            .refuse(
                codes::FRAME,
                both!("an arc under {}", "дуга, пока действует {:#}", state.transform.name()),
                words.span(AXIS_LETTERS.or(ARC_LETTERS)),
                both!(
                    "the frame makes it an ellipse or turns it out of its plane",
                    "система координат делает из неё эллипс или поворачивает её из плоскости"
                ),
            )
            .help(both!(
                "let the CAM write the arc as lines, or scale all axes alike",
                "выводите дугу из CAM прямыми или масштабируйте все оси одинаково"
            )));
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
            return Err(words
                .refuse(
                    codes::ARC_WORDS,
                    both!("R and a centre in one arc", "в одной дуге и R, и центр"),
                    span,
                    both!("which one?", "какое из двух?"),
                )
                .help(both!("remove R or {}", "уберите R или {}", words.names(CENTRE_LETTERS))));
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
        let message = both!("an arc of {turns} turns", "дуга в несколько оборотов: {turns}");
        return Err(words
            .refuse(
                codes::ARC_WORDS,
                message,
                words.span(P),
                both!("1 to {MOST} were expected", "ожидалось от 1 до {MOST}"),
            )
            .help(both!(
                "write P1, or no P, for an arc of at most one turn",
                "для дуги не больше оборота напишите P1 или ничего"
            )));
    }
    match words.plain(b'P') {
        Some(turns) if (turns - 1.0).abs() > 1e-9 => Err(words
            .refuse(
                codes::ARC_WORDS,
                both!("P beside an arc", "P рядом с дугой"),
                words.span(P),
                both!(
                    "turns on some controls, nothing on others",
                    "на одних стойках обороты, на других ничего"
                ),
            )
            .help(both!("write one block for each turn", "напишите на каждый оборот свой кадр"))),
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
            let message = both!(
                "{} on an arc whose plane has {one} and {two}",
                "{} у дуги, в плоскости которой {one} и {two}",
                letter as char
            );
            return Err(words
                .refuse(
                    codes::ARC_WORDS,
                    message,
                    words.span(across),
                    both!("not in this plane", "не в этой плоскости"),
                )
                .help(both!(
                    "select the arc's plane with G17, G18 or G19, or remove the word",
                    "выберите плоскость дуги функцией G17, G18 или G19 или уберите слово"
                )));
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
                both!(
                    "half a centre under absolute arc centres",
                    "половина центра при абсолютных центрах дуг"
                ),
                words.span(in_plane),
                both!("{one} and {two} were expected", "ожидались {one} и {two}"),
            )
            .help(both!(
                "write both {one} and {two}, or G91.1 for centres from the start",
                "напишите и {one}, и {two} или включите G91.1: центр от начала дуги"
            ))),
    }
}

fn without_centre(words: &Words<'_, '_, '_>, one: char, two: char) -> Box<Diagnostic> {
    words
        .refuse(
            codes::ARC_WITHOUT_CENTRE,
            both!("arc without centre", "дуга без центра"),
            words.span(AXIS_LETTERS.or(ARC_LETTERS)),
            both!("neither {one}/{two} nor R in this block, and neither is modal", "в этом кадре нет ни {one}/{two}, ни R, а модально ни одно из них не действует"),
        )
        .help(both!("post the program again so that each arc block has its {one} and {two} (some posts drop unchanged ones), or add R", "выведите программу заново, чтобы в каждом кадре дуги были {one} и {two} (некоторые постпроцессоры опускают повторные), или добавьте R"
        ))
}

fn no_circle(words: &Words<'_, '_, '_>, state: &Modal, fault: Fault) -> Box<Diagnostic> {
    let [one, two] = shown_letters(state);
    let (unit_mm, unit) = match state.units {
        Units::Millimetre => (1.0, Text::pair("mm", "мм")),
        Units::Inch => (25.4, Text::pair("inch", "дюйма")),
    };
    let show = |mm: f64| shortest(mm / unit_mm);
    let centre = words.span(ARC_LETTERS);
    match fault {
        Fault::NoRadius => words
            .refuse(
                codes::ARC_WORDS,
                both!(
                    "an arc that starts or ends in its centre",
                    "дуга начинается или кончается в своём центре"
                ),
                centre,
                both!("no direction leads from there", "оттуда нет направления"),
            )
            .help(both!(
                "write the distance from the start to the centre as {one} and {two}, or a line",
                "напишите расстояние от начала до центра словами {one} и {two} или прямую"
            )),
        Fault::RadiiDiffer { start_mm, end_mm, allowed_mm } => {
            let message = both!(
                "the ends of the arc lie at different distances from its centre",
                "концы дуги лежат на разных расстояниях от её центра"
            );
            let label = both!(
                "radius {} at the start, {} {unit} at the end, {} allowed",
                "радиус в начале {}, в конце {} {unit:#}, допускается {}",
                show(start_mm),
                show(end_mm),
                show(allowed_mm)
            );
            let mode = match state.arc_centres {
                ArcCentres::Incremental => {
                    both!("measured from the start (G91.1)", "отсчитанные от начала (G91.1)")
                }
                ArcCentres::Absolute => both!("absolute (G90.1)", "абсолютные (G90.1)"),
            };
            words.refuse(codes::RADII_DIFFER, message, centre, label).help(both!(
                "correct the end or the centre ({one} and {two} are read as {mode}); where the control takes more, say so with `arc_tolerance_mm` under `[program]` in the profile",
                "исправьте конец или центр ({one} и {two} прочитаны как {mode:#}); если стойка допускает больше, скажите это ключом `arc_tolerance_mm` в разделе `[program]` профиля"
            ))
        }
        Fault::RadiusTooSmall { radius_mm, chord_mm } => {
            // Rounded up, so that the number can be typed as it stands.
            let least = (chord_mm / unit_mm / 2.0 * 1e4 - 1e-6).ceil() / 1e4;
            words
                .refuse(
                    codes::RADIUS_TOO_SMALL,
                    both!("arc radius is smaller than half the chord", "радиус дуги меньше половины хорды"),
                    centre,
                    both!(
                        "R{} {unit}, chord is {} {unit}",
                        "R{} {unit:#}, а хорда {} {unit:#}",
                        show(radius_mm),
                        show(chord_mm)
                    ),
                )
                .help(both!(
                    "use {one}/{two} centre form, or R of at least {}",
                    "задайте центр словами {one}/{two} или R не меньше {}",
                    shortest(least)
                ))
        }
        Fault::FullCircleByRadius => words
            .refuse(
                codes::ARC_WORDS,
                both!("a full circle by R", "полная окружность через R"),
                centre,
                both!(
                    "start and end are the same point: R has no centre",
                    "начало и конец в одной точке: по R центра не найти"
                ),
            )
            .help(both!("use {one}/{two} centre form", "задайте центр словами {one}/{two}")),
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
