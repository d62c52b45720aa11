//! The parameters of a change: which there are, where each stands, and what they leave open.

use diagnostic::{Text, both};
use std::ops::Range;

use machine_model::{AxisTables, Interpolation, LinearAxis, Six, Table};
use nalgebra::DVector;

use crate::error::LETTERS;
use crate::points::{Base, Point, PointReading};

/// What is to be found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plan {
    /// Nodes of the change of X, Y, Z, mm.
    pub(crate) nodes_mm: [Vec<f64>; 3],
    /// Functions that may change: none, EX EY EZ, or all six.
    pub(crate) functions: usize,
    /// The instrument may be turned against the machine.
    pub(crate) turned: bool,
}

/// One group of parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Group {
    /// Axis and function (0 to 5: EX EY EZ EA EB EC).
    Function(usize, usize),
    /// Play of an axis.
    Play(usize),
    /// Set-up of a run.
    Run(usize),
}

impl Group {
    pub(crate) fn name(self) -> Text {
        match self {
            Self::Function(axis, f) => {
                Text::same(format!("E{}{}", ['X', 'Y', 'Z', 'A', 'B', 'C'][f], LETTERS[axis]))
            }
            Self::Play(axis) => both!("the play of {}", "люфт {}", LETTERS[axis]),
            Self::Run(_) => Text::pair("the set-up", "установка прибора"),
        }
    }
}

/// Where which parameter stands.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layout {
    pub(crate) plan: Plan,
    pub(crate) groups: Vec<(Group, Range<usize>)>,
    pub(crate) count: usize,
    /// Of each axis: positions of its changed tables, mm.
    pub(crate) positions_mm: [Vec<f64>; 3],
}

impl Layout {
    pub(crate) fn new(plan: &Plan, base: &Base, points: &[Point]) -> Self {
        let mut groups = Vec::new();
        let mut count = 0;
        let mut add = |group: Group, size: usize| {
            groups.push((group, count..count + size));
            count += size;
        };
        for axis in 0..3 {
            for f in 0..plan.functions {
                add(Group::Function(axis, f), plan.nodes_mm[axis].len());
            }
        }
        for axis in (0..3).filter(|_| plan.functions > 0) {
            let from = |sign: i8| points.iter().any(|p| p.command.direction[axis].signum() == sign);
            // From one side alone play is nothing but a constant.
            if from(1) && from(-1) {
                add(Group::Play(axis), 1);
            }
        }
        for run in 0..points.iter().map(|p| p.run + 1).max().unwrap_or(0) {
            let own = || points.iter().filter(|p| p.run == run);
            if own().next().is_none() {
                continue;
            }
            let station = own().any(|p| matches!(p.reading, PointReading::Distance { .. }));
            add(
                Group::Run(run),
                if station {
                    4
                } else if plan.turned {
                    6
                } else {
                    3
                },
            );
        }
        let of_axis =
            |axis: usize| positions(&base.description.linear[axis], &plan.nodes_mm[axis], base.interpolation);
        Self { plan: plan.clone(), groups, count, positions_mm: std::array::from_fn(of_axis) }
    }

    pub(crate) fn at(&self, group: Group) -> Option<Range<usize>> {
        self.groups.iter().find(|(own, _)| *own == group).map(|(_, range)| range.clone())
    }

    /// Change of a function at `q`, mm or rad.
    pub(crate) fn change(&self, values: &DVector<f64>, axis: usize, function: usize, q: f64) -> f64 {
        let Some(range) = self.at(Group::Function(axis, function)) else { return 0.0 };
        let weights = hats(&self.plan.nodes_mm[axis], q);
        weights.into_iter().map(|(node, weight)| weight * values[range.start + node]).sum()
    }

    pub(crate) fn play(&self, values: &DVector<f64>, axis: usize) -> f64 {
        self.at(Group::Play(axis)).map_or(0.0, |range| values[range.start])
    }

    /// Rows that say what no reading can: the gauge.
    pub(crate) fn gauge(&self, base: &Base) -> Vec<DVector<f64>> {
        let mut rows = Vec::new();
        for (group, range) in &self.groups {
            let Group::Function(axis, f) = *group else { continue };
            let nodes = &self.plan.nodes_mm[axis];
            let mean = nodes.iter().sum::<f64>() / nodes.len() as f64;
            let mut hold = |weight: &dyn Fn(f64) -> f64| {
                let mut row = DVector::zeros(self.count);
                for (k, q) in nodes.iter().enumerate() {
                    row[range.start + k] = weight(*q);
                }
                rows.push(row);
            };
            // A constant shift of any axis is a shift of the instrument; a constant angle of an axis turns the next axes' lines.
            if f < 3 || base.place(axis) < 2 {
                hold(&|_| 1.0);
            }
            // The lines of X and of Y say how the instrument is turned: X along its line, Y in its plane.
            if self.plan.turned && LINES.contains(&(axis, f)) {
                hold(&|q| q - mean);
            }
        }
        rows
    }
}

/// Straightness functions (axis, function) whose slope is the instrument's rotation: EYX, EZX, EZY.
pub(crate) const LINES: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

/// Straightness functions whose slope is a squareness, and its sign: EC0Y, EB0Z, EA0Z; equation (5).
pub(crate) const ANGLES: [(usize, usize, f64); 3] = [(1, 0, -1.0), (2, 0, 1.0), (2, 1, -1.0)];

/// Nodes with a share in the value at `q`, and the shares: straight lines, the ends kept beyond.
pub(crate) fn hats(nodes: &[f64], q: f64) -> Vec<(usize, f64)> {
    let last = nodes.len() - 1;
    if q <= nodes[0] {
        return vec![(0, 1.0)];
    }
    if q >= nodes[last] {
        return vec![(last, 1.0)];
    }
    let above = nodes.partition_point(|node| *node <= q);
    let part = (q - nodes[above - 1]) / (nodes[above] - nodes[above - 1]);
    vec![(above - 1, 1.0 - part), (above, part)]
}

/// Positions on which the base's tables with a change are the same curves as before where nothing changed.
pub(crate) fn positions(axis: &LinearAxis, nodes: &[f64], interpolation: Interpolation) -> Vec<f64> {
    /// Table nodes nearer than this are one, mm.
    const SAME_MM: f64 = 1e-6;
    /// Below what is written: mm, and rad for angles.
    const SAME_CURVE: [f64; 2] = [5e-6, 5e-9];
    /// A cubic sampled sixteen times finer is the same to all that matters.
    const MOST_HALVINGS: usize = 4;
    let tables: Vec<&AxisTables> = [&axis.errors, &axis.errors_negative].into_iter().flatten().collect();
    let range = axis.calibrated_mm();
    let mut all: Vec<f64> = tables.iter().flat_map(|t| t.nodes()).chain(nodes).copied().collect();
    all.retain(|q| tables.is_empty() || range.contains(*q));
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| *a - *b < SAME_MM);
    for _ in 0..MOST_HALVINGS {
        let same = |table: &&AxisTables| {
            let rows: Vec<Six> = all.iter().map(|q| table.at(*q)).collect();
            let Some(again) = tables_of(&all, &rows, interpolation) else { return true };
            all.windows(2).all(|w| {
                [0.25, 0.5, 0.75].iter().all(|part| {
                    let q = w[0] + (w[1] - w[0]) * part;
                    let (a, b) = (table.at(q), again.at(q));
                    (0..6).all(|i| (a[i] - b[i]).abs() < SAME_CURVE[i / 3])
                })
            })
        };
        if tables.iter().all(same) {
            break;
        }
        let middles: Vec<f64> = all.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
        all.extend(middles);
        all.sort_by(f64::total_cmp);
    }
    all
}

pub(crate) fn tables_of(positions: &[f64], rows: &[Six], interpolation: Interpolation) -> Option<AxisTables> {
    let function = |i: usize| {
        Table::new(positions.to_vec(), rows.iter().map(|row| row[i]).collect(), interpolation).ok()
    };
    AxisTables::new(&std::array::from_fn(function))
}
