//! HOLES1 and HOLES2: where the holes of a pattern stand.

use diagnostic::both;
use units::math;

use super::arguments::Arguments;
use crate::came::Fault;
use crate::refusals::called as refusal;
use crate::shorthand::Words;

/// Holes of one pattern; more are a wrong count.
const MOST_HOLES: f64 = 10_000.0;
/// Where HOLES1 may begin at either end, in units of the program.
const SAME: f64 = 1e-6;

/// HOLES1(SPCA, SPCO, STA1, FDIS, DBH, NUM): a row, begun at the end that is nearer to where the plane's axes stand.
pub(super) fn row(
    words: &Words<'_, '_>,
    call: &Arguments,
    stands: [Option<f64>; 2],
) -> Result<Vec<[f64; 2]>, Fault> {
    let count = count(words, call, 5)?;
    call.nothing_behind(words, 6)?;
    let (sin, cos) = math::sin_cos_deg(call.or_zero(2));
    let at = |k: usize| {
        let along = call.or_zero(3) + k as f64 * call.or_zero(4);
        [call.or_zero(0) + along * cos, call.or_zero(1) + along * sin]
    };
    let mut places: Vec<[f64; 2]> = (0..count).map(at).collect();
    let [Some(a), Some(b)] = stands else {
        return Err(words.fault(refusal::HOLES1_FROM_UNKNOWN_PLACE, call.span));
    };
    let far = |p: &[f64; 2]| math::hypot(p[0] - a, p[1] - b);
    if let [first, .., last] = places.as_slice() {
        let (to_first, to_last) = (far(first), far(last));
        if (to_first - to_last).abs() < SAME {
            return Err(words.fault(refusal::HOLES1_ENDS_EQUALLY_NEAR, call.span));
        }
        if to_last < to_first {
            places.reverse();
        }
    }
    Ok(places)
}

/// HOLES2(CPA, CPO, RAD, STA1, INDA, NUM): a circle, from its first angle on; without INDA all around.
pub(super) fn circle(words: &Words<'_, '_>, call: &Arguments) -> Result<Vec<[f64; 2]>, Fault> {
    let count = count(words, call, 5)?;
    call.nothing_behind(words, 6)?;
    let radius = call.or_zero(2).abs();
    let step = match call.or_zero(4) {
        0.0 => 360.0 / count as f64,
        step => step,
    };
    let at = |k: usize| {
        let (sin, cos) = math::sin_cos_deg(call.or_zero(3) + k as f64 * step);
        [call.or_zero(0) + radius * cos, call.or_zero(1) + radius * sin]
    };
    Ok((0..count).map(at).collect())
}

fn count(words: &Words<'_, '_>, call: &Arguments, place: usize) -> Result<usize, Fault> {
    let count = call.needed(words, place, &both!("a number of holes", "числа отверстий"))?;
    if !(1.0..=MOST_HOLES).contains(&count) || count.fract() != 0.0 {
        return Err(words.fault(refusal::number_of_holes(&call.name, count), call.span));
    }
    Ok(count as usize)
}
