//! One hole of a called cycle as moves along the axis of drilling.
//!
//! Source: SINUMERIK 840D/840Di/810D Programming Guide Cycles, sections 2.1.2 (CYCLE81), 2.1.3 (CYCLE82), 2.1.4
//! (CYCLE83), 2.1.7 (CYCLE85) and 2.1.8 (CYCLE86). Lengths in units of the program, along the axis that stands upright
//! on the plane.

use diagnostic::{Text, both};
use nc_dialect::Called;
use toolpath::{MOST_PECKS, Retreat, Stroke, strokes};

use super::arguments::Arguments;
use crate::came::Fault;
use crate::refusals::called as refusal;
use crate::shorthand::Words;

/// How far chip breaking goes back where no argument says it, mm.
const CHIP_MM: f64 = 1.0;
/// How far above the depth reached the feed begins again in a hole of up to 30 mm, mm.
const SHALLOW_MM: f64 = 0.6;
const SHALLOW_DEPTH_MM: f64 = 30.0;
/// In deeper ones, of the depth; and never more than so much, mm.
const DEEP_SHARE: f64 = 1.0 / 50.0;
const DEEP_MOST_MM: f64 = 7.0;
/// A peck below this is none: the last bits of a sum, in units of the program.
const NOTHING: f64 = 1e-9;

/// `_AMODE` of extended cycles: the tens say that the dwell counts seconds, as one above zero does by itself. A post that
/// writes one part with extended cycles and without has this argument there and none here.
const SECONDS: [f64; 1] = [10.0];
/// The same of the three dwells of CYCLE83, whichever digit is whose.
const ALL_SECONDS: [f64; 7] = [10.0, 100.0, 110.0, 1000.0, 1010.0, 1100.0, 1110.0];

/// What `_AMODE` may be beside a dwell.
fn in_seconds(time: f64) -> &'static [f64] {
    if time >= 0.0 { &SECONDS } else { &[] }
}

/// What the spindle does along its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Move {
    Rapid(f64),
    Feed(f64),
    /// To a height at a feed of its own.
    FeedAt(f64, f64),
    /// Above zero seconds, below it turns of the spindle.
    Dwell(f64),
    /// M3 or M4.
    Spindle(u8),
    /// The spindle stops at an angle, degrees.
    Orient(f64),
    /// A rapid by so much along the axes of the plane and the axis drilled along.
    Aside([f64; 3]),
    /// A rapid back over the hole, to a height.
    Over(f64),
}

/// A hole, wherever it stands.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hole {
    pub(super) moves: Vec<Move>,
    /// Some move is at the feed in force.
    pub(super) takes_feed: bool,
    /// It leaves a feed of its own in force, which the manual does not say: the next feed move must name one.
    pub(super) leaves_feed: bool,
    /// It leaves the spindle stopped at an angle, or turning: the manual does not say.
    pub(super) leaves_spindle: bool,
}

/// Planes of a hole.
struct Planes {
    /// Retraction plane.
    out: f64,
    /// Reference plane.
    reference: f64,
    /// The reference plane brought forward by the safety distance.
    near: f64,
    /// Final depth.
    bottom: f64,
    /// From the reference plane to the bottom: 1 or -1.
    inwards: f64,
}

impl Planes {
    /// RTP, RFP, SDIS, DP, DPR.
    fn read(words: &Words<'_, '_>, call: &Arguments) -> Result<Self, Fault> {
        let out = call.needed(words, 0, &both!("the retraction plane", "плоскости отвода"))?;
        let reference = call.or_zero(1);
        let safety = call.or_zero(2).abs();
        let bottom = match (call.at(3), call.or_zero(4).abs()) {
            (Some(bottom), 0.0) => bottom,
            (None, 0.0) => {
                return Err(words.fault(refusal::without_depth(&call.name), call.span));
            }
            (bottom, deep) => {
                // The retraction plane lies on the side that the tool comes from.
                let relative = reference - deep * (out - reference).signum();
                if bottom.is_some_and(|bottom| bottom != 0.0 && (bottom - relative).abs() > NOTHING) {
                    return Err(words.fault(refusal::with_two_depths(&call.name), call.span));
                }
                relative
            }
        };
        let inwards = (bottom - reference).signum();
        let near = reference - inwards * safety;
        if bottom == reference || (out - near) * inwards > NOTHING {
            return Err(words.fault(refusal::planes_out_of_order(&call.name), call.span));
        }
        Ok(Self { out, reference, near, bottom, inwards })
    }
}

impl Hole {
    /// The moves of a cycle's call; `unit_mm` is one unit of the program, `axis` the number of the axis drilled along.
    pub(super) fn read(
        words: &Words<'_, '_>,
        cycle: Called,
        call: &Arguments,
        unit_mm: f64,
        axis: usize,
    ) -> Result<Self, Fault> {
        let planes = Planes::read(words, call)?;
        let Planes { out, near, bottom, .. } = planes;
        let mut moves = vec![Move::Rapid(near)];
        match cycle {
            Called::DrillPecks => pecks(words, call, &planes, unit_mm, axis, &mut moves)?,
            Called::DrillDwell => {
                moves.push(Move::Feed(bottom));
                dwell(call.or_zero(5), &mut moves);
                call.chooses_nothing(words, 6, &[(8, in_seconds(call.or_zero(5)))])?;
            }
            Called::BoreFeeds => bore(words, call, &planes, &mut moves)?,
            Called::BoreOriented => {
                oriented(words, call, &planes, &mut moves)?;
                return Ok(Self { moves, takes_feed: true, leaves_feed: false, leaves_spindle: true });
            }
            _ => {
                moves.push(Move::Feed(bottom));
                // Some posts and controls have a dwell as argument 6, and the others one place behind.
                let short: &[(usize, &[f64])] =
                    if call.count() > 8 { &[(8, &SECONDS)] } else { &[(7, &SECONDS)] };
                call.chooses_nothing(words, 5, short)?;
            }
        }
        moves.push(Move::Rapid(out));
        let own_feed = cycle == Called::BoreFeeds;
        Ok(Self { moves, takes_feed: !own_feed, leaves_feed: own_feed, leaves_spindle: false })
    }
}

/// CYCLE85: behind RTP, RFP, SDIS, DP, DPR stand DTB, FFR, RFF.
fn bore(
    words: &Words<'_, '_>,
    call: &Arguments,
    planes: &Planes,
    moves: &mut Vec<Move>,
) -> Result<(), Fault> {
    let Planes { near, bottom, .. } = *planes;
    let feed = |place: usize, what: Text| {
        let feed = call.needed(words, place, &what)?;
        if feed > 0.0 {
            return Ok(feed);
        }
        Err(words.fault(refusal::with_feed(&call.name, feed, place + 1), call.span))
    };
    let inwards = feed(6, both!("the feed inwards", "подачи внутрь"))?;
    let outwards = feed(7, both!("the feed outwards", "подачи наружу"))?;
    call.nothing_behind(words, 8)?;
    moves.push(Move::FeedAt(bottom, inwards));
    dwell(call.or_zero(5), moves);
    moves.push(Move::FeedAt(near, outwards));
    Ok(())
}

/// CYCLE86: behind RTP, RFP, SDIS, DP, DPR stand DTB, SDIR, RPA, RPO, RPAP, POSS.
fn oriented(
    words: &Words<'_, '_>,
    call: &Arguments,
    planes: &Planes,
    moves: &mut Vec<Move>,
) -> Result<(), Fault> {
    let Planes { out, near, bottom, .. } = *planes;
    let turns = match call.needed(words, 6, &both!("a direction of the spindle", "направления шпинделя"))?
    {
        3.0 => 3,
        4.0 => 4,
        other => {
            return Err(words.fault(refusal::with_spindle_direction(&call.name, other), call.span));
        }
    };
    call.chooses_nothing(words, 11, &[(13, in_seconds(call.or_zero(5)))])?;
    moves.insert(0, Move::Spindle(turns));
    moves.push(Move::Feed(bottom));
    dwell(call.or_zero(5), moves);
    moves.push(Move::Orient(call.or_zero(10)));
    let aside = [7, 8, 9].map(|place| call.or_zero(place));
    if aside != [0.0; 3] {
        moves.push(Move::Aside(aside));
    }
    moves.extend([Move::Rapid(near), Move::Over(out)]);
    Ok(())
}

fn dwell(time: f64, moves: &mut Vec<Move>) {
    if time != 0.0 {
        moves.push(Move::Dwell(time));
    }
}

/// CYCLE83 from its first peck to its last: behind RTP, RFP, SDIS, DP, DPR stand FDEP, FDPR, DAM, DTB, DTS, FRF, VARI,
/// _AXN, _MDEP, _VRT, _DTD, _DIS1.
fn pecks(
    words: &Words<'_, '_>,
    call: &Arguments,
    planes: &Planes,
    unit_mm: f64,
    axis: usize,
    moves: &mut Vec<Move>,
) -> Result<(), Fault> {
    let Planes { reference, near, bottom, inwards, .. } = *planes;
    let whole = (bottom - reference).abs();
    let first = match (call.at(5), call.or_zero(6).abs()) {
        (_, deep) if deep > 0.0 => deep,
        (Some(at), _) => (at - reference) * inwards,
        (None, _) => whole,
    };
    let less = call.or_zero(7);
    if first <= 0.0 || less < 0.0 {
        return Err(words.fault(refusal::CYCLE83_WITH_SHRINKING_PECKS, call.span));
    }
    let factor = call.at(10).unwrap_or(1.0);
    if factor != 0.0 && factor != 1.0 {
        return Err(words.fault(refusal::CYCLE83_WITH_FEED_FACTOR, call.span));
    }
    let along = call.or_zero(12);
    if along != 0.0 && along != (axis + 1) as f64 {
        return Err(words.fault(refusal::CYCLE83_ALONG_ANOTHER_AXIS, call.span));
    }
    let chips_out = match call.or_zero(11) {
        0.0 => false,
        1.0 => true,
        _ => return Err(words.fault(refusal::CYCLE83_OF_UNKNOWN_KIND, call.span)),
    };
    let stay = [8, 9, 15].map(|place| call.or_zero(place));
    let seconds: &[f64] = if stay.iter().all(|time| *time >= 0.0) { &ALL_SECONDS } else { &[] };
    call.chooses_nothing(words, 17, &[(19, seconds)])?;
    let [at_bottom, at_start, own] = stay;
    let last = if own == 0.0 { at_bottom } else { own };
    let back = match call.or_zero(14) {
        0.0 => CHIP_MM / unit_mm,
        own => own.abs(),
    };
    let ahead = match call.or_zero(16) {
        0.0 => ahead_mm(whole * unit_mm) / unit_mm,
        own => own.abs(),
    };
    let lengths = lengths(whole, first.min(whole), less)
        .ok_or_else(|| words.fault(refusal::too_many_pecks(MOST_PECKS), call.span))?;
    // Strokes count from the reference plane, depths from where the drill comes to.
    let mut deep = (near - reference).abs();
    let mut depths = Vec::with_capacity(lengths.len());
    for length in lengths {
        deep += length;
        depths.push(deep);
    }
    let whole = (bottom - near).abs();
    if let Some(last_depth) = depths.last_mut() {
        *last_depth = whole;
    }
    let place = |depth: f64| near + inwards * depth;
    let retreat = if chips_out { Retreat::Out { clearance: ahead } } else { Retreat::Back { by: back } };
    for stroke in strokes(depths.into_iter(), retreat) {
        match stroke {
            Stroke::In(depth) => {
                let (to, time) = if depth == whole { (bottom, last) } else { (place(depth), at_bottom) };
                moves.push(Move::Feed(to));
                dwell(time, moves);
            }
            Stroke::Out => {
                moves.push(Move::Rapid(near));
                dwell(at_start, moves);
            }
            // Never out of the hole on the way in.
            Stroke::Again(depth) if chips_out => moves.push(Move::Rapid(place(depth))),
            Stroke::Again(depth) => moves.push(Move::Feed(place(depth))),
        }
    }
    Ok(())
}

/// How far above the last depth the drill slows down where the call does not say it, mm.
fn ahead_mm(whole_mm: f64) -> f64 {
    if whole_mm <= SHALLOW_DEPTH_MM { SHALLOW_MM } else { (whole_mm * DEEP_SHARE).min(DEEP_MOST_MM) }
}

/// How long the strokes of a hole are: each shorter than the one before it by `less` until it is no longer than that;
/// the last two share what is left where the strokes shrink.
fn lengths(whole: f64, first: f64, less: f64) -> Option<Vec<f64>> {
    let mut lengths = vec![first];
    let mut left = whole - first;
    let mut stroke = first;
    while left > NOTHING {
        if lengths.len() >= MOST_PECKS as usize {
            return None;
        }
        if stroke - less > less {
            stroke -= less;
        } else if less > 0.0 {
            stroke = less;
        }
        if left <= stroke + NOTHING {
            lengths.push(left);
            break;
        }
        if less > 0.0 && left < 2.0 * stroke {
            lengths.extend([0.5 * left, 0.5 * left]);
            break;
        }
        lengths.push(stroke);
        left -= stroke;
    }
    Some(lengths)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_shrink_to_the_degression_and_the_last_two_share_the_rest() {
        // 150 mm, first 50, less 20: 50, 30, then 20 as long as more than 40 are left, the rest halved.
        let found = lengths(150.0, 50.0, 20.0).unwrap();
        assert_eq!(found, [50.0, 30.0, 20.0, 20.0, 15.0, 15.0]);
        assert_eq!(found.iter().sum::<f64>(), 150.0);
        assert_eq!(lengths(10.0, 4.0, 0.0).unwrap(), [4.0, 4.0, 2.0]);
        assert_eq!(lengths(10.0, 10.0, 0.0).unwrap(), [10.0]);
        assert!(lengths(10.0, 1e-4, 0.0).is_none());
    }
}
