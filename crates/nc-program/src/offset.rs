//! Cutter compensation motion by motion: which of its blocks may be written as several.
//!
//! Under G41 and G42 the control makes the tool's path of the programmed contour, block by block. The block that leads
//! onto the contour and the one that leads off it mean another path when they are cut, and so does a block with another
//! D. The blocks between are offset alike whether a line or an arc is one block or two that go on from one another, as
//! long as each is long enough for the tool to reach both of its ends: how long, only the tool's radius says.

use toolpath::{Division, Motion, Partial};

use nc_dialect::{Action, Side};
use nc_syntax::Letters;

use crate::environment::Environment;
use crate::modal::{Compensation, Modal};
use crate::under_way::{Offset, Stage};
use crate::words::{Preparatory, Words};

/// Shortest piece of an offset path, in radii: in front of an inner corner of 37 degrees the tool stops three radii
/// before it. Where a corner is sharper the control may refuse the output; it never cuts another path.
const LEAST_RADII: f64 = 3.0;
/// A move in the plane shorter than this is none, mm.
const STANDS_MM: f64 = 1e-9;
/// A climb across the plane below this share of the way is what a correction may make of a level block: tables of
/// machines climb by some 1e-4 of the way.
const LEVEL_SHARE: f64 = 1e-3;
/// No arc is offset to a radius below this share of its own.
const LEAST_SHARE: f64 = 0.01;

/// What a block's codes and its D make of the compensation, before its motion.
pub(crate) fn begin(env: &Environment<'_>, words: &Words<'_, '_, '_>, before: &Modal, state: &mut Modal) {
    const D: Letters = Letters::of(b"D");
    let asks = words.codes.iter().any(|code| matches!(code.entry.action, Action::Compensation(_)));
    match state.compensation {
        Compensation::Off => {
            if before.compensation != Compensation::Off {
                state.offset.stage = Stage::Ending;
            }
        }
        Compensation::On(_) if asks || words.has(D) || before.compensation != state.compensation => {
            let radius_nm = radius_nm(env, words);
            state.offset = Offset { stage: Stage::Starting, radius_nm };
        }
        Compensation::On(_) => {}
    }
}

/// The radius of a block's D, nm.
fn radius_nm(env: &Environment<'_>, words: &Words<'_, '_, '_>) -> Option<u32> {
    // D beside G41.1 is the diameter itself; D1 of Siemens is an edge of the tool that T names.
    let by_diameter = |code: &Preparatory<'_>| {
        matches!(code.entry.action, Action::Compensation(_)) && !code.entry.code.0.is_multiple_of(10)
    };
    if env.dialect.edge_in_d || words.codes.iter().any(by_diameter) {
        return None;
    }
    let number = words.plain(b'D').filter(|number| *number >= 1.0 && number.fract() == 0.0)?;
    let known = |(known, _): &&(u32, f64)| f64::from(*known) == number;
    let (_, radius_mm) = env.setup.radii_mm.iter().find(known)?;
    let nm = (radius_mm * 1e6).ceil();
    (nm >= 1.0 && nm <= f64::from(u32::MAX)).then_some(nm as u32)
}

/// Behind a block's motions.
pub(crate) fn end(state: &mut Modal, motions: &[Motion]) {
    if state.offset.stage == Stage::Led
        && motions.iter().any(|motion| matches!(motion, Motion::Uncorrected { .. }))
    {
        // A reference return gives the offset up; the next motion leads onto the contour again.
        state.offset.stage = Stage::Starting;
    }
    if !matches!(state.offset.stage, Stage::Starting | Stage::Ending) {
        return;
    }
    let [u, v, _] = state.plane.axes();
    let moves = motions.iter().any(|motion| {
        let (start, end) = match motion {
            Motion::Feed(feed) => (Partial::from(feed.start), Partial::from(feed.end)),
            Motion::Rapid { start, end } => (*start, *end),
            Motion::Hole(_) | Motion::Uncorrected { .. } => return false,
        };
        [u, v].iter().any(|axis| match (start.linear_mm[*axis], end.linear_mm[*axis]) {
            (Some(from), Some(to)) => (to - from).abs() > STANDS_MM,
            _ => false,
        })
    });
    if moves {
        state.offset.stage = if state.offset.stage == Stage::Starting { Stage::Led } else { Stage::Off };
    }
}

/// G41 or G42 is in force before or after a block.
pub(crate) fn compensated(before: &Modal, state: &Modal) -> bool {
    [before, state].iter().any(|state| state.compensation != Compensation::Off)
}

/// What may become of a feed's block.
///
/// * `ends_mm` – its start and end, axis commands
/// * `bend` – of an arc: its radius, mm, and whether it turns counterclockwise in the plane
pub(crate) fn division(
    before: &Modal,
    state: &Modal,
    turns: bool,
    ends_mm: [[f64; 3]; 2],
    bend: Option<(f64, bool)>,
) -> Division {
    match led(before, state, ends_mm, bend) {
        // A rotary axis that turns meanwhile would need a share of each piece.
        Some(Division::Long { .. } | Division::LongClimbing { .. }) if turns => Division::One,
        Some(division) => division,
        None if turns => Division::OneBehindLines,
        None => Division::Any,
    }
}

/// What may become of a motion's block by cutter compensation; `None`: it has nothing to do with it.
///
/// * `ends_mm` – start and end, axis commands. On a ramp the way that corners take from an offset block is shared out over the
///   whole block: where it is cut, it would climb otherwise
/// * `bend` – of an arc: its radius, mm, and whether it turns counterclockwise in the plane
fn led(before: &Modal, state: &Modal, ends_mm: [[f64; 3]; 2], bend: Option<(f64, bool)>) -> Option<Division> {
    let [u, v, normal] = state.plane.axes();
    let along = |axis: usize| ends_mm[1][axis] - ends_mm[0][axis];
    let climb_mm = along(normal).abs();
    let (Compensation::On(side), Stage::Led, None) = (state.compensation, state.offset.stage, &before.aside)
    else {
        let free = before.compensation == Compensation::Off
            && state.compensation == Compensation::Off
            && state.offset.is_off();
        return (!free).then_some(Division::One);
    };
    let chord_mm = units::math::hypot(along(u), along(v));
    // A full circle has none.
    let way_mm = bend.filter(|_| chord_mm <= STANDS_MM).map_or(chord_mm, |(arc_mm, _)| arc_mm);
    let level = state.transform.is_none() && climb_mm <= STANDS_MM.max(LEVEL_SHARE * way_mm);
    let Some(radius_mm) = state.offset.radius_mm().filter(|_| level) else {
        return Some(Division::One);
    };
    // A piece of the contour is as long as it is offset, times the arc's radius over that of its offset.
    let longer = match bend {
        None => 1.0,
        Some((arc_mm, counterclockwise)) => {
            let inner = counterclockwise == (side == Side::Left);
            let offset_mm = if inner { arc_mm - radius_mm } else { arc_mm + radius_mm };
            if offset_mm < LEAST_SHARE * arc_mm {
                return Some(Division::One);
            }
            arc_mm / offset_mm
        }
    };
    let least_um = (LEAST_RADII * radius_mm * longer * 1e3).ceil().min(f64::from(u32::MAX)) as u32;
    let normal = normal as u8;
    Some(if climb_mm <= STANDS_MM {
        Division::Long { least_um, normal }
    } else {
        Division::LongClimbing { least_um, normal }
    })
}
