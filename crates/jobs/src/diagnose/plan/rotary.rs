//! Lines on which rotary axes turn and the linear axes follow a target: the motions of ISO 10791-6, K1, K2 and K4.
//!
//! The target stands on the table and the tool, or what reads it, keeps at it: X, Y and Z go as an ideal machine with the
//! profile's centres would. K1 and K2 turn one axis each, K4 both, so that the tool goes round a cone in the workpiece.

use machine_model::effects::Conditions;
use machine_model::{Axis, Command, PathModel, Vector, Volume};
use machine_profile::Profile;
use toolpath::{TiltRule, WholeTurns};

use super::line::{LONGER_MM, Line, MARGIN, SLOW_MM_MIN, Spot, Stop, rounded};

/// Stops of one axis, each way.
const STOPS: u32 = 13;
/// Stops around the cone.
const AROUND: u32 = 24;
/// An axis turns by so much before its first stop and beyond its last, degrees.
const OVERRUN_DEG: f64 = 2.0;
/// An axis without limit turns from minus to plus so much, degrees.
const FREE_DEG: f64 = 180.0;
/// Between places of the program rotary axes turn by no more, degrees: the tool leaves the target by 4 µm at 100 mm.
const STEP_DEG: f64 = 1.0;
/// Half the angle of the cone, and the tilt of its axis, degrees: NAS 979.
const CONE_DEG: [f64; 2] = [15.0, 10.0];
/// Places of the target that are tried along X, Y and Z.
const PLACES: [u32; 3] = [9, 9, 7];

/// Turns of the rotary axes from place to place, degrees.
struct Swing {
    name: String,
    /// Before the first stop, at the stops, beyond the last.
    stops_deg: Vec<[f64; 3]>,
}

/// The lines, and the rotary axes for which there is none.
pub(super) fn rotary_lines(profile: &Profile, tool_mm: Vector, before: usize) -> (Vec<Line>, Vec<Axis>) {
    let axes: Vec<Axis> = profile.chain().axes().filter(|axis| !axis.is_linear()).collect();
    let mut swings: Vec<Swing> =
        axes.iter().zip(1..).map(|(axis, number)| one_axis(profile, *axis, number)).collect();
    swings.extend(around_a_cone(profile));
    let mut lines: Vec<Line> = Vec::new();
    let mut shown = Vec::new();
    for (tool, vector_mm) in [("", tool_mm), (" longer tool", tool_mm - Vector::new(0.0, 0.0, LONGER_MM))] {
        for swing in &swings {
            let Some(mut line) = line(profile, swing, vector_mm) else { continue };
            line.run = format!("{:02} {}{tool}", before + lines.len() + 1, swing.name);
            shown.push(swing.name.clone());
            lines.push(line);
        }
    }
    let is_shown =
        |axis: &Axis| shown.iter().any(|name| name.split(' ').skip(1).any(|word| word == axis.to_string()));
    let missing = axes.into_iter().filter(|axis| !is_shown(axis)).collect();
    (lines, missing)
}

/// Annex A of the standard has two axes in the head, B two in the table, C one of each.
fn annex(profile: &Profile) -> char {
    match (profile.chain().table().len(), profile.chain().head().len()) {
        (0, _) => 'A',
        (_, 0) => 'B',
        _ => 'C',
    }
}

fn one_axis(profile: &Profile, axis: Axis, number: u32) -> Swing {
    let k = axis.direction();
    let range = profile.description.rotary[k].calibrated_rad();
    let (low, high) = (range.low.to_degrees().max(-FREE_DEG), range.high.to_degrees().min(FREE_DEG));
    let turned = |deg: f64| {
        let mut all = [0.0; 3];
        all[k] = (deg * 100.0).round() / 100.0;
        all
    };
    let (first, last) = (low + 2.0 * OVERRUN_DEG, high - 2.0 * OVERRUN_DEG);
    let place = |stop: u32| first + (last - first) * f64::from(stop) / f64::from(STOPS - 1);
    let mut stops_deg = vec![turned(first - OVERRUN_DEG)];
    stops_deg.extend((0..STOPS).map(|stop| turned(place(stop))));
    stops_deg.push(turned(last + OVERRUN_DEG));
    Swing { name: format!("{}K{number} {axis}", annex(profile)), stops_deg }
}

/// Both axes together, where two of them turn the tool.
fn around_a_cone(profile: &Profile) -> Option<Swing> {
    let chain = profile.rotary_chain();
    let direction = |degrees: f64| {
        let (sin, cos) = units::math::sin_cos(degrees.to_radians());
        let (sin_cone, cos_cone) = units::math::sin_cos(CONE_DEG[0].to_radians());
        let (sin_tilt, cos_tilt) = units::math::sin_cos(CONE_DEG[1].to_radians());
        let [x, y, z] = [sin_cone * cos, sin_cone * sin, cos_cone];
        [cos_tilt * x + sin_tilt * z, y, cos_tilt * z - sin_tilt * x]
    };
    let places: Vec<f64> = (0..=AROUND + 2)
        .map(|k| match k {
            0 => -OVERRUN_DEG,
            k if k == AROUND + 2 => 360.0 + OVERRUN_DEG,
            k => 360.0 * f64::from(k - 1) / f64::from(AROUND),
        })
        .collect();
    let [first, second] = chain.0.as_slice() else { return None };
    let branches = [(second.axis, true), (second.axis, false), (first.axis, true), (first.axis, false)];
    let stops_deg = branches.into_iter().find_map(|branch| {
        let rule =
            TiltRule { branch: Some(branch), turns: Some(WholeTurns::Shortest), ..TiltRule::default() };
        let mut stands = [0.0; 3];
        let all = places.iter().map(|degrees| {
            stands = chain.angles_for(direction(*degrees), &rule, stands.map(Some)).ok()?;
            stands = stands.map(|deg| (deg * 100.0).round() / 100.0);
            Some(stands)
        });
        all.collect::<Option<Vec<_>>>()
    })?;
    let names: Vec<String> = chain.0.iter().map(|link| ["A", "B", "C"][link.axis].to_owned()).collect();
    Some(Swing { name: format!("{}K4 {}", annex(profile), names.join(" ")), stops_deg })
}

/// Forward and back with the target where the linear axes have the longest way; `None` where they can nowhere follow it.
fn line(profile: &Profile, swing: &Swing, tool_mm: Vector) -> Option<Line> {
    let model = profile.rigid_body_without_effects();
    let follow = |target: &Vector, rotary_deg: [f64; 3]| {
        let rotary_rad = Vector::from(rotary_deg.map(f64::to_radians));
        let state = Command { rotary_rad, tool_mm, ..Command::default() };
        model.same_tip_mm(target, &state, &Vector::zeros())
    };
    let all_deg: Vec<[f64; 3]> = swing
        .stops_deg
        .windows(2)
        .flat_map(|pair| steps(pair[0], pair[1]))
        .chain(swing.stops_deg.last().copied())
        .collect();
    let target = targets(profile.volume())
        .filter_map(|target| {
            let way = |deg: &[f64; 3]| {
                let at = follow(&target, *deg);
                profile.volume().contains(&rounded(at)).then(|| (at - target).norm())
            };
            let ways = all_deg.iter().map(way).collect::<Option<Vec<f64>>>()?;
            Some((target, ways.into_iter().fold(0.0, f64::max)))
        })
        .reduce(|best, next| if next.1 > best.1 { next } else { best })?
        .0;
    let spot = |rotary_deg: [f64; 3]| Spot { at_mm: rounded(follow(&target, rotary_deg)), rotary_deg };
    // Without the first and the last.
    let between = |from: [f64; 3], to: [f64; 3]| steps(from, to).into_iter().skip(1).map(spot);
    let inner = swing.stops_deg.len() - 2;
    let order: Vec<usize> = (0..inner + 2).chain((1..=inner).rev()).collect();
    let (mut stops, mut passed) = (Vec::new(), Vec::new());
    let mut way: Vec<Spot> = Vec::new();
    for pair in order.windows(2) {
        let (from, to) = (swing.stops_deg[pair[0]], swing.stops_deg[pair[1]]);
        way.extend(between(from, to));
        let here = spot(to);
        if pair[1] == inner + 1 {
            // Where it turns nothing is read.
            way.push(here);
            continue;
        }
        let last = way.last().map_or(spot(from).at_mm, |spot| spot.at_mm);
        let direction = [0, 1, 2].map(|i| {
            let step = here.at_mm[i] - last[i];
            i8::from(step > 1e-9) - i8::from(step < -1e-9)
        });
        stops.push(Stop { at_mm: here.at_mm, rotary_deg: to, direction });
        passed.push(std::mem::take(&mut way));
    }
    let before = spot(swing.stops_deg[0]);
    Some(Line {
        run: String::new(),
        wait_s: 0.0,
        feed_mm_min: SLOW_MM_MIN,
        flying: false,
        tool_mm,
        conditions: Conditions::default(),
        repeat: 1,
        before_mm: before.at_mm,
        turn_mm: before.at_mm,
        stops,
        swing: Some((before, passed)),
    })
}

/// From place to place in steps that thousandths can say, without the last.
fn steps(from: [f64; 3], to: [f64; 3]) -> Vec<[f64; 3]> {
    let turn = (0..3).map(|k| (to[k] - from[k]).abs()).fold(0.0, f64::max);
    let count = (turn / STEP_DEG).ceil().max(1.0);
    let place = |k: u32, i: usize| from[i] + (to[i] - from[i]) * f64::from(k) / count;
    (0..count as u32).map(|k| [0, 1, 2].map(|i| (place(k, i) * 1000.0).round() / 1000.0)).collect()
}

/// Where the target may stand, said by the linear axes with all rotary axes at 0.
fn targets(volume: Volume) -> impl Iterator<Item = Vector> {
    let [nx, ny, nz] = PLACES;
    let all = (0..nx).flat_map(move |i| (0..ny).flat_map(move |j| (0..nz).map(move |k| [i, j, k])));
    all.map(move |place| {
        Vector::from_fn(|axis, _| {
            let range = volume.0[axis];
            let share = f64::from(place[axis]) / f64::from(PLACES[axis] - 1);
            let inside = MARGIN + (1.0 - 2.0 * MARGIN) * share;
            (range.low + inside * (range.high - range.low)).round()
        })
    })
}
