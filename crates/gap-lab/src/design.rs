//! Measuring plans: which points are visited, in which order, under which conditions.

use crate::alias::Alias;
use crate::dice::Dice;
use crate::machine::Machine;
use crate::row::{Row, Sight};

/// How the machine is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Plan {
    /// Lines along all axes at several offsets, diagonals, both directions, two feeds, three tools, repeats.
    Good,
    /// One line per axis, both directions, two feeds, two tools.
    Sparse,
    /// One line per axis, both directions, one feed, one tool.
    FewLines,
    /// Two lines per axis, always approached from the same side.
    OneWay,
    /// As few lines, but only the component along the moving axis is read.
    Interferometer,
    /// A grid in one plane.
    Plane,
    /// Points strewn in the volume, direction of approach not noted.
    Points,
    /// A design under which two names are the same, and which case of it: see [`Alias`].
    Aliased(Alias, usize),
    /// Circles of a ball bar in three planes.
    BallBar,
    /// Points on the workpiece, seen at many angles of the rotary table.
    Turntable,
}

impl Plan {
    /// The plans called poor.
    pub const POOR: [Self; 6] =
        [Self::Sparse, Self::FewLines, Self::Interferometer, Self::OneWay, Self::Plane, Self::Points];

    /// A word for tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Sparse => "sparse",
            Self::FewLines => "few lines",
            Self::Interferometer => "interferometer",
            Self::OneWay => "one way",
            Self::Plane => "plane",
            Self::Points => "points",
            Self::Aliased(..) => "aliased",
            Self::BallBar => "ball bar",
            Self::Turntable => "turntable",
        }
    }
}

/// Which of the optional columns the file carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Columns {
    pub(crate) approach: bool,
    pub(crate) feed: bool,
    pub(crate) tool: bool,
    pub(crate) load: bool,
    pub(crate) time: bool,
    pub(crate) temperature: bool,
}

impl Columns {
    pub(crate) const ALL: Self =
        Self { approach: true, feed: true, tool: true, load: true, time: true, temperature: true };
}

/// The rows of a plan and the columns its file shows.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    pub(crate) rows: Vec<Row>,
    pub(crate) columns: Columns,
    /// Duration, s.
    pub(crate) span: f64,
}

/// Directions in which targets are passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ways {
    /// From the first to the last.
    One,
    /// And back.
    Both,
}

/// Passes over the same targets under the same conditions.
#[derive(Clone)]
pub(crate) struct Block {
    pub(crate) targets: Vec<[f64; 3]>,
    pub(crate) tool: [f64; 3],
    pub(crate) feed: f64,
    pub(crate) load: f64,
    pub(crate) repeats: usize,
    pub(crate) ways: Ways,
}

/// Writes down rows in the order of time.
pub(crate) struct Recorder {
    pub(crate) rows: Vec<Row>,
    /// Time, s.
    pub(crate) clock: f64,
    /// Offset, size, period, phase and second wave of the temperature.
    pub(crate) weather: [f64; 5],
    pub(crate) sight: Sight,
}

impl Recorder {
    pub(crate) fn new(dice: &mut Dice, sight: Sight) -> Self {
        let weather = [
            dice.between(0.3, 1.8),
            dice.between(2.0, 4.0),
            dice.between(1500.0, 4000.0),
            dice.phase(),
            dice.between(0.3, 0.8),
        ];
        Self { rows: Vec::new(), clock: 0.0, weather, sight }
    }

    /// Temperature of the machine: an offset from 20 °C and two waves of different length.
    pub(crate) fn temperature(&self) -> f64 {
        let [offset, size, period, phase, second] = self.weather;
        let angle = std::f64::consts::TAU * self.clock / period;
        let value = 20.0 + offset + size * (libm::sin(angle + phase) + second * libm::sin(2.7 * angle));
        (value * 100.0).round() / 100.0
    }

    pub(crate) fn block(&mut self, run: usize, block: &Block, dice: &mut Dice) {
        self.clock += 40.0;
        for repeat in 1..=block.repeats {
            self.pass(run, block, repeat, block.targets.clone(), dice);
            if block.ways == Ways::Both {
                self.pass(run, block, repeat, block.targets.iter().rev().copied().collect(), dice);
            }
        }
    }

    /// Reads the targets one after the other.
    fn pass(&mut self, run: usize, block: &Block, repeat: usize, targets: Vec<[f64; 3]>, dice: &mut Dice) {
        let overrun = dice.between(4.0, 8.0);
        let Some((first, last)) = targets.first().zip(targets.last()) else { return };
        let way = [0, 1, 2].map(|i| last[i] - first[i]);
        let length = (way[0] * way[0] + way[1] * way[1] + way[2] * way[2]).sqrt();
        let tangent = way.map(|w| if length > 0.0 { w / length } else { 0.0 });
        let start = *first;
        for target in targets {
            self.clock += 3.0 + 60.0 * length / (block.feed * block.targets.len() as f64);
            let since_reversal = [0, 1, 2].map(|i| overrun * tangent[i].abs() + (target[i] - start[i]).abs());
            self.rows.push(Row {
                run,
                command: target,
                turn: 0.0,
                tool: block.tool,
                approach: tangent.map(|t| if t == 0.0 { 0.0 } else { t.signum() }),
                tangent,
                since_reversal,
                feed: block.feed,
                load: block.load,
                time: (self.clock * 10.0).round() / 10.0,
                temperature: self.temperature(),
                repeat,
                sight: self.sight,
            });
        }
    }

    pub(crate) fn finish(self, columns: Columns) -> Layout {
        Layout { rows: self.rows, columns, span: self.clock.max(1.0) }
    }
}

/// How far apart targets on a line are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pitch {
    /// All alike.
    Even,
    /// Inner ones are moved off the even pitch, as ISO 230-2 asks for, so that an error periodic with the screw is seen.
    Uneven,
}

/// Targets on the straight line between two points. Equal components stay equal.
fn targets(dice: &mut Dice, from: [f64; 3], to: [f64; 3], count: usize, pitch: Pitch) -> Vec<[f64; 3]> {
    (0..count)
        .map(|k| {
            let inner = k > 0 && k + 1 < count && pitch == Pitch::Uneven;
            let off = if inner { dice.between(-0.35, 0.35) } else { 0.0 };
            let s = (k as f64 + off) / (count - 1) as f64;
            [0, 1, 2].map(|i| {
                let value = from[i] + s * (to[i] - from[i]);
                (value * 1000.0).round() / 1000.0
            })
        })
        .collect()
}

/// A line along `axis` at given fractions of the other two.
pub(crate) fn axis_line(
    dice: &mut Dice,
    machine: &Machine,
    axis: usize,
    offset: [f64; 2],
    count: usize,
    pitch: Pitch,
) -> Vec<[f64; 3]> {
    let place = |a: usize, s: f64| machine.travel[a][0] + s * (machine.travel[a][1] - machine.travel[a][0]);
    let round = |v: f64| v.round();
    let (mut from, mut to) = ([0.0; 3], [0.0; 3]);
    for (k, other) in [(axis + 1) % 3, (axis + 2) % 3].into_iter().enumerate() {
        from[other] = round(place(other, offset[k]));
        to[other] = from[other];
    }
    from[axis] = round(place(axis, dice.between(0.02, 0.05)));
    to[axis] = round(place(axis, dice.between(0.95, 0.98)));
    targets(dice, from, to, count, pitch)
}

/// A 45° line in two or three axes, rising in each axis where `signs` is 1.
pub(crate) fn diagonal(dice: &mut Dice, machine: &Machine, signs: [f64; 3], count: usize) -> Vec<[f64; 3]> {
    let moving = |a: usize| signs[a] != 0.0;
    let sizes = [0, 1, 2].map(|a| machine.travel[a][1] - machine.travel[a][0]);
    let reach = (0..3).filter(|a| moving(*a)).map(|a| sizes[a]).fold(f64::INFINITY, f64::min) * 0.9;
    let (mut from, mut to) = ([0.0; 3], [0.0; 3]);
    for a in 0..3 {
        let middle = (machine.travel[a][0] + sizes[a] * dice.between(0.48, 0.52)).round();
        from[a] = middle - signs[a] * (reach / 2.0).round();
        to[a] = middle + signs[a] * (reach / 2.0).round();
    }
    targets(dice, from, to, count, Pitch::Uneven)
}

/// Assigns blocks to runs and records them.
pub(crate) fn record(
    mut recorder: Recorder,
    blocks: &[Block],
    runs: usize,
    columns: Columns,
    dice: &mut Dice,
) -> Layout {
    for (k, block) in blocks.iter().enumerate() {
        recorder.block(k * runs / blocks.len(), block, dice);
    }
    recorder.finish(columns)
}

pub(crate) const ALL_SEEN: Sight = Sight::Components([true; 3]);
pub(crate) const OFFSETS: [[f64; 2]; 5] = [[0.05, 0.05], [0.95, 0.1], [0.1, 0.95], [0.9, 0.9], [0.5, 0.5]];
