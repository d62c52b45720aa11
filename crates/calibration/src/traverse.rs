//! One axis driven alone, read several times: mean and standard uncertainty per node.

use diagnostic::{Text, both};
use machine_model::Vector;

use crate::error::{CalibrationError, LETTERS};

/// One reading of a traverse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Commanded position of all axes, mm.
    pub commanded_mm: Vector,
    /// Measured position, mm, instrument frame.
    pub measured_mm: Vector,
    /// Direction from which the node was approached: -1, +1, 0 where unknown.
    pub direction: i8,
}

/// Where the scatter of the nodes is known from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Noise {
    /// From repeats, with so many degrees of freedom.
    Repeats(usize),
    /// Given by the user.
    Given,
    /// From the second differences along the traverse, its first interval left out: noise and whatever the machine
    /// does from node to node (a screw's period) together, so an upper bound of the noise.
    Roughness,
}

/// Mean of the readings at one command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Command of the axis that moves, mm.
    pub commanded_mm: f64,
    /// Mean of the readings, mm.
    pub measured_mm: Vector,
    /// Readings in the mean.
    pub count: usize,
    /// Standard uncertainty of the mean, per component, mm.
    pub uncertainty_mm: Vector,
}

/// A traverse of one axis with everything repeated put together.
#[derive(Clone, Debug, PartialEq)]
pub struct MeanTraverse {
    /// The axis that moves: 0 X, 1 Y, 2 Z.
    pub axis: usize,
    /// Commands of all axes at the first node, mm.
    pub start_mm: Vector,
    /// Nodes by rising command.
    pub nodes: Vec<Node>,
    /// Standard deviation of one reading per component, mm.
    pub scatter_mm: Vector,
    /// Where the scatter is known from.
    pub noise: Noise,
    /// Mean of (approached from below) minus (approached from above), mm, where both were measured.
    pub reversal_mm: Option<Vector>,
    /// Nodes with fewer readings than the others: command, readings, readings elsewhere.
    pub short_of_runs: Vec<(f64, usize, usize)>,
    /// Steps that are larger than the usual one: from, to, usual step, mm.
    pub gaps: Vec<(f64, f64, f64)>,
}

/// Commands nearer than this are the same node, mm.
const SAME_MM: f64 = 1e-6;

impl MeanTraverse {
    /// Puts the readings of one file together: equation (31).
    ///
    /// * `given_mm` – standard uncertainty of one reading, where the instrument's is known better than one series shows
    ///
    /// # Errors
    /// [`CalibrationError::Axes`] where another axis moves than `axis`, or two; [`CalibrationError::Units`] where the
    /// measured travel is a thousand times the commanded; [`CalibrationError::TooFew`] below 3 nodes.
    pub fn new(axis: usize, readings: &[Reading], given_mm: Option<f64>) -> Result<Self, CalibrationError> {
        moving_axis(axis, readings)?;
        let mut sorted: Vec<&Reading> = readings.iter().collect();
        sorted.sort_by(|a, b| a.commanded_mm[axis].total_cmp(&b.commanded_mm[axis]));
        let mut groups: Vec<Vec<&Reading>> = Vec::new();
        for reading in sorted {
            match groups.last_mut() {
                Some(group) if (reading.commanded_mm[axis] - group[0].commanded_mm[axis]).abs() < SAME_MM => {
                    group.push(reading);
                }
                _ => groups.push(vec![reading]),
            }
        }
        if groups.len() < 3 {
            return Err(CalibrationError::TooFew(both!(
                "the traverse of {} has {} nodes; a line and what departs from it need 3",
                "в проходе {} узлов {}; для линии и отклонений от неё нужны 3",
                LETTERS[axis],
                groups.len()
            )));
        }
        let (scatter_mm, noise) = scatter(&groups, given_mm, axis);
        let mut nodes = Vec::with_capacity(groups.len());
        for group in &groups {
            nodes.push(Node {
                commanded_mm: group[0].commanded_mm[axis],
                measured_mm: mean(group),
                count: group.len(),
                uncertainty_mm: scatter_mm / (group.len() as f64).sqrt(),
            });
        }
        check_scale(axis, &nodes)?;
        let usual = nodes.iter().map(|n| n.count).max().unwrap_or(1);
        let short =
            nodes.iter().filter(|n| n.count < usual).map(|n| (n.commanded_mm, n.count, usual)).collect();
        let gaps = gaps(&nodes);
        Ok(Self {
            axis,
            start_mm: groups[0][0].commanded_mm,
            nodes,
            scatter_mm,
            noise,
            reversal_mm: reversal(&groups),
            short_of_runs: short,
            gaps,
        })
    }

    /// Only the nodes at least `chord_mm` apart, from the first on; the last node always stays.
    #[must_use]
    pub fn thinned(&self, chord_mm: f64) -> Self {
        let mut nodes: Vec<Node> = Vec::new();
        for node in &self.nodes {
            if nodes.last().is_none_or(|last| node.commanded_mm - last.commanded_mm >= chord_mm - SAME_MM) {
                nodes.push(*node);
            }
        }
        if let Some(end) = self.nodes.last()
            && nodes.last().is_none_or(|last| end.commanded_mm - last.commanded_mm > SAME_MM)
        {
            // A last chord that is too short goes into the one before it.
            nodes.truncate(nodes.len().saturating_sub(1).max(1));
            nodes.push(*end);
        }
        Self { nodes, ..self.clone() }
    }

    /// Measured position where the axis is commanded to `q`, straight between the nodes, mm.
    #[must_use]
    pub fn at(&self, q: f64) -> Vector {
        let k =
            self.nodes.partition_point(|n| n.commanded_mm <= q).saturating_sub(1).min(self.nodes.len() - 2);
        let (a, b) = (&self.nodes[k], &self.nodes[k + 1]);
        let part = (q - a.commanded_mm) / (b.commanded_mm - a.commanded_mm);
        a.measured_mm + (b.measured_mm - a.measured_mm) * part
    }
}

/// Refuses a file in which another axis moves, or more than one.
fn moving_axis(axis: usize, readings: &[Reading]) -> Result<(), CalibrationError> {
    let Some(first) = readings.first() else {
        return Err(CalibrationError::TooFew(both!(
            "the traverse of {} has no readings",
            "в проходе {} нет отсчётов",
            LETTERS[axis]
        )));
    };
    let moves =
        |i: usize| readings.iter().any(|r| (r.commanded_mm[i] - first.commanded_mm[i]).abs() > SAME_MM);
    let moving: Vec<char> = (0..3).filter(|&i| moves(i)).map(|i| LETTERS[i]).collect();
    match moving.as_slice() {
        [one] if *one == LETTERS[axis] => Ok(()),
        [one] => Err(CalibrationError::Axes(both!(
            "a traverse of {} is expected here, but the axis commanded in it is {one}",
            "здесь ожидается проход {}, а задаётся в нём ось {one}",
            LETTERS[axis]
        ))),
        [] => Err(CalibrationError::Axes(both!(
            "no axis moves in the traverse of {}",
            "в проходе {} не движется ни одна ось",
            LETTERS[axis]
        ))),
        several => {
            let names: Vec<String> = several.iter().map(char::to_string).collect();
            let (own, names, russian) = (LETTERS[axis], names.join(" and "), names.join(" и "));
            Err(CalibrationError::Axes(Text::new(
                format!("the axes {names} move in the traverse of {own}; a traverse moves one axis alone"),
                format!("в проходе {own} движутся оси {russian}; в проходе движется только одна ось"),
            )))
        }
    }
}

fn mean(group: &[&Reading]) -> Vector {
    group.iter().map(|r| r.measured_mm).sum::<Vector>() / group.len() as f64
}

/// Standard deviation of one reading per component and where it is from: equation (31).
fn scatter(groups: &[Vec<&Reading>], given_mm: Option<f64>, axis: usize) -> (Vector, Noise) {
    if let Some(given) = given_mm {
        return (Vector::from_element(given), Noise::Given);
    }
    // Both directions of approach differ by more than noise: each counts against its own mean.
    let mut squares = Vector::zeros();
    let mut free = 0;
    for group in groups {
        for direction in [-1, 0, 1] {
            let own: Vec<&Reading> =
                group.iter().filter(|r| r.direction.signum() == direction).copied().collect();
            if own.len() > 1 {
                let centre = mean(&own);
                squares += own.iter().map(|r| (r.measured_mm - centre).map(|d| d * d)).sum::<Vector>();
                free += own.len() - 1;
            }
        }
    }
    if free > 0 {
        return (squares.map(|s| (s / free as f64).sqrt()), Noise::Repeats(free));
    }
    // Second differences of independent readings have six times the variance of one. On uneven nodes the command's own
    // second difference is taken off.
    let skip = usize::from(groups.len() > 6);
    let mut sum = Vector::zeros();
    let mut count = 0;
    for three in groups[skip..].windows(3) {
        let q = |k: usize| three[k][0].commanded_mm[axis];
        let share = (q(1) - q(0)) / (q(2) - q(0));
        let bend = mean(&three[1]) - mean(&three[0]) * (1.0 - share) - mean(&three[2]) * share;
        let gain = 1.0 + share * share + (1.0 - share) * (1.0 - share);
        sum += bend.map(|d| d * d / gain);
        count += 1;
    }
    (sum.map(|s| (s / f64::from(count.max(1))).sqrt()), Noise::Roughness)
}

/// Mean difference between the directions of approach, over the nodes that have both.
fn reversal(groups: &[Vec<&Reading>]) -> Option<Vector> {
    let (mut sum, mut count) = (Vector::zeros(), 0);
    for group in groups {
        let side = |sign: i8| -> Vec<&Reading> {
            group.iter().filter(|r| r.direction.signum() == sign).copied().collect()
        };
        let (below, above) = (side(1), side(-1));
        if !below.is_empty() && !above.is_empty() {
            sum += mean(&below) - mean(&above);
            count += 1;
        }
    }
    (count > 0).then(|| sum / f64::from(count))
}

/// The measured travel must be the commanded one but for errors of machines.
fn check_scale(axis: usize, nodes: &[Node]) -> Result<(), CalibrationError> {
    let (first, last) = (&nodes[0], &nodes[nodes.len() - 1]);
    let ratio = (last.measured_mm - first.measured_mm).norm() / (last.commanded_mm - first.commanded_mm);
    let near = |factor: f64| (ratio / factor - 1.0).abs() < 0.05;
    let guess = [
        (
            1000.0,
            Text::pair("are the measured positions in micrometres?", "измеренные положения в микрометрах?"),
        ),
        (
            1e-3,
            Text::pair(
                "are the commanded positions in micrometres, or the measured ones in metres?",
                "заданные положения в микрометрах или измеренные в метрах?",
            ),
        ),
        (25.4, Text::pair("are the commanded positions in inches?", "заданные положения в дюймах?")),
        (1.0 / 25.4, Text::pair("are the measured positions in inches?", "измеренные положения в дюймах?")),
    ];
    if near(1.0) {
        return Ok(());
    }
    let usual = Text::pair(
        "are commanded and measured positions in millimetres?",
        "заданные и измеренные положения в миллиметрах?",
    );
    let why = guess.into_iter().find(|(factor, _)| near(*factor)).map_or(usual, |(_, why)| why);
    Err(CalibrationError::Units(both!(
        "the traverse of {} is {ratio:.4} times as long as commanded: {why}",
        "проход {} длиннее заданного в {ratio:.4} раза: {why:#}",
        LETTERS[axis]
    )))
}

/// Steps at least half as large again as the median one.
fn gaps(nodes: &[Node]) -> Vec<(f64, f64, f64)> {
    let mut steps: Vec<f64> = nodes.windows(2).map(|w| w[1].commanded_mm - w[0].commanded_mm).collect();
    steps.sort_by(f64::total_cmp);
    let usual = steps[steps.len() / 2];
    let large = |w: &[Node]| w[1].commanded_mm - w[0].commanded_mm > 1.5 * usual;
    nodes.windows(2).filter(|w| large(w)).map(|w| (w[0].commanded_mm, w[1].commanded_mm, usual)).collect()
}
