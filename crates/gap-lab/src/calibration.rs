//! Calibration measurements of machines whose errors are known: what `calibration` must find again.
//!
//! Each maker draws a machine, measures it with its own kinematics (products of 4 × 4 matrices) and hands out rows and truth.
//! Truths are in the units of a profile: µm, µrad, µm/m.

use crate::dice::Dice;
use crate::machine::{Contribution, Machine, Table};
use crate::matrix::{Matrix, carry, shift, times, turn};
use crate::row::{Row, Sight};

/// What a test of [`ball_bar`] turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turns {
    /// The table's A axis.
    A,
    /// The table's C axis.
    C,
    /// The spindle.
    Spindle,
}

/// One reading of a ball bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarRow {
    /// Test, from 0.
    pub test: usize,
    /// What turns.
    pub turns: Turns,
    /// Tool ball as set up, mm from the crossing of the axes.
    pub tool_ball_mm: [f64; 3],
    /// Workpiece ball minus tool ball at angle 0, mm.
    pub bar_mm: [f64; 3],
    /// Angle, degrees.
    pub angle_deg: f64,
    /// Reading, mm.
    pub length_mm: f64,
}

/// A table with two rotary axes: `EY0A EZ0A EB0A EC0A EX0C EY0C EA0C EB0C` and where the tool ball sits against the spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableTruth {
    /// µm and µrad.
    pub piges: [f64; 8],
    /// µm.
    pub cup_um: [f64; 2],
}

impl TableTruth {
    /// A table as it comes from assembly: up to 200 µm and 200 µrad.
    #[must_use]
    pub fn random(seed: u64, index: u64) -> Self {
        let mut dice = Dice::new(seed, index, 100);
        Self {
            piges: [0; 8].map(|_| dice.between(-200.0, 200.0)),
            cup_um: [dice.between(-80.0, 80.0), dice.between(-80.0, 80.0)],
        }
    }
}

fn undo(m: &Matrix) -> Matrix {
    let mut back = crate::matrix::IDENTITY;
    for i in 0..3 {
        for j in 0..3 {
            back[i][j] = m[j][i];
        }
        back[i][3] = -(0..3).map(|k| m[k][i] * m[k][3]).sum::<f64>();
    }
    back
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>().sqrt()
}

/// The four tests of Zhang 2024 and a spindle turn: bar of 100 mm, levers of 100 mm.
///
/// * `step_deg`, `repeats` – readings at every step over a full turn, so many times
#[must_use]
pub fn ball_bar(
    truth: &TableTruth,
    seed: u64,
    index: u64,
    noise_um: f64,
    step_deg: f64,
    repeats: usize,
) -> Vec<BarRow> {
    let mut dice = Dice::new(seed, index, 101);
    let [y_a, z_a, b_a, c_a, x_c, y_c, a_c, b_c] = truth.piges;
    let carried_by_machine =
        times(&shift([0.0, y_a * 1e-3, z_a * 1e-3]), &times(&turn(2, c_a * 1e-6), &turn(1, b_a * 1e-6)));
    let carried_by_a =
        times(&shift([x_c * 1e-3, y_c * 1e-3, 0.0]), &times(&turn(1, b_c * 1e-6), &turn(0, a_c * 1e-6)));
    let cup = [truth.cup_um[0] * 1e-3, truth.cup_um[1] * 1e-3, 0.0];
    let plan: [(Turns, [f64; 3], [f64; 3]); 5] = [
        (Turns::A, [0.0; 3], [0.0, -100.0, 0.0]),
        (Turns::A, [100.0, 0.0, 0.0], [0.0, -100.0, 0.0]),
        (Turns::C, [0.0; 3], [100.0, 0.0, 0.0]),
        (Turns::C, [0.0, 0.0, 100.0], [100.0, 0.0, 0.0]),
        (Turns::Spindle, [0.0; 3], [100.0, 0.0, 0.0]),
    ];
    let mut rows = Vec::new();
    for (test, (turns, tool, bar)) in plan.into_iter().enumerate() {
        // The bar's own length is not known to a µm.
        let length_error = dice.normal() * 0.005;
        let tool_at_zero = [0, 1, 2].map(|i| tool[i] + cup[i]);
        let work_at_zero = [0, 1, 2].map(|i| tool_at_zero[i] + bar[i]);
        for _ in 0..repeats {
            let count = (360.0 / step_deg).round() as usize;
            for k in 0..=count {
                let angle_deg = k as f64 * step_deg;
                let angle = angle_deg.to_radians();
                let pose = |at: f64| match turns {
                    Turns::A => times(&carried_by_machine, &turn(0, at)),
                    Turns::C | Turns::Spindle => {
                        times(&carried_by_machine, &times(&carried_by_a, &turn(2, at)))
                    }
                };
                let (tool_ball, work_ball) = if turns == Turns::Spindle {
                    let spun = carry(&turn(2, angle), cup);
                    ([0, 1, 2].map(|i| tool[i] + spun[i]), work_at_zero)
                } else {
                    let on_table = carry(&undo(&pose(0.0)), work_at_zero);
                    (tool_at_zero, carry(&pose(angle), on_table))
                };
                let length_mm =
                    distance(tool_ball, work_ball) + length_error + dice.normal() * noise_um * 1e-3;
                rows.push(BarRow { test, turns, tool_ball_mm: tool, bar_mm: bar, angle_deg, length_mm });
            }
        }
    }
    rows
}

/// One reading of a circle of two linear axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleRow {
    /// Run: 0, 1 in XY, 2, 3 in ZX, 4, 5 in YZ; counter-clockwise, then clockwise.
    pub run: usize,
    /// Commanded, mm.
    pub commanded_mm: [f64; 3],
    /// Fixed ball as set up, mm.
    pub centre_mm: [f64; 3],
    /// Direction in which each axis moves.
    pub direction: [i8; 3],
    /// Reading, mm.
    pub length_mm: f64,
}

/// Errors of three linear axes that circles show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleTruth {
    /// EC0Y, EB0Z, EA0Z, µrad.
    pub squareness_urad: [f64; 3],
    /// Scale errors of X, Y, Z, µm/m.
    pub scale_um_m: [f64; 3],
    /// How much further each axis stands after coming from above, µm.
    pub backlash_um: [f64; 3],
}

/// Circles of 100 mm in the three planes, both ways round.
#[must_use]
pub fn circles(seed: u64, index: u64, noise_um: f64, step_deg: f64) -> (Vec<CircleRow>, CircleTruth) {
    let mut dice = Dice::new(seed, index, 102);
    let truth = CircleTruth {
        squareness_urad: [0; 3].map(|_| dice.between(-60.0, 60.0)),
        scale_um_m: [0; 3].map(|_| dice.between(-40.0, 40.0)),
        backlash_um: [0; 3].map(|_| dice.between(0.0, 12.0)),
    };
    let mut machine = bare([[-500.0, 500.0]; 3]);
    machine.squareness_urad = truth.squareness_urad;
    let mut rows = Vec::new();
    for (plane, [u, v]) in [[0, 1], [2, 0], [1, 2]].into_iter().enumerate() {
        let centre = [dice.between(-50.0, 50.0), dice.between(-50.0, 50.0), dice.between(-50.0, 50.0)];
        for way in [1.0, -1.0] {
            let run = 2 * plane + usize::from(way < 0.0);
            let off = [0; 3].map(|_| dice.normal() * 0.01);
            let bar = dice.normal() * 0.005;
            let start = machine.position(&row(centre), &Contribution::default());
            for k in 0..(360.0 / step_deg).round() as usize {
                let angle = way * (k as f64 + 0.5) * step_deg.to_radians();
                let (sine, cosine) = libm::sincos(angle);
                let mut commanded = centre;
                commanded[u] += 100.0 * cosine;
                commanded[v] += 100.0 * sine;
                let mut direction = [0_i8; 3];
                direction[u] = if -sine * way > 0.0 { 1 } else { -1 };
                direction[v] = if cosine * way > 0.0 { 1 } else { -1 };
                let mut extra = Contribution::default();
                for axis in 0..3 {
                    extra.linear[axis][axis] = commanded[axis] * truth.scale_um_m[axis] * 1e-6
                        - 0.5e-3 * truth.backlash_um[axis] * f64::from(direction[axis]);
                }
                let at = machine.position(&row(commanded), &extra);
                let fixed = [0, 1, 2].map(|i| start[i] + if i == u || i == v { off[i] } else { 0.0 });
                let length_mm = distance(at, fixed) + bar + dice.normal() * noise_um * 1e-3;
                rows.push(CircleRow {
                    run,
                    commanded_mm: commanded,
                    centre_mm: centre,
                    direction,
                    length_mm,
                });
            }
        }
    }
    (rows, truth)
}

fn bare(travel: [[f64; 2]; 3]) -> Machine {
    Machine {
        order: [0, 1, 2],
        bed_before: 2,
        travel,
        tables: [None, None, None],
        squareness_urad: [0.0; 3],
        centre: None,
    }
}

fn row(command: [f64; 3]) -> Row {
    Row {
        run: 0,
        command,
        turn: 0.0,
        tool: [0.0; 3],
        approach: [1.0, 0.0, 0.0],
        tangent: [1.0, 0.0, 0.0],
        since_reversal: [50.0; 3],
        feed: 1000.0,
        load: 0.0,
        time: 0.0,
        temperature: 20.0,
        repeat: 1,
        sight: Sight::Components([true; 3]),
    }
}

/// One reading of a tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerRow {
    /// Axis that moves: 0 X, 1 Y, 2 Z.
    pub axis: usize,
    /// Commanded, mm.
    pub commanded_mm: [f64; 3],
    /// Measured, mm.
    pub measured_mm: [f64; 3],
}

/// What three traverses must give back: of the lines through the true points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerTruth {
    /// Scale errors, µm/m.
    pub scale_um_m: [f64; 3],
    /// EC0Y, EB0Z, EA0Z, µrad.
    pub squareness_urad: [f64; 3],
}

/// Three traverses of 300 mm at 20 mm, with waves that are no straight lines.
#[must_use]
pub fn traverses(seed: u64, index: u64, noise_um: f64, repeats: usize) -> (Vec<TrackerRow>, TrackerTruth) {
    let mut dice = Dice::new(seed, index, 103);
    let mut rows = Vec::new();
    let mut slopes = [[0.0; 3]; 3];
    for (axis, own) in slopes.iter_mut().enumerate() {
        let lean = [0; 3].map(|_| dice.between(-5e-4, 5e-4));
        let wave = [0; 3].map(|_| (dice.normal() * 0.004, dice.phase()));
        let true_at = |q: f64, i: usize| {
            let (size, phase) = wave[i];
            let straight = if i == axis { q } else { 0.0 };
            straight + lean[i] * q + size * (libm::sin(q / 45.0 + phase) - libm::sin(phase))
        };
        let nodes: Vec<f64> = (0..16).map(|k| 20.0 * f64::from(k)).collect();
        let mean = nodes.iter().sum::<f64>() / 16.0;
        let spread: f64 = nodes.iter().map(|q| (q - mean) * (q - mean)).sum();
        for (i, slope) in own.iter_mut().enumerate() {
            *slope = nodes.iter().map(|q| true_at(*q, i) * (q - mean)).sum::<f64>() / spread;
        }
        for _ in 0..repeats {
            for q in &nodes {
                let mut commanded_mm = [0.0; 3];
                commanded_mm[axis] = *q;
                let measured_mm = [0, 1, 2].map(|i| true_at(*q, i) + dice.normal() * noise_um * 1e-3);
                rows.push(TrackerRow { axis, commanded_mm, measured_mm });
            }
        }
    }
    let s = |axis: usize, i: usize| slopes[axis][i] * 1e6;
    let truth = TrackerTruth {
        scale_um_m: [0, 1, 2].map(|i| s(i, i) - 1e6),
        squareness_urad: [-(s(1, 0) + s(0, 1)), s(2, 0) + s(0, 2), -(s(2, 1) + s(1, 2))],
    };
    (rows, truth)
}

/// One point of a volume, measured in three components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointRow {
    /// Run: readings of one run share a shift of the instrument.
    pub run: usize,
    /// Commanded, mm.
    pub commanded_mm: [f64; 3],
    /// Tool vector, mm.
    pub tool_mm: [f64; 3],
    /// Measured minus commanded, µm.
    pub deviation_um: [f64; 3],
}

/// A machine of 18 tables and 3 angles.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeTruth {
    /// Nodes of X, Y, Z, mm.
    pub nodes_mm: [Vec<f64>; 3],
    /// Values per axis and node: three in µm, three in µrad. Positioning and angles are 0 at the first node, straightness at
    /// both ends.
    pub values: [Vec<[f64; 6]>; 3],
    /// EC0Y, EB0Z, EA0Z, µrad.
    pub squareness_urad: [f64; 3],
}

/// Points anywhere in 400 × 300 × 200 mm, chain X, Y, Z, with three tool vectors in three runs.
#[must_use]
pub fn volume_points(seed: u64, index: u64, noise_um: f64, count: usize) -> (Vec<PointRow>, VolumeTruth) {
    let mut dice = Dice::new(seed, index, 104);
    let travel = [[0.0, 400.0], [0.0, 300.0], [0.0, 200.0]];
    let nodes_mm = travel
        .map(|[low, high]| (0..4).map(|k| low + (high - low) * f64::from(k) / 3.0).collect::<Vec<f64>>());
    let values: [Vec<[f64; 6]>; 3] = [0, 1, 2].map(|axis| {
        (0..4)
            .map(|k| {
                let ends = k == 0 || k == 3;
                std::array::from_fn(|f| {
                    let zero = if f < 3 && f != axis { ends } else { k == 0 };
                    if zero { 0.0 } else { dice.normal() * 10.0 }
                })
            })
            .collect()
    });
    let mut machine = bare(travel);
    machine.squareness_urad = [0; 3].map(|_| dice.between(-50.0, 50.0));
    machine.tables = [0, 1, 2].map(|i| Some(Table { nodes: nodes_mm[i].clone(), values: values[i].clone() }));
    let tools = [[0.0, 0.0, 0.0], [0.0, 0.0, -150.0], [60.0, 40.0, -80.0]];
    let offsets: [[f64; 3]; 3] = [0; 3].map(|_| [0; 3].map(|_| dice.normal() * 20.0));
    let mut rows = Vec::new();
    for k in 0..count {
        let run = k % 3;
        // The corners are among the points, so that every table is covered to its ends.
        let corner = |bit: usize, range: [f64; 2]| range[(k / 3) >> bit & 1];
        let place = |dice: &mut Dice, axis: usize| {
            if k < 24 { corner(axis, travel[axis]) } else { dice.between(travel[axis][0], travel[axis][1]) }
        };
        let commanded_mm = [place(&mut dice, 0), place(&mut dice, 1), place(&mut dice, 2)];
        let own = Row { tool: tools[run], ..row(commanded_mm) };
        let (at, nominal) = (machine.position(&own, &Contribution::default()), machine.nominal(&own));
        let deviation_um =
            [0, 1, 2].map(|i| (at[i] - nominal[i]) * 1e3 + offsets[run][i] + dice.normal() * noise_um);
        rows.push(PointRow { run, commanded_mm, tool_mm: tools[run], deviation_um });
    }
    let squareness_urad = machine.squareness_urad;
    (rows, VolumeTruth { nodes_mm, values, squareness_urad })
}
