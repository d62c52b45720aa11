//! The lines of a plan.

use diagnostic::notice;
use machine_model::effects::Conditions;
use machine_model::{Vector, Volume};

use super::line::{LONGER_MM, Line, MARGIN, SLOW_MM_MIN, Stop, rounded};
use crate::message::{Failure, OPTION};

/// Stops along a line, each way.
const STOPS: usize = 15;
/// Feeds of the lines that are read on the fly, mm/min.
const FEEDS_MM_MIN: [f64; 2] = [500.0, 3000.0];
const LONG_MM: f64 = 150.0;
/// The third is aside.
const ASIDE_MM: f64 = 80.0;
/// Two axes each.
const PLANES: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];
/// Axes run for so long before the lines are repeated, seconds.
const WARM_UP_S: f64 = 1800.0;

/// Lines through the volume that make the effects of a three-axis machine separable: every axis in three places, all
/// diagonals, with three tools, both ways, at rest; axes and diagonals again on the fly at two feeds; some again warm.
pub(super) fn lines(volume: Volume, tool_mm: Vector) -> Result<Vec<Line>, Failure> {
    let span = Vector::from_fn(|a, _| volume.0[a].high - volume.0[a].low);
    if (0..3).any(|a| span[a] < 10.0) {
        return Err(Failure::usage(notice!(OPTION;
            "the profile's volume is thinner than 10 mm along an axis",
            "объём профиля по одной из осей тоньше 10 мм";
            "a plan needs three axes to move; give the axis its `travel_mm`, or a longer table",
            "для плана нужны движения трёх осей; дайте оси `travel_mm` или более длинную таблицу"
        )));
    }
    let share = |x: f64, y: f64, z: f64| {
        let inside = |s: f64| MARGIN + (1.0 - 2.0 * MARGIN) * s;
        Vector::from_fn(|a, _| volume.0[a].low + inside([x, y, z][a]) * span[a])
    };
    let mut plan = Plan { lines: Vec::new(), overrun: 0.5 * MARGIN };
    let along = |axis: usize, at: f64| {
        let end = |s: f64| {
            let mut place = [at; 3];
            place[axis] = s;
            share(place[0], place[1], place[2])
        };
        (end(0.0), end(1.0))
    };
    let across = |a: usize, b: usize, other: bool| {
        let end = |s: f64, t: f64| {
            let mut place = [0.5; 3];
            (place[a], place[b]) = (s, t);
            share(place[0], place[1], place[2])
        };
        if other { (end(1.0, 0.0), end(0.0, 1.0)) } else { (end(0.0, 0.0), end(1.0, 1.0)) }
    };
    let through = |y: f64, z: f64| (share(0.0, y, z), share(1.0, 1.0 - y, 1.0 - z));
    let names = ["X", "Y", "Z"];
    // With the tool as it is: axes, diagonals, and the axes begun from the other end, so that place and order are not the
    // same thing.
    plan.axes("middle", &|axis| along(axis, 0.5), Kind::AtRest, tool_mm, 1);
    for (a, b) in PLANES {
        for (other, word) in [(false, "diagonal"), (true, "other diagonal")] {
            let name = format!("{}{} {word}", names[a], names[b]);
            plan.add(&name, across(a, b, other), Kind::AtRest, tool_mm, 1);
        }
    }
    let backwards = |(from, to)| (to, from);
    plan.axes("reversed", &|axis| backwards(along(axis, 0.5)), Kind::AtRest, tool_mm, 2);
    for feed in FEEDS_MM_MIN {
        plan.axes(&format!("at F{feed}"), &|axis| along(axis, 0.5), Kind::Flying(feed), tool_mm, 1);
        for (a, b) in PLANES {
            for (other, word) in [(false, ""), (true, " other")] {
                let name = format!("{}{} at F{feed}{word}", names[a], names[b]);
                plan.add(&name, across(a, b, other), Kind::Flying(feed), tool_mm, 1);
            }
        }
    }
    // With two other tools: what turns shows itself by the lever alone.
    let other = if tool_mm.z < -LONG_MM { "shorter tool" } else { "longer tool" };
    let other_mm = if tool_mm.z < -LONG_MM { 0.5 * tool_mm.z } else { tool_mm.z - LONGER_MM };
    let other_mm = Vector::new(tool_mm.x, tool_mm.y, other_mm);
    let aside_mm = tool_mm + Vector::new(ASIDE_MM, ASIDE_MM, 0.0);
    for (tool, vector_mm, at, corners) in [
        (other, other_mm, 0.0, [(0.0, 0.0), (1.0, 0.0)]),
        ("target aside", aside_mm, 1.0, [(0.0, 1.0), (1.0, 1.0)]),
    ] {
        plan.axes(&format!("middle {tool}"), &|axis| along(axis, 0.5), Kind::AtRest, vector_mm, 1);
        let place = if at < 0.5 { "low" } else { "high" };
        plan.axes(&format!("{place} {tool}"), &|axis| along(axis, at), Kind::AtRest, vector_mm, 1);
        for (y, z) in corners {
            plan.add(&format!("body diagonal {tool}"), through(y, z), Kind::AtRest, vector_mm, 1);
        }
    }
    // Warm.
    let first_warm = plan.lines.len();
    plan.axes("warm", &|axis| along(axis, 0.5), Kind::AtRest, tool_mm, 3);
    plan.add("XY diagonal warm", across(0, 1, false), Kind::AtRest, tool_mm, 2);
    plan.lines[first_warm].wait_s = WARM_UP_S;
    Ok(plan.lines)
}

#[derive(Clone, Copy)]
enum Kind {
    AtRest,
    Flying(f64),
}

struct Plan {
    lines: Vec<Line>,
    /// Way before the first stop, share of the line.
    overrun: f64,
}

impl Plan {
    /// One line along each axis.
    fn axes(
        &mut self,
        name: &str,
        ends: &dyn Fn(usize) -> (Vector, Vector),
        kind: Kind,
        tool_mm: Vector,
        repeat: usize,
    ) {
        for (axis, letter) in ["X", "Y", "Z"].into_iter().enumerate() {
            self.add(&format!("{letter} {name}"), ends(axis), kind, tool_mm, repeat);
        }
    }

    fn add(&mut self, name: &str, (from, to): (Vector, Vector), kind: Kind, tool_mm: Vector, repeat: usize) {
        let direction = |sign: f64| {
            std::array::from_fn(|a| {
                let step = sign * (to[a] - from[a]);
                i8::from(step > 1e-9) - i8::from(step < -1e-9)
            })
        };
        // Uneven steps: an even one cannot tell a screw's period from a curve.
        let place = |k: usize| {
            let inside = k > 0 && k + 1 < STOPS;
            let uneven = if inside { (k as f64 * 0.618_034).fract() - 0.5 } else { 0.0 };
            let share = (k as f64 + 0.6 * uneven) / (STOPS - 1) as f64;
            rounded(from + (to - from) * share)
        };
        let stop =
            |k: usize, sign: f64| Stop { at_mm: place(k), rotary_deg: [0.0; 3], direction: direction(sign) };
        let overrun = (to - from) * self.overrun;
        let (feed_mm_min, flying) = match kind {
            Kind::AtRest => (SLOW_MM_MIN, false),
            Kind::Flying(feed) => (feed, true),
        };
        self.lines.push(Line {
            run: format!("{:02} {name}", self.lines.len() + 1),
            wait_s: 0.0,
            feed_mm_min,
            flying,
            tool_mm,
            conditions: Conditions::default(),
            repeat,
            before_mm: from - overrun,
            turn_mm: to + overrun,
            stops: (0..STOPS).map(|k| stop(k, 1.0)).chain((0..STOPS).rev().map(|k| stop(k, -1.0))).collect(),
            swing: None,
        });
    }
}
