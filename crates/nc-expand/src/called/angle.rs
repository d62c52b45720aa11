//! An arc by its angle: `G3 X Y AR=90` and `G2 I J AR=90`.
//!
//! Source: SINUMERIK 840D sl Programming Manual Fundamentals, circular interpolation with opening angle. With the angle a
//! between 0 and 360 degrees, d the way from start S to end E in the plane and n its normal to the left:
//!
//! * by the end: the centre is (S + E)/2 ± n · |d|/2 / tan(a/2), to the left for G3, to the right for G2;
//! * by the centre C: the end is S turned about C by a, counterclockwise for G3.
//!
//! The numbers written have 6 decimals.

use diagnostic::{Text, both};
use nc_dialect::Action;
use nc_program::modal::Modal;
use units::math;

use crate::known::{Motion, motion};
use crate::shorthand::{AXES, Words, number};

/// Radii and ways below this are none, in units of the program.
const NOTHING: f64 = 1e-6;

/// The words that an arc's angle stands for, each with a blank before it.
///
/// * `modal` – before the block moves, its codes executed
/// * `words` – the block without `AR=`
/// * `degrees` – the angle
///
/// # Errors
/// Why the arc cannot be told.
pub(super) fn words(modal: &Modal, words: &Words<'_, '_>, degrees: f64) -> Result<Vec<u8>, Text> {
    if !(degrees > 0.0 && degrees < 360.0) {
        return Err(both!(
            "an angle between 0 and 360 degrees was expected",
            "ожидался угол от 0 до 360 градусов"
        ));
    }
    if motion(modal) != Motion::Arc {
        return Err(both!("G2 or G3 was expected in the same block", "в том же кадре ожидалось G2 или G3"));
    }
    let clockwise = words.actions().any(|(action, _)| *action == Action::ArcClockwise);
    let counter = words.actions().any(|(action, _)| *action == Action::ArcCounterClockwise);
    if clockwise == counter {
        return Err(both!("G2 or G3 was expected in the same block", "в том же кадре ожидалось G2 или G3"));
    }
    let ([u, v, _], at) = (modal.plane.axes(), modal.places());
    let (Some(a), Some(b)) = (at[u], at[v]) else {
        return Err(both!(
            "where the arc starts is not known: name both axes of the plane before it, in G90",
            "неизвестно, откуда начинается дуга: назовите до неё обе оси плоскости при G90"
        ));
    };
    let centres = [b"IJK"[u], b"IJK"[v]];
    let has = |letters: [u8; 2]| letters.map(|letter| words.number(letter).is_some());
    let mut line = b" ".to_vec();
    let mut word = |letter: u8, value: f64| number(&mut line, letter, value);
    match (has([AXES[u], AXES[v]]), has(centres)) {
        (ends, [false, false]) if ends != [false, false] => {
            let end = words.end(modal);
            let [Some(end_a), Some(end_b)] = [end[u], end[v]] else {
                return Err(both!("where the arc ends is not known", "неизвестно, где кончается дуга"));
            };
            let way = [end_a - a, end_b - b];
            if math::hypot(way[0], way[1]) < NOTHING {
                return Err(both!("its end is its start", "её конец — её же начало"));
            }
            let (sin, cos) = math::sin_cos_deg(0.5 * degrees);
            let reach = if clockwise { -0.5 } else { 0.5 } * cos / sin;
            word(centres[0], 0.5 * way[0] - reach * way[1]);
            word(centres[1], 0.5 * way[1] + reach * way[0]);
        }
        ([false, false], [true, _] | [_, true]) => {
            let centre = centres.map(|letter| words.length(letter, modal.units).unwrap_or_default());
            if math::hypot(centre[0], centre[1]) < NOTHING {
                return Err(both!("its radius is zero", "её радиус равен нулю"));
            }
            let (sin, cos) = math::sin_cos_deg(if clockwise { -degrees } else { degrees });
            let end = [
                a + centre[0] - cos * centre[0] + sin * centre[1],
                b + centre[1] - sin * centre[0] - cos * centre[1],
            ];
            let from = if modal.says_places() { [0.0; 2] } else { [a, b] };
            word(AXES[u], end[0] - from[0]);
            word(AXES[v], end[1] - from[1]);
        }
        _ => {
            return Err(both!(
                "its end or its centre was expected, one of the two",
                "ожидались её конец или центр, что-то одно"
            ));
        }
    }
    Ok(line)
}
