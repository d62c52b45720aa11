//! All rigid-body terms from points anywhere in the volume: equations (51) to (51c).

use diagnostic::{Text, both};
use machine_model::{Command, Description, PathModel, Range, Vector};

use crate::adjustment::Estimate;
use crate::changed::Found;
use crate::error::{CalibrationError, LETTERS};
use crate::field;
use crate::known_places::known_places;
use crate::layout::{Group, Plan};
use crate::machine_change::find;
use crate::mistakes;
use crate::points::{Base, ChangedAxis, Point, SetUp};

/// The change of one error function as found.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundFunction {
    /// 0 X, 1 Y, 2 Z.
    pub axis: usize,
    /// 0 to 5: EX EY EZ EA EB EC.
    pub function: usize,
    /// Change against the base at the nodes of the axis, mm or rad; its gauge is that of [`calibrate`].
    pub values: Vec<f64>,
    /// Half widths of their 95 % intervals.
    pub half_widths_95: Vec<f64>,
}

/// What the points say.
#[derive(Clone, Debug)]
pub struct VolumetricCalibration {
    /// Nodes of the change of X, Y, Z, mm.
    pub nodes_mm: [Vec<f64>; 3],
    /// The change, function by function.
    pub functions: Vec<FoundFunction>,
    /// EC0Y, EB0Z, EA0Z of the changed machine and the half widths of their 95 % intervals, rad.
    pub squareness_rad: [(f64, f64); 3],
    /// Reversal value of X, Y, Z in the middle and the half width of its 95 % interval, mm; `None` where not read from both
    /// sides.
    pub play_mm: [Option<(f64, f64)>; 3],
    /// Terms that the points cannot tell from others and that stay as in the base: term, and what it looks like.
    pub open: Vec<(Text, Text)>,
    /// The tables of the changed machine.
    pub axes: [ChangedAxis; 3],
    /// The changed machine.
    pub description: Description,
    /// How the instrument stood, by run.
    pub setups: Vec<Option<SetUp>>,
    /// Root mean square of what the base leaves of the readings and of what the changed machine leaves, set-ups taken
    /// off, mm.
    pub fitted_rms_mm: [f64; 2],
    /// The same of readings that were held out of a fit, and how many points those were; `None` where none were.
    pub holdout: Option<([f64; 2], usize)>,
    /// True where the held-out readings are no better for the fit, and not because nothing has changed.
    pub refuted: bool,
    /// Half width that 95 % of the volume's points keep, mm: equation (51c).
    pub field_u95_mm: f64,
    /// Points outside the base's volume, which were left out.
    pub left_out: usize,
    /// The least squares behind it, of all readings.
    pub estimate: Estimate,
}

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Nodes per axis, at least 2.
    pub nodes: usize,
    /// One point of so many is held out of a first fit; 0 or 1 for none.
    pub holdout_every: usize,
}

/// Each run has a set-up of its own, six unknowns that are solved for together with the machine's: time grows with the
/// square of their number, and nobody sets an instrument up so often.
const MOST_RUNS: usize = 200;

/// Fits the change of every rigid-body term: equation (51).
///
/// The gauge, so that nothing is counted twice: positioning and straightness change by nothing in the mean over their nodes,
/// neither do the angles of the two axes next to the workpiece; EYX, EZX and EZY change by no slope (the line of X is
/// X, Y lies in the plane); slopes of EXY, EXZ and EYZ are squareness. The set-ups take the rest. Terms that the points cannot
/// tell from others stay as in the base, last axes and angles first, and are named. The result is judged by held-out points,
/// then taken from all.
///
/// # Errors
/// [`CalibrationError`]: places outside the base's volume, too few of them, more runs than are told apart, numbers in another unit than they claim, an outlier,
/// play of the wrong sign, and mistakes after whose repair the readings fit far better.
pub fn calibrate(
    points: &[Point],
    base: &Base,
    options: Options,
) -> Result<VolumetricCalibration, CalibrationError> {
    let runs = points.iter().map(|p| p.run + 1).max().unwrap_or(0);
    if runs > MOST_RUNS {
        return Err(CalibrationError::TooFew(both!(
            "{runs} runs, each with a set-up of its own, for {} points; at most {MOST_RUNS} are told apart: give one run id to what \
             was measured in one set-up of the instrument",
            "серий {runs}, каждая со своей установкой, на {} точек; различимы не больше {MOST_RUNS}: дайте одно имя серии всему, что \
             измерено при одной установке прибора",
            points.len()
        )));
    }
    let kept = known_places(points, base)?;
    let left_out = points.len() - kept.len();
    let points: &[Point] = &kept.iter().map(|k| points[*k]).collect::<Vec<Point>>();
    let still = Plan { nodes_mm: Default::default(), functions: 0, turned: true };
    let before = find(points, base, &still)?;
    mistakes::plausible(points, base, &before)?;
    let plan = Plan { nodes_mm: nodes(points, options.nodes)?, functions: 6, turned: true };
    let found = find(points, base, &plan)?;
    mistakes::contradicted(points, base, &plan)?;
    let unknowns = found.rows.len() - found.estimate.redundancy;
    // A tenth more readings than unknowns: below it no residual shows a mistake.
    if found.estimate.redundancy * 10 < found.rows.len() {
        return Err(CalibrationError::TooFew(both!(
            "{} readings for {unknowns} unknowns",
            "отсчётов {} на {unknowns} неизвестных",
            found.rows.len()
        )));
    }
    mistakes::outlier(points, &found).map_err(|error| error.with_points(&kept))?;
    let play_mm = plays(base, &found);
    mistakes::play(&play_mm)?;
    let (unseen, seen): (Vec<_>, Vec<_>) =
        points.iter().copied().enumerate().partition(|(k, _)| is_held_out(*k, options.holdout_every));
    let [unseen, seen] = [unseen, seen].map(|all| all.into_iter().map(|(_, p)| p).collect::<Vec<Point>>());
    let (mut holdout, mut refuted) = (None, false);
    if !unseen.is_empty() && unseen.iter().all(|p| seen.iter().any(|q| q.run == p.run)) {
        let rms = |found: &Found| Ok(root_mean_square(found.rest(&unseen, base)?.as_slice()));
        let first = find(&seen, base, &plan)?;
        let errors: [f64; 2] = [rms(&find(&seen, base, &still)?)?, rms(&first)?];
        holdout = Some((errors, unseen.len()));
        // Where nothing has changed a fit adds noise, and no more than that.
        let noise =
            first.estimate.rms() * (first.rows.len() as f64 / first.estimate.redundancy.max(1) as f64).sqrt();
        let expected = noise * (1.0 + unknowns as f64 / first.rows.len() as f64).sqrt();
        refuted = errors[1] >= errors[0] && (!base.is_known || errors[1] > 2.0 * expected);
    }
    let (axes, description, setups) = found.changed(base);
    Ok(VolumetricCalibration {
        functions: functions(&found),
        squareness_rad: found.squareness(base),
        play_mm,
        axes,
        description,
        fitted_rms_mm: [before.estimate.rms(), found.estimate.rms()],
        holdout,
        refuted,
        field_u95_mm: found.layout.field_u95_mm(base, &found.estimate, &field_commands(points, &found))?,
        nodes_mm: plan.nodes_mm,
        open: found.open,
        setups,
        left_out,
        estimate: found.estimate,
    })
}

/// True for one row of `every`, spread over the rows.
///
/// A lattice comes row by row: every fifth row of five places a line is a whole plane, and the fit without it knows nothing there.
/// Multiples of the golden section fall evenly into the unit interval and in step with no lattice.
fn is_held_out(row: usize, every: usize) -> bool {
    const GOLDEN_SECTION: f64 = 0.618_033_988_749_894_9;
    every > 1 && (row as f64 * GOLDEN_SECTION).fract() * (every as f64) < 1.0
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Equal steps over what the points cover, or the planes of a lattice.
fn nodes(points: &[Point], count: usize) -> Result<[Vec<f64>; 3], CalibrationError> {
    let mut out: [Vec<f64>; 3] = Default::default();
    for (axis, own) in out.iter_mut().enumerate() {
        let mut places: Vec<f64> = points.iter().map(|p| p.command.linear_mm[axis]).collect();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|a, b| (*a - *b).abs() < 1e-3);
        let (Some(low), Some(high)) = (places.first().copied(), places.last().copied()) else { continue };
        if places.len() < 2 {
            return Err(CalibrationError::TooFew(both!(
                "{} does not move in the measurements",
                "{} в измерениях не движется",
                LETTERS[axis]
            )));
        }
        // On a lattice a table can have no more nodes than the lattice has planes.
        if places.len() <= count.max(2) {
            *own = places;
            continue;
        }
        let cells = count.max(2) - 1;
        *own = (0..=cells).map(|k| low + (high - low) * k as f64 / cells as f64).collect();
    }
    Ok(out)
}

fn functions(found: &Found) -> Vec<FoundFunction> {
    let of = |(group, range): &(Group, std::ops::Range<usize>)| match *group {
        Group::Function(axis, function) => Some(FoundFunction {
            axis,
            function,
            values: range.clone().map(|k| found.values[k]).collect(),
            half_widths_95: range.clone().map(|k| found.estimate.half_width_95(k)).collect(),
        }),
        _ => None,
    };
    found.layout.groups.iter().filter_map(of).collect()
}

/// Reversal values in the middle of each axis, mm, with the half widths of their 95 % intervals.
pub(crate) fn plays(base: &Base, found: &Found) -> [Option<(f64, f64)>; 3] {
    let machine = base.machine().ok();
    [0, 1, 2].map(|axis| {
        let parameter = found.layout.at(Group::Play(axis))?.start;
        let middle =
            found.layout.plan.nodes_mm.each_ref().map(|nodes| 0.5 * (nodes[0] + nodes[nodes.len() - 1]));
        let command = Command { linear_mm: Vector::from(middle), ..Default::default() };
        let before = machine.as_ref().map_or(0.0, |machine| machine.reversal_mm(axis, &command));
        Some((before + found.values[parameter], found.estimate.half_width_95(parameter)))
    })
}

/// Where the field is judged: all over the nodes for the tools that were measured with, from both sides where they were told
/// apart; tools of one run share a frame.
pub(crate) fn field_commands(points: &[Point], found: &Found) -> Vec<Vec<Command>> {
    /// More tools than this are represented by as many of them.
    const TOOLS: usize = 6;
    let runs = points.iter().map(|p| p.run + 1).max().unwrap_or(0);
    // Tool and group; a run with two tools joins their groups.
    let mut tools: Vec<(Vector, usize)> = Vec::new();
    for run in 0..runs {
        let mut joined: Option<usize> = None;
        for p in points.iter().filter(|p| p.run == run) {
            let known = tools.iter().position(|(tool, _)| (tool - p.command.tool_mm).norm() < 1e-6);
            let at = known.unwrap_or_else(|| {
                tools.push((p.command.tool_mm, tools.len()));
                tools.len() - 1
            });
            let (own, group) = (tools[at].1, joined.unwrap_or(tools[at].1));
            for (_, other) in &mut tools {
                if *other == own {
                    *other = group;
                }
            }
            joined = Some(group);
        }
    }
    let every = tools.len().div_ceil(TOOLS).max(1);
    let kept: Vec<(Vector, usize)> = tools.into_iter().step_by(every).collect();
    let sides: &[i8] =
        if (0..3).any(|axis| found.layout.at(Group::Play(axis)).is_some()) { &[1, -1] } else { &[0] };
    let span = |nodes: &Vec<f64>| Range { low: nodes[0], high: nodes[nodes.len() - 1] };
    let places = field::places_mm(&found.layout.plan.nodes_mm.each_ref().map(span));
    let mut groups: Vec<usize> = kept.iter().map(|(_, group)| *group).collect();
    groups.sort_unstable();
    groups.dedup();
    groups
        .into_iter()
        .map(|group| {
            let mut commands = Vec::new();
            for (tool_mm, _) in kept.iter().filter(|(_, own)| *own == group) {
                for side in sides {
                    commands.extend(places.iter().map(|linear_mm| Command {
                        linear_mm: *linear_mm,
                        tool_mm: *tool_mm,
                        direction: [*side; 3],
                        ..Default::default()
                    }));
                }
            }
            commands
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::is_held_out;

    #[test]
    fn no_plane_of_a_lattice_is_held_out() {
        for planes in [2_usize, 3, 4, 5, 7, 8, 13] {
            for every in [2, 3, 4, 5, 8] {
                let held: Vec<usize> = (0..planes.pow(3)).filter(|k| is_held_out(*k, every)).collect();
                let wanted = planes.pow(3).div_ceil(every);
                assert!(held.len().abs_diff(wanted) <= 2, "{planes} {every}: {} of {wanted}", held.len());
                for axis in 0..3 {
                    for plane in 0..planes {
                        let lost = held.iter().filter(|k| **k / planes.pow(axis) % planes == plane).count();
                        assert!(lost < planes.pow(2), "{planes} {every} {axis} {plane}");
                    }
                }
            }
        }
    }
}
